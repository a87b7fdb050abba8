"""Wear life over a study, by two routes: the solver in the loop, and interpolation of the study.

Both integrate d(loss)/dt = rate(loss) to the first end-of-life criterion. The first solves the
contact anew at every step and bounds its own error. The second reads rates and criteria off the
study's grid: it needs no solve, and its error is that of the grid, which the first measures.
"""

import json
from collections.abc import Collection
from pathlib import Path

import xarray as xr

from bearingwear.lives.life import life
from bearingwear.results.netcdf import dataset, load
from bearingwear.results.warnings import merged_warnings
from bearingwear.results.words import datasets_by_bearing
from bearingwear.scene.arrangement import bearings_holding
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.read import load_scene, variant
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.sides import OF_ARRANGEMENT
from bearingwear.studies.dataset import stacked
from bearingwear.studies.grid.gather import axis_coordinates
from bearingwear.studies.grid.grid import Case, Grid
from bearingwear.studies.grid.interpolated import NOT_INTERPOLATED, interpolated_life, known_of


def study_life(scene: Path, study: Path) -> xr.Dataset:
    """Step: the wear life over the study in a file."""
    return wear_life(scene, load(study))


def wear_life(scene_path: str | Path, study: xr.Dataset) -> xr.Dataset:
    """Wear life for each preload method and friction coefficient of a study.

    Returns: the variables of a life file over `preload_method` and `friction`, those of
        `interpolated_life`, and `life_route_difference`, the second route against the first.
    """
    grid = Grid.from_lists(
        [PRELOAD_METHODS[int(flag)] for flag in study["preload_method"]],
        study["friction"].values.tolist(),
        study["ball_diameter_loss"].values.tolist(),
    )
    solved, interpolated = [], []
    unknown: set[str] = set()
    for i, method in enumerate(grid.preload_method):
        for j, friction in enumerate(grid.friction):
            scene = variant(scene_path, Case(method, friction, 0.0).changes)
            solved.append(dataset(life(scene)))
            criteria = scene.wear.end_of_life.criteria if scene.wear.end_of_life else {}
            line = study.isel(preload_method=i, friction=j, drop=True)
            for system, own in OF_ARRANGEMENT.items():
                if system not in line and own in line:
                    holding = bearings_holding(scene.operation.preload_method)
                    line[system] = holding * line[own]
            unknown |= criteria.keys() - known_of(criteria, line).keys()
            which, one = next(iter(datasets_by_bearing(line).items()))
            if which is not None:  # of two that differ, each wears at a rate of its own
                one = one.isel(ball_diameter_loss=slice(1))
            interpolated.append(interpolated_life(one, criteria, scene.operation.preload_N))
    coords = axis_coordinates(grid)
    del coords["ball_diameter_loss"]
    lengths = {name: len(values) for name, (_, values, _) in coords.items()}
    whole = stacked(solved, lengths).assign_coords(coords)
    whole = whole.merge(stacked(interpolated, lengths).assign_coords(coords))
    difference = whole["interpolated_life"] / whole["life"] - 1.0
    whole["life_route_difference"] = difference.where(_comparable(whole, unknown)).assign_attrs(
        long_name="relative difference between the life interpolated from the study and the life "
        "computed with the solver in the loop",
        units="1",
        comment="only if both lives were computed with the same grooves and in the same condition, "
        "and the cases contain the end-of-life criterion",
    )
    # the cases do not read the uncertain values, which are quoted with lives
    shared, now = json.loads(study.attrs["scene"]), load_scene(scene_path).to_dict()
    for key in [key for key in shared if key in ("uncertainty", "cage_uncertainty")]:
        shared[key] = now.get(key)
    return whole.assign_attrs(
        study.attrs
        | {
            "scene": json.dumps(shared),
            "title": f"Wear life of {shared['name']}",
            "history": "computed, and interpolated from the study, by bearingwear study",
            NOT_INTERPOLATED: json.dumps(sorted(unknown)),
            "warnings": merged_warnings(each.attrs for each in solved),
            "comment": "life and history_* were computed with the solver in the loop; "
            "interpolated_* were interpolated between the cases in the study.",
        }
    )


def _comparable(lives: xr.Dataset, unknown: Collection[str]) -> xr.DataArray:
    """Which lives in the loop end as one between cases could: of Hertzian grooves, by what they
    hold, and not over a duty, as the cases are those of the nominal condition.
    """
    if "phase_time_share" in lives:
        return xr.zeros_like(lives["end_criterion"], dtype=bool)
    found = ~lives["end_criterion"].isin([CRITERIA.index(name) for name in unknown])
    if "history_approach_loss" in lives:  # the grooves were followed
        followed = lives["history_approach_loss"].notnull()
        found &= ~followed.any([dim for dim in followed.dims if dim not in found.dims])
    return found
