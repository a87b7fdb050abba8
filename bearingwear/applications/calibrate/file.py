"""What a file of a calibration holds: friction, K_s/H and life before and after, and the tests."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from scipy.special import ndtri

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
from bearingwear.scene.scene import Scene
from bearingwear.studies.dataset import dataset_of_rows

CALIBRATION_KIND = "calibration"
STAGES = ("before", "after")
_ENDS = (0.05, 0.95)
"""Probabilities at the ends of the intervals that are quoted."""

LIFE_PROBABILITIES = (_ENDS[0], 0.1, 0.5, _ENDS[1])
_POINTS = 161
"""Along the axes of what is drawn."""

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
    """A calibration as a file.

    unit: K_s/H of the scene before [m2/N].
    scatter, error: of the log life of the scene.
    """
    found = _of_stages(unit, stages, life, scatter)
    found |= {"interpolation_error": error} | _of_tests(tests, seen, probabilities, stages[0])
    normal = [(one.normal("x"), one.normal("y")) for one in stages]
    x_axis, y_axis = (_spanned([n[k] for n in normal]) for k in (0, 1))
    axes = {_WEAR: unit * np.exp(y_axis), "hours": _hours(found)}
    found["wear_density"] = [_marginal(one.y, one.shares.sum(axis=0), y_axis) for one in stages]
    found["failed_share"] = [
        [one.failed_share(life, t, scatter) for t in axes["hours"]] for one in stages
    ]
    if prior.x.deviation:
        axes["friction"] = np.exp(x_axis)
        found["friction_density"] = [
            _marginal(one.x, one.shares.sum(axis=1), x_axis) for one in stages
        ]
    moved = [
        (after.mean - before.mean) / before.deviation if before.deviation else 0.0
        for before, after in zip(prior[:2], normal[1], strict=True)
    ]
    return dataset_of_rows(
        {name: one for name, one in CALIBRATION_VARIABLES.items() if name in found},
        {
            _STAGE: None,
            _LIFE_PROBABILITY: LIFE_PROBABILITIES,
            _BATCH: (_ENDS[0], 0.5, _ENDS[1]),
            **{CALIBRATION_VARIABLES[name]: values for name, values in axes.items()},
        },
        [found],
        title=f"Calibration: {scene.name}",
        kind=CALIBRATION_KIND,
        scene=scene,
        friction_moved=moved[0],
        wear_moved=moved[1],
    )


def _of_stages(
    unit: float, stages: Sequence[Posterior], life: LogModel, scatter: float
) -> dict[str, Any]:
    """Intervals of friction, K_s/H and life, before and after."""
    L10 = float(ndtri(0.1)) * scatter

    def carried(axis: str) -> np.ndarray:
        normal = stages[-1].normal(axis)
        return np.exp(normal.mean + ndtri(_ENDS) * normal.deviation)

    return {
        "friction_interval": np.exp([one.ends("x", _ENDS) for one in stages]),
        "friction_carried": carried("x"),
        "wear_over_hardness_interval": unit * np.exp([one.ends("y", _ENDS) for one in stages]),
        "wear_over_hardness_carried": unit * carried("y"),
        "life_quantile": [
            [one.quantile(life, p, scatter) for p in LIFE_PROBABILITIES] for one in stages
        ],
        "batch_life_quantile": [
            [one.median_quantile(life, p, L10) for p in (_ENDS[0], 0.5, _ENDS[1])] for one in stages
        ],
        "scatter": scatter,
    }


def _of_tests(
    tests: Sequence[BearingTest],
    seen: Sequence[Observation],
    probabilities: Sequence[float],
    before: Posterior,
) -> dict[str, Any]:
    """What was seen, and what the model has of it before the tests."""
    expected = [
        [before.quantile(one.model, p, one.scatter, one.of_wear) for p in _ENDS] for one in seen
    ]
    torque = np.array([test.seen == SEEN_TORQUE for test in tests])
    return {
        "seen": [SEEN.index(test.seen) for test in tests],
        "row": [test.row for test in tests],
        "value": [test.value for test in tests],
        "after": np.where(torque, np.nan, [test.after for test in tests]),
        "expected": np.where(torque, 1e3, 1.0)[:, None] * np.array(expected),
        "probability_of_test": probabilities,
    }


def _hours(found: Mapping[str, Any]) -> np.ndarray:
    low, *_, high = found["life_quantile"][0]
    return np.geomspace(low / 3.0, high * 3.0, _POINTS)


def _spanned(normals: Sequence[Normal]) -> np.ndarray:
    """Points that span several distributions."""
    low = min(n.mean - 3.5 * n.deviation for n in normals)
    high = max(n.mean + 3.5 * n.deviation for n in normals)
    return np.linspace(low, high, _POINTS)


def _marginal(grid: np.ndarray, shares: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Density along one axis at some of its points."""
    if len(grid) == 1:
        return np.zeros(len(points))
    return np.interp(points, grid, shares / (grid[1] - grid[0]), left=0.0, right=0.0)
