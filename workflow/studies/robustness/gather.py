"""Counts the outcomes of random scenes and of points of maps."""

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
    """Step: returns the outcomes in files of random scenes and of maps; a file is a `set`.

    Returns over `set` and `end` (a status each): count; over `set`: name, kind, trials, no_bearing,
    verified, multiple_states (with more than one steady state), largest_qv_ratio (largest relative
    difference of QV among these), refused (with a physical reason), unexplained (without one),
    violations (verified by the solver but wrong, or crashed) and first_violation.

    paths: at least one.
    CaseFileError: a file of another kind.
    """
    rows: list[dict[str, Any]] = []
    shared: dict[str, Any] = {}
    for path in map(Path, paths):
        dataset = load_kind(path, *_KINDS)
        names = ("Conventions", "source", "source_hash", "package_version", "numpy_version")
        shared = {key: dataset.attrs[key] for key in names if key in dataset.attrs}
        rows.append(_outcomes(dataset))
    variables = {}
    for key in rows[0]:
        column = [row[key] for row in rows]
        dims = ("set", "end") if key == "count" else ("set",)
        dtype = object if isinstance(column[0], str) else None
        variables[key] = (dims, np.array(column, dtype=dtype))
    return xr.Dataset(
        variables,
        attrs=shared
        | {"title": "Outcomes of scenes in the robustness study", "ends": " ".join(STATUS_NAMES)},
    )


def _outcomes(dataset: xr.Dataset) -> dict[str, Any]:
    """Returns the variables of `counted_ends` for the dataset of a file, without `set`.

    `count` is a list with a number for each status.
    """
    status = dataset["status"].values.ravel()
    messages = dataset["violations"].values.ravel().astype(str)
    is_crash = np.char.startswith(messages, "crashed")
    is_bearing = (status != REFUSED) | is_crash
    is_wrong = is_crash | ((status == OK) & (messages != ""))
    is_unexplained = np.isin(status, WITHOUT_REASON)
    is_verified = (status == OK) & ~is_wrong
    # maps have neither of these: no point then counts as one with several states
    states = dataset["states"].values if "states" in dataset else np.zeros(1)
    qv_ratio = dataset["largest_qv_ratio"].values if "largest_qv_ratio" in dataset else np.zeros(1)
    return {
        "name": dataset.attrs["name"],
        "kind": dataset.attrs["kind"],
        "trials": int(is_bearing.sum()),
        "no_bearing": int((~is_bearing).sum()),
        "verified": int(is_verified.sum()),
        "multiple_states": int((states > 1).sum()),
        "largest_qv_ratio": float(qv_ratio.max()),
        "refused": int((is_bearing & ~is_verified & ~is_unexplained & ~is_wrong).sum()),
        "unexplained": int(is_unexplained.sum()),
        "violations": int(is_wrong.sum()),
        "first_violation": str(messages[is_wrong][0]) if is_wrong.any() else "",
        "count": [int((status == code).sum()) for code in range(len(STATUS_NAMES))],
    }
