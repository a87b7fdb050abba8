"""How warm the parts of a bearing are, and how its rings are fitted: keys of a scene."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

from bearingwear.scene.blocks import STEEL_EXPANSION
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.records import NAME, keyed, setting

if TYPE_CHECKING:
    from bearingwear.scene.blocks import Bearing
    from bearingwear.scene.scene import Scene

_DEGREES = "[-273.15, 1000]"
_CONDUCTANCE = "[1e-6, 1e6]"
_CAPACITY = "[1e-9, 1e9]"
_AS_REFERENCE = "(if omitted, the mounting temperature)"

LARGEST_STRAIN = 0.01
"""Thermal expansion of a part, relative, beyond which a scene is refused."""


@keyed
class Temperature:
    """Given temperatures of the parts; each key says what None means."""

    # fmt: off
    inner_ring_C: float | None = setting(f"Temperature of the inner ring {_AS_REFERENCE}", "degC",
        _DEGREES, default=None)
    outer_ring_C: float | None = setting(f"Temperature of the outer ring {_AS_REFERENCE}", "degC",
        _DEGREES, default=None)
    balls_C: float | None = setting(f"Temperature of the balls {_AS_REFERENCE}", "degC", _DEGREES,
        default=None)
    shaft_C: float | None = setting("Temperature of the shaft (if omitted, axial positions are as "
        "mounted, and the fit is computed with the temperature of the inner ring)", "degC",
        _DEGREES, default=None)
    housing_C: float | None = setting("Temperature of the housing (if omitted, axial positions are "
        "as mounted, and the fit is computed with the temperature of the outer ring)", "degC",
        _DEGREES, default=None)
    # fmt: on
    reference_C: float = setting("Mounting temperature", "degC", _DEGREES, default=20.0)


@keyed
class Conductance:
    """Conductances that carry the heat away."""

    # fmt: off
    inner_ring_shaft: float = setting("Conductance from the inner ring to the shaft", "W/K",
        _CONDUCTANCE)
    outer_ring_housing: float = setting("Conductance from the outer ring to the housing", "W/K",
        _CONDUCTANCE)
    ball_race: float = setting("Total conductance from the balls to each ring", "W/K",
        _CONDUCTANCE)
    # fmt: on


@keyed
class HeatCapacity:
    """Heat that parts take up as they warm."""

    # fmt: off
    inner_ring: float = setting("Heat capacity of the inner ring", "J/K", _CAPACITY)
    balls: float = setting("Heat capacity of all balls", "J/K", _CAPACITY)
    outer_ring: float = setting("Heat capacity of the outer ring", "J/K", _CAPACITY)
    # fmt: on


@keyed
class Thermal:
    """A network that finds the temperatures of the rings and balls from the friction heat."""

    conductance_W_K: Conductance = setting(
        "Conductances through which the friction heat is removed"
    )
    shaft_C: float = setting("Constant temperature of the shaft", "degC", _DEGREES, default=20.0)
    housing_C: float = setting(
        "Constant temperature of the housing", "degC", _DEGREES, default=20.0
    )
    reference_C: float = setting("Mounting temperature", "degC", _DEGREES, default=20.0)
    # fmt: off
    heat_capacity_J_K: HeatCapacity | None = setting(
        "Heat capacities of the parts, which a warm-up requires", default=None)
    shaft_time_constant_s: float = setting("Time constant with which the shaft approaches shaft_C "
        "from the mounting temperature in a warm-up (0: at once)", "s", "[0, 1e9]", default=0.0)
    housing_time_constant_s: float = setting("Time constant with which the housing approaches "
        "housing_C from the mounting temperature in a warm-up (0: at once)", "s", "[0, 1e9]",
        default=0.0)
    # fmt: on

    def parts(self, inner_ring: float, balls: float, outer_ring: float) -> Temperature:
        """Returns the temperatures of all parts from those of rings and balls [degC].

        Shaft, housing and reference have the temperatures of the network.
        """
        return Temperature(
            inner_ring_C=inner_ring,
            balls_C=balls,
            outer_ring_C=outer_ring,
            shaft_C=self.shaft_C,
            housing_C=self.housing_C,
            reference_C=self.reference_C,
        )


@keyed
class Fits:
    """Seats of the rings; a ring without a seat is free to grow."""

    # fmt: off
    shaft_interference_um: float = setting(
        "Shaft diameter minus bore, at rest and at mounting temperature", "um", "[-5000, 5000]",
        default=0.0)
    housing_interference_um: float = setting(
        "Outside diameter minus housing bore, at rest and at mounting temperature", "um",
        "[-5000, 5000]", default=0.0)
    shaft_bore_mm: float = setting("Bore diameter of the shaft (0 if solid)", "mm", "[0, 20000]",
        default=0.0)
    shaft_material: str | None = setting(
        "Material of the shaft (if omitted, that of the races)", pattern=NAME, default=None)
    housing_material: str | None = setting(
        "Material of the housing, which is assumed to be thick-walled (if omitted, that of the "
        "races)",
        pattern=NAME,
        default=None)
    # fmt: on


def expansion(scene: Scene, material: str) -> float:
    """Returns the coefficient of thermal expansion of a material of a scene [1/K].

    It is that of bearing steel where the scene does not state it.
    """
    coefficient = scene.materials[material].thermal_expansion_1_K
    return STEEL_EXPANSION if coefficient is None else coefficient


def check_warmth(scene: Scene) -> None:
    """Refuses temperatures, networks and fits that contradict the rest of a scene."""
    if scene.temperature is not None and scene.thermal is not None:
        raise SceneError(
            "thermal",
            "got thermal and temperature, expected only one of them",
            ("temperature",),
        )
    _check_fits(scene)
    _check_expansions(scene)
    _check_play(scene)


def _check_fits(scene: Scene) -> None:
    """Refuses fits without the diameter of their ring, and those that strain it too much."""
    if scene.fits is None:
        return
    _check_ring_diameters(scene.fits, scene.bearing)
    _check_interferences(scene.fits, scene.bearing)


def _check_ring_diameters(fits: Fits, bearing: Bearing) -> None:
    """Refuses fits of rings without the diameter of their seat, and a shaft bored too wide."""
    for name, ring in (
        ("shaft_interference_um", "bore_mm"),
        ("shaft_bore_mm", "bore_mm"),
        ("housing_interference_um", "outside_diameter_mm"),
    ):
        value = getattr(fits, name)
        if value and getattr(bearing, ring) is None:
            problem = f"got {value:g}; only allowed with bearing.{ring}"
            raise SceneError(f"fits.{name}", problem, (f"bearing.{ring}",))
    if bearing.bore_mm is not None and fits.shaft_bore_mm >= bearing.bore_mm:
        raise SceneError(
            "fits.shaft_bore_mm",
            f"got {fits.shaft_bore_mm:g}, expected a number < {bearing.bore_mm:g}, "
            "the bore of the ring",
            ("bearing.bore_mm",),
        )


def _check_interferences(fits: Fits, bearing: Bearing) -> None:
    """Refuses interferences that strain a ring by more than `LARGEST_STRAIN`."""
    for name, diameter in (
        ("shaft_interference_um", bearing.bore_mm),
        ("housing_interference_um", bearing.outside_diameter_mm),
    ):
        if diameter is None:
            continue
        value = getattr(fits, name)
        limit = 1e3 * LARGEST_STRAIN * diameter  # [um], of a diameter in mm
        if abs(value) > limit:
            raise SceneError(
                f"fits.{name}",
                f"got {value:g}, expected a number from {-limit:g} to {limit:g} "
                f"({100.0 * LARGEST_STRAIN:g} % of the diameter)",
                ("bearing.bore_mm", "bearing.outside_diameter_mm"),
            )


def _check_expansions(scene: Scene) -> None:
    """Refuses missing expansions of unlike materials, and parts that expand too much."""
    if scene.temperature is None and scene.thermal is None:
        return
    bearing, fits = scene.bearing, scene.fits or Fits()
    ring = bearing.race_material
    for material, key in (
        (bearing.ball_material, "bearing.ball_material"),
        (fits.shaft_material or ring, "fits.shaft_material"),
        (fits.housing_material or ring, "fits.housing_material"),
    ):
        if material == ring:
            continue
        for name in (material, ring):
            if scene.materials[name].thermal_expansion_1_K is None:
                raise SceneError(
                    f"materials.{name}.thermal_expansion_1_K",
                    "got nothing, expected a number from 0 to 1e-4 if temperatures are given for "
                    "parts of different materials",
                    (key, "temperature", "thermal"),
                )
    for part in _heated_parts(scene):
        alpha = expansion(scene, part.material)
        if abs(alpha * part.heating) > LARGEST_STRAIN:
            limit = LARGEST_STRAIN / alpha
            block, _, _ = part.key.partition(".")
            raise SceneError(
                part.key,
                f"got a difference of {abs(part.heating):g} K from the mounting temperature, "
                f"expected at most {limit:.4g} K for {part.material} "
                f"({100.0 * LARGEST_STRAIN:g} % expansion)",
                (f"{block}.reference_C", f"materials.{part.material}"),
            )


def _check_play(scene: Scene) -> None:
    """Refuses temperatures at which the balls become as wide as a groove."""
    temperature, bearing = scene.temperature, scene.bearing
    if temperature is None:
        return
    reference_C = temperature.reference_C
    balls_C = reference_C if temperature.balls_C is None else temperature.balls_C
    ball_growth = 1.0 + expansion(scene, bearing.ball_material) * (balls_C - reference_C)
    for ring, groove_factor, stated_C in (
        ("inner", bearing.inner_groove_factor, temperature.inner_ring_C),
        ("outer", bearing.outer_groove_factor, temperature.outer_ring_C),
    ):
        ring_C = reference_C if stated_C is None else stated_C
        ring_growth = 1.0 + expansion(scene, bearing.race_material) * (ring_C - reference_C)
        if groove_factor * ring_growth / ball_growth <= 0.5:
            raise SceneError(
                f"temperature.{ring}_ring_C",
                f"got {ring_C:g} with balls at {balls_C:g} degC; only allowed if the groove "
                f"remains wider than the balls (bearing.{ring}_groove_factor {groove_factor:g})",
                ("temperature.balls_C", f"bearing.{ring}_groove_factor"),
            )


class _HeatedPart(NamedTuple):
    """A part whose temperature a scene states."""

    key: str  # of its temperature
    material: str
    heating: float  # above the mounting temperature [K]


def _heated_parts(scene: Scene) -> Iterator[_HeatedPart]:
    """Yields the parts whose temperatures the blocks `temperature` or `thermal` state."""
    bearing, fits = scene.bearing, scene.fits or Fits()
    materials = {
        "inner_ring_C": bearing.race_material,
        "outer_ring_C": bearing.race_material,
        "balls_C": bearing.ball_material,
        "shaft_C": fits.shaft_material or bearing.race_material,
        "housing_C": fits.housing_material or bearing.race_material,
    }
    for block, temperatures in (("temperature", scene.temperature), ("thermal", scene.thermal)):
        if temperatures is None:
            continue
        for name, material in materials.items():
            value = getattr(temperatures, name, None)  # a network states no rings and balls
            if value is not None:
                yield _HeatedPart(f"{block}.{name}", material, value - temperatures.reference_C)


def check_heat_capacities(sides: Sequence[Scene], name: str) -> None:
    """Raises SceneError for bearings without heat capacities, or whose shaft does not turn.

    Such bearings have no warm-up.

    sides: a scene of a single bearing for each side of a pair.
    name: of the scene's file, for the SceneError.
    """
    for side in sides:
        if side.thermal is None:
            problem = "got nothing, expected a thermal network with heat_capacity_J_K"
            raise SceneError("thermal", problem, source=name)
        if side.thermal.heat_capacity_J_K is None:
            problem = "got nothing, expected heat capacities of inner_ring, balls and outer_ring"
            raise SceneError("thermal.heat_capacity_J_K", problem, source=name)
        if not side.operation.shaft_speed_rpm:
            problem = "got 0, expected a speed that a warm-up leads to"
            raise SceneError("operation.shaft_speed_rpm", problem, source=name)
