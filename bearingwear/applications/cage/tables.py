"""The table of a map of cages, and what it says."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from bearingwear.applications.cage.gather import CAGE_AXES
from bearingwear.applications.cage.motion import FLOATS, HANGS, WITH_BALLS
from bearingwear.applications.cage.show import shares_in_words, within
from bearingwear.document.bearing_line import bearing_line
from bearingwear.document.document import Block, Document, Row
from bearingwear.document.markdown import as_markdown
from bearingwear.results.units import digits, display
from bearingwear.results.words import scene_of
from bearingwear.scene.blocks import GUIDES
from bearingwear.scene.read import scene_from_dict
from bearingwear.solvers.dynamic.windows import wear_per_joule
from bearingwear.studies.dataset import load_with_axes


def cage_table(motions: Path) -> str:
    """Every cage of a map, as Markdown."""
    return as_markdown(cage_document(motions))


def cage_answer(motions: Path) -> str:
    """What a map of cages says, for the page."""
    return cage_document(motions).stored


def cage_document(path: Path) -> Document:
    """The recommended cage, the quiet region, and a line for each cage of a map."""
    motions = load_with_axes(path, cage_friction=(), gravity=())
    axes = [axis.name for axis, _ in CAGE_AXES.values()]
    every = [
        motions.isel(dict(zip(axes, index, strict=True)))
        for index in itertools.product(*(range(motions.sizes[axis]) for axis in axes))
    ]
    work = [display("J", motions[f"mean_{name}_work"].values[..., 0]) for name in _WORK]
    wear, rates = display("m3 s-1"), mapped_wear(motions)
    noise = display("N m", motions["mean_torque_noise"].values[..., 0])

    def column(label: str, texts: list[str], unit: str = "") -> Row:
        return Row(label, unit, tuple(texts))

    def means(name: str, unit: object) -> list[str]:
        return [
            within(float(one[f"mean_{name}"][0]), one[f"mean_{name}_interval"].values[0], unit)
            for one in every
        ]

    rows = (
        column("gravity", [f"{float(one['gravity']):g}" for one in every], "m/s2"),
        column("guided by", [GUIDES[int(one["guide"])] for one in every]),
        column("imbalance", [digits(1e6 * float(one["imbalance"])) for one in every], "um"),
        column("pockets", [digits(1e3 * float(one["pocket_clearance"])) for one in every], "mm"),
        column("land", [digits(1e3 * float(one["guide_clearance"])) for one in every], "mm"),
        column("friction", [digits(float(one["cage_friction"])) for one in every]),
        column("motions", [shares_in_words(one["share"].values) or "none" for one in every]),
        column("runs", [f"{int(one['runs'])}" for one in every]),
        *(
            column(f"work, {name}s" if name == "pocket" else "work, land",
                means(f"{name}_work", unit), unit.unit)
            for name, unit in zip(_WORK, work, strict=True)
        ),
        *(
            column(f"wear, {'pockets' if name == 'pocket' else 'land'}",
                [wear.text(value) for value in rates[name].values.ravel()], wear.unit)
            for name in _WORK
        ),
        column("torque noise", means("torque_noise", noise), noise.unit),
    )  # fmt: skip
    lines = [
        "Work is normal force times slip per shaft turn; its mean and 90 % interval are listed. "
        "The wear volume is the work multiplied by K_s/H of the cage material.",
    ]
    if (motions["share"].sel(of_motion=HANGS) > 0.0).any():
        lines.append("The motion of a hanging cage may change after hundreds of turns.")
    scene = scene_of(motions)
    said = Block(
        "Choice of a cage",
        lines=(f"{recommended_cage(motions)}.", f"{quiet_region(motions)}."),
        place="lead",
    )
    return Document(
        (f"{scene['name']}: cage motion",),
        {"scene": scene["name"], "bearing": bearing_line(scene)},
        (said, Block("Every cage", (), rows, tuple(lines), axes=len(axes))),
        subject="The cage",
        rank=_RANK,
    )


_WORK = ("pocket", "land")
_RANK = 9  # behind what is said of preloads and lives


QUIET = (FLOATS, HANGS, WITH_BALLS)
"""Motions of a quiet cage; others whirl, are irregular or jam."""

MOSTLY = 0.9
"""Share of the runs with such a motion from which on a cage is quiet."""

DESIGN = ("guide", "imbalance", "pocket_clearance", "guide_clearance", "cage_friction")
"""Dimensions of a map that a designer decides; gravity is not among them."""


class MappedCage(NamedTuple):
    """A cage of a map, the worst of all gravities, by the names of `DESIGN`."""

    at: dict[str, float]
    work: float  # mean in a turn, pockets and land [J]
    low: float  # ends of its interval
    high: float
    quiet: float  # least share of quiet runs
    shares: np.ndarray


def designs(motions: xr.Dataset) -> list[MappedCage]:
    """Every cage of a map under the gravity at which it wears most."""
    found = []
    for values in itertools.product(*(motions[axis].values.tolist() for axis in DESIGN)):
        values_of = dict(zip(DESIGN, values, strict=True))
        one = motions.sel(values_of)
        mean, ends = one["mean_work"].values[:, 0], one["mean_work_interval"].values[:, 0]
        if not np.isfinite(mean).any():
            continue
        worst = int(np.nanargmax(mean))
        quiet = one["share"].values[:, list(QUIET)].sum(axis=1).min()
        low, high = ends[worst].tolist()
        shares = one["share"].values[worst]
        found.append(MappedCage(values_of, float(mean[worst]), low, high, float(quiet), shares))
    return found


def own_design(motions: xr.Dataset, every: list[MappedCage]) -> MappedCage | None:
    """The cage of a map that is next to the scene's."""
    scene = scene_of(motions)
    cage = scene["cage"]
    own = (
        GUIDES.index(cage["guiding_race"]),
        1e-6 * cage.get("imbalance_um", 0.0),
        1e-3 * cage["pocket_clearance_mm"],
        1e-3 * cage["guide_clearance_mm"],
        scene["friction"]["cage"],
    )

    def distance(one: MappedCage) -> float:
        difference = 0.0
        for axis, value in zip(DESIGN, own, strict=True):
            scale = max(abs(value), float(np.max(np.abs(motions[axis].values))), 1e-12)
            difference += abs(one.at[axis] - value) / scale * (1e3 if axis == "guide" else 1.0)
        return difference

    return min(every, key=distance, default=None)


_IN_DESIGN = {
    "imbalance": "an imbalance of {}",
    "pocket_clearance": "a pocket clearance of {}",
    "guide_clearance": "a land clearance of {}",
    "cage_friction": "a friction coefficient of {}",
}


def in_design_words(axis: str, value: float) -> str:
    """A value of a design."""
    short = _short(axis, value)
    if axis == "guide":
        return f"guided by the {'balls' if short == 'ball' else f'{short} race'}"
    if axis == "imbalance" and value == 0.0:
        return "no imbalance"
    return _IN_DESIGN[axis].format(short)


def quiet_region(motions: xr.Dataset) -> str:
    """Region of quiet cages, in a sentence."""
    every = designs(motions)
    quiet = [one for one in every if one.quiet >= MOSTLY]
    gravity = " at every level of gravity" if motions.sizes["gravity"] > 1 else ""
    if not quiet:
        return f"No cage in the map is quiet{gravity}"
    if len(quiet) == len(every):
        return f"Every cage in the map is quiet{gravity}"
    parts = []
    varied = [axis for axis in DESIGN[:-1] if motions.sizes[axis] > 1]
    for values in itertools.product(*(motions[axis].values.tolist() for axis in varied)):
        place = dict(zip(varied, values, strict=True))
        here = [one for one in quiet if place.items() <= one.at.items()]
        if here:
            known = sorted(one.at["cage_friction"] for one in here)
            alike = [float(v) for v in motions["cage_friction"].values if v <= known[-1]]
            upto = "up to " if known == alike and len(known) > 1 else ""
            mu = digits(known[-1]) if upto else ", ".join(map(digits, known))
            where = ", ".join(map(in_design_words, varied, values))
            parts.append(f"{where + ', ' if where else ''}friction {upto}{mu}")
    return (
        f"Cages that are quiet{gravity} (they float, hang or turn with the balls in at least "
        f"{100.0 * MOSTLY:.0f} % of the runs): {'; '.join(parts)}"
    )


def recommended_cage(motions: xr.Dataset) -> str:
    """Which cage of a map to take, in words."""
    every = designs(motions)
    own = own_design(motions, every)
    if own is None:
        return "No cage in the map could be evaluated"
    calm = [one for one in every if one.quiet >= MOSTLY] or every
    best = min(calm, key=lambda one: one.high if math.isfinite(one.high) else math.inf)
    own_words = f"the present cage ({shares_in_words(own.shares)})"
    if best.at == own.at or not best.high < own.low:
        return f"Keep {own_words}: no quieter cage in the map wears significantly less"
    changes = ", ".join(
        f"{in_design_words(axis, best.at[axis])} (now {_short(axis, own.at[axis])})"
        for axis in DESIGN
        if best.at[axis] != own.at[axis]
    )
    less = own.work / best.work if best.work > 0.0 else math.inf
    ends = own.low / best.high, own.high / best.low if best.low > 0.0 else math.inf
    return (
        f"Best cage in the map: {changes}. Compared with {own_words}, this cage "
        f"({shares_in_words(best.shares)}) reduces wear by a factor of {digits(round(less, 1))} "
        f"({digits(float(f'{ends[0]:.2g}'))} to {digits(float(f'{ends[1]:.2g}'))})"
    )


def _short(axis: str, value: float) -> str:
    if axis == "guide":
        return GUIDES[int(value)]
    unit = {"imbalance": (1e6, " µm"), "cage_friction": (1.0, "")}.get(axis, (1e3, " mm"))
    return f"{digits(unit[0] * value)}{unit[1]}"


def mapped_wear(motions: xr.Dataset) -> dict[str, Any]:
    """Wear of pockets and land of a map [m3/s], by the scene's K_s/H, without a film."""
    scene = scene_from_dict(scene_of(motions))
    assert scene.cage is not None
    per_joule, rpm = wear_per_joule(scene, scene.cage.material), scene.operation.fastest_rpm
    return {
        name: motions[f"mean_{name}_work"].isel(group=0) * per_joule * rpm / 60.0
        for name in ("pocket", "land")
    }
