"""Wear and friction coefficients that were measured, each with its source; pairs made of them.

`python -m bearingwear.scene.coefficients docs/coefficients.md` makes the page. This file imports
nothing heavy: the command line takes its options from it.
"""

from __future__ import annotations

import math
import sys
import textwrap
from dataclasses import dataclass
from pathlib import Path

from bearingwear.scene.errors import yaml_number

M2_PER_N = 1e-9
"""One mm3/(N m), as papers have K_s/H, in m2/N."""

NINETY = 1.6449
"""Standard deviations from the middle to the end of an interval of 90 %."""


@dataclass(frozen=True, kw_only=True)
class Measured:
    """A row: what one source says of what rubs.

    Attributes
    ----------
    surface, against, film : str
        What wears, what it rubs on, and the film in between, if any.
    wear : (float, float)
        Least and largest K_s/H [mm3/(N m)]; NaN where a source has one end alone.
    friction : (float, float)
        Least and largest coefficient; NaN where it has none.
    conditions, source, url : str
    read : str
        What of the source was read.
    """

    surface: str
    against: str
    film: str = ""
    wear: tuple[float, float]
    friction: tuple[float, float] = (math.nan, math.nan)
    conditions: str
    source: str
    url: str
    read: str = "abstract"


NOT_SAID = math.nan

MEASURED_WEAR = {
    "archard": Measured(
        surface="tool steel",
        against="tool steel",
        wear=(1.5e-5, 2.0e-5),
        friction=(NOT_SAID, NOT_SAID),
        conditions="pin and ring, dry, in air; K_s 1.3e-4, over 8.5 GPa (their steel) to 6.6 GPa "
        "(bearing steel of the scenes)",
        source="Archard and Hirst, Proc. R. Soc. A 236 (1956) 397",
        url="https://doi.org/10.1098/rspa.1956.0144",
        read="recalled",
    ),
    "dry_steel": Measured(
        surface="steel",
        against="steel",
        wear=(NOT_SAID, NOT_SAID),
        friction=(0.8, 0.8),
        conditions="dry",
        source="PTC Windchill, reference guide, prediction, friction_coefficients.html",
        url="https://support.ptc.com/help/wrr/r12.0.0.0/en/",
        read="page",
    ),
    "two_discs": Measured(
        surface="steel",
        against="steel",
        film="mos2",
        wear=(4e-6, 4e-6),
        conditions="sputtered, on a disc; two discs that roll with 10.5 % slip, vacuum, 1.1 to "
        "1.6 GPa, 1000 cycles: running in",
        source="Seynstahl and others, Lubricants 11 (2023) 335",
        url="https://www.mdpi.com/2075-4442/11/8/335",
    ),
    "miyoshi": Measured(
        surface="440C",
        against="440C",
        film="mos2",
        wear=(NOT_SAID, 1e-6),
        conditions="magnetron-sputtered; ball on disc, 5.9 N, 0.79 GPa mean, 0.2 m/s; ultra-high "
        "vacuum, nitrogen and humid air: 'on the order of 1e-6 or less'",
        source="Miyoshi, NASA Glenn, report on bonded and sputtered MoS2 and silver films",
        url="https://publicpdfs.com/nasa-technical-reports-server-ntrs-friction-pdf-3",
    ),
    "bearing_in_vacuum": Measured(
        surface="440C",
        against="440C",
        film="mos2",
        wear=(NOT_SAID, 3.6e-9),
        conditions="0.6 um sputtered; angular-contact bearing, 137.9 N, 1750 r/min, vacuum, 1.05e8 "
        "revolutions without failure; K_s/H by this program, with grooves as they wear 2.9e-18 "
        "(docs/film_tests.md)",
        source="NASA, bearing endurance tests in vacuum for sputtered molybdenum disulfide films",
        url="https://core.ac.uk/works/24927645",
    ),
    "spalvins": Measured(
        surface="steel",
        against="steel",
        film="mos2",
        wear=(NOT_SAID, NOT_SAID),
        friction=(0.03, 0.04),
        conditions="0.2 to 0.65 um sputtered; pin on disc, 250 to 1000 g, 40 to 80 r/min",
        source="Spalvins, ASLE Transactions 14 (1971) 267",
        url="https://ntrs.nasa.gov/citations/19720029182",
    ),
    "nitride": Measured(
        surface="silicon nitride",
        against="silicon nitride",
        wear=(1e-5, 1e-4),
        friction=(0.15, 0.8),
        conditions="dry, 0.5 to 5.5 m/s, 225 and 450 N",
        source="friction and wear of two silicon nitrides and two silicon carbides, dynamometer",
        url="https://katalog.lib.cas.cz/KNAV/EdsRecord/edo,ejs16430344",
    ),
    "nitride_rolling": Measured(
        surface="silicon nitride",
        against="silicon nitride",
        wear=(NOT_SAID, 1e-6),
        conditions="dry, two discs that roll with 10 % slip",
        source="Woydt and Schwenzien, Tribology International 26 (1993) 165",
        url="https://acnpsearch.tweb-dev.unibo.it/singlejournalindex/5809285",
    ),
    "ptfe": Measured(
        surface="PTFE",
        against="stainless steel",
        wear=(6e-4, 6e-4),
        friction=(0.11, 0.36),
        conditions="unfilled; 6.35 MPa, 50 mm/s, air; friction of all blends with PEEK",
        source="Burris and Sawyer, Wear 261 (2006) 410",
        url="https://www.scribd.com/document/521472447",
    ),
    "ptfe_peek": Measured(
        surface="PTFE with 20 % PEEK",
        against="stainless steel",
        wear=(2.3e-9, 2.3e-9),
        friction=(0.11, 0.36),
        conditions="as above",
        source="Burris and Sawyer, Wear 261 (2006) 410",
        url="https://www.scribd.com/document/521472447",
    ),
    "peek_eptfe": Measured(
        surface="PEEK with PTFE filaments",
        against="steel",
        wear=(7e-8, NOT_SAID),
        friction=(NOT_SAID, 0.125),
        conditions="the best of several, 2 million cycles",
        source="Vail and others, Wear 270 (2011) 737",
        url="https://studylib.net/doc/18268665/polytetrafluoroethylene--ptfe--fiber-reinforced",
    ),
    "handbook_cage": Measured(
        surface="cage",
        against="ball",
        wear=(4e-6, 4e-6),
        conditions="an example, not a measurement: coefficient of variation 0.6",
        source="ESA, handbook of reliability prediction",
        url="https://github.com/paulremo/NRPMHandbook",
        read="examples",
    ),
}
"""What was found in the open. Of lead films, phenolic cages and silicon nitride on steel nothing
with a number was."""


@dataclass(frozen=True, kw_only=True)
class LogSpread:
    """Middle and geometric standard deviation; 90 % lie between the ends it was made of."""

    median: float
    factor: float

    @classmethod
    def of(cls, low: float, high: float, least: float = 1.0) -> LogSpread:
        middle = math.sqrt(low * high)
        return cls(median=middle, factor=max((high / low) ** (0.5 / NINETY), least))


@dataclass(frozen=True, kw_only=True)
class RubbingPair:
    """What balls, races and a film rub with.

    Attributes
    ----------
    rows : tuple of str
        Those of `MEASURED_WEAR` that it is made of.
    wear : LogSpread
        K_s/H [m2/N].
    friction : LogSpread
    why : str
    """

    rows: tuple[str, ...]
    wear: LogSpread
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
        why="dry steel; the spread is assumed, since one steel and one load are behind it",
    ),
    ("steel/steel", "mos2"): RubbingPair(
        rows=("two_discs", "miyoshi", "bearing_in_vacuum", "spalvins"),
        wear=LogSpread.of(*_ends("two_discs", "bearing_in_vacuum")),
        friction=LogSpread.of(0.03, 0.04),
        why="from the bearing that did not fail in vacuum to two discs while they run in",
    ),
}
"""What `new` takes, by balls/races and film."""

FILMS = ("none", "mos2")
STEEL_GPA = 6.6
"""Hardness of the bearing steel that `new` writes."""


@dataclass(frozen=True, kw_only=True)
class Rubbing:
    """What `new` writes of wear and friction.

    Attributes
    ----------
    steel : float
        Wear coefficient of the steel [1].
    friction : float
        Of ball and race, or where the film is worn through.
    film : dict, optional
        By the names of the template.
    spread : dict
    rule : str
        Where they come from.
    """

    steel: float
    friction: float
    film: dict[str, object] | None
    spread: dict[str, str]
    rule: str


def rubbing(pair: str | None, film: str | None) -> Rubbing:
    """Of a pair of materials and a film; assumed without both.

    Raises
    ------
    KeyError
        No source has them.
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

    def coefficient(of: LogSpread) -> float:
        return float(f"{of.median * STEEL_GPA * 1e9:.3g}")

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


_INTRODUCTION = """\
# Wear and friction coefficients

<!-- made by `python -m bearingwear.scene.coefficients docs/coefficients.md` -->

Volumes wear as K_s/H times load times slip. Papers give K_s/H in mm³/(N m), which is 1e-9 m²/N.
Each item has a source that can be opened, and says what of it was read. Of lead films, of phenolic
cages and of silicon nitride on steel no number was found in the open: a scene that takes one calls
it assumed.

The coefficient of one pair differs by decades between sources, and a test of your own bearing says
more than this table: [from a test to hours](calibrate.md). [Films against tests](film_tests.md)
shows how far the program is off with it."""

_TAKEN = """\
`bearingwear new mine.yaml 7008C --pair steel/steel --film mos2` takes a pair: its middle, and a
lognormal spread with 90 % between the ends of its rows."""

_SCENES = """\
| scene | K_s/H, m²/N | from |
| --- | --- | --- |
| `gyro_s1` to `s3`, the study of the paper | 7.6e-16 | assumed; the paper's value is not known |
| `mos2_gyro` | film 1.2e-16, steel below 2.0e-14 | pair steel/steel, mos2; archard |
| `turbine`, `turbopump`, `bearing218` | 7.2e-16 to 7.6e-16 | assumed, as the study's |
| turbopump, silicon nitride balls | 6.7e-17 | assumed; no source for it on steel |
| cages: phenolic 3.3e-13, steel 1.7e-15 | | assumed |
| written by `new` without `--pair` | 7.6e-16 | assumed, with a factor of 3 |"""


def page_of_coefficients() -> str:
    """The page, in Markdown."""
    rows = [
        f"**{name}**: {m.surface} on {m.against}{f', film {m.film}' if m.film else ''}. K_s/H "
        f"{_span(m.wear, M2_PER_N)} m²/N, friction {_span(m.friction)}. {m.conditions}. "
        f"[{m.source}]({m.url}), {m.read}."
        for name, m in MEASURED_WEAR.items()
    ]
    pairs = [
        f"**{pair}, film {film}**: K_s/H {one.wear.median:.2g} m²/N, factor {one.wear.factor:.2g}; "
        f"friction {one.friction.median:.2g}, factor {one.friction.factor:.2g}. From "
        f"{', '.join(one.rows)}: {one.why}."
        for (pair, film), one in RUBBING.items()
    ]
    parts = [_INTRODUCTION, _items(rows), "## Pairs", _TAKEN, _items(pairs)]
    return "\n\n".join([*parts, "## What the scenes take", _SCENES]) + "\n"


def _items(texts: list[str]) -> str:
    return "\n".join(
        textwrap.fill(
            text, 100, initial_indent="- ", subsequent_indent="  ",
            break_long_words=False, break_on_hyphens=False,
        )
        for text in texts
    )  # fmt: skip


def _span(ends: tuple[float, float], unit: float = 1.0) -> str:
    low, high = (f"{unit * end:.2g}" for end in ends)
    if "nan" in (low, high):
        return "not given" if low == high else f"at most {high}" if low == "nan" else f"from {low}"
    return low if low == high else f"{low} to {high}"


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(page_of_coefficients(), encoding="utf-8")
