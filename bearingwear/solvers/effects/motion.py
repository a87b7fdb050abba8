"""Sentences on the motion of the balls in a model, and estimates of forces before a solve."""

import math
from collections.abc import Iterator

from bearingwear.measures import plain
from bearingwear.scene.accuracy import CAGE_TOLERANCE
from bearingwear.scene.arrangement import Arrangement, set_preload_ratio
from bearingwear.scene.scene import Cage, Scene
from bearingwear.solvers.bearing.fitted_hertz import INNER_RACE, OUTER_RACE, curvatures
from bearingwear.solvers.bearing.mounted import MM, RPM, mounted_geometry
from bearingwear.solvers.dynamic.stability import seeks_periodic, why_not_periodic
from bearingwear.solvers.effects.choice import Choice, asymmetries


def centrifugal_share(scene: Scene) -> float:
    """Estimates the centrifugal force on a ball over its contact load under the preload [1].

    The kinematics is that at the free contact angle. NaN without a preload. Friction depends on the
    angles at speed and is not estimated.
    """
    b, operation = scene.bearing, scene.operation
    D, dm = MM * b.ball_diameter_mm, MM * b.pitch_diameter_mm
    alpha = math.radians(b.contact_angle_deg)
    _, orbit = rolling_rates(scene)
    mass = scene.materials[b.ball_material].density_kg_m3 * math.pi / 6.0 * D**3
    load = operation.preload_N / (b.ball_count * math.sin(alpha)) if alpha > 0.0 else 0.0
    return mass * 0.5 * dm * orbit**2 / load if load > 0.0 else math.nan


def gyroscopic_share(scene: Scene) -> float:
    """Estimates the traction that carries the gyroscopic moment over a ball's axial load [1].

    It is M_g/R over the preload of a ball at the free contact angle. The spin axis is that of inner
    race control, the steeper of the two. NaN without a preload.
    """
    b, operation = scene.bearing, scene.operation
    D = MM * b.ball_diameter_mm
    alpha = math.radians(b.contact_angle_deg)
    gamma = b.ball_diameter_mm / b.pitch_diameter_mm
    relative, orbit = rolling_rates(scene)
    beta = math.atan2(math.sin(alpha), math.cos(alpha) - gamma)
    w_R = relative * (1.0 + gamma * math.cos(alpha)) / (gamma * math.cos(beta - alpha))
    mass = scene.materials[b.ball_material].density_kg_m3 * math.pi / 6.0 * D**3
    moment = 0.1 * mass * D * D * w_R * orbit * math.sin(beta)
    load = operation.preload_N / b.ball_count
    return 2.0 * moment / D / load if load > 0.0 else math.nan


def rolling_rates(scene: Scene) -> tuple[float, float]:
    """Returns the orbit rate of the balls relative to the outer race, and that in space [rad/s].

    The first is without sign. The balls roll at the free contact angle.
    """
    b, operation = scene.bearing, scene.operation
    omega_i, omega_o = (RPM * rpm for rpm in (operation.shaft_speed_rpm, operation.outer_speed_rpm))
    lean = b.ball_diameter_mm / b.pitch_diameter_mm * math.cos(math.radians(b.contact_angle_deg))
    orbit = 0.5 * (omega_i * (1.0 - lean) + omega_o * (1.0 + lean))
    return abs(orbit - omega_o), orbit


def spin_across_share(scene: Scene) -> float:
    """Estimates the share of spin friction due to slip across the ellipse [1].

    It is E(m) - 1 at the free contact angle, for the race with the larger value. E is the fit
    1.0003 + 0.5968 A/B of Brewe and Hamrock (1977).
    """
    g = mounted_geometry(scene)
    pairs = (curvatures(g, race, g.D0, math.cos(g.alpha0)) for race in (INNER_RACE, OUTER_RACE))
    return max(0.0003 + 0.5968 * A / B for A, B in pairs)


def slip_sentences(chosen: Choice) -> Iterator[str]:
    """Yields a sentence on where slip is evaluated, and on what a centre line neglects."""
    model = chosen.scene.model
    share = 100.0 * spin_across_share(chosen.scene)
    size = f"about {plain(share, 2)} % of the friction of a spinning contact"
    if model.slip_region == "line":
        key = "model.slip_over" if model.slip_over else "model.contact: paper"
        yield f"slip: evaluated on the centre line of the ellipse ({key}), which neglects {size}"
    else:
        yield (
            "slip: evaluated over the whole ellipse; evaluation on its centre line would neglect "
            f"{size}"
        )


def traction_sentences(chosen: Choice) -> Iterator[str]:
    """Yields a sentence on traction in the balance of normal forces, and on its share."""
    model = chosen.scene.model
    share = gyroscopic_share(chosen.scene)
    share_words = (
        "an unknown share" if math.isnan(share) else f"up to about {plain(100.0 * share, 2)} %"
    )
    status = "included in the balance of normal forces"
    if chosen.fidelity == "race_control":
        status += " at the controlling race"
    elif not model.includes_traction:
        key = "model.normal_balance" if model.normal_balance else "model.contact: paper"
        status = f"neglected in the balance of normal forces ({key})"
    yield (
        f"traction: {status}; the part that balances the gyroscopic moment is {share_words} of a "
        "ball's axial load"
    )


def pair_sentences(chosen: Choice) -> Iterator[str]:
    """Yields sentences on how a pair is solved, and on what is assumed; none without a pair."""
    a = chosen.scene.pair
    if a is None:
        return
    solution = "each bearing has its own displacement, and the rotor is in equilibrium"
    if a.is_symmetric:
        solution = "two identical bearings without an external force, solved as one"
    preload_words = "fixed spacing" if a.kind == "rigid_pair" else "a spring preloads the second"
    yield f"{a.kind.replace('_', ' ')}: {solution}; {preload_words}"
    if max(a.tandem) > 1:
        counts = " and ".join(map(str, a.tandem))
        yield (
            f"tandem: {counts} identical bearings on the two sides; bearings on the same side "
            f"share its load equally; {_set_preload_words(chosen.scene, a)}"
        )
    if asymmetries(chosen.scene):
        yield "radial load and tilt: the values in the scene apply to each bearing"
    if a.rotor_mass_kg is not None and a.span_mm is not None:
        inertia = " with the transverse inertia of a slender rod"
        if a.rotor_transverse_inertia_kg_mm2:
            inertia = ""
        yield f"natural frequencies: for a rigid rotor at standstill{inertia} (assumed)"


def _set_preload_words(scene: Scene, a: Arrangement) -> str:
    """Returns which force the preload of a set is, and the pair that gives it, in words."""
    preload = scene.operation.preload_N
    side_words = f"operation.preload_N, {preload:g} N, is the force of each side"
    if a.kind != "rigid_pair":
        return side_words
    ratio = set_preload_ratio(a.tandem)
    return (
        f"{side_words}; bearings matched for a pair of {plain(preload / ratio)} N give it, because "
        f"a set has {ratio:.3g} times the preload of the pair (if {preload:g} N is that of a pair, "
        f"set {plain(preload * ratio)} N)"
    )


def cage_sentences(chosen: Choice) -> Iterator[str]:
    """Yields a sentence on a cage that is missing or neglected."""
    if chosen.scene.cage is None:
        yield "cage: none in the scene"
    elif not chosen.cage:
        yield (
            "cage: neglected, including ball wear in the pockets; "
            "set model.cage_results: true to include it"
        )


def ball_sentences(chosen: Choice) -> Iterator[str]:
    """Yields sentences on the motion of the balls in the model, and on the forces on them."""
    scene = chosen.reduced(chosen.scene)
    count = chosen.scene.bearing.ball_count
    if chosen.fidelity == "steady":
        yield "balls: one ball represents all, because all balls move identically"
        yield from _force_sentences(scene)
    elif chosen.fidelity == "dynamic":
        yield from _dynamic_sentences(scene)
    else:
        yield (
            "ball motion: determined by Jones-Harris race control, without a friction balance; "
            "slip, QV and wear are estimates"
        )
        yield f"balls: {count}, each in equilibrium"
        if scene.operation.rotating_load_N:
            yield "rotating load: evaluated at the instant when it points along +Z"
        if scene.lubricant.drag_density_kg_m3:
            yield "lubricant drag: neglected, because race control excludes skidding"


def _force_sentences(scene: Scene) -> Iterator[str]:
    """Yields sentences on the forces on a ball; neglecting one saves no time."""
    share = centrifugal_share(scene)
    size = "its magnitude is unknown before the solve"
    if not math.isnan(share):
        share_words = (
            f"{plain(100.0 * share, 2)} % of" if share < 1.0 else f"{plain(share, 2)} times"
        )
        size = f"about {share_words} the contact load due to the preload at rest"
    yield f"centrifugal force: included; {size}"
    yield "gyroscopic moment: included"
    yield "lubricant drag: " + (
        "included" if scene.lubricant.drag_density_kg_m3 else "none in the scene"
    )
    yield "elastic micro-slip: not modelled; it would reduce QV by 2 to 5 %"


def _dynamic_sentences(scene: Scene) -> Iterator[str]:
    """Yields sentences on degrees of freedom, loads and cage of the dynamic model."""
    operation = scene.operation
    is_fixed = operation.preload_method == "fixed_position"
    loads = [] if is_fixed else [f"preload of {operation.preload_N:g} N"]
    if any(operation.radial_load_N):
        loads.append("radial load fixed in space")
    if operation.rotating_load_N:
        loads.append("radial load rotating with the shaft, initially along +Z")
    freedoms = "two translations, axially fixed" if is_fixed else "three translations"
    tilt = f"{operation.tilt_mrad:g} mrad about Y, constant" if operation.tilt_mrad else "none"
    yield (
        f"balls: {scene.bearing.ball_count}; the three rotations and the orbit of each are "
        "integrated in time, with its centre in equilibrium at each instant"
    )
    yield f"inner race: {freedoms}, in equilibrium at each instant"
    yield f"loads on the inner race: {', '.join(loads) or 'axial force alone'}"
    yield f"tilt of the inner race: {tilt}"
    yield from _force_sentences(scene)
    if len(set(scene.wear.ball_diameter_loss_um)) > 1:
        yield "ball diameters: individual, as worn"
    if scene.cage is not None:
        yield from _cage_motion_sentences(scene, scene.cage)
    yield (
        "Coriolis force and radial inertia of the balls: neglected, as in the published model; "
        "the energy balance includes the work done by the Coriolis force"
    )


def _cage_motion_sentences(scene: Scene, cage: Cage) -> Iterator[str]:
    """Yields sentences on the motion of a cage that is solved, and on the steps it requires."""
    guide = "balls" if cage.guiding_race == "ball" else f"land of the {cage.guiding_race} race"
    g = math.hypot(*scene.operation.gravity_m_s2)
    weight = "weightless, because operation.gravity_m_s2 is not given"
    if g:
        weight = f"gravity {g:.3g} m/s2"
    balance = f", imbalance {cage.imbalance_um:g} um" if cage.imbalance_um else ""
    yield f"cage: six degrees of freedom, guided by the {guide}; {weight}{balance}"
    tolerance = scene.model.dynamic_tolerance
    if tolerance > CAGE_TOLERANCE:
        yield f"steps: tolerance {tolerance:g}; cage wear requires 0.001"
    elif tolerance == CAGE_TOLERANCE:
        yield (
            "steps: tolerance 0.001, which gives cage wear to within 10 % as long as the "
            "motion persists"
        )


def solution_sentences(chosen: Choice) -> Iterator[str]:
    """Yields a sentence on how the dynamic model finds the motion."""
    scene = chosen.reduced(chosen.scene)
    if chosen.fidelity != "dynamic":
        return
    if seeks_periodic(scene):
        yield "motion: periodic, computed directly; the balls are evenly spaced, as with a cage"
    elif scene.model.dynamic_solution == "march":
        yield "motion: integrated in time until it settles (model.dynamic_solution)"
    else:
        why = why_not_periodic(scene) or "histories are requested (model.history_points_per_turn)"
        yield (
            "motion: integrated in time until it settles, with no search for a periodic motion; "
            f"reason: {why}"
        )
