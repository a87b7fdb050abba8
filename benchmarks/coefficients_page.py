"""The page of measured and assumed coefficients of wear and friction.

`python benchmarks/coefficients_page.py docs/coefficients.md` makes it anew.
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
    M2_PER_N,
    MEASURED_WEAR,
    RUBBING,
    WEAR_SCATTER,
)


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
        why="the value used in the paper is unknown; the magnitude is typical of a solid film",
    ),
    Assumed(
        surface="silicon nitride on steel",
        wear=6.7e-17,
        taken_by="`turbopump` and `new --ball-material silicon_nitride`",
        why="abstracts of papers on this pair contain no number, either for M50 in vacuum "
        "(Tong and others, 2011) or for fretting on bearing steel (Kalin and others, 1997)",
    ),
    Assumed(
        surface="phenolic cage on steel",
        wear=3.3e-13,
        taken_by="cages of `gyro_s1` to `s3` and of `new`",
        why="published numbers apply to other fibres or to lubrication with oil",
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
        why="only bearing lives are published ([films against tests](film_tests.md)), not K_s/H",
    ),
)
"""Assumed values, because no source was found."""


_INTRODUCTION = """\
# Wear and friction coefficients

<!-- made by `python benchmarks/coefficients_page.py docs/coefficients.md` -->

The wear volume is K_s/H times load times slip distance. Papers report K_s/H in mm³/(N m), which is
1e-9 m²/N. Each item cites an accessible source, and states which part of it was read. The
[assumed](#assumed) values are listed separately, because no published number was found for lead
films, phenolic cages, or silicon nitride on steel.

Coefficients for the same pair differ by orders of magnitude between sources, so a test of your own
bearing is more reliable than this table: see [from a test to hours](calibrate.md). [Films against
tests](film_tests.md) reports the error of predictions made with this table."""

_TAKEN = """\
`bearingwear new mine.yaml 7008C --pair steel/steel --film mos2` uses the median for a pair, and a
lognormal spread whose 90 % interval covers the sources for that pair."""

_SPREAD = """\
If a scene has no `uncertainty`, the commands `uncertainty` and `calibrate` use the spread of its
pair about the values of the scene, and report this. Steel is identified by stiffness and density;
any film is treated as MoS2, the only film with a source. For any other pair, the spread is assumed:
a factor of {wear.factor:g} for K_s/H and {friction.factor:g} for friction. The assumed scatter of
wear within a batch is a factor of {scatter:g}."""

_NO_SOURCE = """\
`mos2_gyro` uses the value of steel/steel with mos2 for its film (1.2e-16 m²/N), and that of archard
for the steel below it (2.0e-14 m²/N). The values of all other scenes are assumed, because no source
was found:"""


def page_of_coefficients() -> str:
    """The page, in Markdown."""
    rows = [
        f"**{name}**: {m.surface} on {m.against}{f', film {m.film}' if m.film else ''}. K_s/H "
        f"{_span(m.wear, M2_PER_N, ' m²/N')}, friction {_span(m.friction)}. "
        f"{m.conditions[0].upper()}{m.conditions[1:]}. [{m.source}]({m.url}), {m.read}."
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
