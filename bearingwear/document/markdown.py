"""Renders a document, or a block of one, as Markdown."""

from __future__ import annotations

import html
import re

from bearingwear.document.document import Block, Document

_MARKUP = re.compile(r"[\\`*~#|\[\]]|(?<![^\W_])_|_(?![^\W_])")
"""Characters that Markdown reads as markup; an underscore within a word is not markup."""


def plain_text(text: str) -> str:
    """Escapes a text for Markdown, so that no part of it is read as markup or HTML."""
    escaped = html.escape(text, quote=False).replace("&lt; ", "< ")  # no tag begins with a space
    return _MARKUP.sub(r"\\\g<0>", escaped)


def as_markdown(document: Document) -> str:
    """Returns Markdown of a document with at least a title in its heading."""
    title, *heading = (plain_text(line) for line in document.heading)
    parts = [f"# {title}", *heading, *(block_markdown(block) for block in document.blocks)]
    return "\n\n".join(part for part in parts if part) + "\n"


def block_markdown(block: Block, title: str = "## {}") -> str:
    """Returns Markdown of a block: its title, its table, and its sentences.

    title: format of the title, which determines its level.
    """
    parts = [title.format(plain_text(block.title))] if block.title else []
    if block.rows:
        heads, lines = block.table
        texts = [[plain_text(cell) for cell in line] for line in (heads, *lines)]
        head, *rest = (" | ".join(line) for line in texts)
        table = [head, " | ".join(["---"] * len(heads)), *rest]
        parts.append("\n".join(f"| {line} |" for line in table))
    sentences = [plain_text(line) for line in block.lines]
    if not block.rows and len(sentences) > 1:
        sentences = ["\n".join(f"- {sentence}" for sentence in sentences)]
    return "\n\n".join([*parts, *sentences])
