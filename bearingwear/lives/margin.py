"""What a machine asks of new and worn bearings: torque margin and launch in each case.

A corner of the torque is a case, a state of wear and a friction. Theory: docs/theory.md, sections
25 and 26.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.follow import Life
from bearingwear.lives.many import HertzianLives, lives_by_case, worn_life
from bearingwear.scene.cases import NOMINAL
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.scene.coefficients import usual_spread
from bearingwear.scene.duty import cases_of_use
from bearingwear.scene.requirements import Launch
from bearingwear.scene.scene import Distribution, Scene, once
from bearingwear.scene.uncertain import UNCERTAIN, nominal_value
from bearingwear.solvers.bearing.films import COVERED, Films
from bearingwear.solvers.bearing.launch import Launched, launched, wear_at_launch
from bearingwear.solvers.bearing.mounted import RPM, UM
from bearingwear.solvers.compose import solver_of
from bearingwear.solvers.state import State

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
    torque: float  # of all bearings together; NaN where it was not computed [N m]
    margin: float
    stalls: bool
    why: str = ""  # it was not computed


class WearState(NamedTuple):
    """A state of wear of a case, or why it is not known."""

    words: str
    losses: Losses = ()
    is_bare: bool = False  # without film in any contact
    why: str = ""


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
    from bearingwear.scene.distributions import possible_range, quantile

    ends = quantile(given, own, possible_range(key), np.array(_ENDS))
    return key, sorted({*ends.tolist(), own})


def sentence_of(status: int) -> str:
    return code.STATUS_SENTENCES[code.STATUS_NAMES[status]]


def arrangement_torque(scene: Scene, losses: Losses, is_bare: bool = False) -> tuple[float, str]:
    """Torque on the shaft of all bearings of a scene at a loss of each [N m]; or NaN, and why.

    Friction and drag, by the power that they take over the speed.
    """
    solver = solver_of(scene)
    start, sides = solver.bearings.start, (losses * 2)[:2]
    films = (True, True) if is_bare else COVERED
    conditions = tuple(
        one._replace(loss=loss, bare=films) for one, loss in zip(start, sides, strict=False)
    )
    states = solver(conditions)
    failed = next((state.status for state in states if state.status != code.OK), None)
    if failed is not None:
        return math.nan, sentence_of(failed)
    power = [float(state["friction_power"]) for state in states]
    operation = scene.operation
    speed = abs(operation.shaft_speed_rpm - operation.outer_speed_rpm) * RPM
    tandem = scene.pair.tandem if scene.pair is not None else (1,)
    powers = power * 2 if len(power) < len(tandem) else power
    return sum(n * P for n, P in zip(tandem, powers, strict=True)) / speed, ""


def life_of(scene: Scene) -> Life | None:
    """The life of a scene by nominal friction; None without a criterion that ends it."""
    end = scene.wear.end_of_life
    if end is None or not end.criteria:
        return None
    return worn_life(scene) or HertzianLives(scene)(scene)


def life_in_case(scene: Scene, name: str) -> Life | None:
    """The life as bearings are in a case: over the duty if there is one, else in it alone."""
    if scene.duty is None or scene.wear.end_of_life is None:
        return life_of(scene.in_cases[name])
    return _life_over_duty(scene)[name]


@once
def _life_over_duty(scene: Scene) -> dict[str, Life]:
    return lives_by_case(scene)


def losses_of(states: Sequence[State]) -> Losses:
    return tuple(state.loss for state in states)


def least_film(scene: Scene, states: Sequence[State]) -> float:
    """Least film left in any contact of some bearings [m]; infinite where none can be gone.

    A contact is covered as long as the deepest place of its race, or the ball, has film.
    """
    least = math.inf
    for side, state in zip(scene.sides, states, strict=False):
        films = Films.of(side)
        if films.wear_through:
            left = np.where(films.thickness > 0.0, state["film_left"], -math.inf)
            least = min(least, float(np.maximum(left[:2], left[2]).min()))
    return least


def losses_without_film(losses: Sequence[Losses], films: Sequence[float]) -> Losses | None:
    """Losses at which the first contact loses its film along a life; None where none does.

    Between two states, by the film that is left.
    """
    gone = next((k for k, left in enumerate(films) if left <= 0.0), None)
    if not gone:
        return None if gone is None else losses[0]
    before, after = films[gone - 1 : gone + 1]
    share = before / (before - after)
    ends = zip(losses[gone - 1], losses[gone], strict=True)
    return tuple(low + share * (high - low) for low, high in ends)


def wear_of(scene: Scene, life: Life | None) -> list[WearState]:
    """States of wear of a case: new, worn at the end of its life, and when its film is gone.

    A film that outlasts the life is taken away at its end, and at the start of a scene without a
    criterion.
    """
    start = tuple(one.loss for one in solver_of(scene).bearings.start)
    has_film = any(Films.of(side).wear_through for side in scene.sides)
    found = [WearState(_NEW, start)]
    if life is None:
        return [*found, WearState(_BARE, start, True)] if has_film else found
    why = "" if life.status == code.OK else f"wear life: {sentence_of(life.status)}"
    solved = [node.states for node in life.nodes if node.status == code.OK]
    losses = [losses_of(states) for states in solved]
    end = () if why else losses[-1]
    found.append(WearState(_WORN, end, why=why))
    if has_film:
        gone = losses_without_film(losses, [least_film(scene, states) for states in solved])
        found.append(WearState(_BARE, gone or end, True, "" if gone else why))
    return found


def corners_of_case(scene: Scene, case: str, wear: Iterable[WearState]) -> list[Corner]:
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
        for state in wear:
            torque, why = math.nan, state.why
            if not why:
                torque, why = arrangement_torque(one, state.losses, state.is_bare)
            margin, stalls = drive.margin(torque), drive.stalls(torque)
            found.append(Corner(case, state.words, key, friction, torque, margin, stalls, why))
    return found


def torque_corners(scene: Scene) -> list[Corner]:
    """Every corner of the cases of a scene: new, worn at the end of the case's life, without film.

    Worn bearings have the contacts of the groove as new, at their loss.
    """
    return [
        corner
        for name, one in cases_of_use(scene).items()
        for corner in corners_of_case(one, name, wear_of(one, life_in_case(scene, name)))
    ]


def least_margin(scene: Scene, states: Sequence[State]) -> float:
    """The least torque margin along a life: new, at the end, and when the film is gone.

    NaN without a drive, and where a corner is not solved. The states are those of the worse
    bearing, which know the losses of both.
    """
    if scene.drive is None:
        return math.nan
    losses = [state.values.get("losses", (state.loss,)) for state in states]
    wear = [WearState(_NEW, losses[0]), WearState(_WORN, losses[-1])]
    if len(states) > 1 and any(Films.of(side).wear_through for side in scene.sides):
        gone = losses_without_film(losses, [least_film(scene, [state]) for state in states])
        wear.append(WearState(_BARE, gone or losses[-1], True))
    margins = [corner.margin for corner in corners_of_case(scene, "", wear)]
    return min(margins) if all(map(math.isfinite, margins)) else math.nan


def launched_by_wear(scene: Scene) -> dict[str, Launched]:
    """Launch loads and gaps by the state of wear, and by the case where there are several.

    Only those of new bearings where their wear is not known: without an end of life, or where the
    life was not computed.
    """
    found = {}
    cases = cases_of_use(scene)
    for case, one in cases.items():
        where = "" if case == NOMINAL and len(cases) == 1 else f" ({case})"
        found[f"{_NEW}{where}"] = launched(one)
        new = tuple(UM * float(np.max(side.wear.ball_diameter_loss_um)) for side in one.sides)
        try:
            life = life_in_case(scene, case)
        except NotAvailable:
            life = None
        end = None
        if life is not None and life.status == code.OK:
            end = losses_of(life.nodes[-1].states)
        if (losses := wear_at_launch(one, new, end)) is not None:
            limit = (one.launch or Launch()).after_wear_um
            worn = _WORN if limit is None else f"after {limit:g} um of wear"
            found[f"{worn}{where}"] = launched(one, losses)
    return found
