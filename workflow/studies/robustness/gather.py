"""Counts how the random scenes and points of maps ended."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.results.netcdf import load_kind
from bearingwear.studies.answers import REFUSED
from workflow.studies.robustness.plan import WITHOUT_REASON

_KINDS = ("scene_classes", "maps")


def counted_ends(paths: Iterable[str | Path]) -> xr.Dataset:
    """Ends of all scenes by file, of random scenes and of maps.

    Over `set` and `end` (a status each): count; over `set`: name, kind, trials, no_bearing,
    verified, multiple_states (of these with more than one steady state) and largest_qv_ratio (by
    what share QV differs among them at most), refused (with a physical reason), unexplained (ended
    without one), violations (verified by the solver and yet not right, or crashed) and the first
    of these. CaseFileError for a file of another kind.
    """
    rows: list[dict[str, Any]] = []
    shared: dict[str, Any] = {}
    for path in map(Path, paths):
        dataset = load_kind(path, *_KINDS)
        kept = ("Conventions", "source", "source_hash", "package_version", "numpy_version")
        shared = {key: dataset.attrs[key] for key in kept if key in dataset.attrs}
        rows.append(_row(dataset))
    variables = {}
    for key in rows[0]:
        column = [one[key] for one in rows]
        dims = ("set", "end") if key == "count" else ("set",)
        text = isinstance(column[0], str)
        variables[key] = (dims, np.array(column, dtype=object) if text else np.array(column))
    return xr.Dataset(
        variables,
        attrs=shared
        | {"title": "Outcomes of scenes in the robustness study", "ends": " ".join(STATUS_NAMES)},
    )


def _row(dataset: xr.Dataset) -> dict[str, Any]:
    """The numbers of one file."""
    status = dataset["status"].values.ravel()
    said = dataset["violations"].values.ravel().astype(str)
    crashed = np.char.startswith(said, "crashed")
    solved = (status != REFUSED) | crashed
    wrong = crashed | ((status == OK) & (said != ""))
    unexplained = np.isin(status, WITHOUT_REASON)
    verified = (status == OK) & ~wrong
    states, qv_ratio = (
        dataset[key].values if key in dataset else np.zeros(1)
        for key in ("states", "largest_qv_ratio")
    )
    return {
        "name": dataset.attrs["name"],
        "kind": dataset.attrs["kind"],
        "trials": int(solved.sum()),
        "no_bearing": int((~solved).sum()),
        "verified": int(verified.sum()),
        "multiple_states": int((states > 1).sum()),
        "largest_qv_ratio": float(qv_ratio.max()),
        "refused": int((solved & ~verified & ~unexplained & ~wrong).sum()),
        "unexplained": int(unexplained.sum()),
        "violations": int(wrong.sum()),
        "first_violation": str(said[wrong][0]) if wrong.any() else "",
        "count": [int((status == code).sum()) for code in range(len(STATUS_NAMES))],
    }
