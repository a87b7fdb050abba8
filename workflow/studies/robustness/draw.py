"""Scenes made from drawn values."""

import copy
import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from bearingwear.kernels.equilibrium.thrust_loaded import cold_start, orbit_load, thrust_equilibrium
from bearingwear.lives.groove_life import wear_over_gap
from bearingwear.scene.arrangement import PAIRS
from bearingwear.scene.changes import with_changes
from bearingwear.scene.read import scene_from_dict
from bearingwear.scene.scene import Scene, most_balls
from bearingwear.scene.warmth import LARGEST_STRAIN
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.mounted import mounted_geometry

CERAMIC = {
    "youngs_modulus_GPa": 310.0,
    "poisson_ratio": 0.26,
    "density_kg_m3": 3200.0,
    "brinell_hardness_GPa": 15.0,
    "wear_coefficient": 5.0e-6,
    "thermal_expansion_1_K": 3.2e-6,
}


def with_values(base: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """Returns a scene's data with keys like `operation.preload_N` replaced."""
    keys = {
        # a scene refuses 31.7 strips
        key: round(value) if key == "model.strips" else value
        for key, value in values.items()
        if "." in key
    }
    return copy.deepcopy(with_changes(base, keys))


def bare(data: dict[str, Any]) -> dict[str, Any]:
    """Removes cage and end of life from a scene's data."""
    data["cage"], data["wear"]["end_of_life"] = None, None
    return data


def drawn_scene(base: Mapping[str, Any], draw: Mapping[str, Any]) -> Scene:
    """Makes the scene of a draw.

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

    SceneError: the draw makes no valid bearing.
    """
    data = with_values(base, draw)
    bearing, operation = data["bearing"], data["operation"]
    data["materials"]["silicon_nitride"] = CERAMIC
    data["wear"]["end_of_life"] = None
    pitch_ratio = bearing["pitch_diameter_mm"] / bearing["ball_diameter_mm"]
    D = bearing["ball_diameter_mm"] = draw.get("ball_diameter_mm", bearing["ball_diameter_mm"])
    dm = bearing["pitch_diameter_mm"] = D * draw.get("pitch_ratio", pitch_ratio)
    if "fill" in draw:
        bearing["ball_count"] = max(3, math.floor(draw["fill"] * most_balls(1.001 * D, dm)))
    if "speed_m_s" in draw:
        operation["shaft_speed_rpm"] = draw["speed_m_s"] / (0.5e-3 * dm) / parameters.RPM
    operation["outer_speed_rpm"] = draw.get("outer_ratio", 0.0) * operation["shaft_speed_rpm"]
    _fit_cage(data, draw, D, dm)
    _warm(data, draw, D, dm)
    data["wear"]["ball_diameter_loss_um"] = 0.0
    if "stress_GPa" in draw or "loss_ratio" in draw:
        scene = scene_from_dict(data)
        if "stress_GPa" in draw:
            data["operation"]["preload_N"] = preload_at_pressure(scene, 1e9 * draw["stress_GPa"])
            scene = scene_from_dict(data)
        if draw.get("loss_ratio", 0.0) > 0.0:
            loss = 1e6 * draw["loss_ratio"] * elastic_approach(scene)
            data["wear"]["ball_diameter_loss_um"] = min(loss, 0.099e3 * D)
    for name, key in (("radial_ratio", "radial_load_N"), ("rotating_ratio", "rotating_load_N")):
        load = draw.get(name, 0.0) * data["operation"]["preload_N"]
        data["operation"][key] = [0.0, load] if key == "radial_load_N" else load
    if draw.get("pair", "none") != "none":
        data["arrangement"] = _drawn_pair(data, draw, D)
    if "worn_ratio" in draw:
        data["wear"]["end_of_life"] = _end_of_life(data, draw["worn_ratio"], D)
    return scene_from_dict(data)


def _end_of_life(data: dict[str, Any], worn_ratio: float, D: float) -> dict[str, float]:
    """Returns limits of the loss, counted from the present one, and of the residual preload."""
    present = data["wear"]["ball_diameter_loss_um"]
    data["wear"]["end_of_life"] = {"ball_diameter_loss_um": present + 1.0}
    scene = scene_from_dict(data)
    scene = replace(scene, operation=replace(scene.operation, preload_method="constant_force"))
    by_um = wear_over_gap(scene)
    return {
        "ball_diameter_loss_um": min(present + worn_ratio / by_um, 0.099e3 * D),
        "preload_fraction": 0.4,
    }


def _drawn_pair(data: dict[str, Any], draw: Mapping[str, Any], D: float) -> dict[str, Any]:
    """Returns a pair with the drawn differences; its kind follows from the preload method."""
    scene, preload = scene_from_dict(data), data["operation"]["preload_N"]
    approach = elastic_approach(scene)
    method = scene.operation.preload_method
    kind = PAIRS[method]
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
        loss = min(1e6 * draw["second_loss_ratio"] * approach, 0.099e3 * D)
        arrangement["second"] = {"wear.ball_diameter_loss_um": loss}
    return arrangement


def _fit_cage(data: dict[str, Any], draw: Mapping[str, Any], D: float, dm: float) -> None:
    """Scales the cage to the pitch circle, or removes it."""
    guide = draw.get("cage", "none")
    if guide == "none":
        data["cage"] = None
        return
    cage = data["cage"]
    cage["guiding_race"] = guide
    cage["inner_diameter_mm"], cage["outer_diameter_mm"] = dm - 0.45 * D, dm + 0.45 * D
    cage["width_mm"] = 1.5 * D
    gap = dm * math.sin(math.pi / data["bearing"]["ball_count"]) - D
    cage["pocket_clearance_mm"] = draw.get("pocket_clearance_ratio", 0.1) * 0.9 * max(gap, 0.0)
    cage["guide_clearance_mm"] = draw.get("guide_clearance_ratio", 0.1) * 0.5 * D


def _warm(data: dict[str, Any], draw: Mapping[str, Any], D: float, dm: float) -> None:
    """Sets the source of the temperatures, and rings and fits of the pitch circle's size."""
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


def at_rest(scene: Scene):
    """Returns geometry and state of a ball of the unworn bearing at rest under its preload."""
    geometry = mounted_geometry(scene)
    load = orbit_load(0.0, 0.0, 0.0)
    _, state = thrust_equilibrium(
        geometry, geometry.D0, load, float(scene.operation.preload_N), 0.0, True, cold_start()
    )
    return geometry, state


def elastic_approach(scene: Scene) -> float:
    """Returns the elastic approach of both races through a ball, at rest and unworn [m]."""
    _, state = at_rest(scene)
    return (state.Q_i / state.hertz_i.K) ** (2 / 3) + (state.Q_o / state.hertz_o.K) ** (2 / 3)


def preload_at_pressure(scene: Scene, pressure: float) -> float:
    """Returns the preload at which the outer contact has about this pressure, at rest [N]."""
    geometry, state = at_rest(scene)
    hertz = state.hertz_o
    Q = (pressure * math.pi * hertz.c_a * hertz.c_b / 1.5) ** 3
    return min(max(geometry.n_balls * Q * math.sin(max(geometry.alpha0, 0.1)), 1e-3), 1e5)
