"""How the friction of a contact changes with the ball's motion and with what bears on the contact.

The first four changes are by the motion (w_x, w_y, w_z, Omega); the friction's Hessian carries them
over. Where the ball stands changes the slip too, and the load the size of the ellipse.
"""

from bearingwear.kernels.contact.friction import force_slope
from bearingwear.kernels.contact.profile import middle_height, profile
from bearingwear.kernels.contact.slip import point_slip
from bearingwear.kernels.decorators import REORDER_SUMS, jit
from bearingwear.kernels.layout import OMEGA, W_X, W_Y, W_Z
from bearingwear.kernels.linear import accumulate

# Columns of the changes of slip coefficients and friction, after those of w_x, w_y, w_z, Omega.
BY_RADIUS, BY_ANGLE, BY_LOAD = 4, 5, 6


@jit
def slip_changes(contact, c, r, L):
    """Derivatives L (4, 6) of the slip coefficients by (w, Omega), orbit radius, contact angle.

    Parameters
    ----------
    c : tuple of 4 floats
        Slip coefficients.
    """
    sigma, sine, cosine = contact.sigma, contact.sin_a, contact.cos_a
    L[0, W_Y] = -sigma
    L[1, OMEGA] = r
    L[1, BY_RADIUS] = c[1] / r
    L[2, W_X], L[2, W_Z] = sigma * cosine, -sigma * sine
    L[3, W_X], L[3, W_Z] = -sine, -cosine
    L[2, BY_ANGLE], L[3, BY_ANGLE] = sigma * c[3], -sigma * c[2]


@jit
def gradient_changes(contact, R, c, gradient, even, H, L, change):
    """Derivatives (size, 7) of the friction of a contact, from those L of its slip coefficients.

    By its load, both semi-axes grow with its cube root: the points go out, and along the arc of
    the surface down and up. What that does to the gyroscopic slip is left out, and that the axes
    follow the contact angle: `exact_changes` has both.

    Parameters
    ----------
    even : ndarray (size,)
        The part of `gradient` that goes with the area, the load to the power 2/3.
    """
    size, p_R = gradient.size, profile(contact.r_g, R, contact.a)
    up = contact.a * contact.a * (1.0 / p_R.arc - 1.0 / p_R.ball) / 3.0
    middle = middle_height(p_R) - 1.5 * up
    for p in range(size):
        for v in range(6):
            value = 0.0
            for q in range(4):
                value += H[p, q] * L[q, v]
            change[p, v] = value
        higher = 2.0 * c[2] * (H[p, 2] - middle * H[p, 1])
        change[p, BY_LOAD] = (
            gradient[p] - even[p] / 3.0 + (c[3] * H[p, 3] + higher) / 3.0
        ) / contact.Q
    change[2, BY_LOAD] += 2.0 / 3.0 * (gradient[2] - middle * gradient[1]) / contact.Q
    change[3, BY_LOAD] += gradient[3] / (3.0 * contact.Q)


@jit(fastmath=REORDER_SUMS)
def axis_sums(contact, c, R, v_r, points):
    """Derivatives of the gradient of Phi by c, over mu Q, by ln a and ln b, row by row.

    The points go with the axes; other parameters as in `add_axis_changes`.
    """
    t, weight, h, width, across, share = points
    p_R, v_r2, c_1, c_h, c_x = profile(contact.r_g, R, contact.a), v_r * v_r, c[0], c[2], c[3]
    up = contact.a * contact.a * (1.0 / p_R.arc - 1.0 / p_R.ball)
    a_1 = a_0 = a_h = a_x = a_t = b_1 = b_0 = b_h = b_x = b_t = 0.0
    for k in range(t.size):
        hk, x = h[k], contact.a * t[k]
        higher = up - x * x / (hk + p_R.arc - p_R.ball)
        gyroscopic, v2 = point_slip(c, hk, x)
        by_1, by_2 = c_1 * higher, c_h * higher + c_x * x
        for j in range(across.size):
            y = width[k] * across[j]
            v1, away = gyroscopic - c_x * y, -c_x * y
            f, p_11, p_12, p_22 = force_slope(weight[k] * share[j], v1, v2, v_r2)
            f1, f2 = p_11 * by_1 + p_12 * by_2, p_12 * by_1 + p_22 * by_2
            a_1 += f1 * hk + f * v1 * higher
            a_0 += f2
            a_h += f2 * hk + f * v2 * higher
            a_x += f2 * x - f1 * y + f * v2 * x
            a_t += f1
            f1, f2 = p_11 * away, p_12 * away
            b_1 += f1 * hk
            b_0 += f2
            b_h += f2 * hk
            b_x += f2 * x - f1 * y - f * v1 * y
            b_t += f1
    return (a_1, a_0, a_h, a_x, a_t), (b_1, b_0, b_h, b_x, b_t)


@jit
def add_axis_changes(contact, c, mu, R, v_r, points, by_a, by_b):
    """Add how the gradient of Phi by c changes as the axes grow.

    Parameters
    ----------
    by_a, by_b : ndarray (5,)
        Derivatives by ln a and ln b, for each of its rows.
    """
    of_a, of_b = axis_sums(contact, c, R, v_r, points)
    accumulate(mu * contact.Q, of_a, by_a)
    accumulate(mu * contact.Q, of_b, by_b)


@jit
def exact_changes(Q, axes, gradient, even, by_a, by_b, change):
    """Make the columns of `gradient_changes` by angle and load exact.

    Parameters
    ----------
    Q : float
        Load [N].
    axes : tuple of 2 floats
        `hertz.axes_by_angle`.
    gradient, even : ndarray
        As in `gradient_changes`.
    by_a, by_b : ndarray (5,)
        Of `add_axis_changes`.
    """
    turn_a, turn_b = axes
    for p in range(gradient.size):
        change[p, BY_LOAD] = (gradient[p] + (by_a[p] + by_b[p] - even[p]) / 3.0) / Q
        change[p, BY_ANGLE] += turn_a * (by_a[p] + even[p]) + turn_b * (by_b[p] + even[p])
