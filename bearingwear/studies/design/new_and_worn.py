"""The preload to take for a scene, found in seconds, and the bearing with it: new and worn."""

from __future__ import annotations

from functools import partial

import xarray as xr

from bearingwear.document.document import Block, Document, Row
from bearingwear.kernels.status import OK
from bearingwear.plotting.drawing import methods, scene_of
from bearingwear.results.pair_variables import method_words
from bearingwear.results.units import display
from bearingwear.scene.scene import Scene
from bearingwear.studies.dataset import counted
from bearingwear.studies.design.plan import COARSE, DesignLimits, axes_around
from bearingwear.studies.design.recommend import mapped
from bearingwear.studies.design.show import recommendation_sheet
from bearingwear.studies.design.words import SHORT_TABLE, brief_numbers, brief_units
from bearingwear.studies.pool import Tell


def recommended_sheet(
    scene: Scene,
    limits: DesignLimits,
    source: str = "scene",
    workers: int = 1,
    tell: Tell | None = None,
) -> tuple[Document, bool]:
    """The preload to take at the scene's own friction and speed, by each method.

    And whether any life was solved at all.

    Parameters
    ----------
    scene : Scene
        With a steady state and an end of life.
    limits : DesignLimits
    source : str
        What error messages name.
    workers, tell
        As of `recommend.mapped`.
    """
    limits.check(scene, source)
    axes = axes_around(scene, [scene.friction.coefficient], source, COARSE)
    design, found = mapped(scene, axes, limits, workers, tell, quick=bool(limits.given))
    chosen = recommendation_sheet(found)
    every = [] if limits.given else _over_preload(design)
    sheet = Document(chosen.heading, chosen.facts, (*chosen.blocks, *_at_ends(found), *every))
    return sheet, bool((design["status"] == OK).any())


def _at_ends(found: xr.Dataset) -> list[Block]:
    """Of the recommended bearings, when new and at the end of life."""
    columns = {
        f"{method_words(scene_of(found), method)}, {when}": (one, at)
        for method, one in methods(found)
        if one["status"] == OK
        for when, at in (("new", "start"), ("worn", "end"))
    }
    if not columns:
        return []

    def value(column: tuple[xr.Dataset, str], name: str) -> float:
        one, at = column
        return float(one[f"{name}_at_{at}"])

    of = [partial(value, column) for column in columns.values()]
    rows = [_row("residual preload", "N", [each("residual_preload") for each in of])]
    for measure in SHORT_TABLE:
        numbers = [measure.critical(each)[0] for each in of]
        rows.append(_row(measure.short, measure.si_unit, numbers, measure.shown_as))
    return [Block("at that preload", tuple(columns), tuple(rows))]


def _over_preload(design: xr.Dataset) -> list[Block]:
    """Life of each method, and what may be limited, over the preload."""
    line = design.isel(friction=0, shaft_speed=0)
    basis = counted(design)
    columns = tuple(f"{preload:g} N" for preload in line["preload"].values)
    blocks = []
    for method, one in methods(line):
        rows = [Row("life", "h", tuple(one["life"].isel(loss_basis=basis).values.tolist()), "life")]
        for (label, unit), numbers in zip(brief_units(one), brief_numbers(one), strict=True):
            shown = tuple(float(unit.of(number)) for number in numbers.values)
            rows.append(Row(label, unit.unit, shown, str(numbers.name or "")))
        beyond = tuple("x" if number else "" for number in one["impractical"].values)
        rows.append(Row("nobody would build it", "", beyond, "impractical"))
        title = f"over the preload, {method_words(scene_of(design), method)}"
        blocks.append(Block(title, columns, tuple(rows)))
    return blocks


def _row(label: str, units: str, numbers: list[float], shown: str = "") -> Row:
    unit = display(units, numbers, shown=shown)
    return Row(label, unit.unit, tuple(float(unit.of(number)) for number in numbers))
