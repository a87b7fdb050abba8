"""A bearing at the temperatures of its own friction heat, by any model (theory.md section 18)."""

from dataclasses import replace
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.measures import plain
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.films import COVERED, Bare
from bearingwear.solvers.bearing.growth import part_temperatures
from bearingwear.solvers.condition import CaseValues, Condition, SolvedBearing, Solver, Wrapper
from bearingwear.solvers.race_control import RaceControl, heat_of_values
from bearingwear.solvers.start import thrust_alone
from bearingwear.solvers.state import State
from bearingwear.solvers.steady import Steady
from bearingwear.solvers.thermal import (
    LARGEST_HEAT_RESIDUAL,
    HeatFlow,
    Warmed,
    heat_flow_residual,
    warmed,
)

CONDUCTED = (0.3, 1.8)
"""Heat conducted between balls and a race over what the scene has: public estimates for a 7008C
reach from 0.54 over 2.0 (contacts alone) to 3.6 W/K (with oil)."""

NOTHING = HeatFlow(inner=0.0, outer=0.0, drag=0.0)


class Warm(Wrapper):
    """A bearing with a thermal network, or at temperatures `kept` in place of those of the heat."""

    def __init__(self, solver: Solver, kept: Warmed | None = None):
        super().__init__(solver)
        self._kept = kept
        if kept is not None:
            self.solver = solver.at(kept.scene)

    def __call__(self, condition: Condition, near: SolvedBearing | None = None) -> SolvedBearing:
        if self._kept is not None:
            return self.solver(condition, near)._replace(warmed=self._kept)
        last = near

        def heats(scene: Scene) -> tuple[int, HeatFlow]:
            nonlocal last
            found = self.solver.at(scene)(condition, last)
            if found.status != code.OK:
                return found.status, NOTHING
            last = found
            return found.status, self.solver.heat(found)

        start = None if near is None else near.warmed
        found = warmed(self.scene, heats, start, self.solver.heat_error)
        if found.status != code.OK or last is None:
            return SolvedBearing(found.status, condition, found.scene, warmed=found)
        return last._replace(warmed=found)

    def at(self, scene: Scene) -> Solver:
        return self.solver.at(scene)

    def state(self, solution: SolvedBearing) -> State:
        state = self.solver.state(solution)
        if not state.is_solved or solution.warmed is None:
            return state
        return state.with_values(warmth_of(self.scene, solution.warmed))

    def case(self, solution: SolvedBearing) -> CaseValues:
        found = solution.warmed
        assert found is not None
        if solution.problem is None:
            return {"status": solution.status}, {"residual": found.sentence}
        values, attrs = self.solver.at(solution.scene).case(solution)
        if "friction_heat" in values:
            heat = heat_of_values(self.scene, values)
            values |= network_values(self.scene, found, values["status"], heat)
        return values, attrs


def warm_scene(scene: Scene, bare: Bare = COVERED) -> Warmed:
    """A scene at the temperatures that its motion is marched at: its own without a network.

    Else they are those of the steady state under the thrust alone, or of race control where there
    is none: warming takes a million turns.
    """
    if scene.thermal is None:
        return Warmed(code.OK, scene, NOTHING, 0, np.zeros((3, 3)))
    loss = float(np.mean(scene.wear.ball_diameter_loss_um)) * parameters.UM
    solution = Warm(Steady(thrust_alone(scene)))(Condition(loss, bare))
    if solution.status not in (code.OK, code.WARM_SEIZURE, code.NO_HEAT_BALANCE):
        hot = Warm(RaceControl(scene))
        solution = hot(hot.start._replace(bare=bare))
    found = solution.warmed
    assert found is not None
    given = found.scene.temperature
    if given is None:
        return replace(found, scene=scene)
    return replace(found, scene=replace(scene, temperature=given, thermal=None))


def preload_spread(solver: Warm) -> str:
    """The running preload of a fixed position with less and more heat conducted between rings."""
    scene, sentences = solver.scene, []
    assert scene.thermal is not None
    G = scene.thermal.conductance_W_K
    for factor in CONDUCTED:
        other = replace(G, ball_race=factor * G.ball_race)
        thermal = replace(scene.thermal, conductance_W_K=other)
        found = Warm(solver.at(replace(scene, thermal=thermal)))(solver.start)
        preload = f"{plain(found.force)} N"
        if found.status != code.OK:
            preload = code.STATUS_NAMES[found.status]
        sentences.append(f"{preload} with {other.ball_race:.2g} W/K")
    known = "from the balls to each ring (uncertainty range of this conductance)"
    return f"running preload {' and '.join(sentences)} {known}"


def warmth_of(scene: Scene, found: Warmed) -> dict[str, Any]:
    """Temperatures and heat flows of a network, as a state of a life has them."""
    t = found.scene.temperature
    if scene.thermal is None or t is None:
        return {}
    return {
        "part_temperature": np.array(part_temperatures(found.scene)),
        "heat_flow_residual": heat_flow_residual(scene.thermal, t, found.heat),
    }


def network_values(scene: Scene, found: Warmed, status: int, heat: HeatFlow) -> dict[str, Any]:
    """Result variables of the network with the heat of a result, whose status they may change."""
    t = found.scene.temperature
    if scene.thermal is None or t is None:
        return {}
    residual = heat_flow_residual(scene.thermal, t, heat)
    made = {"heat_flow_residual": residual, "thermal_solves": found.solves}
    if status == code.OK and not residual <= LARGEST_HEAT_RESIDUAL:
        return made | {"status": code.UNVERIFIED}
    return made
