"""Wear of films by tables of their lives: the table, what it refuses, and what follows from it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.stats import chi2
from support import benchmark, numbers_in, scene_file

from bearingwear.cli import main
from bearingwear.document.rows import TABLE_TESTS
from bearingwear.lives.life import life
from bearingwear.results.warnings import warnings_in
from bearingwear.scene.coefficients import (
    FILM_SCATTER,
    M2_PER_N,
    MEASURED_WEAR,
    MOS2_LIVES,
    MOS2_WEAR,
)
from bearingwear.scene.friction import FilmLife
from bearingwear.scene.read import variant
from bearingwear.solvers.bearing.films import Films, WearTable
from bearingwear.solvers.solve import solve

NAMES = ("pressure_MPa", "temperature_C", "relative_life")
ROWS = [dict(zip(NAMES, row, strict=True)) for row in MOS2_LIVES]
TABLE = {"friction.film.wear_table": ROWS}
HERTZ = {"model.contact": "hertz"}
SET = "friction.film.wear_table"


def warm(degC):
    """Returns keys of a scene that runs at this temperature and was mounted at it, too."""
    parts = ("inner_ring_C", "balls_C", "outer_ring_C", "reference_C")
    return {"temperature": dict.fromkeys(parts, degC)}


def relative_life(pressure, degC):
    """Returns a life over that at 1500 MPa and 23 degC, by Archard on a track: 1/(K_s p^2)."""
    table = WearTable.of([FilmLife(**row) for row in ROWS])
    return 1.0 / (table.factor(1e6 * pressure, degC) * (pressure / 1500.0) ** 2)


@pytest.mark.parametrize(("pressure", "degC", "expected"), MOS2_LIVES)
def test_the_table_has_the_relative_lives_of_the_published_tests(pressure, degC, expected):
    """ESTL, 44th Aerospace Mechanisms Symposium (2018) 151, entered by hand."""
    entered = {
        850: {23: 8.591, 120: 1.867}, 1500: {23: 1.0, 120: 0.194}, 2000: {23: 0.060, 120: 0.007},
    }  # fmt: skip
    assert expected == entered[pressure][degC]
    assert relative_life(pressure, degC) == pytest.approx(expected, rel=1e-14)


def test_lives_between_the_rows_follow_the_published_powers_of_the_pressure():
    """The exponents of the source's own numbers: 3.8 from 850 to 1500 MPa, 9.8 from there on.

    They have two digits, hence 0.05.
    """
    for low, high, power in ((850.0, 1500.0, 3.8), (1500.0, 2000.0, 9.8)):
        p = np.geomspace(low, high, 7)
        powers = -np.diff(np.log(relative_life(p, 23.0))) / np.diff(np.log(p))
        assert_allclose(powers, power, atol=0.05)


@given(
    st.floats(850.0, 2000.0), st.floats(850.0, 2000.0), st.floats(23.0, 120.0),
    st.floats(23.0, 120.0),
)  # fmt: skip
def test_lives_fall_with_pressure_and_temperature(p, other_p, T, other_T):
    low_p, high_p = sorted((p, other_p))
    low_T, high_T = sorted((T, other_T))
    rounding = 1.0 + 1e-12
    longest = relative_life(low_p, low_T) * rounding
    assert max(relative_life(high_p, low_T), relative_life(low_p, high_T)) <= longest
    shortest_row, longest_row = 0.007, 8.591
    assert shortest_row / rounding <= relative_life(high_p, high_T) <= longest_row * rounding


def test_beyond_the_rows_the_coefficient_is_that_of_the_nearest():
    table = WearTable.of([FilmLife(**row) for row in ROWS])
    corners = table.factor(np.array([850e6, 2000e6]), np.array([23.0, 120.0]))
    assert_allclose(table.factor(np.array([0.0, 1e10]), np.array([-60.0, 300.0])), corners)


def test_a_temperature_that_is_not_known_leaves_the_coefficient():
    """NaN stands for it. 1500 MPa is the pressure of the row whose life is 1."""
    assert WearTable.of([FilmLife(**row) for row in ROWS]).factor(1500e6, np.nan) == 1.0


def test_a_table_of_one_row_leaves_the_coefficient():
    only_row = FilmLife(pressure_MPa=700, temperature_C=20, relative_life=1)
    assert (WearTable.of([only_row]).factor(np.geomspace(1e8, 1e10, 5), 80.0) == 1.0).all()


@pytest.mark.parametrize(
    ("rows", "problem"),
    [
        ("3", f"{SET}: got 3, expected a list of blocks of keys"),
        ("[]", f"{SET}: got 0 rows with a relative_life of 1, expected exactly one"),
        ("[{pressure_MPa: 850, temperature_C: 23}]",
         f"{SET}[0].relative_life: got nothing, expected a number"),
        ("[{pressure_MPa: -850, temperature_C: 23, relative_life: 1}]",
         f"{SET}[0].pressure_MPa: got -850, expected a number > 0"),
        ("[{pressure_MPa: 8, temperature_C: 2, relative_life: 1}, "
         "{pressure_MPa: 9, temperature_C: 2, relative_life: 1}]",
         f"{SET}: got 2 rows with a relative_life of 1"),
        ("[{pressure_MPa: 8, temperature_C: 2, relative_life: 1}, "
         "{pressure_MPa: 9, temperature_C: 3, relative_life: 2}]",
         f"{SET}: got 0 rows for 8 MPa at 3 degC, expected one"),
        ("[{pressure_MPa: 8, temperature_C: 2, relative_life: 1}, "
         "{pressure_MPa: 8, temperature_C: 2, relative_life: 2}]",
         f"{SET}: got 2 rows for 8 MPa at 2 degC, expected one"),
    ],
)  # fmt: skip
def test_wrong_wear_tables_are_refused_in_one_line(rows, problem, capsys):
    assert main(["check", str(scene_file("mos2_gyro")), "--set", f"{SET}={rows}"]) == 2
    error = capsys.readouterr().err
    assert problem in error and error.count("\n") == 1


def test_a_table_requires_a_coefficient(capsys):
    """The other keys that need one are removed, too, so that this problem is reported first."""
    without = [
        f"friction.film.{name}=null"
        for name in ("wear_coefficient", "thickness_um", "bare_ball_race")
    ]
    without.append("wear.end_of_life.film_worn_share=null")
    rows = "[{pressure_MPa: 8, temperature_C: 2, relative_life: 1}]"
    argv = ["check", str(scene_file("mos2_gyro")), "--set", *without, f"{SET}={rows}"]
    assert main(argv) == 2
    expected = "friction.film.wear_coefficient: got nothing; wear_table requires this key"
    assert expected in capsys.readouterr().err


def test_an_exponent_of_earlier_versions_is_refused_with_its_replacement(capsys):
    argv = ["check", str(scene_file("mos2_gyro")), "--set", "friction.film.pressure_exponent=3.6"]
    assert main(argv) == 2
    error = capsys.readouterr().err
    assert "no longer exists" in error and "give friction.film.wear_table" in error


SLOW_RPM = 3000.0  # loads of the contacts are those of the preload alone


@pytest.fixture(scope="module")
def lives_by_row():
    """Returns two lives [s] of a bearing by (pressure [MPa], temperature [degC]) of each test.

    The outer contact, which wears through first, is pressed as in the test. In the first life it
    slips as fast as at 1500 MPa and 23 degC, because all tests slid at 0.6 m/s. The second is at
    SLOW_RPM.
    """
    result, slip_at_reference = {}, None
    for pressure, degC, _ in sorted(MOS2_LIVES, key=lambda row: row[0] != 1500):  # 1500 first
        preload, speed, changes = 30.0, SLOW_RPM, TABLE | HERTZ | warm(degC)
        changes["wear.end_of_life"] = {"film_worn_share": 0.5}
        changes["bearing.inner_groove_factor"] = 0.52  # the outer contact has the higher pressure
        for _ in range(5):  # substitutions, after which pressure and slip have settled
            changes |= {"operation.preload_N": preload, "operation.shaft_speed_rpm": speed}
            scene = variant(scene_file("mos2_gyro"), changes)
            case = solve(scene).values
            preload *= (1e6 * pressure / case["maximum_pressure"].max()) ** 3
            slip = case["qv"][0, 1] / case["contact_load"][0, 1]
            if (pressure, degC) == (1500, 23):
                slip_at_reference = slip
            speed *= slip_at_reference / slip
        assert case["maximum_pressure"][0, 1] == pytest.approx(1e6 * pressure, rel=1e-3)
        as_tested = life(scene)
        at_one_speed = life(scene.with_({"operation.shaft_speed_rpm": SLOW_RPM}))
        result[pressure, degC] = tuple(
            float(result.values["life"]) for result in (as_tested, at_one_speed)
        )
    return result


def test_lives_of_a_bearing_have_the_ratios_of_the_tests(lives_by_row):
    """Three pressures, two temperatures: within 2 % where the contact slips as in the tests.

    At one speed of the shaft a larger contact slips more, and lives go with the slip, too.
    """
    reference, reference_at_one_speed = lives_by_row[1500.0, 23.0]
    assert reference == pytest.approx(reference_at_one_speed, rel=1e-6)
    # slip at 1500 MPa over that at each pressure: regression values of the lives themselves
    slip_ratio = {850: 1.61, 1500: 1.0, 2000: 0.81}
    for pressure, degC, expected in MOS2_LIVES:
        as_tested, at_one_speed = lives_by_row[pressure, degC]
        assert as_tested / reference == pytest.approx(expected, rel=0.02)
        expected_at_one_speed = slip_ratio[pressure] * expected
        assert at_one_speed / reference == pytest.approx(expected_at_one_speed, rel=0.02)


@pytest.mark.parametrize(
    ("pressure", "at_23", "at_120", "steel", "within"),
    [(850, 8.591, 1.867, 1.0, 0.1), (1500, 1.0, 0.194, 1.0, 0.12),
     (1500, 1.0, 0.194, 1.0 / 0.194, 0.01)],
)  # fmt: skip
def test_warmth_shortens_lives_with_worn_grooves(scene, pressure, at_23, at_120, steel, within):
    """Lives have the ratio of the table within 10 or 12 %: steel below the film does not follow it.

    steel: wear of warm over cold steel. Where it wears more by the ratio of the table, too, the
    lives have that ratio to 1 %.
    """
    changes = TABLE | {"bearing.inner_groove_factor": 0.52, "model.contact": "worn"}
    changes["operation.preload_N"] = {850: 5.24, 1500: 30.0}[pressure]  # which make the pressure
    changes["wear.end_of_life"] = {"film_worn_share": 0.5}
    key = "materials.bearing_steel.wear_coefficient"
    worn = scene("mos2_gyro", changes).materials["bearing_steel"].wear_coefficient
    cold = life(scene("mos2_gyro", changes | warm(23.0))).values
    hot = life(scene("mos2_gyro", changes | warm(120.0) | {key: steel * worn})).values
    assert cold["life"] / hot["life"] == pytest.approx(at_23 / at_120, rel=within)


def test_a_network_finds_the_temperature_of_the_film(scene):
    """Wear rates are those at the computed temperatures, in a case and along a life."""
    conductance = dict.fromkeys(("inner_ring_shaft", "outer_ring_housing", "ball_race"), 0.02)
    network = {"conductance_W_K": conductance, "shaft_C": 60.0, "housing_C": 40.0}
    changes = TABLE | HERTZ | {"operation.preload_N": 15.0, "wear.end_of_life": None}
    networked = scene("mos2_gyro", changes | {"thermal": network})
    case = solve(networked).values
    inner, balls, outer = case["part_temperature"][:3]
    assert len({inner, balls, outer}) == 3 and min(inner, balls, outer) > 40.0
    plain = solve(scene("mos2_gyro", changes | {SET: None, "thermal": network})).values
    contact_C = 0.5 * (np.array([inner, outer]) + balls)
    factor = Films.of(networked).table.factor(case["maximum_pressure"][0], contact_C)
    # the solver takes the pressure of fitted factors of Hertz: to 2 %
    assert_allclose(case["race_wear_rate"] / plain["race_wear_rate"], factor, rtol=0.02)
    changes |= {"thermal": network, "wear.end_of_life": {"film_worn_share": 0.5}}
    values = life(scene("mos2_gyro", changes)).values
    assert_allclose(values["history_race_wear_rate"][0], case["race_wear_rate"], rtol=1e-6)
    worn = life(scene("mos2_gyro", changes | {"model.contact": "worn"})).values
    # Hertz's pressure there, that of fitted factors here
    assert_allclose(worn["history_race_wear_rate"][0], case["race_wear_rate"], rtol=0.02)


def by_power(exponent):
    """Returns rows of a wear table by which K_s goes as the pressure to a power.

    The peak of 1500 MPa, a mean of 1 GPa, leaves K_s as it is. A life goes as 1/(K_s p^2).
    """
    lives = ((p, (p / 1500.0) ** -(exponent + 2.0)) for p in (150.0, 1500.0, 15000.0))
    return [dict(zip(NAMES, (p, 20.0, length), strict=True)) for p, length in lives]


@pytest.mark.parametrize("load", [7.0, 28.0])
def test_a_film_wears_by_the_power_of_its_table_in_each_contact(scene, load):
    """K_s goes as the mean pressure [GPa] to the power of 3.6, as the table says.

    Within 5 %, because the solver takes fitted factors of Hertz.
    """
    film = {"shear_strength_MPa": 24.8, "thickness_um": 0.5, "wear_coefficient": 5e-6}
    changes = HERTZ | {f"friction.film.{name}": value for name, value in film.items()}
    changes |= {"friction.ball_race": None, "uncertainty": None, "operation.preload_N": load}
    changes |= {"wear.end_of_life": {"ball_diameter_loss_um": 0.3}}
    plain, tabulated = scene("gyro_s1", changes), scene("gyro_s1", changes | {SET: by_power(3.6)})
    without, with_table = solve(plain).values, solve(tabulated).values
    Q, a, b = (without[n] for n in ("contact_load", "semi_major_axis", "semi_minor_axis"))
    expected = (1e-9 * Q / (np.pi * a * b)).ravel() ** 3.6
    ratio = with_table["race_wear_rate"] / without["race_wear_rate"]
    assert_allclose(ratio, expected, rtol=0.05)
    # the life counts the wear of both contacts, so that its ratio lies between theirs
    life_ratio = life(plain).values["life"] / life(tabulated).values["life"]
    assert 0.95 * expected.min() < life_ratio < 1.05 * expected.max()


def test_wear_by_a_table_in_a_dynamic_case_is_that_of_the_steady_one(scene):
    """Under pure thrust, mean rates of the dynamic case are the steady ones to 0.1 %.

    Its histories have these means to 2 %. The sentence on the model states the range of the tests.
    """
    tabulated = scene("mos2_gyro", HERTZ | TABLE)
    steady, dynamic = (solve(tabulated, fidelity) for fidelity in ("steady", "dynamic"))
    for name in ("race_wear_rate", "ball_wear_rate"):
        assert_allclose(dynamic.values[name].mean(), steady.values[name].mean(), rtol=1e-3)
        history = dynamic.values[f"history_{name}"].mean(axis=0)
        # means have the pressure of their semi-axes, histories that of their loads
        assert_allclose(history, dynamic.values[name], rtol=0.02)
    _, _, of_films = dynamic.attrs["modelled"].partition("wear of films: ")
    assert numbers_in(of_films)[:4] == [850, 2000, 23, 120]  # MPa and degC of the tests


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"operation.preload_N": 15.0}, ""),
        ({"operation.preload_N": 1.0}, "pressure"),
        ({"operation.preload_N": 15.0} | warm(180.0), "temperature of 180 degC"),
        ({"operation.preload_N": 15.0} | warm(20.0), ""),
        ({"operation.preload_N": 90.0}, "shorter life"),
    ],
)
def test_a_pressure_or_temperature_beyond_the_tests_is_warned_of(scene, changes, words):
    """The warning contains `words`; "" means that there is no warning.

    There is none where the film is pressed and warmed as in the tests.
    """
    warnings = warnings_in(solve(scene("mos2_gyro", TABLE | HERTZ | changes)).attrs)
    of_films = [warning for warning in warnings if warning["id"] == "film_beyond_tests"]
    assert bool(of_films) == bool(words)
    assert all(words in f"{warning['sentence']} {warning['advice']}" for warning in of_films)


@pytest.mark.long  # the bound is a search
def test_coefficients_are_those_of_the_row_whose_life_is_one():
    """`MOS2_WEAR` are two K_s/H [m2/N] at 1500 MPa and 23 degC, with two digits: 1 %.

    That of the two discs was measured at 1.1 to 1.6 GPa, and is converted from the geometric mean.
    With the first, the program computes the revolutions that a bearing in vacuum lasted.
    """
    table = WearTable.of([FilmLife(**row) for row in ROWS])
    in_vacuum, two_discs = MOS2_WEAR
    measured = M2_PER_N * MEASURED_WEAR["two_discs"].wear[1]
    converted = measured / table.factor(1e9 * np.sqrt(1.1 * 1.6), 23.0)
    assert two_discs == pytest.approx(converted, rel=0.01, abs=0.0)
    with pytest.warns(UserWarning, match="788 MPa is beyond the tests"):
        bound = benchmark("film_tests").bound()
    assert in_vacuum == pytest.approx(bound, rel=0.01, abs=0.0)


def test_sheets_have_the_factors_of_the_tests_of_films():
    """How much longer the film of NASA's bearing lasted, and how far warmth is overstated."""
    tests = benchmark("film_tests")
    with pytest.warns(UserWarning, match="788 MPa is beyond the tests"):
        lasted = tests.SEEN / tests.revolutions(tests.nasa_bearing())
    measured, computed = tests.wear_over_warmth()
    assert numbers_in(TABLE_TESTS) == [round(lasted), float(f"{computed / measured:.2g}")]


def test_films_scatter_as_those_of_gears():
    """Revolutions of unexposed pinions: NASA Glenn, 44th Aerospace Mechanisms Symposium p. 134.

    The scatter assumed is that of the first four tests, and within what all six allow.
    """
    revolutions = np.array([53_333.0, 61_667.0, 190_333.0, 83_000.0, 128_667.0, 84_000.0])
    of_four, of_six = (np.std(np.log(n), ddof=1) for n in (revolutions[:4], revolutions))
    assert np.exp(of_four) == pytest.approx(FILM_SCATTER, rel=0.02)
    # 90 % interval of the deviation of six normal values
    low, high = np.exp(of_six * np.sqrt(5.0 / chi2.ppf([0.95, 0.05], 5)))
    assert low < FILM_SCATTER < high
