"""What the report page shows of a life over a duty."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import xarray as xr

from bearingwear.document.bearing_line import bearing_line
from bearingwear.document.document import Block
from bearingwear.document.show import sheet_of_result
from bearingwear.lives.life import life
from bearingwear.plotting.drawing import Figure, frame, new_figure
from bearingwear.results.netcdf import dataset_of_result
from bearingwear.results.pair_variables import method_words
from bearingwear.results.words import datasets_by_bearing
from bearingwear.scene.read import load_scene
from bearingwear.studies.lives.duty_figure import duty_figure, duty_message

FOLDED = "worst in each phase"
"""First block of the sheet that is folded away on the page, as are those after it."""


def duty_report(scene: Path) -> tuple[xr.Dataset, str, Figure]:
    """Step: the life of a scene over its duty, its sheet as an answer of the page, its figure."""
    result = life(load_scene(scene))
    lived = dataset_of_result(result)
    of_first, *_ = datasets_by_bearing(lived).values()
    if "history_phase_worn_share" in of_first:
        message, figure = duty_message(of_first), duty_figure(of_first)
    else:
        message = f"{result.scene['name']}: no life over the duty: {result.reason}"
        figure, _ = new_figure(1, 1, 7.6, 1.0)
        frame(figure, message, [], columns=1)
    sheet = sheet_of_result(result)
    titles = [block.title for block in sheet.blocks]
    count = titles.index(FOLDED) if FOLDED in titles else len(titles)
    first, others = sheet.blocks[:count], sheet.blocks[count:]
    sentences = tuple(line for block in first for line in block.lines)
    name, operation = result.scene["name"], result.scene["operation"]
    method = method_words(result.scene, operation["preload_method"])
    answer = replace(
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
            *(replace(block, lines=(), place="open") for block in first),
            *others,
        ),
        figures=("duty",),
        subject="Duty at the input preload",
        rank=2,  # after the recommended preload and the comparison of methods
    )
    return lived, answer.stored, figure
