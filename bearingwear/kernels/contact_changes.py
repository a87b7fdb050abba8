"""How the friction of a contact changes with the ball's motion and with what bears on the contact.

The first four changes are by the motion (w_x, w_y, w_z, Omega); the friction's Hessian carries them
over. Where the ball stands changes the slip too, and the load the size of the ellipse.
"""

from bearingwear.kernels.build.decorators import jit
from bearingwear.kernels.profile import middle_height, profile
from bearingwear.kernels.state import OMEGA, W_X, W_Y, W_Z

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
    the surface down and up. What that does to the gyroscopic slip is left out.

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
