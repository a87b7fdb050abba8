"""Makes the constant parts of the dynamic model from a scene."""

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from bearingwear.kernels.ball import ball_mass
from bearingwear.kernels.cage.body import INNER_LAND, NO_LAND, OUTER_LAND, CageModel
from bearingwear.kernels.contact.hertz import INNER, OUTER, point_contact, race_contact
from bearingwear.kernels.dynamic.model import BearingModel
from bearingwear.kernels.layout import state_layout
from bearingwear.kernels.params import Geometry
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.films import COVERED, Bare

HERTZ_INTERVALS = 64
LIGHT_IMPACT = 1e-3  # of the cage's surface speed
RAMP = 0.2  # of the depth of a light impact
LEAST_RAMP = 1e-9  # [m]
LEAST_CLEARANCE = 1e-3  # of a pocket, over the ball's radius
LARGEST_LAND, LARGEST_POCKET = 0.99, 3.0  # damping at which an impact hardly rebounds
DAMPING_ROUNDING = 1e-9  # accuracy of a damping, far below what restitutions are known to
LONGEST_IMPACT = 50.0  # time to look for its end, where the elastic one takes about 3


def _no_cage() -> CageModel:
    """Returns a model that is not present, with placeholders for all that a cage has."""
    placeholders: dict[str, Any] = dict.fromkeys(CageModel._fields, 1.0)
    vectors = {"gravity": (0.0, 0.0, 0.0), "turning": (0.0, 0.0)}
    return CageModel(**placeholders | vectors | {"present": False, "land": NO_LAND})


def pocket_stiffness(scene: Scene) -> float:
    """Returns Hertz' factor K of a ball in the wall of its pocket [N/m^1.5].

    It is a ball in a concave cylinder. Without clearance the ellipse would be a ring, so the
    cylinder is a little wider.
    """
    bearing, cage = scene.bearing, scene.cage
    assert cage is not None
    R = 0.5 * bearing.ball_diameter_mm * parameters.MM
    clearance = 0.5 * cage.pocket_clearance_mm * parameters.MM
    pocket = R + max(clearance, LEAST_CLEARANCE * R)
    materials = scene.materials
    E_star = parameters.contact_modulus(materials[bearing.ball_material], materials[cage.material])
    A, B = 0.5 * (1.0 / R - 1.0 / pocket), 0.5 / R
    return point_contact(A, B, E_star, math.nan).K


def land_stiffness(scene: Scene) -> float:
    """Returns the stiffness of one edge of a cage on its land, by half of its width [N/m].

    It is that of a line contact, times `model.land_stiffness_factor`.
    """
    cage, materials = scene.cage, scene.materials
    assert cage is not None
    race = materials[scene.bearing.race_material]
    E_star = parameters.contact_modulus(race, materials[cage.material])
    width = cage.width_mm * parameters.MM
    return scene.model.land_stiffness_factor * 0.25 * math.pi * E_star * 0.5 * width


def cage_of(scene: Scene) -> CageModel:
    """Returns geometry, inertia and contact laws of a scene's cage.

    Without a cage, `present` is False and all numbers are placeholders.
    """
    cage = scene.cage
    if cage is None:
        return _no_cage()
    bearing = scene.bearing
    material = scene.materials[cage.material]
    ball = scene.materials[bearing.ball_material]
    mm = parameters.MM
    r_i, r_o = 0.5 * cage.inner_diameter_mm * mm, 0.5 * cage.outer_diameter_mm * mm
    width = cage.width_mm * mm
    R, clearance = 0.5 * bearing.ball_diameter_mm * mm, 0.5 * cage.pocket_clearance_mm * mm
    # A ring less its pockets; the pockets take the same share of mass and inertia.
    ring = math.pi * (r_o**2 - r_i**2) * width
    pockets = bearing.ball_count * math.pi * (R + clearance) ** 2 * (r_o - r_i)
    mass = material.density_kg_m3 * (ring - pockets)
    K_pocket, k_land = pocket_stiffness(scene), land_stiffness(scene)
    land = {"outer": OUTER_LAND, "inner": INNER_LAND, "ball": NO_LAND}[cage.guiding_race]
    # A light impact sets the scale of depth in the contacts.
    operation = scene.operation
    speed = operation.fastest_rpm * parameters.RPM
    impact = LIGHT_IMPACT * 0.25 * bearing.pitch_diameter_mm * mm * speed
    m_ball = ball_mass(ball.density_kg_m3, 2.0 * R)
    m_eff = m_ball * mass / (m_ball + mass)
    pocket_depth = (1.25 * m_eff * impact**2 / K_pocket) ** 0.4  # of a Hertz impact
    g_x, g_y, g_z = operation.gravity_m_s2
    return CageModel(
        present=True,
        mass=mass,
        gravity=(float(g_x), float(g_y), float(g_z)),
        imbalance=cage.imbalance_um * parameters.UM,
        I_x=0.5 * mass * (r_i**2 + r_o**2),
        I_t=mass * (3.0 * (r_i**2 + r_o**2) + width**2) / 12.0,
        clearance=clearance,
        K_pocket=K_pocket,
        land=land,
        radius=r_i if land == INNER_LAND else r_o,
        gap=0.5 * cage.guide_clearance_mm * mm,
        half_width=0.5 * width,
        k_land=k_land,
        mu=float(scene.friction.cage),
        v_r=float(scene.friction.slip_regularisation_m_s),
        damping_pocket=pocket_damping(cage.restitution),
        # Both edges share the mass of a cage that meets the land squarely.
        damping_land=math.sqrt(0.5) * land_damping(cage.restitution),
        ramp_pocket=max(RAMP * pocket_depth, LEAST_RAMP),
        ramp_land=max(RAMP * impact * math.sqrt(mass / k_land), LEAST_RAMP),
        turning=(0.0, 0.0),  # see DynamicSystem.of
    )


def land_restitution(ratio: float) -> float:
    """Returns the restitution of a spring and a dashpot with a critical-damping ratio below 1.

    It solves delta'' + 2 ratio delta' + delta = 0 from delta = 0, delta' = 1 to where the force
    ends.
    """
    w = math.sqrt(1.0 - ratio**2)
    end = (math.pi - math.atan2(2.0 * ratio * w, 1.0 - 2.0 * ratio**2)) / w
    speed = math.cos(w * end) - ratio / w * math.sin(w * end)
    return -math.exp(-ratio * end) * speed


def pocket_restitution(damping: float) -> float:
    """Returns the restitution of a Hertz contact with damping.

    It solves delta'' + damping delta^(1/4) delta' + delta^(3/2) = 0 from delta = 0, delta' = 1 to
    where the force ends.
    """

    def rates(_, y):
        """Returns the derivatives of depth and speed."""
        d = max(y[0], 0.0)
        return y[1], -damping * d**0.25 * y[1] - d**1.5

    def reduced_force(_, y):
        """Returns the force over delta^(1/4), which falls through 0 where the force ends."""
        d = max(y[0], 0.0)
        return damping * y[1] + d**1.25

    setattr(reduced_force, "terminal", True)  # noqa: B010
    setattr(reduced_force, "direction", -1.0)  # noqa: B010
    path = solve_ivp(
        rates, (0.0, LONGEST_IMPACT), (0.0, 1.0), events=reduced_force, rtol=1e-9, atol=1e-12
    )
    return -path.y[1, -1]


@lru_cache
def land_damping(restitution: float) -> float:
    """Returns the critical-damping ratio of a land for a coefficient of restitution."""
    return _damping_for(land_restitution, restitution, LARGEST_LAND)


@lru_cache
def pocket_damping(restitution: float) -> float:
    """Returns the damping of a pocket for a restitution, as `pocket_restitution` takes it."""
    return _damping_for(pocket_restitution, restitution, LARGEST_POCKET)


def _damping_for(law: Callable[[float], float], restitution: float, largest: float) -> float:
    """Returns the damping at which a law gives a restitution: 0 for one of 1 or more.

    It is at most `largest`, also where the restitution is too low for that.

    law: returns the restitution by the damping, which falls from 1 at no damping.
    """
    if restitution >= 1.0:
        return 0.0
    if restitution <= law(largest):
        return largest
    return brentq(lambda damping: law(damping) - restitution, 0.0, largest, xtol=DAMPING_ROUNDING)


def exact_factors(g: Geometry, race: float, D: float, cos_alpha: float) -> tuple[float, ...]:
    """Returns Hertz factors K [N/m^1.5], c_a and c_b [m/N^(1/3)] of a contact with a race.

    race: `INNER` or `OUTER`.
    D: ball diameter [m].
    cos_alpha: cosine of the contact angle.
    """
    hertz = race_contact(g, race, D, cos_alpha, math.nan)
    return hertz.K, hertz.c_a, hertz.c_b


def hertz_table(g: Geometry, D: np.ndarray, factors_of=exact_factors) -> np.ndarray:
    """Returns Hertz factors of all contacts as cubic splines in the cosine of the contact angle.

    Shape (n, 2, HERTZ_INTERVALS, 12), see quasistatic.hertz_at. They depend on the angle so weakly
    that the spline is exact to rounding. Solving Hertz' equation each time would take a third of
    the time of a step.

    D: ball diameters (n,) [m].
    factors_of: function of the arguments of `exact_factors`, which returns K, c_a and c_b.
    """
    cosine = np.linspace(0.0, 1.0, HERTZ_INTERVALS + 1)
    powers = HERTZ_INTERVALS ** -np.arange(3.0, -1.0, -1.0)
    table = np.empty((len(D), 2, HERTZ_INTERVALS, 12))
    splines: dict[float, np.ndarray] = {}
    for j, diameter in enumerate(D):
        if diameter not in splines:
            factors = np.array(
                [[factors_of(g, race, diameter, c) for c in cosine] for race in (INNER, OUTER)]
            )
            coefficients = CubicSpline(cosine, factors, axis=1).c  # (4, intervals, race, factor)
            coefficients = coefficients * powers[:, None, None, None]
            splines[diameter] = np.moveaxis(coefficients, (2, 1, 3, 0), (0, 1, 2, 3)).reshape(
                2, -1, 12
            )
        table[j] = splines[diameter]
    return table


def bearing_model(scene: Scene, bare: Bare = COVERED) -> BearingModel:
    """Returns the model of a scene's bearing with its cage.

    bare: which contacts have no film left.
    """
    g = parameters.geometry(scene)
    operation = scene.operation
    D = parameters.ball_diameters(scene)
    mass = ball_mass(g.rho, D)
    F_y, F_z = operation.radial_load_N
    cage = cage_of(scene)
    return BearingModel(
        g=g,
        op=parameters.operating_point(scene, bare),
        D=D,
        mass=mass,
        inertia=0.1 * mass * D**2,  # of solid spheres
        hertz=hertz_table(g, D),
        axial_is_held=operation.preload_method != "constant_force",
        F_x=float(operation.preload_N),
        F_y=float(F_y),
        F_z=float(F_z),
        F_rot=float(operation.rotating_load_N),
        tilt=operation.tilt_mrad * 1e-3,
        cage=cage,
        traction=scene.model.includes_traction,
        rule=parameters.quadrature(scene),
        points=parameters.spread_points(scene),
        layout=state_layout(len(D), cage.present),
    )
