"""What differs between two result files of one kind, as text."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from bearingwear.results.kinds import kind_of
from bearingwear.results.netcdf import CaseFileError, opened
from bearingwear.scene.keys import leaves

SAID_OF_RESULTS = ("fidelity", "modelled", "settled")
"""Attributes that say what was solved; the others say how a file was made."""

WIDEST = 40
"""Characters of a text that are shown."""


class Difference(NamedTuple):
    """Of one variable: where its values are furthest apart."""

    name: str
    units: str
    first: str
    second: str
    relative: float
    place: str


class Differences(NamedTuple):
    """Of two files: what is in each of them, as short texts, wherever they differ."""

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

    Parameters
    ----------
    first, second : path
    tolerance : float
        Numbers count as the same where they are no further apart than this fraction of the largest
        magnitude that the variable has in either file.

    Returns
    -------
    text : str
        Keys of the scene, attributes and variables that differ.
    same : bool
        Whether scene, model and variables are the same. How a file was made (versions, source
        hash, solver statistics) is shown where it differs, but does not count.

    Raises
    ------
    CaseFileError
        A file that cannot be read, or files of different kinds.
    """
    with opened(first) as a, opened(second) as b:
        kind, other_kind = kind_of(a), kind_of(b)
        if kind != other_kind:
            raise CaseFileError(
                f"{os.fspath(second)}: given a {other_kind} beside a {kind}; allowed two files "
                "of one kind"
            )
        found = _differences(a, b, tolerance)
    lines = [f"A {os.fspath(first)}", f"B {os.fspath(second)}", "", *_lines(found)]
    within = f" to {tolerance:g} of its largest value" if tolerance else ""
    lines.append(
        f"same {kind}: the scene, and all {found.compared} variables{within}"
        if found.same
        else f"{len(found.scene)} keys of the scene and {len(found.variables)} of "
        f"{found.compared} variables differ"
    )
    return "\n".join(line.rstrip() for line in lines), found.same


def _differences(a: Any, b: Any, tolerance: float) -> Differences:
    scenes = [leaves(json.loads(getattr(file, "scene", "{}"))) for file in (a, b)]
    attributes = _texts(*({k: file.getncattr(k) for k in file.ncattrs()} for file in (a, b)))
    attributes.pop("scene", None)
    model = {k: attributes.pop(k) for k in SAID_OF_RESULTS if k in attributes}
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
    lines: list[str] = []
    for title, texts in (
        ("scene", found.scene),
        ("model", found.model),
        ("how it was made (does not count)", found.making),
    ):
        if texts:
            lines += _table([(title, "A", "B"), *((k, *both) for k, both in texts.items())])
    if found.variables:
        rows = [("variable", "unit", "A", "B", "relative", "where")]
        rows += [
            (d.name, d.units, d.first, d.second, _percent(d.relative), d.place)
            for d in found.variables
        ]
        lines += _table(rows)
    return lines


def _texts(a: dict[str, Any], b: dict[str, Any]) -> dict[str, tuple[str, str]]:
    """What differs between two blocks, as short texts; a dash where one has nothing."""
    keys = [*a, *(key for key in b if key not in a)]
    return {k: (_cut(a.get(k)), _cut(b.get(k))) for k in keys if a.get(k) != b.get(k)}


def _cut(value: Any) -> str:
    text = "-" if value is None else " ".join(str(value).split())
    return text if len(text) <= WIDEST else f"{text[: WIDEST - 3]}..."


def _variable_difference(name: str, a: Any, b: Any, tolerance: float) -> Difference | None:
    """How a variable differs; what cannot be put in numbers counts as infinitely far apart."""
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
    first, second = (_shown(np.asarray(values)[index], flags) for values in (x, y))
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
    return "-" if math.isinf(relative) else f"{100.0 * relative:.3g} %"


def _table(rows: Sequence[tuple[str, ...]]) -> list[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ("  ".join(t.ljust(w) for t, w in zip(row, widths, strict=True)) for row in rows)
    return [*(f"  {line}" for line in lines), ""]
