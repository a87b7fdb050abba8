"""How long jobs take, as measured: a table of seconds for each rule and unit of its work.

Slurm's profile and the time left use it. `benchmarks/job_seconds.py` renews it.
"""

from __future__ import annotations

import csv
import functools
import re
from pathlib import Path
from typing import NamedTuple

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
