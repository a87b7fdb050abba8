"""What commands print: sheets in the chosen format, and lines on standard error."""

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
    """Prints a sheet as text, or as JSON or CSV if `args.json` or `args.csv` is set.

    For CSV, standard output is set to UTF-8.
    """
    from bearingwear.document.data import as_csv, as_json
    from bearingwear.document.text import as_text

    if args.csv and isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(encoding="utf-8")  # whatever the locale, as files are
    if args.json:
        text = as_json(sheet)
    elif args.csv:
        text = as_csv(sheet)
    else:
        text = as_text(sheet)
    print_text(text)


def print_file(path: str | Path, args: argparse.Namespace, every: bool = False) -> None:
    """Prints the sheet of a result file of any kind.

    every: whether to add residuals, error estimates, counts of steps, and versions.
    """
    from bearingwear.document.show import sheet
    from bearingwear.studies import STUDY_SHEETS

    print_sheet(sheet(path, STUDY_SHEETS, every), args)


def print_warnings(attributes: Mapping[str, Any]) -> None:
    """Prints a line on standard error for each warning in the attributes of a result."""
    from bearingwear.results.warnings import warning_lines

    for line in warning_lines(attributes):
        tell_line(line)


def print_text(text: str) -> None:
    """Prints a text with question marks for control characters, as a foreign file may contain."""
    print("\n".join(printable(line) for line in text.split("\n")))


def tell_line(text: str) -> None:
    """Writes a line on standard error at once; does nothing if that is closed."""
    with contextlib.suppress(OSError, ValueError):
        sys.stderr.write(one_line(text))
        sys.stderr.flush()


def tell_of_new_folder(path: Path) -> None:
    """Writes a line if the folder of a file will be made, since its name may be mistyped."""
    if not path.parent.exists():
        tell_line(f"{path.parent}: new folder")


def tell_of_file(args: argparse.Namespace) -> None:
    """Writes the name of the file that was written, unless -o named it."""
    if not args.is_named:
        tell_line(f"{args.output}: written")
