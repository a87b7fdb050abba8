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
    """The warmer inner ring presses harder, so that the life is shorter than without a network.

    A third of it is a bound, not a figure.
    """
    warm, cold = life(spindle), life(spindle.with_({"thermal": None}))
    assert warm.status == cold.status == "ok"
    assert warm.values["end_criterion"] == cold.values["end_criterion"]
    assert 0.3 < np.max(warm.values["life"]) / np.max(cold.values["life"]) < 1.0


def test_a_required_thermal_margin_above_the_one_when_new_ends_the_life_at_once(spindle):
    """One that is 5 % lower does not, and the life begins with the margin of a solve."""
    margin = float(solve(spindle).values["thermal_margin"])
    result = life(spindle.with_({"wear.end_of_life.thermal_margin": 1.05 * margin}))
    assert np.all(result.values["life"] == 0.0)
    result = life(spindle.with_({"wear.end_of_life.thermal_margin": 0.95 * margin}))
    assert_allclose(result.values["history_thermal_margin"][0], margin, rtol=1e-4)
