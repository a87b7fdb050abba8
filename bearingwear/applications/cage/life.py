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
from bearingwear.applications.cage.ensemble import END, OF_MOTION, cage_ensemble, resumed_ensemble
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
_BEYOND = 1.02  # length of a step over that which leads to the end, so that the last reaches it
_ENDS_WITHIN = 1e-3  # error of the depth at which the life ends, over that depth
_SAMPLES = 4096
"""Samples of K_s and hardness, which scale a life: its quantiles then scatter by a few percent."""

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
    """Returns the scene with an end-of-life criterion for its cage, by default a worn-through film.

    SceneError: the cage has neither a criterion nor a film, or already meets a criterion.
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

    The values of a state are those of the worn cage and of its ensemble: `work`, the mean work per
    turn in pockets and at the land (2,) [J]; `work_error`, the half-width of its interval relative
    to it (2,); `share`, the share of runs that end in each motion. Nodes lie at times [s]; `turn`
    is the duration of a shaft turn [s].

    ensemble_at: called once for each state that is solved, with numbers from 0 on.
    progress: receives a line of text at each step.
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
        # worn volume per second over the work per turn [m3/(J s)]
        self.per_second = wear_per_joule(scene, scene.cage.material) / self.turn

    def state(self, worn: np.ndarray, near: States = ()) -> States:
        """Returns the state (1,) of a worn cage, from a new ensemble; `near` is not used.

        Without a solved run, its status is that of the first run.
        """
        ensemble = self.ensemble_at(self.ensembles, self.parts.cage_depths(worn))
        self.ensembles += 1
        # the first of the groups of a mean contains all runs
        work = np.array([float(ensemble[f"mean_{part}_work"][0]) for part in CAGE_PARTS])
        status = OK if np.isfinite(work).all() else int(ensemble["status"].values[0])
        intervals = [ensemble[f"mean_{part}_work_interval"].values[0] for part in CAGE_PARTS]
        half_widths = 0.5 * np.diff(intervals)[:, 0]
        relative_error = np.divide(half_widths, work, out=np.zeros(work.size), where=work > 0.0)
        values = {"work": work, "work_error": relative_error, "share": ensemble["share"].values}
        return self.with_worn((State(status, values),), worn)

    def with_worn(self, states: States, worn: np.ndarray) -> States:
        """Returns the state (1,) with the values of the worn cage: clearances, and worn films."""
        return (states[0].with_values(self.parts.cage_values(worn)),)

    def rates(self, node: Node) -> np.ndarray:
        """Returns the wear per second of all parts, of which only pockets and land are not 0.

        The rates follow from the mean work; the work in all pockets is spread evenly over them.
        """
        pockets, land = self.per_second * node.states[0]["work"]
        per_pocket = pockets / self.scene.bearing.ball_count
        return self.parts.cage_rates({"pocket_wear_rate": per_pocket, "cage_land_wear_rate": land})

    def wears(self, node: Node) -> bool:
        """Returns whether any part of the cage wears."""
        return bool(self.rates(node).any())

    def longest_step(self, node: Node, rates: np.ndarray) -> float:
        """Returns the length of the next step, slightly longer than that of a `Motion` [s].

        Otherwise the last step might miss the end by rounding. It is infinite where no wear leads
        to an end.
        """
        return _BEYOND * super().longest_step(node, rates)

    def report_progress(self, node: Node, horizon: float) -> None:
        """Passes a line with turns, expected turns and wear depths to `progress`, if there is one.

        horizon: the estimated end [s].
        """
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
        """Returns the node at a worn-through film unchanged: no ensemble is solved there."""
        return node

    def node_after(self, x: float) -> Node:
        """Returns a node at a time after the last one [s].

        The first call of a step is for its end, where an ensemble is solved. Nodes at times before
        it are interpolated between the ensembles of both ends.
        """
        end = max(self.nodes_by_time.values(), key=lambda node: node.x, default=None)
        if end is None:
            return super().node_after(x)
        wearing, now = self.wearing, self.now
        elapsed = x - now.x
        share = elapsed / (end.x - now.x)
        first_rates, last_rates = wearing.rates(now), wearing.rates(end)
        worn = now.worn + elapsed * (first_rates + 0.5 * share * (last_rates - first_rates))
        last_values = end.states[0].values
        interpolated = {
            name: (1.0 - share) * value + share * last_values[name]
            for name, value in now.states[0].values.items()
        }
        states = wearing.with_worn((State(OK, interpolated),), worn)
        return Node(x, worn, states, x)


def ensemble_life(
    scene: Scene, ensemble_at: WornEnsembles, tell: Callable[[str], None] | None = None
) -> Life:
    """Returns the life of a cage over time, from new on.

    An ensemble is solved at the ends of steps; nodes where a film goes or the life ends are
    interpolated. Raises SceneError as `with_cage_end`.

    ensemble_at: makes the ensemble with a number along the life, at worn depths.
    tell: receives a line of progress at each step.
    """
    wearing = EnsembleWear(scene, ensemble_at, tell)
    return follow(wearing, Criteria(wearing.scene), BetweenEnsembles(_MOST_STEPS))


def cage_life_dataset(life: Life, *, with_other_parts: bool = True) -> xr.Dataset:
    """Returns the life of a cage by the names of `CAGE_LIFE`, and the nodes along it.

    A life that meets no criterion has no `cage_life`, but its nodes.

    life: from `ensemble_life`.
    with_other_parts: whether to add the steady life of balls and races.
    """
    wearing: EnsembleWear = life.wearing
    scene, parts = wearing.scene, wearing.parts
    depths = np.array([parts.cage_depths(node.worn) for node in life.nodes])
    turns = np.array([node.x for node in life.nodes]) / wearing.turn
    share = np.array([state["share"] for state in life.states])
    results: dict[str, Any] = {"cage_end": life.criterion}
    attrs = {}
    if life.status == OK:
        criterion = CRITERIA[life.criterion]
        measure, limit = ENDS[criterion], getattr(wearing.end, criterion)
        value, variable = measure.critical(life.states[-1].__getitem__)
        attrs = {"cage_ended_by": measure.criterion_phrase(value, limit, variable)}
        ending_part = 0 if variable.startswith(CAGE_PARTS[0]) else 1  # as in `work_error`
        relative_error = np.array([state["work_error"][ending_part] for state in life.states])
        # the ensembles of a life have the same draws, so that their errors add; a large wear
        # coefficient makes the short end of the interval
        half_width = np.trapezoid(relative_error, turns) / turns[-1]
        interval = turns[-1] * np.array([1.0 - half_width, 1.0 + half_width])
        results |= {
            "cage_life": turns[-1],
            "cage_life_interval": interval,
            "cage_life_interval_with_wear": interval / _wear_quantiles(scene)[::-1],
            "cage_hours": life.last.x,
        }
    film_thickness = parts.coating.new_thickness[0]  # the same in pockets and at the land
    results |= {
        "film_gone": [_film_gone_turns(film_thickness, depth, turns) for depth in depths.T],
        "motion_changes": _motion_change_turns(share, turns),
        "node_turns": turns,
        "node_depth": depths,
        "node_work": [state["work"] for state in life.states],
        "node_share": share,
    }
    results |= _steady_life_values(scene) if with_other_parts else {}
    axes = {END: None, PART: None, NODE: range(len(turns)), OF_MOTION: None}
    return dataset_of_rows(CAGE_LIFE, axes, [results], **attrs)


def _film_gone_turns(thickness: float, depth: np.ndarray, turns: np.ndarray) -> float:
    """Returns the turns after which a film is worn through, linear between nodes.

    Infinite if it is not worn through by the last node, NaN without a film.

    thickness: of the new film, 0 without one [m].
    depth, turns: wear depths [m] and turns (n,) along the life.
    """
    if not thickness:
        return math.nan
    is_gone = depth[-1] >= (1.0 - _ENDS_WITHIN) * thickness
    return float(np.interp(thickness, depth, turns)) if is_gone else math.inf


def _wear_quantiles(scene: Scene) -> np.ndarray:
    """Returns the 5 % and 95 % quantiles of the cage's wear coefficient over the scene's (2,) [1].

    If its film has a coefficient, that one counts. Both are 1 for a coefficient that is certain.
    """
    spread, _ = cage_spread(scene)
    if WEAR not in spread:
        return np.ones(2)
    cage = scene.cage
    assert cage is not None
    nominal = scene.materials[cage.material].wear_coefficient
    if cage.film and cage.film.wear_coefficient:
        nominal = cage.film.wear_coefficient
    return quantile(spread[WEAR], nominal, (0.0, 1.0), np.array(INTERVAL)) / nominal


def _motion_change_turns(share: np.ndarray, turns: np.ndarray) -> tuple[float, float]:
    """Returns the turns of two nodes between which the most frequent motion changes first.

    Both are NaN if that motion never changes.

    share: of the runs that end in each motion (nodes, motions).
    turns: of the nodes (nodes,).
    """
    motions = share.argmax(axis=1)
    changed_nodes = np.flatnonzero(motions != motions[0])
    if not changed_nodes.size:
        return math.nan, math.nan
    first = changed_nodes[0]
    return turns[first - 1], turns[first]


def _steady_life_values(scene: Scene) -> dict[str, Any]:
    """Returns `other_hours`, its interval and `other_end` from the steady life of balls and races.

    The life and its interval are in seconds here; the file has hours. The dictionary is empty if
    balls and races have no criterion, or if their life cannot be computed.
    """
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
    """Returns the ensemble of a cage as a dataset, with the variables of `CAGE_LIFE` for a life.

    Writes it to `path`, if there is one. SceneError as `ensemble_scene` and, for a life,
    `with_cage_end`.

    life: whether to compute the life of the cage as well.
    workers: number of processes, which affects only the time.
    path: file to write, from which a killed calculation continues. Ensembles along the life stand
        beside it, NAME-1.nc and so on.
    """
    if life:
        with_cage_end(scene)  # a scene without an end is refused before anything is solved
    # the journals of all ensembles are removed when the last file is written
    with contextlib.ExitStack() as journals:
        ensembles: list[xr.Dataset] = []

        def ensemble_at(number: int, depth: np.ndarray) -> xr.Dataset:
            """Returns the ensemble with a number along the life, and writes its file."""
            pocket_um, land_um = (1e6 * depth).tolist()
            worn_plan = replace(plan, worn_um=(pocket_um, land_um))
            if path is None:
                ensemble = cage_ensemble(scene, worn_plan, workers, tell)
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
        new_ensemble = ensembles[0]
        results = xr.merge([new_ensemble, life_data])
        results = results.assign_attrs(life_data.attrs | new_ensemble.attrs)
        if path is not None:
            write_dataset(results, path)
        return results
