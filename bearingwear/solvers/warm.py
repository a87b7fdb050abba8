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
    NO_HEAT,
    HeatFlow,
    Warmed,
    find_heat_balance,
    heat_flow_residual,
)

CONDUCTED = (0.3, 1.8)
"""Range of the conductance between balls and a race, over that of the scene: public estimates for a
7008C are 0.54 and 2.0 (contacts alone) to 3.6 W/K (with oil)."""


class Warm(Wrapper):
    """A bearing with a thermal network, at the temperatures of its heat or of a given `balance`."""

    def __init__(self, solver: Solver, balance: Warmed | None = None):
        super().__init__(solver)
        self._balance = balance
        if balance is not None:
            self.solver = solver.at(balance.scene)

    def __call__(self, condition: Condition, near: SolvedBearing | None = None) -> SolvedBearing:
        """Returns the bearing solved at the temperatures of its heat, or of the given balance.

        Where no temperatures are found, it has the status of that search and NaN for its numbers.
        """
        if self._balance is not None:
            return self.solver(condition, near)._replace(warmed=self._balance)
        last = near

        def heats(scene: Scene) -> tuple[int, HeatFlow]:
            """Returns status and heat at the temperatures of a scene, from the last solution."""
            nonlocal last
            solution = self.solver.at(scene)(condition, last)
            if solution.status != code.OK:
                return solution.status, NO_HEAT
            last = solution
            return solution.status, self.solver.heat(solution)

        start = None if near is None else near.warmed
        warmed = find_heat_balance(self.scene, heats, start, self.solver.heat_error)
        if warmed.status != code.OK or last is None:
            return SolvedBearing(warmed.status, condition, warmed.scene, warmed=warmed)
        return last._replace(warmed=warmed)

    def at(self, scene: Scene) -> Solver:
        """Returns the solver within at other temperatures, those of a scene."""
        return self.solver.at(scene)

    def state(self, solution: SolvedBearing) -> State:
        """Returns the state of a life, with temperatures and the residual of their heat flows."""
        state = self.solver.state(solution)
        if not state.is_solved or solution.warmed is None:
            return state
        return state.with_values(warmth_values(self.scene, solution.warmed))

    def case(self, solution: SolvedBearing) -> CaseValues:
        """Returns values and attributes of the case, with those of the thermal network."""
        warmed = solution.warmed
        assert warmed is not None
        if solution.problem is None:
            return {"status": solution.status}, {"residual": warmed.sentence}
        values, attrs = self.solver.at(solution.scene).case(solution)
        if "friction_heat" in values:
            heat = heat_of_values(self.scene, values)
            values |= network_values(self.scene, warmed, values["status"], heat)
        return values, attrs


def warmed_for_motion(scene: Scene, bare: Bare = COVERED) -> Warmed:
    """Returns the scene at temperatures for a motion in time, and how they were found.

    A scene without a thermal network keeps its own. Otherwise they are those of the steady state
    under the thrust alone or, where that is not solved, of race control: warming up in time takes
    a million turns.
    """
    if scene.thermal is None:
        return Warmed.as_given(scene)
    loss = float(np.mean(scene.wear.ball_diameter_loss_um)) * parameters.UM
    solution = Warm(Steady(thrust_alone(scene)))(Condition(loss, bare))
    has_steady_state = solution.status in (code.OK, code.WARM_SEIZURE, code.NO_HEAT_BALANCE)
    if not has_steady_state:
        race_control = Warm(RaceControl(scene))
        solution = race_control(race_control.start._replace(bare=bare))
    warmed = solution.warmed
    assert warmed is not None
    # the solved scene may have the thrust alone: only its temperatures are taken over
    temperature = warmed.scene.temperature
    if temperature is None:  # the status of `warmed` says why
        return replace(warmed, scene=scene)
    return replace(warmed, scene=replace(scene, temperature=temperature, thermal=None))


def preload_spread(solver: Warm) -> str:
    """Returns the running preload with less and more heat conducted between rings, in words.

    The conductance is changed by the factors `CONDUCTED`. A status stands for a preload that is not
    found.
    """
    scene = solver.scene
    sentences = []
    assert scene.thermal is not None
    G = scene.thermal.conductance_W_K
    for factor in CONDUCTED:
        conductance = replace(G, ball_race=factor * G.ball_race)
        thermal = replace(scene.thermal, conductance_W_K=conductance)
        solution = Warm(solver.at(replace(scene, thermal=thermal)))(solver.start)
        preload = f"{plain(solution.force)} N"
        if solution.status != code.OK:
            preload = code.STATUS_NAMES[solution.status]
        sentences.append(f"{preload} with {conductance.ball_race:.2g} W/K")
    range_words = "from the balls to each ring (uncertainty range of this conductance)"
    return f"running preload {' and '.join(sentences)} {range_words}"


def warmth_values(scene: Scene, warmed: Warmed) -> dict[str, Any]:
    """Returns temperatures of parts and residual of a network's heat flows, for a state of a life.

    Empty without a network, or where no temperatures were found.
    """
    t = warmed.scene.temperature
    if scene.thermal is None or t is None:
        return {}
    return {
        "part_temperature": np.array(part_temperatures(warmed.scene)),
        "heat_flow_residual": heat_flow_residual(scene.thermal, t, warmed.heat),
    }


def network_values(scene: Scene, warmed: Warmed, status: int, heat: HeatFlow) -> dict[str, Any]:
    """Returns result variables of a thermal network; empty without one or without temperatures.

    They include the status UNVERIFIED if the result's heat does not fit its temperatures.

    scene: with the network.
    warmed: temperatures found.
    status, heat: those of the result.
    """
    t = warmed.scene.temperature
    if scene.thermal is None or t is None:
        return {}
    residual = heat_flow_residual(scene.thermal, t, heat)
    values = {"heat_flow_residual": residual, "thermal_solves": warmed.solves}
    if status == code.OK and not residual <= LARGEST_HEAT_RESIDUAL:
        return values | {"status": code.UNVERIFIED}
    return values
