"""Periodic motion of like balls without a cage, found directly (theory.md section 22).

Under a load that stands still, or turns at one rate, like balls that are evenly spaced all move
alike: after the time of a passing each is where the next one was, as seen from the load. That is
solved by a quasi-Newton method for the balls' states and the time. The growth of small disturbances
in a passing shows whether it is stable. A run does not reach it by itself: the spacing of the balls
once the rest has settled stays, or the balls bunch, which a cage prevents.
"""

import contextlib
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.dynamic.integrators import ROSENBROCK, Tableau
from bearingwear.kernels.dynamic.step_control import StepControl
from bearingwear.kernels.dynamic.tangents import carry_tangents
from bearingwear.kernels.layout import BALL, OMEGA, PSI
from bearingwear.solvers.dynamic.stability import GrowthRates
from bearingwear.solvers.dynamic.system import DynamicSystem

_TURN = 2.0 * np.pi
CONVERGED = 1e-9  # change over a passing, of the largest speed or in rad
ACCEPTED = 1e-6  # where the time steps are too rough for better
_MOST_STEPS = 25  # of the quasi-Newton method
_STALLED = 6  # steps without a smaller change
TINY_RATE = 1e-300  # [rad/s], so that a standing ball has a finite passing
MARCHED = (0.0, 4.0, 16.0)  # orbits simulated before each try
LONGEST_PASSING = 50.0  # turns: balls that hardly pass the load have no useful period
TANGENT_STEPS = 8  # steps of the disturbances in a passing; the motion takes as many as it needs


@dataclass(frozen=True)
class PeriodicMotion:
    """A periodic motion, and its stability."""

    balls: np.ndarray  # (n, 5) states at the start of the run
    time: float  # at the start [s]
    passing: float  # time until each ball is where the next one was, as seen from the load [s]
    error: float  # change over it, of the largest speed or in rad [1]
    turns: float  # simulated to find it
    inverse: np.ndarray  # of the derivative of `Passing.change`, see `Passing.solve`
    growth: GrowthRates | None = None  # of its disturbances, if it was computed

    @property
    def sentence(self) -> str:
        """Returns the stability of the motion in words."""
        return self.growth.sentence if self.growth else "stability unknown"


class RepeatedStates(NamedTuple):
    """States of the balls that a passing repeats."""

    states: np.ndarray  # as `Passing.states`
    error: float  # largest change by the passing; infinite where the search failed [1]
    inverse: np.ndarray  # of the derivative of the change, as Broyden's method left it


class Passing:
    """Change of the balls' states by one passing, as seen from the load.

    The search starts from the balls of a system, and changes its state.

    tolerance, method: of the integration in time.
    """

    def __init__(self, system: DynamicSystem, tolerance: float, method: Tableau) -> None:
        self.system = system
        self.control = system.control(tolerance, method)
        self.start_state = system.packed(), system.time
        self.n = len(system.balls)
        bearing = system.bearing
        self.load_rate = bearing.op.omega_i if bearing.F_rot else 0.0
        self.speed = float(np.abs(system.balls[:, : OMEGA + 1]).max())
        self.scale = np.append(np.full(OMEGA + 1, self.speed), 1.0)
        rate = float(system.balls[:, OMEGA].mean()) - self.load_rate
        self.ahead = 1 if rate > 0.0 else -1  # step to the number of the next ball
        self.passing = _TURN / self.n / max(abs(rate), TINY_RATE)
        self.middle = float(system.balls[:, PSI].mean())
        self.simulated = 0.0  # [s]

    def states(self) -> np.ndarray:
        """Returns the unknowns: the balls' states over their scale, then the passing in turns."""
        return np.append(self.system.balls / self.scale, self.passing / self.system.turn)

    def put_balls(self, states: np.ndarray) -> float:
        """Sets the system back to the start of the search, with its balls in states.

        Returns the time of a passing in `states` [s].

        states: unknowns, as the method `states` returns them.
        """
        self.system.unpack(*self.start_state)
        self.system.balls[:] = states[:-1].reshape(self.n, BALL) * self.scale
        return float(states[-1] * self.system.turn)

    def advance(self, duration: float) -> bool:
        """Simulates a duration [s]; returns whether that succeeded."""
        self.simulated += duration
        tally = self.system.simulate(self.control, duration)
        return bool(tally.status == code.OK)

    def march(self, orbits: float) -> bool:
        """Moves the balls on as a run would, for a number of orbits; returns whether it succeeded.

        They start from the beginning of the search. Their azimuths are taken back by whole turns
        and by what the load has turned; `middle` becomes their mean. After a failure the system is
        at the instant that it reached.
        """
        system, passing = self.system, self.passing
        self.put_balls(np.append(self.start, passing / system.turn))
        duration = orbits * self.n * passing
        if not self.advance(duration):
            return False
        azimuth = system.balls[:, PSI]
        azimuth -= self.load_rate * duration
        azimuth -= _TURN * round((azimuth.mean() - self.middle) / _TURN)
        self.middle = float(azimuth.mean())
        return True

    @property
    def start(self) -> np.ndarray:
        """Returns the balls' states at the start, over their scale."""
        balls = self.start_state[0][: self.n * BALL].reshape(self.n, BALL)
        return (balls / self.scale).ravel()

    def change(self, states: np.ndarray) -> np.ndarray | None:
        """Returns the states after a passing less those of the next balls before it (5 n + 1,).

        They are over the scale of the states. The last number is the mean azimuth less `middle`,
        which fixes the phase [rad]. All are zero for a periodic motion. None if the passing cannot
        be simulated.

        states: unknowns, as the method `states` returns them.
        """
        passing = self.put_balls(states)
        if not self.is_usable(passing) or not self.advance(passing):
            return None
        return self.change_after(states)

    def is_usable(self, passing: float) -> bool:
        """Returns whether a passing [s] is positive, and no longer than `LONGEST_PASSING`."""
        return 0.0 < passing < LONGEST_PASSING * self.system.turn

    def change_after(self, states: np.ndarray) -> np.ndarray:
        """Returns `change` of states from which a passing has just been simulated."""
        after = self.system.balls.copy()
        after[:, PSI] -= self.load_rate * states[-1] * self.system.turn
        next_balls = np.roll(states[:-1].reshape(self.n, BALL), -self.ahead, axis=0)
        next_balls[-1 if self.ahead > 0 else 0, PSI] += self.ahead * _TURN
        azimuth_change = states[PSI:-1:BALL].mean() - self.middle
        return np.append(after / self.scale - next_balls, azimuth_change)

    def change_and_tangents(self, states: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """Returns `change`, and the derivative (5 n, 5 n) of the final states by the first ones.

        None if the passing cannot be simulated.
        """
        passing = self.put_balls(states)
        if not self.is_usable(passing):
            return None
        self.simulated += passing
        derivative = tangents(self.system, self.control, passing)
        if derivative is None:
            return None
        scale = np.tile(self.scale, self.n)
        return self.change_after(states), derivative * scale / scale[:, np.newaxis]

    def slope(self, derivative: np.ndarray) -> np.ndarray:
        """Returns the derivative of `change` by the states (5 n + 1, 5 n + 1).

        derivative: of the final states by the first ones (5 n, 5 n).
        """
        m = self.n * BALL
        rates = self.system.rates()[:m].reshape(self.n, BALL) / self.scale
        rates[:, PSI] -= self.load_rate
        J = np.zeros((m + 1, m + 1))
        J[:m, :m] = derivative - np.roll(np.eye(m), self.ahead * BALL, axis=1)
        J[:m, m] = rates.ravel() * self.system.turn
        J[m, PSI:m:BALL] = 1.0 / self.n
        return J

    def growth(self, states: np.ndarray) -> GrowthRates | None:
        """Returns the growth of disturbances of a periodic motion through states.

        None if a passing cannot be simulated.
        """
        linearised = self.change_and_tangents(states)
        if linearised is None:
            return None
        _, derivative = linearised
        multipliers = np.linalg.eigvals(np.roll(derivative, self.ahead * BALL, axis=0))
        return GrowthRates.of(multipliers, self.n, float(states[-1]))

    def solve(self, states: np.ndarray, inverse: np.ndarray | None = None) -> RepeatedStates:
        """Returns states that repeat themselves, by Broyden's method.

        They are the best ones found; `error` says whether they do repeat. It is infinite where the
        first passing cannot be simulated or its derivative has no inverse.

        inverse: of the derivative of `change`, of a solution nearby; else `slope` gives it.
        """
        failure = RepeatedStates(states, np.inf, np.empty((0, 0)))
        change: np.ndarray | None
        if inverse is None:
            linearised = self.change_and_tangents(states)
            if linearised is None:
                return failure
            change, derivative = linearised
            inverse = inverse_of(self.slope(derivative))
        else:
            change = self.change(states)
        if change is None or inverse is None:
            return failure
        best = states
        best_size = float(np.abs(change).max())
        inverse = inverse.copy()
        stalled = 0
        for _ in range(_MOST_STEPS if best_size > CONVERGED else 0):
            step = -inverse @ change
            states = states + step
            new_change = self.change(states)
            if new_change is None:
                break
            stalled += 1
            if np.abs(new_change).max() < best_size:
                best = states
                best_size = float(np.abs(new_change).max())
                stalled = 0
            if best_size <= CONVERGED or stalled >= _STALLED:
                break
            inverse_change = inverse @ (new_change - change)
            inverse += np.outer(step - inverse_change, step @ inverse) / (step @ inverse_change)
            change = new_change
        return RepeatedStates(best, best_size, inverse)


def tangents(system: DynamicSystem, control: StepControl, duration: float) -> np.ndarray | None:
    """Returns the derivative (5 n, 5 n) of the balls' states after a duration; None on failure.

    The system moves to that time by the implicit method, whose matrix is used.
    """
    control = control._replace(method=ROSENBROCK)
    old = np.eye(len(system.balls) * BALL)
    older = old.copy()
    new = old.copy()
    rate = TANGENT_STEPS / duration
    for step in range(TANGENT_STEPS):
        tally = system.simulate(control, duration / TANGENT_STEPS)
        if tally.status != code.OK:
            return None
        system.time, system.h = tally.time, tally.h
        # of the second order, but for the first step
        weights = (1.5 * rate, -2.0 * rate, 0.5 * rate) if step else (rate, -rate, 0.0)
        is_carried = carry_tangents(
            weights, old, older, system.y, system.bearing, system.buffers, system.stages, new
        )
        if not is_carried:
            return None
        old, older, new = new, old, older
    return old.T


def inverse_of(J: np.ndarray) -> np.ndarray | None:
    """Returns the inverse of a matrix; None if it is singular or not finite."""
    with contextlib.suppress(np.linalg.LinAlgError):
        return np.linalg.inv(J) if np.isfinite(J).all() else None
    return None


def periodic_motion(
    system: DynamicSystem,
    tolerance: float,
    method: Tableau,
    near: PeriodicMotion | None = None,
) -> PeriodicMotion | None:
    """Returns the periodic motion that the balls of a system come to; None if none is found.

    Each try starts after some more orbits (`MARCHED`). The search also ends without a motion where
    these cannot be simulated, or where a passing is longer than `LONGEST_PASSING`. The system ends
    in another state.

    tolerance, method: of the integration in time.
    near: motion of much the same system, at which the balls already are. The growth of disturbances
        is then not computed again.
    """
    passing = Passing(system, tolerance, method)
    tries: list[tuple[float, np.ndarray | None]] = [(orbits, None) for orbits in MARCHED]
    if near is not None:
        passing.passing = near.passing
        tries.insert(0, (0.0, near.inverse))
    for orbits, inverse in tries:
        if passing.passing > LONGEST_PASSING * system.turn:
            return None
        if orbits and not passing.march(orbits):
            return None
        repeated = passing.solve(passing.states(), inverse)
        if repeated.error <= ACCEPTED:
            growth = passing.growth(repeated.states) if near is None else None
            duration = passing.put_balls(repeated.states)
            return PeriodicMotion(
                balls=system.balls.copy(),
                time=passing.start_state[1],
                passing=duration,
                error=repeated.error,
                turns=passing.simulated / system.turn,
                inverse=repeated.inverse,
                growth=growth,
            )
        system.unpack(*passing.start_state)
    return None
