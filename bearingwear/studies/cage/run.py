"""Solves a cage from several starts, and names its motions."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.kernels.cage.body import INNER_LAND, NO_LAND
from bearingwear.kernels.layout import CENTRE, MOMENTUM, OMEGA, VELOCITY
from bearingwear.kernels.status import OK
from bearingwear.results.variable import STATUS, Variable, table
from bearingwear.scene.scene import Scene
from bearingwear.scene.variant import variant
from bearingwear.solvers.dynamic.run import solve_dynamic
from bearingwear.solvers.dynamic.system import DynamicSystem
from bearingwear.solvers.dynamic.windows import wear_per_joule
from bearingwear.solvers.start import start_of
from bearingwear.studies.cage.motion import MOTIONS, CagePath, begins, path_of
from bearingwear.studies.cage.plan import CAGE_STARTS
from bearingwear.studies.dataset import filled

START_FROM = Variable("start", ("start",), "", "where the cage starts", "i1", flags=CAGE_STARTS)
ACROSS = Variable("across", ("across",), "", "direction across the shaft", "i1", flags=("Y", "Z"))

CAGE_RUN = table(
    STATUS,
    Variable("motion", (), "", "motion of the cage at the end", "i1", flags=MOTIONS),
    Variable("begins", (), "1", "shaft turns from which that motion lasts"),
    Variable("motions", ("stretch",), "", "motion of each stretch", "i1", flags=MOTIONS),
    Variable("whirl_ratio", (), "1",
        "turns of the cage's centre round the axis for a turn of the shaft"),
    Variable("ball_ratio", (), "1", "orbit rate of the balls over the rate of the shaft"),
    Variable("centre", ACROSS.dims, "m", "mean place of the cage's centre"),
    Variable("offset", (), "m", "mean distance of the cage's centre from the axis"),
    Variable("offset_scatter", (), "m", "standard deviation of that distance"),
    Variable("pocket_power", (), "W", "normal force times slip in all pockets"),
    Variable("land_power", (), "W", "normal force times slip at the guiding land"),
    Variable("cage_wear_rate", (), "m3 s-1", "wear rate of the cage in its pockets"),
    Variable("cage_land_wear_rate", (), "m3 s-1", "wear rate of the cage at its land"),
    Variable("energy_account_error", (), "1", "energy missing, over the heat"),
)  # fmt: skip
"""What is kept of a run: over its evaluated turns, unless another stretch is named."""

CLOSE = 0.95  # of the clearance, where a cage starts that goes round
POINTS = 20  # instants a turn
_SETTINGS = {
    "model.fidelity": "dynamic",
    "model.cage_results": True,
    "model.history_points_per_turn": POINTS,
    "model.settled_drift": 1e-9,  # a motion may last for a hundred turns and yet end
}


def start_state(scene: Scene, start: str) -> dict[str, Any] | None:
    """What a run of a scene goes on from; nothing for the start that a solve has itself."""
    if start == CAGE_STARTS[0]:
        return None
    system = DynamicSystem.of(scene, start_of(scene).u)
    cage, z, omega = system.bearing.cage, system.cage_state, system.balls[:, OMEGA].mean()
    race = system.buffers.balls.delta if cage.land == INNER_LAND else np.zeros(3)
    room = cage.clearance if cage.land == NO_LAND else min(cage.clearance, cage.gap)
    rate = omega if start == CAGE_STARTS[1] else 0.5 * (omega + system.bearing.op.omega_i)
    z[CENTRE + 1] = race[1]
    z[CENTRE + 2] = race[2] - CLOSE * room + cage.imbalance
    z[VELOCITY + 1] = rate * CLOSE * room
    z[MOMENTUM : MOMENTUM + 3] = cage.I_x * omega, 0.0, 0.0
    return {"state": system.packed(), "time": 0.0}


def run_from(scene: Scene, start: str, stretch_turns: int) -> dict[str, Any]:
    """Values of `CAGE_RUN` of one start."""
    values, _ = solve_dynamic(scene, start_state(scene, start))
    if values["status"] != OK:
        return {"status": values["status"]}
    assert scene.cage is not None
    place = np.asarray(values["history_cage_position"], dtype=float)
    if scene.cage.guiding_race == "inner":
        place = place - values["history_race_displacement"]
    across = place[:, 1] + 1j * place[:, 2]
    per_joule = wear_per_joule(scene, scene.cage.material)
    pockets, land = (
        np.asarray(values[f"history_cage_{part}_wear_rate"]) / per_joule
        for part in ("pocket", "land")
    )
    shaft = np.pi / 30.0 * scene.operation.shaft_speed_rpm
    ball_ratio = float(np.mean(values["orbit_speed"])) / shaft

    def path(first: int, last: int) -> CagePath:
        power = float((pockets + land)[first:last].mean())
        return path_of(across[first:last], 1.0 / POINTS, power, ball_ratio)

    size = stretch_turns * POINTS
    motions = [path(k, k + size).motion for k in range(0, across.size, size)]
    evaluated = across.size - round(scene.model.averaged_turns * POINTS)
    whole, first = path(evaluated, across.size), begins(motions)
    return {
        "status": OK,
        "motion": motions[-1],
        "begins": float(stretch_turns * first),
        "motions": motions,
        "whirl_ratio": whole.whirl,
        "ball_ratio": ball_ratio,
        "centre": [whole.centre.real, whole.centre.imag],
        "offset": whole.offset,
        "offset_scatter": whole.scatter,
        "pocket_power": pockets[evaluated:].mean(),
        "land_power": land[evaluated:].mean(),
        "cage_wear_rate": values["cage_wear_rate"],
        "cage_land_wear_rate": values["cage_land_wear_rate"],
        "energy_account_error": values["energy_account_error"],
    }


def motions_from_starts(
    scene: Path, changes: Mapping[str, Any], starts: Sequence[str], stretch_turns: int
) -> xr.Dataset:
    """Step: what the cage of a scene does from several starts.

    Parameters
    ----------
    scene : path
    changes : mapping
        Keys of the scene to set, the turns of a run among them.
    starts : sequence of str
        Of `CAGE_STARTS`.
    stretch_turns : int
        Shaft turns over which a motion is told.
    """
    solved = variant(scene, {**changes, **_SETTINGS})
    rows = [run_from(solved, start, stretch_turns) for start in starts]
    for start, row in zip(starts, rows, strict=True):
        if row["status"] != OK:
            sys.stderr.write(f"{scene}: the run that starts {start} was not solved\n")
    stretches = round(solved.model.simulated_turns) // stretch_turns
    codes = [CAGE_STARTS.index(start) for start in starts]
    return filled(
        CAGE_RUN,
        {START_FROM: codes, ACROSS: None, "stretch": stretches},
        rows,
        title="Motions of a cage",
        kind="cage",
        scene=solved,
    )
