"""Figures of several scenes in the same panels."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.document.rows import counted_words
from bearingwear.plotting.drawing import (
    ABSCISSAE,
    Figure,
    draw_lines,
    failed_keys,
    frame,
    key,
    label_edges,
    list_failed,
    mark_failed,
    new_figure,
    series_look,
    start_at_zero,
)
from bearingwear.results.units import Display, display, key_in_words, printed_unit
from bearingwear.results.words import friction_text, methods, name_in_words, percent, plain_scene
from bearingwear.scene.checking.errors import leaves

_LOSS_RATE = display("m s-1", shown="um/1000 h")
MOST_DIFFERENCES = 4
NOT_SOLVED_FOR = ("name", "description", "cage", "uncertainty")
"""Keys of a scene on which a steady case does not depend."""


def wear_overlay_figure(studies: Sequence[xr.Dataset], friction: float) -> Figure:
    """Returns a figure of QV, residual preload and loss rate against wear, a line for each scene.

    It has a column for each preload method, of which there are at most two.

    studies: cases of each scene over preload method, friction and loss.
    friction: coefficient of the cases drawn.
    """
    figure, panels = new_figure(3, 2, 7.2, 7.2, sharex=True, sharey="row")
    looks = [_nested_look(k, len(studies)) for k in range(len(studies))]
    power = display("W", *(study["total_qv"].sel(friction=friction) for study in studies))
    scenes = [plain_scene(study) for study in studies]
    wear_words = " or ".join(dict.fromkeys(map(counted_words, scenes)))
    rows = {
        "total_qv": ("QV of the bearing", power),
        "residual_preload": ("residual preload", display("N")),
        "ball_diameter_loss_rate": (f"loss rate,\n{wear_words}", _LOSS_RATE),
    }
    failed = False
    for number, (study, look) in enumerate(zip(studies, looks, strict=True)):
        loss = study["ball_diameter_loss"]
        methods_of_study = methods(study.sel(friction=friction))
        # a study with a single method has one column
        for column, (name, state) in zip(panels.T, methods_of_study, strict=False):
            for panel, (quantity, (label, unit)) in zip(column, rows.items(), strict=True):
                if quantity in state:  # no rate if nothing at all was solved
                    draw_lines(panel, state[quantity], "ball_diameter_loss", label, unit, **look)
                failed |= mark_failed(panel, loss, state["status"], look["color"], number)
            column[0].set_title(name_in_words(name))
    label_edges(panels)
    for panel in panels.flat:
        start_at_zero(panel)
    labels = scene_labels(scenes)
    keys = [key(label, **look) for label, look in zip(labels, looks, strict=True)]
    names = ", ".join(scene["name"] for scene in scenes)
    title = f"{names} at {friction_text(friction)}: {_last_qv_phrase(studies, friction)}"
    frame(figure, title, [*keys, *failed_keys(failed)], columns=1)
    return figure


def _last_qv_phrase(studies: Sequence[xr.Dataset], friction: float) -> str:
    """Returns a phrase on QV with the last preload method at the last loss, over QV when new.

    The range is that over the studies, without those that were not solved there. The phrase names
    method and loss of the last study.

    friction: coefficient of the cases drawn.
    """
    ratios = []
    for study in studies:
        name, state = methods(study.sel(friction=friction))[-1]
        ratio = float(state["total_qv"][-1] / state["total_qv"][0])
        if np.isfinite(ratio):
            ratios.append(ratio)
    lowest = percent(min(ratios, default=np.nan))
    highest = percent(max(ratios, default=np.nan))
    range_text = highest if lowest == highest else f"{lowest.removesuffix(' %')} to {highest}"
    last_loss = float(studies[-1]["ball_diameter_loss"][-1])
    return (
        f"QV with {name_in_words(name)} after {last_loss:g} µm of wear is {range_text} of its "
        "initial value"
    )


def _nested_look(k: int, count: int) -> dict[str, Any]:
    """Returns the look of line `k` of `count` lines, from the widest to the narrowest.

    Lines are drawn in this order, so that two lines at the same place both show.
    """
    thickness = (count - 1 - k) / max(count - 1, 1)  # from 1, the first, to 0
    size = {"linewidth": 1.2 + 1.6 * thickness, "markersize": 3.5 + 3.0 * thickness}
    return series_look(k) | size


def life_overlay_figure(lives: Sequence[xr.Dataset], friction: float) -> Figure:
    """Returns a figure of QV over the loss and over the hours of a life, a line for each scene.

    It has a column for each preload method, of which there are at most two. A panel names the lives
    that were not solved.

    lives: wear lives of each scene over preload method and friction.
    friction: coefficient of the lives drawn.
    """
    figure, panels = new_figure(2, 2, 7.2, 5.6, sharex="row", sharey=True)
    looks = [_nested_look(k, len(lives)) for k in range(len(lives))]
    # a file without any solved life has no history
    solved = [life["history_total_qv"] for life in lives if "history_total_qv" in life]
    power = display("W", *(history.sel(friction=friction) for history in solved))
    ratio_texts = []
    unsolved = []
    for scene_lives, look in zip(lives, looks, strict=True):
        scene_name = plain_scene(scene_lives)["name"]
        methods_of_scene = methods(scene_lives.sel(friction=friction))
        ratios = []
        # lives with a single method have one column
        for column, (name, life) in zip(panels.T, methods_of_scene, strict=False):
            column[0].set_title(name_in_words(name))
            ratio = _draw_life(column, life, power, look)
            ratios.append(percent(ratio))
            if np.isnan(ratio):
                unsolved.append(f"{scene_name}, {name_in_words(name)}")
        ratio_texts.append(f"{scene_name} {' and '.join(ratios)}")
    abscissae = (ABSCISSAE["ball_diameter_loss"], "running time (h)")
    for row, abscissa in zip(panels, abscissae, strict=True):
        row[0].set_ylabel(power.label("QV of the bearing"))
        for panel in row:
            panel.set_xlabel(abscissa)
            start_at_zero(panel)
    list_failed(panels[0, 0], unsolved)
    words = " and ".join(name_in_words(name) for name, _ in methods(lives[0]))
    labels = scene_labels([plain_scene(scene_lives) for scene_lives in lives])
    frame(
        figure,
        f"QV at end of life relative to new, {friction_text(friction)}, {words}: "
        f"{'; '.join(ratio_texts)}",
        [key(label, **look) for label, look in zip(labels, looks, strict=True)],
        columns=1,
    )
    return figure


def _draw_life(
    column: np.ndarray, life: xr.Dataset, power: Display, look: Mapping[str, Any]
) -> float:
    """Draws QV of a life over loss and time in two panels; returns its last QV over its first.

    Without a solved state, it draws nothing and returns NaN.

    column: two panels.
    power: unit of QV.
    look: of the lines.
    """
    if "history_time" not in life:
        return math.nan
    time = life["history_time"].values
    qv = life["history_total_qv"].values
    loss_um = 1e6 * life["history_ball_diameter_loss"].values
    is_solved = np.isfinite(qv) & np.isfinite(time)
    if not is_solved.any():
        return math.nan
    for panel, abscissa in zip(column, (loss_um, time), strict=True):
        panel.plot(abscissa[is_solved], power.of(qv[is_solved]), **look, markevery=[-1])
    return float(qv[is_solved][-1] / qv[is_solved][0])


def scene_labels(scenes: Sequence[Mapping[str, Any]]) -> list[str]:
    """Returns the names of scenes with their differences: "gyro_s2: ball count 10, ...".

    Keys on which a steady case does not depend are left out: names, descriptions, the cage and the
    uncertainty. At most `MOST_DIFFERENCES` keys are named.

    scenes: plain data.
    """
    values_of_scenes = [
        leaves({key: part for key, part in scene.items() if key not in NOT_SOLVED_FOR})
        for scene in scenes
    ]
    all_keys = dict.fromkeys(key for values in values_of_scenes for key in values)
    differing_keys = [
        key for key in all_keys if len({str(values.get(key)) for values in values_of_scenes}) > 1
    ]
    labels = []
    for scene, values in zip(scenes, values_of_scenes, strict=True):
        differences = [
            _quantity_words(key, values.get(key)) for key in differing_keys[:MOST_DIFFERENCES]
        ]
        name = scene["name"]
        labels.append(f"{name}: {', '.join(differences)}" if differences else name)
    return labels


def _quantity_words(key: str, value: Any) -> str:
    """Returns a key and its value in words: "pitch diameter 9 mm" for `pitch_diameter_mm`, 9.0."""
    words, unit = key_in_words(key)
    if value is None:
        return f"no {words}"
    number = f"{value:g}" if isinstance(value, float) else str(value)
    space = "" if unit == "degree" else " "
    return f"{words} {number}{space}{printed_unit(unit)}".strip()
