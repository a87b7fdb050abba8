"""Wear life with grooves that are followed as they wear (theory.md section 21)."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from bearingwear.kernels import status as code
from bearingwear.kernels.ball import ball_inertia, ball_mass, drag_force
from bearingwear.kernels.equilibrium import cold_start, orbit_load, thrust_equilibrium
from bearingwear.kernels.profile import contact_approach, semi_axis
from bearingwear.kernels.thrust import skid_ratio
from bearingwear.kernels.worn_friction import unworn_contact
from bearingwear.model import parameters
from bearingwear.model.life import in_half_of_pair, margins
from bearingwear.model.life_integrator import LifeHistory, WearState
from bearingwear.model.steady import ThrustProblem
from bearingwear.model.values import friction_used, wear_values
from bearingwear.model.worn_states import WornBearing, WornDepths, WornPoint
from bearingwear.scene.blocks import CRITERIA, EndOfLife
from bearingwear.scene.scene import LARGEST_LOSS, Scene

WORN_CELLS = (48, 10)  # along the major axis, and on each side of it
FEWER_CELLS = (32, 8)  # to see the error of the others
STEP = 0.08  # deepest wear of a step, over the gap A a^2
_MOST_STEPS = 1000
_SHORTENINGS = 6  # of a step that fails, each by half
_SHORT = 0.3  # of the step before
_END = 1e-4  # of the last step, to which its end is found


@dataclass(frozen=True)
class WornLifeHistory:
    """A life step by step: states, what the rotor sees of them, and the profiles."""

    history: LifeHistory
    points: list[WornPoint]
    approach_loss: np.ndarray  # (steps,) L [m]
    bearing: WornBearing


class WornLife:
    """Heun steps of the wear of a bearing, watching the criteria."""

    def __init__(
        self,
        scene: Scene,
        problem: ThrustProblem | None = None,
        cells: tuple[int, int] = WORN_CELLS,
        step: float = STEP,
    ):
        self.scene, self.step = scene, step
        self.problem = problem or ThrustProblem.of(scene)
        self.D = float(parameters.ball_diameters(scene)[0])
        self.factors = parameters.wear_factors(scene)
        self.mounted = parameters.static_place(scene)
        self.end = scene.wear.end_of_life or EndOfLife()
        self.solves = 0
        self.offset: float | None = None  # of the even loss, at the start [m]
        self.bearing = WornBearing(
            self.problem,
            self.D,
            cells,
            bands=scene.wear.ball_track == "bands",
            wander=scene.wear.track_wander,
        )

    def at(self, wear: WornDepths, stiffness: bool = True) -> WornPoint:
        self.solves += 1
        return self.bearing.solve(wear, stiffness)

    def rate(self, point: WornPoint) -> WornDepths:
        return self.bearing.rate(point, *self.factors)

    def heun(self, point: WornPoint, rate: WornDepths, dt: float) -> WornPoint:
        """The state after the time dt; the one that failed, if one does."""
        ahead = self.at(point.wear.plus(dt, rate), stiffness=False)
        if ahead.status != code.OK:
            return ahead
        return self.at(point.wear.plus(dt, rate.mean(self.rate(ahead))))

    def longest_step(self, point: WornPoint, rate: WornDepths) -> float:
        """Time in which the deepest place wears by `step` of the gap at the edge [s]."""
        deepest = rate.grooves.max(axis=1) + rate.band.max(initial=0.0) + 0.5 * rate.ball
        return float(self.step / (deepest / self.bearing.gap_at_edge(point)).max())

    def margin(self, point: WornPoint) -> np.ndarray:
        """How far each criterion is from being met (4,), as `life.margins`."""
        return margins(self.state(point), self.end, self.scene.operation.preload_N)

    def march(self) -> WornLifeHistory:
        """Steps to the first criterion, or to where the solver or the range ends."""
        history = LifeHistory(
            states=[],
            times=[np.zeros(2)],
            error=np.zeros(2),
            criterion=len(CRITERIA) - 1,
            status=code.CRITERION_NOT_REACHED,
        )
        found = WornLifeHistory(history, [], np.zeros(0), self.bearing)
        status = self.problem.undetermined()
        if status == code.OK:
            status = self.bearing.status
        start = WornPoint(status, WornDepths(0.0, np.zeros(0), np.zeros(0)))
        if status == code.OK:
            start = self.at(self.bearing.unworn())
        if start.status != code.OK:
            history.status = start.status
            history.states.append(WearState(self.problem.g.D0 - self.D, start.status))
            return found
        points, times = [start], [0.0]
        met = np.flatnonzero(self.margin(start) <= 0.0)
        if met.size:
            history.criterion, history.status = int(met[0]), code.OK
        elif max(self.factors) > 0.0:
            self._extend(points, times, history)
        history.solves = self.solves
        history.states = self._states(points, np.array(times))
        history.times = [np.array([np.nan, t]) for t in times]
        losses = np.array([self.approach_loss(p) for p in points])
        return replace(found, points=points, approach_loss=losses)

    def _extend(self, points: list[WornPoint], times: list[float], history: LifeHistory) -> None:
        """Take steps until a criterion is met."""
        largest = LARGEST_LOSS * self.problem.g.D0
        for _ in range(_MOST_STEPS):
            point = points[-1]
            rate = self.rate(point)
            dt = self.longest_step(point, rate)
            new = self.heun(point, rate, dt)
            for _ in range(_SHORTENINGS):
                if new.status == code.OK:
                    break
                dt *= 0.5
                new = self.heun(point, rate, dt)
            if new.status != code.OK:
                history.status = new.status
                return
            before, after = self.margin(point), self.margin(new)
            met = np.flatnonzero(after <= 0.0)
            if met.size:
                shares = before[met] / (before[met] - after[met])
                k = int(met[np.argmin(shares)])
                dt, new = self._end_of(point, rate, dt, k, (before[k], after[k]), new)
                points.append(new)
                times.append(times[-1] + dt)
                history.criterion, history.status = k, code.OK
                return
            points.append(new)
            times.append(times[-1] + dt)
            if self.state(new).loss > largest:
                return

    def _end_of(self, point, rate, dt, k, margins_at, new):
        """Length and end of the step that meets criterion k."""
        reached = {dt: new}

        def value(part: float) -> float:
            if part == 0.0:
                return margins_at[0]
            if part == dt:
                return margins_at[1]
            reached[part] = self.heun(point, rate, part)
            return self.margin(reached[part])[k] if reached[part].status == code.OK else -1.0

        root = brentq(value, 0.0, dt, xtol=_END * dt, rtol=1e-12)
        solved = {part: p for part, p in reached.items() if p.status == code.OK}
        part = min(solved, key=lambda length: abs(length - root))
        return part, solved[part]

    def approach_loss(self, point: WornPoint) -> float:
        """L: ball diameter lost, and what the contacts gave way beyond Hertz [m]."""
        D = self.D - point.wear.ball
        loss = self.problem.g.D0 - D
        for k, force in enumerate(self.bearing.forces(point)):
            depth = self.bearing.lengths(point)[k]
            loss += depth - contact_approach(force.hertz.K, force.Q)
        return loss

    def even_loss(self, point: WornPoint) -> float:
        """L_eq: even loss of diameter with the same rotor position, or the same preload [m].

        Counted from that of the start, where it is that of the scene.
        """
        if self.offset is None:
            self.offset = 0.0
            self.offset = self.even_loss(point) - (self.problem.g.D0 - self.D)
        preload = self.preload(point)
        g, held, seat = self.problem.g, self.problem.preload, point.seat
        load = orbit_load(float(point.u[3]), seat.F_i, seat.F_o)
        state = cold_start()

        def away(loss: float) -> float:
            nonlocal state
            delta_a, state = thrust_equilibrium(
                g, g.D0 - loss, load, held.F_x, seat.delta_a, held.constant_force, state
            )
            if held.constant_force:
                return (delta_a - seat.delta_a) / scale
            return 1.0 - g.n_balls * state.F_ix / preload

        scale = seat.inner.approach + seat.outer.approach
        guess = self.approach_loss(point)
        low, high = guess - 0.5 * scale, guess + 0.5 * scale
        for _ in range(20):
            if away(low) <= 0.0:
                break
            low -= scale
        for _ in range(20):
            if away(high) >= 0.0:
                break
            high += scale
        try:
            root = brentq(away, low, high, xtol=1e-9 * scale, rtol=1e-14)
            return float(root) - self.offset
        except ValueError:
            return float("nan")

    def preload(self, point: WornPoint) -> float:
        """Axial force of all balls on the inner race [N]."""
        inner, across = point.seat.inner, point.seat.inner.T + point.seat.F_i
        axial = inner.Q * np.sin(inner.alpha) + across * np.cos(inner.alpha)
        return float(self.problem.g.n_balls * axial)

    def state(self, point: WornPoint) -> WearState:
        """A point as the other lives have it; the rate of loss is not known from it alone."""
        g, op = self.problem.g, self.problem.op
        forces = self.bearing.forces(point)
        D, r = self.D - point.wear.ball, g.R_o + point.seat.X2
        alpha = np.array([f.alpha for f in forces])
        qv, heat, share, _ = point.slip.T
        ball, race = self.factors
        drag = drag_force(g, D, op.drag, point.u[3])[0] * r * point.u[3]
        moment = ball_inertia(ball_mass(g.rho, D), D) * abs(point.u[3] * point.u[2])
        load = np.array([f.Q for f in forces])
        mu = np.array([unworn_contact(g, op, k, f).mu for k, f in enumerate(forces)])
        state = WearState(
            loss=self.even_loss(point),
            status=point.status,
            rate=np.full(2, np.nan),
            preload=self.preload(point),
            load=load,
            angle=alpha,
            major=np.array([semi_axis(f.hertz.c_a, f.Q) for f in forces]),
            qv=qv,
            total_qv=float(g.n_balls * qv.sum()),
            share=share,
            skid=skid_ratio(op, alpha[0], alpha[1], 0.5 * D, r, point.u),
            pressure=max(f.peak for f in forces),
            stiffness=point.stiffness,
            friction_power=float(g.n_balls * (heat.sum() + drag)),
            ball_rate=float(ball * qv.sum()),
            race_rate=g.n_balls * race * qv,
            place=point.seat.delta_a,
            friction_used=float(friction_used(mu[None], np.array([D]), moment, load[None])[0]),
            friction=mu,
        )
        return in_half_of_pair(self.scene, self.mounted, state)

    def _states(self, points: list[WornPoint], times: np.ndarray) -> list[WearState]:
        """States of the points, with the rate at which the even loss grows."""
        states = [self.state(p) for p in points]
        loss = np.array([s.loss for s in states])
        if len(states) < 2:
            p, first = points[0], states[0]
            wear = wear_values(
                self.scene, np.array([self.D]), first.qv[None], first.major[None], p.track[None]
            )
            return [replace(first, rate=wear["ball_diameter_loss_rate"])]
        # A last step that is short says nothing of a rate.
        steps = np.diff(times)
        n = len(times) - (len(times) > 2 and steps[-1] < _SHORT * steps[-2])
        rates = np.gradient(loss[:n], times[:n], edge_order=2 if n > 2 else 1)
        rates = np.append(rates, rates[-1:])[: len(times)]
        return [
            replace(s, rate=np.array([np.nan, rate])) for s, rate in zip(states, rates, strict=True)
        ]
