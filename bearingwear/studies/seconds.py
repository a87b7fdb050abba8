"""How long jobs take, as measured: a table of seconds for each rule and unit of its work.

`python -m bearingwear.studies.seconds`, in the folder of a study, renews the rows of the rules that
ran there, from Snakemake's benchmarks beside their logs. Slurm's profile and the time left use it.
"""

from __future__ import annotations

import csv
import functools
import io
import re
import statistics
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from bearingwear.studies.protocol import Step, Study

TABLE = Path(__file__).with_suffix(".csv")

NOT_MEASURED = 10.0
"""Seconds of a unit of work that nobody has measured, assumed."""


class JobTime(NamedTuple):
    """Seconds per unit of work of a rule: the median of so many jobs; 0: estimated."""

    seconds: float
    jobs: int


def beside_log(study: str, job: str, output: str, suffix: str) -> str:
    """Path of a job's log or benchmark, by its first output."""
    stem = output.removeprefix("results/").rpartition(".")[0]
    return f"logs/{study}/{job}/{stem}{suffix}"


def kind(rule: str) -> str:
    """Rule without its number, which grids of several lengths have: `grid_solve_2`."""
    return re.sub(r"_\d+$", "", rule)


@functools.cache
def job_times() -> dict[str, JobTime]:
    """What is known, by rule."""
    with TABLE.open(encoding="utf-8", newline="") as file:
        return {
            one["rule"]: JobTime(float(one["seconds"]), int(one["jobs"]))
            for one in csv.DictReader(file)
        }


def seconds_of(rule: str, work: float) -> float:
    """About what a job takes [s]."""
    return work * job_times().get(kind(rule), JobTime(NOT_MEASURED, 0)).seconds


def benchmarked(studies: Mapping[str, Study], folder: Path) -> dict[str, JobTime]:
    """Medians of the jobs that were run in the folder of a study, of steps with work."""
    found: dict[str, list[float]] = {}
    for study in studies.values():
        for step in study.jobs:
            if step.work > 0.0:
                for path in _benchmarks(study.name, step.steps[0]):
                    if (folder / path).is_file():
                        each = found.setdefault(kind(step.rule), [])
                        each.append(_wall_time(folder / path) / step.work)
    return {
        rule: JobTime(float(f"{statistics.median(each):.3g}"), len(each))
        for rule, each in found.items()
    }


def _benchmarks(study: str, step: Step) -> Iterator[str]:
    for job in step.jobs():
        yield beside_log(study, step.name, step.outputs[0], ".tsv").format(**job)


def _wall_time(path: Path) -> float:
    """Seconds of a benchmark of Snakemake, whose other columns are those of the waiting client."""
    with path.open(encoding="utf-8", newline="") as file:
        return float(next(csv.DictReader(file, delimiter="\t"))["s"])


def csv_text(rows: Mapping[str, JobTime]) -> str:
    text = io.StringIO()
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow(["rule", *JobTime._fields])
    lines.writerows([rule, f"{one.seconds:g}", one.jobs] for rule, one in sorted(rows.items()))
    return text.getvalue()


def renew_seconds() -> None:
    import yaml

    from bearingwear.atomic import write_text
    from bearingwear.studies import read
    from bearingwear.studies.launch import CONFIG

    studies = read(yaml.safe_load(CONFIG.read_text(encoding="utf-8")))
    write_text(TABLE, csv_text(job_times() | benchmarked(studies, Path())))


if __name__ == "__main__":
    renew_seconds()
