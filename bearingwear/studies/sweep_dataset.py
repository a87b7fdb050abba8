"""The answers of a sweep as a dataset, and the sweep that its parts make."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.results.kinds import ONLY_IN_CASES, SWEEP_KIND
from bearingwear.results.variable import STATUS, Variable, table
from bearingwear.results.warnings import WARNING, merged_warnings, warning_lines
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.scene import Scene
from bearingwear.studies.answers import PROBLEM, REFUSED, Answer, answer_values
from bearingwear.studies.extremes import KEEP_EXTREMES, WORST_VALUES, worst_values
from bearingwear.studies.points import SweepPoints

if TYPE_CHECKING:
    import xarray as xr

    from bearingwear.solvers.result import Result

NUMBERED = "point"
"""Dimension of the points of a part, and its coordinate: their numbers."""

KEEP_STUDY = "study"
_OF_EXTREMES = ("life", "loss_at_end", "end_criterion")
"""Variables of a life that stand beside the worst values."""

_SHARED = ("kind", "title", "scenes", "points", "source_hash", "package_version")
"""Attributes that are the same in all parts of a sweep."""


@dataclass(frozen=True)
class Kept:
    """What is kept of the answers: variables by name, or all."""

    what: str  # solve, life or function
    names: tuple[str, ...] | None
    with_worst: bool = False

    @classmethod
    def of(cls, keep: str | Sequence[str] | None, what: str) -> Kept:
        """What `keep` asks for. SceneError: a name that no result has."""
        if keep == KEEP_EXTREMES:
            if what != "life":
                raise SceneError(
                    "", f"got {KEEP_EXTREMES} of {what}, expected it of life", source="keep"
                )
            return cls(what, _OF_EXTREMES, True)
        if keep is None:
            return cls(what, None)
        if keep == KEEP_STUDY and what == "solve":
            return cls(what, _names_of_study())
        names = (keep,) if isinstance(keep, str) else tuple(keep)
        if what != "function":
            _check_names(names, what)
        return cls(what, names)

    def of_function(self, values: Mapping[str, Any]) -> Answer:
        """The answer of a function at a point."""
        if not isinstance(values, Mapping):
            kind = type(values).__name__
            raise TypeError(
                f"what: got a function that returns {kind}, expected a mapping of names"
            )
        return {"status": OK} | {n: v for n, v in values.items() if self._has(n)}

    def of_result(self, scene: Scene, result: Result) -> Answer:
        """The answer of a solve or a life of a scene."""
        values = {n: v for n, v in result.values.items() if self._has(n)}
        names = ("fidelity", "warnings", "phases")
        attrs = {name: result.attrs[name] for name in names if name in result.attrs}
        about = {  # of its scene, what decides the layout of a file
            "arrangement": scene.arrangement and {"kind": scene.arrangement.kind},
            "model": {"strips": scene.model.strips},
            "bearing": {"ball_count": scene.bearing.ball_count},
        }
        worst = worst_values(scene, result.values) if self.with_worst else {}
        return {"values": values, "attrs": attrs, "scene": about, "worst": worst}

    def _has(self, name: str) -> bool:
        return self.names is None or name in (*self.names, "status", "end_criterion")


def _names_of_study() -> tuple[str, ...]:
    from bearingwear.results.variables import CASE

    left_out = {*ONLY_IN_CASES}
    return tuple(name for name, one in CASE.items() if not {name, *one.dims} & left_out)


def _check_names(names: Iterable[str], what: str) -> None:
    from bearingwear.results.variables import CASE, LIFE

    known = LIFE if what == "life" else CASE
    for name in names:
        if name not in known:
            import difflib

            near = difflib.get_close_matches(name, known, n=3)
            allowed = ", ".join(near) if near else f"a variable of a {what} (docs/data.md)"
            raise SceneError("", f"got {name}, expected {allowed}", source="keep")


def points_dataset(kept: Kept, answers: Sequence[Answer]) -> xr.Dataset:
    """Answers along `point`, as files have them; NaN where a point has none."""
    from bearingwear.studies.dataset import filled

    if kept.what == "function":
        answers = _of_equal_shapes(answers)
        rows = [answer_values(one) for one in answers]
        made = filled(_table_of(rows), {NUMBERED: len(rows)}, rows)
    else:
        made = _of_results(kept, answers)
    if kept.with_worst:
        rows = [one.get("worst", {}) for one in answers]
        known = {name for row in rows for name in row}
        worst = {name: v for name, v in WORST_VALUES.items() if name in known}
        made = made.assign(filled(worst, {NUMBERED: len(rows)}, rows).variables)
    attrs = [one.get("attrs", {}) for one in answers]
    made.attrs = {
        "fidelity": ", ".join(sorted({one["fidelity"] for one in attrs if "fidelity" in one})),
        "warnings": merged_warnings(attrs),
        "problem": next((one[PROBLEM] for one in answers if PROBLEM in one), ""),
    }
    return made


def _of_results(kept: Kept, answers: Sequence[Answer]) -> xr.Dataset:
    from bearingwear.results.netcdf import stacked_datasets
    from bearingwear.solvers.result import Result
    from bearingwear.studies.dataset import stacked

    refused: dict[str, Any] = {"status": REFUSED}
    if kept.what == "life":
        refused["end_criterion"] = len(CRITERIA) - 1
    about = next(one["scene"] for one in answers if "scene" in one)
    phases = {one["attrs"].get("phases") for one in answers if "attrs" in one}
    same = {"phases": name} if len(phases) == 1 and (name := phases.pop()) else {}
    results = []
    for one in answers:
        attrs = {name: value for name, value in one.get("attrs", {}).items() if name != "phases"}
        result = Result(one.get("values", refused), attrs | same)
        result.scene = one.get("scene", about)
        results.append(result)
    made = stacked(stacked_datasets(results, NUMBERED), {NUMBERED: len(results)}, along=NUMBERED)
    names = kept.names
    return made if names is None else made[[n for n in made.data_vars if n in (*names, "status")]]


def _of_equal_shapes(answers: Sequence[Answer]) -> list[Answer]:
    """Answers of a function, of which those with values of other shapes than before are refused."""
    shapes: dict[str, tuple[int, ...]] = {}
    found: list[Answer] = []
    for answer in answers:
        own = {name: np.shape(value) for name, value in answer_values(answer).items()}
        shapes = own | shapes
        other = [name for name in own if own[name] != shapes[name]]
        problem = "".join(f"{n}: got shape {own[n]}, expected {shapes[n]}" for n in other[:1])
        found.append({"status": REFUSED, PROBLEM: problem} if problem else answer)
    return found


def _table_of(rows: Sequence[Mapping[str, Any]]) -> dict[str, Variable]:
    """Variables of the values that a function returns; dimensions of arrays go by their names."""
    found = table(STATUS)
    for name, value in (item for row in rows for item in row.items()):
        if name not in found:
            array = np.asarray(value)
            dims = tuple(f"{name}_{k}" for k in range(array.ndim))
            kind = "O" if array.dtype.kind in "OUS" else "f8"
            found[name] = Variable(name, dims, "", "value of a function", kind)
    return found


def whole_sweep(made: xr.Dataset, points: SweepPoints) -> xr.Dataset:
    """Answers at all points, in their order, over the dimensions of a sweep; with names."""
    from bearingwear.results.labels import labelled
    from bearingwear.studies.dataset import reshaped

    taken = {str(name) for name in made.variables} - {NUMBERED}
    found = labelled(
        reshaped(made.drop_vars(NUMBERED, errors="ignore"), NUMBERED, points.lengths(taken))
    )
    found = found.assign_coords(points.coordinates(taken))
    found.attrs = dict(made.attrs) | {
        "changed_keys": json.dumps({name: key for key, name in points.key_names(taken).items()}),
        "message": _message(found, made.attrs["problem"]),
    }
    for name in ("problem", "points", "part"):
        found.attrs.pop(name, None)
    return found


def part_of_sweep(
    made: xr.Dataset, points: SweepPoints, numbers: Sequence[int], part: tuple[int, int]
) -> xr.Dataset:
    """Answers at the points of a part along `point`; with names."""
    from bearingwear.results.labels import labelled

    found = labelled(made).assign_coords({NUMBERED: np.array(numbers, dtype="i4")})
    message = _message(found, made.attrs["problem"])
    return found.assign_attrs(points=points.json, part=f"{part[0]}/{part[1]}", message=message)


def sweep_attributes(scenes: Sequence[Scene], points: SweepPoints, what: str) -> dict[str, Any]:
    """Attributes of a sweep, but those of its answers."""
    from bearingwear.results.entries import common_attributes

    several = {"scenes": json.dumps([scene.to_dict() for scene in scenes])}
    return common_attributes() | {
        "title": f"{what}: {', '.join(points.names)} at {len(points)} points",
        "kind": SWEEP_KIND,
        **(several if len(scenes) > 1 else {"scene": scenes[0].json}),
    }


def gathered_parts(paths: Iterable[str | Path]) -> xr.Dataset:
    """The sweep of which all parts are in files, as one call would have made it.

    CaseFileError: a file that is no part, of another sweep, or there twice; or a missing part.
    """
    from bearingwear.results.netcdf import CaseFileError, load_kind
    from bearingwear.studies.dataset import stacked

    parts: dict[str, xr.Dataset] = {}
    for path in map(Path, paths):
        one = load_kind(path, SWEEP_KIND)
        part = one.attrs.get("part")
        if part is None:
            raise CaseFileError(f"{path}: got a whole sweep, expected a part of one")
        if part in parts:
            raise CaseFileError(f"{path}: got part {part} twice, expected each part once")
        first = next(iter(parts.values()), one)
        for key in (*_SHARED, "scene"):
            if one.attrs.get(key) != first.attrs.get(key):
                raise CaseFileError(f"{path}: {key} differs from that of the other parts")
        parts[part] = one
    count = int(next(iter(parts)).partition("/")[2])
    missing = [k for k in range(1, count + 1) if f"{k}/{count}" not in parts]
    if missing:
        raise CaseFileError(
            f"{path}: got {len(parts)} of {count} parts, expected also "
            f"{', '.join(f'{k}/{count}' for k in missing)}"
        )
    each = list(parts.values())
    points = SweepPoints.from_json(each[0].attrs["points"])
    numbers = np.concatenate([one[NUMBERED].values for one in each])
    made = stacked(each, {NUMBERED: len(numbers)}, along=NUMBERED).isel(
        {NUMBERED: np.argsort(numbers)}
    )
    fidelities = {name for one in each for name in one.attrs["fidelity"].split(", ")}
    problems = [one.attrs["problem"] for one in each if one.attrs["problem"]]
    made.attrs = each[0].attrs | {
        "fidelity": ", ".join(sorted(fidelities)),
        "warnings": merged_warnings(one.attrs for one in each),
        "problem": problems[0] if problems else "",
    }
    return whole_sweep(made, points)


def sweep_warnings(made: xr.Dataset) -> list[str]:
    """What a sweep warns of: points not solved, and the warnings of the solved ones."""
    failed = [made.attrs["message"]] if (made["status"] != STATUS_NAMES[OK]).any() else []
    return [*failed, *(line.removeprefix(WARNING) for line in warning_lines(made.attrs))]


def _message(made: xr.Dataset, problem: str) -> str:
    """How many points were not solved, and why."""
    statuses = made["status"].values.ravel().tolist()
    failed = Counter(status for status in statuses if status != STATUS_NAMES[OK])
    if not failed:
        return "all points solved and verified"
    reasons = ", ".join(f"{name} {count}" for name, count in failed.items())
    text = f"{failed.total()} of {len(statuses)} points were not solved: {reasons}"
    return f"{text} ({problem})" if problem else text
