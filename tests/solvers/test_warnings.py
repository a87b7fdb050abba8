"""Absurd scenes are warned of, sane ones are not; where warnings appear."""

import json
import math
import re

import pytest
import yaml
from numpy.testing import assert_allclose
from support import ROOT, numbers_in, scene_file, warm_spindle

import bearingwear
from bearingwear.lives.life import life
from bearingwear.results.warnings import (
    merged_warnings,
    warning_lines,
    warnings_in,
)
from bearingwear.scene.read import variant
from bearingwear.scene.scene import SceneError
from bearingwear.solvers.effects.choice import choice
from bearingwear.solvers.effects.table import EFFECTS, WARNINGS
from bearingwear.solvers.effects.warnings import warnings_of
from bearingwear.solvers.solve import solve
from bearingwear.solvers.thermal import LOW_MARGIN

STEEL = {
    "youngs_modulus_GPa": 208, "poisson_ratio": 0.3, "density_kg_m3": 7800,
    "brinell_hardness_GPa": 6.6, "wear_coefficient": 5e-6,
}  # fmt: skip
SPINDLE = {
    "name": "spindle_7008C",
    "bearing": {
        "ball_count": 15, "ball_diameter_mm": 8.4, "pitch_diameter_mm": 54.0,
        "contact_angle_deg": 15.0, "inner_groove_factor": 0.52, "outer_groove_factor": 0.53,
        "ball_material": "steel", "race_material": "steel",
    },
    "materials": {"steel": STEEL},
    "operation": {
        "shaft_speed_rpm": 19000, "preload_method": "constant_force", "preload_N": 140,
    },
    "friction": {"ball_race": 0.08},
    "wear": {"end_of_life": {"gyroscopic_slip_share": 0.5}},
}  # fmt: skip
STEEP = {
    "model.normal_balance": "frictionless",  # as dynamic runs have it
    "bearing.ball_count": 10, "bearing.ball_diameter_mm": 8.1, "bearing.pitch_diameter_mm": 33.5,
    "bearing.contact_angle_deg": 40.0, "operation.shaft_speed_rpm": 30000,
    "operation.preload_N": 210,
}  # fmt: skip
AT_REST = {"operation.shaft_speed_rpm": 0, "wear.end_of_life.ball_diameter_loss_um": 0.01}
RADIAL = {"operation.radial_load_N": [0.0, -2000.0], "model.simulated_turns": 8}


@pytest.fixture(scope="module")
def spindle(tmp_path_factory):
    """Returns the path of a scene with the spindle bearing `SPINDLE`."""
    path = tmp_path_factory.mktemp("scenes") / "spindle.yaml"
    path.write_text(yaml.safe_dump(SPINDLE), encoding="utf-8")
    return path


def ids(result) -> set[str]:
    """Returns the ids of the warnings of a result."""
    return {warning["id"] for warning in warnings_in(result.attrs)}


# scenes and the warnings that they alone must cause
ABSURD = {
    "both rings turn": (
        {"operation.outer_speed_rpm": -18_000, "wear.end_of_life.gyroscopic_slip_share": 0.1},
        {"limit_passed"},
    ),
    "speed of a dentist's drill": (
        {"operation.shaft_speed_rpm": 200_000, "operation.preload_N": 2000},
        {"pressure_above_yield", "ellipse_over_shoulder", "speed_beyond_practice",
         "inner_load_lost"},
    ),
    "less preload than its maker prescribes": (
        {"bearing.designation": "7208AC", "operation.preload_N": 300}, {"preload_below_makers"},
    ),
    "faster than its maker allows": (
        {"bearing.maker": "NSK", "bearing.designation": "7012C"}, {"speed_beyond_makers"},
    ),
    "a ring that bursts": (
        {"operation.shaft_speed_rpm": 70_000, "operation.preload_N": 2000, "bearing.bore_mm": 40},
        {"pressure_above_practice", "hoop_stress"},
    ),
    "twenty kilonewtons": ({"operation.preload_N": 20_000}, {"pressure_above_practice"}),
    "kN typed for N": ({"operation.preload_N": 0.14}, {"preload_too_small", "inner_load_lost"}),
    "radians typed for degrees": ({"bearing.contact_angle_deg": 0.26}, {"contact_angle_too_small"}),
    "the nominal angle of a deep groove": (
        {"bearing.contact_angle_deg": 0, "operation.shaft_speed_rpm": 3000}, {"contact_angle_zero"},
    ),
    "K_s/H typed for K_s": (
        {"materials.steel.wear_coefficient": 7.6e-16}, {"unit_in_doubt"},
    ),
    "HRC typed for GPa": ({"materials.steel.brinell_hardness_GPa": 62}, {"unit_in_doubt"}),
    "interference in mm": (
        {"bearing.bore_mm": 40, "fits.shaft_interference_um": 0.008}, {"unit_in_doubt", "fit_lost"},
    ),
    "one newton at rest": (
        {"operation.preload_N": 1.0, "operation.shaft_speed_rpm": 100}, {"preload_too_small"},
    ),
    "too fast for its spring": ({"operation.preload_N": 10}, {"inner_load_lost"}),
    "rev/h typed for r/min": (
        {"operation.shaft_speed_rpm": 1.14e6}, {"speed_beyond_practice"},  # and not solved
    ),
    "worn through": ({"wear.ball_diameter_loss_um": 3.0}, {"groove_worn"}),
    "soft steel": ({"materials.steel.yield_pressure_GPa": 0.6}, {"pressure_above_yield"}),
    "low shoulders": ({"bearing.inner_shoulder_mm": 46.0}, {"ellipse_over_shoulder"}),
    "thrust through a low outer shoulder": (
        {"bearing.outer_shoulder_mm": 61.9, "operation.preload_N": 2000}, {"ellipse_over_shoulder"},
    ),
    "radial load that unloads balls": (
        RADIAL, {"radial_load_large", "inner_load_lost", "pressure_above_practice"},
    ),
    "a fixed position, cold and rigid": (
        {"operation.preload_method": "fixed_position", "bearing.bore_mm": 40},
        {"temperature_left_out", "preload_grown", "fit_left_out"},
    ),
    "a fixed position at speed": (
        {"operation.preload_method": "fixed_position"},
        {"temperature_left_out", "growth_left_out"},
    ),
    "a ring that comes loose": (
        {"bearing.bore_mm": 40, "fits.shaft_interference_um": 0.5, "fits.shaft_bore_mm": 30.0},
        {"fit_lost"},
    ),
    "60 000 r/min under a light spring": (
        {"operation.shaft_speed_rpm": 60_000}, {"inner_load_lost"},
    ),
    "a sputtered film on a fast spindle": (
        {"friction": {"film": {"shear_strength_MPa": 24.8, "wear_coefficient": 1e-6}}},
        {"film_too_fast", "limit_passed"},
    ),
    "friction of nothing": ({"friction.ball_race": 1e-4}, {"friction_beyond_practice"}),
    "friction of a seizure": (
        {"friction.ball_race": 1.2, "operation.shaft_speed_rpm": 3000},
        {"friction_beyond_practice"},
    ),
    "in liquid nitrogen": (
        {"temperature": dict.fromkeys(("inner_ring_C", "balls_C", "outer_ring_C"), -200)},
        {"temperature_beyond_practice"},
    ),
    "red hot": (
        {"temperature": dict.fromkeys(("inner_ring_C", "balls_C", "outer_ring_C"), 300)},
        {"temperature_beyond_practice"},
    ),
    "a radial load of twice the preload": (
        {"operation.radial_load_N": [0.0, -300.0], "model.simulated_turns": 8},
        {"radial_load_large"},
    ),
    "tilted by a degree": (
        {"operation.tilt_mrad": 10.0, "model.simulated_turns": 8},
        {"tilt_beyond_practice", "pressure_above_practice", "inner_load_lost"},
    ),
    "a turn in an hour": (
        {"operation.shaft_speed_rpm": 1.0 / 60.0}, set(),
    ),
    "a turn in an hour, regularised as at speed": (
        {"operation.shaft_speed_rpm": 1.0 / 60.0, "friction.slip_regularisation_m_s": 1e-4},
        {"slip_rounded"},
    ),
    "speed of `new`": ({"description": "Speed assumed: 19000 r/min."}, {"speed_assumed"}),
}  # fmt: skip


@pytest.mark.parametrize("name", ABSURD)
def test_an_absurd_scene_has_its_warnings_and_no_others(spindle, name):
    changes, expected = ABSURD[name]
    result = solve(variant(spindle, changes))
    assert ids(result) == expected
    for warning in warnings_in(result.attrs):
        assert warning["excess"] is None or warning["excess"] > 1.0


@pytest.mark.parametrize(("conductance", "is_low"), [(0.6, True), (2.0, False)])
def test_a_low_thermal_margin_is_warned_of(conductance, is_low):
    key = "thermal.conductance_W_K.inner_ring_shaft"
    result = solve(warm_spindle().with_({key: conductance, "model.contact": "hertz"}))
    assert (float(result.values["thermal_margin"]) < LOW_MARGIN) == is_low
    assert ("thermal_margin_low" in ids(result)) == is_low


def test_a_warning_names_the_pair(spindle):
    rigid = {"operation.preload_method": "fixed_position", "arrangement.kind": "rigid_pair"}
    scene = variant(spindle, rigid)
    sentences = {
        warning["id"]: warning["sentence"] for warning in warnings_of(scene, choice(scene))
    }
    assert "rigid pair" in sentences["temperature_left_out"]


@pytest.mark.parametrize(
    ("changes", "fidelity", "expected"),
    [
        (STEEP, None, {"over_limit_when_new", "ellipse_over_shoulder"}),
        ({"operation.radial_load_N": [0.0, -50.0], "operation.preload_N": 300,
          "wear.end_of_life.ball_diameter_loss_um": 0.01}, "race_control",
         {"criterion_not_watched"}),
        ({"wear.end_of_life.ball_diameter_loss_um": 2.0, "model.contact": "hertz"}, None,
         {"groove_worn"}),
        ({"wear.end_of_life.ball_diameter_loss_um": 2.0, "model.contact": "worn"}, None, set()),
        ({"wear.end_of_life.ball_diameter_loss_um": 0.01}, None, set()),
        (AT_REST, None, {"nothing_wears"}),
        (AT_REST | {"model.contact": "worn"}, None, {"nothing_wears"}),
        (AT_REST | {"wear.ball_diameter_loss_um": 0.01}, None, {"over_limit_when_new"}),
    ],
)  # fmt: skip
def test_a_life_has_its_warnings_and_no_others(spindle, changes, fidelity, expected):
    assert ids(life(variant(spindle, changes), fidelity)) == expected


def test_warnings_of_contacts_without_load_divide_by_nothing(spindle):
    """They can be written as JSON, which has no infinity."""
    scene = variant(spindle, {"wear.ball_diameter_loss_um": 3.0, "bearing.bore_mm": 40})
    values = dict(solve(scene).values)
    for name in ("contact_load", "semi_major_axis", "maximum_pressure"):
        values[name] = values[name] * [0.0, 1.0]
    warnings = warnings_of(scene, choice(scene), values)
    assert {warning["id"] for warning in warnings} == {"inner_load_lost", "groove_worn"}
    assert "Infinity" not in json.dumps(warnings) and "NaN" not in json.dumps(warnings)
    values["contact_load"] = values["contact_load"] * 0.0
    assert warnings_of(scene, choice(scene), values)


@pytest.mark.parametrize("shoulders", [{}, {"inner_shoulder_mm": 48.0, "outer_shoulder_mm": 60.0}])
def test_a_spindle_with_rings_has_no_warning(spindle, shoulders):
    rings = {"bore_mm": 40.0, "outside_diameter_mm": 68.0} | shoulders
    result = solve(variant(spindle, {f"bearing.{key}": value for key, value in rings.items()}))
    assert result.status == "ok" and ids(result) == set()


@pytest.mark.parametrize("name", ["gyro_s1", "turbopump"])
def test_scenes_of_the_project_have_no_warning(name):
    result = solve(variant(scene_file(name), {}))
    assert result.status == "ok" and ids(result) == set()


@pytest.mark.parametrize(
    ("preload_N", "expected"), [(10, ["inner_load_lost"]), (20_000, []), (140, [])]
)
def test_a_preload_that_the_speed_overcomes_is_marked_as_impractical(spindle, preload_N, expected):
    result = solve(variant(spindle, {"operation.preload_N": preload_N}))
    warnings = warnings_in(result.attrs)
    assert [warning["id"] for warning in warnings if warning["impractical"]] == expected


HOT = {"temperature": dict.fromkeys(("inner_ring_C", "balls_C", "outer_ring_C"), 150)}


def temperature_sentences(scene):
    """Returns the sentences of a scene's warnings of a temperature beyond practice."""
    warnings = warnings_of(scene, choice(scene))
    return [w["sentence"] for w in warnings if w["id"] == "temperature_beyond_practice"]


def test_a_cage_of_phenolic_bears_no_150_degrees(scene):
    (sentence,) = temperature_sentences(scene("gyro_s1", HOT | {"cage.material": "phenolic"}))
    assert "phenolic" in sentence


def test_rings_and_a_cage_of_steel_bear_150_degrees(scene):
    hot = scene("gyro_s1", HOT | {"cage.material": "bearing_steel"})
    assert temperature_sentences(hot) == []


def test_no_warning_of_skidding_at_rest(spindle):
    at_rest = {"operation.shaft_speed_rpm": 0.0, "operation.radial_load_N": [0.0, -600.0]}
    assert "inner_load_lost" not in ids(solve(variant(spindle, at_rest)))


def test_a_ball_without_load_reaches_no_shoulder():
    """Its contact angle would put its ellipse over the shoulder, which does not count."""
    loaded = {
        "operation.radial_load_N": [0.0, -60.0],
        "operation.shaft_speed_rpm": 3000.0,
        "bearing.inner_shoulder_mm": 5.7,
    }
    solved = solve(variant(scene_file("gyro_s1"), loaded), "race_control")
    load = solved.values["contact_load"][:, 0]
    assert (load == 0.0).any() and (load > 0.0).any()
    assert "ellipse_over_shoulder" not in ids(solved)


@pytest.mark.parametrize(
    ("changes", "fidelity", "expected"),
    [
        ({}, "dynamic", {"cage_weightless"}),
        ({}, "steady", set()),
        ({"operation.gravity_m_s2": [0.0, 0.0, -9.81]}, "dynamic", set()),
    ],
)
def test_a_weightless_cage_is_warned_of_where_the_cage_is_solved(changes, fidelity, expected):
    scene = variant(scene_file("gyro_s1"), changes)
    chosen = choice(scene, fidelity)
    assert {warning["id"] for warning in warnings_of(scene, chosen)} == expected
    reasons = [reason for reason in chosen.reasons if "weightless" in reason]
    assert len(reasons) == len(expected)


def test_every_warning_is_tested_and_documented():
    """docs/warnings.md lists each id, marked with an asterisk if it makes a design impractical.

    Each is expected by a scene of ABSURD, or by one of the tests that are named here.
    """
    page = (ROOT / "docs" / "warnings.md").read_text(encoding="utf-8")
    ids_of_warnings = [warning.id for warning in WARNINGS]
    marks = dict(re.findall(r"^- `(\w+)`(\\\*)?: ", page, re.MULTILINE))
    assert {name: bool(mark) for name, mark in marks.items()} == {
        warning.id: warning.impractical for warning in WARNINGS
    }
    of_absurd_scenes = set().union(*(expected for _, expected in ABSURD.values()))
    tested_otherwise = {
        # in this file
        "over_limit_when_new", "criterion_not_watched", "cage_weightless", "nothing_wears",
        "thermal_margin_low",
        "film_worn",  # tests/solvers/test_films.py
        "film_beyond_tests",  # tests/solvers/test_film_lives.py
        "motion_unstable",  # tests/solvers/test_stability.py
    }  # fmt: skip
    assert set(ids_of_warnings) - of_absurd_scenes == tested_otherwise
    assert len(set(ids_of_warnings)) == len(ids_of_warnings)


def test_effects_have_unique_ids_and_not_all_cause_a_warning():
    assert len({effect.id for effect in EFFECTS}) == len(EFFECTS)
    assert len(EFFECTS) > len(WARNINGS)


def test_hoop_stress_of_a_disc_with_a_tiny_hole(spindle):
    """It is twice that in the middle of a full disc, rho omega^2 b^2 (3 + nu)/8.

    To 0.5 %, as the hole is not infinitely small. The excess is over a limit of 200 MPa.
    """
    scene = variant(spindle, {"operation.shaft_speed_rpm": 90_000, "bearing.bore_mm": 1e-3})
    warnings = warnings_of(scene, choice(scene))
    (hoop_stress,) = (warning for warning in warnings if warning["id"] == "hoop_stress")
    omega, b = 90_000 * math.pi / 30.0, 0.5e-3 * (54.0 - 8.4)
    full_disc = 7800 * omega**2 * b**2 * 3.3 / 8.0
    assert_allclose(hoop_stress["excess"] * 200e6, 2.0 * full_disc, rtol=5e-3)


@pytest.mark.parametrize(("ring", "k", "outwards"), [("inner", 0, 1.0), ("outer", 1, -1.0)])
def test_an_ellipse_is_warned_of_from_where_its_edge_reaches_the_shoulder(
    spindle, ring, k, outwards
):
    """The shoulder is 1 um to either side of the edge, whose radius is computed here [mm]."""
    values = solve(variant(spindle, {})).values
    groove_radius = 8.4 * (0.52, 0.53)[k]
    edge_angle = (
        values["contact_angle"][0, k] + 1e3 * values["semi_major_axis"][0, k] / groove_radius
    )
    centre = 27.0 + 8.4 * (0.02, -0.03)[k] * math.cos(math.radians(15.0))
    edge_radius = centre - outwards * groove_radius * math.cos(edge_angle)
    for room, expected in ((1e-3, set()), (-1e-3, {"ellipse_over_shoulder"})):
        shoulder = {f"bearing.{ring}_shoulder_mm": 2.0 * edge_radius + outwards * room}
        assert ids(solve(variant(spindle, shoulder))) == expected


@pytest.mark.parametrize(
    ("key", "value", "allowed"),
    [
        ("bore_mm", 46, "< 45.6"),
        ("inner_shoulder_mm", 45, "> 45.6 and < 54"),
        ("outer_shoulder_mm", 63, "> 54 and < 62.4"),
        ("outside_diameter_mm", 62, "> 62.4"),
    ],
)
def test_rings_that_do_not_fit_are_refused(spindle, key, value, allowed):
    with pytest.raises(SceneError, match=f"bearing.{key}: got {value} .*number {allowed}$"):
        variant(spindle, {f"bearing.{key}": value})


# where warnings appear


def test_a_tiny_radial_load_does_not_change_how_a_life_ends(spindle):
    """With 1 mN of radial load the life ends at once by slip, as it does under thrust alone."""
    thrust = life(variant(spindle, STEEP))
    tiny_load = {"operation.radial_load_N": [0.0, -0.001], "model.simulated_turns": 4}
    loaded = life(variant(spindle, STEEP | tiny_load))
    assert loaded.attrs["fidelity"] == "dynamic" and thrust.attrs["fidelity"] == "steady"
    assert loaded.values["life"] == thrust.values["life"] == 0.0
    assert ids(loaded) == ids(thrust) and "over_limit_when_new" in ids(loaded)


REGULARISATION = "friction.slip_regularisation_m_s"


def test_friction_that_is_rounded_away_is_warned_of_with_a_finer_regularisation(scene):
    """At 50 r/min the torque is a third of what it is without rounding.

    With the advised regularisation it is within 0.2 % of that with half of it.
    """
    slow = scene("gyro_s1", {"operation.shaft_speed_rpm": 50.0})
    rounded = solve(slow)
    (warning,) = warnings_in(rounded.attrs)
    assert warning["id"] == "slip_rounded" and warning["excess"] > 10.0
    assert REGULARISATION in warning["advice"]
    (advised,) = numbers_in(warning["advice"])
    finer, finest = (solve(slow.with_({REGULARISATION: k * advised})) for k in (1.0, 0.5))
    torque = finest.values["shaft_torque"]
    assert ids(finer) == set()
    assert_allclose(finer.values["shaft_torque"], torque, rtol=2e-3)
    assert rounded.values["shaft_torque"] < 0.5 * torque
    lost = 1.0 - rounded.values["shaft_torque"] / torque
    assert_allclose(rounded.values["torque_lost_to_regularisation"], lost, rtol=1e-3)
    assert float(f"{100.0 * lost:.3g}") in numbers_in(warning["sentence"])
    assert "torque_lost_to_regularisation" not in finer.values
    # half of the regularisation estimates small errors, and not this one
    assert "shaft_torque_error_estimate" not in rounded.values
    assert finer.values["shaft_torque_error_estimate"] < 0.01


@pytest.mark.parametrize("fidelity", ["steady", "race_control"])
@pytest.mark.parametrize("rpm", [10.0, 40.0, 60.0, 120.0])
def test_the_torque_that_regularisation_takes_is_solved_for(spindle, fidelity, rpm):
    """The share that 1e-4 m/s takes is stored, to 3e-4; one of less than 6 % is not.

    The torque without rounding is that of a regularisation of 1e-8 m/s.
    """

    def values(v_r):
        changes = {"operation.shaft_speed_rpm": rpm, REGULARISATION: v_r}
        return solve(variant(spindle, changes), fidelity).values

    coarse, finest = values(1e-4), values(1e-8)
    lost = 1.0 - coarse["shaft_torque"] / finest["shaft_torque"]
    if "torque_lost_to_regularisation" in coarse:
        assert_allclose(coarse["torque_lost_to_regularisation"], lost, atol=3e-4)
    else:
        assert lost < 0.06


def test_python_warns(spindle):
    """A warning names the scene and the file of the caller. The life has two of them."""
    scene = variant(spindle, {"operation.preload_N": 20_000})
    with pytest.warns(
        UserWarning, match=r"^spindle_7008C: .*pressure .*3\.3\d GPa .*2 GPa"
    ) as caught:
        result = bearingwear.solve(scene)
    assert len(caught) == 1 and caught[0].filename == __file__
    assert json.loads(result.attrs["warnings"])[0]["id"] == "pressure_above_practice"
    with (
        pytest.warns(UserWarning, match="criterion .*when new"),
        pytest.warns(UserWarning, match="beyond the assumed shoulder"),
    ):
        bearingwear.life(variant(spindle, STEEP))


def test_warnings_of_several_cases_are_counted_and_shown_at_their_worst():
    """Three of four cases have it; merged twice, six of eight. The largest excess is shown."""
    small, large = (
        {"warnings": json.dumps([{"id": "groove_worn", "sentence": s, "advice": "a", "excess": x}])}
        for s, x in (("small", 2.0), ("large", 7.0))
    )
    merged = {"warnings": merged_warnings([small, {}, large, small])}
    (warning,) = warnings_in(merged)
    assert warning["cases"] == 3 and warning["sentence"] == "large"
    (line,) = warning_lines(merged)
    assert numbers_in(line) == [3.0] and line.endswith("large; a")
    merged_twice = merged_warnings([merged, merged])
    assert warnings_in({"warnings": merged_twice})[0]["cases"] == 6
