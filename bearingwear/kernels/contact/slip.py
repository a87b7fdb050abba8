"""Slip and heat of one ball/race contact (theory.md section 3).

A point at x along the major axis and y across it lies h(x) from the ball's centre along the normal.
There the slip (race minus ball) is linear in four numbers c of the contact, which are linear in the
ball's motion u = (w_x, w_y, w_z, Omega):

    v1 = c_1 h - c_x y,    v2 = c_0 + c_h h + c_x x,    c = L u + const

and the traction is minus the gradient of the convex sum Phi of the points' friction potentials.
Sums over the points need therefore only be those of the gradient and the second derivatives of Phi
by c (traction.py, ellipse_friction.py); `L` carries them to the ball. The law itself stands in
friction.py, the shape of the contact in profile.py.
"""

import math

from bearingwear.kernels.contact.friction import force_per_slip, law_coefficients
from bearingwear.kernels.contact.hertz import INNER, OUTER
from bearingwear.kernels.contact.profile import height, pressure, profile, semi_axis
from bearingwear.kernels.decorators import REORDER_SUMS, inlined, jit
from bearingwear.kernels.params import Contact

# Hertz takes the bodies for paraboloids; at this size of ellipse the ball's own edge is near.
LARGEST_AXIS = 0.7  # a / R


@jit
def loaded_contact(g, op, k, Q, a, b, sine, cosine):
    """Contact of a ball with race k (0 inner, 1 outer).

    Parameters
    ----------
    Q, a, b : float
        Load [N] and semi-axes [m].
    sine, cosine : float
        Of the contact angle.
    """
    mu, mu_even = law_coefficients(op.law_i if k == 0 else op.law_o, Q, a, b)
    return Contact(
        sigma=INNER if k == 0 else OUTER,
        Q=Q,
        a=a,
        b=b,
        sin_a=sine,
        cos_a=cosine,
        r_g=g.r_i if k == 0 else g.r_o,
        omega=op.omega_i if k == 0 else op.omega_o,
        mu=mu,
        mu_even=mu_even,
    )


@jit
def hertz_contact(g, op, k, Q, alpha, hertz):
    """`loaded_contact` at a contact angle [rad], from the Hertz factors there."""
    a, b = semi_axis(hertz.c_a, Q), semi_axis(hertz.c_b, Q)
    return loaded_contact(g, op, k, Q, a, b, math.sin(alpha), math.cos(alpha))


@jit
def race_contacts(g, op, state):
    """The two loaded contacts (inner, outer) of a ball in equilibrium."""
    return (
        hertz_contact(g, op, 0, state.Q_i, state.alpha_i, state.hertz_i),
        hertz_contact(g, op, 1, state.Q_o, state.alpha_o, state.hertz_o),
    )


@jit
def slip_coefficients(contact, u, r):
    """Slip along the two contact axes as (c_1, c_0, c_h, c_x) (theory.md Eqs. 9-10).

    Parameters
    ----------
    u : ndarray or tuple (4,)
        Ball angular velocity (axial, tangential, radial) and orbit rate [rad/s].
    r : float
        Orbit radius [m].
    """
    w_rel = u[0] - contact.omega
    return (
        -contact.sigma * u[1],
        (u[3] - contact.omega) * r,
        contact.sigma * (w_rel * contact.cos_a - u[2] * contact.sin_a),
        -(w_rel * contact.sin_a + u[2] * contact.cos_a),
    )


@inlined
def point_slip(c, h, x):
    """Slip (v1, v2) at x in the middle of its strip, at the height h."""
    c_1, c_0, c_h, c_x = c
    return c_1 * h, c_0 + c_h * h + c_x * x


@jit
def surface_height(contact, R, t, h):
    """Distance h of the contact's points from the ball centre along its normal (Eq. 8) [m].

    Parameters
    ----------
    R : float
        Ball radius [m].
    t : ndarray (n,)
        Positions x/a.
    h : ndarray (n,)
        Filled.
    """
    p = profile(contact.r_g, R, contact.a)
    for k in range(t.size):
        h[k] = height(p, contact.a * t[k])


@jit
def half_width(contact, t, width):
    """Half-width of the ellipse at the points t [m], into `width` (n,)."""
    for k in range(t.size):
        width[k] = contact.b * math.sqrt(pressure(t[k]))


@jit
def slip_map(contact, r, L):
    """Fill L = dc/du (4, 4), rows (c_1, c_0, c_h, c_x), columns (w_x, w_y, w_z, Omega)."""
    L[:, :] = 0.0
    L[0, 1] = -contact.sigma
    L[1, 3] = r
    L[2, 0] = contact.sigma * contact.cos_a
    L[2, 2] = -contact.sigma * contact.sin_a
    L[3, 0] = -contact.sin_a
    L[3, 2] = -contact.cos_a


@jit
def slip_velocity(contact, c, t, h, v1, v2):
    """Slip at the points t in the middle of the strips: along the major axis (v1), rolling (v2)."""
    c_1, c_0, c_h, c_x = c
    by_t = (c_1, c_0, c_h, c_x * contact.a)
    for k in range(t.size):
        v1[k], v2[k] = point_slip(by_t, h[k], t[k])


@jit
def dissipation(contact, c, mu, v_r, r, points):
    """What the slip costs, and the power through the contact.

    Returns
    -------
    qv : float
        Integral of |v| dQ [W].
    heat : float
        Integral of dF.v [W].
    gyro_share : float
        Integral of |c_1 h| dQ over that of |v| dQ: spin slides along the major axis too, but is
        not gyroscopic [1].
    torque : float
        Torque of the race on the ball about the bearing axis, with each point's own lever [N m].
    """
    t, weight, h, width, across, share = points
    qv = heat = gyro = torque = 0.0
    for j in range(across.size):
        for k in range(t.size):
            x, y = contact.a * t[k], across[j] * width[k]
            v1, v2 = point_slip(c, h[k], x)
            v1 -= c[3] * y
            v = math.sqrt(v1 * v1 + v2 * v2)
            dQ = share[j] * weight[k] * contact.Q
            F = force_per_slip(mu * dQ, v * v, v_r * v_r)
            qv += v * dQ
            gyro += abs(c[0] * h[k]) * dQ
            heat += F * v * v
            # Distance of the point from the bearing axis; a force along +y turns about -X.
            torque -= F * v2 * (r + contact.sigma * h[k] * contact.cos_a - x * contact.sin_a)
            torque -= F * v1 * y * contact.sin_a
    return qv, heat, (gyro / qv if qv > 0.0 else 0.0), torque


quick_dissipation = jit(fastmath=REORDER_SUMS)(getattr(dissipation, "py_func", dissipation))
"""`dissipation` with its sums in any order."""
