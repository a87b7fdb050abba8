"""Runs a study with Snakemake, in the present folder or in one of its own."""

from __future__ import annotations

import contextlib
import difflib
import errno
import fcntl
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO, NoReturn, TextIO

from bearingwear.atomic import reason, write_text
from bearingwear.console import ProgressLines, UsageError, one_line
from bearingwear.kernels.build.folder import tell_of_compiling
from bearingwear.provenance import PACKAGE
from bearingwear.studies.command_pipe import CommandPipe
from bearingwear.studies.progress import COMPILING, RELAYED, RUNNING_JOBS

CONFIG = Path("config/config.yaml")
PAGE = Path("results/report/index.html")

DRY_RUN = {"-n", "--dry-run", "--dryrun"}
TOLD = {"-q", "--quiet", "--verbose", "-p", "--printshellcmds"}
"""Arguments of Snakemake that say how much it tells."""

_PROFILE = b"Using workflow specific profile"
"""Beginning of the line in which Snakemake names the profile that came with the workflow."""

_BAD_INPUT = 2
"""Exit status of Snakemake where the workflow refuses the configuration, before anything runs."""

_NO_ROOM = tuple(f"[Errno {number}]".encode() for number in (errno.ENOSPC, errno.EDQUOT))
"""In Snakemake's lines, and in its tracebacks, of a full disk and a used-up quota."""

_TRACEBACK = (b"Traceback", b"During handling of the above")

_LOCK_WAIT = 15.0  # seconds, in which an interrupted Snakemake has ended


class NoStudy(UsageError):
    """A folder without a study, or an installation without the workflow; one line."""


def snakefile() -> Path:
    """The Snakefile of this package: beside it in a checkout, else where it was installed."""
    places = [PACKAGE.parent, Path(sys.prefix) / "share" / "bearingwear"]
    for folder in places:
        if (folder / "Snakefile").is_file():
            return folder / "Snakefile"
    raise NoStudy(f"study: found no workflow in {', '.join(map(str, places))}")


def launch(
    name: str, jobs: int, more: Sequence[str] = (), folder: Path = Path(), files: Sequence[int] = ()
) -> int:
    """Run a study; its results are below `results/`.

    files: open files that Snakemake keeps open while it runs.
    """
    if not (folder / CONFIG).is_file():
        raise NoStudy(f"study: got a folder without {CONFIG}, expected one that contains a study")
    command = [sys.executable, "-P", "-m", "snakemake", "--snakefile", str(snakefile())]
    if not TOLD & set(more):  # of a dry run the table of jobs; never the files of each
        more = [*more, "--quiet", "host", "reason", *(["rules"] if DRY_RUN & set(more) else [])]
    return _relayed([*command, f"-j{jobs}", name, *more], folder, files)


def check_arguments(more: Sequence[str], own: Sequence[str]) -> None:
    """Refuse arguments that are none of Snakemake's, before it prints its usage.

    own: options of ours, one of which may have been meant.
    """
    if set(more) <= DRY_RUN | TOLD:
        return
    from snakemake.cli import get_argument_parser  # type: ignore[import-untyped]
    from snakemake.exceptions import CliException  # type: ignore[import-untyped]

    def refuse(message: str) -> NoReturn:
        raise UsageError(f"study: {message}")

    parser = get_argument_parser()
    parser.error = refuse
    try:
        _, unknown = parser.parse_known_args(["all", *more])
    except CliException as error:
        refuse(str(error))
    if unknown:
        near = difflib.get_close_matches(unknown[0].partition("=")[0], own, n=1)
        allowed = (
            f"did you mean {near[0]}" if near else "expected an option of bearingwear or Snakemake"
        )
        refuse(f"got {unknown[0]!r}; {allowed}")


def takes_value(option: str) -> bool:
    """Whether an option of Snakemake takes the word after it for its value."""
    from snakemake.cli import get_argument_parser

    action = get_argument_parser()._option_string_actions.get(option)
    return action is not None and action.nargs != 0


class _Relay:
    """Passes on what Snakemake says; a full disk is no traceback of it, but noted."""

    def __init__(self, process: subprocess.Popen[bytes], lines: ProgressLines) -> None:
        self._process, self._lines = process, lines
        self.unread, self.full_disk = threading.Event(), threading.Event()

    def pass_on(self, source: IO[bytes], target: TextIO) -> None:
        """Read an output to its end; a traceback is shown then, if it is not of a full disk."""
        before: list[str] = []  # what may lead to a line about a full disk
        held: list[str] = []  # from a traceback on
        for line in source:
            text = line.decode("utf-8", "replace")
            if any(number in line for number in _NO_ROOM):
                self.full_disk.set()
                before.clear()
            elif held or line.startswith(_TRACEBACK):
                held += [*before, text]
                before.clear()
            elif line.startswith(b"WorkflowError:") or not line.strip():
                before.append(text)
            elif line.startswith(COMPILING):
                tell_of_compiling()  # once, whichever jobs do
            elif text.startswith(RUNNING_JOBS):
                running = text.removeprefix(RUNNING_JOBS).strip()
                self._lines.running = running or "ending the workflow"
            elif not line.startswith(_PROFILE):
                self._show([*before, text], target)
                before.clear()
        if held:
            self.unread.wait(0.2)  # it may be of the interrupt that ends this command
        if not self.full_disk.is_set():
            self._show([*held, *before], target)

    def _show(self, texts: Sequence[str], target: TextIO) -> None:
        for text in texts if not self.unread.is_set() else ():
            try:
                self._lines.line(text, target)
            except (BrokenPipeError, ValueError):
                self.unread.set()
                self._process.send_signal(signal.SIGINT)
                break


def _relayed(command: Sequence[str], folder: Path, files: Sequence[int]) -> int:
    """Run Snakemake and pass on its output, until it is interrupted or nobody reads it."""
    # the program's own handler would leave Snakemake behind
    signal.signal(signal.SIGINT, signal.default_int_handler)
    pipe = CommandPipe()
    process = subprocess.Popen(
        command,
        cwd=folder,
        env=os.environ | pipe.environment | {RELAYED: str(folder)},
        pass_fds=[*files, pipe.file],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    pipe.started()
    lines = ProgressLines()
    lines.running = "starting the workflow"
    relay = _Relay(process, lines)
    assert process.stdout and process.stderr
    streams = ((process.stdout, sys.stdout), (process.stderr, sys.stderr))
    readers = [threading.Thread(target=relay.pass_on, args=pair, daemon=True) for pair in streams]
    for reader in readers:
        reader.start()
    try:
        with lines:
            for reader in readers:
                reader.join()
    except KeyboardInterrupt:
        relay.unread.set()  # what it says of being interrupted
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        _interrupt(process)
        pipe.tell_of_interrupt()
        raise
    finally:
        pipe.close()
    status = process.wait()
    if relay.full_disk.is_set():
        sys.stderr.write(one_line(f"{folder}: cannot be written ({os.strerror(errno.ENOSPC)})"))
    if relay.unread.is_set():
        raise BrokenPipeError
    return status


def _interrupt(process: subprocess.Popen[bytes]) -> None:
    """End Snakemake and its jobs; a terminal has signalled all of them already."""
    import psutil

    with contextlib.suppress(psutil.NoSuchProcess):
        for job in psutil.Process(process.pid).children(recursive=True):
            job.send_signal(signal.SIGINT)
    try:
        process.wait(0.1)
    except subprocess.TimeoutExpired:  # it was not, or waits for another job to end
        process.send_signal(signal.SIGINT)
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(0.4)  # then it tidies up alone, and keeps the folder locked meanwhile


@contextlib.contextmanager
def only_run(folder: Path) -> Iterator[int]:
    """Locks a study's folder against other commands of bearingwear; yields the open file.

    NoStudy: where one of them runs the study already.
    """
    path = folder / ".snakemake" / "bearingwear.lock"
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        held = path.open("a")
    except OSError as error:
        raise NoStudy(f"{folder}: cannot be used ({reason(error)})") from None
    with held:
        last = time.monotonic() + _LOCK_WAIT
        while True:
            try:
                fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                if time.monotonic() > last:
                    problem = "got a running study, expected a finished one"
                    raise NoStudy(f"{folder}: {problem}") from None
            time.sleep(0.1)
        yield held.fileno()


def launch_here(name: str, jobs: int, more: Sequence[str] = ()) -> int:
    """Run a study of the present folder; a bad configuration leaves no folder of Snakemake."""
    from bearingwear.scene.checking.errors import SceneError, shown
    from bearingwear.scene.checking.strict_yaml import data_of, text_of

    if not CONFIG.is_file():  # refused, and no folder made
        return launch(name, jobs, more)
    if "--configfile" not in more:
        data = data_of(text_of(CONFIG), str(CONFIG), anchors=True)
        if not isinstance(data, dict):
            raise SceneError("", f"got {shown(data)}, expected a block of keys", source=str(CONFIG))
    own = Path(".snakemake")
    known = own.exists()
    with only_run(Path()) as held:
        status = launch(name, jobs, more, files=[held])
    if status == _BAD_INPUT and not known:
        shutil.rmtree(own, ignore_errors=True)
    return status


def launch_own(
    folder: Path, jobs: int, held: int, more: Sequence[str] = ()
) -> tuple[int, Path | None]:
    """Run the study of a folder that `own.folder.write_study` made; a run that was killed goes on.

    held: what `only_run` gave for the folder.

    Returns `status`: exit status of Snakemake.
    Returns `page`: the page, beside the folders of the study; none where none was made.
    """
    # nobody runs it: a lock of Snakemake is left by a run that was killed
    shutil.rmtree(folder / ".snakemake" / "locks", ignore_errors=True)
    status = launch("all", jobs, [*more, "--rerun-incomplete"], folder, [held])
    return status, own_page(folder)


def own_page(folder: Path) -> Path | None:
    """The page of a study, copied beside its folders; none where none was made."""
    made, page = folder / PAGE, folder / PAGE.name
    if not made.is_file():
        return None
    root = "../" * (len(PAGE.parts) - 1)  # what its links to files begin with
    write_text(page, made.read_text(encoding="utf-8").replace(f'href="{root}', 'href="'))
    return page
