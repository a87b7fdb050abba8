"""Wear and friction coefficients that were measured, each with its source; pairs made of them.

This file imports nothing heavy: the command line takes its options from it.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bearingwear.scene.checking.errors import yaml_number

if TYPE_CHECKING:
    from bearingwear.scene.scene import Scene

M2_PER_N = 1e-9
"""One mm3/(N m), as papers have K_s/H, in m2/N."""

NINETY = 1.6449
"""Standard deviations from the middle to the end of an interval of 90 %."""


@dataclass(frozen=True, kw_only=True)
class Measured:
    """A row of coefficients.csv: what one source measured on a pair of surfaces."""

    # what wears, what it rubs on, and the film in between, if any
    surface: str
    against: str
    film: str
    # least and largest K_s/H [mm3/(N m)]; NaN where a source has one end alone
    wear: tuple[float, float]
    friction: tuple[float, float]  # least and largest coefficient; NaN where it has none
    conditions: str
    source: str
    url: str
    read: str  # what of the source was read


def _measured_row(row: Mapping[str, str]) -> Measured:
    """Returns a row of coefficients.csv as a record."""
    ends = {
        quantity: tuple(float(row[f"{end}_{quantity}"] or math.nan) for end in ("least", "largest"))
        for quantity in ("wear", "friction")
    }
    words = ("surface", "against", "film", "conditions", "source", "url", "read")
    return Measured(**ends, **{name: row[name] for name in words})  # type: ignore[arg-type]


def _table() -> dict[str, Measured]:
    """Reads coefficients.csv."""
    text = Path(__file__).with_suffix(".csv").read_text(encoding="utf-8")
    return {row["name"]: _measured_row(row) for row in csv.DictReader(text.splitlines())}


MEASURED_WEAR = _table()
"""Published values."""


@dataclass(frozen=True, kw_only=True)
class LogSpread:
    """Median and geometric standard deviation of a lognormal value."""

    median: float
    factor: float

    @classmethod
    def of(cls, low: float, high: float, least: float = 1.0) -> LogSpread:
        """Returns the spread whose 90 % interval is from low to high; `least` bounds its factor."""
        middle = math.sqrt(low * high)
        return cls(median=middle, factor=max((high / low) ** (0.5 / NINETY), least))


@dataclass(frozen=True, kw_only=True)
class RubbingPair:
    """Wear and friction coefficients of balls, races and a film."""

    rows: tuple[str, ...]  # rows of `MEASURED_WEAR` that define it
    wear: LogSpread  # K_s/H [m2/N]
    friction: LogSpread
    why: str


def _ends(*rows: str) -> tuple[float, float]:
    """Returns the least and largest K_s/H of some rows [m2/N]."""
    values = [value for row in rows for value in MEASURED_WEAR[row].wear if not math.isnan(value)]
    return M2_PER_N * min(values), M2_PER_N * max(values)


ASSUMED_WEAR = LogSpread(median=7.6e-16, factor=3.0)
"""K_s/H of a scene without a pair, which no source has [m2/N]."""

ASSUMED_FRICTION = LogSpread(median=0.08, factor=1.2)
WEAR_SCATTER = 1.3
"""Geometric standard deviation of the wear of a bearing within its batch, assumed."""

FILM_SCATTER = 1.8
"""That of films: six tests of gears with sputtered MoS2 in vacuum had 1.6, the first four 1.8. NASA
Glenn, 44th Aerospace Mechanisms Symposium (2018) 127, https://ntrs.nasa.gov/citations/20180003085."""

MOS2_LIVES = (
    (850.0, 23.0, 8.591), (1500.0, 23.0, 1.0), (2000.0, 23.0, 0.060),
    (850.0, 120.0, 1.867), (1500.0, 120.0, 0.194), (2000.0, 120.0, 0.007),
)  # fmt: skip
"""Row `estl`: peak pressure [MPa], temperature [degC] and relative life."""

MOS2_WEAR = (4.7e-18, 5.0e-15)
"""K_s/H of the rows `bearing_in_vacuum` and `two_discs` at 1500 MPa and 23 degC, the row of
`MOS2_LIVES` whose life is 1: their own at 0.8 to 1.6 GPa, converted by these lives [m2/N]."""

SHEAR_STRENGTH_MPA, PRESSURE_COEFFICIENT = 24.8, 0.001
"""Of sputtered MoS2: Singer and others, Appl. Phys. Lett. 57 (1990) 995."""

_STARVED = (
    "A bound, because oil and cage ended the lives of those motors: lives are at least what this "
    "computes. Spread and friction are assumed"
)


_BOUND_ROWS = ("nesc_r4", "nesc_r4_hybrid")
_WRITTEN = 5e-3  # to which `new` rounds a wear coefficient


def _upper_bound(row: str) -> LogSpread:
    """Returns the largest K_s/H of a row, with the assumed spread."""
    return LogSpread(median=M2_PER_N * MEASURED_WEAR[row].wear[1], factor=ASSUMED_WEAR.factor)


STEEL, NITRIDE = "bearing_steel", "silicon_nitride"

RUBBING = {
    ("dry", STEEL): RubbingPair(
        rows=("archard", "dry_steel"),
        wear=LogSpread.of(*_ends("archard"), least=3.0),
        friction=LogSpread.of(0.8, 0.8, least=1.2),
        why="The spread for dry steel is assumed, because the source covers only one steel and one "
        "load",
    ),
    ("starved", STEEL): RubbingPair(
        rows=("nesc_r4",), wear=_upper_bound("nesc_r4"), friction=ASSUMED_FRICTION, why=_STARVED
    ),
    ("starved", NITRIDE): RubbingPair(
        rows=("nesc_r4_hybrid",),
        wear=_upper_bound("nesc_r4_hybrid"),
        friction=ASSUMED_FRICTION,
        why=_STARVED,
    ),
    ("mos2", STEEL): RubbingPair(
        rows=("two_discs", "miyoshi", "bearing_in_vacuum", "spalvins", "estl"),
        wear=LogSpread.of(*MOS2_WEAR),
        friction=LogSpread.of(0.03, 0.04),
        why="The range extends from the value for a bearing that did not fail in vacuum to that "
        "for two discs during running-in, both at 1500 MPa and 23 degC by the lives of estl",
    ),
}
"""What `new` takes, by lubrication and material of the balls; the races are of steel."""

NEAREST = {"oil": "starved", "grease": "starved"}
"""Lubrications of which no source has K_s/H, and the one whose K_s/H bounds theirs."""

LUBRICATIONS = (*dict.fromkeys(name for name, _ in RUBBING), *NEAREST)
STEEL_GPA = 6.6
"""Hardness of the bearing steel that `new` writes."""


@dataclass(frozen=True, kw_only=True)
class Rubbing:
    """Wear and friction values that `new` writes."""

    wear: float | None  # K_s/H of balls and races [m2/N]; None where each material has its own
    friction: float  # of ball and race, or where the film is worn through
    film: dict[str, object] | None  # by the names of the template
    spread: dict[str, str]
    rule: str  # where wear comes from, empty where it is assumed
    friction_rule: str
    summary: str  # what `new` prints


def rubbing(lubrication: str | None, ball_material: str | None) -> Rubbing:
    """Returns coefficients for a lubrication and a ball material; assumed without a lubrication.

    KeyError where no source has them.
    """
    scatter = FILM_SCATTER if lubrication == "mos2" else WEAR_SCATTER

    def spread(wear: LogSpread, friction: LogSpread, rule: str) -> dict[str, str]:
        factors = {"wear": wear.factor, "friction": friction.factor, "scatter": scatter}
        return {name: f"{value:.2g}" for name, value in factors.items()} | {"rule": rule}

    dry = RUBBING["dry", STEEL]
    if lubrication is None:
        return Rubbing(
            wear=None,
            friction=ASSUMED_FRICTION.median,
            film=None,
            spread=spread(ASSUMED_WEAR, ASSUMED_FRICTION, ""),
            rule="",
            friction_rule="",
            summary=f"not given, so K_s/H ({ASSUMED_WEAR.median:g} m2/N for steel) is assumed, and "
            "lives, which go as 1/(K_s/H), only compare designs; --lubrication dry takes "
            f"{dry.wear.median:.2g}, starved at most {RUBBING['starved', STEEL].wear.median:.2g}",
        )
    pair = RUBBING[NEAREST.get(lubrication, lubrication), ball_material or STEEL]
    rule = f"docs/coefficients.md: {', '.join(pair.rows)}"
    summary = f"{lubrication}; K_s/H {pair.wear.median:.2g} m2/N, {rule}"
    if pair.why == _STARVED:
        summary += ", a bound: lives are at least these"
    if lubrication in NEAREST:
        summary += (
            f"; no source has {lubrication}, so that of {NEAREST[lubrication]} bearings is taken"
        )
    film: dict[str, object] | None = None
    if lubrication == "mos2":
        film = {
            "shear_strength": SHEAR_STRENGTH_MPA,
            "pressure_coefficient": PRESSURE_COEFFICIENT,
            "wear_coefficient": yaml_number(float(f"{pair.wear.median * STEEL_GPA * 1e9:.3g}")),
            "lives": MOS2_LIVES,
            "bare": dry.friction.median,
            "rule": rule,
        }
    bare_pair = dry if film else pair
    return Rubbing(
        wear=bare_pair.wear.median,
        friction=pair.friction.median,
        film=film,
        spread=spread(pair.wear, pair.friction, f"; {rule}"),
        rule=f"docs/coefficients.md: {', '.join(bare_pair.rows)}",
        friction_rule="" if pair.friction is ASSUMED_FRICTION else rule,
        summary=summary,
    )


def is_wear_bound(scene: Mapping[str, Any]) -> bool:
    """Whether the K_s/H of balls and races is that of starved oil, which is an upper bound.

    scene: as `Scene.to_dict` has it.
    """
    bearing, bounds = scene["bearing"], [_upper_bound(row).median for row in _BOUND_ROWS]
    for part in ("ball", "race"):
        material = scene["materials"][bearing[f"{part}_material"]]
        wear = material["wear_coefficient"] / (1e9 * material["brinell_hardness_GPa"])
        if not any(math.isclose(wear, bound, rel_tol=_WRITTEN) for bound in bounds):
            return False
    return True


_STEEL = ((180.0, 230.0), (7400.0, 8300.0))
"""Young's modulus [GPa] and density [kg/m3] by which a material of a scene is taken for steel."""


def usual_spread(scene: Mapping[str, Any]) -> tuple[dict[str, Any], str]:
    """Returns distributions for a scene without any, and a line that says where they come from.

    scene: as `Scene.to_dict` has it. The middle of each distribution is the scene's own value.
    """
    bearing, film_block = scene["bearing"], scene["friction"].get("film")
    parts = [scene["materials"][bearing[f"{part}_material"]] for part in ("ball", "race")]
    coated = film_block is not None or any(part.get("film") for part in parts)
    pair = STEEL if all(map(_is_steel, parts)) else ""
    row = RUBBING.get(("mos2" if coated else "dry", pair))
    wear, friction = (row.wear, row.friction) if row else (ASSUMED_WEAR, ASSUMED_FRICTION)
    block = film_block or scene["friction"]
    friction_key = "shear_strength_MPa" if film_block else "ball_race"
    scatter = FILM_SCATTER if coated else WEAR_SCATTER
    factors = {"wear_coefficient": wear.factor, "wear_scatter": scatter}
    if block.get(friction_key):
        factors[friction_key] = friction.factor
    text = {name: f"{factor:.2g}" for name, factor in factors.items()}
    if row:
        film_words = "film mos2 (no source for other films)" if coated else "dry"
        summary = f"spread for steel/steel, {film_words}, from {', '.join(row.rows)}"
    else:
        summary = "spread assumed, because no source covers these materials"
    summary += f": K_s/H by a factor of {text['wear_coefficient']}"
    summary += f", friction by a factor of {text[friction_key]}" if friction_key in text else ""
    spread = {name: {"distribution": "lognormal", "factor": float(f)} for name, f in text.items()}
    source = "as films of gears" if coated else "assumed"
    summary += f"; within a batch, K_s/H by a factor of {text['wear_scatter']} ({source})"
    return spread, summary


def with_usual_spread(scene: Scene) -> tuple[Scene, str]:
    """Returns a scene with distributions, and a line on them that is empty if it has its own."""
    if scene.uncertainty:
        return scene, ""
    spread, summary = usual_spread(scene.to_dict())
    return scene.with_({"uncertainty": spread}), summary


def _is_steel(material: Mapping[str, float]) -> bool:
    """Whether the elastic modulus and the density of a material are those of steel."""
    values = (material["youngs_modulus_GPa"], material["density_kg_m3"])
    return all(low <= value <= high for value, (low, high) in zip(values, _STEEL, strict=True))
