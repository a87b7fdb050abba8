"""Wear life over a study, by two routes: the solver in the loop, and interpolation of the study.

Both integrate d(loss)/dt = rate(loss) to the first end-of-life criterion. The first route solves
the contact at every step and bounds its own error. The second interpolates rates and criteria
between the cases of the study: it requires no solve, and its error is that of the grid, which the
first route measures. Over a duty, it requires the cases of the other conditions of a cycle at the
same losses, which are solved here.
"""

import json
from collections.abc import Collection
from pathlib import Path

import xarray as xr

from bearingwear.lives.duty.lives import cycle_with_enough_points
from bearingwear.results.labels import coded
from bearingwear.results.netcdf import load
from bearingwear.results.words import datasets_by_bearing, plain_scene
from bearingwear.scene.arrangement import bearings_holding
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.cases import NOMINAL
from bearingwear.scene.read import load_scene, variant
from bearingwear.scene.scene import PRELOAD_METHODS, Scene
from bearingwear.sides import OF_ARRANGEMENT
from bearingwear.studies.axis import GRID_KEYS
from bearingwear.studies.dataset import stacked_dataset
from bearingwear.studies.grid.gather import axis_coordinates
from bearingwear.studies.grid.grid import Grid
from bearingwear.studies.grid.interpolated import (
    NOT_INTERPOLATED,
    Line,
    interpolable_criteria,
    interpolated_life,
)
from bearingwear.studies.sweep import Sweep
from bearingwear.studies.sweep_dataset import KEEP_STUDY


def study_life(scene: Path, study: Path) -> xr.Dataset:
    """Step: returns the wear life for each preload method and friction of the study in a file.

    scene: file of the scene of the study.
    """
    return wear_life(scene, load(study))


def wear_life(scene_path: str | Path, study: xr.Dataset) -> xr.Dataset:
    """Returns the wear life for each preload method and friction coefficient of a study.

    scene_path: file of the scene of the study; its lives start from new.
    study: cases of `gathered_study`.

    Returns: the variables of a life file over `preload_method` and `friction`, those of
        `interpolated_life`, and `life_route_difference`: the interpolated life over that by the
        solver, less 1, NaN where they cannot be compared. Attributes are those of the study.
    """
    grid = Grid.from_lists(
        [PRELOAD_METHODS[int(flag)] for flag in study["preload_method"]],
        study["friction"].values.tolist(),
        study["ball_diameter_loss"].values.tolist(),
    )
    base = variant(scene_path, {GRID_KEYS["ball_diameter_loss"]: 0.0})
    axes = {GRID_KEYS[name]: getattr(grid, name) for name in ("preload_method", "friction")}
    computed = Sweep.of(base, axes, "life").dataset(workers=1, progress=False)
    interpolated, not_interpolated = _interpolated_lives(base, grid, study)
    coords = axis_coordinates(grid)
    del coords["ball_diameter_loss"]
    lives = coded(computed).drop_attrs(deep=False).assign_coords(coords)
    lives = lives.merge(interpolated.assign_coords(coords))
    lives["life_route_difference"] = _route_difference(lives, not_interpolated)
    # cases do not depend on the uncertain values, which may have changed since the study
    study_scene = plain_scene(study)
    scene_data = load_scene(scene_path).to_dict()
    for key in ("uncertainty", "cage_uncertainty"):
        if key in study_scene:
            study_scene[key] = scene_data.get(key)
    return lives.assign_attrs(
        study.attrs
        | {
            "scene": json.dumps(study_scene),
            "title": f"Wear life of {study_scene['name']}",
            "history": "computed, and interpolated from the study, by bearingwear study",
            NOT_INTERPOLATED: json.dumps(sorted(not_interpolated)),
            "warnings": computed.attrs["warnings"],
            "comment": "life and history_* were computed with the solver in the loop; "
            "interpolated_* were interpolated between the cases in the study.",
        }
    )


def _interpolated_lives(base: Scene, grid: Grid, study: xr.Dataset) -> tuple[xr.Dataset, set[str]]:
    """Returns interpolated lives over `preload_method` and `friction`, and names of criteria.

    These criteria end no interpolated life, because the cases of the study do not contain them.

    base: scene of the study, without wear.
    """
    lives = []
    not_interpolated: set[str] = set()
    for i, method in enumerate(grid.preload_method):
        for j, friction in enumerate(grid.friction):
            scene = base.with_(
                {GRID_KEYS["preload_method"]: method, GRID_KEYS["friction"]: friction}
            )
            criteria = scene.wear.end_of_life.criteria if scene.wear.end_of_life else {}
            line = study.isel(preload_method=i, friction=j, drop=True)
            line = _with_arrangement_stiffness(line, scene.operation.preload_method)
            not_interpolated |= criteria.keys() - interpolable_criteria(criteria, line).keys()
            lives.append(interpolated_life(_lines(line, scene), criteria))
    lengths = {"preload_method": len(grid.preload_method), "friction": len(grid.friction)}
    return stacked_dataset(lives, lengths), not_interpolated


def _route_difference(lives: xr.Dataset, not_interpolated: Collection[str]) -> xr.DataArray:
    """Returns the interpolated lives over those by the solver, less 1; NaN if not comparable.

    not_interpolated: names of the criteria that the cases of the study do not contain.
    """
    difference = lives["interpolated_life"] / lives["life"] - 1.0
    return difference.where(_is_comparable(lives, not_interpolated)).assign_attrs(
        long_name="relative difference between the life interpolated from the study and the life "
        "computed with the solver in the loop",
        units="1",
        comment="only if both lives were computed with the same grooves and in the same condition, "
        "and the cases contain the end-of-life criterion",
    )


def _with_arrangement_stiffness(line: xr.Dataset, preload_method: str) -> xr.Dataset:
    """Returns cases with the stiffness of the arrangement, if they are of a single bearing.

    It is the stiffness of one bearing times the number of those that hold the rotor axially: 1 with
    a spring, 2 if rigid.

    line: cases of a bearing.
    """
    bearings = bearings_holding(preload_method)
    return line.assign(
        {
            of_arrangement: bearings * line[of_bearing]
            for of_arrangement, of_bearing in OF_ARRANGEMENT.items()
            if of_arrangement not in line and of_bearing in line
        }
    )


def _lines(line: xr.Dataset, scene: Scene) -> list[Line]:
    """Returns the cases between which a life is interpolated, of each condition of a duty if any.

    Two bearings that differ wear at different rates: then only their first case is returned, which
    gives no life.

    line: cases of the scene over `ball_diameter_loss`.
    """
    bearing, cases = next(iter(datasets_by_bearing(line).items()))
    first_case = [Line(cases.isel(ball_diameter_loss=slice(1)), scene.operation.preload_N)]
    if bearing is not None:
        return first_case
    if scene.duty is None:
        return [Line(cases, scene.operation.preload_N)]
    cycle = cycle_with_enough_points(scene)
    if cycle.bearings > 1:
        return first_case
    losses = line["ball_diameter_loss"]
    lines = []
    for k, (condition, share) in enumerate(zip(cycle.scenes, cycle.shares.tolist(), strict=True)):
        # after the conditions of the phases: those on the way to a speed, which end no life
        if k >= len(cycle.cases):
            lines.append(Line(_cases_at(losses, condition), None, share))
            continue
        phase = scene.in_cases[cycle.cases[k]]
        phase_cases = cases if cycle.cases[k] == NOMINAL else _cases_at(losses, phase)
        lines.append(Line(phase_cases, phase.operation.preload_N, share))
    return lines


def _cases_at(losses: xr.DataArray, scene: Scene) -> xr.Dataset:
    """Solves a scene at losses [um] and returns the cases of its bearing.

    The scene has a single bearing, or a pair whose bearings have equal values.
    """
    key = GRID_KEYS["ball_diameter_loss"]
    cases_over_loss = Sweep.of(scene, {key: losses.values.tolist()}, keep=KEEP_STUDY)
    solved = coded(cases_over_loss.dataset(workers=1, progress=False))
    (cases,) = datasets_by_bearing(solved.assign_coords(ball_diameter_loss=losses)).values()
    return _with_arrangement_stiffness(cases, scene.operation.preload_method)


def _is_comparable(lives: xr.Dataset, not_interpolated: Collection[str]) -> xr.DataArray:
    """Returns whether each life by the solver could be interpolated between the cases.

    A life with worn grooves could not, as the cases have Hertzian ones. Nor could a life that ends
    by a criterion that the cases do not contain.

    not_interpolated: names of the criteria that the cases do not contain.
    """
    comparable = ~lives["end_criterion"].isin([CRITERIA.index(name) for name in not_interpolated])
    if "history_approach_loss" in lives:  # only lives with worn grooves have it
        has_worn_state = lives["history_approach_loss"].notnull()
        inner_dims = [dim for dim in has_worn_state.dims if dim not in comparable.dims]
        comparable &= ~has_worn_state.any(inner_dims)
    return comparable
