"""Typed records: what a key of a file means and takes stands at the field of a dataclass.

A field says its `Key`:

    @keyed
    class Sampling:
        samples: int = setting("Base samples, a power of two", "1", "[1, inf)", default=256)

`check` checks plain data by it. Completion, the JSON schema and the list of keys in
config/README.md are generated from the same fields.

A field may be int, float, bool, str (with `choices` or a `pattern`), `str | float` (a choice or a
number), another record, a tuple of one of these, a `Mapping` of names to one of these, `X | None`,
or `Any`. A class that needs more has a method `from_plain(data)`, and says in `ALLOWED` what it
takes.

This file imports nothing heavy: the command line completes keys with it.
"""

from __future__ import annotations

import functools
import math
import operator
import re
import types
from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, dataclass, field, fields, is_dataclass, make_dataclass, replace
from typing import Any, TypeVar, Union, dataclass_transform, get_args, get_origin, get_type_hints

from bearingwear.scene.checking.errors import yaml_number

SCENE_SUFFIXES = (".yaml", ".yml")
R = TypeVar("R")

NAME = r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$(?!\n)"  # of scenes, materials and blocks
NAME_RULE = "a-z, A-Z, 0-9, _ and - (at most 64 characters, the first a letter or digit)"


@dataclass(frozen=True)
class Key:
    """Meaning and permitted values of a key."""

    meaning: str = ""  # one sentence
    unit: str = ""  # 1 for a number, none for anything else
    # the range as an interval: `[0, 0.5)` are the numbers from 0 to below 0.5, `(0, inf)`
    # those above 0
    within: str = ""
    choices: tuple[str, ...] = ()  # the texts that are allowed
    synonyms: Mapping[str, str] = field(default_factory=dict)  # other texts for choices
    pattern: str = ""  # regular expression of a text
    longest: int | None = None  # most characters of a text
    # fewest and most values of a list, blocks of a mapping
    least: int = 0
    most: int | None = None
    names: tuple[str, ...] = ()  # names that a mapping may use; any name where empty
    each: str = ""  # what one value of a list or a mapping means
    single: bool = False  # a single value stands for a list of one
    default_by: str = ""  # key that decides the default
    allowed: str = ""  # in words, where the range and the choices do not say it
    example: str = ""  # a value that a message suggests where a required one is missing
    name: str = ""  # in the file, where it cannot be a name in Python

    @property
    def ends(self) -> tuple[float, float]:
        """Returns the least and largest number; an end without a bound is infinite."""
        interval = self.within[1:-1] or "-inf, inf"
        low, high = interval.split(",")
        return float(low), float(high)

    @functools.cached_property
    def bounds(self) -> dict[str, float]:
        """Returns the finite ends, under the names of the JSON schema."""
        low, high = self.ends
        bounds = {
            "minimum" if self.within.startswith("[") else "exclusiveMinimum": low,
            "maximum" if self.within.endswith("]") else "exclusiveMaximum": high,
        }
        return {name: end for name, end in bounds.items() if math.isfinite(end)}


COMPARISONS: Mapping[str, tuple[Callable[[Any, float], bool], str]] = {
    "minimum": (operator.ge, ">="),
    "exclusiveMinimum": (operator.gt, ">"),
    "maximum": (operator.le, "<="),
    "exclusiveMaximum": (operator.lt, "<"),
}
"""How a number compares with each bound of a range, and the sign of it."""


def setting(meaning: str, unit: str = "", within: str = "", **more: Any) -> Any:
    """Returns a field of a dataclass with its `Key`.

    **more: further fields of `Key`; and `default` or `default_factory`, which make it optional.
    """
    default = {name: more.pop(name) for name in ("default", "default_factory") if name in more}
    return field(**default, metadata={"key": Key(meaning, unit, within, **more)})


@dataclass_transform(frozen_default=True, kw_only_default=True, field_specifiers=(setting, field))
def keyed(record_type: type[R]) -> type[R]:
    """Makes a class a frozen record that is built by keyword."""
    return dataclass(frozen=True, kw_only=True)(record_type)


def record_hash(record: Any) -> int:
    """Returns what `__hash__` returns for a record with mapping proxies, which have none.

    The order of keys does not count, as it does not for equality.
    """
    return hash(tuple(_hashable(getattr(record, part.name)) for part in fields(record)))


def _hashable(value: Any) -> Any:
    """Returns a value with mappings and lists replaced by what has a hash."""
    if isinstance(value, Mapping):
        return frozenset((key, _hashable(value[key])) for key in value)
    return tuple(map(_hashable, value)) if isinstance(value, list | tuple) else value


def reduced_record(record: Any) -> tuple[Any, ...]:
    """Returns what `__reduce__` returns for a record with mapping proxies.

    These cannot be pickled, so the record is made again from dictionaries.
    """
    values: dict[str, Any] = {}
    for record_field in fields(record):
        value = getattr(record, record_field.name)
        values[record_field.name] = dict(value) if isinstance(value, Mapping) else value
    record_type: Any = type(record)
    return functools.partial(record_type, **values), ()


@dataclass(frozen=True)
class Part:
    """A field of a record, resolved."""

    # integer, number, boolean, text, choice, choice_or_number, list, mapping, block, own or
    # any
    kind: str
    key: Key
    type: Any = None  # the record of a block
    item: Part = None  # type: ignore[assignment]  # of a list or a mapping
    nullable: bool = False
    field: str = ""
    required: bool = True
    default: Any = None

    @functools.cached_property
    def below(self) -> Mapping[str, Part]:
        """Returns the parts of a block by the names of their keys; none for any other kind."""
        return parts(self.type) if self.kind == "block" else {}

    @functools.cached_property
    def allowed(self) -> str:
        """Returns the permitted values in words."""
        return self.key.allowed or _in_words(self)

    @property
    def example(self) -> str:
        """Returns a value that a message suggests for a required key; "" without one.

        Of a block, it has all required keys.
        """
        if self.key.example or self.kind != "block":
            return self.key.example
        examples = {name: part.example for name, part in self.below.items() if part.required}
        if not examples or not all(examples.values()):
            return ""
        lines = ", ".join(f"{name}: {example}" for name, example in examples.items())
        return f"{{{lines}}}"

    @property
    def unit(self) -> str:
        """Returns the unit of a value; `-` for what has none."""
        return self.key.unit or ("1" if self.kind in ("integer", "number") else "-")


def optional_numbers(keys: Mapping[str, Key]) -> Any:
    """Makes a frozen dataclass, to derive a record from, whose fields are numbers or None.

    keys: by the names of the fields, all of which are None if omitted.
    """
    named: list[Any] = [
        (name, float | None, field(default=None, metadata={"key": key}))
        for name, key in keys.items()
    ]
    return make_dataclass("OptionalNumbers", named, frozen=True, kw_only=True)


_KINDS = {int: "integer", float: "number", bool: "boolean", str: "text", Any: "any"}


@functools.cache
def parts(record_type: Any) -> Mapping[str, Part]:
    """Returns the parts of a record, a dataclass, by the names of their keys; it is read-only.

    A part of a required key has the default None.
    """
    resolved = {}
    hints = get_type_hints(record_type)
    for field_ in fields(record_type):
        hint, key = hints[field_.name], field_.metadata.get("key") or Key()
        optional = field_.default is not MISSING or field_.default_factory is not MISSING
        default = field_.default
        if default is MISSING:
            default = {} if optional else None  # what `default_factory` makes is a block
        part = _part_of_hint(hint, key, field=field_.name, required=not optional, default=default)
        resolved[key.name or field_.name] = part
    return types.MappingProxyType(resolved)


def file_part(record_type: type) -> Part:
    """Returns the part of a record that stands for a whole file."""
    return Part("block", Key(), record_type)


def part_at(part: Part, path: str) -> Part | None:
    """Returns the part at a path such as `materials.steel.density_kg_m3`; None if there is none."""
    place: Part | None = part
    for name in re.findall(r"[^.\[\]]+", path):
        if place is None:
            return None
        place = place.below.get(name) or place.item  # a mapping takes any name, a list an index
    return place


def keys(block: Part, path: str = "") -> Iterator[tuple[str, Part]]:
    """Yields every key of a block with its part, and then the keys below it.

    Keys are whole, as `operation.preload_N`; `NAME` and `[]` stand for items of mappings and lists.

    path: of the block, with a dot at its end.
    """
    for name, part in block.below.items():
        key = f"{path}{name}"
        yield key, part
        if part.kind == "block":
            yield from keys(part, f"{key}.")
        elif part.item and part.item.kind == "block":
            yield from keys(part.item, f"{key}{'.NAME' if part.kind == 'mapping' else '[]'}.")


def _split_none(hint: Any) -> tuple[list[Any], bool]:
    """Returns the alternatives of a type hint other than None, and whether None is one."""
    if get_origin(hint) not in (Union, types.UnionType):
        return [hint], False
    alternatives = [alternative for alternative in get_args(hint) if alternative is not type(None)]
    return alternatives, len(alternatives) < len(get_args(hint))


def _part_of_hint(hint: Any, key: Key, **more: Any) -> Part:
    """Returns the part that a type hint describes.

    With None as an alternative, the part is nullable. Several other alternatives give a choice or
    a number, a tuple a list, and any other generic a mapping. A class with `from_plain` is its own
    part, and a dataclass a block, which is nullable if not required.

    more: further fields of the part.
    """
    (hint, *others), nullable = _split_none(hint)
    if others:
        return Part("choice_or_number", key, nullable=nullable, **more)
    item_key = replace(
        key, meaning=key.each, each="", least=0, most=None, names=(), single=False, allowed=""
    )
    if get_origin(hint) is tuple:
        element, *more_elements = get_args(hint)
        if more_elements != [...]:
            key = replace(key, least=len(get_args(hint)), most=len(get_args(hint)))
        return Part("list", key, item=_part_of_hint(element, item_key), nullable=nullable, **more)
    if get_origin(hint) is not None:
        item = _part_of_hint(get_args(hint)[1], item_key)
        return Part("mapping", key, item=item, nullable=nullable, **more)
    if hasattr(hint, "from_plain"):
        return Part("own", key, hint, nullable=nullable, **more)
    if is_dataclass(hint):
        nullable = nullable or not more.get("required", True)
        return Part("block", key, hint, nullable=nullable, **more)
    kind = "choice" if hint is str and key.choices else _KINDS[hint]
    return Part(kind, key, nullable=nullable, **more)


def _in_words(part: Part) -> str:
    """Returns the permitted values of a part in words, from its kind, range and choices."""
    key = part.key
    if part.kind == "text" and key.pattern == NAME:
        return NAME_RULE
    if part.kind in ("integer", "number"):
        return f"a {'whole ' if part.kind == 'integer' else ''}number{_range(key)}"
    if part.kind == "choice_or_number":
        return f"{', '.join(key.choices)} or a number{_range(key)}"
    if part.kind == "choice":
        *others, last = key.choices
        return f"{', '.join(others)} or {last}" if others else last
    if part.kind == "list":
        if part.item.kind == "block":
            return "a list of blocks of keys"
        count = f" of {_COUNTS[key.least]} numbers" if key.least == key.most else " of values"
        return f"a list{count}, each {part.item.allowed.removeprefix('a number ')}"
    if part.kind == "mapping":
        if part.item.kind == "any":
            return "KEY: VALUE"
        items = "blocks" if part.item.kind == "block" else "values"
        named = ", ".join(key.names) or f"with {NAME_RULE}"
        return f"{'one or more ' if key.least and not key.names else ''}{items} named {named}"
    if part.kind == "own":
        return str(getattr(part.type, "ALLOWED", "another value"))
    words = {"boolean": "true or false", "block": "a block of keys", "text": "text"}
    return words.get(part.kind, "another value")


_COUNTS = ("no", "one", "two", "three", "four")


def _range(key: Key) -> str:
    """Returns the range of a number in words, after a space; "" without bounds."""
    if {"minimum", "maximum"} == set(key.bounds):
        least, largest = key.ends
        return f" from {_end(least)} to {_end(largest)}"
    ends = [f"{COMPARISONS[name][1]} {_end(end)}" for name, end in key.bounds.items()]
    return " " + " and ".join(ends) if ends else ""


def _end(value: float) -> str:
    """Returns a bound of a range as text: `10`, `0.001`, `1.0e-4`."""
    if value == int(value):
        return str(int(value))
    exponent = math.floor(math.log10(abs(value)))
    return yaml_number(value) if exponent >= -3 else f"{value / 10.0**exponent:.1f}e{exponent}"
