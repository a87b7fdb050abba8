"""Published bearings as kernel parameters."""

import math

from bearingwear.kernels.params import Geometry


def geometry(D, dm, alpha0, f_i, f_o, Z, rho, E, nu):
    """Returns the geometry of a bearing of one material.

    D, dm: ball and pitch diameter [m].
    alpha0: contact angle [degree].
    f_i, f_o: groove radii over the ball diameter.
    Z: number of balls.
    rho, E, nu: density [kg/m3], Young's modulus [Pa] and Poisson's ratio.
    """
    a = math.radians(alpha0)
    return Geometry(
        n_balls=Z,
        D0=D,
        dm=dm,
        alpha0=a,
        BD=(f_i + f_o - 1.0) * D,
        R_o=0.5 * dm - (f_o - 0.5) * D * math.cos(a),
        R_i=0.5 * dm + (f_i - 0.5) * D * math.cos(a),
        r_i=f_i * D,
        r_o=f_o * D,
        E_star=E / (2.0 * (1.0 - nu**2)),
        rho=rho,
    )


# Nosaka's turbopump bearing; the 218 bearing of Jones and Harris; an instrument bearing with balls
# of 2 mm. Benchmark digits for them: test_race_control.py.
NOSAKA = geometry(7.938e-3, 38.5e-3, 20.0, 0.56, 0.52, 10, 7750.37, 199.948e9, 0.25)
B218 = geometry(22.225e-3, 125.26e-3, 40.0, 0.5232, 0.5232, 16, 7800.0, 207.5e9, 0.3)
MM2 = geometry(2.0e-3, 9.0e-3, 25.0, 0.565, 0.585, 10, 7800.0, 208e9, 0.3)
