"""Periodic motion of like balls without a cage, found directly (theory.md section 22).

Under a load that stands still, or turns at one rate, like balls that are evenly spaced all move
alike: after the time of a passing each is where the next one was, as seen from the load. That is
solved by a quasi-Newton method for the balls' states and the time, and what small disturbances of
it grow to in a passing says whether it lasts. A run does not come to it by itself: the spacing that
its balls have once the rest has settled stays, or they bunch, which a cage keeps them from.
"""

import contextlib
from dataclasses import dataclass

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
MARCHED = (0.0, 4.0, 16.0)  # orbits simulated before each try
LONGEST_PASSING = 50.0  # turns: balls that hardly pass the load have no period worth waiting for
TANGENT_STEPS = 8  # of the disturbances in a stretch, each as many of the motion as it needs


@dataclass(frozen=True)
class PeriodicMotion:
    balls: np.ndarray  # (n, 5) states as the run begins
    time: float  # of that [s]
    passing: float  # until each ball is where the next one was, as seen from the load [s]
    error: float  # change over it, of the largest speed or in rad [1]
    turns: float  # simulated to find it
    inverse: np.ndarray  # of the derivative of what a passing changes, see `Passing.solve`
    growth: GrowthRates | None = None  # of its disturbances, where it was asked for and found

    @property
    def sentence(self) -> str:
        return self.growth.sentence if self.growth else "stability unknown"


class Passing:
    """Change of the balls' states by one passing, as seen from the load.

    The search begins from the balls of a system, which is moved about.
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
        balls = self.begun[0][: self.n * BALL].reshape(self.n, BALL)
        return (balls / self.scale).ravel()

    def change(self, states: np.ndarray) -> np.ndarray | None:
        """Change in a ball-pass period beyond the shift by a ball, and of the mean azimuth."""
        passing = self.place(states)
        if not self.is_usable(passing) or not self.advance(passing):
            return None
        return self.changed(states)

    def is_usable(self, passing: float) -> bool:
        """Whether a passing lasts neither no time nor for ever [s]."""
        return 0.0 < passing < LONGEST_PASSING * self.system.turn

    def changed(self, states: np.ndarray) -> np.ndarray:
        """`change`, once a passing from these states has been simulated."""
        there = self.system.balls.copy()
        there[:, PSI] -= self.load_rate * states[-1] * self.system.turn
        next_one = np.roll(states[:-1].reshape(self.n, BALL), -self.ahead, axis=0)
        next_one[-1 if self.ahead > 0 else 0, PSI] += self.ahead * _TURN
        mean = states[PSI:-1:BALL].mean() - self.middle
        return np.append(there / self.scale - next_one, mean)

    def change_and_tangents(self, states: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """`change`, and the derivative (5 n, 5 n) of where a passing leads by the states."""
        passing = self.place(states)
        if not self.is_usable(passing):
            return None
        self.simulated += passing
        found = tangents(self.system, self.control, passing)
        if found is None:
            return None
        scale = np.tile(self.scale, self.n)
        return self.changed(states), found * scale / scale[:, np.newaxis]

    def slope(self, moved: np.ndarray) -> np.ndarray:
        """Derivative of `change` where a passing ends, from that of where it leads."""
        m = self.n * BALL
        rates = self.system.rates()[:m].reshape(self.n, BALL) / self.scale
        rates[:, PSI] -= self.load_rate
        J = np.zeros((m + 1, m + 1))
        J[:m, :m] = moved - np.roll(np.eye(m), self.ahead * BALL, axis=1)
        J[:m, m] = rates.ravel() * self.system.turn
        J[m, PSI:m:BALL] = 1.0 / self.n
        return J

    def growth(self, states: np.ndarray) -> GrowthRates | None:
        """Growth of disturbances of a periodic motion through these states."""
        found = self.change_and_tangents(states)
        if found is None:
            return None
        multipliers = np.linalg.eigvals(np.roll(found[1], self.ahead * BALL, axis=0))
        return GrowthRates.of(multipliers, self.n, float(states[-1]))

    def solve(
        self, states: np.ndarray, inverse: np.ndarray | None = None
    ) -> tuple[np.ndarray, float, np.ndarray]:
        """States that repeat themselves, and by how much they do not (infinite where it fails).

        Broyden's method, from `slope` or from an inverse that it ended with nearby, which is
        returned last.
        """
        nothing = states, np.inf, np.empty((0, 0))
        if inverse is None:
            found = self.change_and_tangents(states)
            change = None if found is None else found[0]
            inverse = None if found is None else inverse_of(self.slope(found[1]))
        else:
            change = self.change(states)
        if change is None or inverse is None:
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


def tangents(system: DynamicSystem, control: StepControl, duration: float) -> np.ndarray | None:
    """Derivative (5 n, 5 n) of the balls' states after a time by those now; None where a run fails.

    The system moves to that time, by the implicit method, whose matrix this takes.
    """
    control = control._replace(method=ROSENBROCK)
    old = np.eye(len(system.balls) * BALL)
    older, new, rate = old.copy(), old.copy(), TANGENT_STEPS / duration
    for step in range(TANGENT_STEPS):
        tally = system.simulate(control, duration / TANGENT_STEPS)
        if tally.status != code.OK:
            return None
        system.time, system.h = tally.time, tally.h
        weights = (1.5 * rate, -2.0 * rate, 0.5 * rate) if step else (rate, -rate, 0.0)
        buffers = (system.y, system.bearing, system.buffers, system.stages)
        if not carry_tangents(weights, old, older, *buffers, new):
            return None
        old, older, new = new, old, older
    return old.T


def inverse_of(J: np.ndarray) -> np.ndarray | None:
    with contextlib.suppress(np.linalg.LinAlgError):
        return np.linalg.inv(J) if np.isfinite(J).all() else None
    return None


def periodic_motion(
    system: DynamicSystem,
    tolerance: float,
    method: Tableau,
    near: PeriodicMotion | None = None,
) -> PeriodicMotion | None:
    """The periodic motion that the balls of a system come to; None where none is found.

    The system begins near it, or as a run would; it is left somewhere else. Where the balls are
    already at a motion `near`, of much the same system, the growth of disturbances is not asked for
    again.
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
        states, error, inverse = passing.solve(passing.states(), inverse)
        if error <= ACCEPTED:
            growth = passing.growth(states) if near is None else None
            found = passing.place(states)
            return PeriodicMotion(
                balls=system.balls.copy(),
                time=passing.begun[1],
                passing=found,
                error=error,
                turns=passing.simulated / system.turn,
                inverse=inverse,
                growth=growth,
            )
        system.unpack(*passing.begun)
    return None
