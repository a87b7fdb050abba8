"""Random scenes that once failed, kept as they were drawn."""

from collections import Counter
from pathlib import Path

import pytest
from support import ROOT, in_python

from bearingwear.kernels.status import STATUS_NAMES
from bearingwear.kernels.steady import solver
from bearingwear.scene.checking.strict_yaml import data_of, text_of
from bearingwear.scene.read import load_scene, scene_from_dict
from bearingwear.solvers.bearing import thrust_problem
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


def test_the_steady_solver_takes_its_ways_out(monkeypatch):
    """What it does where Newton fails, counted with the kernels as plain Python."""
    cases, taken = [result for result in FOUND if "paths" in result], Counter()

    def counted(name, kernel):
        def call(*args):
            taken[name] += 1
            return in_python(kernel)(*args)

        return call

    in_python.cache_clear()  # what was made before counts nothing
    for name in {name for case in cases for name in case["paths"]}:
        monkeypatch.setattr(solver, name, counted(name, getattr(solver, name)))
    monkeypatch.setattr(thrust_problem, "thrust_case", in_python(thrust_problem.thrust_case))
    for case in cases:
        taken.clear()
        values = solved_values(drawn_scene(BASE, case["draw"]), "steady")
        assert STATUS_NAMES[values["status"]] == case["status"]
        assert sorted(taken) == sorted(case["paths"]), case["why"]
    in_python.cache_clear()
