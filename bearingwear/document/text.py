"""Renders a document as plain text for a terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from itertools import zip_longest

from bearingwear.document.document import Block, Document, row_notes
from bearingwear.results.units import ascii_text

LABEL_WIDTH, UNIT_WIDTH, VALUE_WIDTH = 28, 11, 13
"""Least widths of the columns of a table with a line for each quantity."""
POINT_WIDTH = 12
"""Least width of each column of a table with a line for each point."""
WIDTH = 110
"""Most characters in a line of a sentence or table; a table with wide columns may exceed it."""
ALWAYS_BESIDE = 4
"""Number of columns that stay beside each other however wide: two methods, new and worn."""


def as_text(document: Document) -> str:
    """Returns a document as plain text in ASCII."""
    lines = [line for text in document.heading for line in _wrapped_lines(text)]
    for block in document.blocks:
        lines += ["", *(_point_lines(block) if block.axes else _quantity_lines(block))]
        indent = "  " if block.rows or not block.title else "    "
        lines += [line for text in block.lines for line in _wrapped_lines(text, indent)]
    return ascii_text("\n".join(line.rstrip() for line in lines)).strip("\n")


def _wrapped_lines(text: str, indent: str = "") -> list[str]:
    """Wraps a sentence into lines of `WIDTH` characters.

    indent: of the first line; the others have two more spaces.
    """
    return textwrap.wrap(
        text, WIDTH, initial_indent=indent, subsequent_indent=f"{indent}  ",
        break_long_words=False, break_on_hyphens=False,
    )  # fmt: skip


def _quantity_lines(block: Block) -> list[str]:
    """Returns the lines of a table with a line for each quantity.

    Columns that do not fit beside each other are in parts of the table, one below the other.
    """
    cells = block.cells
    columns = zip_longest(block.columns, *cells, fillvalue="")
    widths = [max(VALUE_WIDTH, *(len(text) + 2 for text in column)) for column in columns]
    label_width = max([LABEL_WIDTH, *(len(row.label) + 2 for row in block.rows)])

    def line(label: str, unit: str, texts: Sequence[str], part: slice) -> str:
        """Returns a line of a part of the table, each text in the width of its column."""
        # not strict: a row may have fewer texts than there are columns
        aligned = (
            f"{text:>{width}}" for text, width in zip(texts[part], widths[part], strict=False)
        )
        return f"  {label:<{label_width}}{unit:<{UNIT_WIDTH}}{''.join(aligned)}"

    lines = []
    for part in _column_slices(widths, WIDTH - 2 - label_width - UNIT_WIDTH):
        if block.title:
            title = line(block.title, block.unit, block.columns, part)
            is_last_part = part.stop >= len(widths)
            lines.append(f"{title}  {block.notes}" if block.notes and is_last_part else title)
        for row, texts in zip(block.rows, cells, strict=True):
            if part.start and not texts[part]:
                continue
            text, notes = line(row.label, row.unit, texts, part), row_notes(row)
            is_last_part = part.stop >= len(texts)
            lines.append(f"{text}  {notes}" if notes and is_last_part else text)
    return lines


def _column_slices(widths: Sequence[int], total_width: int) -> Iterator[slice]:
    """Yields slices of the columns, in order, each of columns that fit beside each other.

    Up to `ALWAYS_BESIDE` columns are in one slice. Otherwise, a column that is too wide has a slice
    of its own.

    widths: of the columns, in characters.
    total_width: largest sum of the widths in a slice.
    """
    start = 0
    for k in range(1, len(widths)):
        if len(widths) > ALWAYS_BESIDE and sum(widths[start : k + 1]) > total_width:
            yield slice(start, k)
            start = k
    yield slice(start, len(widths))


def _point_lines(block: Block) -> list[str]:
    """Returns the lines of a table with a line for each point; long heads take several lines."""
    heads, points = block.table
    cell_widths = [
        max([POINT_WIDTH, *(len(texts[k]) for texts in points)]) for k in range(len(heads))
    ]
    wrapped_heads = [
        textwrap.wrap(head, width) for head, width in zip(heads, cell_widths, strict=True)
    ]
    # a long word in a head widens its column
    widths = [
        max([width, *(len(part) for part in parts)])
        for width, parts in zip(cell_widths, wrapped_heads, strict=True)
    ]
    head_lines = zip_longest(*wrapped_heads, fillvalue="")
    title = [f"  {block.title}"] if block.title else []
    return title + [
        "  " + "  ".join(f"{text:>{width}}" for text, width in zip(texts, widths, strict=True))
        for texts in [*head_lines, *points]
    ]
