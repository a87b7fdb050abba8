"""A rigid rotor on the two bearings of a pair: its stiffness and natural frequencies."""

import math
from collections.abc import Sequence

import numpy as np
from scipy.linalg import eigh

from bearingwear.model.mounted import MM, mounted_geometry
from bearingwear.model.outputs import stiffness_of_loads
from bearingwear.model.state import State
from bearingwear.scene.scene import Arrangement, Scene

MIRROR = np.diag([-1.0, 1.0, 1.0, -1.0, -1.0])
"""Displacements and tilts of the second bearing, which faces the other way, as its own."""

SLENDER = 1.0 / 12.0
"""Transverse moment of inertia over mass and span squared of a slender rod, assumed."""

KG_MM2 = 1e-6
_AXIAL, _PLANE = 0, (2, 3)


def rotor_stiffness(a: Arrangement, sides: np.ndarray) -> np.ndarray:
    """Stiffness (5, 5) of the rotor about the middle between its bearings [N/m, N, N m].

    Parameters
    ----------
    a : Arrangement
        With a span.
    sides : ndarray (2, 5, 5)
        Stiffness of each bearing in its own frame.
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


def transverse_inertia(a: Arrangement) -> float:
    """About the centre of mass, half way between the bearings [kg m2]."""
    if a.rotor_transverse_inertia_kg_mm2 is not None:
        return a.rotor_transverse_inertia_kg_mm2 * KG_MM2
    assert a.rotor_mass_kg is not None and a.span_mm is not None
    return SLENDER * a.rotor_mass_kg * (a.span_mm * MM) ** 2


def natural_frequencies(a: Arrangement, sides: np.ndarray, axial: float) -> np.ndarray | None:
    """Axial, radial and conical frequency of a rotor that is not turning [Hz].

    Gyroscopic moments of the rotor and its bending are left out. Radial and conical motion in one
    plane are those of the larger and the smaller share of translation.

    Parameters
    ----------
    a : Arrangement
    sides : ndarray (2, 5, 5)
        Stiffness of each bearing in its own frame.
    axial : float
        Axial stiffness of the arrangement: a spring gives way where a bearing does not [N/m].

    Returns
    -------
    ndarray (3,) or None
        None where mass or span are not given.
    """
    if a.rotor_mass_kg is None or a.span_mm is None:
        return None
    inertia, m = transverse_inertia(a), a.rotor_mass_kg
    K = rotor_stiffness(a, sides)[np.ix_(_PLANE, _PLANE)]
    squares, modes = eigh(K, np.diag([m, inertia]))
    radial = int(np.argmax(m * modes[0] ** 2))
    found = np.array([axial / m, squares[radial], squares[1 - radial]])
    return np.sqrt(np.maximum(found, 0.0)) / (2.0 * math.pi)


def lowest_frequency(scene: Scene, states: Sequence[State]) -> float:
    """Lowest natural frequency of the rotor in a state of a life; NaN without mass and span [Hz].

    A single bearing is half of a symmetric pair. The stiffness in other directions goes with the
    axial one, which may be that of worn grooves, as it does with Hertz' contacts (assumed).

    Parameters
    ----------
    scene : Scene
    states : sequence of State
        Of both bearings.
    """
    a = scene.arrangement
    if a is None or a.rotor_mass_kg is None or a.span_mm is None:
        return math.nan
    sides = scene.sides if scene.pair else (scene, scene)
    each = []
    for n, side, state in zip(a.tandem, sides, states, strict=True):
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
