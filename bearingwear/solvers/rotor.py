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
from bearingwear.solvers.bearing.rotor_balance import ROTOR_BALANCED, Nearby, RotorTrial, balanced
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
from bearingwear.solvers.thermal import HEAT_BALANCED
from bearingwear.solvers.warm import Warm, preload_spread

_ROUNDED = 1e-15  # a step below this, over the distance of the groove centres, changes nothing
NEAR_START = 1e-4  # of the range: how well the start is found
_NEWTON_STEPS = 6
_WIDEST = 60  # doublings of the range in which the rotor is looked for
_MOST_BALANCES = 3
WARM_BALANCED = 0.1 * HEAT_BALANCED  # force left while temperatures are found, no better than that


class RotorState(NamedTuple):
    status: int
    sides: tuple[SolvedBearing, ...] = ()
    shift: float = math.nan  # of the rotor from where it was mounted, towards +X [m]
    stiffness: float = math.nan  # axial, of the arrangement, dynamic [N/m]
    quasistatic: float = math.nan  # and quasi-static [N/m]

    @property
    def values(self) -> dict[str, float]:
        """Result variables of the arrangement; without a stiffness that is not known."""
        found = {
            "rotor_axial_shift": self.shift,
            "system_axial_stiffness": self.stiffness,
            "system_quasistatic_axial_stiffness": self.quasistatic,
        }
        return {name: value for name, value in found.items() if not math.isnan(value)}


def half_of_pair(scene: Scene, mounted: float, solution: SolvedBearing) -> RotorState:
    """A bearing as half of a symmetric pair.

    At a fixed position both bearings hold the rotor, and it stays where it is. A spring has no
    stiffness here, and the rotor goes where the bearing lets it from the axial displacement
    `mounted` [m].
    """
    method = scene.operation.preload_method
    holding = bearings_holding(method)
    return RotorState(
        status=solution.status,
        sides=(solution,),
        shift=0.0 if method == "fixed_position" else solution.place - mounted,
        stiffness=holding * solution.stiffness,
        quasistatic=holding * solution.quasistatic,
    )


def bearing_case(side: Solver, solution: SolvedBearing) -> CaseValues:
    values, attrs = side.case(solution)
    return values | growth_values(solution.scene), attrs


@dataclass
class Alone:
    """A bearing by itself, or each half of a symmetric pair, under its own preload."""

    scene: Scene
    sides: tuple[Solver, ...]
    near: SolvedBearing | None = None  # the last usable solution

    @property
    def start(self) -> Conditions:
        return (self.sides[0].start,)

    def solve(
        self,
        conditions: Conditions,
        near: SolvedBearing | None = None,
        tolerance: float | None = None,
    ) -> RotorState:
        """The bearing in a condition, from one nearby; no rotor is to be balanced."""
        (side,), (condition,) = self.sides, conditions
        solution = side(condition, near or self.near)
        if solution.is_usable:
            self.near = solution
        return half_of_pair(self.scene, side.mounted, solution)

    def arranged(self, sides: tuple[SolvedBearing, ...], found: RotorState) -> RotorState:
        return half_of_pair(self.scene, self.sides[0].mounted, sides[0])

    def case(self) -> CaseValues:
        (side,) = self.sides
        (solution,) = self.solve(self.start).sides
        values, attrs = bearing_case(side, solution)
        if isinstance(side, Warm) and isinstance(innermost(side), Steady) and is_held(side.scene):
            if solution.status == code.OK:
                attrs["preload_spread"] = preload_spread(side)
        if self.scene.pair is None:
            return values, attrs
        if "axial_stiffness" not in values:
            return {"status": values["status"]}, {"residual": "not solved"}
        taken = solution._replace(
            status=values["status"],
            stiffness=float(values["axial_stiffness"]),
            quasistatic=float(values["quasistatic_axial_stiffness"]),
            place=float(values["axial_displacement"]),
        )
        return pair_case(
            self.scene,
            (side, side),
            half_of_pair(self.scene, side.mounted, taken),
            [(values, attrs)] * 2,
        )


@dataclass
class OnRotor:
    """Two bearings that differ, or under a force.

    The tolerance is the force left on the rotor, over the larger one.
    """

    scene: Scene
    arrangement: Arrangement
    sides: tuple[Solver, ...]
    tolerance: float = ROTOR_BALANCED
    nearby: Nearby = field(default_factory=Nearby)
    near: list[SolvedBearing | None] = field(default_factory=lambda: [None, None])

    @property
    def start(self) -> Conditions:
        return tuple(side.start for side in self.sides)

    def solve(
        self,
        conditions: Conditions,
        near: SolvedBearing | None = None,
        tolerance: float | None = None,
    ) -> RotorState:
        """Both bearings in their conditions, from their last state."""
        tolerance = tolerance or self.tolerance
        if self.scene.operation.preload_N == 0.0:
            return RotorState(code.PRELOAD_GONE)
        if not any(isinstance(side, Warm) for side in self.sides):
            return self._balanced(self.sides, conditions, tolerance)
        found = self._balanced(self.sides, conditions, max(tolerance, WARM_BALANCED))
        if found.status not in USABLE:
            return found
        # the last steps, at temperatures that are known well enough
        kept = tuple(
            Warm(side.solver, one.warmed) if isinstance(side, Warm) else side
            for side, one in zip(self.sides, found.sides, strict=True)
        )
        return self._balanced(kept, conditions, tolerance)

    def _balanced(
        self, sides: tuple[Solver, ...], conditions: Conditions, tolerance: float
    ) -> RotorState:
        losses = conditions[0].loss, conditions[1].loss

        def solved(k: int, hold: Place | Force) -> SolvedBearing:
            n = self.arrangement.tandem[k]
            if isinstance(hold, Force):
                hold = Force(hold.F_x / n)
            found = sides[k](conditions[k]._replace(hold=hold), self.near[k])
            if found.is_usable:
                self.near[k] = found
            return found

        rigid = self.arrangement.kind == "rigid_pair"
        return (self._rigid if rigid else self._spring)(solved, losses, tolerance)

    def _rigid(
        self,
        solved: Callable[[int, Place], SolvedBearing],
        losses: tuple[float, float],
        tolerance: float,
    ) -> RotorState:
        """F_1(d_1 + x) - F_2(d_2 - x) = F_ext, the unknown x."""
        one, two = self.sides
        F_ext, tandem = self.arrangement.external_axial_N, self.arrangement.tandem

        def trial(x: float) -> RotorTrial:
            states = solved(0, Place(one.mounted + x)), solved(1, Place(two.mounted - x))
            F_1, F_2 = (n * state.force for n, state in zip(tandem, states, strict=True))
            slope = sum(n * state.steepness for n, state in zip(tandem, states, strict=True))
            return RotorTrial(states, F_1 - F_2 - F_ext, slope, max(F_1, F_2, abs(F_ext)))

        first = functools.partial(self._first_place, losses, F_ext)
        return self._found(trial, losses, first, self._rounded, tolerance)

    @functools.cached_property
    def _rounded(self) -> float:
        """Step of the rotor that changes nothing [m]."""
        return _ROUNDED * self.sides[0].mechanics(0.0).g.BD

    def _spring(
        self,
        solved: Callable[[int, Force], SolvedBearing],
        losses: tuple[float, float],
        tolerance: float,
    ) -> RotorState:
        """The spring extends by e, as far as both bearings give way; F_2 = F_s - k_s e."""
        a, F_s = self.arrangement, float(self.scene.operation.preload_N)
        k_s = a.spring_stiffness_N_um * N_UM

        def trial(e: float) -> RotorTrial | int:
            F_2 = F_s - k_s * e
            F_1 = F_2 + a.external_axial_N
            if not (F_1 > 0.0 and F_2 > 0.0):
                return code.LIFTED_OFF
            states = solved(0, Force(F_1)), solved(1, Force(F_2))
            given = sum(s.place - side.mounted for s, side in zip(states, self.sides, strict=True))
            each = zip(a.tandem, states, strict=True)
            soft = sum(k_s / (n * state.steepness) for n, state in each if state.is_usable)
            return RotorTrial(states, k_s * (e - given), k_s * (1.0 + soft), max(F_1, F_2))

        return self._found(trial, losses, lambda: 0.0, 0.0, tolerance)

    def _found(
        self,
        trial: Callable[[float], RotorTrial | int],
        losses: tuple[float, float],
        first: Callable[[], float],
        rounded: float,
        tolerance: float,
    ) -> RotorState:
        """The balance from where earlier ones lead; if that fails, from the place of the last one.

        first: where to begin without an earlier one.
        """
        known, last = self.nearby.known, self.nearby.last[1]
        x = self.nearby.at(losses) if known else first()
        place, found = balanced(trial, x, rounded, self.nearby, tolerance)
        if isinstance(found, int) and known:
            # what a short way said of the slope can lead far astray
            self.nearby.forget()
            again = balanced(trial, last, rounded, self.nearby, tolerance)
            if not isinstance(again[1], int):  # else the first reason is the nearer one
                place, found = again
        return self._state(losses, place, found, tolerance <= self.tolerance)

    def _state(
        self, losses: tuple[float, float], position: float, found: RotorTrial | int, exact: bool
    ) -> RotorState:
        """The state at a place, or why there is none."""
        if isinstance(found, int):
            self.nearby.forget()
            lost = self.sides[0].unsteady if found == code.NO_STEADY_STATE else found
            return RotorState(lost)
        self.nearby.found(losses, position, exact)
        states = found.states
        status = next((one.status for one in states if one.status != code.OK), code.OK)
        shift = states[0].place - self.sides[0].mounted
        return self.arranged(states, RotorState(status, states, shift))

    def arranged(self, sides: tuple[SolvedBearing, ...], found: RotorState) -> RotorState:
        return found._replace(
            sides=sides,
            stiffness=self.stiffness([one.stiffness for one in sides]),
            quasistatic=self.stiffness([one.quasistatic for one in sides]),
        )

    def stiffness(self, of_bearings: Sequence[float]) -> float:
        """Axial stiffness of the arrangement, from that of a bearing of each side [N/m]."""
        k_1, k_2 = (n * k for n, k in zip(self.arrangement.tandem, of_bearings, strict=True))
        if self.arrangement.kind == "rigid_pair":
            return k_1 + k_2
        k_s = self.arrangement.spring_stiffness_N_um * N_UM
        return k_1 + k_s * k_2 / (k_s + k_2)

    def _first_place(self, losses: tuple[float, float], F_ext: float) -> float:
        """Place of the rotor by the mechanics of rolling balls, without friction [m]."""
        each = zip(self.sides, self.arrangement.tandem, losses, strict=True)
        one, two = (in_tandem(side.mechanics(loss), n) for side, n, loss in each)
        mounted = [side.mounted for side in self.sides]
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
                return brent_root(left, -reach, reach, xtol=NEAR_START * reach)
            reach *= 2.0
        return 0.0

    def case(self) -> CaseValues:
        """Values and attributes of the scene as it is.

        A case may take a stable steady state in place of the one that was balanced. The rotor is
        then balanced again from that motion.
        """
        for _ in range(_MOST_BALANCES):
            state = self.solve(self.start)
            if not state.sides:
                return {"status": state.status}, {"residual": "not solved"}
            cases, has_moved = [], False
            for k, (side, one) in enumerate(zip(self.sides, state.sides, strict=True)):
                cases.append(bearing_case(side, one))
                if (moved := side.moved(one, cases[-1][0])) is not None:
                    self.near[k], has_moved = moved, True
            if not has_moved:
                break
        return pair_case(self.scene, self.sides, state, cases)


def in_tandem(one: Mechanics, n: int) -> Mechanics:
    return one._replace(g=one.g._replace(n_balls=n * one.g.n_balls))


def pair_case(
    scene: Scene, sides: Sequence[Solver], state: RotorState, cases: Sequence[CaseValues]
) -> CaseValues:
    """Values and attributes of two bearings, those of each along `bearing`."""
    a, each = scene.pair, [values for values, _ in cases]
    assert a is not None
    alike = state.sides * (2 if len(state.sides) == 1 else 1)
    resting = tuple(
        in_tandem(side.at(solution.scene).mechanics(side.start.loss, 0.0), n)
        for side, solution, n in zip(sides, alike, a.tandem, strict=True)
    )
    mounted = sides[0].mounted, sides[1].mounted
    spring = None
    if a.kind != "rigid_pair":
        spring = PreloadSpring(float(scene.operation.preload_N), a.spring_stiffness_N_um * N_UM)
    values = stacked_sides(each) | state.values
    values |= {
        "lift_off_force": AxialRotor((resting[0], resting[1]), mounted, spring).opening_force,
        "rotor_balance_residual": rotor_balance(scene, mounted, each),
    }
    if "stiffness_matrix" in each[0]:
        K = np.array([n * one["stiffness_matrix"] for n, one in zip(a.tandem, each, strict=True)])
        found = natural_frequencies(a, K, state.stiffness)
        if found is not None:
            values["natural_frequency"] = found
    values["status"] = _status(state, each, values["rotor_balance_residual"])
    return values, joined_attributes([attrs for _, attrs in cases])


def _status(state: RotorState, each: Sequence[Mapping[str, Any]], residual: float) -> int:
    for status in (state.status, *(int(one["status"]) for one in each)):
        if status != code.OK:
            return status
    rounding = max(float(one.get("equilibrium_rounding", 0.0)) for one in each)
    allowed = max(LARGEST_RESIDUAL, min(rounding, MOST_ROUNDING))
    return code.OK if residual <= allowed else code.UNVERIFIED
