"""A small study in a copy of the project, solved once and handed to each test as a copy of its own.

The copies use the compiled kernels of the project itself, which are found by their contents.
"""

import atexit
import functools
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import pytest
import yaml
from support import PACKAGES, ROOT, copy_tree

from bearingwear.kernels.project import PROJECT

# a small study: 8 cases of a scene, and 2 of another
CONFIG = {
    "studies": [
        {
            "scenes": ["gyro_s1"],
            "preload_method": ["constant_force", "fixed_position"],
            "friction": [0.02, 0.08],
            "ball_diameter_loss_um": [0, 0.5],
        },
        {
            "scenes": ["gyro_s1_drag"],
            "preload_method": ["fixed_position"],
            "friction": [0.02],
            "ball_diameter_loss_um": [0, 0.5],
        },
    ],
    "figures": {
        "worn_loss_um": 0.5,
        "friction": [0.02, 0.08],
        "wear_columns": [
            {"scene": "gyro_s1_drag", "friction": 0.02},
            {"scene": "gyro_s1", "friction": 0.08},
        ],
        "spreads": {"drag": {"scenes": ["gyro_s1", "gyro_s1_drag"], "friction": 0.02}},
    },
}


@functools.cache
def planner() -> subprocess.Popen:
    """Starts the process that runs Snakemake for the tests of this process, and returns it."""
    process = subprocess.Popen(
        [sys.executable, str(Path(__file__).with_name("planner.py"))],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env={key: value for key, value in os.environ.items() if key != "PYTHONPATH"},
    )
    atexit.register(process.kill)
    return process


JOBS = re.compile(r"^Job stats.*\n(?:.*\n)*?((?: *[a-z].*? +\d+ *\n)+)", re.M)
"""Rows of the table of jobs, by Snakemake itself or by the plugin that shows its progress."""


def _options(jobs: int | None) -> list[str]:
    """Returns the options of each run; `jobs` is None for a command that runs no job."""
    return [*([] if jobs is None else [f"-j{jobs}"]), "--nocolor"]


@dataclass(frozen=True)
class Project:
    """A copy of the project."""

    root: Path

    @property
    def environment(self) -> dict[str, str]:
        """Returns the variables of a run, which finds the package in the present folder."""
        variables = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        return variables | {"NUMBA_CACHE_DIR": str(Path(PROJECT.code_folder).parent)}

    def command(self, *arguments: str, jobs: int | None = 2) -> list[str]:
        """Returns the words of a command that runs Snakemake.

        jobs: number that may run at once, or None for a command that runs no job.
        """
        return [sys.executable, "-P", "-m", "snakemake", *_options(jobs), *arguments]

    def run(self, *arguments: str, jobs: int | None = 2, prefix: Sequence[str] = ()) -> "Run":
        """Runs Snakemake in the copy until it ends, by another program if a prefix is given."""
        before = self._logs()
        run = self._run(arguments, jobs, prefix)
        logs = sorted(self._logs() - before)  # which alone have the table of jobs of a run
        table = JOBS.search(logs[-1].read_text(encoding="utf-8")) if logs else None
        return Run(run.status, (table[0] if table else "") + run.text)

    @property
    def last_jobs(self) -> dict[str, int]:
        """Returns how many jobs of each rule the last run planned, by its log."""
        return Run(0, max(self._logs()).read_text(encoding="utf-8")).jobs

    def _logs(self) -> set[Path]:
        """Returns the logs that Snakemake has written in the copy."""
        return set((self.root / ".snakemake/log").glob("*.log"))

    def _run(self, arguments: Sequence[str], jobs: int | None, prefix: Sequence[str]) -> "Run":
        """Runs Snakemake: by `planner`, or by another program whose words are the prefix."""
        if not prefix:
            return self._run_by_planner([*_options(jobs), *arguments])
        completed = subprocess.run(
            [*prefix, *self.command(*arguments, jobs=jobs)],
            cwd=self.root,
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=900,
        )
        return Run(completed.returncode, completed.stdout + completed.stderr)

    def _run_by_planner(self, arguments: Sequence[str]) -> "Run":
        """Runs Snakemake by `planner`, which has it imported."""
        server = planner()
        with tempfile.NamedTemporaryFile() as output:
            request = {"arguments": [*arguments], "folder": str(self.root), "output": output.name}
            server.stdin.write(json.dumps(request | {"environment": self.environment}) + "\n")
            server.stdin.flush()
            status = int(server.stdout.readline())
            return Run(status, Path(output.name).read_text(encoding="utf-8", errors="replace"))

    def start(self, *arguments: str) -> subprocess.Popen:
        """Starts Snakemake in the copy, in a group of processes of its own, and does not wait."""
        return subprocess.Popen(
            self.command(*arguments),
            cwd=self.root,
            env=self.environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )

    def edit(self, path: str, old: str, new: str) -> None:
        """Replaces the first occurrence of a text in a file, which must have it."""
        file = self.root / path
        text = file.read_text(encoding="utf-8")
        assert old in text, f"{path} has no {old!r}"
        file.write_text(text.replace(old, new, 1), encoding="utf-8")

    def change_source(self, path: str, date: float) -> None:
        """Adds a comment to a source, and gives it this date [s since 1970]."""
        with (self.root / path).open("a", encoding="utf-8") as file:
            file.write("# changed\n")
        os.utime(self.root / path, (date, date))

    def configure(self, config: dict) -> None:
        """Writes the configuration of the study."""
        (self.root / "config/config.yaml").write_text(yaml.safe_dump(config), encoding="utf-8")

    @property
    def config(self) -> dict:
        """Returns the configuration of the study."""
        return yaml.safe_load((self.root / "config/config.yaml").read_text(encoding="utf-8"))

    def case(self, case_id: str, scene: str = "gyro_s1") -> Path:
        """Returns the path of a case, which need not be there."""
        return self.root / f"results/{scene}/cases/{case_id}.nc"

    def cases(self) -> list[Path]:
        """Returns the files of cases that are there; hidden ones are still being written."""
        return sorted((self.root / "results").glob("*/cases/[!.]*.nc"))

    def results(self) -> dict[str, bytes]:
        """Returns the bytes of all files in `results/`, by their paths there."""
        folder = self.root / "results"
        files = (path for path in sorted(folder.rglob("*")) if path.is_file())
        return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


@dataclass(frozen=True)
class Run:
    """Exit status of Snakemake, and what it printed: the table of jobs, if any, comes first."""

    status: int
    text: str

    @property
    def jobs(self) -> dict[str, int]:
        """Returns how many jobs of each rule were planned, without the rule `all`."""
        table = JOBS.search(self.text)
        if not table:
            return {}
        rows = (line.strip().rpartition(" ") for line in table.group(1).splitlines())
        jobs = {rule.strip().replace(" ", "_"): int(count) for rule, _, count in rows}
        return {rule: count for rule, count in jobs.items() if rule not in ("all", "total")}


@pytest.fixture(scope="session")
def repository():
    """Returns the project itself, with its whole study; no test may run jobs there."""
    return Project(ROOT)


@pytest.fixture(scope="session")
def new_project(tmp_path_factory):
    """Returns a function that makes a copy of the project with CONFIG and nothing solved."""

    def make() -> Project:
        root = tmp_path_factory.mktemp("project")
        copy_tree(root, *PACKAGES, "config", "docs", "workflow", "profiles")
        shutil.copy2(ROOT / "Snakefile", root)
        project = Project(root)
        project.configure(CONFIG)
        return project

    return make


@pytest.fixture(scope="session")
def first_run(new_project, made_once):
    """Returns the small study, which no test may change, and the `Run` that solved it."""

    def make(folder: Path) -> None:
        project = new_project()
        run = project.run()
        assert run.status == 0, run.text
        project.root.rename(folder / "project")
        (folder / "run.json").write_text(json.dumps(asdict(run)), encoding="utf-8")

    folder = made_once("first_run", make)
    run = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    return Project(folder / "project"), Run(**run)


@pytest.fixture
def solved_study(first_run, tmp_path) -> Project:
    """Returns a copy of the solved study, which a test may change."""
    root = tmp_path / "moved project"  # a space in the path
    shutil.copytree(first_run[0].root, root)
    return Project(root)
