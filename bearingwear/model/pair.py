"""Two bearings on one rotor: the rotor's place, and the load of each bearing.

A rigid pair keeps the distance of its bearings, a spring pair the spring's force. Each side is a
single bearing, solved as usual at its own position or under its own force (theory.md section 19).
"""

import contextlib
import functools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np
from scipy.optimize import brentq

from bearingwear.kernels import status as code
from bearingwear.kernels.kinematics import OUTER_CONTROL, race_control
from bearingwear.kernels.thrust import ThrustCase
from bearingwear.model import parameters
from bearingwear.model.at_rest import Mechanics, lift_off_rigid, lift_off_spring
from bearingwear.model.films import COVERED, Bare
from bearingwear.model.heat import SteadyHeat, race_control_heat, warmth_of
from bearingwear.model.pair_balance import (
    ROTOR_BALANCED,
    USABLE,
    Nearby,
    RotorTrial,
    SideState,
    balanced,
    worse_status,
)
from bearingwear.model.race_control import RaceControlProblem, solve_race_control
from bearingwear.model.state import State
from bearingwear.model.states_at_loss import race_control_state, thrust_state
from bearingwear.model.steady import ThrustProblem, axial_force, solve_steady
from bearingwear.model.thermal import HEAT_BALANCED, HeatFlow, Warmed, warmed
from bearingwear.scene.scene import Scene

_ROUNDED = 1e-15  # a step below this, over the distance of the groove centres, changes nothing
NEAR_START = 1e-4  # of the range: how well the start is found
_NEWTON_STEPS = 6
_SAME_MOTION = 1e-12
_WIDEST = 60  # doublings of the range in which the rotor is looked for
WARM_BALANCED = 0.1 * HEAT_BALANCED  # force left while temperatures are found, no better than that
N_UM = 1e6  # in N/m


class Side(Protocol):
    """One side of a pair, by any model; losses are those of ball diameter [m]."""

    scene: Scene
    tandem: int
    """Like bearings in tandem on this side; forces and stiffness are those of all."""
    mounted: float
    """Axial displacement when mounted: at rest, unworn, under the preload [m]."""
    loss: float
    """Of ball diameter at the start [m]."""
    unsteady: int
    """Status where the rotor finds no place in which it stays."""
    kept_warm: bool
    """Whether the temperatures that a network found last are kept."""
    bare: Bare
    """The contacts on which no film is left."""

    def mechanics(self, loss: float, Omega: float | None = None) -> Mechanics:
        """The bearing without friction, its balls orbiting as they roll or at `Omega` [rad/s]."""

    def at_place(self, loss: float, delta_a: float) -> SideState:
        """At an axial displacement [m]."""

    def under(self, loss: float, F_x: float) -> SideState:
        """Under an axial force [N]."""

    def values(self, state: SideState) -> tuple[dict, dict]:
        """Values and attributes of a case."""

    def starts_from(self, state: SideState, values: Mapping[str, Any]) -> bool:
        """Whether the motion of a case differs from that of the state; the next solve starts from
        it."""

    def life_state(self, loss: float, state: SideState) -> State:
        """Values that a life needs."""


class SteadySide:
    """One side by the steady model; each solve starts from the last one."""

    unsteady = code.NO_STEADY_STATE

    def __init__(self, scene: Scene, tandem: int = 1):
        self.scene, self.tandem, self.problem = scene, tandem, ThrustProblem.of(scene)
        self.mounted = self.problem.preload.delta_a
        self.loss = scene.wear.ball_diameter_loss_um[0] * parameters.UM
        self.kept_warm, self.bare = False, COVERED
        self._u: np.ndarray | None = None
        self._warmed: Warmed | None = None

    def mechanics(self, loss: float, Omega: float | None = None) -> Mechanics:
        if Omega is None:
            Omega = float(self.problem.kinematic_start(OUTER_CONTROL)[3])
        g = self.problem.g
        return Mechanics(g._replace(n_balls=self.tandem * g.n_balls), g.D0 - loss, Omega)

    def at_place(self, loss: float, delta_a: float) -> SideState:
        return self._solved(loss, constant_force=False, delta_a=delta_a)

    def under(self, loss: float, F_x: float) -> SideState:
        return self._solved(loss, constant_force=True, F_x=F_x / self.tandem)

    def _solved(self, loss: float, **held: Any) -> SideState:
        problem = replace(self.problem, preload=self.problem.preload._replace(**held))
        if any(self.bare):
            problem = problem.where_bare(self.scene, self.bare)
        if problem.undetermined() != code.OK:
            return SideState(problem.undetermined())
        if self.scene.thermal is None or self.kept_warm:
            case: ThrustCase = problem.solve(problem.g.D0 - loss, self._u)
        else:
            heat = SteadyHeat(loss, problem, self._u)
            found = warmed(self.scene, heat, self._warmed)
            if found.status != code.OK:
                return SideState(found.status)
            self._warmed, self.problem = found, replace(self.problem, g=heat.problem.g)
            problem, case = heat.problem, heat.case
        if case.status not in USABLE:
            return SideState(case.status)
        self._u = case.u
        n = self.tandem * problem.g.n_balls
        return SideState(
            status=case.status,
            force=axial_force(case, n),
            stiffness=float(n * case.S_xx),
            quasistatic=float(n * case.S_quasistatic),
            place=case.delta_a,
            problem=problem,
            answer=case,
            warmed=self._warmed,
        )

    def values(self, state: SideState) -> tuple[dict, dict]:
        return solve_steady(warm_scene(self.scene, state), state.problem, state.answer)

    def starts_from(self, state: SideState, values: Mapping[str, Any]) -> bool:
        if "orbit_speed" not in values:
            return False
        u = np.array([*values["ball_angular_velocity"][0], values["orbit_speed"][0]])
        if np.abs(u - state.answer.u).max() <= _SAME_MOTION * np.abs(u).max():
            return False
        self._u = u
        return True

    def life_state(self, loss: float, state: SideState) -> State:
        made = thrust_state(self.scene, state.problem, loss, state.answer)
        return with_warmth(self.scene, state, made)


class RaceControlSide:
    """One side by race control, also under radial load, which each bearing has as its own."""

    unsteady = code.NO_RACE_CONTROL

    def __init__(self, scene: Scene, tandem: int = 1):
        self.scene, self.tandem, self.problem = scene, tandem, RaceControlProblem.of(scene)
        self.mounted = self.problem.delta_a
        self.loss = scene.wear.ball_diameter_loss_um[0] * parameters.UM
        self.kept_warm, self.bare = False, COVERED
        self._warmed: Warmed | None = None

    def mechanics(self, loss: float, Omega: float | None = None) -> Mechanics:
        g, op = self.problem.g, self.problem.op
        if Omega is None:
            kinematics = race_control(
                OUTER_CONTROL, op.omega_i, op.omega_o, g.D0 / g.dm, g.alpha0, g.alpha0
            )
            Omega = float(kinematics.Omega)
        D = float(self.problem.D.mean()) - (loss - self.loss)
        return Mechanics(g._replace(n_balls=self.tandem * g.n_balls), D, Omega)

    def at_place(self, loss: float, delta_a: float) -> SideState:
        return self._solved(loss, constant_force=False, delta_a=delta_a)

    def under(self, loss: float, F_x: float) -> SideState:
        F = np.array([F_x / self.tandem, *self.problem.F[1:]])
        return self._solved(loss, constant_force=True, F=F)

    def _solved(self, loss: float, **held: Any) -> SideState:
        def problem_of(scene: Scene) -> RaceControlProblem:
            own = RaceControlProblem.of(scene).where_bare(scene, self.bare)
            return replace(own, D=own.D - (loss - self.loss), **held)

        def heats(scene: Scene) -> tuple[int, HeatFlow]:
            return race_control_heat(scene, problem_of(scene))

        scene = self.scene
        if self.kept_warm and self._warmed is not None:
            scene = self._warmed.scene
        elif scene.thermal is not None:
            found = warmed(scene, heats, self._warmed)
            if found.status != code.OK:
                return SideState(found.status)
            self._warmed, scene = found, found.scene
            self.problem = RaceControlProblem.of(scene)
        problem = problem_of(scene)
        answer = solve_race_control(scene, problem)
        values = answer[0]
        if "axial_stiffness" not in values:
            return SideState(values["status"])
        return SideState(
            status=values["status"],
            force=self.tandem * float(values["residual_preload"]),
            stiffness=self.tandem * float(values["axial_stiffness"]),
            quasistatic=self.tandem * float(values["quasistatic_axial_stiffness"]),
            place=float(values["axial_displacement"]),
            problem=problem,
            answer=answer,
            warmed=self._warmed,
        )

    def values(self, state: SideState) -> tuple[dict, dict]:
        return state.answer

    def starts_from(self, state: SideState, values: Mapping[str, Any]) -> bool:
        return False  # there is one solution

    def life_state(self, loss: float, state: SideState) -> State:
        made = race_control_state(loss, self.problem, state.answer[0])
        return with_warmth(self.scene, state, made)


def warm_scene(scene: Scene, state: SideState) -> Scene:
    """The scene of a side at the temperatures of a state."""
    return scene if state.warmed is None else state.warmed.scene


def with_warmth(scene: Scene, state: SideState, made: State) -> State:
    """A state of a life with the temperatures and heat flows of a side that has a network."""
    return made if state.warmed is None else made.with_values(warmth_of(scene, state.warmed))


@dataclass(frozen=True)
class PairState:
    """Both bearings in balance."""

    status: int
    sides: tuple[SideState, ...] = ()
    shift: float = math.nan  # of the rotor from where it was mounted, towards +X [m]
    stiffness: float = math.nan  # axial, of the arrangement, dynamic [N/m]
    quasistatic: float = math.nan  # and quasi-static [N/m]

    @property
    def of_arrangement(self) -> dict[str, float]:
        """Result variables of the arrangement."""
        return {
            "system_axial_stiffness": self.stiffness,
            "system_quasistatic_axial_stiffness": self.quasistatic,
            "rotor_axial_shift": self.shift,
        }


@dataclass
class Pair:
    """Two bearings on a rotor."""

    scene: Scene
    sides: Sequence[Side]
    tolerance: float = ROTOR_BALANCED  # force left on the rotor, over the larger one
    nearby: Nearby = field(default_factory=Nearby)

    @classmethod
    def of(cls, scene: Scene, fidelity: str, tolerance: float = ROTOR_BALANCED) -> "Pair":
        made = SteadySide if fidelity == "steady" else RaceControlSide
        assert scene.pair is not None
        sides = tuple(made(one, n) for one, n in zip(scene.sides, scene.pair.tandem, strict=True))
        return cls(scene, sides, tolerance)

    @property
    def losses(self) -> tuple[float, float]:
        """Of ball diameter at the start, of each side [m]."""
        first, second = self.sides
        return first.loss, second.loss

    def solve(self, losses: tuple[float, float]) -> PairState:
        """Both bearings at their losses of ball diameter [m]."""
        a = self.scene.pair
        assert a is not None
        if self.scene.operation.preload_N == 0.0:
            return PairState(code.PRELOAD_GONE)
        balance = self._rigid if a.kind == "rigid_pair" else self._spring
        if all(side.scene.thermal is None for side in self.sides):
            return balance(losses, self.tolerance)
        found = balance(losses, max(self.tolerance, WARM_BALANCED))
        if found.status in USABLE:
            # the last steps, at temperatures that are known well enough
            with self._kept_warm():
                found = balance(losses, self.tolerance)
        return found

    @contextlib.contextmanager
    def _kept_warm(self) -> Iterator[None]:
        for side in self.sides:
            side.kept_warm = True
        yield
        for side in self.sides:
            side.kept_warm = False

    def _rigid(self, losses: tuple[float, float], tolerance: float) -> PairState:
        """F_1(d_1 + x) - F_2(d_2 - x) = F_ext, the unknown x."""
        one, two = self.sides
        F_ext = self.scene.pair.external_axial_N  # type: ignore[union-attr]

        def trial(x: float) -> RotorTrial:
            states = (
                one.at_place(losses[0], one.mounted + x),
                two.at_place(losses[1], two.mounted - x),
            )
            F_1, F_2 = (state.force for state in states)
            slope = states[0].slope + states[1].slope
            return RotorTrial(states, F_1 - F_2 - F_ext, slope, max(F_1, F_2, abs(F_ext)))

        x = self.nearby.at(losses) if self.nearby.known else self._start(losses, F_ext)
        x, found = balanced(trial, x, self._rounded, self.nearby, tolerance)
        return self._state(losses, x, found, lambda states: x)

    @functools.cached_property
    def _rounded(self) -> float:
        """Step of the rotor that changes nothing [m]."""
        return _ROUNDED * self.sides[0].mechanics(0.0).g.BD

    def _state(
        self,
        losses: tuple[float, float],
        at: float,
        found: RotorTrial | int,
        shift: Callable[[Sequence[SideState]], float],
    ) -> PairState:
        """The state at a place, or why there is none."""
        if isinstance(found, int):
            self.nearby.forget()
            lost = self.sides[0].unsteady if found == code.NO_STEADY_STATE else found
            return PairState(lost)
        self.nearby.found(losses, at)
        states = found.states
        dynamic = self.stiffness(*(one.stiffness for one in states))
        quasistatic = self.stiffness(*(one.quasistatic for one in states))
        return PairState(worse_status(states), states, shift(states), dynamic, quasistatic)

    def stiffness(self, k_1: float, k_2: float) -> float:
        """Axial stiffness of the arrangement, from that of both sides [N/m]."""
        a = self.scene.pair
        assert a is not None
        if a.kind == "rigid_pair":
            return k_1 + k_2
        k_s = a.spring_stiffness_N_um * N_UM
        return k_1 + k_s * k_2 / (k_s + k_2)

    def _start(self, losses: tuple[float, float], F_ext: float) -> float:
        """Place of the rotor by the mechanics of rolling balls, without friction [m]."""
        (one, two), mounted = (
            [side.mechanics(loss) for side, loss in zip(self.sides, losses, strict=True)],
            [side.mounted for side in self.sides],
        )

        x = 0.0
        for _ in range(_NEWTON_STEPS):
            F_1, k_1 = one.force_and_stiffness(mounted[0] + x)
            F_2, k_2 = two.force_and_stiffness(mounted[1] - x)
            if not (F_1 > 0.0 and F_2 > 0.0):
                break
            step = (F_ext - F_1 + F_2) / (k_1 + k_2)
            x += step
            if abs(step) <= NEAR_START * (abs(mounted[0]) + abs(mounted[1])):
                return x

        def left(x: float) -> float:
            return one.force(mounted[0] + x) - two.force(mounted[1] - x) - F_ext

        reach = max(abs(mounted[0]), abs(mounted[1]), 1e-6 * one.g.BD)
        for _ in range(_WIDEST):
            if left(-reach) <= 0.0 <= left(reach):
                return float(brentq(left, -reach, reach, xtol=NEAR_START * reach))
            reach *= 2.0
        return 0.0

    def _spring(self, losses: tuple[float, float], tolerance: float) -> PairState:
        """The spring extends by e, as far as both bearings give way; F_2 = F_s - k_s e."""
        a, F_s = self.scene.pair, float(self.scene.operation.preload_N)
        assert a is not None
        one, two = self.sides
        k_s = a.spring_stiffness_N_um * N_UM

        def trial(e: float) -> RotorTrial | int:
            F_2 = F_s - k_s * e
            F_1 = F_2 + a.external_axial_N
            if not (F_1 > 0.0 and F_2 > 0.0):
                return code.LIFTED_OFF
            states = one.under(losses[0], F_1), two.under(losses[1], F_2)
            given = sum(s.place - side.mounted for s, side in zip(states, self.sides, strict=True))
            soft = sum(k_s / state.slope for state in states if state.status in USABLE)
            return RotorTrial(states, k_s * (e - given), k_s * (1.0 + soft), max(F_1, F_2))

        e = self.nearby.at(losses) if self.nearby.known else 0.0
        e, found = balanced(trial, e, 0.0, self.nearby, tolerance)
        return self._state(losses, e, found, lambda states: states[0].place - one.mounted)

    def lift_off(self, losses: tuple[float, float]) -> float:
        """Least axial force on the rotor that lifts off a bearing at rest [N]."""
        a, (one, two) = self.scene.pair, self.sides
        assert a is not None
        first, second = one.mechanics(losses[0], 0.0), two.mechanics(losses[1], 0.0)
        if a.kind == "rigid_pair":
            return lift_off_rigid(first, second, one.mounted + two.mounted)
        mounted, F_s = (one.mounted, two.mounted), float(self.scene.operation.preload_N)
        return lift_off_spring(first, second, mounted, F_s, a.spring_stiffness_N_um * N_UM)
