"""Wear along a life by short dynamic runs (theory.md section 13).

The parts that wear (each ball, races, pockets, land) are those of `WornParts`. Each run is made at
the wear that those before it left, from the end of the one before.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.ends import largest_loss
from bearingwear.lives.follow import Node, States
from bearingwear.lives.surfaces import Coating, FilmWear, remove_film
from bearingwear.lives.worn_parts import WornParts
from bearingwear.scene.blocks import CRITERIA, OF_CAGE
from bearingwear.scene.scene import EndOfLife, Scene, SceneError
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.condition import Condition, SolvedBearing, Solver
from bearingwear.solvers.dynamic.run import solve_dynamic
from bearingwear.solvers.effects.choice import asymmetries
from bearingwear.solvers.race_control import RaceControl
from bearingwear.solvers.rotor import half_of_pair
from bearingwear.solvers.state import State, case_state
from bearingwear.solvers.steady import Steady
from bearingwear.solvers.warm import warmed_for_motion, warmth_values


@dataclass(frozen=True)
class Run:
    """A dynamic run at some wear."""

    status: int
    carried_on: bool = False  # whether it starts from the end of the run before
    values: dict[str, Any] = field(default_factory=dict)  # result variables; empty without a run
    warmth: dict[str, Any] = field(default_factory=dict)  # those of a thermal network, if any
    residual: str = "not solved"  # text on how well the run is balanced
    # wear per second as in `WornLayout`; empty until `Motion.with_worn` sets it
    rates: np.ndarray = field(default_factory=lambda: np.empty(0))


def run_at(node: Node) -> Run:
    """Returns the dynamic run behind a node."""
    return node.states[0].answer


class Motion:
    """A way to wear: dynamic runs of a scene, without its cage where that is not solved.

    steady: life by the steady model [s], which estimates the end of the first steps with the
        present rates; NaN if not known.
    progress: receives a line of text at each step.
    """

    origin = 0.0
    range = math.inf

    def __init__(
        self,
        scene: Scene,
        steady: float = math.nan,
        progress: Callable[[str], None] | None = None,
    ):
        self.scene, self.steady, self.progress = scene, steady, progress
        self.steps = scene.model.life_steps
        self.parts = WornParts(scene)
        self.end = scene.wear.end_of_life or EndOfLife()
        self.start = np.zeros(self.parts.layout.size)
        self.surfaces = FilmWear(scene)
        self._mounted = parameters.static_place(scene)  # axial displacement as mounted [m]
        self.films_gone: list[int] = []  # indices of `events`, as films wore through
        self._event_time = 0.0  # when a film was last gone [s]
        self._event_worn = self.start  # wear at that time

    def state(self, worn: np.ndarray, near: States = ()) -> States:
        """Returns the state (1,) of a run at some wear.

        worn: of all parts, as in `WornLayout`.
        near: state of a run at a similar wear, from whose end this one starts; if empty, it is a
            first run.
        """
        run = self._run(worn, near[0].answer if near else None)
        return self.with_worn((State(run.status, {}, run),), worn)

    def _run(self, worn: np.ndarray, before: Run | None) -> Run:
        """Returns a run at some wear, from the end of another if there is one.

        If that fails, it is a first run, which continues no other. There is no run, but the status
        alone, where more has worn than a scene may have, or where no temperatures are found.

        before: a run that was solved.
        """
        try:
            scene = self.parts.worn_scene(worn)
        except SceneError:  # the end of what can be followed
            return Run(code.CRITERION_NOT_REACHED)
        warm = warmed_for_motion(scene, self.surfaces.bare)
        if warm.status != code.OK:
            return Run(warm.status, residual=warm.sentence)
        warmth = warmth_values(scene, warm)
        scene = warm.scene
        if before is not None:
            end = {"state": before.values["final_state"], "time": before.values["final_time"]}
            values, attrs = solve_dynamic(scene, end, bare=self.surfaces.bare)
        if before is None or values["status"] != code.OK:
            values, attrs = self.first_run(scene)
            before = None
        if values["status"] == code.OK:
            values["quasistatic_axial_stiffness"] = self._quasistatic_stiffness(scene)
        return Run(
            status=int(values["status"]),
            carried_on=before is not None,
            values=values,
            warmth=warmth,
            residual=attrs["residual"],
        )

    def surface_wear(self, worn: np.ndarray) -> np.ndarray:
        """Returns the wear in the form of `FilmWear`, with that of the mean ball (3,) [m].

        worn: of all parts, as in `WornLayout`.
        """
        return np.array([worn[self.parts.layout.diameter].mean(), *worn[self.parts.layout.groove]])

    def _quasistatic_stiffness(self, scene: Scene) -> float:
        """Returns the quasi-static axial stiffness of a worn scene, which no run has [N/m].

        It is that of the steady state at the mean loss. A scene that has no steady state before any
        wear has the stiffness by race control. NaN where the steady state is not solved.
        """
        if asymmetries(self.scene):
            solver: Solver = RaceControl(scene)
            return solver(solver.start._replace(bare=self.surfaces.bare)).quasistatic
        loss = float(np.mean(scene.wear.ball_diameter_loss_um)) * parameters.UM
        solution = Steady(scene)(Condition(loss, self.surfaces.bare))
        return solution.quasistatic if solution.status == code.OK else math.nan

    def first_run(self, scene: Scene) -> tuple[dict, dict]:
        """Returns values and attributes of a run that continues no other.

        With a cage, a run of `life_run_in_turns` comes before it; if that fails, its values and
        attributes are returned. A cage takes hundreds of turns to forget how it started, and seems
        settled long before.
        """
        restart = None
        if scene.cage is not None and self.parts.model.life_run_in_turns > 0.0:
            turns = self.parts.model.life_run_in_turns
            run_in = replace(
                self.parts.model, simulated_turns=turns, evaluated_turns=turns, settled_drift=0.0
            )
            values, attrs = solve_dynamic(replace(scene, model=run_in), bare=self.surfaces.bare)
            if values["status"] != code.OK:
                return values, attrs
            restart = {"state": values["final_state"], "time": values["final_time"]}
        return solve_dynamic(scene, restart, bare=self.surfaces.bare)

    def with_worn(self, states: States, worn: np.ndarray) -> States:
        """Returns the state (1,) of a run, with the values that it has at a wear close by.

        Its answer is the run with the wear rates there. A run that failed keeps its status and has
        only the values of the cage.

        states: (1,), whose answer is the run.
        worn: of all parts, as in `WornLayout`.
        """
        run: Run = states[0].answer
        loss = float(self.parts.loss(worn).mean())
        state = case_state(loss, {**run.values, "status": run.status})
        values: dict[str, Any] = self.parts.cage_values(worn)
        if state.is_solved:
            power = float(run.values["friction_heat"].sum()) + float(run.values["drag_power"])
            solved = SolvedBearing(
                status=state.status,
                condition=Condition(loss),
                scene=self.scene,
                stiffness=state["axial_stiffness"],
                quasistatic=state["quasistatic_axial_stiffness"],
                place=state["axial_displacement"],
            )
            values |= half_of_pair(self.scene, self._mounted, solved).values
            values |= {"friction_power": power} | run.warmth
            factors = None
            if self.surfaces.changes:
                state_values = run.values | run.warmth
                factors = self.surfaces.wear_factors(state_values, self.surface_wear(worn))
            run = replace(run, rates=self.parts.rates(run.values, factors))
            values |= self._wear_values(run, worn)
        return (replace(state.with_values(values), answer=run),)

    def _wear_values(self, run: Run, worn: np.ndarray) -> dict[str, Any]:
        """Returns result variables of the wear: the greatest groove depth [m].

        Where surfaces have films or run in, the films and the wear rates are there as well.
        """
        layout, rates = self.parts.layout, run.rates
        values = {"greatest_depth": worn[layout.deepest].max()}
        if not self.surfaces.changes:
            return values
        values |= self.surfaces.film_values(self.surface_wear(worn))
        ball_rate = rates[layout.diameter].mean()
        return values | {
            "ball_diameter_loss_rate": self.surfaces.loss_rate(ball_rate, rates[layout.groove]),
            "ball_wear_rate": rates[layout.ball].mean(),
            "race_wear_rate": rates[layout.race],
        }

    def rates(self, node: Node) -> np.ndarray:
        """Returns the wear per second of all parts, as in `WornLayout`."""
        return run_at(node).rates

    def wears(self, node: Node) -> bool:
        """Returns whether any part wears, even one that no criterion limits."""
        return bool(run_at(node).rates.any())

    def films_at(self, worn: np.ndarray) -> list[tuple[Coating, np.ndarray]]:
        """Returns the films of races and balls, then those of the cage, with worn depths [m].

        The depths are those of inner race, outer race and balls (3,), and of pockets and land (2,).
        """
        return [
            (self.surfaces.coating, self.surfaces.depths(self.surface_wear(worn))),
            (self.parts.coating, self.parts.cage_depths(worn)),
        ]

    def events(self, node: Node) -> np.ndarray:
        """Returns the share that is left of each film (5,) [1]; infinite without a film.

        The order is that of `films_at`.
        """
        return np.concatenate(
            [coating.share_left(depths) for coating, depths in self.films_at(node.worn)]
        )

    def pass_event(self, event: int, node: Node) -> bool:
        """Removes a film that is gone, and returns True: the life goes on.

        Appends it to `films_gone`; estimates of the end start anew from this node.

        event: index of the film among the `events`.
        """
        remove_film(self.films_at(node.worn), event)
        self.films_gone.append(event)
        self._event_time, self._event_worn = node.x, node.worn
        return True

    @staticmethod
    def is_of_cage(criterion: int) -> bool:
        """Returns whether a criterion, by its index in `CRITERIA`, limits a measure of the cage."""
        return CRITERIA[criterion] in OF_CAGE

    def end_rate(self, node: Node, criterion: int, film: int | None = None) -> float:
        """Returns the rate at which a film wears, or the measure of a criterion grows [m/s].

        The measure is one of the cage or the depth of a groove. For any other criterion, such as a
        preload fraction, the rate is that of the mean loss. The worn share of the cage's film has a
        rate in 1/s.

        criterion: index in `CRITERIA`, not used for a film.
        film: its index among the `events`; None for the criterion.
        """
        name = CRITERIA[criterion]
        rates = run_at(node).rates
        if film is not None:
            return float(self._film_depths(rates)[film])
        if name == "groove_depth_um":
            return float(rates[self.parts.layout.deepest].max())
        if not self.is_of_cage(criterion):
            return self.parts.mean_loss_rate(rates)
        return self.parts.cage_rate(name, rates)

    def horizon(self, node: Node) -> float:
        """Returns the time of the first estimated end, of life or of a film [s].

        Estimates are the steady life, and the times at which loss, clearances and films reach their
        limits. Wear rates are means since the last film was gone; just after that, they are the
        present ones. Infinite where no wear leads to an end.
        """
        elapsed = node.x - self._event_time
        wear = node.worn - self._event_worn
        if elapsed == 0.0:
            elapsed, wear = 1.0, self.rates(node)  # one second at the present rates
        before = self._limited_values(self._event_worn)
        after = self._limited_values(self._event_worn + wear)
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = self._event_time + elapsed * (self._limits() - before) / (after - before)
        later_ends = [end for end in (self.steady, *ends[after > before]) if end > self._event_time]
        return float(min(later_ends, default=math.inf))

    def _limits(self) -> np.ndarray:
        """Returns the limits of the `_limited_values` (8,) [m]; NaN without one."""
        um = self.end.ball_diameter_loss_um
        loss = largest_loss(self.scene) if um is None else um * parameters.UM
        clearances = [
            math.nan if mm is None else mm * parameters.MM
            for mm in (self.end.pocket_clearance_mm, self.end.guide_clearance_mm)
        ]
        films, cage = self.surfaces.coating, self.parts.coating
        film_depths = np.where(films.is_left, films.new_thickness, math.nan)
        share = self.end.cage_film_worn_share or 1.0
        cage_depths = np.where(cage.is_left, share * cage.new_thickness, math.nan)
        return np.array([loss, *clearances, *film_depths, *cage_depths])

    def _limited_values(self, worn: np.ndarray) -> np.ndarray:
        """Returns mean loss, clearances of pocket and land, and `_film_depths` (8,) [m]."""
        loss = self.parts.loss(worn).mean()
        return np.array([loss, *self.parts.clearances(worn), *self._film_depths(worn)])

    def _film_depths(self, worn: np.ndarray) -> np.ndarray:
        """Returns the depths of both races, balls, pockets and land, in this order (5,) [m].

        worn: of all parts, or their rates; the depths are rates then [m/s].
        """
        return np.concatenate([depths for _, depths in self.films_at(worn)])

    def longest_step(self, node: Node, rates: np.ndarray) -> float:
        """Returns the longest step [s], and reports progress.

        It is a part of the way from the last film that was gone to the estimated end, or a
        running-in time if shorter. It is infinite, with no report, where no wear leads to an end.

        rates: wear per second at the node.
        """
        horizon = self.horizon(node)
        if math.isinf(horizon):
            return horizon
        self.report_progress(node, horizon)
        part = (horizon - self._event_time) / self.steps
        worn, worn_rates = self.surface_wear(node.worn), self.surface_wear(rates)
        return min(part, self.surfaces.running_in_time(worn, worn_rates))

    def report_progress(self, node: Node, horizon: float) -> None:
        """Passes a line with time, estimated end and mean loss to `progress`, if there is one.

        horizon: the estimated end [s].
        """
        if self.progress is not None:
            loss = self.parts.loss(node.worn).mean() / parameters.UM
            hours, end = node.x / 3600.0, horizon / 3600.0
            self.progress(f"{hours:.3g} h of about {end:.3g} h, {loss:.3g} um of wear")
