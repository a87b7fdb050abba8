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
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.results.pair_variables import is_pair
from bearingwear.results.variables import STUDY_COORDINATES
from bearingwear.results.warnings import gathered_warnings
from bearingwear.scene.decisive import decisive_data
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.axis import GRID_KEYS
from bearingwear.studies.dataset import stacked
from bearingwear.studies.grid.grid import Case, Grid

# Left to the case files: profiles, histories, states to restart from, lists whose length differs
# from case to case, and the worn diameter, which is an axis here.
_LEFT_OUT = (
    "strip", "steady_state", "time", "state", "final_time", "ball_diameter_loss",
)  # fmt: skip

# The same in every case of a study, or the cases do not belong together.
_SHARED_ATTRS = ("fidelity", "source_hash", "package_version", "numpy_version", "numba_version")


def study(paths: Iterable[str | Path]) -> xr.Dataset:
    """Gather the cases of one scene.

    paths: case files, or chunks of many cases: every point of a grid once. The grid is what the
        files say it is.

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
            cases, shared = _identity(dataset, path)
            if "case" not in dataset.dims and path.stem != cases[0].id:
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
            self.warnings = gathered_warnings([{"warnings": self.warnings}, dataset.attrs])
            yield dataset


def _on_grid(whole: xr.Dataset, cases: Sequence[Case], grid: Grid) -> xr.Dataset:
    """A dataset along cases as one over the axes of their grid."""
    numbers = {case: number for number, case in enumerate(cases)}
    order = np.array([numbers[case] for case in grid.cases().values()])
    coords = axis_coordinates(grid)
    lengths = {name: len(values) for name, (_, values, _) in coords.items()}
    shaped = {
        name: (
            (*lengths, *array.dims[1:]),
            array.values[order].reshape((*lengths.values(), *array.shape[1:])),
            array.attrs,
        )
        for name, array in whole.data_vars.items()
    }
    return xr.Dataset(shaped, whole.coords).assign_coords(coords)


def chunk(cases: Sequence[Case], datasets: Iterable[xr.Dataset]) -> xr.Dataset:
    """Cases of one scene along the dimension `case`, with their places on the axes of the study.

    datasets: what the case files would hold, in the same order.
    """
    attributes: dict[str, Any] = {}
    warnings = "[]"

    def read() -> Iterator[xr.Dataset]:
        nonlocal warnings
        for dataset in datasets:
            warnings = gathered_warnings([{"warnings": warnings}, dataset.attrs])
            attributes.update(attributes or dataset.attrs | _identity(dataset, Path("chunk"))[1])
            yield dataset

    whole = _along_cases(read())
    axes = ([PRELOAD_METHODS.index(case.preload_method) for case in cases],
            [case.friction for case in cases],
            [case.ball_diameter_loss_um for case in cases])  # fmt: skip
    named = _axis_variables(*axes)
    coords = {name: ("case", values, about) for name, (values, about) in named.items()}
    for key in ("wall_time_s", "modelled", "residual"):
        attributes.pop(key, None)
    title = f"{len(cases)} cases of {json.loads(attributes['scene'])['name']}"
    more = {"title": title, "warnings": warnings}
    return whole.assign_coords(coords).assign_attrs(attributes | more)


_AT_ONCE = 500
"""Cases held as single datasets; each takes a hundred times the memory of its numbers."""


def _along_cases(datasets: Iterable[xr.Dataset]) -> xr.Dataset:
    """Values kept of cases and chunks, along the dimension `case`."""
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
    return stacked(datasets, {"case": count}, leave_out=_LEFT_OUT, along="case")


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
        if "case" in dataset.dims:
            cases = [
                Case(PRELOAD_METHODS[int(method)], float(friction), float(loss))
                for method, friction, loss in zip(
                    *(dataset[name].values for name in GRID_KEYS), strict=True
                )
            ]
        else:
            cases = [
                Case(
                    scene["operation"].pop("preload_method"),
                    float(scene["friction"].pop("ball_race")),
                    float(scene["wear"].pop("ball_diameter_loss_um")),
                )
            ]
            int(dataset["status"])
        shared = {key: dataset.attrs[key] for key in _SHARED_ATTRS}
    except (KeyError, TypeError, ValueError):
        problem = "got a file of another kind, expected a case of a study"
        raise CaseFileError(f"{path}: {problem}") from None
    return cases, {"scene": json.dumps(scene)} | shared


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
