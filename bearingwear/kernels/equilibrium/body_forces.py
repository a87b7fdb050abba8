"""Force equations of a ball, and the forces on it but its contacts' (theory.md section 2)."""

import math

from bearingwear.kernels.ball import ball_inertia, ball_mass
from bearingwear.kernels.decorators import inlined, jit
from bearingwear.kernels.equilibrium.kinematics import INNER_CONTROL, ORBIT, race_control


@inlined
def unbalanced_force(inner, outer, P_x, P_r):
    """The two force equations of a ball (theory.md Eq. 7), axial and radially outward [N].

    Parameters
    ----------
    inner, outer : Spring
        Its contacts.
    P_x, P_r : float
        See `body_forces` [N].
    """
    return (
        inner.Q * inner.s - outer.Q * outer.s + P_x,
        inner.Q * inner.c - outer.Q * outer.c + P_r,
    )


@jit
def body_forces(g, D, load, X2, s_i, c_i, s_o, c_o):
    """Forces on a ball other than the normal ones, and the inner race's share of them.

    Centrifugal force and tractions of a given orbit (ORBIT), or Jones-Harris: centrifugal force at
    dm/2 and the friction force that carries the gyroscopic moment at the controlling race.

    Returns
    -------
    P_x, P_r, T_i : float
        Axial, radially outward; tangential force of the inner race along the first contact axis
        [N].
    """
    m = ball_mass(g.rho, D)
    if load.kinematics_model == ORBIT:
        P_r = m * (g.R_o + X2) * load.Omega * load.Omega + load.P_r
        T_i, T_o = load.T_i, load.T_o
        return load.P_x + T_i * c_i + T_o * c_o, P_r - T_i * s_i - T_o * s_o, T_i
    alpha_i, alpha_o = math.atan2(s_i, c_i), math.atan2(s_o, c_o)
    k = race_control(load.kinematics_model, load.omega_i, load.omega_o, D / g.dm, alpha_i, alpha_o)
    F_c = m * 0.5 * g.dm * k.Omega * k.Omega
    M_g = ball_inertia(m, D) * k.w_R * k.Omega * math.sin(k.beta)
    T = 2.0 * M_g / D
    if load.kinematics_model == INNER_CONTROL:
        return T * c_i, F_c - T * s_i, T
    return -T * c_o, F_c + T * s_o, 0.0


@jit
def body_forces_at(g, D, load, A1, A2, X1, X2):
    """`body_forces`, axial and radially outward, with the ball centre at (X1, X2) [N]."""
    l_i = math.sqrt((A1 - X1) ** 2 + (A2 - X2) ** 2)
    l_o = math.sqrt(X1 * X1 + X2 * X2)
    P_x, P_r, _ = body_forces(g, D, load, X2, (A1 - X1) / l_i, (A2 - X2) / l_i, X1 / l_o, X2 / l_o)
    return P_x, P_r
