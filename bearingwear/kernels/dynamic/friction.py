"""Friction of the races on one ball of a moving bearing (theory.md sections 3 and 8)."""

from typing import NamedTuple

from bearingwear.kernels.contact.ellipse_friction import ellipse_friction
from bearingwear.kernels.contact.points import fill_points, quadrature_points
from bearingwear.kernels.contact.slip import LARGEST_AXIS, slip_coefficients, surface_height
from bearingwear.kernels.contact.traction import quick_strip_slopes, quick_strip_sums
from bearingwear.kernels.decorators import jit
from bearingwear.kernels.dynamic.model import race_contact_of
from bearingwear.kernels.layout import BALL, OMEGA, W_X, W_Y, W_Z
from bearingwear.kernels.status import BEYOND_GROOVE, OK, OUTSIDE_HERTZ_RANGE


class BallForces(NamedTuple):
    """Moment and force that set a ball's rates, and powers summed over all balls."""

    M_x: float  # [N m] in the ball's azimuth frame
    M_y: float
    M_z: float
    F_y: float  # against the orbit for the races' part of it [N]
    heat: float  # of friction [W]
    shaft: float  # put in by the races [W]


@jit(forceinline=True)
def contact_status(contact, R):
    """Whether a closed contact of a ball of radius R is one that the model describes."""
    if contact.a >= LARGEST_AXIS * R:
        return OUTSIDE_HERTZ_RANGE
    if contact.cos_a < 0.0:
        return BEYOND_GROOVE
    return OK


@jit(forceinline=True)
def part_sums(bearing, buf, contact, c, R, even, slopes, gradient, hessian):
    """`friction_sums` of one part of a film's friction, or of all that follows the load.

    Parameters
    ----------
    even : bool
        Whether of the part that is even over the ellipse; QV is of no use then.
    slopes : bool
        Whether `gradient` and `hessian` are filled too, as by `traction.traction_slope`.

    Returns
    -------
    g_1, g_0, g_h, g_x, g_t, qv
        As `traction.ellipse_sums`.
    """
    m, rule = bearing.op, bearing.rule
    if rule.across.size == 1 and not bearing.traction:
        h = buf.h
        t, weight = quadrature_points(rule, contact, R, c, m.v_r, buf.t, buf.weight)
        surface_height(contact, R, t, h)
        mu = contact.mu - contact.mu_even
        if even:
            mu, t, weight = contact.mu_even, buf.t[: t.size], buf.weight[: t.size]
            fill_points(rule, contact, R, c, m.v_r, t, weight, True)
        if slopes:
            qv = quick_strip_slopes(contact, c, mu, m.v_r, t, weight, h, gradient, hessian)
            return gradient[0], gradient[1], gradient[2], gradient[3], 0.0, qv
        g_1, g_0, g_h, g_x, qv = quick_strip_sums(contact, c, mu, m.v_r, t, weight, h)
        return g_1, g_0, g_h, g_x, 0.0, qv
    g_1, g_0, g_h, g_x, g_t, qv = ellipse_friction(
        bearing.points, contact, R, c, m.v_r, even, slopes, buf.places, gradient, hessian
    )
    return g_1, g_0, g_h, g_x, (g_t if bearing.traction else 0.0), qv


@jit
def with_even_part(sums, bearing, buf, contact, c, R, slopes, even, gradient, hessian):
    """`friction_sums` of a film, from those of the part that follows the load."""
    g_1, g_0, g_h, g_x, g_t, qv = sums
    added = part_sums(bearing, buf, contact, c, R, True, slopes, even, buf.even_hessian)
    if slopes:
        for i in range(gradient.size):
            gradient[i] += even[i]
            for j in range(gradient.size):
                hessian[i, j] += buf.even_hessian[i, j]
    e_1, e_0, e_h, e_x, e_t, _ = added
    return g_1 + e_1, g_0 + e_0, g_h + e_h, g_x + e_x, g_t + e_t, qv


@jit(forceinline=True)
def friction_sums(bearing, buf, contact, c, R, slopes, even, gradient, hessian):
    """Gradient of Phi by the slip coefficients c, force along the major axis, and QV.

    The force is zero unless traction enters the balance of normal forces.

    Parameters
    ----------
    slopes : bool
        Whether `gradient` and `hessian` are filled too, and `even`, the even part of `gradient`.

    Returns
    -------
    g_1, g_0, g_h, g_x, g_t, qv
        As `traction.ellipse_sums`.
    """
    sums = part_sums(bearing, buf, contact, c, R, False, slopes, gradient, hessian)
    if contact.mu_even > 0.0:
        return with_even_part(sums, bearing, buf, contact, c, R, slopes, even, gradient, hessian)
    return sums


@jit
def race_friction(y, bearing, buf, j, f, qv, slopes):
    """Forces f and the friction of both races on ball j.

    Parameters
    ----------
    qv : ndarray (2,)
        QV of both contacts [W]; filled, as are the tractions of the ball in `buf.balls.T`.
    slopes : bool
        Whether gradients and second derivatives are left in `buf`, for the Jacobian.

    Returns
    -------
    status : int
    forces : BallForces
    """
    i, R, r = BALL * j, 0.5 * bearing.D[j], buf.balls.r[j]
    u = (y[i + W_X], y[i + W_Y], y[i + W_Z], y[i + OMEGA])
    for k in range(2):
        contact = race_contact_of(bearing, buf.balls, j, k)
        buf.balls.T[j, k] = qv[k] = 0.0
        if not contact.Q > 0.0:
            continue
        status = contact_status(contact, R)
        if status != OK:
            return status, f
        c = slip_coefficients(contact, u, r)
        g_1, g_0, g_h, g_x, buf.balls.T[j, k], qv[k] = friction_sums(
            bearing, buf, contact, c, R, slopes, buf.even[j, k], buf.gradient[j, k],
            buf.hessian[j, k],
        )  # fmt: skip
        sigma, sine, cosine = contact.sigma, contact.sin_a, contact.cos_a
        turning = sigma * cosine * g_h - sine * g_x
        f = BallForces(
            M_x=f.M_x - turning,
            M_y=f.M_y + sigma * g_1,
            M_z=f.M_z + (sigma * sine * g_h + cosine * g_x),
            F_y=f.F_y + g_0,
            heat=f.heat + (c[0] * g_1 + c[1] * g_0 + c[2] * g_h + c[3] * g_x),
            shaft=f.shaft - contact.omega * (r * g_0 + turning),
        )
    return OK, f


@jit
def find_tractions(y, bearing, buf):
    """Tractions of all contacts in the balance of normal forces, into `buf.balls.T`."""
    for j in range(bearing.D.size):
        i, R, r = BALL * j, 0.5 * bearing.D[j], buf.balls.r[j]
        u = (y[i + W_X], y[i + W_Y], y[i + W_Z], y[i + OMEGA])
        for k in range(2):
            contact = race_contact_of(bearing, buf.balls, j, k)
            T = 0.0
            if contact.Q > 0.0 and contact_status(contact, R) == OK:
                c = slip_coefficients(contact, u, r)
                _, _, _, _, T, _ = friction_sums(
                    bearing, buf, contact, c, R, False, buf.even[j, k], buf.gradient[j, k],
                    buf.hessian[j, k],
                )  # fmt: skip
            buf.balls.T[j, k] = T
