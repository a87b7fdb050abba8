"""The study of one scene: `bearingwear study mine.yaml` writes its configuration into a folder.

The first line of each file says so and holds a hash of the rest, so that what somebody edited
there is never replaced.
"""

from __future__ import annotations

import hashlib
import math
import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from bearingwear.atomic import reason, write_text
from bearingwear.console import UsageError
from bearingwear.kernels.status import OK
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.records import NAME, NAME_RULE
from bearingwear.scene.friction import changes_as_it_wears
from bearingwear.scene.scene import PRELOAD_METHODS, Scene, key_of_scene
from bearingwear.studies.design.plan import NO_FRICTION, DesignLimits, axes_around
from bearingwear.studies.sampling import SAMPLES
from bearingwear.studies.solve import life_scene

if TYPE_CHECKING:
    from bearingwear.solvers.compose import Remembered

FRICTIONS = (0.5, 1.0, 1.5, 2.0)
"""Friction coefficients of the grid over the scene's own."""

STATES_OF_WEAR = 8
"""Steps from new to the end of the scene's life."""

LANDS = (0.5, 1.0)
"""Clearances of the cage at its land over the scene's own."""

CAGE_RUNS = 20
"""Runs of each cage: the fewest that workflow/schemas/cage.schema.yaml allows."""


def plan_of(scene: Scene, name: str, limits: DesignLimits, source: str) -> dict[str, Any]:
    """Configuration files of a study of a scene, as plain data by their paths.

    A scene whose friction or wear goes by films or running in has no grid of cases. A single
    bearing with a film of its cage or a `cage_uncertainty` has a map of cages, too.

    SceneError: a friction or a preload that no study can be made around.
    """
    limits.check(scene, source)
    filmed = scene.friction.film is not None or changes_as_it_wears(scene)
    frictions = [NO_FRICTION] if scene.friction.film else _frictions(scene, source)
    axes = axes_around(scene, frictions, source)  # refuses a preload of 0, which has no shares
    config: dict[str, Any] = {"studies": [], "unsolved": "warning"}
    if not filmed:
        config = _grid(scene, name, frictions)
    if scene.uncertainty and not filmed:
        config["uncertain_lives"] = {"scenes": [name], "samples": SAMPLES}
    small_map = {axis: list(values) for axis, values in vars(axes).items()}
    design = {"scenes": {name: {"small_map": small_map, "limits": limits.stored}}}
    plans = {"config/config.yaml": config, "config/design.yaml": design}
    asked = scene.cage is not None and (scene.cage.film or scene.cage_uncertainty) is not None
    if asked and scene.pair is None:
        plans["config/cage.yaml"] = _cages(scene, name)
    return plans


def _grid(scene: Scene, name: str, frictions: Sequence[float]) -> dict[str, Any]:
    """Configuration of cases over friction and wear, as plain data."""
    losses = _losses(scene)
    return {
        "studies": [
            {
                "scenes": [name],
                "preload_method": list(PRELOAD_METHODS),
                "friction": list(frictions),
                "ball_diameter_loss_um": losses,
            }
        ],
        # in one job: writing and reading a file for each of them takes longer than solving it
        "points_per_job": len(PRELOAD_METHODS) * len(frictions) * len(losses),
        "unsolved": "warning",
        "figures": {
            "worn_loss_um": losses[len(losses) // 2],
            "friction": [scene.friction.coefficient],
        },
    }


def _cages(scene: Scene, name: str) -> dict[str, Any]:
    """A map of cages around the scene's, with an ensemble for each."""
    cage = scene.cage
    assert cage is not None
    gaps = sorted({cage.guide_clearance_mm * factor for factor in LANDS})
    frictions = {float(f"{min(factor * scene.friction.cage, 1.0):.3g}") for factor in FRICTIONS[:3]}
    return {
        "scene": name,
        "gravity_m_s2": [math.hypot(*scene.operation.gravity_m_s2[1:])],
        "guiding_race": [cage.guiding_race],
        "imbalance_um": [cage.imbalance_um],
        "pocket_clearance_mm": [cage.pocket_clearance_mm],
        "guide_clearance_mm": gaps if cage.guiding_race != "ball" else gaps[-1:],
        "cage_friction": sorted(frictions),
        "ensemble": {"runs": CAGE_RUNS},
        "in_main_study": True,
    }


def _frictions(scene: Scene, source: str) -> list[float]:
    own, key = scene.friction.coefficient, "friction.ball_race"
    if own <= 0.0:
        raise SceneError(key, f"got {own:g}, expected a number > 0 for a study", source=source)
    part = key_of_scene(key)
    assert part is not None
    around = {round(factor * own, 3) for factor in FRICTIONS}
    return sorted({own, *(mu for mu in around if 0.0 < mu <= part.key.ends[1])})


def _losses(scene: Scene) -> list[float]:
    """States of wear, from new to the end of the scene's own life [um].

    Where one of the methods has no solution so far worn, to the sooner of the ends of their lives.
    """
    from bearingwear.scene.arrangement import held_by
    from bearingwear.solvers.compose import solver_of
    from bearingwear.studies.design.map import life_point

    operation = scene.operation
    ends, states = {}, []
    for method in PRELOAD_METHODS:
        one = held_by(scene, method)
        ends[method] = 1e6 * life_point(one, None).get("loss_at_end", 0.0)
        states.append(solver_of(one))
    last = math.ceil(100.0 * (ends[operation.preload_method] or max(ends.values()))) / 100.0
    if any(_status_at(one, 1e-6 * last) != OK for one in states):
        last = math.floor(100.0 * min((end for end in ends.values() if end), default=0.0)) / 100.0
    return sorted({round(last * k / STATES_OF_WEAR, 2) for k in range(STATES_OF_WEAR + 1)})


def _status_at(solver: Remembered, loss: float) -> int:
    """Of the bearings, all at a loss of ball diameter [m]."""
    worn = (one._replace(loss=loss) for one in solver.bearings.start)
    return next((state.status for state in solver((*worn,)) if state.status != OK), OK)


def write_study(file: Path, folder: Path, limits: DesignLimits) -> None:
    """Write the configuration of a study of a scene, and the scene, into a folder.

    folder: new, empty, or of an earlier call for this scene.
    """
    from bearingwear.scene.checking.strict_yaml import text_of
    from bearingwear.scene.read import scene_files

    name = file.stem
    if not re.match(NAME, name):
        raise UsageError(f"{file}: got the name {name}, expected {NAME_RULE}")
    plans = plan_of(life_scene(file, films=True), name, limits, os.fspath(file))
    bodies = {
        path: yaml.safe_dump(plan, sort_keys=False, default_flow_style=None)
        for path, plan in plans.items()
    }
    for path in map(Path, scene_files(file)):
        bodies[f"config/scenes/{path.name}"] = text_of(path)
    head = f"# Written by `bearingwear study {file.name}`"
    _check_folder(folder, head)
    texts = {
        folder / path: f"{head} ({_hash(body)}). Edit {file.name} and run that command again, or "
        f"edit this file and run `bearingwear study` here.\n{body}"
        for path, body in bodies.items()
    }
    for path in texts:
        _check_unedited(path, head, folder)
    for path, text in texts.items():
        if _text(path) != text:
            write_text(path, text)


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def _check_folder(folder: Path, head: str) -> None:
    """Refuse a folder that holds anything else."""
    try:
        if folder.exists() and any(path.name != ".snakemake" for path in folder.iterdir()):
            config = folder / "config" / "config.yaml"
            if not (_text(config) or "").startswith(head):
                what = head.removeprefix("# Written by ")
                raise UsageError(
                    f"{folder}: got a folder with other files, expected a new folder, or one "
                    f"written by {what}"
                )
    except OSError as error:
        raise UsageError(f"{folder}: cannot be used ({reason(error)})") from None


def _check_unedited(path: Path, head: str, folder: Path) -> None:
    """Refuse to replace what somebody edited."""
    text = _text(path)
    if text is not None:
        first, _, rest = text.partition("\n")
        if not first.startswith(head) or _hash(rest) not in first:
            raise UsageError(
                f"{path}: got an edited file, expected an unchanged file, or none (to run the "
                f"edited study, use `bearingwear study` in {folder})"
            )


def _text(path: Path) -> str | None:
    """What a file holds, if it is there."""
    return path.read_bytes().decode("utf-8", "replace") if path.is_file() else None
