"""The bearings that match what the paper states, which `benchmarks/paper_bearings.py` finds."""

from dataclasses import replace

import numpy as np
import pytest
from support import benchmark


@pytest.fixture(scope="module")
def bearings():
    return benchmark("paper_bearings")


@pytest.fixture
def gyro(scene):
    """One of the bearings that match, and which the scene gyro_s1 was chosen to be."""
    return replace(scene("gyro_s1"), cage=None)


def test_the_search_finds_the_angle_of_a_bearing_that_matches(bearings, gyro):
    """It is that of the scene within half a degree, because the scene has it rounded."""
    angle = gyro.bearing.contact_angle_deg
    (found_angle,) = bearings.angles_with_loss(gyro, [angle - 2.0, angle + 2.0])
    assert found_angle == pytest.approx(angle, abs=0.5)
    bearing = bearings.candidate(bearings.with_angle(gyro, found_angle))
    assert bearing.failed == "" and len(bearing.drags) > 0 and np.isfinite(bearing.lives_h).all()


def test_a_steep_angle_fails_a_statement_of_the_paper(bearings, gyro):
    assert bearings.candidate(bearings.with_angle(gyro, 45.0)).failed != ""


def test_the_search_passes_over_angles_without_a_state(bearings, scene, monkeypatch):
    """The loss is that of the paper at 14 and 26 degrees, of which only the second has states."""

    def loss(scene):
        angle = scene.bearing.contact_angle_deg
        difference = 0.01 * (angle - 14.0) * (26.0 - angle)
        return np.nan if 10.0 < angle < 20.0 else bearings.PRELOAD_LOSS + difference

    monkeypatch.setattr(bearings, "preload_loss", loss)
    assert bearings.angles_with_loss(scene(), [10.0, 20.0, 30.0]) == pytest.approx([26.0])
