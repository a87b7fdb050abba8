"""The one table of display units and digits.

Files have the units of `results/variables.py`. A number is shown in the largest unit of its row
that leaves something before the point, with three significant digits.
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
    """A unit, its factor on a value of the file, and the least number that is shown in it."""

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
"""Units for a person, the smallest first, by the unit of the file or by what a variable is shown
as (`Variable.shown`). A unit that is not here is shown as it is."""

LEAST_PERCENT = 1e-3
"""Percentages below are shown as less than this one."""


LEAST_SHOWN = {"": 1e-15, "N": 1e-9, "degree": 1e-9, "um": 1e-9}
"""Smaller numbers are what rounding leaves of zero, and are shown as that, by their unit."""


class Display(NamedTuple):
    """Display of a quantity: its unit, and the factor on a value of the file."""

    unit: str
    factor: float

    @property
    def printed(self) -> str:
        """The unit as figures, tables and the page have it: `N/µm`."""
        return in_print(self.unit)

    def of(self, values: Any) -> Any:
        """Values of the file in this unit."""
        return self.factor * values

    def label(self, text: str) -> str:
        """A name with the unit in brackets, for an axis or a column."""
        return f"{text} ({self.printed})" if self.unit else text

    def text(self, value: Any) -> str:
        """A value of the file, in this unit, with three digits; a dash where it is not known."""
        return digits(self.of(float(value)), self.unit)


def display(units: str, *values: Any, shown: str = "") -> Display:
    """The unit in which values are shown together.

    *values: those that are shown; the largest magnitude decides.
    shown: how the quantity is shown where its unit does not say: `%`.
    """
    scales = SCALES.get(shown or units, (_Scale(shown or units, 1.0),))
    numbers = [np.abs(np.asarray(v, dtype=float)).ravel() for v in values]
    every = np.concatenate(numbers) if numbers else np.empty(0)
    largest = float(every[np.isfinite(every)].max(initial=0.0))
    # what would round up to the next unit is shown in it
    fitting = [s for s in scales if rounded(s.factor * largest) >= s.least] or [scales[0]]
    return Display(fitting[-1].unit, fitting[-1].factor)


def rounded(value: float) -> float:
    """A number with three significant digits."""
    return float(f"{value:.3g}")


def digits(value: float, unit: str = "") -> str:
    """A number with three significant digits; a dash where it is not known.

    A percentage too small to matter is only said to be less than that.
    """
    if not math.isfinite(value):
        return "–" if math.isnan(value) else f"{value:g}"
    if abs(value) < LEAST_SHOWN.get(unit, 0.0):
        return "0"
    if unit.startswith("%") and 0.0 < abs(value) < LEAST_PERCENT:
        return f"< {LEAST_PERCENT:g}"
    return f"{rounded(value) + 0.0:.7g}"


def scale_of(unit: str) -> tuple[str, float]:
    """The unit of the file behind a unit that is shown, and the factor between them."""
    every = ((key, scale) for key, scales in SCALES.items() for scale in scales)
    return next(((key, scale.factor) for key, scale in every if scale.unit == unit), (unit, 1.0))


class Rough(float):
    """A number that is known to two digits at best: a life as hours."""

    @property
    def text(self) -> str:
        """With the digits that it has: K_s/H of 1e-17 m2/N is not what rounding leaves of zero."""
        return f"{float(f'{self:.2g}'):.7g}" if math.isfinite(self) else digits(self)

    def in_unit(self, unit: str) -> str:
        return digits(float(f"{self:.2g}"), unit)


class Percent(float):
    """The difference of two numbers, with its sign."""

    @property
    def text(self) -> str:
        text = digits(self, "%")
        return text if self < 0.0 or text.startswith("<") else f"+{text}"


class Interval(NamedTuple):
    """Interval of most values."""

    low: float
    high: float

    @property
    def text(self) -> str:
        """`0.34 to 5.8`: the ends are not known better than to two digits."""
        return " to ".join(Rough(end).text for end in self)


RESOLVED = 1e-4
"""Relative error below which a number has no further digits: those serve no comparison."""


_GIVEN = 1e-8
"""Relative difference below which a result is the given number of few digits."""


class Estimated(float):
    """A number with the estimate of its error, which decides its digits."""

    error: float

    @classmethod
    def of(cls, value: float, error: float) -> Estimated:
        found = cls(value)
        found.error = max(error, RESOLVED * abs(value)) if error > 0.0 else math.nan
        return found

    @property
    def text(self) -> str:
        text = to_error(self, self.error)
        if self.error <= RESOLVED * abs(self) and math.isclose(float(text), self, rel_tol=_GIVEN):
            return f"{float(text):.7g}"  # a given number, as 140, no computed one
        return text


def to_error(value: float, error: float) -> str:
    """A number to the first digit of its error: `0.87` of an error of 0.02."""
    if not (math.isfinite(value) and 0.0 < error < math.inf):
        return digits(value)
    places = -math.floor(math.log10(float(f"{error:.0e}")))
    return f"{round(value, places) + 0.0:.{max(places, 0)}f}"


def span(values: Iterable[float]) -> str:
    """The least and the most of the values that are known: `1.2 to 3`; a dash without any."""
    known = sorted(value for value in values if math.isfinite(value))
    ends = [known[0], known[-1]] if known else [math.nan]
    texts = [one.text if isinstance(one, Rough) else digits(one) for one in ends]
    return " to ".join(dict.fromkeys(texts))


def in_print(unit: str) -> str:
    """A unit with its proper characters, in one piece: `N/um` as `N/µm`."""
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
}
"""Units at the ends of the keys of scenes and limits."""


_PROPER = {
    "youngs modulus": "Young's modulus",
    "poisson ratio": "Poisson's ratio",
    "brinell hardness": "Brinell hardness",
}


def key_in_words(key: str) -> tuple[str, str]:
    """The last part of a key in words, and its unit: `ball diameter`, `mm`."""
    name = key.rpartition(".")[2]
    end = next((end for end in KEY_UNITS if name.endswith(end)), "")
    words = name.removesuffix(end).replace("_", " ")
    return _PROPER.get(words, words), KEY_UNITS.get(end, "")


_ASCII = str.maketrans({"µ": "u", "³": "3", "\N{NO-BREAK SPACE}": " ", "\N{MINUS SIGN}": "-"})


def in_ascii(text: str) -> str:
    """A text with its units as a terminal has them: `N/µm` as `N/um`."""
    return text.translate(_ASCII)


_UNIT = re.compile(r"(?<=\d) (?=(%|h|N|N/[uµ]m|[uµm]m|m?W|[GM]Pa|K|Hz|r/min)(?!\w))")
"""The space between a number and its unit."""

_MICRO = re.compile(r"(?<=\N{NO-BREAK SPACE})u(?=m(?!\w))|(?<=\N{NO-BREAK SPACE}N/)u(?=m)")
"""The prefix of a unit as a terminal has it."""


def unbroken(text: str) -> str:
    """A text with its numbers in one piece with their units, and µ for u in these."""
    text = _MICRO.sub("µ", _UNIT.sub("\N{NO-BREAK SPACE}", text))
    return text.replace("N/µm", "N/\N{WORD JOINER}µm")
