"""Wear life: follow the loss of ball diameter to the first end-of-life criterion.

The state of the bearing depends on the loss alone, so the life is an integral over it,

    t = integral of d(loss) / rate(loss),

taken with Simpson's rule in adaptive steps, contact state, slip and preload solved anew at every
point. Both ways of counting wear (ball, ball and races) share the states and differ in the clock.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.optimize import brentq

from bearingwear.kernels import status as code
from bearingwear.kernels.steady import drag_force
from bearingwear.kernels.summary import ANGLE, HEAT, LOAD, MAJOR, PRESSURE, QV, SHARE, TRACK
from bearingwear.model import parameters
from bearingwear.model.estimate import DOUBLED, HALVED, ROUNDING, changed
from bearingwear.model.fidelity import choice_for_life
from bearingwear.model.interrupt import Interrupt
from bearingwear.model.race_control import solve_race_control
from bearingwear.model.result import Result
from bearingwear.model.scene import LARGEST_LOSS, EndOfLife, Scene, SceneError
from bearingwear.model.solve import provenance
from bearingwear.model.steady import ThrustProblem
from bearingwear.model.values import wear_values

CRITERIA = (
    "preload_fraction",
    "gyroscopic_slip_share",
    "skid_ratio",
    "ball_diameter_loss_um",
    "pocket_clearance_mm",
    "guide_clearance_mm",
    "none",
)
FIRST_STEP = 2.5e-5  # of the ball diameter: 0.05 um on 2 mm
SHORTEST_STEP = 1e-6  # of the first step
ROOT = 1e-9  # of the step in which the criterion is met
MOST_STEPS = 2000


@dataclass(frozen=True)
class WearState:
    """The bearing at one loss of ball diameter."""

    loss: float  # [m]
    status: int
    rate: np.ndarray = field(
        default_factory=lambda: np.zeros(2)
    )  # loss rate counting ball; ball and races [m/s]
    preload: float = np.nan  # residual [N]
    load: np.ndarray = field(
        default_factory=lambda: np.zeros(2)
    )  # contact loads, inner and outer [N]
    angle: np.ndarray = field(default_factory=lambda: np.zeros(2))  # contact angles [rad]
    qv: np.ndarray = field(default_factory=lambda: np.zeros(2))  # of one ball [W]
    total_qv: float = np.nan  # whole bearing [W]
    share: np.ndarray = field(default_factory=lambda: np.zeros(2))  # gyroscopic slip shares [1]
    skid: float = np.nan  # [1]
    pressure: float = np.nan  # largest contact pressure [Pa]
    stiffness: float = np.nan  # axial [N/m]
    friction_power: float = np.nan  # friction heat and drag, whole bearing [W]
    ball_rate: float = np.nan  # wear of one ball [m3/s]
    race_rate: np.ndarray = field(
        default_factory=lambda: np.zeros(2)
    )  # wear of the whole races [m3/s]


def steady_states(
    scene: Scene, problem: ThrustProblem | None = None
) -> Callable[[float], WearState]:
    """Function from loss to state on the steady model, each solve started from the nearest one.

    `problem`, if given, takes the place of the scene's own (other settings of accuracy).
    """
    problem = problem or ThrustProblem.of(scene)
    g = problem.g
    solved: dict[float, np.ndarray] = {}

    def state(loss: float) -> WearState:
        if problem.undetermined() != code.OK:
            return WearState(loss, problem.undetermined())
        D = g.D0 - loss
        near = min(solved, key=lambda x: abs(x - loss), default=None)
        case = problem.solve(D, None if near is None else solved[near])
        if case.status != code.OK:
            return WearState(loss, case.status)
        solved[loss] = case.u
        c = case.contacts
        F_v, _ = drag_force(g, D, problem.motion.drag, case.u[3])
        wear = wear_values(
            scene, np.array([D]), c[None, :, QV], c[None, :, MAJOR], c[None, :, TRACK]
        )
        return WearState(
            loss,
            case.status,
            wear["ball_diameter_loss_rate"],
            float(g.n_balls * c[0, LOAD] * np.sin(c[0, ANGLE])),
            c[:, LOAD],
            c[:, ANGLE],
            c[:, QV],
            float(g.n_balls * c[:, QV].sum()),
            c[:, SHARE],
            case.skid,
            float(c[:, PRESSURE].max()),
            float(g.n_balls * case.S_xx),
            float(g.n_balls * (c[:, HEAT].sum() + F_v * case.r * case.u[3])),
            float(wear["ball_wear_rate"][0]),
            wear["race_wear_rate"],
        )

    return state


def race_control_states(scene: Scene) -> Callable[[float], WearState]:
    """Function from loss to state on the race-control model, every ball losing the same."""
    fresh = np.array(scene.wear.ball_diameter_loss_um)
    first = fresh[0] * parameters.UM
    m = parameters.motion(scene)
    slip_speed = abs(m.omega_i - m.omega_o)

    def state(loss: float) -> WearState:
        worn = tuple(fresh + (loss - first) / parameters.UM)
        values, _ = solve_race_control(
            replace(scene, wear=replace(scene.wear, ball_diameter_loss_um=worn))
        )
        if values["status"] != code.OK:
            return WearState(loss, values["status"])
        return WearState(
            loss,
            values["status"],
            values["ball_diameter_loss_rate"],
            float(values["residual_preload"]),
            values["contact_load"].mean(axis=0),
            values["contact_angle"].mean(axis=0),
            values["qv"].mean(axis=0),
            float(values["total_qv"]),
            np.zeros(2),
            0.0,
            float(values["maximum_pressure"].max()),
            float(values["axial_stiffness"]),
            float(values["shaft_torque"]) * slip_speed,
            float(values["ball_wear_rate"].mean()),
            values["race_wear_rate"],
        )

    return state


def margins(state: WearState, end: EndOfLife, preload_N: float) -> np.ndarray:
    """How far each criterion is from being met (4,), in the order of `CRITERIA`.

    Positive before, zero or below where it is met; infinite where it does not apply.
    """
    infinite = np.inf
    return np.array(
        [
            infinite
            if end.preload_fraction is None
            else state.preload / preload_N - end.preload_fraction,
            infinite
            if end.gyroscopic_slip_share is None
            else end.gyroscopic_slip_share - state.share.max(),
            infinite if end.skid_ratio is None else end.skid_ratio - abs(state.skid),
            infinite
            if end.ball_diameter_loss_um is None
            else 1.0 - state.loss / (end.ball_diameter_loss_um * parameters.UM),
        ]
    )


@dataclass
class Course:
    """The way to the end of life."""

    states: list[WearState]
    times: list[np.ndarray]  # (2,) each [s]
    error: np.ndarray  # (2,) bound on the last time [s]
    criterion: int  # index into CRITERIA
    status: int
    solves: int


class Marcher:
    """Adaptive Simpson integration of 1/rate over the loss, watching the criteria."""

    def __init__(self, state: Callable[[float], WearState], margin, tolerance: float):
        self._state = state
        self._known: dict[float, WearState] = {}
        self.margin = margin
        self.tolerance = tolerance

    def at(self, loss: float) -> WearState:
        if loss not in self._known:
            self._known[loss] = self._state(loss)
        return self._known[loss]

    @property
    def solves(self) -> int:
        return len(self._known)

    def crossing(self, a: WearState, b: WearState) -> tuple[float, int] | None:
        """Loss and index of the first criterion met between two solved states, if any."""
        met = np.flatnonzero((self.margin(b) <= 0.0) & (self.margin(a) > 0.0))
        roots = []
        for k in met:
            # A solve that fails in between counts as met there: the bracket closes on it.
            def value(loss, k=k):
                state = self.at(loss)
                return self.margin(state)[k] if state.status == code.OK else -1.0

            roots.append(
                (brentq(value, a.loss, b.loss, xtol=ROOT * (b.loss - a.loss), rtol=1e-15), int(k))
            )
        return min(roots, default=None)

    def first_crossing(self, nodes: list[WearState]) -> tuple[float, int] | None:
        """The first criterion met along solved states in order of loss, if any."""
        for a, b in zip(nodes[:-1], nodes[1:], strict=True):
            if b.status != code.OK:
                return None
            found = self.crossing(a, b)
            if found is not None:
                return found
        return None

    def step(self, x: float, h: float) -> tuple[list[WearState], np.ndarray, np.ndarray]:
        """Five states over [x, x + h], the times from x to each (5, 2) and the error bound (2,)."""
        nodes = [self.at(x + 0.25 * k * h if k < 4 else x + h) for k in range(5)]
        if any(n.status != code.OK for n in nodes):
            return nodes, np.empty((5, 2)), np.full(2, np.inf)
        y = np.array([1.0 / n.rate for n in nodes])
        q = 0.25 * h
        first, second = q / 3.0 * (y[0] + 4 * y[1] + y[2]), q / 3.0 * (y[2] + 4 * y[3] + y[4])
        whole = 2.0 * q / 3.0 * (y[0] + 4 * y[2] + y[4])
        times = np.array(
            [
                np.zeros(2),
                q / 12.0 * (5 * y[0] + 8 * y[1] - y[2]),
                first,
                first + q / 12.0 * (5 * y[2] + 8 * y[3] - y[4]),
                first + second,
            ]
        )
        # The finer rule is about 15 times better than this difference of the two.
        return nodes, times, np.abs(first + second - whole)

    def march(self, loss: float, largest: float, step: float) -> Course:
        """From `loss` to the first criterion, or to where the solver or the range ends."""
        start = self.at(loss)
        states, times, error = [start], [np.zeros(2)], np.zeros(2)
        if start.status != code.OK or not start.rate.min() > 0.0:
            status = start.status if start.status != code.OK else code.CRITERION_NOT_REACHED
            return Course(states, times, error, len(CRITERIA) - 1, status, self.solves)
        met = np.flatnonzero(self.margin(start) <= 0.0)
        if met.size:
            return Course(states, times, error, int(met[0]), code.OK, self.solves)
        shortest = SHORTEST_STEP * step
        ended = None
        status = code.CRITERION_NOT_REACHED
        for _ in range(MOST_STEPS):
            h = min(step, largest - states[-1].loss)
            if h <= shortest:
                break
            x = states[-1].loss
            nodes, increments, bound = self.step(x, h)
            failed = [n.status for n in nodes if n.status != code.OK]
            if ended is None:
                ended = self.first_crossing(nodes)
            if ended is not None and ended[0] < x + h:
                largest = ended[0]  # integrate up to the criterion and no further
                continue
            if failed:
                # What ends the solver's range lies within this step; a physical reason beyond
                # tells more than a solve that rounding spoils just before it.
                if status in (code.CRITERION_NOT_REACHED, code.NOT_CONVERGED, code.UNVERIFIED):
                    status = failed[-1]
                step = 0.5 * h
                continue
            allowed = self.tolerance * np.maximum(times[-1] + increments[-1], 1e-300)
            if np.any(bound > allowed) and h > 1e3 * shortest:
                step = 0.5 * h
                continue
            states += nodes[1:]
            times += [times[-1] + t for t in increments[1:]]
            error += bound
            if np.all(bound < 0.02 * allowed):
                step = 2.0 * h
        if ended is not None:
            # The criterion is known to within the root's tolerance; that is a time, too.
            error += ROOT * (states[-1].loss - states[0].loss) / states[-1].rate
            return Course(states, times, error, ended[1], code.OK, self.solves)
        return Course(states, times, error, len(CRITERIA) - 1, status, self.solves)


def life(
    scene: Scene, fidelity: str | None = None, progress: Callable[[str], None] | None = None
) -> Result:
    """Wear life of a scene from its present loss of ball diameter on.

    Parameters
    ----------
    scene : Scene
        With `wear.end_of_life`.
    fidelity : str, optional
        Overrides `model.fidelity` of the scene.
    progress : callable, optional
        Given one line of text at each step of a life in time; others are done by then.

    Returns
    -------
    Result
        Life, its error bound and the history; where no criterion was met, `status` says so and the
        life is a lower bound.

    Raises
    ------
    SceneError
        Where the scene has no end-of-life criterion, or a preload fraction without a preload.
    NotAvailable
        Where the fidelity asked for cannot solve this scene.
    """
    end = scene.wear.end_of_life
    if end is None or not end.criteria:
        raise SceneError(
            "wear.end_of_life",
            "given nothing; a life needs at least one criterion",
            source=scene.name,
        )
    if end.preload_fraction is not None and scene.operation.preload_N == 0.0:
        raise SceneError(
            "wear.end_of_life.preload_fraction",
            "given with preload_N 0; a fraction needs a preload",
            source=scene.name,
        )
    chosen = choice_for_life(scene, fidelity)
    started = time.perf_counter()
    if chosen.tier == "dynamic":
        # its kernels take long to load, and the others do without
        from bearingwear.model.wear_in_time import solve_life_in_time

        values, attrs = solve_life_in_time(chosen.reduced(scene), progress)
        elapsed = time.perf_counter() - started
        return Result(values, attrs | provenance(scene, chosen), elapsed)
    with Interrupt():
        if chosen.tier == "steady":
            course = course_of(scene, steady_states(scene))
            values = life_values(scene, course) | error_estimate(scene, course)
        else:
            course = course_of(scene, race_control_states(scene))
            values = life_values(scene, course)
    elapsed = time.perf_counter() - started
    return Result(values, {"solves": course.solves} | provenance(scene, chosen), elapsed)


def course_of(scene: Scene, state: Callable[[float], WearState]) -> Course:
    """The way of a scene to its end of life, by its states."""
    end, preload = scene.wear.end_of_life or EndOfLife(), scene.operation.preload_N
    marcher = Marcher(state, lambda s: margins(s, end, preload), scene.model.tolerance)
    D0 = scene.bearing.ball_diameter_mm * parameters.MM
    return marcher.march(
        scene.wear.ball_diameter_loss_um[0] * parameters.UM, LARGEST_LOSS * D0, FIRST_STEP * D0
    )


def error_estimate(scene: Scene, course: Course) -> dict:
    """Estimated numerical error of a life: the same with other settings (see `estimate`)."""
    now = course.times[-1]
    if course.status != code.OK or not now.min() > 0.0:
        return {}
    total = ROUNDING + course.error / now
    problems = ThrustProblem.of(scene).perturbed(scene)
    for weight, problem in zip((HALVED, DOUBLED), problems, strict=True):
        other = course_of(scene, steady_states(scene, problem))
        if (other.status, other.criterion) != (course.status, course.criterion):
            return {}
        total = total + weight * changed(now, other.times[-1])
    return {"life_error_estimate": total}


def life_values(scene: Scene, course: Course) -> dict:
    """Result variables of a course."""
    values: dict = {"status": course.status, "end_criterion": course.criterion}
    states = course.states
    if states[0].status != code.OK or not states[0].rate.min() > 0.0:
        return values
    factor, _ = parameters.wear_factors(scene)
    values |= {
        "life": course.times[-1],
        "normalised_life": course.times[-1] * factor,
        "life_error_bound": course.error,
        "loss_at_end": states[-1].loss,
        "history_time": np.array(course.times),
    }
    return values | history_values(states)


def history_values(states: list[WearState]) -> dict:
    """Result variables of the states along a life."""
    columns = {
        "ball_diameter_loss": "loss",
        "residual_preload": "preload",
        "total_qv": "total_qv",
        "qv": "qv",
        "contact_angle": "angle",
        "contact_load": "load",
        "gyroscopic_slip_share": "share",
        "skid_ratio": "skid",
        "ball_diameter_loss_rate": "rate",
        "ball_wear_rate": "ball_rate",
        "race_wear_rate": "race_rate",
    }
    return {
        f"history_{name}": np.array([getattr(s, attribute) for s in states])
        for name, attribute in columns.items()
    }
