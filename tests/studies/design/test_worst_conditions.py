"""A recommendation names the cases, speeds and wear in which its requirements decide."""

import json

import numpy as np
import pytest
import xarray as xr
from support import numbers_in

import bearingwear
from bearingwear.document.bearing_line import bearing_line, scenes_by_case, warning_with_cases
from bearingwear.studies.design.choice import ACTIVE, NO_PRELOAD, UNLIMITED
from bearingwear.studies.design.document.sentences import no_preload_title
from bearingwear.studies.design.document.words import NONE_BECAUSE
from bearingwear.studies.design.document.worst_conditions import (
    conditions_words,
    life_condition_words,
    limit_met_words,
    stated_warnings,
)

STIFFNESS = "system_axial_stiffness_N_um"
CASES = {
    "slow": {"operation.shaft_speed_rpm": 500.0},
    "fast": {"operation.shaft_speed_rpm": 24000.0, "temperature.inner_ring_C": 40.0},
}
METHOD_FLAGS = {"flag_values": [0, 1], "flag_meanings": "constant_force fixed_position"}
# warnings of a scene
COLD = {"id": "temperature_left_out", "sentence": "temperature is neglected", "advice": "set it"}
HIGH = {"id": "high", "sentence": "it is high", "advice": "mind it"}


@pytest.fixture(scope="module")
def scene():
    """Returns a bearing at 18000 r/min, here in place of the fixture of tests/conftest.py."""
    return bearingwear.new(designation="7008C", speed=18000.0)


def recommended_for(scene, limits=None, active=STIFFNESS, **values):
    """Returns a recommendation of a fixed position, with only the values that sentences use.

    The second bearing, new, at 3000 r/min in the case `fast`, decides everything.

    limits: requirements by key; 20 N/um of the system if omitted. active: name in `ACTIVE` of what
    forbids a longer life. values: of other variables.
    """
    where = {"case": "fast", "speed_rpm": 3000.0, "temperature": "running", "bearing": 2,
             "wear": "new", "value": 20.0e6}  # fmt: skip
    deciding = dict.fromkeys(("system_axial_stiffness", "preload_kept", "life"), where)
    numbers = {
        "system_axial_stiffness": 20.01e6,  # the requirement of 20 N/um is just met
        "system_quasistatic_axial_stiffness": 22e6,
        "preload_kept": 0.0101,
        "active_limit": ACTIVE.index(active),
        "preload": 17.5,
    } | values
    warnings = [COLD | {"in_cases": ["nominal"]}, HIGH | {"in_cases": ["slow", "fast"]}]
    return xr.Dataset(
        {name: ("preload_method", [value]) for name, value in numbers.items()},
        {"preload_method": ("preload_method", [1], METHOD_FLAGS)},
        {
            "scene": json.dumps(scene.to_dict()),
            "limits": json.dumps({STIFFNESS: 20.0} if limits is None else limits),
            "deciding": json.dumps([deciding]),
            "warnings": json.dumps(warnings),
        },
    )


def test_the_first_lines_name_cases_and_speeds(scene):
    """Without cases, they say from rest to the 18000 r/min of the scene.

    With two cases beside the nominal one, they have number and names of all, and the highest speed.
    """
    words = conditions_words(recommended_for(scene))
    assert "rest" in words and numbers_in(words) == [18000.0]
    words = conditions_words(recommended_for(scene.with_({"cases": CASES})))
    assert "nominal, slow, fast" in words and numbers_in(words) == [3.0, 24000.0]


def test_the_first_lines_name_the_lowest_speed_in_place_of_rest(scene):
    slowest = recommended_for(scene.with_({"operation.lowest_speed_rpm": 2000.0}))
    assert numbers_in(conditions_words(slowest)) == [2000.0, 18000.0]


def test_the_first_lines_name_the_speeds_of_cases_if_no_others_were_checked(scene):
    """Requirements apply at the speed of each case alone: the lowest and the highest are named."""
    limits = {STIFFNESS: 20.0, "at_speed_only": True}
    words = conditions_words(recommended_for(scene.with_({"cases": CASES}), limits=limits))
    assert numbers_in(words)[-2:] == [500.0, 24000.0] and "rest" not in words


def limit_words(recommended):
    """Returns the words of the headline for the limit that the recommended preload meets."""
    return limit_met_words(recommended, recommended.isel(preload_method=0))


def test_the_headline_names_where_a_requirement_is_just_met(scene):
    """It names speed, wear and bearing, and the case if there are several."""
    words = limit_words(recommended_for(scene))
    assert numbers_in(words) == [20.0, 3000.0, 2.0] and "new" in words  # N/um, r/min, bearing
    assert "case" not in words
    assert limit_words(recommended_for(scene.with_({"cases": CASES}))).endswith("(case fast)")


def test_the_headline_does_not_call_a_limit_just_met_that_is_exceeded(scene):
    """The stiffness is 21 N/um in place of 20.01, and 20 N/um are required; the place is named."""
    words = limit_words(recommended_for(scene, system_axial_stiffness=21e6))
    assert words.startswith("limited by 20") and "just met" not in words
    assert 3000.0 in numbers_in(words)


def test_the_headline_names_no_limit_where_none_is_met(scene):
    """The words are empty if nothing forbids a longer life."""
    assert limit_words(recommended_for(scene, active=ACTIVE[UNLIMITED])) == ""


def test_the_headline_names_the_bearing_that_lifts_off(scene):
    words = limit_words(recommended_for(scene, active="preload_kept"))
    assert "lifts off" in words and numbers_in(words) == [3000.0, 2.0]


def test_a_life_names_the_speed_and_the_case_in_which_it_is_the_shortest(scene):
    """The words have the 3000 r/min and, with three cases, the name `fast` and their number."""
    of_scene = recommended_for(scene)
    best = of_scene.isel(preload_method=0)  # the only method
    assert numbers_in(life_condition_words(of_scene, best))[0] == 3000.0
    words = life_condition_words(recommended_for(scene.with_({"cases": CASES})), best)
    assert "case fast" in words and 3.0 in numbers_in(words)  # of three cases


def test_warnings_are_those_of_the_cases_that_have_them(scene):
    """The nominal case neglects temperatures; another warning is of the cases `slow` and `fast`."""
    cold, high = stated_warnings(recommended_for(scene.with_({"cases": CASES})))
    assert cold["id"] == "temperature_left_out"
    assert cold["sentence"].startswith("case nominal: ")  # `fast` has temperatures
    assert high["id"] == "high" and "slow, fast" in high["sentence"]


def test_warnings_of_a_scene_without_cases_name_none(scene):
    assert stated_warnings(recommended_for(scene))[0]["sentence"] == COLD["sentence"]


def test_a_warning_of_neglected_temperatures_names_the_cases_without_any(scene):
    """Where no case has temperatures, the warning stays as it is, without names."""
    warning = warning_with_cases(COLD, scene.with_({"cases": CASES}).to_dict())
    assert warning["sentence"].startswith("cases nominal, slow: ")
    all_cold = scene.with_({"cases": {"slow": CASES["slow"]}}).to_dict()
    assert warning_with_cases(COLD, all_cold) == COLD


def test_a_bearing_with_cases_is_described_from_case_to_case(scene):
    """The line has the lowest and the highest speed of cases and their names, or the one speed."""
    data = scene.with_({"cases": CASES}).to_dict()
    line = bearing_line(data)
    assert "500 to 24000 r/min" in line and line.endswith("nominal, slow, fast")
    assert "neglected" not in line  # a case has temperatures
    assert "; 18000 r/min;" in bearing_line(scene.to_dict())
    speeds = {
        name: value["operation"]["shaft_speed_rpm"] for name, value in scenes_by_case(data).items()
    }
    assert speeds == {"nominal": 18000.0, "slow": 500.0, "fast": 24000.0}


def test_a_heading_names_the_method_without_a_preload_if_another_has_one(scene):
    """The heading names the fixed position if a life of 1 h exists, but not if all are NaN."""
    recommended = recommended_for(scene, active=ACTIVE[NO_PRELOAD])
    recommended = recommended.assign(life=("preload_method", [np.nan]))
    recommended.attrs[NONE_BECAUSE] = json.dumps({"fixed_position": "x"})
    assert "fixed position" not in no_preload_title(recommended)
    recommended["life"][...] = 1.0
    assert no_preload_title(recommended).endswith("fixed position")
