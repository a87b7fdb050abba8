"""Whether one preload method can be said to last longer, and how far that holds, as data.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from bearingwear.results.netcdf import data_array
from bearingwear.results.variable import HOURS_PER_SECOND, Variable, table
from bearingwear.scene.blocks import BALL_TRACKS
from bearingwear.studies.dataset import coordinate
from bearingwear.studies.design.room import Room, longer

CLAIMED = 0.05
"""A choice that reverses within this move of one assumption is not claimed."""

VERDICTS = ("nothing_to_compare", "longer", "neither")
NO_COMPARISON, ONE_LONGER, NEITHER_LONGER = range(len(VERDICTS))

_COLUMNS = ("holds_from", "assumed", "holds_to")

HELD = table(
    Variable("assumed", ("assumption",), "", "value of an assumption, in the unit of its key"),
    Variable("holds_from", ("assumption",), "", "least value with the same method as the better"),
    Variable("holds_to", ("assumption",), "", "largest value with the same method as the better"),
    Variable(
        "life_by_ball_track",
        ("preload_method", "ball_track"),
        "h",
        "wear life at the recommended preload, by what is assumed of the track of a ball",
        scale=HOURS_PER_SECOND,
    ),
    Variable(
        "verdict",
        (),
        "",
        "whether one method can be said to last longer than the other",
        dtype="i1",
        flags=VERDICTS,
        comment="neither: a change of 5 % in one assumption, or the other ball track, reverses the "
        "order, or the lives differ by less than their numerical errors",
    ),
)
"""How far a choice holds; `holds_from`, `holds_to`: NaN where it holds over all searched."""


def verdict_on(
    lives: Sequence[float], errors: Sequence[float], room: Room, tracks: np.ndarray
) -> int:
    """Index into `VERDICTS`: whether one of two methods can be said to last longer.

    Parameters
    ----------
    lives, errors : sequence of float
        Life and its relative numerical error of each method.
    room : Room
    tracks : ndarray
        As `lives_by_track`.
    """
    better = longer(lives) if len(lives) == 2 else None
    if better is None:
        return NO_COMPARISON
    told = lives[better] * (1.0 - np.nansum(errors)) > lives[1 - better]
    same_track = all(longer(lives) in (None, better) for lives in tracks.T.tolist())
    turned = any(turns(*held) for held in room.values())
    return ONE_LONGER if told and same_track and not turned else NEITHER_LONGER


def turns(low: float, now: float, high: float) -> bool:
    """Whether a move of `CLAIMED` reverses a choice that holds between two values."""
    return low > (1.0 - CLAIMED) * now or high < (1.0 + CLAIMED) * now


def held(room: Room, tracks: np.ndarray, said: int) -> xr.Dataset:
    """How far a choice holds, as variables of a file over `assumption` and `ball_track`."""
    columns = np.array(list(room.values())).reshape(-1, len(_COLUMNS))
    values = dict(zip(_COLUMNS, columns.T, strict=True))
    values |= {"life_by_ball_track": tracks, "verdict": np.array(said)}
    names = Variable(
        "assumption", ("assumption",), "", "what was assumed", dtype="i1", flags=tuple(room)
    )
    track = Variable(
        "ball_track", ("ball_track",), "", "track of a ball", dtype="i1", flags=BALL_TRACKS
    )
    arrays = {name: data_array(variable, values[name]) for name, variable in HELD.items()}
    return xr.Dataset(arrays, {**coordinate(names), **coordinate(track)})
