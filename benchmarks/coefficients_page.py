"""The page of measured and assumed coefficients of wear and friction.

`python benchmarks/coefficients_page.py docs/coefficients.md` regenerates it.
"""

from __future__ import annotations

import math
import sys
import textwrap
from dataclasses import dataclass
from pathlib import Path

from bearingwear.scene.coefficients import (
    ASSUMED_FRICTION,
    ASSUMED_WEAR,
    FILM_SCATTER,
    M2_PER_N,
    MEASURED_WEAR,
    NITRIDE,
    RUBBING,
    STEEL,
    WEAR_SCATTER,
)


@dataclass(frozen=True, kw_only=True)
class Assumed:
    """K_s/H without a source."""

    surface: str
    wear: float  # [m2/N]; NaN if no value is assumed
    taken_by: str
    why: str


ASSUMED = (
    Assumed(
        surface="races and balls of the study",
        wear=7.6e-16,
        taken_by="`gyro_s1` to `gyro_s3`, `bearing218`, and `new` without `--lubrication`; "
        "`turbine` and `turbopump` use 7.2e-16 m²/N",
        why="the value used in the paper is unknown; the magnitude is typical of a solid film",
    ),
    Assumed(
        surface="silicon nitride on steel",
        wear=6.7e-17,
        taken_by="`turbopump` and `new --ball-material silicon_nitride`",
        why="the abstracts of papers on this pair give no value, either for M50 in vacuum "
        "(Tong and others, 2011) or for fretting on bearing steel (Kalin and others, 1997)",
    ),
    Assumed(
        surface="phenolic cage on steel",
        wear=3.3e-13,
        taken_by="`gyro_s1` to `gyro_s3` and `new`",
        why="published values apply to other fibres or to oil lubrication",
    ),
    Assumed(
        surface="steel cage",
        wear=1.7e-15,
        taken_by="`turbine` and `turbopump`",
        why="the wear coefficient is that of the races, and the hardness that of a softer steel",
    ),
    Assumed(
        surface="lead film on steel",
        wear=math.nan,
        taken_by="no scene",
        why="published tests give bearing lives ([film tests](film_tests.md)), but not K_s/H",
    ),
)
"""Assumed values, because no source was found."""


_BALLS = {STEEL: "balls of steel", NITRIDE: "balls of silicon nitride"}

_INTRODUCTION = """\
# Wear and friction coefficients

<!-- made by `python benchmarks/coefficients_page.py docs/coefficients.md` -->

The wear volume is the product of K_s/H, load and slip distance. Papers report K_s/H in mm³/(N m);
1 mm³/(N m) equals 1e-9 m²/N. Each item cites an accessible source and states which part of the
source was read; *text* means that the paper was read, without its figures, in a [copy of the text
of the proceedings](https://github.com/dan-s-mueller/aerospace_chatbot/tree/8d6a2a98/data/AMS). No
published values were found for lead films, phenolic cages, or silicon nitride on steel, so
[assumed](#assumed) values are listed separately.

For the same pair of materials, the coefficients differ by orders of magnitude between sources, so a
test of your own bearing is more reliable than these values ([from a test to
hours](calibrate.md)). [Film tests](film_tests.md) compares predictions based on these values with
published test results."""

_TAKEN = """\
`bearingwear new mine.yaml 7008C --lubrication mos2` uses the median for the lubrication and a
lognormal distribution whose 90 % interval covers the values from its sources. The K_s/H of MoS2
holds in the test of estl whose life is 1. The scene takes the lives of its six tests as
`friction.film.wear_table` ([section 23](theory/23-films.md)). No source has oil or grease:
`--lubrication oil` and `grease` take the row of starved oil and say so. Oil films are not
modelled. *Factor* denotes the geometric standard deviation."""

_SPREAD = """\
If a scene has no `uncertainty`, the commands `uncertainty` and `calibrate` apply the spread for its
pair of materials to the values in the scene, and report which spread was used. A material is
identified as steel by its Young's modulus and density; any film is treated as MoS2, the only film
for which a source was found. For any other pair, the spread is assumed: a factor of {wear.factor:g}
for K_s/H and {friction.factor:g} for friction. The assumed scatter in wear within a batch is a
factor of {scatter:g}. That of films is a factor of {films:g}: six tests of gears with sputtered
MoS2 in vacuum had 1.6, with a 90 % interval of 1.4 to 2.7
([NASA Glenn](https://ntrs.nasa.gov/citations/20180003085), Proceedings
of the 44th Aerospace Mechanisms Symposium (2018) 127)."""

_NO_SOURCE = """\
`mos2_gyro` uses the geometric mean of bearing_in_vacuum and two_discs as they were measured
(1.2e-16 m²/N, at every pressure and temperature) for its film, and the archard value (2.0e-14 m²/N)
for the steel beneath. The values in all other scenes are assumed, because
no source was found:"""


def page_of_coefficients() -> str:
    """The page, in Markdown."""
    rows = [
        f"**{name}**: {m.surface} on {m.against}{f', film {m.film}' if m.film else ''}. K_s/H: "
        f"{_span(m.wear, M2_PER_N, ' m²/N')}; friction: {_span(m.friction)}. "
        f"{m.conditions[0].upper()}{m.conditions[1:]}. [{m.source}]({m.url}), {m.read}."
        for name, m in MEASURED_WEAR.items()
    ]
    pairs = [
        f"**{lubrication}, {_BALLS[balls]}**: K_s/H: {one.wear.median:.2g} m²/N, "
        f"factor {one.wear.factor:.2g}; friction: {one.friction.median:.2g}, "
        f"factor {one.friction.factor:.2g}. Sources: {', '.join(one.rows)}. {one.why}."
        for (lubrication, balls), one in RUBBING.items()
    ]
    assumed = [
        f"**{one.surface}**: {'none' if math.isnan(one.wear) else f'{one.wear:.2g} m²/N'}. Used "
        f"by {one.taken_by}. {one.why[0].upper()}{one.why[1:]}."
        for one in ASSUMED
    ]
    spread = _SPREAD.format(
        wear=ASSUMED_WEAR, friction=ASSUMED_FRICTION, scatter=WEAR_SCATTER, films=FILM_SCATTER
    )
    parts = [_INTRODUCTION, _items(rows), "## Lubrication", _TAKEN, _items(pairs), _wrapped(spread)]
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
        return f"at most {high}{after}" if low == "nan" else f"at least {low}{after}"
    return f"{low}{after}" if low == high else f"{low} to {high}{after}"


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(page_of_coefficients(), encoding="utf-8")
