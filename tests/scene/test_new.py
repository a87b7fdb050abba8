"""`bearingwear new`: a scene from catalogue numbers; and what the shell completes."""

import math
import os
import re
import subprocess
import sys

import pytest

from bearingwear.cli import main
from bearingwear.commands import OPTIONS
from bearingwear.results.netcdf import load
from bearingwear.scene.read import load_scene

SIZE = ["--bore", "40", "--outside", "68"]


def new(path, *argv) -> int:
    return main(["new", str(path), *map(str, argv)])


@pytest.mark.parametrize(
    ("bore", "outside", "ball", "pitch"),
    [(40, 68, 7.938, 54.0), (5, 10, 2.0, 7.5), (35, 62, 7.938, 48.5), (3, 10, 1.588, 6.5)],
    ids=["7008", "the paper's size", "7007", "623"],
)
def test_rules_give_the_size_of_real_bearings(bore, outside, ball, pitch, tmp_path):
    """Ball and pitch diameters of real bearings, which a rule of thumb meets within a third."""
    assert new(tmp_path / "a.yaml", "--bore", bore, "--outside", outside) == 0
    bearing = load_scene(tmp_path / "a.yaml").bearing
    assert bearing.ball_diameter_mm == pytest.approx(ball, rel=0.34)
    assert bearing.pitch_diameter_mm == pytest.approx(pitch, rel=0.02)
    touching = math.pi / math.asin(bearing.ball_diameter_mm / bearing.pitch_diameter_mm)
    assert bearing.ball_count == pytest.approx(0.75 * touching, abs=0.5)


@pytest.mark.parametrize("size", [(40, 68), (3, 10), (100, 150), (5, 9), (0.6, 2)])
def test_what_is_written_solves(size, tmp_path):
    scene, case = tmp_path / "some_bearing.yaml", tmp_path / "case.nc"
    assert new(scene, "--bore", size[0], "--outside", size[1]) == 0
    assert main(["check", str(scene)]) == 0
    assert main(["solve", str(scene), "-o", str(case)]) == 0
    solved = load(case)
    assert int(solved["status"]) == 0
    # the preload that is assumed: about 1 GPa, whatever the size
    assert 0.7e9 < float(solved["maximum_pressure"].max()) < 1.3e9
    assert main(["life", str(scene), "-o", str(tmp_path / "life.nc")]) == 0


def test_given_numbers_are_taken_and_the_others_told(tmp_path, capsys):
    given = {"--balls": 16, "--ball-diameter": 7.938, "--pitch-diameter": 53.5, "--speed": 24000,
             "--contact-angle": 18, "--preload": 120, "--friction": 0.05}  # fmt: skip
    path = tmp_path / "Spindle 7008.yaml"
    argv = [part for pair in given.items() for part in pair]
    assert new(path, *SIZE, *argv, "--preload-method", "fixed_position") == 0
    told, text = capsys.readouterr().out, path.read_text(encoding="utf-8")
    scene = load_scene(path)
    assert scene.name == "Spindle_7008" and scene.operation.preload_method == "fixed_position"
    plain = scene.to_dict()
    for option, key, *_ in OPTIONS:
        block, name = key.split(".")
        assert plain[block][name] == given[option]
        assert re.search(rf"^  {name}: \S+  # given$", text, re.M) and key not in told
    assert "# assumed" in text and "bearing.ball_material: bearing_steel" in told
    assert new(tmp_path / "b.yaml", *SIZE) == 0
    told, text = capsys.readouterr().out, (tmp_path / "b.yaml").read_text(encoding="utf-8")
    for _, key, *_ in OPTIONS:
        assert re.search(rf"^  {key.split('.')[1]}: \S+  # assumed: ", text, re.M) and key in told


@pytest.mark.parametrize("name", ["7008", "true", "null", "1.0e-5", "1e5"])
def test_names_that_yaml_takes_for_something_else(name, tmp_path):
    assert new(tmp_path / f"{name}.yaml", *SIZE) == 0
    assert load_scene(tmp_path / f"{name}.yaml").name == name.replace(".", "_")


def test_ceramic_balls(tmp_path):
    assert new(tmp_path / "a.yaml", *SIZE, "--ball-material", "silicon_nitride") == 0
    scene = load_scene(tmp_path / "a.yaml")
    assert scene.bearing.ball_material == "silicon_nitride"
    assert scene.materials["silicon_nitride"].density_kg_m3 == 3200


def test_nothing_is_replaced(tmp_path, capsys):
    path = tmp_path / "a.yaml"
    path.write_text("mine", encoding="utf-8")
    assert new(path, *SIZE) == 2
    assert path.read_text(encoding="utf-8") == "mine" and os.listdir(tmp_path) == ["a.yaml"]
    assert "is there already" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("argv", "said"),
    [
        (["--bore", "40"], "--outside"),
        (["--bore", "0", "--outside", "9"], "--bore: given 0; allowed a number > 0"),
        (["--bore", "nan", "--outside", "9"], "--bore: given nan"),
        (["--bore", "40", "--outside", "inf"], "--outside: given inf"),
        (["--bore", "40", "--outside", "30"], "--outside: given 30; allowed a number > 40"),
        ([*SIZE, "--ball-diameter", "14"], "--ball-diameter: given 14; allowed"),
        ([*SIZE, "--pitch-diameter", "45"], "--pitch-diameter: given 45; allowed"),
        ([*SIZE, "--balls", "22"], "--balls: given 22; allowed at most 20"),
        ([*SIZE, "--balls", "2"], "--balls: given 2; allowed a whole number from 3"),
        ([*SIZE, "--balls", "9.5"], "--balls"),
        ([*SIZE, "--contact-angle", "90"], "--contact-angle: given 90; allowed a number from 0"),
        ([*SIZE, "--preload", "-1"], "--preload: given -1"),
        ([*SIZE, "--speed", "nan"], "--speed: given nan"),
        (["--bore", "0.1", "--outside", "0.2"], "--ball-diameter: "),
        (["--bore", "9e9", "--outside", "9.1e9"], "--ball-diameter: "),
    ],
)
def test_bad_numbers_take_one_line(argv, said, tmp_path, capsys):
    assert new(tmp_path / "a.yaml", *argv) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1, error
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("name", ["a.txt", "a", ".yaml", "___.yaml", "no/such\0/a.yaml"])
def test_bad_names_take_one_line(name, tmp_path, capsys):
    assert new(f"{tmp_path}/{name}", *SIZE) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("angle", [0, 80])
@pytest.mark.parametrize("balls", [3, 20])
def test_extremes_make_valid_scenes(angle, balls, tmp_path):
    path = tmp_path / "a.yaml"
    assert new(path, *SIZE, "--balls", balls, "--contact-angle", angle) == 0
    assert load_scene(path).bearing.ball_count == balls


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("bearingwear comp", {"compare"}),
        ("bearingwear new a.yaml --ball", {"--balls", "--ball-diameter", "--ball-material"}),
        ("bearingwear solve a.yaml --fidelity st", {"steady"}),
        (
            "bearingwear check a.yaml --set operation.preload_",
            {"operation.preload_method=", "operation.preload_N="},
        ),
    ],
)
def test_completion(line, offered, tmp_path):
    shell = {"_ARGCOMPLETE": "1", "_ARGCOMPLETE_SHELL": "bash", "_ARGCOMPLETE_IFS": "\n",
             "COMP_LINE": line, "COMP_POINT": str(len(line)), "COMP_TYPE": "9",
             "_ARGCOMPLETE_STDOUT_FILENAME": str(tmp_path / "offered")}  # fmt: skip
    subprocess.run(
        [sys.executable, "-m", "bearingwear"], env=os.environ | shell, check=True, timeout=60
    )
    found = (tmp_path / "offered").read_text(encoding="utf-8").split("\n")
    assert {text.strip() for text in found} == offered
