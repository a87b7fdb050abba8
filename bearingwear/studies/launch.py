"""Runs a study by Snakemake's command line, in the present folder or in that of one scene."""

from __future__ import annotations

import contextlib
import fcntl
import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NoReturn

from bearingwear.atomic import reason, write_text
from bearingwear.console import UsageError
from bearingwear.provenance import PACKAGE
from bearingwear.studies import guard
from bearingwear.studies.configuration import headlines

CONFIG = Path("config/config.yaml")
PAGE = Path("results/report/index.html")

DRY_RUN = {"-n", "--dry-run", "--dryrun"}

OWN_STUDY = "BEARINGWEAR_STUDY"
"""Variable of the environment in a study of one scene, whose page has a copy of its own."""


class NoStudy(UsageError):
    """A folder without a study, or an installation without the workflow; one line."""


def snakefile() -> Path:
    """Returns the Snakefile of this package: beside it in a checkout, else the installed one."""
    places = [PACKAGE.parent, Path(sys.prefix) / "share" / "bearingwear"]
    for folder in places:
        if (folder / "Snakefile").is_file():
            return folder / "Snakefile"
    raise NoStudy(f"study: found no workflow in {', '.join(map(str, places))}")


def run_study(
    target: str,
    jobs: int,
    extra_arguments: Sequence[str] = (),
    folder: Path = Path(),
    files: Sequence[int] = (),
    scene_folder: str = "",
) -> int:
    """Runs a target of the workflow in a folder with a configuration.

    extra_arguments: further arguments of Snakemake.
    files: open files that Snakemake keeps open while it runs.
    scene_folder: folder of the study of one scene, empty for other studies.

    Returns the exit status of Snakemake.
    """
    if not (folder / CONFIG).is_file():
        scene_file = Path(f"{target}.yaml")
        if scene_file.is_file():
            problem = f"got {target}, expected SCENE.yaml; did you mean {scene_file}"
            raise NoStudy(f"study: {problem}")
        raise NoStudy(
            f"study: got {target} in a folder without {CONFIG}, expected SCENE.yaml, or a folder "
            "that contains a study"
        )
    script = str(PACKAGE / "run_module.py")
    command = [
        script,
        "snakemake",
        "--snakefile",
        str(snakefile()),
        f"-j{jobs}",
        target,
        *extra_arguments,
    ]
    environment = {**os.environ, **({OWN_STUDY: scene_folder} if scene_folder else {})}
    return _run_guarded([sys.executable, "-P", *command], folder, files, environment)


def run_own_study(
    folder: Path, jobs: int, extra_arguments: Sequence[str] = ()
) -> tuple[int, Path | None]:
    """Runs the study of one scene in its folder, or continues a run that was killed.

    Returns `status`: the exit status of Snakemake.
    Returns `page`: the report page beside the folders of the study, or None without one.
    """
    with _only_run(folder) as lock_file:
        # this lock ends with the processes that hold it, Snakemake's would stay after a kill
        extra_arguments = [*extra_arguments, "--nolock", "--rerun-incomplete"]
        status = run_study("all", jobs, extra_arguments, folder, [lock_file], str(folder))
    return status, None if DRY_RUN & set(extra_arguments) else own_page(folder)


_INSTEAD = dict.fromkeys(
    ("--json", "--csv"),
    "`bearingwear recommend` prints its sheet so, and `bearingwear show` any result of the study",
) | {"--fidelity": "the study solves with model.fidelity", "--set": "edit the scene"}
"""What other commands accept and a study does not, and what to do."""


def check_arguments(arguments: Sequence[str], is_own_study: bool) -> None:
    """Refuses arguments that Snakemake does not know, and targets in the study of one scene.

    UsageError: the first of them, in one line.
    """
    if not set(arguments) - DRY_RUN:
        return
    from snakemake.cli import get_argument_parser

    parser = get_argument_parser()

    def refuse(problem: str) -> NoReturn:
        raise UsageError(f"bearingwear study: {problem}; see bearingwear study --help")

    parser.error = refuse
    known, unknown = parser.parse_known_args([*arguments])
    if unknown:
        option = unknown[0].partition("=")[0]
        advice = f"; {_INSTEAD[option]}" if option in _INSTEAD else ""
        refuse(f"got {option!r}, which this command does not accept{advice}")
    if is_own_study and known.targets:
        refuse(f"got {[*known.targets][0]!r} after the scene, expected one scene and options")


def _run_guarded(
    command: Sequence[str], folder: Path, files: Sequence[int], environment: Mapping[str, str]
) -> int:
    """Runs a command in a folder and returns its status; it never outlives this process."""
    # the program's own handler would end without waiting for the command
    signal.signal(signal.SIGINT, signal.default_int_handler)
    process = subprocess.Popen(
        [sys.executable, "-P", str(guard.__file__), *command],
        cwd=folder,
        stdin=subprocess.PIPE,
        pass_fds=files,
        env=environment,
        start_new_session=True,
    )
    try:
        return process.wait()
    except KeyboardInterrupt:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        assert process.stdin is not None
        process.stdin.close()
        process.wait()
        raise


@contextlib.contextmanager
def _only_run(folder: Path) -> Iterator[int]:
    """Locks a study's folder against another run, and yields the open file.

    NoStudy: another run has the lock.
    """
    path = folder / ".snakemake" / "bearingwear.lock"
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        file = path.open("a")
    except OSError as error:
        raise NoStudy(f"{folder}: cannot be used ({reason(error)})") from None
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            problem = "got a running study, expected a finished one"
            raise NoStudy(f"{folder}: {problem}") from None
        yield file.fileno()


def own_page(folder: Path) -> Path | None:
    """Copies the page of a study beside its folders and returns its path; None without a page."""
    report, page = folder / PAGE, folder / PAGE.name
    if not report.is_file():
        return None
    root_prefix = "../" * (len(PAGE.parts) - 1)  # what its links to files begin with
    write_text(page, report.read_text(encoding="utf-8").replace(f'href="{root_prefix}', 'href="'))
    return page


def own_findings(folder: Path, name: str) -> list[str]:
    """Returns the titles of what the study of a scene found, recommendations first."""
    results = folder / "results"
    answers = (results / "answer.json", results / name / "preload" / "answer.json")
    return headlines(str(path) for path in answers if path.is_file())
