"""Wear of a bearing along its grooves and balls, and a state with it (section 21)."""

import functools
from dataclasses import dataclass, field

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.contact.hertz import OUTER, race_contact
from bearingwear.kernels.contact.profile import contact_approach
from bearingwear.kernels.contact.summary import ANGLE, LOAD
from bearingwear.kernels.params import Geometry, Hertz
from bearingwear.kernels.steady.thrust import ThrustCase
from bearingwear.kernels.worn.balance import Arc, WornForce, spline_pieces
from bearingwear.kernels.worn.state import WornSeat
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem

UNWORN_ARC = Arc(0.0, 1.0, np.zeros((4, 0)))
_NO_HERTZ = Hertz(K=0.0, c_a=0.0, c_b=0.0, log_kappa=0.0, E=0.0)
NO_FORCE = WornForce(code.OK, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, _NO_HERTZ)
NOWHERE = WornSeat(code.NOT_CONVERGED, 0.0, 0.0, 0.0, NO_FORCE, NO_FORCE, 0.0, 0.0)
"""The seat of a point that was not solved."""
_TAILS = 6.0  # reach of a Gaussian, over its rms


@dataclass(frozen=True, eq=False)
class WornDepths:
    """Wear: even loss of the balls, and depths of the grooves over their grids."""

    ball: float  # even loss of ball diameter [m]
    grooves: np.ndarray  # (2, arcs) depth [m]

    @property
    def deepest(self) -> np.ndarray:
        """Returns the largest depth of inner groove, outer groove and balls (3,) [m].

        That of the balls is half of their loss of diameter.
        """
        return np.array([*self.grooves.max(axis=1), 0.5 * self.ball])

    def plus(self, dt: float, rate: "WornDepths") -> "WornDepths":
        """Returns the wear after a time dt at a rate, itself a wear per second."""
        return WornDepths(
            self.ball + dt * rate.ball,
            self.grooves + dt * rate.grooves,
        )


@dataclass(frozen=True, eq=False)
class WornPoint:
    """A steady state with some wear, or the status of its failure."""

    status: int
    wear: WornDepths
    problem: ThrustProblem
    seat: WornSeat = NOWHERE
    u: np.ndarray = field(default_factory=lambda: np.zeros(0))  # (4,) motion of a ball [rad/s]
    slip: np.ndarray = field(default_factory=lambda: np.zeros(0))  # (2, 5), see `FrictionWork.slip`
    qv_along: tuple[np.ndarray, ...] = ()  # QV per length at the cells, inner and outer [W/m]
    x: tuple[np.ndarray, ...] = ()  # the cells along the major axis [m]
    pressure: tuple[np.ndarray, ...] = ()  # (m, n) each, over the peak of Hertz
    track: np.ndarray = field(default_factory=lambda: np.zeros(0))  # (2,) radius [m]
    D: float = np.nan  # ball diameter, its even loss taken off [m]

    @property
    def forces(self) -> tuple[WornForce, WornForce]:
        """Returns the forces in the contacts with inner and outer race."""
        return self.seat.inner, self.seat.outer


def seat_force(g: Geometry, seat: WornSeat) -> float:
    """Returns the axial force of the inner race on all balls [N]."""
    inner = seat.inner
    across = seat.inner.T + seat.F_i
    return float(g.n_balls * (inner.Q * np.sin(inner.alpha) + across * np.cos(inner.alpha)))


def depth_spline(places: np.ndarray, step: float, depth: np.ndarray) -> Arc:
    """Returns a depth over equally spaced places as a cubic spline.

    places: (n,) [m], `step` apart.
    """
    c = np.empty((4, depth.size - 1))
    spline_pieces(float(step), depth, c)
    return Arc(float(places[0]), float(step), c)


def arc_values(arc: Arc, places: np.ndarray) -> np.ndarray:
    """Returns values of a spline at places [m]; beyond its ends they are those at the ends."""
    steps = (places - arc.first) / arc.step
    piece = np.clip(np.floor(steps).astype(int), 0, arc.c.shape[1] - 1)
    x = np.clip(steps - piece, 0.0, 1.0) * arc.step
    c = arc.c[:, piece]
    return np.asarray(((c[0] * x + c[1]) * x + c[2]) * x + c[3])


def spread_by_wander(
    grid: np.ndarray, places: np.ndarray, values: np.ndarray, wander: float
) -> np.ndarray:
    """Returns values at equally spaced places, spread over a grid by the wander of the track.

    Their integral is kept, but for what the wander moves beyond the ends of the grid.

    grid: equally spaced; values outside `places` are 0.
    wander: rms of a Gaussian, in the unit of the grid; 0 for none.
    """
    on_grid = np.interp(grid, places, values, left=0.0, right=0.0)
    step = grid[1] - grid[0]
    total = on_grid.sum() * step
    if total > 0.0:
        on_grid *= values.sum() * (places[1] - places[0]) / total
    if wander > 0.0:
        weights = _gaussian_weights(float(wander / step))
        on_grid = np.convolve(on_grid, weights)[weights.size // 2 :][: grid.size]
    return on_grid


@functools.lru_cache(maxsize=16)
def _gaussian_weights(rms: float) -> np.ndarray:
    """Returns weights of a Gaussian at whole places about its middle, out to six times its rms."""
    reach = int(_TAILS * rms + 0.5)
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / rms) ** 2)
    return weights / weights.sum()


def seat_of_case(case: ThrustCase, g: Geometry, D: float, worn: float) -> WornSeat:
    """Returns the position of a ball whose contacts bear the loads of a Hertzian state.

    Its forces are not computed (`NO_FORCE`).

    D: worn ball diameter [m].
    worn: depth of the outer groove beyond its pressed surface [m].
    """
    alpha = case.contacts[1, ANGLE]
    hertz = race_contact(g, OUTER, D, np.cos(alpha), np.nan)
    length = g.r_o - 0.5 * D + worn + contact_approach(hertz.K, case.contacts[1, LOAD])
    return WornSeat(
        status=code.OK,
        X1=float(length * np.sin(alpha)),
        X2=float(length * np.cos(alpha)),
        delta_a=float(case.delta_a),
        inner=NO_FORCE,
        outer=NO_FORCE,
        F_i=float(case.T_i),
        F_o=float(case.T_o),
    )
