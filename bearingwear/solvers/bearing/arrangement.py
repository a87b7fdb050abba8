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
"""Turns displacements and tilts into the frame of the second bearing, which faces the other way."""

SLENDER = 1.0 / 12.0
"""Transverse moment of inertia of a slender rod, assumed, over mass and span squared."""

KG_MM2 = 1e-6
N_UM = 1e6  # [N/m]
_PLANE = 2, 3  # displacement along Z and tilt about Y


def rotor_stiffness(a: Arrangement, sides: np.ndarray) -> np.ndarray:
    """Returns the stiffness (5, 5) of the rotor about the midpoint of its bearings [N/m, N, N m].

    Rows and columns: displacements along X, Y and Z, tilts about Y and Z. The rotor has a span.

    sides: stiffness of each bearing in its own frame (2, 5, 5), all of a tandem together.
    """
    assert a.span_mm is not None
    # Side of the midpoint on which the first bearing sits, -1 towards -X. Its contact lines meet
    # the axis on its -X side.
    outwards = -1.0 if a.orientation == "back_to_back" else 1.0
    K = np.zeros((5, 5))
    for K_side, mirror, end in zip(sides, (np.eye(5), MIRROR), (outwards, -outwards), strict=True):
        lever = np.eye(5)
        lever[1, 4], lever[2, 3] = 0.5 * end * a.span_mm * MM, -0.5 * end * a.span_mm * MM
        T = mirror @ lever
        K += T.T @ K_side @ T
    return K


def natural_frequencies(a: Arrangement, sides: np.ndarray, axial: float) -> np.ndarray | None:
    """Returns axial, radial and conical frequency (3,) of a rotor that is not turning [Hz].

    None without mass or span, or where a stiffness across the axis is not finite. Gyroscopic
    moments of the rotor and its bending are left out. Of the two motions in a plane, the one with
    more translation is called radial, the other conical.

    sides: stiffness of each bearing in its own frame (2, 5, 5).
    axial: stiffness of the arrangement, including its spring [N/m].
    """
    if a.rotor_mass_kg is None or a.span_mm is None:
        return None
    K = rotor_stiffness(a, sides)[np.ix_(_PLANE, _PLANE)]
    if not np.isfinite(K).all():  # the stiffness of a worn bearing is not always known
        return None
    return plane_frequencies(a, axial, K)


def plane_frequencies(a: Arrangement, axial: float, K: np.ndarray) -> np.ndarray:
    """Returns axial, radial and conical frequency (3,) of a rotor that is not turning [Hz].

    The rotor of the arrangement has mass and span. The motion with more kinetic energy of
    translation is called radial. 0 for a motion whose stiffness is not positive.

    axial: stiffness of the arrangement [N/m].
    K: stiffness against displacement along Z and tilt about Y, of the middle (2, 2) [N/m, N, N m].
    """
    assert a.rotor_mass_kg is not None and a.span_mm is not None
    m = a.rotor_mass_kg
    offset = a.rotor_offset_mm * MM
    given_inertia = a.rotor_transverse_inertia_kg_mm2
    inertia = (
        SLENDER * m * (a.span_mm * MM) ** 2 if given_inertia is None else given_inertia * KG_MM2
    )
    M = np.array([[m, -m * offset], [-m * offset, inertia + m * offset * offset]])
    from scipy.linalg import eigh  # loads slowly; few rotors have mass and span

    plane_rates, modes = eigh(K, M)
    radial = int(np.argmax(m * (modes[0] - offset * modes[1]) ** 2))
    squared_rates = np.array([axial / m, plane_rates[radial], plane_rates[1 - radial]])
    # a stiffness that falls makes no oscillation
    return np.sqrt(np.maximum(squared_rates, 0.0)) / (2.0 * math.pi)


def lowest_frequency(scene: Scene, states: Sequence[State]) -> float:
    """Returns the lowest natural frequency of the rotor in a state of a life [Hz].

    NaN without mass or span, or where the stiffness is not known. The axial stiffness is that of
    the states, maybe with worn grooves; the others follow from it by the ratios of Hertz' contacts
    without friction (assumed).

    states: of both bearings, also where the scene has one, as half of a symmetric pair.
    """
    a = scene.arrangement
    if a is None or a.rotor_mass_kg is None or a.span_mm is None:
        return math.nan
    sides = []
    scenes = scene.sides if len(scene.sides) == 2 else scene.sides * 2
    for n, side, state in zip(a.tandem, scenes, states, strict=True):
        g = mounted_geometry(side)
        D = np.array([g.D0 - state.loss])
        load = state["contact_load"]
        angle = state["contact_angle"]
        K = stiffness_of_loads(g, D, load, angle)
        # n bearings in tandem, scaled to the axial stiffness of the state
        sides.append(n * state["axial_stiffness"] / K[0, 0] * K)
    frequencies = natural_frequencies(a, np.array(sides), states[0]["system_axial_stiffness"])
    return math.nan if frequencies is None else float(frequencies.min())


def rotor_balance(
    scene: Scene, mounted: Sequence[float], sides: Sequence[Mapping[str, Any]]
) -> float:
    """Returns the residual of the rotor's axial balance over the larger force of a side [1].

    The residual is the larger of two forces, computed from the results alone. One is unbalanced on
    the rotor. The other is the error of the bearings' distance times the larger stiffness (rigid
    pair), or the second side's force less that of the extended spring.

    mounted: axial displacements of both bearings at mounting [m].
    sides: result variables of both bearings.
    """
    a = scene.pair
    assert a is not None
    tandem = np.array(a.tandem)
    F = tandem * np.array([float(side["residual_preload"]) for side in sides])
    displaced = np.array([float(side["axial_displacement"]) for side in sides]) - mounted
    unbalanced = [abs(F[0] - F[1] - a.external_axial_N)]
    if a.kind == "rigid_pair":
        k = tandem * np.array([float(side["axial_stiffness"]) for side in sides])
        unbalanced.append(abs(displaced.sum()) * k.max())
    else:
        spring_force = scene.operation.preload_N - a.spring_stiffness_N_um * N_UM * displaced.sum()
        unbalanced.append(abs(F[1] - spring_force))
    return float(max(unbalanced) / F.max())


def stacked_sides(sides: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Returns the result variables of both bearings, stacked along a first dimension.

    Where one has fewer values, or lacks a variable, NaN fills its floats and -1 its whole numbers.

    sides: result variables of each bearing; the status is left out.
    """
    names = dict.fromkeys(name for side in sides for name in side if name != "status")
    return {name: _stacked([side.get(name) for side in sides]) for name in names}


def _stacked(values: Sequence[Any]) -> np.ndarray:
    """Returns the values of both bearings as one array, filled as in `stacked_sides`.

    values: of each bearing; None where it has none.
    """
    arrays = [np.asarray(value) for value in values if value is not None]
    shapes = {array.shape for array in arrays}
    if len(arrays) == len(values) and len(shapes) == 1:
        return np.array(values)
    shape = np.max(list(shapes), axis=0).astype(int)
    are_whole = all(array.dtype.kind in "iub" for array in arrays)
    stacked = np.full((len(values), *shape), -1 if are_whole else np.nan)
    for k, value in enumerate(values):
        if value is not None:
            place: tuple[Any, ...] = (k, *(slice(n) for n in np.shape(value)))
            stacked[place] = value
    return stacked


def joined_attributes(sides: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Returns the attributes of a pair: sentences joined, numbers added, sorted by their names.

    A bearing that lacks an attribute is left out of its sentence or sum.

    sides: attributes of each bearing.
    """
    joined: dict[str, Any] = {}
    for name in sides[0].keys() | sides[1].keys():
        values = [attrs.get(name) for attrs in sides]
        if any(isinstance(value, str) for value in values):
            joined[name] = "; ".join(
                f"bearing {k}: {value}" for k, value in enumerate(values, 1) if value is not None
            )
        else:
            joined[name] = sum(value for value in values if value is not None)
    return dict(sorted(joined.items()))
