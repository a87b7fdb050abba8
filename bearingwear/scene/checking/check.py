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
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

from bearingwear.scene.checking.errors import (
    DEEPEST,
    SceneError,
    did_you_mean,
    key_path,
    number_hint,
    short,
    shown,
    synonym,
    yaml_number,
)
from bearingwear.scene.checking.records import COMPARISONS, NAME, Part, R, file_part, keys, part_at
from bearingwear.scene.checking.units import converted, meant_words

MOST_FAULTS = 10  # of one file that are reported together
_LARGEST = 1.7976931348623157e308  # a whole number of YAML may be larger


def record(record_type: type[R], data: Any, source: str = "scene") -> R:
    """Checks plain nested data, which it does not change, and builds the record of it.

    SceneError: it begins with the source, and names the gravest fault.
    """
    try:
        return build_record(record_type, checked_data(record_type, data))
    except SceneError as error:
        raise error.in_source(source) from None


def read_record(record_type: type[R], path: str | os.PathLike[str]) -> R:
    """Reads a YAML file, in which anchors are allowed, and builds the record of it.

    SceneError: the file cannot be read, is no block of keys, or does not fit the record.
    """
    from bearingwear.scene.checking.strict_yaml import data_of, text_of

    source = os.fspath(path)
    data = data_of(text_of(path), source, anchors=True)
    if not isinstance(data, dict):
        raise SceneError("", f"got {shown(data)}, expected a block of keys", source=source)
    return record(record_type, data, source)


def checked_data(record_type: type, data: Any) -> dict[str, Any]:
    """Returns a plain copy of data that fits the record, with nothing filled in.

    SceneError: the gravest fault, with the others that do not follow from it.
    """
    file = file_part(record_type)
    plain: dict[str, Any] = _plain_copy(data, "", 0, file)
    faults = sorted(_faults(plain, file, "", file), key=lambda fault: fault.priority)
    if not faults:
        return plain
    if faults[0].priority == _IMPOSSIBLE_NAME:  # the other faults may follow from the name
        faults = [fault for fault in faults if fault.priority == _IMPOSSIBLE_NAME]
    gravest, *further = (fault.error for fault in faults[:MOST_FAULTS])
    raise SceneError(gravest.key, gravest.problem, further=tuple(further))


def changed_record(record: Any, part: Part, changes: Mapping[tuple[str, ...], Any]) -> Any:
    """Returns a checked record with some values replaced, which alone are checked.

    part: describes the record.
    changes: new values by their paths below the record, `("bearing", "ball_count")`.

    ValueError: a value that does not fit, or a path that does not lead to one; `checked_data` of
    all values reports it in context.
    """
    changes_by_name: dict[str, dict[tuple[str, ...], Any]] = {}
    for (name, *path), value in changes.items():
        changes_by_name.setdefault(name, {})[tuple(path)] = value
    if isinstance(record, Mapping):
        return {**record, **_changed_items(record, part.item, changes_by_name)}
    new_values = {}
    for name, inner_changes in changes_by_name.items():
        inner_part = part.below.get(name)
        if inner_part is None or record is None:
            raise ValueError(f"{name}: got changes of what the record does not have")
        inner = getattr(record, inner_part.field)
        new_values[inner_part.field] = _changed_value(inner, inner_part, inner_changes)
    return replace(record, **new_values)


def _changed_items(
    mapping: Mapping[str, Any],
    part: Part,
    changes_by_name: Mapping[str, Mapping[tuple[str, ...], Any]],
) -> dict[str, Any]:
    """Returns the changed items of a mapping, such as a material; ValueError for a new name.

    part: describes each item.
    """
    if missing := [name for name in changes_by_name if name not in mapping]:
        raise ValueError(f"{missing[0]}: got changes of what the mapping does not have")
    return {
        name: _changed_value(mapping[name], part, changes)
        for name, changes in changes_by_name.items()
    }


def _changed_value(value: Any, part: Part, changes: Mapping[tuple[str, ...], Any]) -> Any:
    """Returns a value with changes at paths below it; the empty path replaces it as a whole."""
    if () not in changes:
        return changed_record(value, part, changes)
    if len(changes) > 1:
        raise ValueError("got changes of a block and of keys in it")
    return _checked_value(changes[()], part)


def _checked_value(value: Any, part: Part) -> Any:
    """Returns a checked value in the type of its field. ValueError: it is None or does not fit."""
    if value is None:
        raise ValueError("got no value")
    plain = _plain_copy(value, "", 0, part)
    for fault in _faults(plain, part, "", part):
        raise fault.error
    return _field_value(plain, part, "")


def _plain_copy(value: Any, path: str, depth: int, file: Part) -> Any:
    """Returns a copy of nested data with plain types; refuses what is not plain or not finite.

    path: where the value stands in the file.
    depth: number of blocks and lists around it.
    file: record of the file, whose parts say what is allowed.
    """
    if depth > DEEPEST:
        raise SceneError(path, f"got more than {DEEPEST} nested blocks, expected at most that many")
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                raise SceneError(path, f"got the key {shown(key)}, expected text as a key")
        return {
            key: _plain_copy(item, key_path(path, key), depth + 1, file)
            for key, item in value.items()
        }
    if hasattr(value, "tolist"):  # numpy numbers and arrays
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [_plain_copy(item, f"{path}[{i}]", depth + 1, file) for i, item in enumerate(value)]
    if value is None or isinstance(value, bool | str | int):
        return value
    number = float(value) if isinstance(value, numbers.Real) else value
    if isinstance(number, float) and math.isfinite(number):
        return number
    allowed = getattr(part_at(file, path), "allowed", "another value")
    raise SceneError(path, f"got {shown(number)}, expected {allowed}")


_IMPOSSIBLE_NAME, _UNKNOWN, _WRONG_TYPE, _OUT_OF_RANGE, _MISSING = range(5)


class Fault(NamedTuple):
    """A fault of the data."""

    priority: int  # the lowest is the gravest
    error: SceneError


def fits(value: Any, part: Part) -> bool:
    """Whether a value is one that a key takes.

    part: field of a record, which says what the key takes.
    """
    return not any(_faults(value, part, "", part))


def _faults(value: Any, part: Part, path: str, file: Part) -> Iterator[Fault]:
    """Yields the faults of a value and of all that it contains.

    part: the field that it should fit.
    path: where it stands in the file, for the messages.
    file: record of the whole file, whose other keys may be meant by an unknown one.
    """
    if part.kind in ("own", "any") or (value is None and part.nullable):
        return
    if part.kind == "block" and isinstance(value, Mapping):
        yield from _block_faults(value, part, path, file)
    elif part.kind == "mapping" and isinstance(value, Mapping):
        if len(value) < part.key.least:
            yield _misfit(_OUT_OF_RANGE, value, part, path)
        for name, item in value.items():
            if not _is_name(name, part):
                problem = f"got the name {shown(name)}, expected {part.allowed}"
                yield Fault(_IMPOSSIBLE_NAME, SceneError(path, problem))
            yield from _faults(item, part.item, key_path(path, name), file)
    elif part.kind == "list" and isinstance(value, list):
        if not part.key.least <= len(value) <= (part.key.most or math.inf):
            yield _misfit(_OUT_OF_RANGE, value, part, path)
        for i, item in enumerate(value):
            yield from _faults(item, part.item, f"{path}[{i}]", file)
    elif not _has_kind(value, part):
        yield _misfit(_WRONG_TYPE, value, part, path)
    elif not _is_permitted(value, part):
        yield _misfit(_OUT_OF_RANGE, value, part, path)


def _misfit(priority: int, value: Any, part: Part, path: str) -> Fault:
    """Returns the fault of a value that a part does not take.

    path: where the value stands in the file.
    """
    _, _, key = path.rpartition(".")
    return Fault(priority, SceneError(path, misfit_words(value, part, key)))


def misfit_words(value: Any, part: Part, key: str = "") -> str:
    """Returns the problem of a value that a part does not take: `got -1, expected a number > 0`.

    It also names the value, unit or choice that was probably meant.

    key: the name of the key, without its block.
    """
    allowed = part.allowed
    if part.kind == "block" and part.example:
        allowed = f"a block, such as {part.example}"
    return f"got {shown(value)}{_hint(value, part)}, expected {allowed}{_note(value, part, key)}"


def option_misfit(text: str, part: Part, key: str = "") -> str:
    """Returns the problem of an option whose text its part does not take, as `misfit_words`.

    key: the name of the key that the option sets, without its block.
    """
    try:
        note = _note(float(text), part, key)
    except ValueError:
        note = _in_brackets(part.unit, number_hint(text.strip(), part.unit))
    return f"got {text!r}, expected {part.allowed}{note}"


def _note(value: Any, part: Part, key: str) -> str:
    """Returns the unit of a part and the unit or choice that was probably meant, for a message.

    It is "" if there is neither.

    key: the name of the key, without its block.
    """
    number = part.item if part.kind == "list" else part
    if part.kind == "choice":
        return did_you_mean(value, part.key.choices)
    if number.kind not in ("integer", "number"):
        return ""
    meant = ""
    if part.kind == "list" and isinstance(value, list) and len(value) > (part.key.most or math.inf):
        meant = "write decimals with a point, not a comma"
    if number.kind == "number" and _is_number(value):
        meant = meant_words(value, number.unit, lambda other: _is_permitted(other, number), key)
    return _in_brackets(number.unit, meant)


def _in_brackets(unit: str, advice: str) -> str:
    """Returns a unit and advice on a value in brackets; "" if there is neither."""
    unit = "" if unit in ("1", "-", "as the value") else unit
    words = "; ".join(filter(None, (unit, advice)))
    return f" ({words})" if words else ""


FORMER_KEYS = {
    "wear.ball_track": "balls always wear evenly (spread); delete the key",
    "friction.film.pressure_exponent": "give friction.film.wear_table",
    "friction.film.reference_pressure_GPa": "give friction.film.wear_table",
}
"""Keys of earlier versions, and what to do."""


def _block_faults(values: Mapping[str, Any], block: Part, path: str, file: Part) -> Iterator[Fault]:
    """Yields unknown and missing keys of a block, and what is wrong with its values.

    Beside an unknown key, no missing one is reported: the unknown key may be that one, mistyped.

    values: those of the block, by its keys.
    path: of the block in the file.
    file: record of the whole file, as for `_faults`.
    """
    unknown = [name for name in values if name not in block.below]
    for name in unknown:
        problem = f"got an unknown key; {_advice(name, values, block, file)}"
        if (whole_key := key_path(path, name)) in FORMER_KEYS:
            problem = f"got a key that no longer exists, expected none: {FORMER_KEYS[whole_key]}"
        yield Fault(_UNKNOWN, SceneError(key_path(path, short(name)), problem))
    for name, field in block.below.items():
        if field.required and name not in values and not unknown:  # not a mistyped one
            is_block_with_example = field.kind in ("block", "mapping") and field.example
            allowed = "a block" if is_block_with_example else field.allowed
            suggestion = f", such as {field.example}" if field.example else ""
            problem = f"got nothing, expected {allowed}{suggestion}"
            yield Fault(_MISSING, SceneError(key_path(path, name), problem))
    for name, value in values.items():
        if name in block.below:
            yield from _faults(value, block.below[name], key_path(path, name), file)


def _advice(unknown: str, values: Mapping[str, Any], block: Part, file: Part) -> str:
    """Returns advice on an unknown key: a similar key of its block or of another one.

    values: those of the block in which the key stands.
    file: record of the whole file.
    """
    if unknown.isdigit():  # {poisson_ratio: 0,3}
        return "write decimals with a point, not a comma"
    if key_in_its_unit := _in_its_unit(unknown, values[unknown], block):
        return f"write {key_in_its_unit}"
    if name := synonym(unknown, block.below):
        return f"did you mean {name}"
    similar = difflib.get_close_matches(unknown, block.below, n=2)
    if not similar and len(unknown) > 2:
        similar = [name for name in block.below if unknown in name]
    similar = similar or _similar_keys(unknown, file)
    if similar:
        return f"did you mean {' or '.join(similar)}"
    unused = [name for name in block.below if name not in values]
    return f"expected one of {', '.join(unused or block.below)}"


def _similar_keys(unknown: str, file: Part) -> list[str]:
    """Returns the whole keys of a file whose last part is most like an unknown key.

    Of several with the same last part, only those in the fewest blocks count. There may be none.
    """
    paths_by_name: dict[str, list[str]] = {}
    for path, part in keys(file):
        if part.kind != "block" and ".NAME" not in path and "[]" not in path:
            paths_by_name.setdefault(path.rpartition(".")[2], []).append(path)
    similar = difflib.get_close_matches(unknown, paths_by_name, n=1, cutoff=0.8)
    if not similar:
        return []
    paths = paths_by_name[similar[0]]
    least_depth = min(path.count(".") for path in paths)
    return [path for path in paths if path.count(".") == least_depth]


_SHORTEST_STEM = 3  # characters of a key without its unit, by which another is found


def _in_its_unit(unknown: str, value: Any, block: Part) -> str:
    """Returns the key that is meant by one in another unit, with its value; "" if there is none.

    For `preload_lbf: 30` it is `preload_N: 133.45`, for `preload_lbf: x` it is `preload_N, in N`.
    """
    for underscore in re.finditer("_", unknown):
        stem = unknown[: underscore.start()]
        typed_unit = unknown[underscore.end() :].replace("_", "/")
        if len(stem) < _SHORTEST_STEM:
            continue
        for name, part in block.below.items():
            if not _is_stem_with_unit(name, stem, part.unit):
                continue
            if converted(1.0, typed_unit, part.unit) is None:
                continue
            if not _is_number(value):
                return f"{name}, in {part.unit}"
            return f"{name}: {converted(float(value), typed_unit, part.unit):.5g}"
    return ""


def _is_stem_with_unit(name: str, stem: str, unit: str) -> bool:
    """Whether a key ends with a stem and its unit, as `preload_N` with `preload` and `N`."""
    _, separator, suffix = name.rpartition(f"{stem}_")
    return bool(separator) and converted(1.0, suffix.replace("_", "/"), unit) == 1.0


def _is_name(name: str, mapping: Part) -> bool:
    """Whether a mapping allows an item of this name."""
    if mapping.key.names:
        return name in mapping.key.names
    return mapping.item.kind == "any" or bool(re.search(NAME, name))


def _has_kind(value: Any, part: Part) -> bool:
    """Whether a value has the type of a part; whether it is permitted is another question.

    A choice is of any type, because only a permitted value is one.
    """
    if part.kind in ("choice", "choice_or_number"):
        return True
    if part.kind == "integer":
        return _is_number(value) and value == value // 1  # a whole number, also as 3.0
    if part.kind == "number" or (part.kind == "list" and part.key.single):
        return _is_number(value)
    if part.kind == "boolean":
        return isinstance(value, bool)
    return part.kind == "text" and isinstance(value, str)


def _is_number(value: Any) -> bool:
    """Whether a value is a number; true and false are none."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_permitted(value: Any, part: Part) -> bool:
    """Whether a value of the right type is a choice, in the range, or fits the pattern."""
    key = part.key
    if part.kind == "boolean" or value in (*key.choices, *key.synonyms):
        return True
    if part.kind == "text":
        return len(value) <= (key.longest or math.inf) and bool(re.search(key.pattern, value))
    if part.kind == "choice" or not _is_number(value) or abs(value) > _LARGEST:
        return False
    for name, end in key.bounds.items():
        is_within, _ = COMPARISONS[name]
        if not is_within(value, end):
            return False
    return True


def _hint(value: Any, part: Part) -> str:
    """Returns how to write a text that was meant as a number, or a name that YAML reads as one.

    It is "" where a value is neither.
    """
    if part.key.pattern == NAME and _is_number(value) and re.search(NAME, str(value)):
        return f', a number, not text (write "{value}")'
    kind = part.item.kind if part.key.single else part.kind
    if not isinstance(value, str) or kind not in ("integer", "number"):
        return ""
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        hint = number_hint(value, part.item.unit if part.key.single else part.unit)
        in_brackets = f" ({hint})" if hint else ""
        return f", text, not a number{in_brackets}"
    is_whole = number == int(number) and abs(number) < 1e9
    return f", text, not a number (write {int(number) if is_whole else yaml_number(number)})"


# building


def build_record(record_type: type[R], plain: Mapping[str, Any], path: str = "") -> R:
    """Builds a record from checked data; whole numbers become floats where a number is meant.

    SceneError where the record itself refuses its values.
    """
    values = {
        part.field: _field_value(plain[name], part, key_path(path, name))
        for name, part in file_part(record_type).below.items()
        if name in plain and (plain[name] is not None or part.required)
    }
    return _call_maker(path, record_type, **values)


def _call_maker(path: str, make: Callable[..., Any], *values: Any, **fields: Any) -> Any:
    """Returns what the maker of a record makes; a SceneError or ValueError names the block.

    path: of the block, with which the key of the SceneError begins.
    make: class of the record, or its `from_plain`, which is called with values and fields.
    """
    try:
        return make(*values, **fields)
    except SceneError as error:
        key = ".".join(filter(None, (path, error.key)))
        raise SceneError(key, error.problem, error.involved) from None
    except ValueError as error:
        raise SceneError(path, str(error)) from None


def _field_value(value: Any, part: Part, path: str) -> Any:
    """Returns a checked value in the type of its field: a record, a tuple, a float and so on.

    path: where it stands, for the errors of records.
    """
    if value is None or part.kind == "any":
        return value
    if part.kind == "block":
        return build_record(part.type, value, path)
    if part.kind == "own":
        return _call_maker(path, part.type.from_plain, value)
    if part.kind == "mapping":
        return {
            name: _field_value(item, part.item, key_path(path, name))
            for name, item in value.items()
        }
    if part.kind == "list":
        values = value if isinstance(value, list) else [value]
        return tuple(_field_value(item, part.item, f"{path}[{i}]") for i, item in enumerate(values))
    if part.kind == "integer":
        return int(value)
    if part.kind == "choice":
        return part.key.synonyms.get(value, value)
    return float(value) if _is_number(value) else value
