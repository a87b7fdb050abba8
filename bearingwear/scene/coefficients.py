"""Wear and friction coefficients that were measured, each with its source; pairs made of them.

`python -m bearingwear.scene.coefficients docs/coefficients.md` makes the page. This file imports
nothing heavy: the command line takes its options from it.
"""

from __future__ import annotations

import csv
import math
import sys
import textwrap
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
    """A row of coefficients.csv: what one source says of what rubs."""

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


def _measured(row: Mapping[str, str]) -> Measured:
    ends = {
        quantity: tuple(float(row[f"{end}_{quantity}"] or math.nan) for end in ("least", "largest"))
        for quantity in ("wear", "friction")
    }
    words = ("surface", "against", "film", "conditions", "source", "url", "read")
    return Measured(**ends, **{name: row[name] for name in words})  # type: ignore[arg-type]


def _table() -> dict[str, Measured]:
    text = Path(__file__).with_suffix(".csv").read_text(encoding="utf-8")
    return {row["name"]: _measured(row) for row in csv.DictReader(text.splitlines())}


MEASURED_WEAR = _table()
"""Published values."""


@dataclass(frozen=True, kw_only=True)
class Assumed:
    """K_s/H without a source."""

    surface: str
    wear: float  # [m2/N]; NaN where nothing is assumed, either
    taken_by: str
    why: str


ASSUMED = (
    Assumed(
        surface="races and balls of the study",
        wear=7.6e-16,
        taken_by="`gyro_s1` to `s3`, `bearing218` and `new` without `--pair`; 7.2e-16 by `turbine` "
        "and `turbopump`",
        why="the value of the paper is unknown; the magnitude is that of a solid film",
    ),
    Assumed(
        surface="silicon nitride on steel",
        wear=6.7e-17,
        taken_by="`turbopump`, `new --ball-material silicon_nitride`",
        why="abstracts of papers on this pair contain no number: on M50 in vacuum (Tong and "
        "others, 2011), in fretting on bearing steel (Kalin and others, 1997)",
    ),
    Assumed(
        surface="phenolic cage on steel",
        wear=3.3e-13,
        taken_by="cages of `gyro_s1` to `s3` and of `new`",
        why="published numbers refer to other fibres or to lubrication with oil",
    ),
    Assumed(
        surface="steel cage",
        wear=1.7e-15,
        taken_by="`turbine`, `turbopump`",
        why="wear coefficient of the races with the hardness of a softer steel",
    ),
    Assumed(
        surface="lead film on steel",
        wear=math.nan,
        taken_by="nothing",
        why="only bearing lives are published ([films against tests](film_tests.md)), not K_s/H",
    ),
)
"""Assumed values, because no source was found."""


@dataclass(frozen=True, kw_only=True)
class LogSpread:
    """Median and geometric standard deviation; the 90 % interval is that of `of`."""

    median: float
    factor: float

    @classmethod
    def of(cls, low: float, high: float, least: float = 1.0) -> LogSpread:
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
    """Least and largest K_s/H of some rows [m2/N]."""
    known = [end for row in rows for end in MEASURED_WEAR[row].wear if not math.isnan(end)]
    return M2_PER_N * min(known), M2_PER_N * max(known)


ASSUMED_WEAR = LogSpread(median=7.6e-16, factor=3.0)
"""K_s/H of a scene without a pair, which no source has [m2/N]."""

ASSUMED_FRICTION = LogSpread(median=0.08, factor=1.2)
WEAR_SCATTER = 1.3
"""Geometric standard deviation of the wear of a bearing within its batch, assumed."""

SHEAR_STRENGTH_MPA, PRESSURE_COEFFICIENT = 24.8, 0.001
"""Of sputtered MoS2: Singer and others, Appl. Phys. Lett. 57 (1990) 995."""

RUBBING = {
    ("steel/steel", "none"): RubbingPair(
        rows=("archard", "dry_steel"),
        wear=LogSpread.of(*_ends("archard"), least=3.0),
        friction=LogSpread.of(0.8, 0.8, least=1.2),
        why="dry steel; the spread is assumed, because the source covers one steel and one load",
    ),
    ("steel/steel", "mos2"): RubbingPair(
        rows=("two_discs", "miyoshi", "bearing_in_vacuum", "spalvins"),
        wear=LogSpread.of(*_ends("two_discs", "bearing_in_vacuum")),
        friction=LogSpread.of(0.03, 0.04),
        why="from the bearing that did not fail in vacuum to two discs during running-in",
    ),
}
"""What `new` takes, by balls/races and film."""

FILMS = ("none", "mos2")
STEEL_GPA = 6.6
"""Hardness of the bearing steel that `new` writes."""


@dataclass(frozen=True, kw_only=True)
class Rubbing:
    """Wear and friction values that `new` writes."""

    steel: float  # wear coefficient of the steel [1]
    friction: float  # of ball and race, or where the film is worn through
    film: dict[str, object] | None  # by the names of the template
    spread: dict[str, str]
    rule: str  # where they come from


def rubbing(pair: str | None, film: str | None) -> Rubbing:
    """Coefficients of a pair of materials and a film; assumed without both.

    KeyError where no source has them.
    """

    def spread(wear: LogSpread, friction: LogSpread, rule: str) -> dict[str, str]:
        factors = {"wear": wear.factor, "friction": friction.factor, "scatter": WEAR_SCATTER}
        return {name: f"{value:.2g}" for name, value in factors.items()} | {"rule": rule}

    if pair is None and film is None:
        return Rubbing(
            steel=5.0e-6,
            friction=ASSUMED_FRICTION.median,
            film=None,
            spread=spread(ASSUMED_WEAR, ASSUMED_FRICTION, ""),
            rule="",
        )
    found, dry = RUBBING[pair or "steel/steel", film or "none"], RUBBING["steel/steel", "none"]
    rule = f"docs/coefficients.md: {', '.join(found.rows)}"

    def coefficient(spread: LogSpread) -> float:
        return float(f"{spread.median * STEEL_GPA * 1e9:.3g}")

    on_it: dict[str, object] | None = None
    if film == "mos2":
        on_it = {
            "shear_strength": SHEAR_STRENGTH_MPA,
            "pressure_coefficient": PRESSURE_COEFFICIENT,
            "wear_coefficient": yaml_number(coefficient(found.wear)),
            "bare": dry.friction.median,
            "rule": rule,
        }
    return Rubbing(
        steel=coefficient(dry.wear),
        friction=found.friction.median,
        film=on_it,
        spread=spread(found.wear, found.friction, f"; {rule}"),
        rule=f"docs/coefficients.md: {', '.join(dry.rows)}",
    )


_STEEL = ((180.0, 230.0), (7400.0, 8300.0))
"""Young's modulus [GPa] and density [kg/m3] by which a material of a scene is taken for steel."""


def usual_spread(scene: Mapping[str, Any]) -> tuple[dict[str, Any], str]:
    """Distributions for a scene without any, by the row of what rubs in it, and what they are.

    scene: as `Scene.to_dict` has it. The middle of each distribution is the scene's own value.
    """
    bearing, on_it = scene["bearing"], scene["friction"].get("film")
    parts = [scene["materials"][bearing[f"{part}_material"]] for part in ("ball", "race")]
    coated = on_it is not None or any(part.get("film") for part in parts)
    pair = "steel/steel" if all(map(_is_steel, parts)) else ""
    row = RUBBING.get((pair, "mos2" if coated else "none"))
    wear, friction = (row.wear, row.friction) if row else (ASSUMED_WEAR, ASSUMED_FRICTION)
    block, key = (on_it, "shear_strength_MPa") if on_it else (scene["friction"], "ball_race")
    factors = {"wear_coefficient": wear.factor, "wear_scatter": WEAR_SCATTER}
    if block.get(key):
        factors[key] = friction.factor
    text = {name: f"{factor:.2g}" for name, factor in factors.items()}
    if row:
        film = "film mos2 (no other has a source)" if coated else "dry"
        said = f"spread of {pair}, {film}, from {', '.join(row.rows)}"
    else:
        said = "spread assumed, because no source covers these materials"
    said += f": K_s/H by a factor of {text['wear_coefficient']}"
    said += f", friction by {text[key]}" if key in text else ""
    spread = {name: {"distribution": "lognormal", "factor": float(f)} for name, f in text.items()}
    return spread, f"{said}; within a batch by {text['wear_scatter']} (assumed)"


def with_usual_spread(scene: Scene) -> tuple[Scene, str]:
    """A scene with distributions, and what they are; empty where they are its own."""
    if scene.uncertainty:
        return scene, ""
    spread, said = usual_spread(scene.to_dict())
    return scene.with_({"uncertainty": spread}), said


def _is_steel(material: Mapping[str, float]) -> bool:
    values = (material["youngs_modulus_GPa"], material["density_kg_m3"])
    return all(low <= one <= high for one, (low, high) in zip(values, _STEEL, strict=True))


_INTRODUCTION = """\
# Wear and friction coefficients

<!-- made by `python -m bearingwear.scene.coefficients docs/coefficients.md` -->

The wear volume is K_s/H times load times slip distance. Papers report K_s/H in mm³/(N m), which is
1e-9 m²/N. Each item has an accessible source, and states which part of it was read. The
[assumed](#assumed) values are listed separately: no published number was found for lead films,
phenolic cages, and silicon nitride on steel.

Coefficients of the same pair differ by decades between sources, so a test of your own bearing is
more reliable than this table: [from a test to hours](calibrate.md). [Films against
tests](film_tests.md) reports the error of predictions with this table."""

_TAKEN = """\
`bearingwear new mine.yaml 7008C --pair steel/steel --film mos2` uses the median of a pair, and a
lognormal spread whose 90 % interval extends over its rows."""

_SPREAD = """\
If a scene has no `uncertainty`, the commands `uncertainty` and `calibrate` use the spread of its
pair about the values of the scene, and report this. Steel is identified by stiffness and density; a
film is treated as MoS2, the only film with a source. For any other pair the spread is assumed: a
factor of {wear.factor:g} for K_s/H and {friction.factor:g} for friction. The assumed scatter of
wear within a batch is a factor of {scatter:g}."""

_NO_SOURCE = """\
`mos2_gyro` uses steel/steel with mos2 for its film, 1.2e-16 m²/N, and archard for the steel below
it, 2.0e-14 m²/N. The values of all other scenes are assumed, because no source was found:"""


def page_of_coefficients() -> str:
    """The page, in Markdown."""
    rows = [
        f"**{name}**: {m.surface} on {m.against}{f', film {m.film}' if m.film else ''}. K_s/H "
        f"{_span(m.wear, M2_PER_N, ' m²/N')}, friction {_span(m.friction)}. {m.conditions}. "
        f"[{m.source}]({m.url}), {m.read}."
        for name, m in MEASURED_WEAR.items()
    ]
    pairs = [
        f"**{pair}, film {film}**: K_s/H {one.wear.median:.2g} m²/N, factor {one.wear.factor:.2g}; "
        f"friction {one.friction.median:.2g}, factor {one.friction.factor:.2g}. From "
        f"{', '.join(one.rows)}: {one.why}."
        for (pair, film), one in RUBBING.items()
    ]
    assumed = [
        f"**{one.surface}**: {'none' if math.isnan(one.wear) else f'{one.wear:.2g} m²/N'}. Used "
        f"by {one.taken_by}. {one.why[0].upper()}{one.why[1:]}."
        for one in ASSUMED
    ]
    spread = _SPREAD.format(wear=ASSUMED_WEAR, friction=ASSUMED_FRICTION, scatter=WEAR_SCATTER)
    parts = [_INTRODUCTION, _items(rows), "## Pairs", _TAKEN, _items(pairs), _wrapped(spread)]
    return "\n\n".join([*parts, "## Assumed", _wrapped(_NO_SOURCE), _items(assumed)]) + "\n"


def _items(texts: list[str]) -> str:
    return "\n".join(_wrapped(text, "- ") for text in texts)


def _wrapped(text: str, mark: str = "") -> str:
    return textwrap.fill(
        text, 100, initial_indent=mark, subsequent_indent=" " * len(mark),
        break_long_words=False, break_on_hyphens=False,
    )  # fmt: skip


def _span(ends: tuple[float, float], unit: float = 1.0, after: str = "") -> str:
    low, high = (f"{unit * end:.3g}" for end in ends)
    if "nan" in (low, high):
        if low == high:
            return "not given"
        return f"at most {high}{after}" if low == "nan" else f"from {low}{after}"
    return f"{low}{after}" if low == high else f"{low} to {high}{after}"


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(page_of_coefficients(), encoding="utf-8")
