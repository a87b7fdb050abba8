"""Follows steady states along an axis, up and down, and finds them anew."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.kernels import status as code
from bearingwear.scene.checking.check import record
from bearingwear.scene.read import load_scene, scene_from_dict
from bearingwear.scene.scene import COUNTS
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.steady import steady_values
from workflow.studies.robustness.draw import bare, with_values
from workflow.studies.robustness.plan import KeyAxis
from workflow.studies.robustness.run import attributes

BRANCH_WAYS = ("up", "down", "anew")
_QUANTITIES = (
    "orbit_share",
    "total_qv",
    "loss_rate",
    "branch",
    "stable",
    "gyroscopic_slip_share",
)


def branch(
    scene: Path, name: str, title: str, changes: Mapping[str, Any], along: Mapping[str, Any]
) -> xr.Dataset:
    """Step: steady states followed up and down an axis, and found anew at each point.

    Parameters
    ----------
    scene : path
        Where all start from.
    name, title : str
        Of the branches.
    changes : mapping
        Keys of the scene to set.
    along : mapping
        Block of the axis.

    Returns
    -------
    Dataset
        Over `way` (up, down, anew) and `point`: status, orbit speed, QV, rate of loss, branch,
        stability.
    """
    axis = record(KeyAxis, along, "along")
    base = bare(with_values(load_scene(scene).to_dict(), changes))
    n = len(axis.values)
    columns = {key: np.full((len(BRANCH_WAYS), n), np.nan) for key in _QUANTITIES}
    status = np.zeros((len(BRANCH_WAYS), n), dtype=np.int8)
    for k, way in enumerate(BRANCH_WAYS):
        last: np.ndarray | None = None
        for point in range(n - 1, -1, -1) if way == "down" else range(n):
            data = with_values(base, {axis.key: axis.values[point]})
            state, last = _followed(data, None if way == "anew" else last)
            status[k, point] = state.pop("status")
            for key, value in state.items():
                columns[key][k, point] = value
    return xr.Dataset(
        {"status": (("way", "point"), status)}
        | {key: (("way", "point"), column) for key, column in columns.items()}
        | {"along": ("point", list(axis.values))},
        attrs=attributes(
            "branches",
            name,
            {
                "shown": title,
                "key": axis.key,
                "log": int(axis.is_log),
                "ways": " ".join(BRANCH_WAYS),
            },
        ),
    )


def _followed(
    data: Mapping[str, Any], last: np.ndarray | None
) -> tuple[dict[str, Any], np.ndarray | None]:
    """A steady state sought from the last one, and the one that the next is sought from."""
    scene = scene_from_dict(data)
    problem = ThrustProblem.of(scene)
    D = float(parameters.ball_diameters(scene)[0])
    case = problem.solve(D, None if last is None else last.copy())
    if case.status != code.OK:
        return {"status": case.status}, last
    values = steady_values(scene, problem, D, case)
    *_, Omega = case.u
    return {
        "status": case.status,
        "orbit_share": Omega / problem.op.omega_i,
        "total_qv": values["total_qv"],
        "loss_rate": values["ball_diameter_loss_rate"][COUNTS.index("ball_and_races")],
        "branch": case.branch,
        "stable": problem.stable(D, case),
        "gyroscopic_slip_share": np.max(values["gyroscopic_slip_share"]),
    }, case.u
