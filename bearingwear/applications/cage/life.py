"""How long a cage lasts: ensembles along its wear, until a film is gone or a clearance too large.

Work per shaft turn in pockets and at the land, from ensembles, times K_s/H is what they lose; the
loss opens the clearances, and the next ensemble is made there (docs/theory/10-cage.md). What balls
lose in the pockets is left out.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.applications.cage.draws import WEAR, cage_spread
from bearingwear.applications.cage.ensemble import END, OF_MOTION, ensemble_of, kept_in
from bearingwear.applications.cage.plan import Ensemble
from bearingwear.kernels.status import OK
from bearingwear.lives.dynamic_life import steady_life
from bearingwear.lives.ends import Criteria, with_end
from bearingwear.lives.follow import Life, Node, States, follow
from bearingwear.lives.methods import Trapezoid
from bearingwear.lives.motion import Motion
from bearingwear.lives.worn_parts import CAGE_PARTS
from bearingwear.measures import ENDS
from bearingwear.results.quantiles import INTERVAL
from bearingwear.results.variable import HOURS_PER_SECOND, Variable, table
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.scene.coefficients import with_usual_spread
from bearingwear.scene.distributions import quantile, values_at
from bearingwear.scene.scene import WORN, EndOfLife, Scene, SceneError
from bearingwear.solvers.bearing.mounted import UM
from bearingwear.solvers.dynamic.windows import wear_per_joule
from bearingwear.solvers.state import State
from bearingwear.studies.answers import Tell
from bearingwear.studies.dataset import dataset_of_rows, write_dataset
from bearingwear.studies.sampling import wear_factor

WEARING = ("pockets", "land")
LIFE_STEPS = 4
"""Ensembles from new to the end, or from one film to the next, besides the first."""

_MOST_STEPS = 4 * LIFE_STEPS
_BEYOND = 1.02  # of a step, so that the last one reaches the end
_ENDS_WITHIN = 1e-3  # of the depth at which the life ends
_SAMPLES = 4096

PART = Variable("part", ("part",), "", "part of the cage", "i1", flags=WEARING)
NODE = Variable("node", ("node",), "1", "index of the ensemble", "i8")

CAGE_LIFE = table(
    Variable("cage_life", (), "1", "number of shaft turns to the end of the cage's life"),
    Variable("cage_life_interval", END.dims, "1",
        "90 % interval of cage_life, allowing only for the scatter between runs"),
    Variable("cage_life_interval_with_wear", END.dims, "1",
        "90 % interval of cage_life, allowing also for the uncertain wear coefficient of the cage"),
    Variable("cage_hours", (), "h", "time to the end of the cage's life", scale=HOURS_PER_SECOND),
    Variable("cage_end", (), "", "criterion that determines the end of the cage's life", "i1",
        flags=CRITERIA),
    Variable("film_gone", PART.dims, "1", "number of shaft turns until the film is worn through"),
    Variable("motion_changes", END.dims, "1", "number of shaft turns until the dominant motion "
        "changes"),
    Variable("node_turns", NODE.dims, "1", "number of shaft turns completed before each ensemble"),
    Variable("node_depth", (*NODE.dims, *PART.dims), "m", "wear depth"),
    Variable("node_work", (*NODE.dims, *PART.dims), "J", "mean work per shaft turn"),
    Variable("node_share", (*NODE.dims, *OF_MOTION.dims), "1",
        "share of runs that end in each motion"),
    Variable("other_hours", (), "h", "computed life of the balls and races, steady model",
        scale=HOURS_PER_SECOND),
    Variable("other_hours_interval", END.dims, "h",
        "90 % interval of other_hours, allowing for the uncertain wear coefficient and hardness",
        scale=HOURS_PER_SECOND),
    Variable("other_end", (), "", "criterion that determines the end of life of the balls and "
        "races",
        "i1", flags=CRITERIA),
)  # fmt: skip


WornEnsembles = Callable[[int, np.ndarray], xr.Dataset]
"""The ensemble of a number along a life, with so much worn off pockets and land (2,) [m]."""


def with_cage_end(scene: Scene) -> Scene:
    """The scene with an end for its cage: a film that is worn through, if it has no other.

    SceneError: nothing ends the life of the cage, or it has ended.
    """
    cage, end = scene.cage, scene.wear.end_of_life or EndOfLife()
    assert cage is not None
    if end == end.without_cage:
        if cage.film is None:
            problem = (
                "got neither a film nor a limit, expected one of them to define the end of life"
            )
            raise SceneError("cage.film", problem)
        end = replace(end, **{"cage_film_worn_share": 1.0})
    for name in ("pocket_clearance_mm", "guide_clearance_mm"):
        limit, own = getattr(end, name), getattr(cage, name)
        if limit is not None and limit <= own:
            problem = f"got {limit:g}, expected a number > {own:g}, the initial value"
            raise SceneError(f"wear.end_of_life.{name}", problem)
    return with_end(scene, end)


class EnsembleWear(Motion):
    """The wear of a cage by ensembles; balls and races do not wear.

    A state has the mean work in pockets and at the land (2,) [J], half of its interval over it, and
    the share of each motion.
    """

    def __init__(
        self, scene: Scene, found: WornEnsembles, tell: Callable[[str], None] | None = None
    ) -> None:
        super().__init__(with_cage_end(scene), progress=tell)
        self.found, self.made, self.steps = found, 0, LIFE_STEPS
        self.turn = 60.0 / scene.operation.fastest_rpm
        assert scene.cage is not None
        self.per_second = wear_per_joule(scene, scene.cage.material) / self.turn

    def state(self, worn: np.ndarray, near: States = ()) -> States:
        """The ensemble at that wear."""
        ensemble = self.found(self.made, self.parts.cage_depths(worn))
        self.made += 1
        work = np.array([float(ensemble[f"mean_{part}_work"][0]) for part in CAGE_PARTS])
        status = OK if np.isfinite(work).all() else int(ensemble["status"].values[0])
        ends = [ensemble[f"mean_{part}_work_interval"].values[0] for part in CAGE_PARTS]
        half = 0.5 * np.diff(ends)[:, 0]
        error = np.divide(half, work, out=np.zeros(work.size), where=work > 0.0)
        values = {"work": work, "work_error": error, "share": ensemble["share"].values}
        return self.with_worn((State(status, values),), worn)

    def with_worn(self, states: States, worn: np.ndarray) -> States:
        return (states[0].with_values(self.parts.of_cage(worn)),)

    def rates(self, node: Node) -> np.ndarray:
        pockets, land = self.per_second * node.states[0]["work"]
        each = pockets / self.scene.bearing.ball_count
        return self.parts.cage_rates({"pocket_wear_rate": each, "cage_land_wear_rate": land})

    def wears(self, node: Node) -> bool:
        return bool(self.rates(node).any())

    def longest_step(self, node: Node, rates: np.ndarray) -> float:
        return _BEYOND * super().longest_step(node, rates)

    def report_progress(self, node: Node, horizon: float) -> None:
        if self.progress is not None:
            pocket, land = self.parts.cage_depths(node.worn) / UM
            self.progress(f"cage: {node.x / self.turn:.3g} of about {horizon / self.turn:.3g} "
                f"turns; wear depth {pocket:.3g} um in the pockets, {land:.3g} um at the "
                "land")  # fmt: skip


class BetweenEnsembles(Trapezoid):
    """The trapezoidal rule with work that is linear in time between two ensembles.

    So an end or a film that is worn through within a step requires no further ensemble.
    """

    def again(self, node: Node) -> Node:
        return node

    def after(self, x: float) -> Node:
        end = max(self.known.values(), key=lambda node: node.x, default=None)
        if end is None:
            return super().after(x)
        wearing, now = self.wearing, self.now
        h, share = x - now.x, (x - now.x) / (end.x - now.x)
        first, last = wearing.rates(now), wearing.rates(end)
        worn = now.worn + h * (first + 0.5 * share * (last - first))
        limits = now.states[0].values, end.states[0].values
        mixed = {
            name: (1.0 - share) * value + share * limits[1][name]
            for name, value in limits[0].items()
        }
        states = wearing.with_worn((State(OK, mixed),), worn)
        return Node(x, worn, states, x)


def followed(scene: Scene, found: WornEnsembles, tell: Callable[[str], None] | None = None) -> Life:
    """The life of a cage by ensembles along it."""
    wearing = EnsembleWear(scene, found, tell)
    method = BetweenEnsembles(_MOST_STEPS)
    return follow(wearing, Criteria(wearing.scene), method)


def cage_life(life: Life, other: bool = True) -> xr.Dataset:
    """Life of a cage by the ensembles along it, beside that of balls and races."""
    wearing: EnsembleWear = life.wearing
    scene, parts = wearing.scene, wearing.parts
    depths = np.array([parts.cage_depths(node.worn) for node in life.nodes])
    turns = np.array([node.x for node in life.nodes]) / wearing.turn
    share, error = (
        np.array([one[name] for one in life.states]) for name in ("share", "work_error")
    )
    values: dict[str, Any] = {"cage_end": life.criterion}
    attrs = {}
    if life.status == OK:
        criterion = CRITERIA[life.criterion]
        measure, limit = ENDS[criterion], getattr(wearing.end, criterion)
        worst, name = measure.critical(life.states[-1].__getitem__)
        attrs = {"cage_ended_by": measure.criterion_phrase(worst, limit, name)}
        # Runs along the life draw alike, so errors add.
        half = np.trapezoid(error[:, int(not name.startswith(CAGE_PARTS[0]))], turns) / turns[-1]
        interval = turns[-1] * np.array([1.0 - half, 1.0 + half])
        values |= {
            "cage_life": turns[-1],
            "cage_life_interval": interval,
            "cage_life_interval_with_wear": interval / _wear_quantiles(scene)[::-1],
            "cage_hours": life.last.x,
        }
    values |= {
        "film_gone": [_gone(parts.coating.whole[0], depth, turns) for depth in depths.T],
        "motion_changes": _change(share, turns),
        "node_turns": turns,
        "node_depth": depths,
        "node_work": [one["work"] for one in life.states],
        "node_share": share,
    }
    values |= _of_balls_and_races(scene) if other else {}
    axes = {END: None, PART: None, NODE: range(len(turns)), OF_MOTION: None}
    return dataset_of_rows(CAGE_LIFE, axes, [values], **attrs)


def _gone(film: float, depth: np.ndarray, turns: np.ndarray) -> float:
    """When a film is worn through; infinite if it is not, NaN without one."""
    if not film:
        return math.nan
    is_gone = depth[-1] >= (1.0 - _ENDS_WITHIN) * film
    return float(np.interp(film, depth, turns)) if is_gone else math.inf


def _wear_quantiles(scene: Scene) -> np.ndarray:
    """Ends of the interval of the cage's wear coefficient, over the scene's own."""
    spread, _ = cage_spread(scene)
    if WEAR not in spread:
        return np.ones(2)
    own = scene.materials[scene.cage.material].wear_coefficient if scene.cage else 1.0
    if scene.cage and scene.cage.film and scene.cage.film.wear_coefficient:
        own = scene.cage.film.wear_coefficient
    return quantile(spread[WEAR], own, (0.0, 1.0), np.array(INTERVAL)) / own


def _change(share: np.ndarray, turns: np.ndarray) -> tuple[float, float]:
    """Between which turns another motion than that of the new cage begins to prevail."""
    motions = share.argmax(axis=1)
    other = np.flatnonzero(motions != motions[0])
    return (turns[other[0] - 1], turns[other[0]]) if other.size else (math.nan, math.nan)


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
    time = life.last.time
    spread, _ = with_usual_spread(scene)
    names = [name for name in WORN if name in (spread.uncertainty or {})]
    sampled = values_at(spread, names, np.random.default_rng(0).random((_SAMPLES, len(names))))
    factor = wear_factor(spread, names, sampled)
    return {
        "other_hours": time,
        "other_hours_interval": time * np.quantile(factor, INTERVAL),
        "other_end": life.criterion,
    }


def cage_found(
    scene: Scene,
    plan: Ensemble,
    life: bool = False,
    workers: int = 1,
    tell: Tell | None = None,
    path: Path | None = None,
) -> xr.Dataset:
    """The ensemble of a cage, and its life if that is asked for.

    path: file to write. What is killed goes on from there. Ensembles along the life stand beside
        it, NAME-1.nc and so on.
    """
    if life:
        with_cage_end(scene)  # refused before anything is solved
    with contextlib.ExitStack() as kept:
        first: list[xr.Dataset] = []

        def found(number: int, depth: np.ndarray) -> xr.Dataset:
            pocket, land = (1e6 * depth).tolist()
            worn = replace(plan, worn_um=(pocket, land))
            if path is None:
                made = ensemble_of(scene, worn, workers, tell)
            else:
                place = path.with_name(f"{path.stem}-{number}{path.suffix}") if number else path
                made = kept.enter_context(kept_in(place, scene, worn, workers, tell))
                write_dataset(made, place)
            first.append(made)
            return made

        if not life:
            return found(0, np.zeros(2))
        of_life = cage_life(followed(scene, found, tell))
        whole = xr.merge([first[0], of_life]).assign_attrs(of_life.attrs | first[0].attrs)
        if path is not None:
            write_dataset(whole, path)
        return whole
