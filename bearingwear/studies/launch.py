"""Runs a study in the present folder with Snakemake."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from bearingwear.console import UsageError
from bearingwear.provenance import PACKAGE

CONFIG = Path("config/config.yaml")


class NoStudy(UsageError):
    """A folder without a study, or an installation without the workflow; one line."""


def snakefile() -> Path:
    """The Snakefile of this package: beside it in a checkout, else where it was installed."""
    places = [PACKAGE.parent, Path(sys.prefix) / "share" / "bearingwear"]
    for folder in places:
        if (folder / "Snakefile").is_file():
            return folder / "Snakefile"
    raise NoStudy(f"study: the workflow is in neither of {', '.join(map(str, places))}")


def launch(name: str, jobs: int, more: Sequence[str] = ()) -> int:
    """Run a study; its results are below `results/`.

    Parameters
    ----------
    name : str
        A study of `studies.NAMES`, or `all` for those that run by default.
    jobs : int
        How many run at a time.
    more : sequence of str
        Further arguments of Snakemake.

    Returns
    -------
    int
        Exit status of Snakemake.

    Raises
    ------
    NoStudy
    """
    if not CONFIG.is_file():
        raise NoStudy(f"study: given a folder without {CONFIG}; allowed one that holds a study")
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(snakefile())]
    return subprocess.call([*command, f"-j{jobs}", name, *more])
