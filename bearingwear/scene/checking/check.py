"""Checks plain data, as YAML gives it, by the fields of a record, and builds the record.

    plan = record(Sampling, {"samples": -1}, "config/design.yaml")

raises a SceneError for the gravest fault, in one line:
`config/design.yaml: samples: got -1, expected a whole number >= 1`; the others are `further` in it.

What several fields must fulfil together is checked in the record's `__post_init__`, which raises
a ValueError, or a `SceneError` that names the field.
"""

from __future__ import annotations

import difflib
import math
import numbers
import os
import re
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from bearingwear.scene.checking.errors import SceneError, short, shown, yaml_number
from bearingwear.scene.checking.records import NAME, Key, Part, R, part_at, whole

DEEPEST = 20
"""Limit of blocks within blocks; a scene has three."""

MOST_FAULTS = 10
"""Faults of one file that are reported together."""


def record(record_type: type[R], data: Any, source: str = "scene") -> R:
    """Check plain nested data and build the record of it.

    Parameters
    ----------
    record_type : type
        A dataclass.
    data : dict
        Not changed.
    source : str
        What error messages name.

    SceneError: whatever is wrong.
    """
    try:
        return built(record_type, checked_data(record_type, data))
    except SceneError as error:
        raise error.in_source(source) from None


def read_record(record_type: type[R], path: str | os.PathLike[str]) -> R:
    """Read a YAML file, in which anchors are allowed, and build the record of it.

    SceneError: whatever is wrong.
    """
    from bearingwear.scene.checking.strict_yaml import data_of, text_of

    source = os.fspath(path)
    data = data_of(text_of(path), source, anchors=True)
    if not isinstance(data, dict):
        raise SceneError("", f"got {shown(data)}, expected a block of keys", source=source)
    return record(record_type, data, source)


def checked_data(record_type: type, data: Any) -> dict[str, Any]:
    """Plain copy of data that fits the record, nothing filled in.

    May raise SceneError.
    """
    file = whole(record_type)
    plain = _copied(data, "", 0, file)
    if faults := list(_faults(plain, file, "", ())):
        raise _refused(faults, file)
    return plain


def _refused(faults: list[Fault], file: Part) -> SceneError:
    """The gravest fault, with the others that do not follow from it.

    Paths below an impossible name hold it, and a mistyped key is missing as well.
    """
    faults = sorted(faults, key=lambda f: (f.rank, f.place))
    if faults[0].rank == _IMPOSSIBLE_NAME:
        faults = [fault for fault in faults if fault.rank == _IMPOSSIBLE_NAME]
    mistyped = {fault.place for fault in faults if fault.rank == _UNKNOWN}
    errors = [
        SceneError(
            fault.path, (fault.rank == _UNKNOWN and _meant(fault.path, file)) or fault.problem
        )
        for fault in faults
        if not (fault.rank == _NOTHING and fault.place in mistyped)
    ]
    first, *further = errors[:MOST_FAULTS]
    return SceneError(first.key, first.problem, further=tuple(further))


def _copied(value: Any, path: str, depth: int, file: Part) -> Any:
    """Plain copy of nested data, refusing what is not plain or not finite."""
    if depth > DEEPEST:
        raise SceneError(path, f"got more than {DEEPEST} nested blocks, expected fewer")
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                raise SceneError(path, f"got the key {shown(key)}, expected text as a key")
        return {
            k: _copied(v, f"{path}.{k}" if path else k, depth + 1, file) for k, v in value.items()
        }
    if hasattr(value, "tolist"):  # numpy numbers and arrays
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [_copied(part, f"{path}[{i}]", depth + 1, file) for i, part in enumerate(value)]
    if value is None or isinstance(value, bool | str | int):
        return value
    if isinstance(value, numbers.Real) and math.isfinite(value):
        return float(value)
    given = float(value) if isinstance(value, numbers.Real) else value
    part = part_at(file, path)
    raise SceneError(
        path, f"got {shown(given)}, expected {part.allowed if part else 'another value'}"
    )


# A name that is impossible comes first: the path of whatever is wrong below it would hold it.
# A mistyped key is both unknown and missing: it is named as what it is.
_IMPOSSIBLE_NAME, _UNKNOWN, _WRONG_TYPE, _OUT_OF_RANGE, _NOTHING = range(5)


class Fault(NamedTuple):
    """A fault: its priority, its place in the file, and its message."""

    rank: int
    place: tuple[int, ...]
    path: str
    problem: str


def _faults(value: Any, part: Part, path: str, place: tuple[int, ...]) -> Iterator[Fault]:
    if value is None and part.nullable:
        return
    given_as = part
    if part.kind == "list" and part.key.single and _is_number(value):
        part = part.item or part
    if part.kind == "block" and isinstance(value, Mapping):
        yield from _block_faults(value, part, path, place)
    elif part.kind == "mapping" and isinstance(value, Mapping):
        yield from _mapping_faults(value, part, path, place)
    elif part.kind == "list" and isinstance(value, list):
        if len(value) < part.key.least or len(value) > (part.key.most or math.inf):
            yield _out_of_range(value, part, path, place)
        for i, item in enumerate(value):
            yield from _faults(item, part.item, f"{path}[{i}]", (*place, i))  # type: ignore[arg-type]
    elif part.kind in ("choice", "choice_or_number"):
        number = part.kind == "choice_or_number" and _is_number(value)
        if not (number and _in_range(value, part.key)) and value not in part.key.choices:
            yield _out_of_range(value, given_as, path, place)
    elif part.kind not in ("own", "any"):
        if not _has_kind(value, part.kind):
            hint = _number_hint(value, part) or _text_hint(value, part)
            problem = f"got {shown(value)}{hint}, expected {part.allowed}"
            yield Fault(_WRONG_TYPE, place, path, problem)
        elif not (_text_fits if part.kind == "text" else _in_range)(value, part.key):
            yield _out_of_range(value, given_as, path, place)


def _out_of_range(value: Any, part: Part, path: str, place: tuple[int, ...]) -> Fault:
    problem = f"got {shown(value)}, expected {part.allowed}"
    return Fault(_OUT_OF_RANGE, place, path, problem)


def _block_faults(
    given: Mapping[str, Any], part: Part, path: str, place: tuple[int, ...]
) -> Iterator[Fault]:
    known = part.below
    for unknown in (key for key in given if key not in known):
        near = difflib.get_close_matches(unknown, known, n=2, cutoff=0.6)
        free = [key for key in known if key not in given] or list(known)
        names = (
            f"did you mean {' or '.join(near)}" if near else f"expected one of {', '.join(free)}"
        )
        where = _joined(path, short(unknown))
        yield Fault(_UNKNOWN, place, where, f"got an unknown key; {names}")
    for name, below in known.items():
        if below.required and name not in given:
            such = f", such as {below.key.example}" if below.key.example else ""
            problem = f"got nothing, expected {below.allowed}{such}"
            yield Fault(_NOTHING, place, _joined(path, name), problem)
    for i, (name, value) in enumerate(given.items()):
        if name in known:
            yield from _faults(value, known[name], _joined(path, name), (*place, i))


def _meant(path: str, file: Part) -> str:
    """The message for an unknown key that belongs to another block; empty if it belongs to none."""
    block, _, name = path.rpartition(".")
    siblings = part_at(file, block)
    if siblings is not None and difflib.get_close_matches(name, siblings.below):
        return ""
    places: dict[str, list[str]] = {}
    for place in _places(file, ""):
        places.setdefault(place.rpartition(".")[2], []).append(place)
    near = difflib.get_close_matches(name, places, n=1, cutoff=0.8)
    meant = [place for one in near for place in places[one]]
    meant = [place for place in meant if place.count(".") == min(p.count(".") for p in meant)]
    return f"got an unknown key; did you mean {' or '.join(meant)}" if meant else ""


def _places(block: Part, path: str) -> Iterator[str]:
    """Every key of a file that takes a value, with the blocks it stands in."""
    for name, part in block.below.items():
        if part.kind == "block":
            yield from _places(part, _joined(path, name))
        else:
            yield _joined(path, name)


def _mapping_faults(
    given: Mapping[str, Any], part: Part, path: str, place: tuple[int, ...]
) -> Iterator[Fault]:
    assert part.item is not None
    if len(given) < part.key.least:
        problem = f"got a block of {len(given)} keys, expected {part.allowed}"
        yield Fault(_OUT_OF_RANGE, place, path, problem)
    for i, (name, value) in enumerate(given.items()):
        if not _is_name(name, part):
            problem = f"got the name {shown(name)}, expected {part.allowed}"
            yield Fault(_IMPOSSIBLE_NAME, place, path, problem)
        yield from _faults(value, part.item, _joined(path, name), (*place, i))


def _is_name(name: str, mapping: Part) -> bool:
    if mapping.key.names:
        return name in mapping.key.names
    return mapping.item is None or mapping.item.kind == "any" or bool(re.search(NAME, name))


def _has_kind(value: Any, kind: str) -> bool:
    if kind == "integer":
        whole_float = isinstance(value, float) and value.is_integer()
        return _is_number(value) and (isinstance(value, int) or whole_float)
    if kind == "number":
        return _is_number(value)
    return isinstance(value, {"boolean": bool, "text": str}.get(kind, ()))


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _in_range(value: Any, key: Key) -> bool:
    if isinstance(value, bool):
        return True
    return (
        (key.minimum is None or value >= key.minimum)
        and (key.above is None or value > key.above)
        and (key.maximum is None or value <= key.maximum)
        and (key.below is None or value < key.below)
        and abs(value) <= _LARGEST
    )


_LARGEST = 1.7976931348623157e308
"""A whole number of YAML may be larger than any that can be calculated with."""


def _text_fits(value: str, key: Key) -> bool:
    return len(value) <= (key.longest or math.inf) and bool(re.search(key.pattern, value))


def fits(value: Any, part: Part) -> bool:
    """Whether a value may stand at a part."""
    return not any(_faults(value, part, "", ()))


def _joined(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name


# building


def built(record_type: type[R], plain: Mapping[str, Any], path: str = "") -> R:
    """The record of checked data; whole numbers become floats where a number is meant.

    SceneError where the record itself refuses its values.
    """
    values = {
        part.field: _value(plain[name], part, _joined(path, name))
        for name, part in whole(record_type).below.items()
        if name in plain and (plain[name] is not None or part.required)
    }
    try:
        return record_type(**values)
    except SceneError as error:
        here = path and ".".join(filter(None, (path, error.key)))
        raise SceneError(here or error.key, error.problem, error.involved) from None
    except ValueError as error:
        raise SceneError(path, str(error)) from None


def _value(value: Any, part: Part, path: str) -> Any:
    if value is None:
        return None
    if part.kind == "block":
        return built(part.type, value, path)
    if part.kind == "own":
        try:
            return part.type.from_plain(value)
        except SceneError:
            raise
        except ValueError as error:
            raise SceneError(path, str(error)) from None
    if part.kind == "mapping" and part.item:
        return {name: _value(v, part.item, _joined(path, name)) for name, v in value.items()}
    if part.kind == "list" and part.item:
        values = value if isinstance(value, list) else [value]
        return tuple(_value(v, part.item, f"{path}[{i}]") for i, v in enumerate(values))
    if part.kind == "integer":
        return int(value)
    return float(value) if part.kind != "any" and _is_number(value) else value


def _number_hint(value: Any, part: Part) -> str:
    """How a text that was meant as a number is written as one."""
    numeric = part.item if part.key.single and part.item else part
    if not isinstance(value, str) or numeric.kind not in ("integer", "number"):
        return ""
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        return ", text, not a number"
    whole = number == int(number) and abs(number) < 1e9
    return f", text, not a number (write {int(number) if whole else yaml_number(number)})"


def _text_hint(value: Any, part: Part) -> str:
    """How a name that YAML takes for a number is written as one."""
    if part.key.pattern != NAME or not _is_number(value) or not re.search(NAME, str(value)):
        return ""
    return f', a number, not text (write "{value}")'
