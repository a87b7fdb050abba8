"""The worst value of each measure along a life."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from bearingwear.measures import MEASURES, Measure
from bearingwear.results.variable import Variable, table
from bearingwear.scene.scene import Scene

KEEP_EXTREMES = "extremes"
"""Choice of a sweep that keeps the worst values along each life."""


def _worst_words(measure: Measure, name: str) -> str:
    """Returns the words for the worst value of a measure, such as "largest contact pressure".

    name: of the worst value, one of `measure.extremes`.
    """
    if measure.over_preload:
        return "minimum ratio of residual to initial preload"
    return f"{measure.worst_word} {measure.words_of(name)}"


WORST_VALUES = table(
    *(
        Variable(
            name,
            (),
            measure.si_unit,
            f"{_worst_words(measure, name)}, from new to the end of life",
            comment=measure.note or None,
        )
        for measure in MEASURES
        if not measure.resting
        for name in measure.extremes
    )
)
"""Variables of the worst values along a life; a preload is a share of the initial preload."""


def worst_values(scene: Scene, life: Mapping[str, Any]) -> dict[str, float]:
    """Returns the worst value of each measure along a life, if the life has its history.

    life: values of its result [SI]; `history_...` has the shape (steps, ...), or (2, steps, ...)
        for a pair, whose worse bearing counts.

    Returns values by the names of `WORST_VALUES`.
    """
    worst_by_name = {}
    for measure in MEASURES:
        for name, variable in zip(measure.extremes, measure.variables, strict=True):
            history = life.get(f"history_{variable}")
            if history is not None:
                worst_by_name[name] = _worst_value(measure, np.asarray(history), scene)
    return worst_by_name


def _worst_value(measure: Measure, values: np.ndarray, scene: Scene) -> float:
    """Returns the worst value over steps, contacts and bearings [SI]; NaN if all are NaN.

    A residual preload is returned as a share of the preload of the scene [1].

    values: (steps, ...) [SI], in a pair (2, steps, ...).
    """
    reference = 1.0
    if measure.over_preload:
        reference = scene.operation.preload_N
        # `values` are of one bearing; all bearings in tandem on a side share the preload
        if scene.pair is not None:
            values = values * np.reshape(scene.pair.tandem, (2,) + (1,) * (values.ndim - 1))
    finite = values[~np.isnan(values)]
    return measure.extreme(finite) / reference if finite.size else math.nan
