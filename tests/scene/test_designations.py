"""Designations of common bearings and the clearances of deep groove ones."""

import pytest

from bearingwear.scene.new.designations import ANGLES, CLEARANCES, clearance_range, designation_of

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
def test_sizes(designation, bore, outside, width):
    found = designation_of(designation)
    assert (found.bore, found.outside, found.width) == (bore, outside, width)
    assert found.deep_groove == designation.startswith("6") and found.name == designation


@pytest.mark.parametrize("series", SERIES)
def test_sizes_grow_with_the_bore_code(series):
    """As in any dimension series: a wrong entry of the table would stand out."""
    sizes = [designation_of(series + code) for code in CODES]
    for a, b in zip(sizes, sizes[1:], strict=False):
        assert b.bore > a.bore and b.outside > a.outside and b.width >= a.width
    for size in sizes:
        section = 0.5 * (size.outside - size.bore)
        assert 0.7 < size.width / section < 1.3  # narrow series: nearly square


@pytest.mark.parametrize("text", ["7008C", "7008 C", "7008-c", "7008/C", " 7008_C "])
def test_spelling(text):
    assert designation_of(text) == designation_of("7008C")


def test_suffixes():
    angles = {"": None, "C": 15, "AC": 25, "A5": 25, "E": 25, "A": 30, "B": 40}
    assert set(angles) == {"", *ANGLES}
    for suffix, angle in angles.items():
        found = designation_of(f"7210{suffix}")
        assert found.angle == angle and bool(found.angle_rule) == (suffix in ("E", "A"))
    for group in CLEARANCES:
        assert designation_of(f"6210{group}").clearance == group


@pytest.mark.parametrize(
    ("text", "name", "ignored"),
    [
        ("7008CD/P4A", "7008C", "D P4A"),  # SKF
        ("S7008 ACE/HCP4A", "7008AC", "S E HCP4A"),
        ("B7008-C-T-P4S", "7008C", "B T P4S"),  # FAG
        ("HCB71908-E-T-P4S-UL", "71908E", "HCB T P4S UL"),
        ("7010A5TYNSULP3", "7010A5", "TYNSULP3"),  # NSK
        ("7308 BECBP", "7308B", "ECBP"),
        ("7204-B-XL-TVP", "7204B", "XL TVP"),
        ("7008-P4", "7008", "P4"),
        ("B7008", "7008", "B"),
        ("6204-2RSH/C3", "6204C3", "2RSH"),
        ("608-2Z", "608", "2Z"),
        ("608ZZ", "608", "ZZ"),
    ],
)
def test_designations_of_other_makers(text, name, ignored):
    """What is not used is said, the rest is as without it."""
    found = designation_of(text)
    assert (found.name, found.ignored) == (name, ignored)
    assert found._replace(ignored="") == designation_of(name)


@pytest.mark.parametrize(
    "text",
    ["", "7", "7008D", "7508", "6204C", "7008C3", "681", "603", "622", "691", "7023", "7042",
     "70008", "7008D/P4", "7008-C3", "ABCDE7008", "7" * 500, "7008\0", "608B", "6204C4"],
)  # fmt: skip
def test_what_is_not_known_takes_one_line(text):
    with pytest.raises(ValueError, match="designation: got .*, expected ") as error:
        designation_of(text)
    assert "\n" not in str(error.value) and len(str(error.value)) < 320


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
def test_clearances(bore, ranges):
    """ISO 5753-1, deep groove bearings with a cylindrical bore."""
    assert [clearance_range(group, bore) for group in CLEARANCES] == ranges
