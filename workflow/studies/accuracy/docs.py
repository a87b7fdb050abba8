"""Parts of docs/accuracy.md that are generated from the study, each between two marks."""

import textwrap
from collections.abc import Callable, Iterable
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
"""Functions that return the paragraphs and tables of each part."""


def docs_part(trade: Path, plan: Path, name: str) -> list[str | CheckedTable]:
    """Returns the paragraphs and tables of a part of docs/accuracy.md.

    trade: file of all points of the study. plan: its file.
    name: key of `DOCS_PARTS`; a CaseFileError is raised for another one.
    """
    if name not in DOCS_PARTS:
        raise CaseFileError(f"part: got {name}, expected {', '.join(DOCS_PARTS)}")
    return DOCS_PARTS[name](load_with_axes(trade, point=()), read_accuracy(plan))


def part_tables(trade: Path, plan: Path, part: str) -> str:
    """Step: returns only the tables of a part, as Markdown."""
    return "\n\n".join(_markdown_texts(tables_in(docs_part(trade, plan, part)))) + "\n"


def accuracy_tables(trade: Path, plan: Path) -> tuple[str, str]:
    """Step: returns every point as CSV, and the tables of the main part as Markdown."""
    return points_csv(load_with_axes(trade, point=())), part_tables(trade, plan, "accuracy")


def docs_with_part(trade: Path, plan: Path, docs: Path, part: str) -> str:
    """Step: returns the text of the docs with a part of this run instead of the old one.

    A part that the docs lack is added at the end. If they have only the mark at its begin, all that
    follows the mark is replaced. Docs that do not exist begin with a title.
    """
    begin, end = _marks(part)
    text = "\n\n".join(_markdown_texts(docs_part(trade, plan, part)))
    old_text = docs.read_text(encoding="utf-8") if docs.exists() else "# Accuracy\n"
    before, _, after_begin = old_text.partition(begin)
    after = after_begin.partition(end)[2] if end in after_begin else "\n"
    if not after_begin:
        before = f"{before.rstrip()}\n\n"
    return f"{before}{begin}\n{text}\n{end}{after}"


def check_docs(trade: Path, plan: Path, docs: Path, cages: Path) -> str:
    """Step: returns a line that says that the docs agree with a run.

    trade, cages: files of all points, and of the cage ensembles.
    plan, docs: files of the plan, and of the docs.
    NotSolved: a line for each number that differs.
    CaseFileError: the docs lack a part.
    """
    trade_by_part = dict.fromkeys(DOCS_PARTS, trade) | {"cages": cages}
    lines = []
    for part, path in trade_by_part.items():
        lines += differences(path, plan, docs, part)
    if lines:
        raise NotSolved("\n".join([*lines, f"{docs}: numbers that differ: {len(lines)}"]))
    return f"{docs}: agrees with the run\n"


def differences(trade: Path, plan: Path, docs: Path, part: str) -> list[str]:
    """Returns a line for each number in a part of the docs that differs beyond its tolerance.

    CaseFileError: the docs lack the part.
    """
    begin, end = _marks(part)
    _, _, after_begin = docs.read_text(encoding="utf-8").partition(begin)
    old_part, end_mark, _ = after_begin.partition(end)
    if not end_mark:
        raise CaseFileError(f"{docs}: got no part between {begin} and {end}")
    tables = tables_in(docs_part(trade, plan, part))
    return [f"{docs}: {line}" for table in tables for line in table.differences(old_part)]


def tables_in(part: list[str | CheckedTable]) -> list[CheckedTable]:
    """Returns the tables of a part."""
    return [item for item in part if isinstance(item, CheckedTable)]


def _markdown_texts(part: Iterable[str | CheckedTable]) -> list[str]:
    """Returns each paragraph, with lines of at most 100 columns, and each table as Markdown."""
    texts = []
    for item in part:
        if isinstance(item, CheckedTable):
            texts.append(item.text)
        else:
            texts.append(
                textwrap.fill(item, width=100, break_long_words=False, break_on_hyphens=False)
            )
    return texts


def _marks(part: str) -> tuple[str, str]:
    """Returns the Markdown comments before and after a part."""
    return f"<!-- {part}: begin -->", f"<!-- {part}: end -->"
