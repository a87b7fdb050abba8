"""Solves a scene: makes a `Result` from a `Scene`."""

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
from bearingwear.solvers.warm import network_values, warmed_for_motion
from kerneljit.interrupt import Interrupt

Progress = Callable[[str], None]


def solve(
    scene: Scene,
    fidelity: str | None = None,
    restart: Mapping[str, Any] | None = None,
    progress: Progress | None = None,
) -> Result:
    """Solves a scene with the model it needs, or with that of `fidelity`; returns the result.

    A solve that fails has a result too: its status says why. Raises NotAvailable as `choice`, or if
    the model cannot continue from a state, and KeyboardInterrupt after Ctrl-C.

    restart: `state` and `time` [s] at the end of another run, from which a dynamic solve continues.
    progress: receives a line of text every few seconds of a dynamic solve.
    """
    chosen = choice(scene, fidelity)
    if restart is not None:
        check_restart(scene, chosen)
    started = time.perf_counter()
    with Interrupt():
        values, attrs = case_values(chosen.reduced(scene), chosen.fidelity, restart, progress)
    elapsed = time.perf_counter() - started
    return result_of(scene, chosen, values, attrs, elapsed)


def case_values(
    scene: Scene, fidelity: str, restart: Mapping[str, Any] | None, progress: Progress | None
) -> CaseValues:
    """Returns values and attributes of a scene solved with the model of a fidelity.

    restart, progress: of a dynamic solve, see `solve`.
    """
    if fidelity != "dynamic":
        bearings = solver_of(scene, fidelity, Accuracy.CHECKED).bearings
        values, attrs = bearings.case()
        if values["status"] == code.OK and bearings.sides[0].scene.thermal is not None:
            # the solve starts from the state of the case, so it finds this one again
            state = bearings.solve(bearings.start)
            values |= margin_values(bearings, bearings.start, state)
        return values, attrs
    # its kernels take long to load, and the other models need none of them
    from bearingwear.solvers.dynamic.run import solve_dynamic

    warm = warmed_for_motion(scene)
    if warm.status != code.OK:
        return {"status": warm.status} | growth_values(warm.scene), {"residual": warm.sentence}
    values, attrs = solve_dynamic(warm.scene, restart=restart, progress=progress)
    if "friction_heat" in values:
        values |= network_values(scene, warm, values["status"], warm.heat)
    return values | growth_values(warm.scene), attrs


def check_restart(scene: Scene, chosen: Choice) -> None:
    """Raises NotAvailable if the model chosen is not the dynamic one, which alone continues."""
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
    """Returns a result with the scene, the model and its warnings.

    Its status is UNVERIFIED if a number that must be finite is not.

    values, attrs: result variables and attributes.
    elapsed: time of the solve [s].
    warnings: those of the values if None.
    """
    names = not_finite(values, scene.plain) if values["status"] == code.OK else []
    if names:
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
