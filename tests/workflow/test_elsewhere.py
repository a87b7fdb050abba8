"""A study outside the repository: a folder with a configuration and scenes, and nothing else."""

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
    done = study(elsewhere, "results/verdict.txt", "-j2")
    assert done.returncode == 0, done.stdout + done.stderr
    assert (elsewhere / "results/verdict.txt").read_text() == "all 2 solved and verified\n"


def test_a_configuration_is_whole(elsewhere):
    """One that is given takes the place of config.yaml; nothing of that is left."""
    own = elsewhere / "config" / "config.yaml"
    in_time = {**ONE_CASE["studies"][0], "model": {"simulated_turns": 1}}
    own.write_text(yaml.safe_dump(ONE_CASE | {"dynamic": [in_time]}))
    (elsewhere / "other.yaml").write_text(yaml.safe_dump(ONE_CASE))
    jobs = study(elsewhere, "all", "-n", "--configfile", "other.yaml").stdout
    assert "grid_solve " in jobs and "grid_solve_dynamic" not in jobs
    assert "results/" not in jobs  # the table of jobs, not the files of each
    assert not (elsewhere / "results").exists()


def test_a_folder_without_a_study(tmp_path):
    done = study(tmp_path)
    assert done.returncode == 2
    assert done.stderr.splitlines() == [
        "study: got a folder without config/config.yaml, expected one that contains a study"
    ]
