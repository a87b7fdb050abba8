"""`bearingwear sweep`: axes and rows as they are typed, parts, cost, errors in one line."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from support import numbers_in, scene_file

import bearingwear
from bearingwear.cli import main
from bearingwear.studies.typed_points import typed_points

SCENE = scene_file("gyro_s1")
# options and axes of the commands
COARSE = ["--set", "model.strips=8", "--set", "model.tolerance=1.0e-3"]
PRELOADS, FRICTIONS = "operation.preload_N=5,7,9", "friction.ball_race=0.05:0.09:3"


def sweep(*words):
    """Runs `bearingwear sweep` on gyro_s1 and returns its exit status."""
    return main(["sweep", str(SCENE), *map(str, words)])


@pytest.fixture(scope="module")
def coarse():
    """Returns the scene of the commands, as COARSE changes it: few strips, for speed."""
    return bearingwear.load(SCENE).with_({"model.strips": 8, "model.tolerance": 1e-3})


def test_axes_of_the_command_make_the_dataset_of_python(coarse, tmp_path):
    """Axes are a list and `first:last:count`; only the attribute `message` differs."""
    axes = {"operation.preload_N": [5, 7, 9], "friction.ball_race": np.linspace(0.05, 0.09, 3)}
    options = [*COARSE, "--axis", PRELOADS, "--axis", FRICTIONS, "-j", 1]
    assert sweep(*options, "-o", tmp_path / "axes.nc") == 0
    dataset = bearingwear.load(tmp_path / "axes.nc")
    expected = bearingwear.sweep(coarse, axes, workers=1)
    del expected.attrs["message"]
    xr.testing.assert_identical(dataset, expected)


def test_rows_of_a_table_are_points_of_their_own(coarse, tmp_path):
    """Two rows are two points, and not the four of two axes; only what `--keep` names is stored."""
    table = tmp_path / "rows.csv"
    table.write_text(
        "operation.preload_N,operation.preload_method\n5,constant_force\n7,fixed_position\n"
    )
    assert sweep(*COARSE, "--rows", table, "--keep", "total_qv", "-o", tmp_path / "rows.nc") == 0
    with xr.open_dataset(tmp_path / "rows.nc") as file:
        assert file.total_qv.dims == ("row",) and set(file.data_vars) == {"status", "total_qv"}
        assert file.preload_N.values.tolist() == [5.0, 7.0]
        fixed = coarse.with_({"operation.preload_method": "fixed_position"})
        with pytest.warns(UserWarning, match="temperature is neglected"):  # of a fixed position
            assert file.total_qv[1] == bearingwear.solve(fixed).total_qv


def test_gather_joins_parts_byte_for_byte(tmp_path, capsys):
    """The result is the file of the whole sweep. A missing part is named, with status 2."""
    options = [*COARSE, "--axis", PRELOADS, "--axis", FRICTIONS, "-j", 1]
    parts = [tmp_path / f"{k}.nc" for k in (1, 2)]
    for k, path in enumerate(parts, 1):
        assert sweep(*options, "--part", f"{k}/2", "-o", path) == 0
    assert sweep(*options, "-o", tmp_path / "whole.nc") == 0
    assert main(["gather", *map(str, parts), "-o", str(tmp_path / "all.nc")]) == 0
    assert (tmp_path / "all.nc").read_bytes() == (tmp_path / "whole.nc").read_bytes()
    assert main(["gather", str(parts[1]), "-o", str(tmp_path / "none.nc")]) == 2
    assert capsys.readouterr().err.endswith("2.nc: got 1 of 2 parts, expected also 1/2\n")


def test_show_prints_a_variable_of_a_sweep(tmp_path, capsys):
    assert sweep(*COARSE, "--axis", PRELOADS, "-j", 1, "-o", tmp_path / "sweep.nc") == 0
    assert main(["show", str(tmp_path / "sweep.nc")]) == 0
    assert "total_qv" in capsys.readouterr().out


def test_a_dry_run_states_points_and_time_and_writes_nothing(tmp_path, capsys, monkeypatch):
    """Its four lines have points and axes, time by cores, the part, and the size of the file."""
    monkeypatch.chdir(tmp_path)
    axes = ["--axis", "operation.preload_N=4:20:100", "--axis", "friction.ball_race=0.04:0.12:1000"]
    assert sweep(*COARSE, *axes, "-n", "-j", 2, "--part", "1/20") == 0
    points, time, part, size = capsys.readouterr().out.splitlines()
    assert numbers_in(points)[:3] == [100_000, 100, 1000]  # in all, and along each axis
    assert numbers_in(time)[-1] == 2 and numbers_in(part)[0] == 20  # cores, parts
    assert "MB" in size
    assert not list(tmp_path.iterdir())


def test_failed_points_are_reported_and_recorded(tmp_path, capsys):
    """A friction of zero leaves spin undetermined. The status is 3 only if no point is solved.

    With `--record-failures`, it is 0 even then.
    """
    options = [*COARSE, "-j", 1, "-o", tmp_path / "x.nc"]
    assert sweep(*options, "--axis", "friction.ball_race=0,0.08") == 0
    *_, line = capsys.readouterr().err.splitlines()
    assert line.startswith(f"{tmp_path / 'x.nc'}: 1 of 2 points ")
    assert line.endswith(" undetermined 1")
    assert sweep(*options, "--axis", "friction.ball_race=0") == 3
    assert sweep(*options, "--axis", "friction.ball_race=0", "--record-failures") == 0


@pytest.mark.parametrize("number", ["1e-5", "2.5E-4", "-1e-5"])
def test_a_single_number_with_a_negative_exponent_is_an_axis(number):
    """Its hyphen separates no numbers, unlike that of 5-9, which is refused."""
    points = typed_points([f"model.tolerance={number}"], None)
    assert points == {"model.tolerance": [float(number)]}


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["-n"], "sweep: got neither --axis nor --rows, expected one of them"),
        (["-n", "--axis", PRELOADS, "--rows", "a.csv"], "sweep: got both --axis and --rows, "),
        (["-n", "--axis", "operation.preload_N"], "--axis: got operation.preload_N, expected KEY="),
        (["-n", "--axis", "operation.preload_N=5,5"], "operation.preload_N: got 5 twice, expected"),
        (
            ["-n", "--axis", "operation.preload_N=-5"],
            "operation.preload_N: got -5, expected a n",
        ),
        (["-n", "--axis", "operation.preload=5"], "operation.preload: got an unknown key; did you"),
        (["-n", "--axis", "operation.preload_N=5-9"], "--axis operation.preload_N: got 5-9, "),
        (
            ["-n", "--axis", "operation.preload_N=5:6:1"],
            "--axis operation.preload_N: got 5:6:1, ",
        ),
        (["-n", "--axis", PRELOADS, "--keep", "total_gv"], "keep: got total_gv, expected total_qv"),
        (["-n", "--axis", PRELOADS, "--keep", "extremes"], "keep: got extremes of solve, expected"),
        (["-o", "x.nc", "--axis", PRELOADS, "--part", "4/3"], "part: got 4/3, expected K/N with"),
        (["-n", "--rows", "missing.csv"], "missing.csv: got a file that cannot be read (No such"),
        (["-n", "--rows", "short.csv"], "short.csv: line 4: got 1 values, expected 2"),
        (["-n", "--rows", "twice.csv"], "twice.csv: got no header of different keys, expected one"),
    ],
)
def test_wrong_axes_and_rows_are_refused_in_one_line(words, line, tmp_path, monkeypatch, capsys):
    """The exit status is 2, and the line begins as stated."""
    monkeypatch.chdir(tmp_path)
    Path("short.csv").write_text("operation.preload_N,friction.ball_race\n5,0.05\n\n7\n")
    Path("twice.csv").write_text("operation.preload_N,operation.preload_N\n5,6\n")
    assert sweep(*words) == 2
    err = capsys.readouterr().err
    assert err.startswith(line) and err.count("\n") == 1


@pytest.mark.parametrize("words", [["--part", "3"], ["--part", "a/b"], ["-j", "0"], ["-j", "-1"]])
def test_options_that_are_no_numbers_are_refused(words, capsys):
    """So are numbers of cores below one."""
    assert sweep("-n", "--axis", PRELOADS, *words) == 2
    assert "expected" in capsys.readouterr().err


def test_the_file_of_a_sweep_is_named_after_the_scene_and_the_part(tmp_path, monkeypatch, capsys):
    """Without `-o` it is in the present folder; a line of standard error names it."""
    (tmp_path / "mine.yaml").write_text(scene_file("gyro_s1").read_text(encoding="utf-8"))
    monkeypatch.chdir(tmp_path)
    options = ["sweep", "mine.yaml", "--axis", "operation.preload_N=6,7", "-j", "1"]
    for part, name in (([], "mine-sweep.nc"), (["--part", "2/2"], "mine-sweep-2of2.nc")):
        assert main([*options, *part]) == 0
        assert f"{name}: written\n" in capsys.readouterr().err and (tmp_path / name).exists()


def test_the_file_of_an_export_is_named_after_the_scene(tmp_path, monkeypatch, capsys):
    """This applies without `-o`; a line of standard output names the file."""
    (tmp_path / "mine.yaml").write_text(scene_file("gyro_s1").read_text(encoding="utf-8"))
    monkeypatch.chdir(tmp_path)
    assert main(["export", "mine.yaml", "--speeds", "20000,30000"]) == 0
    assert capsys.readouterr().out.startswith("mine-stiffness.csv: written")
