"""How long a cage lasts: ensembles along its wear, until a film is gone or a clearance too large.

Work per shaft turn in pockets and at the land, from ensembles, times K_s/H is what they lose; the
loss opens the clearances, and the next ensemble is made there (docs/theory/10-cage.md). What balls
lose in the pockets is left out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK
from bearingwear.lives.dynamic_life import steady_life
from bearingwear.lives.worn_parts import cage_surfaces
from bearingwear.results.quantiles import INTERVAL
from bearingwear.results.variable import HOURS_PER_SECOND, Variable, table
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.distributions import quantile
from bearingwear.scene.scene import COUNTS, Scene, SceneError
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.dynamic.windows import wear_per_joule
from bearingwear.solvers.effects.choice import NotAvailable
from bearingwear.studies.cage.draws import WEAR, cage_spread
from bearingwear.studies.cage.ensemble import END, OF_MOTION
from bearingwear.studies.dataset import filled

WEARING = ("pockets", "land")
ENDS_OF_CAGE = ("pocket_film", "land_film", "pocket_clearance", "guide_clearance", "none")
"""What may end the life of a cage; films first, in the order of `WEARING`."""

LIFE_STEPS = 4
"""Ensembles from new to the end, besides the first."""

_MOST_STEPS = 4 * LIFE_STEPS

PART = Variable("part", ("part",), "", "part of the cage", "i1", flags=WEARING)
NODE = Variable("node", ("node",), "1", "number of the ensemble", "i8")

CAGE_LIFE = table(
    Variable("cage_life", (), "1", "shaft turns to the end"),
    Variable("cage_life_interval", END.dims, "1", "90 % interval of the life by the runs"),
    Variable("cage_life_interval_with_wear", END.dims, "1",
        "90 % interval of the life with that of the cage's wear coefficient"),
    Variable("cage_hours", (), "h", "duration of the life", scale=HOURS_PER_SECOND),
    Variable("cage_end", (), "", "the part that ends the life", "i1", flags=ENDS_OF_CAGE),
    Variable("film_gone", PART.dims, "1", "shaft turns until a film is worn through"),
    Variable("motion_changes", END.dims, "1", "shaft turns of a change of the main motion"),
    Variable("node_turns", NODE.dims, "1", "shaft turns at an ensemble"),
    Variable("node_depth", (*NODE.dims, *PART.dims), "m", "depth worn off"),
    Variable("node_work", (*NODE.dims, *PART.dims), "J", "mean work in a shaft turn"),
    Variable("node_share", (*NODE.dims, *OF_MOTION.dims), "1", "share of each motion"),
    Variable("other_hours", (), "h", "life of balls and races, steady", scale=HOURS_PER_SECOND),
    Variable("other_end", (), "", "what ends that", "i1", flags=CRITERIA),
)  # fmt: skip


def revolutions(volume: float, wear_over_hardness: float, work: float) -> float:
    """Revolutions in which a volume [m3] wears away, by K_s/H [m2/N] and work a revolution [J]."""
    lost = wear_over_hardness * work
    return volume / lost if lost > 0.0 else math.inf


@dataclass(frozen=True)
class CagePart:
    """Pockets or land of a cage as they wear.

    Attributes
    ----------
    area : float
        Over which wear spreads [m2].
    film, below : float
        K_s/H of the film and of what lies below [m2/N].
    thickness : float
        Of the film, 0 without one [m].
    end : float
        Depth at which the life ends, infinite where it does not [m].
    """

    area: float
    film: float
    below: float
    thickness: float
    end: float

    def rate(self, depth: float, work: float) -> float:
        """Depth worn off in a turn, by the work in it [m]."""
        return (self.film if depth < self.thickness else self.below) * work / self.area

    def next_depth(self, depth: float) -> float:
        """Depth of what comes next: the end of the film, or of the life."""
        return self.thickness if depth < self.thickness else self.end


def parts_of(scene: Scene) -> tuple[CagePart, CagePart]:
    """Pockets and land of a scene's cage.

    Raises
    ------
    SceneError
        Nothing ends its life.
    """
    cage, end = scene.cage, scene.wear.end_of_life
    assert cage is not None
    below = film = wear_per_joule(scene, cage.material)
    if cage.film is not None:
        own = scene.materials[cage.material]
        K_s = cage.film.wear_coefficient or own.wear_coefficient
        film = K_s / ((cage.film.brinell_hardness_GPa or own.brinell_hardness_GPa) * parameters.GPA)
    thickness = 0.0 if cage.film is None else cage.film.thickness_um * parameters.UM
    wall, surface = cage_surfaces(scene)
    found = []
    for area, name in ((scene.bearing.ball_count * wall, "pocket"), (surface, "guide")):
        own_room, limit = (getattr(one, f"{name}_clearance_mm", None) for one in (cage, end))
        last = thickness or math.inf
        if limit is not None:
            last = 0.5 * (limit - own_room) * parameters.MM
            if last <= 0.0:
                problem = f"got {limit:g}, expected more than the cage has new, {own_room:g}"
                raise SceneError(f"wear.end_of_life.{name}_clearance_mm", problem)
        found.append(CagePart(cage.worn_share * area, film, below, thickness, last))
    if not any(math.isfinite(part.end) for part in found):
        problem = (
            "got neither a film nor a clearance limit, expected one that ends the life of the cage"
        )
        raise SceneError("cage.film", problem)
    return found[0], found[1]


class WornEnsemble(NamedTuple):
    """An ensemble along a life."""

    turns: float
    depth: np.ndarray  # (2,) [m]
    work: np.ndarray  # (2,) [J]
    error: np.ndarray  # (2,) half of its interval, over it
    share: np.ndarray


WornEnsembles = Callable[[int, np.ndarray], xr.Dataset]
"""The ensemble of a number along a life, with so much worn off pockets and land (2,) [m]."""


def node_of(found: xr.Dataset, turns: float, depth: np.ndarray) -> WornEnsemble:
    """Data of an ensemble for a life."""
    names = ("mean_pocket_work", "mean_land_work")
    work = np.array([float(found[name][0]) for name in names])
    ends = np.array([found[f"{name}_interval"].values[0] for name in names])
    half = 0.5 * (ends[:, 1] - ends[:, 0])
    error = np.divide(half, work, out=np.zeros(2), where=work > 0.0)
    return WornEnsemble(turns, depth, work, error, found["share"].values)


def followed(
    scene: Scene, found: WornEnsembles, tell: Callable[[str], None] | None = None
) -> list[WornEnsemble]:
    """Ensembles from a new cage to its end; the last one is there, if the end was reached.

    Depths step to what comes next for the part that is there first, or by a share of its way. The
    work over a step is the mean of both its ends (trapezoidal rule), the first guess that at its
    beginning.
    """
    parts = parts_of(scene)
    nodes = [node_of(found(0, np.zeros(2)), 0.0, np.zeros(2))]
    while len(nodes) <= _MOST_STEPS:
        last = nodes[-1]
        rates = _rates(parts, last.depth, last.work)
        first, goal = _next(parts, last.depth, rates)
        if not math.isfinite(goal) or not np.isfinite(last.work).all():
            break
        ahead = (goal - last.depth[first]) / rates[first]
        guess = last.depth + rates * ahead
        guess[first] = goal
        there = node_of(found(len(nodes), guess), 0.0, guess)
        if not np.isfinite(there.work).all():
            break
        mean = _rates(parts, last.depth, 0.5 * (last.work + there.work))
        turns = (goal - last.depth[first]) / mean[first]
        depth = last.depth + mean * turns
        depth[first] = goal
        nodes.append(there._replace(turns=last.turns + turns, depth=depth))
        if tell:
            tell(f"cage: {nodes[-1].turns:.3g} turns, {1e6 * depth[0]:.3g} and "
                 f"{1e6 * depth[1]:.3g} um of wear on pockets and land")  # fmt: skip
        if any(d >= part.end for d, part in zip(depth, parts, strict=True)):
            break
    return nodes


def _rates(parts: Sequence[CagePart], depth: np.ndarray, work: np.ndarray) -> np.ndarray:
    each = zip(parts, depth, work, strict=True)
    return np.array([part.rate(float(d), float(w)) for part, d, w in each])


def _next(parts: Sequence[CagePart], depth: np.ndarray, rates: np.ndarray) -> tuple[int, float]:
    """The part that decides a step, and the depth to which it goes."""
    goals = []
    for part, d, rate in zip(parts, depth, rates, strict=True):
        upto = part.next_depth(float(d))
        step = (part.end if math.isfinite(part.end) else upto) / LIFE_STEPS
        goal = min(upto, d + step) if math.isfinite(upto) and upto - d > 1e-3 * step else upto
        goals.append(((goal - d) / rate if rate > 0.0 else math.inf, float(goal)))
    times = [time for time, _ in goals]
    first = int(np.argmin(times))
    return first, goals[first][1] if math.isfinite(times[first]) else math.inf


def cage_life(scene: Scene, nodes: Sequence[WornEnsemble], other: bool = True) -> xr.Dataset:
    """Life of a cage by the ensembles along it, beside that of balls and races."""
    parts = parts_of(scene)
    turn = 60.0 / max(abs(scene.operation.shaft_speed_rpm), abs(scene.operation.outer_speed_rpm))
    depths = np.array([node.depth for node in nodes])
    turns = np.array([node.turns for node in nodes])
    over = [k for k, part in enumerate(parts) if depths[-1, k] >= part.end]
    reached = [float(np.interp(parts[k].end, depths[:, k], turns)) for k in over]
    ended = min(zip(reached, over, strict=True), default=None)
    end = len(ENDS_OF_CAGE) - 1
    values: dict[str, Any] = {}
    if ended is not None:
        life, part = ended
        end = part if parts[part].end == parts[part].thickness else len(WEARING) + part
        error = _error(nodes, part, life)
        both = np.array([1.0 - error, 1.0 + error])
        values = {
            "cage_life": life,
            "cage_life_interval": life * both,
            "cage_life_interval_with_wear": life * both / _wear_quantiles(scene)[::-1],
            "cage_hours": life * turn,
        }
    values |= {
        "cage_end": end,
        "film_gone": [
            float(np.interp(part.thickness, depths[:, k], turns, right=math.inf))
            if part.thickness
            else math.nan
            for k, part in enumerate(parts)
        ],
        "motion_changes": _change(nodes),
        "node_turns": turns,
        "node_depth": depths,
        "node_work": [node.work for node in nodes],
        "node_share": [node.share for node in nodes],
    }
    values |= _of_balls_and_races(scene) if other else {}
    axes = {END: None, PART: None, NODE: range(len(nodes)), OF_MOTION: None}
    return filled(CAGE_LIFE, axes, [values])


def _error(nodes: Sequence[WornEnsemble], part: int, life: float) -> float:
    """Half of the interval of a life over it; runs along it draw alike, so errors add."""
    if len(nodes) == 1 or life <= 0.0:
        return 0.0
    steps = np.diff([min(node.turns, life) for node in nodes])
    errors = np.array([node.error[part] for node in nodes])
    return float(np.sum(steps * 0.5 * (errors[1:] + errors[:-1])) / life)


def _wear_quantiles(scene: Scene) -> np.ndarray:
    """Ends of the interval of the cage's wear coefficient, over the scene's own."""
    spread, _ = cage_spread(scene)
    if WEAR not in spread:
        return np.ones(2)
    own = scene.materials[scene.cage.material].wear_coefficient if scene.cage else 1.0
    if scene.cage and scene.cage.film and scene.cage.film.wear_coefficient:
        own = scene.cage.film.wear_coefficient
    return quantile(spread[WEAR], own, (0.0, 1.0), np.array(INTERVAL)) / own


def _change(nodes: Sequence[WornEnsemble]) -> tuple[float, float]:
    """Between which turns another motion than that of the new cage begins to prevail."""
    motions = [int(np.argmax(node.share)) for node in nodes]
    for k, motion in enumerate(motions):
        if motion != motions[0]:
            return nodes[k - 1].turns, nodes[k].turns
    return math.nan, math.nan


def _of_balls_and_races(scene: Scene) -> dict[str, Any]:
    """Steady life of the rest of the bearing; nothing where it has none."""
    end = scene.wear.end_of_life
    if end is None or not end.without_cage.criteria:
        return {}
    try:
        life = steady_life(scene)
    except NotAvailable:
        return {}
    if life.status != OK:
        return {}
    hours = float(life.last.time[COUNTS.index(scene.wear.counts)])
    return {"other_hours": hours, "other_end": life.criterion}
