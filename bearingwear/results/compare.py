"""What differs between two result files of one kind, as text."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from bearingwear.measures import plain
from bearingwear.results.kinds import kind_of
from bearingwear.results.netcdf import CaseFileError, opened
from bearingwear.results.units import display
from bearingwear.results.variables import CASE, DIAGNOSTICS, LIFE
from bearingwear.scene.checking.errors import leaves

SAID_OF_RESULTS = ("fidelity", "modelled", "settled")
"""Attributes that say what was solved; the others say how a file was made."""

_VARIABLES = CASE | LIFE
_SHOWN = {name for name, variable in _VARIABLES.items() if variable.label} - DIAGNOSTICS
"""Results that have a label for a person."""

WIDEST = 60
"""Characters of a text that are shown."""


class Difference(NamedTuple):
    """One variable, and where its values are furthest apart."""

    name: str
    units: str
    first: str
    second: str
    relative: float
    place: str


class Differences(NamedTuple):
    """Differences between two files, as short texts from each."""

    scene: dict[str, tuple[str, str]]
    model: dict[str, tuple[str, str]]
    making: dict[str, tuple[str, str]]
    variables: list[Difference]
    compared: int  # number of variables

    @property
    def same(self) -> bool:
        return not (self.scene or self.model or self.variables)


def difference(
    first: str | os.PathLike[str], second: str | os.PathLike[str], tolerance: float = 0.0
) -> tuple[str, bool]:
    """Compare two result files.

    tolerance: numbers count as the same where they are no further apart than this fraction of the
        largest magnitude that the variable has in either file.

    Returns `text`: results that differ, those that a person asks for first; keys of the scene; then
        how well each was solved and how it was made.
    Returns `same`: whether scene, model and variables are the same. How a file was made (versions,
        source hash, solver statistics) is shown where it differs, but does not count.

    CaseFileError where a file cannot be read, or the files are of different kinds.
    """
    with opened(first) as a, opened(second) as b:
        kind, other_kind = kind_of(a), kind_of(b)
        if kind != other_kind:
            raise CaseFileError(
                f"{os.fspath(second)}: got the kinds {other_kind} and {kind}, expected two files "
                "of the same kind"
            )
        found = file_differences(a, b, tolerance)
    lines = [f"A {os.fspath(first)}", f"B {os.fspath(second)}", "", *_lines(found)]
    tolerance_text = f" to within {tolerance:g} of their largest values" if tolerance else ""
    lines.append(
        f"same {kind}: the scene and all {found.compared} variables agree{tolerance_text}"
        if found.same
        else f"{len(found.scene)} keys of the scene and {len(found.variables)} of "
        f"{found.compared} variables differ"
    )
    return "\n".join(line.rstrip() for line in lines), found.same


def file_differences(a: Any, b: Any, tolerance: float = 0.0) -> Differences:
    """Differences of two open files."""
    scenes = [leaves(json.loads(getattr(file, "scene", "{}"))) for file in (a, b)]
    attributes = _texts(*map(_attributes, (a, b)))
    attributes.pop("scene", None)
    model = {k: attributes.pop(k) for k in SAID_OF_RESULTS if k in attributes}
    if "modelled" in model:  # of many sentences those that differ
        one, other = (json.loads(getattr(file, "modelled", "[]")) for file in (a, b))
        apart = [t for t in one if t not in other], [t for t in other if t not in one]
        model["modelled"] = (_cut("; ".join(apart[0])), _cut("; ".join(apart[1])))
    names = [*a.variables, *(name for name in b.variables if name not in a.variables)]
    variables = [d for d in (_variable_difference(name, a, b, tolerance) for name in names) if d]
    variables.sort(key=lambda d: -d.relative)
    return Differences(
        scene=_texts(*scenes),
        model=model,
        making=attributes,
        variables=variables,
        compared=len(names),
    )


def _lines(found: Differences) -> list[str]:
    """Lines in the order of interest: results, why they differ, and how they were made."""
    lines: list[str] = []
    results = [d for d in found.variables if d.name not in DIAGNOSTICS]
    shown = [d for d in results if d.name in _SHOWN]
    lines += _variables("result", shown)
    lines += _texts_of("scene", found.scene) + _texts_of("model", found.model)
    lines += _variables("further result", [d for d in results if d.name not in _SHOWN])
    lines += _variables(
        "accuracy of the solution", [d for d in found.variables if d.name in DIAGNOSTICS]
    )
    return lines + _texts_of("provenance (ignored)", found.making)


def _texts_of(title: str, texts: dict[str, tuple[str, str]]) -> list[str]:
    rows = [(key, *pair) for key, pair in texts.items()]
    return _table([(title, "A", "B"), *rows]) if rows else []


def _variables(title: str, differences: Sequence[Difference]) -> list[str]:
    rows = [
        (d.name, d.units, d.first, d.second, _percent(d.relative), d.place) for d in differences
    ]
    return _table([(title, "unit", "A", "B", "relative", "where"), *rows]) if rows else []


def _texts(a: dict[str, Any], b: dict[str, Any]) -> dict[str, tuple[str, str]]:
    """Differences of two blocks, as short texts; a dash where one has nothing."""
    keys = [*a, *(key for key in b if key not in a)]
    return {k: (_cut(a.get(k)), _cut(b.get(k))) for k in keys if a.get(k) != b.get(k)}


def _attributes(file: Any) -> dict[str, Any]:
    """Global attributes; several values are a list, as arrays are not the same or not."""
    return {name: np.asarray(file.getncattr(name)).tolist() for name in file.ncattrs()}


def _cut(value: Any) -> str:
    text = "-" if value is None else " ".join(str(value).split())
    return text if len(text) <= WIDEST else f"{text[: WIDEST - 3]}..."


def _variable_difference(name: str, a: Any, b: Any, tolerance: float) -> Difference | None:
    """How a variable differs; differences without a number count as infinite."""
    if name not in a.variables or name not in b.variables:
        first, second = ("there" if name in file.variables else "-" for file in (a, b))
        return Difference(name, "", first, second, math.inf, "")
    one, other = a[name], b[name]
    unit, other_unit = (str(getattr(variable, "units", "")) for variable in (one, other))
    if unit != other_unit:
        return Difference(name, "", unit, other_unit, math.inf, "units")
    if one.dimensions != other.dimensions or one.shape != other.shape:
        return Difference(name, unit, _sizes(one), _sizes(other), math.inf, "sizes")
    if str in (one.dtype, other.dtype):
        x, y = one[...], other[...]
        apart, largest = np.asarray(x != y), 0.0
    else:
        x, y = (np.ma.filled(np.ma.asarray(v[...], dtype=float), np.nan) for v in (one, other))
        missing = np.isnan(x) != np.isnan(y)
        with np.errstate(invalid="ignore"):  # infinite in both
            apart = np.where(missing, math.inf, np.nan_to_num(np.abs(x - y)))
        largest = float(np.max(np.nan_to_num(np.abs([x, y])), initial=0.0))
    if not apart.any():
        return None
    flags = str(getattr(one, "flag_meanings", "")).split()
    index = np.unravel_index(int(np.argmax(apart)), apart.shape)
    is_number = largest > 0.0 and not flags
    relative = float(apart[index]) / largest if is_number else math.inf
    if relative <= tolerance:
        return None
    pair = [np.asarray(values)[index] for values in (x, y)]
    if is_number:
        known = _VARIABLES.get(name)
        shown = display(unit, pair, shown=known.shown if known and known.units == unit else "")
        pair, unit = [shown.of(value) for value in pair], shown.unit
    first, second = (_shown(value, flags) for value in pair)
    return Difference(name, unit, first, second, relative, _place(a, one.dimensions, index))


def _sizes(variable: Any) -> str:
    pairs = zip(variable.dimensions, variable.shape, strict=True)
    return ", ".join(f"{dim} {size}" for dim, size in pairs) or "one value"


def _shown(value: Any, flags: list[str]) -> str:
    if isinstance(value, str):
        return _cut(value)
    if np.isnan(value):
        return "missing"
    return flags[int(value)] if flags and 0 <= value < len(flags) else f"{value:.6g}"


def _place(file: Any, dimensions: tuple[str, ...], index: tuple[Any, ...]) -> str:
    """The coordinates of an element, in words."""
    parts = []
    for dim, number in zip(dimensions, index, strict=True):
        if file.dimensions[dim].size == 1:
            continue
        if dim not in file.variables:
            parts.append(f"{dim} {number}")
            continue
        flags = str(getattr(file[dim], "flag_meanings", "")).split()
        parts.append(f"{dim} {_shown(np.ma.filled(file[dim][number], np.nan), flags)}")
    return ", ".join(parts)


def _percent(relative: float) -> str:
    return "-" if math.isinf(relative) else f"{plain(100.0 * relative)} %"


def _table(rows: Sequence[tuple[str, ...]]) -> list[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ("  ".join(t.ljust(w) for t, w in zip(row, widths, strict=True)) for row in rows)
    return [*(f"  {line}" for line in lines), ""]
