"""Periodic motion of like balls without a cage, found directly (theory.md section 22).

Under a load that stands still, or turns at one rate, like balls that are evenly spaced all move
alike: after the time of a passing each is where the next one was, as seen from the load. That is
solved by a quasi-Newton method for the balls' states and the time. A run settles by itself where
this is stable, but may take hundreds of turns, and its balls may bunch, which a cage keeps them
from.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from bearingwear.kernels import status as code
from bearingwear.kernels.integrators import Tableau
from bearingwear.kernels.state import BALL, OMEGA, PSI
from bearingwear.model.dynamic import DynamicSystem

_TURN = 2.0 * np.pi
CONVERGED = 1e-9  # change over a passing, of the largest speed or in rad
ACCEPTED = 1e-6  # where the steps in time are too rough for better
_SHIFT = 1e-5  # of the states, to see what they do; far above what the steps leave open
_MOST_STEPS = 25  # of the quasi-Newton method
_STALLED = 6  # steps without a smaller change
MARCHED = (0.0, 4.0, 16.0)  # orbits simulated before each try
LONGEST_PASSING = 50.0  # turns: balls that hardly pass the load have no period worth waiting for


@dataclass(frozen=True)
class PeriodicMotion:
    """State that repeats itself."""

    balls: np.ndarray  # (n, 5) states as the run begins
    time: float  # of that [s]
    passing: float  # until each ball is where the next one was, as seen from the load [s]
    error: float  # change over it, of the largest speed or in rad [1]
    turns: float  # simulated to find it
    inverse: np.ndarray  # of the derivative of what a passing changes, see `Passing.solve`


class Passing:
    """Change of the balls' states by one passing, as seen from the load.

    Parameters
    ----------
    system : DynamicSystem
        Whose balls the search begins from; it is moved about.
    tolerance, method
        See `DynamicSystem.control`.
    """

    def __init__(self, system: DynamicSystem, tolerance: float, method: Tableau) -> None:
        self.system, self.control = system, system.control(tolerance, method)
        self.begun = system.packed(), system.time
        self.n = len(system.balls)
        bearing = system.bearing
        self.load_rate = bearing.op.omega_i if bearing.F_rot else 0.0
        self.speed = float(np.abs(system.balls[:, : OMEGA + 1]).max())
        self.scale = np.append(np.full(OMEGA + 1, self.speed), 1.0)
        rate = float(system.balls[:, OMEGA].mean()) - self.load_rate
        self.ahead = 1 if rate > 0.0 else -1  # the next ball
        self.passing = _TURN / self.n / max(abs(rate), 1e-300)
        self.middle = float(system.balls[:, PSI].mean())
        self.simulated = 0.0  # [s]

    def states(self) -> np.ndarray:
        """Unknowns: the balls' states over their scale, then the passing in turns."""
        return np.append(self.system.balls / self.scale, self.passing / self.system.turn)

    def place(self, states: np.ndarray) -> float:
        """Put the balls into these states at the start; returns the passing [s]."""
        self.system.unpack(*self.begun)
        self.system.balls[:] = states[:-1].reshape(self.n, BALL) * self.scale
        return float(states[-1] * self.system.turn)

    def advance(self, duration: float) -> bool:
        """Simulate for a time; returns whether that went well."""
        self.simulated += duration
        tally = self.system.simulate(self.control, duration)
        return bool(tally.status == code.OK)

    def march(self, orbits: float) -> bool:
        """Continue as a run would, for a number of orbits; returns whether that went well."""
        system, passing = self.system, self.passing
        self.place(np.append(self.start, passing / system.turn))
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
        """The balls' states over their scale where the search begins."""
        balls = self.begun[0][: self.n * BALL].reshape(self.n, BALL)
        return (balls / self.scale).ravel()

    def change(self, states: np.ndarray) -> np.ndarray | None:
        """What a passing changes beyond the shift by a ball, and of the mean azimuth."""
        passing = self.place(states)
        if not 0.0 < passing < LONGEST_PASSING * self.system.turn or not self.advance(passing):
            return None
        there = self.system.balls.copy()
        there[:, PSI] -= self.load_rate * passing
        next_one = np.roll(states[:-1].reshape(self.n, BALL), -self.ahead, axis=0)
        next_one[-1 if self.ahead > 0 else 0, PSI] += self.ahead * _TURN
        mean = states[PSI:-1:BALL].mean() - self.middle
        return np.append(there / self.scale - next_one, mean)

    def slope(self, states: np.ndarray, change: np.ndarray) -> np.ndarray | None:
        """Derivative of `change`, each ball's states counted as if they moved it alone.

        Like shifts of all balls at once give it, five runs for all of them.
        """
        n, m = self.n, self.n * BALL
        own = np.tile(np.eye(BALL), (n, 1, 1))
        for q in range(BALL):
            shifted = states.copy()
            shifted[q:m:BALL] += _SHIFT
            after = self.change(shifted)
            if after is None:
                return None
            own[:, :, q] += ((after - change)[:m] / _SHIFT).reshape(n, BALL)
        longer = states.copy()
        longer[m] *= 1.0 + _SHIFT
        after = self.change(longer)
        if after is None:
            return None
        return self.assembled(own, (after - change) / (_SHIFT * states[m]))

    def thrust_slope(self, linear: np.ndarray) -> np.ndarray:
        """`slope` if each ball returned to its motion as under the thrust alone; no run for it.

        Parameters
        ----------
        linear : ndarray (4, 4)
            Derivative of the rates of (w_x, w_y, w_z, Omega) by these [1/s].
        """
        k = OMEGA + 1
        with_integral = np.zeros((2 * k, 2 * k))
        with_integral[:k, :k], with_integral[k:, :k] = linear, np.eye(k)
        moved = expm(self.passing * with_integral)
        own = np.eye(BALL)
        own[:k, :k] = moved[:k, :k]
        own[PSI, :k] = self.speed * moved[k + OMEGA, :k]
        m = self.n * BALL
        by_time = np.zeros(m + 1)
        by_time[PSI:m:BALL] = (self.system.balls[:, OMEGA] - self.load_rate) * self.system.turn
        return self.assembled(np.tile(own, (self.n, 1, 1)), by_time)

    def assembled(self, own: np.ndarray, by_time: np.ndarray) -> np.ndarray:
        """Derivative of `change` from that of each ball's states (n, 5, 5), and by the passing."""
        n, m = self.n, self.n * BALL
        J, ball = np.zeros((m + 1, m + 1)), np.arange(n)
        for q in range(BALL):
            J[ball * BALL + q, (ball + self.ahead) % n * BALL + q] -= 1.0
        for j in range(n):
            J[j * BALL : (j + 1) * BALL, j * BALL : (j + 1) * BALL] += own[j]
        J[:, m] = by_time
        J[m, PSI:m:BALL] = 1.0 / n
        return J

    def solve(
        self, states: np.ndarray, inverse: np.ndarray | None = None
    ) -> tuple[np.ndarray, float, np.ndarray]:
        """States that repeat themselves, and by how much they do not (infinite where it fails).

        Broyden's method, from `slope` or from an inverse that it ended with nearby, which is
        returned last.
        """
        change = self.change(states)
        nothing = states, np.inf, np.empty((0, 0))
        if change is None:
            return nothing
        if inverse is None:
            J = self.slope(states, change)
            inverse = None if J is None else inverse_of(J)
            if inverse is None:
                return nothing
        best, size, inverse = states, float(np.abs(change).max()), inverse.copy()
        since = 0
        for _ in range(_MOST_STEPS if size > CONVERGED else 0):
            step = -inverse @ change
            states = states + step
            new = self.change(states)
            if new is None:
                break
            since += 1
            if np.abs(new).max() < size:
                best, size, since = states, float(np.abs(new).max()), 0
            if size <= CONVERGED or since >= _STALLED:
                break
            mapped = inverse @ (new - change)
            inverse += np.outer(step - mapped, step @ inverse) / (step @ mapped)
            change = new
        return best, size, inverse


def inverse_of(J: np.ndarray) -> np.ndarray | None:
    """Inverse of a matrix; None where it has none."""
    if not np.isfinite(J).all():
        return None
    try:
        return np.linalg.inv(J)
    except np.linalg.LinAlgError:
        return None


def periodic_motion(
    system: DynamicSystem,
    tolerance: float,
    method: Tableau,
    near: PeriodicMotion | None = None,
    linear: np.ndarray | None = None,
) -> PeriodicMotion | None:
    """The periodic motion that the balls of a system come to; None where none is found.

    Parameters
    ----------
    system : DynamicSystem
        Begins near it, or as a run would; it is left somewhere else.
    tolerance, method
        See `DynamicSystem.control`.
    near : PeriodicMotion, optional
        Of much the same system, where the balls are already.
    linear : ndarray (4, 4), optional
        See `Passing.thrust_slope`.
    """
    passing = Passing(system, tolerance, method)
    tries: list[tuple[float, np.ndarray | None]] = [(orbits, None) for orbits in MARCHED]
    if near is not None:
        passing.passing = near.passing
        tries.insert(0, (0.0, near.inverse))
    elif linear is not None and passing.passing <= LONGEST_PASSING * system.turn:
        inverse = inverse_of(passing.thrust_slope(linear))
        if inverse is not None:
            tries.insert(0, (0.0, inverse))
    for orbits, inverse in tries:
        if passing.passing > LONGEST_PASSING * system.turn:
            return None
        if orbits and not passing.march(orbits):
            return None
        states, error, inverse = passing.solve(passing.states(), inverse)
        if error <= ACCEPTED:
            found = passing.place(states)
            return PeriodicMotion(
                balls=system.balls.copy(),
                time=passing.begun[1],
                passing=found,
                error=error,
                turns=passing.simulated / system.turn,
                inverse=inverse,
            )
        system.unpack(*passing.begun)
    return None
