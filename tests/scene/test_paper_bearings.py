"""The bearings that match what the paper states, which `benchmarks/paper_bearings.py` finds."""

from dataclasses import replace

import numpy as np
import pytest
from support import benchmark


@pytest.fixture(scope="module")
def bearings():
    return benchmark("paper_bearings")


def test_the_scene_is_found_again(bearings, scene):
    """gyro_s1 was chosen among them: with its own values, the search comes back to its angle."""
    without_cage = replace(scene("gyro_s1"), cage=None)
    angle = without_cage.bearing.contact_angle_deg
    (result,) = bearings.angles_with_loss(without_cage, [angle - 2.0, angle + 2.0])
    assert result == pytest.approx(angle, abs=0.5)
    bearing = bearings.candidate(bearings.with_angle(without_cage, result))
    assert bearing.failed == "" and len(bearing.drags) > 0 and np.isfinite(bearing.lives_h).all()
    steep = bearings.candidate(bearings.with_angle(without_cage, 45.0))
    assert steep.failed != ""


def test_an_angle_without_a_state(bearings, scene, monkeypatch):
    """The loss changes its sign twice, the first time where no state is found."""

    def loss(turned):
        angle = turned.bearing.contact_angle_deg
        miss = 0.01 * (angle - 14.0) * (26.0 - angle)
        return np.nan if 10.0 < angle < 20.0 else bearings.PRELOAD_LOSS + miss

    monkeypatch.setattr(bearings, "preload_loss", loss)
    assert bearings.angles_with_loss(scene(), [10.0, 20.0, 30.0]) == pytest.approx([26.0])
