"""Limits hold in every case of a scene: the recommendation against every preload of a fine grid."""

import json

import numpy as np
import pytest

import bearingwear
from bearingwear.document.text import as_text
from bearingwear.measures import LIMITED
from bearingwear.scene.arrangement import with_method
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.design.choice import limit_margins
from bearingwear.studies.design.document.sheets import preload_document
from bearingwear.studies.design.machine import MACHINE
from bearingwear.studies.design.map import design_point, new_point
from bearingwear.studies.design.plan import DesignLimits
from bearingwear.studies.design.recommend import WORST_CASES, recommendation

pytestmark = pytest.mark.long  # a search in three cases; one in two: test_condition_extremes.py

LIMITS = DesignLimits(launch_g=30.0, torque_margin=0.5)
"""No bearing opens up to 30 g, and the drive has half as much torque again as is needed."""


@pytest.fixture(scope="module")
def scene():
    """Returns a rigid pair with the cases `cold` and `hot` beside the nominal one.

    Inner rings are 1 K colder than outer rings in `cold`, and 2 K warmer in `hot`. The scene has a
    launch and a drive, to which LIMITS apply. Contacts are Hertzian.
    """
    plain = bearingwear.new(
        designation="7001C", maker="NSK", preload_class="L", speed=3000.0, friction=0.1,
        preload_method="fixed_position",
    )  # fmt: skip
    arrangement = {"kind": "rigid_pair", "rotor_mass_kg": 0.5, "span_mm": 25.0}
    temperatures = {  # [degC]
        "cold": {"inner_ring_C": -31.0, "balls_C": -30.5, "outer_ring_C": -30.0},
        "hot": {"inner_ring_C": 62.0, "balls_C": 61.0, "outer_ring_C": 60.0},
    }
    cases = {
        name: {f"temperature.{part}": C for part, C in values.items()}
        for name, values in temperatures.items()
    }
    return plain.with_(
        {f"arrangement.{key}": value for key, value in arrangement.items()}
        | {
            "launch.axial_g": 30.0,
            "launch.radial_g": 30.0,
            "drive.torque_Nm": 0.03,
            "launch.after_wear_um": 0.05,
        }
        | {"cases": cases, "model.contact": "hertz", "friction.ball_race": 0.1}
        | {"uncertainty": {"wear_scatter": {"distribution": "lognormal", "factor": 1.3}}}
    )


@pytest.fixture(scope="module")
def recommended(scene):
    """Returns the recommendation for the pair within LIMITS, by both preload methods."""
    return recommendation(scene, LIMITS)


def worst_cases(points):
    """Returns the names of the cases with the worst values, by `life` and extremes of measures.

    The worst is the least of a measure that falls, or the largest magnitude. An extreme that is not
    known in all cases is left out.

    points: design points by the names of cases.
    """
    names, by_case = list(points), list(points.values())
    worst = {"life": names[int(np.argmin([point["life"] for point in by_case]))]}
    for measure in LIMITED.values():
        for name in measure.extremes:
            values = np.array([point[name] for point in by_case])
            if np.isfinite(values).all():
                k = np.argmin(values) if measure.falls else np.argmax(np.abs(values))
                worst[name] = names[int(k)]
    return worst


def points_by_case(scene, method, preload):
    """Returns the design points of a preload [N], by the names of cases."""
    in_cases = with_method(scene, method, preload).in_cases
    return {name: design_point(case, LIMITS) for name, case in in_cases.items()}


def is_within_limits(point):
    """Returns whether no margin of LIMITS is negative."""
    return min(map(float, limit_margins(point, LIMITS))) >= 0.0


def shortest_life(points):
    """Returns the shortest life [s] of design points by the names of cases."""
    return min(float(point["life"]) for point in points.values())


@pytest.mark.parametrize("k", range(2))
def test_no_preload_within_all_limits_in_all_cases_lives_longer(scene, recommended, k):
    """None of four preloads from 20 to 120 N does so by more than 1 %, if practical in all cases.

    Without a recommended preload, none of the four may be allowed.

    k: of the preload method in the recommendation.
    """
    method, longest = PRELOAD_METHODS[int(recommended["preload_method"][k])], 0.0
    for preload in np.geomspace(20.0, 120.0, 4).tolist():
        points = points_by_case(scene, method, preload)
        practical = not any(point["impractical"] for point in points.values())
        if practical and all(map(is_within_limits, points.values())):
            longest = max(longest, shortest_life(points))
    if np.isnan(recommended["preload"][k]):
        assert longest == 0.0  # none of the four was allowed
    else:
        assert 3600.0 * float(recommended["life"][k]) >= 0.99 * longest


def test_the_recommended_preload_has_the_numbers_of_its_worst_cases(scene, recommended):
    """They are its life, the preload at its end, and the case of each worst value.

    For each method with a recommended preload, that preload satisfies all requirements in all
    cases.
    """
    solved = np.flatnonzero(np.isfinite(recommended["preload"]))
    assert solved.size
    for k in solved:
        point = recommended.isel(preload_method=k)
        method = PRELOAD_METHODS[int(point["preload_method"])]
        points = points_by_case(scene, method, float(point["preload"]))
        assert all(map(is_within_limits, points.values())), method
        life = shortest_life(points)
        assert 3600.0 * float(point["life"]) == pytest.approx(life, rel=1e-9)
        left = min(float(values["residual_preload_at_end"]) for values in points.values())
        assert float(point["residual_preload_at_end"]) == pytest.approx(left, rel=1e-9)
        assert json.loads(recommended.attrs[WORST_CASES])[k] == worst_cases(points)


def test_the_worst_case_is_named(recommended):
    """Cold bearings open at the least acceleration; hot ones leave the least margin of torque.

    The sheet names both cases. The margin of torque is the least over the corners of the machine.
    """
    k = int(np.flatnonzero(np.isfinite(recommended["preload"]))[0])
    worst = json.loads(recommended.attrs[WORST_CASES])[k]
    assert worst["opening_acceleration"] == "cold" and worst["torque_margin"] == "hot"
    text = " ".join(as_text(preload_document(recommended)).split())
    assert "worst corner: hot, new" in text and "Launch, 30 g axial, 30 g radial" in text
    machine = json.loads(recommended.attrs[MACHINE])[k]
    least = min(corner["margin"] for corner in machine["corners"])
    assert float(recommended["torque_margin"][k]) == pytest.approx(least, rel=1e-6)


def test_a_point_of_a_map_has_the_values_of_its_worst_cases(scene):
    """It has the least acceleration at which the pair opens (cold) and the highest pressure."""
    point = new_point(scene, LIMITS)
    by_case = {name: new_point(case, LIMITS) for name, case in scene.in_cases.items()}
    opening = {name: values["opening_acceleration"] for name, values in by_case.items()}
    assert point["opening_acceleration"] == min(opening.values()) == opening["cold"]
    assert opening["cold"] < opening["nominal"]
    pressures = [values["maximum_pressure"] for values in by_case.values()]
    assert point["maximum_pressure"] == max(pressures)
