"""A document as Markdown."""

from __future__ import annotations

import html
import re

from bearingwear.document.document import Block, Document

_MARKUP = re.compile(r"[\\`*~#|\[\]]|(?<![^\W_])_|_(?![^\W_])")
"""What Markdown reads as its own; an underscore within a word it does not."""


def plain_text(text: str) -> str:
    """A text of somebody else, for Markdown: nothing in it is markup or HTML."""
    escaped = html.escape(text, quote=False).replace("&lt; ", "< ")  # no tag begins with a space
    return _MARKUP.sub(r"\\\g<0>", escaped)


def as_markdown(document: Document) -> str:
    """Title, heading, and each block below its title."""
    title, *heading = map(plain_text, document.heading)
    parts = [f"# {title}", *heading, *map(block_markdown, document.blocks)]
    return "\n\n".join(part for part in parts if part) + "\n"


def block_markdown(block: Block, title: str = "## {}") -> str:
    """A block below its title, for a larger text."""
    parts = [title.format(plain_text(block.title))] if block.title else []
    if block.rows:
        heads, lines = block.table
        head, *rest = (" | ".join(map(plain_text, line)) for line in [heads, *lines])
        table = [head, " | ".join(["---"] * len(heads)), *rest]
        parts.append("\n".join(f"| {line} |" for line in table))
    said = [*map(plain_text, block.lines)]
    if not block.rows and len(said) > 1:
        said = ["\n".join(f"- {text}" for text in said)]
    return "\n\n".join([*parts, *said])
