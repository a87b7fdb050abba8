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

FIRST_REACH = 1e-6  # [m]


def race_displacement(g: Geometry, length: Any) -> Any:
    """Axial displacement of the inner race where the groove centres are so far apart [m]."""
    across = g.BD * math.cos(g.alpha0)
    return np.sqrt(np.maximum(length**2 - across**2, 0.0)) - g.BD * math.sin(g.alpha0)


class Mechanics(NamedTuple):
    """A bearing whose balls orbit at a given rate, or not at all."""

    g: Geometry
    D: float  # worn ball diameter [m]
    Omega: float = 0.0  # orbit rate of the balls [rad/s]

    def _solved(self, F_x: float, delta_a: float, constant_force: bool) -> tuple[float, BallState]:
        """Place [m], and one of its balls."""
        load = orbit_load(self.Omega, 0.0, 0.0)
        return thrust_equilibrium(self.g, self.D, load, F_x, delta_a, constant_force, cold_start())

    def force(self, delta_a: float) -> float:
        """Axial force at an axial displacement [m], 0 where the balls are loose [N]."""
        return self.force_and_stiffness(delta_a)[0]

    def force_and_stiffness(self, delta_a: float) -> tuple[float, float]:
        """Axial force [N] and its slope [N/m]."""
        _, ball = self._solved(0.0, delta_a, False)
        return self.g.n_balls * ball.F_ix, self.g.n_balls * ball.S_xx

    def place(self, F_x: float) -> float:
        """Axial displacement under an axial force [N] [m]."""
        return self._solved(F_x, self.touch, True)[0]

    def stiffness_matrix(self, F_x: float) -> np.ndarray:
        """Stiffness (5, 5) under an axial force [N], as `stiffness_of_loads` [N/m, N, N m]."""
        _, ball = self._solved(F_x, self.touch, True)
        load, angle = np.array([ball.Q_i, ball.Q_o]), np.array([ball.alpha_i, ball.alpha_o])
        return stiffness_of_loads(self.g, np.array([self.D]), load, angle)

    @property
    def touch(self) -> float:
        """Axial displacement at which balls at rest lose their load [m]."""
        return float(race_displacement(self.g, self.g.r_i + self.g.r_o - self.D))


class RestingPair(NamedTuple):
    """Two like bearings, unworn, held against each other at a distance, nothing turning."""

    one: Mechanics
    preload: float  # [N]

    @classmethod
    def of(cls, scene: Scene) -> "RestingPair":
        """Of the bearing of a scene under its preload, whatever its arrangement."""
        g = mounted_geometry(scene)
        return cls(Mechanics(g, g.D0), float(scene.operation.preload_N))

    @property
    def rigidity(self) -> tuple[float, float]:
        """Axial and radial stiffness of the pair [N/m]."""
        K = self.one.stiffness_matrix(self.preload)
        return 2.0 * float(K[0, 0]), 2.0 * float(K[1, 1])

    @property
    def lift_off(self) -> float:
        """Axial force on the shaft that takes the load off one of them [N]."""
        mounted = self.one.place(self.preload)
        return AxialRotor((self.one, self.one), (mounted, mounted)).opening_force

    def clearance(self, measuring_load: float) -> float:
        """Axial clearance under a measuring load [N]: negative where it has been closed [m]."""
        return 2.0 * (self.one.place(measuring_load) - self.one.place(self.preload))


class PreloadSpring(NamedTuple):
    """Of the second outer ring."""

    force: float  # as mounted [N]
    stiffness: float  # [N/m]
    stop: float = math.inf  # way to it [m]


class AxialRotor(NamedTuple):
    """A rotor at rest between two sides that face each other, at a fixed position or on a spring.

    Sides have the `force` and `touch` of `Mechanics`.
    """

    sides: tuple[Any, Any]
    mounted: tuple[float, float]  # axial displacements [m]
    spring: PreloadSpring | None = None

    def external(self, k: int, delta_a: float) -> float:
        """Axial force on the rotor that displaces one of its sides so [N].

        Towards +X; infinite where none does.
        """
        (one, two), closed, slide = self.sides, sum(self.mounted), 0.0
        if k == 0:
            return float(one.force(delta_a) - self._force_of_second(closed - delta_a))
        F_2 = two.force(delta_a)
        if self.spring is not None:
            F_s, k_s, stop = self.spring
            pressed = (F_s - F_2) / k_s if k_s else math.copysign(math.inf, F_s - F_2)
            slide = max(pressed, -stop)
            if math.isinf(slide):
                return slide
        return float(one.force(closed + slide - delta_a) - F_2)

    def _force_of_second(self, place: float) -> float:
        """Axial force of the second side, whose outer ring slides, at a place of its inner race."""
        two = self.sides[1]
        if self.spring is None:
            return float(two.force(place))
        F_s, k_s, stop = self.spring

        def left(slide: float) -> float:
            return two.force(place + slide) - F_s + k_s * slide

        reach = FIRST_REACH
        while left(reach) < 0.0 or left(-reach) > 0.0:
            reach *= 2.0
        slide = brent_root(left, -reach, reach, xtol=1e-18, rtol=1e-14)
        return F_s - k_s * slide if slide > -stop else float(two.force(place - stop))

    @property
    def opening_force(self) -> float:
        """Least axial force, either way, that takes all load off a side [N]."""
        relieved = -self.external(0, self.sides[0].touch), self.external(1, self.sides[1].touch)
        return max(min(relieved), 0.0)
