"""`bearingwear new`: a scene from catalogue numbers; and what the shell completes."""

import math
import os
import re
import shlex
import subprocess
import sys

import pytest
from support import only_line

from bearingwear.cli import main
from bearingwear.commands import OPTIONS
from bearingwear.kernels.project import PROJECT
from bearingwear.lives.life import life
from bearingwear.results.warnings import warnings_in
from bearingwear.scene.checking.strict_yaml import data_of
from bearingwear.scene.new.scene_file import scene_text, usual_limits
from bearingwear.scene.read import load_scene, scene_from_dict
from bearingwear.solvers.solve import solve

SIZE = ["--bore", "40", "--outside", "68"]


def new(path, *argv) -> int:
    """Runs `bearingwear new` for a file, and returns its exit status."""
    return main(["new", str(path), *map(str, argv)])


@pytest.mark.parametrize(
    ("bore", "outside", "ball", "pitch"),
    [(40, 68, 7.938, 54.0), (5, 10, 2.0, 7.5), (35, 62, 7.938, 48.5), (3, 10, 1.588, 6.5)],
    ids=["7008", "the paper's size", "7007", "623"],
)
def test_rules_give_about_the_size_of_real_bearings(bore, outside, ball, pitch, tmp_path):
    """A rule of thumb meets their balls within a third, and their pitch within 2 %."""
    assert new(tmp_path / "a.yaml", "--bore", bore, "--outside", outside) == 0
    bearing = load_scene(tmp_path / "a.yaml").bearing
    assert bearing.ball_diameter_mm == pytest.approx(ball, rel=0.34)
    assert bearing.pitch_diameter_mm == pytest.approx(pitch, rel=0.02)


def test_balls_without_a_designation_fill_three_quarters_of_the_pitch_circle(tmp_path):
    """Rounded to a whole ball; `touching` would fill it."""
    assert new(tmp_path / "a.yaml", *SIZE) == 0
    bearing = load_scene(tmp_path / "a.yaml").bearing
    touching = math.pi / math.asin(bearing.ball_diameter_mm / bearing.pitch_diameter_mm)
    assert bearing.ball_count == pytest.approx(0.75 * touching, abs=0.5)


@pytest.mark.parametrize("size", [(40, 68), (100, 150), (0.6, 2)])
def test_the_scene_of_new_solves_with_about_one_gpa(size, tmp_path):
    scene = tmp_path / "some_bearing.yaml"
    assert new(scene, "--bore", size[0], "--outside", size[1]) == 0
    assert main(["check", str(scene)]) == 0
    solved = solve(load_scene(scene))
    assert solved.status == "ok"
    # the preload that is assumed: about 1 GPa, whatever the size
    assert 0.7e9 < solved.values["maximum_pressure"].max() < 1.3e9
    assert life(load_scene(scene)).status == "ok"


def test_given_numbers_are_written_as_given_and_not_listed_as_assumed(tmp_path, capsys):
    inputs = {"--balls": 16, "--ball-diameter": 7.938, "--pitch-diameter": 53.5, "--speed": 24000,
             "--contact-angle": 18, "--preload": 120, "--friction": 0.05}  # fmt: skip
    path = tmp_path / "Spindle-7008.yaml"
    argv = [part for pair in inputs.items() for part in pair]
    assert new(path, *SIZE, *argv, "--preload-method", "fixed_position") == 0
    output, text = capsys.readouterr().out, path.read_text(encoding="utf-8")
    scene = load_scene(path)
    assert scene.name == "Spindle-7008" and scene.operation.preload_method == "fixed_position"
    plain = scene.to_dict()
    for option, key, *_ in OPTIONS:
        block, name = key.split(".")
        assert plain[block][name] == inputs[option]
        assert re.search(rf"^  {name}: \S+  # given$", text, re.M) and key not in output


@pytest.mark.parametrize("name", ["7008", "true", "null", "1e-5", "1e5", "my-spindle"])
def test_file_names_that_yaml_reads_as_other_types_stay_names(name, tmp_path):
    assert new(tmp_path / f"{name}.yaml", *SIZE) == 0
    assert load_scene(tmp_path / f"{name}.yaml").name == name


def test_new_does_not_replace_a_file(tmp_path, capsys):
    path = tmp_path / "a.yaml"
    path.write_text("mine", encoding="utf-8")
    assert new(path, *SIZE) == 2
    assert path.read_text(encoding="utf-8") == "mine" and os.listdir(tmp_path) == ["a.yaml"]
    assert "already exists" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("argv", "problem"),
    [
        (["--bore", "40"], "--outside"),
        ([], "new: got no designation, expected `bearingwear new "),
        (["7008C", "--bore", "40"], "--bore: got 40; only allowed without a designation"),
        (["6204C"], "designation: got '6204C', expected 6204 alone, or with C2, CN, C3"),
        (
            ["7008C3"],
            "designation: got '7008C3', expected 7008 alone, or with C, FB, FE, AC, A5, AD, E",
        ),
        (["7008C", "--clearance", "CN"], "--clearance: got CN; only allowed for a deep groove"),
        (
            [*SIZE, "--contact-angle", "15", "--clearance", "CN"],
            "only allowed without a contact angle",
        ),
        (
            ["608", "--radial-clearance-um", "0"],
            "--radial-clearance-um: got '0', expected a number",
        ),
        (["--bore", "0", "--outside", "9"], "--bore: got '0', expected a number from 0.5"),
        (
            [*SIZE, "--speed", "fast"],
            "--speed: got 'fast', expected a number from 0 to 10000000 (r/min);",
        ),
        (["--bore", "40", "--outside", "30"], "--outside: got 30, expected a number > 40"),
        ([*SIZE, "--ball-diameter", "14"], "--ball-diameter: got 14, expected"),
        ([*SIZE, "--balls", "22"], "--balls: got 22, expected at most 20"),
        (["--bore", "1000", "--outside", "9000"], "bearing.ball_diameter_mm: got 2400.0, expected"),
        (
            ["7008C", "--contact-angle", "0"],
            "--contact-angle: got 0, expected a number > 0, because",
        ),
        (["7008C", "--maker", "NSK", "--contact-angle", "0"], "--contact-angle: got 0, expected a"),
        ([*SIZE, "--contact-angle", "90"], "--contact-angle: got '90', expected a number from 0"),
    ],
)
def test_wrong_arguments_are_refused_in_one_line(argv, problem, tmp_path, capsys):
    assert new(tmp_path / "a.yaml", *argv) == 2
    assert problem in only_line(capsys)
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("name", ["a.txt", ".yaml", "no/such\0/a.yaml", "a b.yaml"])
def test_wrong_file_names_are_refused_in_one_line(name, tmp_path, capsys):
    assert new(f"{tmp_path}/{name}", *SIZE) == 2
    only_line(capsys)
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("designation", ["71910ACD/HCP4A", "SKF 7008 CD/P4ADBC"])
def test_a_designation_with_a_slash_is_no_file(designation, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["new", designation, "--speed", "5000"]) == 0
    name = "".join(letter for letter in designation if letter.isalnum())
    assert os.listdir(tmp_path) == [f"{name}.yaml"]
    assert capsys.readouterr().out.startswith(f"{name}.yaml: written")


def output_of(capsys) -> str:
    return capsys.readouterr().out


@pytest.mark.parametrize(
    ("argv", "clearance"),
    [
        (["608"], 7.5),
        (["6204"], 12.5),
        (["6204-C3"], 20.5),
        (["6204", "--clearance", "C2"], 5.0),
        (["6204", "--radial-clearance-um", "9"], 9.0),
        (["--bore", "20", "--outside", "47", "--clearance", "CN"], 12.5),
    ],
)
def test_the_radial_clearance_gives_the_free_contact_angle(argv, clearance, tmp_path):
    """cos(a) = 1 - G/(2 (f_i + f_o - 1) D), of the middle of the group, in the file's four digits.

    Of grooves of 0.52 and 0.53; clearances [um] of ISO 5753-1.
    """
    assert new(tmp_path / "a.yaml", *argv) == 0
    bearing = load_scene(tmp_path / "a.yaml").bearing
    between_centres = (0.52 + 0.53 - 1.0) * bearing.ball_diameter_mm
    angle = math.degrees(math.acos(1.0 - 1e-3 * clearance / (2.0 * between_centres)))
    assert bearing.contact_angle_deg == pytest.approx(angle, rel=1e-3)


@pytest.mark.parametrize(
    ("designation", "balls"),
    [("608", 7), ("6204", 8), ("6205", 9), ("6206", 9), ("6208", 9), ("6008", 12)],
)
def test_deep_groove_bearings_have_the_real_number_of_balls_within_one(
    designation, balls, tmp_path
):
    """The numbers were counted in real bearings."""
    assert new(tmp_path / "a.yaml", designation) == 0
    assert load_scene(tmp_path / "a.yaml").bearing.ball_count == pytest.approx(balls, abs=1)


CATALOGUE = [
    ("7015E", "heavy", 1970),
    ("7016E", "heavy", 2240),
    ("7019C", "heavy", 2260),
    ("7024C", "heavy", 3640),
    ("7216C", "heavy", 2580),
    ("7218C", "medium", 1630),
    ("7218C", "heavy", 3260),
    ("7220E", "medium", 2740),
    ("7220E", "heavy", 5480),
    ("71921C", "heavy", 1710),
]
"""Axial preloads [N] M and H of spindle bearings (IBC, TI-I-5050.0 E, 2010, section 2.4)."""


@pytest.mark.parametrize(("designation", "preload_class", "published"), CATALOGUE)
def test_preload_classes_meet_a_catalogue_within_30_percent(
    designation, preload_class, published, tmp_path
):
    assert new(tmp_path / "a.yaml", designation, "--preload-class", preload_class) == 0
    preload = load_scene(tmp_path / "a.yaml").operation.preload_N
    assert preload == pytest.approx(published, rel=0.3)


@pytest.mark.long  # sampled lives and a recommendation with grooves as they wear
def test_new_solves_its_scene_and_prints_commands_that_work(tmp_path, capsys):
    path = tmp_path / "my-spindle.yaml"
    assert new(path, "7008C") == 0
    lines = output_of(capsys).splitlines()
    assert any(line.startswith("solved and verified") for line in lines)
    commands = [shlex.split(line)[1:] for line in lines if line.startswith("  bearingwear ")]
    *short, study = commands
    assert [argv[0] for argv in short] == ["check", "solve", "life", "uncertainty", "recommend"]
    assert study[:2] == ["study", str(path)]  # tests/workflow/test_own.py types that
    for argv in short:
        assert main(argv) == 0, argv
    assert new(tmp_path / "b.yaml", "7008C", "--friction", 0) == 0  # it is written all the same
    assert "undetermined" in output_of(capsys)


def test_new_compiles_no_kernel(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(PROJECT.__dict__, "code_folder", str(tmp_path / "empty"))
    assert new(tmp_path / "a.yaml", "608") == 0
    assert "not solved" in output_of(capsys) and not (tmp_path / "empty").exists()


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("bearingwear new a.yaml --ball", {"--balls", "--ball-diameter", "--ball-material"}),
        (
            "bearingwear check a.yaml --set operation.preload_",
            {"operation.preload_method=", "operation.preload_N="},
        ),
    ],
)
def test_the_shell_completes_options_and_keys(line, offered, tmp_path):
    shell = {"_ARGCOMPLETE": "1", "_ARGCOMPLETE_SHELL": "bash", "_ARGCOMPLETE_IFS": "\n",
             "COMP_LINE": line, "COMP_POINT": str(len(line)), "COMP_TYPE": "9",
             "_ARGCOMPLETE_STDOUT_FILENAME": str(tmp_path / "offered")}  # fmt: skip
    subprocess.run(
        [sys.executable, "-m", "bearingwear"], env=os.environ | shell, check=True, timeout=60
    )
    words = (tmp_path / "offered").read_text(encoding="utf-8").split("\n")
    assert {text.strip() for text in words} == offered


@pytest.mark.parametrize("block", ["temperature", "thermal", "arrangement"])
def test_a_block_in_a_comment_is_valid_without_its_number_sign(block):
    text, _ = scene_text("mine", None, None, {}, designation="7008C")
    assert text.count(f"\n# {block}: ") == 1
    uncommented = text.replace(f"\n# {block}: ", f"\n{block}: ")
    scene = scene_from_dict(data_of(uncommented, "mine"), "mine")
    assert getattr(scene, block) is not None
    assert scene.bearing.bore_mm == 40.0 and scene.bearing.outside_diameter_mm == 68.0


def test_an_instrument_bearing_has_the_stiffness_of_its_maker(tmp_path):
    """R168: 2.88 N/um under 0.45 kg with a radial play of 8 um, printed by its maker.

    Within 5 %, as its balls and grooves are those of a rule.
    """
    path, size = tmp_path / "r168.yaml", ["--bore", "6.35", "--outside", "9.525"]
    preload = str(0.45 * 9.80665)
    assert new(path, *size, "--radial-clearance-um", "8", "--preload", preload, "--speed", "1") == 0
    scene = load_scene(path)
    assert scene.bearing.inner_groove_factor == scene.bearing.outer_groove_factor == 0.57
    stiffness = solve(scene).values["quasistatic_axial_stiffness"]
    assert stiffness == pytest.approx(2.88e6, rel=0.05)


@pytest.mark.parametrize(
    ("argv", "is_small", "grooves"),
    [
        (["608"], True, (0.52, 0.53)),
        (["--bore", "9.9", "--outside", "24"], True, (0.57, 0.57)),
        (["--bore", "2", "--outside", "6", "--contact-angle", "15"], True, (0.57, 0.57)),
        (["--bore", "10", "--outside", "24"], False, (0.52, 0.53)),
        (["6000"], False, (0.52, 0.53)),
    ],
)
def test_bearings_below_a_bore_of_10_mm_have_uncertain_grooves(
    argv, is_small, grooves, tmp_path, capsys
):
    """Those without an ISO designation are instrument bearings: Dynaroll prints 0.56 +-0.03."""
    assert new(tmp_path / "a.yaml", *argv) == 0
    lines = output_of(capsys)
    assert ("0.52 to 0.58" in lines) == is_small
    assert ("Dynaroll" in lines) == (grooves[0] == 0.57)
    scene = load_scene(tmp_path / "a.yaml")
    assert (scene.bearing.inner_groove_factor, scene.bearing.outer_groove_factor) == grooves
    for race in ("inner", "outer"):
        assert (f"{race}_groove_factor" in scene.uncertainty) == is_small
        if is_small:
            spread = scene.uncertainty[f"{race}_groove_factor"]
            assert (spread.low, spread.high) == (0.52, 0.58)


@pytest.mark.parametrize(
    ("designation", "ends", "gap"),
    [("7000C", "-2 to +6", 5.5), ("7008C", "-3.5 to +9.5", 7.5), ("7020C", "-5 to +13", 10.5)],
)
def test_fits_are_written_with_the_range_of_their_class(designation, ends, gap):
    """ISO 286 and ISO 492, entered once more: 10 x 26, 40 x 68 and 100 x 150 mm."""
    text, _ = scene_text("mine", None, None, {}, designation=designation)
    (line,) = re.findall("^fits: .*", text, re.MULTILINE)
    assert f"{ends} um" in line and "js4" in line and "P4" in line
    scene = scene_from_dict(data_of(text, "mine"), "mine")
    assert scene.fits.shaft_interference_um == 0.0
    assert scene.fits.housing_interference_um == -gap


@pytest.mark.parametrize("rings", [{}, {"inner_ring_C": 30.0, "outer_ring_C": 25.0}])
def test_written_fits_change_no_number(rings):
    """The fits are loose or line to line, so that rings are not pressed.

    That holds until the outer ring fills its housing: when it is 9 K warmer here.
    """
    text, _ = scene_text("mine", None, None, {}, None, "fixed_position", designation="7008C")
    scene = scene_from_dict(data_of(text, "mine"), "mine")
    scene = scene.with_({f"temperature.{part}": degC for part, degC in rings.items()})
    fitted, free = solve(scene).values, solve(scene.with_({"fits": None})).values
    for name, value in free.items():
        assert (fitted[name] == value).all() if hasattr(value, "all") else fitted[name] == value


@pytest.mark.parametrize(
    ("designation", "pair", "expected"),
    [
        ("7008C", "spring", ("spring_pair", "constant_force", "back_to_back")),
        ("7008CDF", "rigid", ("rigid_pair", "fixed_position", "face_to_face")),
        ("NSK7010CDBL", "spring", ("spring_pair", "constant_force", "back_to_back")),
    ],
)
def test_a_pair_is_written_as_its_option_and_its_designation_say(designation, pair, expected):
    """A maker's class of preload is that of a rigid pair, unless a spring is asked for."""
    text, lines = scene_text("mine", None, None, {}, designation=designation, pair=pair)
    scene = scene_from_dict(data_of(text, "mine"), "mine")
    arrangement = scene.arrangement
    written = (arrangement.kind, scene.operation.preload_method, arrangement.orientation)
    assert written == expected
    assert not any("one bearing of it" in line for line in lines)
    assert solve(scene).status == "ok"


def new_with_film(**given):
    """A 7204AC with a film of MoS2, and the lines on what was assumed."""
    text, lines = scene_text(
        "mine", None, None, given, designation="7204AC", lubrication="mos2"
    )  # fmt: skip
    return scene_from_dict(data_of(text, "mine"), "mine"), lines


def warning_ids(result):
    return {warning["id"] for warning in warnings_in(result.attrs)}


def test_a_film_gets_the_speed_and_the_pressure_of_its_tests():
    """1750 r/min of a 7204C (docs/film_tests.md), and 1500 MPa, where its relative life is 1."""
    scene, lines = new_with_film()
    assert scene.operation.shaft_speed_rpm == pytest.approx(1750.0, rel=0.05)
    assert any("docs/film_tests.md" in line for line in lines)
    result = solve(scene)
    assert result.status == "ok" and not warning_ids(result) & {"limit_passed", "film_too_fast"}
    assert usual_limits(scene).pressure == 1.5


def test_a_film_at_ten_times_the_speed_of_its_tests_is_warned_of():
    scene, _ = new_with_film(**{"operation.shaft_speed_rpm": 20_000.0})
    assert "film_too_fast" in warning_ids(solve(scene))
