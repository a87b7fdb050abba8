"""Mistakes that people make in commands and scenes: each is refused with helpful advice."""

import re
import shlex
from pathlib import Path

import pytest
from support import only_line

from bearingwear.atomic import SIGNATURE
from bearingwear.cli import main
from bearingwear.scene.new.scene_file import checked_scene, scene_text

CERAMIC, STEEL = "silicon_nitride", "bearing_steel"

REFUSED_OF_NEW = {
    "7008C --speed 18.000": "expected 18000 or 18;",
    "7008C --speed 18,000": "write 18000 or 18, without a comma",
    "7008C --speed '18 000'": "write 18000, without separators",
    "7008C --speed 18000rpm": "write the number alone",
    "7008C --speed -18000": "expected a number from 0",
    "7008C --preload 22lbf": "write 97.861, which is it in N",
    "7008C --preload 140,5": "write 140.5, with a decimal point",
    "7008C --preload -10": "expected a number from 0",
    "7008C --contact-angle 0": "because 7008C is an angular contact bearing",
    "7008C --contact-angle 15°": "write the number alone",
    "7008C --contact-angle 0.26rad": "write 14.897, which is it in degrees",
    "7008C --ball-diameter 5/16": "write 7.9375, which is it in mm",
    "7008C --ball-diameter 0.0084": "(mm; if it is in m, write 8.4)",
    "7008C --ball-diameter 0.3125in": "write 7.9375, which is it in mm",
    "7008C --ball-diameter 7,938": "write 7938 or 7.938, without a comma",
    "7008C --pitch-diameter 5.4": "expected a number > 48.4 and < 59.6",
    "--bore 0.040 --outside 0.068": "(mm; if it is in m, write 40)",
    "--bore 40 --outside 0.068": "(mm; if it is in m, write 68)",
    "--bore 1.5748in --outside 68": "write 40, which is it in mm",
    "7008C --speed 1885rad/s": "write 18000, which is it in r/min",
    "7008C --speed 300Hz": "write 18000, which is it in r/min",
    "7008C --speed '18 000 rpm'": "write the number alone: 18000",
    "7008C --speed 18krpm": "write 18000, which is it in r/min",
    "7008C --preload 0.14kN": "write 140, which is it in N",
    "7008C --preload 14kgf": "write 137.29, which is it in N",
    "--bore 68 --outside 40": "expected a number > 68, the bore",
    "--bore 40": "--outside: got nothing",
    "7008C --balls 15.5": "expected a whole number",
    "7008C --balls 22": "expected at most 20 of 8.4 mm",
    "7008C --friction 8": "expected a number from 0 to 2",
    "7008C --friction 8%": "write 0.08, as a share",
    "7008C --lubrication greese": "did you mean grease",
    "7008C --speed 18k": "write 18000, which is it in r/min",
    "7008C --rpm 18000": "did you mean --speed",
    "--bore 40 --od 68": "did you mean --outside",
    "7008C --preload 140 N": "numbers are typed without a unit and without spaces (140 alone)",
    "7008C --preload light": "did you mean --preload-class light",
    "7008C --maker FAG": "designations of other makers are read without it",
    "7008C --balls 15,0": "write 15)",
    "7008 25": "got the number 25, expected 7008 --contact-angle 25",
    "7008C 18000": "got the number 18000, expected 7008C --speed 18000",
    "--speed 18000": "got no designation, expected `bearingwear new x.yaml 7008C`",
    "7008C_pair": "got pair, expected 7008C --pair spring or --pair rigid",
    "7008C hybrid": "expected 7008C --ball-material silicon_nitride",
    "NSK7010C grease": "expected 7010C --lubrication grease",
    "7008C --pair springs": "did you mean spring",
    "7008C --pair spacer": "did you mean rigid",
    "5S-HSE010": "expected 7010 with --balls",
    "2LA-BNS910LLB": "expected 71910 with --balls",
    "7008C --pair rigid --preload-method constant_force": "expected fixed_position in a rigid pair",
    "7008CDT --pair spring": "only allowed without DT (tandem)",
    "7008C --film mos2": "it is now --lubrication",
    "7008C --lubricaton oil": "did you mean --lubrication",
    "7008C --preload-method spring": "did you mean constant_force",
    "7008C --preload-class Light": "did you mean light",
    "7010C --maker nsk": "did you mean NSK",
    "7008C --maker SKF": "expected NSK, SNFA, GMN",
    "7008C --ball-material ceramic": "did you mean silicon_nitride",
    "7008C --preload-method rigid": "did you mean fixed_position",
    "7008C 7208C": "expected one",
    "NU1008": "or --bore, --outside and --contact-angle",
    "7008D": "for another angle, 7008 with --contact-angle",
    "HCM7008-C": "or --bore, --outside and --contact-angle",
    "SEA60/NS7CE1": "expected --maker SNFA",
    "6204 --clearance C4": "expected C2, CN, C3",
}
"""Arguments of `bearingwear new`, and a part of the line that refuses them."""

DESIGNATIONS = {
    "SKF 7008 ACD/HCP4ADGA": (25, CERAMIC), "SKF S71908 FB/P7": (18, STEEL),
    "FAG HCB71910-C-T-P4S-UL": (15, CERAMIC), "FAG B7008-E-T-P4S-DBM": (25, STEEL),
    "NSK7010CSN24TRDULP4": (15, CERAMIC), "40BNR10HTYNDBLP4": (18, CERAMIC),
    "NTN 5S-7008UADDB/GMP4": (25, CERAMIC), "NTN 7008CDB/GLP4": (15, STEEL),
    "GMN HY KH 6010 C 2RZ TA P4 UL": (17, CERAMIC), "S6005ETAP4DUL": (25, STEEL),
    "SKF 7014 CD/HCP4AQBCA": (15, CERAMIC), "S7014 ACDGA/HCP4A": (25, CERAMIC),
    "FAG XCB71914-E-T-P4S-K5-UL": (25, CERAMIC), "HCS7014.C.T.P4S.UL": (15, CERAMIC),
    "NSK 70BNR10XTYNDBBLP4Y": (18, CERAMIC), "NSK7908A5SN24TRSULP3": (25, CERAMIC),
    "NTN 7014UCG/GNP42": (15, STEEL), "GMN HYS6204CTAP4": (15, CERAMIC),
    "GMN KH 6014 C TXM HG UL": (17, STEEL),
    "SNFA VEX 40/NS 7CE3 UL": (25, CERAMIC), "SNFA SEA 60 7CE1": (15, STEEL),
}  # fmt: skip
"""Contact angle [degree] and material of the balls by designations of makers."""

DOUBTED_OF_NEW = {
    "--bore 1.5748 --outside 2.67": "if they are in inches, write --bore 40 --outside 68",
    "7008C --preload 300000": "548 times a heavy preload; is it in N?",
}
"""Arguments of `new` that are allowed, and a part of its doubt among the assumptions."""

REFUSED_IN_A_SCENE = {
    "shaft_speed_rpm: 18.000": "expected 18000 or 18",
    "shaft_speed_rpm: 18,000": "write 18000 or 18, without a comma",
    "shaft_speed_rpm: 18_000": "write 18000",
    "shaft_speed_rpm: 18000 rpm": "write the number alone: 18000",
    "preload_N: 7,5": "write 7.5, with a decimal point",
    "preload_N: 22 lbf": "write 97.861, which is it in N",
    "preload_N: 0.14 kN": "write 140, which is it in N",
    "preload_N: -140": "expected a number from 0 to 10000000 (N)",
    "preload_lbf: 30": "got an unknown key; write preload_N: 133.45",
    "shaft_speed_rad_s: 1885": "got an unknown key; write shaft_speed_rpm: 18000",
    "ball_diameter_in: 0.3125": "got an unknown key; write ball_diameter_mm: 7.9375",
    "contact_angle_rad: 0.2618": "got an unknown key; write contact_angle_deg: 15",
    "youngs_modulus_MPa: 208000": "got an unknown key; write youngs_modulus_GPa: 208",
    "density_g_cm3: 7.8": "got an unknown key; write density_kg_m3: 7800",
    "preload_N:": "got nothing",
    "preload: 140": "did you mean preload_N",
    "\tpreload_N: 140": "a tab on line",
    "contact_angle_deg: 15°": "write the number alone: 15",
    "ball_diameter_mm: 0.0084": "(mm; if it is in m, write 8.4)",
    "pitch_diameter_mm: 0.054": "(mm; if it is in m, write 54)",
    "ball_count: 150": "expected at most 20",
    "ball_cout: 15": "did you mean ball_count",
    "youngs_modulus_GPa: 208000": "(GPa; if it is in MPa, write 208)",
    "density_kg_m3: 7.8": "(kg/m3; if it is in g/cm3, write 7800)",
    "poisson_ratio: 0,3": "write decimals with a point, not a comma",
    "brinell_hardness_GPa: 660": "(GPa; if it is in HB, write 6.4724)",
    "wear_coefficient: -5e-6": "expected a number > 0",
    "thermal_expansion_1_K: 11.5": "(1/K; if it is in 1e-6/K, write 1.15e-05)",
    "inner_groove_factor: 52": "expected a number > 0.5",
    "ball_material: steel": "did you mean bearing_steel",
    "ball_material: ceramic": "--ball-material silicon_nitride` writes a block",
    "preload_method: spring": "did you mean constant_force",
    "preload_method: rigid": "did you mean fixed_position",
    "gravity_m_s2: 9.81": "expected a list of three numbers",
    "ball_race: 8%": "write 0.08, as a share",
    "gravity_m_s2: [0, 0, -9,81]": "write decimals with a point, not a comma",
    "preload_n: 140": "write preload_N: 140",
    "mu: 0.08": "did you mean ball_race",
    "preload_N = 140": "got an equals sign on line",
    "preload_N:140": "got no space after the colon on line",
    " preload_N: 140": "got 3 spaces before the key on line",
    "end_of_life: {preload_fraction: 40}": "expected a number > 0 and < 1",
}
"""Lines in place of those of a scene, and a part of the line that refuses them."""

DOUBTED = {
    "contact_angle_deg: 0.2618": "0.2618 rad would be 15 degrees",
    "contact_angle_deg: 0": "needs a clearance of exactly 0",
    "ball_diameter_mm: 0.33": "fill 2.9 % of the pitch circle; check the unit",
    "brinell_hardness_GPa: 62": "62 HRC are 7 GPa",
    "wear_coefficient: 3.7e-19": "wear_coefficient is K_s, which is K_s/H times the hardness",
    "shaft_interference_um: 0.005": "too small to be measured; check the unit",
    "bore_mm: 0.04": "a bore of 0.04 mm is tiny",
}
"""Lines in place of those of a scene that are allowed, and a part of the warning of `check`."""

BLOCKS = {
    "bearing": "{ball_count: 15, ball_diameter_mm: 8.4, pitch_diameter_mm: 54,",
    "materials": "{bearing_steel: {youngs_modulus_GPa: 208,",
    "operation": "{shaft_speed_rpm: 18000, preload_method: constant_force, preload_N: 140}",
    "friction": "{ball_race: 0.08}",
}
"""Blocks that are missing, and the example in the line that refuses the scene."""

REFUSED_COMMANDS = {
    "slove a.yaml": "did you mean solve",
    "check a.nc": "got a result file, which `bearingwear show` prints",
    "check b.yaml": "cannot be read (No such file or directory)",
    "check a.yaml --set preload_N=9": "did you mean operation.preload_N",
    "check a.yaml --set operation.preload_N=9,5": "write 9.5, with a decimal point",
    "check a.yaml --set operation.shaft_speed_rpm=18.000": "expected 18000 or 18",
    "recommend a.yaml --slip 36": "a share: 0.36 for 36 %",
    "recommend a.yaml --slip 0,36": "write 0.36, with a decimal point",
    "recommend a.yaml --pressure 2000": "> 0 and <= 20 (GPa; if it is in MPa, write 2)",
    "recommend a.yaml --pressure 2000MPa": "write 2, which is it in GPa",
    "recommend a.yaml --stiffness 2e7": "(N/um; if it is in N/m, write 20)",
    "recommend a.yaml --stiffness 20000": "(N/um; if it is in N/mm, write 20)",
    "recommend a.yaml --rigidity 20": "did you mean --stiffness",
    "recommend a.yaml --stiffness -20": "expected a number > 0 and <= 10000 (N/um)",
    "recommend a.yaml --life 5years": "write 43830, which is it in h",
    "recommend a.yaml --stifness 20": "did you mean --stiffness",
    "recommend a.yaml --stiffness 20N/um": "write the number alone: 20",
    "plot a.yaml": "as `bearingwear solve a.yaml -o a.nc` writes one",
    "show a.yaml a.nc": "as `bearingwear solve a.yaml -o a.nc` writes one",
    "recommend README.md --stiffness 20": "got a .md file, expected a scene, such as `bearingwear",
    "recommend design.yaml": "got a file without any block of a scene (scenes)",
    "check a": "did you mean a.yaml",
    "life 7008C": "`bearingwear new 7008C` writes a scene",
    "export a.yaml --speeds 1000-5000 -o a.csv": "expected LOW:HIGH:COUNT",
    "check a.yaml --fidelity quasi-static": "did you mean steady",
    "check a.yaml --set operation.preload_N 9": "did you mean --set operation.preload_N=9",
    "check a.yaml --set arrangement.kind=pair": "did you mean rigid_pair or spring_pair",
    "check a.yaml --set materials.steel.density_kg_m3=7800": "did you mean bearing_steel",
    "check a.yaml --set uncertainty.ball_race=3": "such as {distribution: lognormal, factor: 3}",
    "solve a.yaml -o a.csv": "expected a name that ends in .nc; --csv prints the sheet",
    "solve a.yaml -o a.svg": "expected a name that ends in .nc; `bearingwear plot` draws it",
    "recommend a.yaml --stiffness 50 N/um": "(50 alone)",
    "recommend a.yaml --warmup 20min": "write 1200, which is it in s",
    "sweep a.yaml --axis operation.preload_N=100:200": "expected LOW:HIGH:COUNT",
    "sweep a.yaml --axis operation.preload_N=100N,200N": "write the number alone: 100",
    "compile fast": "expected steady, worn, dynamic;",
    "warmup a.yaml --limit pressure": "got pressure, expected pressure=GPA or preload=N",
    "warmup a.yaml --limit pressure=2000": "if it is in MPa, write 2",
    "launch a.yaml --axial 300m/s2": "write 30.591, which is it in g",
    "study a": "did you mean a.yaml",
    "study a --slip 0.36": "did you mean a.yaml",
    "recommend a.yaml --speed 12000": "write --set operation.shaft_speed_rpm=12000",
    "show results": "got a folder, expected a result file, such as results/a.nc",
    "plot results": "got a folder, expected a result file, such as results/a.nc",
    "check results": "got a folder, expected a scene file",
    "page results": "got a folder, expected .nc, .md, .svg, .png",
    "page a.yaml": "`bearingwear study a.yaml` makes its page",
    "study a.yaml --stifness 20": "did you mean --stiffness",
    "study a.yaml --stiffness 2e7": "(N/um; if it is in N/m, write 20)",
    "margin a.yaml --drive 20mNm": "write 0.02, which is it in N m",
}


@pytest.fixture
def scene_text_in_folder(tmp_path, monkeypatch):
    """Writes a.yaml and files that are no scenes to the present folder; returns its text."""
    monkeypatch.chdir(tmp_path)
    text, _ = scene_text("", None, None, {}, designation="7008C", lubrication="starved")
    (tmp_path / "a.yaml").write_text(text, encoding="utf-8")
    (tmp_path / "README.md").write_text("# Bearings: all of them\n\n- angle: 15, speed: 20\n")
    (tmp_path / "design.yaml").write_text("scenes: {a: {limits: {}}}\n", encoding="utf-8")
    (tmp_path / "a.nc").write_bytes(SIGNATURE + b"\xff")
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "a.nc").write_bytes(SIGNATURE + b"\xff")
    return text


NEAREST_KEYS = {
    "preload": "preload_N", "ball_cout": "ball_count", "preload_lbf": "preload_N",
    "shaft_speed_rad_s": "shaft_speed_rpm", "ball_diameter_in": "ball_diameter_mm",
    "contact_angle_rad": "contact_angle_deg", "youngs_modulus_MPa": "youngs_modulus_GPa",
    "density_g_cm3": "density_kg_m3", "preload_n": "preload_N", "mu": "ball_race",
}  # fmt: skip
"""Keys of a scene by mistyped ones."""


def text_with_line(text, line):
    """Returns the text of a scene in which a line replaces the same or the nearest key.

    Keys in comments stay.
    """
    key = line.strip().partition(":")[0]
    key = NEAREST_KEYS.get(key, key.partition(" ")[0])
    inline = re.compile(rf"(?<=[{{ ]){key}: (?:\[[^]]*\]|[^,\]}}\n#]*)")
    if line.startswith("\t"):
        return re.sub(rf"^ +{key}: .*$", line, text, count=1, flags=re.M)
    if "{" in line:
        return re.sub(rf"{key}: .*", line, text, count=1)
    lines = text.split("\n")
    k = next(k for k, old in enumerate(lines) if inline.search(old) and not old.startswith("#"))
    lines[k] = inline.sub(lambda _: f"{line} ", lines[k], count=1)
    return "\n".join(lines)


def refusal(argv, capsys):
    """Returns the only line of a command, which must end with status 2."""
    assert main(argv) == 2
    return only_line(capsys)


@pytest.mark.usefixtures("scene_text_in_folder")
@pytest.mark.parametrize(("text", "problem"), REFUSED_OF_NEW.items())
def test_a_mistake_in_arguments_of_new_is_refused_in_one_line(text, problem, capsys):
    assert problem in refusal(["new", "x.yaml", *shlex.split(text)], capsys)


@pytest.mark.usefixtures("scene_text_in_folder")
@pytest.mark.parametrize(("text", "doubt"), DOUBTED_OF_NEW.items())
def test_new_doubts_an_allowed_but_improbable_argument(text, doubt, capsys):
    assert main(["new", "x.yaml", *shlex.split(text)]) == 0
    assert doubt in capsys.readouterr().out


@pytest.mark.parametrize(("designation", "angle_and_balls"), DESIGNATIONS.items())
def test_designations_of_makers_give_contact_angle_and_ball_material(designation, angle_and_balls):
    bearing = checked_scene(scene_text("x", None, None, {}, designation=designation)[0]).bearing
    assert (bearing.contact_angle_deg, bearing.ball_material) == angle_and_balls


@pytest.mark.parametrize(("line", "problem"), REFUSED_IN_A_SCENE.items())
def test_a_mistake_in_a_scene_is_refused_in_one_line(line, problem, scene_text_in_folder, capsys):
    Path("x.yaml").write_text(text_with_line(scene_text_in_folder, line), encoding="utf-8")
    assert problem in refusal(["check", "x.yaml"], capsys)


@pytest.mark.parametrize(("block", "example"), BLOCKS.items())
def test_a_missing_block_is_refused_with_an_example(block, example, scene_text_in_folder, capsys):
    text = re.sub(rf"^{block}:.*\n(?:[ #].*\n)*", "", scene_text_in_folder, flags=re.M)
    Path("x.yaml").write_text(text, encoding="utf-8")
    problem = f"{block}: got nothing, expected a block, such as {example}"
    assert problem in refusal(["check", "x.yaml"], capsys)


@pytest.mark.parametrize(("line", "warning"), DOUBTED.items())
def test_check_doubts_an_allowed_but_improbable_value(line, warning, scene_text_in_folder, capsys):
    Path("x.yaml").write_text(text_with_line(scene_text_in_folder, line), encoding="utf-8")
    assert main(["check", "x.yaml"]) == 0
    assert warning in " ".join(capsys.readouterr().out.split())


@pytest.mark.usefixtures("scene_text_in_folder")
@pytest.mark.parametrize(("text", "problem"), REFUSED_COMMANDS.items())
def test_a_mistake_in_a_command_is_refused_in_one_line(text, problem, capsys):
    assert problem in refusal(shlex.split(text), capsys)


def test_a_name_in_a_folder_with_a_study_is_answered_with_the_scene_of_that_name(
    scene_text_in_folder, tmp_path, capsys
):
    """A clone is such a folder; Snakemake would look for a target of that name."""
    (tmp_path / "config").mkdir()
    (tmp_path / "config" / "config.yaml").write_text("scenes: {}\n", encoding="utf-8")
    assert "did you mean a.yaml" in refusal(["study", "a"], capsys)
    assert "did you mean a.yaml" in refusal(["study", "a/"], capsys)
