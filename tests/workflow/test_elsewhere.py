"""A study outside the repository: a folder with a configuration and scenes, and nothing else."""

import re
import subprocess
import sys

import pytest
import yaml
from support import scene_file

ONE_CASE = {
    "studies": [
        {
            "scenes": ["gyro_s1"],
            "preload_method": ["constant_force"],
            "friction": [0.08],
            "ball_diameter_loss_um": [0.0],
        }
    ],
    "figures": {"worn_loss_um": 0.0, "friction": [0.08]},
}


@pytest.fixture
def elsewhere(tmp_path):
    """A folder that holds one scene and a study of one case."""
    (tmp_path / "config" / "scenes").mkdir(parents=True)
    (tmp_path / "config" / "config.yaml").write_text(yaml.safe_dump(ONE_CASE))
    text = scene_file("gyro_s1").read_text(encoding="utf-8")
    (tmp_path / "config" / "scenes" / "gyro_s1.yaml").write_text(text, encoding="utf-8")
    return tmp_path


def study(folder, *arguments):
    command = [sys.executable, "-m", "bearingwear", "study", *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True)


def test_a_study_outside_the_repository(elsewhere):
    done = study(elsewhere, "-j2")
    assert done.returncode == 0, done.stdout + done.stderr
    results = elsewhere / "results"
    assert (results / "verdict.txt").read_text() == "all 2 solved and verified\n"
    assert (results / "report" / "index.html").is_file()
    again = study(elsewhere, "-j2")
    assert again.returncode == 0 and "Nothing to be done" in again.stdout + again.stderr


def test_arguments_of_snakemake_go_on(elsewhere):
    planned = study(elsewhere, "-n")
    told = planned.stdout + planned.stderr
    assert planned.returncode == 0 and "grid_solve" in told
    assert "results/" not in told  # the table of jobs, not the files of each
    assert not (elsewhere / "results").exists()


def test_every_rule_says_what_it_does(elsewhere):
    listed = study(elsewhere, "--list").stdout.splitlines()
    rules = [line for line in listed if re.match(r"(grid|page|verdict|all)", line)]
    assert len(rules) > 5
    for line in rules:
        assert re.fullmatch(r"\w+ \(.+\)", line), line


def test_a_configuration_is_whole(elsewhere):
    """One that is given takes the place of config.yaml; nothing of that is left."""
    own = elsewhere / "config" / "config.yaml"
    in_time = {**ONE_CASE["studies"][0], "model": {"simulated_turns": 1}}
    own.write_text(yaml.safe_dump(ONE_CASE | {"dynamic": [in_time]}))
    (elsewhere / "other.yaml").write_text(yaml.safe_dump(ONE_CASE))
    jobs = study(elsewhere, "-n").stdout
    assert "grid_solve_dynamic" in jobs
    jobs = study(elsewhere, "all", "-n", "--configfile", "other.yaml").stdout
    assert "grid_solve " in jobs and "grid_solve_dynamic" not in jobs


def test_a_folder_without_a_study(tmp_path):
    done = study(tmp_path)
    assert done.returncode == 2
    assert done.stderr.splitlines() == [
        "study: got a folder without config/config.yaml, expected one that holds a study"
    ]
