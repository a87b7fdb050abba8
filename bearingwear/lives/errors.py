"""Numerical errors of lives, estimated by lives with other settings (see `solvers.estimates`)."""

import math

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.ends import Criteria
from bearingwear.lives.follow import Life
from bearingwear.lives.grooves import FEWER_CELLS, LONGER_STEP, WORN_CELLS, Grooves, follow_grooves
from bearingwear.lives.surfaces import surface_life
from bearingwear.scene.scene import COUNTS, Scene
from bearingwear.solvers.bearing.films import follows_depths
from bearingwear.solvers.compose import Remembered, solver_of
from bearingwear.solvers.condition import Accuracy
from bearingwear.solvers.estimates import DOUBLED, HALVED, ROUNDING, changed

SCATTER = 2.0  # standard errors
_WEIGHTS = {Accuracy.HALF_SLIP: HALVED, Accuracy.TWICE_POINTS: DOUBLED}


def _ends_alike(life: Life, other: Life) -> bool:
    return (other.status, other.criterion) == (life.status, life.criterion)


def surface_error(scene: Scene, life: Life) -> dict:
    """Estimate for a steady life whose contacts stay Hertzian; none without an end of its own."""
    now, own = life.last.time, COUNTS.index(scene.wear.counts)
    if life.status != code.OK or not now[own] > 0.0:
        return {}
    total = ROUNDING + life.error / now
    for accuracy, weight in _WEIGHTS.items():
        states = solver_of(scene, "steady", accuracy)
        if len(scene.sides) == 1 and not follows_depths(scene):
            change = _changed_along(life, states, Criteria(scene))
        else:
            other = surface_life(scene, states, bounded=False, counts=(own,))
            change = changed(now, other.last.time) if _ends_alike(life, other) else None
        if change is None:
            return {}
        total = total + weight * change
    return {"life_error_estimate": total}


def _changed_along(life: Life, states: Remembered, ends: Criteria) -> np.ndarray | None:
    """Relative change of a life by other states at its start, middle and end; None if it would end
    by another criterion.

    That of the pace is integrated; that of the margin shifts the end, by its last slope.
    """
    nodes, before = [life.nodes[k] for k in (0, len(life.nodes) // 2, -1)], life.nodes[-2]
    others = [states.at(node.x) for node in nodes]
    if not all(one.is_solved for one in others):
        return None
    left, last = ends.margins(others[-1:]), ends.margins(before.states)[life.criterion]
    if np.delete(left, life.criterion).min() <= 0.0:
        return None
    pace = [node.states[0].rate / one.rate - 1.0 for node, one in zip(nodes, others, strict=True)]
    change = np.trapezoid(pace, [node.time for node in nodes], axis=0)
    change += left[life.criterion] / last * (life.last.time - before.time)
    return np.abs(change) / life.last.time


def groove_errors(scene: Scene, life: Life) -> dict:
    """Bound on the error of the steps, and the estimate of all; by lives in longer steps.

    That of the steps is at most twice what steps half as long again change. That of the cells, of
    v_r and of the points is taken from lives with fewer cells, half of v_r and twice the points.
    """
    now = life.last.time[1]
    if life.status != code.OK or not now > 0.0:
        return {}

    def time(accuracy: Accuracy, cells: tuple[int, int]) -> float:
        longer = Grooves(scene, cells, LONGER_STEP, accuracy, only_times=True, rough=True)
        other = follow_grooves(longer)
        return float(other.last.time[1]) if _ends_alike(life, other) else math.nan

    coarse, few = (time(Accuracy.CHECKED, cells) for cells in (WORN_CELLS, FEWER_CELLS))
    bound = 2.0 * abs(coarse - now)
    values = {"life_error_bound": np.array([math.nan, bound])}
    estimate = ROUNDING + (bound + abs(few - coarse)) / now
    for accuracy, weight in _WEIGHTS.items():
        estimate += weight * abs(time(accuracy, FEWER_CELLS) / few - 1.0)
    if math.isfinite(estimate):
        values["life_error_estimate"] = np.array([math.nan, estimate])
    return values


def integration_error(time: np.ndarray, rate: np.ndarray) -> float:
    """Bound on the error of a trapezoidal integral by steps and by scatter of the runs.

    A third of the change by steps twice as long, plus twice the standard error of the sum. The
    latter comes from the scatter of the nodes about parabolas through their neighbours.
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
