"""The answer of a study, for the head of a page: sentences and tables as text, kept as JSON.

A study writes one by a step of its own; the page shows what it finds and knows no study.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from bearingwear.results.netcdf import CaseFileError


@dataclass(frozen=True, kw_only=True)
class AnswerTable:
    """A table of an answer; every cell is text.

    Attributes
    ----------
    title : str
    columns : sequence of str
        Headings; the first is that of the rows' names.
    rows : sequence of sequence of str
    note : str
        A sentence below it.
    shown : bool
        Whether it is open where it is not the first.
    slider : bool
        Whether a reader picks one of the values in the first column to see its rows alone.
    start : str
        The value that is picked at first.
    """

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    note: str = ""
    shown: bool = False
    slider: bool = False
    start: str = ""


@dataclass(frozen=True, kw_only=True)
class Answer:
    """The answer of a study.

    Attributes
    ----------
    scene : str
        Name of the scene that it is about.
    bearing : str
        A line of its data.
    rank : int
        Of several answers about a scene, the least leads the page.
    title : str
        What the answer is about, for the navigation.
    headline : str
        What to do, in a sentence.
    points : sequence of (str, sequence of str)
        What an engineer asks next, and the sentences that say it.
    notes : sequence of (str, sequence of str)
        What can wait.
    tables : sequence of AnswerTable
        The first belongs to the headline.
    figures : sequence of str
        Names, without suffix, of the figures that belong to it.
    """

    scene: str
    bearing: str
    rank: int
    title: str
    headline: str
    points: Sequence[tuple[str, Sequence[str]]]
    notes: Sequence[tuple[str, Sequence[str]]] = ()
    tables: Sequence[AnswerTable] = ()
    figures: Sequence[str] = ()

    @property
    def sliders(self) -> bool:
        """Whether a reader can pick a value in one of the tables."""
        return any(table.slider for table in self.tables)

    def as_json(self) -> str:
        """As `load_answer` reads it."""
        return json.dumps(asdict(self), ensure_ascii=False, indent=1) + "\n"


def load_answer(path: Path) -> Answer:
    """An answer that a step of a study wrote.

    Raises
    ------
    CaseFileError
        One line.
    """
    try:
        read = json.loads(path.read_text(encoding="utf-8"))
        tables = [AnswerTable(**table) for table in read.pop("tables")]
        return Answer(tables=tables, **read)
    except (OSError, ValueError, TypeError, KeyError, AttributeError) as error:
        reason = " ".join(str(error).split())
        raise CaseFileError(f"{path}: cannot be read ({reason}), expected an answer") from None
