"""A ball by itself: mass, inertia and the drag of the lubricant."""

import math

from bearingwear.kernels.decorators import inlined, jit


@inlined
def ball_mass(rho, D):
    """Mass of a ball of diameter D [m] and density rho [kg/m3] [kg]."""
    return rho * math.pi / 6.0 * D**3


@inlined
def ball_inertia(m, D):
    """Moment of inertia 2/5 m R^2 of a ball of mass m [kg m2]."""
    return 0.1 * m * D * D


@jit
def drag_force(g, D, drag, Omega):
    """Lubricant drag along +y on a ball that orbits, and its slope (theory.md Eq. 17)."""
    c = math.pi / 8.0 * drag * D * D * (0.5 * g.dm) ** 2
    return c * Omega * abs(Omega), 2.0 * c * abs(Omega)
