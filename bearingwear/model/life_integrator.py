"""Integral of a wear life over the loss of ball diameter.

The state of the bearing depends on the loss alone, so the life is

    t = integral of d(loss) / rate(loss),

taken with Simpson's rule in adaptive steps. Both ways of counting wear (ball, ball and races) share
the states and differ in the clock.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from bearingwear.kernels import status as code
from bearingwear.model.state import State
from bearingwear.scene.blocks import CRITERIA

FIRST_STEP = 2.5e-5  # of the ball diameter: 0.05 um on 2 mm
SHORTEST_STEP = 1e-6  # of the first step
ROOT = 1e-9  # of the step in which the criterion is met
_MOST_STEPS = 2000
WELL_WITHIN = 0.02  # share of the allowed error below which the next step is twice as long
ENOUGH = 1e3  # shortest steps; a step as short as this is taken whatever its error
TINY_TIME = 1e-300  # [s], so that nothing is no scale
REASONLESS = (code.CRITERION_NOT_REACHED, code.NOT_CONVERGED, code.UNVERIFIED)


class Unsolved(ArithmeticError):
    """A state along the life that was not found."""

    def __init__(self, status: int):
        super().__init__(status)
        self.status = status


@dataclass
class LifeHistory:
    """Wear states up to the end of life, and when they are reached."""

    states: list[State]
    times: list[np.ndarray]  # (2,) each [s]
    error: np.ndarray  # (2,) bound on the last time [s]
    criterion: int  # index into CRITERIA
    status: int
    solves: int = 0


class LifeIntegrator:
    """Adaptive Simpson integration of 1/rate over the loss, watching the criteria."""

    def __init__(self, state: Callable[[float], State], margin, tolerance: float):
        self._state = state
        self._known: dict[float, State] = {}
        self.margin = margin
        self.tolerance = tolerance

    def at(self, loss: float) -> State:
        if loss not in self._known:
            self._known[loss] = self._state(loss)
        return self._known[loss]

    @property
    def solves(self) -> int:
        return len(self._known)

    def crossing(self, a: State, b: State) -> tuple[float, int] | None:
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

    def first_crossing(self, nodes: list[State]) -> tuple[float, int] | None:
        """The first criterion met along solved states in order of loss, if any."""
        for a, b in zip(nodes[:-1], nodes[1:], strict=True):
            if b.status != code.OK:
                return None
            found = self.crossing(a, b)
            if found is not None:
                return found
        return None

    def step(self, x: float, h: float) -> tuple[list[State], np.ndarray, np.ndarray]:
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

    def integrate(self, loss: float, largest: float, step: float) -> LifeHistory:
        """From `loss` to the first criterion, or to where the solver or the range ends."""
        start = self.at(loss)
        history = LifeHistory(
            states=[start],
            times=[np.zeros(2)],
            error=np.zeros(2),
            criterion=len(CRITERIA) - 1,
            status=code.CRITERION_NOT_REACHED,
        )
        if start.status != code.OK:
            history.status = start.status
        elif start.rate.min() > 0.0:
            met = np.flatnonzero(self.margin(start) <= 0.0)
            if met.size:
                history.criterion, history.status = int(met[0]), code.OK
            else:
                self.extend(history, largest, step)
        history.solves = self.solves
        return history

    def extend(self, history: LifeHistory, largest: float, step: float) -> None:
        """Take steps up to the first criterion, or up to the loss `largest`."""
        states, times = history.states, history.times
        shortest = SHORTEST_STEP * step
        ended = None
        for _ in range(_MOST_STEPS):
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
                # The solver's range ends within this step. A physical reason beyond it
                # says more than a solve that rounding spoils just before.
                if history.status in REASONLESS:
                    history.status = failed[-1]
                step = 0.5 * h
                continue
            allowed = self.tolerance * np.maximum(times[-1] + increments[-1], TINY_TIME)
            if np.any(bound > allowed) and h > ENOUGH * shortest:
                step = 0.5 * h
                continue
            states += nodes[1:]
            times += [times[-1] + t for t in increments[1:]]
            history.error += bound
            if np.all(bound < WELL_WITHIN * allowed):
                step = 2.0 * h
        if ended is not None:
            # The criterion is known to within the root's tolerance; that is a time, too.
            history.error += ROOT * (states[-1].loss - states[0].loss) / states[-1].rate
            history.criterion, history.status = ended[1], code.OK
