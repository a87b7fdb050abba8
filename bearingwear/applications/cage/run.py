"""One run of a cage from a start, as long as its motion needs to settle."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from bearingwear.applications.cage.motion import JAMS, MOTIONS, CagePath, is_drifting, path_of
from bearingwear.applications.cage.plan import STRETCH
from bearingwear.kernels.status import CAGE_JAMMED, OK, UNVERIFIED
from bearingwear.results.variable import STATUS, Variable, table
from bearingwear.scene.scene import Scene
from bearingwear.solvers.dynamic.errors import TIGHTER
from bearingwear.solvers.dynamic.outputs import window_values
from bearingwear.solvers.dynamic.run import LARGEST_ACCOUNT, LARGEST_UNBALANCED, TIGHTEST_RUN
from bearingwear.solvers.dynamic.system import CageStart, DynamicSystem
from bearingwear.solvers.dynamic.windows import TREND_OF_TORQUE, TimeRun
from bearingwear.solvers.start import start_of
from kerneljit.interrupt import Interrupt

ACROSS = Variable(
    "across", ("across",), "", "direction perpendicular to the shaft", "i1", flags=("Y", "Z")
)

CAGE_RUN = table(
    STATUS,
    Variable("motion", (), "", "motion of the cage", "i1", flags=MOTIONS),
    Variable("work", (), "J", "normal force times slip at the cage per shaft turn"),
    Variable("pocket_work", (), "J", "normal force times slip in all pockets per shaft turn"),
    Variable("land_work", (), "J", "normal force times slip at the guiding land per shaft turn"),
    Variable("pocket_force", (), "N", "mean normal force between a ball and its pocket"),
    Variable("pocket_force_99", (), "N", "99 % quantile of the normal force between a ball and "
        "its pocket"),
    Variable("land_force", (), "N", "mean normal force between the cage and its land"),
    Variable("land_force_99", (), "N", "99 % quantile of the normal force between the cage and "
        "its land"),
    Variable("shaft_torque", (), "N m", "mean shaft torque"),
    Variable("torque_noise", (), "N m",
        "standard deviation of the shaft torque averaged over each turn"),
    Variable("whirl_ratio", (), "1",
        "number of orbits of the cage centre about the axis per shaft turn"),
    Variable("ball_ratio", (), "1", "ratio of the balls' orbit rate to the shaft speed"),
    Variable("offset", (), "m", "mean distance of the cage's centre from the axis"),
    Variable("offset_scatter", (), "m",
        "standard deviation of the distance of the cage's centre from the axis"),
    Variable("centre", ACROSS.dims, "m", "mean position of the cage's centre"),
    Variable("turns", (), "1", "number of shaft turns simulated"),
    Variable("energy_account_error", (), "1", "residual of the energy balance, relative to the "
                                              "friction heat"),
)  # fmt: skip
"""What is kept of a run: of its last stretches, where no other is named."""

EVALUATED = 2
"""Stretches at the end of a run over which it is averaged."""

ALIKE = 3
"""Stretches at the end of a settled run that have one motion and do not drift."""

DRIFT_OF_WORK, DRIFT_OF_PLACE = 0.05, 5e-3
"""Relative drifts over these stretches up to which a run has settled. A cage that nears its land
drifts by 0.03 of its place in ten turns, one that whirls scatters by 0.002."""

POINTS = 20  # instants a turn


def cage_run(scene: Scene, start: CageStart, least_turns: int, most_turns: int) -> dict[str, Any]:
    """Values of `CAGE_RUN` of one start; a run whose energy balance stays open is repeated.

    scene: solved with its cage, at the temperatures that it has.
    least_turns, most_turns: shaft turns, multiples of `STRETCH`.
    """
    model = replace(
        scene.model,
        history_points_per_turn=POINTS,
        simulated_turns=float(most_turns),
        evaluated_turns=float(STRETCH),
    )
    scene, tolerance = replace(scene, model=model), scene.model.dynamic_tolerance
    while True:
        row = _run(scene, start, least_turns, tolerance)
        if row["status"] != UNVERIFIED or tolerance < TIGHTEST_RUN:
            return row
        tolerance /= TIGHTER


def _run(scene: Scene, start: CageStart, least_turns: int, tolerance: float) -> dict[str, Any]:
    system = DynamicSystem.of(scene, start_of(scene).u)
    system.start_cage(start)
    begun = system.packed(), system.time
    status = system.diagnose(system.update())
    if status != OK:
        return _stopped(status)
    with Interrupt():
        run = TimeRun(scene, system, None, tolerance)
        system.unpack(*begun)  # what compiles first has moved it
        found: list[_Stretch] = []
        for length in run.grid.windows:
            status = run.window(length)
            if status != OK:
                return _stopped(system.diagnose(status))
            found.append(_stretch(run, length))
            if run.turns >= least_turns and _is_settled(found):
                break
    values = window_values(scene, run)
    account = values["energy_account_error"]
    verified = values["equilibrium_residual"] <= LARGEST_UNBALANCED
    if not (verified and abs(account) <= LARGEST_ACCOUNT):
        return {"status": UNVERIFIED, "energy_account_error": account}
    return _evaluated(run, found) | {"energy_account_error": account}


def _stopped(status: int) -> dict[str, Any]:
    jams = {"motion": JAMS} if status == CAGE_JAMMED else {}
    return {"status": int(status)} | jams


class _Stretch(NamedTuple):
    path: CagePath
    work: float  # in pockets and at the land in a turn [J]
    torques: np.ndarray  # sums over its turns of 1, torque and its square


def _stretch(run: TimeRun, length: int) -> _Stretch:
    last = slice(run.done - length, run.done)
    trend, history = run.trend, run.recorder.history
    torques = np.array(
        [trend.sums[0], trend.values[0, TREND_OF_TORQUE], trend.values[2, TREND_OF_TORQUE]]
    )
    torques /= (1.0, POINTS, POINTS**2)  # a turn's value is the sum over its instants
    power = float(history.pocket_power[last].sum(axis=1).mean() + history.land_power[last].mean())
    return _Stretch(_path(run, last, power), power * run.system.turn, torques)


def _path(run: TimeRun, part: slice, power: float) -> CagePath:
    y, z = run.cage_offset(part).T
    return path_of(y + 1j * z, 1.0 / POINTS, power, run.system.ball_ratio)


def _is_settled(found: list[_Stretch]) -> bool:
    """Whether the last stretches have one motion, and neither work nor place drift."""
    last = found[-ALIKE:]
    return (
        len(last) == ALIKE
        and len({one.path.motion for one in last}) == 1
        and not is_drifting([one.work for one in last], DRIFT_OF_WORK)
        and not is_drifting([one.path.offset for one in last], DRIFT_OF_PLACE)
    )


def _evaluated(run: TimeRun, found: list[_Stretch]) -> dict[str, Any]:
    history, turn = run.recorder.history, run.system.turn
    last = slice(run.done - EVALUATED * STRETCH * POINTS, run.done)
    pockets = float(history.pocket_power[last].sum(axis=1).mean())
    land = float(history.land_power[last].mean())
    path = _path(run, last, pockets + land)
    count, total, squares = np.sum([one.torques for one in found[-EVALUATED:]], axis=0)
    torque = total / count
    force, at_land = history.force[last, :-2], history.force[last, -2:].sum(axis=1)
    return {
        "status": OK,
        "motion": path.motion,
        "work": (pockets + land) * turn,
        "pocket_work": pockets * turn,
        "land_work": land * turn,
        "pocket_force": float(force.mean()),
        "pocket_force_99": float(np.quantile(force, 0.99)),
        "land_force": float(at_land.mean()),
        "land_force_99": float(np.quantile(at_land, 0.99)),
        "shaft_torque": float(torque),
        "torque_noise": math.sqrt(max(squares / count - torque**2, 0.0) * count / (count - 1.0)),
        "whirl_ratio": path.whirl,
        "ball_ratio": run.system.ball_ratio,
        "offset": path.offset,
        "offset_scatter": path.scatter,
        "centre": [path.centre.real, path.centre.imag],
        "turns": run.turns,
    }
