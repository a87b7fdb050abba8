"""Bearings under thrust without friction: force over displacement, lift-off, a pair at rest."""

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from bearingwear.kernels.equilibrium.thrust_loaded import cold_start, orbit_load, thrust_equilibrium
from bearingwear.kernels.params import BallState, Geometry
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.mounted import mounted_geometry
from bearingwear.solvers.bearing.outputs import stiffness_of_loads


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
        g = self.g
        free, across = g.r_i + g.r_o - self.D, g.BD * math.cos(g.alpha0)
        return math.sqrt(max(free * free - across * across, 0.0)) - g.BD * math.sin(g.alpha0)


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
        return lift_off_rigid(self.one, self.one, 2.0 * self.one.place(self.preload))

    def clearance(self, measuring_load: float) -> float:
        """Axial clearance under a measuring load [N]: negative where it has been closed [m]."""
        return 2.0 * (self.one.place(measuring_load) - self.one.place(self.preload))


def lift_off_rigid(first: Mechanics, second: Mechanics, closed: float) -> float:
    """Least axial force, either way, that lifts off a bearing of a rigid pair [N].

    Both axial displacements add up to `closed` [m].
    """
    on_first, on_second = first.force(closed - second.touch), second.force(closed - first.touch)
    return min(on_first, on_second)


def lift_off_spring(
    first: Mechanics, second: Mechanics, mounted: tuple[float, float], F_s: float, k_s: float
) -> float:
    """Axial force away from the first bearing of a spring pair that lifts it off [N].

    When mounted, the bearings have these axial displacements [m], and the spring the force F_s [N].
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
