"""Gathers the sweeps into one dataset of times and errors."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK
from bearingwear.results.netcdf import CaseFileError, load
from workflow.studies.accuracy.plan import FIRST
from workflow.studies.accuracy.quantities import QUANTITIES

_SHARED = ("source_hash", "package_version", "numpy_version", "numba_version")


def gathered_sweeps(paths: Iterable[str | Path]) -> xr.Dataset:
    """Step: returns every point of all sweeps and references on all scenes.

    Returns over `point`: scene, sweep, kind, against, label, value, settings; times; the
    quantities; `error_*`, relative to the reference and signed, NaN where a quantity was not
    solved; `error_contact_qv`, the larger magnitude of both contacts; `reference_time`.

    CaseFileError: a file of another kind or of other sources, or without its reference.
    """
    sweep_datasets = _of_one_study(paths)
    parts = []
    for (scene, sweep), dataset in sweep_datasets.items():
        against = dataset.attrs["against"]
        reference = dataset if against == FIRST else sweep_datasets.get((scene, against))
        if reference is None:
            raise CaseFileError(f"{scene}, {sweep}: the reference {against} is missing")
        texts = {"scene": scene, "sweep": sweep, "against": against}
        texts |= {"kind": dataset.attrs["sweep_kind"], "sweep_title": dataset.attrs["sweep_title"]}
        text_variables = {
            key: ("point", np.full(dataset.sizes["point"], text, dtype=object))
            for key, text in texts.items()
        }
        error_variables = errors(dataset, reference.isel(point=0))
        part = dataset.assign(error_variables | text_variables)
        parts.append(part.drop_attrs(deep=False))
    attrs = next(iter(sweep_datasets.values())).attrs
    return xr.concat(parts, "point").assign_attrs(
        {key: attrs[key] for key in ("Conventions", "source", *_SHARED) if key in attrs}
        | {
            "title": "Accuracy against time",
            "history": "gathered by snakemake accuracy",
            "comment": "Errors are signed and relative to the reference solution of each scene. "
            "Wall times vary from run to run.",
        }
    )


def _of_one_study(paths: Iterable[str | Path]) -> dict[tuple[str, str], xr.Dataset]:
    """Returns the datasets of files by the names of scene and sweep.

    CaseFileError: a file of another kind or of other sources, or no file.
    """
    sweep_datasets: dict[tuple[str, str], xr.Dataset] = {}
    shared: dict[str, Any] = {}
    for path in map(Path, paths):
        dataset = load(path)
        attrs = dataset.attrs
        if not {"scene_name", "sweep_name", "sweep_kind", "against"} <= set(attrs):
            raise CaseFileError(
                f"{path}: got a file of another kind, expected a sweep of the accuracy study"
            )
        versions = {key: attrs.get(key) for key in _SHARED}
        shared = shared or versions
        for key, value in versions.items():
            if value != shared[key]:
                raise CaseFileError(f"{path}: {key} differs from its value in the previous files")
        sweep_datasets[attrs["scene_name"], attrs["sweep_name"]] = dataset
    if not sweep_datasets:
        raise CaseFileError("got no sweeps, expected those of the accuracy study")
    return sweep_datasets


def errors(points: xr.Dataset, reference: xr.Dataset) -> dict[str, tuple]:
    """Returns variables of the errors of points against a reference point, and of its wall time.

    An error is the value over that of the reference, less 1. It is NaN where either was not solved,
    or where the reference is 0. `error_contact_qv` is the larger magnitude of both contacts.

    points: of a sweep, over `point`.

    Returns tuples that `xr.Dataset.assign` takes, by name: dimension, values, attributes.
    """
    solved = points["status"].values == OK
    columns: dict[str, tuple[np.ndarray, str]] = {}
    for name in QUANTITIES:
        true_value = float(reference[name]) if int(reference["status"]) == OK else np.nan
        error = points[name].values / (true_value or np.nan) - 1.0
        quantity = points[name].attrs.get("long_name", name)
        columns[f"error_{name}"] = np.where(solved, error, np.nan), f"error in {quantity}"
    inner_error, _ = columns["error_qv_inner"]
    outer_error, _ = columns["error_qv_outer"]
    columns["error_contact_qv"] = (
        np.maximum(np.abs(inner_error), np.abs(outer_error)),
        "magnitude of the error in contact QV, larger of the two contacts",
    )
    time = np.full(solved.size, float(reference["wall_time"]))
    variables = {
        name: ("point", values, {"long_name": label, "units": "1"})
        for name, (values, label) in columns.items()
    }
    label = {"long_name": "wall time of the reference solution", "units": "s"}
    return variables | {"reference_time": ("point", time, label)}


def points_where(trade: xr.Dataset, **texts: str) -> xr.Dataset:
    """Returns the points whose text variables have certain values.

    trade: points of the study, over `point`.
    texts: values by the names of variables, such as `scene` and `sweep`.
    """
    mask = np.ones(trade.sizes["point"], dtype=bool)
    for name, text in texts.items():
        mask &= trade[name].values == text
    return trade.isel(point=mask)


def distinct_texts(trade: xr.Dataset, variable: str) -> list[str]:
    """Returns the different values of a text variable in the order of the file.

    trade: points of the study, over `point`.
    """
    return list(dict.fromkeys(trade[variable].values))


def finite_statistic(statistic: Callable[[np.ndarray], float], values: np.ndarray) -> float:
    """Returns a statistic, such as `np.median`, of the finite values; NaN if there are none."""
    finite_values = values[np.isfinite(values)]
    return float(statistic(finite_values)) if finite_values.size else np.nan
