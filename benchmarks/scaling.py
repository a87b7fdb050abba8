"""Measure what a study of many points costs: planning, solving, gathering.

    python benchmarks/scaling.py -o docs/scaling.md     # from 100 to 100 000 points; half an hour

Studies of one scene, by lines and by chunks of the grid, each in its own folder. A time is user
and system time of a process and its children, the least of three (from 10 000 points on, of one),
since wall time depends on what else the machine does. Memory is the largest resident set of any of
these processes.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[1]
SCENE = "gyro_s1"
STUDY = f"results/{SCENE}/study.nc"
BEGIN, END = "<!-- measured: begin -->", "<!-- measured: end -->"


@dataclass(frozen=True)
class Size:
    """A study of two preload methods; `points_per_job` as in config.yaml."""

    frictions: int
    losses: int
    points_per_job: int | None

    @property
    def points(self) -> int:
        return 2 * self.frictions * self.losses

    @property
    def label(self) -> str:
        return f"{self.points}, {self.points_per_job or 'lines'}"

    def config(self) -> dict:
        """What config.yaml says."""
        block = {
            "scenes": [SCENE],
            "preload_method": ["constant_force", "fixed_position"],
            "friction": [round(0.02 + 0.001 * k, 3) for k in range(self.frictions)],
            "ball_diameter_loss_um": [round(0.01 * k, 2) for k in range(self.losses)],
        }
        figures = {"worn_loss_um": 0.0, "friction": block["friction"][:1]}
        return {
            "studies": [block],
            "figures": figures,
            "points_per_job": self.points_per_job,
        }


SIZES = [
    Size(5, 10, None),
    Size(20, 25, None),
    Size(20, 25, 500),
    Size(100, 50, 1000),
    Size(100, 500, 10_000),
]
# Runs a command and writes status, CPU time and largest memory into a file. A process of its own,
# since a child's largest memory begins with that of the process it was forked from. It adopts and
# waits for processes that outlive their parents (PR_SET_CHILD_SUBREAPER): jobs are forks of one.
PROBE = """
import ctypes, os, resource, sys
ctypes.CDLL(None).prctl(36, 1, 0, 0, 0)
pid = os.fork()
pid or os.execv(sys.argv[2], sys.argv[2:])
_, status = os.waitpid(pid, 0)
try:
    while True:
        os.wait()
except ChildProcessError:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
with open(sys.argv[1], "w") as file:
    file.write(f"{status} {used.ru_utime + used.ru_stime} {used.ru_maxrss}")
"""


@dataclass(frozen=True)
class Cost:
    """Of a command."""

    cpu_s: float
    memory_MB: float
    text: str


def cost(command: list[str], cwd: Path, repeats: int) -> Cost:
    """Run a command and see what it takes."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    found = []
    for _ in range(repeats):
        with tempfile.NamedTemporaryFile("r") as used:
            probe = [sys.executable, "-S", "-c", PROBE, used.name, *command]
            done = subprocess.run(
                probe, cwd=cwd, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
            )
            status, cpu, memory = used.read().split()
        text = done.stdout.decode()
        if int(status):
            sys.exit(f"{' '.join(command)[:200]}: {text[-2000:]}")
        found.append(Cost(float(cpu), float(memory) / 1024, text))
    return min(found, key=lambda one: one.cpu_s)


def snakemake(*arguments: str) -> list[str]:
    own = ["--snakefile", str(ROOT / "Snakefile"), "--nocolor"]
    return [sys.executable, "-m", "snakemake", *own, *arguments]


def new_study(root: Path, size: Size) -> None:
    """A folder with a study, nothing solved."""
    (root / "config/scenes").mkdir(parents=True)
    shutil.copy2(ROOT / f"config/scenes/{SCENE}.yaml", root / "config/scenes")
    (root / "config/config.yaml").write_text(yaml.safe_dump(size.config()))


def files(root: Path, pattern: str) -> tuple[int, float]:
    """How many there are, and how many MB."""
    found = [path for path in root.glob(pattern) if path.is_file()]
    return len(found), sum(path.stat().st_size for path in found) / 1e6


def measured(root: Path, size: Size, repeats: int) -> dict[str, str]:
    """A column of the table."""
    column = {}

    def told(what: str, one: Cost) -> Cost:
        column[f"{what} [s]"] = f"{one.cpu_s:.1f}"
        column[f"{what} [MB]"] = f"{one.memory_MB:.0f}"
        print(f"{size.label}: {what}: {one.cpu_s:.2f} s, {one.memory_MB:.0f} MB", flush=True)
        return one

    plan = snakemake(STUDY, "-n", "--quiet", "all")
    told("plan", cost(plan, root, repeats))
    solved = told("solve and gather", cost(snakemake(STUDY, "-j2", "--quiet", "all"), root, 1))
    column["solve and gather, per point [ms]"] = f"{solved.cpu_s / size.points * 1e3:.1f}"
    parts = sorted(
        str(path.relative_to(root))
        for folder in ("cases", "chunks")
        for path in root.glob(f"results/{SCENE}/{folder}/*.nc")
    )
    gather = [sys.executable, "-m", "bearingwear", "gather", *parts, "-o", STUDY]
    told("gather alone", cost(gather, root, repeats))
    told("plan, nothing to do", cost([*plan, "--rerun-triggers", "params"], root, repeats))
    number, megabytes = files(root, f"results/{SCENE}/c*/*.nc")
    column["files of points"] = f"{number}, {megabytes:.1f} MB"
    column["study.nc"] = f"{files(root, STUDY)[1]:.1f} MB"
    return column


def table(columns: dict[Size, dict[str, str]]) -> list[str]:
    labels = [size.label for size in columns]
    lines = [f"| points, by job | {' | '.join(labels)} |", "| --- |" + " ---: |" * len(labels)]
    for what in next(iter(columns.values())):
        lines.append(f"| {what} | {' | '.join(column[what] for column in columns.values())} |")
    return lines


def put_into(path: Path, lines: list[str]) -> None:
    before, _, rest = path.read_text(encoding="utf-8").partition(BEGIN)
    _, _, after = rest.partition(END)
    text = "\n".join([BEGIN, *lines, END])
    path.write_text(before + text + after, encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--most", type=int, default=SIZES[-1].points, help="points at the most")
    parser.add_argument("--repeats", type=int, default=3, help="of each command, the least counts")
    parser.add_argument("-o", "--output", type=Path, help="document to put the table into")
    given = parser.parse_args()
    columns = {}
    for size in SIZES:
        if size.points <= given.most:
            with tempfile.TemporaryDirectory() as folder:
                new_study(Path(folder), size)
                repeats = given.repeats if size.points < 10_000 else 1
                columns[size] = measured(Path(folder), size, repeats)
    lines = table(columns)
    print(*lines, sep="\n")
    if given.output:
        put_into(given.output, lines)


if __name__ == "__main__":
    main()
