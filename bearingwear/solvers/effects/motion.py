"""How balls move in a model, before any solve: its forces and how large they are."""

import math
from collections.abc import Iterator

from bearingwear.scene.accuracy import CAGE_TOLERANCE
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.mounted import MM, RPM
from bearingwear.solvers.dynamic.stability import is_found_periodic, why_not_periodic
from bearingwear.solvers.effects.choice import Choice, asymmetries


def centrifugal_share(scene: Scene) -> float:
    """Centrifugal force on a ball over its contact load under the preload alone, estimated.

    Estimated by the kinematics at the free contact angle [1]; NaN without a preload. Friction and
    what it holds depend on the angles at speed and are not estimated.
    """
    b, operation = scene.bearing, scene.operation
    D, dm = MM * b.ball_diameter_mm, MM * b.pitch_diameter_mm
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
    D, alpha = MM * b.ball_diameter_mm, math.radians(b.contact_angle_deg)
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
    omega_i, omega_o = (RPM * rpm for rpm in (operation.shaft_speed_rpm, operation.outer_speed_rpm))
    lean = b.ball_diameter_mm / b.pitch_diameter_mm * math.cos(math.radians(b.contact_angle_deg))
    orbit = 0.5 * (omega_i * (1.0 - lean) + omega_o * (1.0 + lean))
    return abs(orbit - omega_o), orbit


def spin_across_share(scene: Scene) -> float:
    """Share of a spinning contact's friction that slip across the ellipse adds, before any solve.

    E(m) - 1 [1] at the free contact angle, of the race where it is larger; by the fit E = 1.0003 +
    0.5968 A/B of Brewe and Hamrock (1977).
    """
    b = scene.bearing
    D, cosine = b.ball_diameter_mm, math.cos(math.radians(b.contact_angle_deg))
    shares = []
    for f, sigma in ((b.inner_groove_factor, -1.0), (b.outer_groove_factor, 1.0)):
        A = 2.0 / D - 1.0 / (f * D)
        B = 2.0 / D - sigma * 2.0 * cosine / (b.pitch_diameter_mm + sigma * D * cosine)
        shares.append(0.0003 + 0.5968 * A / B)
    return max(shares)


def slip(chosen: Choice) -> Iterator[str]:
    model = chosen.scene.model
    share = 100.0 * spin_across_share(chosen.scene)
    size = f"about {share:.2g} % of the friction of a spinning contact"
    if model.slip_is_over == "line":
        who = "model.slip_over" if model.slip_over else "model.contact: paper"
        yield f"slip: on the centre line of the ellipse ({who}); leaves out {size}"
    else:
        yield f"slip: over the whole ellipse; its centre line alone would leave out {size}"


def traction_borne(chosen: Choice) -> Iterator[str]:
    model, share = chosen.scene.model, gyroscopic_share(chosen.scene)
    share_of = "an unknown share" if math.isnan(share) else f"{100.0 * share:.2g} %"
    where = "in the balance of normal forces"
    if chosen.fidelity == "race_control":
        where += " at the controlling race"
    elif not model.traction_bears:
        why = "model.normal_balance" if model.normal_balance else "model.contact: paper"
        where = f"left out of the balance of normal forces ({why})"
    yield (
        f"traction: {where}; up to about {share_of} of a ball's axial load carries the gyroscopic "
        "moment"
    )


def pair(chosen: Choice) -> Iterator[str]:
    a = chosen.scene.pair
    if a is None:
        return
    solved = "each bearing at its own place, the rotor in balance between them"
    if a.is_symmetric:
        solved = "two identical bearings, no external force: solved as one"
    held = "their distance is kept" if a.kind == "rigid_pair" else "a spring loads the second"
    yield f"{a.kind.replace('_', ' ')}: {solved}; {held}"
    if max(a.tandem) > 1:
        each = " and ".join(map(str, a.tandem))
        yield f"tandem: {each} bearings on the two sides, alike; each bears its share"
    if asymmetries(chosen.scene):
        yield "radial load and tilt: each bearing has its own, as the scene gives them"
    if a.rotor_mass_kg is not None and a.span_mm is not None:
        rod = "" if a.rotor_transverse_inertia_kg_mm2 else ", transverse inertia of a slender rod"
        yield f"natural frequencies: of a rigid rotor that does not turn{rod} (assumed)"


def no_cage(chosen: Choice) -> Iterator[str]:
    if chosen.scene.cage is None:
        yield "cage: none in the scene"
    elif not chosen.cage:
        yield (
            "cage: left out, since model.cage_results does not ask for it, "
            "and with it the balls' wear in its pockets"
        )


def balls(chosen: Choice) -> Iterator[str]:
    scene, count = chosen.reduced(chosen.scene), chosen.scene.bearing.ball_count
    if chosen.fidelity == "steady":
        yield "balls: one represents all, because all move alike"
        yield from _forces(scene)
    elif chosen.fidelity == "dynamic":
        yield from _in_time(scene)
    else:
        yield (
            "ball motion: from Jones-Harris race control, not from a balance of friction; slip, QV "
            "and wear are estimates"
        )
        yield f"balls: {count}, each in its own equilibrium"
        if scene.operation.rotating_load_N:
            yield "rotating load: taken at the instant when it points along +Z"
        if scene.lubricant.drag_density_kg_m3:
            yield "lubricant drag: left out, because race control has no skidding"


def _forces(scene: Scene) -> Iterator[str]:
    """Always solved, because leaving one out saves too little (benchmarks/reductions.py)."""
    share, size = centrifugal_share(scene), "its size is not known before the solve"
    if not math.isnan(share):
        times = f"{100.0 * share:.2g} % of" if share < 1.0 else f"{share:.2g} times"
        size = f"about {times} the contact load under the preload at rest"
    yield f"centrifugal force: solved; {size}"
    yield "gyroscopic moment: solved"
    yield "lubricant drag: " + (
        "solved" if scene.lubricant.drag_density_kg_m3 else "none in the scene"
    )
    yield "elastic micro-slip: not modelled; it takes 2 to 5 % of QV"


def _in_time(scene: Scene) -> Iterator[str]:
    operation, cage = scene.operation, scene.cage
    held = operation.preload_method == "fixed_position"
    loads = [] if held else [f"preload of {operation.preload_N:g} N"]
    if any(operation.radial_load_N):
        loads.append("radial load fixed in space")
    if operation.rotating_load_N:
        loads.append("radial load that turns with the shaft, along +Z at the start")
    moves = "two translations, held axially" if held else "three translations"
    tilt = f"{operation.tilt_mrad:g} mrad about Y, held" if operation.tilt_mrad else "none"
    yield (
        f"balls: {scene.bearing.ball_count}, each with three rotations and its orbit as states in "
        "time, its centre in equilibrium of normal forces at each instant"
    )
    yield f"inner race: {moves}, in equilibrium at each instant"
    yield f"loads on the inner race: {', '.join(loads) or 'none except the axial one'}"
    yield f"tilt of the inner race: {tilt}"
    yield from _forces(scene)
    if len(set(scene.wear.ball_diameter_loss_um)) > 1:
        yield "ball diameters: one for each ball, as worn"
    if cage is not None:
        guide = "balls" if cage.guiding_race == "ball" else f"land of the {cage.guiding_race} race"
        g = math.hypot(*operation.gravity_m_s2)
        weight = f"gravity {g:.3g} m/s2" if g else "weightless, no operation.gravity_m_s2"
        balance = f", imbalance {cage.imbalance_um:g} um" if cage.imbalance_um else ""
        yield f"cage: six degrees of freedom, guided by the {guide}; {weight}{balance}"
        steps = scene.model.dynamic_tolerance
        if steps > CAGE_TOLERANCE:
            yield f"steps: tolerance {steps:g}; for wear of the cage it needs 0.001"
        elif steps == CAGE_TOLERANCE:
            yield "steps: tolerance 0.001, for wear of the cage to 10 % in one motion"
    yield (
        "Coriolis force and radial inertia of the balls: left out, as in the source of the model; "
        "the energy account books the first"
    )


def solution(chosen: Choice) -> Iterator[str]:
    scene = chosen.reduced(chosen.scene)
    if chosen.fidelity != "dynamic":
        return
    if is_found_periodic(scene):
        yield "motion: found as a periodic one, the balls evenly spaced as a cage would keep them"
    elif scene.model.dynamic_solution == "march":
        yield "motion: time stepping until it settles (model.dynamic_solution)"
    else:
        why = why_not_periodic(scene) or "histories are requested (model.history_points_per_turn)"
        yield f"motion: time stepping until it settles, without a search for a periodic one: {why}"
