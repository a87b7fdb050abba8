"""The balance of a rotor between two bearings, solved for its place."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.solvers.condition import USABLE, SolvedBearing

ROTOR_BALANCED = 1e-12  # force left on the rotor, over the larger one, where its place is found
_MOST_STEPS = 40
_STEEPER = 1e3  # a secant within this of the slope of a trial is believed
_FASTER = 2.0  # steps of a rotor that runs away are so many times as long
_NARROW = 1e-9  # of a place: a range in which a force does not change but jumps
_STALLED = 3  # trials without gain after which it is rounding that is left, where that is
_LIGHT = 1e-5  # of the forces at the most
GONE = (code.CONTACT_LOST, code.PRELOAD_GONE)


@dataclass(frozen=True)
class RotorTrial:
    """Both bearings at a place of the rotor, and what is left of its balance."""

    states: tuple[SolvedBearing, SolvedBearing]
    left: float  # [N]
    slope: float  # of `left`, about [N/m]
    scale: float  # of the forces [N]


@dataclass
class Nearby:
    """Start values from earlier balances."""

    steeper: float = 1.0  # slope of what is left over that of a trial
    place: float = math.nan  # that was found last [m]
    losses: np.ndarray = field(default_factory=lambda: np.zeros(2))  # there [m]
    rough: tuple[np.ndarray, float] | None = None  # losses and place found roughly since then [m]
    slope: np.ndarray = field(default_factory=lambda: np.zeros(2))  # of the place by the losses

    @property
    def last(self) -> tuple[np.ndarray, float]:
        """Losses and the place found with them last, roughly or not [m]."""
        return self.rough or (self.losses, self.place)

    @property
    def known(self) -> bool:
        return not math.isnan(self.last[1])

    def at(self, losses: tuple[float, float]) -> float:
        """The place to expect [m]."""
        losses_there, place = self.last
        return place + float(self.slope @ (losses - losses_there))

    def found(self, losses: tuple[float, float], place: float, exact: bool = True) -> None:
        """Remember a place and, if it is exact, its slope by Broyden's rule.

        A rough one is next to an exact one, and its error over so short a way is no slope.
        """
        self.rough = None if exact else (np.array(losses), place)
        if not exact:
            return
        moved = losses - self.losses
        if not math.isnan(self.place) and moved.any():
            self.slope += (place - self.at(losses)) / (moved @ moved) * moved
        self.losses, self.place = np.array(losses), place

    def forget(self) -> None:
        """Forget what a short way said of the slope; the last place serves shorter steps too."""
        self.steeper, self.slope, self.rough = 1.0, np.zeros(2), None


@dataclass
class _Secants:
    """Steps of the rotor towards its balance.

    The force left rises with the position of a rotor that stays. Where it falls the rotor runs
    away, and so do the steps.
    """

    nearby: Nearby
    runs_away: bool = False
    before: tuple[float, float] | None = None
    low: float = -math.inf  # nearest places where too little, and too much, is left
    high: float = math.inf

    @property
    def jumps(self) -> bool:
        """Whether the residual changes sign without a root in between."""
        largest = max(abs(self.low), abs(self.high))
        return math.isfinite(largest) and 0.0 <= self.high - self.low <= _NARROW * largest

    def step(self, x: float, found: RotorTrial) -> float:
        """From a trial at a place [m]."""
        left, slope = found.left, self.nearby.steeper * found.slope
        if self.before is not None and x != self.before[0]:
            secant = (left - self.before[1]) / (x - self.before[0])
            nearer, turned = abs(left) < abs(self.before[1]), left * self.before[1] < 0.0
            self.runs_away = secant < 0.0 and not nearer
            if nearer or turned:
                near = found.slope / _STEEPER < secant < _STEEPER * found.slope
                slope = secant if near else found.slope
        self.nearby.steeper = slope / found.slope
        self.before = x, left
        self.low, self.high = (self.low, x) if left > 0.0 else (x, self.high)
        if self.runs_away:
            return -_FASTER * left / found.slope
        if not self.low < x - left / slope < self.high and self.low < self.high:
            return 0.5 * (self.low + self.high) - x
        return -left / slope


def balanced(
    trial: Callable[[float], RotorTrial | int],
    x: float,
    rounded: float,
    nearby: Nearby,
    tolerance: float = ROTOR_BALANCED,
) -> tuple[float, RotorTrial | int]:
    """The place of balance: Newton's method with the slope of a trial, then secants.

    A trial is that of a place [m], or a status. `nearby` has the steepness of the first step, which
    is renewed; steps of `rounded` [m] change nothing; the tolerance is the force left, over the
    larger one. Light loads reach rounding before they balance; the check afterwards says by how
    much. Returns the place, and the trial there or the status of what failed.
    """
    secants, stalled = _Secants(nearby), 0
    best: tuple[float, RotorTrial] | None = None
    for _ in range(_MOST_STEPS):
        found = trial(x)
        lost = found if isinstance(found, int) else failed_status(found.states)
        if isinstance(found, int) or lost != code.OK:
            return x, code.NO_STEADY_STATE if secants.runs_away else lost
        if best is None or abs(found.left) < abs(best[1].left):
            best, stalled = (x, found), 0
        else:
            stalled += 1
        if abs(found.left) <= tolerance * found.scale:
            return x, found
        step = secants.step(x, found)
        good = abs(best[1].left) <= _LIGHT * best[1].scale
        if abs(step) <= rounded or secants.jumps or (good and stalled >= _STALLED):
            break
        x += step
    assert best is not None
    if abs(best[1].left) <= _LIGHT * best[1].scale:
        return best
    nowhere = secants.runs_away or secants.jumps
    return x, code.NO_STEADY_STATE if nowhere else code.NOT_CONVERGED


def failed_status(states: Sequence[SolvedBearing]) -> int:
    """Why there is no balance: a side that alone lost its contact has lifted off."""
    failed = [state.status for state in states if state.status not in USABLE]
    if not failed:
        return code.OK
    if len(failed) < len(states) and failed[0] in GONE:
        return code.LIFTED_OFF
    return failed[0]
