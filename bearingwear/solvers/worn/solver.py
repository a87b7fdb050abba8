"""A bearing whose grooves wear, as a solver (section 21)."""

import copy
import functools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.ball import ball_inertia, ball_mass, drag_force
from bearingwear.kernels.contact.profile import contact_approach, semi_axis
from bearingwear.kernels.equilibrium.thrust_loaded import cold_start, orbit_load, thrust_equilibrium
from bearingwear.kernels.steady.thrust import skid_ratio
from bearingwear.scene.friction import friction_changes_with_wear
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.outputs import friction_used
from bearingwear.solvers.condition import Condition, SolvedBearing
from bearingwear.solvers.roots import brent_root
from bearingwear.solvers.state import State
from bearingwear.solvers.steady import Steady
from bearingwear.solvers.thermal import HeatFlow
from bearingwear.solvers.worn.bearing import ROUGH, WornBearing
from bearingwear.solvers.worn.depths import WornDepths, WornPoint, seat_force
from bearingwear.solvers.worn.films import WornFilms

_HEAT_OF_ROUGH = 10.0  # error of the heat of a rough state over that of its balance
_NEAR = 0.02  # of the approaches: first range about the guess in which an even loss is sought
_FURTHER = 12  # extensions of this range, each twice as long
_CLOSE = 1e-9  # of the approaches: accuracy of the even loss


@dataclass
class _Memory:
    """Results that later solves and states start from, at whatever temperatures."""

    slope: float  # last stiffness [N/m]
    offset: float | None = None  # even loss at the start less that of the scene [m]
    ahead: float = 0.0  # last even loss less that of the approaches, over the approaches


def _largest_loss_of_life(scene: Scene) -> float:
    """Returns the loss of ball diameter that the criteria of a scene allow [m].

    It is infinite where they do not limit the loss, and 0 without any criterion.
    """
    end = scene.wear.end_of_life
    if end is None:
        return 0.0
    limit = end.ball_diameter_loss_um
    return math.inf if limit is None else limit * parameters.UM


class Worn(Steady):
    """A bearing with worn grooves; each solve starts from the last one.

    unworn: its solution without wear, by `Steady`.
    cells: numbers along the major axis, and on each side of it.
    """

    def __init__(self, scene: Scene, unworn: SolvedBearing, cells: tuple[int, int]):
        self.scene, self.problem, self.start = scene, unworn.problem, unworn.condition
        self.mounted = parameters.static_place(scene)
        self.factors = parameters.wear_factors(scene)
        has_films = scene.friction.film is not None or friction_changes_with_wear(scene)
        self.bearing = WornBearing(
            self.problem,
            unworn.answer,
            self.start.loss,
            cells,
            wander=scene.wear.track_wander,
            films=WornFilms.of(scene) if has_films else None,
            most_worn=_largest_loss_of_life(scene),
        )
        self.memory = _Memory(unworn.steepness)

    def elsewhere(self, scene: Scene) -> "Worn":
        """Returns the solver with the same grooves at the speed and temperatures of a scene.

        Both share one bearing, whose grooves wear no further from now on.
        """
        solver = copy.copy(self)
        solver.scene, solver.problem = scene, self.problem.of(scene).without_finer
        solver.mounted = solver.problem.preload.delta_a
        solver.bearing.stop_wear()
        return solver

    @property
    def heat_error(self) -> float:  # type: ignore[override]
        """Returns the relative error of the heat of a roughly balanced state on the way; else 0."""
        return _HEAT_OF_ROUGH * ROUGH if self.bearing.on_the_way else 0.0

    @staticmethod
    def condition(wear: WornDepths) -> Condition:
        """Returns the condition with some wear; its loss is the balls' and the deepest grooves'."""
        deepest = float(wear.grooves.max(axis=1, initial=0.0).sum())
        return Condition(wear.ball + deepest, depths=wear)

    def __call__(self, condition: Condition, near: SolvedBearing | None = None) -> SolvedBearing:
        """Returns the bearing solved, from its last state; `near` is not used.

        It has no stiffness, see `with_stiffness`. On failure all numbers are NaN, and the bearing
        keeps its last state.
        """
        assert condition.depths is not None
        point = self.bearing.solve(condition.depths, self.problem_in(condition))
        if point.status != code.OK:
            return SolvedBearing(point.status, condition, self.scene)
        return SolvedBearing(
            status=point.status,
            condition=condition,
            scene=self.scene,
            force=seat_force(point.problem.g, point.seat),
            slope=self.memory.slope,
            place=point.seat.delta_a,
            problem=point.problem,
            answer=point,
        )

    def with_stiffness(self, solution: SolvedBearing) -> SolvedBearing:
        """Returns the last solution with both stiffnesses, NaN where a state nearby is missing.

        Its steepness becomes the slope of the next solves; where it is NaN, they keep the last one.
        """
        dynamic, quasistatic = self.bearing.axial_stiffnesses(solution.answer).tolist()
        # without the slope of a solution nearby, the steepness is that of the new stiffnesses
        with_both = solution._replace(stiffness=dynamic, quasistatic=quasistatic, slope=math.nan)
        if not math.isnan(with_both.steepness):
            self.memory.slope = with_both.steepness
        return with_both

    def heat(self, solution: SolvedBearing) -> HeatFlow:
        """Returns the heat of friction and drag of all balls in a solution."""
        point: WornPoint = solution.answer
        g, op, n = point.problem.g, point.problem.op, point.problem.g.n_balls
        r = g.R_o + point.seat.X2
        Omega = float(point.u[3])
        drag = drag_force(g, point.D, op.drag, Omega)[0] * r * Omega
        inner, outer = (float(n * heat) for heat in point.slip[:, 1])
        return HeatFlow(inner, outer, drag=float(n * drag))

    def rate(self, solution: SolvedBearing) -> WornDepths:
        """Returns the wear per second in a solution, as depths [m/s]."""
        ball, race = self.factors
        return self.bearing.rate(solution.answer, ball, race, solution.scene)

    def approach_loss(self, point: WornPoint) -> float:
        """Returns L: ball diameter lost, plus the approach of both contacts beyond Hertz' [m]."""
        loss = self.start.loss + point.wear.ball
        for k, force in enumerate(point.forces):
            depth = self.bearing.lengths(point)[k]
            loss += depth - contact_approach(force.hertz.K, force.Q)
        return loss

    def even_loss(self, point: WornPoint) -> float:
        """Returns L_eq: even loss of diameter with the same rotor position or preload [m].

        The first call defines its zero: there it is the loss of the scene. NaN where none is found.
        """
        if self.memory.offset is None:
            self.memory.offset = 0.0
            self.memory.offset = self.even_loss(point) - self.start.loss
            return self.start.loss
        g, hold, seat = point.problem.g, point.problem.preload, point.seat
        preload = seat_force(g, seat)
        load = orbit_load(float(point.u[3]), seat.F_i, seat.F_o)
        state = cold_start()
        scale = seat.inner.approach + seat.outer.approach

        @functools.cache
        def difference(loss: float) -> float:
            """Returns how far the evenly worn bearing is from the position or preload [1]."""
            nonlocal state
            delta_a, state = thrust_equilibrium(
                g, g.D0 - loss, load, hold.F_x, seat.delta_a, hold.constant_force, state
            )
            if hold.constant_force:
                return (delta_a - seat.delta_a) / scale
            return 1.0 - g.n_balls * state.F_ix / preload

        guess = self.approach_loss(point) + self.memory.ahead * scale
        width = _NEAR * scale
        low = guess
        high = guess
        for _ in range(_FURTHER):
            low, high, width = low - width, high + width, 2.0 * width
            if difference(low) <= 0.0 <= difference(high):
                break
        try:
            root = brent_root(difference, low, high, xtol=_CLOSE * scale, rtol=1e-14)
        except ValueError:
            return float("nan")
        self.memory.ahead += (root - guess) / scale
        return root - self.memory.offset

    def state(self, solution: SolvedBearing) -> State:
        """Returns the state of a solution, without its rate of loss and stiffnesses.

        These need the states beside it, and more solves.
        """
        point = solution.answer
        values = self._values_without_films(point) | self._film_values(solution)
        values["friction_power"] = self.heat(solution).total
        return State(point.status, values, solution)

    def _film_values(self, solution: SolvedBearing) -> dict[str, Any]:
        """Returns the result variables that films and running in change; empty without any.

        `film_left` has the order inner race, outer race, balls; `film_worn_share` is the mean over
        the loaded cells of the inner and of the outer contact.
        """
        films, point = self.bearing.films, solution.answer
        if films is None:
            return {}
        D = point.D
        shares = []
        for k, force in enumerate(point.forces):
            on_arc = self.bearing.bare(point.wear, k)
            g = point.problem.g
            bare = self.bearing.at_cells(on_arc, k, point.x[k], force.alpha, g)
            shares.append(bare[point.pressure[k].max(axis=0) > 0.0].mean())
        rate = self.rate(solution)
        area = rate.grooves.sum(axis=1) * self.bearing.arc_step
        return {
            "ball_wear_rate": 0.5 * np.pi * D * D * rate.ball,
            "race_wear_rate": 2.0 * np.pi * point.track * area,
            "film_left": films.films.thickness - point.wear.deepest,
            "film_worn_share": np.array(shares),
        }

    def _values_without_films(self, point: WornPoint) -> dict[str, Any]:
        """Returns the result variables of a state, as if it had no films."""
        g, op, D = point.problem.g, point.problem.op, point.D
        forces = point.forces
        r = g.R_o + point.seat.X2
        alpha = np.array([f.alpha for f in forces])
        qv, _, share, _, mu = point.slip.T
        ball, race = self.factors
        moment = ball_inertia(ball_mass(g.rho, D), D) * abs(point.u[3] * point.u[2])
        load = np.array([f.Q for f in forces])
        return {
            "ball_diameter_loss": self.even_loss(point),
            "residual_preload": seat_force(g, point.seat),
            "contact_load": load,
            "contact_angle": alpha,
            "semi_major_axis": np.array([semi_axis(f.hertz.c_a, f.Q) for f in forces]),
            "qv": qv,
            "total_qv": float(g.n_balls * qv.sum()),
            "gyroscopic_slip_share": share,
            "skid_ratio": skid_ratio(op, alpha[0], alpha[1], 0.5 * D, r, point.u),
            "maximum_pressure": max(f.peak for f in forces),
            "greatest_depth": float(point.wear.grooves.max()),
            "ball_wear_rate": float(ball * qv.sum()),
            "race_wear_rate": g.n_balls * race * qv,
            "axial_displacement": point.seat.delta_a,
            "friction_used_by_gyroscopic_moment": float(friction_used(mu, D, moment, load)),
            "friction_coefficient": mu,
        }
