"""Growth of the bearing by heat, speed and fits (theory.md section 18).

Warm rings grow as a whole, groove circle and groove radius. Speed and fits stretch a ring along
its circumference: its section moves outwards, and the groove radius stays. Only lengths change;
the mass of the balls and the elastic constants stay.
"""

import functools
import math
from dataclasses import replace
from typing import Any, NamedTuple

from bearingwear.kernels.params import Geometry
from bearingwear.scene.scene import Material, Scene, once
from bearingwear.scene.warmth import Fits, Temperature, expansion
from bearingwear.solvers.bearing.mounted import GPA, MM, RPM, UM


class Ring(NamedTuple):
    """A ring as a plane annulus, and how it turns."""

    inside: float  # radius [m]
    outside: float  # [m]
    E: float  # [Pa]
    nu: float
    rho: float  # [kg/m3]
    omega: float  # [rad/s]

    def growth_at_speed(self, r: float) -> float:
        """Outward displacement at a radius by rotation, plane stress [m].

        Timoshenko and Goodier, *Theory of Elasticity*, section 32; a full disc has no hole.
        """
        a2, b2, nu = self.inside**2, self.outside**2, self.nu
        hole = (1.0 + nu) * a2 * b2 / r**2 if a2 else 0.0
        shape = (1.0 - nu) * (a2 + b2) + hole - (1.0 - nu * nu) / (3.0 + nu) * r**2
        return (3.0 + nu) * self.rho * self.omega**2 * r * shape / (8.0 * self.E)

    def growth_under(self, p_in: float, p_out: float, r: float) -> float:
        """Outward displacement at a radius under pressure on both faces [m]; Lame, plane stress."""
        a2, b2, nu = self.inside**2, self.outside**2, self.nu
        even = (1.0 - nu) * (p_in * a2 - p_out * b2) * r
        hole = (1.0 + nu) * (p_in - p_out) * a2 * b2 / r if a2 else 0.0
        return (even + hole) / (self.E * (b2 - a2))


class Expansion(NamedTuple):
    """Thermal growth of the parts, relative [1]."""

    inner_ring: float = 0.0
    balls: float = 0.0
    outer_ring: float = 0.0
    shaft: float = 0.0  # of axial positions: 0 where they are as mounted
    housing: float = 0.0


class RingGrowth(NamedTuple):
    speed: float = 0.0  # outward displacement of its track [m]
    fit: float = 0.0  # the same
    pressure: float = 0.0  # on its seat [Pa]
    seat_lost: bool = False  # a fit that was tight at rest is no more


class Growth(NamedTuple):
    heat: Expansion
    inner: RingGrowth
    outer: RingGrowth

    @property
    def nothing(self) -> bool:
        moved = (self.inner.speed, self.inner.fit, self.outer.speed, self.outer.fit)
        return not any((*self.heat, *moved))


def temperatures(scene: Scene) -> Temperature:
    """Temperatures of the parts, with a number for every ring and the balls."""
    t, held = scene.temperature or Temperature(), scene.thermal
    if held is not None:  # before the friction heat is known
        t = held.parts(held.shaft_C, 0.5 * (held.shaft_C + held.housing_C), held.housing_C)
    return _with_numbers(t)


@functools.lru_cache(maxsize=64)  # asked for several times in each solve
def _with_numbers(t: Temperature) -> Temperature:
    parts = ("inner_ring_C", "balls_C", "outer_ring_C")
    return replace(t, **{name: t.reference_C for name in parts if getattr(t, name) is None})


def part_temperatures(scene: Scene) -> list[float]:
    """Inner ring, balls, outer ring, shaft, housing [degC]; NaN of one as mounted."""
    t = temperatures(scene)
    parts = (t.inner_ring_C, t.balls_C, t.outer_ring_C, t.shaft_C, t.housing_C)
    return [math.nan if part is None else part for part in parts]


def thermal_expansion(scene: Scene) -> Expansion:
    b, fits, t = scene.bearing, scene.fits or Fits(), temperatures(scene)

    def strain(part_C: float | None, material: str) -> float:
        return 0.0 if part_C is None else expansion(scene, material) * (part_C - t.reference_C)

    return Expansion(
        inner_ring=strain(t.inner_ring_C, b.race_material),
        balls=strain(t.balls_C, b.ball_material),
        outer_ring=strain(t.outer_ring_C, b.race_material),
        shaft=strain(t.shaft_C, fits.shaft_material or b.race_material),
        housing=strain(t.housing_C, fits.housing_material or b.race_material),
    )


def track_radius(scene: Scene, side: float) -> float:
    """Radius of the track of the free contact angle, side -1 inner, +1 outer [m]."""
    b = scene.bearing
    cosine = math.cos(math.radians(b.contact_angle_deg))
    return 0.5 * MM * (b.pitch_diameter_mm + side * b.ball_diameter_mm * cosine)


def ring_of(material: Material, inside: float, outside: float, rpm: float) -> Ring:
    """A ring of a material between two radii [m]."""
    return Ring(
        inside=inside,
        outside=outside,
        E=material.youngs_modulus_GPa * GPA,
        nu=material.poisson_ratio,
        rho=material.density_kg_m3,
        omega=rpm * RPM,
    )


def inner_growth(
    scene: Scene, heat: Expansion, bore: float | None, fits: Fits | None, rpm: float
) -> RingGrowth:
    """Growth of the inner ring by speed [r/min] and fit, a plane annulus from bore [m] to track."""
    if bore is None:
        return RingGrowth()
    seat, track = 0.5 * bore, track_radius(scene, -1.0)
    ring = ring_of(scene.materials[scene.bearing.race_material], seat, track, rpm)
    speed = ring.growth_at_speed(track)
    if fits is None:
        return RingGrowth(speed=speed)
    shaft = _shaft(scene, fits, seat, rpm)
    slow, fast = _overlaps(scene, fits, heat, ring, shaft)
    overlap = slow + fast
    soft = ring.growth_under(1.0, 0.0, seat) - shaft.growth_under(0.0, 1.0, seat)
    pressure = max(overlap, 0.0) / soft
    fit = ring.growth_under(pressure, 0.0, track)
    lost = fits.shaft_interference_um > 0.0 and overlap <= 0.0
    return RingGrowth(speed, fit, pressure, seat_lost=lost)


def _shaft(scene: Scene, fits: Fits, seat: float, rpm: float) -> Ring:
    material = scene.materials[fits.shaft_material or scene.bearing.race_material]
    return ring_of(material, 0.5 * MM * fits.shaft_bore_mm, seat, rpm)


def _overlaps(
    scene: Scene, fits: Fits, heat: Expansion, ring: Ring, shaft: Ring
) -> tuple[float, float]:
    """Overlap of shaft and inner ring in radius without rotation, and its change by speed [m]."""
    seat, t, warmer = ring.inside, temperatures(scene), heat.shaft
    if t.shaft_C is None and t.inner_ring_C is not None:  # a shaft as warm as its ring
        material = fits.shaft_material or scene.bearing.race_material
        warmer = expansion(scene, material) * (t.inner_ring_C - t.reference_C)
    slow = 0.5 * UM * fits.shaft_interference_um + seat * (warmer - heat.inner_ring)
    return slow, shaft.growth_at_speed(seat) - ring.growth_at_speed(seat)


def speed_that_takes_the_fit(scene: Scene, bore: float, fits: Fits) -> float:
    """Speed [r/min] at which the inner ring leaves its seat on the shaft, at its temperatures.

    By its bore [m]. 0 without interference, infinite where the shaft grows as much as the ring.
    """
    seat, material = 0.5 * bore, scene.materials[scene.bearing.race_material]
    ring = ring_of(material, seat, track_radius(scene, -1.0), 1.0)
    shaft = _shaft(scene, fits, seat, 1.0)
    slow, per_square = _overlaps(scene, fits, thermal_expansion(scene), ring, shaft)
    if slow <= 0.0:
        return 0.0
    return math.sqrt(slow / -per_square) if per_square < 0.0 else math.inf


def outer_growth(scene: Scene, heat: Expansion) -> RingGrowth:
    """Growth of the outer ring by speed and fit, a plane annulus from track to outside.

    Its housing is thick. Where both turn, the fit is taken as at rest.
    """
    b, fits = scene.bearing, scene.fits
    if b.outside_diameter_mm is None:
        return RingGrowth()
    seat, track = 0.5 * MM * b.outside_diameter_mm, track_radius(scene, 1.0)
    steel = scene.materials[b.race_material]
    ring = ring_of(steel, track, seat, scene.operation.outer_speed_rpm)
    speed = ring.growth_at_speed(track)
    if fits is None:
        return RingGrowth(speed=speed)
    material = fits.housing_material or b.race_material
    m, t = scene.materials[material], temperatures(scene)
    warmer = heat.housing
    if t.housing_C is None and t.outer_ring_C is not None:  # a housing as warm as its ring
        warmer = expansion(scene, material) * (t.outer_ring_C - t.reference_C)
    at_rest = 0.5 * UM * fits.housing_interference_um
    overlap = at_rest + seat * (heat.outer_ring - warmer)
    thick = seat * (1.0 + m.poisson_ratio) / (m.youngs_modulus_GPa * GPA)
    pressure = max(overlap, 0.0) / (thick - ring.growth_under(0.0, 1.0, seat))
    fit = ring.growth_under(0.0, pressure, track)
    return RingGrowth(speed, fit, pressure, seat_lost=at_rest > 0.0 and overlap <= 0.0)


@once
def growth_of(scene: Scene) -> Growth:
    """All that changes the bearing as mounted."""
    bore = scene.bearing.bore_mm
    return growth_with_bore(scene, None if bore is None else bore * MM)


def growth_with_bore(scene: Scene, bore: float | None) -> Growth:
    """`growth_of` with a bore of the inner ring [m], which is rigid without one."""
    return growth_with_fits(scene, bore, scene.fits)


def growth_with_fits(scene: Scene, bore: float | None, fits: Fits | None) -> Growth:
    """`growth_with_bore` with other fits of the inner ring than the scene's."""
    heat, rpm = thermal_expansion(scene), scene.operation.shaft_speed_rpm
    return Growth(heat, inner_growth(scene, heat, bore, fits, rpm), outer_growth(scene, heat))


def axial_change(
    heat: Expansion, A1: float, span: float = 0.0, orientation: str = "back_to_back"
) -> float:
    """Change of the axial distance A1 of a bearing's groove centres by its shaft and housing [m].

    The inner grooves of a symmetric pair lie span - A1 apart on the shaft and the outer ones span +
    A1 in the housing, back to back: a longer shaft takes preload away. Face to face it adds
    preload. The span is that between the middles of the bearings [m]. A single bearing is half of a
    pair of no span: its own offset grows with the mean of shaft and housing.
    """
    side = -1.0 if orientation == "back_to_back" else 1.0
    return 0.5 * (A1 * (heat.shaft + heat.housing) + side * span * (heat.shaft - heat.housing))


def grown(g: Geometry, growth: Growth, axial: float) -> Geometry:
    """Geometry of the running bearing, from `g` as mounted.

    `BD` and `alpha0` are length and direction of the line between the grown groove centres at axial
    displacement 0, so that Eq. (5) holds for the running bearing; the grooves touch the balls at
    another angle. `axial` is the change of the axial distance of the groove centres [m].
    """
    heat = growth.heat
    moved_i = g.R_i * heat.inner_ring + growth.inner.speed + growth.inner.fit
    moved_o = g.R_o * heat.outer_ring + growth.outer.speed + growth.outer.fit
    wider = (g.r_o * heat.outer_ring - g.r_i * heat.inner_ring) * math.cos(g.alpha0)
    axial_distance = g.BD * math.sin(g.alpha0) + axial
    across = g.BD * math.cos(g.alpha0) + (moved_i - moved_o)
    return g._replace(
        D0=g.D0 * (1.0 + heat.balls),
        dm=g.dm + (moved_i + moved_o) + wider,
        alpha0=math.atan2(axial_distance, across),
        BD=math.hypot(axial_distance, across),
        R_o=g.R_o + moved_o,
        R_i=g.R_i + moved_i,
        r_i=g.r_i * (1.0 + heat.inner_ring),
        r_o=g.r_o * (1.0 + heat.outer_ring),
        rho=g.rho / (1.0 + heat.balls) ** 3,
    )


def is_held(scene: Scene) -> bool:
    """Whether the preload is that of a fixed position."""
    return scene.operation.preload_method == "fixed_position"


def growth_values(scene: Scene) -> dict[str, Any]:
    """Result variables of the growth; none where the bearing runs as mounted."""
    growth, values = growth_of(scene), {}
    if scene.temperature is not None:
        values["part_temperature"] = part_temperatures(scene)
        values["thermal_growth"] = list(growth.heat)
    rings = (growth.inner, growth.outer)
    if any(ring.speed for ring in rings):
        values["growth_at_speed"] = [ring.speed for ring in rings]
    if scene.fits is not None:
        values["growth_by_fit"] = [ring.fit for ring in rings]
        values["fit_pressure"] = [ring.pressure for ring in rings]
    return values


def lasting_growth(scene: Scene) -> dict[str, Any]:
    """`growth_values` of a life, if the bearing grows alike all along; none of a pair."""
    return growth_values(scene) if scene.thermal is None and len(scene.sides) == 1 else {}
