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
from bearingwear.scene.scene import Material, Scene, cached_in_scene
from bearingwear.scene.warmth import Fits, Temperature, expansion
from bearingwear.solvers.bearing.mounted import GPA, MM, RPM, UM


class Ring(NamedTuple):
    """A ring as a plane annulus that rotates."""

    inside: float  # radius [m]
    outside: float  # [m]
    E: float  # [Pa]
    nu: float
    rho: float  # [kg/m3]
    omega: float  # [rad/s]

    def growth_at_speed(self, r: float) -> float:
        """Returns the outward displacement at a radius by rotation, in plane stress [m].

        Timoshenko and Goodier, *Theory of Elasticity*, section 32; a full disc has no hole.
        """
        a2 = self.inside**2
        b2 = self.outside**2
        nu = self.nu
        hole = (1.0 + nu) * a2 * b2 / r**2 if a2 else 0.0
        shape = (1.0 - nu) * (a2 + b2) + hole - (1.0 - nu * nu) / (3.0 + nu) * r**2
        return (3.0 + nu) * self.rho * self.omega**2 * r * shape / (8.0 * self.E)

    def growth_under(self, p_in: float, p_out: float, r: float) -> float:
        """Returns the outward displacement at a radius under pressure on both faces [m].

        Lame's solution in plane stress.

        p_in, p_out: pressures on the inner and the outer face [Pa].
        """
        a2 = self.inside**2
        b2 = self.outside**2
        nu = self.nu
        uniform = (1.0 - nu) * (p_in * a2 - p_out * b2) * r
        hole = (1.0 + nu) * (p_in - p_out) * a2 * b2 / r if a2 else 0.0
        return (uniform + hole) / (self.E * (b2 - a2))


class Expansion(NamedTuple):
    """Thermal growth of the parts, relative [1]."""

    inner_ring: float = 0.0
    balls: float = 0.0
    outer_ring: float = 0.0
    shaft: float = 0.0  # of axial positions: 0 where they are as mounted
    housing: float = 0.0


class RingGrowth(NamedTuple):
    """Growth of a ring by rotation and by its fit."""

    speed: float = 0.0  # outward displacement of its track by rotation [m]
    fit: float = 0.0  # outward displacement of its track by the fit [m]
    pressure: float = 0.0  # on its seat [Pa]
    seat_lost: bool = False  # whether a fit that was tight at rest is loose


class Growth(NamedTuple):
    """Growth of the parts of a bearing."""

    heat: Expansion
    inner: RingGrowth
    outer: RingGrowth

    @property
    def is_none(self) -> bool:
        """Returns whether nothing changes the bearing as mounted."""
        displacements = (self.inner.speed, self.inner.fit, self.outer.speed, self.outer.fit)
        return not any((*self.heat, *displacements))


def temperatures(scene: Scene) -> Temperature:
    """Returns the temperatures of the parts, with a number for both rings and the balls.

    With a thermal network they are those without friction heat.
    """
    t = scene.temperature or Temperature()
    network = scene.thermal
    if network is not None:
        t = network.parts(
            network.shaft_C, 0.5 * (network.shaft_C + network.housing_C), network.housing_C
        )
    return _completed(t)


@functools.lru_cache(maxsize=64)  # used several times in each solve
def _completed(t: Temperature) -> Temperature:
    """Returns temperatures with the reference for rings and balls that have none."""
    parts = ("inner_ring_C", "balls_C", "outer_ring_C")
    return replace(t, **{name: t.reference_C for name in parts if getattr(t, name) is None})


def part_temperatures(scene: Scene) -> list[float]:
    """Returns inner ring, balls, outer ring, shaft and housing [degC]; NaN if as mounted."""
    t = temperatures(scene)
    parts = (t.inner_ring_C, t.balls_C, t.outer_ring_C, t.shaft_C, t.housing_C)
    return [math.nan if part is None else part for part in parts]


def thermal_expansion(scene: Scene) -> Expansion:
    """Returns the thermal strains of the parts; 0 where a part is as warm as when mounted [1]."""
    b = scene.bearing
    fits = scene.fits or Fits()
    t = temperatures(scene)

    def strain(part_C: float | None, material: str) -> float:
        """Returns the thermal strain of a part; 0 without a temperature."""
        return 0.0 if part_C is None else expansion(scene, material) * (part_C - t.reference_C)

    return Expansion(
        inner_ring=strain(t.inner_ring_C, b.race_material),
        balls=strain(t.balls_C, b.ball_material),
        outer_ring=strain(t.outer_ring_C, b.race_material),
        shaft=strain(t.shaft_C, fits.shaft_material or b.race_material),
        housing=strain(t.housing_C, fits.housing_material or b.race_material),
    )


def track_radius(scene: Scene, side: float) -> float:
    """Returns the radius of the track at the free contact angle [m].

    side: -1 for the inner race, +1 for the outer one.
    """
    b = scene.bearing
    cosine = math.cos(math.radians(b.contact_angle_deg))
    return 0.5 * MM * (b.pitch_diameter_mm + side * b.ball_diameter_mm * cosine)


def ring_of(material: Material, inside: float, outside: float, rpm: float) -> Ring:
    """Returns a ring of a material between two radii [m] at a speed [r/min]."""
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
    """Returns the growth of the inner ring by speed and fit.

    It is taken as a plane annulus from bore to track. Without a bore the ring is rigid and nothing
    grows; without fits it grows by speed alone.

    heat: thermal strains of the parts.
    bore: diameter [m].
    rpm: speed of the shaft [r/min].
    """
    if bore is None:
        return RingGrowth()
    seat = 0.5 * bore
    track = track_radius(scene, -1.0)
    ring = ring_of(scene.materials[scene.bearing.race_material], seat, track, rpm)
    speed = ring.growth_at_speed(track)
    if fits is None:
        return RingGrowth(speed=speed)
    shaft = _shaft(scene, fits, seat, rpm)
    at_rest, by_speed = _overlaps(scene, fits, heat, ring, shaft)
    overlap = at_rest + by_speed
    compliance = ring.growth_under(1.0, 0.0, seat) - shaft.growth_under(0.0, 1.0, seat)
    pressure = max(overlap, 0.0) / compliance
    fit = ring.growth_under(pressure, 0.0, track)
    is_lost = fits.shaft_interference_um > 0.0 and overlap <= 0.0
    return RingGrowth(speed, fit, pressure, seat_lost=is_lost)


def _shaft(scene: Scene, fits: Fits, seat: float, rpm: float) -> Ring:
    """Returns the shaft within the seat of the inner ring as a rotating annulus.

    seat: radius [m].
    rpm: speed [r/min].
    """
    material = scene.materials[fits.shaft_material or scene.bearing.race_material]
    return ring_of(material, 0.5 * MM * fits.shaft_bore_mm, seat, rpm)


def _overlaps(
    scene: Scene, fits: Fits, heat: Expansion, ring: Ring, shaft: Ring
) -> tuple[float, float]:
    """Returns the radial overlap of shaft and inner ring at rest, and its change by speed [m]."""
    seat = ring.inside
    t = temperatures(scene)
    shaft_strain = heat.shaft
    if t.shaft_C is None and t.inner_ring_C is not None:  # a shaft as warm as its ring
        material = fits.shaft_material or scene.bearing.race_material
        shaft_strain = expansion(scene, material) * (t.inner_ring_C - t.reference_C)
    at_rest = 0.5 * UM * fits.shaft_interference_um + seat * (shaft_strain - heat.inner_ring)
    return at_rest, shaft.growth_at_speed(seat) - ring.growth_at_speed(seat)


def fit_loss_speed(scene: Scene, bore: float, fits: Fits) -> float:
    """Returns the speed [r/min] at which the inner ring leaves its seat, at its temperatures.

    It is 0 without interference, and infinite where the shaft grows as much as the ring.

    bore: of the inner ring [m].
    """
    seat = 0.5 * bore
    material = scene.materials[scene.bearing.race_material]
    # at 1 r/min, so that the change of the overlap is per square of the speed
    ring = ring_of(material, seat, track_radius(scene, -1.0), 1.0)
    shaft = _shaft(scene, fits, seat, 1.0)
    at_rest, per_square = _overlaps(scene, fits, thermal_expansion(scene), ring, shaft)
    if at_rest <= 0.0:
        return 0.0
    return math.sqrt(at_rest / -per_square) if per_square < 0.0 else math.inf


def outer_growth(scene: Scene, heat: Expansion) -> RingGrowth:
    """Returns the growth of the outer ring by speed and fit, a plane annulus from track to outside.

    Without an outside diameter nothing grows; without fits it grows by speed alone. The housing is
    taken as infinitely thick. Speed does not change the fit, also if ring and housing turn.
    """
    b, fits = scene.bearing, scene.fits
    if b.outside_diameter_mm is None:
        return RingGrowth()
    seat = 0.5 * MM * b.outside_diameter_mm
    track = track_radius(scene, 1.0)
    ring_material = scene.materials[b.race_material]
    ring = ring_of(ring_material, track, seat, scene.operation.outer_speed_rpm)
    speed = ring.growth_at_speed(track)
    if fits is None:
        return RingGrowth(speed=speed)
    material = fits.housing_material or b.race_material
    housing = scene.materials[material]
    t = temperatures(scene)
    housing_strain = heat.housing
    if t.housing_C is None and t.outer_ring_C is not None:  # a housing as warm as its ring
        housing_strain = expansion(scene, material) * (t.outer_ring_C - t.reference_C)
    at_rest = 0.5 * UM * fits.housing_interference_um
    overlap = at_rest + seat * (heat.outer_ring - housing_strain)
    housing_compliance = seat * (1.0 + housing.poisson_ratio) / (housing.youngs_modulus_GPa * GPA)
    pressure = max(overlap, 0.0) / (housing_compliance - ring.growth_under(0.0, 1.0, seat))
    fit = ring.growth_under(0.0, pressure, track)
    return RingGrowth(speed, fit, pressure, seat_lost=at_rest > 0.0 and overlap <= 0.0)


@cached_in_scene
def growth_of(scene: Scene) -> Growth:
    """Returns the growth of a scene's bearing by heat, speed and fits."""
    bore = scene.bearing.bore_mm
    return growth_with_bore(scene, None if bore is None else bore * MM)


def growth_with_bore(scene: Scene, bore: float | None) -> Growth:
    """Returns the growth of a scene's bearing with a bore of the inner ring [m].

    Without a bore the ring is rigid.
    """
    return growth_with_fits(scene, bore, scene.fits)


def growth_with_fits(scene: Scene, bore: float | None, fits: Fits | None) -> Growth:
    """Returns the growth of a scene's bearing with a bore [m] and fits of the inner ring.

    The fit of the outer ring is that of the scene.
    """
    heat = thermal_expansion(scene)
    rpm = scene.operation.shaft_speed_rpm
    return Growth(heat, inner_growth(scene, heat, bore, fits, rpm), outer_growth(scene, heat))


def axial_change(
    heat: Expansion, A1: float, span: float = 0.0, orientation: str = "back_to_back"
) -> float:
    """Returns the change of the axial distance A1 of the groove centres by shaft and housing [m].

    The grooves of a symmetric pair, back to back, lie span - A1 apart on the shaft and span + A1
    apart in the housing. A longer shaft then reduces the preload; face to face it increases the
    preload. A single bearing is half of a pair without span: its A1 grows with the mean of shaft
    and housing.

    span: distance between the middles of the bearings [m].
    orientation: of the pair, back_to_back or face_to_face.
    """
    side = -1.0 if orientation == "back_to_back" else 1.0
    return 0.5 * (A1 * (heat.shaft + heat.housing) + side * span * (heat.shaft - heat.housing))


def grown_geometry(g: Geometry, growth: Growth, axial: float) -> Geometry:
    """Returns the geometry of the running bearing.

    `BD` and `alpha0` are length and direction of the line between the grown groove centres at axial
    displacement 0, so that Eq. (5) holds for the running bearing; the grooves touch the balls at
    another angle.

    g: geometry as mounted.
    axial: change of the axial distance of the groove centres [m].
    """
    heat = growth.heat
    moved_i = g.R_i * heat.inner_ring + growth.inner.speed + growth.inner.fit
    moved_o = g.R_o * heat.outer_ring + growth.outer.speed + growth.outer.fit
    outward = (g.r_o * heat.outer_ring - g.r_i * heat.inner_ring) * math.cos(g.alpha0)
    axial_distance = g.BD * math.sin(g.alpha0) + axial
    across = g.BD * math.cos(g.alpha0) + (moved_i - moved_o)
    return g._replace(
        D0=g.D0 * (1.0 + heat.balls),
        dm=g.dm + (moved_i + moved_o) + outward,
        alpha0=math.atan2(axial_distance, across),
        BD=math.hypot(axial_distance, across),
        R_o=g.R_o + moved_o,
        R_i=g.R_i + moved_i,
        r_i=g.r_i * (1.0 + heat.inner_ring),
        r_o=g.r_o * (1.0 + heat.outer_ring),
        rho=g.rho / (1.0 + heat.balls) ** 3,
    )


def is_held(scene: Scene) -> bool:
    """Returns whether the preload is that of a fixed position."""
    return scene.operation.preload_method == "fixed_position"


def growth_values(scene: Scene) -> dict[str, Any]:
    """Returns result variables of the growth, each where the scene has its cause; else empty.

    They are part_temperature [degC] and thermal_growth [1] with temperatures, growth_at_speed [m]
    where it is not 0, growth_by_fit [m] and fit_pressure [Pa] with fits. Those of rings have the
    order inner, outer.
    """
    growth = growth_of(scene)
    values = {}
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
    """Returns result variables of the growth that is constant along a life.

    They are empty for a pair, and where a thermal network changes the growth along the life.
    """
    return growth_values(scene) if scene.thermal is None and len(scene.sides) == 1 else {}
