"""Writes the part of a Slurm profile on single rules: cases per job, and time limits.

`python benchmarks/slurm_profile.py PROFILE.yaml`, in the folder of a study, renews the part of the
profile between the two marks.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path

import yaml

from bearingwear.atomic import write_text
from bearingwear.studies import read
from bearingwear.studies.launch import CONFIG
from bearingwear.studies.protocol import Step, Study

FIRST_LINE = "# Written by `python benchmarks/slurm_profile.py`: from here"
LAST_LINE = "# to here."

SECONDS_OF_A_JOB = 180.0
"""Intended length of a Slurm job; Slurm and Snakemake add 5 s to each."""

MOST_IN_A_JOB = 100
LONG = 30.0
"""A job that takes so many seconds is a Slurm job of its own."""

SLOWEST = 40.0
"""Time limit as a multiple of the expected time, for a slow node or a first compilation."""


def in_a_job(step: Step) -> int:
    """How many jobs of a step are one of Slurm."""
    if step.seconds >= LONG:
        return 1
    return max(1, min(MOST_IN_A_JOB, int(SECONDS_OF_A_JOB / step.seconds)))


def minutes(step: Step) -> int:
    """Time limit of one job of a step, in whole minutes; Snakemake adds them up over a group."""
    return max(1, round(SLOWEST * step.seconds / 60.0))


def settings(studies: Mapping[str, Study]) -> str:
    """Groups, their sizes and time limits of all steps that are worth a process on another node."""
    steps = {
        f"{study.name}_{job.name}": job
        for study in studies.values()
        for job in study.jobs
        if isinstance(job, Step) and job.work > 0.0
    }
    grouped = {rule: in_a_job(step) for rule, step in steps.items() if in_a_job(step) > 1}
    limits = {rule: {"runtime": minutes(step)} for rule, step in steps.items()}
    return "\n".join(
        [
            _list("groups", {rule: rule for rule in grouped}),
            _list("group-components", grouped),
            yaml.safe_dump({"set-resources": limits}, sort_keys=False).rstrip(),
        ]
    )


def _list(key: str, pairs: Mapping[str, object]) -> str:
    """Pairs as Snakemake takes them: `- NAME=VALUE`."""
    return "\n".join([f"{key}:", *(f"  - {name}={value}" for name, value in pairs.items())])


def with_settings(profile: str, studies: Mapping[str, Study]) -> str:
    """A profile with its part between the marks made again."""
    before, _, rest = profile.partition(FIRST_LINE)
    _, _, after = rest.partition(LAST_LINE)
    return f"{before}{FIRST_LINE}\n{settings(studies)}\n{LAST_LINE}{after}"


def renew_profile(path: Path) -> None:
    """Make the part of a profile between the marks anew."""
    studies = read(yaml.safe_load(CONFIG.read_text(encoding="utf-8")))
    write_text(path, with_settings(path.read_text(encoding="utf-8"), studies))


if __name__ == "__main__":
    renew_profile(Path(sys.argv[1]))
