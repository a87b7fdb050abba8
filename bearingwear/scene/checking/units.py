"""Units that people type for those of a scene or an option, and numbers converted from them."""

from __future__ import annotations

import math
from collections.abc import Callable

_LBF, _INCH, _KGF = 4.4482216, 25.4, 9.80665
_PSI = 1e-6 * _LBF / (1e-3 * _INCH) ** 2  # [MPa]
_RPM = 60.0 / (2.0 * math.pi)

_DIMENSIONS: dict[str, dict[str, float]] = {
    "N": {
        "N": 1.0, "mN": 1e-3, "kN": 1e3, "daN": 10.0, "lbf": _LBF, "lbs": _LBF, "lb": _LBF,
        "kgf": _KGF, "kp": _KGF, "kg": _KGF, "gf": 1e-3 * _KGF,
    },
    "mm": {
        "mm": 1.0, "m": 1e3, "cm": 10.0, "um": 1e-3, "µm": 1e-3, "nm": 1e-6, "in": _INCH,
        "inch": _INCH, "inches": _INCH, '"': _INCH, "mil": 1e-3 * _INCH, "thou": 1e-3 * _INCH,
    },
    "r/min": {
        "r/min": 1.0, "rpm": 1.0, "1/min": 1.0, "min-1": 1.0, "U/min": 1.0, "krpm": 1e3, "k": 1e3,
        "rad/s": _RPM, "Hz": 60.0, "1/s": 60.0, "rps": 60.0, "rev/s": 60.0,
    },
    "degree": {"degree": 1.0, "degrees": 1.0, "deg": 1.0, "°": 1.0, "rad": 180.0 / math.pi},
    "mrad": {"mrad": 1.0, "rad": 1e3, "deg": 1e3 * math.pi / 180.0, "°": 1e3 * math.pi / 180.0,
        "arcmin": 1e3 * math.pi / 10800.0, "'": 1e3 * math.pi / 10800.0},
    "GPa": {
        "GPa": 1.0, "MPa": 1e-3, "N/mm2": 1e-3, "N/mm²": 1e-3, "kPa": 1e-6, "Pa": 1e-9,
        "bar": 1e-4, "psi": 1e-3 * _PSI, "ksi": _PSI, "HB": 1e-3 * _KGF, "HV": 1e-3 * _KGF,
    },
    "N/um": {
        "N/um": 1.0, "N/µm": 1.0, "kN/mm": 1.0, "N/mm": 1e-3, "N/m": 1e-6, "MN/m": 1.0,
        "N/nm": 1e3, "lbf/in": 1e-3 * _LBF / _INCH, "lb/in": 1e-3 * _LBF / _INCH,
    },
    "W": {"W": 1.0, "mW": 1e-3, "kW": 1e3, "hp": 745.7},
    "Hz": {"Hz": 1.0, "kHz": 1e3, "1/s": 1.0, "rad/s": 0.5 / math.pi, "rpm": 1.0 / 60.0,
        "r/min": 1.0 / 60.0},
    "h": {"h": 1.0, "hours": 1.0, "hour": 1.0, "hr": 1.0, "hrs": 1.0, "min": 1.0 / 60.0,
        "s": 1.0 / 3600.0, "d": 24.0, "days": 24.0, "day": 24.0, "weeks": 168.0,
        "years": 8766.0, "year": 8766.0, "yr": 8766.0, "a": 8766.0},
    "kg": {"kg": 1.0, "g": 1e-3, "t": 1e3, "lb": 0.45359237, "lbs": 0.45359237},
    "kg/m3": {"kg/m3": 1.0, "kg/m³": 1.0, "g/cm3": 1e3, "g/cm³": 1e3, "kg/l": 1e3, "t/m3": 1e3},
    "m/s2": {"m/s2": 1.0, "m/s²": 1.0, "m/s^2": 1.0, "g": 9.80665, "gn": 9.80665},
    "g": {"g": 1.0, "gn": 1.0, "m/s2": 1.0 / 9.80665, "m/s²": 1.0 / 9.80665},
    "N m": {"N m": 1.0, "Nm": 1.0, "N*m": 1.0, "mNm": 1e-3, "mN m": 1e-3, "Nmm": 1e-3,
        "N mm": 1e-3, "Ncm": 1e-2, "uNm": 1e-6, "µNm": 1e-6, "kNm": 1e3, "lbf in": 1e-3 * _LBF
        * _INCH, "in-lbf": 1e-3 * _LBF * _INCH, "ozin": 1e-3 * _LBF * _INCH / 16.0},
    "1/K": {"1/K": 1.0, "1e-6/K": 1e-6, "ppm/K": 1e-6, "um/m/K": 1e-6},
    "m/s": {"m/s": 1.0, "mm/s": 1e-3, "um/s": 1e-6},
    "1": {"1": 1.0, "%": 1e-2},
}  # fmt: skip
"""Units that may be typed in place of a scene's unit, by that unit, each with its size in it."""

for _unit, _base, _factor in (("um", "mm", 1e3), ("MPa", "GPa", 1e3), ("s", "h", 3600.0)):
    _DIMENSIONS[_unit] = {name: size * _factor for name, size in _DIMENSIONS[_base].items()}

_CONFUSED = {
    "N": ("kN", "mN"),
    "mm": ("m", "um"),
    "um": ("mm", "m"),
    "GPa": ("MPa", "Pa"),
    "MPa": ("GPa", "Pa"),
    "N/um": ("N/mm", "N/m"),
    "kg": ("g",),
    "kg/m3": ("g/cm3",),
    "1/K": ("1e-6/K",),
    "h": ("s",),
    "W": ("mW",),
    "Hz": ("r/min",),
    "1": ("%",),
}
"""Units that are confused with that of a scene, the likeliest first."""

_CONFUSED_AT = {"brinell_hardness_GPa": ("HB", "MPa")}
"""Confused units of keys, by their names, for which others than in `_CONFUSED` are likelier."""


def converted(value: float, typed: str, unit: str) -> float | None:
    """Returns a value in the unit of a scene; None where the typed unit is of another dimension.

    typed: unit of the value. Its case counts only where it tells two units apart (mN, MN).
    """
    typed = " ".join(typed.replace("μ", "µ").split())
    if typed in ("C", "°C", "degC", "K", "F", "°F", "degF"):
        return _degrees_celsius(value, typed) if unit == "degC" else None
    units = _DIMENSIONS.get(unit, {})
    if typed in units:
        return value * units[typed]
    sizes = {size for name, size in units.items() if name.lower() == typed.lower()}
    return value * sizes.pop() if len(sizes) == 1 else None


def _degrees_celsius(value: float, typed: str) -> float:
    """Converts a temperature to degrees Celsius.

    typed: unit of the value: K, or one of Fahrenheit or Celsius.
    """
    if typed == "K":
        return value - 273.15
    return (value - 32.0) / 1.8 if "F" in typed else value


_LARGEST_MEANT = {"%": 2.0, "N/mm": 1000.0}
"""Largest value in the right unit that may have been typed in another: no share is larger, and no
ball bearing has 1000 N/um, which were then rather typed in N/m."""


def confused_unit(
    value: float, unit: str, fits: Callable[[float], bool], key: str = ""
) -> tuple[str, float] | None:
    """Returns the unit in which a value was probably given, and the value in its right unit.

    It is None if no other unit makes the value an allowed one.

    unit: the right one.
    fits: whether a value in the right unit is allowed.
    key: name of the key, without its block.
    """
    for typed in _CONFUSED_AT.get(key, _CONFUSED.get(unit, ())):
        value_in_unit = converted(value, typed, unit)
        if value_in_unit is None or value_in_unit > _LARGEST_MEANT.get(typed, math.inf):
            continue
        if fits(value_in_unit):
            return typed, float(f"{value_in_unit:.5g}")
    return None


def meant_words(value: float, unit: str, fits: Callable[[float], bool], key: str = "") -> str:
    """Returns advice on a value that is not allowed in its unit but is in another; "" if none.

    Parameters are those of `confused_unit`.
    """
    confused = confused_unit(value, unit, fits, key)
    if confused is None:
        return ""
    typed, meant = confused
    if typed == "%":
        return f"a share: {meant:.7g} for {value:.7g} %"
    return f"if it is in {typed}, write {meant:.7g}"
