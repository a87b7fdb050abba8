"""The dynamic model: state of balls, cage and inner race of a scene, and its integration."""

import functools
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize

from bearingwear.kernels import status as code
from bearingwear.kernels.cage.body import INNER_LAND, NO_LAND, cage_energy
from bearingwear.kernels.cage.contacts import cage_contacts
from bearingwear.kernels.cage.law import ELASTIC
from bearingwear.kernels.contact.profile import STORED
from bearingwear.kernels.dynamic import record
from bearingwear.kernels.dynamic.equilibrium import free_equilibrium
from bearingwear.kernels.dynamic.integrators import ROSENBROCK, RUNGE_KUTTA, Tableau, stages
from bearingwear.kernels.dynamic.model import BearingModel, buffers, load_at
from bearingwear.kernels.dynamic.quasistatic import HERTZ_K
from bearingwear.kernels.dynamic.step_control import StepControl, Tally
from bearingwear.kernels.equilibrium import race
from bearingwear.kernels.equilibrium.kinematics import ORBIT
from bearingwear.kernels.layout import (
    BALL,
    CAGE,
    CENTRE,
    MOMENTUM,
    OMEGA,
    PSI,
    ROTATION,
    VELOCITY,
    W_X,
    StateLayout,
)
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.films import COVERED, Bare
from bearingwear.solvers.bearing.race_control_problem import is_unseated
from bearingwear.solvers.dynamic.parts import bearing_model

CAGE_LAG = 0.01  # share by which the cage turns slower than the balls at the start
_FIRST_STEP = 1e-4  # of a shaft turn
HARDLY_SQUEEZED = 0.01  # of the cage's elastic energy in its usual place
STEPS_PER_TURN = 20  # fewest steps: a ball's loads change with its azimuth
TOLERANCE = 1e-3  # of the mean slip, see step_control.step_error
_ONLY_READY = -1  # intervals to simulate: none, but buffers and rates are brought to the state
POSE = np.r_[CENTRE : CENTRE + 3, ROTATION : ROTATION + 3]  # states of the cage


class CageStart(NamedTuple):
    """Start of a cage: its centre, and the orbit rate of the centre."""

    offset: float = 0.5  # distance from the axis, over the clearance
    angle: float = -0.5 * math.pi  # from Y towards Z; below the axis
    whirl: float = 0.0  # orbits about the axis per shaft turn
    lag: float = CAGE_LAG  # share by which the cage turns slower than the balls


@dataclass(frozen=True)
class Snapshot:
    """Integrals and energies at an instant of a run, for differences."""

    time: float  # [s]
    integrals: np.ndarray  # the part of the state vector from `layout.qv` on
    energy: dict[str, float]  # see `DynamicSystem.energy`
    momentum: float  # of the cage about the bearing axis [kg m2/s]


@dataclass
class DynamicSystem:
    """State of balls, cage and inner race of a scene, and its integration in time."""

    bearing: BearingModel
    y: np.ndarray  # state vector, see `layout`
    time: float = 0.0  # [s]

    def __post_init__(self) -> None:
        bearing = self.bearing
        n = len(self.bearing.D)
        self.buffers = buffers(n, bearing.rule, bearing.points, bearing.traction)
        self.stages = stages(n, self.layout)
        self.dy = np.zeros(self.y.size)
        self.h = _FIRST_STEP * self.turn
        self.cage_has_room = True

    @classmethod
    def of(cls, scene: Scene, u: np.ndarray, bare: Bare = COVERED) -> "DynamicSystem":
        """Returns the bearing of a scene, its balls evenly spaced and moving alike.

        u: motion (w_x, w_y, w_z, Omega) of every ball [rad/s].
        """
        bearing = bearing_model(scene, bare)
        system = cls(bearing, np.zeros(bearing.layout.size))
        n = len(bearing.D)
        system.balls[:, W_X : OMEGA + 1] = u
        system.balls[:, PSI] = 2.0 * math.pi * np.arange(n) / n
        system.buffers.rest[0] = parameters.static_place(scene)
        system.buffers.balls.delta[:] = system.buffers.rest
        if bearing.cage.present:
            if bearing.cage.land == INNER_LAND and bearing.F_rot:
                cage = bearing.cage._replace(turning=system.turning_displacement())
                system.bearing = bearing._replace(cage=cage)
            system.place_cage()
        return system

    def turning_displacement(self) -> tuple[float, float]:
        """Returns the displacement (Y, Z) of the race by the rotating load alone [m].

        It is 0 where the bearing has no equilibrium.
        """
        balls = self.buffers.balls
        displacements = []
        for bearing in (self.bearing._replace(F_rot=0.0), self.bearing):
            if free_equilibrium(self.time, self.y, bearing, self.buffers) != code.OK:
                return 0.0, 0.0
            displacements.append(balls.delta[1:].copy())
        without_load, with_load = displacements
        y, z = (with_load - without_load).tolist()
        return y, z

    def variant(self, **changes) -> "DynamicSystem":
        """Returns a system with some fields of its model replaced, and a copy of `y`.

        `unpack` gives it the rest of a state: time, step and last positions.
        """
        system = DynamicSystem(self.bearing._replace(**changes), self.y.copy())
        system.buffers.rest[:] = self.buffers.rest
        system.buffers.balls.delta[:] = system.buffers.rest
        return system

    def place_cage(self) -> None:
        """Places the cage at the start: every ball in the middle of its pocket, the cage slower.

        Its centre hangs below the axis by half of its clearance: a centred cage that turns with the
        balls would never touch anything. Load or tilt may move the balls out of their plane, so
        that they squeeze the cage. It then starts where it is squeezed least; if that is hardly
        less, `cage_has_room` becomes False.
        """
        balls, contacts, state = self.buffers.balls, self.buffers.cage, self.cage_state
        cage = self.bearing.cage
        free_equilibrium(self.time, self.y, self.bearing, self.buffers)
        state[:] = 0.0
        room = cage.clearance if cage.land == NO_LAND else min(cage.clearance, cage.gap)
        state[CENTRE] = balls.X[:, 0].mean()
        state[CENTRE + 2] = -0.5 * room
        if cage.land == INNER_LAND:
            state[CENTRE + 1 : CENTRE + 3] += balls.delta[1:]
        middle = state[POSE] + np.r_[0.0, 0.0, cage.imbalance, 0.0, 0.0, 0.0]

        def elastic_energy(shift: np.ndarray) -> float:
            """Moves the cage by a scaled shift (6,) and returns its elastic energy [J]."""
            state[POSE] = middle + shift * scale
            cage_contacts(self.y, self.bearing, balls, contacts)
            return float(contacts.sums[ELASTIC])

        scale = np.zeros(6)
        energy = elastic_energy(scale)
        if energy > 0.0:
            scale[:] = contacts.approach.max()
            scale[3:] /= cage.radius
            best_shift = minimize(lambda shift: elastic_energy(shift) / energy, np.zeros(6)).x
            self.cage_has_room = elastic_energy(best_shift) <= HARDLY_SQUEEZED * energy
        momentum = cage.I_x * (1.0 - CAGE_LAG) * self.balls[:, OMEGA].mean()
        state[MOMENTUM : MOMENTUM + 3] = momentum * contacts.R[:, 0]

    def start_cage(self, start: CageStart) -> None:
        """Puts the cage at a start, wherever `place_cage` has put it.

        Sets its centre and velocity across the axis, and its angular momentum; its axial place and
        its rotation stay.
        """
        cage = self.bearing.cage
        state = self.cage_state
        omega = self.balls[:, OMEGA].mean()
        race_centre = self.buffers.balls.delta if cage.land == INNER_LAND else np.zeros(3)
        room = cage.clearance if cage.land == NO_LAND else min(cage.clearance, cage.gap)
        outward = np.array([math.cos(start.angle), math.sin(start.angle)])
        radius, rate = start.offset * room, start.whirl * 2.0 * math.pi / self.turn
        state[CENTRE + 1 : CENTRE + 3] = (
            race_centre[1:] + radius * outward + np.array([0.0, cage.imbalance])
        )
        state[VELOCITY + 1 : VELOCITY + 3] = rate * radius * np.array([-outward[1], outward[0]])
        state[MOMENTUM : MOMENTUM + 3] = cage.I_x * (1.0 - start.lag) * omega, 0.0, 0.0

    @property
    def layout(self) -> StateLayout:
        """Returns the offsets into the state vector `y`."""
        return self.bearing.layout

    @property
    def turn(self) -> float:
        """Returns the duration of a shaft turn, or of a turn of the faster race [s]."""
        op = self.bearing.op
        return 2.0 * math.pi / max(abs(op.omega_i), abs(op.omega_o))

    @property
    def balls(self) -> np.ndarray:
        """Returns the states (n, 5) of the balls: w_x, w_y, w_z, Omega, psi; a view."""
        n = len(self.bearing.D)
        return self.y[: BALL * n].reshape(n, BALL)

    @property
    def ball_ratio(self) -> float:
        """Returns the mean orbit rate of the balls, over the rate of the faster race."""
        return float(self.balls[:, OMEGA].mean()) * self.turn / (2.0 * math.pi)

    @property
    def cage_state(self) -> np.ndarray:
        """Returns the state (12,) of the cage, if there is one; a view."""
        return self.y[self.layout.cage : self.layout.cage + CAGE]

    @property
    def qv(self) -> np.ndarray:
        """Returns the time integral of QV (n, 2), inner and outer contact [J]; a view."""
        return self.y[self.layout.qv : self.layout.pockets].reshape(-1, 2)

    def update(self) -> int:
        """Brings buffers and rates to this instant; returns the status of the equilibrium."""
        status = self.simulate(self.control(method=RUNGE_KUTTA), 0.0, _ONLY_READY).status
        self.dy[:] = self.stages.rates[0]
        return status

    def diagnose(self, status: int) -> int:
        """Returns the status, or a more specific one where it gives no reason.

        The reason is sought at the last state that had an equilibrium: balls and race without the
        cage, from a safe start.
        """
        if status == code.TOO_STIFF and not self.cage_has_room:
            return code.CAGE_JAMMED
        if status not in (code.NOT_CONVERGED, code.UNVERIFIED):
            return status
        bearing = self.bearing
        buffers = self.buffers
        n = len(self.bearing.D)
        loads = np.zeros((n, race.LOAD_FIELDS))
        loads[:, race.MODEL], loads[:, race.ORBIT_RATE] = ORBIT, self.balls[:, OMEGA]
        load_at(bearing, self.time, buffers.balls.F)
        rows, delta = np.empty((n, race.PACKED)), buffers.rest.copy()
        without_cage, *_ = race.race_equilibrium(
            bearing.g,
            bearing.D,
            loads,
            self.balls[:, PSI].copy(),
            buffers.balls.F,
            bearing.tilt,
            int(bearing.axial_is_held),
            delta,
            rows,
        )
        if without_cage not in (code.OK, code.NOT_CONVERGED):
            return int(without_cage)
        if is_unseated([race.unpack_ball_state(row) for row in rows]):
            return code.RACE_UNSEATED
        if status == code.NOT_CONVERGED and without_cage == code.OK and bearing.cage.present:
            return code.CAGE_JAMMED
        return status

    def snapshot(self) -> Snapshot:
        """Returns time, integrals, energies and the cage's angular momentum now."""
        return Snapshot(
            energy=self.energy(),
            time=self.time,
            integrals=self.y[self.layout.qv :].copy(),
            momentum=self.cage_momentum() if self.bearing.cage.present else 0.0,
        )

    def rates(self) -> np.ndarray:
        """Returns the time derivative of `y` now, as `dy` itself; also updates the buffers."""
        self.update()
        return self.dy

    def control(
        self,
        tolerance: float = TOLERANCE,
        method: Tableau = ROSENBROCK,
        longest: float | None = None,
    ) -> StepControl:
        """Returns the control of the time steps.

        tolerance: of a step, over the mean slip.
        longest: longest step, by default the usual one [s].
        """
        return StepControl(
            method=method,
            tolerance=float(tolerance),
            longest=longest or self.turn / STEPS_PER_TURN,
        )

    def advance(
        self,
        duration: float,
        tolerance: float = TOLERANCE,
        method: Tableau = ROSENBROCK,
        longest: float | None = None,
    ) -> Tally:
        """Moves state and time on by a duration [s]; the tally has the status.

        tolerance, method, longest: as in `control`.
        """
        tally = self.simulate(self.control(tolerance, method, longest), duration)
        self.time, self.h = tally.time, tally.h
        return tally

    def simulate(self, control: StepControl, duration: float, intervals: int = 1) -> Tally:
        """Moves `y` and the buffers on from this instant; `time` and `h` stay as they are.

        Returns the tally of the steps, with the status, and the time and next step at the end.

        duration: of each interval [s].
        intervals: number of intervals; `_ONLY_READY` for none.
        """
        grid = record.TimeGrid(origin=self.time, dt=duration, first=0)
        return record.advance_and_record(
            control,
            grid,
            0,
            intervals,
            self.h,
            self.y,
            self.bearing,
            self.buffers,
            self.stages,
            self._idle_recorder,
        )

    @functools.cached_property
    def _idle_recorder(self) -> record.Recorder:
        """Returns a recorder whose values are not used, for the kernel that runs need anyway.

        A kernel without a recorder would take another half minute to compile.
        """
        n = len(self.bearing.D)
        integrals = self.layout.size - self.layout.qv
        sums = record.empty_sums(n, self.bearing.rule, np.zeros(1), integrals)
        return record.Recorder(sums=sums, history=record.empty_history(1, n), keep=False)

    def parts(self, h: np.ndarray) -> tuple[np.ndarray, ...]:
        """Returns all arrays that a run continues from, as views.

        h: buffer (1,) of the next step [s].
        """
        balls = self.buffers.balls
        return self.y, h, self.buffers.cage.R0, balls.X, balls.delta

    def packed(self) -> np.ndarray:
        """Returns the state from which a run continues as if it had not stopped; see `unpack`."""
        return np.concatenate([np.ravel(part) for part in self.parts(np.array([self.h]))])

    def unpack(self, state: np.ndarray, time: float) -> None:
        """Continues from the state that `packed()` returned at `time` [s].

        ValueError if it is that of a system with other parts.
        """
        h = np.empty(1)
        parts = self.parts(h)
        if state.size != sum(part.size for part in parts):
            raise ValueError(f"state of {state.size} numbers rather than {len(self.packed())}")
        offset = 0
        for part in parts:
            part[...] = state[offset : offset + part.size].reshape(part.shape)
            offset += part.size
        self.h = float(h[0])
        self.time = time
        # Kept, because the equilibrium starts from the last positions.
        self.buffers.balls.factors[:] = 0.0

    def cage_momentum(self) -> float:
        """Returns the angular momentum of the cage about the bearing axis [kg m2/s]."""
        state = self.cage_state
        _, y, z_centre = state[CENTRE : CENTRE + 3]
        _, v_y, v_z = state[VELOCITY : VELOCITY + 3]
        return float(state[MOMENTUM] + self.bearing.cage.mass * (y * v_z - z_centre * v_y))

    def energy(self) -> dict[str, float]:
        """Returns the terms of the energy balance now (theory.md Eq. 26) [J].

        Over any time the change of `supplied` equals that of the sum of all others.
        """
        self.update()
        bearing, balls, cage = self.bearing, self.buffers.balls, self.buffers.cage
        y, layout = self.y, self.layout
        w, Omega = self.balls[:, :OMEGA], self.balls[:, OMEGA]
        free = np.array([bearing.g.r_i, bearing.g.r_o]) - 0.5 * bearing.D[:, None]
        to_inner = balls.A - balls.X
        to_outer = balls.X
        lengths = np.column_stack([np.hypot(*to_inner.T), np.hypot(*to_outer.T)])
        d = np.maximum(lengths - free, 0.0)
        r = bearing.g.R_o + balls.X[:, 1]
        orbit = bearing.mass * r**2 * Omega**2
        cage_kinetic = weight_work = 0.0
        if bearing.cage.present:
            state = self.cage_state
            cage_kinetic = cage_energy(bearing.cage, state, cage.R)
            weight_work = bearing.cage.mass * np.dot(
                bearing.cage.gravity, state[CENTRE : CENTRE + 3]
            )
        # translations in which the load does work: none where the race is held
        free_directions = np.array([0.0 if bearing.axial_is_held else 1.0, 1.0, 1.0])
        elastic = STORED * (balls.factors[:, :, HERTZ_K] * d**2.5).sum()
        return {
            "supplied": (
                y[layout.shaft]
                + balls.delta @ (balls.F * free_directions)
                - y[layout.load]
                + weight_work
            ),
            "heat": y[layout.heat],
            "drag": y[layout.drag],
            "cage heat": y[layout.cage_heat],
            "damping": y[layout.damping],
            "kinetic": 0.5 * (bearing.inertia * (w**2).sum(axis=1) + orbit).sum() + cage_kinetic,
            "elastic": elastic + cage.sums[ELASTIC],
            "coriolis": -(orbit.sum() - y[layout.turning]),
            "azimuth": -y[layout.azimuth],
            "hertz": -y[layout.hertz],
            "traction": y[layout.traction],
        }
