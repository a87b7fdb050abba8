"""What `bearingwear plot` draws of single files of this study and of the lives that are uncertain.

No step calls this, so what it imports makes no figure of the study outdated.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from bearingwear.document.rows import counted_words
from bearingwear.measures import LIMITED
from bearingwear.plotting.drawing import (
    COLOURS,
    Figure,
    failed_keys,
    frame,
    lines,
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
from bearingwear.results.words import friction_text, methods, scene_of
from bearingwear.studies.design.choice import ACTIVE, preload_text
from bearingwear.studies.design.document.held import decides_words, lives_words, worst_words
from bearingwear.studies.design.document.sentences import method_names
from bearingwear.studies.design.document.words import LIMIT_WORDS
from bearingwear.studies.design.figures.map_figure import MAPPED, map_overview
from bearingwear.studies.design.figures.uncertainty_figure import (
    cumulated_keys,
    draw_cumulated,
    uncertainty_figure,
)


def map_plot(design: xr.Dataset) -> Figure:
    """A design map over preload and friction, or over preload alone where it has one friction."""
    return map_overview(design) if design.sizes["friction"] > 1 else _lines_over_preload(design)


def _lines_over_preload(design: xr.Dataset) -> Figure:
    """The quantities of a map of one friction, a panel each."""
    scene = scene_of(design)
    speed = scene["operation"]["shaft_speed_rpm"]
    line = design.sel(shaft_speed=speed).isel(friction=0)
    quantities = {name: look for name, look in MAPPED.items() if name in line}
    figure, panels = new_figure(1, len(quantities), 2.6 * len(quantities), 3.2)
    failed = False
    for panel, (name, look) in zip(panels[0], quantities.items(), strict=True):
        values = line[name]
        unit, known = display(look.units, values), values.where(np.isfinite(values))
        failed |= lines(panel, known, "preload", look.label, unit, line["status"], marker=".")
        start_at_zero(panel)
    frame(
        figure,
        f"{scene['name']}, friction {float(design['friction'][0]):g}: life {lives_words(design)}, "
        f"and the worst values {worst_words(design)}, against preload; wear of "
        f"{counted_words(scene)}",
        [*method_keys([name for name, _ in methods(line)], scene), *failed_keys(failed)],
        columns=3,
    )
    return figure


def uncertainty_plot(uncertainty: xr.Dataset) -> Figure:
    """Spread of lives at each friction, and its main cause if computed."""
    if "total_index" in uncertainty:
        return uncertainty_figure(uncertainty)
    each = at_each_friction(uncertainty)
    points = [(one, name, of_method) for one in each for name, of_method in methods(one)]
    columns = uncertainty.sizes["preload_method"]
    figure, panels = new_figure(len(each), columns, max(5.6, 4.2 * columns), 3.6 * len(each))
    said = []
    for panel, (at, name, of_method) in zip(panels.flat, points, strict=True):
        scene = scene_of(at)
        words = method_words(scene, name)
        if len(each) > 1:
            words += f", {friction_text(scene['friction']['ball_race'])}"
        drawn = of_method.sel(preload_choice=available_preload_choice(of_method))
        draw_cumulated(panel, drawn.sel(uncertain_inputs=ALL_INPUTS), COLOURS[name])
        panel.set_title(f"{words}, {digits(float(drawn['preload']))} N")
        panel.set_xlabel("wear life (h)")
        panel.set_ylabel("share of bearings worn out")
        spread = spread_at(drawn)
        if spread:
            panel.axvspan(*spread.bearings, color=COLOURS[name], alpha=0.12, linewidth=0.0)
        said.append(f"{words}, {spread_text(spread)}")
    scene = scene_of(uncertainty)
    text = f"{scene['name']}: {'; '.join(said)}; wear of {counted_words(scene)}"
    frame(figure, text, cumulated_keys(scene), columns=2)
    return figure


def recommendation_plot(recommendation: xr.Dataset) -> Figure:
    """Life at the recommended preload of each method."""
    figure, ((panel,),) = new_figure(1, 1, 5.4, 3.2)
    rows, scene = methods(recommendation), scene_of(recommendation)
    for height, (name, one) in enumerate(rows):
        life = float(one["life"])
        active = ACTIVE[int(one["active_limit"])]
        held = LIMIT_WORDS[active]
        where = ""
        if active in LIMITED:
            where = decides_words(recommendation, one, active, brief=True)
        where = where and f"\n({where})"
        text = f"{preload_text(one)} N, limited by\n{held}{where}"
        panel.barh(height, np.nan_to_num(life), color=COLOURS[name], height=0.4)
        said = f"{Rough(life).text} h at {text}" if np.isfinite(life) else held
        panel.text(0.0, height + 0.24, said, va="bottom", fontsize=7)
    panel.set_yticks(range(len(rows)), method_names(recommendation))
    panel.set_ylim(-0.4, len(rows) - 0.1)
    panel.set_xlabel("wear life (h)")
    panel.set_title(f"wear of {counted_words(scene)}")
    lives = span(map(Rough, recommendation["life"].values))
    text = f"{scene['name']}: life at the recommended preload, {lives} h"
    frame(figure, text, method_keys([name for name, _ in rows], scene), columns=2)
    return figure
