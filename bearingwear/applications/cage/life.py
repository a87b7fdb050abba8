"""The life of a cage: ensembles along its wear, until a film is gone or a clearance too large.

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

from bearingwear import Scene, SceneError
from bearingwear.applications.cage.draws import WEAR, cage_spread
from bearingwear.applications.cage.ensemble import END, OF_MOTION, ensemble_of, resumed_ensemble
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
from bearingwear.scene.distributions import quantile, sampled_values
from bearingwear.scene.scene import WORN, EndOfLife
from bearingwear.solvers.dynamic.windows import wear_per_joule
from bearingwear.solvers.state import State
from bearingwear.studies.answers import Tell
from bearingwear.studies.dataset import dataset_of_rows, write_dataset
from bearingwear.studies.sampling import wear_factor

WEARING = ("pockets", "land")
LIFE_STEPS = 4
"""Ensembles from new to the end, or from one film to the next, besides the first."""

_MOST_STEPS = 4 * LIFE_STEPS
_UM = 1e-6
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
"""Returns the ensemble of a number along a life, at wear depths of pockets and land (2,) [m]."""


def with_cage_end(scene: Scene) -> Scene:
    """Returns the scene with an end for its cage: a film worn through, if it has no other.

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
        limit, initial = getattr(end, name), getattr(cage, name)
        if limit is not None and limit <= initial:
            problem = f"got {limit:g}, expected a number > {initial:g}, the initial value"
            raise SceneError(f"wear.end_of_life.{name}", problem)
    return with_end(scene, end)


class EnsembleWear(Motion):
    """The wear of a cage by ensembles; balls and races do not wear.

    The values of a state are the mean work in pockets and at the land (2,) [J], the half-width of
    its interval relative to it, and the share of each motion.
    """

    def __init__(
        self,
        scene: Scene,
        ensemble_at: WornEnsembles,
        progress: Callable[[str], None] | None = None,
    ) -> None:
        super().__init__(with_cage_end(scene), progress=progress)
        self.ensemble_at, self.ensembles, self.steps = ensemble_at, 0, LIFE_STEPS
        self.turn = 60.0 / scene.operation.fastest_rpm
        assert scene.cage is not None
        self.per_second = wear_per_joule(scene, scene.cage.material) / self.turn

    def state(self, worn: np.ndarray, near: States = ()) -> States:
        """Returns the state at a wear, from an ensemble there."""
        ensemble = self.ensemble_at(self.ensembles, self.parts.cage_depths(worn))
        self.ensembles += 1
        work = np.array([float(ensemble[f"mean_{part}_work"][0]) for part in CAGE_PARTS])
        status = OK if np.isfinite(work).all() else int(ensemble["status"].values[0])
        intervals = [ensemble[f"mean_{part}_work_interval"].values[0] for part in CAGE_PARTS]
        half_widths = 0.5 * np.diff(intervals)[:, 0]
        relative_error = np.divide(half_widths, work, out=np.zeros(work.size), where=work > 0.0)
        values = {"work": work, "work_error": relative_error, "share": ensemble["share"].values}
        return self.with_worn((State(status, values),), worn)

    def with_worn(self, states: States, worn: np.ndarray) -> States:
        return (states[0].with_values(self.parts.cage_values(worn)),)

    def rates(self, node: Node) -> np.ndarray:
        """Returns wear rates by the mean work in pockets and at the land."""
        pockets, land = self.per_second * node.states[0]["work"]
        per_pocket = pockets / self.scene.bearing.ball_count
        return self.parts.cage_rates({"pocket_wear_rate": per_pocket, "cage_land_wear_rate": land})

    def wears(self, node: Node) -> bool:
        return bool(self.rates(node).any())

    def longest_step(self, node: Node, rates: np.ndarray) -> float:
        return _BEYOND * super().longest_step(node, rates)

    def report_progress(self, node: Node, horizon: float) -> None:
        if self.progress is not None:
            pocket, land = self.parts.cage_depths(node.worn) / _UM
            self.progress(f"cage: {node.x / self.turn:.3g} of about {horizon / self.turn:.3g} "
                f"turns; wear depth {pocket:.3g} um in the pockets, {land:.3g} um at the "
                "land")  # fmt: skip


class BetweenEnsembles(Trapezoid):
    """The trapezoidal rule with work that is linear in time between two ensembles.

    So an end or a film that is worn through within a step requires no further ensemble.
    """

    def node_after_event(self, node: Node) -> Node:
        return node

    def node_after(self, x: float) -> Node:
        """Returns the node at a time after the last one, between two ensembles if there are two."""
        end = max(self.nodes_by_time.values(), key=lambda node: node.x, default=None)
        if end is None:
            return super().node_after(x)
        wearing, now = self.wearing, self.now
        h, share = x - now.x, (x - now.x) / (end.x - now.x)
        first_rate, last_rate = wearing.rates(now), wearing.rates(end)
        worn = now.worn + h * (first_rate + 0.5 * share * (last_rate - first_rate))
        first, last = now.states[0].values, end.states[0].values
        between = {
            name: (1.0 - share) * value + share * last[name] for name, value in first.items()
        }
        states = wearing.with_worn((State(OK, between),), worn)
        return Node(x, worn, states, x)


def ensemble_life(
    scene: Scene, ensemble_at: WornEnsembles, tell: Callable[[str], None] | None = None
) -> Life:
    """Returns the life of a cage, from ensembles along it."""
    wearing = EnsembleWear(scene, ensemble_at, tell)
    method = BetweenEnsembles(_MOST_STEPS)
    return follow(wearing, Criteria(wearing.scene), method)


def cage_life_dataset(life: Life, *, with_other_parts: bool = True) -> xr.Dataset:
    """Returns the life of a cage from the ensembles along it.

    with_other_parts: whether to add the steady life of balls and races.
    """
    wearing: EnsembleWear = life.wearing
    scene, parts = wearing.scene, wearing.parts
    depths = np.array([parts.cage_depths(node.worn) for node in life.nodes])
    turns = np.array([node.x for node in life.nodes]) / wearing.turn
    share, relative_error = (
        np.array([state[variable] for state in life.states]) for variable in ("share", "work_error")
    )
    results: dict[str, Any] = {"cage_end": life.criterion}
    attrs = {}
    if life.status == OK:
        criterion = CRITERIA[life.criterion]
        measure, limit = ENDS[criterion], getattr(wearing.end, criterion)
        value, variable = measure.critical(life.states[-1].__getitem__)
        attrs = {"cage_ended_by": measure.criterion_phrase(value, limit, variable)}
        # Runs along the life draw alike, so errors add.
        half_width = (
            np.trapezoid(relative_error[:, int(not variable.startswith(CAGE_PARTS[0]))], turns)
            / turns[-1]
        )
        interval = turns[-1] * np.array([1.0 - half_width, 1.0 + half_width])
        results |= {
            "cage_life": turns[-1],
            "cage_life_interval": interval,
            "cage_life_interval_with_wear": interval / _wear_quantiles(scene)[::-1],
            "cage_hours": life.last.x,
        }
    results |= {
        "film_gone": [
            _film_gone_turns(parts.coating.new_thickness[0], depth, turns) for depth in depths.T
        ],
        "motion_changes": _motion_change_turns(share, turns),
        "node_turns": turns,
        "node_depth": depths,
        "node_work": [state["work"] for state in life.states],
        "node_share": share,
    }
    results |= _steady_life_values(scene) if with_other_parts else {}
    axes = {END: None, PART: None, NODE: range(len(turns)), OF_MOTION: None}
    return dataset_of_rows(CAGE_LIFE, axes, [results], **attrs)


def _film_gone_turns(film: float, depth: np.ndarray, turns: np.ndarray) -> float:
    """Returns when a film is worn through; infinite if it is not, NaN without one."""
    if not film:
        return math.nan
    is_gone = depth[-1] >= (1.0 - _ENDS_WITHIN) * film
    return float(np.interp(film, depth, turns)) if is_gone else math.inf


def _wear_quantiles(scene: Scene) -> np.ndarray:
    """Returns the ends of the cage's wear coefficient interval, relative to the scene's value."""
    spread, _ = cage_spread(scene)
    if WEAR not in spread:
        return np.ones(2)
    nominal = scene.materials[scene.cage.material].wear_coefficient if scene.cage else 1.0
    if scene.cage and scene.cage.film and scene.cage.film.wear_coefficient:
        nominal = scene.cage.film.wear_coefficient
    return quantile(spread[WEAR], nominal, (0.0, 1.0), np.array(INTERVAL)) / nominal


def _motion_change_turns(share: np.ndarray, turns: np.ndarray) -> tuple[float, float]:
    """Returns the turns between which another motion than that of the new cage prevails."""
    motions = share.argmax(axis=1)
    changed = np.flatnonzero(motions != motions[0])
    return (turns[changed[0] - 1], turns[changed[0]]) if changed.size else (math.nan, math.nan)


def _steady_life_values(scene: Scene) -> dict[str, Any]:
    """Returns the steady life of balls and races; nothing where it has none."""
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
    sampled = sampled_values(spread, names, np.random.default_rng(0).random((_SAMPLES, len(names))))
    factor = wear_factor(spread, names, sampled)
    return {
        "other_hours": time,
        "other_hours_interval": time * np.quantile(factor, INTERVAL),
        "other_end": life.criterion,
    }


def cage_results(
    scene: Scene,
    plan: Ensemble,
    life: bool = False,
    workers: int = 1,
    tell: Tell | None = None,
    path: Path | None = None,
) -> xr.Dataset:
    """Returns the ensemble of a cage, and its life if that is required.

    path: file to write, from which a killed calculation continues. Ensembles along the life stand
        beside it, NAME-1.nc and so on.
    """
    if life:
        with_cage_end(scene)  # refused before anything is solved
    with contextlib.ExitStack() as journals:  # that no interruption loses
        ensembles: list[xr.Dataset] = []

        def ensemble_at(number: int, depth: np.ndarray) -> xr.Dataset:
            pocket_um, land_um = (1e6 * depth).tolist()
            worn_plan = replace(plan, worn_um=(pocket_um, land_um))
            if path is None:
                ensemble = ensemble_of(scene, worn_plan, workers, tell)
            else:
                file = path.with_name(f"{path.stem}-{number}{path.suffix}") if number else path
                ensemble = journals.enter_context(
                    resumed_ensemble(file, scene, worn_plan, workers, tell)
                )
                write_dataset(ensemble, file)
            ensembles.append(ensemble)
            return ensemble

        if not life:
            return ensemble_at(0, np.zeros(2))
        life_data = cage_life_dataset(ensemble_life(scene, ensemble_at, tell))
        new = ensembles[0]
        results = xr.merge([new, life_data]).assign_attrs(life_data.attrs | new.attrs)
        if path is not None:
            write_dataset(results, path)
        return results
