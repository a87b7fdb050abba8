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

LIMITS = DesignLimits(launch_g=30.0, torque_margin=0.5)


@pytest.fixture(scope="module")
def scene():
    """A pair that is cold and stiff, or hot and tight, and grooves that stay as they are."""
    plain = bearingwear.new(
        designation="7001C", maker="NSK", preload_class="L", speed=3000.0, friction=0.1,
        preload_method="fixed_position",
    )  # fmt: skip
    arrangement = {"kind": "rigid_pair", "rotor_mass_kg": 0.5, "span_mm": 25.0}
    rings = {"inner_ring_C": 1.0, "balls_C": 0.5, "outer_ring_C": 0.0}
    at = {"cold": (-30.0, -1.0), "hot": (60.0, 2.0)}
    cases = {
        name: {f"temperature.{key}": C + share * K for key, share in rings.items()}
        for name, (C, K) in at.items()
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
    return recommendation(scene, LIMITS)


def worst_of(points):
    """Of each quantity that is known in all cases, the case that has the worst value."""
    names = list(points)
    result = {"life": names[int(np.argmin([item["life"] for item in points.values()]))]}
    for measure in LIMITED.values():
        for name in measure.extremes:
            by_case = np.array([point[name] for point in points.values()])
            if np.isfinite(by_case).all():
                result[name] = names[
                    int(np.argmin(by_case) if measure.falls else np.argmax(np.abs(by_case)))
                ]
    return result


def test_the_recommendation_is_the_best_of_every_preload_in_every_case(scene, recommended):
    for k, code in enumerate(recommended["preload_method"].values):
        method, best = PRELOAD_METHODS[int(code)], 0.0
        for preload in np.geomspace(20.0, 120.0, 4).tolist():
            points = [
                design_point(o, LIMITS)
                for o in with_method(scene, method, preload).in_cases.values()
            ]
            kept = all(min(map(float, limit_margins(item, LIMITS))) >= 0.0 for item in points)
            if kept and not any(point["impractical"] for point in points):
                best = max(best, min(float(point["life"]) for point in points))
        recommended_preload = float(recommended["preload"][k])
        if np.isnan(recommended_preload):
            assert best == 0.0, method
            continue
        points = {
            name: design_point(case, LIMITS)
            for name, case in with_method(scene, method, recommended_preload).in_cases.items()
        }
        for name, point in points.items():
            assert min(map(float, limit_margins(point, LIMITS))) >= 0.0, (method, name)
        life = min(float(point["life"]) for point in points.values())
        assert 3600.0 * float(recommended["life"][k]) == pytest.approx(life, rel=1e-9)
        assert life >= 0.99 * best
        left = min(float(point["residual_preload_at_end"]) for point in points.values())
        assert float(recommended["residual_preload_at_end"][k]) == pytest.approx(left, rel=1e-9)
        assert json.loads(recommended.attrs[WORST_CASES])[k] == worst_of(points)
    assert np.isfinite(recommended["preload"]).any()


def test_the_worst_case_is_named(recommended):
    k = int(np.flatnonzero(np.isfinite(recommended["preload"]))[0])
    worst = json.loads(recommended.attrs[WORST_CASES])[k]
    assert worst["opening_acceleration"] == "cold" and worst["torque_margin"] == "hot"
    text = " ".join(as_text(preload_document(recommended)).split())
    assert "worst corner: hot, new" in text and "Launch, 30 g axial, 30 g radial" in text
    asked = json.loads(recommended.attrs[MACHINE])[k]
    least = min(corner["margin"] for corner in asked["corners"])
    assert float(recommended["torque_margin"][k]) == pytest.approx(least, rel=1e-6)


def test_without_its_cases_the_scene_may_take_less_preload(scene, recommended):
    """A point of a map is that of the worst case."""
    point = new_point(scene, LIMITS)
    case_points = [new_point(case, LIMITS) for case in scene.in_cases.values()]
    opening = [item["opening_acceleration"] for item in case_points]
    assert point["opening_acceleration"] == min(opening) == opening[1] < opening[0]
    assert point["maximum_pressure"] == max(
        case_point["maximum_pressure"] for case_point in case_points
    )
