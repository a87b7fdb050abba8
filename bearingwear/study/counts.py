"""Counts how the scenes of the study of the extremes ended."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.io.netcdf import CaseFileError, load
from bearingwear.kernels.status import NOT_CONVERGED, OK, STATUS_NAMES, UNVERIFIED

NO_BEARING = -1  # status of a draw that is refused before any solve


def counted(paths: Iterable[str | Path]) -> xr.Dataset:
    """Ends of all scenes by file.

    Parameters
    ----------
    paths : iterable of path
        Files of `bearingwear extremes`, families and maps.

    Returns
    -------
    Dataset
        Over `set` and `end` (a status each): count; over `set`: name, kind, trials, no_bearing,
        verified, several (of these with more than one steady state found) and largest_other_qv (by
        what share QV differs among them at most), refused (with a physical reason), unnamed (ended
        without one), wrong (verified by the solver and yet not right, or crashed) and the first of
        what was wrong.

    Raises
    ------
    CaseFileError
        A file of another kind.
    """
    rows: list[dict] = []
    shared: dict = {}
    for path in map(Path, paths):
        dataset = load(path)
        if dataset.attrs.get("kind") not in ("families", "maps"):
            raise CaseFileError(f"{path}: no random scenes and no map of the extremes")
        kept = ("Conventions", "source", "source_hash", "package_version", "numpy_version")
        shared = {key: dataset.attrs[key] for key in kept if key in dataset.attrs}
        status = dataset["status"].values.ravel()
        said = dataset["wrong"].values.ravel().astype(str)
        crashed = np.char.startswith(said, "crashed")
        solved = (status != NO_BEARING) | crashed
        wrong = crashed | ((status == OK) & (said != ""))
        unnamed = np.isin(status, (NOT_CONVERGED, UNVERIFIED))
        verified = (status == OK) & ~wrong
        states, other_qv = (
            dataset[key].values if key in dataset else np.zeros(1) for key in ("states", "other_qv")
        )
        count = [int((status == code).sum()) for code in range(len(STATUS_NAMES))]
        rows.append(
            {
                "name": dataset.attrs["name"],
                "kind": dataset.attrs["kind"],
                "trials": int(solved.sum()),
                "no_bearing": int((~solved).sum()),
                "verified": int(verified.sum()),
                "several": int((states > 1).sum()),
                "largest_other_qv": float(other_qv.max()),
                "refused": int((solved & ~verified & ~unnamed & ~wrong).sum()),
                "unnamed": int(unnamed.sum()),
                "wrong": int(wrong.sum()),
                "first_wrong": str(said[wrong][0]) if wrong.any() else "",
                "count": count,
            }
        )
    variables = {}
    for key in rows[0]:
        column = [row[key] for row in rows]
        dims = ("set", "end") if key == "count" else ("set",)
        text = isinstance(column[0], str)
        variables[key] = (dims, np.array(column, dtype=object) if text else np.array(column))
    return xr.Dataset(
        variables,
        attrs=shared | {"title": "How scenes of the extremes end", "ends": " ".join(STATUS_NAMES)},
    )
