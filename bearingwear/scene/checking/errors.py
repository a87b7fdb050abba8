"""How input is refused: one line with what it got and what was expected."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

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
    """Joins the path of a block and the name of a key in it."""
    return f"{path}.{name}" if path else name


def leaves(block: Mapping[str, Any], path: str = "") -> dict[str, Any]:
    """Returns the values of nested data by their whole keys, such as `operation.preload_N`."""
    values_by_key: dict[str, Any] = {}
    for name, value in block.items():
        key = key_path(path, name)
        values_by_key |= leaves(value, key) if isinstance(value, Mapping) else {key: value}
    return values_by_key


def yaml_number(value: float) -> str:
    """Writes a number so that every YAML reader takes it for one: 1.0e-5, not 1e-05."""
    mantissa, e, exponent = repr(value).partition("e")
    if not e:
        return mantissa
    return f"{mantissa if '.' in mantissa else mantissa + '.0'}e{int(exponent):+d}"


def shown(value: Any) -> str:
    """Writes a value as it would stand in a file, on one short line."""
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
    if isinstance(value, float) and not math.isfinite(value):
        return ".nan" if math.isnan(value) else ".inf" if value > 0 else "-.inf"
    return short(yaml_number(value) if isinstance(value, float) else repr(value))


_THOUSANDS = re.compile(r"[-+]?\d{1,3}(?:[ _'\u00a0\u202f]\d{3})+(?:\.\d*)?")
_WITH_UNIT = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\d\s.,+-].*)")

_CONVERTED = {
    "lbf": (4.4482216, "N"), "lb": (4.4482216, "N"), "kgf": (9.80665, "N"), "kN": (1e3, "N"),
    "in": (25.4, "mm"), "inch": (25.4, "mm"), '"': (25.4, "mm"),
    "rad": (180.0 / math.pi, "degrees"),
}  # fmt: skip
"""Units that are typed for those of a scene, by their factors."""


def number_hint(text: str, unit: str = "") -> str:
    """Returns how to write a text that was meant as a number; empty where that is not clear.

    unit: of the number, where it is known.
    """
    if re.fullmatch(r"[-+]?\d{1,3}(,\d{3})+(\.\d*)?", text):
        as_decimal = f" or {float(text.replace(',', '.')):g}" if text.count(",") == 1 else ""
        return f"write {text.replace(',', '')}{as_decimal}, without a comma"
    if re.fullmatch(r"[-+]?\d*,\d+([eE][-+]?\d+)?", text):
        return f"write {text.replace(',', '.')}, with a decimal point"
    if _THOUSANDS.fullmatch(text):
        return f"write {re.sub(r'[^-+.0-9]', '', text)}, without separators"
    if match := _WITH_UNIT.fullmatch(text):
        if match[2] == "%":
            return f"write {float(match[1]) / 100.0:.6g}, as a share"
        if match[2] in _CONVERTED:
            factor, unit_of_scene = _CONVERTED[match[2]]
            return f"write {factor * float(match[1]):.5g}, which is it in {unit_of_scene}"
        return f"write the number alone{f', in {unit}' if unit not in ('', '1', '-') else ''}"
    return ""


def check_thousands(path: str, text: str, source: str = "scene") -> None:
    """Refuses a speed such as 18.000, which may be 18 or 18000 r/min."""
    if re.fullmatch(r"[-+]?\d{1,3}\.000", text):
        units, thousands = text.partition(".")[0], text.replace(".", "")
        problem = f"got {text}, which may be a thousand times more, expected {thousands} or {units}"
        raise SceneError(path, problem, source=source)


def short(text: str) -> str:
    """Shortens a text to what a message repeats of it."""
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."
