"""What the report page shows of a life over a duty."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import xarray as xr

from bearingwear.document.bearing_line import bearing_line
from bearingwear.document.document import Block, Document
from bearingwear.document.show import sheet_of_result
from bearingwear.lives.life import life
from bearingwear.plotting.drawing import Figure, frame, new_figure
from bearingwear.results.netcdf import dataset_of_result
from bearingwear.results.pair_variables import method_words
from bearingwear.results.words import datasets_by_bearing
from bearingwear.scene.read import load_scene
from bearingwear.solvers.result import Result
from bearingwear.studies.lives.duty_figure import duty_figure, duty_message

FOLDED = "worst in each phase"
"""First block of the sheet that is folded away on the page, as are those after it."""


def duty_report(scene: Path) -> tuple[xr.Dataset, str, Figure]:
    """Step: returns the life of a scene over its duty, its answer for the page, and its figure.

    The figure of a pair is that of its first bearing.
    """
    result = life(load_scene(scene))
    duty_life = dataset_of_result(result)
    first_bearing = next(iter(datasets_by_bearing(duty_life).values()))
    if "history_phase_worn_share" in first_bearing:
        message = duty_message(first_bearing)
        figure = duty_figure(first_bearing)
    else:
        message = f"{result.scene['name']}: no life over the duty: {result.reason}"
        figure, _ = new_figure(1, 1, 7.6, 1.0)
        frame(figure, message, [], columns=1)
    return duty_life, _duty_answer(result, message).stored, figure


def _duty_answer(result: Result, message: str) -> Document:
    """Returns the sheet of a life over a duty, as an answer of the report page.

    Its sentences lead the page. The tables from `FOLDED` on are folded away.
    """
    sheet = sheet_of_result(result)
    titles = [block.title for block in sheet.blocks]
    count = titles.index(FOLDED) if FOLDED in titles else len(titles)
    open_blocks = sheet.blocks[:count]
    folded_blocks = sheet.blocks[count:]
    sentences = tuple(line for block in open_blocks for line in block.lines)
    name, operation = result.scene["name"], result.scene["operation"]
    method = method_words(result.scene, operation["preload_method"])
    return replace(
        sheet,
        heading=(message,),
        facts={
            "scene": name,
            "bearing": bearing_line(result.scene),
            "beside": f"With the input preload of {operation['preload_N']:g} N ({method}): "
            f"{message.removeprefix(f'{name}: ')}",
        },
        blocks=(
            Block("What ends the life at the input preload", lines=sentences, place="lead"),
            *(replace(block, lines=(), place="open") for block in open_blocks),
            *folded_blocks,
        ),
        figures=("duty",),
        subject="Duty at the input preload",
        rank=2,  # after the recommended preload and the comparison of methods
    )
