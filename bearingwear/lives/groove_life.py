"""Lives with worn grooves: when they are used, and their result variables."""

import math
from collections.abc import Sequence

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
DEEP = 1e-2  # of the deepest place, at the edge of what counts as the width of a groove


def wear_over_gap(scene: Scene) -> float:
    """Loss at the end of life over the gap A a^2 at the edge of the contact, before any solve.

    Static, at the free contact angle; the loss is the limit of the scene, or what takes so much of
    the preload at fixed position. Infinite where the scene says nothing of the loss.
    """
    g, end, operation = parameters.geometry(scene), scene.wear.end_of_life, scene.operation
    sine = math.sin(g.alpha0)
    if end is None or not (sine > 0.0 and operation.preload_N > 0.0):
        return math.inf
    Q, gaps, approaches = operation.preload_N / (g.n_balls * sine), [], []
    for side in (INNER, OUTER):
        hertz = race_contact(g, side, g.D0, math.cos(g.alpha0), math.nan)
        approaches.append(contact_approach(hertz.K, Q))
        gaps.append(elliptic_integrals(math.exp(-hertz.log_kappa))[2] * approaches[-1])
    losses = [math.inf]
    if end.ball_diameter_loss_um is not None:
        present = float(np.mean(scene.wear.ball_diameter_loss_um))
        losses.append((end.ball_diameter_loss_um - present) * parameters.UM)
    if end.preload_fraction is not None and operation.preload_method != "constant_force":
        losses.append((1.0 - end.preload_fraction ** (2.0 / 3.0)) * sum(approaches))
    return min(losses) / min(gaps)


def grooves_followed(scene: Scene, fidelity: str) -> tuple[Scene | None, str]:
    """The scene whose grooves a life follows, one of two identical ones; None without; and why.

    Refuses what is impossible.
    """
    scene = scene.one_of_alike
    obstacles = {
        f"model.fidelity {fidelity}": fidelity != "steady",
        "wear.counts ball": scene.wear.counts != "ball_and_races",
        "model.slip_over line": scene.model.slip_is_over == "line",
    }
    found = [name for name, stands in obstacles.items() if stands]
    if scene.model.contact == "worn":
        if found:
            raise NotAvailable(
                f"{scene.name}: model.contact: got worn with {found[0]}, expected the steady "
                f"model with wear.counts ball_and_races and slip evaluated over the ellipse"
            )
        return scene, "grooves: worn profile, as requested by model.contact"
    if scene.model.contact != "auto" or found:
        return None, ""
    end = scene.wear.end_of_life
    if end is not None and end.groove_depth_um is not None:
        return scene, "grooves: worn profile, because groove depth is an end-of-life criterion"
    share = max(wear_over_gap(one) for one in scene.sides)
    size = f"the wear at the end of life is about {share:.2g} times the gap at the contact edge"
    if math.isinf(share):
        size = "the wear at the end of life is not known in advance"
    if share > REQUIRED:
        return scene, f"grooves: worn profile; {size}"
    return None, f"grooves: Hertzian contact; {size}"


def met_when_new(scene: Scene) -> Life | None:
    """The life of a scene that meets a criterion before any wear; None of any other one.

    It is zero, whether or not the grooves can be followed.
    """
    states = solver_of(scene)
    found = states(states.bearings.start)
    if any(one.status != code.OK for one in found) or Criteria(scene).margins(found).min() > 0.0:
        return None
    return surface_life(scene, states)


def groove_life(scene: Scene) -> tuple[dict, dict]:
    """Values and attributes of a life with worn grooves, of one bearing or of two."""
    life = follow_grooves(StiffGrooves(scene))
    if life.nodes[0].status != code.OK and (ended := met_when_new(scene)):
        return life_values(scene, ended), {"solves": life.solves + ended.solves, "contact": "hertz"}
    values = life_values(scene, life)
    if life.status == code.OK:
        values |= groove_errors(scene, life.last.time, life.criterion)
    if life.nodes[0].status == code.OK:
        each = zip(life.wearing.sides, life.bearings, strict=True)
        values |= joined([groove_values(side, states) for side, states in each])
    return values, {"solves": life.solves, "contact": "worn"}


def groove_values(side: Worn, states: Sequence[State]) -> dict:
    """Wear, and the profiles of a few states."""
    points, bearing = [point_of(state) for state in states], side.bearing
    D = np.array([bearing.D - p.wear.ball for p in points])  # as new, less what is worn
    depth = np.array([p.wear.grooves for p in points])  # (steps, race, arcs)
    track = np.array([p.track for p in points])
    area = depth.sum(axis=2) * bearing.arc_step
    volume = np.zeros_like(area)
    volume[1:] = np.cumsum(np.diff(area, axis=0) * np.pi * (track[1:] + track[:-1]), axis=0)
    deepest = depth.max(axis=2)
    wide = depth > DEEP * np.maximum(deepest, 1e-300)[:, :, None]
    ball = np.pi / 6.0 * (bearing.D**3 - D**3)
    kept = np.unique(np.linspace(0, len(points) - 1, SHOWN).round().astype(int))
    return {
        "history_approach_loss": np.array([side.approach_loss(p) for p in points]),
        "history_equivalent_loss": np.array([state.loss for state in states]),
        "history_deepest_groove": deepest,
        "history_groove_width": wide.sum(axis=2) * bearing.arc_step,
        "history_contact_half_length": np.array([half_lengths(p) for p in points]),
        "history_race_worn_volume": volume,
        "history_one_ball_worn_volume": ball,
        "groove_step": kept,
        "groove_arc": bearing.arc,
        "groove_depth": depth[kept],
        "groove_pressure": np.array([pressures(bearing, points[k]) for k in kept]),
    }


def half_lengths(point: WornPoint) -> np.ndarray:
    """Half of the length of both contacts (2,) [m]."""
    lengths = []
    for x, pressure in zip(point.x, point.pressure, strict=True):
        first, last = x[loaded_ends(pressure)]
        lengths.append(0.5 * (last - first + x[1] - x[0]))
    return np.array(lengths)


def pressures(bearing: WornBearing, point: WornPoint) -> np.ndarray:
    """Pressure in the middle of both contacts along the arcs (2, arcs) [Pa]."""
    g, rows = point.problem.g, []
    for k, force in enumerate(point.forces):
        places = point.x[k] + bearing.shift(k, force.alpha, g)
        middle = point.pressure[k][0] * force.peak / point.pressure[k].max()
        rows.append(np.interp(bearing.arc[k], places, middle, left=0.0, right=0.0))
    return np.array(rows)
