"""What would change the choice: values at which the other method lives longer, solved there."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bearingwear.measures import LIMITED
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.design.changes import LIMIT_KEY, WARMTH_KEY, choice_changes, quick_life
from bearingwear.studies.design.plan import DesignLimits
from bearingwear.studies.design.recommend import best_method, recommendation

STIFFNESS = "system_axial_stiffness_N_um"


def change_in(found, name):
    k = found["change"].attrs["flag_meanings"].split().index(name)
    columns = ("other_better_below", "value_now", "other_better_above")
    return [float(found[column][k]) for column in columns]


@pytest.fixture(scope="module")
def chosen(scene):
    """Function of a limit of system stiffness -> the recommendation of gyro_s1."""
    gyro = scene("gyro_s1")
    return lambda limit: recommendation(
        gyro, DesignLimits(**{STIFFNESS: limit}, at_speed_only=True)
    )


def test_machines_at_equal_stiffness(chosen):
    """A spring is better up to 4.8 N/um, a rigid pair above; both are as stiff as is asked."""
    soft = chosen(3.0)
    assert best_method(soft) == 0
    # in three digits of preload, on the side that keeps to the limit
    lesser = LIMITED[STIFFNESS].worst(soft)
    assert_allclose(lesser, 3e6, rtol=1e-2)
    assert (lesser >= 3e6).all()
    below, _, above = change_in(soft, LIMIT_KEY + STIFFNESS)
    assert 4.6 < above < 5.0 and math.isnan(below)
    assert best_method(chosen(1.04 * above)) == 1
    assert best_method(chosen(0.96 * above)) == 0


@pytest.mark.parametrize("name", ["torque_margin", "gap_um"])
def test_a_requirement_of_zero_is_not_varied(name):
    """Other values are tried as factors of the present one: zero (`--torque-margin 0`) stays."""
    limits = DesignLimits(**{name: 0.0})
    search = SimpleNamespace(limits=limits, lines=["spring pair", "rigid pair"])
    no_spring_pair, rigid_pair = None, SimpleNamespace(life=1.0)
    assert choice_changes(search, [no_spring_pair, rigid_pair]) == []


def test_the_warmth_at_which_lives_are_equal(scene, chosen):
    """At the recommended preloads; the choice is the other way round just beyond."""
    choice = chosen(5.0)
    assert best_method(choice) == 1
    below, now, above = change_in(choice, WARMTH_KEY)
    assert math.isnan(below) and now == 0.0
    both = [
        held_by(scene("gyro_s1"), method, float(choice["preload"][k]))
        for k, method in enumerate(PRELOAD_METHODS)
    ]
    longest = []
    for kelvin in (0.9 * above, 1.1 * above):
        moved = [item.with_({"temperature.inner_ring_C": 20.0 + kelvin}) for item in both]
        longest.append(int(np.argmax([quick_life(one)["life"] for one in moved])))
    assert longest == [1, 0]


def test_no_warmth_is_tried_where_a_thermal_expansion_is_missing(scene):
    """As for balls and races of different materials; the rest is tried without it."""
    steel = vars(scene("gyro_s1").materials["bearing_steel"])
    ceramic = {key: value for key, value in steel.items() if value is not None}
    ceramic.pop("thermal_expansion_1_K", None)
    hybrid = scene("gyro_s1").with_(
        {"materials.ceramic": ceramic, "bearing.ball_material": "ceramic"}
    )
    limits = DesignLimits(**{STIFFNESS: 3.0}, at_speed_only=True)
    tried = recommendation(hybrid, limits)["change"].attrs["flag_meanings"].split()
    assert "friction.ball_race" in tried and WARMTH_KEY not in tried
