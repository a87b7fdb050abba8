"""Figures of several scenes in the same panels."""

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


def spread(studies: Sequence[xr.Dataset], friction: float) -> Figure:
    """Draws total QV, residual preload and loss rate against wear, a line for each scene."""
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
    ratios: list[float] = []
    for number, (study, look) in enumerate(zip(studies, looks, strict=True)):
        loss = study["ball_diameter_loss"]
        methods_of_study = methods(study.sel(friction=friction))
        for column, (name, state) in zip(panels.T, methods_of_study, strict=False):
            for panel, (quantity, (label, unit)) in zip(column, rows.items(), strict=True):
                if quantity in state:  # no rate if nothing at all was solved
                    draw_lines(panel, state[quantity], "ball_diameter_loss", label, unit, **look)
                failed |= mark_failed(panel, loss, state["status"], look["color"], number)
            column[0].set_title(name_in_words(name))
        ratio = float(state["total_qv"][-1] / state["total_qv"][0])
        ratios += [ratio] if np.isfinite(ratio) else []
    label_edges(panels)
    for panel in panels.flat:
        start_at_zero(panel)
    lowest, highest = (percent(f(ratios, default=np.nan)) for f in (min, max))
    share_left = highest if lowest == highest else f"{lowest.removesuffix(' %')} to {highest}"
    frame(
        figure,
        f"{', '.join(scene['name'] for scene in scenes)} at {friction_text(friction)}: "
        f"QV with {name_in_words(name)} after {float(loss[-1]):g} µm of wear is {share_left} of "
        "its initial value",
        [key(label, **look) for label, look in zip(scene_labels(scenes), looks, strict=True)]
        + failed_keys(failed),
        columns=1,
    )
    return figure


def _nested_look(k: int, count: int) -> dict[str, Any]:
    """Returns the look of a line; each is finer than the next, so that equal lines both show."""
    fineness = (count - 1 - k) / max(count - 1, 1)
    size = {"linewidth": 1.2 + 1.6 * fineness, "markersize": 3.5 + 3.0 * fineness}
    return series_look(k) | size


def lives_side_by_side(lives: Sequence[xr.Dataset], friction: float) -> Figure:
    """Draws QV over the loss and over the hours of a life, a line for each scene."""
    figure, panels = new_figure(2, 2, 7.2, 5.6, sharex="row", sharey=True)
    looks = [_nested_look(k, len(lives)) for k in range(len(lives))]
    # a file without any solved life has no history
    solved = [life["history_total_qv"] for life in lives if "history_total_qv" in life]
    power = display("W", *(history.sel(friction=friction) for history in solved))
    ratio_texts, failed = [], []
    for scene, look in zip(lives, looks, strict=True):
        label, ratios = plain_scene(scene)["name"], []
        for column, (name, life) in zip(
            panels.T, methods(scene.sel(friction=friction)), strict=False
        ):
            column[0].set_title(name_in_words(name))
            ratios.append(percent(_draw_life_and_qv_ratio(column, life, power, look)))
            if ratios[-1] == percent(np.nan):
                failed.append(f"{label}, {name_in_words(name)}")
        ratio_texts.append(f"{label} {' and '.join(ratios)}")
    for row, abscissa in zip(
        panels, (ABSCISSAE["ball_diameter_loss"], "running time (h)"), strict=True
    ):
        row[0].set_ylabel(power.label("QV of the bearing"))
        for axes in row:
            axes.set_xlabel(abscissa)
            start_at_zero(axes)
    list_failed(panels[0, 0], failed)
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


def _draw_life_and_qv_ratio(
    column: np.ndarray, life: xr.Dataset, power: Display, look: Mapping[str, Any]
) -> float:
    """Draws a life in the two panels of a column; returns its last QV over its first.

    Without a solved state, it draws nothing and returns NaN.
    """
    if "history_time" not in life:
        return float("nan")
    time = life["history_time"].values
    qv, loss = life["history_total_qv"].values, 1e6 * life["history_ball_diameter_loss"].values
    is_solved = np.isfinite(qv) & np.isfinite(time)
    if not is_solved.any():
        return float("nan")
    for axes, abscissa in zip(column, (loss, time), strict=True):
        axes.plot(abscissa[is_solved], power.of(qv[is_solved]), **look, markevery=[-1])
    return float(qv[is_solved][-1] / qv[is_solved][0])


def scene_labels(scenes: Sequence[Mapping[str, Any]]) -> list[str]:
    """States the differences of scenes: `gyro_s2: ball count 10, pitch diameter 9 mm`.

    Keys on which a steady case does not depend are left out: names, descriptions, the cage and the
    uncertainty.
    """
    values_of_scenes = [
        leaves({key: part for key, part in scene.items() if key not in NOT_SOLVED_FOR})
        for scene in scenes
    ]
    differing = [
        key
        for key in dict.fromkeys(key for values in values_of_scenes for key in values)
        if len({str(values.get(key)) for values in values_of_scenes}) > 1
    ][:MOST_DIFFERENCES]
    labels = []
    for scene, values in zip(scenes, values_of_scenes, strict=True):
        differences = ", ".join(_quantity(key, values.get(key)) for key in differing)
        labels.append(": ".join(filter(None, (scene["name"], differences))))
    return labels


def _quantity(key: str, value: Any) -> str:
    """Writes a key and its value in words: `pitch_diameter_mm`, 9.0 -> `pitch diameter 9 mm`."""
    words, unit = key_in_words(key)
    if value is None:
        return f"no {words}"
    number = f"{value:g}" if isinstance(value, float) else str(value)
    space = "" if unit == "degree" else " "
    return f"{words} {number}{space}{printed_unit(unit)}".strip()
