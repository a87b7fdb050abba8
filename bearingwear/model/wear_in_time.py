"""Wear life in time: short runs along the life, each at the wear that those before it left.

What wears (each ball, races, pockets, land) is integrated over the running time by a predictor and
the trapezoidal rule (theory.md section 13). The rates at each node are those of a run in time at
the wear predicted for it, which goes on from where the run of the node before ended.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.model import parameters
from bearingwear.model.estimate import ROUNDING
from bearingwear.model.fidelity import asymmetries
from bearingwear.model.life import (
    CRITERIA,
    Course,
    WearState,
    course_of,
    history_values,
    margins,
    steady_states,
)
from bearingwear.model.scene import COUNTS, LARGEST_LOSS, EndOfLife, Scene, SceneError
from bearingwear.model.transient import solve_dynamic, thrust_alone

OF_CAGE = ("pocket_clearance_mm", "guide_clearance_mm")
MOST_STEPS = 20  # times those asked for: rates may fall on the way
END = 1e-3  # of a step: how well the end is found
MOST_TRIALS = 8  # runs to find the end
SCATTER = 2.0  # standard errors


class Places:
    """Where the parts stand in a vector of what has worn, or of its rates; n balls."""

    def __init__(self, n: int):
        self.diameter = slice(0, n)  # worn off each ball's diameter [m]
        self.ball = slice(n, 2 * n)  # volume worn off each ball [m3]
        self.pocket = slice(2 * n, 3 * n)  # and off the cage in its pocket
        self.race = slice(3 * n, 3 * n + 2)
        self.land = 3 * n + 2  # off the cage at its guiding land
        self.groove = 3 * n + 3  # depth worn into both grooves [m]
        self.size = 3 * n + 4


@dataclass
class Node:
    """A point of the life: what has worn, and what a run in time found there."""

    time: float  # [s]
    worn: np.ndarray
    status: int
    carried_on: bool = False
    values: dict[str, Any] = field(default_factory=dict)
    residual: str = "not solved"
    rates: np.ndarray = field(default_factory=lambda: np.empty(0))

    @property
    def end(self) -> dict[str, Any]:
        """What the next run goes on from."""
        return {"state": self.values["final_state"], "time": self.values["final_time"]}


class WearInTime:
    """A scene on its way through its life.

    Parameters
    ----------
    scene : Scene
        As it is solved: without its cage where that is not asked for.
    progress : callable, optional
        Told in one line how far the life has come.
    """

    def __init__(self, scene: Scene, progress: Callable[[str], None] | None = None):
        self.scene, self.progress = scene, progress
        self.end = scene.wear.end_of_life or EndOfLife()
        self.count = COUNTS.index(scene.wear.counts)
        n = scene.bearing.ball_count
        self.places = Places(n)
        loss = np.array(scene.wear.ball_diameter_loss_um) * parameters.UM
        self.fresh = np.broadcast_to(loss, (n,))
        self.limits = (self.end.pocket_clearance_mm, self.end.guide_clearance_mm)
        # Histories of each run would be kept for nobody.
        self.model = replace(scene.model, history_points_per_turn=0)

    # what has worn, in other words

    def loss(self, worn: np.ndarray) -> np.ndarray:
        """Loss of diameter of each ball that the fit sees (n,) [m]: grooves as counted."""
        p = self.places
        return self.fresh + worn[p.diameter] + (worn[p.groove] if self.count else 0.0)

    def clearances(self, worn: np.ndarray) -> tuple[float, float]:
        """Diametral clearances of pocket and most worn ball, and at the land [m]; or NaN.

        The wear of all pockets and of the land is spread evenly over `worn_share` of the surface.
        """
        cage, p = self.scene.cage, self.places
        if cage is None:
            return math.nan, math.nan
        D0, MM = self.scene.bearing.ball_diameter_mm * parameters.MM, parameters.MM
        r_i, r_o = 0.5 * cage.inner_diameter_mm * MM, 0.5 * cage.outer_diameter_mm * MM
        wall = math.pi * (D0 + cage.pocket_clearance_mm * MM) * (r_o - r_i)
        guiding = r_i if cage.guiding_race == "inner" else r_o
        surface = 2.0 * math.pi * guiding * cage.width_mm * MM
        pocket = 2.0 * worn[p.pocket].mean() / (cage.worn_share * wall)
        land = 2.0 * worn[p.land] / (cage.worn_share * surface)
        ball = (self.fresh + worn[p.diameter]).max()
        return cage.pocket_clearance_mm * MM + pocket + ball, cage.guide_clearance_mm * MM + land

    def worn_scene(self, worn: np.ndarray) -> Scene:
        """The scene at that wear.

        Raises
        ------
        SceneError
            Where so much has worn that it makes no sense any more.
        """
        wear = replace(
            self.scene.wear, ball_diameter_loss_um=tuple((self.loss(worn) / parameters.UM).tolist())
        )
        cage = self.scene.cage
        if cage is not None:
            pocket, guide = self.clearances(worn)
            # The motion adds each ball's loss to its pocket, the depth of the grooves with it.
            pocket -= (self.fresh + worn[self.places.diameter]).max()
            pocket -= worn[self.places.groove] if self.count else 0.0
            cage = replace(
                cage,
                pocket_clearance_mm=max(float(pocket), 0.0) / parameters.MM,
                guide_clearance_mm=float(guide) / parameters.MM,
            )
        return replace(self.scene, wear=wear, cage=cage, model=self.model)

    # nodes

    def node(self, time: float, worn: np.ndarray, before: Node | None) -> Node:
        """A run in time at that wear: from the end of the one before, else from a start anew."""
        try:
            scene = self.worn_scene(worn)
        except SceneError:
            return Node(time, worn, code.CRITERION_NOT_REACHED)
        if before is not None:
            values, attrs = solve_dynamic(scene, restart=before.end)
        if before is None or values["status"] != code.OK:
            values, attrs = self.begun(scene)
            before = None
        found = Node(
            time, worn, int(values["status"]), before is not None, values, attrs["residual"]
        )
        if found.status == code.OK:
            found.rates = self.rates(values)
        return found

    def begun(self, scene: Scene) -> tuple[dict, dict]:
        """A run from a start of its own; with a cage after `life_run_in_turns`.

        A cage takes hundreds of turns to forget how it started, and seems settled long before.
        """
        restart = None
        if scene.cage is not None and self.model.life_run_in_turns > 0.0:
            turns = self.model.life_run_in_turns
            run_in = replace(
                self.model, simulated_turns=turns, evaluated_turns=turns, settled_drift=0.0
            )
            values, attrs = solve_dynamic(replace(scene, model=run_in))
            if values["status"] != code.OK:
                return values, attrs
            restart = {"state": values["final_state"], "time": values["final_time"]}
        return solve_dynamic(scene, restart=restart)

    def rates(self, values: dict[str, Any]) -> np.ndarray:
        """Rates of what wears, from the averages of a run."""
        p, rates = self.places, np.zeros(self.places.size)
        D = self.scene.bearing.ball_diameter_mm * parameters.MM - values["ball_diameter_loss"]
        rates[p.ball] = values["ball_wear_rate"]
        rates[p.diameter] = 2.0 * values["ball_wear_rate"] / (math.pi * D**2)
        rates[p.race] = values["race_wear_rate"]
        alone, both = values["ball_diameter_loss_rate"]
        rates[p.groove] = both - alone
        rates[p.pocket] = values.get("pocket_wear_rate", 0.0)
        rates[p.land] = values.get("cage_land_wear_rate", 0.0)
        return rates

    def mean_loss_rate(self, node: Node) -> float:
        """Rate of the mean loss of ball diameter as counted [m/s]."""
        p = self.places
        return float(node.rates[p.diameter].mean() + (node.rates[p.groove] if self.count else 0.0))

    def step(self, nodes: list[Node], time: float) -> Node:
        """The node at that time, from all before."""
        last, h = nodes[-1], time - nodes[-1].time
        ahead = last.rates
        if len(nodes) > 1:
            before = nodes[-2]
            ahead = last.rates + 0.5 * h / (last.time - before.time) * (last.rates - before.rates)
            ahead = np.maximum(ahead, 0.0)  # nothing grows back
        found = self.node(time, last.worn + h * ahead, last)
        if found.status == code.OK:
            found.worn = last.worn + 0.5 * h * (last.rates + found.rates)
        return found

    def state(self, node: Node) -> WearState:
        """A node as a state of the steady life: means over the balls, the largest slip share."""
        v, loss = node.values, float(self.loss(node.worn).mean())
        if node.status != code.OK:
            nan = np.full(2, math.nan)
            return WearState(
                loss, node.status, nan, load=nan, angle=nan, qv=nan, share=nan, race_rate=nan
            )
        power = float(v["friction_heat"].sum()) + float(v["drag_power"])
        return WearState(
            loss,
            node.status,
            v["ball_diameter_loss_rate"],
            preload=float(v["residual_preload"]),
            load=v["contact_load"].mean(axis=0),
            angle=v["contact_angle"].mean(axis=0),
            qv=v["qv"].mean(axis=0),
            total_qv=float(v["total_qv"]),
            share=v["gyroscopic_slip_share"].max(axis=0),
            skid=float(v["skid_ratio"]),
            pressure=float(v["maximum_pressure"].max()),
            stiffness=float(v["axial_stiffness"]),
            friction_power=power,
            ball_rate=float(v["ball_wear_rate"].mean()),
            race_rate=v["race_wear_rate"],
        )

    # the end

    def end_rate(self, node: Node, criterion: int) -> float:
        """Rate of what the criterion looks at: a clearance, else the mean loss [m/s]."""
        name = CRITERIA[criterion]
        if name not in OF_CAGE:
            return self.mean_loss_rate(node)
        nothing = self.clearances(np.zeros(self.places.size))
        # clearances are linear in what has worn, but for which ball is the most worn
        return self.clearances(node.rates)[OF_CAGE.index(name)] - nothing[OF_CAGE.index(name)]

    def margins(self, node: Node) -> np.ndarray:
        """How far each criterion is from being met, in the order of `CRITERIA`, as `life.margins`.

        Those of the cage as shares of the clearance allowed.
        """
        operation = self.scene.operation
        of_cage = [
            math.inf if limit is None else 1.0 - clearance / (limit * parameters.MM)
            for limit, clearance in zip(self.limits, self.clearances(node.worn), strict=True)
        ]
        return np.append(margins(self.state(node), self.end, operation.preload_N), of_cage)

    def first_crossing(self, a: Node, b: Node) -> tuple[float, int, float] | None:
        """Time, criterion and margin lost per second where the first is met between two nodes."""
        before, after = self.margins(a), self.margins(b)
        found = []
        for k in np.flatnonzero((after <= 0.0) & (before > 0.0)):
            slope = (before[k] - after[k]) / (b.time - a.time)
            found.append((a.time + before[k] / slope, int(k), slope))
        return min(found, default=None)

    def found_end(self, nodes: list[Node], beyond: Node) -> tuple[Node, int, float]:
        """The node where the first criterion is met, which, and how well that is known [s]."""
        a, b = nodes[-1], beyond
        step = b.time - a.time
        best: tuple[Node, int, float] | None = None
        for _ in range(MOST_TRIALS):
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
        """About when the life ends [s]: the steady life, or what wears as fast as so far.

        Infinite where nothing that wears leads to an end.
        """
        um = self.end.ball_diameter_loss_um
        largest = LARGEST_LOSS * self.scene.bearing.ball_diameter_mm * parameters.MM
        limits = [largest if um is None else um * parameters.UM]
        limits += [math.nan if mm is None else mm * parameters.MM for mm in self.limits]
        then, now = (
            np.array([self.loss(worn).mean(), *self.clearances(worn)])
            for worn in (np.zeros(self.places.size), node.worn)
        )
        with np.errstate(divide="ignore", invalid="ignore"):
            times = node.time * (np.array(limits) - then) / (now - then)
        known = [time for time in (steady, *times[now > then]) if time > 0.0]
        return float(min(known, default=math.inf))

    def march(self, steady: float) -> "CourseInTime":
        """From the present wear to the first criterion, or to where the solver or the range ends.

        Parameters
        ----------
        steady : float
            Life by the steady model [s], NaN if not known: what steps are made for.
        """
        none = len(CRITERIA) - 1
        start = self.node(0.0, np.zeros(self.places.size), None)
        nodes = [start]
        if start.status != code.OK:
            return CourseInTime(nodes, none, start.status, 0.0)
        met = np.flatnonzero(self.margins(start) <= 0.0)
        if met.size:
            return CourseInTime(nodes, int(met[0]), code.OK, 0.0)
        if not start.rates.any():
            return CourseInTime(nodes, none, code.CRITERION_NOT_REACHED, 0.0)
        steps = self.scene.model.life_steps
        # one second at the rates of the start, to guess by
        guess = Node(1.0, start.rates, code.OK)
        for _ in range(MOST_STEPS * steps):
            horizon = self.horizon(nodes[-1] if len(nodes) > 1 else guess, steady)
            if math.isinf(horizon):
                break
            self.tell(nodes[-1], horizon)
            found = self.step(nodes, nodes[-1].time + horizon / steps)
            if found.status != code.OK:
                return CourseInTime([*nodes, found], none, found.status, 0.0)
            if self.first_crossing(nodes[-1], found) is not None:
                last, criterion, unsure = self.found_end(nodes, found)
                return CourseInTime([*nodes, last], criterion, code.OK, unsure)
            nodes.append(found)
        return CourseInTime(nodes, none, code.CRITERION_NOT_REACHED, 0.0)

    def tell(self, node: Node, horizon: float) -> None:
        """Say how far the life has come."""
        if self.progress is not None:
            loss = self.loss(node.worn).mean() / parameters.UM
            hours = node.time / 3600.0, horizon / 3600.0
            self.progress(f"{hours[0]:.3g} h of about {hours[1]:.3g} h, {loss:.3g} um lost")


@dataclass
class CourseInTime:
    """The way to the end of life; the last node is the end, or the one that could not be solved."""

    nodes: list[Node]
    criterion: int  # index into CRITERIA
    status: int
    unsure: float  # of the time at which the criterion is met [s]

    @property
    def solved(self) -> list[Node]:
        """Those that were solved."""
        return [node for node in self.nodes if node.status == code.OK]


def integration_error(time: np.ndarray, rate: np.ndarray) -> float:
    """What steps and scatter of the runs may do to the integral of a rate by trapezoids.

    A third of what twice the step would change, and twice the standard error that the nodes'
    scatter about smooth curves (parabolas through neighbours) makes of the sum.
    """
    last = len(time) - 1
    if last < 2:
        return math.nan
    kept = np.r_[0:last:2, last] if last % 2 == 0 else np.r_[0 : last - 2 : 2, last]
    coarse = np.trapezoid(rate[kept], time[kept])
    steps = abs(float(np.trapezoid(rate, time) - coarse)) / 3.0
    left = []
    for k in range(last - 2):
        t = (time[k : k + 4] - time[k]) / (time[k + 3] - time[k])
        apart = t[:, None] - t + np.eye(4)
        weights = 1.0 / apart.prod(axis=1)  # blind to parabolas
        left.append(weights @ rate[k : k + 4] / np.linalg.norm(weights))
    h = np.diff(time)
    shares = 0.5 * (np.append(h, 0.0) + np.append(0.0, h))
    deviation = math.sqrt(np.mean(np.square(left))) if left else 0.0
    return steps + SCATTER * deviation * float(np.linalg.norm(shares))


def solve_life_in_time(
    scene: Scene, progress: Callable[[str], None] | None = None
) -> tuple[dict, dict]:
    """Wear life of a scene with a run in time at every step, and the steady life beside it.

    Parameters
    ----------
    scene : Scene
        With `wear.end_of_life`, and with its cage where that is to be solved.
    progress : callable, optional
        Given one line of text at each step.

    Returns
    -------
    values, attrs : dict
        Of a life file. Only one way of counting wear is followed, that of `wear.counts`, since it
        decides which wear the runs see; what belongs to the other is NaN.
    """
    way = WearInTime(scene, progress)
    values = steady_life(scene)
    course = way.march(float(values.get("steady_life", math.nan)))
    values |= {"status": course.status, "end_criterion": course.criterion}
    attrs = {
        "solves": len(course.nodes),
        "steady_life_of": steady_told(scene),
        "residual": f"of the last run: {course.nodes[-1].residual}",
    }
    if course.solved:
        values |= ends(way, course) | histories(way, course)
        values |= steady_time_to_loss(scene, values["loss_at_end"])
    return values, attrs


def ends(way: WearInTime, course: CourseInTime) -> dict:
    """Life and its errors; the life is a lower bound where no criterion was met."""
    solved = course.solved
    last = solved[-1]
    life, error, estimate = (np.full(2, math.nan) for _ in range(3))
    life[way.count] = last.time
    values: dict[str, Any] = {"loss_at_end": float(way.loss(last.worn).mean())}
    if course.status == code.OK and last.time > 0.0:
        time = np.array([node.time for node in solved])
        rate = np.array([way.end_rate(node, course.criterion) for node in solved])
        at_end = 0.5 * (rate[-2] + rate[-1])
        error[way.count] = integration_error(time, rate) / at_end + course.unsure
        by_runs = [
            node.values.get("wear_rate_error_estimate", [math.nan] * 2)[way.count]
            for node in solved
        ]
        # No run estimates the error of a clearance's growth.
        if CRITERIA[course.criterion] not in OF_CAGE:
            mean = np.trapezoid(by_runs, time) / last.time
            estimate[way.count] = ROUNDING + error[way.count] / last.time + mean
    factor, _ = parameters.wear_factors(way.scene)
    values |= {"life": life, "normalised_life": life * factor, "life_error_bound": error}
    return values | ({"life_error_estimate": estimate} if np.isfinite(estimate).any() else {})


def histories(way: WearInTime, course: CourseInTime) -> dict:
    """What has worn, and what was found, at each node; NaN where a node was not solved."""
    p, nodes = way.places, course.nodes
    worn = np.array([node.worn for node in nodes])
    missing = np.full(p.size, math.nan)
    rates = np.array([node.rates if node.status == code.OK else missing for node in nodes])
    time = np.full((len(nodes), 2), math.nan)
    time[:, way.count] = [node.time for node in nodes]
    values = history_values([way.state(node) for node in nodes]) | {
        "history_time": time,
        "history_status": [node.status for node in nodes],
        "history_start": [int(node.carried_on) for node in nodes],
        "history_simulated_turns": [node.values.get("simulated_turns", math.nan) for node in nodes],
        "history_worn_diameter": worn[:, p.diameter],
        "history_groove_depth": worn[:, p.groove],
        "history_ball_worn_volume": worn[:, p.ball],
        "history_race_worn_volume": worn[:, p.race],
        "history_each_ball_wear_rate": rates[:, p.ball],
    }
    if way.scene.cage is None:
        return values
    pocket, guide = np.array([way.clearances(row) for row in worn]).T
    return values | {
        "history_pocket_worn_volume": worn[:, p.pocket],
        "history_land_worn_volume": worn[:, p.land],
        "history_pocket_wear_rate": rates[:, p.pocket],
        "history_land_wear_rate": rates[:, p.land],
        "history_pocket_clearance": pocket,
        "history_guide_clearance": guide,
    }


def steady_scene(scene: Scene) -> Scene:
    """What of a scene has a steady life: thrust alone, no cage, every ball with the mean loss."""
    mean = float(np.mean(scene.wear.ball_diameter_loss_um))
    reduced = thrust_alone(scene).without_cage
    return replace(reduced, wear=replace(reduced.wear, ball_diameter_loss_um=(mean,)))


def steady_told(scene: Scene) -> str:
    """What the steady life leaves out of a scene, in words."""
    left = asymmetries(scene) + ([] if scene.cage is None else ["cage"])
    return f"the scene without {', '.join(left)}" if left else "the scene"


def steady_course(scene: Scene) -> Course:
    """The steady life of what of a scene has one; without its own estimate of errors."""
    reduced = steady_scene(scene)
    return course_of(reduced, steady_states(reduced))


def steady_life(scene: Scene) -> dict:
    """Life, end and loss at the end by the steady model, counted as the scene does."""
    course = steady_course(scene)
    values: dict = {"steady_status": course.status, "steady_end_criterion": course.criterion}
    if course.status == code.OK:
        count = COUNTS.index(scene.wear.counts)
        values |= {
            "steady_life": float(course.times[-1][count]),
            "steady_loss_at_end": course.states[-1].loss,
        }
    return values


def steady_time_to_loss(scene: Scene, loss: float) -> dict:
    """Time that the steady model takes to lose what the life in time lost in all."""
    end = EndOfLife(ball_diameter_loss_um=loss / parameters.UM)
    if not loss > float(np.mean(scene.wear.ball_diameter_loss_um)) * parameters.UM:
        return {}
    course = steady_course(replace(scene, wear=replace(scene.wear, end_of_life=end)))
    if course.status != code.OK:
        return {}
    return {"steady_time_to_loss": float(course.times[-1][COUNTS.index(scene.wear.counts)])}
