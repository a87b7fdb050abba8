"""Whether one preload method is preferred, and how far that holds, as data.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from bearingwear.results.variable import HOURS_PER_SECOND, Variable, table
from bearingwear.scene.blocks import BALL_TRACKS
from bearingwear.studies.dataset import filled
from bearingwear.studies.design.room import Assumption, longer

CLAIMED = 0.05
"""A choice that reverses within this move of one assumption is not claimed."""

VERDICTS = ("nothing_to_compare", "longer", "neither")
NO_COMPARISON, ONE_LONGER, NEITHER_LONGER = range(len(VERDICTS))

HELD = table(
    Variable("assumed", ("assumption",), "", "value of an assumption, in the unit of its key"),
    Variable("holds_from", ("assumption",), "", "least value with the same method as the better"),
    Variable("holds_to", ("assumption",), "", "largest value with the same method as the better"),
    Variable("life_by_ball_track", ("preload_method", "ball_track"), "h",
        "wear life at the recommended preload, by what is assumed of the track of a ball",
        scale=HOURS_PER_SECOND),
    Variable("verdict", (), "", "whether one method is preferred to the other", dtype="i1",
        flags=VERDICTS,
        comment="neither: a change of 5 % in one assumption, or the other ball track, reverses the "
        "order, or the lives differ by less than their numerical errors"),
)  # fmt: skip
"""How far a choice holds; `holds_from`, `holds_to`: NaN where it holds over all searched."""


def verdict_on(
    lives: Sequence[float], errors: Sequence[float], room: Sequence[Assumption], tracks: np.ndarray
) -> int:
    """Index into `VERDICTS`: whether one of two methods is preferred.

    lives, errors: life and its relative numerical error of each method.
    tracks: as `lives_by_track`.
    """
    better = longer(lives) if len(lives) == 2 else None
    if better is None:
        return NO_COMPARISON
    beyond_errors = lives[better] * (1.0 - np.nansum(errors)) > lives[1 - better]
    same_track = all(longer(lives) in (None, better) for lives in tracks.T.tolist())
    turned = any(one.turns_within(CLAIMED) for one in room)
    return ONE_LONGER if beyond_errors and same_track and not turned else NEITHER_LONGER


def held(room: Sequence[Assumption], tracks: np.ndarray, said: int) -> xr.Dataset:
    """Robustness of a choice, as variables of a file over `assumption` and `ball_track`."""
    columns = {"holds_from": "low", "assumed": "now", "holds_to": "high"}
    values = {name: [getattr(one, field) for one in room] for name, field in columns.items()}
    names = tuple(one.name for one in room)
    number = Variable(
        "assumption", ("assumption",), "", "what was assumed", dtype="i1", flags=names
    )
    track = Variable(
        "ball_track", ("ball_track",), "", "track of a ball", dtype="i1", flags=BALL_TRACKS
    )
    row = {**values, "life_by_ball_track": tracks, "verdict": said}
    return filled(HELD, {number: None, track: None}, [row])
