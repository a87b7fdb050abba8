"""Jones-Harris kinematics: one race holds the ball against spinning (theory.md section 5)."""

import math

from bearingwear.kernels.decorators import jit
from bearingwear.kernels.params import Kinematics

ORBIT, OUTER_CONTROL, INNER_CONTROL = 0, 1, 2


@jit
def rolling_orbit(omega_i, omega_o, rho_i, rho_o, delta_i, delta_o):
    """Orbit rate and ball spin with no slip at the centres of both contacts.

    Parameters
    ----------
    omega_i, omega_o : float
        Race speeds [rad/s].
    rho_i, rho_o : float
        Race radius at the contact over ball radius, (r -+ R cos a)/R [1].
    delta_i, delta_o : float
        Angle between spin axis and contact tangent, beta - a_i, beta - a_o [rad].

    Returns
    -------
    Omega, w_R : float
        [rad/s]
    """
    g_i = math.cos(delta_i) / rho_i  # (omega_i - Omega) / w_R
    g_o = math.cos(delta_o) / rho_o  # (Omega - omega_o) / w_R
    w_R = (omega_i - omega_o) / (g_i + g_o)
    return omega_o + w_R * g_o, w_R


@jit
def race_control(kinematics_model, omega_i, omega_o, gamma, alpha_i, alpha_o):
    """Kinematics with no spin at the controlling race (theory.md Eqs. 20-22).

    Parameters
    ----------
    kinematics_model : int
        OUTER_CONTROL or INNER_CONTROL.
    gamma : float
        D/dm [1].
    """
    if kinematics_model == OUTER_CONTROL:
        beta = math.atan2(math.sin(alpha_o), math.cos(alpha_o) + gamma)
    else:
        beta = math.atan2(math.sin(alpha_i), math.cos(alpha_i) - gamma)
    Omega, w_R = rolling_orbit(
        omega_i,
        omega_o,
        1.0 / gamma - math.cos(alpha_i),
        1.0 / gamma + math.cos(alpha_o),
        beta - alpha_i,
        beta - alpha_o,
    )
    return Kinematics(Omega, w_R, beta)
