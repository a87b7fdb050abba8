"""Lives over a duty, exact and quick, and the phase that ends them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.duty.cycle import Cycle, cycle_of
from bearingwear.lives.duty.wearing import DutyCriteria, DutyGrooves, DutySurfaces
from bearingwear.lives.ends import NO_CRITERION, Criteria
from bearingwear.lives.follow import Life
from bearingwear.lives.groove_life import GrooveChoice, groove_choice
from bearingwear.lives.grooves import (
    EXACT_GROOVES,
    GrooveMode,
    Grooves,
    StiffGrooves,
    follow_grooves,
    quick_groove_life,
)
from bearingwear.lives.surfaces import follow_surfaces, surface_life
from bearingwear.scene.duty import phase_cases
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.mounted import UM
from bearingwear.solvers.compose import WELL_BALANCED, Remembered, solver_of
from bearingwear.solvers.condition import Accuracy

MOST_RAMP_POINTS = 5
_MET = 1e-9  # largest margin of a criterion that counts as met
RAMP_ENOUGH = 1e-3  # error of the mean wear rate by the points of the ramps


@dataclass
class DutyLife:
    """A life over a duty, and its cycle."""

    cycle: Cycle
    life: Life
    grooves: str = ""  # sentence on whether they are followed, and why
    is_worn: bool = False  # whether they are followed

    @property
    def by_case(self) -> dict[str, Life]:
        """Returns the life by the names of the cases of the duty: equal times, other states."""
        return {name: self.in_case(k) for k, name in enumerate(self.cycle.cases)}

    def in_case(self, case: int) -> Life:
        """Returns the life with the states and the way to wear of one case, by its index."""
        life, n = self.life, self.cycle.bearings
        nodes = [
            node._replace(states=node.states[case * n : (case + 1) * n]) for node in life.nodes
        ]
        return replace(life, nodes=nodes, wearing=life.wearing.ways[case], unsolved_node=None)

    @property
    def ends_in_all_cases(self) -> bool:
        """Returns whether its criterion is met in all cases at once, as a limit of the loss is."""
        return self.life.status == code.OK and max(self._final_margins()) <= _MET

    @property
    def ending_case_index(self) -> int:
        """Returns the index of the case that ends the life: it meets the criterion, or fails.

        Where a condition on the way to a speed fails, it is the case of its phase. Where no
        criterion is met and nothing fails, it is 0.
        """
        cycle, life = self.cycle, self.life
        if life.status == code.OK and life.criterion < NO_CRITERION:
            return int(np.argmin(self._final_margins()))
        failed = life.tried_nodes[-1]
        if failed.status == code.OK:
            return 0
        # the states end with the first condition that is not solved
        condition = (len(failed.states) - 1) // cycle.bearings
        if condition < len(cycle.cases):
            return condition
        phase = int(np.flatnonzero(cycle.starting[:, condition])[0])
        return cycle.case_of_phase[phase]

    def _final_margins(self) -> list[float]:
        """Returns the margins that each case has at the end to the criterion of the life."""
        by_case = DutyCriteria(self.cycle).margins_by_case(self.life.last.states)
        return [margins[self.life.criterion] for margins in by_case]


def duty_life(
    scene: Scene,
    fidelity: str = "steady",
    quick: bool = False,
    kind: type[Grooves] = StiffGrooves,
) -> DutyLife:
    """Returns the life of a scene over its duty; its grooves are followed if any phase requires it.

    Bearings that meet a criterion when new have a life of length zero, even if their grooves cannot
    be solved.

    quick: whether steps are longer and, along grooves, cells are fewer.
    kind: of grooves. States of the kind `Grooves` have no stiffness unless the life ends by it,
        which saves time.
    """
    cycle = cycle_with_enough_points(scene, fidelity)
    choice = duty_groove_choice(scene, fidelity)
    if not choice.follows:
        return DutyLife(cycle, _even_duty_life(cycle, fidelity, quick), choice.sentence)
    if quick:
        life = quick_groove_life(partial(DutyGrooves, cycle, kind=kind), DutyCriteria(cycle))
    else:
        life = worn_duty_life(cycle, kind=kind)
    if life.nodes[0].status == code.OK:
        return DutyLife(cycle, life, choice.sentence, is_worn=True)
    # an end that is met when new needs no grooves
    even = _even_duty_life(cycle, fidelity, quick)
    if even.status == code.OK and even.last.time == 0.0:
        return DutyLife(cycle, even, choice.sentence)
    return DutyLife(cycle, life, choice.sentence, is_worn=True)


def _even_duty_life(cycle: Cycle, fidelity: str, quick: bool) -> Life:
    """Returns the life over a cycle whose contacts stay Hertzian, by new solvers."""
    tolerance = WELL_BALANCED if quick else None
    solvers = [solver_of(scene, fidelity, tolerance=tolerance) for scene in cycle.scenes]
    return hertzian_duty_life(cycle, solvers, quick)


def lives_alone(over_duty: DutyLife, fidelity: str = "steady") -> dict[str, Life]:
    """Returns the life of each case of a duty alone, without starts, by the names of the cases.

    Contacts wear as over the duty, with grooves that are followed or not. A duty of one condition
    has its life over the duty.
    """
    cycle = over_duty.cycle
    if len(cycle.scenes) == 1:
        return over_duty.by_case
    scenes = zip(cycle.cases, cycle.case_scenes, strict=True)
    if over_duty.is_worn:
        return {case: follow_grooves(Grooves(scene)) for case, scene in scenes}
    return {case: surface_life(scene, solver_of(scene, fidelity)) for case, scene in scenes}


def duty_groove_choice(scene: Scene, fidelity: str = "steady") -> GrooveChoice:
    """Returns whether a life over a duty follows the grooves, and why; any phase may require it."""
    choices = [groove_choice(case, fidelity) for case in phase_cases(scene).values()]
    return next((choice for choice in choices if choice.follows), choices[0])


def grooves_wear(scene: Scene) -> bool:
    """Returns whether the steady life of a scene, over its duty if any, follows the grooves."""
    if scene.duty is not None:
        return duty_groove_choice(scene).follows
    return groove_choice(scene, "steady").follows


def criteria_of(scene: Scene) -> Criteria:
    """Returns the end-of-life criteria of a scene, in all phases of its duty if it has one."""
    return Criteria(scene) if scene.duty is None else DutyCriteria(cycle_of(scene))


def hertzian_duty_life(cycle: Cycle, solvers: Sequence[Remembered], quick: bool = False) -> Life:
    """Returns the life over a cycle whose contacts stay Hertzian.

    solvers: of each condition.
    quick: as in `surface_life`.
    """
    scene = cycle.scenes[0]
    life = follow_surfaces(DutySurfaces(cycle, solvers), DutyCriteria(cycle), scene, quick)
    life.solves = sum(solver.solves for solver in solvers)
    return life


def worn_duty_life(
    cycle: Cycle, mode: GrooveMode = EXACT_GROOVES, kind: type[Grooves] = StiffGrooves
) -> Life:
    """Returns the life over a cycle with grooves as they wear.

    kind: as in `duty_life`.
    """
    return follow_grooves(DutyGrooves(cycle, mode, kind), DutyCriteria(cycle))


def loss_rates(cycle: Cycle, losses: Sequence[float], fidelity: str = "steady") -> np.ndarray:
    """Returns the rate of loss (conditions,) in each condition of a cycle [m/s].

    Rates of the bearings are added. From the first condition that is not solved on, all are NaN.

    losses: even loss of each bearing [m].
    """
    rates = np.full(len(cycle.scenes), np.nan)
    for k, scene in enumerate(cycle.scenes):
        solver = solver_of(scene, fidelity, Accuracy.BRIEF)
        pairs = zip(solver.bearings.start, losses, strict=True)
        states = solver(tuple(condition._replace(loss=loss) for condition, loss in pairs))
        if any(state.status != code.OK for state in states):
            break
        rates[k] = sum(state.rate for state in states)
    return rates


def ramp_error(
    scene: Scene, points: int, losses: Sequence[float] | None = None, fidelity: str = "steady"
) -> float:
    """Returns the relative error of the mean rate of loss by a number of points of each ramp [1].

    It is the magnitude of the difference from the rate by `MOST_RAMP_POINTS`. It is 0 without
    starts, and NaN where a condition is not solved or nothing wears.

    losses: of each bearing, if not those of the scene [m].
    """
    cycle, finer = cycle_of(scene, points), cycle_of(scene, MOST_RAMP_POINTS)
    if not cycle.starting.any():
        return 0.0
    if losses is None:
        losses = present_losses(cycle)
    rate, fine_rate = (
        sum((ramped.shares * loss_rates(ramped, losses, fidelity)).tolist())
        for ramped in (cycle, finer)
    )
    return abs(rate - fine_rate) / fine_rate if fine_rate > 0.0 else np.nan


def present_losses(cycle: Cycle) -> list[float]:
    """Returns the loss of each bearing that is solved, at the start of a life [m]."""
    bearings = cycle.scenes[0].symmetric_half.sides
    return [side.wear.ball_diameter_loss_um[0] * UM for side in bearings]


def cycle_with_enough_points(scene: Scene, fidelity: str = "steady") -> Cycle:
    """Returns the cycle of a scene's duty with the ramp points that its wear needs when new.

    Their number rises from two until the error is at most `RAMP_ENOUGH`, or to `MOST_RAMP_POINTS`.
    It stays two where the ramps cause at most a share `RAMP_ENOUGH` of the wear, or where the error
    is not known.
    """
    points = 2
    cycle = cycle_of(scene, points)
    if not cycle.starting.any():
        return cycle
    rates = loss_rates(cycle, present_losses(cycle), fidelity)
    if cycle.starting.sum(axis=0) @ rates <= RAMP_ENOUGH * (cycle.shares @ rates):
        return cycle
    while points < MOST_RAMP_POINTS and ramp_error(scene, points, None, fidelity) > RAMP_ENOUGH:
        points += 1
    return cycle_of(scene, points)
