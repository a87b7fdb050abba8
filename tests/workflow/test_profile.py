"""The Slurm profile says of each rule what its step says."""

import pytest
import yaml
from support import ROOT, benchmark

from bearingwear import studies
from bearingwear.studies.protocol import Step, Study
from bearingwear.studies.protocol import step as study_step
from bearingwear.studies.seconds import NOT_MEASURED, JobTime, job_times, seconds_of

slurm_profile, job_seconds = benchmark("slurm_profile"), benchmark("job_seconds")
in_a_job, minutes = slurm_profile.in_a_job, slurm_profile.minutes

PROFILE = ROOT / "workflow" / "profiles" / "slurm" / "profile.yaml"


def step(seconds):
    work = seconds / NOT_MEASURED
    return Step(name="a", run="studies.a.b", outputs=("c",), label="d", work=work)


@pytest.mark.parametrize(
    ("seconds", "jobs", "limit"),
    [
        (0.1, 100, 1),
        (1.5, 100, 1),
        (8.5, 21, 6),
        (14.0, 12, 9),
        (29.0, 6, 19),
        (30.0, 1, 20),
        (1e4, 1, 6667),
    ],
)
def test_a_slurm_job_takes_three_minutes_and_has_forty_times_that(seconds, jobs, limit):
    assert in_a_job(step(seconds)) == jobs
    assert minutes(step(seconds)) == limit


def test_the_profile_is_current(monkeypatch):
    """`python benchmarks/slurm_profile.py workflow/profiles/slurm/profile.yaml` renews it."""
    monkeypatch.chdir(ROOT)
    config = yaml.safe_load((ROOT / "config/config.yaml").read_text(encoding="utf-8"))
    made = studies.read(config)
    text = PROFILE.read_text(encoding="utf-8")
    assert slurm_profile.with_settings(text, made) == text
    profile = yaml.safe_load(text)
    rules = {f"{name}_{step.name}" for name, study in made.items() for step in study.steps}
    grouped = dict(pair.split("=") for pair in profile["groups"])
    sizes = dict(pair.split("=") for pair in profile["group-components"])
    assert set(grouped) | set(profile["set-resources"]) <= rules
    assert set(sizes) == set(grouped.values())
    assert all(1 < int(size) <= 100 for size in sizes.values())


def test_seconds_of_a_rule_are_the_median_of_its_benchmarks(tmp_path):
    solve = study_step("solve_2", "cases/{speed}.nc", "run.at", ["1", "2", "3"], work=4.0)
    study = Study("toy", None, solve, study_step("gather", "all.nc", "run.all"))
    for speed, seconds in (("1", 2.0), ("2", 8.0)):
        file = tmp_path / "logs" / "toy" / "solve_2" / "toy" / "cases" / f"{speed}.tsv"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(f"s\th:m:s\n{seconds}\t0:00:01\n")
    assert job_seconds.benchmarked({"toy": study}, tmp_path) == {"toy_solve": JobTime(1.25, 2)}
    rule, known = next(iter(job_times().items()))
    assert seconds_of(f"{rule}_2", 3.0) == 3.0 * known.seconds
