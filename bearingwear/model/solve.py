"""Solve one scene: from a `Scene` to a `Result`."""

import json
import time
from collections.abc import Callable, Mapping
from typing import Any

from bearingwear.kernels import status as code
from bearingwear.model.cautions import warnings_of
from bearingwear.model.fidelity import Choice, NotAvailable, choice
from bearingwear.model.growth_told import growth_values
from bearingwear.model.heat import network_values, warmed_for
from bearingwear.model.interrupt import Interrupt
from bearingwear.model.race_control import solve_race_control
from bearingwear.model.result import Result
from bearingwear.model.steady import solve_steady
from bearingwear.scene.scene import Scene

Progress = Callable[[str], None]


def solve(
    scene: Scene,
    fidelity: str | None = None,
    restart: Mapping[str, Any] | None = None,
    progress: Progress | None = None,
) -> Result:
    """Solve a scene with the model it needs.

    Parameters
    ----------
    scene : Scene
    fidelity : str, optional
        Overrides `model.fidelity` of the scene.
    restart : mapping, optional
        `state` and `time` [s] at the end of another run to go on from; dynamic only.
    progress : callable, optional
        Given one line of text every few seconds; dynamic only, others are done by then.

    Returns
    -------
    Result
        `values["status"]` says whether the numbers may be used.

    Raises
    ------
    NotAvailable
        Where the fidelity asked for cannot solve this scene, or does not go on from a state.
    """
    chosen = choice(scene, fidelity)
    if restart is not None:
        check_restart(scene, chosen)
    started = time.perf_counter()
    with Interrupt():
        values, attrs = solved(chosen.reduced(scene), chosen.tier, restart, progress)
    elapsed = time.perf_counter() - started
    return Result(values, attrs | provenance(scene, chosen, values), elapsed)


def solved(
    scene: Scene, tier: str, restart: Mapping[str, Any] | None, progress: Progress | None
) -> tuple[dict, dict]:
    """Values and attributes of a scene solved with the model of that tier."""
    if scene.pair is not None:
        from bearingwear.model.pair_case import solve_pair

        alike = solved(scene.sides[0], tier, None, None) if scene.pair.is_symmetric else None
        return solve_pair(scene, tier, alike)
    if scene.thermal is None:
        values, attrs = solved_as_given(scene, tier, restart, progress)
        return values | growth_values(scene), attrs
    found, heat = warmed_for(scene, tier)
    if found.status != code.OK:
        return {"status": found.status} | growth_values(found.scene), {"residual": found.sentence}
    if tier == "steady":  # the state whose heat it is, where there are others nearby
        values, attrs = solve_steady(found.scene, heat.problem, heat.case)
    else:
        values, attrs = solved_as_given(found.scene, tier, restart, progress)
    if "friction_heat" in values:
        values |= network_values(scene, found, values, tier)
    return values | growth_values(found.scene), attrs


def solved_as_given(
    scene: Scene, tier: str, restart: Mapping[str, Any] | None, progress: Progress | None
) -> tuple[dict, dict]:
    """The same, no temperatures left to find."""
    if tier == "dynamic":
        # its kernels take long to load, and the others do without
        from bearingwear.model.dynamic_run import solve_dynamic

        return solve_dynamic(scene, restart=restart, progress=progress)
    return solve_steady(scene) if tier == "steady" else solve_race_control(scene)


def check_restart(scene: Scene, chosen: Choice) -> None:
    """Refuse a state to go on from where nothing moves in time.

    Raises
    ------
    NotAvailable
    """
    if chosen.tier != "dynamic":
        raise NotAvailable(
            f"{scene.name}: restart: got a scene solved with {chosen.tier}, expected one "
            "solved with fidelity dynamic"
        )


def provenance(scene: Scene, chosen: Choice, values: Mapping[str, Any]) -> dict[str, str]:
    """Global attributes that any result of a scene carries."""
    return {
        "scene": json.dumps(scene.to_dict()),
        "fidelity": chosen.tier,
        "modelled": json.dumps(list(chosen.reasons)),
        "warnings": json.dumps(warnings_of(scene, chosen, values)),
    }
