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

ROTOR = {"arrangement.rotor_mass_kg": 0.03, "arrangement.span_mm": 20.0}
PUSHED = {"arrangement.kind": "spring_pair", "arrangement.external_axial_N": 1.0} | ROTOR
METHODS = ("constant_force", "fixed_position")
UNLIKE = PUSHED | {"arrangement.tandem": [2, 1]}


@pytest.mark.parametrize("changes", [ROTOR | {"arrangement.kind": "spring_pair"}, PUSHED, UNLIKE])
@pytest.mark.parametrize("method", METHODS)
def test_frequencies_along_a_life_are_those_of_a_case(scene, changes, method):
    """New, the lowest of what a case of the pair has."""
    held = with_method(scene("gyro_s1", changes), method)
    new = HertzianLives(held)(held).states[0]
    result = (
        new["lowest_frequency"]
        if np.isfinite(new["lowest_frequency"])
        else lowest_frequency(held, (new, new))
    )
    case = solve(held).values
    assert_allclose(result, case["natural_frequency"].min(), rtol=1e-5)
    assert life_point(held, None)["lowest_frequency"] <= result * (1.0 + 1e-12)


def test_a_point_of_the_map_is_a_life(scene):
    """Of an unlike pair; what limits look at is that of the worse bearing."""
    rigid = with_method(scene("gyro_s1", PUSHED), "fixed_position", 9.0)
    point, lived = life_point(rigid, None), life(rigid).values
    assert_allclose(point["life"], lived["life"], rtol=1e-5)
    assert_allclose(point["loss_at_end"], lived["loss_at_end"].max(), rtol=1e-5)
    stiffness = lived["history_system_axial_stiffness"]
    assert_allclose(point["system_axial_stiffness"], stiffness.min(), rtol=1e-5)
    shift = np.abs(lived["history_rotor_axial_shift"]).max()
    assert_allclose(point["rotor_axial_shift"], shift, rtol=1e-5)
    pressure = lived["history_maximum_pressure"].max()
    assert_allclose(point["maximum_pressure"], pressure, rtol=1e-5)


def test_spring_pair_against_rigid_pair(scene, tmp_path):
    pushed = scene("gyro_s1", PUSHED)
    limits = DesignLimits(
        lowest_frequency_Hz=2100.0, rotor_shift_um=3.0, preload_kept=0.3, at_speed_only=True
    )
    recommended = recommendation(pushed, limits)
    assert (recommended["lowest_frequency"] >= 2100.0 * (1.0 - 1e-6)).all()
    names = recommended["active_limit"].attrs["flag_meanings"].split()
    assert {names[int(k)] for k in recommended["active_limit"].values} == {"lowest_frequency_Hz"}
    for k, method in enumerate(METHODS):
        again = life_point(with_method(pushed, method, float(recommended["preload"][k])), None)
        assert_allclose(again["life"] / 3600.0, recommended["life"][k], rtol=1e-9)
    recommended.to_netcdf(tmp_path / "recommendation.nc")
    with open_result(tmp_path / "recommendation.nc") as file:
        sheet = recommendation_sheet(file)
    (table,) = (block for block in sheet.blocks_in("open") if block.rows)
    assert table.columns == ("spring pair", "rigid pair")
    (frequency,) = (text for text in sheet.facts["limits"] if "frequency" in text)
    assert numbers_in(frequency) == [2100.0]


@pytest.mark.parametrize("missing", ["arrangement.rotor_mass_kg", "arrangement.span_mm"])
def test_a_frequency_needs_mass_and_span(scene, missing, capsys):
    options = [f"--set={key}={value}" for key, value in ROTOR.items() if key != missing]
    with pytest.raises(SceneError, match=missing):
        DesignLimits(lowest_frequency_Hz=1e3).check(
            scene("gyro_s1", {k: v for k, v in ROTOR.items() if k != missing}), "scene"
        )
    assert main(["recommend", str(scene_file("gyro_s1")), "--frequency", "1000", *options]) == 2
    assert missing in only_line(capsys)
