"""Variables of a dynamic case: averages over its window, accounts, histories."""

import math
from typing import Any

import numpy as np

from bearingwear.kernels.contact.summary import ANGLE, PRESSURE, QV
from bearingwear.kernels.dynamic import record
from bearingwear.kernels.dynamic.model import BearingModel
from bearingwear.kernels.steady.thrust import skid_ratio
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.films import (
    PEAK_OVER_MEAN,
    Films,
    contact_temperatures,
    pressure_of_load,
)
from bearingwear.solvers.bearing.outputs import contact_values
from bearingwear.solvers.dynamic.system import DynamicSystem
from bearingwear.solvers.dynamic.windows import TimeRun, wear_per_joule

LEAST_LOST = 1e-6  # of the kinetic energy: losses below it are no scale of an error


def window_values(scene: Scene, run: TimeRun) -> dict:
    """Returns result variables of a run from the opening of its last window until now.

    They are averages, ranges of loads, and the account of energy. In a periodic motion, each ball
    gets the means over all balls, which replace the sums of `run.recorder`, too.
    """
    system, sums, bearing = run.system, run.recorder.sums, run.system.bearing
    now = system.snapshot()
    opening = run.opening
    time, integrals = now.time - opening.time, now.integrals - opening.integrals
    count = sums.count[0]
    contacts = sums.contacts / count
    loads = run.loads
    contacts[:, :, QV] = integrals[: contacts[:, :, QV].size].reshape(-1, 2) / time
    if run.grid.is_periodic:
        contacts[:] = contacts.mean(axis=0)
        sums.ball[:] = sums.ball.mean(axis=0)
        sums.slip[:] = sums.slip.mean(axis=1, keepdims=True)
        loads = loads.of_like_balls()
    values = averages(scene, bearing, sums, contacts) | {
        "maximum_pressure": loads.largest_pressure(contacts[:, :, PRESSURE], count),
        "maximum_contact_load": loads.largest,
        "minimum_contact_load": loads.smallest,
        "unloaded_share": loads.unloaded / count,
    }
    change = {key: value - opening.energy[key] for key, value in now.energy.items()}
    values |= account_values(change, system.energy()["kinetic"])
    if scene.cage is not None:
        add_cage_values(scene, system, integrals, time, values)
        values["cage_speed"] = sums.bearing[record.CAGE_SPEED] / count
        values["cage_momentum_rate"] = (now.momentum - opening.momentum) / time
    return values


def averages(
    scene: Scene, bearing: BearingModel, sums: record.Sums, contacts: np.ndarray
) -> dict[str, Any]:
    """Returns the result variables that are means over the instants of a window.

    `equilibrium_residual` alone is the largest of all instants.

    sums: over the instants.
    contacts: (n, 2, COLUMNS) of `kernels.contact.summary`, means already.
    """
    count, D = sums.count[0], bearing.D
    ball_means, bearing_means = sums.ball / count, sums.bearing / count
    motion = np.ascontiguousarray(ball_means[:, : record.RADIUS])
    r = ball_means[:, record.RADIUS]
    values = contact_values(
        scene, bearing.g, bearing.op, D, motion, r, contacts, ball_means[:, record.AXIAL]
    )
    skids = [
        skid_ratio(bearing.op, *contacts[j, :, ANGLE], 0.5 * D[j], r[j], u)
        for j, u in enumerate(motion)
    ]
    return values | {
        "gyroscopic_slip": sums.slip[0] / count,
        "rolling_slip": sums.slip[1] / count,
        "axial_displacement": bearing_means[record.SHIFT],
        "residual_preload": bearing_means[record.PRELOAD],
        "shaft_torque": bearing_means[record.INNER_RACE_TORQUE],
        "drag_power": bearing_means[record.DRAG_POWER],
        "axial_stiffness": bearing_means[record.STIFFNESS],
        "centrifugal_force": ball_means[:, record.CENTRIFUGAL],
        "equilibrium_residual": sums.residual[0],
        "skid_ratio": np.mean(skids),
    }


def account_values(change: dict[str, float], kinetic: float) -> dict[str, float]:
    """Returns result variables: the error of the energy balance, and shares of neglected terms.

    change: of each term of `DynamicSystem.energy` over the window [J].
    kinetic: energy at its end [J].
    """
    accounted = sum(value for key, value in change.items() if key != "supplied")
    lost = sum(change[key] for key in ("heat", "cage heat", "damping")) + abs(change["drag"])
    # Without friction there is no heat to compare with; rounding depends on the kinetic energy.
    scale = max(lost, LEAST_LOST * kinetic)
    return {
        "energy_account_error": (change["supplied"] - accounted) / scale,
        "coriolis_energy_share": change["coriolis"] / scale,
        "azimuth_energy_share": change["azimuth"] / scale,
    }


def add_cage_values(
    scene: Scene,
    system: DynamicSystem,
    integrals: np.ndarray,
    time: float,
    values: dict[str, Any],
) -> None:
    """Adds torques, heat and wear of the cage, and the wear of the balls by its pockets.

    integrals: those of the state over the window, from the first one on.
    time: length of the window [s].
    values: result variables, to which these are added in place.
    """
    layout, first, D = system.layout, system.layout.qv, system.bearing.D
    pockets = integrals[layout.pockets - first : layout.land - first] / time
    assert scene.cage is not None
    cage_rate = wear_per_joule(scene, scene.cage.material)
    ball_rate = wear_per_joule(scene, scene.bearing.ball_material)
    values["ball_wear_rate"] = values["ball_wear_rate"] + ball_rate * pockets
    values["ball_diameter_loss_rate"] = values["ball_diameter_loss_rate"] + np.mean(
        2.0 * ball_rate * pockets / (math.pi * D**2)
    )
    values |= {
        "cage_wear_rate": cage_rate * pockets.sum(),
        "pocket_wear_rate": cage_rate * pockets,
        "cage_land_wear_rate": cage_rate * integrals[layout.land - first] / time,
        "cage_friction_heat": integrals[layout.cage_heat - first] / time,
        "mean_pocket_torque": integrals[layout.pocket_torque - first] / time,
        "mean_land_torque": integrals[layout.land_torque - first] / time,
        "mean_gravity_torque": integrals[layout.gravity_torque - first] / time,
    }


def histories(scene: Scene, history: record.History, length: int) -> dict:
    """Returns the result variables along a run, over its first instants; those of the cage if any.

    history: as recorded, which may have room for more.
    length: number of instants.
    """
    log = record.History._make(column[:length] for column in history)
    ball_factor, race_factor = parameters.wear_factors(scene)
    films = Films.of(scene)
    wearing_qv = log.qv
    if films.table is not None:
        pressure = PEAK_OVER_MEAN * pressure_of_load(scene, log.load)
        wearing_qv = log.qv * films.table_factor(pressure, contact_temperatures(scene))
    ball_in_pocket = wear_per_joule(scene, scene.bearing.ball_material)
    values = {
        "time": log.time,
        "history_contact_load": log.load,
        "history_slip": log.slip,
        "history_contact_qv": log.qv,
        "history_orbit_lead": log.lead,
        "history_residual_preload": log.preload,
        "history_race_displacement": log.displacement,
        "history_ball_wear_rate": ball_factor * wearing_qv.sum(axis=2)
        + ball_in_pocket * log.pocket_power,
        "history_race_wear_rate": race_factor * wearing_qv.sum(axis=1),
    }
    if scene.cage is None:
        return values
    cage_factor = wear_per_joule(scene, scene.cage.material)
    return values | {
        "history_cage_position": log.cage[:, record.POSITION : record.POSITION + 3],
        "history_cage_tilt": log.cage[:, record.TILT : record.TILT + 3],
        "history_cage_speed": log.cage[:, record.SPEED],
        "history_pocket_force": log.force[:, :-2],
        "history_land_force": log.force[:, -2:],
        "history_cage_pocket_wear_rate": cage_factor * log.pocket_power.sum(axis=1),
        "history_cage_land_wear_rate": cage_factor * log.land_power,
    }
