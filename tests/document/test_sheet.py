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
FIXED_POSITION = "operation.preload_method=fixed_position"
COMPILING = "compiling part of the solver"  # printed once on a machine


def printed(capsys, *words) -> str:
    """Returns what a command prints; fails if it prints errors other than warnings."""
    capsys.readouterr()
    assert main([str(word) for word in words]) == 0
    out, err = capsys.readouterr()
    for line in without_waits(err).splitlines():
        assert "warning: " in line or line.startswith(COMPILING), line
    return out


def quantities(capsys, *words) -> dict[str, dict]:
    """Returns the quantities of a sheet by their names, as a command prints them for programs."""
    rows = json.loads(printed(capsys, *words, "--json"))["quantities"]
    return {row["name"]: row for row in rows}


def test_the_heading_of_a_case_states_input_and_status(capsys):
    heading, *_ = printed(capsys, "solve", SCENE).split("\n\n")
    title, operation, model = heading.splitlines()
    assert numbers_in(title) == [9, 2]  # balls, of [mm]
    assert numbers_in(operation)[:3] == [30000, 7, 0.08]  # [r/min], [N], friction
    assert "steady" in model and "status ok" in model


@pytest.fixture(scope="module")
def gyro_rows():
    """Returns the rows of the sheet of the scene gyro_s1 by their names."""
    document = sheet_of_result(solve(load_scene(SCENE)))
    return {row.name: row for block in document.blocks for row in block.rows}


@pytest.mark.parametrize(
    ("name", "unit", "values", "limit"),
    [
        ("maximum_pressure", "MPa", (980.0, 943.0), None),
        ("gyroscopic_slip_share", "%", (8.49, 2.29), 50.0),
        ("residual_preload", "N", (7.0,), 2.8),
        ("axial_stiffness", "N/um", (4.49,), None),
        ("shaft_torque", "uN m", (15.6,), None),
        ("friction_power", "mW", (48.9,), None),
        ("ball_diameter_loss_rate", "um/1000 h", (528.0,), None),
    ],
)
def test_a_case_is_shown_in_units_for_people_with_its_limits(gyro_rows, name, unit, values, limit):
    """Golden numbers, from `bearingwear solve config/scenes/gyro_s1.yaml`, to three digits."""
    row = gyro_rows[name]
    assert row.values == pytest.approx(values, rel=5e-3) and row.unit == unit
    assert row.limit == pytest.approx(limit)


@pytest.mark.parametrize(
    ("more_phases", "reason"),
    [
        ({}, "Starts and stops wear the bearing, too."),
        ({"slow": {"hours": 1e-3}}, "All phases, starts and stops wear the bearing, and phase s"),
    ],
)
@pytest.mark.filterwarnings("ignore:the life has only .* cycles")
def test_a_sheet_says_that_starts_shorten_the_life(more_phases, reason):
    """In each start the balls warm before the outer ring, which raises the preload."""
    capacities = {"inner_ring": 1.0, "balls": 0.3, "outer_ring": 15.0}
    conductances = {"inner_ring_shaft": 0.02, "outer_ring_housing": 0.02, "ball_race": 0.02}
    nominal = {"hours": 0.1, "starts": 1}
    changes = {
        "model.contact": "hertz",
        "operation.preload_method": "fixed_position",
        "thermal": {"conductance_W_K": conductances, "heat_capacity_J_K": capacities},
        "cases": {"slow": {"operation.shaft_speed_rpm": 20000.0}},
        "duty": {"phases": {"nominal": nominal} | more_phases, "start_s": 2.0, "warmup": True},
    }
    result = life(load_scene(SCENE).with_(changes))
    lines = [line for block in sheet_of_result(result).blocks for line in block.lines]
    (shorter,) = (line for line in lines if "shorter than the life in any phase alone" in line)
    assert reason in shorter


def test_residuals_are_shown_only_with_the_option_all(tmp_path, capsys):
    file = tmp_path / "case.nc"
    printed(capsys, "solve", SCENE, "-o", file, "--quiet")
    assert "equilibrium_residual" not in quantities(capsys, "show", file)
    assert "equilibrium_residual" in quantities(capsys, "show", file, "--all")


def test_friction_power_is_torque_times_speed(capsys):
    """The power balance of the whole bearing: friction and drag take all power of the shaft."""
    rows = quantities(capsys, "solve", SCENE, "--set", "lubricant.drag_density_kg_m3=20")
    si_factors = {"mW": 1e-3, "W": 1.0, "uN m": 1e-6, "mN m": 1e-3}
    power, torque = (
        rows[name]["value"] * si_factors[rows[name]["unit"]]
        for name in ("friction_power", "shaft_torque")
    )
    assert rows["drag_power"]["value"] > 0.0
    assert power == pytest.approx(torque * 30000.0 * math.pi / 30.0, rel=1e-6)


def test_the_criterion_that_ends_a_life_is_marked():
    document = sheet_of_result(life(load_scene(SCENE, [FIXED_POSITION])))
    rows = {row.name: row for block in document.blocks for row in block.rows}
    criteria = {name: rows[name] for name in CRITERIA if name in rows}
    assert [name for name, row in criteria.items() if row.note] == ["preload_fraction"]
    preload = criteria["preload_fraction"]
    assert preload.values[-1] == pytest.approx(preload.limit, rel=1e-3) and preload.limit == 40.0
    assert rows["end_criterion"].values == (preload.label,)
    slip = criteria["gyroscopic_slip_share"]
    assert slip.limit == 50.0
    assert max(slip.values) < slip.limit


def test_rates_with_and_without_grooves_have_different_labels(capsys):
    """A state averages the grooves over their width; a life with worn grooves does not."""
    loss = "wear.end_of_life.ball_diameter_loss_um=0.3"
    settings = ["--set", loss, "model.contact=hertz"]
    state_rate = quantities(capsys, "solve", SCENE, *settings)["ball_diameter_loss_rate"]
    lives = {
        contact: quantities(capsys, "life", SCENE, "--set", loss, f"model.contact={contact}")
        for contact in ("hertz", "worn")
    }
    even_rate, groove_rate = (
        rows["history_ball_diameter_loss_rate"] for rows in (lives["hertz"], lives["worn"])
    )
    assert even_rate["label"] == state_rate["label"]
    assert groove_rate["label"] != state_rate["label"]
    assert even_rate["values"]["start"] == pytest.approx(state_rate["value"], rel=1e-6)
    assert groove_rate["values"]["start"] != pytest.approx(state_rate["value"], rel=0.02)
    assert lives["worn"]["loss_at_end"]["value"] == pytest.approx(0.3, rel=1e-4)


@pytest.mark.parametrize("command", ["solve", "life"])
def test_a_result_prints_the_same_sheet_as_its_file(command, tmp_path, capsys):
    """A life that is written to a file ends with a further line, that its spread is unknown."""
    file, settings = tmp_path / "result.nc", ["--set", FIXED_POSITION]
    text = printed(capsys, command, SCENE, "-o", file, *settings)
    assert printed(capsys, "show", file) == text
    text_without_file = printed(capsys, command, SCENE, *settings)
    assert text.startswith(text_without_file.rstrip("\n"))


def test_quiet_prints_nothing(tmp_path, capsys):
    assert printed(capsys, "solve", SCENE, "-o", tmp_path / "case.nc", "--quiet") == ""


def test_json_and_csv_have_the_numbers_of_the_file(tmp_path, capsys):
    file = tmp_path / "case.nc"
    data = json.loads(printed(capsys, "solve", SCENE, "-o", file, "--json"))
    assert json.loads(printed(capsys, "show", file, "--json")) == data
    assert (data["scene"], data["fidelity"], data["status"]) == ("gyro_s1", "steady", "ok")
    rows = {row["name"]: row for row in data["quantities"]}
    with netCDF4.Dataset(file) as case:
        stiffness, pressure = float(case["axial_stiffness"][...]), case["maximum_pressure"][0]
    assert rows["axial_stiffness"]["unit"] == "N/um"
    assert rows["axial_stiffness"]["value"] == pytest.approx(1e-6 * stiffness, rel=1e-12)
    assert rows["maximum_pressure"]["values"]["outer"] == pytest.approx(1e-6 * pressure[1])
    assert rows["residual_preload"]["limit"] == pytest.approx(2.8)  # 0.4 of 7 N
    lines = csv.DictReader(io.StringIO(printed(capsys, "show", file, "--csv")))
    (line,) = [
        line for line in lines if (line["name"], line["column"]) == ("maximum_pressure", "inner")
    ]
    assert line["unit"] == "MPa" and float(line["value"]) == pytest.approx(1e-6 * pressure[0])


def test_warnings_stand_at_the_end_of_the_heading(tmp_path, capsys):
    file = tmp_path / "case.nc"
    printed(capsys, "solve", SCENE, "-o", file)
    with netCDF4.Dataset(file, "a") as case:
        case.warnings = json.dumps([{"sentence": "sentence", "advice": "advice"}])
    heading = printed(capsys, "show", file).partition("\n\n")[0].splitlines()
    assert heading[-1] == "warning: sentence; advice"
    assert json.loads(printed(capsys, "show", file, "--json"))["warnings"] == ["sentence; advice"]


def test_a_failed_solve_prints_its_heading_alone(capsys):
    assert main(["solve", SCENE, "--set", "friction.ball_race=0"]) == 3
    out, err = capsys.readouterr()
    assert "status undetermined" in out and "\n\n" not in out
    assert err.count("\n") == 1 and "(see" not in err


def test_the_numbers_of_an_unverified_case_are_not_printed(monkeypatch, scene):
    """The result contains them for diagnosis; the sheet has only what the inputs determine.

    A loose tolerance of friction makes the case unverified.
    """
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
"""Changes to the bearing of a test rig, which loads it only radially; it has no cage."""


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
def test_a_bearing_without_preload_is_the_limit_of_a_small_preload(tmp_path, capsys, method):
    """No warning of NumPy is raised on the way to its sheet."""
    plain = load_scene(SCENE, ["cage=null"]).to_dict()
    file = tmp_path / "rig.yaml"
    bearingwear.save(scene_from_dict(with_changes(plain, DEEP_GROOVE)), file)

    def values_at(preload):
        """Returns the single values of the printed sheet by name at a preload [N]."""
        settings = [f"operation.preload_method={method}", f"operation.preload_N={preload}"]
        words = ("solve", file, "--fidelity", "race_control", "--set", *settings, "--json")
        sheet = json.loads(printed(capsys, *words))
        assert sheet["status"] == "ok"
        assert not [text for text in sheet["warnings"] if "e+" in text]  # no number overflows
        return {row["name"]: row.get("value") for row in sheet["quantities"]}

    without_preload, small_preload = values_at(0), values_at(1e-3)
    for name in ("quasistatic_axial_stiffness", "axial_stiffness", "shaft_torque"):
        assert without_preload[name] == pytest.approx(small_preload[name], rel=1e-3), name
    # with a spring, the contacts move to the middle of the grooves; with spacers, nothing moves
    groove_distance = (0.52 + 0.53 - 1.0) * 7.92  # of the centres of both grooves [mm]
    to_middle_um = -1e3 * groove_distance * math.sin(math.radians(10.19))
    expected = to_middle_um if method == "constant_force" else 0.0
    assert without_preload["axial_displacement"] == pytest.approx(expected, rel=1e-9)


@pytest.fixture(scope="module")
def factors_in_docs():
    """Returns the numbers of the page on tests of films."""
    return numbers_in((ROOT / "docs" / "film_tests.md").read_text(encoding="utf-8"))


def test_a_life_of_a_film_states_its_disagreement_with_tests(factors_in_docs):
    """Its factor is a lower bound, at most 10 % below a factor on the page on tests."""
    scene = load_scene(scene_file("mos2_gyro"))
    (sentence,) = caveat_lines(scene.to_dict())
    sheet = sheet_of_result(life(scene))
    assert sentence in [line for block in sheet.blocks for line in block.lines]
    (least,) = numbers_in(sentence)
    assert any(least <= factor < 1.1 * least for factor in factors_in_docs)


def test_a_film_with_a_table_of_lives_states_only_factors_of_the_page(factors_in_docs):
    friction = load_scene(scene_file("mos2_gyro")).to_dict()["friction"]
    film = friction["film"] | {"wear_table": [{"relative_life": 1.0}]}
    (sentence,) = caveat_lines({"friction": friction | {"film": film}})
    assert numbers_in(sentence) and set(numbers_in(sentence)) <= set(factors_in_docs)


def test_calibrated_films_and_dry_bearings_do_not_mention_tests_of_films():
    film_scene = load_scene(scene_file("mos2_gyro")).to_dict()
    assert not caveat_lines(film_scene | {"calibrated": {"tests": "own.csv"}})
    assert not caveat_lines(load_scene(SCENE).to_dict())


@pytest.mark.parametrize("lubrication", ["starved", "oil"])
@pytest.mark.parametrize("designation", ["7001C", "HCB7001C"])
def test_a_life_by_an_upper_bound_of_wear_states_that_it_is_a_lower_bound(lubrication, designation):
    scene = bearingwear.new(designation=designation, speed=9000.0, lubrication=lubrication)
    (sentence,) = caveat_lines(scene.to_dict())
    assert "this life and its interval are lower bounds" in sentence
    smaller_wear = scene.with_({"materials.bearing_steel.wear_coefficient": 1e-9})
    assert not caveat_lines(smaller_wear.to_dict())
