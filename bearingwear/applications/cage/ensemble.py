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
"""Values of `CAGE_RUN` of a run by their names, and the list of values that it drew (`drawn`)."""

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
_FEWEST_OF_ESTIMATE = 3  # runs, from whose scatter the number of all is estimated
_SAME_RUNS = ("scene", "spread", "drawn_by", "run_sources")
"""Attributes that agree where two ensembles consist of the same runs."""


def ensemble_scene(scene: Scene) -> Scene:
    """Returns a scene as its runs solve it: with the cage, at known temperatures.

    The model is dynamic, with results of the cage. A thermal network is replaced by the
    temperatures that it leads to.

    SceneError: the scene has no cage, or no temperatures at which its heat is carried away.
    """
    if scene.cage is None:
        raise SceneError("cage", "got nothing, expected a cage")
    dynamic_scene = variant(scene, {"model.cage_results": True, "model.fidelity": "dynamic"})
    warm = warmed_for_motion(dynamic_scene)
    if warm.status != OK:
        raise SceneError("thermal", f"got {warm.sentence}, expected a thermal balance")
    return warm.scene


def work_per_turn(rows: Sequence[RunRow]) -> np.ndarray:
    """Returns the work at the cage per shaft turn of the runs that were solved (n,) [J]."""
    return np.array([row["work"] for row in rows if "work" in row])


def half_interval(values: np.ndarray) -> float:
    """Returns half the width of the 90 % interval of the mean of independent values.

    The interval is that of Student's t. The result is NaN for fewer than two values.
    """
    n = len(values)
    if n < 2:
        return math.nan
    return float(t.ppf(INTERVAL[1], n - 1) * values.std(ddof=1) / math.sqrt(n))


def is_narrow_enough(rows: Sequence[RunRow], plan: Ensemble) -> bool:
    """Returns whether the interval of the mean work is as narrow as the plan requires.

    False for fewer than `FEWEST` solved runs.
    """
    work = work_per_turn(rows)
    if len(work) < FEWEST:
        return False
    return half_interval(work) <= plan.within * abs(float(work.mean()))


def share_interval(count: int, total: int) -> tuple[float, float]:
    """Returns the ends of Wilson's 90 % interval of the share count/total, for a total > 0."""
    z = float(norm.ppf(INTERVAL[1]))
    p, weight = count / total, z * z / total
    middle = (p + 0.5 * weight) / (1.0 + weight)
    half = z * math.sqrt(p * (1.0 - p) / total + weight / (4.0 * total)) / (1.0 + weight)
    return max(middle - half, 0.0), min(middle + half, 1.0)


def ensemble_summary(rows: Sequence[RunRow]) -> dict[str, Any]:
    """Returns the shares of motions and the means over runs, by the names of `SUMMARY`.

    Shares are relative to the runs with a motion; a run that failed has one only if the cage jams.
    A mean has a value for all runs, then one for the runs of each motion; it is NaN without runs.
    """
    motions = np.array([row.get("motion", -1) for row in rows])  # -1: without a motion
    counts = [int((motions == code).sum()) for code in range(len(MOTIONS))]
    classified = max(sum(counts), 1)  # without any, all shares are 0
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
    """Returns the ends of the 90 % interval of a mean; both are NaN for fewer than two values.

    Where no value is negative, a negative end is replaced by 0.

    mean: of the values.
    """
    half = half_interval(values)
    if math.isnan(half):
        return math.nan, math.nan
    least = 0.0 if values.min() >= 0.0 else -math.inf
    return max(mean - half, least), mean + half


class _Job(NamedTuple):
    """A run to solve: its number, and what its input is drawn from."""

    scene: Scene
    spread: Mapping[str, Any]
    plan: Ensemble
    run: int


def _run_row(job: _Job) -> RunRow:
    """Draws the input of a run, solves it and returns its results.

    An impossible draw is not solved: its status is BEYOND_GROOVE, and it has no results.
    """
    draw: CageDraw = cage_draw(job.scene, job.spread, job.plan, job.run)
    row: RunRow = {"status": BEYOND_GROOVE}
    if draw.scene is not None:
        row = cage_run(draw.scene, draw.start, job.plan.least_turns, job.plan.most_turns)
    return row | {"drawn": list(draw.values.values())}


def cage_ensemble(
    scene: Scene,
    plan: Ensemble,
    workers: int = 1,
    tell: Tell | None = None,
    earlier: xr.Dataset | None = None,
    path: Path | None = None,
) -> xr.Dataset:
    """Solves runs of a scene's cage until the required interval is met, or all are solved.

    Returns a dataset with the results along `run` and their summary. SceneError as
    `ensemble_scene`; ValueError where a run could not be computed.

    workers: number of processes, which affects only the time.
    tell: receives a line of progress every few seconds.
    earlier: an ensemble to continue. It is not used if it is of another scene or plan.
    path: file that the caller will write; until then, a journal beside it keeps the runs.
    """
    dynamic_scene = ensemble_scene(scene)
    spread, assumption = cage_spread(dynamic_scene)
    names = [*cage_draw(dynamic_scene, spread, plan, 0).values]
    attributes = {
        "title": f"Ensemble of cage runs: {scene.name}",
        "kind": ENSEMBLE_KIND,
        "scene": scene.json,
        "ensemble": json.dumps(asdict(plan)),
        "spread": json.dumps({name: asdict(distribution) for name, distribution in spread.items()}),
        "assumed": assumption,
        "drawn_by": json.dumps([plan.seed, plan.least_turns, plan.most_turns, plan.worn_um]),
        "dynamic_tolerance": dynamic_scene.model.dynamic_tolerance,
        "run_sources": result_hash("bearingwear.applications.cage.run"),
    }
    rows = _rows_to_continue(earlier, attributes)
    journal = None if path is None else Journal(path, attributes)
    if journal is not None:
        journal.read(rows)
    jobs = [_Job(dynamic_scene, spread, plan, k) for k in range(len(rows), plan.runs)]
    _add_runs(rows, jobs, plan, workers, tell, journal)
    return _ensemble_dataset(rows[: plan.runs], names, attributes)


def _add_runs(
    rows: list[RunRow],
    jobs: Sequence[_Job],
    plan: Ensemble,
    workers: int,
    tell: Tell | None,
    journal: Journal | None,
) -> None:
    """Solves runs and appends them to `rows` and to the journal, until they are enough or all.

    rows: results of earlier runs, which come before those of the jobs.
    tell: receives a line of progress every `LINE_EVERY` seconds.
    """
    initial_count = len(rows)
    start_time = line_time = time.monotonic()
    with contextlib.closing(_solved_rows(jobs, workers)) as new_rows:
        while not _is_enough(rows, plan):
            row = next(new_rows, None)
            if row is None:
                break
            if journal is not None:
                journal.add(len(rows), row)
            rows.append(row)
            now = time.monotonic()
            if tell and now - line_time > LINE_EVERY:
                line_time = now
                solved = len(rows) - initial_count
                seconds_per_run = (now - start_time) / solved
                seconds_left = seconds_per_run * (_expected_runs(rows, plan) - len(rows))
                tell(f"{solved} of at most {len(jobs)} runs, about {seconds_left:.0f} s left")


def _solved_rows(jobs: Sequence[_Job], workers: int) -> Generator[RunRow, None, None]:
    """Yields the results of runs in the order of the jobs.

    Closing the generator waits for no run that is not finished. ValueError: a run could not be
    computed.
    """
    with Workers(workers, "bearingwear.cage", progress=False) as pool:
        pool.start()
        for answer in pool.answers_at(_run_row, jobs, at_once=1):
            if PROBLEM in answer:
                raise ValueError(answer[PROBLEM])
            yield dict(answer)


def _is_enough(rows: Sequence[RunRow], plan: Ensemble) -> bool:
    """Returns whether an ensemble needs no further run.

    It has all runs of the plan or, checked every `_CHECKED_EVERY` runs, an interval that is narrow
    enough.
    """
    if len(rows) >= plan.runs:
        return True
    return len(rows) % _CHECKED_EVERY == 0 and is_narrow_enough(rows, plan)


def _expected_runs(rows: Sequence[RunRow], plan: Ensemble) -> int:
    """Estimates the number of runs that meet the interval, if all scatter like those so far.

    It is at most that of the plan, and equal to it while too few runs are solved to tell.
    """
    work = work_per_turn(rows)
    if len(work) < _FEWEST_OF_ESTIMATE or not work.any():
        return plan.runs
    half_width_ratio = half_interval(work) / (plan.within * abs(float(work.mean())))
    needed = len(rows) * half_width_ratio**2
    checked = _CHECKED_EVERY * math.ceil(max(needed, FEWEST, len(rows)) / _CHECKED_EVERY)
    return min(checked, plan.runs)


def _ensemble_dataset(
    rows: Sequence[RunRow], names: Sequence[str], attributes: Mapping[str, Any]
) -> xr.Dataset:
    """Returns runs and their summary as a dataset.

    Its attribute `met` is 1 if the interval of the work is narrow enough, else 0.

    names: names of the sampled values.
    attributes: of the dataset; `ensemble` is the plan as JSON.
    """
    plan = Ensemble(**json.loads(attributes["ensemble"]))
    value = Variable("value", ("value",), "", "name of the sampled value", "i1", flags=tuple(names))
    drawn_values = Variable("drawn", ("value",), "", "sampled value, in the unit of its key")
    runs = CAGE_RUN | ({"drawn": drawn_values} if names else {})
    stored_rows = [{name: row[name] for name in runs if name in row} for row in rows]
    axes: dict[Any, Any] = {OF_RUN: range(len(rows)), ACROSS: None}
    run_dataset = dataset_of_rows(runs, axes | ({value: None} if names else {}), stored_rows)
    summary_dataset = dataset_of_rows(
        SUMMARY, {OF_MOTION: None, GROUP: None, END: None}, [ensemble_summary(rows)]
    )
    met = np.int64(is_narrow_enough(rows, plan))
    return xr.merge([run_dataset, summary_dataset], combine_attrs="override").assign_attrs(
        attributes, met=met
    )


def _rows_to_continue(earlier: xr.Dataset | None, attributes: Mapping[str, Any]) -> list[RunRow]:
    """Returns the runs of an earlier ensemble; no runs if any of `_SAME_RUNS` differs.

    A value that is NaN, or contains NaN, is left out of its row.

    attributes: of the ensemble that continues it.
    """
    if earlier is None or any(earlier.attrs.get(key) != attributes[key] for key in _SAME_RUNS):
        return []
    names = [name for name in (*CAGE_RUN, "drawn") if name in earlier]
    rows = []
    for k in range(earlier.sizes["run"]):
        values = {name: earlier[name].values[k] for name in names}
        finite_values = {name: value for name, value in values.items() if np.isfinite(value).all()}
        rows.append({name: np.asarray(value).tolist() for name, value in finite_values.items()})
    return rows


class Journal:
    """A hidden file beside a result file that keeps its runs, so that a killed process loses none.

    The first line states scene and draws; each other line is a JSON list of number and `RunRow`.
    """

    def __init__(self, path: Path, attributes: Mapping[str, Any]) -> None:
        self.path = path.with_name(f".{path.name}.runs")
        self.head = json.dumps([attributes[key] for key in _SAME_RUNS])

    def read(self, rows: list[RunRow]) -> None:
        """Appends to `rows` the stored runs that follow them.

        A file of other runs, or none, is replaced by a new one with the first line alone. Removes a
        last line that was not written to its end.
        """
        lines = self.path.read_text(encoding="utf-8").split("\n") if self.path.is_file() else []
        if lines[:1] != [self.head]:
            write_text(self.path, f"{self.head}\n")
            return
        *complete, incomplete = lines[1:]  # the text after the last line break is empty
        for number, row in map(json.loads, complete):
            if number == len(rows):
                rows.append(row)
        if incomplete:
            write_text(self.path, "\n".join([self.head, *complete, ""]))

    def add(self, number: int, row: RunRow) -> None:
        """Appends a run with its number in the ensemble to the file."""
        with self.path.open("a", encoding="utf-8") as file:
            file.write(f"{json.dumps([number, row])}\n")


@contextlib.contextmanager
def resumed_ensemble(
    path: Path, scene: Scene, plan: Ensemble, workers: int = 1, tell: Tell | None = None
) -> Iterator[xr.Dataset]:
    """Yields an ensemble that continues from its file, or from the journal of a killed process.

    The `with` block must write the file at `path`. The journal is removed after it, but stays if
    the block raises. A file that cannot be read is solved anew. Arguments: `cage_ensemble`.
    """
    earlier = None
    if path.is_file():
        with contextlib.suppress(CaseFileError):
            earlier = load(path)
    ensemble = cage_ensemble(scene, plan, workers, tell, earlier, path)
    yield ensemble
    Journal(path, ensemble.attrs).path.unlink(missing_ok=True)
