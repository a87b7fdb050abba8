"""Scenes made from drawn values."""

import copy
import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from bearingwear.kernels.equilibrium.thrust_loaded import cold_start, orbit_load, thrust_equilibrium
from bearingwear.kernels.params import BallState, Geometry
from bearingwear.lives.groove_life import wear_over_gap
from bearingwear.scene.arrangement import PAIRS
from bearingwear.scene.changes import with_changes
from bearingwear.scene.read import scene_from_dict
from bearingwear.scene.scene import Scene, most_balls
from bearingwear.scene.warmth import LARGEST_STRAIN
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.mounted import mounted_geometry

_LARGEST_LOSS_UM = 0.099e3
"""Largest loss [um] for each mm of ball diameter: a scene refuses a tenth of the diameter."""

CERAMIC = {
    "youngs_modulus_GPa": 310.0,
    "poisson_ratio": 0.26,
    "density_kg_m3": 3200.0,
    "brinell_hardness_GPa": 15.0,
    "wear_coefficient": 5.0e-6,
    "thermal_expansion_1_K": 3.2e-6,
}


def with_values(base: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """Returns a copy of a scene's data with other values of its keys.

    base: plain data of a scene.
    values: by keys such as `operation.preload_N`; keys without a point are left out. The number of
        strips is rounded, the others are not checked.
    """
    changes = {key: value for key, value in values.items() if "." in key}
    if "model.strips" in changes:
        changes["model.strips"] = round(changes["model.strips"])  # a whole number
    return copy.deepcopy(with_changes(base, changes))


def without_cage_and_end(data: Mapping[str, Any]) -> dict[str, Any]:
    """Returns a scene's data without its cage and its end of life."""
    return {**data, "cage": None, "wear": {**data["wear"], "end_of_life": None}}


def drawn_scene(base: Mapping[str, Any], draw: Mapping[str, Any]) -> Scene:
    """Returns the scene of a draw.

    Besides keys of a scene, a draw may have: `ball_diameter_mm` and `pitch_ratio` (pitch over ball
    diameter), to which the cage is scaled; `fill` (ball count over the largest that fits);
    `stress_GPa` (pressure of the outer contact at rest and unworn, which gives the preload);
    `speed_m_s` (of the inner race at the pitch circle); `outer_ratio` (outer speed over shaft
    speed); `radial_ratio`, `rotating_ratio` (loads over the preload); `loss_ratio` (loss of ball
    diameter over the elastic approach of both races under the preload); `cage` (its guiding race,
    or none); `pocket_clearance_ratio`, `guide_clearance_ratio` (over the largest clearance);
    `warmth`: given temperatures, or those of the thermal network; `bore_ratio`, `outside_ratio`
    (over the diameter of the groove's bottom), `fit_ratio` (interference over the largest that is
    accepted); `pair` (its orientation, or none), with `external_ratio` (force on the rotor over the
    preload), `spring_ratio` (stiffness of the spring times the elastic approach, over the preload),
    `second_loss_ratio` (as `loss_ratio`, in the second bearing) and `in_tandem` (bearings on the
    first side); `worn_ratio` (loss that ends the life, over the gap at the edge of a contact).

    base: plain data of the scene that the draw changes.
    SceneError: the draw makes no valid bearing.
    """
    data = with_values(base, draw)
    data["materials"]["silicon_nitride"] = CERAMIC
    data["wear"]["end_of_life"] = None
    data["wear"]["ball_diameter_loss_um"] = 0.0
    _set_size_and_speed(data, draw)
    D, dm = data["bearing"]["ball_diameter_mm"], data["bearing"]["pitch_diameter_mm"]
    _fit_cage(data, draw, D, dm)
    _warm(data, draw, D, dm)
    _set_preload_and_loss(data, draw, D)
    preload = data["operation"]["preload_N"]
    data["operation"]["radial_load_N"] = [0.0, draw.get("radial_ratio", 0.0) * preload]
    data["operation"]["rotating_load_N"] = draw.get("rotating_ratio", 0.0) * preload
    if draw.get("pair", "none") != "none":
        data["arrangement"] = _drawn_pair(data, draw, D)
    if "worn_ratio" in draw:
        data["wear"]["end_of_life"] = _end_of_life(data, draw["worn_ratio"], D)
    return scene_from_dict(data)


def _set_size_and_speed(data: dict[str, Any], draw: Mapping[str, Any]) -> None:
    """Sets the drawn diameters, number of balls and speeds in a scene's data.

    Values that are not drawn stay, but the outer race, which then does not turn.

    draw: drawn values; see `drawn_scene`.
    """
    bearing, operation = data["bearing"], data["operation"]
    pitch_ratio = bearing["pitch_diameter_mm"] / bearing["ball_diameter_mm"]
    D = draw.get("ball_diameter_mm", bearing["ball_diameter_mm"])
    dm = D * draw.get("pitch_ratio", pitch_ratio)
    bearing["ball_diameter_mm"] = D
    bearing["pitch_diameter_mm"] = dm
    if "fill" in draw:
        # a little larger balls, lest they touch
        bearing["ball_count"] = max(3, math.floor(draw["fill"] * most_balls(1.001 * D, dm)))
    if "speed_m_s" in draw:
        operation["shaft_speed_rpm"] = draw["speed_m_s"] / (0.5e-3 * dm) / parameters.RPM
    operation["outer_speed_rpm"] = draw.get("outer_ratio", 0.0) * operation["shaft_speed_rpm"]


def _set_preload_and_loss(data: dict[str, Any], draw: Mapping[str, Any], D: float) -> None:
    """Sets the drawn preload and loss of ball diameter in a scene's data, if they are drawn.

    The loss is at most `_LARGEST_LOSS_UM`.

    draw: drawn values; see `drawn_scene`.
    D: ball diameter [mm].
    """
    if "stress_GPa" in draw or "loss_ratio" in draw:
        scene = scene_from_dict(data)
        if "stress_GPa" in draw:
            data["operation"]["preload_N"] = preload_at_pressure(scene, 1e9 * draw["stress_GPa"])
            scene = scene_from_dict(data)
        if draw.get("loss_ratio", 0.0) > 0.0:
            loss_um = 1e6 * draw["loss_ratio"] * elastic_approach(scene)
            data["wear"]["ball_diameter_loss_um"] = min(loss_um, _LARGEST_LOSS_UM * D)


def _end_of_life(data: dict[str, Any], worn_ratio: float, D: float) -> dict[str, float]:
    """Returns the end of life of a scene's data: limits of the loss and of the residual preload.

    It replaces the end of life in the data by a preliminary one.

    worn_ratio: further loss, over the gap at the edge of a contact.
    D: ball diameter [mm].
    """
    present_um = data["wear"]["ball_diameter_loss_um"]
    data["wear"]["end_of_life"] = {"ball_diameter_loss_um": present_um + 1.0}
    scene = scene_from_dict(data)
    scene = replace(scene, operation=replace(scene.operation, preload_method="constant_force"))
    gaps_of_1_um = wear_over_gap(scene)  # of 1 um beyond the present loss
    loss_um = present_um + worn_ratio / gaps_of_1_um
    return {
        "ball_diameter_loss_um": min(loss_um, _LARGEST_LOSS_UM * D),
        "preload_fraction": 0.4,
    }


def _drawn_pair(data: dict[str, Any], draw: Mapping[str, Any], D: float) -> dict[str, Any]:
    """Returns the arrangement of a pair, as plain data; the preload method decides its kind.

    Its rotor has a mass of 30 g, and the bearings are five ball diameters apart.

    data: of the scene of a bearing.
    draw: drawn values; see `drawn_scene`.
    D: ball diameter [mm].
    """
    scene = scene_from_dict(data)
    preload = data["operation"]["preload_N"]
    approach = elastic_approach(scene)
    kind = PAIRS[scene.operation.preload_method]
    arrangement: dict[str, Any] = {
        "kind": kind,
        "orientation": draw["pair"],
        "external_axial_N": draw.get("external_ratio", 0.0) * preload,
        "rotor_mass_kg": 0.03,
        "span_mm": 5.0 * D,
        "tandem": [draw.get("in_tandem", 1), 1],
    }
    if kind == "spring_pair":
        stiffness = 1e-6 * draw.get("spring_ratio", 0.0) * preload / approach
        arrangement["spring_stiffness_N_um"] = min(stiffness, 1e6)
    if "second_loss_ratio" in draw:
        loss_um = 1e6 * draw["second_loss_ratio"] * approach
        arrangement["second"] = {"wear.ball_diameter_loss_um": min(loss_um, _LARGEST_LOSS_UM * D)}
    return arrangement


def _fit_cage(data: dict[str, Any], draw: Mapping[str, Any], D: float, dm: float) -> None:
    """Scales the cage in a scene's data to the balls, or removes it.

    The cage is usual for its balls: 0.45 D on either side of the pitch circle, and 1.5 D wide. The
    largest clearances are 0.9 of the gap between two balls in a pocket, and 0.5 D at the land.

    draw: drawn values; see `drawn_scene`.
    D, dm: diameters of balls and pitch circle [mm].
    """
    guide = draw.get("cage", "none")
    if guide == "none":
        data["cage"] = None
        return
    cage = data["cage"]
    cage["guiding_race"] = guide
    cage["inner_diameter_mm"] = dm - 0.45 * D
    cage["outer_diameter_mm"] = dm + 0.45 * D
    cage["width_mm"] = 1.5 * D
    gap = dm * math.sin(math.pi / data["bearing"]["ball_count"]) - D
    cage["pocket_clearance_mm"] = draw.get("pocket_clearance_ratio", 0.1) * 0.9 * max(gap, 0.0)
    cage["guide_clearance_mm"] = draw.get("guide_clearance_ratio", 0.1) * 0.5 * D


def _warm(data: dict[str, Any], draw: Mapping[str, Any], D: float, dm: float) -> None:
    """Sets the source of temperatures in a scene's data, and rings and fits for the pitch circle.

    Without a drawn `warmth`, it changes nothing.

    draw: drawn values; see `drawn_scene`.
    D, dm: diameters of balls and pitch circle [mm].
    """
    if "warmth" not in draw:
        return
    bearing = data["bearing"]
    data["thermal" if draw["warmth"] == "given" else "temperature"] = None
    data["materials"]["bearing_steel"]["thermal_expansion_1_K"] = 11.5e-6
    bearing["bore_mm"] = bore = draw["bore_ratio"] * (dm - D)
    bearing["outside_diameter_mm"] = outside = draw["outside_ratio"] * (dm + D)
    largest_fit = 1e3 * LARGEST_STRAIN * draw["fit_ratio"]
    data["fits"] = {
        "shaft_interference_um": largest_fit * bore,
        "housing_interference_um": largest_fit * outside,
    }


def at_rest(scene: Scene) -> tuple[Geometry, BallState]:
    """Returns geometry and state of a ball of the unworn bearing at rest under its preload."""
    geometry = mounted_geometry(scene)
    no_load = orbit_load(0.0, 0.0, 0.0)
    # from a displacement of 0, under a constant force
    _, state = thrust_equilibrium(
        geometry, geometry.D0, no_load, float(scene.operation.preload_N), 0.0, True, cold_start()
    )
    return geometry, state


def elastic_approach(scene: Scene) -> float:
    """Returns the elastic approach of both races through a ball, at rest and unworn [m]."""
    _, state = at_rest(scene)
    return (state.Q_i / state.hertz_i.K) ** (2 / 3) + (state.Q_o / state.hertz_o.K) ** (2 / 3)


def preload_at_pressure(scene: Scene, pressure: float) -> float:
    """Returns the preload [N] at which the outer contact has about a pressure [Pa], at rest.

    The Hertz factors are those under the scene's preload, and the contact angle is the free one, at
    least 0.1 rad. The result is limited to the range from 1e-3 to 1e5 N, which a scene may have.
    """
    geometry, state = at_rest(scene)
    hertz = state.hertz_o
    # pressure = 1.5 Q / (pi a b) with the semi-axes a = c_a Q^(1/3), b = c_b Q^(1/3)
    Q = (pressure * math.pi * hertz.c_a * hertz.c_b / 1.5) ** 3
    return min(max(geometry.n_balls * Q * math.sin(max(geometry.alpha0, 0.1)), 1e-3), 1e5)
