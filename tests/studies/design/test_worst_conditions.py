"""A recommendation names the cases, speeds and wear in which its requirements decide."""

import json

import numpy as np
import pytest
import xarray as xr

import bearingwear
from bearingwear.document.bearing_line import bearing_line, scenes_by_case
from bearingwear.studies.design.choice import ACTIVE, NO_PRELOAD, UNLIMITED
from bearingwear.studies.design.document.sentences import none_title
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
METHODS = {"flag_values": [0, 1], "flag_meanings": "constant_force fixed_position"}
COLD = {"id": "temperature_left_out", "sentence": "temperature is neglected", "advice": "set it"}
HIGH = {"id": "high", "sentence": "it is high", "advice": "mind it"}


@pytest.fixture(scope="module")
def scene():
    return bearingwear.new(designation="7008C", speed=18000.0)


def found_for(scene, where=None, limits=None, active=STIFFNESS, **values):
    """A recommendation of one method, with just what words are made of."""
    at = {"case": "fast", "speed_rpm": 3000.0, "temperature": "running", "bearing": 2,
          "wear": "new", "value": 20.0e6}  # fmt: skip
    deciding = {"system_axial_stiffness": at | (where or {}), "preload_kept": at, "life": at}
    known = {"system_axial_stiffness": 20.01e6, "system_quasistatic_axial_stiffness": 22e6}
    known |= {
        "preload_kept": 0.0101,
        "active_limit": ACTIVE.index(active),
        "preload": 17.5,
    } | values
    warnings = [COLD | {"in_cases": ["nominal"]}, HIGH | {"in_cases": ["slow", "fast"]}]
    return xr.Dataset(
        {name: ("preload_method", [value]) for name, value in known.items()},
        {"preload_method": ("preload_method", [1], METHODS)},
        {
            "scene": json.dumps(scene.to_dict()),
            "limits": json.dumps({STIFFNESS: 20.0} if limits is None else limits),
            "deciding": json.dumps([deciding]),
            "warnings": json.dumps(warnings),
        },
    )


def test_the_first_lines_name_cases_and_speeds(scene):
    alone, both = found_for(scene), found_for(scene.with_({"cases": CASES}))
    assert conditions_words(alone) == "from rest to 18000 r/min"
    assert conditions_words(both) == "worst of 3: nominal, slow, fast; from rest to 24000 r/min"
    slowest = found_for(scene.with_({"operation.lowest_speed_rpm": 2000.0}))
    assert conditions_words(slowest) == "from 2000 to 18000 r/min"
    only = found_for(scene.with_({"cases": CASES}), limits={STIFFNESS: 20.0, "at_speed_only": True})
    assert conditions_words(only).endswith("; at 500 to 24000 r/min only")


def test_the_headline_names_where_a_requirement_is_just_met(scene):
    alone, both = found_for(scene), found_for(scene.with_({"cases": CASES}))
    one = alone.isel(preload_method=0)
    said = limit_met_words(alone, one).replace("\N{NO-BREAK SPACE}", " ")
    assert said == "20 N/µm is just met at 3000 r/min, new, bearing 2"
    assert limit_met_words(both, one).endswith("at 3000 r/min, new, bearing 2 (case fast)")
    far = found_for(scene, system_axial_stiffness=21e6).isel(preload_method=0)
    assert limit_met_words(alone, far).startswith("limited by 20")
    free = found_for(scene, active=ACTIVE[UNLIMITED]).isel(preload_method=0)
    assert limit_met_words(alone, free) == ""
    lifted = found_for(scene, active="preload_kept").isel(preload_method=0)
    assert limit_met_words(alone, lifted) == (
        "below that, a bearing lifts off at 3000 r/min, new, bearing 2"
    )


def test_a_life_says_whose_it_is(scene):
    alone, both = found_for(scene), found_for(scene.with_({"cases": CASES}))
    one = alone.isel(preload_method=0)
    assert life_condition_words(alone, one).startswith("at 3000 r/min")
    assert "case fast, the shortest of 3" in life_condition_words(both, one)


def test_warnings_are_those_of_the_cases_that_have_them(scene):
    alone, both = found_for(scene), found_for(scene.with_({"cases": CASES}))
    assert [one["sentence"] for one in stated_warnings(both)] == ["cases slow, fast: it is high"]
    assert "temperature is neglected" in [one["sentence"] for one in stated_warnings(alone)]


def test_a_bearing_with_cases_is_described_from_case_to_case(scene):
    data = scene.with_({"cases": CASES}).to_dict()
    line = bearing_line(data)
    assert "500 to 24000 r/min" in line and line.endswith("; worst of 3: nominal, slow, fast")
    assert "temperatures given in fast" in line and "neglected" not in line
    plain = bearing_line(scene.to_dict())
    assert "; 18000 r/min;" in plain and "worst of" not in plain
    speeds = {
        name: one["operation"]["shaft_speed_rpm"] for name, one in scenes_by_case(data).items()
    }
    assert speeds == {"nominal": 18000.0, "slow": 500.0, "fast": 24000.0}


def test_a_method_without_a_preload_is_named_in_its_heading(scene):
    found = found_for(scene, active=ACTIVE[NO_PRELOAD])
    found = found.assign(life=("preload_method", [np.nan]))
    found.attrs[NONE_BECAUSE] = json.dumps({"fixed_position": "x"})
    assert none_title(found) == "Why no preload is recommended"
    found["life"][...] = 1.0
    assert none_title(found) == "Why no preload is recommended with fixed position"
