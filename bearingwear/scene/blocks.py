"""The blocks of a scene: the bearing, how it runs, and its wear.

Plain frozen data. The field names are the keys of a scene file, so the unit is in the name and
nothing is converted here (`bearingwear.solvers.bearing.parameters` does that).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any

from bearingwear.measures import ENDS
from bearingwear.scene.catalogue import MAKERS
from bearingwear.scene.friction import Film, RunningIn
from bearingwear.scene.records import NAME, Key, optional_numbers

COUNTS = ("ball", "ball_and_races")
BALL_TRACKS = ("spread", "bands")
"""What a life may count as loss: the wear of the ball alone, or that of the races as well."""

PRELOAD_METHODS = ("constant_force", "fixed_position")
"""How the preload is applied: by a spring, or by a fixed distance of the rings."""

MATERIAL = "a name under materials"

STEEL_EXPANSION = 11.5e-6
"""Thermal expansion [1/K] of bearing steel, taken where a material has none."""

_RING = "(0, 20000]"


@dataclass(frozen=True, kw_only=True)
class Bearing:
    """Nominal, unworn geometry."""

    maker: Annotated[
        str | None,
        Key("Whose catalogue the designation is of, for its limit of speed", choices=tuple(MAKERS)),
    ] = None
    designation: Annotated[
        str | None,
        Key("Of the bearing in the catalogue, as `bearingwear new --list` has it", longest=40),
    ] = None
    ball_count: Annotated[
        int,
        Key("Number of balls, which must fit side by side on the pitch circle", "1", "[3, 1000]"),
    ]
    ball_diameter_mm: Annotated[float, Key("Nominal (unworn) ball diameter", "mm", "[0.1, 500]")]
    pitch_diameter_mm: Annotated[
        float, Key("Pitch diameter, larger than the ball diameter", "mm", "[0.2, 10000]")
    ]
    contact_angle_deg: Annotated[
        float, Key("Free contact angle (unloaded, unworn)", "degree", "[0, 80]")
    ]
    inner_groove_factor: Annotated[
        float, Key("Groove radius of the inner race over ball diameter", "1", "(0.5, 1]")
    ]
    outer_groove_factor: Annotated[
        float, Key("Groove radius of the outer race over ball diameter", "1", "(0.5, 1]")
    ]
    ball_material: Annotated[str, Key("Material of the balls", pattern=NAME, allowed=MATERIAL)]
    race_material: Annotated[str, Key("Material of both races", pattern=NAME, allowed=MATERIAL)]
    bore_mm: Annotated[
        float | None,
        Key(
            "Bore of the inner ring, for its growth at speed and the warning of hoop stress",
            "mm",
            _RING,
        ),
    ] = None
    outside_diameter_mm: Annotated[
        float | None,
        Key("Outside diameter of the outer ring, for its growth where it turns", "mm", _RING),
    ] = None
    inner_shoulder_mm: Annotated[
        float | None,
        Key(
            "Diameter of the inner ring's shoulder on the loaded side, for the warning of an "
            "ellipse beyond it",
            "mm",
            _RING,
        ),
    ] = None
    outer_shoulder_mm: Annotated[
        float | None,
        Key(
            "Diameter of the outer ring's shoulder on the loaded side, for the same warning",
            "mm",
            _RING,
        ),
    ] = None


@dataclass(frozen=True, kw_only=True)
class Material:
    """Elastic, inertial and wear properties of one material."""

    youngs_modulus_GPa: Annotated[float, Key("Young's modulus", "GPa", "[0.001, 2000]")]
    poisson_ratio: Annotated[float, Key("Poisson's ratio", "1", "[0, 0.5)")]
    density_kg_m3: Annotated[float, Key("Density", "kg/m3", "[10, 30000]")]
    brinell_hardness_GPa: Annotated[
        float, Key("Brinell hardness as a pressure, the H of Archard's law", "GPa", "[0.001, 100]")
    ]
    wear_coefficient: Annotated[
        float, Key("Dimensionless wear coefficient, the K_s of Archard's law", "1", "(0, 1]")
    ]
    yield_pressure_GPa: Annotated[
        float | None,
        Key(
            "Largest contact pressure that leaves no dent, for a warning (if left out 4.2, as "
            "ISO 76 has it for steel, assumed for other materials)",
            "GPa",
            "(0, 100]",
        ),
    ] = None
    thermal_expansion_1_K: Annotated[
        float | None,
        Key(
            f"Thermal expansion, linear ({STEEL_EXPANSION:g} if left out, assumed as of bearing "
            "steel, parts of unlike materials with temperatures need it)",
            "1/K",
            "[0, 1e-4]",
        ),
    ] = None
    film: Annotated[
        Film | None, Key("A solid film on the balls or races of this material, none if left out")
    ] = None
    running_in: Annotated[
        RunningIn | None,
        Key("How its wear coefficient changes while its surface is new, not if left out"),
    ] = None


@dataclass(frozen=True, kw_only=True)
class Cage:
    """A cage with cylindrical radial pockets."""

    material: Annotated[str, Key("Material of the cage", pattern=NAME, allowed=MATERIAL)]
    guiding_race: Annotated[
        str,
        Key(
            "What guides the cage, the land of a race or the balls",
            choices=("outer", "inner", "ball"),
        ),
    ] = "outer"
    restitution: Annotated[
        float, Key("Coefficient of restitution of ball/pocket and cage/land impacts", "1", "[0, 1]")
    ] = 0.5
    inner_diameter_mm: Annotated[float, Key("Inner diameter of the cage ring", "mm", "(0, 10000]")]
    outer_diameter_mm: Annotated[
        float, Key("Outer diameter of the cage ring, larger than the inner one", "mm", "(0, 10000]")
    ]
    width_mm: Annotated[float, Key("Axial width of the cage", "mm", "(0, 1000]")]
    pocket_clearance_mm: Annotated[
        float, Key("Diametral clearance of ball and pocket", "mm", "[0, 50]")
    ]
    guide_clearance_mm: Annotated[
        float, Key("Diametral clearance of cage and guiding land", "mm", "[0, 50]")
    ]
    imbalance_um: Annotated[
        float,
        Key(
            "Distance of the centre of mass from the cage's centre, towards its first pocket",
            "um",
            "[0, 1000]",
        ),
    ] = 0.0
    worn_share: Annotated[
        float,
        Key(
            "Share of pocket walls and guiding surface over which wear spreads evenly, assumed,"
            " dynamic life only",
            "1",
            "[0.001, 1]",
        ),
    ] = 1.0


@dataclass(frozen=True, kw_only=True)
class Operation:
    """Speeds, preload and loads."""

    shaft_speed_rpm: Annotated[
        float, Key("Speed of the shaft and the inner race", "r/min", "[0, 1e7]")
    ]
    outer_speed_rpm: Annotated[
        float, Key("Speed of the outer race, in either direction", "r/min", "[-1e7, 1e7]")
    ] = 0.0
    preload_method: Annotated[
        str, Key("How the preload is held, a spring or a fixed distance", choices=PRELOAD_METHODS)
    ]
    preload_N: Annotated[float, Key("Initial (static, unworn) axial preload", "N", "[0, 1e7]")]
    radial_load_N: Annotated[
        tuple[float, float],
        Key(
            "Radial load along Y and Z, fixed in space",
            "N",
            "[-1e7, 1e7]",
            each="One component of the radial load",
        ),
    ] = (0.0, 0.0)
    rotating_load_N: Annotated[
        float,
        Key("Radial load that turns with the shaft, along +Z at the start", "N", "[-1e7, 1e7]"),
    ] = 0.0
    tilt_mrad: Annotated[float, Key("Tilt of the inner race about Y", "mrad", "[-20, 20]")] = 0.0
    gravity_m_s2: Annotated[
        tuple[float, float, float],
        Key(
            "Gravity along X, Y and Z, on the cage alone (Z is up if the shaft is horizontal)",
            "m/s2",
            "[-1000, 1000]",
            each="One component of gravity",
        ),
    ] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class Lubricant:
    """Drag on the orbiting balls."""

    drag_density_kg_m3: Annotated[
        float,
        Key(
            "Effective density of the oil-gas mixture times drag coefficient of an orbiting ball",
            "kg/m3",
            "[0, 10000]",
        ),
    ] = 0.0


OF_CAGE = ("pocket_clearance_mm", "guide_clearance_mm")
"""Criteria that a cage alone has."""

_CRITERIA: Any = optional_numbers(
    {name: Key(one.end[0], one.key_unit, one.end[1]) for name, one in ENDS.items()}
)


@dataclass(frozen=True, kw_only=True)
class EndOfLife(_CRITERIA):
    """Criteria of which the first that is met ends the life; None where one does not apply.

    Its keys are those of `bearingwear.measures.ENDS`. The clearances are limits of the cage, which
    a dynamic life alone sees wearing.
    """

    @property
    def criteria(self) -> dict[str, float]:
        """The criteria that apply."""
        values = {name: getattr(self, name) for name in ENDS}
        return {name: value for name, value in values.items() if value is not None}

    @property
    def without_cage(self) -> EndOfLife:
        """The criteria that ask nothing of a cage."""
        return replace(self, **dict.fromkeys(OF_CAGE))


CRITERIA = (*ENDS, "none")
"""What may end a life, in the order of the flags."""


@dataclass(frozen=True, kw_only=True)
class Wear:
    """State of wear, way of counting, end of life.

    `ball_diameter_loss_um` has one value for all balls, or one for each ball (where they differ).
    """

    ball_diameter_loss_um: Annotated[
        tuple[float, ...],
        Key(
            "Loss of ball diameter at which a case is solved, below a tenth of the ball diameter",
            "um",
            "[0, 50000]",
            single=True,
            least=1,
            most=1000,
            each="Loss of diameter of one ball",
            allowed="a number from 0 to 50000, or a list of one such number for each ball",
        ),
    ] = (0.0,)
    counts: Annotated[
        str,
        Key(
            "Which wear counts in the interference loss where one life is quoted (files always "
            "hold both)",
            choices=COUNTS,
        ),
    ] = COUNTS[1]
    ball_track: Annotated[
        str,
        Key(
            "How balls wear in a life with worn grooves: evenly, because their axes wander "
            "(spread), or in bands about axes that stay",
            choices=BALL_TRACKS,
        ),
    ] = BALL_TRACKS[0]
    track_wander: Annotated[
        float,
        Key(
            "rms wander of a ball's track in a worn groove, in semi-major axes of the new "
            "contact (assumed)",
            "1",
            "[0, 1]",
        ),
    ] = 0.1
    end_of_life: Annotated[
        EndOfLife | None,
        Key(
            "End-of-life criteria, the first one met ends the life (a life needs at least one, "
            "leave out what does not apply)"
        ),
    ] = None
