"""Parts of docs/accuracy.md that are made from a study: each stands between two marks."""

from dataclasses import dataclass
from pathlib import Path

from bearingwear.results.netcdf import CaseFileError


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
