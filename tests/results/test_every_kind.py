"""Every kind of result file: shown, compared, drawn, and checked against the CF conventions."""

import csv
import functools
import io
import json
import re
import shutil

import netCDF4
import numpy as np
import pytest
import xarray as xr
import yaml
from support import ROOT, only_line, scene_file, step

import bearingwear
from bearingwear.cli import main
from bearingwear.results.netcdf import load

SCENE = str(scene_file("gyro_s1"))
QUICK = ["--set", "model.strips=4", "model.tolerance=1.0e-3"]  # further settings may follow
NOT_DRAWN = ("sweep", "trade study")
CASES = {
    f"{method}-mu0.080-loss{loss}": [
        f"operation.preload_method={method}",
        "friction.ball_race=0.08",
        f"wear.ball_diameter_loss_um={loss}",
    ]
    for method in ("constant_force", "fixed_position")
    for loss in ("0.00", "0.50")
}
"""Settings of the cases of a study by their names."""

KINDS = (
    "steady case", "race control case", "dynamic case", "failed case", "life", "dynamic life",
    "study", "wear life", "sweep", "trade study",
)  # fmt: skip


def run_command(*argv) -> None:
    """Runs a command, which must succeed."""
    assert main([str(part) for part in argv]) == 0


@pytest.fixture(scope="module")
def file_of(tmp_path_factory):
    """Returns the path of a file by its kind, made by commands and steps of the workflow."""
    folder = tmp_path_factory.mktemp("kinds")
    files = {kind: folder / f"{kind.replace(' ', '_')}.nc" for kind in KINDS}
    make_cases_and_lives(files)
    make_study(files, folder)
    make_trade_study(files, folder)
    return files


def make_cases_and_lives(files):
    """Writes the files of cases and lives: of each model, and of a case without a solution."""
    dynamic = ["--fidelity", "dynamic"]
    run_command("solve", SCENE, "-o", files["steady case"])
    run_command("solve", SCENE, "-o", files["race control case"], "--fidelity", "race_control")
    half_a_turn = "model.simulated_turns=0.5"
    run_command("solve", SCENE, "-o", files["dynamic case"], *QUICK, half_a_turn, *dynamic)
    no_friction = ["--set", "friction.ball_race=0", "--record-failures"]
    run_command("solve", SCENE, "-o", files["failed case"], *no_friction)
    fixed = "operation.preload_method=fixed_position"
    run_command("life", SCENE, "-o", files["life"], *QUICK, fixed)
    short = [half_a_turn, "model.life_run_in_turns=0", "model.life_steps=2"]
    run_command("life", SCENE, "-o", files["dynamic life"], *QUICK, fixed, *short, *dynamic)


def make_study(files, folder):
    """Writes the files of a study of CASES, which are gathered, and of its wear lives."""
    paths = {name: folder / f"{name}.nc" for name in CASES}
    for name, settings in CASES.items():
        run_command("solve", SCENE, "-o", paths[name], *QUICK, *settings)
    gather = "studies.grid.gather.gathered_study"
    assert step(gather, files["study"], paths=[*paths.values()]) == 0
    inputs = {"scene": SCENE, "study": files["study"]}
    assert step("studies.grid.life.study_life", files["wear life"], **inputs) == 0


def make_trade_study(files, folder):
    """Writes the files of a sweep with one rule, and of a study of accuracy with it alone."""
    plan = yaml.safe_load((ROOT / "config/accuracy.yaml").read_text(encoding="utf-8"))
    reference = plan["references"]["steady"]
    plan |= {"repeats": 1, "references": {"steady": reference}, "table": [], "effects": []}
    del plan["cages"]
    plan["scenes"] = {"gyro_fresh": {"file": "gyro_s1", "references": ["steady"]}}
    plan["sweeps"] = {"gauss": plan["sweeps"]["gauss"] | {"grid": {"rule": ["gauss 20"]}}}
    plan_file = folder / "accuracy.yaml"
    plan_file.write_text(yaml.safe_dump(plan), encoding="utf-8")
    (folder / "scenes").mkdir()
    shutil.copy(SCENE, folder / "scenes")
    paths = {"gauss": files["sweep"], "steady": folder / "reference.nc"}
    for sweep, path in paths.items():
        settings = {"scene": "gyro_fresh", "sweep": sweep}
        run = "studies.accuracy.run.solved_sweep"
        assert step(run, path, settings=settings, plan=plan_file) == 0
    gather = "studies.accuracy.gather.gathered_sweeps"
    assert step(gather, files["trade study"], paths=[*paths.values()]) == 0


# show


@pytest.mark.parametrize(
    ("kind", "name", "column", "value"),
    [
        ("steady case", "axial_stiffness", "", 4.49),
        ("race control case", "fidelity", "", "race_control"),
        ("dynamic case", "simulated_turns", "", 0.5),
        ("failed case", "status", "", "undetermined"),
        ("life", "end_criterion", "", "residual preload"),
        ("dynamic life", "loss_at_end", "", 0.501),
        ("study", "total_qv", "least", 228.0),
        ("wear life", "end_criterion", "fixed_position, 0.08", "preload_fraction"),
        ("sweep", "total_qv", "least", 614.0),
        ("trade study", "value", "most", 1600.0),
    ],
)
def test_show_has_the_main_numbers_of_each_kind(file_of, kind, name, column, value, capsys):
    """The text has short lines without NaN. The CSV has each number under a key of its own.

    Computed numbers are regression values, which `bearingwear show FILE --csv` prints.
    """
    capsys.readouterr()
    assert main(["show", str(file_of[kind])]) == 0
    text, error = capsys.readouterr()
    assert error == "" and "nan" not in text and all(len(line) < 120 for line in text.split("\n"))
    assert main(["show", str(file_of[kind]), "--csv"]) == 0
    facts_and_rows = [*csv.DictReader(io.StringIO(capsys.readouterr().out))]
    (printed,) = (
        row["value"] for row in facts_and_rows if (row["name"], row["column"]) == (name, column)
    )
    if isinstance(value, str):
        assert printed == value and value in text
    else:
        assert float(printed) == pytest.approx(value, rel=2e-3)  # expected to three digits
    rows = [row for row in facts_and_rows if row["block"]]
    keys = [(row["block"], row["name"], row["column"]) for row in rows]
    assert len(keys) == len(set(keys)) and (kind == "failed case" or keys)


@pytest.mark.parametrize("kind", KINDS)
def test_a_file_that_is_loaded_and_saved_is_the_same(file_of, kind, tmp_path):
    """Its codes are names in memory, and codes again in the file that is written."""
    read = bearingwear.load(file_of[kind])
    labelled = [name for name, coord in read.coords.items() if "flag_meanings" in coord.attrs]
    assert all(read[name].dtype.kind == "U" for name in labelled)
    assert labelled or kind in ("sweep", "trade study")
    bearingwear.save(read, tmp_path / "back.nc")
    xr.testing.assert_identical(load(tmp_path / "back.nc"), load(file_of[kind]))


# side by side


def compared(capsys, first, second):
    """Returns the sheet of two files as JSON, and the values of its rows by block and name."""
    capsys.readouterr()
    run_command("show", first, second, "--json")
    sheet = json.loads(capsys.readouterr().out)
    return sheet, {(row["block"], row["name"]): row["values"] for row in sheet["quantities"]}


@pytest.mark.parametrize("kind", KINDS)
def test_two_files_of_one_content_do_not_differ(file_of, kind, tmp_path, capsys):
    """Both columns have the same values, and each number of the sheet of one file has a row.

    The axes of a table of lives have none, because they name its points.
    """
    copy = tmp_path / "copy.nc"
    shutil.copy(file_of[kind], copy)
    sheet, rows = compared(capsys, file_of[kind], copy)
    assert sheet["differences"] == 0 and sheet["A"] == str(file_of[kind])
    assert all(values == {"A": values["A"], "B": values["A"]} for values in rows.values())
    run_command("show", file_of[kind], "--json")
    rows_of_one = json.loads(capsys.readouterr().out)["quantities"]
    axes = ("preload_method", "friction")
    counts = [
        len(row["values"]) if "values" in row else 1
        for row in rows_of_one
        if row["block"] != "lives" or row["name"] not in axes
    ]
    assert len(rows) == sum(counts)
    if kind != "wear life":  # whose labels name the point of a table, too
        run_command("show", file_of[kind], copy)
        assert all(len(line) < 120 for line in capsys.readouterr().out.split("\n"))


@pytest.mark.parametrize(
    ("kind", "name", "key"),
    [
        ("steady case", "residual_preload", ("bearing", "residual_preload")),
        ("dynamic life", "life", ("life", "life")),
        ("study", "total_qv", ("variable", "total_qv.most")),
    ],
)
def test_one_changed_number_is_shown_with_its_percentage(
    file_of, kind, name, key, tmp_path, capsys
):
    """The largest value of a variable is changed by a part in a thousand, in a copy."""
    copy = tmp_path / "copy.nc"
    shutil.copy(file_of[kind], copy)
    with netCDF4.Dataset(copy, "a") as file:
        values = np.ma.filled(file[name][...], np.nan)
        file[name][...] = np.where(values == np.nanmax(values), 1.001 * values, values)
    _, rows = compared(capsys, file_of[kind], copy)
    assert rows[key]["difference, %"] == pytest.approx(0.1)
    run_command("show", file_of[kind], copy)
    assert re.search(r" \+0\.1$", capsys.readouterr().out, re.M)


def test_keys_and_attributes_that_differ_have_blocks_of_their_own(file_of, tmp_path, capsys):
    """The second file is solved with two other keys, and gets another source hash and `mine`."""
    changed = tmp_path / "changed.nc"
    changes = "operation.preload_N=9", "friction.ball_race=0.05"
    run_command("solve", SCENE, "-o", changed, "--set", *changes)
    with netCDF4.Dataset(changed, "a") as file:
        file.source_hash, file.mine = "0123456789abcdef", [1.0, 2.0]
    sheet, rows = compared(capsys, file_of["steady case"], changed)
    block_title = "keys of the scene that differ"
    differing = {name for block, name in rows if block == block_title}
    assert differing == {"operation.preload_N", "friction.ball_race"}
    # 9 N against the scene's 7 N
    assert rows[block_title, "operation.preload_N"]["difference, %"] == pytest.approx(200.0 / 7.0)
    attributes = sheet["sentences"]["attributes that differ"]
    assert any("B 0123456789abcdef" in line for line in attributes)
    assert "mine: A –; B [1.0, 2.0]" in attributes


def test_two_files_share_units_and_a_number_that_one_lacks_differs(file_of, tmp_path, capsys):
    """The pressure of the copy is a hundredth, which alone would be in a smaller unit."""
    copy = tmp_path / "copy.nc"
    shutil.copy(file_of["steady case"], copy)
    with netCDF4.Dataset(copy, "a") as file:
        file["maximum_pressure"][...] *= 0.01
        file["orbit_speed"][...] = np.nan
    _, rows = compared(capsys, file_of["steady case"], copy)
    (pressure,) = [rows[key] for key in rows if key[1] == "maximum_pressure.inner"]
    assert pressure["B"] == pytest.approx(0.01 * pressure["A"])
    assert pressure["difference, %"] == pytest.approx(-99.0)
    speed = rows["bearing", "orbit_speed"]
    assert speed["B"] is None and speed["difference, %"] == "differs"


@pytest.mark.parametrize(
    ("first", "second", "problem"),
    [
        ("steady case", "life", "got the kinds life and case, expected two files of the same kind"),
        ("study", "wear life", "got the kinds wear life and study"),
        ("study", None, "got a file that cannot be read"),
    ],
)
def test_files_of_two_kinds_are_not_shown_side_by_side(
    file_of, first, second, problem, tmp_path, capsys
):
    second_file = file_of[second] if second else tmp_path / "missing.nc"
    capsys.readouterr()
    assert main(["show", str(file_of[first]), str(second_file)]) == 2
    error = only_line(capsys)
    assert problem in error and str(second_file) in error


def test_the_former_command_compare_says_what_to_type(capsys):
    assert main(["compare", "a.nc", "b.nc"]) == 2
    assert "bearingwear show A.nc B.nc" in only_line(capsys)


# drawn and tabulated


def test_a_dynamic_life_is_drawn_and_tabulated(file_of, tmp_path, capsys):
    figure, table = tmp_path / "x.svg", tmp_path / "x.md"
    draw, tabulate = "studies.lives.figures.wear_history", "studies.lives.tables.lives_table"
    assert step(draw, figure, life=file_of["dynamic life"]) == 0
    text = figure.read_text(encoding="utf-8")
    assert "residual preload (N)" in text and "preload fraction" in text  # which ended it
    assert step(tabulate, table, lives=[file_of["dynamic life"]]) == 0
    assert "| dynamic_life | " in table.read_text(encoding="utf-8")


@pytest.mark.parametrize("kind", ["life", "dynamic case"])
@pytest.mark.parametrize(
    ("run", "argument"),
    [("figures.wear_history", "life"), ("tables.lives_table", "lives")],
)
def test_only_a_dynamic_life_is_drawn_and_tabulated_as_one(
    file_of, kind, run, argument, tmp_path, capsys
):
    """The line that refuses another kind begins with its path."""
    path = file_of[kind]
    capsys.readouterr()
    inputs = {argument: [path] if argument == "lives" else path}
    assert step(f"studies.lives.{run}", tmp_path / "no.svg", **inputs) == 2
    assert only_line(capsys).startswith(f"{path}: ")


@pytest.mark.parametrize("kind", [k for k in KINDS if k not in NOT_DRAWN])
def test_every_kind_is_drawn(file_of, kind, tmp_path, capsys):
    copy = tmp_path / "a.nc"
    shutil.copy(file_of[kind], copy)
    assert main(["plot", str(copy)]) == 0
    assert capsys.readouterr().out.endswith(f"{tmp_path / 'a.svg'}: written\n")
    text = (tmp_path / "a.svg").read_text(encoding="utf-8")
    assert "<path" in text and (kind != "dynamic case" or "contact load" in text)


@pytest.mark.parametrize("kind", NOT_DRAWN)
def test_files_without_a_figure_are_refused_in_one_line(file_of, kind, tmp_path, capsys):
    """They are parts of a study of accuracy, not results of their own."""
    capsys.readouterr()
    assert main(["plot", str(file_of[kind]), "-o", str(tmp_path / "a.svg")]) == 2
    assert re.fullmatch(r"got .*sweep.*, expected .*\n", capsys.readouterr().err)


# the conventions

# What the checker asks for beyond the conventions, where a dimension is called `time`: that it has
# dates (CF 4.4 asks for a date to count from only of times that are dates; ours count from the
# start of a run), and that the name in cell_methods is that of a dimension (7.3 also allows a
# standard name, as `time` is one).
BEYOND_CF = (
    "Coordinate variable 'time' should have standard_name='time', found: 'None'",
    "cell_methods name component time does not match a dimension, area or auxiliary coordinate",
)


# other kinds are written by the same code as one of these
@pytest.mark.long  # the checker takes seconds a file, and its set-up more
@pytest.mark.parametrize("kind", ["dynamic case", "dynamic life", "study"])
def test_result_files_follow_the_cf_conventions(file_of, kind, tmp_path, monkeypatch):
    """The CF checker finds nothing but BEYOND_CF, and that only in dynamic cases."""
    runner = pytest.importorskip(
        "compliance_checker.runner", reason="compliance-checker is not installed (extra cf)"
    )
    from compliance_checker.cf import util

    # asked for nine times a file, each in proportion to the square of its variables
    monkeypatch.setattr(
        util, "get_geophysical_variables", functools.cache(util.get_geophysical_variables)
    )
    runner.CheckSuite.load_all_available_checkers()
    report = tmp_path / "report.json"
    runner.ComplianceChecker.run_checker(
        str(file_of[kind]), ["cf:1.11"], 0, "strict", output_filename=str(report),
        output_format="json_new",
    )  # fmt: skip
    (result,) = json.loads(report.read_text(encoding="utf-8")).values()
    checks = [
        check
        for checker in result.values()
        for key in ("high_priorities", "medium_priorities", "low_priorities")
        for check in checker[key]
    ]
    assert len(checks) > 10
    messages = {message for check in checks for message in check["msgs"]}
    assert not [message for message in messages if not message.endswith(BEYOND_CF)]
    assert kind == "dynamic case" or not messages  # only a dynamic case has times
