"""Values of a scene at probabilities, by the distributions of what is uncertain in it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.special import ndtr, ndtri

from bearingwear.scene.scene import Distribution, Scene, key_of_scene
from bearingwear.scene.uncertain import friction_correlation, uncertain_key


def possible_range(key: str) -> tuple[float, float]:
    """Returns the least and largest value that a key of a scene takes.

    An end without a bound is infinite. The range of `wear_scatter`, which is no key of a scene, is
    (0, inf).
    """
    key_field = key_of_scene(key)
    return (0.0, np.inf) if key_field is None else key_field.key.ends


def quantile(
    distribution: Distribution, nominal: float, ends: tuple[float, float], probability: np.ndarray
) -> np.ndarray:
    """Returns the quantiles of a truncated distribution, one for each probability.

    nominal: mean or median where the distribution does not state it, in its unit.
    ends: least and largest value, at which the distribution is truncated; infinite without one,
        but for a lognormal distribution the least is at least 0.
    probability: from 0 to 1, of any shape.
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


def value_quantiles(scene: Scene, name: str, probability: np.ndarray) -> np.ndarray:
    """Returns quantiles of an uncertain value of a scene, one for each probability.

    name: a key of `uncertainty`, whose distribution is truncated to the values that a scene takes.
    """
    ends = possible_range(uncertain_key(name, scene.bearing.race_material))
    return quantile((scene.uncertainty or {})[name], scene.nominal(name), ends, probability)


def sampled_values(scene: Scene, names: Sequence[str], probability: np.ndarray) -> np.ndarray:
    """Returns a sample of uncertain values of a scene, shape (samples, names).

    names: keys of `uncertainty`.
    probability: of each value, independent of the others, shape (samples, names). A wear
        coefficient that is correlated with friction depends on the probabilities of both.
    """
    friction, correlation = friction_correlation(scene.uncertainty or {})
    if correlation and friction in names and "wear_coefficient" in names:
        friction_column, wear_column = names.index(friction), names.index("wear_coefficient")
        deviates = ndtri(probability[:, [friction_column, wear_column]])
        wear_deviate = deviates @ (correlation, math.sqrt(1.0 - correlation * correlation))
        probability = probability.copy()
        probability[:, wear_column] = ndtr(wear_deviate)
    # without names, `probability` already has the shape (samples, 0) of the sample
    columns = [value_quantiles(scene, name, probability[:, k]) for k, name in enumerate(names)]
    return np.stack(columns, axis=-1) if columns else probability
