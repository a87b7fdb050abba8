"""The application that docs/develop.md writes."""

import json
import re

import pytest
from support import ROOT, scene_file

PROGRAM = """
import json, sys
import bearingwear
from bearingwear.cli import main

scene, output = sys.argv[1:]
assert main(["frequencies", scene, "-o", output, "--json"]) == 0
dataset = bearingwear.frequencies(scene)
print("---")
print(json.dumps({name: values.values.ravel().tolist() for name, values in dataset.items()}))
assert dataset.equals(bearingwear.load(output)) and "frequencies" in dir(bearingwear)
"""
HZ = {"Hz": 1.0, "kHz": 1e3}


def test_the_application_written_in_the_docs_works_as_command_and_function(
    applications_of_a_copy, printed_by
):
    """Its command and its function give the same numbers, as the kinematics of rolling has them."""
    page = (ROOT / "docs" / "develop.md").read_text(encoding="utf-8")
    files = dict(re.findall(r"^```py\n# (\w+\.py)\n(.*?)^```$", page, re.M | re.S))
    assert set(files) == {"__init__.py", "command.py"}
    folder = applications_of_a_copy / "frequencies"
    folder.mkdir()
    for name, text in files.items():
        (folder / name).write_text(text)
    printed = printed_by(PROGRAM, scene_file("gyro_s1"), "frequencies.nc")
    sheet, results = map(json.loads, printed.split("---"))
    for row in sheet["quantities"]:
        shown = row.get("values", [row.get("value")])
        frequencies = [HZ[row["unit"]] * value for value in shown]
        assert frequencies == pytest.approx(results[row["name"]], rel=1e-12), row["name"]
    # 9 balls pass each race; the outer ring stands still, and the inner one turns at 500 Hz
    (cage,), (inner, outer) = results["cage_frequency"], results["ball_pass_frequency"]
    assert outer == pytest.approx(9 * cage, rel=1e-6)
    assert inner + outer == pytest.approx(9 * 500.0, rel=1e-6)
