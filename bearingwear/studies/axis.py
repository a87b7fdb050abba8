"""Axes of studies in their YAML files, a list of numbers, or first, last and step; their errors."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from typing import Any

from bearingwear.scene.checking.check import build_record, checked_data
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.records import keyed, setting

GRID_KEYS = {
    "preload_method": "operation.preload_method",
    "friction": "friction.ball_race",
    "ball_diameter_loss": "wear.ball_diameter_loss_um",
}
"""Keys of a scene by the names that they have as dimensions of files."""

MOST_POINTS = 1000
"""Largest number of evenly spaced values on an axis."""

MOST_DECIMALS = 9
"""Most decimals of a number that names files."""


def mu_name(friction: float) -> str:
    """Returns a friction coefficient as it stands in the names of files, such as 0.050."""
    return _with_decimals(friction, 3)


def loss_name(loss_um: float) -> str:
    """Returns a loss of ball diameter [um] as it stands in the names of files, such as 1.50."""
    return _with_decimals(loss_um, 2)


def _with_decimals(value: float, decimals: int) -> str:
    """Returns a number as text with at least some decimals, and with `MOST_DECIMALS` at most."""
    integer_part, _, fraction = f"{value:.{MOST_DECIMALS}f}".rstrip("0").partition(".")
    return f"{integer_part}.{fraction:0<{decimals}}"


@keyed
class Steps:
    """Evenly spaced values."""

    first: float = setting("First value", within="(0, inf)")
    last: float = setting("Last value", within="(0, inf)")
    step: float = setting("Distance between successive values", within="(0, inf)")

    def __post_init__(self) -> None:
        """Raises a ValueError unless at most `MOST_POINTS` equal steps end at the last value."""
        distance = abs(self.first + (self.count - 1) * self.step - self.last)
        # beyond the rounding of decimals such as 0.1
        misses_last = distance > 1e-6 * self.step
        if not 1 <= self.count <= MOST_POINTS or misses_last:
            raise ValueError(
                f"got {self.first:g} to {self.last:g} in steps of {self.step:g}, expected at most "
                f"{MOST_POINTS} equal steps that end at the last value"
            )

    @property
    def count(self) -> int:
        """Returns the number of values."""
        return round((self.last - self.first) / self.step) + 1

    @property
    def values(self) -> list[float]:
        """Returns the values, rounded as they stand in the names of files."""
        return [round(self.first + k * self.step, MOST_DECIMALS) for k in range(self.count)]


@keyed
class Values:
    """A list of rising values."""

    values: tuple[float, ...] = setting("Values", least=1, within="(0, inf)")

    def __post_init__(self) -> None:
        """Raises a SceneError if the values do not rise strictly."""
        check_rising("values", self.values)


class RisingAxis(tuple[float, ...]):
    """Rising numbers > 0."""

    ALLOWED = "a list of increasing numbers > 0, or the first value, last value and step"

    @classmethod
    def from_plain(cls, data: Any) -> RisingAxis:
        """Returns the axis of a list, or of the keys of `Steps`. Raises ValueError."""
        try:
            if isinstance(data, list):
                return cls(build_record(Values, checked_data(Values, {"values": data})).values)
            return cls(build_record(Steps, checked_data(Steps, data)).values)
        except SceneError as error:
            key = error.key.removeprefix("values")  # a list has no key of its own
            raise ValueError(": ".join(part for part in (key, error.problem) if part)) from None


def check_rising(name: str, values: Sequence[float]) -> None:
    """Raises a SceneError if the values of a key do not rise strictly."""
    if list(values) != sorted(set(values)):
        numbers = ", ".join(f"{value:g}" for value in values)
        raise SceneError(name, f"got {numbers}, expected increasing numbers > 0")


@contextlib.contextmanager
def place_of_errors(place: str) -> Iterator[None]:
    """Puts a place, such as "config: studies[0]", before the message of a ValueError inside.

    A subclass, such as SceneError, becomes a plain ValueError, and a leading `--set ` is left out.
    """
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{place}: {str(error).removeprefix('--set ')}") from None
