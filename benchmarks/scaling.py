"""Measure what a study of many cases costs besides solving them: planning, files, gathering.

    python benchmarks/scaling.py -o docs/scaling.md     # 100, 1000 and 10 000 cases; half an hour

Studies of one scene are planned by Snakemake and gathered by bearingwear in a copy of the project.
Each case is really solved, but by calls in one process, which is measured beside a process for each
case. A time is user and system time of a process and its children, the least of three (of 10 000
cases, of one), since wall time depends on what else the machine does. Memory is the largest
resident set of any of these processes.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import yaml

from bearingwear.model.solve import solve
from bearingwear.results.netcdf import write_result
from bearingwear.scene.variant import variant
from bearingwear.studies.grid.grid import Grid

ROOT = Path(__file__).resolve().parents[1]
SCENE = "gyro_s1"
SIZES = {100: (5, 10), 1000: (20, 25), 10_000: (50, 100)}  # friction coefficients, states of wear
STUDY = f"results/{SCENE}/study.nc"
BEGIN, END = "<!-- measured: begin -->", "<!-- measured: end -->"
# Takes each job through the scheduler and writes its record, but runs nothing. Left to itself, it
# sleeps a tenth of a second for each job.
TOUCH = [
    sys.executable,
    "-c",
    "from snakemake.executors.touch import Executor; Executor.SLEEPING_TIME = 0; "
    "from snakemake.cli import main; main()",
    *(STUDY, "--touch", "--forceall", "-j2", "--nocolor", "--quiet", "all"),
]
# Runs a command and writes status, CPU time and largest memory into a file. A process of its own,
# since a child's largest memory begins with that of the process it was forked from.
PROBE = (
    "import os, sys; pid = os.fork(); "
    "pid or os.execv(sys.argv[2], sys.argv[2:]); "
    "_, status, used = os.wait4(pid, 0); "
    "open(sys.argv[1], 'w').write(f'{status} {used.ru_utime + used.ru_stime} {used.ru_maxrss}')"
)
SLURM = ("--workflow-profile", "workflow/profiles/slurm")


@dataclass(frozen=True)
class Cost:
    """Of a command."""

    cpu_s: float
    memory_MB: float
    text: str


def cost(command: list[str], cwd: Path, repeats: int) -> Cost:
    """Run a command and see what it takes."""
    environment = os.environ | {"PYTHONPATH": str(cwd)}
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
    return [sys.executable, "-m", "snakemake", "--nocolor", *arguments]


def axes(cases: int) -> dict[str, list]:
    """The axes of a study of so many cases."""
    frictions, losses = SIZES[cases]
    step = max(0.01, 0.7 / losses)
    return {
        "preload_method": ["constant_force", "fixed_position"],
        "friction": [round(0.02 + 0.1 * k / frictions, 3) for k in range(frictions)],
        "ball_diameter_loss_um": [round(k * step, 2) for k in range(losses)],
    }


def case_files(cases: int) -> list[str]:
    return [f"results/{SCENE}/cases/{name}.nc" for name in Grid.from_lists(**axes(cases)).cases()]


def new_project(folder: Path, cases: int) -> Path:
    """A copy of the project with a study of so many cases, nothing solved."""
    root = folder / str(cases)
    for name in ("bearingwear", "config", "docs", "workflow"):
        shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns("numba-*"))
    shutil.copy2(ROOT / "Snakefile", root)
    config = {
        "studies": [{"scenes": [SCENE]} | axes(cases)],
        "figures": {"worn_loss_um": 0.0, "friction": [0.02]},
    }
    (root / "config/config.yaml").write_text(yaml.safe_dump(config))
    return root


def solved_in_process(root: Path, cases: int) -> float:
    """Solve every case by calls in this process; returns the CPU time of one [s]."""
    grid = Grid.from_lists(**axes(cases)).cases().values()
    scene = root / f"config/scenes/{SCENE}.yaml"
    started = time.process_time()
    for case, path in zip(grid, case_files(cases), strict=True):
        write_result(solve(variant(scene, case.changes)), root / path)
    return (time.process_time() - started) / cases


def files(root: Path, pattern: str) -> tuple[int, float]:
    """How many there are, and how many MB."""
    found = [path for path in root.glob(pattern) if path.is_file()]
    return len(found), sum(path.stat().st_size for path in found) / 1e6


def measured(root: Path, cases: int, repeats: int) -> dict[str, str]:
    """A column of the table."""
    column = {}

    def told(what: str, one: Cost) -> None:
        column[f"{what} [s]"] = f"{one.cpu_s:.1f}"
        column[f"{what} [MB]"] = f"{one.memory_MB:.0f}"
        print(f"{cases}: {what}: {one.cpu_s:.2f} s, {one.memory_MB:.0f} MB", flush=True)

    quiet = ("-n", "--quiet", "all")
    told("plan, `snakemake -n`", cost(snakemake("-n"), root, repeats))
    told("plan, `-n --quiet`", cost(snakemake(*quiet), root, repeats))
    told("plan, `--batch all=1/10`", cost(snakemake(*quiet, "--batch", "all=1/10"), root, repeats))
    grouped = cost(snakemake("-n", *SLURM), root, 1)
    told("plan, Slurm profile", grouped)
    column["Slurm jobs of these cases"] = str(grouped.text.count("Group job cases"))
    column["solve, calls in one process [ms a case]"] = (
        f"{solved_in_process(root, cases) * 1e3:.0f}"
    )
    gather = [sys.executable, "-m", "bearingwear", "gather", *case_files(cases), "-o", STUDY]
    told("gather", cost(gather, root, repeats))
    told("schedule and record", cost(TOUCH, root, 1))
    told("plan, nothing to do", cost(snakemake(STUDY, *quiet), root, repeats))
    for what, pattern in (
        ("case files", "results/*/cases/*.nc"),
        ("records of Snakemake", ".snakemake/metadata/**/*"),
    ):
        number, size = files(root, pattern)
        column[what] = f"{number}, {size:.1f} MB"
    column["study.nc"] = f"{files(root, STUDY)[1]:.2f} MB"
    return column


def one_process_a_case(folder: Path) -> list[str]:
    """What a case costs that is solved by a process of its own, alone and under Snakemake."""
    root = new_project(folder, 100)
    first, *others = case_files(100)
    command = [sys.executable, "-m", "bearingwear", "solve", f"config/scenes/{SCENE}.yaml"]
    cost([*command, "-o", "warm.nc"], root, 1)  # compiles
    alone = cost([*command, "-o", "warm.nc"], root, 5)
    start = cost([sys.executable, "-c", "import bearingwear.model.solve, netCDF4"], root, 5)
    empty = cost(snakemake("-j1", first), root, 1)
    twenty = cost(snakemake("-j1", *others[:20]), root, 1)
    number = len([p for p in root.glob("logs/**/*") if p.is_file()])
    shutil.rmtree(root)
    return [
        f"A process for each case takes {alone.cpu_s:.2f} s and {alone.memory_MB:.0f} MB, of which "
        f"Python and the imports take {start.cpu_s:.2f} s. Twenty of them under Snakemake take "
        f"{(twenty.cpu_s - empty.cpu_s) / 19:.2f} s each, and leave {number / 21:.0f} files each "
        "under `logs/`.",
    ]


def table(columns: dict[int, dict[str, str]]) -> list[str]:
    sizes = list(columns)
    lines = [f"| cases | {' | '.join(map(str, sizes))} |", "| --- |" + " ---: |" * len(sizes)]
    for what in columns[sizes[0]]:
        lines.append(f"| {what} | {' | '.join(columns[size][what] for size in sizes)} |")
    return lines


def put_into(path: Path, lines: list[str]) -> None:
    before, _, rest = path.read_text(encoding="utf-8").partition(BEGIN)
    _, _, after = rest.partition(END)
    text = "\n".join([BEGIN, *lines, END])
    path.write_text(before + text + after, encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, nargs="+", choices=list(SIZES), default=list(SIZES))
    parser.add_argument("--repeats", type=int, default=3, help="of each command, the least counts")
    parser.add_argument("-o", "--output", type=Path, help="document to put the table into")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        lines = one_process_a_case(Path(folder))
        print(*lines, flush=True)
        columns = {}
        for size in given.cases:
            root = new_project(Path(folder), size)
            columns[size] = measured(root, size, given.repeats if size < 10_000 else 1)
            shutil.rmtree(root)
    lines = [*lines, "", *table(columns)]
    print(*lines, sep="\n")
    if given.output:
        put_into(given.output, lines)


if __name__ == "__main__":
    main()
