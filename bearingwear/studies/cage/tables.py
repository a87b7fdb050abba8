"""The table of a map of cages, and what it says."""

from __future__ import annotations

import itertools
from pathlib import Path

import xarray as xr

from bearingwear.document.bearing_line import bearing_line
from bearingwear.document.document import Block, Document, Row
from bearingwear.document.markdown import as_markdown
from bearingwear.results.units import digits, display
from bearingwear.results.words import scene_of
from bearingwear.scene.blocks import GUIDES
from bearingwear.studies.cage.advice import mapped_wear, quiet_region, recommended_cage
from bearingwear.studies.cage.gather import CAGE_AXES
from bearingwear.studies.cage.motion import HANGS
from bearingwear.studies.cage.show import shares_in_words, within
from bearingwear.studies.dataset import loaded


def cage_table(motions: Path) -> str:
    """Step: every cage of a map, as Markdown."""
    return as_markdown(cage_document(loaded(motions, cage_friction=(), gravity=())))


def cage_answer(motions: Path) -> str:
    """Step: what a map of cages says, for the page."""
    return cage_document(loaded(motions, cage_friction=(), gravity=())).stored


def cage_document(motions: xr.Dataset) -> Document:
    """The recommended_cage, the quiet region, and a line for each cage of a map."""
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
        "Work: normal force times slip in a shaft turn, mean and its 90 % interval. Times "
        "K_s/H of the cage material, it is the volume worn off.",
    ]
    if (motions["share"].sel(of_motion=HANGS) > 0.0).any():
        lines.append("A cage that hangs may change its motion after hundreds of turns.")
    scene = scene_of(motions)
    said = Block(
        "Which cage to take",
        lines=(f"{recommended_cage(motions)}.", f"{quiet_region(motions)}."),
        place="lead",
    )
    return Document(
        (f"{scene['name']}: motions of its cage",),
        {"scene": scene["name"], "bearing": bearing_line(scene)},
        (said, Block("Every cage", (), rows, tuple(lines), axes=len(axes))),
        subject="The cage",
        rank=_RANK,
    )


_WORK = ("pocket", "land")
_RANK = 9  # behind what is said of preloads and lives
