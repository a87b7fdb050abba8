"""The wear that short dynamic runs find along a life (theory.md section 13).

What wears (each ball, races, pockets, land) is that of `WornParts`. Each run is made at the wear
that those before it left, from the end of the one before.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.ends import largest_loss
from bearingwear.lives.follow import Node, States
from bearingwear.lives.surfaces import Coating, FilmWear, wear_through
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
from bearingwear.solvers.warm import warm_scene, warmth_values


@dataclass(frozen=True)
class Run:
    status: int
    carried_on: bool = False
    values: dict[str, Any] = field(default_factory=dict)
    warmth: dict[str, Any] = field(default_factory=dict)  # where a network finds temperatures
    residual: str = "not solved"
    rates: np.ndarray = field(default_factory=lambda: np.empty(0))


def run_at(node: Node) -> Run:
    return node.states[0].answer


class Motion:
    """The wear of a scene that moves: without its cage where that is not solved.

    Steps are made for its life by the steady model [s], NaN if not known.
    """

    origin, range = 0.0, math.inf

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
        self.films = FilmWear(scene)
        self._mounted = parameters.static_place(scene)
        self.gone: list[int] = []  # films, in the order in which they wore through
        self._since = 0.0, self.start  # time [s] and wear when the way last changed

    def state(self, worn: np.ndarray, near: States = ()) -> States:
        """A run at that wear, from the end of one before or a start of its own."""
        run = self._run(worn, near[0].answer if near else None)
        return self.with_worn((State(run.status, {}, run),), worn)

    def _run(self, worn: np.ndarray, before: Run | None) -> Run:
        try:
            scene = self.parts.worn_scene(worn)
        except SceneError:
            return Run(code.CRITERION_NOT_REACHED)
        warm = warm_scene(scene, self.films.bare)
        if warm.status != code.OK:
            return Run(warm.status, residual=warm.sentence)
        scene, warmth = warm.scene, warmth_values(scene, warm)
        if before is not None:
            end = {"state": before.values["final_state"], "time": before.values["final_time"]}
            values, attrs = solve_dynamic(scene, end, bare=self.films.bare)
        if before is None or values["status"] != code.OK:
            values, attrs = self.first_run(scene)
            before = None
        solved = values["status"] == code.OK
        if solved:
            values["quasistatic_axial_stiffness"] = self._quasistatic(scene)
        return Run(
            status=int(values["status"]),
            carried_on=before is not None,
            values=values,
            warmth=warmth,
            residual=attrs["residual"],
        )

    def depths(self, worn: np.ndarray) -> np.ndarray:
        """Wear as `FilmWear` has it: the balls have one film, worn as they are on the mean."""
        return np.array([worn[self.parts.layout.diameter].mean(), *worn[self.parts.layout.groove]])

    def _quasistatic(self, scene: Scene) -> float:
        """Axial stiffness at some wear, which no run has: steady, or by race control [N/m].

        The steady one where the scene has a steady state but for how the balls have worn.
        """
        if asymmetries(self.scene):
            solver: Solver = RaceControl(scene)
            return solver(solver.start._replace(bare=self.films.bare)).quasistatic
        solver, loss = Steady(scene), float(np.mean(scene.wear.ball_diameter_loss_um))
        found = solver(Condition(loss * parameters.UM, self.films.bare))
        return found.quasistatic if found.status == code.OK else math.nan

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
            values, attrs = solve_dynamic(replace(scene, model=run_in), bare=self.films.bare)
            if values["status"] != code.OK:
                return values, attrs
            restart = {"state": values["final_state"], "time": values["final_time"]}
        return solve_dynamic(scene, restart, bare=self.films.bare)

    def with_worn(self, states: States, worn: np.ndarray) -> States:
        """The state of a run at a wear close by, with the clearances of the cage."""
        run: Run = states[0].answer
        loss = float(self.parts.loss(worn).mean())
        state = case_state(loss, {**run.values, "status": run.status})
        more: dict[str, Any] = self.parts.of_cage(worn)
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
            more |= half_of_pair(self.scene, self._mounted, solved).values
            more |= {"friction_power": power} | run.warmth
            wearing = None
            if self.films.changes:
                wearing = self.films.wearing(run.values | run.warmth, self.depths(worn))
            run = replace(run, rates=self.parts.rates(run.values, wearing))
            more |= self._of_wear(run, worn)
        return (replace(state.with_values(more), answer=run),)

    def _of_wear(self, run: Run, worn: np.ndarray) -> dict[str, Any]:
        """The deepest groove, and what films decide where there are any."""
        p, rates = self.parts.layout, run.rates
        deepest, ball = {"greatest_depth": worn[p.deepest].max()}, rates[p.diameter].mean()
        if not self.films.changes:
            return deepest
        return (
            deepest
            | self.films.film_values(self.depths(worn))
            | {
                "ball_diameter_loss_rate": self.films.loss_rate(ball, rates[p.groove]),
                "ball_wear_rate": rates[p.ball].mean(),
                "race_wear_rate": rates[p.race],
            }
        )

    def rates(self, node: Node) -> np.ndarray:
        return run_at(node).rates

    def wears(self, node: Node) -> bool:
        return bool(run_at(node).rates.any())

    def films_at(self, worn: np.ndarray) -> list[tuple[Coating, np.ndarray]]:
        """Films of races and balls, and those of the cage, with the depths there [m]."""
        of_bearing = self.films.coating, self.films.depths(self.depths(worn))
        return [of_bearing, (self.parts.coating, self.parts.cage_depths(worn))]

    def events(self, node: Node) -> np.ndarray:
        return np.concatenate([films.left(deep) for films, deep in self.films_at(node.worn)])

    def passes(self, event: int, node: Node) -> bool:
        """A film is gone."""
        wear_through(self.films_at(node.worn), event)
        self.gone.append(event)
        self._since = node.x, node.worn
        return True

    @staticmethod
    def is_of_cage(criterion: int) -> bool:
        return CRITERIA[criterion] in OF_CAGE

    def end_rate(self, node: Node, criterion: int, film: int | None = None) -> float:
        """Rate of the wear of a film, else of what a criterion limits [m/s].

        That is of the cage, the depth of a groove, or the mean loss.
        """
        name, rates = CRITERIA[criterion], run_at(node).rates
        if film is not None:
            return float(self._film_depths(rates)[film])
        if name == "groove_depth_um":
            return float(rates[self.parts.layout.deepest].max())
        if not self.is_of_cage(criterion):
            return self.parts.mean_loss_rate(rates)
        return self.parts.cage_rate(name, rates)

    def horizon(self, node: Node) -> float:
        """Estimated end of life or of a film [s]: by the steady life, or the wear rate so far.

        Infinite where nothing that wears leads to an end.
        """
        begun, worn = self._since
        # at the start, one second at its rates
        time, more = node.x - begun, node.worn - worn
        if time == 0.0:
            time, more = 1.0, self.rates(node)
        um = self.end.ball_diameter_loss_um
        limits = [largest_loss(self.scene) if um is None else um * parameters.UM]
        given = (self.end.pocket_clearance_mm, self.end.guide_clearance_mm)
        limits += [math.nan if mm is None else mm * parameters.MM for mm in given]
        films, cage = self.films.coating, self.parts.coating
        limits += [*np.where(films.cover, films.whole, math.nan)]
        share = self.end.cage_film_worn_share or 1.0
        limits += [*np.where(cage.cover, share * cage.whole, math.nan)]
        then, now = self._limited(worn), self._limited(worn + more)
        with np.errstate(divide="ignore", invalid="ignore"):
            times = begun + time * (np.array(limits) - then) / (now - then)
        known = [time for time in (self.steady, *times[now > then]) if time > begun]
        return float(min(known, default=math.inf))

    def _limited(self, worn: np.ndarray) -> np.ndarray:
        """Mean loss, clearances, and depths of films [m]."""
        loss, clearances = self.parts.loss(worn).mean(), self.parts.clearances(worn)
        return np.array([loss, *clearances, *self._film_depths(worn)])

    def _film_depths(self, worn: np.ndarray) -> np.ndarray:
        """Depths of whatever may have a film: races, balls, pockets, land (5,) [m]."""
        return np.concatenate([depths for _, depths in self.films_at(worn)])

    def longest_step(self, node: Node, rates: np.ndarray) -> float:
        """A part of the way to the end, or `FilmWear.running_in_time` [s]; reports progress.

        Infinite as `horizon`.
        """
        horizon = self.horizon(node)
        if math.isinf(horizon):
            return horizon
        self.report_progress(node, horizon)
        part = (horizon - self._since[0]) / self.steps
        return min(part, self.films.running_in_time(*map(self.depths, (node.worn, rates))))

    def report_progress(self, node: Node, horizon: float) -> None:
        if self.progress is not None:
            loss = self.parts.loss(node.worn).mean() / parameters.UM
            hours = node.x / 3600.0, horizon / 3600.0
            self.progress(f"{hours[0]:.3g} h of about {hours[1]:.3g} h, {loss:.3g} um of wear")
