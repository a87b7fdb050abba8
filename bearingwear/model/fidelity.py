"""Which model a scene needs."""

from dataclasses import dataclass

from bearingwear.model.scene import Scene

TIERS = ("race_control", "steady", "dynamic")

ASKED_FOR = "asked for by the scene or the command"


class NotAvailable(ValueError):
    """The model asked for does not apply to the scene; one line."""


@dataclass(frozen=True)
class Choice:
    """A tier and the sentences that say why."""

    tier: str
    reasons: tuple[str, ...]


def asymmetries(scene: Scene) -> list[str]:
    """What in a scene keeps its balls from all doing the same thing."""
    operation = scene.operation
    found = []
    if any(operation.radial_load_N):
        found.append("radial load")
    if operation.rotating_load_N:
        found.append("rotating load")
    if operation.tilt_mrad:
        found.append("tilt")
    if len(set(scene.wear.ball_diameter_loss_um)) > 1:
        found.append("unequal ball diameters")
    return found


def choice(scene: Scene, fidelity: str | None = None) -> Choice:
    """Decide the tier; `fidelity` overrides `model.fidelity` of the scene.

    Raises
    ------
    NotAvailable
        Where the tier asked for cannot solve this scene.
    """
    wanted = fidelity or scene.model.fidelity
    found = " and ".join(asymmetries(scene))
    at_rest = not (scene.operation.shaft_speed_rpm or scene.operation.outer_speed_rpm)
    needs_cage = scene.model.cage_results
    if needs_cage and wanted in ("steady", "race_control"):
        raise _refusal(scene, wanted, "cage motion and wear need the dynamic model", "dynamic")
    if wanted == "steady" and found:
        problem = f"a scene with {found} has no steady state"
        raise _refusal(scene, wanted, problem, "dynamic, race_control")
    if at_rest and (wanted == "dynamic" or needs_cage):
        raise NotAvailable(
            f"{scene.name}: operation.shaft_speed_rpm: given 0 with an outer race at rest; "
            "allowed, for a dynamic model, a race that turns"
        )
    if wanted != "auto":
        return _chosen(scene, wanted, ASKED_FOR)
    if needs_cage:
        return _chosen(scene, "dynamic", "cage motion and wear are asked for")
    if found and at_rest:
        return _chosen(scene, "race_control", f"{found}, and both races at rest: nothing moves")
    if found:
        return _chosen(scene, "dynamic", f"{found}: no steady state exists")
    return _chosen(scene, "steady", "thrust alone")


def choice_for_life(scene: Scene, fidelity: str | None = None) -> Choice:
    """Decide the tier that a wear life is made of, which takes a great many solves.

    Raises
    ------
    NotAvailable
        Where the tier asked for cannot solve this scene, or takes too long for a life.
    """
    wanted = fidelity or scene.model.fidelity
    if scene.model.cage_results:
        raise NotAvailable(
            f"{scene.name}: model.cage_results: given true; allowed false, since a life is not "
            "solved in time"
        )
    if wanted == "dynamic":
        raise _refusal(scene, wanted, "a life is not solved in time", "steady, race_control")
    found = " and ".join(asymmetries(scene))
    if wanted == "auto" and found:
        why = f"{found}: no steady state exists, and a life is not solved in time"
        return _chosen(scene, "race_control", why)
    return choice(scene, fidelity)


def _refusal(scene: Scene, wanted: str, problem: str, others: str) -> NotAvailable:
    return NotAvailable(
        f"{scene.name}: model.fidelity: given '{wanted}'; {problem}; allowed auto, {others}"
    )


def _chosen(scene: Scene, tier: str, why: str) -> Choice:
    told = {"race_control": _race_control, "steady": _steady, "dynamic": _dynamic}
    last = "traction: left out of the normal force balance, as in the source of the model"
    return Choice(tier, (f"{tier}: {why}", *told[tier](scene), last))


def _race_control(scene: Scene) -> list[str]:
    told = [
        "ball motion: from Jones-Harris race control, not from a balance of friction; slip, QV "
        "and wear are estimates",
        f"balls: {scene.bearing.ball_count}, each in its own equilibrium",
    ]
    if scene.operation.rotating_load_N:
        told.append("rotating load: taken at the instant when it points along +Z")
    if scene.lubricant.drag_density_kg_m3:
        told.append("lubricant drag: left out, race control knows no skidding")
    return told + _no_cage(scene)


def _steady(scene: Scene) -> list[str]:
    return [
        "balls: one stands for all, since every ball does the same thing",
        "centrifugal force and gyroscopic moment: solved",
        _drag(scene),
        *_no_cage(scene),
    ]


def _no_cage(scene: Scene) -> list[str]:
    if scene.cage is None:
        return []
    return ["cage: in the scene, but nothing asked for depends on it; left out"]


def _dynamic(scene: Scene) -> list[str]:
    operation, cage = scene.operation, scene.cage
    held = operation.preload_method == "fixed_position"
    loads = [] if held else [f"preload of {operation.preload_N:g} N"]
    if any(operation.radial_load_N):
        loads.append("radial load fixed in space")
    if operation.rotating_load_N:
        loads.append("radial load that turns with the shaft, along +Z at the start")
    told = [
        f"balls: {scene.bearing.ball_count}, each with three rotations and its orbit moving in "
        "time, its centre in equilibrium of normal forces at each instant",
        "centrifugal force and gyroscopic moment: solved",
        "inner race: "
        + ("two translations, held axially" if held else "three translations")
        + ", in equilibrium at each instant",
        f"loads on the inner race: {', '.join(loads) or 'none but what holds it axially'}",
        "tilt of the inner race: "
        + (f"{operation.tilt_mrad:g} mrad about Y, held" if operation.tilt_mrad else "none"),
        _drag(scene),
    ]
    if len(set(scene.wear.ball_diameter_loss_um)) > 1:
        told.append("ball diameters: one for each ball, as worn")
    if cage is None:
        told.append("cage: none in the scene")
    else:
        guide = "balls" if cage.guiding_race == "ball" else f"land of the {cage.guiding_race} race"
        told.append(f"cage: six degrees of freedom moving in time, guided by the {guide}")
    told.append(
        "Coriolis force and radial inertia of the balls: left out, as in the source of the model; "
        "the energy account books the first"
    )
    return told


def _drag(scene: Scene) -> str:
    solved = "solved" if scene.lubricant.drag_density_kg_m3 else "none in the scene"
    return f"lubricant drag: {solved}"
