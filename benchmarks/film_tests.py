"""Predictions for films, compared with published tests: docs/film_tests.md and its figure.

    python benchmarks/film_tests.py docs

Coefficients are those of docs/coefficients.md; nothing is tuned to a test.
"""

from __future__ import annotations

import math
import sys
import textwrap
from pathlib import Path

import bearingwear
from bearingwear.plotting.drawing import key, new_figure, save
from bearingwear.scene.coefficients import NINETY, RUBBING
from bearingwear.solvers.bearing.films import Films

SEEN, LOADS, LIVES = 1.05e8, (250.0, 1000.0), (5e5, 3.8e4)  # that at 250 g is a lower bound
MEASURED = {"color": "C3", "marker": "s", "markersize": 8, "markerfacecolor": "none"}


def revolutions() -> tuple[float, float]:
    """Until half of a track of the NASA bearing is bare, by the program; K_s/H taken [m2/N]."""
    scene = bearingwear.new(
        designation="7204C", maker="NSK", speed=1750, preload=137.9,
        preload_method="constant_force", pair="steel/steel", film="mos2",
    ).with_({"wear.end_of_life": {"film_worn_share": 0.5}})  # fmt: skip
    hours = bearingwear.life(scene).life.item()
    film = Films.of(scene).race.film
    assert film is not None
    return hours * 60.0 * 1750.0, film.factor


def exponent() -> float:
    """Of pressure in K_s: what the ratio of Spalvins' lives leaves beside Archard's law.

    A film on a track as wide as Hertz's contact wears by K F/width a turn; width and pressure go
    as F^(1/3).
    """
    ratio = math.log(LIVES[0] / LIVES[1]) / math.log(LOADS[1] / LOADS[0])
    return 3.0 * (ratio - 2.0 / 3.0)


def rounded(value: float, digits: int) -> str:
    """Plain up to four figures, else with a short exponent: 1300, 1.05e8."""
    text = f"{value:.{digits}g}"
    return f"{float(text):g}" if value < 1e4 else text.replace("e+0", "e")


def page() -> str:
    rev, K = revolutions()
    wear = RUBBING["steel/steel", "mos2"].wear
    low, high = (rev * K / (wear.median * wear.factor**z) for z in (NINETY, -NINETY))
    bound, archard = K * rev / SEEN, 4.0 ** (2.0 / 3.0)
    _draw(rev, (low, high), archard)
    text = f"""\
# Film tests

<!-- made by `python benchmarks/film_tests.py docs` -->

This page compares predictions with published tests of solid-lubricant films. All predictions use
the same published [coefficients](coefficients.md), which were not tuned to any test. Only two of
the six test results can be predicted; both predictions fail with the median coefficients.

![Revolutions to wear-through of a film, and life against load](figures/film_tests.svg)

| **Sputtered MoS2** (0.6 µm, angular contact bearing, 1750 r/min, 137.9 N, vacuum) [1] | the film \
lasted more than {rounded(SEEN, 3)} revolutions | The computed life is {rounded(rev, 2)} \
revolutions (90 % interval {rounded(low, 1)} to {rounded(high, 1)}) | {SEEN / rev:.2g} or more | \
so the prediction **fails** |
| **Sputtered MoS2** (0.2 to 0.65 µm, pin on disc) [2] | quadrupling the load shortened the life \
by a factor of {LIVES[0] / LIVES[1]:.3g} or more | The computed factor is {archard:.2g} \
(Archard's law) | {LIVES[0] / LIVES[1] / archard:.2g} or more | so the prediction **fails** |
| **Lead on a retainer** (40 mm bore, 30 000 r/min, 1780 N, liquid hydrogen) [3] | a 50 µm film \
lasted 15 h, and other films lasted 2 to 6 h | – | | No prediction is made, because no wear \
coefficient for lead was found |
| **Lead alloys** (same conditions) [4] | the films lasted 22.5 and 19.3 h | – | | No prediction \
is made, because no wear coefficient was found |
| **PTFE transfer film** (40 mm bore, liquid hydrogen) [5] | the film withstood 2000 N/mm² at a \
spin velocity of 5 m/s | – | | No prediction is made, because the model does not include film \
rupture |
| **SR4** (self-lubricating) | more than 3.7e9 revolutions were reported | – | | No comparison is \
made, because no accessible source was found |

The abstract of [1] does not state the bearing size, so a 7204C with NSK's ball complement is
assumed. The life of the bearing is assumed to end when half of a track is bare. The test ended
without failure (run-out), so K_s/H was at most {bound:.2g} m²/N. In the two-disc test [6], K_s/H
was 4e-15 m²/N during running-in, {rounded(4e-15 / bound, 2)} times the bound from [1]. The 90 %
interval of K_s/H in the table of coefficients extends from one of these values to the other, so the
run-out lies at the lower end of the interval.

**Cause.** A transferred and compacted film, in which patches of material move back and forth, wears
much more slowly than a film in its first thousand cycles. A single value of K_s/H cannot describe
both stages. Moreover, film debris may have continued to lubricate the test bearing beyond the point
at which the film wears through in the model.

**Load.** According to Archard's law, the life of a track as wide as the Hertzian contact is
proportional to F^(-2/3), so quadrupling the load shortens the life by a factor of {archard:.2g}. To
match the result of [2], K_s must be proportional to the pressure raised to a power of
{exponent():.2g} or more. `friction.film.pressure_exponent` represents such an increase
([theory](theory/23-films.md)). By default, no pressure exponent is used, because its value is based
on a single pair of loads.

1. [NASA, bearing endurance tests in vacuum](https://core.ac.uk/works/24927645)
2. [Spalvins, 1971](https://ntrs.nasa.gov/citations/19720029182)
3. [Wisander, Brewe, Scibbe, 1972](https://catalog.hathitrust.org/Record/011445060)
4. [Brewe, Scibbe, Wisander, 1973](https://id.scribd.com/document/175017241/19730018685-1973018685)
5. [Nosaka and others, 1993](https://www.scilit.net/publications/d14c1a0a71f25a93674a469b727af1f5)
6. [Seynstahl and others, 2023](https://www.mdpi.com/2075-4442/11/8/335)

Only the abstracts of these references were read.
"""
    return "\n".join(_wrapped(line) for line in text.split("\n"))


def _wrapped(line: str) -> str:
    """A row `| test | measured | computed | factor | verdict |` as an item of a list."""
    if not line.startswith("| "):
        return line
    test, seen, program, off, verdict = (cell.strip() for cell in line.strip("|").split(" |"))
    if program == "–":
        text = f"{test}: {seen}. {verdict}."
    else:
        factor = f", which is too low by a factor of {off}" if off else ""
        text = f"{test}: {seen}. {program}{factor}, {verdict}."
    return textwrap.fill(text, 100, initial_indent="- ", subsequent_indent="  ")


def _draw(rev: float, ends: tuple[float, float], archard: float) -> None:
    figure, ((left, right),) = new_figure(1, 2, 7.2, 2.8)
    left.plot(ends, (0, 0), color="C2", linewidth=6, alpha=0.4, solid_capstyle="butt")
    left.plot(rev, 0, "o", color="C2")
    left.plot(SEEN, 1, ">", color="C3")
    left.set_xscale("log")
    left.set_yticks((0, 1), ("computed", "NASA"))
    left.set_ylim(-0.6, 1.6)
    left.set_xlabel("revolutions until the film is worn through")
    lives = [LIVES[1] * archard, LIVES[1]]
    right.plot(LOADS, LIVES, "-", color="C3")
    right.plot(LOADS[0], LIVES[0], "^", color="C3")
    right.plot(LOADS, lives, "o-", color="C2")
    right.plot(LOADS[1], LIVES[1], **MEASURED)  # round the computed one, which starts from it
    right.set_xscale("log")
    right.set_yscale("log")
    right.set_xticks(LOADS, [f"{load:g}" for load in LOADS])
    right.set_yticks((4e4, 1e5, 4e5), ("4 × 10⁴", "1 × 10⁵", "4 × 10⁵"))
    right.minorticks_off()
    right.set_xlabel("load (g, as in the test)")
    right.set_ylabel("life (cycles)")
    handles = [
        key("computed, bar: 90 % interval of the wear coefficient", color="C2", marker="o"),
        key("measured lower bound of revolutions", color="C3", linestyle="none", marker=">"),
        key("measured lower bound of life", color="C3", linestyle="none", marker="^"),
        key("measured at 1000 g, start of the computed line", linestyle="none", **MEASURED),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=2)
    figure.suptitle(f"An MoS₂ film lasted at least {SEEN / rev:.0f} times as long as computed")
    save(figure, ["docs/figures/film_tests.svg"])


if __name__ == "__main__":
    Path(sys.argv[1], "film_tests.md").write_text(page(), encoding="utf-8")
