"""What commands print: sheets in the format that is asked for, and lines on standard error."""

from __future__ import annotations

import argparse
import contextlib
import io
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bearingwear.console import one_line, printable

if TYPE_CHECKING:
    from bearingwear.document.document import Document


def print_sheet(sheet: Document, args: argparse.Namespace) -> None:
    from bearingwear.document.data import as_csv, as_json
    from bearingwear.document.text import as_text

    if args.csv and isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(encoding="utf-8")  # whatever the locale, as files are
    render = as_json if args.json else as_csv if args.csv else as_text
    print_text(render(sheet))


def print_file(path: str | Path, args: argparse.Namespace, every: bool = False) -> None:
    """Prints the sheet of a result file of any kind."""
    from bearingwear.document.show import sheet
    from bearingwear.studies import STUDY_SHEETS

    print_sheet(sheet(path, STUDY_SHEETS, every), args)


def print_warnings(attributes: Mapping[str, Any]) -> None:
    from bearingwear.results.warnings import warning_lines

    for line in warning_lines(attributes):
        tell_line(line)


def print_text(text: str) -> None:
    """Mask control characters: names in a foreign file may hold some."""
    print("\n".join(map(printable, text.split("\n"))))


def tell_line(text: str) -> None:
    """Write a line at once; a run goes on where nobody reads about its progress any more."""
    with contextlib.suppress(OSError, ValueError):
        sys.stderr.write(one_line(text))
        sys.stderr.flush()


def tell_of_new_folder(path: Path) -> None:
    """Tell of folders that are made, since a name may be mistyped."""
    if not path.parent.exists():
        tell_line(f"{path.parent}: new folder")


def tell_of_file(args: argparse.Namespace) -> None:
    """Name the file that was written where nobody named it."""
    if not args.is_named:
        tell_line(f"{args.output}: written")
