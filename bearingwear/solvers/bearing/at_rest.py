"""Bearings under thrust without friction: force over displacement, lift-off, a pair at rest."""

import math
from typing import Any, NamedTuple

import numpy as np

from bearingwear.kernels.equilibrium.thrust_loaded import cold_start, orbit_load, thrust_equilibrium
from bearingwear.kernels.params import BallState, Geometry
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.mounted import mounted_geometry
from bearingwear.solvers.bearing.outputs import stiffness_of_loads
from bearingwear.solvers.roots import brent_root

FIRST_REACH = 1e-6  # of the search for the place of a spring [m]
_SLIDE_ROUNDING = {"xtol": 1e-18, "rtol": 1e-14}
"""Tolerances [m] and [1] of that search: about the last bits of a slide of micrometres."""


def race_displacement(g: Geometry, length: Any) -> Any:
    """Returns the axial displacement of the inner race at a distance of the groove centres [m].

    It counts from where the contact angle is the free one. A length below the radial distance of
    the centres, which no displacement gives, counts as that distance.

    length: distance of the groove centres [m], a number or an array.
    """
    across = g.BD * math.cos(g.alpha0)
    return np.sqrt(np.maximum(length**2 - across**2, 0.0)) - g.BD * math.sin(g.alpha0)


class Mechanics(NamedTuple):
    """A bearing without friction, whose balls orbit at a given rate, or not at all."""

    g: Geometry
    D: float  # worn ball diameter [m]
    Omega: float = 0.0  # orbit rate of the balls [rad/s]

    def _equilibrium(self, F_x: float) -> tuple[float, BallState]:
        """Returns the axial displacement [m] under an axial force [N], and the state of a ball."""
        load = orbit_load(self.Omega, 0.0, 0.0)
        return thrust_equilibrium(self.g, self.D, load, F_x, self.touch, True, cold_start())

    def force(self, delta_a: float) -> float:
        """Returns the axial force [N] at an axial displacement [m]; 0 where the balls are loose."""
        force, _ = self.force_and_stiffness(delta_a)
        return force

    def force_and_stiffness(self, delta_a: float) -> tuple[float, float]:
        """Returns the axial force of all balls [N] and its slope [N/m] at a displacement [m]."""
        load = orbit_load(self.Omega, 0.0, 0.0)
        _, ball = thrust_equilibrium(self.g, self.D, load, 0.0, delta_a, False, cold_start())
        return self.g.n_balls * ball.F_ix, self.g.n_balls * ball.S_xx

    def place(self, F_x: float) -> float:
        """Returns the axial displacement [m] under an axial force [N]."""
        displacement, _ = self._equilibrium(F_x)
        return displacement

    def stiffness_matrix(self, F_x: float) -> np.ndarray:
        """Returns the stiffness (5, 5) under an axial force [N], in units [N/m, N, N m].

        Rows and columns: displacements along X, Y and Z, tilts about Y and Z.
        """
        _, ball = self._equilibrium(F_x)
        load, angle = np.array([ball.Q_i, ball.Q_o]), np.array([ball.alpha_i, ball.alpha_o])
        return stiffness_of_loads(self.g, np.array([self.D]), load, angle)

    @property
    def touch(self) -> float:
        """Returns the axial displacement at which balls at rest lose their load [m]."""
        return float(race_displacement(self.g, self.g.r_i + self.g.r_o - self.D))


class RestingPair(NamedTuple):
    """Two identical bearings at rest, unworn, preloaded against each other at a fixed distance."""

    bearing: Mechanics
    preload: float  # [N]

    @classmethod
    def of(cls, scene: Scene) -> "RestingPair":
        """Returns a pair of the scene's bearing under its preload, whatever its arrangement."""
        g = mounted_geometry(scene)
        return cls(Mechanics(g, g.D0), float(scene.operation.preload_N))

    @property
    def rigidity(self) -> tuple[float, float]:
        """Returns axial and radial stiffness of the pair [N/m]."""
        K = self.bearing.stiffness_matrix(self.preload)
        return 2.0 * float(K[0, 0]), 2.0 * float(K[1, 1])

    @property
    def lift_off(self) -> float:
        """Returns the least axial force on the shaft that takes the load off one bearing [N]."""
        mounted = self.bearing.place(self.preload)
        return AxialRotor((self.bearing, self.bearing), (mounted, mounted)).opening_force

    def clearance(self, measuring_load: float) -> float:
        """Returns the axial clearance of the pair under a measuring load, as makers state it [m].

        It is the displacement of both bearings under that load less that under the preload. It is
        negative where the preload is the larger load.

        measuring_load: [N].
        """
        return 2.0 * (self.bearing.place(measuring_load) - self.bearing.place(self.preload))


class PreloadSpring(NamedTuple):
    """The spring that preloads the second outer ring."""

    force: float  # at mounting [N]
    stiffness: float  # [N/m]
    stop: float = math.inf  # distance to the stop [m]


class AxialRotor(NamedTuple):
    """A rotor at rest between two sides that face each other, at a fixed position or on a spring.

    Sides have the `force` and `touch` of `Mechanics`.
    """

    sides: tuple[Any, Any]
    mounted: tuple[float, float]  # axial displacements [m]
    spring: PreloadSpring | None = None

    def external(self, k: int, delta_a: float) -> float:
        """Returns the axial force on the rotor, towards +X, at a displacement of one side [N].

        Infinite where no force gives that displacement, because the spring has no stiffness.

        k: number of the side, 0 or 1.
        delta_a: its axial displacement [m].
        """
        first, second = self.sides
        mounted = sum(self.mounted)
        if k == 0:
            return float(first.force(delta_a) - self._force_of_second(mounted - delta_a))
        F_2 = second.force(delta_a)
        slide = 0.0  # of the second outer ring
        if self.spring is not None:
            F_s, k_s, stop = self.spring
            pressed = (F_s - F_2) / k_s if k_s else math.copysign(math.inf, F_s - F_2)
            slide = max(pressed, -stop)
            if math.isinf(slide):
                return slide
        return float(first.force(mounted + slide - delta_a) - F_2)

    def _force_of_second(self, place: float) -> float:
        """Returns the axial force of the second side, whose outer ring slides on its spring [N].

        place: axial displacement of its inner race [m].
        """
        second = self.sides[1]
        if self.spring is None:
            return float(second.force(place))
        F_s, k_s, stop = self.spring

        def unbalanced(slide: float) -> float:
            """Returns the force on the outer ring beyond that of its spring [N]."""
            return second.force(place + slide) - F_s + k_s * slide

        reach = FIRST_REACH
        while unbalanced(reach) < 0.0 or unbalanced(-reach) > 0.0:
            reach *= 2.0
        slide = brent_root(unbalanced, -reach, reach, **_SLIDE_ROUNDING)
        return F_s - k_s * slide if slide > -stop else float(second.force(place - stop))

    @property
    def opening_force(self) -> float:
        """Returns the least axial force, in either direction, that unloads a side [N].

        0 if a side is loose already, infinite if no force unloads one.
        """
        first, second = self.sides
        opens_first = -self.external(0, first.touch)
        opens_second = self.external(1, second.touch)
        return max(min(opens_first, opens_second), 0.0)
