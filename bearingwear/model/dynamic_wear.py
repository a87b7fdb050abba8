"""Dynamic wear life: short runs along the life, each at the wear that those before it left.

What wears (each ball, races, pockets, land) is integrated over the running time by a predictor and
the trapezoidal rule (theory.md section 13). The rates at each node are those of a dynamic run at
the predicted wear, continued from the end of the run before.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.model import parameters
from bearingwear.model.dynamic_run import solve_dynamic
from bearingwear.model.fidelity import asymmetries
from bearingwear.model.heat import warmed_for, warmth_of
from bearingwear.model.life import margins
from bearingwear.model.race_control import solve_race_control
from bearingwear.model.state import State, case_state
from bearingwear.model.states_at_loss import in_half_of_pair
from bearingwear.model.steady import ThrustProblem
from bearingwear.model.worn_parts import WornParts
from bearingwear.scene.blocks import CRITERIA, OF_CAGE
from bearingwear.scene.scene import LARGEST_LOSS, EndOfLife, Scene, SceneError

_MOST_STEPS = 20  # times the steps asked for, because rates may fall on the way
END = 1e-3  # of a step: tolerance of the end
_MOST_TRIALS = 8  # runs to find the end
_CLEARANCES = ("pocket_clearance", "guide_clearance")
"""Of a cage, as `WornParts.clearances` gives them."""


@dataclass
class Node:
    """A point of the life: what has worn, and what a dynamic run found there."""

    time: float  # [s]
    worn: np.ndarray
    status: int
    carried_on: bool = False
    values: dict[str, Any] = field(default_factory=dict)
    warmth: dict[str, Any] = field(default_factory=dict)  # where a network finds temperatures
    residual: str = "not solved"
    rates: np.ndarray = field(default_factory=lambda: np.empty(0))

    @property
    def end(self) -> dict[str, Any]:
        """State from which the next run continues."""
        return {"state": self.values["final_state"], "time": self.values["final_time"]}


class DynamicWear:
    """A dynamic life of a scene.

    Parameters
    ----------
    scene : Scene
        As it is solved: without its cage where that is not asked for.
    progress : callable, optional
        Called with a line that says how far the life has come.
    """

    def __init__(self, scene: Scene, progress: Callable[[str], None] | None = None):
        self.scene, self.progress = scene, progress
        self.parts = WornParts(scene)
        self.end = scene.wear.end_of_life or EndOfLife()
        self.limits = (self.end.pocket_clearance_mm, self.end.guide_clearance_mm)

    def evaluate(self, time: float, worn: np.ndarray, before: Node | None) -> Node:
        """A dynamic run at that wear, from the end of the one before or a start of its own."""
        try:
            scene = self.parts.worn_scene(worn)
        except SceneError:
            return Node(time, worn, code.CRITERION_NOT_REACHED)
        warmth: dict[str, Any] = {}
        if scene.thermal is not None:
            warm, _ = warmed_for(scene, "dynamic")
            if warm.status != code.OK:
                return Node(time, worn, warm.status, residual=warm.sentence)
            scene, warmth = warm.scene, warmth_of(scene, warm)
        if before is not None:
            values, attrs = solve_dynamic(scene, restart=before.end)
        if before is None or values["status"] != code.OK:
            values, attrs = self.first_run(scene)
            before = None
        found = Node(
            time,
            worn,
            status=int(values["status"]),
            carried_on=before is not None,
            values=values,
            warmth=warmth,
            residual=attrs["residual"],
        )
        if found.status == code.OK:
            found.rates = self.parts.rates(values)
            found.values["quasistatic_axial_stiffness"] = self.quasistatic(scene)
        return found

    def quasistatic(self, scene: Scene) -> float:
        """Axial stiffness at some wear, which no run has: steady, or by race control [N/m].

        The steady one where the scene has a steady state but for how the balls have worn.
        """
        if asymmetries(self.scene):
            values, _ = solve_race_control(scene)
            return float(values.get("quasistatic_axial_stiffness", math.nan))
        problem = ThrustProblem.of(scene).without_finer
        case = problem.solve(float(parameters.ball_diameters(scene).mean()))
        return problem.g.n_balls * case.S_quasistatic if case.status == code.OK else math.nan

    def first_run(self, scene: Scene) -> tuple[dict, dict]:
        """A run from a start of its own; with a cage after `life_run_in_turns`.

        A cage takes hundreds of turns to forget how it started, and seems settled long before.
        """
        restart = None
        if scene.cage is not None and self.parts.model.life_run_in_turns > 0.0:
            turns = self.parts.model.life_run_in_turns
            run_in = replace(
                self.parts.model, simulated_turns=turns, evaluated_turns=turns, settled_drift=0.0
            )
            values, attrs = solve_dynamic(replace(scene, model=run_in))
            if values["status"] != code.OK:
                return values, attrs
            restart = {"state": values["final_state"], "time": values["final_time"]}
        return solve_dynamic(scene, restart=restart)

    def step(self, nodes: list[Node], time: float) -> Node:
        """The node at that time, from all earlier ones."""
        last, h = nodes[-1], time - nodes[-1].time
        ahead = last.rates
        if len(nodes) > 1:
            before = nodes[-2]
            ahead = last.rates + 0.5 * h / (last.time - before.time) * (last.rates - before.rates)
            ahead = np.maximum(ahead, 0.0)  # nothing grows back
        found = self.evaluate(time, last.worn + h * ahead, last)
        if found.status == code.OK:
            found.worn = last.worn + 0.5 * h * (last.rates + found.rates)
        return found

    def state(self, node: Node) -> State:
        """A node as a state of the steady life, with the clearances of the cage."""
        loss = float(self.parts.loss(node.worn).mean())
        state = case_state(loss, {"status": node.status, **node.values})
        clearances = dict(zip(_CLEARANCES, self.parts.clearances(node.worn), strict=True))
        if not state.is_solved:
            return state.with_values(clearances)
        heat = float(node.values["friction_heat"].sum()) + float(node.values["drag_power"])
        more = {"friction_power": heat} | node.warmth | clearances
        mounted = parameters.static_place(self.scene)
        return in_half_of_pair(self.scene, mounted, state.with_values(more))

    def end_rate(self, node: Node, criterion: int) -> float:
        """Rate of what the criterion looks at: a clearance, else the mean loss [m/s]."""
        name = CRITERIA[criterion]
        if name not in OF_CAGE:
            return self.parts.mean_loss_rate(node.rates)
        nothing = self.parts.clearances(self.parts.nothing)
        # clearances are linear in what has worn, but for which ball is the most worn
        return self.parts.clearances(node.rates)[OF_CAGE.index(name)] - nothing[OF_CAGE.index(name)]

    def margins(self, node: Node) -> np.ndarray:
        """How far each criterion is from being met, as `life.margins`."""
        return margins(self.state(node), self.end, self.scene.operation.preload_N)

    def first_crossing(self, a: Node, b: Node) -> tuple[float, int, float] | None:
        """First criterion met between two nodes: time, index, loss of margin per second."""
        before, after = self.margins(a), self.margins(b)
        found = []
        for k in np.flatnonzero((after <= 0.0) & (before > 0.0)):
            slope = (before[k] - after[k]) / (b.time - a.time)
            found.append((a.time + before[k] / slope, int(k), slope))
        return min(found, default=None)

    def locate_end(self, nodes: list[Node], beyond: Node) -> tuple[Node, int, float]:
        """The node where the first criterion is met, which one, and the error of the time [s]."""
        a, b = nodes[-1], beyond
        step = b.time - a.time
        best: tuple[Node, int, float] | None = None
        for _ in range(_MOST_TRIALS):
            crossing = self.first_crossing(a, b)
            assert crossing is not None
            time, k, slope = crossing
            trial = self.step(nodes, time)
            if trial.status != code.OK:
                break
            left = self.margins(trial)
            best = trial, k, abs(float(left[k])) / slope
            if best[2] <= END * step and not (np.delete(left, k) <= 0.0).any():
                return best
            a, b = (a, trial) if (left <= 0.0).any() else (trial, b)
        if best is not None:
            return best
        crossing = self.first_crossing(a, b)
        assert crossing is not None
        return b, crossing[1], b.time - crossing[0]

    def horizon(self, node: Node, steady: float) -> float:
        """Estimated end of life [s]: by the steady life, or by the wear rate so far.

        Infinite where nothing that wears leads to an end.
        """
        um = self.end.ball_diameter_loss_um
        largest = LARGEST_LOSS * self.scene.bearing.ball_diameter_mm * parameters.MM
        limits = [largest if um is None else um * parameters.UM]
        limits += [math.nan if mm is None else mm * parameters.MM for mm in self.limits]
        then, now = (
            np.array([self.parts.loss(worn).mean(), *self.parts.clearances(worn)])
            for worn in (self.parts.nothing, node.worn)
        )
        with np.errstate(divide="ignore", invalid="ignore"):
            times = node.time * (np.array(limits) - then) / (now - then)
        known = [time for time in (steady, *times[now > then]) if time > 0.0]
        return float(min(known, default=math.inf))

    def march(self, steady: float) -> "DynamicCourse":
        """From the present wear to the first criterion, or to where the solver or the range ends.

        Parameters
        ----------
        steady : float
            Life by the steady model [s], NaN if not known: what steps are made for.
        """
        none = len(CRITERIA) - 1
        start = self.evaluate(0.0, self.parts.nothing, None)
        nodes = [start]
        if start.status != code.OK:
            return DynamicCourse(nodes, none, start.status, 0.0)
        met = np.flatnonzero(self.margins(start) <= 0.0)
        if met.size:
            return DynamicCourse(nodes, int(met[0]), code.OK, 0.0)
        if not start.rates.any():
            return DynamicCourse(nodes, none, code.CRITERION_NOT_REACHED, 0.0)
        steps = self.scene.model.life_steps
        # one second at the rates of the start, to guess by
        guess = Node(1.0, start.rates, code.OK)
        for _ in range(_MOST_STEPS * steps):
            horizon = self.horizon(nodes[-1] if len(nodes) > 1 else guess, steady)
            if math.isinf(horizon):
                break
            self.report_progress(nodes[-1], horizon)
            found = self.step(nodes, nodes[-1].time + horizon / steps)
            if found.status != code.OK:
                return DynamicCourse([*nodes, found], none, found.status, 0.0)
            if self.first_crossing(nodes[-1], found) is not None:
                last, criterion, unsure = self.locate_end(nodes, found)
                return DynamicCourse([*nodes, last], criterion, code.OK, unsure)
            nodes.append(found)
        return DynamicCourse(nodes, none, code.CRITERION_NOT_REACHED, 0.0)

    def report_progress(self, node: Node, horizon: float) -> None:
        """Report the progress of the life."""
        if self.progress is not None:
            loss = self.parts.loss(node.worn).mean() / parameters.UM
            hours = node.time / 3600.0, horizon / 3600.0
            self.progress(f"{hours[0]:.3g} h of about {hours[1]:.3g} h, {loss:.3g} um lost")


@dataclass
class DynamicCourse:
    """Nodes up to the end of life; the last is the end, or the one that could not be solved."""

    nodes: list[Node]
    criterion: int  # index into CRITERIA
    status: int
    unsure: float  # of the time at which the criterion is met [s]

    @property
    def solved(self) -> list[Node]:
        """The nodes that were solved."""
        return [node for node in self.nodes if node.status == code.OK]
