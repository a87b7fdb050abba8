"""Random scenes that once failed, kept as they were drawn."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from support import ROOT

from bearingwear.kernels.status import STATUS_NAMES
from bearingwear.scene.checking.strict_yaml import data_of, text_of
from bearingwear.scene.read import load_scene, scene_from_dict
from workflow.studies.robustness.draw import drawn_scene, with_values
from workflow.studies.robustness.run import solved_values, violations

SOURCE = Path(__file__).with_name("found_at_random.yaml")
FOUND = data_of(text_of(SOURCE), SOURCE.name)
BASE = load_scene(ROOT / "config" / "scenes" / "gyro_s1.yaml").to_dict()


def changed(changes):
    """The scene with other keys, without its cage, which would not fit each, and its limits."""
    data = with_values(BASE, changes)
    data["cage"] = data["wear"]["end_of_life"] = None
    return scene_from_dict(data)


@pytest.mark.parametrize("found", FOUND, ids=lambda found: found["why"].replace(" ", "-"))
def test_ends_as_it_should(found):
    scene = drawn_scene(BASE, found["draw"]) if "draw" in found else changed(found["changes"])
    values = solved_values(scene, found["fidelity"])
    status, expected = STATUS_NAMES[values["status"]], found["status"]
    assert status in (expected if isinstance(expected, list) else [expected])
    if status == "ok":
        assert violations(scene, found["fidelity"], values) == []
    if "states" in found:
        assert values["steady_state_count"] == found["states"]


COUNTED = """
import json, sys
from collections import Counter
from bearingwear.kernels.steady import solver
from support import ROOT
from bearingwear.scene.read import load_scene
from workflow.studies.robustness.draw import drawn_scene
from workflow.studies.robustness.run import solved_values

taken = Counter()
def counted(name, function):
    def call(*args):
        taken[name] += 1
        return function(*args)
    return call
for name in {name for one in json.loads(sys.argv[1]) for name in one["paths"]}:
    setattr(solver, name, counted(name, getattr(solver, name)))
base = load_scene(ROOT / "config/scenes/gyro_s1.yaml").to_dict()
for one in json.loads(sys.argv[1]):
    taken.clear()
    values = solved_values(drawn_scene(base, one["draw"]), "steady")
    print(json.dumps([int(values["status"]), sorted(taken)]))
"""


def test_the_steady_solver_takes_its_ways_out():
    """What it does where Newton fails, counted with the kernels as plain Python."""
    cases = [found for found in FOUND if "paths" in found]
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": str(ROOT / "tests")}
    done = subprocess.run(
        [sys.executable, "-c", COUNTED, json.dumps(cases)],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    for found, line in zip(cases, done.stdout.splitlines(), strict=True):
        status, taken = json.loads(line)
        assert STATUS_NAMES[status] == found["status"]
        assert taken == sorted(found["paths"]), found["why"]
