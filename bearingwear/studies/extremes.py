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


def _worst_words(measure: Measure, name: str) -> str:
    """Describes the worst value of a measure."""
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
"""Variables of the worst values along a life; the preload is a share of that when new."""


def worst_values(scene: Scene, life: Mapping[str, Any]) -> dict[str, float]:
    """Returns the values of `WORST_VALUES` of the measures that a life has along its steps.

    life: values of its result [SI]. In a pair, the worse bearing counts.
    """
    worst = {}
    for measure in MEASURES:
        for name, variable in zip(measure.extremes, measure.variables, strict=True):
            history = life.get(f"history_{variable}")
            if history is not None:
                worst[name] = _worst(measure, np.asarray(history), scene)
    return worst


def _worst(measure: Measure, values: np.ndarray, scene: Scene) -> float:
    """Returns the worst of the known values over steps and bearings; NaN if none is known."""
    initial = 1.0
    if measure.over_preload:
        if scene.pair is not None:  # one spring or one displacement preloads all in tandem
            values = values * np.reshape(scene.pair.tandem, (2,) + (1,) * (values.ndim - 1))
        initial = scene.operation.preload_N
    finite = values[~np.isnan(values)]
    return measure.extreme(finite) / initial if finite.size else math.nan
