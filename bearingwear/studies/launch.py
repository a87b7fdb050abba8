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
    """Returns the path of the Snakefile: beside this package in a checkout, else the installed one.

    NoStudy: there is none.
    """
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

    jobs: largest number of simultaneous jobs.
    extra_arguments: further arguments of Snakemake.
    files: descriptors of files that Snakemake keeps open while it runs.
    scene_folder: folder of the study of one scene, empty for other studies.
    NoStudy: the folder has no configuration, or there is no workflow.

    Returns the exit status of Snakemake.
    """
    scene_file = Path(f"{Path(target)}.yaml")
    if not scene_folder and scene_file.is_file():
        problem = f"got {target}, expected SCENE.yaml; did you mean {scene_file}"
        raise NoStudy(f"study: {problem}")
    if not (folder / CONFIG).is_file():
        raise NoStudy(
            f"study: got {target} in a folder without {CONFIG}, expected SCENE.yaml, or a folder "
            "that contains a study"
        )
    command = [
        sys.executable,
        "-P",
        str(PACKAGE / "run_module.py"),
        "snakemake",
        "--snakefile",
        str(snakefile()),
        f"-j{jobs}",
        target,
        *extra_arguments,
    ]
    environment = dict(os.environ)
    if scene_folder:
        environment[OWN_STUDY] = scene_folder
    return _run_guarded(command, folder, files, environment)


def run_own_study(
    folder: Path, jobs: int, extra_arguments: Sequence[str] = ()
) -> tuple[int, Path | None]:
    """Runs the study of one scene in its folder, or continues a run that was killed.

    jobs, extra_arguments: as of `run_study`.
    NoStudy: another run is in the folder, or it has no configuration or cannot be used.

    Returns the exit status of Snakemake, and the path of the report page, which is copied beside
        the folders of the study. The path is None if there is no page, and after a dry run.
    """
    with _only_run(folder) as lock_file:
        # this lock ends with the processes that hold it, Snakemake's would stay after a kill
        extra_arguments = [*extra_arguments, "--nolock", "--rerun-incomplete"]
        status = run_study(
            "all",
            jobs,
            extra_arguments,
            folder=folder,
            files=[lock_file],
            scene_folder=str(folder),
        )
    if DRY_RUN & set(extra_arguments):
        return status, None
    return status, copy_own_page(folder)


_ADVICE = dict.fromkeys(
    ("--json", "--csv"),
    "`bearingwear recommend` prints its sheet so, and `bearingwear show` any result of the study",
) | {"--fidelity": "the study solves with model.fidelity", "--set": "edit the scene"}
"""What to do instead, by options that other commands accept and a study does not."""


def check_arguments(arguments: Sequence[str], is_own_study: bool) -> None:
    """Refuses arguments that Snakemake does not know, and targets in the study of one scene.

    Arguments that only ask for a dry run pass at once, without the slow import of the parser.

    is_own_study: whether the study is of one scene.
    UsageError: the first of them, in one line.
    """
    if not set(arguments) - DRY_RUN:
        return
    from snakemake.cli import get_argument_parser

    parser = get_argument_parser()

    def refuse(problem: str) -> NoReturn:
        """Raises a UsageError, where the parser would print its usage and exit."""
        raise UsageError(f"bearingwear study: {problem}; see bearingwear study --help")

    parser.error = refuse
    options, unknown = parser.parse_known_args([*arguments])
    if unknown:
        option = unknown[0].partition("=")[0]
        advice = f"; {_ADVICE[option]}" if option in _ADVICE else ""
        refuse(f"got {option!r}, which this command does not accept{advice}")
    if is_own_study and options.targets:
        target = next(iter(options.targets))
        refuse(f"got {target!r} after the scene, expected one scene and options")


def _run_guarded(
    command: Sequence[str], folder: Path, files: Sequence[int], environment: Mapping[str, str]
) -> int:
    """Runs a command in a folder and returns its exit status; it never outlives this process.

    An interrupt ends the command; KeyboardInterrupt is raised after that. The handler of SIGINT is
    replaced, and stays so.

    files: descriptors of open files that the command inherits.
    """
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
    """Locks a study's folder against another run, and yields the descriptor of the lock file.

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


def copy_own_page(folder: Path) -> Path | None:
    """Copies the page of a study beside its folders; returns the path of the copy.

    Links are changed so that they lead from the copy to the same files. Without a page, it returns
    None.
    """
    report = folder / PAGE
    page = folder / PAGE.name
    if not report.is_file():
        return None
    root_prefix = "../" * (len(PAGE.parts) - 1)  # with which its links to files begin
    write_text(page, report.read_text(encoding="utf-8").replace(f'href="{root_prefix}', 'href="'))
    return page


def own_headlines(folder: Path, name: str) -> list[str]:
    """Returns the titles of the answers that lead the page of a scene's study.

    The list is empty if the study has no answer yet.

    folder: of the study.
    name: of the scene.
    """
    results = folder / "results"
    answers = (results / "answer.json", results / name / "preload" / "answer.json")
    return headlines(str(path) for path in answers if path.is_file())
