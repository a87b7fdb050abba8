"""Friction heat of a scene by each model, and the scene at the resulting temperatures."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.ball import drag_force
from bearingwear.kernels.summary import HEAT
from bearingwear.kernels.thrust import ThrustCase
from bearingwear.model import parameters
from bearingwear.model.growth import part_temperatures
from bearingwear.model.race_control import RaceControlProblem, solve_race_control
from bearingwear.model.start import thrust_alone
from bearingwear.model.steady import ThrustProblem, axial_force
from bearingwear.model.thermal import (
    LARGEST_HEAT_RESIDUAL,
    HeatFlow,
    Warmed,
    heat_flow_residual,
    warmed,
)
from bearingwear.scene.scene import Scene

CONDUCTED = (0.3, 1.8)
"""Heat conducted between balls and a race over what the scene has: public estimates for a 7008C
reach from 0.54 over 2.0 (contacts alone) to 3.6 W/K (with oil)."""

NOTHING = HeatFlow(inner=0.0, outer=0.0, drag=0.0)


def heat_of_case(problem: ThrustProblem, D: float, case: ThrustCase) -> HeatFlow:
    """Of a solved steady state."""
    n = problem.g.n_balls
    F_v, _ = drag_force(problem.g, D, problem.op.drag, case.u[3])
    inner, outer = (float(n * heat) for heat in case.contacts[:, HEAT])
    return HeatFlow(inner, outer, drag=float(n * F_v * case.r * case.u[3]))


def heat_of_values(scene: Scene, values: Mapping[str, Any]) -> HeatFlow:
    """Of the values of a result, by whatever model."""
    n = scene.bearing.ball_count
    inner, outer = (float(n * heat) for heat in np.mean(values["friction_heat"], axis=0))
    return HeatFlow(inner, outer, drag=float(values["drag_power"]))


@dataclass
class SteadyHeat:
    """Heat of a scene's steady state at any temperatures; each solve starts from the last one."""

    loss: float  # of ball diameter [m]
    like: ThrustProblem | None = None  # whose accuracy and preload are taken, not the scene's
    u: np.ndarray | None = None  # motion of a solve nearby
    problem: ThrustProblem = field(init=False)  # of the last solve
    case: ThrustCase = field(init=False)

    def __call__(self, scene: Scene) -> tuple[int, HeatFlow]:
        if self.like is None:
            problem = ThrustProblem.of(scene)
        else:
            problem = replace(self.like, g=parameters.geometry(scene))
        status = problem.undetermined()
        if status != code.OK:
            return status, NOTHING
        D = problem.g.D0 - self.loss
        case = problem.solve(D, self.u)
        if case.status != code.OK:
            return case.status, NOTHING
        self.problem, self.case, self.u = problem, case, case.u
        return code.OK, heat_of_case(problem, D, case)


def race_control_heat(
    scene: Scene, problem: RaceControlProblem | None = None
) -> tuple[int, HeatFlow]:
    """Estimated heat of the race-control solution; `problem` as `solve_race_control` takes it."""
    values, _ = solve_race_control(scene, problem)
    status = int(values["status"])
    return status, heat_of_values(scene, values) if status == code.OK else NOTHING


def warmed_for(scene: Scene, fidelity: str) -> tuple[Warmed, SteadyHeat]:
    """A scene with a thermal network at the temperatures of its own friction heat.

    The dynamic model takes those of the steady state under the thrust alone, or of race control
    where there is none: warming takes a million turns.

    Returns
    -------
    Warmed
    SteadyHeat
        With the steady state that was last solved, if that model made the heat.
    """
    heat = SteadyHeat(float(np.mean(scene.wear.ball_diameter_loss_um)) * parameters.UM)
    if fidelity == "race_control":
        return warmed(scene, race_control_heat), heat
    found = warmed(thrust_alone(scene), heat)
    if fidelity == "dynamic" and found.status not in (
        code.OK,
        code.WARM_SEIZURE,
        code.NO_HEAT_BALANCE,
    ):
        found = warmed(scene, race_control_heat)
    given = found.scene.temperature
    if given is None:
        return replace(found, scene=scene), heat
    return replace(found, scene=replace(scene, temperature=given, thermal=None)), heat


def preload_spread(scene: Scene) -> str:
    """The running preload of a fixed position with less and more heat conducted between rings."""
    assert scene.thermal is not None
    G, told = scene.thermal.conductance_W_K, []
    for factor in CONDUCTED:
        other = replace(G, ball_race=factor * G.ball_race)
        thermal = replace(scene.thermal, conductance_W_K=other)
        found, heat = warmed_for(replace(scene, thermal=thermal), "steady")
        preload = code.STATUS_NAMES[found.status]
        if found.status == code.OK:
            preload = f"{axial_force(heat.case, heat.problem.g.n_balls):.3g} N"
        told.append(f"{preload} with {other.ball_race:.2g} W/K")
    return f"running preload {' and '.join(told)} from balls to a race, which is known no better"


def warmth_of(scene: Scene, found: Warmed) -> dict[str, Any]:
    """Temperatures and heat flows of a scene with a network, as a state of a life has them."""
    t = found.scene.temperature
    assert scene.thermal is not None and t is not None
    return {
        "part_temperature": np.array(part_temperatures(found.scene)),
        "heat_flow_residual": heat_flow_residual(scene.thermal, t, found.heat),
    }


def network_values(
    scene: Scene, found: Warmed, values: Mapping[str, Any], fidelity: str
) -> dict[str, Any]:
    """Result variables of the network; the heat flows are those of the solved values."""
    t = found.scene.temperature
    assert scene.thermal is not None and t is not None
    # the dynamic model takes its temperatures from another model
    heat = found.heat if fidelity == "dynamic" else heat_of_values(scene, values)
    residual = heat_flow_residual(scene.thermal, t, heat)
    made = {"heat_flow_residual": residual, "thermal_solves": found.solves}
    if values["status"] == code.OK and not residual <= LARGEST_HEAT_RESIDUAL:
        return made | {"status": code.UNVERIFIED}
    return made
