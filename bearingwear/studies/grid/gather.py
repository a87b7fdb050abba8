"""Gathers the cases of a scene into one dataset over preload method, friction and wear."""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.dataset import attrs, flags, stacked
from bearingwear.studies.grid.grid import Case, Grid

# Left to the case files: profiles, histories, states to restart from, lists whose length differs
# from case to case, and the worn diameter, which is an axis here.
_LEFT_OUT = (
    "strip", "steady_state", "time", "state", "final_time", "ball_diameter_loss",
)  # fmt: skip

# The same in every case of a study, or the cases do not belong together.
_SHARED_ATTRS = ("fidelity", "source_hash", "package_version", "numpy_version", "numba_version")


def study(paths: Iterable[str | Path]) -> xr.Dataset:
    """Gather case files of one scene.

    Parameters
    ----------
    paths : iterable of path
        One file for each point of the grid; the grid is what the files say it is.

    Returns
    -------
    xarray.Dataset
        Dimensions `preload_method` (flags, in the order of `scene.PRELOAD_METHODS`), `friction`,
        `ball_diameter_loss` [um], then those of the case. Of a case whose status is not ok, the
        status and the other flags stay and every number is NaN.

    Raises
    ------
    CaseFileError
        One line naming the file that is missing, truncated, foreign, of another scene, of another
        version of the solver, or there twice; or the case that is missing.
    """
    cases: dict[Case, xr.Dataset] = {}
    files: dict[Case, Path] = {}
    common: dict[str, Any] = {}
    for path in map(Path, paths):
        dataset = load(path)
        case, shared = _identity(dataset, path)
        if case in cases:
            raise CaseFileError(f"{path}: holds the same case as {files[case]}")
        if path.stem != case.id:
            raise CaseFileError(f"{path}: holds the case {case.id}")
        common = common or shared
        for key, value in shared.items():
            if value != common[key]:
                raise CaseFileError(f"{path}: {key} is not that of {next(iter(files.values()))}")
        cases[case], files[case] = dataset, path
    if not cases:
        raise CaseFileError("no case files given")
    try:
        grid = Grid.from_lists(
            {case.preload_method for case in cases},
            {case.friction for case in cases},
            {case.ball_diameter_loss_um for case in cases},
        )
    except ValueError as error:
        raise CaseFileError(f"{next(iter(files.values())).parent}: {error}") from None
    for case_id, case in grid.cases().items():
        if case not in cases:
            raise CaseFileError(f"{next(iter(files.values())).with_stem(case_id)}: missing")
    ordered = [_numbers_of_solved(cases[case]) for case in grid.cases().values()]
    coords = axis_coordinates(grid)
    lengths = {name: len(values) for name, (_, values, _) in coords.items()}
    first = ordered[0].attrs
    return (
        stacked(ordered, lengths, leave_out=_LEFT_OUT)
        .assign_coords(coords)
        .assign_attrs(
            Conventions=first.get("Conventions", "CF-1.11"),
            title=f"Study of {json.loads(common['scene'])['name']}",
            source=first.get("source", "bearingwear"),
            references=first.get("references", ""),
            history="gathered from case files by bearingwear gather",
            comment="The scene is what all cases share; the axes give the rest. "
            "Numbers of a case whose status is not ok are missing.",
            **common,
        )
    )


def _identity(dataset: xr.Dataset, path: Path) -> tuple[Case, dict[str, Any]]:
    """Which case a file holds, and what it must share with the others."""
    try:
        scene = json.loads(dataset.attrs["scene"])
        case = Case(
            scene["operation"].pop("preload_method"),
            float(scene["friction"].pop("ball_race")),
            float(scene["wear"].pop("ball_diameter_loss_um")),
        )
        int(dataset["status"])
        shared = {key: dataset.attrs[key] for key in _SHARED_ATTRS}
    except (KeyError, TypeError, ValueError):
        raise CaseFileError(f"{path}: not a case of a study") from None
    return case, {"scene": json.dumps(scene)} | shared


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
    return {
        "preload_method": (
            "preload_method",
            np.array(methods, dtype=np.int8),
            flags("how the preload is applied", PRELOAD_METHODS),
        ),
        "friction": (
            "friction",
            np.array(grid.friction),
            attrs("ball/race friction coefficient", "1"),
        ),
        "ball_diameter_loss": (
            "ball_diameter_loss",
            np.array(grid.ball_diameter_loss_um),
            attrs("loss of ball diameter by wear", "um"),
        ),
    }
