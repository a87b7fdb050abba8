"""A document as HTML, and any block of it."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from bearingwear.document.document import Block, Document
from bearingwear.results.units import unbroken


def as_html(document: Document) -> str:
    """All of a document: what a notebook shows."""
    heading = "".join(f"<p>{_plain(text)}</p>" for text in document.heading)
    return f"<div>{heading}{''.join(block_html(block) for block in document.blocks)}</div>"


def block_html(block: Block, name: str = "") -> str:
    """A table with its title and the sentences below it, or sentences below their title.

    name: the `id` of its table.
    """
    if not block.rows:
        return sentences_html([block])
    heads, lines = block.table
    sortable = ' class="sortable"' if heads[0] else ""
    known = f' id="{escape(name)}"' if name else ""
    label = escape(block.title)
    head = "".join(
        f'<th scope="col">{_plain(text)}</th>' if text else "<td></td>" for text in heads
    )
    body = "\n".join(
        f'<tr><th scope="row">{_plain(first)}</th>'
        + "".join(f"<td>{_plain(text)}</td>" for text in rest)
        + "</tr>"
        for first, *rest in lines
    )
    caption = f"<caption>{_plain(block.title)}</caption>" if block.title else ""
    table = f"<table{known}{sortable}>{caption}\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}"
    notes = "".join(f'<p class="note">{_plain(text)}</p>' for text in block.lines)
    return (
        f'<div class="wide" role="region" aria-label="{label}" tabindex="0">{table}\n'
        f"</tbody></table></div>\n{notes}"
    )


def sentences_html(blocks: Iterable[Block]) -> str:
    """Sentences of some blocks below their titles, as one list."""
    parts = []
    for block in blocks:
        parts += [f"<dt>{_plain(block.title)}</dt>"] if block.title else []
        parts += [f"<dd>{_plain(text)}</dd>" for text in block.lines]
    return f"<dl>{''.join(parts)}</dl>" if parts else ""


def _plain(text: str) -> str:
    """A text, of whom ever, with its numbers in one piece with their units."""
    return escape(unbroken(text), quote=False)
