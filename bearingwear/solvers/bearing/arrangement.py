"""A rigid rotor on two bearings: its stiffness, frequencies, lift-off and balance."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from bearingwear.scene.scene import Arrangement, Scene
from bearingwear.solvers.bearing.mounted import MM, mounted_geometry
from bearingwear.solvers.bearing.outputs import stiffness_of_loads
from bearingwear.solvers.state import State

MIRROR = np.diag([-1.0, 1.0, 1.0, -1.0, -1.0])
"""Displacements and tilts of the second bearing, which faces the other way, as its own."""

SLENDER = 1.0 / 12.0
"""Transverse moment of inertia over mass and span squared of a slender rod, assumed."""

KG_MM2 = 1e-6
N_UM = 1e6  # in N/m
_PLANE = 2, 3


def rotor_stiffness(a: Arrangement, sides: np.ndarray) -> np.ndarray:
    """Stiffness (5, 5) of the rotor about the middle between its bearings [N/m, N, N m].

    From that of each bearing in its own frame (2, 5, 5).
    """
    assert a.span_mm is not None
    # Contact lines of the first bearing meet the axis on its -X side.
    outwards = -1.0 if a.orientation == "back_to_back" else 1.0
    K = np.zeros((5, 5))
    for own, mirror, end in zip(sides, (np.eye(5), MIRROR), (outwards, -outwards), strict=True):
        lever = np.eye(5)
        lever[1, 4], lever[2, 3] = 0.5 * end * a.span_mm * MM, -0.5 * end * a.span_mm * MM
        T = mirror @ lever
        K += T.T @ own @ T
    return K


def natural_frequencies(a: Arrangement, sides: np.ndarray, axial: float) -> np.ndarray | None:
    """Axial, radial and conical frequency (3,) of a rotor that is not turning [Hz].

    None without mass or span. From the stiffness of each bearing in its own frame (2, 5, 5), and
    the axial one of the arrangement, whose spring gives way where a bearing does not [N/m].
    Gyroscopic moments of the rotor and its bending are left out. Radial and conical motion in one
    plane are those of the larger and the smaller share of translation.
    """
    if a.rotor_mass_kg is None or a.span_mm is None:
        return None
    K = rotor_stiffness(a, sides)[np.ix_(_PLANE, _PLANE)]
    if not np.isfinite(K).all():  # the stiffness of a worn bearing is not always known
        return None
    return plane_frequencies(a, axial, K)


def plane_frequencies(a: Arrangement, axial: float, K: np.ndarray) -> np.ndarray:
    """`natural_frequencies` from the stiffness (2, 2) against Z and tilt about the middle [Hz]."""
    assert a.rotor_mass_kg is not None and a.span_mm is not None
    m, offset, given = a.rotor_mass_kg, a.rotor_offset_mm * MM, a.rotor_transverse_inertia_kg_mm2
    inertia = SLENDER * m * (a.span_mm * MM) ** 2 if given is None else given * KG_MM2
    M = np.array([[m, -m * offset], [-m * offset, inertia + m * offset * offset]])
    from scipy.linalg import eigh  # loads slowly; few rotors have mass and span

    squares, modes = eigh(K, M)
    radial = int(np.argmax(m * (modes[0] - offset * modes[1]) ** 2))
    found = np.array([axial / m, squares[radial], squares[1 - radial]])
    return np.sqrt(np.maximum(found, 0.0)) / (2.0 * math.pi)


def lowest_frequency(scene: Scene, states: Sequence[State]) -> float:
    """Lowest natural frequency of the rotor in a state of a life; NaN without mass and span [Hz].

    A single bearing is half of a symmetric pair, and there are two states. The stiffness in other
    directions goes with the axial one, which may be that of worn grooves, as it does with Hertz'
    contacts (assumed).
    """
    a = scene.arrangement
    if a is None or a.rotor_mass_kg is None or a.span_mm is None:
        return math.nan
    each = []
    for n, side, state in zip(a.tandem, (scene.sides * 2)[:2], states, strict=True):
        g = mounted_geometry(side)
        D, load, angle = (
            np.array([g.D0 - state.loss]),
            state["contact_load"],
            state["contact_angle"],
        )
        K = stiffness_of_loads(g, D, load, angle)
        each.append(n * state["axial_stiffness"] / K[0, 0] * K)
    found = natural_frequencies(a, np.array(each), states[0]["system_axial_stiffness"])
    return math.nan if found is None else float(found.min())


def rotor_balance(
    scene: Scene, mounted: Sequence[float], each: Sequence[Mapping[str, Any]]
) -> float:
    """Residual of the rotor's balance by places and forces of both, over the preload [1].

    From their results alone: the force on the rotor, and by the stiffness what lacks of the
    distance of the bearings, or of the extension of the spring.
    """
    a = scene.pair
    assert a is not None
    tandem = np.array(a.tandem)
    F = tandem * np.array([float(side["residual_preload"]) for side in each])
    moved = np.array([float(side["axial_displacement"]) for side in each]) - mounted
    left = [abs(F[0] - F[1] - a.external_axial_N)]
    if a.kind == "rigid_pair":
        k = tandem * np.array([float(side["axial_stiffness"]) for side in each])
        left.append(abs(moved.sum()) * k.max())
    else:
        given = scene.operation.preload_N - a.spring_stiffness_N_um * N_UM * moved.sum()
        left.append(abs(F[1] - given))
    return float(max(left) / F.max())


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
    known = [np.asarray(one) for one in found if one is not None]
    shape = np.max([one.shape for one in known], axis=0).astype(int)
    whole = all(one.dtype.kind in "iub" for one in known)
    filled = np.full((len(found), *shape), -1 if whole else np.nan)
    for k, one in enumerate(found):
        if one is not None:
            place: tuple[Any, ...] = (k, *(slice(n) for n in np.shape(one)))
            filled[place] = one
    return filled


def joined_attributes(each: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Attributes of both: sentences one after the other, counts added."""
    made: dict[str, Any] = {}
    for name in each[0].keys() | each[1].keys():
        values = [attrs.get(name) for attrs in each]
        if any(isinstance(one, str) for one in values):
            each_one = enumerate(values, 1)
            made[name] = "; ".join(f"bearing {k}: {one}" for k, one in each_one if one is not None)
        else:
            made[name] = sum(one for one in values if one is not None)
    return dict(sorted(made.items()))
