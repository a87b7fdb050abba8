"""Gathers the cases of a scene into one dataset over preload method, friction and wear."""

import itertools
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK
from bearingwear.results.entries import stored_data
from bearingwear.results.kinds import ONLY_IN_CASES, SWEEP_KIND, kind_of
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.results.pair_variables import is_pair
from bearingwear.results.variables import STUDY_COORDINATES
from bearingwear.results.warnings import merged_warnings
from bearingwear.results.words import plain_scene
from bearingwear.scene.decisive import decisive_data
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.axis import GRID_KEYS
from bearingwear.studies.dataset import reshaped_dataset, stacked_dataset
from bearingwear.studies.grid.grid import Case, Grid

_SHARED_ATTRS = ("fidelity", "source_hash", "package_version", "numpy_version", "numba_version")
"""Attributes that must be the same in all cases of a study."""


def gathered_study(paths: Iterable[str | Path]) -> xr.Dataset:
    """Returns the cases of one scene over the axes of their grid.

    paths: case files, or sweeps over axes of the grid, which together contain every point of a
        grid once. The files determine the grid.

    Returns: dimensions `preload_method` (flags, in the order of `scene.PRELOAD_METHODS`),
        `friction`, `ball_diameter_loss` [um], then those of the case. A case whose status is not
        ok has its flags, and NaN for every number.

    CaseFileError: names the file that is missing, truncated, foreign, of another scene, of another
    version of the solver, or contained twice; or the case that is missing.
    """
    reader = _CaseReader()
    along_cases = _stacked_cases(reader.datasets(paths))
    first = reader.first
    grid = _complete_grid(reader.files)
    return _reshaped_to_grid(along_cases, list(reader.files), grid).assign_attrs(
        Conventions=first.get("Conventions", "CF-1.11"),
        title=f"Study of {json.loads(first['scene'])['name']}",
        source=first.get("source", "bearingwear"),
        references=first.get("references", ""),
        history="gathered from case files by bearingwear gather",
        comment="The scene contains the values common to all cases; the axes give the others. "
        "If the status of a case is not ok, its values are missing.",
        warnings=reader.warnings,
        **{key: first[key] for key in ("scene", *_SHARED_ATTRS)},
    )


@dataclass
class _CaseReader:
    """Reads files of cases, and checks that each belongs to the files before it."""

    files: dict[Case, Path] = field(default_factory=dict)  # the file of each case, as read
    # attributes of the first file; its `scene` has the values that all cases share
    first: dict[str, Any] = field(default_factory=dict)
    warnings: str = "[]"  # of all files, each id once

    def datasets(self, paths: Iterable[str | Path]) -> Iterator[xr.Dataset]:
        """Yields the dataset of each file: a case, or a sweep with its cases along `case`.

        CaseFileError: a file that does not belong to the others, or is no case or sweep.
        """
        for path in map(Path, paths):
            dataset = load(path)
            is_sweep = kind_of(dataset) == SWEEP_KIND
            content = _sweep_content(dataset, path) if is_sweep else _case_content(dataset, path)
            if not is_sweep and path.stem != content.cases[0].id:
                problem = f"got the case {content.cases[0].id}, expected it in a file of that name"
                raise CaseFileError(f"{path}: {problem}")
            for case in content.cases:
                if case in self.files:
                    raise CaseFileError(f"{path}: contains the same case as {self.files[case]}")
                self.files[case] = path
            if not self.first:
                self.first = dataset.attrs | content.shared
            self._check_shared(content.shared, path)
            self.warnings = merged_warnings([{"warnings": self.warnings}, dataset.attrs])
            yield _sweep_along_cases(dataset, len(content.cases)) if is_sweep else dataset

    def _check_shared(self, shared: Mapping[str, Any], path: Path) -> None:
        """Raises CaseFileError for a file whose shared attributes differ from the first file's."""
        for key, value in shared.items():
            if _comparable_attribute(value) != _comparable_attribute(self.first[key]):
                first_file = next(iter(self.files.values()))
                raise CaseFileError(f"{path}: {key} differs from {first_file}")


def _reshaped_to_grid(along_cases: xr.Dataset, cases: Sequence[Case], grid: Grid) -> xr.Dataset:
    """Returns a dataset over the axes of a grid, with their coordinates.

    along_cases: a dataset along the dimension `case`, in the order of `cases`.
    """
    index_of = {case: index for index, case in enumerate(cases)}
    order = np.array([index_of[case] for case in grid.cases().values()])
    coords = axis_coordinates(grid)
    lengths = {name: len(values) for name, (_, values, _) in coords.items()}
    return reshaped_dataset(along_cases.isel(case=order), "case", lengths).assign_coords(coords)


_BATCH = 500
"""Most cases in memory as single datasets; each takes a hundred times the memory of its numbers."""


def _stacked_cases(datasets: Iterable[xr.Dataset]) -> xr.Dataset:
    """Returns single cases and datasets along `case` as one dataset along `case`.

    Numbers of unsolved cases are NaN. Raises a CaseFileError for no dataset.
    """
    prepared = (
        dataset if "case" in dataset.dims else _without_unsolved_numbers(dataset)
        for dataset in datasets
    )
    stacked_batches: list[xr.Dataset] = []
    while batch := list(itertools.islice(prepared, _BATCH)):
        stacked_batches.append(_stacked_batch(batch))
    if not stacked_batches:
        raise CaseFileError("got no case files, expected at least one")
    if len(stacked_batches) == 1:
        return stacked_batches[0]
    return _stacked_batch(stacked_batches)


def _stacked_batch(datasets: Sequence[xr.Dataset]) -> xr.Dataset:
    """Returns cases, or datasets along `case`, as one dataset along `case`.

    Variables that only case files have are left out.
    """
    count = sum(dataset.sizes.get("case", 1) for dataset in datasets)
    return stacked_dataset(datasets, {"case": count}, leave_out=ONLY_IN_CASES, along="case")


def _complete_grid(files: Mapping[Case, Path]) -> Grid:
    """Returns the grid that cases fill. Raises a CaseFileError if one is missing.

    files: the file of each case.
    """
    first_file = next(iter(files.values()))
    try:
        grid = Grid.from_lists(
            {case.preload_method for case in files},
            {case.friction for case in files},
            {case.ball_diameter_loss_um for case in files},
        )
    except ValueError as error:
        raise CaseFileError(f"{first_file.parent}: {error}") from None
    for case_id, case in grid.cases().items():
        if case not in files:
            raise CaseFileError(f"{first_file.with_stem(case_id)}: missing")
    return grid


class _FileContent(NamedTuple):
    """The cases in a file, and the attributes that it must share with the other files."""

    cases: list[Case]
    shared: dict[str, Any]


def _case_content(dataset: xr.Dataset, path: Path) -> _FileContent:
    """Returns the case in a case file, and its shared attributes. Raises CaseFileError."""
    try:
        scene = plain_scene(dataset)
        case = _take_case(scene)
        int(dataset["status"])
        shared = {key: dataset.attrs[key] for key in _SHARED_ATTRS}
    except (KeyError, TypeError, ValueError):
        problem = "got a file of another kind, expected a case of a study"
        raise CaseFileError(f"{path}: {problem}") from None
    return _FileContent(cases=[case], shared={"scene": json.dumps(scene)} | shared)


def _sweep_content(dataset: xr.Dataset, path: Path) -> _FileContent:
    """Returns the cases in a sweep, in C order over its axes, and their shared attributes.

    A value of a case that is not on an axis is that of the scene.

    CaseFileError: a sweep of lives, or over other axes than those of a grid.
    """
    key_by_dim = json.loads(dataset.attrs.get("changed_keys", "{}"))
    has_grid_keys = set(key_by_dim.values()) <= set(GRID_KEYS.values())
    is_over_keys = set(key_by_dim) == set(dataset["status"].dims)
    if not has_grid_keys or not is_over_keys or "end_criterion" in dataset:
        problem = f"got another sweep, expected one of solves over {', '.join(GRID_KEYS.values())}"
        raise CaseFileError(f"{path}: {problem}")
    scene = plain_scene(dataset)
    base_values = vars(_take_case(scene))
    # the fields of a case are in the order of the keys
    field_by_key = dict(zip(GRID_KEYS.values(), base_values, strict=True))
    fields = [field_by_key[key] for key in key_by_dim.values()]
    cases = []
    for point in itertools.product(*(dataset[dim].values.tolist() for dim in key_by_dim)):
        values = base_values | dict(zip(fields, point, strict=True))
        if not isinstance(values["preload_method"], str):
            values["preload_method"] = PRELOAD_METHODS[int(values["preload_method"])]
        cases.append(Case(**values))
    shared = {key: dataset.attrs[key] for key in _SHARED_ATTRS}
    return _FileContent(cases=cases, shared={"scene": json.dumps(scene)} | shared)


def _take_case(scene: dict[str, Any]) -> Case:
    """Removes the values of a case from its scene (plain data), and returns the case."""
    return Case(
        preload_method=scene["operation"].pop("preload_method"),
        friction=float(scene["friction"].pop("ball_race")),
        ball_diameter_loss_um=float(scene["wear"].pop("ball_diameter_loss_um")),
    )


def _sweep_along_cases(sweep: xr.Dataset, count: int) -> xr.Dataset:
    """Returns a sweep with its cases along `case`, and NaN for the numbers of unsolved cases.

    The axes of the sweep are the leading dimensions of all its variables, and lose their values.

    count: number of cases.
    """
    axis_count = len(json.loads(sweep.attrs["changed_keys"]))
    is_solved = sweep["status"].values.ravel() == OK
    variables = {}
    for name, variable in sweep.data_vars.items():
        values = variable.values.reshape((count, *variable.shape[axis_count:]))
        if not is_solved.all() and "flag_values" not in variable.attrs:
            mask = is_solved.reshape((count,) + (1,) * (values.ndim - 1))
            values = np.where(mask, values, np.nan)
        variables[name] = (("case", *variable.dims[axis_count:]), values, variable.attrs)
    axis_dims = {*sweep["status"].dims}
    coords = {
        name: coordinate
        for name, coordinate in sweep.coords.items()
        if not axis_dims & {*coordinate.dims}
    }
    return xr.Dataset(variables, coords, sweep.attrs)


def _comparable_attribute(value: Any) -> Any:
    """Returns an attribute in the form in which all cases must have it.

    A scene, which is JSON, is reduced to its decisive keys. Kind and spring of a pair, which the
    preload method determines, do not count. Other attributes are returned unchanged.
    """
    if not isinstance(value, str) or not value.startswith("{"):
        return value
    scene = decisive_data(json.loads(value))
    if is_pair(scene):
        scene["arrangement"] |= {"kind": "pair", "spring_stiffness_N_um": None}
    return scene


def _without_unsolved_numbers(dataset: xr.Dataset) -> xr.Dataset:
    """Returns a case, with NaN for its numbers (not its flags) if it was not solved."""
    if int(dataset["status"]) == OK:
        return dataset

    def without_numbers(variable: xr.DataArray) -> xr.DataArray:
        """Returns a variable of flags unchanged, another one full of NaN."""
        if "flag_values" in variable.attrs:
            return variable
        return xr.full_like(variable, np.nan, dtype=float)

    return dataset.map(without_numbers, keep_attrs=True)


def axis_coordinates(grid: Grid) -> dict[str, tuple[str, np.ndarray, dict[str, Any]]]:
    """Returns dimension, values and attributes of the coordinate of each axis of a grid, by name.

    The preload methods are flags, because the CF conventions require numbers along a dimension.
    """
    methods = [PRELOAD_METHODS.index(method) for method in grid.preload_method]
    values_of_axes = (methods, grid.friction, grid.ball_diameter_loss_um)
    return {
        variable.name: (variable.name, stored_data(variable, values), variable.attributes)
        for variable, values in zip(STUDY_COORDINATES.values(), values_of_axes, strict=True)
    }
