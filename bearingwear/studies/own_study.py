"""The study of one scene: `bearingwear study mine.yaml` writes its configuration into a folder.

The first line of each file names that command and holds a hash of the rest, so that an edited file
is never replaced.
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
from bearingwear.scene.duty import phase_cases
from bearingwear.scene.friction import friction_changes_with_wear
from bearingwear.scene.scene import PRELOAD_METHODS, Scene, key_of_scene
from bearingwear.studies.design.plan import NO_FRICTION, DesignLimits, axes_around
from bearingwear.studies.sampling import SAMPLES
from bearingwear.studies.solve import life_scene

if TYPE_CHECKING:
    from bearingwear.solvers.compose import Remembered

FRICTIONS = (0.5, 1.0, 1.5, 2.0)
"""Friction coefficients of the grid, relative to the scene's; over a duty, the scene's alone."""

STATES_OF_WEAR = 8
"""Number of steps of the grid from new to the end of the scene's life."""

LANDS = (0.5, 1.0)
"""Clearances of the cage at its land, relative to the scene's."""

CAGE_FRICTIONS = (0.5, 1.0, 1.5)
"""Friction coefficients of the cage, relative to the scene's."""

LEAST_SAMPLES = 16
"""Bearings sampled: the fewest that workflow/schemas/config.schema.yaml allows."""

CAGE_RUNS = 20
"""Runs of each cage: the fewest that workflow/schemas/cage.schema.yaml allows."""


def study_files(scene: Scene, name: str, limits: DesignLimits, source: str) -> dict[str, Any]:
    """Returns the configuration files of a study of a scene, as plain data by their paths.

    A scene with films or running-in has no grid of cases. A single bearing with a film of its cage
    or a `cage_uncertainty` has a map of cages, too.

    name: of the scene's file in the study, without suffix.
    limits: requirements on the recommended preload.
    source: file of the scene, for errors.
    SceneError: limits that are not possible for the scene, or a friction or a preload of 0, around
    which no grid is possible.
    """
    limits.check(scene, source)
    changes_with_depth = scene.friction.film is not None or friction_changes_with_wear(scene)
    frictions = [NO_FRICTION] if scene.friction.film else _grid_frictions(scene, source)
    axes = axes_around(scene, frictions, source)  # refuses a preload of 0, which has no shares
    config: dict[str, Any] = {"studies": [], "unsolved": "warning"}
    if not changes_with_depth:
        config = _grid_configuration(scene, name, frictions)
        if scene.uncertainty:
            config["uncertain_lives"] = {"scenes": [name], "samples": _sample_size(scene)}
    small_map = {axis: list(values) for axis, values in vars(axes).items()}
    design = {"scenes": {name: {"small_map": small_map, "limits": limits.stored}}}
    files = {"config/config.yaml": config, "config/design.yaml": design}
    if scene.pair is None and scene.cage is not None:
        if scene.cage.film is not None or scene.cage_uncertainty is not None:
            files["config/cage.yaml"] = _cage_configuration(scene, name)
    return files


def _grid_configuration(scene: Scene, name: str, frictions: Sequence[float]) -> dict[str, Any]:
    """Returns the data of config.yaml for cases over friction and wear.

    frictions: coefficients of the grid.
    """
    losses = _grid_losses(scene)
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


def _sample_size(scene: Scene) -> int:
    """Returns the number of bearings sampled, a power of two: fewer over a duty of several cases.

    A life over a duty costs about as much as a life in each of its cases. The quantiles then have
    wider intervals, which the study states.
    """
    cases = len(phase_cases(scene)) if scene.duty else 1
    halvings = math.ceil(math.log2(cases))
    return max(SAMPLES // 2**halvings, LEAST_SAMPLES)


def _cage_configuration(scene: Scene, name: str) -> dict[str, Any]:
    """Returns the data of cage.yaml for a map of cages around that of the scene.

    A cage on the balls has no land, so its clearance there does not vary. Frictions are rounded to
    three digits, and at most 1.
    """
    cage = scene.cage
    assert cage is not None
    factors = (1.0,) if cage.guiding_race == "ball" else LANDS
    clearances = {cage.guide_clearance_mm * factor for factor in factors}
    frictions = {
        float(f"{min(factor * scene.friction.cage, 1.0):.3g}") for factor in CAGE_FRICTIONS
    }
    return {
        "scene": name,
        "gravity_m_s2": [math.hypot(*scene.operation.gravity_m_s2[1:])],
        "guiding_race": [cage.guiding_race],
        "imbalance_um": [cage.imbalance_um],
        "pocket_clearance_mm": [cage.pocket_clearance_mm],
        "guide_clearance_mm": sorted(clearances),
        "cage_friction": sorted(frictions),
        "ensemble": {"runs": CAGE_RUNS},
        "in_main_study": True,
    }


def _grid_frictions(scene: Scene, source: str) -> list[float]:
    """Returns the friction coefficients of the grid, rising, among which is that of the scene.

    The others are rounded to three decimals, and left out beyond the largest that a scene allows.
    Over a duty, that of the scene is the only one: phases may have friction of their own, and each
    life costs as much as one in each phase.

    source: file of the scene, for errors.
    SceneError: the scene has no friction.
    """
    coefficient = scene.friction.coefficient
    key = "friction.ball_race"
    if coefficient <= 0.0:
        raise SceneError(
            key, f"got {coefficient:g}, expected a number > 0 for a study", source=source
        )
    if scene.duty is not None:
        return [coefficient]
    field = key_of_scene(key)
    assert field is not None
    _, largest = field.key.ends
    coefficients = {round(factor * coefficient, 3) for factor in FRICTIONS}
    return sorted({coefficient, *(mu for mu in coefficients if 0.0 < mu <= largest)})


def _grid_losses(scene: Scene) -> list[float]:
    """Returns losses of ball diameter [um], rising evenly from 0 to the end of the scene's life.

    They have two decimals. If the life with the scene's own preload method is not solved, the other
    method decides the last loss. If a preload method has no state there, the last loss is the
    smaller of those at the two ends of life. Without any life, the list is [0.0].
    """
    from bearingwear.scene.arrangement import with_method
    from bearingwear.solvers.compose import solver_of
    from bearingwear.studies.design.map import life_point

    end_losses = {}  # um; 0 where a life was not solved
    solvers = []
    for method in PRELOAD_METHODS:
        method_scene = with_method(scene, method)
        end_losses[method] = 1e6 * life_point(method_scene, None).get("loss_at_end", 0.0)
        solvers.append(solver_of(method_scene))
    end_loss = end_losses[scene.operation.preload_method] or max(end_losses.values())
    last_loss = math.ceil(100.0 * end_loss) / 100.0  # names of files have two decimals
    if any(_status_at_loss(solver, 1e-6 * last_loss) != OK for solver in solvers):
        sooner_end = min((loss for loss in end_losses.values() if loss), default=0.0)
        last_loss = math.floor(100.0 * sooner_end) / 100.0
    return sorted({round(last_loss * k / STATES_OF_WEAR, 2) for k in range(STATES_OF_WEAR + 1)})


def _status_at_loss(solver: Remembered, loss: float) -> int:
    """Returns OK, or the first other status of the bearings, at a loss of ball diameter [m].

    solver: of a bearing or a pair. All its bearings have the loss.
    """
    worn_bearings = tuple(bearing._replace(loss=loss) for bearing in solver.bearings.start)
    statuses = [state.status for state in solver(worn_bearings)]
    return next((status for status in statuses if status != OK), OK)


def write_study(file: Path, folder: Path, limits: DesignLimits) -> str:
    """Writes the configuration of a study of a scene, and the scene, into a folder.

    Files that would not change are not written. Nothing is written if anything is refused.

    file: of the scene.
    folder: new, empty, or of an earlier call for this scene.
    limits: requirements on the recommended preload.
    UsageError: a folder with other files, an edited file, or a name of the scene that is not
        allowed.
    SceneError: as of `study_files`, or a scene that is not valid or has no life.

    Returns the `requirements_in_words` of the earlier call; "" without one.
    """
    from bearingwear.scene.checking.strict_yaml import text_of
    from bearingwear.scene.read import scene_files

    name = file.stem
    if not re.match(NAME, name):
        raise UsageError(f"{file}: got the name {name}, expected {NAME_RULE}")
    heading = f"# Written by `bearingwear study {file.name}`"
    _check_folder(folder, heading)
    configurations = study_files(life_scene(file, films=True), name, limits, os.fspath(file))
    bodies = {
        path: yaml.safe_dump(data, sort_keys=False, default_flow_style=None)
        for path, data in configurations.items()
    }
    for path in map(Path, scene_files(file)):
        bodies[f"config/scenes/{path.name}"] = text_of(path)
    advice = (
        f"Edit {file.name} and run that command again, or edit this file and run "
        "`bearingwear study` here."
    )
    texts = {
        folder / path: f"{heading} ({_hash(body)}). {advice}\n{body}"
        for path, body in bodies.items()
    }
    for path in texts:
        _check_unedited(path, heading, folder)
    earlier = requirements_in_words(folder, name)
    for path, text in texts.items():
        if _file_text(path) != text:
            write_text(path, text)
    return earlier


def requirements_in_words(folder: Path, name: str) -> str:
    """Returns the requirements of the study in a folder, as its configuration has them.

    They are `none` without any, and "" where the folder has no study of that scene.
    """
    design = yaml.safe_load(_file_text(folder / "config" / "design.yaml") or "") or {}
    scene = design.get("scenes", {}).get(name)
    if scene is None:
        return ""
    limits = scene.get("limits") or {}
    return ", ".join(f"{key} {value:g}" for key, value in limits.items()) or "none"


def _hash(text: str) -> str:
    """Returns the start of a SHA-256 hash, by which edited files are recognised."""
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def _check_folder(folder: Path, heading: str) -> None:
    """Raises a UsageError for a folder with other files than those of a study of this scene.

    What Snakemake keeps in `.snakemake` does not count.

    heading: begins the first line of the files of that study.
    """
    try:
        has_files = folder.exists() and any(path.name != ".snakemake" for path in folder.iterdir())
        config_text = _file_text(folder / "config" / "config.yaml") or ""
    except OSError as error:
        raise UsageError(f"{folder}: cannot be used ({reason(error)})") from None
    if has_files and not config_text.startswith(heading):
        command = heading.removeprefix("# Written by ")
        raise UsageError(
            f"{folder}: got a folder with other files, expected a new folder, or one "
            f"written by {command}"
        )


def _check_unedited(path: Path, heading: str, folder: Path) -> None:
    """Raises a UsageError for a file that this program did not write, or that was edited since.

    heading: begins the first line of a file that was written, which also holds a hash of the rest.
    folder: of the study, for the error.
    """
    text = _file_text(path)
    if text is not None:
        first_line, _, body = text.partition("\n")
        if not first_line.startswith(heading) or _hash(body) not in first_line:
            raise UsageError(
                f"{path}: got an edited file, expected an unchanged file, or none (to run the "
                f"edited study, use `bearingwear study` in {folder})"
            )


def _file_text(path: Path) -> str | None:
    """Returns the contents of a file; None if it does not exist.

    Bytes that are not UTF-8 are replaced, so that an edited file can be compared, too.
    """
    return path.read_bytes().decode("utf-8", "replace") if path.is_file() else None
