"""The balance of a rotor between two bearings: a root in its place."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from bearingwear.kernels import status as code
from bearingwear.model.thermal import Warmed

ROTOR_BALANCED = 1e-12  # force left on the rotor, over the larger one, where its place is found
_MOST_STEPS = 30
_STEEPER = 1e3  # a secant within this of the slope at held orbits is believed
_STALLED = 3  # trials without gain after which it is rounding that is left, where that is
_LIGHT = 1e-5  # of the forces at the most
GONE = (code.CONTACT_LOST, code.PRELOAD_GONE)
USABLE = (code.OK, code.UNVERIFIED)


@dataclass(frozen=True)
class SideState:
    """One bearing at a place or under a force."""

    status: int
    force: float = math.nan  # axial, of its inner race on the balls [N]
    stiffness: float = math.nan  # axial [N/m]
    place: float = math.nan  # axial displacement [m]
    problem: Any = None  # that was solved
    answer: Any = None
    warmed: Warmed | None = None  # where a network finds the temperatures


@dataclass(frozen=True)
class RotorTrial:
    """Both bearings at a place of the rotor, and what is left of its balance."""

    states: tuple[SideState, SideState]
    left: float  # [N]
    slope: float  # of `left`, about [N/m]
    scale: float  # of the forces [N]


def balanced(
    trial: Callable[[float], RotorTrial | int], x: float, rounded: float
) -> tuple[float, RotorTrial | int]:
    """Where nothing is left: Newton's method with the slope of a trial, then secants.

    Light loads round before they are balanced; the check afterwards knows by how much.

    Parameters
    ----------
    trial : callable
        Of a place [m]; or a status.
    x : float
        The start [m].
    rounded : float
        Step that changes nothing [m].

    Returns
    -------
    x, found
        The place, and the trial there or the status of what failed.
    """
    before: tuple[float, float] | None = None
    best, stalled = None, 0
    for _ in range(_MOST_STEPS):
        found = trial(x)
        if isinstance(found, int):
            return x, found
        if any(state.status not in USABLE for state in found.states):
            return x, failed_status(found.states)
        left, slope = found.left, found.slope
        if before is not None and x != before[0] and abs(left) < abs(before[1]):
            secant = (left - before[1]) / (x - before[0])
            slope = secant if slope / _STEEPER < secant < _STEEPER * slope else slope
        better = best is None or abs(left) < abs(best[1].left)
        best, stalled = ((x, found), 0) if better else (best, stalled + 1)
        if abs(left) <= ROTOR_BALANCED * found.scale:
            return x, found
        before, step = (x, left), -left / slope
        if abs(step) <= rounded or stalled >= _STALLED:
            break
        x += step
    assert best is not None
    if abs(best[1].left) > _LIGHT * best[1].scale:
        return x, code.NOT_CONVERGED
    return best


def worse_status(states: Sequence[SideState]) -> int:
    return next((state.status for state in states if state.status != code.OK), code.OK)


def failed_status(states: Sequence[SideState]) -> int:
    """Why there is no balance: a side that alone has lost its contact has lifted off."""
    failed = [state.status for state in states if state.status not in USABLE]
    if len(failed) < len(states) and failed[0] in GONE:
        return code.LIFTED_OFF
    return failed[0]
