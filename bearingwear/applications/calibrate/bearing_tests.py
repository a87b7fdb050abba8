"""Tests of bearings from a CSV file: the conditions and the result of each."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from bearingwear import Scene, SceneError
from bearingwear.applications.calibrate.seen import SEEN, SEEN_AS, SEEN_LOSS, SEEN_PRELOAD
from bearingwear.results.netcdf import CaseFileError
from bearingwear.scene.checking.errors import short
from bearingwear.scene.checking.strict_yaml import data_of, text_of

_AFTER, _COUNT, _ERROR = "after_h", "bearings", "error_percent"
TEST_COLUMNS = (*SEEN, _AFTER, _COUNT, _ERROR)
"""Every column that is no key of the scene."""


@dataclass(frozen=True, kw_only=True)
class BearingTest:
    """A test of one or several bearings with one result: a row of the file."""

    row: int  # number of its line in the file, from 1
    scene: Scene  # under the conditions of the test
    seen: str  # kind of result, one of `SEEN`
    value: float  # result, in the unit of its column
    after: float  # time of the result; equal to `value` except for a loss or a preload [h]
    count: int  # number of bearings with this result
    error: float  # standard error of the measurement, relative to the result [1]


def bearing_tests(path: str | Path, scene: Scene) -> list[BearingTest]:
    """Reads the tests in a CSV file.

    Commas, semicolons or tabs separate its columns; with semicolons or tabs, numbers may have
    decimal commas, as Excel writes them in Europe. The first line names the columns: keys of the
    scene (an empty cell leaves the scene's value) and those of `TEST_COLUMNS`. A row fills one of
    `SEEN`. Empty lines are left out.

    CaseFileError: names file, row and column, what was given and what is allowed.
    """
    names, *rows = _table_lines(path)
    if not rows:
        raise CaseFileError(f"{path}: got no tests, expected a header and one row per test")
    for name in names.cells:
        if names.cells.count(name) > 1:
            raise CaseFileError(f"{path}: got the column {name!r} twice, expected it once")
        if name not in TEST_COLUMNS and "." not in name:
            allowed = f"a scene key (operation.preload_N), or one of {', '.join(TEST_COLUMNS)}"
            raise CaseFileError(f"{path}: got the column {short(name)!r}, expected {allowed}")
    tests = []
    for number, cells in rows:
        if len(cells) > len(names.cells):
            raise CaseFileError(
                f"{path}: row {number}: got {len(cells)} cells, expected {len(names.cells)}"
            )
        # a row may end before its last columns, whose cells are empty then
        filled_cells = {name: cell for name, cell in zip(names.cells, cells, strict=False) if cell}
        tests.append(_Row(str(path), number, filled_cells).test(scene))
    return tests


class _TableLine(NamedTuple):
    """A line of a CSV file that is not empty."""

    number: int  # from 1
    cells: list[str]  # without blanks around them


def _table_lines(path: str | Path) -> list[_TableLine]:
    """Reads the lines of a CSV file, the header first, with decimal points in all numbers.

    CaseFileError: the file cannot be read, or is empty.
    """
    text = text_of(path, "CSV").lstrip("\ufeff")
    header = text.partition("\n")[0]
    separator = next((mark for mark in ",;\t" if mark in header), ",")
    reader = csv.reader(io.StringIO(text), skipinitialspace=True, delimiter=separator)
    lines = []
    for row in reader:
        cells = [cell.strip() for cell in row]
        if separator != ",":
            cells = [_with_decimal_point(cell) for cell in cells]
        if any(cells):
            lines.append(_TableLine(reader.line_num, cells))
    if not lines:
        raise CaseFileError(f"{path}: got no tests, expected a header and one row per test")
    return lines


def _with_decimal_point(cell: str) -> str:
    """Returns a number with a decimal comma as one with a point; any other text unchanged."""
    return cell.replace(",", ".") if re.fullmatch(r"[-+]?\d+,\d+([eE][-+]?\d+)?", cell) else cell


@dataclass(frozen=True)
class _Row:
    """A row of a file of tests, which reads its cells into a test."""

    path: str
    number: int  # its line in the file
    cells: Mapping[str, str]  # those that are not empty, by the names of their columns

    def refusal(self, column: str, problem: str) -> CaseFileError:
        """Returns the error that names this row and a column."""
        return CaseFileError(f"{self.path}: row {self.number}: {column}: {problem}")

    def number_in(self, column: str, default: float | None = None) -> float:
        """Returns the positive number in a column, or the default if the cell is empty.

        A measurement error may be 0. CaseFileError: it is no such number, or there is no default.
        """
        text = self.cells.get(column)
        if text is None and default is not None:
            return default
        try:
            value = float(text or "")
        except ValueError:
            value = math.nan
        is_exact = column == _ERROR and value == 0.0
        if not (is_exact or 0.0 < value < math.inf):
            got = "nothing" if text is None else repr(short(text))
            raise self.refusal(column, f"got {got}, expected a number > 0")
        return value

    def test(self, scene: Scene) -> BearingTest:
        """Returns the test of this row, with the scene under its conditions.

        CaseFileError: the row has no result, or two, or an invalid cell.
        """
        names = [name for name in SEEN if name in self.cells]
        if len(names) != 1:
            got = " and ".join(names) or "nothing"
            problem = f"got {got}, expected one of {', '.join(SEEN)}"
            raise CaseFileError(f"{self.path}: row {self.number}: {problem}")
        (name,) = names
        value = self.number_in(name)
        has_time = name in (SEEN_LOSS, SEEN_PRELOAD)
        if _AFTER in self.cells and not has_time:
            problem = f"got {self.cells[_AFTER]!r}, only allowed with {SEEN_LOSS} or {SEEN_PRELOAD}"
            raise self.refusal(_AFTER, problem)
        count = self.number_in(_COUNT, 1.0)
        if count != int(count):
            raise self.refusal(_COUNT, f"got {count:g}, expected a whole number > 0")
        error = self.number_in(_ERROR, SEEN_AS[name].error)
        if error > 100.0:
            raise self.refusal(_ERROR, f"got {error:g}, expected a number from 0 to 100")
        return BearingTest(
            row=self.number,
            scene=self.under_conditions(scene, name, value),
            seen=name,
            value=value,
            after=self.number_in(_AFTER) if has_time else value,
            count=int(count),
            error=0.01 * error,
        )

    def under_conditions(self, scene: Scene, seen: str, value: float) -> Scene:
        """Returns the scene of the test; a loss or a residual preload is the end of its life.

        For any other result it has the end of life of the scene.

        seen, value: kind of result, one of `SEEN`, and its number in the unit of its column.
        CaseFileError: a cell is invalid in the scene, or such an end is not possible in it.
        """
        changes = {
            key: data_of(text, self.path)
            for key, text in self.cells.items()
            if key not in TEST_COLUMNS
        }
        try:
            tested = scene.with_(changes)
            preload = tested.operation.preload_N
            if seen == SEEN_LOSS:
                tested = tested.with_({"wear.end_of_life": {"ball_diameter_loss_um": value}})
            elif seen == SEEN_PRELOAD:
                if tested.operation.preload_method != "fixed_position":
                    problem = "got this result with constant force, expected it with fixed position"
                    raise self.refusal(seen, problem)
                if value >= preload:
                    raise self.refusal(seen, f"got {value:g}, expected a number < {preload:g}")
                tested = tested.with_({"wear.end_of_life": {"preload_fraction": value / preload}})
        except SceneError as error:
            raise self.refusal(error.key or error.source, error.problem) from None
        return tested
