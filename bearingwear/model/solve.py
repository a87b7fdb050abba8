"""Solve one scene: from a `Scene` to a `Result`."""

import json
import time

from bearingwear.model.fidelity import Choice, choice
from bearingwear.model.race_control import solve_race_control
from bearingwear.model.result import Result
from bearingwear.model.scene import Scene
from bearingwear.model.steady import solve_steady


def solve(scene: Scene, fidelity: str | None = None) -> Result:
    """Solve a scene with the model it needs.

    Parameters
    ----------
    scene : Scene
    fidelity : str, optional
        Overrides `model.fidelity` of the scene.

    Returns
    -------
    Result
        `values["status"]` says whether the numbers may be used.

    Raises
    ------
    NotAvailable
        Where the fidelity asked for cannot solve this scene.
    """
    chosen = choice(scene, fidelity)
    started = time.perf_counter()
    if chosen.tier == "steady":
        values, attrs = solve_steady(scene)
    else:
        values, attrs = solve_race_control(scene)
    elapsed = time.perf_counter() - started
    return Result(values, attrs | provenance(scene, chosen), elapsed)


def provenance(scene: Scene, chosen: Choice) -> dict[str, str]:
    """Global attributes that any result of a scene carries."""
    return {
        "scene": json.dumps(scene.to_dict()),
        "fidelity": chosen.tier,
        "modelled": json.dumps(list(chosen.reasons)),
    }
