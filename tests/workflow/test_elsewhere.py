"""A study outside the repository: a folder with a configuration and scenes, and nothing else."""

import subprocess
import sys

import pytest
import yaml
from support import ROOT, scene_file, without_waits
from workflow.conftest import Project

ONE_CASE_WITHOUT_FRICTION = {
    "studies": [
        {
            "scenes": ["gyro_s1"],
            "preload_method": ["constant_force"],
            "friction": [0.0, 0.02],
            "ball_diameter_loss_um": [0],
        }
    ],
    "figures": {"worn_loss_um": 0.5, "friction": [0.02]},
}


@pytest.fixture
def folder(tmp_path):
    """Returns a folder with one scene and a study of two cases, of which one has no friction."""
    (tmp_path / "config" / "scenes").mkdir(parents=True)
    (tmp_path / "config" / "config.yaml").write_text(yaml.safe_dump(ONE_CASE_WITHOUT_FRICTION))
    text = scene_file("gyro_s1").read_text(encoding="utf-8")
    (tmp_path / "config" / "scenes" / "gyro_s1.yaml").write_text(text, encoding="utf-8")
    return tmp_path


def study(folder, *arguments):
    """Runs `bearingwear study` in a folder, and returns the process as it ended.

    Its standard error is without lines that depend on time.
    """
    command = [sys.executable, "-m", "bearingwear", "study", *arguments]
    completed = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    completed.stderr = without_waits(completed.stderr)
    return completed


@pytest.mark.long  # a whole study
def test_a_case_without_a_solution_is_recorded_and_reported_at_the_end(folder):
    """Without friction the rotation of a ball is undetermined. All else of the study is made.

    The summary lists the case. The last job, the verdict, fails and names its file and status. A
    second run of the rules repeats the verdict alone.
    """
    completed = study(folder, "-j2")
    failed = "results/gyro_s1/cases/constant_force-mu0.000-loss0.00.nc: undetermined"
    output = completed.stdout + completed.stderr
    assert completed.returncode != 0 and failed in output, output
    results = folder / "results"
    drawn = {path.stem for path in results.glob("gyro_s1/figures/*.svg")}
    assert {"fig10_wear", "wear_life"} <= drawn
    assert (results / "report/index.html").exists() and not (results / "verdict.txt").exists()
    summary = (results / "gyro_s1/tables/summary.md").read_text(encoding="utf-8")
    assert summary.count("µm: undetermined") == 1
    assert "page: results/report/index.html" in completed.stderr.splitlines()
    again = Project(folder).run("--snakefile", str(ROOT / "Snakefile"))
    assert again.status != 0 and failed in again.text and again.jobs == {"verdict": 1}


def test_a_folder_without_a_study_is_refused_in_one_line(tmp_path):
    """Without a scene, the command makes `all`, the whole study of a folder."""
    completed = study(tmp_path)
    assert completed.returncode == 2
    assert completed.stderr.splitlines() == [
        "study: got all in a folder without config/config.yaml, expected SCENE.yaml, or a folder "
        "that contains a study"
    ]
