"""Runs a study with Snakemake, in the present folder or in one of its own."""

from __future__ import annotations

import contextlib
import fcntl
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from bearingwear.atomic import write_text
from bearingwear.console import UsageError
from bearingwear.provenance import PACKAGE

CONFIG = Path("config/config.yaml")
PAGE = Path("results/report/index.html")

DRY_RUN = {"-n", "--dry-run", "--dryrun"}
TOLD = {"-q", "--quiet", "--verbose", "-p", "--printshellcmds"}
"""Arguments of Snakemake that say how much it tells."""


class NoStudy(UsageError):
    """A folder without a study, or an installation without the workflow; one line."""


def snakefile() -> Path:
    """The Snakefile of this package: beside it in a checkout, else where it was installed."""
    places = [PACKAGE.parent, Path(sys.prefix) / "share" / "bearingwear"]
    for folder in places:
        if (folder / "Snakefile").is_file():
            return folder / "Snakefile"
    raise NoStudy(f"study: the workflow is in neither of {', '.join(map(str, places))}")


def launch(
    name: str, jobs: int, more: Sequence[str] = (), folder: Path = Path(), files: Sequence[int] = ()
) -> int:
    """Run a study; its results are below `results/`.

    Parameters
    ----------
    name : str
        A study of `studies.NAMES`, or `all` for those that run by default.
    jobs : int
        How many run at a time.
    more : sequence of str
        Further arguments of Snakemake.
    folder : path
        Where the study is.
    files : sequence of int
        Open files that Snakemake keeps open while it runs.

    Returns
    -------
    int
        Exit status of Snakemake.

    Raises
    ------
    NoStudy
    """
    if not (folder / CONFIG).is_file():
        raise NoStudy(f"study: given a folder without {CONFIG}; allowed one that holds a study")
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(snakefile())]
    if not TOLD & set(more):  # of a dry run the table of jobs; never the files of each
        more = [*more, "--quiet", "host", "reason", *(["rules"] if DRY_RUN & set(more) else [])]
    return subprocess.call([*command, f"-j{jobs}", name, *more], cwd=folder, pass_fds=files)


@contextlib.contextmanager
def only_run(folder: Path) -> Iterator[int]:
    """Keeps other commands of ours out of a study's folder; yields the file that is held open.

    Raises
    ------
    NoStudy
        Where one of them runs the study already.
    """
    path = folder / ".snakemake" / "bearingwear.lock"
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a") as held:
        try:
            fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise NoStudy(
                f"{folder}: given a study that is running; allowed when it is done"
            ) from None
        yield held.fileno()


def launch_own(
    folder: Path, jobs: int, held: int, more: Sequence[str] = ()
) -> tuple[int, Path | None]:
    """Run the study of a folder that `own.folder.write_study` made; a run that was killed goes on.

    Parameters
    ----------
    held : int
        What `only_run` gave for the folder.

    Returns
    -------
    status : int
        Exit status of Snakemake.
    page : path or None
        The page, beside the folders of the study; none where none was made.

    Raises
    ------
    NoStudy
    """
    # nobody runs it: a lock of Snakemake is left by a run that was killed
    shutil.rmtree(folder / ".snakemake" / "locks", ignore_errors=True)
    status = launch("all", jobs, ["--rerun-incomplete", *more], folder, [held])
    made = folder / PAGE
    if DRY_RUN & set(more) or not made.is_file():
        return status, None
    page = folder / PAGE.name
    write_text(page, made.read_text(encoding="utf-8"))
    return status, page
