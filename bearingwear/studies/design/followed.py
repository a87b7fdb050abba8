"""Points of a design map with grooves that are followed as they wear, where a life follows them.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK
from bearingwear.model.life_integrator import LifeHistory
from bearingwear.model.worn_courses import first_met, worn_history
from bearingwear.model.worn_outputs import grooves_followed
from bearingwear.results.netcdf import data_array
from bearingwear.results.variable import HOURS_PER_SECOND, Variable
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.scene import PRELOAD_METHODS, EndOfLife, Scene
from bearingwear.studies.dataset import LOSS_BASIS
from bearingwear.studies.design.map import SLIP_SHARE, gone_through, life_point, point_variables
from bearingwear.studies.pool import Tell, in_processes, told_in_lines

GROOVE_SHAPES = ("hertzian", "worn")
HERTZIAN_GROOVE, WORN_GROOVE = range(len(GROOVE_SHAPES))
GROOVE = Variable(
    "groove",
    (),
    "",
    "groove of the life and of the states along it",
    dtype="i1",
    flags=GROOVE_SHAPES,
    comment="worn: followed as it wears, where the life of the scene follows it",
)
HERTZIAN_LIFE = Variable(
    "hertzian_life",
    LOSS_BASIS.dims,
    "h",
    "wear life at the same preload with grooves that keep their shape",
    scale=HOURS_PER_SECOND,
)
FOLLOWED = "followed_"
"""Prefix of the variables of a line of preloads with grooves as they wear."""

FOLLOWED_PRELOADS = f"{FOLLOWED}preload"


def followed_point(scene: Scene, slip_limit: float | None, quick: bool = True) -> dict[str, Any]:
    """`life_point` of the groove that `life` would follow, and the life with the Hertzian one.

    Where races do not count, they do not wear: that life is the same with both.

    Parameters
    ----------
    scene, slip_limit
        As of `life_point`.
    quick : bool
        Whether worn grooves have the cells and steps of a quick life.
    """
    found = life_point(scene, slip_limit)
    hertzian = found.get("life", np.full(2, np.nan))
    found |= {"groove": HERTZIAN_GROOVE, "hertzian_life": hertzian}
    if hertzian[1] == 0.0:
        return found  # beyond a limit when new, whatever the groove
    history = worn_history(scene, quick)
    if history is None:
        return found
    kept = {"hertzian_life": hertzian, "groove": WORN_GROOVE, "status": history.status}
    kept |= {"end_criterion": history.criterion, "solves": found["solves"] + history.solves}
    kept["failed_solves"] = found["failed_solves"]
    if history.status != OK:
        return kept
    kept["life"] = np.array([hertzian[0], history.times[-1][1]])
    kept |= gone_through(scene, history.states)
    if slip_limit is not None:
        kept["time_to_slip_limit"] = _times_to_share(history, slip_limit, found, kept[SLIP_SHARE])
    return kept


def _times_to_share(
    history: LifeHistory, limit: float, hertzian: Mapping[str, Any], largest: float
) -> np.ndarray:
    """When the share of a life with worn grooves reaches a limit, by both ways of counting [s]."""
    ball = hertzian.get("time_to_slip_limit", np.full(2, np.nan))[0]
    share = EndOfLife(gyroscopic_slip_share=limit)
    return np.array([ball, first_met(history, share, 1.0) if largest >= limit else np.inf])


def followed_lines(
    scene: Scene,
    at_scene: xr.Dataset,
    slip_limit: float | None,
    workers: int = 1,
    tell: Tell | None = None,
) -> xr.Dataset:
    """The lines of a map over preload, with the groove that the scene's life would follow.

    Parameters
    ----------
    scene : Scene
    at_scene : Dataset
        The map over `preload_method` and `preload`, of Hertzian grooves.
    slip_limit : float, optional
    workers : int
        Processes that share the points.
    tell : callable, optional
        Given one line of text every few seconds.

    Returns
    -------
    Dataset
        `at_scene` itself, where no life follows a groove.
    """
    methods = [PRELOAD_METHODS[int(flag)] for flag in at_scene["preload_method"].values]
    preloads = at_scene["preload"].values.tolist()
    scenes = [held_by(scene, method, preload) for method in methods for preload in preloads]
    solve = partial(followed_point, slip_limit=slip_limit)
    if not any(grooves_followed(one, "steady")[0] for one in scenes):
        return at_scene
    solved = in_processes(solve, scenes, workers, "recommend")
    if tell is not None:
        what = "{} of {} lives with grooves as they wear"
        solved = told_in_lines(solved, len(scenes), what, tell=tell)
    points = list(solved)
    if all(point["groove"] == HERTZIAN_GROOVE for point in points):
        return at_scene
    sizes = {"preload_method": len(methods), "preload": len(preloads)}
    return xr.Dataset(with_grooves(points, sizes), at_scene.coords)


def with_grooves(
    points: Sequence[Mapping[str, Any]], sizes: Mapping[str, int]
) -> dict[str, xr.DataArray]:
    """`point_variables` of what `followed_point` gives."""
    variables = point_variables(points, sizes)
    for variable in (GROOVE, HERTZIAN_LIFE):
        missing = 0 if variable is GROOVE else np.full(2, np.nan)
        values = np.array([point.get(variable.name, missing) for point in points])
        shape = (*sizes.values(), *values.shape[1:])
        variables[variable.name] = data_array(variable, values.reshape(shape), tuple(sizes))
    return variables


def as_followed(lines: xr.Dataset) -> dict[str, xr.Variable]:
    """Variables of `followed_lines` under names of their own, for a file with a recommendation."""
    own = lines.drop_vars("solves").rename({"preload": FOLLOWED_PRELOADS})
    renamed = {f"{FOLLOWED}{name}": own[name].variable for name in own.data_vars}
    return renamed | {FOLLOWED_PRELOADS: own[FOLLOWED_PRELOADS].variable}


def lines_followed(recommendation: xr.Dataset) -> xr.Dataset | None:
    """The lines with grooves as they wear in a file with a recommendation, if it has any."""
    if FOLLOWED_PRELOADS not in recommendation.coords:
        return None
    names = {
        name: str(name).removeprefix(FOLLOWED)
        for name in recommendation.variables
        if str(name).startswith(FOLLOWED)
    }
    return recommendation[list(names)].rename(names)
