"""Which model a scene needs, and how large the forces in it are."""

import math
from dataclasses import dataclass, replace

from bearingwear.kernels.build.folder import compile_time, is_compiled
from bearingwear.scene.accuracy import CAGE_TOLERANCE, FIDELITIES
from bearingwear.scene.blocks import EndOfLife
from bearingwear.scene.scene import Scene
from bearingwear.solvers.effects.films import film_sentences, films_refused
from bearingwear.solvers.effects.growth import growth_sentences
from bearingwear.solvers.effects.motion import check_solution, is_found_periodic, motion_sentence
from bearingwear.solvers.errors import NotAvailable as NotAvailable

ASKED_FOR = "asked for by the scene or the command"

NEEDS_SLIP = frozenset({"gyroscopic_slip_share", "skid_ratio"})
"""Criteria that need a balance of friction, which race control does without."""

# Milliseconds per ball and shaft turn (docs/accuracy.md, gyro_s1 at standard), for a rough estimate
# of the effort before anything runs.
TURN_MS, TURN_WITH_CAGE_MS = 0.3, 0.5
LARGEST_KERNEL = {
    "race_control": "contact_summary",
    "steady": "thrust_case",
    "dynamic": "advance_and_record",
}


@dataclass(frozen=True)
class Choice:
    """A model, the sentences that say why, and whether the scene's cage is solved with it."""

    fidelity: str
    reasons: tuple[str, ...]
    cage: bool = False

    def reduced(self, scene: Scene) -> Scene:
        """The scene without what is not solved."""
        return scene if self.cage or scene.cage is None else scene.without_cage


def asymmetries(scene: Scene) -> list[str]:
    """What in a scene makes its balls differ."""
    if scene.pair is not None:
        return list(dict.fromkeys(text for side in scene.sides for text in asymmetries(side)))
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


def stands_still(scene: Scene) -> bool:
    """Whether neither race turns."""
    return not (scene.operation.shaft_speed_rpm or scene.operation.outer_speed_rpm)


def choice(scene: Scene, fidelity: str | None = None) -> Choice:
    """Choose the model; `fidelity` overrides `model.fidelity` of the scene.

    Raises
    ------
    NotAvailable
        Where the fidelity asked for cannot solve this scene, or does not exist.
    """
    wanted = fidelity or scene.model.fidelity
    if wanted not in FIDELITIES:
        raise NotAvailable(
            f"{scene.name}: fidelity: got {wanted!r}, expected {', '.join(FIDELITIES)}"
        )
    found = " and ".join(asymmetries(scene))
    needs_cage = scene.model.cage_results
    if needs_cage and wanted in ("steady", "race_control"):
        raise _refusal(scene, wanted, "cage motion and wear need the dynamic model", "dynamic")
    if scene.pair is not None and (wanted == "dynamic" or needs_cage):
        asked, instead = (
            ("model.fidelity: got 'dynamic'", "steady or race_control")
            if wanted == "dynamic"
            else ("model.cage_results: got true", "false")
        )
        raise NotAvailable(
            f"{scene.name}: {asked} with a {scene.pair.kind}, expected {instead}; the "
            "dynamic model takes one bearing: set arrangement.kind single (half of a like pair)"
        )
    if wanted == "steady" and found:
        problem = f"a scene with {found} has no steady state"
        raise _refusal(scene, wanted, problem, "dynamic, race_control")
    if stands_still(scene) and (wanted == "dynamic" or needs_cage):
        raise NotAvailable(
            f"{scene.name}: operation.shaft_speed_rpm: got 0 with an outer race at rest, "
            "expected, for a dynamic model, a race that turns"
        )
    if wanted != "auto":
        return _chosen(scene, wanted, ASKED_FOR)
    if needs_cage:
        return _chosen(scene, "dynamic", "cage motion and wear are asked for")
    if found and stands_still(scene):
        return _chosen(scene, "race_control", f"{found}, and both races at rest: nothing moves")
    if found and scene.pair is not None:
        why = f"{found}: no steady state exists, and a pair has no dynamic model"
        return _chosen(scene, "race_control", why)
    if found:
        return _chosen(scene, "dynamic", f"{found}: no steady state exists")
    return _chosen(scene, "steady", "thrust alone")


def choice_for_life(scene: Scene, fidelity: str | None = None) -> Choice:
    """Choose the model of a wear life: that of a solve, if it watches any criterion of the scene.

    Raises
    ------
    NotAvailable
        Where the fidelity asked for cannot solve this scene, or watches no end of its life.
    """
    chosen = choice(scene, fidelity)
    if refused := films_refused(scene, chosen.fidelity):
        raise NotAvailable(f"{scene.name}: {refused}")
    unseen = unwatched(scene, chosen)
    if not unseen:
        return chosen
    names = ", ".join(unseen)
    other = "fidelity auto" if unseen.keys() <= NEEDS_SLIP else "fidelity dynamic"
    if scene.wear.end_of_life and unseen.keys() == scene.wear.end_of_life.criteria.keys():
        raise NotAvailable(
            f"{scene.name}: wear.end_of_life: got {names} alone, which a life of fidelity "
            f"{chosen.fidelity} does not watch, expected another criterion, or {other}"
        )
    return replace(chosen, reasons=(*chosen.reasons, f"criteria: {names} not watched"))


def unwatched(scene: Scene, chosen: Choice) -> dict[str, float]:
    """The criteria of a scene that a life of this fidelity does not watch, with their limits."""
    end = scene.wear.end_of_life or EndOfLife()
    blind = set() if chosen.cage else end.criteria.keys() - end.without_cage.criteria.keys()
    if chosen.fidelity == "race_control" and not stands_still(scene):
        blind |= NEEDS_SLIP
    return {name: limit for name, limit in end.criteria.items() if name in blind}


def _refusal(scene: Scene, wanted: str, problem: str, others: str) -> NotAvailable:
    return NotAvailable(
        f"{scene.name}: model.fidelity: got '{wanted}'; {problem}, expected auto, {others}"
    )


def _chosen(scene: Scene, fidelity: str, why: str) -> Choice:
    sentences = {"race_control": _race_control, "steady": _steady, "dynamic": _dynamic}
    contact = [_slip(scene), _traction(scene, fidelity)]
    # whoever asks for the dynamic model by name gets the cage too
    cage = fidelity == "dynamic" and (scene.model.cage_results or why == ASKED_FOR)
    chosen = Choice(fidelity, (), cage and scene.cage is not None)
    motion: tuple[str, ...] = ()
    if fidelity == "dynamic":
        check_solution(chosen.reduced(scene))
        motion = (motion_sentence(chosen.reduced(scene)),)
    no_cage = [] if chosen.cage else _no_cage(scene)
    reasons = (
        f"{fidelity}: {why}",
        *_pair(scene),
        *film_sentences(scene),
        *sentences[fidelity](chosen.reduced(scene)),
        *growth_sentences(scene),
        *no_cage,
        *motion,
        *contact,
    )
    return replace(chosen, reasons=reasons)


def centrifugal_share(scene: Scene) -> float:
    """Centrifugal force on a ball over its contact load under the preload alone, estimated.

    Estimated by the kinematics at the free contact angle [1]; NaN without a preload. Friction and
    what it holds depend on the angles at speed and are not estimated.
    """
    b, operation = scene.bearing, scene.operation
    D, dm = 1e-3 * b.ball_diameter_mm, 1e-3 * b.pitch_diameter_mm
    alpha = math.radians(b.contact_angle_deg)
    _, orbit = _rolling(scene)
    mass = scene.materials[b.ball_material].density_kg_m3 * math.pi / 6.0 * D**3
    load = operation.preload_N / (b.ball_count * math.sin(alpha)) if alpha > 0.0 else 0.0
    return mass * 0.5 * dm * orbit**2 / load if load > 0.0 else math.nan


def gyroscopic_share(scene: Scene) -> float:
    """Traction that carries the gyroscopic moment over the axial load of a ball, before any solve.

    M_g/R over the preload of a ball, by the steeper spin axis of the two race controls, that of
    a ball which rolls on the inner race, at the free contact angle [1]; NaN where nothing presses
    axially.
    """
    b, operation = scene.bearing, scene.operation
    D, alpha = 1e-3 * b.ball_diameter_mm, math.radians(b.contact_angle_deg)
    gamma = b.ball_diameter_mm / b.pitch_diameter_mm
    relative, orbit = _rolling(scene)
    beta = math.atan2(math.sin(alpha), math.cos(alpha) - gamma)
    w_R = relative * (1.0 + gamma * math.cos(alpha)) / (gamma * math.cos(beta - alpha))
    mass = scene.materials[b.ball_material].density_kg_m3 * math.pi / 6.0 * D**3
    moment = 0.1 * mass * D * D * w_R * orbit * math.sin(beta)
    load = operation.preload_N / b.ball_count
    return 2.0 * moment / D / load if load > 0.0 else math.nan


def _rolling(scene: Scene) -> tuple[float, float]:
    """Orbit rate against the outer race, and in space, of rolling at the free contact angle."""
    b, operation = scene.bearing, scene.operation
    omega_i, omega_o = (
        math.pi / 30.0 * rpm for rpm in (operation.shaft_speed_rpm, operation.outer_speed_rpm)
    )
    lean = b.ball_diameter_mm / b.pitch_diameter_mm * math.cos(math.radians(b.contact_angle_deg))
    orbit = 0.5 * (omega_i * (1.0 - lean) + omega_o * (1.0 + lean))
    return abs(orbit - omega_o), orbit


def spin_across_share(scene: Scene) -> float:
    """Share of a spinning contact's friction that slip across the ellipse adds, before any solve.

    E(m) - 1 [1] at the free contact angle, of the race where it is larger; by the fit E = 1.0003 +
    0.5968 A/B of Brewe and Hamrock (1977).
    """
    b = scene.bearing
    D, dm, cosine = (
        b.ball_diameter_mm,
        b.pitch_diameter_mm,
        math.cos(math.radians(b.contact_angle_deg)),
    )
    shares = []
    for f, sigma in ((b.inner_groove_factor, -1.0), (b.outer_groove_factor, 1.0)):
        A = 2.0 / D - 1.0 / (f * D)
        B = 2.0 / D - sigma * 2.0 * cosine / (dm + sigma * D * cosine)
        shares.append(0.0003 + 0.5968 * A / B)
    return max(shares)


def accuracy_sentence(scene: Scene, chosen: Choice) -> str:
    """The settings of accuracy that a solve uses, in words."""
    model = scene.model
    across = f" times {model.points_across} across" if model.slip_is_over == "ellipse" else ""
    always = (
        f"accuracy: {model.accuracy}; {model.strips} points or strips ({model.quadrature}){across}"
        f", slip rounded below {scene.friction.slip_regularisation_m_s:g} m/s"
    )
    if chosen.fidelity != "dynamic":
        return always
    return (
        f"{always}, step tolerance {model.dynamic_tolerance:g}, at most {model.simulated_turns:g} "
        f"turns, settled at {model.settled_drift:g}"
    )


def effort(scene: Scene, chosen: Choice) -> str:
    """A rough estimate of what a solve costs, in words."""
    compiled = is_compiled(LARGEST_KERNEL[chosen.fidelity])
    before = "" if compiled else f"up to {compile_time()} to compile the solver, once; then "
    if chosen.fidelity != "dynamic":
        return f"effort: {before}milliseconds"
    if is_found_periodic(chosen.reduced(scene)):
        return f"effort: {before}a tenth of a second"
    turns = scene.model.simulated_turns
    ms = scene.bearing.ball_count * (TURN_WITH_CAGE_MS if chosen.cage else TURN_MS)
    runs = ""
    if scene.wear.end_of_life is not None:
        runs = f"; a life takes about {scene.model.life_steps} such runs or more"
    return (
        f"effort: {before}at most {turns:g} shaft turns, of the order of "
        f"{1e-3 * turns * ms:.1g} s (an estimate from one measured scene){runs}"
    )


def _compared(share: float) -> str:
    if math.isnan(share):
        return "its size is not known before the solve"
    size = f"{100.0 * share:.2g} % of" if share < 1.0 else f"{share:.2g} times"
    return f"about {size} the contact load under the preload at rest"


def _slip(scene: Scene) -> str:
    size = f"about {100.0 * spin_across_share(scene):.2g} % of the friction of a spinning contact"
    if scene.model.slip_is_over == "line":
        who = "model.slip_over" if scene.model.slip_over else "model.contact: paper"
        return f"slip: on the centre line of the ellipse ({who}); leaves out {size}"
    return f"slip: over the whole ellipse; its centre line alone would leave out {size}"


def _traction(scene: Scene, fidelity: str) -> str:
    share = _percent(gyroscopic_share(scene))
    size = f"up to about {share} of a ball's axial load carry the gyroscopic moment"
    if fidelity == "race_control":
        return f"traction: in the balance of normal forces at the controlling race; {size}"
    if scene.model.traction_bears:
        return f"traction: in the balance of normal forces; {size}"
    why = "model.normal_balance" if scene.model.normal_balance else "model.contact: paper"
    return f"traction: left out of the balance of normal forces ({why}); {size}"


def _percent(share: float) -> str:
    return "an unknown share" if math.isnan(share) else f"{100.0 * share:.2g} %"


def _race_control(scene: Scene) -> list[str]:
    sentences = [
        "ball motion: from Jones-Harris race control, not from a balance of friction; slip, QV "
        "and wear are estimates",
        f"balls: {scene.bearing.ball_count}, each in its own equilibrium",
    ]
    if scene.operation.rotating_load_N:
        sentences.append("rotating load: taken at the instant when it points along +Z")
    if scene.lubricant.drag_density_kg_m3:
        sentences.append("lubricant drag: left out, because race control has no skidding")
    return sentences


def _steady(scene: Scene) -> list[str]:
    return [
        "balls: one represents all, because all move alike",
        *_forces(scene),
    ]


def _forces(scene: Scene) -> list[str]:
    """Always solved, because leaving one out saves too little (benchmarks/reductions.py)."""
    drag = "solved" if scene.lubricant.drag_density_kg_m3 else "none in the scene"
    return [
        f"centrifugal force: solved; {_compared(centrifugal_share(scene))}",
        "gyroscopic moment: solved",
        f"lubricant drag: {drag}",
        "elastic micro-slip: not modelled; it takes 2 to 5 % of QV",
    ]


def _pair(scene: Scene) -> list[str]:
    a = scene.pair
    if a is None:
        return []
    if a.is_symmetric:
        solved = "two identical bearings, no external force: solved as one"
    else:
        solved = "each bearing at its own place, the rotor in balance between them"
    held = "their distance is kept" if a.kind == "rigid_pair" else "a spring loads the second"
    both = [f"{a.kind.replace('_', ' ')}: {solved}; {held}"]
    if max(a.tandem) > 1:
        each = " and ".join(map(str, a.tandem))
        both.append(f"tandem: {each} bearings on the two sides, alike; each bears its share")
    if asymmetries(scene):
        both.append("radial load and tilt: each bearing has its own, as the scene gives them")
    if a.rotor_mass_kg is not None and a.span_mm is not None:
        rod = "" if a.rotor_transverse_inertia_kg_mm2 else ", transverse inertia of a slender rod"
        both.append(f"natural frequencies: of a rigid rotor that does not turn{rod} (assumed)")
    return both


def _no_cage(scene: Scene) -> list[str]:
    if scene.cage is None:
        return ["cage: none in the scene"]
    return [
        "cage: left out, since model.cage_results does not ask for it, "
        "and with it the balls' wear in its pockets"
    ]


def _dynamic(scene: Scene) -> list[str]:
    operation, cage = scene.operation, scene.cage
    held = operation.preload_method == "fixed_position"
    loads = [] if held else [f"preload of {operation.preload_N:g} N"]
    if any(operation.radial_load_N):
        loads.append("radial load fixed in space")
    if operation.rotating_load_N:
        loads.append("radial load that turns with the shaft, along +Z at the start")
    sentences = [
        f"balls: {scene.bearing.ball_count}, each with three rotations and its orbit as states in "
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
        sentences.append("ball diameters: one for each ball, as worn")
    if cage is not None:
        guide = "balls" if cage.guiding_race == "ball" else f"land of the {cage.guiding_race} race"
        g = math.hypot(*operation.gravity_m_s2)
        weight = f"gravity {g:.3g} m/s2" if g else "weightless, no operation.gravity_m_s2"
        balance = f", imbalance {cage.imbalance_um:g} um" if cage.imbalance_um else ""
        sentences.append(f"cage: six degrees of freedom, guided by the {guide}; {weight}{balance}")
        steps = scene.model.dynamic_tolerance
        if steps > CAGE_TOLERANCE:
            sentences.append(f"steps: tolerance {steps:g}; for wear of the cage it needs 0.001")
        elif steps == CAGE_TOLERANCE:
            sentences.append("steps: tolerance 0.001, for wear of the cage to 10 % in one motion")
    sentences.append(
        "Coriolis force and radial inertia of the balls: left out, as in the source of the model; "
        "the energy account books the first"
    )
    return sentences
