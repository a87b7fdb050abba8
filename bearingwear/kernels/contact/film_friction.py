"""The part of a film's friction that spreads evenly over the ellipse (theory.md section 23).

A film shears at S_0 + alpha p: dF = (S_0 dA + alpha dQ) v/|v|. The second part sums as Coulomb's
friction does, over shares of the load; the first sums over shares of the area. They are taken at
the same points.
"""

from bearingwear.kernels.build.decorators import jit
from bearingwear.kernels.contact.points import fill_points, place_across
from bearingwear.kernels.contact.slip import quick_dissipation
from bearingwear.kernels.contact.traction import traction, traction_slope


@jit
def area_shares(rule, contact, R, c, v_r, t, weight, across, share):
    """Put shares of the area in place of those of the load; points as `contact_points` has them.

    Parameters
    ----------
    t, weight : ndarray (n,)
    across, share : ndarray (rule.across.size,)
    """
    fill_points(rule, contact, R, c, v_r, t, weight, True)
    if across.size > 1:
        place_across(rule, contact, R, c, across, share, True)


@jit
def add_even_part(rule, contact, R, c, v_r, points, even, even_hessian, gradient, hessian, slope):
    """Add to `gradient`, and where asked to `hessian`, those of the even part.

    Parameters
    ----------
    points : tuple of 6 ndarray
        t, weight, h, width, across, share, as in `traction`; left with shares of the area.
    even, even_hessian : ndarray
        Filled: the even part alone.
    """
    t, weight, h, width, across, share = points
    area_shares(rule, contact, R, c, v_r, t, weight, across, share)
    mu, n = contact.mu_even, gradient.size
    if slope:
        traction_slope(contact, c, mu, v_r, t, weight, h, width, across, share, even, even_hessian)
        for i in range(n):
            for j in range(n):
                hessian[i, j] += even_hessian[i, j]
    else:
        traction(contact, c, mu, v_r, t, weight, h, width, across, share, even)
    for i in range(n):
        gradient[i] += even[i]


@jit
def even_dissipation(contact, c, v_r, r, points):
    """Heat [W] and torque [N m] of the even part, as `contact.dissipation` has them."""
    t, weight, h, width, across, share = points
    _, heat, _, torque = quick_dissipation(
        contact, c, contact.mu_even, v_r, r, t, weight, h, width, across, share
    )
    return heat, torque
