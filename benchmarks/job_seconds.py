"""Renews the table of how long jobs take: `python benchmarks/job_seconds.py`.

In the folder of a study, from Snakemake's benchmarks beside the logs of the rules that ran there.
"""

from __future__ import annotations

import csv
import io
import statistics
from collections.abc import Iterator, Mapping
from pathlib import Path

import yaml

from bearingwear.atomic import write_text
from bearingwear.studies import read
from bearingwear.studies.launch import CONFIG
from bearingwear.studies.protocol import Step, Study
from bearingwear.studies.seconds import TABLE, JobTime, beside_log, job_times, kind


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
    studies = read(yaml.safe_load(CONFIG.read_text(encoding="utf-8")))
    write_text(TABLE, csv_text(job_times() | benchmarked(studies, Path())))


if __name__ == "__main__":
    renew_seconds()
