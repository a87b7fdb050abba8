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
    unit: float,
    prior: Prior,
    stages: tuple[Posterior, Posterior],
    life: LogModel,
    scatter: float,
    error: float,
    tests: Sequence[BearingTest],
    seen: Sequence[Observation],
    probabilities: Sequence[float],
) -> xr.Dataset:
    """Returns a calibration as a dataset.

    unit: K_s/H of the scene before the tests [m2/N].
    scatter, error: scatter of the log life of the scene, and its interpolation error.
    """
    results = _stage_values(unit, stages, life, scatter)
    results |= {"interpolation_error": error} | _test_values(tests, seen, probabilities, stages[0])
    normals = [(stage.normal("x"), stage.normal("y")) for stage in stages]
    x_axis, y_axis = (_spanning_points([pair[k] for pair in normals]) for k in (0, 1))
    axes = {_WEAR: unit * np.exp(y_axis), "hours": _hours(results)}
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
    moved = [
        (after.mean - before.mean) / before.deviation if before.deviation else 0.0
        for before, after in zip(prior[:2], normals[1], strict=True)
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
        friction_moved=moved[0],
        wear_moved=moved[1],
    )


def _stage_values(
    unit: float, stages: Sequence[Posterior], life: LogModel, scatter: float
) -> dict[str, Any]:
    """Returns intervals of friction, K_s/H and life, before and after."""
    log_L10 = float(ndtri(0.1)) * scatter

    def carried_interval(axis: str) -> np.ndarray:
        """Returns the interval in the calibrated scene, which carries a normal distribution on."""
        normal = stages[-1].normal(axis)
        return np.exp(normal.mean + ndtri(_ENDS) * normal.deviation)

    return {
        "friction_interval": np.exp([stage.ends("x", _ENDS) for stage in stages]),
        "friction_carried": carried_interval("x"),
        "wear_over_hardness_interval": unit * np.exp([stage.ends("y", _ENDS) for stage in stages]),
        "wear_over_hardness_carried": unit * carried_interval("y"),
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
    seen: Sequence[Observation],
    probabilities: Sequence[float],
    before: Posterior,
) -> dict[str, Any]:
    """Returns the results of the tests, and what the model expected before them."""
    expected = [
        [
            before.quantile(
                observation.model, probability, observation.scatter, observation.of_wear
            )
            for probability in _ENDS
        ]
        for observation in seen
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


def _hours(results: Mapping[str, Any]) -> np.ndarray:
    """Returns lives [h] along the axis of the failed share."""
    low, *_, high = results["life_quantile"][0]
    return np.geomspace(low / 3.0, high * 3.0, _POINTS)


def _spanning_points(normals: Sequence[Normal]) -> np.ndarray:
    """Returns points that span several distributions."""
    low = min(normal.mean - 3.5 * normal.deviation for normal in normals)
    high = max(normal.mean + 3.5 * normal.deviation for normal in normals)
    return np.linspace(low, high, _POINTS)


def _density_at(grid: np.ndarray, shares: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Returns the density along one axis at some points, from shares on a grid."""
    if len(grid) == 1:
        return np.zeros(len(points))
    return np.interp(points, grid, shares / (grid[1] - grid[0]), left=0.0, right=0.0)
