"""What the report page shows of a life over a duty."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import xarray as xr

from bearingwear.document.bearing_line import bearing_line
from bearingwear.document.document import Block, Document
from bearingwear.document.show import sheet_of_result
from bearingwear.lives.life import life
from bearingwear.plotting.drawing import Figure, frame, new_figure
from bearingwear.results.netcdf import dataset_of_result, load
from bearingwear.results.pair_variables import method_words
from bearingwear.results.words import datasets_by_bearing
from bearingwear.scene.arrangement import with_method
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import Scene
from bearingwear.solvers.result import Result
from bearingwear.studies.design.document.sentences import (
    points_with_short_life,
    recommended_points,
    sentence,
)
from bearingwear.studies.design.recommend import recommended_for
from bearingwear.studies.lives.duty_figure import duty_figure, duty_message

FOLDED = "worst in each phase"
"""Title of the first block of the sheet that is folded away on the page, as are all after it."""


class _Preload(NamedTuple):
    """The preload at which the page shows the duty."""

    scene: Scene
    kind: str  # such as `recommended preload`
    note: str = ""  # why it is no recommended one


def duty_report(scene: Path, recommendation: Path | None = None) -> tuple[xr.Dataset, str, Figure]:
    """Step: returns the life of a scene over its duty, its answer for the page, and its figure.

    Without a recommendation, the preload is that of the scene. The figure of a pair is that of its
    first bearing.

    recommendation: file of `bearingwear recommend`, from which the preload is chosen.
    """
    base = load_scene(scene)
    preload = _Preload(base, "input preload")
    if recommendation is not None:
        preload = _chosen_preload(base, recommended_for(base, load(recommendation)))
    result = life(preload.scene)
    duty_life = dataset_of_result(result)
    first_bearing = next(iter(datasets_by_bearing(duty_life).values()))
    if "history_phase_worn_share" in first_bearing:
        message = duty_message(first_bearing)
        figure = duty_figure(first_bearing)
    else:
        message = f"{result.scene['name']}: no life over the duty: {result.reason}"
        figure, _ = new_figure(1, 1, 5.2, 1.0)
        frame(figure, message, [], columns=1)
    return duty_life, _duty_answer(result, message, preload).stored, figure


def _chosen_preload(scene: Scene, recommendation: xr.Dataset) -> _Preload:
    """Returns the recommended preload; without one, that of the longest life or the input one."""
    kind, note = "recommended preload", ""
    points = recommended_points(recommendation)
    if not points:
        kind = "preload with the longest life"
        note = "No preload is recommended: this longest life is shorter than required."
        points = points_with_short_life(recommendation)
    if not points:
        return _Preload(scene, "input preload", "No preload is recommended.")
    best = points[0]
    return _Preload(with_method(scene, best.method, best.preload), kind, note)


def _duty_answer(result: Result, message: str, preload: _Preload) -> Document:
    """Returns the sheet of a life over a duty, as an answer of the report page.

    Its sentences lead the page. The tables from `FOLDED` on are folded away.
    """
    sheet = sheet_of_result(result)
    titles = [block.title for block in sheet.blocks]
    count = titles.index(FOLDED) if FOLDED in titles else len(titles)
    open_blocks = sheet.blocks[:count]
    folded_blocks = sheet.blocks[count:]
    sentences = [sentence(line.rstrip(".")) for block in open_blocks for line in block.lines]
    if preload.note:
        sentences = [preload.note, *sentences]
    name, operation = result.scene["name"], result.scene["operation"]
    method = method_words(result.scene, operation["preload_method"])
    title = f"What ends the life at the {preload.kind}"
    return replace(
        sheet,
        heading=(message,),
        facts={
            "scene": name,
            "bearing": bearing_line(result.scene),
            "beside": f"Duty at the {preload.kind}, {operation['preload_N']:.7g} N ({method})",
        },
        blocks=(
            Block(title, lines=tuple(sentences), place="lead"),
            *(replace(block, lines=(), place="open") for block in open_blocks),
            *folded_blocks,
        ),
        figures=("duty",),
        subject="Duty",
        rank=1,  # after the recommended preload, before the comparison of methods
    )
