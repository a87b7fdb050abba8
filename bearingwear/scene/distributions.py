"""Values of a scene at probabilities, by the distributions of what is uncertain in it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.special import ndtr, ndtri

from bearingwear.scene.scene import Distribution, Scene, key_of_scene
from bearingwear.scene.uncertain import friction_correlation, uncertain_key


def possible_range(key: str) -> tuple[float, float]:
    """Returns the least and largest value of a key of a scene; (0, inf) for any other text."""
    key_field = key_of_scene(key)
    return (0.0, np.inf) if key_field is None else key_field.key.ends


def quantile(
    distribution: Distribution, nominal: float, ends: tuple[float, float], probability: np.ndarray
) -> np.ndarray:
    """Returns quantiles of a distribution that is truncated at `ends`.

    `nominal` is the mean or median of a distribution that has none.
    """
    if distribution.distribution == "uniform":
        assert distribution.low is not None and distribution.high is not None
        width = distribution.high - distribution.low
        p_low, p_high = np.clip(np.subtract(ends, distribution.low) / width, 0.0, 1.0)
        return distribution.low + width * (p_low + (p_high - p_low) * np.asarray(probability))
    if distribution.distribution == "normal":
        mean = nominal if distribution.mean is None else distribution.mean
        deviation = distribution.standard_deviation
        p_low, p_high = ndtr(np.subtract(ends, mean) / deviation)
        return mean + deviation * ndtri(p_low + (p_high - p_low) * np.asarray(probability))
    assert distribution.factor is not None
    median = nominal if distribution.median is None else distribution.median
    width = math.log(distribution.factor)
    with np.errstate(divide="ignore"):
        p_low, p_high = ndtr(np.log(np.divide(ends, median)) / width)
    return median * np.exp(width * ndtri(p_low + (p_high - p_low) * np.asarray(probability)))


def value_at(scene: Scene, name: str, probability: np.ndarray) -> np.ndarray:
    """Returns quantiles of an uncertain value; its distribution is truncated to possible values."""
    ends = possible_range(uncertain_key(name, scene.bearing.race_material))
    return quantile((scene.uncertainty or {})[name], scene.nominal(name), ends, probability)


def values_at(scene: Scene, names: Sequence[str], probability: np.ndarray) -> np.ndarray:
    """Returns uncertain values (n, names) at independent probabilities (n, names).

    A wear coefficient that is correlated with friction follows both probabilities.
    """
    friction, rho = friction_correlation(scene.uncertainty or {})
    if rho and {friction, "wear_coefficient"} <= set(names):
        friction_column, wear_column = names.index(friction), names.index("wear_coefficient")
        deviates = ndtri(probability[:, [friction_column, wear_column]])
        wear_deviate = deviates @ (rho, math.sqrt(1.0 - rho * rho))
        probability = probability.copy()
        probability[:, wear_column] = ndtr(wear_deviate)
    columns = [value_at(scene, name, probability[:, k]) for k, name in enumerate(names)]
    return np.stack(columns, axis=-1) if columns else probability
