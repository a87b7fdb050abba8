"""Gathers the trade study into one dataset: what each setting costs in time and in accuracy."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.io.netcdf import CaseFileError, load
from bearingwear.kernels.status import OK
from bearingwear.study.sweeps import FIRST

QUANTITIES = (
    "total_qv", "qv_inner", "qv_outer", "residual_preload", "wear_rate", "cage_wear_rate", "life",
)  # fmt: skip
"""What has an error, as `bearingwear.study.trial` names it."""

_SHARED = ("source_hash", "package_version", "numpy_version", "numba_version")


def gathered(paths: Iterable[str | Path]) -> xr.Dataset:
    """Every point of every sweep on every scene, with its errors.

    Parameters
    ----------
    paths : iterable of path
        Files of `bearingwear.study.trial.sweep`, references among them.

    Returns
    -------
    Dataset
        Over `point`: scene, sweep, kind, against, label, value, settings; times; the quantities;
        `error_*`, relative to the reference and signed, NaN where a quantity was not solved;
        `error_contact_qv`, the larger of both contacts without its sign; `reference_time`.

    Raises
    ------
    CaseFileError
        One line: a file that is no such file, of other sources, or whose reference is missing.
    """
    found: dict[tuple[str, str], xr.Dataset] = {}
    shared: dict[str, Any] = {}
    for path in map(Path, paths):
        dataset = load(path)
        attrs = dataset.attrs
        if not {"trade_scene", "trade_sweep", "kind", "against"} <= set(attrs):
            raise CaseFileError(f"{path}: not a file of the trade study")
        of = {key: attrs.get(key) for key in _SHARED}
        shared = shared or of
        for key, value in of.items():
            if value != shared[key]:
                raise CaseFileError(f"{path}: {key} is not that of the files before it")
        found[attrs["trade_scene"], attrs["trade_sweep"]] = dataset
    if not found:
        raise CaseFileError("no files of the trade study given")
    parts = []
    for (scene, sweep), dataset in found.items():
        against = dataset.attrs["against"]
        reference = dataset if against == FIRST else found.get((scene, against))
        if reference is None:
            raise CaseFileError(f"{scene}, {sweep}: its reference {against} is missing")
        part = with_errors(dataset, reference.isel(point=0))
        names = {"scene": scene, "sweep": sweep, "against": against}
        names |= {key: dataset.attrs[key] for key in ("kind", "sweep_title")}
        size = dataset.sizes["point"]
        for key, text in names.items():
            part[key] = ("point", np.full(size, text, dtype=object))
        parts.append(part.drop_attrs(deep=False))
    attrs = next(iter(found.values())).attrs
    return xr.concat(parts, "point").assign_attrs(
        {key: attrs[key] for key in ("Conventions", "source", *_SHARED) if key in attrs}
        | {
            "title": "Accuracy against time",
            "history": "gathered by bearingwear gather-tradeoff",
            "comment": "Errors are relative to the reference of each scene, signed. "
            "Wall times differ from run to run.",
        }
    )


def with_errors(points: xr.Dataset, reference: xr.Dataset) -> xr.Dataset:
    """Points and their errors against one point."""
    out = points.copy()
    solved = points["status"] == OK
    for name in QUANTITIES:
        right = float(reference[name]) if int(reference["status"]) == OK else np.nan
        error = (points[name] / right - 1.0 if right else points[name] * np.nan).where(solved)
        out[f"error_{name}"] = error.assign_attrs(
            long_name=f"error of {points[name].attrs.get('long_name', name)}", units="1"
        )
    both = [abs(out[f"error_qv_{race}"]) for race in ("inner", "outer")]
    out["error_contact_qv"] = xr.concat(both, "race").max("race", skipna=False)
    out["error_contact_qv"].attrs = {
        "long_name": "error of the QV of a contact, the larger of both, without sign",
        "units": "1",
    }
    out["reference_time"] = xr.full_like(points["wall_time"], float(reference["wall_time"]))
    out["reference_time"].attrs = {"long_name": "wall time of the reference", "units": "s"}
    return out


def pareto(time: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Which points no other beats in both time and error (n,); those with a NaN do not count."""
    front = np.zeros(len(time), dtype=bool)
    least = np.inf
    usable = np.isfinite(time) & np.isfinite(error)
    for k in np.lexsort((error, time)):
        if usable[k] and error[k] < least:
            least = error[k]
            front[k] = True
    return front
