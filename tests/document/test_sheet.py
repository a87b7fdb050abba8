"""The result sheet: the same text after a solve and from its file; JSON and CSV of it."""

import csv
import io
import json
import math

import netCDF4
import pytest
from support import ROOT, numbers_in, scene_file, without_waits

import bearingwear
from bearingwear.cli import main
from bearingwear.document.rows import caveat_lines
from bearingwear.document.show import sheet_of_result
from bearingwear.lives.life import life
from bearingwear.scene.blocks import CRITERIA
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


def quantities(capsys, *argv) -> dict[str, dict]:
    """Returns the quantities of a sheet by their names, as a command prints them for programs."""
    rows = json.loads(printed(capsys, *argv, "--json"))["quantities"]
    return {row["name"]: row for row in rows}


def test_a_sheet_of_a_case_states_input_status_and_results(capsys):
    """Numbers as they were when each of them was checked, with their units and criteria."""
    heading, *_ = printed(capsys, "solve", SCENE).split("\n\n")
    title, operation, model = heading.splitlines()
    assert numbers_in(title) == [9, 2] and numbers_in(operation)[:3] == [30000, 7, 0.08]
    assert "steady" in model and "status ok" in model
    shown = quantities(capsys, "solve", SCENE)
    for name, unit, values, limit in (
        ("maximum_pressure", "MPa", (980.0, 943.0), None),
        ("gyroscopic_slip_share", "%", (8.49, 2.29), 50.0),
        ("residual_preload", "N", (7.0,), 2.8),
        ("axial_stiffness", "N/um", (4.49,), None),
        ("shaft_torque", "uN m", (15.6,), None),
        ("friction_power", "mW", (48.9,), None),
        ("ball_diameter_loss_rate", "um/1000 h", (528.0,), None),
    ):
        row = shown[name]
        numbers = [*row["values"].values()] if "values" in row else [row["value"]]
        assert numbers == pytest.approx(values, rel=5e-3) and row["unit"] == unit, name
        assert row.get("limit") == pytest.approx(limit), name
    assert "residual" not in shown


def test_friction_power_is_torque_times_speed(capsys):
    """The power balance of the whole bearing: what the shaft gives, friction and drag take."""
    drag = ["--set", "lubricant.drag_density_kg_m3=20"]
    shown = quantities(capsys, "solve", SCENE, *drag)
    watts = {"mW": 1e-3, "W": 1.0, "uN m": 1e-6, "mN m": 1e-3}
    power, torque = (
        shown[name]["value"] * watts[shown[name]["unit"]]
        for name in ("friction_power", "shaft_torque")
    )
    assert shown["drag_power"]["value"] > 0.0
    assert power == pytest.approx(torque * 30000.0 * 3.14159265358979 / 30.0, rel=1e-6)


def test_the_criterion_that_ends_a_life_is_marked(capsys):
    document = sheet_of_result(life(load_scene(SCENE, FIXED[1:])))
    rows = {row.name: row for block in document.blocks for row in block.rows}
    criteria = {name: rows[name] for name in CRITERIA if name in rows}
    assert [name for name, row in criteria.items() if row.note] == ["preload_fraction"]
    preload = criteria["preload_fraction"]
    assert preload.values == pytest.approx((105.0, 40.0), abs=0.5) and preload.limit == 40.0
    assert rows["end_criterion"].values == (preload.label,)
    slip = criteria["gyroscopic_slip_share"]
    assert max(slip.values) < slip.limit == 50.0


def test_rates_with_and_without_grooves_have_different_labels(capsys):
    """A state averages the grooves over their width; a life with worn grooves does not."""

    loss = "wear.end_of_life.ball_diameter_loss_um=0.3"
    states = {
        contact: quantities(capsys, "solve", SCENE, "--set", loss, f"model.contact={contact}")
        for contact in ("hertz", "worn")
    }
    lives = {
        contact: quantities(capsys, "life", SCENE, "--set", loss, f"model.contact={contact}")
        for contact in ("hertz", "worn")
    }
    of_state = states["hertz"]["ball_diameter_loss_rate"]
    even, grooved = (
        lives[contact]["history_ball_diameter_loss_rate"] for contact in ("hertz", "worn")
    )
    assert even["label"] == of_state["label"] != grooved["label"]
    assert even["values"]["start"] == pytest.approx(of_state["value"], rel=1e-6)
    assert grooved["values"]["start"] != pytest.approx(of_state["value"], rel=0.02)
    assert lives["worn"]["loss_at_end"]["value"] == pytest.approx(0.3, rel=1e-4)


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
    data = json.loads(printed(capsys, "solve", SCENE, "-o", file, "--json"))
    assert json.loads(printed(capsys, "show", file, "--json")) == data
    assert (data["scene"], data["fidelity"], data["status"]) == ("gyro_s1", "steady", "ok")
    shown = {row["name"]: row for row in data["quantities"]}
    with netCDF4.Dataset(file) as case:
        stiffness, pressure = float(case["axial_stiffness"][...]), case["maximum_pressure"][0]
    assert shown["axial_stiffness"]["unit"] == "N/um"
    assert shown["axial_stiffness"]["value"] == pytest.approx(1e-6 * stiffness, rel=1e-12)
    assert shown["maximum_pressure"]["values"]["outer"] == pytest.approx(1e-6 * pressure[1])
    assert shown["residual_preload"]["limit"] == pytest.approx(2.8)
    rows = list(csv.DictReader(io.StringIO(printed(capsys, "show", file, "--csv"))))
    (row,) = [r for r in rows if (r["name"], r["column"]) == ("maximum_pressure", "inner")]
    assert row["unit"] == "MPa" and float(row["value"]) == pytest.approx(1e-6 * pressure[0])


def test_warnings_stand_at_the_head(tmp_path, capsys):
    file = tmp_path / "x.nc"
    printed(capsys, "solve", SCENE, "-o", file)
    with netCDF4.Dataset(file, "a") as case:
        case.warnings = json.dumps([{"sentence": "sentence", "advice": "advice"}])
    head = printed(capsys, "show", file).partition("\n\n")[0].splitlines()
    assert head[-1] == "warning: sentence; advice"
    assert json.loads(printed(capsys, "show", file, "--json"))["warnings"] == ["sentence; advice"]


def test_a_failed_solve_prints_its_status_alone(capsys):
    assert main(["solve", SCENE, "--set", "friction.ball_race=0"]) == 3
    out, err = capsys.readouterr()
    assert "status undetermined" in out and "\n\n" not in out
    assert err.count("\n") == 1 and "(see" not in err


def test_an_unverified_number_is_not_printed(monkeypatch, scene):
    """The file keeps what was found, for whoever looks for the reason; the sheet does not."""
    monkeypatch.setattr(thrust_problem, "FRICTION_TOLERANCE", 1e-5)
    changes = {"model.quadrature": "gauss", "bearing.bore_mm": 5.0, "operation.preload_N": 0.1}
    result = solve(scene("gyro_s1", changes), "steady")
    assert result.status == "unverified" and "total_qv" in result.values
    document = sheet_of_result(result)
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
        sheet = json.loads(printed(capsys, *argv))
        assert sheet["status"] == "ok"
        assert not [text for text in sheet["warnings"] if "e+" in text]
        return {row["name"]: row.get("value") for row in sheet["quantities"]}

    none, little = numbers(0), numbers(1e-3)
    for name in ("quasistatic_axial_stiffness", "axial_stiffness", "shaft_torque"):
        assert none[name] == pytest.approx(little[name], rel=1e-3)
    # on a spring all contacts lie in the middle of the grooves, on spacers where they were mounted
    middle = -1e3 * 0.05 * 7.92 * math.sin(math.radians(10.19))
    expected = middle if method == "constant_force" else 0.0
    assert none["axial_displacement"] == pytest.approx(expected, rel=1e-9)


def test_a_life_of_a_film_states_its_disagreement_with_tests():
    """With the factors of the page of tests; dry bearings and calibrated films do not."""
    page = numbers_in((ROOT / "docs" / "film_tests.md").read_text(encoding="utf-8"))
    scene = load_scene(scene_file("mos2_gyro")).to_dict()
    (sentence,) = caveat_lines(scene)
    sheet = sheet_of_result(life(load_scene(scene_file("mos2_gyro"))))
    assert sentence in [line for block in sheet.blocks for line in block.lines]
    (least,) = numbers_in(sentence)
    assert any(least <= factor < 1.1 * least for factor in page)
    film_law = scene["friction"]["film"] | {"wear_table": [{"relative_life": 1.0}]}
    (by_table,) = caveat_lines(scene | {"friction": scene["friction"] | {"film": film_law}})
    assert numbers_in(by_table) and set(numbers_in(by_table)) <= set(page)
    assert not caveat_lines(scene | {"calibrated": {"tests": "own.csv"}})
    assert not caveat_lines(load_scene(SCENE).to_dict())


@pytest.mark.parametrize("lubrication", ["starved", "oil"])
@pytest.mark.parametrize("designation", ["7001C", "HCB7001C"])
def test_a_life_by_an_upper_bound_of_wear_states_that_it_is_a_lower_bound(lubrication, designation):
    scene = bearingwear.new(designation=designation, speed=9000.0, lubrication=lubrication)
    (sentence,) = caveat_lines(scene.to_dict())
    assert "lower bounds" in sentence
    own = scene.with_({"materials.bearing_steel.wear_coefficient": 1e-9})
    assert not caveat_lines(own.to_dict())
