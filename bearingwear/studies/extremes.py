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
"""Of lives, by the names of variables; the preload is a share of that when new."""


def worst_values(scene: Scene, life: Mapping[str, Any]) -> dict[str, float]:
    """Values of `WORST_VALUES` of measures that a life has along its steps.

    life: values of its result [SI]. Of a pair, the worse bearing counts.
    """
    found = {}
    for measure in MEASURES:
        for name, variable in zip(measure.extremes, measure.variables, strict=True):
            history = life.get(f"history_{variable}")
            if history is not None:
                found[name] = _worst(measure, np.asarray(history), scene)
    return found


def _worst(measure: Measure, values: np.ndarray, scene: Scene) -> float:
    """The worst of values over (bearing and) step; those that are not known are left out."""
    whole = 1.0
    if measure.over_preload:
        if scene.pair is not None:  # one spring or one displacement preloads all in tandem
            values = values * np.reshape(scene.pair.tandem, (2,) + (1,) * (values.ndim - 1))
        whole = scene.operation.preload_N
    known = values[~np.isnan(values)]
    return measure.extreme(known) / whole if known.size else math.nan
