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


def test_a_warm_bearing_wears_sooner_to_the_same_criterion(spindle):
    """The warmer inner ring presses harder.

    Temperatures on the way are no better than the rough balances of its states.
    """
    warm, cold = life(spindle), life(spindle.with_({"thermal": None}))
    assert warm.status == cold.status == "ok"
    assert warm.values["end_criterion"] == cold.values["end_criterion"]
    assert 0.3 < np.max(warm.values["life"]) / np.max(cold.values["life"]) < 1.0


def test_a_required_thermal_margin_above_the_one_when_new_ends_the_life_at_once(spindle):
    margin = float(solve(spindle).values["thermal_margin"])
    result = life(spindle.with_({"wear.end_of_life.thermal_margin": 1.05 * margin}))
    assert np.all(result.values["life"] == 0.0)
    result = life(spindle.with_({"wear.end_of_life.thermal_margin": 0.95 * margin}))
    assert_allclose(result.values["history_thermal_margin"][0], margin, rtol=1e-4)
