"""Renders a document, or a block of one, as HTML."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from bearingwear.document.document import Block, Document
from bearingwear.results.units import without_unit_breaks


def as_html(document: Document) -> str:
    """Returns HTML of a whole document, which a notebook shows."""
    heading = "".join(f"<p>{_escaped(text)}</p>" for text in document.heading)
    return f"<div>{heading}{''.join(block_html(block) for block in document.blocks)}</div>"


def block_html(block: Block, name: str = "") -> str:
    """Returns HTML of a block: its title, its table if there is one, and its sentences.

    name: the `id` of the table; "" for none.
    """
    if not block.rows:
        return sentences_html([block])
    heads, lines = block.table
    sortable = ' class="sortable"' if heads[0] else ""
    identifier = f' id="{escape(name)}"' if name else ""
    label = escape(block.title)
    head_cells = "".join(
        f'<th scope="col">{_escaped(text)}</th>' if text else "<td></td>" for text in heads
    )
    if block.axes:
        styles = [""] * len(lines)
    else:  # the label of a row that details the one above it is indented
        styles = [' class="part"' if row.label.startswith(" ") else "" for row in block.rows]
    body = "\n".join(
        f'<tr><th scope="row"{style}>{_escaped(row_head)}</th>'
        + "".join(f"<td>{_escaped(text)}</td>" for text in texts)
        + "</tr>"
        for style, (row_head, *texts) in zip(styles, lines, strict=True)
    )
    caption = f"<caption>{_escaped(block.title)}</caption>" if block.title else ""
    start = f"<table{identifier}{sortable}>{caption}\n<thead><tr>{head_cells}</tr></thead>\n"
    notes = "".join(f'<p class="note">{_escaped(text)}</p>' for text in block.lines)
    return (
        f'<div class="wide" role="region" aria-label="{label}" tabindex="0">{start}'
        f"<tbody>\n{body}\n</tbody></table></div>\n{notes}"
    )


def sentences_html(blocks: Iterable[Block]) -> str:
    """Returns one HTML list of the titles of blocks and their sentences; "" without any."""
    items = []
    for block in blocks:
        if block.title:
            items.append(f"<dt>{_escaped(block.title)}</dt>")
        items += [f"<dd>{_escaped(text)}</dd>" for text in block.lines]
    return f"<dl>{''.join(items)}</dl>" if items else ""


def _escaped(text: str) -> str:
    """Escapes a text for HTML, with no line break between a number and its unit."""
    return escape(without_unit_breaks(text), quote=False)
