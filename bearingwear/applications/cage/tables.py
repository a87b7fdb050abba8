"""The table of a map of cages, and the recommended cage."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from bearingwear.applications.cage.gather import CAGE_AXES
from bearingwear.applications.cage.motion import FLOATS, HANGS, WITH_BALLS
from bearingwear.applications.cage.show import mean_with_interval, shares_in_words
from bearingwear.document.bearing_line import bearing_line
from bearingwear.document.document import Block, Document, Row
from bearingwear.document.markdown import as_markdown
from bearingwear.results.units import Display, digits, display
from bearingwear.results.words import plain_scene
from bearingwear.scene.blocks import GUIDES
from bearingwear.scene.read import scene_from_dict
from bearingwear.solvers.dynamic.windows import wear_per_joule
from bearingwear.studies.dataset import load_with_axes


def cage_table(motions: Path) -> str:
    """Returns Markdown of the report on the map of cages in a file."""
    return as_markdown(cage_document(motions))


def cage_answer(motions: Path) -> str:
    """Returns JSON of the report on the map of cages in a file, which the page reads."""
    return cage_document(motions).stored


def cage_document(path: Path) -> Document:
    """Returns the report on the map of cages in a file.

    It states the recommended cage, the quiet cages, and the results of every cage.
    """
    motions = load_with_axes(path, cage_friction=(), gravity=())
    lines = [
        "Work is normal force times slip per shaft turn; its mean and 90 % interval are listed. "
        "The wear volume is the work multiplied by K_s/H of the cage material.",
    ]
    if (motions["share"].sel(of_motion=HANGS) > 0.0).any():
        lines.append("The motion of a hanging cage may change after hundreds of turns.")
    scene = plain_scene(motions)
    choice = Block(
        "Choice of a cage",
        lines=(f"{cage_choice_sentence(motions)}.", f"{quiet_region(motions)}."),
        place="lead",
    )
    return Document(
        (f"{scene['name']}: cage motion",),
        {"scene": scene["name"], "bearing": bearing_line(scene)},
        (choice, Block("Every cage", (), _cage_rows(motions), tuple(lines), axes=len(CAGE_AXES))),
        subject="The cage",
        rank=_RANK,
    )


def _cage_rows(motions: xr.Dataset) -> tuple[Row, ...]:
    """Returns a row for each property of the cages of a map, with a cell for each cage.

    The first rows are the values along its dimensions; means are those over all runs.
    """
    axes = [axis.name for axis, _ in CAGE_AXES.values()]
    index_ranges = [range(motions.sizes[axis]) for axis in axes]
    cages = [
        motions.isel(dict(zip(axes, indices, strict=True)))
        for indices in itertools.product(*index_ranges)
    ]
    pocket_work = display("J", motions["mean_pocket_work"].values[..., 0])
    land_work = display("J", motions["mean_land_work"].values[..., 0])
    wear, rates = display("m3 s-1"), mapped_wear(motions)
    noise = display("N m", motions["mean_torque_noise"].values[..., 0])

    def column(label: str, texts: list[str], unit: str = "") -> Row:
        """Returns a property of the cages, which a page shows as a column."""
        return Row(label, unit, tuple(texts))

    def means(name: str, unit: Display) -> list[str]:
        """Returns the mean of a variable over all runs of each cage, with its interval, as text."""
        return [
            mean_with_interval(
                float(cage[f"mean_{name}"][0]), cage[f"mean_{name}_interval"].values[0], unit
            )
            for cage in cages
        ]

    def wear_rates(name: str) -> list[str]:
        """Returns the wear rate of `pocket` or `land` of each cage."""
        return [wear.text(value) for value in rates[name].values.ravel()]

    return (
        column("gravity", [f"{float(cage['gravity']):g}" for cage in cages], "m/s2"),
        column("guided by", [GUIDES[int(cage["guide"])] for cage in cages]),
        column("imbalance", [digits(1e6 * float(cage["imbalance"])) for cage in cages], "um"),
        column("pockets", [digits(1e3 * float(cage["pocket_clearance"])) for cage in cages], "mm"),
        column("land", [digits(1e3 * float(cage["guide_clearance"])) for cage in cages], "mm"),
        column("friction", [digits(float(cage["cage_friction"])) for cage in cages]),
        column("motions", [shares_in_words(cage["share"].values) or "none" for cage in cages]),
        column("runs", [f"{int(cage['runs'])}" for cage in cages]),
        column("work, pockets", means("pocket_work", pocket_work), pocket_work.unit),
        column("work, land", means("land_work", land_work), land_work.unit),
        column("wear, pockets", wear_rates("pocket"), wear.unit),
        column("wear, land", wear_rates("land"), wear.unit),
        column("torque noise", means("torque_noise", noise), noise.unit),
    )


_RANK = 9  # on the page, behind preloads and lives


QUIET = (FLOATS, HANGS, WITH_BALLS)
"""Motions of a quiet cage; others whirl, are irregular or jam."""

MOSTLY = 0.9
"""Share of the runs with a motion of `QUIET` from which on a cage is quiet."""

DESIGN = ("guide", "imbalance", "pocket_clearance", "guide_clearance", "cage_friction")
"""Dimensions of a map that a designer decides; gravity is not among them."""


class MappedCage(NamedTuple):
    """A cage of a map under the gravity at which its work is largest."""

    design: dict[str, float]  # by the names of `DESIGN` [SI]; a guide by its index
    work: float  # mean per turn, pockets and land [J]
    low: float  # lower end of the interval of the work [J]
    high: float  # upper end [J]
    quiet: float  # share of quiet runs, at the gravity where it is least
    shares: np.ndarray  # of the runs that end in each motion


def mapped_cages(motions: xr.Dataset) -> list[MappedCage]:
    """Returns every cage of a map under the gravity at which its work per turn is largest.

    A cage without a solved run at any gravity is left out.
    """
    cages = []
    for values in itertools.product(*(motions[axis].values.tolist() for axis in DESIGN)):
        design = dict(zip(DESIGN, values, strict=True))
        ensembles = motions.sel(design)
        work = ensembles["mean_work"].values[:, 0]
        if not np.isfinite(work).any():
            continue
        worst = int(np.nanargmax(work))
        low, high = ensembles["mean_work_interval"].values[worst, 0].tolist()
        shares = ensembles["share"].values
        cages.append(
            MappedCage(
                design=design,
                work=float(work[worst]),
                low=low,
                high=high,
                quiet=float(shares[:, list(QUIET)].sum(axis=1).min()),
                shares=shares[worst],
            )
        )
    return cages


def present_cage(motions: xr.Dataset, cages: list[MappedCage]) -> MappedCage | None:
    """Returns the cage of a map that is nearest to that of its scene; None if there are no cages.

    Any cage with the same guide is nearer than one with another.
    """
    scene = plain_scene(motions)
    cage = scene["cage"]
    present = {
        "guide": GUIDES.index(cage["guiding_race"]),
        "imbalance": 1e-6 * cage.get("imbalance_um", 0.0),
        "pocket_clearance": 1e-3 * cage["pocket_clearance_mm"],
        "guide_clearance": 1e-3 * cage["guide_clearance_mm"],
        "cage_friction": scene["friction"]["cage"],
    }

    def distance(mapped: MappedCage) -> float:
        """Returns the sum of the differences, each relative to the largest value of its axis."""
        total = 0.0
        for axis, value in present.items():
            largest = max(abs(value), float(np.max(np.abs(motions[axis].values))))
            weight = _GUIDE_WEIGHT if axis == "guide" else 1.0
            total += weight * abs(mapped.design[axis] - value) / max(largest, _NO_DIVISION_BY_ZERO)
        return total

    return min(cages, key=distance, default=None)


_GUIDE_WEIGHT = 1e3  # more than the sum of all other differences, each of which is at most 2
_NO_DIVISION_BY_ZERO = 1e-12  # for an axis with no other value than zero

_IN_DESIGN = {
    "imbalance": "an imbalance of {}",
    "pocket_clearance": "a pocket clearance of {}",
    "guide_clearance": "a land clearance of {}",
    "cage_friction": "a friction coefficient of {}",
}


def in_design_words(axis: str, value: float) -> str:
    """Returns a value of a design in words: `a land clearance of 0.2 mm`.

    axis: one of `DESIGN`, whose value is in SI units or the index of a guide.
    """
    text = _design_value(axis, value)
    if axis == "guide":
        return "guided by the balls" if text == "ball" else f"guided by the {text} race"
    if axis == "imbalance" and value == 0.0:
        return "no imbalance"
    return _IN_DESIGN[axis].format(text)


def quiet_region(motions: xr.Dataset) -> str:
    """Describes the region of quiet cages in a sentence without a full stop.

    It lists the quiet frictions of each design, or says that all cages are quiet, or that no cage
    is.
    """
    cages = mapped_cages(motions)
    quiet = [cage for cage in cages if cage.quiet >= MOSTLY]
    gravity = " at every level of gravity" if motions.sizes["gravity"] > 1 else ""
    if not quiet:
        return f"No cage in the map is quiet{gravity}"
    if len(quiet) == len(cages):
        return f"Every cage in the map is quiet{gravity}"
    parts = []
    varied = [axis for axis in DESIGN[:-1] if motions.sizes[axis] > 1]
    for values in itertools.product(*(motions[axis].values.tolist() for axis in varied)):
        axes = dict(zip(varied, values, strict=True))
        quiet_frictions = sorted(
            cage.design["cage_friction"]
            for cage in quiet
            if all(cage.design[axis] == value for axis, value in axes.items())
        )
        if quiet_frictions:
            friction = _friction_range(quiet_frictions, motions["cage_friction"].values.tolist())
            words = [in_design_words(axis, value) for axis, value in axes.items()]
            parts.append(", ".join([*words, f"friction {friction}"]))
    return (
        f"Cages that are quiet{gravity} (they float, hang or turn with the balls in at least "
        f"{100.0 * MOSTLY:.0f} % of the runs): {'; '.join(parts)}"
    )


def _friction_range(quiet: list[float], mapped: list[float]) -> str:
    """Lists the friction coefficients of quiet cages.

    Several are written as `up to 0.2` if they are all mapped ones up to that value.

    quiet, mapped: in rising order; all quiet ones are mapped.
    """
    if len(quiet) > 1 and quiet == [friction for friction in mapped if friction <= quiet[-1]]:
        return f"up to {digits(quiet[-1])}"
    return ", ".join(map(digits, quiet))


def cage_choice_sentence(motions: xr.Dataset) -> str:
    """States which cage of a map to choose, in words, without a full stop.

    It is the cage with the lowest upper end of the interval of its work: of the quiet cages or, if
    there are none, of all. The present cage stays unless that is below the lower end of its own.
    """
    cages = mapped_cages(motions)
    present = present_cage(motions, cages)
    if present is None:
        return "No cage in the map could be evaluated"
    candidates = [cage for cage in cages if cage.quiet >= MOSTLY] or cages
    best = min(candidates, key=lambda cage: cage.high if math.isfinite(cage.high) else math.inf)
    present_words = f"the present cage ({shares_in_words(present.shares)})"
    if best.design == present.design or not best.high < present.low:
        return f"Keep {present_words}: no quieter cage in the map wears significantly less"
    changes = ", ".join(
        f"{in_design_words(axis, value)} (now {_design_value(axis, present.design[axis])})"
        for axis, value in best.design.items()
        if value != present.design[axis]
    )
    factor = present.work / best.work if best.work > 0.0 else math.inf
    lowest = present.low / best.high
    highest = present.high / best.low if best.low > 0.0 else math.inf
    return (
        f"Best cage in the map: {changes}. Compared with {present_words}, this cage "
        f"({shares_in_words(best.shares)}) reduces wear by a factor of {digits(round(factor, 1))} "
        f"({digits(float(f'{lowest:.2g}'))} to {digits(float(f'{highest:.2g}'))})"
    )


def _design_value(axis: str, value: float) -> str:
    """Returns a value of a design with its unit as text.

    axis: one of `DESIGN`, whose value is in SI units or the index of a guide.
    """
    if axis == "guide":
        return GUIDES[int(value)]
    if axis == "imbalance":
        return f"{digits(1e6 * value)} µm"
    if axis == "cage_friction":
        return digits(value)
    return f"{digits(1e3 * value)} mm"


def mapped_wear(motions: xr.Dataset) -> dict[str, Any]:
    """Returns the wear rates of `pocket` and `land` by these names, over the axes of a map [m3/s].

    They follow from the mean work of all runs and K_s/H of the cage material, without a film.
    """
    scene = scene_from_dict(plain_scene(motions))
    assert scene.cage is not None
    per_joule, rpm = wear_per_joule(scene, scene.cage.material), scene.operation.fastest_rpm
    return {
        name: motions[f"mean_{name}_work"].isel(group=0) * per_joule * rpm / 60.0
        for name in ("pocket", "land")
    }
