"""Parts of docs/accuracy.md that are made from a study: each stands between two marks."""

import textwrap
from dataclasses import dataclass
from pathlib import Path

from bearingwear.results.netcdf import CaseFileError


def wrapped(text: str) -> str:
    """Markdown with the lines of its paragraphs at most 100 columns long; the rest as it is."""
    return "\n\n".join(
        part if part.lstrip().startswith(("|", "#", "<!--")) else _filled(part)
        for part in text.split("\n\n")
    )


def _filled(paragraph: str) -> str:
    return textwrap.fill(paragraph, width=100, break_long_words=False, break_on_hyphens=False)


@dataclass(frozen=True)
class MarkedPart:
    """The text from one mark to the other."""

    name: str

    @property
    def begin(self) -> str:
        return f"<!-- {self.name}: begin -->"

    @property
    def end(self) -> str:
        return f"<!-- {self.name}: end -->"

    def holding(self, text: str) -> str:
        """The part with this text between its marks."""
        return f"{self.begin}\n{wrapped(text)}\n{self.end}"

    def stands_in(self, text: str) -> bool:
        return self.begin in text and self.end in text

    def split(self, docs: Path) -> tuple[str, str, str]:
        """The text before the marks, between them, and after them.

        Raises
        ------
        CaseFileError
            Where the file has no such part.
        """
        text = docs.read_text(encoding="utf-8") if docs.exists() else ""
        if not self.stands_in(text):
            raise CaseFileError(f"{docs}: has no part between {self.begin} and {self.end}")
        before, _, rest = text.partition(self.begin)
        inside, _, after = rest.partition(self.end)
        return before, inside, after

    def renewed(self, docs: Path, text: str) -> str:
        """The file with this text in the place of the part.

        Raises
        ------
        CaseFileError
            Where the file has no such part.
        """
        before, _, after = self.split(docs)
        return before + text + after
