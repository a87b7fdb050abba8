"""Rows of result sheets, from an open result file and the table of variables."""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from bearingwear.document.document import Block, Row, row_of
from bearingwear.measures import ENDS, Measure
from bearingwear.results.units import scale_of
from bearingwear.scene.coefficients import is_wear_bound
from bearingwear.scene.scene import COUNTS

COUNTED_WORDS = dict(zip(COUNTS, ("the balls alone", "balls and races"), strict=True))
"""Words for each value of `wear.counts`."""


def stored_scene(file: Any) -> Mapping[str, Any]:
    """Returns the scene of an open file as plain data; it is shared, so do not write to it."""
    return _parsed_scene(str(getattr(file, "scene", "{}")))


@functools.lru_cache(maxsize=4)  # each block of a sheet reads the scene
def _parsed_scene(text: str) -> Mapping[str, Any]:
    """Returns the scene in a JSON text."""
    return json.loads(text)


def counted_words(scene: Mapping[str, Any]) -> str:
    """Returns the words for the parts whose wear a scene counts."""
    return COUNTED_WORDS[scene.get("wear", {}).get("counts", COUNTS[-1])]


FILM_TESTS = (
    "Film lives disagree with published tests: both predictions that can be checked fail, one by a "
    "factor of 40 or more (docs/film_tests.md)."
)
TABLE_TESTS = (
    "Film lives disagree with published tests: a bearing lasted at least 28 times as long as "
    "computed, and the effect of temperature is too large by a factor of 1.6 (docs/film_tests.md)."
)
"""The sentence in place of `FILM_TESTS` for films whose wear follows a table of lives."""

LOWER_BOUND = (
    "K_s/H of starved oil is an upper bound, so this life and its interval are lower bounds."
)


def film_lines(scene: Mapping[str, Any]) -> tuple[str, ...]:
    """Returns the sentence on tests of film lives, for a scene with a film and no calibration."""
    if scene.get("calibrated") or not _has_film(scene):
        return ()
    has_table = bool((scene["friction"].get("film") or {}).get("wear_table"))
    return (TABLE_TESTS if has_table else FILM_TESTS,)


def bound_lines(scene: Mapping[str, Any]) -> tuple[str, ...]:
    """Returns the sentence on lives that are lower bounds; empty unless K_s/H is an upper bound."""
    if "materials" not in scene or scene.get("calibrated") or _has_film(scene):
        return ()
    return (LOWER_BOUND,) if is_wear_bound(scene) else ()


def caveat_lines(scene: Mapping[str, Any]) -> tuple[str, ...]:
    """Returns the sentences on the limited accuracy of the lives of a scene."""
    return (*film_lines(scene), *bound_lines(scene))


def _has_film(scene: Mapping[str, Any]) -> bool:
    """Returns whether the contact of balls and races, or any material, has a film."""
    coated = [scene.get("friction", {}), *scene.get("materials", {}).values()]
    return any(block.get("film") for block in coated)


def variable_values(file: Any, name: str) -> np.ndarray:
    """Returns the values of a variable of an open file as floats; NaN for missing values.

    Without the variable, it is an array of no dimensions with NaN.
    """
    if name not in file.variables:
        return np.array(np.nan)
    return np.ma.filled(np.ma.asarray(file[name][...], dtype=float), np.nan)


def flag_name(file: Any, name: str) -> str:
    """Returns the name of the flag that a variable of an open file has as its single value."""
    return str(file[name].flag_meanings.split()[int(file[name][...])])


def without_empty_rows(block: Block) -> Block:
    """Returns a block without the rows whose values are all NaN."""
    rows = tuple(row for row in block.rows if not all(_is_nan(value) for value in row.values))
    return replace(block, rows=rows)


def _is_nan(value: Any) -> bool:
    """Returns whether a cell is a number that was not computed."""
    return isinstance(value, float) and math.isnan(value)


def blocks_in_one_unit(blocks: Iterable[Block]) -> list[Block]:
    """Returns the blocks with each quantity in one unit, the largest that it has in any block."""
    blocks = list(blocks)
    # by quantity and unit of files; the largest unit has the smallest factor from that of files
    largest_units: dict[tuple[str, str], tuple[float, str]] = {}
    for row in (row for block in blocks for row in block.rows):
        file_unit, factor = scale_of(row.unit)
        key = row.name or row.label, file_unit
        unit = (factor, row.unit)
        largest_units[key] = min(largest_units.get(key, unit), unit)

    def in_largest_unit(row: Row) -> Row:
        """Returns a row in the largest unit of its quantity."""
        file_unit, factor = scale_of(row.unit)
        new_factor, new_unit = largest_units[row.name or row.label, file_unit]
        if new_unit == row.unit:
            return row
        return _converted_row(row, new_unit, new_factor, factor)

    return [
        replace(block, rows=tuple(in_largest_unit(row) for row in block.rows)) for block in blocks
    ]


def _converted_row(row: Row, unit: str, factor: float, old_factor: float) -> Row:
    """Returns a row in another unit.

    factor, old_factor: from the unit of files to the new unit and to that of the row.
    """

    def converted(number: float | None) -> float | None:
        """Returns a number in the new unit; None stays None."""
        return None if number is None else number * factor / old_factor

    return row._replace(
        unit=unit,
        values=tuple(converted(x) if isinstance(x, float) else x for x in row.values),
        limit=converted(row.limit),
        limits=tuple(converted(limit) for limit in row.limits),
    )


def side_by_side(bearings: Sequence[Sequence[Block]]) -> list[Block]:
    """Returns the blocks of several bearings as one list, with columns for each bearing.

    bearings: the blocks of each bearing; all have the same blocks and rows.
    """
    return [_merged_block(blocks) for blocks in zip(*bearings, strict=True)]


def _merged_block(blocks: Sequence[Block]) -> Block:
    """Returns one block for several bearings, whose columns name the bearing.

    blocks: that of each bearing.
    """
    columns = tuple(
        f"{k}: {column}" if column else f"bearing {k}"
        for k, block in enumerate(blocks, 1)
        for column in block.columns or ("",)
    )
    rows = zip(*(block.rows for block in blocks), strict=True)
    return replace(
        blocks[0],
        columns=columns,
        rows=tuple(_merged_row(bearing_rows) for bearing_rows in rows),
        lines=tuple(dict.fromkeys(line for block in blocks for line in block.lines)),
    )


def _merged_row(rows: Sequence[Row]) -> Row:
    """Returns one row for several bearings, in one unit and with the notes of all.

    It has a single limit if all limits agree to nine digits, otherwise a limit for each value.

    rows: that of each bearing.
    """
    rescaled = blocks_in_one_unit([Block("", rows=tuple(rows))])[0].rows
    limit_texts = {"" if row.limit is None else f"{row.limit:.9g}" for row in rescaled}
    notes = [f"{row.note} by bearing {k}" for k, row in enumerate(rows, 1) if row.note]
    merged = rescaled[0]._replace(
        values=tuple(value for row in rescaled for value in row.values), note=", ".join(notes)
    )
    if len(limit_texts) == 1:
        return merged
    limits = tuple(row.limit for row in rescaled for _ in row.values)
    return merged._replace(limit=None, limits=limits)


def mean(values: np.ndarray) -> float:
    """Returns the mean of an array of any shape; NaN if it is empty."""
    return float(values.mean()) if values.size else float("nan")


def mean_rows(
    file: Any, names: Iterable[str], limits: Mapping[str, float] = MappingProxyType({})
) -> tuple[Row, ...]:
    """Returns a row with the mean of the values of each variable that the file contains.

    limits: by variable [units of the file].
    """
    return tuple(
        row_of(name, [mean(variable_values(file, name))], limits.get(name))
        for name in names
        if name in file.variables
    )


class _Criterion(NamedTuple):
    """An end-of-life criterion of a scene, for one of the variables of its measure."""

    measure: Measure
    limit: float  # as in the key of the scene
    preload_N: float  # initial

    @property
    def file_limit(self) -> float:
        """Returns the limit in the unit of the variable in files."""
        return self.measure.file_limit(self.limit, self.preload_N)

    def is_violated(self, numbers: np.ndarray) -> bool:
        """Returns whether the worst of the variable's values [SI] is beyond the limit."""
        return self.measure.is_passed(self.measure.value(numbers, self.preload_N), self.limit)


def _criteria(file: Any) -> dict[str, _Criterion]:
    """Returns the end-of-life criteria of the scene in a file, by the names of their variables."""
    scene = stored_scene(file)
    limits = scene.get("wear", {}).get("end_of_life") or {}
    preload_N = scene.get("operation", {}).get("preload_N", 0.0)
    return {
        variable: _Criterion(measure=measure, limit=limits[key], preload_N=preload_N)
        for key, measure in ENDS.items()
        if limits.get(key) and (preload_N or not measure.over_preload)
        for variable in measure.variables
    }


def variable_limits(file: Any) -> dict[str, float]:
    """Returns the limits [units of the file] of the variables that may end a life, by name."""
    return {name: criterion.file_limit for name, criterion in _criteria(file).items()}


def rows_with_violations(rows: Iterable[Row], file: Any) -> tuple[Row, ...]:
    """Returns the rows, with a note on each whose value in the file violates its criterion."""
    criteria = _criteria(file)
    return tuple(
        row._replace(note="violated")
        if row.limit is not None and criteria[row.name].is_violated(variable_values(file, row.name))
        else row
        for row in rows
    )
