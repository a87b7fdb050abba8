"""Renders a document, or a block of one, as Markdown."""

from __future__ import annotations

import html
import re

from bearingwear.document.document import Block, Document

_MARKUP = re.compile(r"[\\`*~#|\[\]]|(?<![^\W_])_|_(?![^\W_])")
"""Characters that Markdown reads as markup; an underscore within a word is not markup."""


def plain_text(text: str) -> str:
    """Escapes a text for Markdown, so that nothing in it is markup or HTML."""
    escaped = html.escape(text, quote=False).replace("&lt; ", "< ")  # no tag begins with a space
    return _MARKUP.sub(r"\\\g<0>", escaped)


def as_markdown(document: Document) -> str:
    """Returns Markdown of a document: title, heading, and each block below its title."""
    title, *heading = (plain_text(line) for line in document.heading)
    parts = [f"# {title}", *heading, *(block_markdown(block) for block in document.blocks)]
    return "\n\n".join(part for part in parts if part) + "\n"


def block_markdown(block: Block, title: str = "## {}") -> str:
    """Returns Markdown of a block below its title.

    title: format of the title, which determines its level.
    """
    parts = [title.format(plain_text(block.title))] if block.title else []
    if block.rows:
        heads, lines = block.table
        head, *rest = (" | ".join(map(plain_text, line)) for line in [heads, *lines])
        table = [head, " | ".join(["---"] * len(heads)), *rest]
        parts.append("\n".join(f"| {line} |" for line in table))
    sentences = [plain_text(line) for line in block.lines]
    if not block.rows and len(sentences) > 1:
        sentences = ["\n".join(f"- {sentence}" for sentence in sentences)]
    return "\n\n".join([*parts, *sentences])
