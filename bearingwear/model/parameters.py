"""The factory: from a scene (units in the names) to what kernels take (SI, radians)."""

import functools
import math

import numpy as np

from bearingwear.kernels.ellipse import SEGMENTS, Rule
from bearingwear.kernels.params import Geometry, OperatingPoint
from bearingwear.model.quadrature import equal_strips, gathered, gauss_halves
from bearingwear.scene.scene import Material, Scene

MM, UM, GPA = 1e-3, 1e-6, 1e9
RPM = math.pi / 30.0
FEWEST_SPLIT = 20  # with fewer the points' own motion upsets the balance that they measure


def contact_modulus(first: Material, second: Material) -> float:
    """1/E* = (1-nu1^2)/E1 + (1-nu2^2)/E2 [Pa]."""
    flexibility = sum(
        (1.0 - m.poisson_ratio**2) / (m.youngs_modulus_GPa * GPA) for m in (first, second)
    )
    return 1.0 / flexibility


def geometry(scene: Scene) -> Geometry:
    """Groove geometry and material pair of a scene."""
    b = scene.bearing
    ball, race = scene.materials[b.ball_material], scene.materials[b.race_material]
    D0 = b.ball_diameter_mm * MM
    dm = b.pitch_diameter_mm * MM
    alpha0 = math.radians(b.contact_angle_deg)
    f_i, f_o = float(b.inner_groove_factor), float(b.outer_groove_factor)
    return Geometry(
        n_balls=int(b.ball_count),
        D0=D0,
        dm=dm,
        alpha0=alpha0,
        BD=(f_i + f_o - 1.0) * D0,
        R_o=0.5 * dm - (f_o - 0.5) * D0 * math.cos(alpha0),
        R_i=0.5 * dm + (f_i - 0.5) * D0 * math.cos(alpha0),
        r_i=f_i * D0,
        r_o=f_o * D0,
        E_star=contact_modulus(ball, race),
        rho=float(ball.density_kg_m3),
    )


def operating_point(scene: Scene) -> OperatingPoint:
    """Speeds and friction of a scene."""
    return OperatingPoint(
        omega_i=scene.operation.shaft_speed_rpm * RPM,
        omega_o=scene.operation.outer_speed_rpm * RPM,
        mu=float(scene.friction.ball_race),
        v_r=float(scene.friction.slip_regularisation_m_s),
        drag=float(scene.lubricant.drag_density_kg_m3),
    )


def ball_diameters(scene: Scene) -> np.ndarray:
    """Worn diameter of every ball (n_balls,) [m]."""
    loss = np.array(scene.wear.ball_diameter_loss_um, dtype=float) * UM
    return np.broadcast_to(
        scene.bearing.ball_diameter_mm * MM - loss, (scene.bearing.ball_count,)
    ).copy()


@functools.cache
def ellipse_rule(name: str, points: int) -> Rule:
    """A rule with so many points (split: at the most); shared, so never to be written to."""
    if name == "split":
        return Rule(True, *gathered(-(-points // SEGMENTS)))
    return Rule(False, *{"gauss": gauss_halves, "strips": equal_strips}[name](points))


def quadrature(scene: Scene, refined: int = 1) -> Rule:
    """The rule of a scene for the contact ellipse, with so many times its points."""
    name, points = scene.model.quadrature, scene.model.strips
    return ellipse_rule(name, refined * (max(points, FEWEST_SPLIT) if name == "split" else points))


def wear_factors(scene: Scene) -> tuple[float, float]:
    """K_s/H of ball and race [1/Pa]."""
    b = scene.bearing
    ball, race = (
        m.wear_coefficient / (m.brinell_hardness_GPa * GPA)
        for m in (scene.materials[b.ball_material], scene.materials[b.race_material])
    )
    return ball, race
