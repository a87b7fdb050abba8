"""Lives at the recommended preloads under other assumptions, and what these change."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.results.netcdf import CaseFileError, load, load_kind
from bearingwear.results.variable import Variable
from bearingwear.results.words import in_words
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.read import variant
from bearingwear.scene.scene import PRELOAD_METHODS, Scene
from bearingwear.studies.design.choice import limit_margins, limits_of
from bearingwear.studies.design.document.words import LIMIT_WORDS
from bearingwear.studies.design.map import IMPRACTICAL, MAP_AXES, filled_points, followed_point
from bearingwear.studies.design.recommend import recommended_for
from bearingwear.studies.design.room import longer, warm_end
from bearingwear.studies.solve import life_scene

_KIND = "beside"
_WORDS = "words"
"""Attribute: the other assumption of each of them, in words."""

REVERSED_BY_WARMTH = "reversed_by_warmth"
"""Attribute: warming of the inner ring alone that reverses the choice [K]; missing without any."""


def lives_beside(
    scene: Path, recommendation: Path, cases: Mapping[str, Mapping[str, Any]]
) -> xr.Dataset:
    """Step: lives at the recommended preloads of a scene, with other assumptions.

    cases: of each name `words`, and `set`, the keys of the scene that are changed.
    """
    found = recommended_for(life_scene(scene), load(recommendation))
    limits = limits_of(found)
    points = []
    for case in cases.values():
        other = variant(scene, case["set"])
        for flag, preload in zip(
            found["preload_method"].values, found["preload"].values, strict=True
        ):
            held = held_by(other, PRELOAD_METHODS[int(flag)], float(np.nan_to_num(preload)))
            known = math.isfinite(preload)
            points.append(followed_point(held, limits) if known else {})
    names = Variable(_KIND, (_KIND,), "", "changed assumption", dtype="i1", flags=tuple(cases))
    methods = {MAP_AXES["preload_method"]: found["preload_method"].values}
    made = filled_points({names: None, **methods}, points)
    made.attrs = {
        key: value for key, value in found.attrs.items() if key not in ("warnings", "none_because")
    } | {
        "kind": _KIND,
        "title": "Computed lives at the recommended preloads under different assumptions",
        _WORDS: json.dumps([case["words"] for case in cases.values()]),
    }
    kelvin = _warmth(life_scene(scene), found)
    return made.assign_attrs({REVERSED_BY_WARMTH: kelvin} if math.isfinite(kelvin) else {})


def _warmth(scene: Scene, found: xr.Dataset) -> float:
    """Warming of the inner ring alone that reverses the choice [K]; NaN for none found."""
    lives: list[float] = found["life"].values.tolist()
    first = longer(lives)
    if first is None or len(lives) < 2 or scene.thermal is not None:
        return math.nan
    names = (PRELOAD_METHODS[int(flag)] for flag in found["preload_method"].values)
    scenes = [held_by(scene, *one) for one in zip(names, found["preload"].values, strict=True)]
    return warm_end(scenes, lives, first)


def load_beside(path: Path, recommendation: xr.Dataset) -> xr.Dataset:
    """Lives at the recommended preloads under other assumptions. Raises CaseFileError."""
    found = load_kind(path, _KIND)
    if found.attrs["scene"] != recommendation.attrs["scene"]:
        raise CaseFileError(
            f"{path}: got lives computed for another scene, expected the scene of the "
            "recommendation"
        )
    return found


def assumptions_of(beside: xr.Dataset) -> list[tuple[str, xr.Dataset]]:
    """Words and numbers of each assumption, which have the limits of the recommendation."""
    words = json.loads(beside.attrs[_WORDS])
    return [(text, beside.isel({_KIND: k})) for k, text in enumerate(words)]


def passed(one: xr.Dataset) -> str:
    """Which limits a point passes, or why it has no life."""
    if int(one["status"]) != OK:
        return f"not solved: {in_words(STATUS_NAMES[int(one['status'])])}"
    limits = limits_of(one)
    margins = zip(limits.held, limit_margins(one, limits), strict=True)
    beyond = [LIMIT_WORDS[name] for name, left in margins if not left >= -SAME]
    if number := int(one["impractical"]):
        beyond.append(f"impractical design: {in_words(IMPRACTICAL[number - 1])}")
    return ", ".join(beyond) or NONE_PASSED


NONE_PASSED = "none"

SAME = 1e-6
"""Relative excess over a limit that counts as rounding."""
