"""The contact's profile: the only place that knows the groove, the pressure and the contact law.

A groove of radius r_g and a ball of radius R press each other to an arc of radius R_d. Along the
major axis, -1 < t = x/a < 1, the pressure is Hertz' semi-ellipse (theory.md sections 1 and 3).
"""

import math
from typing import NamedTuple

from bearingwear.kernels.decorators import inlined

PEAK = 0.75  # load per length of t in the middle of the contact, as a share of the load [1]
MIDDLE_WIDTH = 2.0 / math.pi  # area per length of t there, as a share of the ellipse [1]
STORED = 0.4  # elastic energy over Q d: the integral of K d^1.5 is 2/5 K d^2.5 [1]


class Profile(NamedTuple):
    """Pressed surface of one contact."""

    R_d: float  # radius of its arc [m]
    ball: float  # height of its ends on the ball's sphere [m]
    arc: float  # and on the arc, from the arc's own centre [m]


@inlined
def profile(r_g, R, a):
    """Pressed surface of a ball of radius R in a groove of radius r_g, semi-major axis a [m]."""
    R_d = 2.0 * r_g * R / (r_g + R)
    return Profile(R_d=R_d, ball=math.sqrt(R * R - a * a), arc=math.sqrt(R_d * R_d - a * a))


@inlined
def base(p):
    """Distance of the arc's centre from the ball's [m]."""
    return p.ball - p.arc


@inlined
def height(p, x):
    """Distance of the point at x from the ball's centre, along the contact normal (Eq. 8) [m]."""
    return math.sqrt(p.R_d * p.R_d - x * x) + base(p)


@inlined
def middle_height(p):
    """`height` in the middle of the contact, x = 0 [m]."""
    return p.R_d - p.arc + p.ball


@inlined
def pressure(t):
    """Pressure integrated across the contact, over that in the middle; t a float or an array."""
    return 1.0 - t * t


@inlined
def pressure_integral(t):
    """Integral of `pressure` from 0 to t, t a float or an array."""
    return t - t**3 / 3.0


@inlined
def contact_load(K, d):
    """Load of a closed contact at the approach d > 0, Q = K d^1.5 [N]."""
    return K * d * math.sqrt(d)


@inlined
def contact_stiffness(Q, d):
    """Slope dQ/dd at the approach d > 0 [N/m]."""
    return 1.5 * Q / d


@inlined
def contact_approach(K, Q):
    """Approach under the load Q, the inverse of `contact_load` [m]."""
    return (Q / K) ** (2.0 / 3.0)


@inlined
def semi_axis(c, Q):
    """Semi-axis of the ellipse under the load Q from its factor, a = c_a Q^(1/3) [m]."""
    return c * Q ** (1.0 / 3.0)


@inlined
def elastic_energy(Q, d):
    """Elastic energy of a contact under the load Q at the approach d [J]."""
    return STORED * Q * d
