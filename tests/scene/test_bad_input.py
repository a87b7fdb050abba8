"""Broken scenes: each is refused with one line that says what is wrong, and nothing is written."""

import os
import re
from pathlib import Path

import pytest

from bearingwear.cli import main
from bearingwear.scene.checking.check import MOST_FAULTS
from bearingwear.scene.read import SceneError, load_scene

SCENES = Path(__file__).parents[2] / "config" / "scenes"
GOOD = (SCENES / "gyro_s1.yaml").read_text(encoding="utf-8")
GOOD = GOOD.replace("model: {contact: paper}\n", "")


def edited(*pairs: tuple[str, str]) -> str:
    """Returns the text GOOD with old texts, each of which occurs once, replaced by new ones."""
    text = GOOD
    for old, new in pairs:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def with_line(block: str, line: str) -> str:
    """Returns the text GOOD with a line added to a block."""
    return edited((f"\n{block}:\n", f"\n{block}:\n  {line}\n"))


def alias_bomb() -> str:
    """Returns the text of a small scene whose aliases stand for 9^9 texts."""
    lines = ["a: &a [x, x, x, x, x, x, x, x, x]"]
    for old, new in zip("abcdefgh", "bcdefghi", strict=True):
        lines.append(f"{new}: &{new} [" + ", ".join([f"*{old}"] * 9) + "]")
    return "\n".join(lines) + "\n" + GOOD


LOSS = "  ball_diameter_loss_um: 0.0\n"
CAGE = GOOD[GOOD.index("cage:") : GOOD.index("operation:")]

# name of the fault: contents of the file, key that must be named, further texts of the line
BROKEN: dict[str, tuple[str | bytes, str, tuple[str, ...]]] = {
    # keys
    "unknown key": (with_line("bearing", "ball_cuont: 9"), "bearing.ball_cuont", ("ball_count",)),
    "key of an earlier version": (
        with_line("wear", "ball_track: bands"), "wear.ball_track",
        ("no longer exists", "delete the key"),
    ),
    "missing key": (edited(("  preload_N: 7.0\n", "")), "operation.preload_N", ("nothing",)),
    "duplicate key": (
        with_line("bearing", "ball_count: 8"), "bearing.ball_count", ("second time",)),
    "list as a key": (GOOD + "? [a, b]\n: 1\n", "", ("as a key",)),
    # types
    "NaN": (edited(("preload_N: 7.0", "preload_N: .nan")), "operation.preload_N", (".nan",)),
    "endless whole number": (
        edited(("preload_N: 7.0", "preload_N: " + "9" * 5000)), "operation.preload_N", ()),
    # ranges
    "negative loss in a list": (
        edited((LOSS, "  ball_diameter_loss_um: [0, 0, 0, 0, -0.1, 0, 0, 0, 0]\n")),
        "wear.ball_diameter_loss_um[4]", ()),
    # sense
    "too many balls": (
        edited(("ball_count: 9", "ball_count: 12")), "bearing.ball_count", ("at most 11",)),
    "balls as large as the pitch circle": (
        edited(("pitch_diameter_mm: 7.5", "pitch_diameter_mm: 2.0")),
        "bearing.pitch_diameter_mm", ("> 2",)),
    "missing cage material": (
        edited(("  material: phenolic", "  material: peek")), "cage.material", ("peek",)),
    "cage inside out": (
        edited(("  inner_diameter_mm: 6.6", "  inner_diameter_mm: 9.6")),
        "cage.inner_diameter_mm", ("< 8.6",)),
    "cage off the balls": (
        edited(("  inner_diameter_mm: 6.6", "  inner_diameter_mm: 9.6"),
               ("  outer_diameter_mm: 8.6", "  outer_diameter_mm: 11.6")),
        "cage.inner_diameter_mm", ("does not reach the balls",)),
    "pockets that overlap": (
        edited(("pocket_clearance_mm: 0.15", "pocket_clearance_mm: 0.6")),
        "cage.pocket_clearance_mm", ("overlap",)),
    "loss list of wrong length": (
        edited((LOSS, "  ball_diameter_loss_um: [0.1, 0.2]\n")),
        "wear.ball_diameter_loss_um", ("2 values", "9 balls")),
    "loss as large as the ball": (
        edited((LOSS, "  ball_diameter_loss_um: 2000\n")), "wear.ball_diameter_loss_um", ("200",)),
    "end of life as large as the ball": (
        edited(("ball_diameter_loss_um: 0.7", "ball_diameter_loss_um: 700")),
        "wear.end_of_life.ball_diameter_loss_um", ("200",)),
    "limit of a cage without a cage": (
        edited((CAGE, ""), ("ball_diameter_loss_um: 0.7", "pocket_clearance_mm: 0.2")),
        "wear.end_of_life.pocket_clearance_mm", ("0.2", "with a cage")),
    "limit of a land without a land": (
        edited(("guiding_race: outer", "guiding_race: ball"),
               ("ball_diameter_loss_um: 0.7", "guide_clearance_mm: 0.3")),
        "wear.end_of_life.guide_clearance_mm", ("guided by a race",)),
    "gravity without a direction": (
        edited(("  preload_N: 7.0", "  preload_N: 7.0\n  gravity_m_s2: 9.81")),
        "operation.gravity_m_s2", ("9.81", "three")),
    "cage results without a cage": (
        edited((CAGE, "")) + "model: {cage_results: true}\n", "model.cage_results", ("cage",)),
    "dynamic model at rest": (
        edited(("shaft_speed_rpm: 30000", "shaft_speed_rpm: 0")) + "model: {fidelity: dynamic}\n",
        "operation.shaft_speed_rpm", ("rotating",)),
    "steady cage results": (
        GOOD + "model: {cage_results: true, fidelity: steady}\n", "model.fidelity", ("dynamic",)),
    "more turns evaluated than simulated": (
        GOOD + "model: {evaluated_turns: 40.5}\n", "model.evaluated_turns", ("40.5", "<= 40")),
    "histories beyond memory": (
        GOOD + "model: {history_points_per_turn: 50, simulated_turns: 1000000}\n",
        "model.history_points_per_turn", ("<= 1",)),
    "steady under radial load": (
        with_line("operation", "radial_load_N: [0, 1]") + "model: {fidelity: steady}\n",
        "model.fidelity", ("radial load",)),
    # names and texts
    "name with a path": (edited(("name: gyro_s1", "name: ../gyro_s1")), "name", ("a-z",)),
    "control character in the description": (
        GOOD[: GOOD.index("description:")]
        + 'description: "\\e[31mred"\n'
        + GOOD[GOOD.index("bearing:") :],
        "description", ("control character",)),
    # the file as a whole
    "empty file": ("", "", ("nothing",)),
    "two documents": (GOOD + "---\n" + GOOD, "", ("second document",)),
    "not YAML": (GOOD + "operation: [\n", "", ("not YAML",)),
    "binary": (bytes(range(256)) * 8, "", ("UTF-8",)),
    "huge": (GOOD + "# " + "x" * 1_000_000 + "\n", "", ("1000000 bytes",)),
    "long list": (
        edited((LOSS, "  ball_diameter_loss_um: [" + "1," * 400_000 + "1]\n")), "", ("5000 keys",)),
    "alias bomb": (alias_bomb(), "", ("anchor",)),
    "tag": (edited(("preload_N: 7.0", "preload_N: !!float 7")), "", ("tag",)),
    "deep nesting": (GOOD + "x: " + "[" * 5000 + "]" * 5000 + "\n", "", ("nested blocks",)),
}  # fmt: skip


def refusal(capsys, argv: list[str]) -> str:
    """Returns what a command writes when it refuses its input: a line for each fault.

    Each line says what was found and what is expected.
    """
    assert main(argv) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert 1 <= err.count("\n") <= MOST_FAULTS and err.endswith("\n"), err
    assert "Traceback" not in err
    for line in err.splitlines():
        assert re.search("got |set |stands ", line), err
        assert re.search("expected|allowed|did you mean", line), err
        assert len(line) < 500
    return err


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_scene_is_refused_in_a_line_that_names_the_key(name, tmp_path, capsys):
    contents, key, texts = BROKEN[name]
    scene, output = tmp_path / "broken.yaml", tmp_path / "out" / "case.nc"
    scene.write_bytes(contents if isinstance(contents, bytes) else contents.encode())
    line = refusal(capsys, ["solve", str(scene), "-o", str(output)])
    assert line.startswith(f"{scene}: {key}")
    for text in texts:
        assert text in line, line
    assert os.listdir(tmp_path) == ["broken.yaml"]


def test_every_fault_has_its_line(tmp_path, capsys):
    """Lines are in the order of the scene; missing keys come last, with an example.

    The key that `ball_cout` stands for is not reported as missing, too.
    """
    scene = tmp_path / "broken.yaml"
    scene.write_text(
        edited(
            ("ball_count: 9", "ball_cout: 9"),
            ("preload_N: 7.0", "preload_N: many"),
            ("contact_angle_deg: 20.0", "contact_angle_deg: 200"),
            ("brinell_hardness_GPa: 6.6, ", ""),
        )
    )
    lines = refusal(capsys, ["solve", str(scene), "-o", str(tmp_path / "x.nc")]).splitlines()
    assert [line.partition(": ")[2].partition(":")[0] for line in lines] == [
        "bearing.ball_cout",
        "operation.preload_N",
        "bearing.contact_angle_deg",
        "materials.bearing_steel.brinell_hardness_GPa",
    ]
    assert lines[-1].endswith("got nothing, expected a number from 0.001 to 100, such as 6.6")


def test_of_many_faults_only_the_first_are_reported(tmp_path, capsys):
    """99 unknown keys have MOST_FAULTS lines."""
    scene = tmp_path / "broken.yaml"
    scene.write_text(GOOD + "".join(f"k{i}: 1\n" for i in range(99)))
    err = refusal(capsys, ["solve", str(scene), "-o", str(tmp_path / "x.nc")])
    assert err.count("\n") == MOST_FAULTS and "k0" in err and "k98" not in err


@pytest.mark.parametrize("command", ["life", "check"])
@pytest.mark.parametrize("name", ["unknown key", "alias bomb"])
def test_other_commands_refuse_broken_scenes_like_solve(command, name, tmp_path, capsys):
    """`life` and `check` name file and key, too, and write nothing."""
    contents, key, _ = BROKEN[name]
    scene, output = tmp_path / "broken.yaml", tmp_path / "life.nc"
    scene.write_text(contents)
    options = ["-o", str(output)] if command == "life" else []
    assert refusal(capsys, [command, str(scene), *options]).startswith(f"{scene}: {key}")
    assert not output.exists()


# options KEY=VALUE: key that must be named, further text of the line
OVERRIDES = {
    "operation.preload_N=-3": ("operation.preload_N", "-3"),
    "operation.shaft_speed_rpm= 18.000": ("operation.shaft_speed_rpm", "18000 or 18"),
    "operation.preload_N=[": ("operation.preload_N", "not YAML"),
    "bearing.ball_diameter_mm=4": ("bearing.ball_diameter_mm", "9 balls of 4 mm"),
    "bearing.ball_count.x=1": ("bearing.ball_count.x", "not a block"),
    "wear.end_of_life={preload_fraction: 2}": ("wear.end_of_life", "preload_fraction"),
}


@pytest.mark.parametrize("override", OVERRIDES)
def test_a_fault_of_an_override_is_named_by_its_option(override, tmp_path, capsys):
    key, text = OVERRIDES[override]
    output = tmp_path / "case.nc"
    scene = str(SCENES / "gyro_s1.yaml")
    line = refusal(capsys, ["solve", scene, "-o", str(output), "--set", override])
    assert line.startswith(f"--set {key}: ") and text in line, line
    assert not output.exists()


@pytest.mark.parametrize("override", ["operation.preload_N", "=3", "a..b=3", "a b=3"])
def test_an_override_without_key_and_value_is_refused(override, capsys):
    line = refusal(capsys, ["check", str(SCENES / "gyro_s1.yaml"), "--set", override])
    assert line.startswith("--set: ") and "KEY=VALUE" in line


def test_an_override_given_twice_is_refused(capsys):
    argv = ["check", str(SCENES / "gyro_s1.yaml")]
    argv += ["--set", "operation.preload_N=3", "--set", "operation.preload_N=4"]
    assert "more than once" in refusal(capsys, argv)


def test_a_fault_of_the_file_is_named_by_the_file_beside_an_override(tmp_path, capsys):
    scene = tmp_path / "broken.yaml"
    scene.write_text(BROKEN["too many balls"][0])
    line = refusal(capsys, ["check", str(scene), "--set", "operation.preload_N=3"])
    assert line.startswith(f"{scene}: bearing.ball_count: ")


@pytest.mark.parametrize("command", ["solve", "life"])
@pytest.mark.parametrize("what", ["missing", "folder", "line break", "zero byte"])
def test_a_scene_that_is_no_file_is_refused(command, what, tmp_path, capsys):
    """Missing files, a folder, and names with a line break or a zero byte take one line."""
    path = {
        "missing": str(tmp_path / "none.yaml"),
        "folder": str(tmp_path),
        "line break": str(tmp_path / "no\nfile.yaml"),
        "zero byte": "no\0file.yaml",
    }[what]
    line = refusal(capsys, [command, path, "-o", str(tmp_path / "x.nc")])
    assert ("got a folder" if what == "folder" else "cannot be read") in line
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("text", ["", "  end_of_life: {}\n", "  end_of_life: {skid_ratio: null}\n"])
def test_a_life_needs_a_criterion(text, tmp_path, capsys):
    """The block `end_of_life` is missing, empty, or has only null."""
    scene, output = tmp_path / "endless.yaml", tmp_path / "life.nc"
    end = GOOD[GOOD.index("  end_of_life:") :]
    scene.write_text(edited((end, text)))
    line = refusal(capsys, ["life", str(scene), "-o", str(output)])
    assert line.startswith(f"{scene}: wear.end_of_life: ") and "preload_fraction" in line
    assert not output.exists()


def test_a_share_of_no_preload_is_no_criterion(tmp_path, capsys):
    """The scene has a `preload_fraction`, and a preload of 0."""
    scene, output = tmp_path / "endless.yaml", tmp_path / "life.nc"
    scene.write_text(edited(("preload_N: 7.0", "preload_N: 0")))
    line = refusal(capsys, ["life", str(scene), "-o", str(output)])
    assert line.startswith(f"{scene}: wear.end_of_life.preload_fraction: ")
    assert not output.exists()


@pytest.mark.parametrize(
    ("key", "meant"),
    [
        ("preload_N", "operation.preload_N"),
        ("bearing.preload_N", "operation.preload_N"),
        ("operation.preload", "preload_N or preload_method"),
        ("operation.speed", "shaft_speed_rpm or lowest_speed_rpm or outer_speed_rpm"),
    ],
)
def test_a_key_of_another_block_is_named_whole(key, meant):
    with pytest.raises(SceneError, match=f"^--set {key}: .*; did you mean {meant}$"):
        load_scene(SCENES / "gyro_s1.yaml", [f"{key}=3"])
