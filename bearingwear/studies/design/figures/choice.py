"""Figure of the design study: lives of a map, and the recommended preloads."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.ticker import LogLocator, NullFormatter

from bearingwear.document.rows import counted_words
from bearingwear.kernels.status import OK
from bearingwear.measures import ENDS, LIMITED
from bearingwear.plotting.drawing import (
    COLOURS,
    Figure,
    failed_keys,
    frame,
    key,
    mark_failed,
    method_keys,
    new_figure,
)
from bearingwear.results.pair_variables import method_words
from bearingwear.results.quantiles import ALL_INPUTS, RECOMMENDED
from bearingwear.results.units import display
from bearingwear.results.words import methods, plain_scene
from bearingwear.studies.design.choice import (
    ACTIVE,
    NO_PRELOAD,
    UNLIMITED,
    limit_margins,
    limits_of,
    line_of_scene,
    pareto_front,
    stiffness_of,
)
from bearingwear.studies.design.document.sentences import headline
from bearingwear.studies.design.document.words import LIMIT_WORDS
from bearingwear.studies.design.map import WORN_GROOVE
from bearingwear.studies.design.plan import DesignLimits

LETTERS = {name: measure.letter for name, measure in LIMITED.items()}
LETTERS |= dict(zip(ACTIVE[UNLIMITED:], "LEU×NB", strict=True))
"""Letters on a map for what keeps a preload from a longer life, by the names of `ACTIVE`."""

STAR = {"marker": "*", "markersize": 11, "markeredgecolor": "black", "markeredgewidth": 0.6}
PALE = {"alpha": 0.6, "linewidth": 0.9}
"""Style of lives that violate a requirement."""
_LIMIT_LINE: dict[str, Any] = {"color": "black", "linewidth": 1.0, "linestyle": (0, (6, 2))}
STIFFNESS_UNIT = display("N m-1")


def design_figure(
    design: xr.Dataset, recommendation: xr.Dataset, uncertainty: xr.Dataset | None
) -> Figure:
    """Returns a figure of life over preload and over stiffness, with the recommended preloads.

    For a map of several frictions and speeds, it also shows the recommended preload over these.

    uncertainty: dataset of the study of uncertainty, whose spread of lives is drawn; or None.
    """
    has_area = min(design.sizes["friction"], design.sizes["shaft_speed"]) > 1
    figure, panels = new_figure(2 if has_area else 1, 2, 7.2, 7.4 if has_area else 4.2)
    over_preload, over_stiffness = panels[0]
    lives = line_of_scene(design)
    has_worn_grooves = bool((lives["groove"] == WORN_GROOVE).any())
    has_failed = _draw_lives(over_preload, over_stiffness, lives)
    for k, (method, _) in enumerate(methods(lives)):
        point = recommendation.isel(preload_method=k)
        if np.isfinite(point["preload"]):
            _draw_stars(over_preload, over_stiffness, method, point)
            if uncertainty is not None:
                _draw_spread_bar(over_preload, method, point, uncertainty)
    has_limit = _draw_stiffness_limit(over_stiffness, design)
    for panel in panels[0]:
        panel.set_ylabel("wear life (h)")
        if bool((lives["life"] > 0.0).any()):
            _set_logarithmic_life(panel)
    over_preload.set(xlabel="initial preload (N)", title="life against preload")
    over_stiffness.set_title("life against stiffness")
    set_preload_scale(over_preload, design)
    if has_area:
        _draw_choices(figure, panels[1], design)
    handles = [
        *method_keys([method for method, _ in methods(lives)], plain_scene(design)),
        *_life_keys(plain_scene(design), has_limit, uncertainty is not None),
        *(_groove_keys() if has_worn_grooves else ()),
        *_end_keys(lives),
        *(_letter_keys(design) if has_area else ()),
        *failed_keys(has_failed),
    ]
    frame(figure, headline(recommendation), handles, columns=3)
    return figure


def _draw_lives(over_preload: Any, over_stiffness: Any, lives: xr.Dataset) -> bool:
    """Draws the lives of each method in two panels; returns whether any was not solved.

    over_preload, over_stiffness: panels.
    lives: map over preload method and preload.
    """
    if bool((lives["groove"] == WORN_GROOVE).any()):
        for method, line in methods(lives):
            _draw_hertzian_lives(over_preload, method, line)
    has_failed = False
    front = pareto_front(lives)
    for k, (method, line) in enumerate(methods(lives)):
        is_allowed = _is_allowed(line, limits_of(lives))
        _draw_lives_over_preload(over_preload, method, line, is_allowed)
        is_on_front = front.isel(preload_method=k).values
        _draw_lives_over_stiffness(over_stiffness, method, line, is_allowed, is_on_front)
        has_failed |= mark_failed(over_preload, line["preload"], line["status"], COLOURS[method], k)
    return has_failed


def _draw_stiffness_limit(panel: Any, design: xr.Dataset) -> bool:
    """Labels the axis of stiffness, and draws its limit; returns whether there is one."""
    stiffness = stiffness_of(design)
    panel.set_xlabel(STIFFNESS_UNIT.label(f"{stiffness.worst_word} {stiffness.words}\n"))
    limit = limits_of(design).given.get(stiffness.key)  # [N/um], the unit of the axis
    if limit is None:
        return False
    panel.axvline(limit, **_LIMIT_LINE)
    return True


def _is_allowed(line: xr.Dataset, limits: DesignLimits) -> xr.DataArray:
    """Returns a mask of the points of a map that are solved, practical and within all limits.

    line: map over the preload.
    """
    is_allowed = (line["status"] == OK) & (line["impractical"] == 0)
    for margin in limit_margins(line, limits):
        is_allowed &= margin >= 0.0
    return is_allowed


def _set_logarithmic_life(panel: Any) -> None:
    """Makes the axis of life logarithmic; a life above zero must be drawn on it already."""
    panel.set_yscale("log")
    panel.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    panel.yaxis.set_major_formatter("{x:g}")
    panel.yaxis.set_minor_formatter(NullFormatter())


def set_preload_scale(panel: Any, design: xr.Dataset) -> None:
    """Makes the axis of preload logarithmic where a map spans more than a factor of 30."""
    preloads = design["preload"].values
    if preloads[-1] > 30.0 * preloads[0]:
        panel.set_xscale("log")
        panel.xaxis.set_major_formatter("{x:g}")


def _draw_lives_over_preload(
    panel: Any, method: str, line: xr.Dataset, is_allowed: xr.DataArray
) -> None:
    """Draws lives of a method, pale where a requirement is violated, with marks at new ends.

    line: map over the preload, of the method.
    is_allowed: mask of the points that violate no requirement.
    """
    lives = line["life"].where(lambda life: life > 0.0)
    look = {"color": COLOURS[method]}
    panel.plot(line["preload"], lives, **PALE, **look)
    panel.plot(line["preload"], lives.where(is_allowed), **look)
    for k, end in end_changes(line):
        mark = {"marker": ENDS[end].mark, "markersize": 5, "markerfacecolor": "white"}
        panel.plot(line["preload"][k], lives[k], color=COLOURS[method], zorder=4, **mark)


def end_changes(line: xr.Dataset) -> list[tuple[int, str]]:
    """Returns the indices of preloads from which on another criterion ends the life, with its name.

    The indices rise. Preloads without a solved life are skipped, and lives that no criterion ends
    are not among them.

    line: map over the preload.
    """
    names = line["end_criterion"].attrs["flag_meanings"].split()
    solved = np.flatnonzero((line["status"] == OK).values)
    ends = [names[int(flag)] for flag in line["end_criterion"].values[solved]]
    changes = []
    for j, k in enumerate(solved.tolist()):
        if j > 0 and ends[j] != ends[j - 1] and ends[j] in ENDS:
            changes.append((k, ends[j]))
    return changes


def _draw_hertzian_lives(panel: Any, method: str, line: xr.Dataset) -> None:
    """Draws lives with Hertzian grooves as a dotted line, beside those with worn grooves.

    line: map over the preload, of the method.
    """
    lives = line["hertzian_life"].where(lambda life: life > 0.0)
    panel.plot(line["preload"], lives, color=COLOURS[method], linewidth=0.8, linestyle=":")


def _draw_lives_over_stiffness(
    panel: Any, method: str, line: xr.Dataset, is_allowed: xr.DataArray, is_on_front: np.ndarray
) -> None:
    """Draws lives of a method, pale where a requirement is violated; dots mark the Pareto front.

    line: map over the preload, of the method.
    is_allowed: mask of the points that violate no requirement.
    is_on_front: mask of the points on the Pareto front.
    """
    lives = line["life"].where(lambda life: life > 0.0)
    stiffness = STIFFNESS_UNIT.of(stiffness_of(line).worst(line))
    look = {"color": COLOURS[method]}
    dot = {"linestyle": "none", "marker": "o", "markersize": 2.6, **look}
    panel.plot(stiffness, lives, **PALE, **look)
    panel.plot(stiffness, lives.where(is_allowed), **look)
    panel.plot(stiffness[is_on_front], lives[is_on_front], **dot)


def _draw_stars(over_preload: Any, over_stiffness: Any, method: str, point: xr.Dataset) -> None:
    """Draws stars at the recommended preload of a method.

    over_preload, over_stiffness: panels.
    point: recommendation of the method.
    """
    look = {"linestyle": "none", **STAR, "color": COLOURS[method], "zorder": 6}
    stiffness = STIFFNESS_UNIT.of(float(stiffness_of(point).worst(point)))
    over_preload.plot(float(point["preload"]), float(point["life"]), **look)
    over_stiffness.plot(stiffness, float(point["life"]), **look)


def _draw_spread_bar(panel: Any, method: str, point: xr.Dataset, uncertainty: xr.Dataset) -> None:
    """Draws a bar at the recommended preload, between the outer quantiles of the life.

    point: recommendation of the method.
    uncertainty: dataset of the study of uncertainty.
    """
    sampled = uncertainty.sel(
        preload_method=int(point["preload_method"]),
        preload_choice=RECOMMENDED,
        uncertain_inputs=ALL_INPUTS,
    )
    quantiles = sampled["life_quantile"]
    ends = float(quantiles.min("probability")), float(quantiles.max("probability"))
    panel.vlines(float(point["preload"]), *ends, linewidth=1.2, color=COLOURS[method], zorder=5)


def _draw_choices(figure: Figure, panels: Any, design: xr.Dataset) -> None:
    """Draws the recommended preload of every friction and speed, with a letter for its limit.

    panels: one for each preload method.
    """
    scene = plain_scene(design)
    preload = design["recommended_preload"]
    low, high = float(preload.min()), float(preload.max())
    image = None
    speeds = design["shaft_speed"].values / 1e3
    frictions = design["friction"].values
    # a map of one method leaves the second panel empty
    for panel, (method, area) in zip(panels, methods(design), strict=False):
        values = area["recommended_preload"].transpose("friction", "shaft_speed")
        image = panel.pcolormesh(
            speeds,
            frictions,
            values,
            shading="nearest",
            cmap="YlGnBu",
            vmin=low,
            vmax=high,
            rasterized=True,
        )
        _draw_letters(panel, area, dark_from=0.5 * (low + high))
        panel.plot(
            scene["operation"]["shaft_speed_rpm"] / 1e3,
            scene["friction"]["ball_race"],
            marker="o",
            markersize=9,
            markerfacecolor="none",
            color="C3",
            markeredgewidth=1.4,
        )
        panel.grid(False)
        panel.set_title(f"recommended preload, {method_words(scene, method)}")
        panel.set_xlabel("shaft speed (1000 r/min)")
        panel.set_ylabel("friction coefficient")
    if image is not None:
        bar = figure.colorbar(image, ax=list(panels), shrink=0.9, pad=0.01)
        bar.set_label("preload (N)")


def _draw_letters(panel: Any, area: xr.Dataset, dark_from: float) -> None:
    """Writes the letter of the active limit at every friction and speed.

    area: map of a method.
    dark_from: recommended preload [N] above which the background is dark.
    """
    preloads = area["recommended_preload"].transpose("friction", "shaft_speed").values
    flags = area["active_limit"].transpose("friction", "shaft_speed").values
    for i, friction in enumerate(area["friction"].values):
        for j, speed in enumerate(area["shaft_speed"].values):
            panel.text(
                speed / 1e3,
                friction,
                LETTERS[ACTIVE[int(flags[i, j])]],
                ha="center",
                va="center",
                fontsize=5.5,
                color="white" if preloads[i, j] > dark_from else "0.2",
            )


def counting_key(scene: Mapping[str, Any]) -> Any:
    """Returns the entry of a legend that says what wear counts: of balls, or of races as well."""
    return key(f"wear of {counted_words(scene)}", color="0.3")


def _life_keys(scene: Mapping[str, Any], has_limit: bool, has_spread: bool) -> list[Any]:
    """Returns the entries of the legend for the lives.

    has_limit: whether a limit of stiffness is drawn.
    has_spread: whether bars of the spread of lives are drawn.
    """
    star_text = "recommended (bar: 90 % of bearings)" if has_spread else "recommended"
    keys = [
        counting_key(scene),
        key("a requirement is violated", color="0.3", **PALE),
        key("Pareto front", color="0.3", linestyle="none", marker="o", markersize=2.6),
        key(star_text, color="0.6", linestyle="none", **STAR),
    ]
    if has_limit:
        keys.append(key("required stiffness", **_LIMIT_LINE))
    return keys


def _groove_keys() -> list[Any]:
    """Returns the entries of the legend for the grooves."""
    return [
        key("worn grooves", color="0.3"),
        key("Hertzian grooves", color="0.3", linewidth=0.8, linestyle=":"),
    ]


def _end_keys(lives: xr.Dataset) -> list[Any]:
    """Returns the entries of the legend for marks where another criterion ends the life."""
    ends = dict.fromkeys(end for _, line in methods(lives) for _, end in end_changes(line))
    look = {"color": "0.3", "linestyle": "none", "markerfacecolor": "white"}
    return [
        key(f"beyond this kink, life limited by {ENDS[end].short}", marker=ENDS[end].mark, **look)
        for end in ends
    ]


def _letter_keys(design: xr.Dataset) -> list[Any]:
    """Returns the entries of the legend for the letters, and for the mark at the scene's values."""
    keys = []
    for flag in np.unique(design["active_limit"].values):
        name = ACTIVE[flag]
        verb = "" if name == ACTIVE[NO_PRELOAD] else "limited by "
        keys.append(key(f"{LETTERS[name]}: {verb}{LIMIT_WORDS[name]}", linestyle="none"))
    return [*keys, key("scene", color="C3", linestyle="none", marker="o", markerfacecolor="none")]
