"""A case of two bearings: values of each side, of the arrangement, and the check of the rotor."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.thrust import LARGEST_RESIDUAL
from bearingwear.model.growth_told import growth_values
from bearingwear.model.heat import network_values
from bearingwear.model.pair import N_UM, Pair, PairState, warm_scene
from bearingwear.model.pair_balance import USABLE
from bearingwear.model.rotor import natural_frequencies
from bearingwear.scene.scene import Scene
from bearingwear.scene.warmth import Temperature

_MOST_BALANCES = 3

Solved = tuple[tuple[dict, dict], ...]
"""Values and attributes of each bearing."""


def solve_pair(
    scene: Scene, fidelity: str, alike: tuple[dict, dict] | None = None
) -> tuple[dict, dict]:
    """Values and attributes of a scene of two bearings, those of each along `bearing`.

    `alike` is the single bearing solved, which is each side of a symmetric pair.
    """
    pair = Pair.of(scene, fidelity)
    state, solved = _balanced(pair, fidelity) if alike is None else _symmetric(scene, pair, alike)
    if not solved:
        return {"status": state.status}, {"residual": "not solved"}
    each = [values for values, _ in solved]
    values = stacked_sides(each)
    values |= system_values(scene, pair, state, each)
    values["status"] = _status(state, each, values["rotor_balance_residual"])
    return values, _attributes([attrs for _, attrs in solved])


def _balanced(pair: Pair, fidelity: str) -> tuple[PairState, Solved]:
    """Two bearings that differ, or under a force.

    A case may take a stable steady state instead of the one that was balanced. The rotor is then
    balanced again from that motion.
    """
    for _ in range(_MOST_BALANCES):
        state = pair.solve(pair.losses)
        if state.status not in USABLE:
            return state, ()
        solved, moved = [], False
        for side, one in zip(pair.sides, state.sides, strict=True):
            values, attrs = side.values(one)
            moved |= side.starts_from(one, values)
            if one.warmed is not None:
                values = values | network_values(side.scene, one.warmed, values, fidelity)
            solved.append((values | growth_values(warm_scene(side.scene, one)), attrs))
        if not moved:
            break
    return state, tuple(solved)


def _symmetric(scene: Scene, pair: Pair, alike: tuple[dict, dict]) -> tuple[PairState, Solved]:
    """Two identical bearings without any other force: each is the single bearing."""
    values, a = alike[0], scene.pair
    assert a is not None
    if "axial_stiffness" not in values:
        return PairState(values["status"]), ()
    if scene.thermal is not None:  # what the arrangement is, is that of the warm bearings
        pair.sides = [type(pair.sides[0])(_warm(side.scene, values)) for side in pair.sides]  # type: ignore[call-arg]
    rigid = a.kind == "rigid_pair"
    shift = 0.0 if rigid else float(values["axial_displacement"]) - pair.sides[0].mounted
    dynamic, quasistatic = (
        (2.0 if rigid else 1.0) * float(values[name])
        for name in ("axial_stiffness", "quasistatic_axial_stiffness")
    )
    return PairState(values["status"], (), shift, dynamic, quasistatic), (alike, alike)


def _warm(scene: Scene, values: Mapping[str, Any]) -> Scene:
    """A scene with a network, with the temperatures that a result has found."""
    assert scene.thermal is not None
    names = ("inner_ring_C", "balls_C", "outer_ring_C", "shaft_C", "housing_C")
    found = dict(zip(names, map(float, values["part_temperature"]), strict=True))
    t = Temperature(**found, reference_C=scene.thermal.reference_C)
    return replace(scene, temperature=t, thermal=None)


def system_values(
    scene: Scene, pair: Pair, state: PairState, each: Sequence[Mapping[str, Any]]
) -> dict:
    """Values of the arrangement of both bearings."""
    a = scene.pair
    assert a is not None
    values: dict[str, Any] = {
        **state.of_arrangement,
        "lift_off_force": pair.lift_off(pair.losses),
        "rotor_balance_residual": rotor_balance(scene, pair, each),
    }
    if "stiffness_matrix" in each[0]:
        K = np.array([n * side["stiffness_matrix"] for n, side in zip(a.tandem, each, strict=True)])
        found = natural_frequencies(a, K, state.stiffness)
        if found is not None:
            values["natural_frequency"] = found
    return values


def rotor_balance(scene: Scene, pair: Pair, each: Sequence[Mapping[str, Any]]) -> float:
    """Residual of the rotor's balance by places and forces of both, over the preload [1].

    From their results alone: the force on the rotor, and by the stiffness what lacks of the
    distance of the bearings, or of the extension of the spring.
    """
    a = scene.pair
    assert a is not None
    tandem = np.array(a.tandem)
    F = tandem * np.array([float(side["residual_preload"]) for side in each])
    moved = np.array(
        [
            float(values["axial_displacement"]) - side.mounted
            for values, side in zip(each, pair.sides, strict=True)
        ]
    )
    left = [abs(F[0] - F[1] - a.external_axial_N)]
    if a.kind == "rigid_pair":
        k = tandem * np.array([float(side["axial_stiffness"]) for side in each])
        left.append(abs(moved.sum()) * k.max())
    else:
        given = scene.operation.preload_N - a.spring_stiffness_N_um * N_UM * moved.sum()
        left.append(abs(F[1] - given))
    return float(max(left) / F.max())


def _status(state: PairState, each: Sequence[Mapping[str, Any]], residual: float) -> int:
    for status in (state.status, *(int(side["status"]) for side in each)):
        if status != code.OK:
            return status
    rounding = max(float(side.get("equilibrium_rounding", 0.0)) for side in each)
    allowed = max(LARGEST_RESIDUAL, min(rounding, 1e-5))
    return code.OK if residual <= allowed else code.UNVERIFIED


def stacked_sides(each: Sequence[Mapping[str, Any]]) -> dict:
    """Values of both bearings along a first dimension; NaN and -1 where one has fewer of them."""
    names = dict.fromkeys(name for side in each for name in side if name != "status")
    made = {}
    for name in names:
        found = [side.get(name) for side in each]
        known = [np.shape(one) for one in found if one is not None]
        alike = len(known) == len(found) and len(set(known)) == 1
        made[name] = np.array(found) if alike else _filled(found)
    return made


def _filled(found: Sequence[Any]) -> np.ndarray:
    """Arrays of unlike shapes along a first dimension."""
    known = [np.asarray(one) for one in found if one is not None]
    shape = np.max([one.shape for one in known], axis=0).astype(int)
    whole = all(one.dtype.kind in "iub" for one in known)
    filled = np.full((len(found), *shape), -1 if whole else np.nan)
    for k, one in enumerate(found):
        if one is not None:
            place: tuple[Any, ...] = (k, *(slice(n) for n in np.shape(one)))
            filled[place] = one
    return filled


def _attributes(each: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Attributes of both: sentences one after the other, counts added."""
    made: dict[str, Any] = {}
    for name in each[0].keys() | each[1].keys():
        both = [attrs.get(name) for attrs in each]
        if any(isinstance(one, str) for one in both):
            told = enumerate(both, 1)
            made[name] = "; ".join(f"bearing {k}: {one}" for k, one in told if one is not None)
        else:
            made[name] = sum(one for one in both if one is not None)
    return dict(sorted(made.items()))
