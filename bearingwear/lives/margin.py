"""Torque margin and launch loads of new and worn bearings, in each case of a scene.

A corner of the torque is a case, a state of wear and a friction. Theory: docs/theory.md, sections
25 and 26.
"""

import math
from collections.abc import Sequence
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
from bearingwear.scene.scene import Distribution, Scene, cached_in_scene
from bearingwear.scene.uncertain import UNCERTAIN, nominal_value
from bearingwear.solvers.bearing.films import COVERED, Films
from bearingwear.solvers.bearing.launch import LaunchResult, launch_result, wear_at_launch
from bearingwear.solvers.bearing.mounted import RPM, UM
from bearingwear.solvers.compose import solver_of
from bearingwear.solvers.state import State

Losses = tuple[float, ...]
"""Loss of ball diameter of each bearing [m]."""

_NEW, _WORN, _BARE = "new", "worn", "film worn off"
_PROBABILITIES = 0.05, 0.95  # at the ends of the interval of friction


@dataclass(frozen=True)
class Corner:
    """The torque of a scene and its margin in one case, one state of wear, with one friction."""

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
    why: str = ""  # the losses are not known


def friction_interval(scene: Scene) -> tuple[str, list[float]]:
    """Returns the key of the friction, and its 5 %, nominal and 95 % values.

    The scene's `uncertainty` gives them, else the spread of the table of coefficients. Without a
    spread there is the nominal value alone.
    """
    name = "shear_strength_MPa" if scene.friction.film is not None else "ball_race"
    key = f"{UNCERTAIN[name]}.{name}"
    nominal = nominal_value(scene, name)
    distribution = (scene.uncertainty or {}).get(name)
    if scene.uncertainty is None:
        spread, _ = usual_spread(scene.to_dict())
        if name in spread:
            distribution = Distribution(**spread[name])
    if distribution is None:
        return key, [nominal]
    # SciPy's distributions load slowly, and few scenes have a drive
    from bearingwear.scene.distributions import possible_range, quantile

    ends = quantile(distribution, nominal, possible_range(key), np.array(_PROBABILITIES))
    return key, sorted({*ends.tolist(), nominal})


def sentence_of(status: int) -> str:
    """Returns the sentence of a status, by its number."""
    return code.STATUS_SENTENCES[code.STATUS_NAMES[status]]


def arrangement_torque(scene: Scene, losses: Losses, is_bare: bool = False) -> tuple[float, str]:
    """Returns the torque of all bearings of a scene on the shaft [N m]; or NaN, and why.

    It is the power of friction and drag over the speed.

    losses: of each bearing; one loss stands for both of a pair.
    is_bare: whether no contact has a film.
    """
    solver = solver_of(scene)
    side_losses = (losses * 2)[:2]
    bare = (True, True) if is_bare else COVERED
    pairs = zip(solver.bearings.start, side_losses, strict=False)
    states = solver(tuple(condition._replace(loss=loss, bare=bare) for condition, loss in pairs))
    failed = next((state.status for state in states if state.status != code.OK), None)
    if failed is not None:
        return math.nan, sentence_of(failed)
    powers = [float(state["friction_power"]) for state in states]
    operation = scene.operation
    speed = abs(operation.shaft_speed_rpm - operation.outer_speed_rpm) * RPM
    tandem = scene.pair.tandem if scene.pair is not None else (1,)
    side_powers = powers * 2 if len(powers) < len(tandem) else powers
    return sum(n * power for n, power in zip(tandem, side_powers, strict=True)) / speed, ""


def life_of(scene: Scene) -> Life | None:
    """Returns the quick life of a scene by nominal friction; None without a criterion."""
    end = scene.wear.end_of_life
    if end is None or not end.criteria:
        return None
    return worn_life(scene) or HertzianLives(scene)(scene)


def life_in_case(scene: Scene, name: str) -> Life | None:
    """Returns the life as bearings are in a case: over the duty if any, else in the case alone."""
    if scene.duty is None or scene.wear.end_of_life is None:
        return life_of(scene.in_cases[name])
    return _duty_lives(scene)[name]


@cached_in_scene
def _duty_lives(scene: Scene) -> dict[str, Life]:
    """Returns the lives along which the requirements of a scene hold, by case, computed once."""
    return lives_by_case(scene)


def losses_of(states: Sequence[State]) -> Losses:
    """Returns the loss of ball diameter of each bearing [m]."""
    return tuple(state.loss for state in states)


def least_film(scene: Scene, states: Sequence[State]) -> float:
    """Returns the least film left in any contact of some bearings [m].

    A contact is covered as long as the deepest place of its race, or the ball, has film. The film
    is infinite where none can wear through.
    """
    least = math.inf
    for side, state in zip(scene.sides, states, strict=False):
        films = Films.of(side)
        if films.wear_through:
            film = np.where(films.thickness > 0.0, state["film_left"], -math.inf)
            races, ball = film[:2], film[2]
            least = min(least, float(np.maximum(races, ball).min()))
    return least


def losses_without_film(losses: Sequence[Losses], films: Sequence[float]) -> Losses | None:
    """Returns the losses at which the first contact loses its film along a life.

    They lie between two states, by the film that is left in these. None if no contact loses it.

    losses: of the bearings in each state [m].
    films: least film left in each state [m].
    """
    bare = next((k for k, left in enumerate(films) if left <= 0.0), None)
    if bare is None:
        return None
    if bare == 0:
        return losses[0]
    before, after = films[bare - 1 : bare + 1]
    share = before / (before - after)
    return tuple(
        low + share * (high - low) for low, high in zip(losses[bare - 1], losses[bare], strict=True)
    )


def wear_states(scene: Scene, life: Life | None) -> list[WearState]:
    """Returns the wear of a case when new, at the end of its life, and when its film is gone.

    A film that outlasts the life is taken away at its end, and at the start of a scene without a
    criterion.
    """
    start = tuple(condition.loss for condition in solver_of(scene).bearings.start)
    has_film = any(Films.of(side).wear_through for side in scene.sides)
    wear = [WearState(_NEW, start)]
    if life is None:
        return [*wear, WearState(_BARE, start, is_bare=True)] if has_film else wear
    why = "" if life.status == code.OK else f"wear life: {sentence_of(life.status)}"
    solved = [node.states for node in life.nodes if node.status == code.OK]
    losses = [losses_of(states) for states in solved]
    end = () if why else losses[-1]
    wear.append(WearState(_WORN, end, why=why))
    if has_film:
        films = [least_film(scene, states) for states in solved]
        bare = losses_without_film(losses, films)
        if bare is not None:
            wear.append(WearState(_BARE, bare, is_bare=True))
        else:
            wear.append(WearState(_BARE, end, is_bare=True, why=why))
    return wear


def corners_of_case(scene: Scene, case: str, wear: Sequence[WearState]) -> list[Corner]:
    """Returns the corners of one case of a scene with a drive, in some states of wear.

    Raises NotAvailable if its races turn at one speed.

    case: name of the case.
    """
    drive = scene.drive
    assert drive is not None
    if scene.operation.shaft_speed_rpm == scene.operation.outer_speed_rpm:
        problem = (
            "got equal speeds for both races, at which no torque is required, expected different "
            "speeds"
        )
        raise NotAvailable(f"{scene.name}: operation.shaft_speed_rpm: {problem}")
    key, frictions = friction_interval(scene)
    corners = []
    for friction in frictions:
        with_friction = scene.with_({key: friction})
        for state in wear:
            torque, why = math.nan, state.why
            if not why:
                torque, why = arrangement_torque(with_friction, state.losses, state.is_bare)
            corners.append(
                Corner(
                    case=case,
                    wear=state.words,
                    key=key,
                    friction=friction,
                    torque=torque,
                    margin=drive.margin(torque),
                    stalls=drive.stalls(torque),
                    why=why,
                )
            )
    return corners


def torque_corners(scene: Scene) -> list[Corner]:
    """Returns the corners of all cases of a scene: new, at the end of a case's life, without film.

    Worn bearings have the contacts of the groove as new, at their loss.
    """
    corners = []
    for name, case in cases_of_use(scene).items():
        wear = wear_states(case, life_in_case(scene, name))
        corners += corners_of_case(case, name, wear)
    return corners


def least_margin(scene: Scene, states: Sequence[State]) -> float:
    """Returns the least torque margin along a life: new, at the end, and when the film is gone.

    It is NaN without a drive, and where a corner is not solved.

    states: those of the worse bearing, which know the losses of both.
    """
    if scene.drive is None:
        return math.nan
    losses = [state.values.get("losses", (state.loss,)) for state in states]
    wear = [WearState(_NEW, losses[0]), WearState(_WORN, losses[-1])]
    if len(states) > 1 and any(Films.of(side).wear_through for side in scene.sides):
        bare = losses_without_film(losses, [least_film(scene, [state]) for state in states])
        wear.append(WearState(_BARE, bare or losses[-1], is_bare=True))
    margins = [corner.margin for corner in corners_of_case(scene, "", wear)]
    return min(margins) if all(map(math.isfinite, margins)) else math.nan


def launched_by_wear(scene: Scene) -> dict[str, LaunchResult]:
    """Returns the results of a launch by the state of wear, and the case if there are several.

    They are those of new bearings alone where their wear is not known: without an end of life, or
    where the life was not computed.
    """
    by_wear = {}
    cases = cases_of_use(scene)
    for name, case in cases.items():
        suffix = "" if name == NOMINAL and len(cases) == 1 else f" ({name})"
        by_wear[f"{_NEW}{suffix}"] = launch_result(case)
        new = tuple(UM * float(np.max(side.wear.ball_diameter_loss_um)) for side in case.sides)
        try:
            life = life_in_case(scene, name)
        except NotAvailable:
            life = None
        end = None
        if life is not None and life.status == code.OK:
            end = losses_of(life.last.states)
        losses = wear_at_launch(case, new, end)
        if losses is not None:
            limit = (case.launch or Launch()).after_wear_um
            worn = _WORN if limit is None else f"after {limit:g} um of wear"
            by_wear[f"{worn}{suffix}"] = launch_result(case, losses)
    return by_wear
