"""Lives of bearings at the temperatures of their own heat."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support import warm_spindle

from bearingwear.lives.life import life
from bearingwear.solvers.solve import solve


@pytest.fixture(scope="module")
def spindle():
    return warm_spindle()


def test_a_warm_worn_life_ends_by_a_criterion(spindle):
    """States on the way are balanced roughly; the temperatures are then found no better."""
    result, cold = life(spindle), life(spindle.with_({"thermal": None}))
    assert result.status == cold.status == "ok"
    assert result.values["end_criterion"] == cold.values["end_criterion"]
    # the warmer inner ring presses harder, and the bearing wears sooner
    assert 0.3 < np.max(result.values["life"]) / np.max(cold.values["life"]) < 1.0


def test_a_life_ends_where_the_thermal_margin_is_met(spindle):
    margin = float(solve(spindle).values["thermal_margin"])
    result = life(spindle.with_({"wear.end_of_life.thermal_margin": 1.05 * margin}))
    assert_allclose(result.values["life"], 0.0, atol=1e-12)
    result = life(spindle.with_({"wear.end_of_life.thermal_margin": 0.95 * margin}))
    assert_allclose(result.values["history_thermal_margin"][0], margin, rtol=1e-4)
