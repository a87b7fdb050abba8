"""Datasets of the answers of a sweep, and of the sweep that is gathered from its parts."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.lives.ends import NO_CRITERION
from bearingwear.results.kinds import ONLY_IN_CASES, SWEEP_KIND
from bearingwear.results.variable import STATUS, Variable, table
from bearingwear.results.warnings import WARNING, merged_warnings, warning_lines
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.scene import Scene
from bearingwear.studies.answers import PROBLEM, REFUSED, Answer, answer_values
from bearingwear.studies.extremes import KEEP_EXTREMES, WORST_VALUES, worst_values
from bearingwear.studies.points import SweepPoints

if TYPE_CHECKING:
    import xarray as xr

    from bearingwear.solvers.result import Result

NUMBERED = "point"
"""Dimension of the points of a part; its coordinate holds their numbers."""

KEEP_STUDY = "study"
"""Choice of a sweep that keeps the variables of a case that `study.nc` has."""

_OF_EXTREMES = ("life", "loss_at_end", "end_criterion")
"""Variables of a life that are kept beside the worst values."""

_SHARED = ("kind", "title", "scenes", "points", "source_hash", "package_version")
"""Attributes that are the same in all parts of a sweep."""


@dataclass(frozen=True)
class KeptVariables:
    """Choice of the variables of a sweep: some by name, or all."""

    what: str  # solve, life or function
    names: tuple[str, ...] | None  # None: all
    with_worst: bool = False  # whether to add the worst values along a life

    @classmethod
    def of(cls, keep: str | Sequence[str] | None, what: str) -> KeptVariables:
        """Returns the choice that the argument `keep` of `bearingwear.sweep` makes.

        keep: names of variables or one name, "extremes", "study" (of a solve), or None for all.
        what {"solve", "life", "function"}: that the sweep computes.
        SceneError: a name that no result has, or the extremes of something other than a life.
        """
        if keep == KEEP_EXTREMES:
            if what != "life":
                raise SceneError(
                    "", f"got {KEEP_EXTREMES} of {what}, expected it of life", source="keep"
                )
            return cls(what, _OF_EXTREMES, with_worst=True)
        if keep is None:
            return cls(what, None)
        if keep == KEEP_STUDY and what == "solve":
            return cls(what, _names_of_study())
        names = (keep,) if isinstance(keep, str) else tuple(keep)
        if what != "function":
            _check_names(names, what)
        return cls(what, names)

    def of_function(self, values: Mapping[str, Any]) -> Answer:
        """Returns the kept values that a function returned at a point, with a status.

        TypeError: the function did not return a mapping.
        """
        if not isinstance(values, Mapping):
            kind = type(values).__name__
            raise TypeError(
                f"what: got a function that returns {kind}, expected a mapping of names"
            )
        return {"status": OK} | {name: value for name, value in values.items() if self._keeps(name)}

    def of_result(self, scene: Scene, result: Result) -> Answer:
        """Returns what a dataset of the sweep needs of a solve or a life.

        The keys `values` and `attrs` have the kept values, and the attributes that differ between
        points. `scene` has the blocks that decide the layout of a file, and `worst` the values of
        `WORST_VALUES`, if kept.
        """
        values = {name: value for name, value in result.values.items() if self._keeps(name)}
        names = ("fidelity", "warnings", "phases")
        attrs = {name: result.attrs[name] for name in names if name in result.attrs}
        layout = {  # the part of the scene that decides the layout of a file
            "arrangement": {"kind": scene.arrangement.kind} if scene.arrangement else None,
            "model": {"strips": scene.model.strips},
            "bearing": {"ball_count": scene.bearing.ball_count},
        }
        worst = worst_values(scene, result.values) if self.with_worst else {}
        return {"values": values, "attrs": attrs, "scene": layout, "worst": worst}

    def _keeps(self, name: str) -> bool:
        """Whether the choice keeps the variable of a name, or every dataset needs it."""
        return self.names is None or name in (*self.names, "status", "end_criterion")


def _names_of_study() -> tuple[str, ...]:
    """Returns the variables of a case that a study keeps."""
    from bearingwear.results.variables import CASE

    return tuple(
        name
        for name, variable in CASE.items()
        if not {name, *variable.dims}.intersection(ONLY_IN_CASES)
    )


def _check_names(names: Iterable[str], what: str) -> None:
    """Raises a SceneError for a name that is no variable of a solve or a life."""
    from bearingwear.results.variables import CASE, LIFE

    variables = LIFE if what == "life" else CASE
    for name in names:
        if name not in variables:
            import difflib

            similar = difflib.get_close_matches(name, variables, n=3)
            allowed = ", ".join(similar) if similar else f"a variable of a {what} (docs/data.md)"
            raise SceneError("", f"got {name}, expected {allowed}", source="keep")


def points_dataset(kept: KeptVariables, answers: Sequence[Answer]) -> xr.Dataset:
    """Returns a dataset of answers along `point`, with codes; NaN where a point has no value.

    Its attributes are `fidelity` (all models used), `warnings`, and `problem`: that of the first
    refused point, empty without one.

    answers: of `kept.of_function` or `kept.of_result`, or of refused points; at least one of a
        solve or a life is not refused.
    """
    from bearingwear.studies.dataset import dataset_of_rows

    if kept.what == "function":
        answers = _answers_of_equal_shapes(answers)
        rows = [answer_values(answer) for answer in answers]
        dataset = dataset_of_rows(_variables_of_rows(rows), {NUMBERED: len(rows)}, rows)
    else:
        dataset = _results_dataset(kept, answers)
    if kept.with_worst:
        rows = [answer.get("worst", {}) for answer in answers]
        present_names = {name for row in rows for name in row}
        variables = {name: WORST_VALUES[name] for name in WORST_VALUES if name in present_names}
        worst = dataset_of_rows(variables, {NUMBERED: len(rows)}, rows)
        dataset = dataset.assign(worst.variables)
    answer_attrs = [answer.get("attrs", {}) for answer in answers]
    fidelities = {attrs["fidelity"] for attrs in answer_attrs if "fidelity" in attrs}
    dataset.attrs = {
        "fidelity": ", ".join(sorted(fidelities)),
        "warnings": merged_warnings(answer_attrs),
        "problem": next((answer[PROBLEM] for answer in answers if PROBLEM in answer), ""),
    }
    return dataset


def _results_dataset(kept: KeptVariables, answers: Sequence[Answer]) -> xr.Dataset:
    """Returns a dataset of solves or lives along `point`.

    Refused points have NaN in the layout of the first solved one, of which there must be one. The
    names of the phases of a duty are kept where all points have the same.
    """
    from bearingwear.results.netcdf import stacked_datasets
    from bearingwear.solvers.result import Result
    from bearingwear.studies.dataset import stacked_dataset

    refused_values: dict[str, Any] = {"status": REFUSED}
    if kept.what == "life":
        refused_values["end_criterion"] = NO_CRITERION
    first_layout = next(answer["scene"] for answer in answers if "scene" in answer)
    phases = {answer["attrs"].get("phases") for answer in answers if "attrs" in answer}
    shared_phases = phases.pop() if len(phases) == 1 else None
    results = []
    for answer in answers:
        attrs = dict(answer.get("attrs", {}))
        attrs.pop("phases", None)
        if shared_phases:
            attrs["phases"] = shared_phases
        result = Result(answer.get("values", refused_values), attrs)
        result.scene = answer.get("scene", first_layout)
        results.append(result)
    lengths = {NUMBERED: len(results)}
    dataset = stacked_dataset(stacked_datasets(results, NUMBERED), lengths, along=NUMBERED)
    if kept.names is None:
        return dataset
    return dataset[[name for name in dataset.data_vars if name in (*kept.names, "status")]]


def _answers_of_equal_shapes(answers: Sequence[Answer]) -> list[Answer]:
    """Returns the answers of a function; one with a value of another shape becomes a refused one.

    The first answer that has a value of a name decides the shape of all values of that name.
    """
    first_shapes: dict[str, tuple[int, ...]] = {}
    checked: list[Answer] = []
    for answer in answers:
        shapes = {name: np.shape(value) for name, value in answer_values(answer).items()}
        first_shapes = shapes | first_shapes
        for name, shape in shapes.items():
            if shape != first_shapes[name]:
                problem = f"{name}: got shape {shape}, expected {first_shapes[name]}"
                answer = {"status": REFUSED, PROBLEM: problem}
                break
        checked.append(answer)
    return checked


def _variables_of_rows(rows: Sequence[Mapping[str, Any]]) -> dict[str, Variable]:
    """Returns variables for the values that a function returned, by their names.

    They are texts, or numbers as `float`. The dimensions of an array `a` are `a_0`, `a_1` and so
    on.

    rows: values at each point; the first row with a name decides the type and the dimensions.
    """
    variables = table(STATUS)
    for row in rows:
        for name, value in row.items():
            if name not in variables:
                array = np.asarray(value)
                dims = tuple(f"{name}_{k}" for k in range(array.ndim))
                dtype = "O" if array.dtype.kind in "OUS" else "f8"
                variables[name] = Variable(name, dims, "", "value of a function", dtype)
    return variables


def whole_sweep(results: xr.Dataset, points: SweepPoints) -> xr.Dataset:
    """Returns results along `point` over the dimensions of the sweep, with names for codes.

    The attribute `changed_keys` gets the key of each dimension or coordinate as JSON, `message` a
    line on unsolved points. The attributes that only parts need are left out.

    results: dataset of `points_dataset` at all points, in their order.
    """
    from bearingwear.results.labels import labelled
    from bearingwear.studies.dataset import reshaped_dataset

    used_names = {str(name) for name in results.variables} - {NUMBERED}
    unnumbered = results.drop_vars(NUMBERED, errors="ignore")
    over_axes = labelled(reshaped_dataset(unnumbered, NUMBERED, points.lengths(used_names)))
    over_axes = over_axes.assign_coords(points.coordinates(used_names))
    changed_keys = {name: key for key, name in points.key_names(used_names).items()}
    over_axes.attrs = dict(results.attrs) | {
        "changed_keys": json.dumps(changed_keys),
        "message": _solved_message(over_axes, results.attrs["problem"]),
    }
    for name in ("problem", "points", "part"):
        over_axes.attrs.pop(name, None)
    return over_axes


def part_of_sweep(
    results: xr.Dataset, points: SweepPoints, numbers: Sequence[int], part: tuple[int, int]
) -> xr.Dataset:
    """Returns the results of a part of a sweep along `point`, with names for codes.

    The attributes `points`, `part` ("3/10") and `message`, a line on unsolved points, are set.

    results: dataset of `points_dataset` at the points of the part.
    points: of the whole sweep.
    numbers: of the points of the part, among all points.
    part: number of the part, and number of parts.
    """
    from bearingwear.results.labels import labelled

    labelled_part = labelled(results).assign_coords({NUMBERED: np.array(numbers, dtype="i4")})
    message = _solved_message(labelled_part, results.attrs["problem"])
    part_name = f"{part[0]}/{part[1]}"
    return labelled_part.assign_attrs(points=points.json, part=part_name, message=message)


def sweep_attributes(scenes: Sequence[Scene], points: SweepPoints, what: str) -> dict[str, Any]:
    """Returns the attributes of a sweep that do not depend on its answers.

    what {"solve", "life", "function"}: that the sweep computes.
    """
    from bearingwear.results.entries import common_attributes

    attributes = common_attributes() | {
        "title": f"{what}: {', '.join(points.names)} at {len(points)} points",
        "kind": SWEEP_KIND,
    }
    if len(scenes) == 1:
        return attributes | {"scene": scenes[0].json}
    return attributes | {"scenes": json.dumps([scene.to_dict() for scene in scenes])}


def gathered_parts(paths: Iterable[str | Path]) -> xr.Dataset:
    """Returns the dataset of a whole sweep from the files of its parts, in any order.

    paths: at least one.
    CaseFileError: a file that is no part, a part of another sweep, a repeated or a missing part.
    """
    from bearingwear.studies.dataset import stacked_dataset

    datasets = _part_datasets(paths)
    points = SweepPoints.from_json(datasets[0].attrs["points"])
    numbers = np.concatenate([dataset[NUMBERED].values for dataset in datasets])
    answers = stacked_dataset(datasets, {NUMBERED: len(numbers)}, along=NUMBERED).isel(
        {NUMBERED: np.argsort(numbers)}
    )
    fidelities = {name for dataset in datasets for name in dataset.attrs["fidelity"].split(", ")}
    problems = [dataset.attrs["problem"] for dataset in datasets if dataset.attrs["problem"]]
    answers.attrs = datasets[0].attrs | {
        "fidelity": ", ".join(sorted(fidelities)),
        "warnings": merged_warnings(dataset.attrs for dataset in datasets),
        "problem": problems[0] if problems else "",
    }
    return whole_sweep(answers, points)


def _part_datasets(paths: Iterable[str | Path]) -> list[xr.Dataset]:
    """Returns the datasets of all parts of a sweep, in the order of the paths.

    paths: at least one.
    CaseFileError: a file that is no part, a part of another sweep, a repeated or a missing part.
    """
    from bearingwear.results.netcdf import CaseFileError, load_kind

    parts: dict[str, xr.Dataset] = {}
    for path in map(Path, paths):
        dataset = load_kind(path, SWEEP_KIND)
        part_name = dataset.attrs.get("part")
        if part_name is None:
            raise CaseFileError(f"{path}: got a whole sweep, expected a part of one")
        if part_name in parts:
            raise CaseFileError(f"{path}: got part {part_name} twice, expected each part once")
        first_part = next(iter(parts.values()), dataset)
        for key in (*_SHARED, "scene"):
            if dataset.attrs.get(key) != first_part.attrs.get(key):
                raise CaseFileError(f"{path}: {key} differs from that of the other parts")
        parts[part_name] = dataset
    count = int(next(iter(parts)).partition("/")[2])
    missing = [k for k in range(1, count + 1) if f"{k}/{count}" not in parts]
    if missing:
        raise CaseFileError(
            f"{path}: got {len(parts)} of {count} parts, expected also "
            f"{', '.join(f'{k}/{count}' for k in missing)}"
        )
    return list(parts.values())


def sweep_warnings(results: xr.Dataset) -> list[str]:
    """Returns a line on the unsolved points of a sweep, then a line for each of its warnings.

    The list is empty if all points were solved without a warning.

    results: of a whole sweep, or of a part, with names for codes.
    """
    lines = [line.removeprefix(WARNING) for line in warning_lines(results.attrs)]
    if (results["status"] != STATUS_NAMES[OK]).any():
        return [results.attrs["message"], *lines]
    return lines


def _solved_message(results: xr.Dataset, problem: str) -> str:
    """Returns a line on how many points were not solved, by status, or that all were solved.

    results: with names for codes.
    problem: of the first refused point, empty without one.
    """
    statuses = results["status"].values.ravel().tolist()
    failures = Counter(status for status in statuses if status != STATUS_NAMES[OK])
    if not failures:
        return "all points solved and verified"
    reasons = ", ".join(f"{name} {count}" for name, count in failures.items())
    text = f"{failures.total()} of {len(statuses)} points were not solved: {reasons}"
    return f"{text} ({problem})" if problem else text
