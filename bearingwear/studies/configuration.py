"""Configurations of the workflow, their grids, and hashes of the values that decide a result.

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
from bearingwear.scene.arrangement import Arrangement, single_bearing_scene
from bearingwear.scene.assumed import assumed_keys
from bearingwear.scene.checking.check import record
from bearingwear.scene.checking.errors import leaves
from bearingwear.scene.checking.strict_yaml import data_of, text_of
from bearingwear.scene.decisive import decisive_data
from bearingwear.scene.read import as_data, changed_scene, load_scene, scene_for_life, variant
from bearingwear.studies.axis import RisingAxis, place_of_errors
from bearingwear.studies.design.plan import NO_FRICTION, DesignLimits
from bearingwear.studies.grid.grid import GRID_AXES, Grid
from bearingwear.studies.solve import life_scene
from bearingwear.studies.uncertainty.plan import uncertain_scene

FORK_SERVER = PACKAGE / "studies" / "fork_server.py"
"""Program that jobs run."""


def read_config(path: str) -> dict[str, Any]:
    """Returns a configuration as plain data; an empty dict where there is no such file."""
    return dict(data_of(text_of(path), path, anchors=True)) if Path(path).is_file() else {}


def validated_config(
    path: Path, schema: str, check: Callable[[Mapping[str, Any], Path], None]
) -> dict[str, Any]:
    """Returns a configuration with the defaults of its schema, for a command outside of Snakemake.

    schema: name of the schema, such as "cage" for cage.schema.yaml.
    check: takes the configuration and its path, and raises a ValueError for faults that the schema
        cannot detect.
    UsageError: one line that says what is wrong.
    """
    from snakemake.exceptions import WorkflowError
    from snakemake.utils import validate

    try:
        data = dict(data_of(text_of(path), str(path), anchors=True))
        validate(data, str(PACKAGE.parent / "workflow" / "schemas" / f"{schema}.schema.yaml"))
        check(data, path)
    except (WorkflowError, ValueError) as error:
        raise UsageError(fault_line(path, error)) from None
    return data


def refuse_other_copy() -> None:
    """Ends the process if an installed copy differs from these sources; commands would run it.

    It writes a line to standard error and raises SystemExit with status 2.
    """
    if copy := other_copy():
        print(
            f"{copy}: got an installed copy that differs from the sources of this workflow; "
            "expected the same ones: run `make venv` or `pip install -c constraints.txt -e .`",
            file=sys.stderr,
        )
        raise SystemExit(2)


def fault_line(path: str | Path, error: Exception) -> str:
    """Returns one line that says what is wrong with a configuration.

    error: raised by a check, or by Snakemake's `validate`.
    """
    if isinstance(error, ValueError):
        return str(error)
    violation: Any = error.__context__  # of jsonschema
    keys = (f"[{key}]" if isinstance(key, int) else f".{key}" for key in violation.absolute_path)
    return f"{path}: {''.join(keys).lstrip('.') or 'the file'}: {violation.message}"


def scene_file(scene: str) -> str:
    """Returns the path of the file of a scene, from the name of the scene."""
    return f"config/scenes/{scene}.yaml"


def settings(changes: Mapping[str, Any]) -> str:
    """Returns changes of a scene as `--set` options of a shell command; empty without changes."""
    words = (shlex.quote(f"{key}={json.dumps(value)}") for key, value in changes.items())
    return " ".join(["--set", *words]) if changes else ""


# what a scene decides


def scene_values(
    file: str | Callable[[Any], str] = "config/scenes/{scene}.yaml",
    replaced: Iterable[str] = (),
    cage: bool = False,
    uncertainty: bool = False,
) -> Callable[[Any], str]:
    """Returns a function of wildcards, which returns a hash of the values a job reads of a scene.

    Snakemake runs a job again when its params change. A value that the job reads changes the hash;
    comments, the description and other values do not.

    file: path of the scene with wildcards, or a function of these.
    replaced: keys that the job sets itself.
    cage: whether the job reads more of the cage than its material.
    uncertainty: whether the job samples the uncertain values, or its file quotes them.
    """
    replaced_keys = tuple(replaced)

    def hash_of_values(wildcards: Any) -> str:
        """Returns the hash of the scene that the wildcards of a job name."""
        path = file(wildcards) if callable(file) else file.format(**dict(wildcards.items()))
        return scene_hash(path, replaced_keys, cage, uncertainty)

    return hash_of_values


@functools.cache
def scene_hash(path: str, replaced: tuple[str, ...], cage: bool, uncertainty: bool) -> str:
    """Returns a hash of the values of a scene that decide a result.

    A process reads each scene once: later calls with the same arguments return the same hash.

    replaced, cage, uncertainty: as of `scene_values`.
    """
    data = dict(as_data(path)[0])
    # a warning depends on the description, which says whether the speed is assumed
    is_speed_assumed = "Speed assumed:" in str(data.pop("description", ""))
    more_keys = []
    if cage:
        more_keys += ["friction", "cage", "cage_uncertainty"]
    if uncertainty:
        more_keys.append("uncertainty")
    read_values = decisive_data(data) | {key: data.get(key) for key in more_keys}
    values = {key: value for key, value in leaves(read_values).items() if key not in replaced}
    return text_hash(json.dumps([values, is_speed_assumed], sort_keys=True))


def page_notes_hash(scenes: Iterable[str]) -> str:
    """Returns a hash of the descriptions and assumed keys of scenes, which the report page reads.

    scenes: names of scenes.
    """
    notes = [
        [as_data(path)[0].get("description"), sorted(assumed_keys(path))]
        for path in map(scene_file, scenes)
    ]
    return text_hash(json.dumps(notes))


def headlines(answers: Iterable[str]) -> list[str]:
    """Returns the titles of the answers of the lowest rank, which lead the report page.

    answers: paths; those that are no answer.json are left out.
    """
    documents = [load_document(Path(path)) for path in answers if path.endswith("answer.json")]
    best_rank = min((answer.rank for answer in documents), default=0)
    return [answer.title for answer in documents if answer.rank == best_rank]


def has_heat_capacities(scene: str) -> bool:
    """Whether a scene states the heat capacities that a warm-up requires."""
    return "heat_capacity_J_K" in (as_data(scene_file(scene))[0].get("thermal") or {})


def has_duty(scene: str) -> bool:
    """Whether the life of a scene is over a duty of several phases."""
    return as_data(scene_file(scene))[0].get("duty") is not None


def figure_suffixes(scene: str) -> Sequence[str]:
    """Returns the suffixes for the names of a scene's figures.

    They are "-first" and "-second" for a pair whose bearings differ, else only the empty suffix.
    """
    block = as_data(scene_file(scene))[0].get("arrangement")
    arrangement = Arrangement() if block is None else record(Arrangement, block)
    if not arrangement.is_pair or arrangement.is_symmetric:
        return ("",)
    return tuple(f"-{bearing}" for bearing in BEARINGS)


# checks that a schema cannot make


def grids(config: Mapping[str, Any], key: str = "studies") -> dict[str, Grid]:
    """Returns the grid of each scene in the blocks of config.yaml, by the name of the scene.

    key {"studies", "dynamic"}: of the list of blocks.
    ValueError: an axis that is not valid, or a scene in two blocks.
    """
    grid_of_scene: dict[str, Grid] = {}
    for number, block in enumerate(config[key]):
        place = f"config: {key}[{number}]"
        with place_of_errors(place):
            grid = Grid.from_lists(*(block[axis] for axis in GRID_AXES))
        for scene in block["scenes"]:
            if scene in grid_of_scene:
                raise ValueError(f"{place}.scenes: got {scene} twice, expected it once")
            grid_of_scene[scene] = grid
    return grid_of_scene


def check_config(config: Mapping[str, Any]) -> None:
    """Refuses figures of cases or lives that no grid contains, and scenes with invalid cases.

    It also refuses sampled scenes without a block `uncertainty` or outside of the studies, and
    studied scenes without an end of life. Dynamic cases must be of single bearings, and in the grid
    of steady cases of the same scene if there is one.

    config: data of config.yaml that agrees with its schema.
    ValueError: the first fault, in one line that names the key or the scene file.
    """
    studied, dynamic = grids(config), grids(config, "dynamic")
    figures = config["figures"]
    studied_frictions = {mu for grid in studied.values() for mu in grid.friction}
    if studied:
        drawn_frictions = [float(mu) for mu in figures["friction"]]
        _check_each("figures.friction", drawn_frictions, studied_frictions)
    for k, column in enumerate(figures["wear_columns"]):
        _check_studied(f"figures.wear_columns[{k}]", column["scene"], column["friction"], studied)
    for kind in ("spreads", "lives"):
        for name, overlay in figures[kind].items():
            for scene in overlay["scenes"]:
                _check_studied(f"figures.{kind}.{name}", scene, overlay["friction"], studied)
    _check_each("figures.running_averages", figures["running_averages"], dynamic)
    sampled_scenes = config["uncertain_lives"]["scenes"]
    _check_each("uncertain_lives.scenes", sampled_scenes, studied or sampled_scenes)
    for scene in sampled_scenes:
        if not load_scene(scene_file(scene)).uncertainty:
            problem = f"got {scene}, whose file has no uncertainty block, expected scenes with one"
            raise ValueError(f"config: uncertain_lives.scenes: {problem}")
    for scene, grid in studied.items():
        scene_for_life(load_scene(scene_file(scene)), scene_file(scene))  # raises for no end
        _check_cases(scene, grid, {})
    for scene, grid in dynamic.items():
        single_bearing_scene(load_scene(scene_file(scene)), scene_file(scene))  # for a pair
        _check_cases(scene, grid, dynamic_model(config, scene))
        if scene not in studied:
            continue
        # a dynamic case without its steady twin could not be compared with it
        for case in grid.cases():
            if case not in studied[scene].cases():
                problem = f"got {scene}, {case}, expected cases of the same scene under studies"
                raise ValueError(f"config: dynamic: {problem}")


def dynamic_model(config: Mapping[str, Any], scene: str) -> dict[str, Any]:
    """Returns the changes of the block `model` in the dynamic cases of a scene, by dotted key.

    config: data of config.yaml, in which a block of `dynamic` names the scene.
    """
    scene_block = next(block for block in config["dynamic"] if scene in block["scenes"])
    return {f"model.{key}": value for key, value in scene_block["model"].items()}


def _check_each(key: str, values: Iterable[Any], allowed_values: Collection[Any]) -> None:
    """Raises a ValueError for the first value of a key that is not allowed."""
    for value in values:
        if value not in allowed_values:
            expected = ", ".join(map(_printed_value, sorted(allowed_values)))
            expected = expected or "none, because nothing is studied"
            raise ValueError(f"config: {key}: got {_printed_value(value)}, expected {expected}")


def _printed_value(value: Any) -> str:
    """Returns a value of the configuration as a message shows it."""
    return f"{value:g}" if isinstance(value, float) else str(value)


def _check_studied(key: str, scene: str, mu: float, studied: Mapping[str, Grid]) -> None:
    """Refuses a scene that has no grid, or a friction coefficient that is not in its grid.

    key: of the configuration, for the error.
    studied: grids by the name of the scene.
    ValueError: one line that names the key.
    """
    _check_each(key, [scene], studied)
    _check_each(f"{key}: {scene}", [float(mu)], studied[scene].friction)


def _check_cases(scene: str, grid: Grid, model_changes: Mapping[str, Any]) -> None:
    """Checks a scene with the changes of cases that cover each value of each axis.

    Combinations of values are not checked.

    model_changes: by dotted key, of all cases.
    ValueError: a case that makes no valid scene; the line names the scene and the case.
    """
    data, source = as_data(scene_file(scene))
    for case in grid.cases_of_each_value():
        with place_of_errors(f"config: {scene}, {case.id}"):
            changed_scene(data, {**case.changes, **model_changes}, source)


def check_lives(lives: Mapping[str, Any]) -> None:
    """Checks every scene of lives.yaml with the changes of its life. Raises ValueError."""
    for name, life in lives["lives"].items():
        path = scene_file(life["scene"])
        with place_of_errors(f"config/lives.yaml: lives.{name}"):
            scene_for_life(variant(path, life["set"]), path)


def check_design(design: Mapping[str, Any]) -> None:
    """Checks every scene of design.yaml and its requirements. Raises ValueError."""
    for name, block in design["scenes"].items():
        path = scene_file(name)
        limits = record(DesignLimits, block["limits"], f"config/design.yaml: scenes.{name}.limits")
        limits.check(life_scene(path, films=True), path)


def check_sampled(uncertainty: Mapping[str, Any]) -> None:
    """Refuses scenes of uncertainty.yaml whose lives cannot be sampled. Raises ValueError."""
    for name in uncertainty["scenes"]:
        uncertain_scene(scene_file(name))


def map_axes(axes: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the axes of a map of design.yaml as lists of methods and numbers, by their keys.

    axes: `preload_method`, and further keys with a list, or with `first`, `last` and `step`. The
        list `[NO_FRICTION]`, for films, stays as it is.
    ValueError: an axis that does not rise, or is neither a list nor steps.
    """
    lists: dict[str, Any] = {"preload_method": list(axes["preload_method"])}
    for key, values in axes.items():
        if key != "preload_method":
            is_for_films = values == [NO_FRICTION]  # the films have coefficients of their own
            lists[key] = values if is_for_films else list(RisingAxis.from_plain(values))
    return lists
