"""Requirements on the thermal margin, and on the way to speed."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support import SLOW_HOUSING, warm_spindle

import bearingwear
from bearingwear.kernels import status as code
from bearingwear.measures import LIMITED
from bearingwear.scene.arrangement import with_method
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.design import map as design_map
from bearingwear.studies.design.conditions import DECIDING, WARMING, condition_words
from bearingwear.studies.design.map import NOT_SOLVED_AT, design_point, new_point
from bearingwear.studies.design.plan import DesignLimits, MapAxes
from bearingwear.studies.design.recommend import preload_map, recommendation
from bearingwear.studies.design.warm_up_extremes import warm_up_extremes


@pytest.fixture(scope="module")
def spindle():
    """Returns a rigid pair of 7008C, mounted with 140 N, for 12000 r/min, as `warm_spindle` has it.

    Its housing warms more slowly than its bearings.
    """
    return warm_spindle().with_(SLOW_HOUSING)


@pytest.mark.parametrize("point", [new_point, design_point])
def test_the_required_thermal_margin_of_a_point_is_that_of_the_case(spindle, point):
    """A new bearing and a life have it to 1e-3; it is least when new, at the full speed."""
    limits = DesignLimits(thermal_margin=1.5)
    values = point(spindle, limits)
    with pytest.warns(UserWarning, match="no interference fit"):  # `solve` warns of it here
        case = bearingwear.solve(spindle)
    condition = values[DECIDING]["thermal_margin"]
    assert condition["speed_rpm"] == 12000.0 and condition["wear"] == "new"
    assert_allclose(values["thermal_margin"], float(case["thermal_margin"]), rtol=1e-3)


def test_the_thermal_margin_along_a_quick_life_is_right_to_half_a_percent(spindle):
    """A quick life balances heat only roughly; a margin by differences over 1 mK would be wrong."""
    limits = DesignLimits(thermal_margin=1.5, at_speed_only=True)
    quick, exact = (design_point(spindle, limits, is_quick) for is_quick in (True, False))
    assert_allclose(quick["thermal_margin"], exact["thermal_margin"], rtol=5e-3)


STIFF_TO_THE_END = {
    "model.contact": "hertz",
    "wear.end_of_life": {"system_axial_stiffness_N_um": 45.0},
}
"""Ends a life by stiffness, so that more preload lives longer but has less thermal margin."""


def test_the_thermal_margin_falls_evenly_with_the_preload():
    """Margins at six preloads are within 0.5 % of a straight line.

    Computed heat jumps by 3e-4 of itself at some preloads. Differences over such jumps once made
    margins wrong by factors of 1.6 to 2.8.
    """
    scene = warm_spindle().with_(STIFF_TO_THE_END)
    limits = DesignLimits(thermal_margin=1.5, at_speed_only=True)
    preloads = (180.0, 190.0, 200.0, 220.0, 240.0, 260.0)
    margins = [
        design_point(scene.with_({"operation.preload_N": preload}), limits)["thermal_margin"]
        for preload in preloads
    ]
    assert np.all(np.diff(margins) < 0.0)
    slope, offset = np.polyfit(preloads, margins, 1)
    assert_allclose(margins, slope * np.array(preloads) + offset, rtol=5e-3)


REQUIRED = 6.25
"""Thermal margin that the rigid pair has at a preload somewhat above the 140 N of the scene."""


def flag_name(values):
    """Returns the name of the flag whose code a variable has."""
    return values.attrs["flag_meanings"].split()[int(values)]


@pytest.mark.long  # a search whose every state has its margin solved
def test_a_required_thermal_margin_limits_the_preload():
    """With 5 % more preload the pair would live longer, but with less than the required margin."""
    scene = warm_spindle().with_(STIFF_TO_THE_END)
    limits = DesignLimits(thermal_margin=REQUIRED, at_speed_only=True)
    rigid = PRELOAD_METHODS.index("fixed_position")
    recommended = recommendation(scene, limits).sel(preload_method=rigid)
    assert flag_name(recommended["active_limit"]) == "thermal_margin"
    # met to 1 %, as a recommended preload has three digits
    assert REQUIRED <= float(recommended["thermal_margin"]) < 1.01 * REQUIRED
    life_s = 3600.0 * float(recommended["life"])  # files have hours, points have seconds
    preload = 1.05 * float(recommended["preload"])
    more_preloaded = design_point(with_method(scene, "fixed_position", preload), limits)
    assert more_preloaded["life"] > life_s
    assert more_preloaded["thermal_margin"] < REQUIRED


def test_a_map_contains_the_thermal_margin_if_it_is_required():
    """It is that of a design point at each of three preloads."""
    scene = warm_spindle().with_(STIFF_TO_THE_END)
    preloads = (100.0, 140.0, 200.0)
    axes = MapAxes(
        preload_method=("fixed_position",),
        friction=(0.08,),
        shaft_speed_rpm=(12000.0,),
        preload_N=preloads,
    )
    limits = DesignLimits(thermal_margin=1.5, at_speed_only=True)
    margins = preload_map(scene, axes, limits)["thermal_margin"].values.ravel()
    expected = [
        design_point(scene.with_({"operation.preload_N": preload}), limits)["thermal_margin"]
        for preload in preloads
    ]
    assert_allclose(margins, expected)


def test_the_thermal_margin_is_unknown_where_it_is_not_required(spindle):
    """It is NaN, as it would take further solves."""
    point = new_point(spindle, DesignLimits(maximum_pressure_GPa=2.0))
    assert math.isnan(point["thermal_margin"])


def test_a_required_thermal_margin_does_not_end_the_life(spindle):
    """The life is the same with a required margin of 1000, which the pair misses by far.

    Lives agree to 1e-5, as the solves for the margin give those of the life other starting values.
    """
    expected = design_point(spindle, DesignLimits())["life"]
    required = design_point(spindle, DesignLimits(thermal_margin=1e3))["life"]
    assert_allclose(required, expected, rtol=1e-5)


def test_requirements_on_the_way_see_the_peaks_of_the_warm_up(spindle):
    """The peak pressure is that of the warm-up to 1 %; its time to 20 %, as the peak is flat.

    It is more than 5 % above the pressure of the warm bearings.
    """
    limits = DesignLimits(maximum_pressure_GPa=2.0, at_speed_only=True)
    warm, warming = (
        new_point(spindle, replace(limits, warmup_s=seconds)) for seconds in (None, 10.0)
    )
    warm_up = bearingwear.warmup(spindle, seconds=10.0)
    condition = warming[DECIDING]["maximum_pressure"]
    assert condition["temperature"] == WARMING and "warm-up" in condition_words(condition)
    assert warming["maximum_pressure"] > 1.05 * warm["maximum_pressure"]
    peak, time = warm_up["peak_maximum_pressure"], warm_up["peak_maximum_pressure_time"]
    assert_allclose(warming["maximum_pressure"], float(peak), rtol=1e-2)
    assert_allclose(condition["time_s"], float(time), rtol=0.2)


def test_no_warm_up_is_computed_where_a_requirement_is_broken_without_it(spindle, monkeypatch):
    """Warm bearings exceed the 0.1 GPa; a warm-up would call None and raise a TypeError."""
    monkeypatch.setattr(design_map, "warm_up_extremes", None)
    limits = DesignLimits(maximum_pressure_GPa=0.1, warmup_s=10.0, at_speed_only=True)
    point = new_point(spindle, limits)
    assert LIMITED["maximum_pressure_GPa"].worst(point) > 0.1e9


def spring_pair(spindle, **arrangement):
    """Returns a spring pair, 200 mm apart, whose shaft warms faster than its housing.

    Their time constants are 5 s and 600 s.

    arrangement: other values of that block.
    """
    spring = {"kind": "spring_pair", "span_mm": 200.0, "spring_stiffness_N_um": 0.1} | arrangement
    warm = {"shaft_C": 60.0, "shaft_time_constant_s": 5.0, "housing_C": 60.0}
    network = {f"thermal.{key}": value for key, value in warm.items()}
    network["thermal.housing_time_constant_s"] = 600.0
    changes = {"operation.preload_method": "constant_force", "arrangement": spring} | network
    return spindle.with_(changes)


def test_the_sliding_ring_needs_more_room_on_the_way_than_in_the_end(spindle):
    """Face to face, the shaft compresses the spring while it is warmer than the housing.

    Steel expands by 11.5e-6/K: 40 K over 200 mm are 92 um. A negative travel is a compression.
    """
    pair = spring_pair(spindle, orientation="face_to_face")
    warmed = bearingwear.warmup(pair, seconds=10.0)
    travel = warmed["spring_travel"].values
    assert travel.min() < -1e-4  # [m]; with the growth of the bearings, above 92 um
    assert abs(travel[-1]) < 3e-5  # [m]
    assert_allclose(float(warmed["peak_spring_compression"]), -travel.min())
    # 140 N as mounted; 0.1 N/um
    by_its_force = (140.0 - warmed["residual_preload"].isel(side=1).values) / 0.1e6
    assert_allclose(travel, by_its_force, atol=1e-9)
    limits = DesignLimits(spring_travel_um=100.0, at_speed_only=True)
    warm, warming = (new_point(pair, replace(limits, warmup_s=s)) for s in (None, 10.0))
    # a margin is 1 - travel/limit: less than half of 100 um warm, more than 150 um on the way
    assert LIMITED["spring_travel_um"].margins(warm, 100.0) > 0.5
    assert LIMITED["spring_travel_um"].margins(warming, 100.0) < -0.5
    condition = warming[DECIDING]["spring_travel"]
    assert condition["temperature"] == WARMING
    assert_allclose(condition["time_s"], float(warmed["peak_spring_compression_time"]), rtol=0.2)


def test_a_stop_that_the_spring_reaches_is_named(spindle):
    """The sheet of a warm-up names a stop at 100 um with its time; 200 um are not reached."""
    pair = spring_pair(spindle, orientation="face_to_face", stop_um=100.0)
    warmed = bearingwear.warmup(pair, seconds=10.0)
    text = str(bearingwear.show(warmed))
    reached = warmed["time"].values[np.argmax(warmed["spring_travel"].values < -1e-4)]
    assert f"stop_um 100 is reached after {reached:.3g} s" in " ".join(text.split())
    far_stop = spring_pair(spindle, orientation="face_to_face", stop_um=200.0)
    assert "stop_um" not in str(bearingwear.show(bearingwear.warmup(far_stop, seconds=10.0)))


def test_a_rigid_pair_has_no_spring_that_travels(spindle):
    """Its warm-up has no variable of travel; at a point of the map, the travel is zero."""
    warmed = bearingwear.warmup(spindle, seconds=10.0, duration=20.0)
    assert "spring_travel" not in warmed and "peak_spring_extension" not in warmed
    limits = DesignLimits(spring_travel_um=1.0, at_speed_only=True)
    assert new_point(spindle, limits)["spring_travel"] == 0.0


def test_a_bearing_that_lifts_off_on_the_way_breaks_the_requirement_that_none_does(spindle):
    """Back to back, the warm shaft unloads a stiff spring: less than 1 % of the preload is left.

    Wherever a warm-up counts, each bearing is required to keep 1 %, though no limit says so.
    """
    pair = spring_pair(spindle, span_mm=800.0, spring_stiffness_N_um=3.0)
    limits = DesignLimits(maximum_pressure_GPa=2.0, at_speed_only=True)
    assert new_point(pair, limits)["preload_kept"] > 0.5
    point = new_point(pair, replace(limits, warmup_s=10.0))
    condition = point[DECIDING]["preload_kept"]
    assert point["status"] == code.OK and point["preload_kept"] < 0.01
    assert condition["temperature"] == WARMING and 0.0 < condition["time_s"] < 10.0
    assert "preload_kept" in replace(limits, warmup_s=10.0).effective


def test_a_runaway_on_the_way_is_named(spindle):
    """In a housing that stays cold for long, the preload grows until no heat balance is left.

    The steady state, with a warm housing, has one. The point says when the last balance is lost.
    """
    late = spindle.with_(
        {
            "thermal.conductance_W_K": {
                "inner_ring_shaft": 0.2, "outer_ring_housing": 8.0, "ball_race": 0.5
            },
            "thermal.housing_C": 60.0,
            "thermal.housing_time_constant_s": 3000.0,
        }
    )  # fmt: skip
    limits = DesignLimits(at_speed_only=True)
    assert new_point(late, limits)["status"] == code.OK
    point = new_point(late, replace(limits, warmup_s=1.0))
    assert point["status"] != code.OK
    lost = point[NOT_SOLVED_AT]
    assert lost["temperature"] == WARMING and lost["time_s"] > 0.0


def test_a_warm_up_is_refused_without_heat_capacities(spindle):
    """So is a required thermal margin without a thermal network; the complete scene passes."""
    limits = DesignLimits(warmup_s=10.0)
    limits.check(spindle, "mine.yaml")
    with pytest.raises(SceneError, match="heat_capacity_J_K"):
        limits.check(spindle.with_({"thermal.heat_capacity_J_K": None}), "mine.yaml")
    with pytest.raises(SceneError, match="thermal"):
        DesignLimits(thermal_margin=1.5).check(spindle.with_({"thermal": None}), "mine.yaml")


def test_a_warm_up_in_python_follows_its_course_to_its_duration(spindle):
    """The course takes 5 s to 12000 r/min and lasts until 20 s; the inner ring never cools."""
    warmed = bearingwear.warmup(spindle, course=[(0.0, 0.0), (5.0, 12000.0)], duration=20.0)
    assert warmed["ending"].item() == "duration" and float(warmed["end_time"]) == 20.0
    peak = warmed["residual_preload"].max()
    assert_allclose(float(warmed["peak_residual_preload"]), float(peak))
    inner = warmed["part_temperature"].sel(part="inner_ring")
    assert np.all(np.diff(inner.isel(side=0)) >= 0.0)


def test_bearings_without_a_state_as_mounted_fail_the_warm_up_of_a_requirement(spindle):
    """60 um of wear are far more than the elastic approach of both races, a few um at 140 N."""
    worn = spindle.with_({"wear.ball_diameter_loss_um": 60.0})
    extremes = warm_up_extremes(worn, 10.0, quick=True)
    assert (extremes.extremes, extremes.status) == ({}, code.CONTACT_LOST)
    assert extremes.unsolved["status"] == "contact_lost" and extremes.unsolved["time_s"] == 0.0
