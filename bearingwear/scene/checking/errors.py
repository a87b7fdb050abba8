"""How input is refused: one line with what it got and what was expected."""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterable, Mapping
from typing import Any

from bearingwear.scene.checking.units import converted

DEEPEST = 20  # blocks within blocks; a scene has three
LONGEST = 60  # characters of a text that a message repeats


class NotAvailable(ValueError):
    """The requested model does not apply to the scene; one line."""


class SceneError(ValueError):
    """Input that cannot be used; its text is one line."""

    def __init__(
        self,
        key: str,  # path of the key at fault, `bearing.ball_count`; empty for the whole file
        problem: str,  # what was given and what is allowed
        involved: tuple[str, ...] = (),  # further keys of the contradiction
        source: str = "scene",  # a file, or `scene` for data of Python
        further: tuple[SceneError, ...] = (),  # other faults of the same input
    ) -> None:
        self.key = key
        self.problem = problem
        self.involved = involved
        self.source = source
        self.further = further
        text = ": ".join(part for part in (source, key, problem) if part)
        super().__init__("".join(c if c.isprintable() else "?" for c in text))

    def __reduce__(self) -> tuple[Any, ...]:
        return SceneError, (self.key, self.problem, self.involved, self.source, self.further)

    def in_source(self, source: str) -> SceneError:
        """Returns this error and its further ones as errors of another source."""
        further = tuple(error.in_source(source) for error in self.further)
        return SceneError(self.key, self.problem, self.involved, source, further)


def key_path(path: str, name: str) -> str:
    """Returns the path of a key from that of its block, which is "" for a whole file."""
    return f"{path}.{name}" if path else name


def leaves(block: Mapping[str, Any], path: str = "") -> dict[str, Any]:
    """Returns the values of nested data by their whole keys, such as `operation.preload_N`.

    path: of the block, with which the keys begin.
    """
    values_by_key: dict[str, Any] = {}
    for name, value in block.items():
        key = key_path(path, name)
        if isinstance(value, Mapping):
            values_by_key |= leaves(value, key)
        else:
            values_by_key[key] = value
    return values_by_key


def yaml_number(value: float) -> str:
    """Returns a number as text that every YAML reader takes for one: 1.0e-5, not 1e-05."""
    mantissa, _, exponent = repr(value).partition("e")
    if not exponent:
        return mantissa
    if "." not in mantissa:
        mantissa += ".0"
    return f"{mantissa}e{int(exponent):+d}"


def shown(value: Any) -> str:
    """Returns a value as it would stand in a file, on one short line; `nothing` for None."""
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Mapping):
        return f"a block of {len(value)} keys"
    if isinstance(value, list | tuple):
        return f"a list of {len(value)}"
    if isinstance(value, int) and abs(value) > 10**30:
        return "a whole number with more than 30 digits"
    if not isinstance(value, float):
        return short(repr(value))
    if math.isnan(value):
        return ".nan"
    if math.isinf(value):
        return ".inf" if value > 0.0 else "-.inf"
    return yaml_number(value)


_THOUSANDS = re.compile(r"[-+]?\d{1,3}(?:[ _'\u00a0\u202f]\d{3})+(?:\.\d*)?")
_WITH_UNIT = re.compile(
    r"([-+]?(?:\d[\d., _'\u00a0\u202f]*|[.,]\d+)(?:[eE][-+]?\d+)?)\s*((?:1/)?[^\d\s.,+-].*)"
)
_INCHES = re.compile(r"(\d+)/(\d+)(?:\s*(?:in|inch|\"))?")


def number_hint(text: str, unit: str = "") -> str:
    """Returns how to write a text that was meant as a number; "" where that is not clear.

    unit: that the number should have; "" where it is not known.
    """
    if re.fullmatch(r"[-+]?\d{1,3}(,\d{3})+(\.\d*)?", text):
        may_be_decimal = text.count(",") == 1 and "." not in text
        as_decimal = f" or {float(text.replace(',', '.')):g}" if may_be_decimal else ""
        return f"write {text.replace(',', '')}{as_decimal}, without a comma"
    if re.fullmatch(r"[-+]?\d*,\d+([eE][-+]?\d+)?", text):
        return f"write {text.replace(',', '.')}, with a decimal point"
    if _THOUSANDS.fullmatch(text):
        return f"write {re.sub(r'[^-+.0-9]', '', text)}, without separators"
    if (match := _INCHES.fullmatch(text)) and unit in ("mm", "um") and float(match[2]):
        return _unit_hint(float(match[1]) / float(match[2]), "in", unit)
    if match := _WITH_UNIT.fullmatch(text):
        try:
            return _unit_hint(float(match[1].replace(" ", "")), match[2].strip(), unit)
        except ValueError:  # 18,000 rpm
            return number_hint(match[1].strip(), unit)
    return ""


def _unit_hint(number: float, typed: str, unit: str) -> str:
    """Returns how to write a number that was typed with a unit.

    typed: the unit that was typed; one that cannot be converted to `unit` is only refused.
    """
    value = converted(number, typed, unit or "1")
    if value is None:
        in_unit = "" if unit in ("", "1", "-") else f", in {unit}"
        return f"write the number alone{in_unit}"
    if typed == "%":
        return f"write {value:.6g}, as a share"
    if value == number:
        return f"write the number alone: {number:.7g}"
    return f"write {value:.5g}, which is it in {unit}{'s' if unit == 'degree' else ''}"


def check_thousands(path: str, text: str, source: str = "scene") -> None:
    """Raises SceneError for a speed such as 18.000, which may be 18 or 18000 r/min.

    path: of the key; "" where the source names it.
    source: file or option in which the text stands.
    """
    if re.fullmatch(r"[-+]?\d{1,3}\.000", text):
        units, thousands = text.partition(".")[0], text.replace(".", "")
        problem = f"got {text}, which may be a thousand times more, expected {thousands} or {units}"
        raise SceneError(path, problem, source=source)


SYNONYMS = {
    # choices of keys and options
    "fixed_position": ("rigid", "fixed", "spacer", "displacement", "position"),
    "constant_force": ("spring", "springs", "constant", "force"),
    "rigid": ("fixed", "spacer", "position", "fixed_position", "rigid_pair"),
    "spring": ("springs", "constant", "force", "constant_force", "spring_pair"),
    "silicon_nitride": ("ceramic", "hybrid", "si3n4"),
    "bearing_steel": ("steel", "100cr6", "52100", "suj2", "440c"),
    "mos2": ("moly", "solid", "vacuum"),
    "dry": ("none",),
    "dynamic": ("time", "transient"),
    "steady": ("quasistatic", "static"),
    # keys of a scene
    "ball_race": ("mu", "friction", "coefficient"),
    "ball_count": ("Z", "balls"),
    "ball_diameter_mm": ("D",),
    "pitch_diameter_mm": ("dm", "d_m"),
    "contact_angle_deg": ("alpha",),
    "shaft_speed_rpm": ("n", "rpm"),
    "youngs_modulus_GPa": ("E",),
    "poisson_ratio": ("nu",),
    "density_kg_m3": ("rho",),
    "standard_deviation": ("std", "sigma"),
    "preload_N": ("F", "force"),
    "preload_method": ("method",),
    # options of commands
    "--speed": ("-n", "--n", "--rpm"),
    "--bore": ("-d", "--id"),
    "--outside": ("-D", "--od", "--diameter"),
    "--friction": ("--mu",),
    "--contact-angle": ("--alpha",),
    "--ball-material": ("--material", "--hybrid"),
    "--preload-class": ("--class",),
    "--pair": ("--arrangement",),
    "--lubrication": ("--lubricant",),
    "--output": ("--out",),
    "--slip": ("--gyro",),
    "--stiffness": ("--rigidity",),
    "--frequency": ("--noise",),
}
"""Symbols and words that people type for choices, keys and options."""


def synonym(typed: str, choices: Iterable[str]) -> str | None:
    """Returns the choice that people mean by another text; None if no choice is known for it."""
    return next((choice for choice in choices if typed in SYNONYMS.get(choice, ())), None)


def did_you_mean(typed: Any, choices: Iterable[str]) -> str:
    """Returns advice on a text that is none of the choices: `; did you mean spring`.

    It is "" if no choice is similar. A synonym comes before choices that are spelt alike.
    """
    by_lower_case = {choice.lower(): choice for choice in choices}
    plain_text = re.sub(r"[\s-]+", "_", str(typed).strip().lower())
    for text in (plain_text, plain_text.replace("_", "")):
        if choice := synonym(text, by_lower_case.values()):
            return f"; did you mean {choice}"
    similar = difflib.get_close_matches(plain_text, by_lower_case, n=2, cutoff=0.7)
    if not similar and len(plain_text) > 2:
        similar = [name for name in by_lower_case if plain_text in name]
    names = " or ".join(by_lower_case[name] for name in similar)
    return f"; did you mean {names}" if names else ""


def short(text: str) -> str:
    """Returns at most `LONGEST` characters of a text, with dots at the end of a longer one."""
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."
