"""A bearing under thrust without friction: its force over displacement, and its lift-off."""

import math
from typing import NamedTuple

from scipy.optimize import brentq

from bearingwear.kernels.equilibrium import cold_start, orbit_load, thrust_equilibrium
from bearingwear.kernels.params import Geometry


class Mechanics(NamedTuple):
    """A bearing whose balls orbit at a given rate, or not at all."""

    g: Geometry
    D: float  # worn ball diameter [m]
    Omega: float = 0.0  # orbit rate of the balls [rad/s]

    def _solved(self, F_x: float, delta_a: float, constant_force: bool) -> tuple[float, ...]:
        """Place [m], force [N] and axial stiffness [N/m]."""
        load = orbit_load(self.Omega, 0.0, 0.0)
        place, state = thrust_equilibrium(
            self.g, self.D, load, F_x, delta_a, constant_force, cold_start()
        )
        return place, self.g.n_balls * state.F_ix, self.g.n_balls * state.S_xx

    def force(self, delta_a: float) -> float:
        """Axial force at an axial displacement [m], 0 where the balls are loose [N]."""
        return self._solved(0.0, delta_a, False)[1]

    def force_and_stiffness(self, delta_a: float) -> tuple[float, float]:
        """The same, and its slope [N/m]."""
        _, force, stiffness = self._solved(0.0, delta_a, False)
        return force, stiffness

    def place(self, F_x: float) -> float:
        """Axial displacement under an axial force [N] [m]."""
        return self._solved(F_x, self.touch, True)[0]

    @property
    def touch(self) -> float:
        """Axial displacement at which balls at rest lose their load [m]."""
        g = self.g
        free, across = g.r_i + g.r_o - self.D, g.BD * math.cos(g.alpha0)
        return math.sqrt(max(free * free - across * across, 0.0)) - g.BD * math.sin(g.alpha0)


def lift_off_rigid(first: Mechanics, second: Mechanics, closed: float) -> float:
    """Least axial force, either way, that lifts off a bearing of a rigid pair [N].

    Parameters
    ----------
    first, second : Mechanics
        At rest.
    closed : float
        Sum of the axial displacements of both [m].
    """
    on_first, on_second = first.force(closed - second.touch), second.force(closed - first.touch)
    return min(on_first, on_second)


def lift_off_spring(
    first: Mechanics, second: Mechanics, mounted: tuple[float, float], F_s: float, k_s: float
) -> float:
    """Axial force away from the first bearing of a spring pair that lifts it off [N].

    Parameters
    ----------
    first, second : Mechanics
        At rest.
    mounted : tuple of float
        Axial displacements of both when mounted [m].
    F_s, k_s : float
        Force of the spring then [N] and its stiffness [N/m].
    """

    def left(F: float) -> float:
        extended = first.touch - mounted[0] + second.place(F) - mounted[1]
        return F_s - k_s * extended - F

    if k_s == 0.0:
        return F_s
    most = F_s
    while left(most) > 0.0:
        most *= 2.0
    return float(brentq(left, 1e-9 * F_s, most)) if left(1e-9 * F_s) > 0.0 else 0.0
