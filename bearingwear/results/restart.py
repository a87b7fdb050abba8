"""The state at the end of a dynamic case, from which another run continues."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.provenance import source_hash
from bearingwear.results.netcdf import CaseFileError, opened
from bearingwear.scene.accuracy import REGULARISATION
from bearingwear.scene.checking.errors import leaves
from bearingwear.scene.scene import Scene

MAY_DIFFER = ("description", "wear", "uncertainty", "calibrated", "model", REGULARISATION)
"""What a continued run may change in its scene; the rest decides the state."""


def restart_from(path: str | os.PathLike[str], scene: Scene | None = None) -> dict[str, Any]:
    """State from which a run continues.

    scene: the scene to continue; it may differ from the file's only in `MAY_DIFFER`.

    Returns: `state` (m,) in SI units, `time` [s], `scene` as plain data.
    CaseFileError: one line: no such case, not solved, of another version of the solver, of
    another scene.
    """
    name = os.fspath(path)
    with opened(path) as file:
        fidelity = str(getattr(file, "fidelity", "none"))
        if fidelity != "dynamic" or "contact_load" not in file.variables:
            raise CaseFileError(
                f"{name}: got a file with fidelity {fidelity}, expected a dynamic case"
            )
        status = int(file["status"][...])
        if status != OK:
            raise CaseFileError(
                f"{name}: got a case with status {STATUS_NAMES[status]}, expected status ok"
            )
        if file.source_hash != source_hash():
            raise CaseFileError(
                f"{name}: got a case solved with another version of the solver, "
                f"{file.source_hash}, expected this version, {source_hash()}"
            )
        state = _numbers(file["final_state"])
        time = float(_numbers(file["final_time"]))
        before = json.loads(file.scene)
    if not np.isfinite(state).all() or not np.isfinite(time):
        raise CaseFileError(
            f"{name}: got a case without a final state, expected one with a final state"
        )
    if scene is not None:
        _same_scene(name, before, scene.to_dict())
    return {"state": state, "time": time, "scene": before}


def _numbers(variable: Any) -> np.ndarray:
    """Values of a variable, NaN where there is none."""
    return np.ma.filled(np.ma.asarray(variable[...], dtype=float), np.nan)


def _same_scene(name: str, before: Mapping[str, Any], now: Mapping[str, Any]) -> None:
    """Refuse a case whose scene differs in a key that decides the state."""
    one, other = (
        leaves({key: part for key, part in scene.items() if key not in MAY_DIFFER})
        for scene in (before, now)
    )
    for key in [*other, *one]:
        if one.get(key) != other.get(key) and key not in MAY_DIFFER:
            raise CaseFileError(
                f"{name}: {key}: got a case with {_shown(one.get(key))}, expected the value in "
                f"the scene, {_shown(other.get(key))} (only wear, model and {REGULARISATION} may "
                "differ)"
            )


def _shown(value: Any) -> str:
    return "nothing" if value is None else json.dumps(value)
