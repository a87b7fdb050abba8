"""The result sheet: the same text after a solve and from its file; JSON and CSV of it."""

import csv
import io
import json
import math
import re

import netCDF4
import pytest
from support import ROOT, scene_file, without_waits

import bearingwear
from bearingwear.cli import main
from bearingwear.document.rows import film_lines
from bearingwear.document.show import sheet_of_result
from bearingwear.lives.life import life
from bearingwear.scene.changes import with_changes
from bearingwear.scene.read import load_scene, scene_from_dict
from bearingwear.solvers.bearing import thrust_problem
from bearingwear.solvers.solve import solve

SCENE = str(scene_file("gyro_s1"))
FIXED = ["--set", "operation.preload_method=fixed_position"]


def printed(capsys, *argv) -> str:
    capsys.readouterr()
    assert main([str(part) for part in argv]) == 0
    out, err = capsys.readouterr()
    assert all(
        line.partition(": ")[2].startswith("warning: ")
        or line.startswith(
            ("warning: ", "compiling part of the solver")
        )  # the latter once on a machine
        for line in without_waits(err).splitlines()
    )
    return out


def test_a_case_says_what_was_solved(capsys):
    text = printed(capsys, "solve", SCENE)
    assert text.startswith("gyro_s1: 9 balls of 2 mm\n30000 r/min, constant force preload 7 N")
    assert "model steady (pure thrust load), status ok: solved and verified" in text
    for line in (
        r"maximum pressure +MPa +980 +943",
        r"gyroscopic slip share +% +8\.49 +2\.29  criterion 50",
        r"residual preload +N +7  criterion 2\.8",
        r"dynamic axial stiffness +N/um +4\.49",
        r"shaft torque +uN m +15\.6",
        r"friction power +mW +48\.9",
        r"total wear depth, mean of tracks +um/1000 h +528",
    ):
        assert re.search(rf"^  {line}$", text, re.M), line
    assert "residual  " not in text and "source_hash" not in text


def test_friction_power_is_torque_times_speed(capsys):
    """The power balance of the whole bearing: what the shaft gives, friction and drag take."""
    drag = ["--set", "lubricant.drag_density_kg_m3=20"]
    found = json.loads(printed(capsys, "solve", SCENE, "--json", *drag))["quantities"]
    known = {one["name"]: one for one in found}
    watts = {"mW": 1e-3, "W": 1.0, "uN m": 1e-6, "mN m": 1e-3}
    power, torque = (
        known[name]["value"] * watts[known[name]["unit"]]
        for name in ("friction_power", "shaft_torque")
    )
    assert known["drag_power"]["value"] > 0.0
    assert power == pytest.approx(torque * 30000.0 * 3.14159265358979 / 30.0, rel=1e-6)


def test_a_life_says_what_ends_it(capsys):
    text = printed(capsys, "life", SCENE, *FIXED)
    assert re.search(r"^  ended by +residual preload$", text, re.M)
    assert re.search(r"^  residual preload +% +105 +40  criterion 40, reached first$", text, re.M)
    assert re.search(r"^  gyroscopic slip share +% +[\d.]+ +[\d.]+  criterion 50$", text, re.M)
    assert re.search(r"^  total wear depth, mean of tracks +um/1000 h +\d+ +\d+$", text, re.M)


def test_two_losses_have_two_labels(capsys):
    """A state averages the grooves over their width; a life with worn grooves does not."""

    def rates(command, label, *more):
        text = printed(capsys, command, SCENE, "--set", *more)
        (found,) = re.findall(rf"^  total wear depth, {label} +um/1000 h +(.*)$", text, re.M)
        return [float(one) for one in found.split()], text

    loss = "wear.end_of_life.ball_diameter_loss_um=0.3"
    (state,), _ = rates("solve", "mean of tracks", loss, "model.contact=hertz")
    (start, _), text = rates("life", "mean of tracks", loss, "model.contact=hertz")
    assert start == pytest.approx(state, rel=1e-6) and "equivalent" not in text
    (start, _), text = rates("life", "equivalent", loss, "model.contact=worn")
    assert abs(start / state - 1.0) > 0.02 and "mean of tracks" not in text
    assert re.search(r"^  total wear depth, equivalent +um +0\.3$", text, re.M)


@pytest.mark.parametrize("command", ["solve", "life"])
def test_with_and_without_a_file(command, tmp_path, capsys):
    file = tmp_path / "x.nc"
    text = printed(capsys, command, SCENE, "-o", file, *FIXED)
    assert printed(capsys, "show", file) == text
    alone = printed(capsys, command, SCENE, *FIXED)
    assert text.startswith(alone.rstrip("\n"))  # a file of a life says where its spread would be
    assert printed(capsys, command, SCENE, "-o", file, "--quiet", *FIXED) == ""


def test_formats_for_programs(tmp_path, capsys):
    file = tmp_path / "x.nc"
    found = json.loads(printed(capsys, "solve", SCENE, "-o", file, "--json"))
    assert json.loads(printed(capsys, "show", file, "--json")) == found
    assert (found["scene"], found["fidelity"], found["status"]) == ("gyro_s1", "steady", "ok")
    known = {one["name"]: one for one in found["quantities"]}
    with netCDF4.Dataset(file) as case:
        stiffness, pressure = float(case["axial_stiffness"][...]), case["maximum_pressure"][0]
    assert known["axial_stiffness"]["unit"] == "N/um"
    assert known["axial_stiffness"]["value"] == pytest.approx(1e-6 * stiffness, rel=1e-12)
    assert known["maximum_pressure"]["values"]["outer"] == pytest.approx(1e-6 * pressure[1])
    assert known["residual_preload"]["limit"] == pytest.approx(2.8)
    rows = list(csv.DictReader(io.StringIO(printed(capsys, "show", file, "--csv"))))
    (row,) = [r for r in rows if (r["name"], r["column"]) == ("maximum_pressure", "inner")]
    assert row["unit"] == "MPa" and float(row["value"]) == pytest.approx(1e-6 * pressure[0])


def test_warnings_stand_at_the_head(tmp_path, capsys):
    file = tmp_path / "x.nc"
    printed(capsys, "solve", SCENE, "-o", file)
    with netCDF4.Dataset(file, "a") as case:
        warning = {"sentence": "the ellipse runs over the shoulder", "advice": "less load"}
        case.warnings = json.dumps([warning])
    head = printed(capsys, "show", file).partition("\n\n")[0].splitlines()
    assert head[-1] == "warning: the ellipse runs over the shoulder; less load"
    assert json.loads(printed(capsys, "show", file, "--json"))["warnings"] == [
        "the ellipse runs over the shoulder; less load"
    ]


def test_a_failed_solve_says_so_and_no_more(capsys):
    assert main(["solve", SCENE, "--set", "friction.ball_race=0"]) == 3
    out, err = capsys.readouterr()
    assert "status undetermined" in out and "\n\n" not in out
    assert err.count("\n") == 1 and "(see" not in err


def test_an_unverified_number_is_not_printed(monkeypatch, scene):
    """The file keeps what was found, for whoever looks for the reason; the sheet does not."""
    monkeypatch.setattr(thrust_problem, "FRICTION_TOLERANCE", 1e-5)
    changes = {"model.quadrature": "gauss", "bearing.bore_mm": 5.0, "operation.preload_N": 0.1}
    found = solve(scene("gyro_s1", changes), "steady")
    assert found.status == "unverified" and "total_qv" in found.values
    document = sheet_of_result(found)
    assert [row.name for block in document.blocks for row in block.rows] == ["growth_at_speed"]
    assert document.facts["warnings"] == []


DEEP_GROOVE = {
    "bearing.ball_count": 8,
    "bearing.ball_diameter_mm": 7.92,
    "bearing.pitch_diameter_mm": 34.55,
    "bearing.contact_angle_deg": 10.19,
    "bearing.inner_groove_factor": 0.52,
    "bearing.outer_groove_factor": 0.53,
    "operation.shaft_speed_rpm": 2100,
    "operation.radial_load_N": [12000, 0],
}
"""Of a bearing in a rig that loads it across its axis alone; its cage would not fit."""


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
def test_no_thrust_at_all_is_like_hardly_any(tmp_path, capsys, method):
    """The limit of a small preload, and no warning of NumPy on the way to its sheet."""
    plain = load_scene(SCENE, ["cage=null"]).to_dict()
    file = tmp_path / "rig.yaml"
    bearingwear.save(scene_from_dict(with_changes(plain, DEEP_GROOVE)), file)
    changes = ["--set", f"operation.preload_method={method}", "operation.preload_N"]

    def numbers(preload):
        *head, last = changes
        argv = ("solve", file, "--fidelity", "race_control", *head, f"{last}={preload}", "--json")
        found = json.loads(printed(capsys, *argv))
        assert found["status"] == "ok"
        assert not [text for text in found["warnings"] if "e+" in text]
        return {one["name"]: one.get("value") for one in found["quantities"]}

    none, little = numbers(0), numbers(1e-3)
    for name in ("quasistatic_axial_stiffness", "axial_stiffness", "shaft_torque"):
        assert none[name] == pytest.approx(little[name], rel=1e-3)
    # on a spring all contacts lie in the middle of the grooves, on spacers where they were mounted
    middle = -1e3 * 0.05 * 7.92 * math.sin(math.radians(10.19))
    expected = middle if method == "constant_force" else 0.0
    assert none["axial_displacement"] == pytest.approx(expected, rel=1e-9)


def test_a_life_of_a_film_says_how_its_tests_ended(capsys):
    """In the words of the page of tests; a dry bearing and a calibrated film do not say it."""
    page = " ".join((ROOT / "docs" / "film_tests.md").read_text(encoding="utf-8").split())
    assert "too low by a factor of 43 or more, the second by 5.2 or more" in page
    said = "Film lives disagree with published tests: both predictions that can be checked fail"
    film = str(sheet_of_result(life(load_scene(scene_file("mos2_gyro")))))
    assert f"{said}, one by a factor of 40" in " ".join(film.split())
    assert said not in printed(capsys, "life", SCENE, *FIXED)
    scene = load_scene(scene_file("mos2_gyro")).to_dict()
    assert film_lines(scene)
    film_law = scene["friction"]["film"] | {"wear_table": [{"relative_life": 1.0}]}
    (by_table,) = film_lines(scene | {"friction": scene["friction"] | {"film": film_law}})
    for factor, of_page in (
        ("28", "one prediction fails by a factor of 28"),
        ("1.6", "one by 1.6"),
    ):
        assert factor in by_table and of_page in page
    assert not film_lines(scene | {"calibrated": {"tests": "own.csv"}})
    assert not film_lines(load_scene(SCENE).to_dict())
