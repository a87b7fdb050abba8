"""The part of a film's friction that spreads evenly over the ellipse (theory.md section 23).

A film shears at S_0 + alpha p: dF = (S_0 dA + alpha dQ) v/|v|. The second part sums as Coulomb's
friction does, over shares of the load; the first sums over shares of the area. They are taken at
the same points.
"""

from bearingwear.kernels.contact.points import area_shares
from bearingwear.kernels.contact.slip import quick_dissipation
from bearingwear.kernels.contact.traction import traction, traction_slope
from bearingwear.kernels.decorators import jit


@jit
def add_even_part(rule, contact, R, c, v_r, points, even, even_hessian, gradient, hessian, slope):
    """Add to `gradient`, and where asked to `hessian`, those of the even part.

    `points` keep shares of the area, `even` and `even_hessian` the even part alone.
    """
    area_shares(rule, contact, R, c, v_r, points)
    mu, n = contact.mu_even, gradient.size
    if slope:
        traction_slope(contact, c, mu, v_r, points, even, even_hessian)
        for i in range(n):
            for j in range(n):
                hessian[i, j] += even_hessian[i, j]
    else:
        traction(contact, c, mu, v_r, points, even)
    for i in range(n):
        gradient[i] += even[i]


@jit
def even_dissipation(contact, c, v_r, r, points):
    """Heat [W] and torque [N m] of the even part, as `contact.dissipation` has them."""
    _, heat, _, torque = quick_dissipation(contact, c, contact.mu_even, v_r, r, points)
    return heat, torque
