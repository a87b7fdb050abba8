"""Spring and rigid pair as machines: their map, what limits them, and how the sheet names them."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support import numbers_in, only_line, scene_file

from bearingwear.cli import main
from bearingwear.lives.life import life
from bearingwear.lives.many import HertzianLives
from bearingwear.results.netcdf import open_result
from bearingwear.scene.arrangement import with_method
from bearingwear.scene.checking.errors import SceneError
from bearingwear.solvers.bearing.arrangement import lowest_frequency
from bearingwear.solvers.solve import solve
from bearingwear.studies.design.document.sheets import recommendation_sheet
from bearingwear.studies.design.map import life_point
from bearingwear.studies.design.plan import DesignLimits
from bearingwear.studies.design.recommend import recommendation

METHODS = ("constant_force", "fixed_position")
# a rotor of 30 g on bearings 20 mm apart; a pair with it under 1 N; two bearings on one side of it
ROTOR = {"arrangement.rotor_mass_kg": 0.03, "arrangement.span_mm": 20.0}
PUSHED = {"arrangement.kind": "spring_pair", "arrangement.external_axial_N": 1.0} | ROTOR
UNLIKE = PUSHED | {"arrangement.tandem": [2, 1]}


@pytest.mark.parametrize("changes", [ROTOR | {"arrangement.kind": "spring_pair"}, PUSHED, UNLIKE])
@pytest.mark.parametrize("method", METHODS)
def test_frequencies_along_a_life_are_those_of_a_case(scene, changes, method):
    """When new, the lowest one is that of a solved case; along the life it is no higher.

    States of unlike bearings have it. A state that stands for both bearings of a symmetric pair has
    NaN, and the frequency is computed here.
    """
    preloaded = with_method(scene("gyro_s1", changes), method)
    new = HertzianLives(preloaded)(preloaded).states[0]
    frequency = new["lowest_frequency"]
    if np.isnan(frequency):
        frequency = lowest_frequency(preloaded, (new, new))
    case = solve(preloaded).values
    assert_allclose(frequency, case["natural_frequency"].min(), rtol=1e-5)
    assert life_point(preloaded, None)["lowest_frequency"] <= frequency * (1.0 + 1e-12)


def test_a_point_of_the_map_has_the_worst_values_along_a_life(scene):
    """They are the extremes over the history of `life`, and over both bearings of a pair."""
    rigid = with_method(scene("gyro_s1", PUSHED), "fixed_position", 9.0)
    point, values = life_point(rigid, None), life(rigid).values
    expected = {
        "life": values["life"],
        "loss_at_end": values["loss_at_end"].max(),
        "system_axial_stiffness": values["history_system_axial_stiffness"].min(),
        "rotor_axial_shift": np.abs(values["history_rotor_axial_shift"]).max(),
        "maximum_pressure": values["history_maximum_pressure"].max(),
    }
    for name, value in expected.items():
        assert_allclose(point[name], value, rtol=1e-5, err_msg=name)


@pytest.fixture(scope="module")
def recommended(scene):
    """Returns the recommendation for a pair whose rotor has no frequency below 2100 Hz.

    The other two limits are so wide that the frequency decides.
    """
    limits = DesignLimits(
        lowest_frequency_Hz=2100.0, rotor_shift_um=3.0, preload_kept=0.3, at_speed_only=True
    )
    return recommendation(scene("gyro_s1", PUSHED), limits)


def test_the_required_frequency_limits_spring_and_rigid_pair(scene, recommended):
    """Both pairs have 2100 Hz or more, but for rounding, and the life of a map at their preload."""
    assert (recommended["lowest_frequency"] >= 2100.0 * (1.0 - 1e-6)).all()
    names = recommended["active_limit"].attrs["flag_meanings"].split()
    limits = [names[int(k)] for k in recommended["active_limit"].values]
    assert limits == ["lowest_frequency_Hz"] * 2
    for k, method in enumerate(METHODS):
        preloaded = with_method(scene("gyro_s1", PUSHED), method, float(recommended["preload"][k]))
        life_h = life_point(preloaded, None)["life"] / 3600.0
        assert_allclose(life_h, recommended["life"][k], rtol=1e-9, err_msg=method)


def test_the_sheet_names_spring_and_rigid_pair_and_the_required_frequency(recommended, tmp_path):
    """The columns of its first table are the pairs, not the preload methods."""
    recommended.to_netcdf(tmp_path / "recommendation.nc")
    with open_result(tmp_path / "recommendation.nc") as file:
        sheet = recommendation_sheet(file)
    (table,) = (block for block in sheet.blocks_in("open") if block.rows)
    assert table.columns == ("spring pair", "rigid pair")
    (frequency,) = (text for text in sheet.facts["limits"] if "frequency" in text)
    assert numbers_in(frequency) == [2100.0]


@pytest.mark.parametrize("missing", ["arrangement.rotor_mass_kg", "arrangement.span_mm"])
def test_a_required_frequency_needs_mass_and_span(scene, missing, capsys):
    """The error names the missing key, in Python and in one line of the command."""
    rotor = {key: value for key, value in ROTOR.items() if key != missing}
    with pytest.raises(SceneError, match=missing):
        DesignLimits(lowest_frequency_Hz=1e3).check(scene("gyro_s1", rotor), "scene")
    options = [f"--set={key}={value}" for key, value in rotor.items()]
    assert main(["recommend", str(scene_file("gyro_s1")), "--frequency", "1000", *options]) == 2
    assert missing in only_line(capsys)
