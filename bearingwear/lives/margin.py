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
    margin: float  # as by `Drive.margin`; NaN without a torque
    stalls: bool
    why: str = ""  # reason for which the torque was not computed


class WearState(NamedTuple):
    """A state of wear of a case, or why it is not known."""

    words: str  # its name on sheets
    losses: Losses = ()
    is_bare: bool = False  # whether no contact has a film
    why: str = ""  # reason for which the losses are not known


def friction_interval(scene: Scene) -> tuple[str, list[float]]:
    """Returns the key of the friction, and its 5 %, nominal and 95 % values in rising order.

    The key is dotted, and its values are in its unit: the shear strength of a film in MPa, else a
    coefficient. The scene's `uncertainty` gives the distribution, else the spread of the table of
    coefficients. Without either there is the nominal value alone.
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

    It is the power of friction and drag of all bearings, over the relative speed of the races. The
    speeds must differ. The text is the sentence of the status where a bearing is not solved, else
    empty.

    losses: of each bearing [m]; one loss stands for both of a pair.
    is_bare: whether no contact has a film.
    """
    solver = solver_of(scene)
    side_losses = losses * 2 if len(losses) == 1 else losses
    bare = (True, True) if is_bare else COVERED
    # one condition stands for a single bearing, and for both of a symmetric pair
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
    """Returns the life of a scene without its duty, by nominal friction; None without a criterion.

    A life with worn grooves is quick: see `worn_life`.
    """
    end = scene.wear.end_of_life
    if end is None or not end.criteria:
        return None
    return worn_life(scene) or HertzianLives(scene)(scene)


def life_in_case(scene: Scene, name: str) -> Life | None:
    """Returns the life with the states of a case: over the duty if any, else in the case alone.

    None without a criterion.

    name: of the case.
    """
    if scene.duty is None or scene.wear.end_of_life is None:
        return life_of(scene.in_cases[name])
    return _duty_lives(scene)[name]


@cached_in_scene
def _duty_lives(scene: Scene) -> dict[str, Life]:
    """Returns the lives over the duty of a scene by the names of its cases, computed once.

    They are those of `lives_by_case`, kept with the scene.
    """
    return lives_by_case(scene)


def losses_of(states: Sequence[State]) -> Losses:
    """Returns the loss of ball diameter of each bearing [m]."""
    return tuple(state.loss for state in states)


def least_film(scene: Scene, states: Sequence[State]) -> float:
    """Returns the least thickness of film that is left in any contact of some bearings [m].

    A contact has the thicker film of its race, at the deepest place, and of the ball. So it is bare
    only where both are gone: the value is zero then, or negative by what has worn beyond the film
    of worn grooves. It is infinite where no film can wear through.

    states: of the bearings; fewer than the sides where one stands for both, of a symmetric pair or
        as the worse one.
    """
    least = math.inf
    for side, state in zip(scene.sides, states, strict=False):
        films = Films.of(side)
        if films.wear_through:
            film = np.where(films.thickness > 0.0, state["film_left"], -math.inf)
            races, ball = film[:2], film[2]  # its order: inner race, outer race, balls
            least = min(least, float(np.maximum(races, ball).min()))
    return least


def losses_without_film(losses: Sequence[Losses], films: Sequence[float]) -> Losses | None:
    """Returns the losses of the bearings at which a contact first has no film along a life [m].

    They are linear between the last state with a film in every contact and the next one, and lie
    where the least film is zero. None if it stays above zero in all states.

    losses: of the bearings in each state [m].
    films: least film left in each state, from `least_film` [m].
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

    A film that outlasts the life is taken away at the end of the life. Without a criterion there is
    no end, and the film is taken away when new. Without a film there is no such state.

    life: of the case; None without a criterion. One without an end has states that say why their
        losses are not known.
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
    """Returns the corners of one case: each friction of the interval in each state of wear.

    Raises NotAvailable if both races turn at the same speed.

    scene: of the case, with a drive.
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

    Torques of worn bearings are those of unworn grooves at the loss of the worn ones. Raises
    NotAvailable as `corners_of_case`.
    """
    corners = []
    for name, case in cases_of_use(scene).items():
        wear = wear_states(case, life_in_case(scene, name))
        corners += corners_of_case(case, name, wear)
    return corners


def least_margin(scene: Scene, states: Sequence[State]) -> float:
    """Returns the least torque margin along a life: new, at the end, and when the film is gone.

    It is NaN without a drive, and where a corner is not solved. A film that outlasts the life is
    taken away at its end.

    states: of a life, from `worse_states`; those of a pair have the `losses` of both bearings.
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
    """Returns the results of a launch by a name that states the wear, and the case if several.

    A case has the result of new bearings, at their present loss, and that of worn ones. Worn ones
    have the loss at the end of life, or less if `launch.after_wear_um` limits it. They are left out
    where neither is known: without an end of life, or where the life was not computed.
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
