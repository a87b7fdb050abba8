"""What a machine asks of new and worn bearings: torque margin and launch in each case.

A corner of the torque is a case, a state of wear and a friction. Theory: docs/theory.md, sections
25 and 26.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.many import HertzianLives, worn_life
from bearingwear.scene.cases import NOMINAL
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.scene.coefficients import usual_spread
from bearingwear.scene.requirements import Launch
from bearingwear.scene.scene import Distribution, Scene
from bearingwear.scene.uncertain import UNCERTAIN, nominal_value
from bearingwear.solvers.bearing.films import COVERED, Films
from bearingwear.solvers.bearing.launch import Launched, launched, wear_at_launch
from bearingwear.solvers.bearing.mounted import RPM, UM
from bearingwear.solvers.compose import solver_of

Losses = tuple[float, ...]
"""Of ball diameter, of each bearing [m]."""

_NEW, _WORN, _BARE = "new", "worn", "film worn off"
_ENDS = 0.05, 0.95


@dataclass(frozen=True)
class Corner:
    case: str
    wear: str
    key: str  # of the friction
    friction: float  # [as in the scene]
    torque: float  # of all bearings together; NaN where it was not solved [N m]
    margin: float
    stalls: bool


def friction_interval(scene: Scene) -> tuple[str, list[float]]:
    """The key of the friction, and its 5 %, nominal and 95 % values.

    By the scene's `uncertainty`, else by the spread of the table of coefficients.
    """
    name = "shear_strength_MPa" if scene.friction.film is not None else "ball_race"
    own, given = nominal_value(scene, name), (scene.uncertainty or {}).get(name)
    key = f"{UNCERTAIN[name]}.{name}"
    if scene.uncertainty is None and (usual := usual_spread(scene.to_dict())[0].get(name)):
        given = Distribution(**usual)
    if given is None:
        return key, [own]
    # it loads slowly, and few scenes have a drive
    from bearingwear.scene.distributions import possible, quantile

    ends = quantile(given, own, possible(key), np.array(_ENDS))
    return key, sorted({*ends.tolist(), own})


def arrangement_torque(scene: Scene, losses: Losses, bare: bool = False) -> float:
    """Torque on the shaft of all bearings of a scene at a loss of each [N m]; NaN if not solved.

    Friction and drag, by the power that they take over the speed.
    """
    solver = solver_of(scene)
    start, sides = solver.bearings.start, (losses * 2)[:2]
    films = (True, True) if bare else COVERED
    conditions = tuple(
        one._replace(loss=loss, bare=films) for one, loss in zip(start, sides, strict=False)
    )
    states = solver(conditions)
    if any(state.status != code.OK for state in states):
        return math.nan
    power = [float(state["friction_power"]) for state in states]
    operation = scene.operation
    speed = abs(operation.shaft_speed_rpm - operation.outer_speed_rpm) * RPM
    tandem = scene.pair.tandem if scene.pair is not None else (1,)
    powers = power * 2 if len(power) < len(tandem) else power
    return sum(n * P for n, P in zip(tandem, powers, strict=True)) / speed


def losses_at_end(scene: Scene) -> Losses | None:
    """Of each bearing at the end of its life [m]; None of a scene without one, or not solved."""
    end = scene.wear.end_of_life
    if end is None or not end.criteria:
        return None
    life = worn_life(scene, only_times=True) or HertzianLives(scene)(scene)
    if life.status != code.OK:
        return None
    return tuple(state.loss for state in life.nodes[-1].states)


def corners_of_case(scene: Scene, case: str, wear: Iterable[tuple[str, Losses]]) -> list[Corner]:
    """Corners of one case of a scene with a drive, in some states of wear."""
    drive = scene.drive
    assert drive is not None
    if scene.operation.shaft_speed_rpm == scene.operation.outer_speed_rpm:
        problem = (
            "got equal speeds for both races, at which no torque is required, expected different "
            "speeds"
        )
        raise NotAvailable(f"{scene.name}: operation.shaft_speed_rpm: {problem}")
    key, values = friction_interval(scene)
    found = []
    for friction in values:
        one = scene.with_({key: friction})
        for words, losses in wear:
            torque = arrangement_torque(one, losses, words == _BARE)
            margin, stalls = drive.margin(torque), drive.stalls(torque)
            found.append(Corner(case, words, key, friction, torque, margin, stalls))
    return found


def torque_corners(scene: Scene) -> list[Corner]:
    """Every corner of the cases of a scene: new, worn at the end of the case's life, without film.

    Worn bearings have the contacts of the groove as new, at their loss.
    """
    found = []
    for name, one in scene.in_cases.items():
        start = tuple(c.loss for c in solver_of(one).bearings.start)
        wear: list[tuple[str, Losses]] = [(_NEW, start)]
        if (worn := losses_at_end(one)) is not None:
            wear.append((_WORN, worn))
        if any(Films.of(side).wear_through for side in one.sides):
            wear.append((_BARE, worn or start))
        found += corners_of_case(one, name, wear)
    return found


def least_margin(scene: Scene, losses: Sequence[Losses]) -> float:
    """The least torque margin of a scene in some states of wear; NaN without a drive."""
    if scene.drive is None:
        return math.nan
    wear = [(f"state {k}", loss) for k, loss in enumerate(losses)]
    margins = [corner.margin for corner in corners_of_case(scene, "", wear)]
    return min(margins) if all(map(math.isfinite, margins)) else math.nan


def launched_by_wear(scene: Scene) -> dict[str, Launched]:
    """Launch loads and gaps by the state of wear, and by the case where there are several.

    Only those of new bearings where their wear is not known: without an end of life, or where the
    life was not computed.
    """
    found = {}
    for case, one in scene.in_cases.items():
        where = "" if case == NOMINAL and len(scene.in_cases) == 1 else f" ({case})"
        found[f"{_NEW}{where}"] = launched(one)
        new = tuple(UM * float(np.max(side.wear.ball_diameter_loss_um)) for side in one.sides)
        try:
            end = losses_at_end(one)
        except NotAvailable:
            end = None
        if (losses := wear_at_launch(one, new, end)) is not None:
            limit = (one.launch or Launch()).after_wear_um
            worn = _WORN if limit is None else f"after {limit:g} um of wear"
            found[f"{worn}{where}"] = launched(one, losses)
    return found
