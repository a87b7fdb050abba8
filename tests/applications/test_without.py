"""The program without one of its applications: the rest stays as it is."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support import ROOT, scene_file

import bearingwear
from bearingwear.application import applications
from bearingwear.kernels.project import PROJECT

PROGRAM = """
import json, sys
import bearingwear
from bearingwear.cli import main
from bearingwear.studies import STUDY_PLOTS, STUDY_SHEETS

scene, case = sys.argv[1:]
statuses = []
for line in (["--help"], ["check", scene], ["solve", scene, "-o", case, "--quiet"], ["show", case]):
    statuses.append(main(line))
public = {name: type(getattr(bearingwear, name)).__name__ for name in bearingwear.__all__}
print()
print(json.dumps([bearingwear.__file__, statuses, public, [*STUDY_SHEETS, *STUDY_PLOTS]]))
"""


@pytest.mark.parametrize("one", applications(), ids=lambda one: one.command)
def test_the_program_without_an_application(one, tmp_path):
    """Imports, `--help`, `check`, `solve` and `show`, with a copy that lacks the folder."""
    ignored = shutil.ignore_patterns("__pycache__")
    for package in ("bearingwear", "kerneljit"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=ignored)
    folder = one.handler.split(".")[2]
    shutil.rmtree(tmp_path / "bearingwear" / "applications" / folder)
    environment = os.environ | {"PYTHONPATH": str(tmp_path), "PYTHONDONTWRITEBYTECODE": "1"}
    environment["NUMBA_CACHE_DIR"] = str(Path(PROJECT.code_folder).parent)  # of the same kernels
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, scene_file("gyro_s1"), "case.nc"],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    file, statuses, public, kinds = json.loads(done.stdout.splitlines()[-1])
    assert file.startswith(str(tmp_path)) and statuses == [0, 0, 0, 0]
    assert f"    {one.command} " not in done.stdout  # in the list of commands
    assert set(public) == set(bearingwear.__all__) - set(one.functions)
    assert not set(kinds) & {*one.sheets, *one.plots}
