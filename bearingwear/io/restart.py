"""The state at the end of a dynamic case, to go on from."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from bearingwear.io.keys import leaves
from bearingwear.io.netcdf import SOURCE, CaseFileError, foreign, readable
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.model.accuracy import REGULARISATION
from bearingwear.model.scene import Scene
from bearingwear.provenance import source_hash

MAY_DIFFER = ("description", "wear", "model", REGULARISATION)
"""What of a scene a run may change when it goes on from another; the rest decides the state."""


def restart_from(path: str | os.PathLike[str], scene: Scene | None = None) -> dict[str, Any]:
    """What a run goes on from.

    Parameters
    ----------
    path : path
        A case file of `fidelity: dynamic`, solved.
    scene : Scene, optional
        The scene that shall go on; it may differ from the file's in wear and model alone.

    Returns
    -------
    dict
        `state` (m,) in SI units, `time` [s], `scene` as plain data.

    Raises
    ------
    CaseFileError
        One line: no such case, not solved, of another version of the solver, of another scene.
    """
    import netCDF4

    readable(path)
    name = os.fspath(path)
    try:
        with netCDF4.Dataset(path) as file:
            if not str(getattr(file, "source", "")).startswith(SOURCE):
                raise foreign(path)
            fidelity = str(getattr(file, "fidelity", "none"))
            if fidelity != "dynamic" or "contact_load" not in file.variables:
                raise CaseFileError(
                    f"{name}: given a file of fidelity {fidelity}; allowed a dynamic case"
                )
            status = int(file["status"][...])
            if status != OK:
                raise CaseFileError(
                    f"{name}: given a case with status {STATUS_NAMES[status]}; allowed status ok"
                )
            if file.source_hash != source_hash():
                raise CaseFileError(
                    f"{name}: given a case of another version of the solver, {file.source_hash}; "
                    f"allowed one of this version, {source_hash()}"
                )
            state: np.ndarray = np.ma.filled(
                np.ma.asarray(file["final_state"][...], dtype=float), np.nan
            )
            time = float(np.ma.filled(np.ma.asarray(file["final_time"][...], dtype=float), np.nan))
            before = json.loads(file.scene)
    except (OSError, RuntimeError, IndexError, KeyError, AttributeError, ValueError) as error:
        if isinstance(error, CaseFileError):
            raise
        reason = " ".join(str(error).split())
        raise CaseFileError(
            f"{name}: given a damaged file ({reason}); allowed a dynamic case"
        ) from None
    if not np.isfinite(state).all() or not np.isfinite(time):
        raise CaseFileError(f"{name}: given a case without its last state; allowed one with it")
    if scene is not None:
        _same_scene(name, before, scene.to_dict())
    return {"state": state, "time": time, "scene": before}


def _same_scene(name: str, before: Mapping[str, Any], now: Mapping[str, Any]) -> None:
    """Refuse a case of a scene that differs in what decides the state."""
    one, other = (
        leaves({key: part for key, part in scene.items() if key not in MAY_DIFFER})
        for scene in (before, now)
    )
    for key in [*other, *one]:
        if one.get(key) != other.get(key) and key not in MAY_DIFFER:
            raise CaseFileError(
                f"{name}: {key}: given a case with {_shown(one.get(key))}; allowed that of the "
                f"scene, {_shown(other.get(key))} (only wear, model and {REGULARISATION} may "
                "differ)"
            )


def _shown(value: Any) -> str:
    return "nothing" if value is None else json.dumps(value)
