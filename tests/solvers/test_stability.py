"""Stability of periodic motions: known multipliers, pure thrust, and growth in a march."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support import numbers_in

from bearingwear.kernels.layout import PSI
from bearingwear.results.warnings import warnings_in
from bearingwear.solvers.dynamic.periodic import Passing, periodic_motion
from bearingwear.solvers.dynamic.stability import GrowthRates
from bearingwear.solvers.dynamic.system import DynamicSystem
from bearingwear.solvers.solve import solve
from bearingwear.solvers.start import start_of

BARE = {"model.history_points_per_turn": 0, "model.contact": "paper"}
RADIAL = BARE | {"operation.radial_load_N": [0.0, -1.5]}
TURBINE = BARE | {"operation.radial_load_N": [0.0, -900.0], "operation.rotating_load_N": 0.0}
TOLERANCE = 1e-4


def motion_of(scene):
    """Returns a system where its run begins, and the periodic motion that is found from there."""
    system = DynamicSystem.of(scene, start_of(scene).u)
    system.update()
    begun = system.packed(), system.time
    motion = periodic_motion(system, TOLERANCE, system.control().method)
    system.unpack(*begun)
    return system, motion


@pytest.mark.parametrize("largest, others", [(1.02, 0.4), (0.99, 0.4), (1.02, 1.3)])
def test_growth_rates_tell_the_spacing_from_other_disturbances(largest, others):
    """Nine of fourteen multipliers are of the spacing of the balls: near the nine roots of 1.

    One of the nine is exactly 1, and a pair has the largest modulus. The five other multipliers are
    not taken for the spacing, however fast they grow. Growth is ln(modulus) over the turns of a
    passing.
    """
    n, turns = 9, 0.25
    phases = 0.98 * np.exp(2j * np.pi * np.arange(n) / n)
    phases[[1, -1]] *= largest / 0.98
    phases[0] = 1.0
    multipliers = np.concatenate([others * np.exp(1j * np.arange(-2, 3)), phases[::-1]])
    growth = GrowthRates.of(multipliers, n, turns)
    assert_allclose(growth.spacing, np.log(largest) / turns, rtol=1e-12)
    assert_allclose(growth.slip_and_spin, np.log(others) / turns, rtol=1e-12)


def test_disturbances_decay_as_in_the_steady_state_under_a_tiny_radial_load(scene):
    """At 1 mN the slowest disturbance has the rate of the steady state.

    The spacing of the balls neither grows nor decays.
    """
    tiny = {"operation.radial_load_N": [0.0, -1e-3]}
    almost_unloaded = scene("gyro_s1", RADIAL | tiny).without_cage
    system, motion = motion_of(almost_unloaded)
    slow_time = start_of(almost_unloaded).scales["slow_time_scale"]
    assert_allclose(motion.growth.slip_and_spin, -system.turn / slow_time, rtol=0.02)
    assert abs(motion.growth.spacing) < 1e-6


def test_tangents_are_derivatives(scene):
    """Some columns of two balls against central differences of whole passings."""
    system, motion = motion_of(scene("gyro_s1", RADIAL).without_cage)
    passing = Passing(system, TOLERANCE, system.control().method)
    states = np.append((motion.balls / passing.scale).ravel(), motion.passing / system.turn)
    _, moved = passing.change_and_tangents(states)
    for column in (0, 2, 3, 4, 19):  # spin, orbit and phase of ball 0; the last of ball 3
        ends = []
        for shift in (1e-5, -1e-5):
            shifted = states.copy()
            shifted[column] += shift
            passing.change(shifted)
            ends.append((system.balls / passing.scale).ravel())
        difference = (ends[0] - ends[1]) / 2e-5
        assert_allclose(moved[:, column], difference, atol=5e-3 * np.abs(difference).max())


def test_uneven_spacing_grows_in_a_march_as_stated(scene):
    """Two marches start from the motion and from beside it; their azimuths differ ever more.

    The first harmonic of this difference over the balls grows as the motion states.
    """
    system, motion = motion_of(scene("turbine", TURBINE).without_cage)
    n, orbit = len(motion.balls), motion.passing * len(motion.balls)
    begun, wave = (system.packed(), system.time), np.exp(2j * np.pi * np.arange(n) / n)
    paths = []
    for shift in (0.0, 1e-4):
        system.unpack(*begun)
        system.balls[:] = motion.balls
        system.balls[:, PSI] += shift * wave.real
        path = []
        for _ in range(14):
            system.advance(orbit, TOLERANCE)
            path.append(system.balls[:, PSI].copy())
        paths.append(np.array(path))
    amplitude = np.abs((paths[1] - paths[0]) @ wave)
    # over the last six of 14 orbits, when other disturbances have decayed
    growth_per_turn = np.log(amplitude[-1] / amplitude[7]) / (6.0 * orbit / system.turn)
    assert motion.growth.spacing > 5e-3
    assert_allclose(motion.growth.spacing, growth_per_turn, rtol=3e-3)
    assert motion.growth.slip_and_spin < 0.0


@pytest.mark.parametrize("has_cage", [True, False])
def test_spacing_is_warned_of_where_no_cage_keeps_it(scene, has_cage):
    with_cage = scene("turbine", TURBINE)
    result = solve(with_cage if has_cage else with_cage.without_cage)
    assert result.values["spacing_growth_per_turn"] > 0.0
    assert "spacing" in result.attrs["settled"]
    warning_ids = {warning["id"] for warning in warnings_in(result.attrs)}
    assert ("motion_unstable" in warning_ids) == (not has_cage)


@pytest.fixture
def disturbances_grow(monkeypatch):
    """Makes every periodic motion seem to be unstable: disturbances grow by 0.1 a turn."""
    growth = GrowthRates(spacing=0.0, slip_and_spin=0.1)
    monkeypatch.setattr(Passing, "growth", lambda self, states: growth)


def test_a_motion_that_does_not_last_is_marched(scene, disturbances_grow):
    """The default `auto` marches, and its attribute `start` says why."""
    marched = solve(scene("gyro_s1", RADIAL | {"model.simulated_turns": 1.0}))
    assert "unstable" in marched.attrs["start"]
    assert 10.0 in numbers_in(marched.attrs["start"])  # turns for growth by a factor of e
    assert marched.values["simulated_turns"] == 1.0
    assert "disturbance_growth_per_turn" not in marched.values


def test_a_motion_that_does_not_last_is_kept_and_warned_of_where_it_is_required(
    scene, disturbances_grow
):
    kept = solve(scene("gyro_s1", RADIAL | {"model.dynamic_solution": "periodic"}))
    assert kept.values["disturbance_growth_per_turn"] == 0.1
    assert "motion_unstable" in {warning["id"] for warning in warnings_in(kept.attrs)}
