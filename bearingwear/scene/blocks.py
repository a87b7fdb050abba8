"""The blocks of a scene: the bearing, how it runs, and its wear.

Plain frozen data. The field names are the keys of a scene file, so the unit is in the name and
nothing is converted here (`bearingwear.solvers.bearing.parameters` does that).
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import Any

from bearingwear.measures import ENDS
from bearingwear.scene.checking.records import NAME, Key, keyed, optional_numbers, setting
from bearingwear.scene.friction import Film, RunningIn
from bearingwear.scene.new.catalogue import MAKERS

COUNTS = ("ball", "ball_and_races")
"""What a life may count as loss: the wear of the ball alone, or that of the races as well."""

PRELOAD_METHODS = ("constant_force", "fixed_position")
"""How the preload is applied: by a spring, or by a fixed distance of the rings."""

MATERIAL = "a name under materials"

STEEL_EXPANSION = 11.5e-6
"""Thermal expansion [1/K] of bearing steel, taken where a material has none."""

_RING = "(0, 20000]"


@keyed
class Bearing:
    """Nominal, unworn geometry."""

    # fmt: off
    maker: str | None = setting("Maker whose catalogue gives the speed limits",
        choices=tuple(MAKERS), default=None)
    designation: str | None = setting(
        "Designation (if a maker is given, as in that maker's catalogue; see `bearingwear new "
        "--list`)",
        longest=40, default=None)
    ball_count: int = setting("Number of balls (they must fit side by side on the pitch circle)",
        "1", "[3, 1000]", example="15")
    ball_diameter_mm: float = setting("Nominal (unworn) ball diameter", "mm", "[0.1, 500]",
        example="8.4")
    pitch_diameter_mm: float = setting("Pitch diameter (must exceed the ball diameter)", "mm",
        "[0.2, 10000]", example="54")
    contact_angle_deg: float = setting("Free contact angle (unloaded, unworn)", "degree", "[0, 80]",
        example="15")
    inner_groove_factor: float = setting("Ratio of the groove radius of the inner race to the "
        "ball diameter", "1",
        "(0.5, 1]", example="0.52")
    outer_groove_factor: float = setting("Ratio of the groove radius of the outer race to the "
        "ball diameter", "1",
        "(0.5, 1]", example="0.53")
    ball_material: str = setting("Material of the balls", pattern=NAME, allowed=MATERIAL,
        example="bearing_steel")
    race_material: str = setting("Material of both races", pattern=NAME, allowed=MATERIAL,
        example="bearing_steel")
    bore_mm: float | None = setting(
        "Bore of the inner ring, used to compute its growth at speed and to warn of high hoop "
        "stress", "mm",
        _RING, default=None)
    outside_diameter_mm: float | None = setting(
        "Outside diameter of the outer ring, used to compute its growth if it rotates", "mm",
        _RING, default=None)
    inner_shoulder_mm: float | None = setting("Shoulder diameter of the inner ring on the loaded "
        "side, used to warn if the contact ellipse extends beyond it", "mm", _RING, default=None)
    outer_shoulder_mm: float | None = setting(
        "Shoulder diameter of the outer ring on the loaded side, used to warn if the contact "
        "ellipse extends beyond it", "mm", _RING, default=None)
    # fmt: on


@keyed
class Material:
    """Elastic, inertial and wear properties of one material."""

    youngs_modulus_GPa: float = setting("Young's modulus", "GPa", "[0.001, 2000]", example="208")
    poisson_ratio: float = setting("Poisson's ratio", "1", "[0, 0.5)", example="0.3")
    density_kg_m3: float = setting("Density", "kg/m3", "[10, 30000]", example="7800")
    # fmt: off
    brinell_hardness_GPa: float = setting("Brinell hardness as a pressure, H in Archard's law",
        "GPa", "[0.001, 100]", example="6.6")
    wear_coefficient: float = setting("Dimensionless wear coefficient, K_s in Archard's law",
        "1", "(0, 1]", example="5.0e-6")
    yield_pressure_GPa: float | None = setting("Maximum contact pressure without denting, used for "
        "a warning (default: 4.2, from ISO 76 for steel and assumed for other materials)",
        "GPa",
        "(0, 100]", default=None)
    thermal_expansion_1_K: float | None = setting(
        "Coefficient of linear thermal expansion (if omitted, that of bearing steel, "
        f"{STEEL_EXPANSION:g}, is assumed; required if materials differ and temperatures are "
        "given)", "1/K", "[0, 1e-4]", default=None)
    film: Film | None = setting(
        "A solid film on the balls or races of this material (none if omitted)", default=None)
    running_in: RunningIn | None = setting("Running-in of the wear coefficient (none if omitted)",
        default=None)
    # fmt: on


GUIDES = ("outer", "inner", "ball")
"""What may guide a cage."""


@keyed
class Cage:
    """A cage with cylindrical radial pockets."""

    material: str = setting("Material of the cage", pattern=NAME, allowed=MATERIAL)
    # fmt: off
    guiding_race: str = setting("Guidance of the cage, by the land of a race or by the balls",
        choices=GUIDES, default="outer")
    restitution: float = setting("Coefficient of restitution in impacts of balls on pockets and "
        "of the cage on its land",
        "1", "[0, 1]", default=0.5)
    inner_diameter_mm: float = setting("Inner diameter of the cage ring", "mm", "(0, 10000]")
    outer_diameter_mm: float = setting(
        "Outer diameter of the cage ring (must exceed the inner one)", "mm", "(0, 10000]")
    width_mm: float = setting("Axial width of the cage", "mm", "(0, 1000]")
    pocket_clearance_mm: float = setting("Diametral clearance between a ball and its pocket", "mm",
        "[0, 50]")
    guide_clearance_mm: float = setting("Diametral clearance between the cage and its guiding "
        "land", "mm",
        "[0, 50]")
    imbalance_um: float = setting(
        "Distance of the cage's centre of mass from its geometric centre, towards the first pocket",
        "um", "[0, 1000]", default=0.0)
    worn_share: float = setting("Fraction of the pocket walls and the guiding surface over which "
        "wear is spread (assumed; used only in the cage life calculation)", "1", "[0.001, 1]",
        default=1.0)
    film: Film | None = setting("A solid film on the pocket walls and the guiding surface (used "
        "only in the cage life calculation; none if omitted)", default=None)
    # fmt: on


@keyed
class Operation:
    """Speeds, preload and loads."""

    # fmt: off
    shaft_speed_rpm: float = setting("Speed of the shaft and the inner race", "r/min", "[0, 1e7]",
        example="18000")
    lowest_speed_rpm: float = setting("Lowest speed of the shaft at which requirements of a "
        "preload must hold, at most shaft_speed_rpm (default: at rest)", "r/min", "[0, 1e7]",
        default=0.0)
    outer_speed_rpm: float = setting("Speed of the outer race, in either direction", "r/min",
        "[-1e7, 1e7]", default=0.0)
    preload_method: str = setting("Preload method: spring or fixed position",
        choices=PRELOAD_METHODS, example="constant_force")
    preload_N: float = setting("Initial (static, unworn) axial preload (of a set in tandem, "
        "the force of each side, not the preload of a pair: see arrangement.tandem)", "N",
        "[0, 1e7]", example="140")
    radial_load_N: tuple[float, float] = setting("Radial load along Y and Z, fixed in space", "N",
        "[-1e7, 1e7]", each="One component of the radial load", default=(0.0, 0.0))
    rotating_load_N: float = setting(
        "Radial load that rotates with the shaft, initially along +Z", "N", "[-1e7, 1e7]",
        default=0.0)
    tilt_mrad: float = setting("Tilt of the inner race about Y", "mrad", "[-20, 20]", default=0.0)
    gravity_m_s2: tuple[float, float, float] = setting(
        "Gravity along X, Y and Z, acting only on the cage (Z is up if the shaft is horizontal)",
        "m/s2",
        "[-1000, 1000]", each="One component of gravity", default=(0.0, 0.0, 0.0))
    # fmt: on

    @property
    def fastest_rpm(self) -> float:
        """Returns the speed of the faster race [r/min], without its sign."""
        return max(abs(self.shaft_speed_rpm), abs(self.outer_speed_rpm))

    @property
    def turns(self) -> bool:
        """Whether one race turns against the other, so that anything wears."""
        return self.shaft_speed_rpm != self.outer_speed_rpm


@keyed
class Lubricant:
    """Drag on the orbiting balls."""

    # fmt: off
    drag_density_kg_m3: float = setting(
        "Effective density of the oil-gas mixture times the drag coefficient of an orbiting ball",
        "kg/m3", "[0, 10000]", default=0.0)
    # fmt: on


OF_CAGE = ("pocket_clearance_mm", "guide_clearance_mm", "cage_film_worn_share")
"""Criteria that a cage alone has."""

_CRITERIA: Any = optional_numbers(
    {name: Key(measure.end[0], measure.key_unit, measure.end[1]) for name, measure in ENDS.items()}
)


@dataclass(frozen=True, kw_only=True)
class EndOfLife(_CRITERIA):
    """Criteria of which the first that is met ends the life; None where one does not apply.

    Its keys are those of `bearingwear.measures.ENDS`. Those of `OF_CAGE` limit the cage, whose wear
    a dynamic life and `bearingwear cage` alone follow.
    """

    @functools.cached_property
    def criteria(self) -> dict[str, float]:
        """Returns the values of the criteria that are given, by their keys and in their units."""
        values = {name: getattr(self, name) for name in ENDS}
        return {name: value for name, value in values.items() if value is not None}

    @functools.cached_property
    def without_cage(self) -> EndOfLife:
        """Returns the criteria without those of a cage."""
        return replace(self, **dict.fromkeys(OF_CAGE))


CRITERIA = (*ENDS, "none")
"""What may end a life, in the order of the flags; the last one is that nothing does."""


@keyed
class Wear:
    """State of wear, way of counting, end of life.

    `ball_diameter_loss_um` has one value for all balls, or one for each ball (where they differ).
    """

    # fmt: off
    ball_diameter_loss_um: tuple[float, ...] = setting(
        "Loss of ball diameter for which a case is solved (less than 10 % of the ball diameter)",
        "um", "[0, 50000]",
        single=True, least=1, most=1000, each="Diameter loss of one ball",
        allowed="a number from 0 to 50000, or a list with one such number for each ball",
        default=(0.0,))
    counts: str = setting(
        "Wear included in the total wear depth, and therefore in the life",
        choices=COUNTS, default=COUNTS[1])
    track_wander: float = setting("RMS wander of a ball's track in a worn groove, relative to the "
        "semi-major axis of the new contact (assumed)", "1", "[0, 1]", default=0.1)
    end_of_life: EndOfLife | None = setting(
        "End-of-life criteria; the first one met determines the end of life (a life "
        "calculation requires at least one)",
        default=None)
    # fmt: on

    @property
    def counts_races(self) -> bool:
        """Whether the total wear depth includes the depths of both grooves."""
        return self.counts == COUNTS[1]


@keyed
class Calibrated:
    """Tests from which `bearingwear calibrate` derived friction and wear coefficients."""

    tests: str = setting("Name of the test file", pattern=r"^[^\u0000-\u001f\u007f]*$")
    sha256: str = setting("SHA-256 of the test file", pattern=r"^[0-9a-f]{64}$", longest=64)
    rows: int = setting("Number of tests in the file", "1", within="[1, inf)")
