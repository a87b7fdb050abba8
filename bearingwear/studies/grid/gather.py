"""Gathers the cases of a scene into one dataset over preload method, friction and wear."""

import itertools
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK
from bearingwear.results.entries import stored_data
from bearingwear.results.kinds import ONLY_IN_CASES, SWEEP_KIND, kind_of
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.results.pair_variables import is_pair
from bearingwear.results.variables import STUDY_COORDINATES
from bearingwear.results.warnings import merged_warnings
from bearingwear.scene.decisive import decisive_data
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.axis import GRID_KEYS
from bearingwear.studies.dataset import reshaped, stacked
from bearingwear.studies.grid.grid import Case, Grid

# The same in every case of a study, or the cases do not belong together.
_SHARED_ATTRS = ("fidelity", "source_hash", "package_version", "numpy_version", "numba_version")


def study(paths: Iterable[str | Path]) -> xr.Dataset:
    """Gather the cases of one scene.

    paths: case files, or sweeps over axes of the grid: every point of a grid once. The grid is what
        the files say it is.

    Returns: dimensions `preload_method` (flags, in the order of `scene.PRELOAD_METHODS`),
        `friction`, `ball_diameter_loss` [um], then those of the case. Of a case whose status is not
        ok, the status and the other flags stay and every number is NaN.

    CaseFileError: the file that is missing, truncated, foreign, of another scene, of
    another version of the solver, or there twice; or the case that is missing.
    """
    read = _Read()
    whole = _along_cases(read.each(paths))
    first = read.first
    return _on_grid(whole, list(read.files), _grid_of(read.files)).assign_attrs(
        Conventions=first.get("Conventions", "CF-1.11"),
        title=f"Study of {json.loads(first['scene'])['name']}",
        source=first.get("source", "bearingwear"),
        references=first.get("references", ""),
        history="gathered from case files by bearingwear gather",
        comment="The scene contains the values common to all cases; the axes give the others. "
        "If the status of a case is not ok, its values are missing.",
        warnings=read.warnings,
        **{key: first[key] for key in ("scene", *_SHARED_ATTRS)},
    )


@dataclass
class _Read:
    """Contents of the files read so far."""

    # the file of each case, in the order read
    files: dict[Case, Path] = field(default_factory=dict)
    # attributes of the first file; `scene` is what all cases share
    first: dict[str, Any] = field(default_factory=dict)
    warnings: str = "[]"  # those of all, each once

    def each(self, paths: Iterable[str | Path]) -> Iterator[xr.Dataset]:
        """Read file by file; refuse what does not belong to the others."""
        for path in map(Path, paths):
            dataset = load(path)
            is_sweep = kind_of(dataset) == SWEEP_KIND
            cases, shared = (
                _identity_of_sweep(dataset, path) if is_sweep else _identity(dataset, path)
            )
            if not is_sweep and path.stem != cases[0].id:
                raise CaseFileError(f"{path}: contains the case {cases[0].id}")
            for case in cases:
                if case in self.files:
                    raise CaseFileError(f"{path}: contains the same case as {self.files[case]}")
                self.files[case] = path
            self.first = self.first or dataset.attrs | shared
            for key, value in shared.items():
                if _compared(value) != _compared(self.first[key]):
                    other = next(iter(self.files.values()))
                    raise CaseFileError(f"{path}: {key} differs from {other}")
            self.warnings = merged_warnings([{"warnings": self.warnings}, dataset.attrs])
            yield _along_case(dataset, len(cases)) if is_sweep else dataset


def _on_grid(whole: xr.Dataset, cases: Sequence[Case], grid: Grid) -> xr.Dataset:
    """A dataset along cases as one over the axes of their grid."""
    numbers = {case: number for number, case in enumerate(cases)}
    order = np.array([numbers[case] for case in grid.cases().values()])
    coords = axis_coordinates(grid)
    lengths = {name: len(values) for name, (_, values, _) in coords.items()}
    return reshaped(whole.isel(case=order), "case", lengths).assign_coords(coords)


_AT_ONCE = 500
"""Cases held as single datasets; each takes a hundred times the memory of its numbers."""


def _along_cases(datasets: Iterable[xr.Dataset]) -> xr.Dataset:
    """Values kept of cases and sweeps, along the dimension `case`."""
    parts: list[xr.Dataset] = []
    left = iter(datasets)
    while some := list(itertools.islice(left, _AT_ONCE)):
        kept = [one if "case" in one.dims else _numbers_of_solved(one) for one in some]
        parts.append(_joined(kept))
    if not parts:
        raise CaseFileError("got no case files, expected at least one")
    return _joined(parts) if len(parts) > 1 else parts[0]


def _joined(datasets: Sequence[xr.Dataset]) -> xr.Dataset:
    count = sum(dataset.sizes.get("case", 1) for dataset in datasets)
    return stacked(datasets, {"case": count}, leave_out=ONLY_IN_CASES, along="case")


def _grid_of(files: Mapping[Case, Path]) -> Grid:
    """The grid that cases fill, each once."""
    some = next(iter(files.values()))
    try:
        grid = Grid.from_lists(
            {case.preload_method for case in files},
            {case.friction for case in files},
            {case.ball_diameter_loss_um for case in files},
        )
    except ValueError as error:
        raise CaseFileError(f"{some.parent}: {error}") from None
    for case_id, case in grid.cases().items():
        if case not in files:
            raise CaseFileError(f"{some.with_stem(case_id)}: missing")
    return grid


def _identity(dataset: xr.Dataset, path: Path) -> tuple[list[Case], dict[str, Any]]:
    """Which cases a file holds, and what it must share with the others."""
    try:
        scene = json.loads(dataset.attrs["scene"])
        case = _case_of(scene)
        int(dataset["status"])
        shared = {key: dataset.attrs[key] for key in _SHARED_ATTRS}
    except (KeyError, TypeError, ValueError):
        problem = "got a file of another kind, expected a case of a study"
        raise CaseFileError(f"{path}: {problem}") from None
    return [case], {"scene": json.dumps(scene)} | shared


def _identity_of_sweep(dataset: xr.Dataset, path: Path) -> tuple[list[Case], dict[str, Any]]:
    """Which cases a sweep over axes of a grid holds, and what it must share with other files."""
    keys = json.loads(dataset.attrs.get("changed_keys", "{}"))
    of_grid = set(keys.values()) <= {*GRID_KEYS.values()} and {*keys} == {*dataset["status"].dims}
    if not of_grid or "end_criterion" in dataset:
        problem = f"got another sweep, expected one of solves over {', '.join(GRID_KEYS.values())}"
        raise CaseFileError(f"{path}: {problem}")
    scene = json.loads(dataset.attrs["scene"])
    own = vars(_case_of(scene))
    names = dict(zip(GRID_KEYS.values(), own, strict=True))
    columns = [dataset[dim].values.tolist() for dim in keys]
    cases = []
    for values in itertools.product(*columns):
        found = own | {names[key]: value for key, value in zip(keys.values(), values, strict=True)}
        if not isinstance(found["preload_method"], str):
            found["preload_method"] = PRELOAD_METHODS[int(found["preload_method"])]
        cases.append(Case(**found))
    shared = {key: dataset.attrs[key] for key in _SHARED_ATTRS}
    return cases, {"scene": json.dumps(scene)} | shared


def _case_of(scene: dict[str, Any]) -> Case:
    """The case that a scene stands for, whose values are taken out of it."""
    return Case(
        scene["operation"].pop("preload_method"),
        float(scene["friction"].pop("ball_race")),
        float(scene["wear"].pop("ball_diameter_loss_um")),
    )


def _along_case(sweep: xr.Dataset, count: int) -> xr.Dataset:
    """A sweep with its cases along one dimension, without numbers of those not solved."""
    axes = len(json.loads(sweep.attrs["changed_keys"]))
    solved = sweep["status"].values.ravel() == OK
    variables = {}
    for name, one in sweep.data_vars.items():
        values = one.values.reshape((count, *one.shape[axes:]))
        if not solved.all() and "flag_values" not in one.attrs:
            values = np.where(solved.reshape((count,) + (1,) * (values.ndim - 1)), values, np.nan)
        variables[name] = (("case", *one.dims[axes:]), values, one.attrs)
    outer = {*sweep["status"].dims}
    coords = {name: one for name, one in sweep.coords.items() if not outer & {*one.dims}}
    return xr.Dataset(variables, coords, sweep.attrs)


def _compared(value: Any) -> Any:
    """What cases must share: what of their scene decides but, of a pair, its kind.

    The preload method decides the kind.
    """
    if not isinstance(value, str) or not value.startswith("{"):
        return value
    scene = decisive_data(json.loads(value))
    if is_pair(scene):
        scene["arrangement"] |= {"kind": "pair", "spring_stiffness_N_um": None}
    return scene


def _numbers_of_solved(dataset: xr.Dataset) -> xr.Dataset:
    """The dataset, its numbers (not its flags) gone if it was not solved."""
    if int(dataset["status"]) == OK:
        return dataset
    return dataset.map(
        lambda v: v if "flag_values" in v.attrs else xr.full_like(v, np.nan, dtype=float),
        keep_attrs=True,
    )


def axis_coordinates(grid: Grid) -> dict[str, tuple[str, np.ndarray, dict[str, Any]]]:
    """Coordinates of a grid's axes.

    CF wants numbers along a dimension, so the preload methods are flags.
    """
    methods = [PRELOAD_METHODS.index(method) for method in grid.preload_method]
    axes = _axis_variables(methods, grid.friction, grid.ball_diameter_loss_um)
    return {name: (name, values, about) for name, (values, about) in axes.items()}


def _axis_variables(
    methods: Sequence[int], friction: Sequence[float], loss_um: Sequence[float]
) -> dict[str, tuple[np.ndarray, dict[str, Any]]]:
    """Values along the axes of a study, and their attributes."""
    columns = zip(STUDY_COORDINATES.values(), (methods, friction, loss_um), strict=True)
    return {one.name: (stored_data(one, values), one.attributes) for one, values in columns}
