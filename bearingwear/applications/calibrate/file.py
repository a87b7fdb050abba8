"""The file of a calibration: friction, K_s/H and life before and after, and the tests."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from scipy.special import ndtri

from bearingwear import Scene
from bearingwear.applications.calibrate.bearing_tests import BearingTest
from bearingwear.applications.calibrate.posterior import (
    LogModel,
    Normal,
    Observation,
    Posterior,
    Prior,
)
from bearingwear.applications.calibrate.seen import SEEN, SEEN_TORQUE
from bearingwear.results.variable import Variable, table
from bearingwear.studies.dataset import dataset_of_rows

CALIBRATION_KIND = "calibration"
STAGES = ("before", "after")
_ENDS = (0.05, 0.95)
"""Probabilities at the ends of the intervals that are quoted."""

LIFE_PROBABILITIES = (_ENDS[0], 0.1, 0.5, _ENDS[1])
_POINTS = 161
"""Number of points of each curve."""

_LIFE_MARGIN, _DRAWN_DEVIATIONS = 3.0, 3.5
"""Where drawn curves end, as they are close to zero there.

A curve reaches beyond the quantiles of a life by the first as a factor. That of a normal
distribution reaches from its mean by the second in standard deviations.
"""

_STAGE = Variable("stage", ("stage",), "", "before or after the tests", "i1", flags=STAGES)
_LIFE_PROBABILITY = Variable(
    "probability",
    ("probability",),
    "1",
    "share of failed bearings, allowing for all uncertain values",
)
_BATCH = Variable(
    "batch_probability", ("batch_probability",), "1", "share of batches with a lower value"
)
_WEAR = "wear_over_hardness"
CALIBRATION_VARIABLES = table(
    Variable("friction_interval", ("stage", "end"), "1",
        "friction of a batch, 5 % and 95 % quantiles"),
    Variable("wear_over_hardness_interval", ("stage", "end"), "m2 N-1",
        "K_s/H of a batch, 5 % and 95 % quantiles"),
    Variable("friction_carried", ("end",), "1",
        "friction of a batch, 5 % and 95 % quantiles of the distribution in the calibrated scene"),
    Variable("wear_over_hardness_carried", ("end",), "m2 N-1",
        "K_s/H of a batch, 5 % and 95 % quantiles of the distribution in the calibrated scene"),
    Variable("life_quantile", ("stage", "probability"), "h", "quantile of bearing life"),
    Variable("batch_life_quantile", ("stage", "batch_probability"), "h",
        "life that 10 % of the bearings in a batch fail to reach"),
    Variable("scatter", (), "1", "standard deviation of log life within a batch of bearings"),
    Variable("interpolation_error", (), "1",
        "maximum error in log life interpolated between friction values"),
    Variable("friction", ("friction",), "1", "friction coefficient, or shear strength in MPa"),
    Variable("friction_density", ("stage", "friction"), "1",
        "probability density of the logarithm of friction"),
    Variable(_WEAR, (_WEAR,), "m2 N-1", "K_s/H of the rubbing surfaces while the races are new"),
    Variable("wear_density", ("stage", _WEAR), "1",
        "probability density of the logarithm of K_s/H"),
    Variable("hours", ("hours",), "h", "life"),
    Variable("failed_share", ("stage", "hours"), "1", "share of bearings that have failed"),
    Variable("seen", ("test",), "", "kind of result", "i1", flags=SEEN),
    Variable("row", ("test",), "1", "line in the test file", "i8"),
    Variable("value", ("test",), "1", "result, in the unit given by its name"),
    Variable("after", ("test",), "h", "time at which the result was measured (none for a torque)"),
    Variable("expected", ("test", "end"), "1",
        "5 % and 95 % quantiles predicted before the tests: time [h] to this result, or torque "
        "[N mm]"),
    Variable("probability_of_test", ("test",), "1",
        "probability of a deviation from the model at least as large as in the test, given the "
        "other tests"),
)  # fmt: skip
"""Axes and results; `end` is the lower and the upper one of an interval."""


def calibration_dataset(
    *,
    scene: Scene,
    wear_over_hardness: float,
    prior: Prior,
    stages: tuple[Posterior, Posterior],
    life: LogModel,
    scatter: float,
    error: float,
    tests: Sequence[BearingTest],
    observations: Sequence[Observation],
    probabilities: Sequence[float],
) -> xr.Dataset:
    """Returns a calibration as a dataset.

    scene: calibrated by the tests.
    wear_over_hardness: K_s/H of the scene before the tests [m2/N].
    stages: the distribution of friction and K_s/H before and after the tests.
    life: logarithm of the life [h] over ln mu.
    scatter: standard deviation of the log life of the scene within a batch.
    error: largest error of log lives and torques that are interpolated between frictions.
    observations, probabilities: what the posterior uses of each test, and its probability given
        the others.
    """
    results = _stage_values(wear_over_hardness, stages, life, scatter)
    results |= _test_values(tests, observations, probabilities, stages[0])
    results["interpolation_error"] = error
    x_axis, y_axis = (
        _spanning_points([stage.normal(axis) for stage in stages]) for axis in ("x", "y")
    )
    axes = {_WEAR: wear_over_hardness * np.exp(y_axis), "hours": _life_axis(results)}
    results["wear_density"] = [
        _density_at(stage.y, stage.shares.sum(axis=0), y_axis) for stage in stages
    ]
    results["failed_share"] = [
        [stage.failed_share(life, t, scatter) for t in axes["hours"]] for stage in stages
    ]
    if prior.x.deviation:
        axes["friction"] = np.exp(x_axis)
        results["friction_density"] = [
            _density_at(stage.x, stage.shares.sum(axis=1), x_axis) for stage in stages
        ]
    return dataset_of_rows(
        {name: variable for name, variable in CALIBRATION_VARIABLES.items() if name in results},
        {
            _STAGE: None,
            _LIFE_PROBABILITY: LIFE_PROBABILITIES,
            _BATCH: (_ENDS[0], 0.5, _ENDS[1]),
            **{CALIBRATION_VARIABLES[name]: values for name, values in axes.items()},
        },
        [results],
        title=f"Calibration: {scene.name}",
        kind=CALIBRATION_KIND,
        scene=scene,
        friction_moved=_shift(prior.x, stages[1].normal("x")),
        wear_moved=_shift(prior.y, stages[1].normal("y")),
    )


def _shift(before: Normal, after: Normal) -> float:
    """Returns the shift of a mean in standard deviations before the tests [1]; 0 for a known value.

    It is positive for a value that the tests increase.
    """
    return (after.mean - before.mean) / before.deviation if before.deviation else 0.0


def _stage_values(
    wear_over_hardness: float, stages: Sequence[Posterior], life: LogModel, scatter: float
) -> dict[str, Any]:
    """Returns intervals of friction, K_s/H and life before and after, by names of variables.

    Arguments: `calibration_dataset`.
    """
    log_L10 = float(ndtri(0.1)) * scatter  # less that of the median bearing

    def carried_interval(axis: str) -> np.ndarray:
        """Returns the interval in the calibrated scene, which has lognormal distributions."""
        normal = stages[-1].normal(axis)
        return np.exp(normal.mean + ndtri(_ENDS) * normal.deviation)

    friction_interval, wear_interval = (
        np.exp([stage.axis_quantiles(axis, _ENDS) for stage in stages]) for axis in ("x", "y")
    )
    return {
        "friction_interval": friction_interval,
        "friction_carried": carried_interval("x"),
        "wear_over_hardness_interval": wear_over_hardness * wear_interval,
        "wear_over_hardness_carried": wear_over_hardness * carried_interval("y"),
        "life_quantile": [
            [stage.quantile(life, probability, scatter) for probability in LIFE_PROBABILITIES]
            for stage in stages
        ],
        "batch_life_quantile": [
            [
                stage.median_quantile(life, probability, log_L10)
                for probability in (_ENDS[0], 0.5, _ENDS[1])
            ]
            for stage in stages
        ],
        "scatter": scatter,
    }


def _test_values(
    tests: Sequence[BearingTest],
    observations: Sequence[Observation],
    probabilities: Sequence[float],
    before: Posterior,
) -> dict[str, Any]:
    """Returns the results of the tests, and what was expected before them, by names of variables.

    Arguments: `calibration_dataset`; `before` is the first of its stages.
    """
    expected = [
        [
            before.quantile(
                observation.model, probability, observation.scatter, observation.depends_on_wear
            )
            for probability in _ENDS
        ]
        for observation in observations
    ]
    is_torque = np.array([test.seen == SEEN_TORQUE for test in tests])
    return {
        "seen": [SEEN.index(test.seen) for test in tests],
        "row": [test.row for test in tests],
        "value": [test.value for test in tests],
        "after": np.where(is_torque, np.nan, [test.after for test in tests]),
        "expected": np.where(is_torque, 1e3, 1.0)[:, None] * np.array(expected),
        "probability_of_test": probabilities,
    }


def _life_axis(results: Mapping[str, Any]) -> np.ndarray:
    """Returns `_POINTS` lives [h] at which curves are drawn, around the quantiles before the tests.

    results: with `life_quantile` [h].
    """
    low, *_, high = results["life_quantile"][0]
    return np.geomspace(low / _LIFE_MARGIN, high * _LIFE_MARGIN, _POINTS)


def _spanning_points(normals: Sequence[Normal]) -> np.ndarray:
    """Returns `_POINTS` evenly spaced points that span several distributions."""
    low = min(normal.mean - _DRAWN_DEVIATIONS * normal.deviation for normal in normals)
    high = max(normal.mean + _DRAWN_DEVIATIONS * normal.deviation for normal in normals)
    return np.linspace(low, high, _POINTS)


def _density_at(grid: np.ndarray, shares: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Returns the density of one axis at some points; zero for a known value.

    grid: evenly spaced points; a single one for a known value.
    shares: of probability at the points of the grid; their sum is 1.
    points: at which the density is wanted; it is zero beyond the grid.
    """
    if len(grid) == 1:
        return np.zeros(len(points))
    return np.interp(points, grid, shares / (grid[1] - grid[0]), left=0.0, right=0.0)
