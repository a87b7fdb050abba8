"""Lives over a duty, exact and quick, and what phase ends them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.duty.cycle import Cycle, cycle_of
from bearingwear.lives.duty.wearing import DutyCriteria, DutyGrooves, DutySurfaces
from bearingwear.lives.ends import NO_CRITERION, Criteria
from bearingwear.lives.follow import Life
from bearingwear.lives.groove_life import grooves_followed
from bearingwear.lives.grooves import (
    EXACT_GROOVES,
    QUICK_GROOVES,
    GrooveMode,
    Grooves,
    StiffGrooves,
    follow_grooves,
)
from bearingwear.lives.surfaces import follow_surfaces, surface_life
from bearingwear.scene.duty import phase_cases
from bearingwear.scene.scene import Scene
from bearingwear.solvers.compose import WELL_BALANCED, Remembered, solver_of
from bearingwear.solvers.condition import Accuracy

MOST_RAMP_POINTS = 5
_AT_ONCE = 1e-9  # margin of a criterion that counts as met
RAMP_ENOUGH = 1e-3  # error of the mean wear rate by the points of the ramps


@dataclass
class DutyLife:
    """A life over a duty, and its cycle."""

    cycle: Cycle
    life: Life
    grooves: str = ""  # whether they are followed, and why
    is_worn: bool = False

    @property
    def by_case(self) -> dict[str, Life]:
        """The life as its bearings are in each case of the duty: one time, other states."""
        return {name: life_of_case(self, k) for k, name in enumerate(self.cycle.cases)}

    @property
    def ends_in_all_cases(self) -> bool:
        """Whether its criterion is met in all cases at once, as that of an even loss."""
        if self.life.status != code.OK:
            return False
        of_cases = DutyCriteria(self.cycle).of_cases(self.life.last.states)
        return max(margins[self.life.criterion] for margins in of_cases) <= _AT_ONCE

    @property
    def ending_case(self) -> int:
        """Index of the case that ends the life: that meets its criterion, or is not solved.

        The first case of a life without an end of its own.
        """
        cycle, life = self.cycle, self.life
        if life.status == code.OK and life.criterion < NO_CRITERION:
            of_cases = DutyCriteria(cycle).of_cases(life.last.states)
            return int(np.argmin([margins[life.criterion] for margins in of_cases]))
        failed = life.tried[-1]
        if failed.status == code.OK:
            return 0
        condition = (len(failed.states) - 1) // cycle.bearings
        if condition < len(cycle.cases):
            return condition
        return cycle.case_of_phase[int(np.flatnonzero(cycle.starting[:, condition])[0])]


def life_of_case(found: DutyLife, case: int) -> Life:
    """The life over a duty as its bearings are in one of its cases, with its way to wear there."""
    life, n = found.life, found.cycle.bearings
    part = slice(case * n, (case + 1) * n)
    nodes = [node._replace(states=node.states[part]) for node in life.nodes]
    wearing = life.wearing.each[case]
    return Life(nodes, wearing, life.criterion, life.status, life.error, life.solves)


def duty_life(
    scene: Scene,
    fidelity: str = "steady",
    quick: bool = False,
    kind: type[Grooves] = StiffGrooves,
) -> DutyLife:
    """The life of a scene over its duty, with grooves as they wear where any phase requires it.

    A quick one takes longer steps and, along grooves, fewer cells. The states of the `kind`
    `Grooves` have no stiffness unless the life ends by it, which saves time.
    """
    cycle = cycle_with_enough_points(scene, fidelity)
    is_worn, sentence = duty_grooves(scene, fidelity)
    if is_worn:
        life = worn_duty_life(cycle, QUICK_GROOVES if quick else EXACT_GROOVES, kind)
        if life.nodes[0].status == code.OK:
            return DutyLife(cycle, life, sentence, is_worn=True)
        # an end that is met when new needs no grooves
        even = _even_duty_life(cycle, fidelity, quick)
        is_met = even.status == code.OK and even.last.time == 0.0
        return DutyLife(cycle, even if is_met else life, sentence, is_worn=not is_met)
    return DutyLife(cycle, _even_duty_life(cycle, fidelity, quick), sentence)


def _even_duty_life(cycle: Cycle, fidelity: str, quick: bool) -> Life:
    tolerance = WELL_BALANCED if quick else None
    solvers = [solver_of(one, fidelity, tolerance=tolerance) for one in cycle.scenes]
    return hertzian_duty_life(cycle, solvers, quick)


def lives_alone(found: DutyLife, fidelity: str = "steady") -> dict[str, Life]:
    """The life of each case of a duty alone, without starts, with the same contacts."""
    cycle = found.cycle
    if len(cycle.scenes) == 1:
        return found.by_case
    scenes = zip(cycle.cases, cycle.scenes, strict=False)
    if found.is_worn:
        return {case: follow_grooves(Grooves(one)) for case, one in scenes}
    return {case: surface_life(one, solver_of(one, fidelity)) for case, one in scenes}


def duty_grooves(scene: Scene, fidelity: str = "steady") -> tuple[bool, str]:
    """Whether a life over a duty follows the grooves, which any of its phases may require; why."""
    each = [grooves_followed(one, fidelity) for one in phase_cases(scene).values()]
    return max(((followed is not None, why) for followed, why in each), key=lambda one: one[0])


def grooves_wear(scene: Scene) -> bool:
    """Whether the steady life of a scene, over its duty if it has one, follows the grooves."""
    if scene.duty is not None:
        return duty_grooves(scene)[0]
    return grooves_followed(scene, "steady")[0] is not None


def criteria_of(scene: Scene) -> Criteria:
    """End-of-life criteria of a scene, in all phases of its duty if it has one."""
    return Criteria(scene) if scene.duty is None else DutyCriteria(cycle_of(scene))


def hertzian_duty_life(cycle: Cycle, solvers: Sequence[Remembered], quick: bool = False) -> Life:
    """The life over a cycle whose contacts stay Hertzian."""
    scene = cycle.scenes[0]
    life = follow_surfaces(DutySurfaces(cycle, solvers), DutyCriteria(cycle), scene, quick)
    life.solves = sum(states.solves for states in solvers)
    return life


def worn_duty_life(
    cycle: Cycle, mode: GrooveMode = EXACT_GROOVES, kind: type[Grooves] = StiffGrooves
) -> Life:
    """The life over a cycle with grooves as they wear."""
    return follow_grooves(DutyGrooves(cycle, mode, kind), DutyCriteria(cycle))


def mean_loss_rate(cycle: Cycle, losses: Sequence[float], fidelity: str = "steady") -> float:
    """Mean rate of loss over a cycle with even losses of the bearings [m/s]; NaN if not solved."""
    total = 0.0
    for share, scene in zip(cycle.shares.tolist(), cycle.scenes, strict=True):
        states = solver_of(scene, fidelity, Accuracy.BRIEF)
        start = zip(states.bearings.start, losses, strict=True)
        found = states(tuple(one._replace(loss=loss) for one, loss in start))
        if any(state.status != code.OK for state in found):
            return np.nan
        total += share * sum(state.rate for state in found)
    return total


def ramp_error(
    scene: Scene, points: int, losses: Sequence[float] | None = None, fidelity: str = "steady"
) -> float:
    """Relative error of the mean rate of loss by so many points of each ramp; by more points.

    With even losses of the bearings, else those of the scene. NaN where one is not solved.
    """
    cycle, finer = cycle_of(scene, points), cycle_of(scene, MOST_RAMP_POINTS)
    if not cycle.starting.any():
        return 0.0
    if losses is None:
        losses = [one.loss for one in solver_of(cycle.scenes[0], fidelity).bearings.start]
    rate, fine = (mean_loss_rate(one, losses, fidelity) for one in (cycle, finer))
    return abs(rate - fine) / fine if fine > 0.0 else np.nan


def cycle_with_enough_points(scene: Scene, fidelity: str = "steady") -> Cycle:
    """The cycle of a scene's duty, with as many points of its ramps as its wear needs when new."""
    points = 2
    while points < MOST_RAMP_POINTS and ramp_error(scene, points, None, fidelity) > RAMP_ENOUGH:
        points += 1
    return cycle_of(scene, points)
