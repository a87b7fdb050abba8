"""Solves scenes far beyond the study and says how each one ends."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from bearingwear.io.config import scene_from_dict
from bearingwear.kernels import status as code
from bearingwear.kernels.equilibrium import cold_start, thrust_equilibrium
from bearingwear.kernels.kinematics import ORBIT
from bearingwear.kernels.params import BallLoad
from bearingwear.kernels.status import STATUS_NAMES
from bearingwear.model import parameters
from bearingwear.model.scene import Scene, most_balls
from bearingwear.model.solve import solved
from bearingwear.study.extremes import changed

CERAMIC = {
    "youngs_modulus_GPa": 310.0,
    "poisson_ratio": 0.26,
    "density_kg_m3": 3200.0,
    "brinell_hardness_GPa": 15.0,
    "wear_coefficient": 5.0e-6,
}

UNNAMED = (code.NOT_CONVERGED, code.UNVERIFIED)
"""Ends that give no physical reason."""


def scene_of(base: Mapping[str, Any], drawn: Mapping[str, Any]) -> Scene:
    """The scene that a draw stands for.

    Besides keys of a scene, a draw may hold: `ball_diameter_mm` and `pitch_ratio` (pitch over ball
    diameter), to which the cage is scaled; `fill` (ball count over the most that fit); `stress_GPa`
    (a preload that presses the outer contact so, at rest and unworn); `speed_m_s` (of the inner
    race at the pitch circle); `outer_ratio` (outer speed over shaft speed); `radial_ratio`, `rotating_ratio` (loads over the preload);
    `loss_ratio` (loss of ball diameter over the elastic approach of both races under the preload);
    `cage` (its guiding race, or none); `pocket_clearance_ratio`, `guide_clearance_ratio` (over the
    room there is).

    Raises
    ------
    SceneError
        Where there is no such bearing.
    """
    data = changed(base, drawn)
    b, operation = data["bearing"], data["operation"]
    data["materials"]["silicon_nitride"] = CERAMIC
    data["wear"]["end_of_life"] = None
    old = b["ball_diameter_mm"], b["pitch_diameter_mm"]
    D = b["ball_diameter_mm"] = drawn.get("ball_diameter_mm", old[0])
    dm = b["pitch_diameter_mm"] = D * drawn.get("pitch_ratio", old[1] / old[0])
    if "fill" in drawn:
        b["ball_count"] = max(3, math.floor(drawn["fill"] * most_balls(1.001 * D, dm)))
    if "speed_m_s" in drawn:
        operation["shaft_speed_rpm"] = drawn["speed_m_s"] / (0.5e-3 * dm) / parameters.RPM
    operation["outer_speed_rpm"] = drawn.get("outer_ratio", 0.0) * operation["shaft_speed_rpm"]
    _fit_cage(data, drawn, D, dm)
    data["wear"]["ball_diameter_loss_um"] = 0.0
    if "stress_GPa" in drawn or "loss_ratio" in drawn:
        scene = scene_from_dict(data)
        if "stress_GPa" in drawn:
            data["operation"]["preload_N"] = preload_of(scene, 1e9 * drawn["stress_GPa"])
            scene = scene_from_dict(data)
        if drawn.get("loss_ratio", 0.0) > 0.0:
            loss = 1e6 * drawn["loss_ratio"] * elastic_approach(scene)
            data["wear"]["ball_diameter_loss_um"] = min(loss, 0.099e3 * D)
    for name, key in (("radial_ratio", "radial_load_N"), ("rotating_ratio", "rotating_load_N")):
        load = drawn.get(name, 0.0) * data["operation"]["preload_N"]
        data["operation"][key] = [0.0, load] if key == "radial_load_N" else load
    return scene_from_dict(data)


def _fit_cage(data: dict[str, Any], drawn: Mapping[str, Any], D: float, dm: float) -> None:
    """A cage of the pitch circle's size, or none."""
    guide = drawn.get("cage", "none")
    if guide == "none":
        data["cage"] = None
        return
    cage = data["cage"]
    cage["guiding_race"] = guide
    cage["inner_diameter_mm"], cage["outer_diameter_mm"] = dm - 0.45 * D, dm + 0.45 * D
    cage["width_mm"] = 1.5 * D
    room = dm * math.sin(math.pi / data["bearing"]["ball_count"]) - D
    cage["pocket_clearance_mm"] = drawn.get("pocket_clearance_ratio", 0.1) * 0.9 * max(room, 0.0)
    cage["guide_clearance_mm"] = drawn.get("guide_clearance_ratio", 0.1) * 0.5 * D


def at_rest(scene: Scene):
    """One ball of the unworn bearing at rest under its preload alone."""
    g = parameters.geometry(scene)
    load = BallLoad(ORBIT, 0.0, 0.0, 0.0, 0.0, 0.0)
    _, state = thrust_equilibrium(
        g, g.D0, load, float(scene.operation.preload_N), 0.0, True, cold_start()
    )
    return g, state


def elastic_approach(scene: Scene) -> float:
    """Of both races to each other through a ball, at rest and unworn [m]."""
    _, state = at_rest(scene)
    return (state.Q_i / state.hertz_i.K) ** (2 / 3) + (state.Q_o / state.hertz_o.K) ** (2 / 3)


def preload_of(scene: Scene, pressure: float) -> float:
    """Preload that presses the outer contact with about this stress at the free angle [N]."""
    g, state = at_rest(scene)
    hertz = state.hertz_o
    Q = (pressure * math.pi * hertz.c_a * hertz.c_b / 1.5) ** 3
    return min(max(g.n_balls * Q * math.sin(max(g.alpha0, 0.1)), 1e-3), 1e5)


def wrongs(scene: Scene, tier: str, values: Mapping[str, Any]) -> list[str]:
    """What is wrong with a solve: nothing, where it ended as it may."""
    status = int(values["status"])
    if status in UNNAMED:
        return [STATUS_NAMES[status]]
    if status != code.OK:
        return []
    found = [
        f"{name} is not finite"
        for name, value in values.items()
        if not np.all(np.isfinite(np.asarray(value, dtype=float)))
    ]
    checks = {"equilibrium_residual": 1e-6 if tier == "dynamic" else 1e-9}
    if tier == "steady":
        checks |= {
            name: max(1e-9, min(1e-5, values[rounding]))
            for name, rounding in (
                ("equilibrium_residual", "equilibrium_rounding"),
                ("friction_residual", "friction_rounding"),
                ("power_balance_error", "power_rounding"),
            )
        }
    if tier == "dynamic":
        checks |= {"energy_account_error": 1e-3}
    found += [
        f"{name} {values[name]:.1e}"
        for name, most in checks.items()
        if not abs(values[name]) <= most
    ]
    heat, qv = values["friction_heat"], values["qv"]
    if tier != "dynamic" and not np.all(heat <= scene.friction.ball_race * qv * (1.0 + 1e-9)):
        found.append("more heat than mu QV")
    if scene.operation.preload_method == "constant_force":
        preload = scene.operation.preload_N
        if not abs(values["residual_preload"] / preload - 1.0) <= 1e-6:
            found.append(f"a spring of {preload:g} N holds {values['residual_preload']:g} N")
    return found


def solved_values(scene: Scene, tier: str) -> dict[str, Any]:
    """Values of a solve, as `bearingwear.solve` finds them."""
    return solved(scene, tier, None, None)[0]
