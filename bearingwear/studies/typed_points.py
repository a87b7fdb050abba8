"""Reads typed axes and rows of a sweep."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bearingwear.atomic import reason
from bearingwear.console import UsageError
from bearingwear.scene.changes import changes_of
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.strict_yaml import data_of

MOST_ON_AN_AXIS = 100_000


def typed_points(axes: Sequence[str], rows: Path | None) -> Any:
    """Returns the points of a sweep from the options `--axis` or `--rows`.

    Axes give a dict with the list of values of each key. A table gives a list of rows, each of
    which is a dict with a value for each key.

    axes: texts `KEY=VALUES`.
    rows: path of a table, if there are no axes.
    UsageError: both options or neither.
    SceneError: a text or a table that cannot be read.
    """
    if (rows is None) == (not axes):
        options = "both --axis and --rows" if axes else "neither --axis nor --rows"
        raise UsageError(f"sweep: got {options}, expected one of them")
    if rows is not None:
        return _table_rows(rows)
    texts = []
    for text in axes:
        key, equals, values = text.partition("=")
        if not equals:
            problem = f"got {text}, expected KEY=VALUES such as operation.preload_N=5,7,9"
            raise SceneError("", problem, source="--axis")
        texts.append(f"{key}={_yaml_list(key, values)}")
    try:
        return changes_of(texts)
    except SceneError as error:
        raise error.in_source(error.source.replace("--set", "--axis")) from None


def _yaml_list(key: str, text: str) -> str:
    """Returns the values of an axis as a list in YAML.

    text: values with commas between them, or LOW:HIGH:COUNT for evenly spaced numbers from LOW to
        HIGH, both included.
    SceneError: numbers with colons between them that are not LOW:HIGH:COUNT, or with hyphens
        between them, as in 5-9.
    """
    # numbers with colons or hyphens between them; the hyphen of 1e-5 does not separate numbers
    if not re.fullmatch(r"[-+.eE\d]+(?:(?::|(?<![eE])-)[-+.eE\d]+)+", text):
        return f"[{text}]"
    try:
        low_text, high_text, count_text = text.split(":")
        low, high, count = float(low_text), float(high_text), int(count_text)
        if not 2 <= count <= MOST_ON_AN_AXIS:
            raise ValueError
    except ValueError:
        problem = f"got {text}, expected LOW:HIGH:COUNT with a count from 2 to {MOST_ON_AN_AXIS}"
        raise SceneError("", problem, source=f"--axis {key}") from None
    values = (low + (high - low) * k / (count - 1) for k in range(count))
    return f"[{', '.join(map(repr, values))}]"


def _table_rows(path: Path) -> list[dict[str, Any]]:
    """Returns a dict of values by key for each line of a CSV file below its header.

    Empty lines are left out.

    SceneError: a file that cannot be read, or has no header of different keys or no row.
    SceneError: a line with too few or too many values, or a value that is not YAML.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeError) as error:
        problem = f"got a file that cannot be read ({reason(error)}), expected a CSV file"
        raise SceneError("", problem, source=str(path)) from None
    lines = csv.reader(text.splitlines())
    header = [key.strip() for key in next(lines, [])]
    if not header or len(set(header)) < len(header):
        raise SceneError("", "got no header of different keys, expected one", source=str(path))
    rows = []
    for cells in lines:
        if not cells:
            continue
        source = f"{path}: line {lines.line_num}"
        if len(cells) != len(header):
            problem = f"got {len(cells)} values, expected {len(header)}"
            raise SceneError("", problem, source=source)
        values = [_cell_value(cell, source) for cell in cells]
        rows.append(dict(zip(header, values, strict=True)))
    if not rows:
        raise SceneError("", "got no row, expected one or more", source=str(path))
    return rows


def _cell_value(cell: str, source: str) -> Any:
    """Returns the number in a cell of a table, or what its text means in YAML.

    source: file and line, for errors.
    SceneError: a text that is not YAML.
    """
    try:
        return float(cell)  # a hundred times as fast as YAML
    except ValueError:
        return data_of(cell, source)
