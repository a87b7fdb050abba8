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
    """Returns a row of coefficients.csv as a record; an empty number as NaN."""

    def number(column: str) -> float:
        return float(row[column]) if row[column] else math.nan

    return Measured(
        surface=row["surface"],
        against=row["against"],
        film=row["film"],
        wear=(number("least_wear"), number("largest_wear")),
        friction=(number("least_friction"), number("largest_friction")),
        conditions=row["conditions"],
        source=row["source"],
        url=row["url"],
        read=row["read"],
    )


def _measured_wear() -> dict[str, Measured]:
    """Reads coefficients.csv: what each source measured, by the name of the row."""
    text = Path(__file__).with_suffix(".csv").read_text(encoding="utf-8")
    return {row["name"]: _measured_row(row) for row in csv.DictReader(text.splitlines())}


MEASURED_WEAR = _measured_wear()
"""Published values."""


@dataclass(frozen=True, kw_only=True)
class LogSpread:
    """Median and geometric standard deviation of a lognormal value."""

    median: float
    factor: float

    @classmethod
    def of(cls, low: float, high: float, least: float = 1.0) -> LogSpread:
        """Returns the spread whose 90 % interval is from low to high.

        least: smallest factor that it may have; a smaller one is raised to it, which widens the
            interval about the same median.
        """
        factor = (high / low) ** (0.5 / NINETY)
        return cls(median=math.sqrt(low * high), factor=max(factor, least))


@dataclass(frozen=True, kw_only=True)
class RubbingPair:
    """Wear and friction coefficients of balls, races and a film."""

    rows: tuple[str, ...]  # rows of `MEASURED_WEAR` that define it
    wear: LogSpread  # K_s/H [m2/N]
    friction: LogSpread
    why: str


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

MOS2_WEAR = (4.9e-18, 5.0e-15)
"""K_s/H of the rows `bearing_in_vacuum` and `two_discs` at 1500 MPa and 23 degC, the row of
`MOS2_LIVES` whose life is 1: their own at 0.8 to 1.6 GPa, converted by these lives [m2/N]. The
first is computed by `bound` of benchmarks/film_tests.py."""

SHEAR_STRENGTH_MPA, PRESSURE_COEFFICIENT = 24.8, 0.001
"""Of sputtered MoS2: Singer and others, Appl. Phys. Lett. 57 (1990) 995."""

_STARVED = (
    "A bound, because oil and cage ended the lives of those motors: lives are at least what this "
    "computes. Spread and friction are assumed"
)


def _wear_range(row: str) -> tuple[float, float]:
    """Returns the least and largest K_s/H [m2/N] of a row of `MEASURED_WEAR` that has both."""
    least, largest = MEASURED_WEAR[row].wear
    return M2_PER_N * least, M2_PER_N * largest


_BOUND_ROWS = ("nesc_r4", "nesc_r4_hybrid")
_WRITTEN = 5e-3  # to which `new` rounds a wear coefficient


def _upper_bound(row: str) -> LogSpread:
    """Returns the largest K_s/H [m2/N] of a row of `MEASURED_WEAR`, with the assumed spread."""
    _, largest = MEASURED_WEAR[row].wear
    return LogSpread(median=M2_PER_N * largest, factor=ASSUMED_WEAR.factor)


STEEL, NITRIDE = "bearing_steel", "silicon_nitride"

RUBBING = {
    ("dry", STEEL): RubbingPair(
        rows=("archard", "dry_steel"),
        wear=LogSpread.of(*_wear_range("archard"), least=ASSUMED_WEAR.factor),
        friction=LogSpread(median=0.8, factor=ASSUMED_FRICTION.factor),
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

    lubrication: of `LUBRICATIONS`, or None.
    ball_material: `bearing_steel` or `silicon_nitride`; steel if None. Races are of steel.
    """
    if lubrication is None:
        return _assumed_rubbing()
    pair = RUBBING[NEAREST.get(lubrication, lubrication), ball_material or STEEL]
    rule = _rule(pair)
    film, bare_pair = None, pair
    if lubrication == "mos2":
        bare_pair = RUBBING["dry", STEEL]
        film = {
            "shear_strength": SHEAR_STRENGTH_MPA,
            "pressure_coefficient": PRESSURE_COEFFICIENT,
            "wear_coefficient": yaml_number(float(f"{pair.wear.median * STEEL_GPA * 1e9:.3g}")),
            "lives": MOS2_LIVES,
            "bare": bare_pair.friction.median,
            "rule": rule,
        }
    scatter = WEAR_SCATTER if film is None else FILM_SCATTER
    return Rubbing(
        wear=bare_pair.wear.median,
        friction=pair.friction.median,
        film=film,
        spread=_spread_texts(pair.wear, pair.friction, scatter) | {"rule": f"; {rule}"},
        rule=_rule(bare_pair),
        friction_rule="" if pair.friction is ASSUMED_FRICTION else rule,
        summary=_lubrication_summary(lubrication, pair),
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


def _assumed_rubbing() -> Rubbing:
    """Returns the assumed coefficients of a bearing whose lubrication is not known."""
    dry, starved = RUBBING["dry", STEEL].wear, RUBBING["starved", STEEL].wear
    return Rubbing(
        wear=None,
        friction=ASSUMED_FRICTION.median,
        film=None,
        spread=_spread_texts(ASSUMED_WEAR, ASSUMED_FRICTION, WEAR_SCATTER) | {"rule": ""},
        rule="",
        friction_rule="",
        summary=f"not given, so K_s/H ({ASSUMED_WEAR.median:g} m2/N for steel) is assumed, and "
        "lives, which go as 1/(K_s/H), only compare designs; --lubrication dry takes "
        f"{dry.median:.2g}, starved at most {starved.median:.2g}",
    )


def _rule(pair: RubbingPair) -> str:
    """Names the rows of the table in the documentation that define a pair."""
    return f"docs/coefficients.md: {', '.join(pair.rows)}"


def _spread_texts(wear: LogSpread, friction: LogSpread, scatter: float) -> dict[str, str]:
    """Returns geometric standard deviations by `wear`, `friction` and `scatter`, as text."""
    factors = {"wear": wear.factor, "friction": friction.factor, "scatter": scatter}
    return {name: f"{factor:.2g}" for name, factor in factors.items()}


def _lubrication_summary(lubrication: str, pair: RubbingPair) -> str:
    """Returns the line that `new` prints on a lubrication: K_s/H, its source, and its limits."""
    summary = f"{lubrication}; K_s/H {pair.wear.median:.2g} m2/N, {_rule(pair)}"
    if pair.why == _STARVED:
        summary += ", a bound: lives are at least these"
    if nearest := NEAREST.get(lubrication):
        summary += f"; no source has {lubrication}, so that of {nearest} bearings is taken"
    return summary


_STEEL = {"youngs_modulus_GPa": (180.0, 230.0), "density_kg_m3": (7400.0, 8300.0)}
"""Least and largest values by which a material of a scene is taken for steel."""


def usual_spread(scene: Mapping[str, Any]) -> tuple[dict[str, Any], str]:
    """Returns distributions for a scene without any, and a line that says where they come from.

    The distributions are plain data of the block `uncertainty`, about the scene's own values.

    scene: as `Scene.to_dict` has it.
    """
    bearing, friction = scene["bearing"], scene["friction"]
    materials = [scene["materials"][bearing[f"{part}_material"]] for part in ("ball", "race")]
    film = friction.get("film")
    is_coated = film is not None or any(material.get("film") for material in materials)
    pair = None
    if all(map(_is_steel, materials)):
        pair = RUBBING["mos2" if is_coated else "dry", STEEL]
    factors = {
        "wear_coefficient": (pair.wear if pair else ASSUMED_WEAR).factor,
        "wear_scatter": FILM_SCATTER if is_coated else WEAR_SCATTER,
    }
    friction_key = "shear_strength_MPa" if film else "ball_race"
    if (film or friction).get(friction_key):
        factors[friction_key] = (pair.friction if pair else ASSUMED_FRICTION).factor
    texts = {name: f"{factor:.2g}" for name, factor in factors.items()}
    distributions = {
        name: {"distribution": "lognormal", "factor": float(text)} for name, text in texts.items()
    }
    return distributions, _spread_summary(texts, pair, is_coated)


def _spread_summary(factors: Mapping[str, str], pair: RubbingPair | None, is_coated: bool) -> str:
    """Returns a line on the factors of `usual_spread` and their source.

    pair: whose spread is taken; None if the spread is assumed.
    is_coated: whether balls or races have a film.
    """
    summary = "spread assumed, because no source covers these materials"
    if pair is not None:
        lubrication = "film mos2 (no source for other films)" if is_coated else "dry"
        summary = f"spread for steel/steel, {lubrication}, from {', '.join(pair.rows)}"
    summary += f": K_s/H by a factor of {factors['wear_coefficient']}"
    for friction_key in ("shear_strength_MPa", "ball_race"):
        if friction_key in factors:
            summary += f", friction by a factor of {factors[friction_key]}"
    source = "as films of gears" if is_coated else "assumed"
    return f"{summary}; within a batch, K_s/H by a factor of {factors['wear_scatter']} ({source})"


def with_usual_spread(scene: Scene) -> tuple[Scene, str]:
    """Returns a scene with the distributions of `usual_spread`, and a line that states them.

    A scene that has distributions is returned as it is, with an empty line.
    """
    if scene.uncertainty:
        return scene, ""
    spread, summary = usual_spread(scene.to_dict())
    return scene.with_({"uncertainty": spread}), summary


def _is_steel(material: Mapping[str, float]) -> bool:
    """Whether the elastic modulus and the density of a material are those of steel."""
    return all(low <= material[key] <= high for key, (low, high) in _STEEL.items())
