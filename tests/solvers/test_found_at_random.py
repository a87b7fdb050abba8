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
ONCE_FAILED = data_of(text_of(SOURCE), SOURCE.name)
"""Each case says why it is kept, what was drawn or changed, and how it must end."""
BASE = load_scene(ROOT / "config" / "scenes" / "gyro_s1.yaml").to_dict()


def base_with(changes):
    """Returns gyro_s1 with other keys, no end of life, and no cage, which would not fit all."""
    data = with_values(BASE, changes)
    data["cage"] = data["wear"]["end_of_life"] = None
    return scene_from_dict(data)


@pytest.mark.parametrize("case", ONCE_FAILED, ids=lambda case: case["why"].replace(" ", "-"))
def test_a_scene_that_once_failed_ends_with_its_status(case):
    scene = drawn_scene(BASE, case["draw"]) if "draw" in case else base_with(case["changes"])
    values = solved_values(scene, case["fidelity"])
    status, expected = STATUS_NAMES[values["status"]], case["status"]
    assert status in (expected if isinstance(expected, list) else [expected])
    if status == "ok":
        assert violations(scene, case["fidelity"], values) == []
    if "states" in case:
        assert values["steady_state_count"] == case["states"]


def test_the_steady_solver_takes_other_paths_where_newton_fails(monkeypatch):
    """Of the functions listed under `paths`, each case calls its own and no others.

    The kernels run as plain Python, so that their calls can be counted.
    """
    cases, calls = [case for case in ONCE_FAILED if "paths" in case], Counter()

    def counted(name, kernel):
        def call(*args):
            calls[name] += 1
            return in_python(kernel)(*args)

        return call

    in_python.cache_clear()  # functions made before this test would count nothing
    for name in {name for case in cases for name in case["paths"]}:
        monkeypatch.setattr(solver, name, counted(name, getattr(solver, name)))
    monkeypatch.setattr(thrust_problem, "thrust_case", in_python(thrust_problem.thrust_case))
    for case in cases:
        calls.clear()
        values = solved_values(drawn_scene(BASE, case["draw"]), "steady")
        assert STATUS_NAMES[values["status"]] == case["status"], case["why"]
        assert sorted(calls) == sorted(case["paths"]), case["why"]
    in_python.cache_clear()  # and those of this test count for it alone
