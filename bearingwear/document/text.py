"""A document as text for a terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from itertools import zip_longest

from bearingwear.document.document import Block, Document, row_notes
from bearingwear.results.units import in_ascii

LABEL_WIDTH, UNIT_WIDTH, VALUE_WIDTH = 28, 11, 13
WIDTH = 110
"""Of a line of sentences, and of a table's heads where its columns need no more."""
COMPARED = 4
"""Columns that stay beside each other however wide: two methods, new and worn."""


def as_text(document: Document) -> str:
    """Plain text for a terminal."""
    lines = [part for text in document.heading for part in _wrapped(text)]
    for block in document.blocks:
        lines += ["", *(_points(block) if block.axes else _quantities(block))]
        indent = "  " if block.rows or not block.title else "    "
        lines += [part for text in block.lines for part in _wrapped(text, indent)]
    return in_ascii("\n".join(line.rstrip() for line in lines)).strip("\n")


def _wrapped(text: str, indent: str = "") -> list[str]:
    return textwrap.wrap(
        text, WIDTH, initial_indent=indent, subsequent_indent=f"{indent}  ",
        break_long_words=False, break_on_hyphens=False,
    )  # fmt: skip


def _quantities(block: Block) -> list[str]:
    """A line for each quantity."""
    cells = block.cells
    columns_of = zip_longest(block.columns, *cells, fillvalue="")
    widths = [max(VALUE_WIDTH, *(len(text) + 2 for text in column)) for column in columns_of]
    label_width = max([LABEL_WIDTH, *(len(row.label) + 2 for row in block.rows)])

    def line(label: str, unit: str, texts: Sequence[str], part: slice) -> str:
        shown = zip(texts[part], widths[part], strict=False)
        columns = "".join(f"{text:>{width}}" for text, width in shown)
        return f"  {label:<{label_width}}{unit:<{UNIT_WIDTH}}{columns}"

    lines = []
    for part in _parts(widths, WIDTH - 2 - label_width - UNIT_WIDTH):
        if block.title:
            lines.append(line(block.title, block.unit, block.columns, part))
        for row, texts in zip(block.rows, cells, strict=True):
            if part.start and not texts[part]:
                continue
            text, notes = line(row.label, row.unit, texts, part), row_notes(row)
            last = part.stop >= len(texts)
            lines.append(f"{text}  {notes}" if notes and last else text)
    return lines


def _parts(widths: Sequence[int], room: int) -> Iterator[slice]:
    """Columns that fit beside each other; of many, further ones stand below."""
    start = 0
    for k in range(1, len(widths)):
        if len(widths) > COMPARED and sum(widths[start : k + 1]) > room:
            yield slice(start, k)
            start = k
    yield slice(start, len(widths))


def _points(block: Block) -> list[str]:
    """A line for each point; heads stand on several lines, as their columns are narrow."""
    heads, points = block.table
    narrow = [max(12, *(len(text) for text in column)) for column in zip(*points, strict=True)]
    wrapped_heads = [textwrap.wrap(head, width) for head, width in zip(heads, narrow, strict=True)]
    height = max(map(len, wrapped_heads), default=0)
    widths = [
        max(width, *(len(part) for part in parts), 0)
        for width, parts in zip(narrow, wrapped_heads, strict=True)
    ]
    rows = [[(parts[k : k + 1] or [""])[0] for parts in wrapped_heads] for k in range(height)]
    title = [f"  {block.title}"] if block.title else []
    return title + [
        "  " + "  ".join(f"{text:>{width}}" for text, width in zip(row, widths, strict=True))
        for row in [*rows, *points]
    ]
