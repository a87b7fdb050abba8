"""Whether the bearings of a rotor gap or dent at launch, in sentences."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from bearingwear.results.units import digits
from bearingwear.solvers.bearing.launch import Launched

_UM, _GPA = 1e6, 1e-9
_SHOWN = 2  # states of one case: new and worn


def launch_gap(one: Launched) -> float:
    return one.gap


def denting_share(one: Launched) -> float:
    return one.pressure_share


def worst_state(found: Mapping[str, Launched], value_of: Callable[[Launched], float]) -> str:
    return max(found, key=lambda words: value_of(found[words]))


def launch_verdict(found: Mapping[str, Launched]) -> list[str]:
    """Whether it gaps and whether it dents in any state, in sentences that name the state."""
    worst = worst_state(found, launch_gap)
    state = f", {worst}" if len(found) > 1 else ""
    said = [
        f"{load.name}{state}: the spring does not support the rotor; increase the spring force, or "
        "add a stop (arrangement.stop_um)"
        for load in found[worst].loads
        if load.rotor is None
    ]
    opened = [
        (max(bearing.gap, bearing.past), k + 1, load.name, bearing.past > 0.0)
        for load in found[worst].loads
        if load.rotor is not None
        for k, bearing in enumerate(load.rotor.bearings)
        if bearing.is_open
    ]
    if opened:
        gap, k, name, is_past = max(opened)
        said.append(f"bearing {k} gaps by {digits(_UM * gap)} um, {name}{state}")
        if is_past:
            said.append(
                f"bearing {k} passes its gap onto the other side of its grooves, {name}: add "
                "a stop (arrangement.stop_um)"
            )
    elif found[worst].loads and not said:
        states = " and ".join(dict.fromkeys(words.partition(" (")[0] for words in found))
        states += ", in every case" if len(found) > _SHOWN else ""
        said.append(f"no gap: every bearing remains loaded, {states}")
    worst = worst_state(found, denting_share)
    one, state = found[worst], f", {worst}" if len(found) > 1 else ""
    if one.loads:
        share = 100.0 * one.pressure_share
        verb = "dents" if share > 100.0 else "no dents"
        said.append(
            f"{verb}: the peak pressure is {digits(share)} % of "
            f"{digits(_GPA * one.pressure)} GPa, {one.source}{state}"
        )
    return said
