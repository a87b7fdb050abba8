"""How input is refused: one line with what it got and what was expected."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

DEEPEST = 20  # blocks within blocks; a scene has three
LONGEST = 60  # characters of a text that a message repeats


class NotAvailable(ValueError):
    """The model asked for does not apply to the scene; one line."""


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
        """All that is wrong, as of another source."""
        further = tuple(one.in_source(source) for one in self.further)
        return SceneError(self.key, self.problem, self.involved, source, further)


def key_path(path: str, name: str) -> str:
    """The path of a key in a block."""
    return f"{path}.{name}" if path else name


def leaves(block: Mapping[str, Any], path: str = "") -> dict[str, Any]:
    """Values of nested data by their whole keys, `operation.preload_N`."""
    found: dict[str, Any] = {}
    for name, value in block.items():
        key = key_path(path, name)
        found |= leaves(value, key) if isinstance(value, Mapping) else {key: value}
    return found


def yaml_number(value: float) -> str:
    """A number written so that every YAML reader takes it for one: 1.0e-5, not 1e-05."""
    mantissa, e, exponent = repr(value).partition("e")
    if not e:
        return mantissa
    return f"{mantissa if '.' in mantissa else mantissa + '.0'}e{int(exponent):+d}"


def shown(value: Any) -> str:
    """A value as it would stand in a file, on one short line."""
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


def short(text: str) -> str:
    """A text of a file, as far as a message repeats it."""
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."
