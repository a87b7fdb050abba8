"""Quasi-static stiffness: slope of force over place where balls follow (theory.md section 2)."""

import functools
import math
from collections.abc import Iterable

import numpy as np

from bearingwear.kernels.ball import ball_inertia, ball_mass
from bearingwear.kernels.equilibrium.place_tangent import place_tangent
from bearingwear.kernels.equilibrium.stiffness import DOF
from bearingwear.kernels.params import BallLoad, BallState, Geometry
from bearingwear.kernels.steady.thrust import ThrustCase

STANDING = 1e-6  # of the ball's speeds: with an orbit rate below it a ball does not orbit


def groove_maps(R_i: float, psi: np.ndarray) -> np.ndarray:
    """Returns derivatives of the inner groove centre at each ball by the race's place (n, 2, DOF).

    Rows: axial, then radial displacement of the centre (outwards). Columns: displacements of the
    race along X, Y and Z [1], and its tilts about Y and Z [m].

    R_i: radius of the inner groove centres [m].
    psi: azimuths of the balls (n,), from +Z towards -Y [rad].
    """
    maps = np.zeros((len(psi), 2, DOF))
    s, c = np.sin(psi), np.cos(psi)
    maps[:, 0, 0] = 1.0
    maps[:, 0, 3], maps[:, 0, 4] = R_i * c, R_i * s
    maps[:, 1, 1] = -s
    maps[:, 1, 2] = c
    return maps


def azimuths(n: int) -> np.ndarray:
    """Returns the azimuths (n,) of n evenly spaced balls, the first at +Z [rad]."""
    return 2.0 * np.pi * np.arange(n) / n


@functools.lru_cache(maxsize=16)
def _maps_across(R_i: float, n: int) -> np.ndarray:
    """Returns the sums over n balls of exp(i psi) times `groove_maps`, complex (2, DOF - 1, 2).

    Axes: the maps at psi, then at psi + 90 degrees; the displacements and tilts of the race but for
    the axial one; axial and radial displacement of the groove. Callers share it and must not write
    to it.
    """
    psi = azimuths(n)
    maps = np.array([groove_maps(R_i, psi), groove_maps(R_i, psi + 0.5 * np.pi)])
    return np.einsum("tjdp,j->tpd", maps[..., 1:], np.exp(1j * psi))


def quasistatic_matrix(g: Geometry, D: float, case: ThrustCase) -> np.ndarray | None:
    """Returns the quasi-static stiffness (5, 5) of a steady state [N/m, N, N m].

    Rows and columns: displacements along X, Y and Z, tilts about Y and Z; the axial one is not
    coupled to the others. Displacements across the axis are fixed in space: a ball meets them once
    an orbit, and responds at that rate. None where the balls do not orbit.

    D: worn ball diameter [m].
    """
    Omega = case.u[3]
    if not abs(Omega) > STANDING * max(map(abs, case.u.tolist())):
        return None
    N = g.n_balls
    m = ball_mass(g.rho, D)
    k = len(case.response) - 2  # motion and traction, before the place of the groove
    J, B = case.response[:k, :k], case.response[:k, k:]
    C, S = case.response[k:, :k], case.response[k:, k:]
    K = np.zeros((DOF, DOF))
    K[0, 0] = N * case.S_quasistatic
    # inertia times i Omega on the diagonal of the motion; tractions have none
    impedance = -J.astype(complex)
    inertia = [ball_inertia(m, D)] * 3 + [m * case.r * case.r]
    impedance.flat[: 4 * (k + 1) : k + 1] += 1j * Omega * np.array(inertia)
    motion = np.linalg.solve(impedance, B)
    force, lead = S + C @ motion, motion[3] / (1j * Omega)
    # amplitudes of the groove's displacement by those of the race, over exp(i psi)
    amplitude = np.array([[0.0, 0.0, g.R_i, -1j * g.R_i], [1j, 1.0, 0.0, 0.0]])
    Q, alpha = case.contacts[0, :2].tolist()
    sine, cosine = math.sin(alpha), math.cos(alpha)
    steady = np.array([Q * sine + case.T_i * cosine, Q * cosine - case.T_i * sine])
    across, turned = _maps_across(g.R_i, N)
    led = (turned @ steady)[:, None] * (lead @ amplitude)
    K[1:, 1:] = (across @ (force @ amplitude) + led).real
    return K


def race_control_matrix(
    g: Geometry,
    D: np.ndarray,
    loads: Iterable[BallLoad],
    states: Iterable[BallState],
    delta: np.ndarray,
    tilt: float,
) -> np.ndarray:
    """Returns the quasi-static stiffness (5, 5) under race control [N/m, N, N m].

    The forces of race control on a ball follow its place at once, whatever the orbit rate. Rows and
    columns: displacements along X, Y and Z, tilts about Y and Z. A ball off the inner race counts
    as 0.

    D, loads, states: of the n balls solved, one if it represents all.
    delta: displacement of the inner race (3,) along X, Y and Z [m].
    tilt: of the inner race about Y [rad].
    """
    psi = azimuths(g.n_balls)[: len(D)]
    ball_tangents = np.zeros((len(D), 2, 2))  # 0 where a ball is off the inner race
    for k, (load, state) in enumerate(zip(loads, states, strict=True)):
        if state.Q_i > 0.0:
            tangent = place_tangent(g, D[k], load, psi[k], tuple(delta), tilt, state)
            ball_tangents[k] = np.reshape(tangent, (2, 2))
    maps = groove_maps(g.R_i, azimuths(g.n_balls))
    tangents = np.broadcast_to(ball_tangents, (g.n_balls, 2, 2))
    return np.einsum("jdp,jde,jeq->pq", maps, tangents, maps)


def radially_free(K: np.ndarray) -> float:
    """Returns the axial stiffness of a race that may move along Y and Z, without tilting [N/m].

    It is K_xx less the part by which Y and Z yield to an axial displacement. Where K gives them no
    stiffness in a direction, lstsq takes no displacement there. NaN if a number of K is not finite.

    K: stiffness (5, 5), in the order of `race_control_matrix`.
    """
    if not np.isfinite(K).all():
        return float("nan")
    yields, *_ = np.linalg.lstsq(K[1:3, 1:3], K[1:3, 0], rcond=None)
    return float(K[0, 0] - K[0, 1:3] @ yields)
