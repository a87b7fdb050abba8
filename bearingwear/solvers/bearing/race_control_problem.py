"""Equilibrium of balls and race under Jones-Harris race control, for any load."""

import math
from dataclasses import dataclass, replace

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.contact.profile import contact_approach, semi_axis
from bearingwear.kernels.contact.slip import LARGEST_AXIS
from bearingwear.kernels.equilibrium import race
from bearingwear.kernels.equilibrium.kinematics import (
    INNER_CONTROL,
    ORBIT,
    OUTER_CONTROL,
    race_control,
)
from bearingwear.kernels.equilibrium.thrust_loaded import cold_start, orbit_load, thrust_equilibrium
from bearingwear.kernels.params import BallLoad, BallState, Geometry, OperatingPoint
from bearingwear.kernels.steady.balance import LAST_BIT
from bearingwear.kernels.steady.thrust import MOST_ROUNDING
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.effects.choice import asymmetries

LIGHT_LOAD = 0.01  # of the largest load of a ball; below it a ball is almost off


@dataclass(frozen=True)
class Balance:
    """Equilibrium of balls and race."""

    status: int
    delta: np.ndarray  # (3,) displacement (axial, Y, Z) of the inner race [m]
    states: list[BallState]  # one if the scene is symmetric
    stiffness: float  # axial [N/m]
    race_residual: float  # see `RaceControlProblem.unbalanced_force` [N]


@dataclass(frozen=True)
class RaceControlProblem:
    """A scene in the form that the race-control kernels take."""

    g: Geometry
    op: OperatingPoint
    constant_force: bool
    F: np.ndarray  # (3,) load on the inner race (axial, Y, Z) [N]
    delta_a: float  # static displacement under the initial preload alone [m]
    tilt: float  # [rad]
    D: np.ndarray  # (n,) worn diameters of the balls solved: all, or one if all balls are alike [m]

    @classmethod
    def of(cls, scene: Scene) -> "RaceControlProblem":
        """Returns the problem of a scene, its rotating load at the instant along +Z."""
        g = parameters.geometry(scene)
        operation = scene.operation
        F_y, F_z = operation.radial_load_N
        F = np.array([operation.preload_N, F_y, F_z + operation.rotating_load_N], dtype=float)
        D = parameters.ball_diameters(scene)
        return cls(
            g=g,
            op=parameters.operating_point(scene),
            constant_force=operation.preload_method == "constant_force",
            F=F,
            delta_a=parameters.static_place(scene),
            tilt=operation.tilt_mrad * 1e-3,
            D=D if asymmetries(scene) else D[:1],
        )

    @property
    def psi(self) -> np.ndarray:
        """Returns the azimuths (n,) of the balls solved, from +Z towards -Y [rad]."""
        return 2.0 * np.pi * np.arange(len(self.D)) / self.g.n_balls

    def balance(self, models: np.ndarray, Omega: float = 0.0) -> Balance:
        """Returns the equilibrium of balls and race; its status says whether there is one.

        models: kinematics model of each ball (n,), see `kernels.equilibrium.kinematics`.
        Omega: orbit rate in the model ORBIT [rad/s].
        """
        op = self.op
        load = self.load(models[0], Omega)  # of the one ball, else for the start alone
        if len(self.D) == 1:
            return self.thrust_balance(load)
        loads = np.zeros((len(self.D), race.LOAD_FIELDS))
        loads[:, race.MODEL], loads[:, race.ORBIT_RATE] = models, Omega
        loads[:, race.OMEGA_I], loads[:, race.OMEGA_O] = op.omega_i, op.omega_o
        # `race_equilibrium` moves the race in `delta`, and writes the balls into `packed_states`
        packed_states = np.empty((len(self.D), race.PACKED))
        delta = np.array([self.delta_a, 0.0, 0.0])
        if self.constant_force and self.F[0] > 0.0:
            # worn balls may be loose at the mounted place: start where thrust alone presses them
            delta[0], _ = thrust_equilibrium(
                self.g, self.D.mean(), load, self.F[0], self.delta_a, True, cold_start()
            )
        first = 0 if self.constant_force else 1  # of the free translations: axial, along Y and Z
        status, _, stiffness = race.race_equilibrium(
            self.g, self.D, loads, self.psi, self.F, self.tilt, first, delta, packed_states
        )
        states = [race.unpack_ball_state(row) for row in packed_states]
        return Balance(
            status=status,
            delta=delta,
            states=states,
            stiffness=race.axial_stiffness(stiffness),
            race_residual=self.unbalanced_force(states),
        )

    def load(self, model: int, Omega: float = 0.0) -> BallLoad:
        """Returns speeds and forces of a ball, as the equilibrium takes them.

        model: its kinematics model, see `kernels.equilibrium.kinematics`.
        Omega: orbit rate in the model ORBIT [rad/s].
        """
        return orbit_load(Omega, 0.0, 0.0)._replace(
            kinematics_model=int(model), omega_i=self.op.omega_i, omega_o=self.op.omega_o
        )

    def thrust_balance(self, load: BallLoad) -> Balance:
        """Returns the equilibrium of a scene in which one ball represents all.

        Its `race_residual` is that of the axial force, 0 at a fixed position. NOT_CONVERGED where
        that residual is more than rounding.

        load: of the ball, see `load`.
        """
        n = self.g.n_balls
        delta_a, state = thrust_equilibrium(
            self.g, self.D[0], load, self.F[0], self.delta_a, self.constant_force, cold_start()
        )
        status = state.status
        residual = 0.0
        if self.constant_force:
            residual = abs(n * state.F_ix - self.F[0])
            if status == code.OK and residual > MOST_ROUNDING * n * max(state.Q_i, state.Q_o):
                status = code.NOT_CONVERGED  # the load jumps past that of the spring
        return Balance(
            status=status,
            delta=np.array([delta_a, 0.0, 0.0]),
            states=[state],
            stiffness=n * state.S_xx,
            race_residual=residual,
        )

    def failure_status(self) -> int:
        """Returns the status of a scene that has no equilibrium under race control.

        It is solved again without the friction that carries the gyroscopic moments. The status is
        NO_RACE_CONTROL if that has an equilibrium, RACE_UNSEATED if a ball leaves its groove, and
        otherwise that of the second solve.
        """
        op, alpha0 = self.op, self.g.alpha0
        k = race_control(
            OUTER_CONTROL, op.omega_i, op.omega_o, self.g.D0 / self.g.dm, alpha0, alpha0
        )
        frictionless = self.balance(np.full(len(self.D), ORBIT), k.Omega)
        if frictionless.status == code.NOT_CONVERGED and is_unseated(frictionless.states):
            return code.RACE_UNSEATED
        if frictionless.status == code.OK:
            return code.NO_RACE_CONTROL
        return frictionless.status

    def unbalanced_force(self, states: list[BallState]) -> float:
        """Returns the largest component, without sign, of the unbalanced force on the race [N].

        The components are those along X, Y and Z of the balls' forces, summed anew, less the load.
        At a fixed position the axial one is left out.

        states: of all balls.
        """
        axial = np.array([s.F_ix for s in states])
        radial = np.array([s.F_ir for s in states])
        sums = np.array(
            [axial.sum(), -(radial * np.sin(self.psi)).sum(), (radial * np.cos(self.psi)).sum()]
        )
        unbalanced = np.abs(sums - self.F)
        # a fixed position takes any axial force
        return float(unbalanced.max() if self.constant_force else unbalanced[1:].max())


def is_unseated(states: list[BallState]) -> bool:
    """Returns whether a ball is almost off the inner race, or beyond its groove.

    Almost off is below `LIGHT_LOAD` of the largest inner load; true if no ball has any load.
    """
    light = LIGHT_LOAD * max(s.Q_i for s in states)
    return any(not (s.Q_i > light and 0.0 < s.alpha_i < 0.5 * math.pi) for s in states)


def outer_controls(state: BallState) -> bool:
    """Returns whether the outer spin moment is the larger one, so that the outer race controls.

    Both are compared as in theory.md Eq. 23.
    """
    a_i = semi_axis(state.hertz_i.c_a, state.Q_i)
    a_o = semi_axis(state.hertz_o.c_a, state.Q_o)
    outer = state.Q_o * a_o * state.hertz_o.E * math.cos(state.alpha_i - state.alpha_o)
    return outer > state.Q_i * a_i * state.hertz_i.E


def controlled_balance(problem: RaceControlProblem) -> tuple[Balance, np.ndarray]:
    """Returns the equilibrium and the control of each ball (n,), OUTER_CONTROL or INNER_CONTROL.

    All balls start under outer control. Those whose spin moments contradict it change to inner
    control and stay there, until none is left. If the balls after a change have no equilibrium (a
    friction force on a ball without load), the last one is kept.

    If outer control has no equilibrium, all balls take inner control, unchecked. If that has none
    either, the status is that of `failure_status`.
    """
    models = np.full(len(problem.D), OUTER_CONTROL)
    balance = problem.balance(models)
    if balance.status == code.NOT_CONVERGED:
        # Where the outer race cannot carry the gyroscopic moments there is no such equilibrium.
        models = np.full(len(problem.D), INNER_CONTROL)
        balance = problem.balance(models)
        if balance.status == code.NOT_CONVERGED:
            balance = replace(balance, status=problem.failure_status())
        return balance, models
    while True:
        inner_controlled = [
            j
            for j, state in enumerate(balance.states)
            if models[j] == OUTER_CONTROL and state.Q_i > 0.0 and not outer_controls(state)
        ]
        if not inner_controlled:
            return balance, models
        changed_models = models.copy()
        changed_models[inner_controlled] = INNER_CONTROL
        changed_balance = problem.balance(changed_models)
        if changed_balance.status == code.NOT_CONVERGED:
            return balance, models
        balance, models = changed_balance, changed_models


def geometric_status(states: list[BallState], D: np.ndarray) -> int:
    """Returns the status of the contacts: OK if they lie in their grooves and are small.

    BEYOND_GROOVE if a loaded contact has turned beyond its groove, OUTSIDE_HERTZ_RANGE if its
    ellipse is too large for its ball.

    states: of the balls solved.
    D: diameters of these balls (n,) [m].
    """
    for state, diameter in zip(states, D, strict=True):
        loaded = (
            (state.Q_i, state.alpha_i, state.hertz_i),
            (state.Q_o, state.alpha_o, state.hertz_o),
        )
        for Q, alpha, hertz in loaded:
            if Q > 0.0 and not abs(alpha) < 0.5 * math.pi:
                return code.BEYOND_GROOVE
            if semi_axis(hertz.c_a, Q) >= LARGEST_AXIS * 0.5 * diameter:
                return code.OUTSIDE_HERTZ_RANGE
    return code.OK


def load_rounding(g: Geometry, state: BallState) -> float:
    """Returns the relative error of a ball's loads by rounding of its position; 0 without loads.

    The deformation under a light load is a small difference of large lengths.
    """
    loads = ((state.Q_i, state.hertz_i.K, g.r_i), (state.Q_o, state.hertz_o.K, g.r_o))
    return max(1.5 * LAST_BIT * r / contact_approach(K, Q) if Q > 0.0 else 0.0 for Q, K, r in loads)
