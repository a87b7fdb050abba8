"""Whether the bearings of a rotor gap or dent at launch, in sentences."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from bearingwear.results.units import digits
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.launch import LaunchLoad, LaunchResult

_UM, _GPA = 1e6, 1e-9
NEW_AND_WORN = 2
"""Number of states of a case."""

SOFT_PAIR_GAPS = (
    "a spring-loaded pair that gaps strikes back: its loads may be 2 to 4 times those of three "
    "sigma, as measured (docs/launch.md)"
)


def state_suffix(state: str, states: Mapping[str, LaunchResult]) -> str:
    """Returns the name of a state after a comma; empty if it is the only state.

    states: all results, by the name of their state.
    """
    return f", {state}" if len(states) > 1 else ""


def state_of_largest_gap(states: Mapping[str, LaunchResult]) -> str:
    """Returns the name of the state in which a bearing gaps most; the first if none gaps."""
    return max(states, key=lambda state: states[state].gap)


def state_of_largest_pressure(states: Mapping[str, LaunchResult]) -> str:
    """Returns the name of the state with the largest ratio of peak pressure to denting pressure."""
    return max(states, key=lambda state: states[state].pressure_share)


def launch_verdict(scene: Scene, states: Mapping[str, LaunchResult]) -> list[str]:
    """Returns sentences that state whether a bearing gaps or dents, and in which state of wear.

    states: results by the name of the state.
    """
    return _gap_sentences(states) + _dent_sentences(states) + _soft_pair_sentences(scene, states)


def _soft_pair_sentences(scene: Scene, states: Mapping[str, LaunchResult]) -> list[str]:
    """Warns that a spring-loaded pair that gaps has higher loads than any computed at rest.

    Empty for any other pair, and if no bearing gaps in any state.
    """
    has_spring = scene.operation.preload_method == "constant_force"
    is_open = any(state.gap for state in states.values())
    return [SOFT_PAIR_GAPS] if has_spring and is_open else []


class _OpenBearing(NamedTuple):
    """A bearing that gaps under a load; the order of the fields makes the largest gap the `max`."""

    gap: float  # [m]
    number: int  # 1 or 2
    load: str  # name of the load
    leaves_its_groove: bool


def _open_bearings(loads: Sequence[LaunchLoad]) -> list[_OpenBearing]:
    """Returns every bearing that gaps, under every load that the spring supports."""
    return [
        _OpenBearing(
            gap=max(bearing.gap, bearing.past),
            number=k + 1,
            load=load.name,
            leaves_its_groove=bearing.past > 0.0,
        )
        for load in loads
        if load.rotor is not None
        for k, bearing in enumerate(load.rotor.bearings)
        if bearing.is_open
    ]


def _gap_sentences(states: Mapping[str, LaunchResult]) -> list[str]:
    """States the largest gap of a bearing, in the worst state, or that no bearing gaps.

    Each load that the spring does not support in that state has a sentence, too.
    """
    worst = state_of_largest_gap(states)
    loads, suffix = states[worst].loads, state_suffix(worst, states)
    sentences = [
        f"{load.name}{suffix}: the spring does not support the rotor; increase the spring force, "
        "or add a stop (arrangement.stop_um)"
        for load in loads
        if load.rotor is None
    ]
    open_bearings = _open_bearings(loads)
    if open_bearings:
        widest = max(open_bearings)
        gap_um = digits(_UM * widest.gap)
        sentences.append(f"bearing {widest.number} gaps by {gap_um} um, {widest.load}{suffix}")
        if widest.leaves_its_groove:
            sentences.append(
                f"bearing {widest.number} passes its gap onto the other side of its grooves, "
                f"{widest.load}: add a stop (arrangement.stop_um)"
            )
    elif loads and not sentences:
        names = " and ".join(dict.fromkeys(state.partition(" (")[0] for state in states))
        names += ", in every case" if len(states) > NEW_AND_WORN else ""
        sentences.append(f"no gap: every bearing remains loaded, {names}")
    return sentences


def _dent_sentences(states: Mapping[str, LaunchResult]) -> list[str]:
    """States the largest peak pressure as a share of the denting pressure; empty without loads."""
    worst = state_of_largest_pressure(states)
    state = states[worst]
    if not state.loads:
        return []
    percent = 100.0 * state.pressure_share
    verdict = "dents" if percent > 100.0 else "no dents"
    return [
        f"{verdict}: the peak pressure is {digits(percent)} % of "
        f"{digits(_GPA * state.pressure)} GPa, {state.source}{state_suffix(worst, states)}"
    ]
