"""Which model a scene needs, and what the forces in it amount to."""

import math
from dataclasses import dataclass, replace

from bearingwear.provenance import is_compiled
from bearingwear.scene.scene import Scene

ASKED_FOR = "asked for by the scene or the command"

# What a shaft turn takes, per ball, in milliseconds (docs/accuracy.md, gyro_s1 at standard), for a
# rough word on the effort before anything runs.
TURN_MS, TURN_WITH_CAGE_MS = 0.25, 1.6
LARGEST_KERNEL = {
    "race_control": "contact_summary",
    "steady": "thrust_case",
    "dynamic": "advance_and_record",
}
COMPILING = "up to a minute to compile the solver, once on this machine; then "


class NotAvailable(ValueError):
    """The model asked for does not apply to the scene; one line."""


@dataclass(frozen=True)
class Choice:
    """A tier and the sentences that say why; whether the scene's cage is solved with it."""

    tier: str
    reasons: tuple[str, ...]
    cage: bool = False

    def reduced(self, scene: Scene) -> Scene:
        """The scene without what is not solved."""
        return scene if self.cage or scene.cage is None else scene.without_cage


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

    A life in time takes a run at every step, so it is followed only where it is asked for.

    Raises
    ------
    NotAvailable
        Where the tier asked for cannot solve this scene, or sees no end of its life.
    """
    wanted = fidelity or scene.model.fidelity
    found = " and ".join(asymmetries(scene))
    if wanted == "auto" and found and not scene.model.cage_results:
        why = f"{found}: no steady state exists, and a life in time was not asked for"
        chosen = _chosen(scene, "race_control", why)
    else:
        chosen = choice(scene, fidelity)
    end = scene.wear.end_of_life
    limits = [] if end is None else sorted(end.criteria.keys() - end.without_cage.criteria.keys())
    if not limits or (chosen.tier == "dynamic" and chosen.cage):
        return chosen
    if end is not None and not end.without_cage.criteria:
        raise NotAvailable(
            f"{scene.name}: wear.end_of_life: given limits of the cage alone, which a life of "
            f"fidelity {chosen.tier} does not see wearing; allowed another criterion, or fidelity "
            "dynamic"
        )
    told = f"limits of the cage: {', '.join(limits)} not watched, since its wear is not solved"
    return replace(chosen, reasons=(*chosen.reasons, told))


def _refusal(scene: Scene, wanted: str, problem: str, others: str) -> NotAvailable:
    return NotAvailable(
        f"{scene.name}: model.fidelity: given '{wanted}'; {problem}; allowed auto, {others}"
    )


def _chosen(scene: Scene, tier: str, why: str) -> Choice:
    told = {"race_control": _race_control, "steady": _steady, "dynamic": _dynamic}
    last = "traction: left out of the normal force balance, as in the source of the model"
    # who asks for the dynamic model by its name asks for all of it
    cage = tier == "dynamic" and (scene.model.cage_results or why == ASKED_FOR)
    chosen = Choice(tier, (), cage and scene.cage is not None)
    cage_told = [] if chosen.cage else _no_cage(scene)
    reasons = (f"{tier}: {why}", *told[tier](chosen.reduced(scene)), *cage_told, last)
    return replace(chosen, reasons=reasons)


@dataclass(frozen=True)
class Shares:
    """How large the forces beside the preload are: kinematics at the free contact angle [1].

    NaN where the preload presses no ball.
    """

    centrifugal: float  # centrifugal force over contact load
    gyroscopic: float  # gyroscopic moment over what friction of both contacts can hold
    drag: float  # lubricant drag over what friction of both contacts can hold


def shares(scene: Scene) -> Shares:
    """Estimate the forces on a ball under the preload alone, before any solve."""
    b, operation = scene.bearing, scene.operation
    D, dm = 1e-3 * b.ball_diameter_mm, 1e-3 * b.pitch_diameter_mm
    alpha, gamma = math.radians(b.contact_angle_deg), D / dm
    omega_i, omega_o = (
        math.pi / 30.0 * rpm for rpm in (operation.shaft_speed_rpm, operation.outer_speed_rpm)
    )
    lean = gamma * math.cos(alpha)
    orbit = 0.5 * (omega_i * (1.0 - lean) + omega_o * (1.0 + lean))
    spin = 0.5 * (omega_i - omega_o) / gamma * (1.0 - lean * lean)
    mass = scene.materials[b.ball_material].density_kg_m3 * math.pi / 6.0 * D**3
    load = operation.preload_N / (b.ball_count * math.sin(alpha)) if alpha > 0.0 else 0.0
    if not load > 0.0:
        return Shares(math.nan, math.nan, math.nan)
    hold = 2.0 * scene.friction.ball_race * load
    drag = math.pi / 8.0 * scene.lubricant.drag_density_kg_m3 * (0.5 * D * dm * orbit) ** 2
    moment = 0.1 * mass * D * D * abs(orbit * spin) * math.sin(alpha)
    infinite = math.inf
    return Shares(
        mass * 0.5 * dm * orbit**2 / load,
        moment / (0.5 * D * hold) if hold else infinite,
        drag / hold if hold else infinite,
    )


def accuracy_told(scene: Scene, chosen: Choice) -> str:
    """The settings of accuracy that a solve uses, in words."""
    model = scene.model
    told = (
        f"accuracy: {model.accuracy}; {model.strips} points or strips ({model.quadrature})"
        f", slip rounded below {scene.friction.slip_regularisation_m_s:g} m/s"
    )
    if chosen.tier != "dynamic":
        return told
    return (
        f"{told}, step tolerance {model.dynamic_tolerance:g}, at most {model.simulated_turns:g} "
        f"turns, settled at {model.settled_drift:g}"
    )


def effort(scene: Scene, chosen: Choice) -> str:
    """What a solve takes, roughly, in words."""
    before = "" if is_compiled(LARGEST_KERNEL[chosen.tier]) else COMPILING
    if chosen.tier != "dynamic":
        return f"effort: {before}milliseconds"
    turns = scene.model.simulated_turns
    ms = scene.bearing.ball_count * (TURN_WITH_CAGE_MS if chosen.cage else TURN_MS)
    return (
        f"effort: {before}{turns:g} shaft turns at the most, of the order of "
        f"{1e-3 * turns * ms:.1g} s (an estimate from one measured scene)"
    )


def _percent(share: float) -> str:
    if math.isnan(share):
        return "its size is not known before the solve"
    if math.isinf(share):
        return "there is no friction to compare it with"
    return f"about {100.0 * share:.2g} %" if share < 1.0 else f"about {share:.2g} times"


def _race_control(scene: Scene) -> list[str]:
    told = [
        "ball motion: from Jones-Harris race control, not from a balance of friction; slip, QV "
        "and wear are estimates",
        f"balls: {scene.bearing.ball_count}, each in its own equilibrium",
    ]
    if scene.operation.rotating_load_N:
        told.append("rotating load: taken at the instant when it points along +Z")
    if scene.lubricant.drag_density_kg_m3:
        told.append(
            "lubricant drag: left out, race control knows no skidding; it is "
            f"{_percent(shares(scene).drag)} of what friction can hold"
        )
    return told


def _steady(scene: Scene) -> list[str]:
    return [
        "balls: one stands for all, since every ball does the same thing",
        *_forces(scene),
    ]


def _forces(scene: Scene) -> list[str]:
    """Always solved: what leaving one out saves is not worth it (benchmarks/reductions.py)."""
    found = shares(scene)
    drag = "none in the scene"
    if scene.lubricant.drag_density_kg_m3:
        drag = f"solved; {_percent(found.drag)} of what friction can hold"
    return [
        f"centrifugal force: solved; {_percent(found.centrifugal)} of the contact load",
        f"gyroscopic moment: solved; {_percent(found.gyroscopic)} of what friction can hold",
        f"lubricant drag: {drag}",
    ]


def _no_cage(scene: Scene) -> list[str]:
    if scene.cage is None:
        return ["cage: none in the scene"]
    return [
        "cage: in the scene, but its motion and wear are not asked for (model.cage_results); left "
        "out, and with it the balls' wear in its pockets"
    ]


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
        "inner race: "
        + ("two translations, held axially" if held else "three translations")
        + ", in equilibrium at each instant",
        f"loads on the inner race: {', '.join(loads) or 'none but what holds it axially'}",
        "tilt of the inner race: "
        + (f"{operation.tilt_mrad:g} mrad about Y, held" if operation.tilt_mrad else "none"),
        *_forces(scene),
    ]
    if len(set(scene.wear.ball_diameter_loss_um)) > 1:
        told.append("ball diameters: one for each ball, as worn")
    if cage is not None:
        guide = "balls" if cage.guiding_race == "ball" else f"land of the {cage.guiding_race} race"
        told.append(f"cage: six degrees of freedom moving in time, guided by the {guide}")
    told.append(
        "Coriolis force and radial inertia of the balls: left out, as in the source of the model; "
        "the energy account books the first"
    )
    return told
