"""Designations of common bearings and the clearances of deep groove ones."""

import itertools
import re

import pytest

from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.new.assumed import size_of
from bearingwear.scene.new.designations import (
    ANGLES,
    CLEARANCES,
    Designation,
    clearance_range,
    designation_of,
)
from bearingwear.scene.new.letters import Letters
from bearingwear.scene.new.scene_file import checked_scene, scene_text

CODES = [f"{code:02d}" for code in [*range(23), *range(24, 41, 2)]]
SERIES = ["70", "72", "73", "719", "60", "62", "63"]


@pytest.mark.parametrize(
    ("designation", "bore", "outside", "width"),
    [
        # the ends of the table and common sizes, entered once more
        ("7008C", 40, 68, 15), ("7204B", 20, 47, 14), ("71914E", 70, 100, 16), ("7000", 10, 26, 8),
        ("6000", 10, 26, 8), ("6001", 12, 28, 8), ("6002", 15, 32, 9), ("6003", 17, 35, 10),
        ("6004", 20, 42, 12), ("6005", 25, 47, 12), ("6006", 30, 55, 13), ("6009", 45, 75, 16),
        ("6010", 50, 80, 16), ("6200", 10, 30, 9), ("6201", 12, 32, 10), ("6202", 15, 35, 11),
        ("6203", 17, 40, 12), ("6205", 25, 52, 15), ("6206", 30, 62, 16), ("6207", 35, 72, 17),
        ("6208", 40, 80, 18), ("6209", 45, 85, 19), ("6210", 50, 90, 20), ("71900", 10, 22, 6),
        ("71908", 40, 62, 12), ("7020", 100, 150, 24), ("7220", 100, 180, 34),
        ("7300", 10, 35, 11), ("7308B", 40, 90, 23), ("7312", 60, 130, 31), ("6320", 100, 215, 47),
        ("6340", 200, 420, 80), ("7910C", 50, 72, 12),
        ("608", 8, 22, 7), ("604", 4, 12, 4), ("623", 3, 10, 4), ("625", 5, 16, 5),
        ("688", 8, 16, 4), ("682", 2, 5, 1.5), ("695", 5, 13, 4), ("699", 9, 20, 6),
    ],
)  # fmt: skip
def test_a_designation_gives_bore_outside_and_width(designation, bore, outside, width):
    parsed = designation_of(designation)
    assert (parsed.bore, parsed.outside, parsed.width) == (bore, outside, width)
    assert parsed.deep_groove == designation.startswith("6") and parsed.name == designation


@pytest.mark.parametrize("series", SERIES)
def test_sizes_grow_with_the_bore_code(series):
    """They do in every dimension series, so that a wrong entry of the table stands out."""
    sizes = [designation_of(series + code) for code in CODES]
    for smaller, size in itertools.pairwise(sizes):
        assert size.bore > smaller.bore and size.outside > smaller.outside
        assert size.width >= smaller.width
    for size in sizes:
        section = 0.5 * (size.outside - size.bore)
        assert 0.7 < size.width / section < 1.3  # narrow series: nearly square


@pytest.mark.parametrize("text", ["7008C", "7008 C", "7008-c", "7008/C", " 7008_C "])
def test_spaces_dashes_and_small_letters_make_no_difference(text):
    assert designation_of(text) == designation_of("7008C")


SUFFIXES = {"": None, "C": 15, "FB": 18, "FE": 18, "AC": 25, "A5": 25, "AD": 25, "E": 25, "A": 30,
            "B": 40}  # fmt: skip


def test_every_suffix_of_an_angle_is_tested():
    assert set(SUFFIXES) == {"", *ANGLES}


@pytest.mark.parametrize(("suffix", "angle"), SUFFIXES.items())
def test_a_suffix_gives_the_contact_angle(suffix, angle):
    """Makers use E and A for different angles, so that a line states the rule for these."""
    designation = designation_of(f"7210{suffix}")
    assert designation.angle == angle and bool(designation.angle_rule) == (suffix in ("E", "A"))


@pytest.mark.parametrize("group", CLEARANCES)
def test_a_suffix_gives_the_clearance_group(group):
    assert designation_of(f"6210{group}").clearance == group


@pytest.mark.parametrize(
    ("text", "name", "balls", "pair", "load", "ignored"),
    [
        ("7008CD/P4A", "7008C", "", "", "", "D P4A"),  # SKF
        ("S7008 ACE/HCP4A", "7008AC", "HC", "", "", "S E P4A"),
        ("S7012 FB", "7012FB", "", "", "", "S"),
        ("7012 CB", "7012C", "", "", "", "B"),
        ("B7008-C-T-P4S", "7008C", "", "", "", "B T P4S"),  # FAG
        ("HCB71908-E-T-P4S-UL", "71908E", "HCB", "U", "L", "T P4S"),
        ("XCB7008-C-T-P4S-UM", "7008C", "XCB", "U", "M", "T P4S"),
        ("HCS7008C", "7008C", "HCS", "", "", ""),
        ("7010A5TYNSULP3", "7010A5", "", "SU", "L", "TYN P3"),  # NSK
        ("7013CSN24TYNDBLP4", "7013C", "SN24", "DB", "L", "TYN P4"),
        ("7308 BECBP", "7308B", "", "CB", "", "P"),  # CB is a clearance of pairs here
        ("7208 BEGAP", "7208B", "", "G", "A", "P"),
        ("7008 CDGA/P4A", "7008C", "", "G", "A", "P4A"),
        ("7008 ACD/HCP4ADGA", "7008AC", "HC", "DG", "A", "D P4A"),
        ("7008 CD/P4ADBB", "7008C", "", "DB", "B", "D P4A"),
        ("7208 ACD/P4AQBCB", "7208AC", "", "QBC", "B", "D P4A"),
        ("71908 CE/HCP4AL", "71908C", "HC", "", "", "E P4AL"),  # L: holes for oil
        ("7208-B-TVP-UO", "7208B", "", "UO", "", "TVP"),
        ("CB71908C", "71908C", "CB", "", "", ""),  # IBC
        ("CH71908CVDTJ84", "71908C", "CH", "", "", "VDTJ84"),  # SNR
        ("5S-7008C", "7008C", "5S", "", "", ""),  # NTN
        ("5S-7008UCG/GNP42", "7008C", "5S", "G", "GN", "P42 U"),
        ("7008UADDB/GMP4", "7008AD", "", "DB", "GM", "P4 U"),
        ("7008ADDB/GLP4", "7008AD", "", "DB", "GL", "P4"),
        ("7204-B-XL-TVP", "7204B", "", "", "", "XL TVP"),
        ("7008-P4", "7008", "", "", "", "P4"),
        ("B7008", "7008", "", "", "", "B"),
        ("S6005CTAP4DUL", "S 6005 C", "", "DU", "L", "TA P4"),  # GMN
        ("6008ETXM", "S 6008 E", "", "", "", "TXM"),
        ("S6205CTA", "S 6205 C", "", "", "", "TA"),
        ("HY KH 61914 2RZ C TA P4 UM", "KH 61914 C", "HY", "U", "M", "TA P4"),
        ("SM 61918 18 TA", "SM6191818", "", "", "", "TA"),
        ("6204-2RSH/C3", "6204C3", "", "", "", "2RSH"),
        ("6204-2RSLTN9/HC5C3WT", "6204C3", "HC5", "", "", "2RSLTN9 WT"),
        ("HC6204", "6204", "HC", "", "", ""),
        ("6204ZZC3", "6204C3", "", "", "", "ZZ"),
        ("6204ZZ P63", "6204C3", "", "", "", "ZZ P6"),
        ("6204DDU", "6204", "", "", "", "DDU"),  # seals, no pair
        ("608-2Z", "608", "", "", "", "2Z"),
        ("608ZZ", "608", "", "", "", "ZZ"),
    ],
)
def test_the_letters_of_makers_are_understood(text, name, balls, pair, load, ignored):
    """Letters stand for the balls, a pair and its preload; others change nothing here.

    Each group of letters has a line on what it means. Without them, the designation is `name`.
    """
    designation = designation_of(text)
    letters = designation.letters
    parts = letters.ball_letters, letters.pair, letters.load, letters.ignored
    assert (designation.name, *parts) == (name, balls, pair, load, ignored)
    assert letters.ball_material == ("silicon_nitride" if balls else None)
    assert len(letters.explanations()) == sum(map(bool, (*parts, letters.small_balls)))
    assert designation._replace(letters=Letters()) == designation_of(name)


@pytest.mark.parametrize(
    ("text", "angle", "deep_groove"),
    [
        ("S6005C", 15, False), ("KH6014C", 17, False), ("KH6014E", 25, False),
        ("SM600518", 18, False), ("S6026E", 25, False), ("S6026C", 15, False),
        ("KH6020C", 17, False), ("SM6026C", 17, False), ("6005", None, True),
    ],
)  # fmt: skip
def test_spindle_bearings_numbered_like_deep_groove_ones_have_an_angle(text, angle, deep_groove):
    designation = designation_of(text)
    assert (designation.angle, designation.deep_groove) == (angle, deep_groove)
    size = designation_of("70" + re.search(r"60(\d\d)", text)[1])
    assert (designation.bore, designation.outside) == (size.bore, size.outside)


def test_ceramic_balls_reach_the_scene():
    text, assumptions = scene_text("a", None, None, {}, designation="HCB71910-C-T-P4S")
    assert checked_scene(text).bearing.ball_material == "silicon_nitride"
    assert re.search(r"^ *ball_material: silicon_nitride +# .*HCB", text, re.MULTILINE)
    assert not any(line.startswith("bearing.ball_material") for line in assumptions)
    (line,) = [line for line in assumptions if line.startswith("designation: ")]
    assert "HCB" in line and "silicon nitride" in line
    with pytest.raises(SceneError, match="--ball-material: got bearing_steel, .* because of HCB"):
        scene_text("a", None, None, {}, "bearing_steel", designation="HCB71910-C-T-P4S")


@pytest.mark.parametrize(
    ("text", "letters"),
    [("HS7008-C-T-P4S", "HS"), ("XC71910E", "XC"), ("HCSS7008-C", "HCSS"), ("RS7008-C", "RS")],
)
def test_letters_of_a_high_speed_series_ask_for_the_size_of_its_small_balls(text, letters):
    """The program does not know that size, and names the option for it."""
    read = designation_of(text).letters
    assert read.small_balls == letters and letters not in read.ignored.split()
    assert "--ball-diameter" in " ".join(read.explanations())


@pytest.mark.parametrize("text", ["B7008-C", "HCB7008-C", "HC6204", "S7008-C"])
def test_letters_of_other_series_mean_no_small_balls(text):
    letters = designation_of(text).letters
    assert letters.small_balls == "" and "--ball-diameter" not in " ".join(letters.explanations())


def test_letters_of_small_balls_before_an_unknown_designation_are_refused():
    """7008D is none."""
    with pytest.raises(SceneError, match="designation: got 'RS7008D-C', expected"):
        designation_of("RS7008D-C")


@pytest.mark.parametrize(
    ("text", "option", "preload"),
    [
        ("NSK7010C", {}, "class L"),
        ("NSK 7010C TYN DB M P4", {}, "class M"),
        ("NSK7010CTYNDBHP4", {}, "class H"),
        ("7010C DBM", {"maker": "NSK"}, "class M"),
        ("B7010-C-T-P4S-UM", {}, "medium,"),
        ("B7010-C-T-P4S", {}, "light,"),
        ("7010C DBM", {"preload_class": "heavy"}, "heavy,"),
        ("SNFA SEA 60/NS 7CE1 DDF", {}, "class F"),
        ("SKF 7008 CD/P4ADBC", {}, "heavy,"),
        ("NTN 7008UCDB/GMP4", {}, "medium,"),
        ("7010CDBELP4", {}, "light,"),
    ],
)
def test_the_preload_is_that_of_the_makers_class(text, option, preload):
    written, _ = scene_text("a", None, None, {}, designation=text, **option)
    (line,) = re.findall("preload_N: .*", written)
    assert preload in line


@pytest.mark.parametrize(
    ("text", "balls", "ball", "preload"),
    [
        ("S6005CTAP4DUL", 15, 6.35, "70.0  # GMN class L"),
        ("6008ETXM", 18, 7.938, "180.0  # GMN class L"),
        ("S6205CTA", 13, 7.938, "100.0  # GMN class L"),
        ("HY KH 61914 2RZ C TA P4 UM", 32, 6.35, "200.0  # GMN class M"),
    ],
)
def test_designations_of_gmn_have_its_balls(text, balls, ball, preload):
    """GMN prints the balls of spindle bearings. A designation shows the maker without its name."""
    written, _ = scene_text("a", None, None, {}, designation=text)
    bearing = checked_scene(written).bearing
    assert (bearing.maker, bearing.ball_count, bearing.ball_diameter_mm) == ("GMN", balls, ball)
    assert bearing.contact_angle_deg in (15.0, 17.0, 25.0)
    assert (bearing.ball_material == "silicon_nitride") == text.startswith("HY")
    assert f"preload_N: {preload}" in written


@pytest.mark.parametrize(
    ("text", "angle", "balls", "pair"),
    [
        ("40BNR10STYNDBLP4", 18.0, None, "DB"),
        ("40BNR10HTYNDBLP4Y", 18.0, "silicon_nitride", "DB"),
        ("NSK 40 BER10X V1V SU EL P4Y", 25.0, "silicon_nitride", "SU"),
        ("40BER19S", 25.0, None, ""),
    ],
)
def test_the_robust_series_of_nsk_has_the_sizes_of_70_and_719(text, angle, balls, pair):
    """Its designations have the bore in mm; S, H and X behind the series are materials."""
    size = size_of(text, None, None)
    iso = designation_of("71908" if "19" in text else "7008")
    assert (size.bore, size.outside, size.width) == (iso.bore, iso.outside, iso.width)
    assert size.angle == angle and size.letters.ball_material == balls
    assert size.letters.pair == pair


def test_a_class_of_preload_without_a_rule_is_named():
    _, assumptions = scene_text("a", None, None, {}, designation="7010CDBELP4")
    (line,) = [line for line in assumptions if line.startswith("designation")]
    assert "class EL" in line and "light" in line and "--preload" in line


@pytest.mark.parametrize(
    ("text", "orientation"), [("7010CDFL", "face_to_face"), ("7010CDBL", "back_to_back")]
)
def test_the_orientation_of_a_pair_stands_in_the_file(text, orientation):
    written, assumptions = scene_text("a", None, None, {}, designation=text)
    assert f"# arrangement: {{kind: spring_pair, orientation: {orientation}," in written
    assert sum("both with --pair spring or --pair rigid" in line for line in assumptions) == 1


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("SM 6005", "expected SM 6005 C (GMN spindle bearings)"),
        ("SM 6005 17", "expected SM 6005 C (GMN spindle bearings)"),
        ("KH6007", "expected KH 6007 C, KH 6007 E (GMN spindle bearings)"),
        ("S 6007 D", "C3, or S 6007 C, S 6007 E (GMN spindle bearings)"),
    ],
)
def test_the_nearest_bearings_of_gmn_are_named(text, expected):
    with pytest.raises(SceneError) as error:
        designation_of(text)
    assert expected in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize(("text", "is_there"), [("SM 6205 C", False), ("S 6205 C", True)])
def test_a_bearing_not_in_the_gmn_catalogue_is_reported(text, is_there):
    """Its size and angle follow from rules of GMN; balls and grooves are assumed."""
    written, assumptions = scene_text("a", None, None, {}, designation=text)
    assert any("not in GMN's catalogue" in line for line in assumptions) == (not is_there)
    assert (checked_scene(written).bearing.maker == "GMN") == is_there


def test_a_digit_after_ce_is_the_angle_of_a_bearing_of_snfa():
    """1 is 15 degrees and 3 is 25 degrees; others are refused."""
    assert [size_of(f"SNFA SEA 60 7CE{k}", None, None).angle for k in (1, 3)] == [15, 25]
    with pytest.raises(SceneError, match="SNFA designation: got .* expected --contact-angle"):
        size_of("SNFA EX 20 7CE2", None, None)


def test_the_name_of_a_maker_whose_catalogue_is_not_known_changes_nothing():
    assert size_of("FAG B7008-C", None, None) == size_of("B7008-C", None, None)


def test_a_size_that_the_makers_catalogue_lacks_is_the_standard_one():
    size = size_of("NSK 6204", None, None)
    assert isinstance(size, Designation) and (size.bore, size.outside) == (20, 47)


def test_two_makers_are_refused():
    with pytest.raises(SceneError, match="--maker: got SNFA, expected NSK"):
        size_of("NSK 7010C", None, None, maker="SNFA")


@pytest.mark.parametrize(
    "text",
    ["", "7", "7008D", "7508", "6204C", "7008C3", "681", "603", "622", "691", "7023", "7042",
     "70008", "7008D/P4", "7008-C3", "ABCDE7008",
     # letters that could say angle, balls or type, and are not known
     "HCM7008C", "RS7008-D", "40BNR11S", "41BNR10S",
     "ABC7008C", "7008-P4-C", "7008F", "S6005", "6005C", "6204DDUCM", "6204ZZC4", "16008",
     "7" * 500, "7008\0", "608B", "6204C4", "KH608C", "608ETXM", "S 608 E"],
)  # fmt: skip
def test_unknown_designations_are_refused_in_one_line(text):
    with pytest.raises(ValueError, match="designation: got .*, expected ") as error:
        designation_of(text)
    assert "\n" not in str(error.value) and len(str(error.value)) < 360  # a few lines of a screen


@pytest.mark.parametrize(
    ("bore", "ranges"),
    [
        (8, [(0, 7), (2, 13), (8, 23)]),
        (10, [(0, 7), (2, 13), (8, 23)]),
        (10.5, [(0, 9), (3, 18), (11, 25)]),
        (20, [(0, 10), (5, 20), (13, 28)]),
        (50, [(1, 11), (6, 23), (18, 36)]),
        (100, [(1, 18), (12, 36), (30, 58)]),
        (200, [(2, 30), (25, 71), (63, 117)]),
        (200.1, [None, None, None]),
    ],
)
def test_clearance_groups_are_those_of_the_standard(bore, ranges):
    """Ranges [um] of C2, CN and C3 in ISO 5753-1, for deep groove bearings with cylindrical bores.

    A range applies to bores [mm] up to an end of the standard's table.
    """
    assert [clearance_range(group, bore) for group in CLEARANCES] == ranges
