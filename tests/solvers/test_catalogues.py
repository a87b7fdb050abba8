"""Numbers of catalogues and of a commercial program, against those of this program."""

import re

import numpy as np
import pytest
from support import benchmark

import bearingwear
from bearingwear.solvers.bearing.at_rest import RestingPair


@pytest.fixture(scope="module")
def catalogues():
    return benchmark("catalogues")


ODD_ROWS = {
    "S 619/5 C TA", "S 605 C TA", "SM 605 C TA", "S 606 C TA", "SM 606 C TA", "S 626 C TA",
    "S 619/9 C TA", "S 61900 C TA", "KH 61900 C TA", "KH 6001 C TA", "KH 6001 E TA",
    "KH 61903 E TA", "SM 6019 C TA",
}  # fmt: skip
"""Rows of GMN that break a rule of their series as printed: small sizes, whose numbers are round,
two pitch circles that are not half way between bore and outside, and single numbers."""


ROWS_OF_GMN = 269
"""Bearings in benchmarks/catalogue/gmn.csv."""


def test_every_row_of_gmn_agrees_with_the_others():
    """Sizes, balls, ratings, speeds, preloads, rigidities; those that do not are known by name."""
    checked = benchmark("gmn_rows").Checked()
    assert len(checked.rows) == ROWS_OF_GMN
    assert set(checked.all_failures()) == ODD_ROWS


def test_wrong_digits_replace_one_digit_before_the_trailing_zeros():
    assert list(benchmark("gmn_rows").wrong_digits("1200")) == [
        *(f"{k}200" for k in "023456789"), *(f"1{k}00" for k in "013456789")
    ]  # fmt: skip


def test_checks_of_rows_find_misread_digits():
    """They find nine of ten wrong sizes, and four of ten other wrong numbers, at least.

    Every 25th row is tried; the page has the shares of all rows.
    """
    rows = benchmark("gmn_rows")
    shares = rows.shares_found(every=25)
    assert set(shares) == set(rows.COLUMNS) and min(shares.values()) > 0.4
    assert min(shares[name] for name in ("bore_mm", "outside_mm", "width_mm", "pitch_mm")) > 0.9


def test_rows_are_read_from_the_text_of_the_catalogue():
    """One row as the text has it, and then with a digit more than in the table."""
    rows = benchmark("gmn_rows")
    name, numbers = "KH 6007 E TA", rows.numbers()["KH 6007 E TA"]
    before, after = (
        [f"{numbers[column]:g}" for column in columns] for columns in (rows.BEFORE, rows.AFTER)
    )
    text = "\n".join([name, *before, "1.5", "0.3", *after, name])
    assert name not in rows.differences_from_text(text)
    assert len(rows.differences_from_text(text)) == ROWS_OF_GMN - 1  # which are not in it
    assert name in rows.differences_from_text(text.replace("0.3\n", "0.3\n9"))


@pytest.fixture(scope="module")
def groups(catalogues):
    return catalogues.groups()


@pytest.mark.parametrize(
    ("name", "source", "count"),
    [
        ("axial rigidity of a pair", "NSK", 256),
        ("axial clearance of a pair", "NSK", 256),
        ("ratio of radial to axial rigidity", "NSK, SNFA, GMN", 10),
        ("low-speed torque, one coefficient", "SNFA", 32),
        ("exponent of torque against preload", "SKF", 16),
        ("axial rigidity of a pair, series S", "GMN", 433),
        ("axial rigidity of a pair, series SM", "GMN", 138),
        ("axial rigidity of a pair, series KH", "GMN", 170),
        ("displacement under load", "ISO 16281", 4),
        ("lift-off load", "SNFA", 3),
        ("axial deflection", "SNFA", 10),
        ("torque / thrust^(4/3), 218", "SKF", 3),
        ("orbital speed of balls", "kinematics", 2),
        ("starting torque of a 108H pair", "NASA", 3),
    ],
)
def test_each_group_of_comparisons_keeps_its_limit(groups, name, source, count):
    """Every row counts in the root mean square of the differences, which a limit bounds.

    A group with `fails` is one that the page reports as failed: its limit is exceeded. In the
    others, only known misprints lie far off.
    """
    (group,) = [group for group in groups if (group.name, group.source) == (name, source)]
    assert len(group.rows) == count
    misprints = ["KH 61903 E M, axial rigidity"] if name.endswith("KH") else []
    assert group.rms > group.allowed if group.fails else group.rms <= group.allowed
    if not group.fails:
        assert [row.what for row in group.suspects] == misprints


def test_all_torques_of_the_maker_are_compared(groups, catalogues):
    """Sixteen bearings, each as a pair and as a quad, differ by 14.0 % from one coefficient.

    A regression value, which the page quotes.
    """
    (torque,) = [group for group in groups if group.fails]
    assert torque.name == "low-speed torque, one coefficient"
    printed = catalogues.makers.printed_rows(catalogues.makers.PRINTED / "snfa_ball_screw.csv")
    assert len({row["designation"] for row in printed}) == 16
    assert torque.rms == pytest.approx(0.140, abs=1e-3)
    page = catalogues.PAGE.read_text("utf-8")
    assert catalogues.makers.torque_sentences(torque.rows) in page


def test_the_first_screen_counts_all_groups_and_values(groups, catalogues):
    assert len(groups) == 14  # those of the test above, of which each has its number of rows
    values = sum(len(group.rows) for group in groups)
    kept = sum(not group.fails for group in groups)
    first_screen = catalogues.PAGE.read_text("utf-8").partition("<!-- totals")[0]
    counts = rf"\b{kept} of {len(groups)} comparisons\b.* {values} values"
    assert re.search(counts, first_screen)


def test_grooves_of_the_ratings_meet_the_rigidities(catalogues, groups):
    """The means of S, SM and KH differ by 2, 0.5 and 0.5 % at most; nothing is fitted to a row.

    With a groove factor of 0.52, SM and KH would be 15 % off.
    """
    gmn = [group for group in groups if group.source == "GMN"]
    assert catalogues.makers.gmn_sentences(gmn) in catalogues.PAGE.read_text("utf-8")
    for group, mean in zip(gmn, (0.02, 0.005, 0.005), strict=True):
        assert abs(group.differences.mean()) < mean
    closed = catalogues.makers.gmn_rows(0.52)
    assert all(np.mean([row.difference for row in closed[s]]) > 0.15 for s in ("SM", "KH"))


def test_the_arm_of_the_starting_torque_is_that_of_the_measured_pair(catalogues):
    """The arm is starting torque over preload: 24 um times 267 N are the 6.4 mN m measured.

    The page has the paragraph with the present numbers.
    """
    assert 1e-3 * catalogues.MEASURED_ARM * 267.0 == pytest.approx(6.4, abs=0.05)
    assert catalogues.starting_torque_sentence() in catalogues.PAGE.read_text("utf-8")


def test_the_page_has_these_totals(catalogues, groups):
    """The sentence of totals, the row table of misprints, and two cells of a table near the top.

    One has the number and the range of the comparisons at rest, the other the two of torques.
    """
    page = catalogues.PAGE.read_text(encoding="utf-8")
    assert catalogues.totals(groups) in page
    at_rest = [group for group in groups if group.source in ("NSK", "GMN")]
    relative = [group.rms for group in at_rest if not group.rows[0].absolute]
    ends = f"{100.0 * min(relative):.1f} to {100.0 * max(relative):.1f} %"
    values = sum(len(group.rows) for group in at_rest)
    cells = [cell for line in page.splitlines() if line[:1] == "|" for cell in line.split("|")]
    assert any(cell.startswith(f" {values} ") and ends in cell for cell in cells)
    (torque,) = [group for group in groups if group.fails]
    starting = max(group.differences.max() for group in groups if group.source == "NASA")
    off, rms = f"{100.0 * starting:+.0f} %", f"{100.0 * torque.rms:.0f} %"
    assert any(off in cell and rms in cell for cell in cells)
    assert catalogues.row_table(catalogues.makers.misprint_rows()) in page


def test_misprinted_catalogue_rows_are_not_kept(catalogues):
    """Five rows, whose numbers break the rule of all others."""
    rows = catalogues.makers.misprint_rows()
    assert len(rows) == 5 and not any(row.kept for row in rows)


@pytest.mark.parametrize("preload_class", ["EL", "H"])
@pytest.mark.parametrize("designation", ["7000C", "7010A5", "7218A", "7930C"])
def test_a_solve_and_a_plain_program_have_the_same_rigidity(catalogues, designation, preload_class):
    """A rigid pair that stands still, by the command's own solve."""
    inputs = {"designation": designation, "maker": "NSK", "preload_class": preload_class}
    scene = bearingwear.new(**inputs, speed=0.0).with_({"arrangement.kind": "rigid_pair"})
    axial, radial = RestingPair.of(scene).rigidity
    with (
        pytest.warns(UserWarning, match="temperature is neglected"),
        pytest.warns(UserWarning, match="no interference fit"),
    ):
        case = bearingwear.solve(scene)
    assert case.status == "ok"
    assert float(case.system_axial_stiffness) == pytest.approx(axial, rel=1e-6)
    assert 2.0 * np.mean(case.stiffness_matrix[:, 1, 1]) == pytest.approx(radial, rel=1e-6)
    # 3e-4: the plain program lets the Hertz factors follow the angle, the others hold them
    assert catalogues.makers.plain_rigidity(scene) == pytest.approx(axial, rel=3e-4)


def test_speed_of_rigid_pairs_by_pv_and_by_heat():
    """Speed of a rigid pair over that under a spring, for the preload classes EL and H.

    The maker's rule has 0.85 and 0.55. Equal p v allows 0.70 for both classes, equal heat 0.53 for
    EL and far less for H. The shares are those of the page, to its digits.
    """
    limits = benchmark("speed_limits")
    entry = limits.entry_of("NSK", "7010C")[0]
    pv, heat = limits.severity(entry, "constant_force", entry.preloads["EL"], entry.speed_grease)

    def shares(quantity, limit):
        return [limits.share(entry, entry.preloads[name], quantity, limit) for name in ("EL", "H")]

    assert shares(limits.PV, pv) == pytest.approx([0.70, 0.70], abs=0.1)
    light, heavy = shares(limits.HEAT, heat)
    assert light == pytest.approx(0.53, abs=0.06) and heavy < 0.6 * light
