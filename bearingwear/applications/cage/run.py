"""One run of a cage from a start, as long as its motion needs to settle."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from bearingwear import Scene
from bearingwear.applications.cage.motion import JAMS, MOTIONS, CagePath, cage_path, is_drifting
from bearingwear.applications.cage.plan import STRETCH
from bearingwear.kernels.status import CAGE_JAMMED, OK, UNVERIFIED
from bearingwear.results.variable import STATUS, Variable, table
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
"""Results of a run, over its last stretches where no other time is named."""

EVALUATED = 2
"""Stretches at the end of a run over which it is averaged."""

ALIKE = 3
"""Stretches at the end of a settled run that have one motion and do not drift."""

DRIFT_OF_WORK, DRIFT_OF_PLACE = 0.05, 5e-3
"""Relative drifts over these stretches up to which a run has settled. A cage that nears its land
drifts by 0.03 of its place in ten turns, one that whirls scatters by 0.002."""

POINTS = 20  # instants a turn


def cage_run(scene: Scene, start: CageStart, least_turns: int, most_turns: int) -> dict[str, Any]:
    """Returns the results of a run from one start, by the names of `CAGE_RUN`.

    A run that failed has its status but no results; see `_single_run`. One that is UNVERIFIED is
    repeated with a tighter tolerance, until that is below `TIGHTEST_RUN`.

    scene: with a cage and without a thermal network.
    least_turns, most_turns: shaft turns after which a run may end and must end, multiples of
        `STRETCH`.
    """
    model = replace(
        scene.model,
        history_points_per_turn=POINTS,
        simulated_turns=float(most_turns),
        evaluated_turns=float(STRETCH),
    )
    scene, tolerance = replace(scene, model=model), scene.model.dynamic_tolerance
    while True:
        row = _single_run(scene, start, least_turns, tolerance)
        if row["status"] != UNVERIFIED or tolerance < TIGHTEST_RUN:
            return row
        tolerance /= TIGHTER


def _single_run(
    scene: Scene, start: CageStart, least_turns: int, tolerance: float
) -> dict[str, Any]:
    """Returns the results of a run by the names of `CAGE_RUN`; its status says how it ended.

    OK: the motion has settled after `least_turns`, or the simulated turns of the model have passed,
    settled or not; all results are there.
    UNVERIFIED: over the last stretch, the error of the energy balance is above `LARGEST_ACCOUNT` of
    the dissipated energy, or the forces on a ball or on the inner race leave a component above
    `LARGEST_UNBALANCED` of the contact load; only `energy_account_error` is there.
    Any other: the run failed; no result is there, but `motion` where the cage has jammed.

    tolerance: of the steps, in place of that of the model.
    """
    system = DynamicSystem.of(scene, start_of(scene).u)
    system.start_cage(start)
    start_vector, start_time = system.packed(), system.time
    status = system.diagnose(system.update())
    if status != OK:
        return _failed_run(status)
    with Interrupt():
        run = TimeRun(scene, system, None, tolerance)
        # TimeRun has advanced the system to compile the kernels: back to the start
        system.unpack(start_vector, start_time)
        stretches: list[_Stretch] = []
        for length in run.grid.windows:
            status = run.window(length)
            if status != OK:
                return _failed_run(system.diagnose(status))
            stretches.append(_stretch(run, length))
            # else the loop ends with the last window, which counts as solved, too
            if run.turns >= least_turns and _is_settled(stretches):
                break
    values = window_values(scene, run)
    energy_error = values["energy_account_error"]
    if values["equilibrium_residual"] > LARGEST_UNBALANCED or abs(energy_error) > LARGEST_ACCOUNT:
        return {"status": UNVERIFIED, "energy_account_error": energy_error}
    return _run_values(run, stretches) | {"energy_account_error": energy_error}


def _failed_run(status: int) -> dict[str, Any]:
    """Returns the results of a run that failed: its status, and `motion` if the cage has jammed."""
    row = {"status": int(status)}
    if status == CAGE_JAMMED:
        row["motion"] = JAMS
    return row


class _Stretch(NamedTuple):
    """Motion, work and torque over `STRETCH` turns."""

    path: CagePath
    work: float  # in pockets and at the land in a turn [J]
    torques: np.ndarray  # sums over its turns of 1, torque and its square


def _stretch(run: TimeRun, length: int) -> _Stretch:
    """Returns motion, work and torque over the last window of a run.

    length: number of recorded instants of the window.
    """
    last = slice(run.done - length, run.done)
    trend, history = run.trend, run.recorder.history
    # over the turns of the window: their number, and sums of the torque and of its square
    torques = np.array(
        [trend.sums[0], trend.values[0, TREND_OF_TORQUE], trend.values[2, TREND_OF_TORQUE]]
    )
    torques /= (1.0, POINTS, POINTS**2)  # the value of a turn is the sum over its instants
    power = float(history.pocket_power[last].sum(axis=1).mean() + history.land_power[last].mean())
    return _Stretch(path=_path(run, last, power), work=power * run.system.turn, torques=torques)


def _path(run: TimeRun, stretch: slice, power: float) -> CagePath:
    """Returns the path of the cage over a stretch of the recorded instants.

    power: mean of normal force times slip at the cage [W].
    """
    y, z = run.cage_offset(stretch).T
    return cage_path(y + 1j * z, 1.0 / POINTS, power, run.system.ball_ratio)


def _is_settled(stretches: list[_Stretch]) -> bool:
    """Returns whether the last `ALIKE` stretches have one motion, and neither work nor place drift.

    The place is the mean distance of the cage's centre from the axis. False for fewer stretches.
    """
    last = stretches[-ALIKE:]
    return (
        len(last) == ALIKE
        and len({stretch.path.motion for stretch in last}) == 1
        and not is_drifting([stretch.work for stretch in last], DRIFT_OF_WORK)
        and not is_drifting([stretch.path.offset for stretch in last], DRIFT_OF_PLACE)
    )


def _run_values(run: TimeRun, stretches: list[_Stretch]) -> dict[str, Any]:
    """Returns the results of a solved run by the names of `CAGE_RUN`, without the energy balance.

    They are of its last `EVALUATED` stretches, except `turns`, which is of the whole run.
    """
    history, seconds_per_turn = run.recorder.history, run.system.turn
    last = slice(run.done - EVALUATED * STRETCH * POINTS, run.done)
    pocket_power = float(history.pocket_power[last].sum(axis=1).mean())
    land_power = float(history.land_power[last].mean())
    path = _path(run, last, pocket_power + land_power)
    count, total, squares = np.sum([stretch.torques for stretch in stretches[-EVALUATED:]], axis=0)
    torque = total / count
    # the last two contacts are those of the guiding land
    pocket_force, land_force = history.force[last, :-2], history.force[last, -2:].sum(axis=1)
    return {
        "status": OK,
        "motion": path.motion,
        "work": (pocket_power + land_power) * seconds_per_turn,
        "pocket_work": pocket_power * seconds_per_turn,
        "land_work": land_power * seconds_per_turn,
        "pocket_force": float(pocket_force.mean()),
        "pocket_force_99": float(np.quantile(pocket_force, 0.99)),
        "land_force": float(land_force.mean()),
        "land_force_99": float(np.quantile(land_force, 0.99)),
        "shaft_torque": float(torque),
        # rounding may make the variance of a steady torque negative
        "torque_noise": math.sqrt(max(squares / count - torque**2, 0.0) * count / (count - 1.0)),
        "whirl_ratio": path.whirl,
        "ball_ratio": run.system.ball_ratio,
        "offset": path.offset,
        "offset_scatter": path.scatter,
        "centre": [path.centre.real, path.centre.imag],
        "turns": run.turns,
    }
