"""Solve one scene: from a `Scene` to a `Result`."""

import json
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from bearingwear.kernels import status as code
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.growth import growth_values
from bearingwear.solvers.bearing_states import margin_values
from bearingwear.solvers.compose import solver_of
from bearingwear.solvers.condition import Accuracy, CaseValues
from bearingwear.solvers.effects.choice import Choice, choice
from bearingwear.solvers.effects.warnings import warnings_of
from bearingwear.solvers.result import Result, not_finite
from bearingwear.solvers.warm import network_values, warm_scene
from kerneljit.interrupt import Interrupt

Progress = Callable[[str], None]


def solve(
    scene: Scene,
    fidelity: str | None = None,
    restart: Mapping[str, Any] | None = None,
    progress: Progress | None = None,
) -> Result:
    """Solve a scene with the model it needs, or with that of `fidelity`.

    A dynamic solve may go on from the `state` and `time` [s] at the end of another run, and gives
    `progress` one line of text every few seconds. Raises NotAvailable as `choice`, or where the
    model cannot continue from a state.
    """
    chosen = choice(scene, fidelity)
    if restart is not None:
        check_restart(scene, chosen)
    started = time.perf_counter()
    with Interrupt():
        values, attrs = solved(chosen.reduced(scene), chosen.fidelity, restart, progress)
    elapsed = time.perf_counter() - started
    return result_of(scene, chosen, values, attrs, elapsed)


def solved(
    scene: Scene, fidelity: str, restart: Mapping[str, Any] | None, progress: Progress | None
) -> CaseValues:
    """Values and attributes of a scene solved with the model of that fidelity."""
    if fidelity != "dynamic":
        bearings = solver_of(scene, fidelity, Accuracy.CHECKED).bearings
        values, attrs = bearings.case()
        if values["status"] == code.OK and bearings.sides[0].scene.thermal is not None:
            # from the case's own state, which the solve begins with
            state = bearings.solve(bearings.start)
            values |= margin_values(bearings, bearings.start, state)
        return values, attrs
    # its kernels take long to load, and the other models need none of them
    from bearingwear.solvers.dynamic.run import solve_dynamic

    found = warm_scene(scene)
    if found.status != code.OK:
        return {"status": found.status} | growth_values(found.scene), {"residual": found.sentence}
    values, attrs = solve_dynamic(found.scene, restart=restart, progress=progress)
    if "friction_heat" in values:
        values |= network_values(scene, found, values["status"], found.heat)
    return values | growth_values(found.scene), attrs


def check_restart(scene: Scene, chosen: Choice) -> None:
    if chosen.fidelity != "dynamic":
        raise NotAvailable(
            f"{scene.name}: restart: got a scene solved with fidelity {chosen.fidelity}, expected "
            "one solved with fidelity dynamic"
        )


def result_of(
    scene: Scene,
    chosen: Choice,
    values: dict[str, Any],
    attrs: Mapping[str, Any],
    elapsed: float,
    warnings: Sequence[Mapping[str, Any]] | None = None,
) -> Result:
    """A result with the scene, the model and its warnings; ok only if its numbers are finite.

    The warnings are those of the values unless they are given.
    """
    if values["status"] == code.OK and (names := not_finite(values, scene.plain)):
        values = values | {"status": code.UNVERIFIED}
        attrs = {**attrs, "residual": f"not finite: {', '.join(names)}"}
    provenance = {
        "scene": scene.json,
        "fidelity": chosen.fidelity,
        "modelled": json.dumps(list(chosen.reasons)),
        "warnings": json.dumps(
            warnings_of(scene, chosen, values) if warnings is None else warnings
        ),
    }
    result = Result(values, {**attrs, **provenance}, elapsed)
    result.scene = scene.plain  # or it would be read from the attribute
    return result
