"""The balance of a rotor between two bearings, solved for its place."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.solvers.condition import USABLE, SolvedBearing

ROTOR_BALANCED = 1e-12  # unbalanced force on the rotor, over the larger one
_MOST_STEPS = 40
_STEEPER = 1e3  # factor between a secant and the slope of a trial up to which it is used
_FASTER = 2.0  # factor on the steps of a rotor that runs away
_NARROW = 1e-9  # of a place: a range in which a change of the force is a jump
_STALLED = 3  # trials without gain after which a small force counts as rounding
_LIGHT = 1e-5  # largest share of the forces that may be rounding
GONE = (code.CONTACT_LOST, code.PRELOAD_GONE)


@dataclass(frozen=True)
class RotorTrial:
    """Both bearings at a place of the rotor, and the unbalanced force there."""

    states: tuple[SolvedBearing, SolvedBearing]
    unbalanced: float  # force [N]
    slope: float  # of the unbalanced force, about [N/m]
    scale: float  # of the forces [N]


@dataclass
class Nearby:
    """Start values from earlier balances."""

    steeper: float = 1.0  # slope of the unbalanced force over that of a trial
    place: float = math.nan  # last place of balance [m]
    losses: np.ndarray = field(default_factory=lambda: np.zeros(2))  # at that place [m]
    rough: tuple[np.ndarray, float] | None = None  # losses and rough place since then [m]
    slope: np.ndarray = field(default_factory=lambda: np.zeros(2))  # of the place by the losses

    @property
    def last(self) -> tuple[np.ndarray, float]:
        """Returns the last losses and place, rough or not [m]."""
        return self.rough or (self.losses, self.place)

    @property
    def has_place(self) -> bool:
        """Returns whether a place is known from an earlier balance."""
        _, place = self.last
        return not math.isnan(place)

    def expected_place(self, losses: tuple[float, float]) -> float:
        """Returns the place of balance to expect at losses [m]."""
        losses_there, place = self.last
        return place + float(self.slope @ (losses - losses_there))

    def remember(self, losses: tuple[float, float], place: float) -> None:
        """Stores an exact place of balance [m] at losses [m], and drops a rough one.

        The slope of the place by the losses is corrected by Broyden's rule.
        """
        self.rough = None
        moved = losses - self.losses
        if not math.isnan(self.place) and moved.any():
            self.slope += (place - self.expected_place(losses)) / (moved @ moved) * moved
        self.losses = np.array(losses)
        self.place = place

    def remember_rough(self, losses: tuple[float, float], place: float) -> None:
        """Stores a rough place of balance [m] at losses [m], without its slope.

        So close to an exact place, its error would distort the slope.
        """
        self.rough = np.array(losses), place

    def forget(self) -> None:
        """Drops slopes and the rough place, but keeps the last exact one with its losses.

        A slope found over a short distance may be far off.
        """
        self.steeper = 1.0
        self.slope = np.zeros(2)
        self.rough = None


@dataclass
class _Secants:
    """Steps of the rotor towards its balance.

    The unbalanced force rises with the position of a rotor that stays. Where it falls, the rotor
    runs away, and its steps become longer.
    """

    nearby: Nearby
    runs_away: bool = False
    last_trial: tuple[float, float] | None = None  # its place [m] and its unbalanced force [N]
    low: float = -math.inf  # nearest place where the unbalanced force is negative [m]
    high: float = math.inf  # nearest place where it is positive [m]

    @property
    def jumps(self) -> bool:
        """Returns whether the unbalanced force changes its sign without a root in between."""
        largest = max(abs(self.low), abs(self.high))
        return math.isfinite(largest) and 0.0 <= self.high - self.low <= _NARROW * largest

    def step(self, x: float, trial: RotorTrial) -> float:
        """Returns the next step of the rotor [m], from a trial at a place `x` [m].

        Sets the fields from that trial, and `nearby.steeper`. Between two places of opposite signs,
        a step that would leave them is replaced by one to their middle.
        """
        unbalanced = trial.unbalanced
        slope = self.nearby.steeper * trial.slope
        if self.last_trial is not None and x != self.last_trial[0]:
            last_x, last_unbalanced = self.last_trial
            secant = (unbalanced - last_unbalanced) / (x - last_x)
            is_nearer = abs(unbalanced) < abs(last_unbalanced)
            changes_sign = unbalanced * last_unbalanced < 0.0
            self.runs_away = secant < 0.0 and not is_nearer
            if is_nearer or changes_sign:
                is_credible = trial.slope / _STEEPER < secant < _STEEPER * trial.slope
                slope = secant if is_credible else trial.slope
        self.nearby.steeper = slope / trial.slope
        self.last_trial = x, unbalanced
        if unbalanced > 0.0:
            self.high = x
        else:
            self.low = x
        if self.runs_away:
            return -_FASTER * unbalanced / trial.slope
        step = -unbalanced / slope
        if self.low < self.high and not self.low < x + step < self.high:
            return 0.5 * (self.low + self.high) - x
        return step


def balanced_place(
    trial_at: Callable[[float], RotorTrial | int],
    x: float,
    rounded: float,
    nearby: Nearby,
    tolerance: float = ROTOR_BALANCED,
) -> tuple[float, RotorTrial | int]:
    """Returns the place of balance [m], and the trial there or the status of the failure.

    The place is found by Newton's method with the slope of a trial, then by secants. Light loads
    reach rounding before they balance: where steps no longer help, the best trial counts if its
    unbalanced force is below `_LIGHT` of the forces. The caller's check says by how much it is off.

    On failure the place is the last one tried. The status is NO_STEADY_STATE where the rotor runs
    away or its force jumps past zero, that of a trial that failed, or NOT_CONVERGED.

    trial_at: returns the trial at a place [m], or the status (an int) where there is none.
    x: place to begin with [m].
    rounded: step that changes nothing [m].
    nearby: its `steeper` scales the slope of the first step, and is renewed here.
    tolerance: unbalanced force over `RotorTrial.scale`.
    """
    secants = _Secants(nearby)
    stalled = 0
    best: RotorTrial | None = None
    best_x = x
    for _ in range(_MOST_STEPS):
        trial = trial_at(x)
        status = trial if isinstance(trial, int) else failed_status(trial.states)
        if isinstance(trial, int) or status != code.OK:
            return x, code.NO_STEADY_STATE if secants.runs_away else status
        if best is None or abs(trial.unbalanced) < abs(best.unbalanced):
            best_x = x
            best = trial
            stalled = 0
        else:
            stalled += 1
        if abs(trial.unbalanced) <= tolerance * trial.scale:
            return x, trial
        step = secants.step(x, trial)
        is_light = abs(best.unbalanced) <= _LIGHT * best.scale
        if abs(step) <= rounded or secants.jumps or (is_light and stalled >= _STALLED):
            break
        x += step
    assert best is not None
    if abs(best.unbalanced) <= _LIGHT * best.scale:
        return best_x, best
    has_no_place = secants.runs_away or secants.jumps
    return x, code.NO_STEADY_STATE if has_no_place else code.NOT_CONVERGED


def failed_status(states: Sequence[SolvedBearing]) -> int:
    """Returns the status of two solved bearings: OK if both are usable, else why not.

    LIFTED_OFF if one alone has failed, by a lost contact or preload; else that of the first failed.
    """
    failed = [state.status for state in states if state.status not in USABLE]
    if not failed:
        return code.OK
    if len(failed) < len(states) and failed[0] in GONE:
        return code.LIFTED_OFF
    return failed[0]
