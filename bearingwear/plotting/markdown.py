"""Tables as text: Markdown, and the cells of CSV."""

import html
import re
from collections.abc import Iterable, Sequence

import numpy as np
import xarray as xr


def plain_text(text: str) -> str:
    """A text of somebody else, for Markdown: nothing in it is markup or HTML."""
    return re.sub(r"([\\`*_~#|\[\]])", r"\\\1", html.escape(text, quote=False))


def markdown_table(header: str, rows: Iterable[list[str]]) -> str:
    """A table in Markdown; the names of its columns stand between bars."""
    count = header.count("|") + 1
    lines = [f"| {header} |", "|" + " --- |" * count]
    return "\n".join([*lines, *("| " + " | ".join(row) + " |" for row in rows)]).replace("nan", "–")


def cell_text(number: float, flags: Sequence[str] | None) -> str:
    """A number with nine digits, a flag by its name, nothing where it is missing."""
    if not np.isfinite(number):
        return ""
    return flags[int(number)] if flags else f"{number:.9g}"


def flag_names(coordinate: xr.DataArray) -> list[str]:
    """The names of the flags along a dimension."""
    names = coordinate.attrs["flag_meanings"].split()
    return [names[int(flag)] for flag in coordinate.values]
