"""Lives with worn grooves: when they are used, and their result variables."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.contact.hertz import INNER, OUTER, elliptic_integrals, race_contact
from bearingwear.kernels.contact.profile import contact_approach
from bearingwear.lives.ends import Criteria
from bearingwear.lives.errors import groove_errors
from bearingwear.lives.follow import Life
from bearingwear.lives.grooves import StiffGrooves, follow_grooves, point_of
from bearingwear.lives.history import joined, life_values
from bearingwear.lives.surfaces import surface_life
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.compose import solver_of
from bearingwear.solvers.effects.table import FLAT_GROOVE
from bearingwear.solvers.state import State
from bearingwear.solvers.worn.bearing import WornBearing, loaded_ends
from bearingwear.solvers.worn.depths import WornPoint
from bearingwear.solvers.worn.solver import Worn

REQUIRED = FLAT_GROOVE  # above which the grooves have to be followed
SHOWN = 5  # states whose profiles are kept
EDGE_DEPTH = 1e-2  # of a groove at the edges of its width, over the depth of its deepest place
TINY_DEPTH = 1e-300  # [m], so that an unworn groove has no width


def wear_over_gap(scene: Scene) -> float:
    """Returns the loss at the end of life over the gap A a^2 at the edge of the contact [1].

    The gap is the smaller one of both races. It is estimated without a solve, from a static contact
    at the free contact angle. The loss is the smaller of two: the limit of the loss, and the loss
    at which a fixed position has only `preload_fraction` of its preload left. The ratio is infinite
    where the scene limits neither, and without preload or contact angle.
    """
    g = parameters.geometry(scene)
    end = scene.wear.end_of_life
    operation = scene.operation
    sine = math.sin(g.alpha0)
    if end is None or not (sine > 0.0 and operation.preload_N > 0.0):
        return math.inf
    Q = operation.preload_N / (g.n_balls * sine)
    approaches, gaps = [], []
    for race in (INNER, OUTER):
        hertz = race_contact(g, race, g.D0, math.cos(g.alpha0), math.nan)
        approaches.append(contact_approach(hertz.K, Q))
        # the third integral is A a^2 over the approach
        gaps.append(elliptic_integrals(math.exp(-hertz.log_kappa))[2] * approaches[-1])
    losses = [math.inf]
    if end.ball_diameter_loss_um is not None:
        present = float(np.mean(scene.wear.ball_diameter_loss_um))
        losses.append((end.ball_diameter_loss_um - present) * parameters.UM)
    if end.preload_fraction is not None and operation.preload_method != "constant_force":
        losses.append((1.0 - end.preload_fraction ** (2.0 / 3.0)) * sum(approaches))
    return min(losses) / min(gaps)


class GrooveChoice(NamedTuple):
    """Whether a life follows the grooves as they wear, and why."""

    # whose grooves are followed, with one of two identical sides; None: contacts stay Hertzian
    scene: Scene | None
    sentence: str = ""  # for the result; empty where there is no choice

    @property
    def follows(self) -> bool:
        """Returns whether the grooves are followed."""
        return self.scene is not None


def groove_choice(scene: Scene, fidelity: str) -> GrooveChoice:
    """Returns whether a life of a scene follows the grooves, and why.

    The sentence is empty where the scene asks for Hertzian contacts, or where its model cannot
    follow grooves. Raises NotAvailable where the scene requests worn grooves that its model cannot
    follow.

    fidelity: model that solves the scene.
    """
    scene = scene.symmetric_half
    obstacle = None
    if fidelity != "steady":
        obstacle = f"model.fidelity {fidelity}"
    elif scene.wear.counts != "ball_and_races":
        obstacle = "wear.counts ball"
    elif scene.model.slip_region == "line":
        obstacle = "model.slip_over line"
    if scene.model.contact == "worn":
        if obstacle:
            raise NotAvailable(
                f"{scene.name}: model.contact: got worn with {obstacle}, expected the steady "
                f"model with wear.counts ball_and_races and slip evaluated over the ellipse"
            )
        return GrooveChoice(scene, "grooves: worn profile, as requested by model.contact")
    if scene.model.contact != "auto" or obstacle:
        return GrooveChoice(None)
    end = scene.wear.end_of_life
    if end is not None and end.groove_depth_um is not None:
        reason = "because groove depth is an end-of-life criterion"
        return GrooveChoice(scene, f"grooves: worn profile, {reason}")
    ratio = max(wear_over_gap(side) for side in scene.sides)
    size = f"the wear at the end of life is about {ratio:.2g} times the gap at the contact edge"
    if math.isinf(ratio):
        size = "the wear at the end of life is not known in advance"
    if ratio > REQUIRED:
        return GrooveChoice(scene, f"grooves: worn profile; {size}")
    return GrooveChoice(None, f"grooves: Hertzian contact; {size}")


def life_if_ended_when_new(scene: Scene) -> Life | None:
    """Returns the life of zero length of a scene that meets a criterion before any wear.

    None for a scene that meets no criterion when new, or that is not solved.
    """
    solver = solver_of(scene)
    states = solver(solver.bearings.start)
    is_solved = all(state.status == code.OK for state in states)
    if not is_solved or Criteria(scene).margins(states).min() > 0.0:
        return None
    return surface_life(scene, solver)


def groove_life(scene: Scene) -> tuple[dict, dict]:
    """Returns values and attributes of a life with worn grooves, of one bearing or of two.

    Values are result variables [SI]. They are the status and the criterion alone if the start is
    not solved. Grooves that are not solved when new are not needed if the scene meets a criterion
    then: it has the life of zero length with Hertzian contacts, and the attribute `contact` hertz.
    """
    life = follow_grooves(StiffGrooves(scene))
    if life.nodes[0].status != code.OK:
        ended = life_if_ended_when_new(scene)
        if ended is not None:
            attrs = {"solves": life.solves + ended.solves, "contact": "hertz"}
            return life_values(scene, ended), attrs
    values = life_values(scene, life)
    if life.status == code.OK:
        values |= groove_errors(scene, life.last.time, life.criterion)
    if life.nodes[0].status == code.OK:
        values |= life_groove_values(life)
    return values, {"solves": life.solves, "contact": "worn"}


def life_groove_values(life: Life) -> dict:
    """Returns the result variables of the grooves along a life, of one bearing or of two.

    Those of two stand along a further first dimension, except shared ones: see `joined`.
    """
    pairs = zip(life.wearing.sides, life.bearings, strict=True)
    return joined([groove_values(side, states) for side, states in pairs])


def groove_values(side: Worn, states: Sequence[State]) -> dict:
    """Returns result variables of the wear of one bearing along a life [SI].

    Histories have the states as their first dimension, then inner and outer race if they belong to
    the races. The profiles of grooves and pressure are those of up to `SHOWN` states.

    side: solver of the bearing.
    """
    points = [point_of(state) for state in states]
    bearing = side.bearing
    D = np.array([bearing.D - point.wear.ball for point in points])  # worn diameter
    depth = np.array([point.wear.grooves for point in points])  # (steps, race, arcs)
    track = np.array([point.track for point in points])
    area = depth.sum(axis=2) * bearing.arc_step
    race_volume = np.zeros_like(area)
    race_volume[1:] = np.cumsum(np.diff(area, axis=0) * np.pi * (track[1:] + track[:-1]), axis=0)
    deepest = depth.max(axis=2)
    is_groove = depth > EDGE_DEPTH * np.maximum(deepest, TINY_DEPTH)[:, :, None]
    shown_steps = np.unique(np.linspace(0, len(points) - 1, SHOWN).round().astype(int))
    return {
        "history_approach_loss": np.array([side.approach_loss(point) for point in points]),
        "history_equivalent_loss": np.array([state.loss for state in states]),
        "history_deepest_groove": deepest,
        "history_groove_width": is_groove.sum(axis=2) * bearing.arc_step,
        "history_contact_half_length": np.array([half_lengths(point) for point in points]),
        "history_race_worn_volume": race_volume,
        "history_one_ball_worn_volume": np.pi / 6.0 * (bearing.D**3 - D**3),
        "groove_step": shown_steps,
        "groove_arc": bearing.arc,
        "groove_depth": depth[shown_steps],
        "groove_pressure": np.array([pressures(bearing, points[k]) for k in shown_steps]),
    }


def half_lengths(point: WornPoint) -> np.ndarray:
    """Returns half of the length of both contacts along the major axis (2,) [m].

    The length is that of the cells with a pressure, both end cells included in full.
    """
    lengths = []
    for x, pressure in zip(point.x, point.pressure, strict=True):
        first, last = x[loaded_ends(pressure)]
        lengths.append(0.5 * (last - first + x[1] - x[0]))
    return np.array(lengths)


def pressures(bearing: WornBearing, point: WornPoint) -> np.ndarray:
    """Returns the pressure on the major axis of both contacts, along the arcs (2, arcs) [Pa].

    It is 0 on arcs outside the contact.
    """
    arc_pressures = []
    for k, force in enumerate(point.forces):
        places = point.x[k] + bearing.shift(k, force.alpha, point.problem.g)
        # row 0 of the cells lies on the major axis
        axis_pressure = point.pressure[k][0] * force.peak / point.pressure[k].max()
        arc_pressures.append(np.interp(bearing.arc[k], places, axis_pressure, left=0.0, right=0.0))
    return np.array(arc_pressures)
