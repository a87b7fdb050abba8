"""Bearings on a rotor: one, or two that press against each other (theory.md section 19).

A rigid pair keeps the distance of its bearings, a spring pair the spring's force. Each bearing is
solved as a single one at its own place or under its own force, by any model.
"""

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.steady.thrust import LARGEST_RESIDUAL, MOST_ROUNDING
from bearingwear.scene.arrangement import bearings_holding
from bearingwear.scene.scene import Arrangement, Scene
from bearingwear.solvers.bearing.arrangement import (
    N_UM,
    joined_attributes,
    natural_frequencies,
    rotor_balance,
    stacked_sides,
)
from bearingwear.solvers.bearing.at_rest import AxialRotor, Mechanics, PreloadSpring
from bearingwear.solvers.bearing.growth import growth_values, is_held
from bearingwear.solvers.bearing.rotor_balance import (
    ROTOR_BALANCED,
    Nearby,
    RotorTrial,
    balanced_place,
)
from bearingwear.solvers.condition import (
    USABLE,
    CaseValues,
    Conditions,
    Force,
    Place,
    SolvedBearing,
    Solver,
    innermost,
)
from bearingwear.solvers.roots import brent_root
from bearingwear.solvers.steady import Steady
from bearingwear.solvers.thermal import (
    HEAT_BALANCED,
    HeatFlow,
    Warmed,
    find_joint_heat_balance,
)
from bearingwear.solvers.warm import Warm, preload_spread

_ROUNDED = 1e-15  # a step below this, over the distance of the groove centres, changes nothing
NEAR_START = 1e-4  # of the range: accuracy of the start
_NEWTON_STEPS = 6
_WIDEST = 60  # doublings of the range in which the rotor is searched for
_LEAST_REACH = 1e-6  # of that range, over the distance of the groove centres
_MOST_BALANCES = 3
NO_BALANCE_ALONE = (code.WARM_SEIZURE, code.NO_HEAT_BALANCE, code.NOT_CONVERGED)
"""Statuses of a rotor of which one bearing may have had no temperatures at a place by itself."""
WARM_BALANCED = 0.1 * HEAT_BALANCED  # unbalanced force while temperatures are sought


class RotorState(NamedTuple):
    """Bearings in balance on a rotor, or why they are not."""

    status: int
    sides: tuple[SolvedBearing, ...] = ()
    shift: float = math.nan  # of the rotor from where it was mounted, towards +X [m]
    travel: float = math.nan  # of the spring from where it was mounted; 0 without one [m]
    stiffness: float = math.nan  # axial, of the arrangement, dynamic [N/m]
    quasistatic: float = math.nan  # axial, of the arrangement, quasi-static [N/m]

    @property
    def values(self) -> dict[str, float]:
        """Returns result variables of the arrangement, without a stiffness that is not known."""
        values = {
            "rotor_axial_shift": self.shift,
            "spring_travel": self.travel,
            "system_axial_stiffness": self.stiffness,
            "system_quasistatic_axial_stiffness": self.quasistatic,
        }
        return {name: value for name, value in values.items() if not math.isnan(value)}


def half_of_pair(scene: Scene, mounted: float, solution: SolvedBearing) -> RotorState:
    """Returns the state of a rotor on a symmetric pair, by a solution of one of its bearings.

    At a fixed position both bearings hold the rotor, which stays where it is. A spring has no
    stiffness here, and the rotor follows the bearing; the sliding ring moves twice as far.

    mounted: axial displacement at mounting [m].
    """
    method = scene.operation.preload_method
    holding_count = bearings_holding(method)  # two at a fixed position, one on a spring
    shift = 0.0 if method == "fixed_position" else solution.place - mounted
    return RotorState(
        status=solution.status,
        sides=(solution,),
        shift=shift,
        travel=2.0 * shift,
        stiffness=holding_count * solution.stiffness,
        quasistatic=holding_count * solution.quasistatic,
    )


def bearing_case(solver: Solver, solution: SolvedBearing) -> CaseValues:
    """Returns values and attributes of a bearing's case, with those of its growth."""
    values, attrs = solver.case(solution)
    return values | growth_values(solution.scene), attrs


@dataclass
class Alone:
    """A bearing by itself, or each half of a symmetric pair, under its own preload."""

    scene: Scene
    sides: tuple[Solver, ...]
    near: SolvedBearing | None = None  # the last usable solution

    @property
    def start(self) -> Conditions:
        """Returns the condition of the bearing as the scene has it."""
        return (self.sides[0].start,)

    def solve(
        self,
        conditions: Conditions,
        near: SolvedBearing | None = None,
        tolerance: float | None = None,
    ) -> RotorState:
        """Returns the bearing in a condition, solved from `near` if given, else from `self.near`.

        A usable solution becomes the new `self.near`.

        tolerance: unused, as no rotor is balanced; `OnRotor` has it.
        """
        (side,), (condition,) = self.sides, conditions
        solution = side(condition, near or self.near)
        if solution.is_usable:
            self.near = solution
        return half_of_pair(self.scene, side.mounted, solution)

    def with_sides(self, sides: tuple[SolvedBearing, ...], state: RotorState) -> RotorState:
        """Returns the state of the arrangement with another solution of the bearing."""
        return half_of_pair(self.scene, self.sides[0].mounted, sides[0])

    def case(self) -> CaseValues:
        """Returns values and attributes of the scene as it is.

        Of a symmetric pair they are those of both bearings, see `pair_case`; without a solution,
        the status alone.
        """
        (side,) = self.sides
        (solution,) = self.solve(self.start).sides
        values, attrs = bearing_case(side, solution)
        is_steady_at_fixed_position = isinstance(innermost(side), Steady) and is_held(side.scene)
        if isinstance(side, Warm) and is_steady_at_fixed_position and solution.status == code.OK:
            attrs["preload_spread"] = preload_spread(side)
        if self.scene.pair is None:
            return values, attrs
        if "axial_stiffness" not in values:
            return {"status": values["status"]}, {"residual": "not solved"}
        # the case may be another, stable state than the solution
        case_solution = solution._replace(
            status=values["status"],
            stiffness=float(values["axial_stiffness"]),
            quasistatic=float(values["quasistatic_axial_stiffness"]),
            place=float(values["axial_displacement"]),
        )
        return pair_case(
            self.scene,
            (side, side),
            half_of_pair(self.scene, side.mounted, case_solution),
            [(values, attrs)] * 2,
        )


@dataclass
class OnRotor:
    """Two bearings that differ, or under an external force.

    tolerance: unbalanced force on the rotor, over the larger one.
    nearby, near: places and solutions that the next balance starts from.
    """

    scene: Scene
    arrangement: Arrangement
    sides: tuple[Solver, ...]
    tolerance: float = ROTOR_BALANCED
    nearby: Nearby = field(default_factory=Nearby)
    near: list[SolvedBearing | None] = field(default_factory=lambda: [None, None])

    @property
    def start(self) -> Conditions:
        """Returns the conditions of both bearings as the scene has them."""
        return tuple(side.start for side in self.sides)

    def solve(
        self,
        conditions: Conditions,
        near: SolvedBearing | None = None,
        tolerance: float | None = None,
    ) -> RotorState:
        """Returns both bearings in their conditions, solved from their last state.

        `self.near` and `self.nearby` become those of this one. With thermal networks the rotor is
        balanced roughly first, then to the tolerance at the temperatures found. Where a bearing has
        no temperatures by itself, those of both are sought together.

        near: unused; `Alone` has it.
        tolerance: unbalanced force on the rotor, over the larger one, if not that of `self`.
        """
        tolerance = tolerance or self.tolerance
        if self.scene.operation.preload_N == 0.0:
            return RotorState(code.PRELOAD_GONE)
        if not any(isinstance(side, Warm) for side in self.sides):
            return self._balance(self.sides, conditions, tolerance)
        rough = self._balance(self.sides, conditions, max(tolerance, WARM_BALANCED))
        if rough.status in USABLE:
            # the last steps of the rotor, at the temperatures of the rough balance
            balances = [solution.warmed for solution in rough.sides]
            return self._balance(self._solvers_at(balances), conditions, tolerance)
        if rough.status not in NO_BALANCE_ALONE:
            return rough
        joint_balances = self._joint_balances(conditions)
        if joint_balances is None:
            return rough
        exact = self._balance(self._solvers_at(joint_balances), conditions, tolerance)
        return exact if exact.status in USABLE else rough

    def _solvers_at(self, balances: Sequence[Warmed | None]) -> tuple[Solver, ...]:
        """Returns the solvers of both bearings at the temperatures of given heat balances.

        balances: of each bearing; None without a thermal network.
        """
        return tuple(
            Warm(side.solver, balance) if isinstance(side, Warm) else side
            for side, balance in zip(self.sides, balances, strict=True)
        )

    def _joint_balances(self, conditions: Conditions) -> list[Warmed | None] | None:
        """Returns the temperatures of both bearings, sought together; None if none are found.

        A bearing without a thermal network has None in the list.
        """
        warm = [k for k, side in enumerate(self.sides) if isinstance(side, Warm)]

        def by_side(warmed: Sequence[Warmed]) -> list[Warmed | None]:
            """Returns the balances of the warm sides, with None for the other one."""
            by_warm_side = dict(zip(warm, warmed, strict=True))
            return [by_warm_side.get(k) for k in range(len(self.sides))]

        def heats(scenes: Sequence[Scene]) -> list[HeatFlow] | None:
            """Returns the heats of the warm sides at temperatures; None without a balance."""
            sides = self._solvers_at(by_side([Warmed.as_given(scene) for scene in scenes]))
            state = self._balance(sides, conditions, WARM_BALANCED)
            if state.status not in USABLE:
                return None
            return [sides[k].heat(state.sides[k]) for k in warm]

        error = max(self.sides[k].heat_error for k in warm)
        joint_balance = find_joint_heat_balance([self.sides[k].scene for k in warm], heats, error)
        return None if joint_balance is None else by_side(joint_balance)

    def _balance(
        self, sides: tuple[Solver, ...], conditions: Conditions, tolerance: float
    ) -> RotorState:
        """Returns the balance of the rotor with solvers of both bearings in their conditions.

        tolerance: unbalanced force over the larger one.
        """
        losses = conditions[0].loss, conditions[1].loss

        def solve_side(k: int, hold: Place | Force) -> SolvedBearing:
            """Returns bearing k at a place, or under its share of a force on all in tandem."""
            n = self.arrangement.tandem[k]
            if isinstance(hold, Force):
                hold = Force(hold.F_x / n)
            solution = sides[k](conditions[k]._replace(hold=hold), self.near[k])
            if solution.is_usable:
                self.near[k] = solution
            return solution

        if self.arrangement.kind == "rigid_pair":
            return self._rigid_balance(solve_side, losses, tolerance)
        return self._spring_balance(solve_side, losses, tolerance)

    def _rigid_balance(
        self,
        solve_side: Callable[[int, Place], SolvedBearing],
        losses: tuple[float, float],
        tolerance: float,
    ) -> RotorState:
        """Returns the balance of a rigid pair: F_1(d_1 + x) - F_2(d_2 - x) = F_ext for x.

        solve_side: returns a bearing, 0 or 1, at an axial displacement.
        losses: of ball diameter [m].
        tolerance: unbalanced force over the larger one.
        """
        first, second = self.sides
        F_ext, tandem = self.arrangement.external_axial_N, self.arrangement.tandem

        def trial_at(x: float) -> RotorTrial:
            """Returns both bearings with the rotor displaced by x towards +X [m]."""
            states = (
                solve_side(0, Place(first.mounted + x)),
                solve_side(1, Place(second.mounted - x)),
            )
            F_1, F_2 = (n * state.force for n, state in zip(tandem, states, strict=True))
            return RotorTrial(
                states=states,
                unbalanced=F_1 - F_2 - F_ext,
                slope=sum(n * state.steepness for n, state in zip(tandem, states, strict=True)),
                scale=max(F_1, F_2, abs(F_ext)),
            )

        start = functools.partial(self._first_place, losses, F_ext)
        return self._balance_from_nearby(trial_at, losses, start, self._negligible_step, tolerance)

    @functools.cached_property
    def _negligible_step(self) -> float:
        """Returns the step of the rotor below which its balance does not change [m]."""
        return _ROUNDED * self.sides[0].mechanics(0.0).g.BD

    def _spring_balance(
        self,
        solve_side: Callable[[int, Force], SolvedBearing],
        losses: tuple[float, float],
        tolerance: float,
    ) -> RotorState:
        """Returns the balance of a spring pair: F_2 = F_s - k_s e for the spring's extension e.

        It extends as far as both bearings allow.

        solve_side: returns a bearing, 0 or 1, under an axial force.
        losses: of ball diameter [m].
        tolerance: unbalanced force over the larger one.
        """
        a = self.arrangement
        F_s = float(self.scene.operation.preload_N)
        k_s = a.spring_stiffness_N_um * N_UM

        def trial_at(e: float) -> RotorTrial | int:
            """Returns both bearings with the spring extended by e [m], or LIFTED_OFF without force.

            Its unbalanced force is k_s times the extension that the bearings do not allow.
            """
            F_2 = F_s - k_s * e
            F_1 = F_2 + a.external_axial_N
            if not (F_1 > 0.0 and F_2 > 0.0):
                return code.LIFTED_OFF
            states = solve_side(0, Force(F_1)), solve_side(1, Force(F_2))
            allowed_extension = sum(
                state.place - side.mounted for state, side in zip(states, self.sides, strict=True)
            )
            relative_compliance = sum(
                k_s / (n * state.steepness)
                for n, state in zip(a.tandem, states, strict=True)
                if state.is_usable
            )
            return RotorTrial(
                states=states,
                unbalanced=k_s * (e - allowed_extension),
                slope=k_s * (1.0 + relative_compliance),
                scale=max(F_1, F_2),
            )

        return self._balance_from_nearby(trial_at, losses, lambda: 0.0, 0.0, tolerance)

    def _balance_from_nearby(
        self,
        trial_at: Callable[[float], RotorTrial | int],
        losses: tuple[float, float],
        start: Callable[[], float],
        rounded: float,
        tolerance: float,
    ) -> RotorState:
        """Returns the balance, sought from the place that earlier ones predict, then from the last.

        trial_at: returns the bearings at a place of the rotor [m], or the status of a failure.
        losses: of ball diameter [m].
        start: returns the place to begin with if there is no earlier one [m].
        rounded: step of the rotor that changes nothing [m].
        tolerance: unbalanced force over the larger one.
        """
        nearby = self.nearby
        _, last = nearby.last
        has_place = nearby.has_place
        x = nearby.expected_place(losses) if has_place else start()
        place, trial = balanced_place(trial_at, x, rounded, nearby, tolerance)
        if isinstance(trial, int) and has_place:
            # a slope over a short distance can lead far astray
            nearby.forget()
            second_place, second_trial = balanced_place(trial_at, last, rounded, nearby, tolerance)
            if not isinstance(second_trial, int):  # else the first status is the better reason
                place, trial = second_place, second_trial
        return self._state(losses, place, trial, tolerance <= self.tolerance)

    def _state(
        self, losses: tuple[float, float], place: float, trial: RotorTrial | int, exact: bool
    ) -> RotorState:
        """Returns the state of the rotor in a trial at a place [m], and remembers that place.

        Its status is that of the first bearing that is not OK. Without a balance no place is
        remembered, and slopes are dropped.

        trial: a status if there is no balance.
        exact: whether the place is balanced to the tolerance of the rotor.
        """
        if isinstance(trial, int):
            self.nearby.forget()
            return RotorState(self.sides[0].unsteady if trial == code.NO_STEADY_STATE else trial)
        if exact:
            self.nearby.remember(losses, place)
        else:
            self.nearby.remember_rough(losses, place)
        states = trial.states
        status = next((state.status for state in states if state.status != code.OK), code.OK)
        shifts = [
            state.place - side.mounted for state, side in zip(states, self.sides, strict=True)
        ]
        travel = 0.0 if self.arrangement.kind == "rigid_pair" else sum(shifts)
        return self.with_sides(states, RotorState(status, states, shifts[0], travel))

    def with_sides(self, sides: tuple[SolvedBearing, ...], state: RotorState) -> RotorState:
        """Returns the state of the rotor with other solutions of the bearings."""
        return state._replace(
            sides=sides,
            stiffness=self.stiffness([side.stiffness for side in sides]),
            quasistatic=self.stiffness([side.quasistatic for side in sides]),
        )

    def stiffness(self, bearing_stiffnesses: Sequence[float]) -> float:
        """Returns the axial stiffness of the arrangement [N/m].

        bearing_stiffnesses: stiffness of one bearing of each side [N/m].
        """
        k_1, k_2 = (
            n * k for n, k in zip(self.arrangement.tandem, bearing_stiffnesses, strict=True)
        )
        if self.arrangement.kind == "rigid_pair":
            return k_1 + k_2
        k_s = self.arrangement.spring_stiffness_N_um * N_UM
        return k_1 + k_s * k_2 / (k_s + k_2)

    def _first_place(self, losses: tuple[float, float], F_ext: float) -> float:
        """Returns the place of the rotor [m] by the mechanics of rolling balls, without friction.

        It is accurate to `NEAR_START` alone, and 0 where none is found.

        losses: of ball diameter [m].
        F_ext: external axial force on the rotor [N].
        """
        first, second = (
            in_tandem(side.mechanics(loss), n)
            for side, n, loss in zip(self.sides, self.arrangement.tandem, losses, strict=True)
        )
        mounted = [side.mounted for side in self.sides]
        x = 0.0
        for _ in range(_NEWTON_STEPS):
            F_1, k_1 = first.force_and_stiffness(mounted[0] + x)
            F_2, k_2 = second.force_and_stiffness(mounted[1] - x)
            if not (F_1 > 0.0 and F_2 > 0.0):
                break
            step = (F_ext - F_1 + F_2) / (k_1 + k_2)
            x += step
            if abs(step) <= NEAR_START * (abs(mounted[0]) + abs(mounted[1])):
                return x

        def unbalanced(x: float) -> float:
            """Returns the axial force on the rotor that pushes it back towards -X [N]."""
            return first.force(mounted[0] + x) - second.force(mounted[1] - x) - F_ext

        reach = max(abs(mounted[0]), abs(mounted[1]), _LEAST_REACH * first.g.BD)
        for _ in range(_WIDEST):
            if unbalanced(-reach) <= 0.0 <= unbalanced(reach):
                return brent_root(unbalanced, -reach, reach, xtol=NEAR_START * reach)
            reach *= 2.0
        return 0.0

    def case(self) -> CaseValues:
        """Returns values and attributes of the scene as it is.

        The case of a bearing may have a stable steady state in place of the balanced one. The rotor
        is then balanced again from that motion, up to `_MOST_BALANCES` times. Without a balance
        the values are the status alone.
        """
        for _ in range(_MOST_BALANCES):
            state = self.solve(self.start)
            if not state.sides:
                return {"status": state.status}, {"residual": "not solved"}
            cases = []
            has_moved = False
            for k, (side, solution) in enumerate(zip(self.sides, state.sides, strict=True)):
                cases.append(bearing_case(side, solution))
                values, _ = cases[-1]
                moved_solution = side.with_motion_of_case(solution, values)
                if moved_solution is not None:
                    self.near[k] = moved_solution
                    has_moved = True
            if not has_moved:
                break
        return pair_case(self.scene, self.sides, state, cases)


def in_tandem(bearing: Mechanics, n: int) -> Mechanics:
    """Returns n identical bearings in tandem as one."""
    return bearing._replace(g=bearing.g._replace(n_balls=n * bearing.g.n_balls))


def pair_case(
    scene: Scene, sides: Sequence[Solver], state: RotorState, cases: Sequence[CaseValues]
) -> CaseValues:
    """Returns values and attributes of two bearings, stacked along `bearing`.

    sides: solvers of the bearings.
    state: of the rotor; of a symmetric pair it has one bearing.
    cases: values and attributes of each bearing.
    """
    a = scene.pair
    side_values = [values for values, _ in cases]
    assert a is not None
    solutions = state.sides * 2 if len(state.sides) == 1 else state.sides
    resting = tuple(
        in_tandem(side.at(solution.scene).mechanics(side.start.loss, 0.0), n)
        for side, solution, n in zip(sides, solutions, a.tandem, strict=True)
    )
    mounted = sides[0].mounted, sides[1].mounted
    spring = None
    if a.kind != "rigid_pair":
        spring = PreloadSpring(float(scene.operation.preload_N), a.spring_stiffness_N_um * N_UM)
    values = stacked_sides(side_values) | state.values
    if a.kind == "rigid_pair":
        values.pop("spring_travel", None)
    values |= {
        "lift_off_force": AxialRotor((resting[0], resting[1]), mounted, spring).opening_force,
        "rotor_balance_residual": rotor_balance(scene, mounted, side_values),
    }
    if "stiffness_matrix" in side_values[0]:
        matrices = (values_of_side["stiffness_matrix"] for values_of_side in side_values)
        K = np.array([n * matrix for n, matrix in zip(a.tandem, matrices, strict=True)])
        frequencies = natural_frequencies(a, K, state.stiffness)
        if frequencies is not None:
            values["natural_frequency"] = frequencies
    values["status"] = _pair_status(state, side_values, values["rotor_balance_residual"])
    return values, joined_attributes([attrs for _, attrs in cases])


def _pair_status(
    state: RotorState, side_values: Sequence[Mapping[str, Any]], residual: float
) -> int:
    """Returns the status of a pair: that of the first failure, else OK or UNVERIFIED.

    UNVERIFIED where the residual is above `LARGEST_RESIDUAL` and the rounding of the loads.

    side_values: result variables of each bearing.
    residual: of the rotor's balance, see `rotor_balance`.
    """
    for status in (state.status, *(int(values["status"]) for values in side_values)):
        if status != code.OK:
            return status
    rounding = max(float(values.get("equilibrium_rounding", 0.0)) for values in side_values)
    allowed = max(LARGEST_RESIDUAL, min(rounding, MOST_ROUNDING))
    return code.OK if residual <= allowed else code.UNVERIFIED
