"""Parts of docs/accuracy.md that are made from the study: each stands between two marks."""

import textwrap
from collections.abc import Callable
from pathlib import Path

import xarray as xr

from bearingwear.results.netcdf import CaseFileError
from bearingwear.studies.dataset import load_with_axes
from bearingwear.studies.run_step import NotSolved
from workflow.studies.accuracy.cages import cages_part
from workflow.studies.accuracy.checked_table import CheckedTable
from workflow.studies.accuracy.effects import effects_part
from workflow.studies.accuracy.groove_tables import grooves_part
from workflow.studies.accuracy.plan import Plan, read_accuracy
from workflow.studies.accuracy.tables import accuracy_part, points_csv

DOCS_PARTS: dict[str, Callable[[xr.Dataset, Plan], list[str | CheckedTable]]] = {
    "accuracy": accuracy_part,
    "effects": effects_part,
    "grooves": grooves_part,
    "cages": cages_part,
}
"""Paragraphs and tables of each part."""


def docs_part(trade: Path, plan: Path, name: str) -> list[str | CheckedTable]:
    """Paragraphs and tables of a part; CaseFileError where there is no such part."""
    if name not in DOCS_PARTS:
        raise CaseFileError(f"part: got {name}, expected {', '.join(DOCS_PARTS)}")
    return DOCS_PARTS[name](load_with_axes(trade, point=()), read_accuracy(plan))


def part_tables(trade: Path, plan: Path, part: str) -> str:
    """The tables of a part alone, as Markdown."""
    return "\n\n".join(_texts(tables_in(docs_part(trade, plan, part)))) + "\n"


def accuracy_tables(trade: Path, plan: Path) -> tuple[str, str]:
    """Every point as CSV, and what each simplification costs and saves as Markdown."""
    return points_csv(load_with_axes(trade, point=())), part_tables(trade, plan, "accuracy")


def docs_with_part(trade: Path, plan: Path, docs: Path, part: str) -> str:
    """The docs with a part of this run in the place of the old one, or at the end."""
    begin, end = _marks(part)
    text = "\n\n".join(_texts(docs_part(trade, plan, part)))
    old = docs.read_text(encoding="utf-8") if docs.exists() else "# Accuracy\n"
    before, _, rest = old.partition(begin)
    after = rest.partition(end)[2] if end in rest else "\n"
    if not rest:
        before = f"{before.rstrip()}\n\n"
    return f"{before}{begin}\n{text}\n{end}{after}"


def check_docs(trade: Path, plan: Path, docs: Path, cages: Path) -> str:
    """Says that the docs agree with a run; else NotSolved with a line for each difference."""
    given = dict.fromkeys(DOCS_PARTS, trade) | {"cages": cages}
    lines = [line for part, path in given.items() for line in differences(path, plan, docs, part)]
    if lines:
        raise NotSolved("\n".join([*lines, f"{docs}: numbers that differ: {len(lines)}"]))
    return f"{docs}: agrees with the run\n"


def differences(trade: Path, plan: Path, docs: Path, part: str) -> list[str]:
    """Where a part of the docs differs beyond the tolerance; CaseFileError where they lack it."""
    begin, end = _marks(part)
    inside, closed, _ = docs.read_text(encoding="utf-8").partition(begin)[2].partition(end)
    if not closed:
        raise CaseFileError(f"{docs}: got no part between {begin} and {end}")
    tables = tables_in(docs_part(trade, plan, part))
    return [f"{docs}: {line}" for table in tables for line in table.differences(inside)]


def tables_in(part: list[str | CheckedTable]) -> list[CheckedTable]:
    return [one for one in part if isinstance(one, CheckedTable)]


def _texts(part) -> list[str]:
    """Markdown, the lines of paragraphs at most 100 columns long."""
    return [
        textwrap.fill(one, width=100, break_long_words=False, break_on_hyphens=False)
        if isinstance(one, str)
        else one.text
        for one in part
    ]


def _marks(part: str) -> tuple[str, str]:
    return f"<!-- {part}: begin -->", f"<!-- {part}: end -->"
