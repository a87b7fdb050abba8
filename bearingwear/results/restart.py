"""Reads the state at the end of a dynamic case, from which another run continues."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.provenance import source_hash
from bearingwear.results.netcdf import CaseFileError, open_result
from bearingwear.scene.accuracy import REGULARISATION
from bearingwear.scene.checking.errors import leaves
from bearingwear.scene.scene import Scene

MAY_DIFFER = ("description", "wear", "uncertainty", "calibrated", "model", REGULARISATION)
"""Keys of the scene that a continued run may change; the others determine the state."""


def restart_from(path: str | os.PathLike[str], scene: Scene | None = None) -> dict[str, Any]:
    """Returns the state from which a run continues: `state` (m,) in SI units, `time` [s], `scene`.

    The entry `scene` is the scene of the file as plain data.

    scene: the scene to continue; it may differ from the file's only in `MAY_DIFFER`.

    CaseFileError: the file is no dynamic case, is not solved, or has no final state; or its solver
    or scene is another.
    """
    name = os.fspath(path)
    with open_result(path) as file:
        _check_can_continue(name, file)
        state = _numbers(file["final_state"])
        time = float(_numbers(file["final_time"]))
        earlier_scene = json.loads(file.scene)
    if not np.isfinite(state).all() or not np.isfinite(time):
        raise CaseFileError(
            f"{name}: got a case without a final state, expected one with a final state"
        )
    if scene is not None:
        _check_same_scene(name, earlier_scene, scene.plain)
    return {"state": state, "time": time, "scene": earlier_scene}


def _check_can_continue(name: str, file: Any) -> None:
    """Raises CaseFileError unless an open file is a dynamic case solved by this solver.

    name: of the file.
    """
    fidelity = str(getattr(file, "fidelity", "none"))
    if fidelity != "dynamic" or "contact_load" not in file.variables:
        raise CaseFileError(f"{name}: got a file with fidelity {fidelity}, expected a dynamic case")
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


def _numbers(variable: Any) -> np.ndarray:
    """Returns the values of a variable of an open file; NaN for missing values."""
    return np.ma.filled(np.ma.asarray(variable[...], dtype=float), np.nan)


def _check_same_scene(name: str, earlier: Mapping[str, Any], scene: Mapping[str, Any]) -> None:
    """Raises CaseFileError if two scenes differ in a key that determines the state.

    name: of the file with the earlier scene.
    """
    earlier_values, values = _decisive_values(earlier), _decisive_values(scene)
    for key in [*values, *earlier_values]:
        earlier_value, value = earlier_values.get(key), values.get(key)
        if earlier_value != value and key not in MAY_DIFFER:
            raise CaseFileError(
                f"{name}: {key}: got a case with {_value_text(earlier_value)}, expected the value "
                f"in the scene, {_value_text(value)} (only wear, model and {REGULARISATION} may "
                "differ)"
            )


def _decisive_values(scene: Mapping[str, Any]) -> Mapping[str, Any]:
    """Returns the values of a scene by dotted key, without blocks that may differ as a whole."""
    return leaves({key: block for key, block in scene.items() if key not in MAY_DIFFER})


def _value_text(value: Any) -> str:
    """Returns a value of a scene as text, `nothing` if it is missing."""
    return "nothing" if value is None else json.dumps(value)
