"""What the report page shows of a life over a duty."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import xarray as xr

from bearingwear.document.bearing_line import bearing_line
from bearingwear.document.document import Block
from bearingwear.document.show import sheet_of_result
from bearingwear.lives.life import life
from bearingwear.plotting.drawing import Figure, frame, new_figure
from bearingwear.results.netcdf import dataset, load
from bearingwear.results.pair_variables import method_words
from bearingwear.results.words import datasets_by_bearing
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import Scene
from bearingwear.studies.design.document.sentences import (
    points_with_short_life,
    recommended_points,
    sentence,
)
from bearingwear.studies.design.recommend import recommended_for
from bearingwear.studies.lives.duty_figure import duty_figure, duty_message

FOLDED = "worst in each phase"
"""First block of the sheet that is folded away on the page, as are those after it."""


class _Preload(NamedTuple):
    """The preload at which the page shows the duty."""

    scene: Scene
    kind: str  # `recommended preload`
    note: str = ""  # why it is no recommended one


def duty_report(scene: Path, recommendation: Path | None = None) -> tuple[xr.Dataset, str, Figure]:
    """Step: the life of a scene over its duty, its sheet as an answer of the page, its figure.

    The preload is the recommended one if there is a recommendation with one.
    """
    base = load_scene(scene)
    preload = _Preload(base, "input preload")
    if recommendation is not None:
        preload = _chosen_preload(base, recommended_for(base, load(recommendation)))
    result = life(preload.scene)
    lived = dataset(result)
    of_first, *_ = datasets_by_bearing(lived).values()
    if "history_phase_worn_share" in of_first:
        message, figure = duty_message(of_first), duty_figure(of_first)
    else:
        message = f"{result.scene['name']}: no life over the duty: {result.reason}"
        figure, _ = new_figure(1, 1, 5.2, 1.0)
        frame(figure, message, [], columns=1)
    sheet = sheet_of_result(result)
    titles = [block.title for block in sheet.blocks]
    count = titles.index(FOLDED) if FOLDED in titles else len(titles)
    first, others = sheet.blocks[:count], sheet.blocks[count:]
    sentences = [sentence(line.rstrip(".")) for block in first for line in block.lines]
    if preload.note:
        sentences = [preload.note, *sentences]
    name, operation = result.scene["name"], result.scene["operation"]
    method = method_words(result.scene, operation["preload_method"])
    title = f"What ends the life at the {preload.kind}"
    answer = replace(
        sheet,
        heading=(message,),
        facts={
            "scene": name,
            "bearing": bearing_line(result.scene),
            "beside": f"Duty at the {preload.kind}, {operation['preload_N']:.7g} N ({method})",
        },
        blocks=(
            Block(title, lines=tuple(sentences), place="lead"),
            *(replace(block, lines=(), place="open") for block in first),
            *others,
        ),
        figures=("duty",),
        subject="Duty",
        rank=1,  # after the recommended preload, before the comparison of methods
    )
    return lived, answer.stored, figure


def _chosen_preload(scene: Scene, recommendation: xr.Dataset) -> _Preload:
    """Returns the recommended preload; the nearest or the input one if none is recommended."""
    kind, note = "recommended preload", ""
    points = recommended_points(recommendation)
    if not points:
        kind = "preload with the longest life"
        note = "No preload is recommended: this longest life is shorter than required."
        points = points_with_short_life(recommendation)
    if not points:
        note = "No preload is recommended."
        return _Preload(scene, "input preload", note)
    best = points[0]
    return _Preload(held_by(scene, best.method, best.preload), kind, note)
