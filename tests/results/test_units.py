"""Units and digits in which numbers are shown to people, in sheets, figures and tables alike."""

import math

import numpy as np
import pytest

from bearingwear.results.units import (
    Estimated,
    Interval,
    Rough,
    digits,
    display,
    printed_unit,
    span,
    text_to_error,
)


@pytest.mark.parametrize(
    ("units", "values", "unit", "text"),
    [
        ("W", [0.61492], "mW", "615"),
        ("W", [307.1322], "W", "307"),
        ("W", [70.3e3], "kW", "70.3"),
        ("W", [0.9999], "W", "1"),  # 1000 mW would round up to it
        ("W", [], "mW", "–"),
        ("N m", [15.567e-6], "uN m", "15.6"),
        ("N m", [0.0213], "mN m", "21.3"),
        ("N m", [-2.5], "N m", "-2.5"),
        ("N m-1", [4.48975e6], "N/um", "4.49"),
        ("Pa", [980.16e6], "MPa", "980"),
        ("Pa", [1054e6], "GPa", "1.05"),
        ("m", [2.1435e-6], "um", "2.14"),
        ("m", [0.012], "mm", "12"),
        ("m3 s-1", [1e-16], "mm3/1000 h", "0.36"),
        ("rad s-1", [1177.7], "r/min", "11200"),
        ("degree", [21.526], "degree", "21.5"),
        ("N", [7.33], "N", "7.33"),
        ("kg m-3", [12.0], "kg m-3", "12"),  # a unit that the table does not know
    ],
)
def test_the_unit_suits_the_size_of_a_number(units, values, unit, text):
    chosen = display(units, values)
    assert chosen.unit == unit
    assert chosen.text(values[0] if values else math.nan) == text


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (7.58e-19, "N", "0"),
        (-1.69e-15, "um", "0"),
        (3.9e-16, "degree", "0"),
        (1.18e-18, "", "0"),
        (2e-8, "", "2e-08"),  # a wear coefficient
        (3.31e-5, "degree", "3.31e-05"),
        (1920.0, "N", "1920"),
        (4.59e-12, "s/Pa", "4.59e-12"),
    ],
)
def test_rounding_errors_of_zero_are_shown_as_zero(value, unit, text):
    assert digits(value, unit) == text


def test_a_row_has_one_unit():
    """The largest magnitude of its numbers decides the unit; NaN does not count."""
    unit = display("W", [2e-3, np.nan, -0.5], [[30.0]])
    assert unit.unit == "W" and unit.text(2e-3) == "0.002"
    np.testing.assert_allclose(unit.of(np.array([1.0, 2.0])), [1.0, 2.0])


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (0.8732, 0.0186, "0.87"),
        (109.6, 5.5, "110"),
        (0.12, 0.0, "0.12"),
        (9.97, 0.096, "10.0"),
        (math.nan, 0.1, "–"),
        (0.1234, math.nan, "0.123"),
    ],
)
def test_a_number_has_the_digits_that_its_error_leaves(value, error, text):
    assert text_to_error(value, error) == text


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (137.4, 0.053, "137.40"),
        (137.4, 1e-9, "137.4"),
        (137.4, 0.0, "137"),
        (137.4, math.nan, "137"),
        (140.0, 1e-9, "140"),
        (7.0 + 1e-9, 1e-9, "7"),
        (137.4003, 1e-9, "137.40"),
    ],
)
def test_an_estimate_has_the_digits_of_its_error_and_an_input_those_it_was_given(
    value, error, text
):
    assert Estimated.of(value, error).text == text


def test_rough_numbers_and_their_span_have_two_digits():
    assert span(map(Rough, [0.627, 1.174])) == "0.63 to 1.2"


def test_the_span_of_nothing_is_a_dash():
    assert span([]) == "–"


def test_an_interval_of_small_numbers_is_not_zero():
    """K_s/H of steel and of a film [m2/N]."""
    assert Interval(1.3e-16, 4.6e-15).text == "1.3e-16 to 4.6e-15"
    assert Rough(3.04e-18).text == "3e-18" and Rough(math.nan).text == "–"


def test_a_share_is_a_percentage():
    share = display("1", 0.0849, shown="%")
    assert share.unit == "%" and share.text(0.0849) == "8.49"
    assert [share.text(x) for x in (3e-9, -3e-9, 0.0)] == ["< 0.001", "< 0.001", "0"]


def test_rates_are_those_of_1000_hours():
    """One micrometre an hour is 1000 um in 1000 h."""
    rate = 1e-6 / 3600.0
    assert display("m s-1", rate, shown="um/1000 h").text(rate) == "1000"


@pytest.mark.parametrize(
    ("value", "text"),
    [(28268.4, "28300"), (3.72e-12, "3.72e-12"), (-0.0, "0"), (0.0274, "0.0274"),
     (1.2e9, "1.2e+09"),
     (math.inf, "inf")],
)  # fmt: skip
def test_a_number_has_three_digits(value, text):
    assert digits(value) == text


@pytest.mark.parametrize(
    ("unit", "text"),
    [
        ("N/um", "N/µm"),
        ("um", "µm"),
        ("degree", "°"),
        ("mm3/1000 h", "mm³/1000\N{NO-BREAK SPACE}h"),
        ("uN m", "µN\N{NO-BREAK SPACE}m"),
    ],
)
def test_units_are_printed_with_their_signs(unit, text):
    assert printed_unit(unit) == text


def test_a_label_has_the_unit_in_brackets_if_there_is_one():
    assert display("Pa", 2e9).label("pressure") == "pressure (GPa)"
    assert display("1").label("friction") == "friction"
