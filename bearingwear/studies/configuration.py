"""What the workflow reads: its configurations, their grids, and the values of scenes that decide.

This file imports nothing heavy: Snakemake reads the Snakefile before each job on a cluster.
"""

from __future__ import annotations

import functools
import json
import shlex
import sys
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from bearingwear.console import UsageError
from bearingwear.document.document import load_document
from bearingwear.provenance import PACKAGE, other_copy, text_hash
from bearingwear.results.pair_variables import BEARINGS
from bearingwear.scene.arrangement import Arrangement, one_bearing
from bearingwear.scene.assumed import assumed_keys
from bearingwear.scene.checking.check import record
from bearingwear.scene.checking.errors import leaves
from bearingwear.scene.checking.strict_yaml import data_of, text_of
from bearingwear.scene.decisive import decisive_data
from bearingwear.scene.read import as_data, changed_scene, for_life, load_scene, variant
from bearingwear.studies.axis import RisingAxis, in_name, place_of_errors
from bearingwear.studies.design.plan import NO_FRICTION, DesignLimits
from bearingwear.studies.grid.grid import GRID_AXES, Grid
from bearingwear.studies.solve import life_scene
from bearingwear.studies.uncertainty.plan import uncertain_scene

FORK_SERVER = PACKAGE / "studies" / "fork_server.py"
"""Program that jobs run."""


def read(path: str) -> dict[str, Any]:
    """A configuration as plain data; empty where there is no such file."""
    return dict(data_of(text_of(path), path, anchors=True)) if Path(path).is_file() else {}


def validated(
    path: Path, schema: str, check: Callable[[Mapping[str, Any], Path], None]
) -> dict[str, Any]:
    """A configuration with the defaults of its schema, for a command outside of Snakemake.

    check: refuses by a ValueError what the schema cannot.
    UsageError: one line that says what is wrong.
    """
    from snakemake.exceptions import WorkflowError
    from snakemake.utils import validate

    try:
        data = dict(data_of(text_of(path), str(path), anchors=True))
        validate(data, str(PACKAGE.parent / "workflow" / "schemas" / f"{schema}.schema.yaml"))
        check(data, path)
    except (WorkflowError, ValueError) as error:
        raise UsageError(fault(path, error)) from None
    return data


def refuse_other_copy() -> None:
    """End with status 2 where an installed copy differs: commands would be of other sources."""
    if copy := other_copy():
        print(
            f"{copy}: got an installed copy that differs from the sources of this workflow; "
            "expected the same ones: run `make venv` or `pip install -c constraints.txt -e .`",
            file=sys.stderr,
        )
        raise SystemExit(2)


def fault(path: str | Path, error: Exception) -> str:
    """What is wrong with a configuration, on one line: by a check, or by a schema.

    error: what a check raises, or Snakemake's `validate`.
    """
    if isinstance(error, ValueError):
        return str(error)
    found: Any = error.__context__
    keys = (f"[{key}]" if isinstance(key, int) else f".{key}" for key in found.absolute_path)
    return f"{path}: {''.join(keys).lstrip('.') or 'the file'}: {found.message}"


def scene_file(scene: str) -> str:
    """Path of the file of a scene."""
    return f"config/scenes/{scene}.yaml"


def mu_name(friction: float) -> str:
    """A friction coefficient as it stands in the names of files."""
    return in_name(friction, 3)


def loss_name(loss_um: float) -> str:
    """A loss of ball diameter as it stands in the names of files."""
    return in_name(loss_um, 2)


def settings(changes: Mapping[str, Any]) -> str:
    """Changes of a scene as `--set` takes them."""
    words = (shlex.quote(f"{key}={json.dumps(value)}") for key, value in changes.items())
    return " ".join(["--set", *words]) if changes else ""


# what a scene decides


def scene_values(
    file: str | Callable[[Any], str] = "config/scenes/{scene}.yaml",
    replaced: Iterable[str] = (),
    cage: bool = False,
    uncertainty: bool = False,
) -> Callable[[Any], str]:
    """A function of wildcards that returns the hash of what a scene decides in a job.

    Snakemake runs a job again when its params change: after a change of a value that the job reads,
    and not after a change of a comment, the description or a value that it does not read.

    file: path of the scene with wildcards, or a function of these.
    replaced: keys that the job sets itself.
    cage: whether the job reads more of the cage than its material.
    uncertainty: whether the job samples the uncertain values, or its file quotes them.
    """
    keys = tuple(replaced)

    def values(wildcards: Any) -> str:
        path = file(wildcards) if callable(file) else file.format(**dict(wildcards.items()))
        return scene_hash(path, keys, cage, uncertainty)

    return values


@functools.cache
def scene_hash(path: str, replaced: tuple[str, ...], cage: bool, uncertainty: bool) -> str:
    """Hash of the values of a scene that decide a result; arguments as of `scene_values`."""
    data = dict(as_data(path)[0])
    # a warning reads in the description that the speed is assumed
    assumed = "Speed assumed:" in str(data.pop("description", ""))
    more = ["friction", "cage", "cage_uncertainty"] * cage + ["uncertainty"] * uncertainty
    read = decisive_data(data) | {key: data.get(key) for key in more}
    values = {key: value for key, value in leaves(read).items() if key not in replaced}
    return text_hash(json.dumps([values, assumed], sort_keys=True))


def page_notes(scenes: Iterable[str]) -> str:
    """Hash of what the report page reads in scene files beside their results."""
    notes = [
        [as_data(path)[0].get("description"), sorted(assumed_keys(path))]
        for path in map(scene_file, scenes)
    ]
    return text_hash(json.dumps(notes))


def headlines(answers: Iterable[str]) -> list[str]:
    """Titles of the leading answers on the report page: recommendations, if there are any."""
    found = [load_document(Path(path)) for path in answers if path.endswith("answer.json")]
    least = min((answer.rank for answer in found), default=0)
    return [answer.title for answer in found if answer.rank == least]


def has_heat_capacities(scene: str) -> bool:
    """Whether a scene gives what a warm-up requires."""
    return "heat_capacity_J_K" in (as_data(scene_file(scene))[0].get("thermal") or {})


def has_duty(scene: str) -> bool:
    """Whether the life of a scene is over a duty."""
    return as_data(scene_file(scene))[0].get("duty") is not None


def bearings_drawn(scene: str) -> Sequence[str]:
    """Ends of the names of a scene's figures: one for each bearing where two of them differ."""
    given = as_data(scene_file(scene))[0].get("arrangement")
    alone = given is None or not (a := record(Arrangement, given)).is_pair or a.is_symmetric
    return ("",) if alone else tuple(f"-{which}" for which in BEARINGS)


# checks that a schema cannot make


def grids(config: Mapping[str, Any], key: str = "studies") -> dict[str, Grid]:
    """The grid of each scene in the blocks of config.yaml. Raises ValueError."""
    found: dict[str, Grid] = {}
    for number, block in enumerate(config[key]):
        place = f"config: {key}[{number}]"
        with place_of_errors(place):
            grid = Grid.from_lists(*(block[axis] for axis in GRID_AXES))
        for scene in block["scenes"]:
            if scene in found:
                raise ValueError(f"{place}.scenes: got {scene} twice, expected it once")
            found[scene] = grid
    return found


def check_config(config: Mapping[str, Any]) -> None:
    """Refuse figures and spreads of what is not solved, and scenes that a grid makes impossible.

    ValueError: one line that names the key, or the scene file.
    """
    studied, dynamic = grids(config), grids(config, "dynamic")
    figures, every_mu = config["figures"], {mu for grid in studied.values() for mu in grid.friction}
    if studied:
        _check_each("figures.friction", map(float, figures["friction"]), every_mu)
    for k, column in enumerate(figures["wear_columns"]):
        _check_studied(f"figures.wear_columns[{k}]", column["scene"], column["friction"], studied)
    for kind in ("spreads", "lives"):
        for name, overlay in figures[kind].items():
            for scene in overlay["scenes"]:
                _check_studied(f"figures.{kind}.{name}", scene, overlay["friction"], studied)
    _check_each("figures.running_averages", figures["running_averages"], dynamic)
    spread = config["uncertain_lives"]["scenes"]
    _check_each("uncertain_lives.scenes", spread, studied or spread)
    for scene in spread:
        if not load_scene(scene_file(scene)).uncertainty:
            problem = f"got {scene}, whose file has no uncertainty block, expected scenes with one"
            raise ValueError(f"config: uncertain_lives.scenes: {problem}")
    for scene, grid in studied.items():
        for_life(load_scene(scene_file(scene)), scene_file(scene))
        _check_cases(scene, grid, {})
    for scene, grid in dynamic.items():
        one_bearing(load_scene(scene_file(scene)), scene_file(scene))
        _check_cases(scene, grid, dynamic_model(config, scene))
        # a dynamic case without its steady twin could not be set beside it
        for case in grid.cases() if scene in studied else ():
            if case not in studied[scene].cases():
                problem = f"got {scene}, {case}, expected cases of the same scene under studies"
                raise ValueError(f"config: dynamic: {problem}")


def dynamic_model(config: Mapping[str, Any], scene: str) -> dict[str, Any]:
    """Keys that the dynamic cases of a scene set in its block `model`."""
    (block,) = [block for block in config["dynamic"] if scene in block["scenes"]]
    return {f"model.{key}": value for key, value in block["model"].items()}


def _check_each(key: str, given: Iterable[Any], known: Collection[Any]) -> None:
    for one in given:
        if one not in known:
            allowed = ", ".join(map(_text, sorted(known))) or "none, because nothing is studied"
            raise ValueError(f"config: {key}: got {_text(one)}, expected {allowed}")


def _text(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def _check_studied(key: str, scene: str, mu: float, studied: Mapping[str, Grid]) -> None:
    _check_each(key, [scene], studied)
    _check_each(f"{key}: {scene}", [float(mu)], studied[scene].friction)


def _check_cases(scene: str, grid: Grid, more: Mapping[str, Any]) -> None:
    """Check a scene, read once, as some cases change it: each value of each axis is in one."""
    data, source = as_data(scene_file(scene))
    for case in grid.cases_of_each_value():
        with place_of_errors(f"config: {scene}, {case.id}"):
            changed_scene(data, {**case.changes, **more}, source)


def check_lives(lives: Mapping[str, Any]) -> None:
    """Read every scene of lives.yaml as its life changes it. Raises ValueError."""
    for name, life in lives["lives"].items():
        path = scene_file(life["scene"])
        with place_of_errors(f"config/lives.yaml: lives.{name}"):
            for_life(variant(path, life["set"]), path)


def check_design(design: Mapping[str, Any]) -> None:
    """Read every scene of design.yaml and its requirements. Raises ValueError."""
    for name, one in design["scenes"].items():
        path = scene_file(name)
        limits = record(DesignLimits, one["limits"], f"config/design.yaml: scenes.{name}.limits")
        limits.check(life_scene(path, films=True), path)


def check_sampled(uncertainty: Mapping[str, Any]) -> None:
    """Refuse scenes of uncertainty.yaml whose lives cannot be sampled. Raises ValueError."""
    for name in uncertainty["scenes"]:
        uncertain_scene(scene_file(name))


def map_axes(axes: Mapping[str, Any]) -> dict[str, Any]:
    """Axes of a map of design.yaml as lists."""
    numbers = {key: values for key, values in axes.items() if key != "preload_method"}
    return {"preload_method": list(axes["preload_method"])} | {
        key: values if values == [NO_FRICTION] else list(RisingAxis.from_plain(values))
        for key, values in numbers.items()
    }
