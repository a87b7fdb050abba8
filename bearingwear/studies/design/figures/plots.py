"""Figures by `bearingwear plot` of single files of this study, and of uncertain lives.

No step of the workflow calls this module, so its imports make no figure of the study outdated.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from bearingwear.document.rows import counted_words
from bearingwear.measures import LIMITED
from bearingwear.plotting.drawing import (
    COLOURS,
    Figure,
    draw_lines,
    failed_keys,
    frame,
    method_keys,
    new_figure,
    start_at_zero,
)
from bearingwear.results.pair_variables import method_words
from bearingwear.results.quantiles import (
    ALL_INPUTS,
    at_each_friction,
    available_preload_choice,
    spread_at,
    spread_text,
)
from bearingwear.results.units import Rough, digits, display, span
from bearingwear.results.words import friction_text, methods, plain_scene
from bearingwear.studies.design.choice import ACTIVE, preload_text
from bearingwear.studies.design.document.sentences import method_names
from bearingwear.studies.design.document.words import LIMIT_WORDS
from bearingwear.studies.design.document.worst_conditions import (
    brief_condition_words,
    critical_extreme,
    extent_words,
    lives_condition_words,
)
from bearingwear.studies.design.figures.map_figure import MAPPED, map_overview
from bearingwear.studies.design.figures.uncertainty_figure import (
    cumulated_keys,
    draw_cumulated,
    uncertainty_figure,
)


def map_plot(design: xr.Dataset) -> Figure:
    """Returns a figure of a map at the scene's speed, over preload and friction.

    A map of one friction is drawn over the preload alone.
    """
    if design.sizes["friction"] > 1:
        return map_overview(design)
    return _preload_line_figure(design)


def _preload_line_figure(design: xr.Dataset) -> Figure:
    """Returns a figure of `MAPPED` quantities of a map of one friction over preload, a panel each.

    It shows the speed of the scene. Infinite values are left out.
    """
    scene = plain_scene(design)
    speed = scene["operation"]["shaft_speed_rpm"]
    line = design.sel(shaft_speed=speed).isel(friction=0)
    quantities = {name: quantity for name, quantity in MAPPED.items() if name in line}
    figure, panels = new_figure(1, len(quantities), 2.6 * len(quantities), 3.2)
    has_failed = False
    for panel, (name, quantity) in zip(panels[0], quantities.items(), strict=True):
        unit = display(quantity.units, line[name])
        finite = line[name].where(np.isfinite(line[name]))
        has_failed |= draw_lines(
            panel, finite, "preload", quantity.label, unit, line["status"], marker="."
        )
        start_at_zero(panel)
    frame(
        figure,
        f"{scene['name']}, friction {float(design['friction'][0]):g}: life "
        f"{lives_condition_words(design)}, and the worst values {extent_words(design)}, against "
        f"preload; wear of {counted_words(scene)}",
        [*method_keys([name for name, _ in methods(line)], scene), *failed_keys(has_failed)],
        columns=3,
    )
    return figure


def uncertainty_plot(uncertainty: xr.Dataset) -> Figure:
    """Returns a figure of the spread of lives, by friction and preload method.

    If Sobol indices were computed, it is `uncertainty_figure`, which shows these as well.
    """
    if "total_index" in uncertainty:
        return uncertainty_figure(uncertainty)
    frictions = at_each_friction(uncertainty)
    columns = uncertainty.sizes["preload_method"]
    figure, panels = new_figure(
        len(frictions), columns, max(5.6, 4.2 * columns), 3.6 * len(frictions)
    )
    spread_texts = []
    for row, sampled in zip(panels, frictions, strict=True):
        scene = plain_scene(sampled)
        for panel, (method, choices) in zip(row, methods(sampled), strict=True):
            words = method_words(scene, method)
            if len(frictions) > 1:
                words += f", {friction_text(scene['friction']['ball_race'])}"
            lives = choices.sel(preload_choice=available_preload_choice(choices))
            draw_cumulated(panel, lives.sel(uncertain_inputs=ALL_INPUTS), COLOURS[method])
            panel.set_title(f"{words}, {digits(float(lives['preload']))} N")
            spread = spread_at(lives)
            if spread:
                panel.axvspan(*spread.bearings, color=COLOURS[method], alpha=0.12, linewidth=0.0)
            spread_texts.append(f"{words}, {spread_text(spread)}")
    scene = plain_scene(uncertainty)
    title = f"{scene['name']}: {'; '.join(spread_texts)}; wear of {counted_words(scene)}"
    frame(figure, title, cumulated_keys(scene), columns=2)
    return figure


def recommendation_plot(recommendation: xr.Dataset) -> Figure:
    """Returns a figure of the life at the recommended preload of each method."""
    figure, ((panel,),) = new_figure(1, 1, 5.4, 3.2)
    scene = plain_scene(recommendation)
    points = methods(recommendation)
    for height, (method, point) in enumerate(points):
        life = float(point["life"])
        panel.barh(height, np.nan_to_num(life), color=COLOURS[method], height=0.4)
        text = _recommended_text(recommendation, point)
        panel.text(0.0, height + 0.24, text, va="bottom", fontsize=7)
    panel.set_yticks(range(len(points)), method_names(recommendation))
    panel.set_ylim(-0.4, len(points) - 0.1)
    panel.set_xlabel("wear life (h)")
    panel.set_title(f"wear of {counted_words(scene)}")
    lives = span(map(Rough, recommendation["life"].values))
    title = f"{scene['name']}: life at the recommended preload, {lives} h"
    frame(figure, title, method_keys([method for method, _ in points], scene), columns=2)
    return figure


def _recommended_text(recommendation: xr.Dataset, point: xr.Dataset) -> str:
    """Returns text with the life at the recommended preload of a method, and with its limit.

    Without a recommended preload, the text has only the reason.

    point: recommendation of the method.
    """
    active = ACTIVE[int(point["active_limit"])]
    limit = LIMIT_WORDS[active]
    life = float(point["life"])
    if not np.isfinite(life):
        return limit
    text = f"{digits(life)} h at {preload_text(point)} N, limited by\n{limit}"
    if active in LIMITED:
        where = brief_condition_words(recommendation, point, critical_extreme(point, active))
        text += f"\n({where})" if where else ""
    return text
