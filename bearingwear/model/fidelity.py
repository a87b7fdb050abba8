"""Which model a scene needs."""

from dataclasses import dataclass

from bearingwear.model.scene import Scene

TIERS = ("race_control", "steady", "dynamic")


class NotAvailable(ValueError):
    """The model asked for does not apply to the scene, or does not exist yet; one line."""


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
    found = asymmetries(scene)
    if wanted == "dynamic":
        raise NotAvailable(
            f"{scene.name}: model.fidelity: given 'dynamic'; the dynamic model is not available "
            "in this version; allowed auto, steady, race_control"
        )
    if scene.model.cage_results:
        raise NotAvailable(
            f"{scene.name}: model.cage_results: given true; cage motion and wear need the dynamic "
            "model, which is not available in this version; allowed false"
        )
    if wanted == "steady" and found:
        raise NotAvailable(
            f"{scene.name}: model.fidelity: given 'steady'; a scene with {' and '.join(found)} "
            "has no steady state; allowed auto, race_control"
        )
    if wanted == "race_control" or found:
        why = (
            "asked for by the scene or the command"
            if wanted == "race_control"
            else f"{' and '.join(found)}: no steady state exists, and the dynamic model is not "
            "available in this version"
        )
        reasons = [
            f"race_control: {why}",
            "ball motion: from Jones-Harris race control, not from a balance of friction; slip, QV "
            "and wear are estimates",
            f"balls: {scene.bearing.ball_count}, each in its own equilibrium",
        ]
        if scene.operation.rotating_load_N:
            reasons.append("rotating load: taken at the instant when it points along +Z")
        if scene.lubricant.drag_density_kg_m3:
            reasons.append("lubricant drag: left out, race control knows no skidding")
    else:
        why = "asked for by the scene or the command" if wanted == "steady" else "thrust alone"
        reasons = [
            f"steady: {why}",
            "balls: one stands for all, since every ball does the same thing",
            "centrifugal force and gyroscopic moment: solved",
            "lubricant drag: "
            + ("solved" if scene.lubricant.drag_density_kg_m3 else "none in the scene"),
        ]
    if scene.cage is not None:
        reasons.append("cage: in the scene, but nothing asked for depends on it; left out")
    reasons.append("traction: left out of the normal force balance, as in the source of the model")
    return Choice("race_control" if wanted == "race_control" or found else "steady", tuple(reasons))
