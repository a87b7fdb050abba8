"""An ensemble of runs of one cage: its motions, their shares, and the wear that they cause.

Theory: docs/theory/10-cage.md.
"""

from __future__ import annotations

import contextlib
import json
import math
import time
from collections.abc import Generator, Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy.stats import norm, t

from bearingwear import Scene, SceneError
from bearingwear.applications.cage.draws import CageDraw, cage_draw, cage_spread
from bearingwear.applications.cage.motion import MOTIONS
from bearingwear.applications.cage.plan import FEWEST, Ensemble
from bearingwear.applications.cage.run import ACROSS, CAGE_RUN, cage_run
from bearingwear.atomic import write_text
from bearingwear.console import LINE_EVERY
from bearingwear.kernels.status import BEYOND_GROOVE, OK
from bearingwear.provenance import result_hash
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.results.quantiles import INTERVAL
from bearingwear.results.variable import Variable, table
from bearingwear.scene.read import variant
from bearingwear.solvers.warm import warmed_for_motion
from bearingwear.studies.answers import PROBLEM, Tell, Workers
from bearingwear.studies.dataset import dataset_of_rows

RunRow = dict[str, Any]
"""Values of `CAGE_RUN` of a run, and the values that it drew."""

ENSEMBLE_KIND = "cage ensemble"

OF_RUN = Variable("run", ("run",), "1", "index of the run", "i8")
GROUP = Variable("group", ("group",), "", "runs included in a mean", "i1", flags=("all", *MOTIONS))
OF_MOTION = Variable("of_motion", ("of_motion",), "", "motion", "i1", flags=MOTIONS)
END = Variable("end", ("end",), "", "end of an interval", "i1", flags=("low", "high"))

MEANS = tuple(
    name
    for name, variable in CAGE_RUN.items()
    if not variable.dims and variable.units and not variable.flags
)
"""Variables of a run whose means an ensemble has."""

SUMMARY = table(
    Variable("share", OF_MOTION.dims, "1", "share of runs that end in each motion"),
    Variable(
        "share_interval", OF_MOTION.dims + END.dims, "1", "90 % interval of the share of runs"
    ),
    *(
        variable
        for name in MEANS
        for variable in (
            Variable(f"mean_{name}", GROUP.dims, CAGE_RUN[name].units,
                f"mean over the runs: {CAGE_RUN[name].long_name}"),
            Variable(f"mean_{name}_interval", GROUP.dims + END.dims, CAGE_RUN[name].units,
                f"90 % interval of mean_{name}"),
        )
    ),
)  # fmt: skip
"""Results of an ensemble."""

_CHECKED_EVERY = 10  # runs
_SAME_RUNS = ("scene", "spread", "drawn_by", "run_sources")
"""Attributes that agree where two ensembles consist of the same runs."""


def ensemble_scene(scene: Scene) -> Scene:
    """Returns a scene as its runs solve it: with the cage, at known temperatures.

    SceneError: it has no cage, or no temperatures at which its heat is carried away.
    """
    if scene.cage is None:
        raise SceneError("cage", "got nothing, expected a cage")
    dynamic_scene = variant(scene, {"model.cage_results": True, "model.fidelity": "dynamic"})
    warm = warmed_for_motion(dynamic_scene)
    if warm.status != OK:
        raise SceneError("thermal", f"got {warm.sentence}, expected a thermal balance")
    return warm.scene


def work(rows: Sequence[RunRow]) -> np.ndarray:
    """Returns the work at the cage per shaft turn, of each run that was solved [J]."""
    return np.array([row["work"] for row in rows if "work" in row])


def half_interval(values: np.ndarray) -> float:
    """Returns half of the interval of the mean of independent values, by Student's t."""
    n = len(values)
    if n < 2:
        return math.nan
    return float(t.ppf(INTERVAL[1], n - 1) * values.std(ddof=1) / math.sqrt(n))


def is_met(rows: Sequence[RunRow], plan: Ensemble) -> bool:
    """Returns whether the interval of the mean work is as narrow as the plan requires."""
    values = work(rows)
    enough = len(values) >= FEWEST
    return enough and half_interval(values) <= plan.within * abs(float(values.mean()))


def share_interval(count: int, total: int) -> tuple[float, float]:
    """Returns Wilson's interval of the share that a count is of a total."""
    z = float(norm.ppf(INTERVAL[1]))
    p, weight = count / total, z * z / total
    middle = (p + 0.5 * weight) / (1.0 + weight)
    half = z * math.sqrt(p * (1.0 - p) / total + weight / (4.0 * total)) / (1.0 + weight)
    return max(middle - half, 0.0), min(middle + half, 1.0)


def summary(rows: Sequence[RunRow]) -> dict[str, Any]:
    """Returns the values of `SUMMARY` over runs."""
    motions = np.array([row.get("motion", -1) for row in rows])
    counts = [int((motions == code).sum()) for code in range(len(MOTIONS))]
    classified = max(sum(counts), 1)
    results: dict[str, Any] = {
        "share": [count / classified for count in counts],
        "share_interval": [share_interval(count, classified) for count in counts],
    }
    groups = [np.ones(len(rows), bool), *(motions == code for code in range(len(MOTIONS)))]
    for name in MEANS:
        run_values = np.array([row.get(name, math.nan) for row in rows], dtype=float)
        group_values = [run_values[group & np.isfinite(run_values)] for group in groups]
        means = [float(values.mean()) if values.size else math.nan for values in group_values]
        results[f"mean_{name}"] = means
        results[f"mean_{name}_interval"] = [
            _mean_interval(values, mean) for values, mean in zip(group_values, means, strict=True)
        ]
    return results


def _mean_interval(values: np.ndarray, mean: float) -> tuple[float, float]:
    """Returns the interval of a mean; values that are never negative have no negative end."""
    half = half_interval(values)
    least = 0.0 if values.size and values.min() >= 0.0 else -math.inf
    return max(mean - half, least) if math.isfinite(half) else math.nan, mean + half


class _Job(NamedTuple):
    """A run to make."""

    scene: Scene
    spread: Mapping[str, Any]
    plan: Ensemble
    run: int


def _run_row(job: _Job) -> RunRow:
    """Draws a run and solves it."""
    draw: CageDraw = cage_draw(job.scene, job.spread, job.plan, job.run)
    row: RunRow = {"status": BEYOND_GROOVE}
    if draw.scene is not None:
        row = cage_run(draw.scene, draw.start, job.plan.least_turns, job.plan.most_turns)
    return row | {"drawn": list(draw.values.values())}


def ensemble_of(
    scene: Scene,
    plan: Ensemble,
    workers: int = 1,
    tell: Tell | None = None,
    before: xr.Dataset | None = None,
    journal: Path | None = None,
) -> xr.Dataset:
    """Makes runs of a scene's cage until the required interval is met, or all have been made.

    workers: processes; they change nothing but the time.
    tell: given a line every few seconds.
    before: an ensemble to continue. That of another scene or plan is not used.
    journal: file that the ensemble will be written to; until then, runs are kept beside it.
    """
    dynamic_scene = ensemble_scene(scene)
    spread, assumed = cage_spread(dynamic_scene)
    names = [*cage_draw(dynamic_scene, spread, plan, 0).values]
    attributes = {
        "title": f"Ensemble of cage runs: {scene.name}",
        "kind": ENSEMBLE_KIND,
        "scene": scene.json,
        "ensemble": json.dumps(asdict(plan)),
        "spread": json.dumps({name: asdict(distribution) for name, distribution in spread.items()}),
        "assumed": assumed,
        "drawn_by": json.dumps([plan.seed, plan.least_turns, plan.most_turns, plan.worn_um]),
        "dynamic_tolerance": dynamic_scene.model.dynamic_tolerance,
        "run_sources": result_hash("bearingwear.applications.cage.run"),
    }

    rows = _rows_before(before, attributes)
    journal_file = None if journal is None else Journal(journal, attributes)
    if journal_file is not None:
        journal_file.read(rows)
    jobs = [_Job(dynamic_scene, spread, plan, k) for k in range(len(rows), plan.runs)]
    new_runs = _solved_rows(jobs, workers)
    begun = last = time.monotonic()
    rows_before = len(rows)
    with contextlib.closing(new_runs):
        while not _is_enough(rows, plan) and (row := next(new_runs, None)) is not None:
            if journal_file is not None:
                journal_file.add(len(rows), row)
            rows.append(row)
            now = time.monotonic()
            if tell and now - last > LINE_EVERY:
                last, done = now, len(rows) - rows_before
                left = (now - begun) / done * (_expected_runs(rows, plan) - len(rows))
                tell(f"{done} of at most {len(jobs)} runs, about {left:.0f} s left")
    return _dataset(rows[: plan.runs], names, attributes)


def _solved_rows(jobs: Sequence[_Job], workers: int) -> Generator[RunRow, None, None]:
    """Yields runs one by one in their order; whoever closes this waits for no other run."""
    with Workers(workers, "bearingwear.cage", progress=False) as pool:
        pool.start()
        for answer in pool.answers_at(_run_row, jobs, at_once=1):
            if PROBLEM in answer:
                raise ValueError(answer[PROBLEM])
            yield dict(answer)


def _is_enough(rows: Sequence[RunRow], plan: Ensemble) -> bool:
    return len(rows) >= plan.runs or (len(rows) % _CHECKED_EVERY == 0 and is_met(rows, plan))


def _expected_runs(rows: Sequence[RunRow], plan: Ensemble) -> int:
    """Estimates the number of runs that meet the interval, if all scatter like those so far."""
    values = work(rows)
    if len(values) < 3 or not values.any():
        return plan.runs
    narrower = half_interval(values) / (plan.within * abs(float(values.mean())))
    needed = len(rows) * narrower**2
    checked = _CHECKED_EVERY * math.ceil(max(needed, FEWEST, len(rows)) / _CHECKED_EVERY)
    return min(checked, plan.runs)


def _dataset(
    rows: Sequence[RunRow], names: Sequence[str], attributes: Mapping[str, Any]
) -> xr.Dataset:
    """Returns runs and their summary as a dataset.

    names: names of the sampled values.
    """
    plan = Ensemble(**json.loads(attributes["ensemble"]))
    value = Variable("value", ("value",), "", "name of the sampled value", "i1", flags=tuple(names))
    drawn_values = Variable("drawn", ("value",), "", "sampled value, in the unit of its key")
    runs = CAGE_RUN | ({"drawn": drawn_values} if names else {})
    stored_rows = [{name: row[name] for name in runs if name in row} for row in rows]
    axes: dict[Any, Any] = {OF_RUN: range(len(rows)), ACROSS: None}
    run_dataset = dataset_of_rows(runs, axes | ({value: None} if names else {}), stored_rows)
    summary_dataset = dataset_of_rows(
        SUMMARY, {OF_MOTION: None, GROUP: None, END: None}, [summary(rows)]
    )
    met = np.int64(len(rows) > 0 and is_met(rows, plan))
    return xr.merge([run_dataset, summary_dataset], combine_attrs="override").assign_attrs(
        attributes, met=met
    )


def _rows_before(before: xr.Dataset | None, attributes: Mapping[str, Any]) -> list[RunRow]:
    """Returns the runs of an ensemble that was begun, or none if it is another one."""
    if before is None or any(before.attrs.get(k) != attributes[k] for k in _SAME_RUNS):
        return []
    names = [name for name in (*CAGE_RUN, "drawn") if name in before]
    rows = []
    for k in range(before.sizes["run"]):
        values = {name: before[name].values[k] for name in names}
        finite_values = {name: value for name, value in values.items() if np.isfinite(value).all()}
        rows.append({name: np.asarray(value).tolist() for name, value in finite_values.items()})
    return rows


class Journal:
    """Runs that are not in a file yet, one on each line, so that a killed process loses none."""

    def __init__(self, path: Path, attributes: Mapping[str, Any]) -> None:
        self.path = path.with_name(f".{path.name}.runs")
        self.head = json.dumps([attributes[key] for key in _SAME_RUNS])

    def read(self, rows: list[RunRow]) -> None:
        """Adds the runs that follow the given rows; drops a line that is incomplete."""
        lines = self.path.read_text(encoding="utf-8").split("\n") if self.path.is_file() else []
        if lines[:1] != [self.head]:
            write_text(self.path, f"{self.head}\n")
            return
        *complete, incomplete = lines[1:]  # the last one is empty if it was written to its end
        for number, row in map(json.loads, complete):
            if number == len(rows):
                rows.append(row)
        if incomplete:
            write_text(self.path, "\n".join([self.head, *complete, ""]))

    def add(self, number: int, row: RunRow) -> None:
        """Adds a run."""
        with self.path.open("a", encoding="utf-8") as file:
            file.write(f"{json.dumps([number, row])}\n")


@contextlib.contextmanager
def resumed_ensemble(
    path: Path, scene: Scene, plan: Ensemble, workers: int = 1, tell: Tell | None = None
) -> Iterator[xr.Dataset]:
    """Yields an ensemble that continues from its file, or from where a run was killed.

    Its journal is removed after the block, which must write the file.
    """
    before = None
    if path.is_file():
        with contextlib.suppress(CaseFileError):
            before = load(path)
    ensemble = ensemble_of(scene, plan, workers, tell, before, path)
    yield ensemble
    Journal(path, ensemble.attrs).path.unlink(missing_ok=True)
