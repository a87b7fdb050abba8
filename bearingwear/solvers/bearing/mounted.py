"""The bearing as mounted: cold, at rest, unworn, in SI units."""

import math
from typing import NamedTuple

from bearingwear.kernels.params import Geometry
from bearingwear.scene.scene import Material, Scene, cached_in_scene

MM, UM, GPA = 1e-3, 1e-6, 1e9
RPM = math.pi / 30.0

STEEL_YIELD = 4.2
"""Contact pressure [GPa] that dents hardened steel by 1e-4 of the ball diameter: ISO 76."""


class YieldPressure(NamedTuple):
    """The contact pressure that dents a material, and its source in words."""

    GPa: float
    source: str


def yield_pressure(scene: Scene) -> YieldPressure:
    """Returns the yield pressure of the weaker of balls and races."""
    pressures = []
    for name in (scene.bearing.race_material, scene.bearing.ball_material):
        from_scene = scene.materials[name].yield_pressure_GPa
        origin = "from the scene" if from_scene else "assumed, from ISO 76 for steel"
        source = f"the yield pressure of {name} ({origin})"
        pressures.append(YieldPressure(from_scene or STEEL_YIELD, source))
    return min(pressures, key=lambda pressure: pressure.GPa)


def contact_modulus(first: Material, second: Material) -> float:
    """Returns E* [Pa] from 1/E* = (1-nu1^2)/E1 + (1-nu2^2)/E2."""
    flexibility = sum(
        (1.0 - m.poisson_ratio**2) / (m.youngs_modulus_GPa * GPA) for m in (first, second)
    )
    return 1.0 / flexibility


def groove_geometry(
    n_balls: int,
    D0: float,
    dm: float,
    alpha0: float,
    f_i: float,
    f_o: float,
    E_star: float,
    rho: float,
) -> Geometry:
    """Returns the geometry of an unworn bearing (theory.md section 2).

    D0, dm: ball diameter and pitch diameter [m].
    alpha0: free contact angle [rad].
    f_i, f_o: groove radii over the ball diameter.
    E_star, rho: contact modulus [Pa], and density of the balls [kg/m3].
    """
    return Geometry(
        n_balls=n_balls,
        D0=D0,
        dm=dm,
        alpha0=alpha0,
        BD=(f_i + f_o - 1.0) * D0,
        R_o=0.5 * dm - (f_o - 0.5) * D0 * math.cos(alpha0),
        R_i=0.5 * dm + (f_i - 0.5) * D0 * math.cos(alpha0),
        r_i=f_i * D0,
        r_o=f_o * D0,
        E_star=E_star,
        rho=rho,
    )


@cached_in_scene
def mounted_geometry(scene: Scene) -> Geometry:
    """Returns geometry and material constants of a scene's bearing as mounted."""
    b = scene.bearing
    ball, race = scene.materials[b.ball_material], scene.materials[b.race_material]
    return groove_geometry(
        n_balls=int(b.ball_count),
        D0=b.ball_diameter_mm * MM,
        dm=b.pitch_diameter_mm * MM,
        alpha0=math.radians(b.contact_angle_deg),
        f_i=float(b.inner_groove_factor),
        f_o=float(b.outer_groove_factor),
        E_star=contact_modulus(ball, race),
        rho=float(ball.density_kg_m3),
    )
