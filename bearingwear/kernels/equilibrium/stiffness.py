"""Stiffness of a bearing against all five displacements of its inner race (theory.md section 2)."""

import math

from bearingwear.kernels.contact.hertz import INNER, OUTER, race_contact
from bearingwear.kernels.contact.profile import contact_approach
from bearingwear.kernels.decorators import jit
from bearingwear.kernels.equilibrium.thrust_loaded import Spring, loaded_spring, series_stiffness

DOF = 5
"""Displacements: axial, along Y, along Z, tilt about Y, tilt about Z."""


@jit
def spring_under(g, side, D, Q, alpha):
    """A contact under the load Q at its angle as a spring; without load it has no stiffness."""
    s, c = math.sin(alpha), math.cos(alpha)
    if not Q > 0.0:
        return Spring(Q=0.0, s=s, c=c, k11=0.0, k12=0.0, k22=0.0)
    d = contact_approach(race_contact(g, side, D, c, math.nan).K, Q)
    length = (g.r_o if side > 0.0 else g.r_i) - 0.5 * D + d
    return loaded_spring(Q, d, length, s, c)


@jit
def bearing_stiffness(g, D, psi, Q, alpha, out):
    """Stiffness matrix of a bearing in equilibrium, from its contacts alone (theory.md Eq. 75).

    Orbit rates and friction forces are held, ball centres are free. Displacements are those of the
    circle of inner groove centres, of the radius R_i, about its middle.

    Parameters
    ----------
    D : ndarray (n,)
        Worn diameters of the balls [m].
    psi : ndarray (n,)
        Their azimuths [rad].
    Q, alpha : ndarray (n, 2)
        Loads [N] and angles [rad] of their inner and outer contacts.
    out : ndarray (DOF, DOF)
        Filled [N/m, N, N m].
    """
    for p in range(DOF):
        for q in range(DOF):
            out[p, q] = 0.0
    S_xx = S_xr = S_rr = 0.0
    for j in range(D.size):
        alike = j > 0 and D[j] == D[j - 1]
        for k in range(2):
            alike = alike and Q[j, k] == Q[j - 1, k] and alpha[j, k] == alpha[j - 1, k]
        if not alike:
            inner = spring_under(g, INNER, D[j], Q[j, 0], alpha[j, 0])
            outer = spring_under(g, OUTER, D[j], Q[j, 1], alpha[j, 1])
            S_xx, S_xr, S_rr = series_stiffness(inner, outer)
        s, c = math.sin(psi[j]), math.cos(psi[j])
        axial = (1.0, 0.0, 0.0, g.R_i * c, g.R_i * s)  # of the groove centre, for each displacement
        radial = (0.0, -s, c, 0.0, 0.0)
        for p in range(DOF):
            for q in range(p, DOF):
                out[p, q] += axial[p] * (S_xx * axial[q] + S_xr * radial[q]) + radial[p] * (
                    S_xr * axial[q] + S_rr * radial[q]
                )
    for p in range(DOF):
        for q in range(p):
            out[p, q] = out[q, p]
