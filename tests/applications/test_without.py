"""The program without one of its applications: the rest stays as it is."""

import json
import shutil

import pytest
from support import scene_file

import bearingwear
from bearingwear.application import applications

PROGRAM = """
import json, sys
import bearingwear
from bearingwear.cli import main
from bearingwear.studies import STUDY_PLOTS, STUDY_SHEETS

scene, case = sys.argv[1:]
statuses = []
for line in (["--help"], ["check", scene], ["solve", scene, "-o", case, "--quiet"], ["show", case]):
    statuses.append(main(line))
public = [name for name in bearingwear.__all__ if hasattr(bearingwear, name)]
print()
report = {"file": bearingwear.__file__, "statuses": statuses, "public": public}
print(json.dumps(report | {"kinds": [*STUDY_SHEETS, *STUDY_PLOTS]}))
"""


@pytest.mark.parametrize("application", applications(), ids=lambda application: application.command)
def test_the_program_works_without_the_folder_of_an_application(
    application, tmp_path, applications_of_a_copy, printed_by
):
    """Imports, `--help`, `check`, `solve` and `show` work, and do not mention the application."""
    shutil.rmtree(applications_of_a_copy / application.handler.split(".")[2])
    printed = printed_by(PROGRAM, scene_file("gyro_s1"), "case.nc")
    report = json.loads(printed.splitlines()[-1])
    assert report["file"].startswith(str(tmp_path))  # of the copy
    assert report["statuses"] == [0, 0, 0, 0]
    assert f"    {application.command} " not in printed  # in the list of commands
    assert set(report["public"]) == set(bearingwear.__all__) - set(application.functions)
    assert not set(report["kinds"]) & {*application.sheets, *application.plots}
