"""How far a limit, or an end of life, may move before the other method is the better one."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bearingwear.measures import LIMITED
from bearingwear.studies.axis import RisingAxis
from bearingwear.studies.design.document.words import END_KEY, FRICTION_KEY, LIMIT_KEY, WEAR_KEY
from bearingwear.studies.design.map import life_point, scene_at
from bearingwear.studies.design.plan import DesignLimits, MapAxes
from bearingwear.studies.design.recommend import best_method, mapped
from bearingwear.studies.design.room import (
    NEITHER_LONGER,
    NO_COMPARISON,
    ONE_LONGER,
    Assumption,
    criteria_room,
    friction_end,
    friction_room,
    printed_life,
    verdict_on,
    warm_end,
)

METHODS = ("constant_force", "fixed_position")
STIFFNESS = "system_axial_stiffness_N_um"


@pytest.fixture(scope="module")
def chosen(scene):
    """Function of a limit of system stiffness -> the map and the recommendation of gyro_s1."""
    axes = MapAxes(
        preload_method=METHODS,
        friction=RisingAxis([0.08]),
        shaft_speed_rpm=RisingAxis([30000.0]),
        preload_N=RisingAxis([2.5, 3.5, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 12.0]),
    )
    return lambda limit: mapped(
        scene("gyro_s1"), axes, DesignLimits(**{STIFFNESS: limit}, at_speed_only=True)
    )


def held_between(recommendation, name):
    """Values of an assumption between which the choice holds, and the one it has."""
    k = recommendation["assumption"].attrs["flag_meanings"].split().index(name)
    columns = ("holds_from", "assumed", "holds_to")
    return [float(recommendation[column][k]) for column in columns]


def test_machines_at_equal_stiffness(chosen):
    """A spring is better up to 4.8 N/um, a rigid pair above; both are as stiff as is asked."""
    _, soft = chosen(3.0)
    assert best_method(soft) == 0
    # in three digits of preload, on the side that keeps to the limit
    lesser = LIMITED[STIFFNESS].worst(soft)
    assert_allclose(lesser, 3e6, rtol=1e-2)
    assert (lesser >= 3e6).all()
    assert_allclose(LIMITED["axial_stiffness_N_um"].worst(soft), [3e6, 1.5e6], rtol=1e-2)
    low, _, high = held_between(soft, LIMIT_KEY + STIFFNESS)
    assert 4.6 < high < 5.0
    _, stiff = chosen(1.04 * high)
    assert best_method(stiff) == 1
    assert held_between(stiff, LIMIT_KEY + STIFFNESS)[0] == pytest.approx(high, rel=0.02)
    # which is less than 5 % away from either
    assert int(stiff["verdict"]) == NEITHER_LONGER and int(soft["verdict"]) == ONE_LONGER
    _, before = chosen(0.96 * high)
    assert best_method(before) == 0


def test_ends_of_life(scene):
    """Where a moved end of life makes both lives equal, solved anew there."""
    both = [
        scene_at(scene("gyro_s1"), m, 0.08, 30000.0, p)
        for m, p in zip(METHODS, (4.11, 6.37), strict=True)
    ]
    solved = [life_point(one, None)["life"] for one in both]
    room = {one.name: one for one in criteria_room(both, solved, 0)}
    end = room[END_KEY + "preload_fraction"]
    assert 0.3 < end.low < 0.4
    assert np.isnan(end.high)
    lives = []
    for one in both:
        at = one.with_({"wear.end_of_life.preload_fraction": end.low})
        lives.append(life_point(at, None)["life"])
    assert_allclose(lives[0], lives[1], rtol=1e-3)
    assert set(room) == {END_KEY + name for name in both[0].wear.end_of_life.criteria}


def test_friction_at_which_lives_are_equal(scene):
    """Lives go with one over the wear coefficient by either method, and not so with friction."""
    both = [scene_at(scene("gyro_s1"), method, 0.08, 30000.0, 7.0) for method in METHODS]
    lives = [printed_life(one) for one in both]
    ends = (friction_end(both, lives, 1, up) for up in (False, True))
    room = {one.name: one for one in friction_room(both[0], *ends)}
    wear, mu = room[WEAR_KEY], room[FRICTION_KEY]
    assert np.isnan([wear.low, wear.high]).all() and wear.now > 0.0
    assert mu.now == 0.08 and np.isnan(mu.high)
    longest = []
    for value in (0.995 * mu.low, 1.005 * mu.low, mu.now, 4.0 * mu.now):
        moved = [one.with_({"friction.ball_race": value}) for one in both]
        longest.append(int(np.argmax([life_point(one, None)["life"] for one in moved])))
    assert longest == [0, 1, 1, 1]


def test_a_warm_inner_ring_at_which_lives_are_equal(scene):
    """It shortens the life of a fixed position; a spring's hardly changes."""
    both = [scene_at(scene("gyro_s1"), method, 0.08, 30000.0, 7.0) for method in METHODS]
    lives = [printed_life(one) for one in both]
    kelvin = warm_end(both, lives, 1)
    warm = [
        [one.with_({"temperature.inner_ring_C": 20.0 + k}) for one in both]
        for k in (kelvin - 0.1, kelvin + 0.1)
    ]
    assert [np.argmax([printed_life(one) for one in pair]) for pair in warm] == [1, 0]
    # the other way round nothing is reversed
    assert np.isnan(warm_end(both[::-1], [lives[1] * 0.5, lives[0]], 1))


def test_what_turns_a_choice_round_within_five_per_cent_is_not_claimed():
    held = [Assumption(name="far", low=0.9, now=1.0, high=1.2), Assumption(name="none", now=1.0)]
    below = Assumption(name="below", low=0.96, now=1.0)
    above = Assumption(name="above", now=1.0, high=1.04)
    exact = [0.0, 0.0]
    assert verdict_on([2.0, 1.9], exact, held) == ONE_LONGER
    assert verdict_on([1.9, 2.0], exact, [*held, below]) == NEITHER_LONGER
    assert verdict_on([1.9, 2.0], exact, [*held, above]) == NEITHER_LONGER
    # numerical errors
    assert verdict_on([2.0, 1.9], [0.03, 0.03], held) == NEITHER_LONGER
    assert verdict_on([2.0, np.nan], exact, []) == NO_COMPARISON
    assert verdict_on([0.0, 0.0], exact, []) == NO_COMPARISON
