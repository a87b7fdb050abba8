"""The one table of display units and digits.

Files have the units of `results/variables.py`. The numbers of a row are shown with three
significant digits, in the largest unit in which the largest of them is at least 1.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

PER_1000_HOURS = 3.6e6
_R_PER_MIN = 30.0 / math.pi


class _Scale(NamedTuple):
    """A unit, the factor from the unit of files, and the smallest number that is shown in it."""

    unit: str
    factor: float
    least: float = 1.0


SCALES: dict[str, tuple[_Scale, ...]] = {
    "%": (_Scale("%", 100.0),),
    "%/turn": (_Scale("%/turn", 100.0),),
    "1": (_Scale("", 1.0),),
    "J": (_Scale("uJ", 1e6), _Scale("mJ", 1e3), _Scale("J", 1.0)),
    "N m": (_Scale("uN m", 1e6), _Scale("mN m", 1e3), _Scale("N m", 1.0)),
    "N m rad-1": (_Scale("N m/rad", 1.0),),
    "N m-1": (_Scale("N/um", 1e-6),),
    "Pa": (_Scale("MPa", 1e-6), _Scale("GPa", 1e-9)),
    "W": (_Scale("mW", 1e3), _Scale("W", 1.0), _Scale("kW", 1e-3)),
    "m": (_Scale("um", 1e6), _Scale("mm", 1e3)),
    "m s-1": (_Scale("m/s", 1.0),),
    "m s-2": (_Scale("g", 1.0 / 9.80665),),
    "m3": (_Scale("um3", 1e18), _Scale("mm3", 1e9, 1e-3)),
    "m3 s-1": (_Scale("mm3/1000 h", 1e9 * PER_1000_HOURS),),
    "rad s-1": (_Scale("r/min", _R_PER_MIN),),
    "s": (_Scale("us", 1e6), _Scale("ms", 1e3), _Scale("s", 1.0)),
    "s Pa-1": (_Scale("s/Pa", 1.0),),
    "um/1000 h": (_Scale("um/1000 h", 1e6 * PER_1000_HOURS),),
}
"""Units for a person, the smallest first, by the unit of files or by `Variable.shown`, which
replaces it. A unit that is not here is shown as it is."""

LEAST_PERCENT = 1e-3
"""Smaller percentages are shown as less than this one."""

LEAST_SHOWN = {"": 1e-15, "N": 1e-9, "degree": 1e-9, "um": 1e-9}
"""Smaller numbers in these units are rounding errors, and are shown as 0."""


class Display(NamedTuple):
    """The display of a quantity: its unit, and the factor from the unit of files."""

    unit: str
    factor: float

    @property
    def printed(self) -> str:
        """Returns the unit with the characters of figures, tables and the page: `N/µm`."""
        return printed_unit(self.unit)

    def of(self, values: Any) -> Any:
        """Converts values from the unit of files to this unit."""
        return self.factor * values

    def label(self, text: str) -> str:
        """Returns a name with the unit in brackets, for an axis or a column."""
        return f"{text} ({self.printed})" if self.unit else text

    def text(self, value: Any) -> str:
        """Returns a value of a file as text in this unit, with three digits; a dash for NaN."""
        return digits(self.of(float(value)), self.unit)


def display(units: str, *values: Any, shown: str = "") -> Display:
    """Returns the unit in which all values of a quantity are shown.

    units: of the file.
    *values: numbers or arrays in that unit; their largest finite magnitude determines the unit.
    shown: key of `SCALES`, such as `%`; by default `units`.
    """
    scales = SCALES.get(shown or units, (_Scale(shown or units, 1.0),))
    arrays = [np.abs(np.asarray(value, dtype=float)).ravel() for value in values]
    numbers = np.concatenate(arrays) if arrays else np.empty(0)
    largest = float(numbers[np.isfinite(numbers)].max(initial=0.0))
    display_scale = scales[0]
    for scale in scales:
        # rounded, so that a number that rounds up to the next unit is shown in that unit
        if rounded(scale.factor * largest) >= scale.least:
            display_scale = scale
    return Display(unit=display_scale.unit, factor=display_scale.factor)


def rounded(value: float) -> float:
    """Rounds a number to three significant digits."""
    return float(f"{value:.3g}")


def digits(value: float, unit: str = "") -> str:
    """Returns a number as text with three significant digits; a dash for NaN.

    A number below `LEAST_SHOWN` is 0, and a percentage below `LEAST_PERCENT` is less than that.

    unit: shown unit of the number.
    """
    if not math.isfinite(value):
        return "–" if math.isnan(value) else f"{value:g}"
    if abs(value) < LEAST_SHOWN.get(unit, 0.0):
        return "0"
    if unit.startswith("%") and 0.0 < abs(value) < LEAST_PERCENT:
        return f"< {LEAST_PERCENT:g}"
    return f"{rounded(value) + 0.0:.7g}"  # + 0.0 makes 0 of -0


def scale_of(unit: str) -> tuple[str, float]:
    """Returns the key of `SCALES` for a shown unit, and the factor from it to the shown unit.

    A unit that is not in `SCALES` is its own key, with the factor 1.
    """
    for file_unit, scales in SCALES.items():
        for scale in scales:
            if scale.unit == unit:
                return file_unit, scale.factor
    return unit, 1.0


class Rough(float):
    """A number that is shown with two digits, such as a life, which is not known better."""

    @property
    def text(self) -> str:
        """Returns the number with two digits, however small: K_s/H may be 1e-17 m2/N."""
        return f"{float(f'{self:.2g}'):.7g}" if math.isfinite(self) else digits(self)

    def in_unit(self, unit: str) -> str:
        """Returns the number with two digits; 0 if it is a rounding error in its unit."""
        return digits(float(f"{self:.2g}"), unit)


class Percent(float):
    """The difference of two numbers in percent."""

    @property
    def text(self) -> str:
        """Returns the number with three digits and its sign; `< 0.001` for a tiny one."""
        text = digits(self, "%")
        return text if self < 0.0 or text.startswith("<") else f"+{text}"


class Interval(NamedTuple):
    """The interval that contains most values, for example the lives of 90 % of the bearings."""

    low: float
    high: float

    @property
    def text(self) -> str:
        """Returns the ends with two digits: `0.34 to 5.8`."""
        return " to ".join(Rough(end).text for end in self)


RESOLVED = 1e-4
"""Relative error that counts in place of a smaller one, whose digits serve no comparison."""

_EQUAL_TO_INPUT = 1e-8
"""Relative difference below which a result counts as an input, a number of few digits."""


class Estimated(float):
    """A number with an estimate of its error, which determines its digits."""

    error: float

    @classmethod
    def of(cls, value: float, error: float) -> Estimated:
        """Returns a number with its error.

        The stored error is at least the share `RESOLVED` of the number. An unknown error, given as
        0 or NaN, is stored as NaN.
        """
        number = cls(value)
        number.error = max(error, RESOLVED * abs(value)) if error > 0.0 else math.nan
        return number

    @property
    def text(self) -> str:
        """Returns the number to the first digit of its error; an input without further zeros."""
        text = text_to_error(self, self.error)
        if self.error <= RESOLVED * abs(self) and math.isclose(
            float(text), self, rel_tol=_EQUAL_TO_INPUT
        ):
            return f"{float(text):.7g}"  # an input such as 140, not a computed 140.00
        return text


def text_to_error(value: float, error: float) -> str:
    """Returns a number as text to the first digit of its error: `0.87` with an error of 0.02.

    It has three digits if the error is 0, infinite or NaN.
    """
    if not (math.isfinite(value) and 0.0 < error < math.inf):
        return digits(value)
    rounded_error = float(f"{error:.0e}")  # 0.096 rounds to 0.1, whose first digit is another
    places = -math.floor(math.log10(rounded_error))
    return f"{round(value, places) + 0.0:.{max(places, 0)}f}"  # + 0.0 makes 0 of -0


def span(values: Iterable[float]) -> str:
    """Returns the smallest and the largest finite value as text: `1.2 to 3`.

    It is a single number if both have the same text, and a dash if no value is finite.
    """
    finite = [value for value in values if math.isfinite(value)]
    ends = [min(finite), max(finite)] if finite else [math.nan]
    texts = [end.text if isinstance(end, Rough) else digits(end) for end in ends]
    return " to ".join(dict.fromkeys(texts))


def counted_tests(count: int) -> str:
    """Returns a number of tests in words: `1 test`, `3 tests`."""
    return f"{count} test" if count == 1 else f"{count} tests"


def printed_unit(unit: str) -> str:
    """Returns a unit with its proper characters and no-break spaces: `N/um` as `N/µm`."""
    text = re.sub(r"u(?=[mNsJ])", "µ", unit).replace("degree", "°")
    text = text.replace("m3", "m³").replace("s2", "s²")
    return text.replace(" ", "\N{NO-BREAK SPACE}")


KEY_UNITS = {
    "_MPa": "MPa",
    "_N_um": "N/um",
    "_kg_m3": "kg/m3",
    "_kg_mm2": "kg mm²",
    "_g2_Hz": "g²/Hz",
    "_m_s2": "m/s2",
    "_1_K": "1/K",
    "_m_s": "m/s",
    "_GPa": "GPa",
    "_mrad": "mrad",
    "_rpm": "r/min",
    "_deg": "degree",
    "_mm": "mm",
    "_um": "um",
    "_Nm": "N m",
    "_kg": "kg",
    "_N": "N",
    "_W": "W",
    "_C": "°C",
    "_g": "g",
    "_s": "s",
}
"""Units by the ends of keys of scenes and limits; `_N_um` comes before `_um`, in which it ends."""

_PROPER_NAMES = {
    "youngs modulus": "Young's modulus",
    "poisson ratio": "Poisson's ratio",
    "brinell hardness": "Brinell hardness",
}


def key_in_words(key: str) -> tuple[str, str]:
    """Returns the last part of a dotted key in words, and its unit: `ball diameter`, `mm`."""
    name = key.rpartition(".")[2]
    suffix = next((suffix for suffix in KEY_UNITS if name.endswith(suffix)), "")
    words = name.removesuffix(suffix).replace("_", " ")
    return _PROPER_NAMES.get(words, words), KEY_UNITS.get(suffix, "")


_ASCII = str.maketrans({"µ": "u", "³": "3", "\N{NO-BREAK SPACE}": " ", "\N{MINUS SIGN}": "-"})


def ascii_text(text: str) -> str:
    """Returns a text with units in ASCII, for a terminal: `N/µm` as `N/um`."""
    return text.translate(_ASCII)


_UNIT = re.compile(r"(?<=\d) (?=(%|h|N|N/[uµ]m|[uµm]m|m?W|[GM]Pa|K|Hz|r/min)(?!\w))")
"""The space between a number and its unit."""

_MICRO = re.compile(r"(?<=\N{NO-BREAK SPACE})u(?=m(?!\w))|(?<=\N{NO-BREAK SPACE}N/)u(?=m)")
"""The prefix `u` of a unit in ASCII, which stands for micro."""


def without_unit_breaks(text: str) -> str:
    """Returns a text with no-break spaces between numbers and units, and µ for u in units."""
    text = _MICRO.sub("µ", _UNIT.sub("\N{NO-BREAK SPACE}", text))
    return text.replace("N/µm", "N/\N{WORD JOINER}µm")
