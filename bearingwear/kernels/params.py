"""Parameter records of a bearing: immutable, of floats, built by one factory.

The factory is `bearingwear.solvers.bearing.parameters`; it makes every field a float (counts an
int), since each mixture of types would compile another version of every kernel.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:  # numba takes long to load, and commands read these records without it
    from bearingwear.kernels.contact.friction import Law


class Geometry(NamedTuple):
    """Grooves, material pair and load direction of the whole bearing (theory.md section 2)."""

    n_balls: int
    D0: float  # nominal ball diameter [m]
    dm: float  # pitch diameter [m]
    alpha0: float  # free contact angle, unworn [rad]
    BD: float  # distance of the groove centres, unworn and unloaded [m]
    R_o: float  # locus radius of the outer groove centre [m]
    R_i: float  # locus radius of the inner groove centre [m]
    r_i: float  # inner groove radius [m]
    r_o: float  # outer groove radius [m]
    E_star: float  # contact modulus of the ball/race pair [Pa]
    rho: float  # density of the balls [kg/m3]


class OperatingPoint(NamedTuple):
    """Speeds and friction (theory.md section 3)."""

    omega_i: float  # inner race speed [rad/s]
    omega_o: float  # outer race speed [rad/s]
    law_i: Law  # friction in the inner contacts
    law_o: Law  # and in the outer ones
    v_r: float  # slip regularisation [m/s]
    drag: float  # rho_eff C_d of the lubricant drag [kg/m3]


class Hertz(NamedTuple):
    """Elliptic point contact: Q = K d^1.5, a = c_a Q^(1/3), b = c_b Q^(1/3)."""

    K: float  # load-deformation factor [N/m^1.5]
    c_a: float  # semi-major axis factor [m/N^(1/3)]
    c_b: float  # semi-minor axis factor [m/N^(1/3)]
    log_kappa: float  # ln(a/b), the start of the next solve nearby [1]
    E: float  # complete elliptic integral of the second kind, m = 1 - (b/a)^2 [1]


class BallLoad(NamedTuple):
    """What sets the forces on a ball other than its two normal contact forces."""

    kinematics_model: int  # ORBIT: a given orbit rate; OUTER_CONTROL, INNER_CONTROL: Jones-Harris
    Omega: float  # orbit rate (ORBIT only) [rad/s]
    omega_i: float  # inner race speed (race control only) [rad/s]
    omega_o: float  # outer race speed (race control only) [rad/s]
    P_x: float  # further force on the ball, axial (ORBIT only) [N]
    P_r: float  # and radially outward [N]
    T_i: float  # traction along the first contact axes, inner and outer (ORBIT only) [N]
    T_o: float


class BallState(NamedTuple):
    """Normal-force equilibrium of one ball between the grooves."""

    status: int
    X1: float  # axial position of the ball centre from the outer groove centre [m]
    X2: float  # radial position of the ball centre from the outer groove centre [m]
    alpha_i: float  # contact angles [rad]
    alpha_o: float
    Q_i: float  # contact loads [N]
    Q_o: float
    hertz_i: Hertz
    hertz_o: Hertz
    F_ix: float  # force of the inner race on the ball, traction of its load included [N]
    F_ir: float
    S_xx: float  # stiffness of that force against race displacement, ball centre free [N/m]
    S_xr: float
    S_rr: float
    P_x: float  # all forces on the ball but the two loads Q, traction among them: axial [N]
    P_r: float  # and radially outward
    residual: float  # what is left of the ball's force balance [N]


class Kinematics(NamedTuple):
    """Ball motion under Jones-Harris race control."""

    Omega: float  # orbit rate [rad/s]
    w_R: float  # ball spin relative to the orbiting frame [rad/s]
    beta: float  # pitch angle of the spin axis [rad]


class Contact(NamedTuple):
    """One loaded contact, all a slip integral needs (theory.md section 3)."""

    sigma: float  # +1 outer race, -1 inner race
    Q: float  # load [N]
    a: float  # semi-major axis [m]
    b: float  # semi-minor axis [m]
    sin_a: float  # sine and cosine of the contact angle
    cos_a: float
    r_g: float  # groove radius [m]
    omega: float  # race speed [rad/s]
    mu: float  # friction coefficient at its load [1]
    mu_even: float = 0.0  # the part of it that a film's shear strength makes, even over the ellipse
