"""Makes arguments of the kernels (SI, radians) from a scene (units in the names)."""

import functools
import math
from dataclasses import replace
from typing import Any

import numpy as np

from bearingwear.kernels.contact.ellipse_friction import EllipsePoints
from bearingwear.kernels.contact.friction import Law
from bearingwear.kernels.contact.points import SEGMENTS, Rule
from bearingwear.kernels.contact.profile import MIDDLE_WIDTH, PEAK
from bearingwear.kernels.equilibrium.thrust_loaded import static_displacement
from bearingwear.kernels.params import Geometry, OperatingPoint
from bearingwear.scene.scene import Arrangement, Scene, cached_in_scene
from bearingwear.solvers.bearing import quadrature as rules
from bearingwear.solvers.bearing.films import COVERED, MPA, Bare, Films
from bearingwear.solvers.bearing.growth import Growth, axial_change, grown_geometry, growth_of
from bearingwear.solvers.bearing.mounted import GPA as GPA
from bearingwear.solvers.bearing.mounted import MM as MM
from bearingwear.solvers.bearing.mounted import RPM as RPM
from bearingwear.solvers.bearing.mounted import UM as UM
from bearingwear.solvers.bearing.mounted import contact_modulus as contact_modulus
from bearingwear.solvers.bearing.mounted import mounted_geometry

SEARCH_POINTS = 16  # along the ellipse, at a v_r that these resolve
SEARCH_ACROSS = 4
FEWEST_SPLIT = 20  # with fewer the points' own motion upsets the balance that they measure


@cached_in_scene
def static_place(scene: Scene) -> float:
    """Returns the axial displacement of the bearing as mounted, under its preload alone [m].

    A fixed position keeps it, whatever grows or wears afterwards. 0 without a preload.
    """
    if not scene.operation.preload_N:  # no load at any place with play: the solver finds a far one
        return 0.0
    return static_displacement(mounted_geometry(scene), float(scene.operation.preload_N))


@cached_in_scene
def geometry(scene: Scene) -> Geometry:
    """Returns geometry and material constants of a scene's bearing as it runs, warm and fitted."""
    return running_geometry(scene, growth_of(scene))


def running_geometry(scene: Scene, growth: Growth) -> Geometry:
    """Returns geometry and material constants of a scene's bearing with some growth."""
    g = mounted_geometry(scene)
    if growth.is_none:
        return g
    axial_growth = 0.0
    if growth.heat.shaft or growth.heat.housing:
        arrangement = scene.arrangement or Arrangement()
        span = MM * (arrangement.span_mm or 0.0)
        A1 = g.BD * math.sin(g.alpha0) + static_place(scene)
        axial_growth = axial_change(growth.heat, A1, span, arrangement.orientation)
    return grown_geometry(g, growth, axial_growth)


def operating_point(scene: Scene, bare: Bare = COVERED) -> OperatingPoint:
    """Returns speeds and friction of a scene, some of its contacts without film."""
    return OperatingPoint(
        omega_i=scene.operation.shaft_speed_rpm * RPM,
        omega_o=scene.operation.outer_speed_rpm * RPM,
        v_r=float(scene.friction.slip_regularisation_m_s),
        drag=float(scene.lubricant.drag_density_kg_m3),
        law_i=friction_law(scene, bare[0]),
        law_o=friction_law(scene, bare[1]),
    )


def friction_law(scene: Scene, bare: bool = False) -> Law:
    """Returns the friction law of balls and races.

    bare: whether the film is worn through.
    """
    film = scene.friction.film
    if film is None:
        mu = scene.friction.coefficient
        S = 0.0
    elif bare and film.bare_ball_race is not None:
        mu = film.bare_ball_race
        S = 0.0
    else:
        mu = film.pressure_coefficient
        S = film.shear_strength_MPa * MPA
    return Law(mu=float(mu), S=float(S))


def where_bare(problem: Any, scene: Scene, bare: Bare) -> Any:
    """Returns a problem with the friction of a scene, some of its contacts without film.

    problem: a dataclass with an `OperatingPoint` in its field `op`.
    bare: which contacts have no film left.
    """
    if not any(bare):
        return problem
    laws = {"law_i": friction_law(scene, bare[0]), "law_o": friction_law(scene, bare[1])}
    return replace(problem, op=problem.op._replace(**laws))


def ball_diameters(scene: Scene) -> np.ndarray:
    """Returns the worn diameter of every ball as it runs (n_balls,) [m]."""
    return worn_diameters(scene, geometry(scene))


def worn_diameters(scene: Scene, g: Geometry) -> np.ndarray:
    """Returns the worn diameter of every ball in a geometry (n_balls,) [m]."""
    loss = np.array(scene.wear.ball_diameter_loss_um, dtype=float) * UM
    return np.broadcast_to(g.D0 - loss, (scene.bearing.ball_count,)).copy()


@functools.cache
def ellipse_rule(name: str, points: int, across: int = 1) -> Rule:
    """Returns a rule of points over the contact ellipse.

    Callers share it and must not write to it.

    name: "split", "strips" or "gauss", as in `model.quadrature` of a scene.
    points: number along the major axis. "gauss" makes it even; "split" has ceil(points/SEGMENTS) in
        each segment that is used.
    across: points across each strip; 1 is the line model.
    """
    if name == "split":
        m = math.ceil(points / SEGMENTS)
        y, share = rules.chebyshev_halves(across)
        t, weight = rules.gathered_points(m)
        return Rule(
            split=True,
            t=t,
            weight=weight,
            tip=rules.root_factors(m),
            across=y,
            share=share,
            even=rules.area_shares_across(y, halves=True),
        )
    y, share = rules.chebyshev(across)
    if name == "strips":
        t, weight = rules.equal_strips(points)
        tip = rules.strip_area_factors(points)
    else:
        t, weight = rules.gauss_halves(points)
        half = rules.root_factors((points + 1) // 2)
        tip = np.concatenate([half[::-1], half])
    return Rule(
        split=False,
        t=t,
        weight=weight,
        tip=tip,
        across=y,
        share=share,
        even=rules.area_shares_across(y, halves=False),
    )


def quadrature(scene: Scene, refined: int = 1) -> Rule:
    """Returns the rule of a scene for the contact ellipse.

    refined: factor on its points along the centre line. If slip is evaluated over the whole
        ellipse, it counts both along and across, at most 2 each.
    """
    model = scene.model
    name = model.quadrature
    strips = max(model.strips, FEWEST_SPLIT) if name == "split" else model.strips
    if model.slip_region == "line":
        return ellipse_rule(name, refined * strips)
    refined = min(refined, 2)
    return ellipse_rule(name, refined * strips, refined * model.points_across)


def line_points(rule: Rule) -> EllipsePoints:
    """Returns a split rule with one point across as `EllipsePoints`."""
    middle = np.zeros(rule.t.size)
    area = MIDDLE_WIDTH * rule.weight
    return EllipsePoints(
        split=True,
        s=rule.t,
        weight=PEAK * rule.weight,
        y=middle,
        moved=middle,
        area=area,
        tip=rule.tip,
    )


def spread_points(scene: Scene, refined: int = 1) -> EllipsePoints:
    """Returns the points at which the motion in time sums friction.

    They cost less than those of the rule and are as accurate.

    refined: factor on the points, as in `quadrature`.
    """
    rule = quadrature(scene, refined)
    if rule.split and rule.across.size > 1:
        return rules.spread_ellipse(rule.t.size, rule.across.size)
    if rule.split:
        return line_points(rule)
    return rules.spread_fixed(rule)


def search_rule(scene: Scene) -> Rule:
    """Returns the rule for the search of other steady states: coarse, with fixed points."""
    rule = quadrature(scene)
    is_coarse = not rule.split and rule.t.size <= SEARCH_POINTS
    across = min(rule.across.size, SEARCH_ACROSS)
    return rule if is_coarse else ellipse_rule("gauss", SEARCH_POINTS, across)


def wear_factors(scene: Scene) -> tuple[float, float]:
    """Returns K_s/H of ball and race when new, the larger of both contacts [1/Pa]."""
    films = Films.of(scene)
    ball, race = (float(np.max(part)) for part in films.contact_factors(films.thickness > 0.0))
    return ball, race
