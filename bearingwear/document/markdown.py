"""A document as Markdown."""

from __future__ import annotations

import html
import re
from collections.abc import Iterable

from bearingwear.document.document import Block, Document

_MARKUP = re.compile(r"[\\`*~#|\[\]]|(?<![^\W_])_|_(?![^\W_])")
"""What Markdown reads as its own; an underscore within a word it does not."""


def plain_text(text: str) -> str:
    """A text of somebody else, for Markdown: nothing in it is markup or HTML."""
    return _MARKUP.sub(r"\\\g<0>", html.escape(text, quote=False))


def markdown_table(header: str, rows: Iterable[list[str]]) -> str:
    """A table in Markdown; the names of its columns stand between bars."""
    count = header.count("|") + 1
    lines = [f"| {header} |", "|" + " --- |" * count]
    return "\n".join([*lines, *("| " + " | ".join(row) + " |" for row in rows)]).replace("nan", "–")


def as_markdown(document: Document) -> str:
    """Title, heading, and each block below its title."""
    title, *heading = map(plain_text, document.heading)
    parts = [f"# {title}", *heading, *(part for block in document.blocks for part in _parts(block))]
    return "\n\n".join(part for part in parts if part) + "\n"


def _parts(block: Block) -> list[str]:
    title = [f"## {plain_text(block.title)}"] if block.title else []
    table = []
    if block.rows:
        heads, lines = block.table
        cells = [[*map(plain_text, line)] for line in lines]
        table = [markdown_table(" | ".join(map(plain_text, heads)), cells)]
    said = [*map(plain_text, block.lines)]
    if not block.rows and len(said) > 1:
        said = ["\n".join(f"- {text}" for text in said)]
    return [*title, *table, *said]
