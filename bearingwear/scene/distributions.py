"""Values of a scene at probabilities, by the distributions of what is uncertain in it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.special import ndtr, ndtri

from bearingwear.scene.scene import Distribution, Scene, key_of_scene
from bearingwear.scene.uncertain import friction_correlation, uncertain_key


def possible(key: str) -> tuple[float, float]:
    """Least and largest value that a key of a scene may have; what is no key is positive."""
    part = key_of_scene(key)
    return (0.0, np.inf) if part is None else part.key.ends


def quantile(
    given: Distribution, nominal: float, ends: tuple[float, float], probability: np.ndarray
) -> np.ndarray:
    """Quantiles of a distribution that is cut off at the ends of what is possible.

    About the scene's own value if it has no middle.
    """
    if given.distribution == "uniform":
        assert given.low is not None and given.high is not None
        width = given.high - given.low
        below, upto = np.clip(np.subtract(ends, given.low) / width, 0.0, 1.0)
        return given.low + width * (below + (upto - below) * np.asarray(probability))
    if given.distribution == "normal":
        mean, deviation = nominal if given.mean is None else given.mean, given.standard_deviation
        below, upto = ndtr(np.subtract(ends, mean) / deviation)
        return mean + deviation * ndtri(below + (upto - below) * np.asarray(probability))
    assert given.factor is not None
    median, width = nominal if given.median is None else given.median, math.log(given.factor)
    with np.errstate(divide="ignore"):
        below, upto = ndtr(np.log(np.divide(ends, median)) / width)
    return median * np.exp(width * ndtri(below + (upto - below) * np.asarray(probability)))


def value_at(scene: Scene, name: str, probability: np.ndarray) -> np.ndarray:
    """Quantiles of an uncertain value, its distribution cut off where it would be impossible."""
    ends = possible(uncertain_key(name, scene.bearing.race_material))
    return quantile((scene.uncertainty or {})[name], scene.nominal(name), ends, probability)


def values_at(scene: Scene, names: Sequence[str], probability: np.ndarray) -> np.ndarray:
    """Values (n, names) of uncertain values at independent probabilities (n, names).

    A wear coefficient that goes with friction takes of its own what friction leaves open.
    """
    friction, rho = friction_correlation(scene.uncertainty or {})
    if rho and {friction, "wear_coefficient"} <= set(names):
        mu, wear = names.index(friction), names.index("wear_coefficient")
        deviate = ndtri(probability[:, [mu, wear]]) @ (rho, math.sqrt(1.0 - rho * rho))
        probability = probability.copy()
        probability[:, wear] = ndtr(deviate)
    columns = [value_at(scene, name, probability[:, k]) for k, name in enumerate(names)]
    return np.stack(columns, axis=-1) if columns else probability
