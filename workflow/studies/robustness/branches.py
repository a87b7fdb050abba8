"""Follows steady states along an axis, up and down, and searches them anew."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.kernels import status as code
from bearingwear.results.variable import STATUS, Variable, table
from bearingwear.scene.checking.check import record
from bearingwear.scene.read import load_scene, scene_from_dict
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.steady import steady_values
from bearingwear.studies.dataset import dataset_of_rows
from workflow.studies.robustness.draw import with_values, without_cage_and_end
from workflow.studies.robustness.plan import KeyAxis, base_scene, plan_entry, read_robustness
from workflow.studies.robustness.run import study_attributes

BRANCH_WAYS = ("up", "down", "anew")
_ALONG = Variable("along", ("along",), "", "value of the key")
_BRANCH = table(
    STATUS,
    Variable("orbit_share", (), "1", "ratio of orbit rate to shaft speed"),
    Variable("total_qv", (), "W", "QV of the bearing"),
    Variable("loss_rate", (), "m s-1", "rate of increase in total wear depth"),
    Variable("branch", (), "1", "branch of steady states", "i1"),
    Variable("stable", (), "1", "whether the state is stable", "i1"),
    Variable("gyroscopic_slip_share", (), "1", "gyroscopic slip share, larger of the two contacts"),
)


def branch_states(plan: Path, name: str) -> xr.Dataset:
    """Step: returns the steady states along an axis, followed up and down and searched anew.

    plan: file of the plan.
    name: of the branch in the plan.

    Returns the variables of `_BRANCH` over `way` (up, down, anew) and `along`.
    """
    robustness = read_robustness(plan)
    branch_plan = plan_entry(robustness, plan, "branches", name)
    axis = record(KeyAxis, branch_plan["along"], "along")
    scene_data = load_scene(base_scene(robustness, plan)).to_dict()
    base = without_cage_and_end(with_values(scene_data, branch_plan["set"]))
    rows = []
    for way in BRANCH_WAYS:
        previous: np.ndarray | None = None
        states = []
        for value in reversed(axis.values) if way == "down" else axis.values:
            data = with_values(base, {axis.key: value})
            state, previous = _next_state(data, None if way == "anew" else previous)
            states.append(state)
        rows += states[::-1] if way == "down" else states
    return dataset_of_rows(
        _BRANCH,
        {"way": len(BRANCH_WAYS), _ALONG: axis.values},
        rows,
        **study_attributes("branches", name),
        shown=branch_plan["title"],
        key=axis.key,
        log=int(axis.is_log),
        ways=" ".join(BRANCH_WAYS),
    )


def _next_state(
    data: Mapping[str, Any], previous: np.ndarray | None
) -> tuple[dict[str, Any], np.ndarray | None]:
    """Returns the values of a steady state by name, and the motion from which to start the next.

    Where it is not solved, the status is its only value, and the motion is the previous one.

    data: plain data of the scene.
    previous: motion w_x, w_y, w_z, Omega (4,) [rad/s] of the state before, from which the solver
        starts; None for a new search.
    """
    scene = scene_from_dict(data)
    problem = ThrustProblem.of(scene)
    D = float(parameters.ball_diameters(scene)[0])
    case = problem.solve(D, None if previous is None else previous.copy())
    if case.status != code.OK:
        return {"status": case.status}, previous
    values = steady_values(scene, problem, D, case)
    *_, Omega = case.u
    return {
        "status": case.status,
        "orbit_share": Omega / problem.op.omega_i,
        "total_qv": values["total_qv"],
        "loss_rate": values["ball_diameter_loss_rate"],
        "branch": case.branch,
        "stable": problem.stable(D, case),
        "gyroscopic_slip_share": np.max(values["gyroscopic_slip_share"]),
    }, case.u
