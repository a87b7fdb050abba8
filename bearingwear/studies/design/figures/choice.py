"""Figure of the design study: which preload to take."""

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
from bearingwear.results.words import methods, scene_of
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

LETTERS = {name: one.letter for name, one in LIMITED.items()}
LETTERS |= dict(zip(ACTIVE[UNLIMITED:], "LEU×NB", strict=True))
"""What holds a preload, on a map."""

STAR = {"marker": "*", "markersize": 11, "markeredgecolor": "black", "markeredgewidth": 0.6}
PALE = {"alpha": 0.6, "linewidth": 0.9}
"""Of lives that violate a requirement."""
_LIMIT_LINE: dict[str, Any] = {"color": "black", "linewidth": 1.0, "linestyle": (0, (6, 2))}
STIFFNESS_UNIT = display("N m-1")


def at_recommended(uncertainty: xr.Dataset, flag: int) -> xr.Dataset:
    """Spread of the life at the recommended preload of a method, with all that is uncertain."""
    return uncertainty.sel(
        preload_method=flag, preload_choice=RECOMMENDED, uncertain_inputs=ALL_INPUTS
    )


def design_figure(
    design: xr.Dataset, recommendation: xr.Dataset, uncertainty: xr.Dataset | None
) -> Figure:
    """Life over preload and over stiffness, and the recommended preload over friction and speed.

    The latter only of a map that has several of both.
    """
    area = min(design.sizes["friction"], design.sizes["shaft_speed"]) > 1
    figure, panels = new_figure(2 if area else 1, 2, 7.2, 7.4 if area else 4.2)
    limits = limits_of(design)
    line = line_of_scene(design)
    followed = bool((line["groove"] == WORN_GROOVE).any())
    over_preload, over_stiffness = panels[0]
    failed = False
    for name, one in methods(line) if followed else ():
        _hertzian(over_preload, name, one)
    best = pareto_front(line)
    for k, (name, one) in enumerate(methods(line)):
        allowed = (one["status"] == OK) & (one["impractical"] == 0)
        for margin in limit_margins(one, limits):
            allowed &= margin >= 0.0
        _over_preload(over_preload, name, one, allowed)
        on_front = best.isel(preload_method=k).values
        _over_stiffness(over_stiffness, name, one, allowed, on_front)
        failed |= mark_failed(over_preload, one["preload"], one["status"], COLOURS[name], k)
        chosen = recommendation.isel(preload_method=k)
        if np.isfinite(chosen["preload"]):
            _recommended(panels[0], name, chosen)
            if uncertainty is not None:
                lives = at_recommended(uncertainty, int(chosen["preload_method"]))["life_quantile"]
                _spread_bar(over_preload, name, chosen, lives)
    stiffness = stiffness_of(design)
    limit = limits.given.get(stiffness.key)
    if limit is not None:
        over_stiffness.axvline(limit, **_LIMIT_LINE)
    for panel in panels[0]:
        panel.set_ylabel("wear life (h)")
        if bool((line["life"] > 0.0).any()):
            _logarithmic(panel)
    over_preload.set(xlabel="initial preload (N)", title="life against preload")
    over_stiffness.set(
        xlabel=STIFFNESS_UNIT.label(f"{stiffness.worst_word} {stiffness.words}\n"),
        title="life against stiffness",
    )
    as_wide_as_it_is(over_preload, design)
    if area:
        _choices(figure, panels[1], design)
    handles = [
        *method_keys([name for name, _ in methods(line)], scene_of(design)),
        *_keys(scene_of(design), limit is not None, uncertainty is not None),
        *_groove_keys(followed),
        *_end_keys(line),
        *(_letter_keys(design) if area else ()),
        *failed_keys(failed),
    ]
    frame(figure, headline(recommendation), handles, columns=3)
    return figure


def _logarithmic(panel: Any) -> None:
    """A logarithmic axis of life; matplotlib needs at least one that is above zero."""
    panel.set_yscale("log")
    panel.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    panel.yaxis.set_major_formatter("{x:g}")
    panel.yaxis.set_minor_formatter(NullFormatter())


def as_wide_as_it_is(panel: Any, design: xr.Dataset) -> None:
    """A logarithmic axis of preload where it spans more than a decade and a half."""
    preloads = design["preload"].values
    if preloads[-1] > 30.0 * preloads[0]:
        panel.set_xscale("log")
        panel.xaxis.set_major_formatter("{x:g}")


def _over_preload(panel: Any, name: str, one: xr.Dataset, allowed: xr.DataArray) -> None:
    """Lives of a method, pale where a requirement is violated."""
    lives = one["life"].where(lambda h: h > 0.0)
    look = {"color": COLOURS[name]}
    panel.plot(one["preload"], lives, **PALE, **look)
    panel.plot(one["preload"], lives.where(allowed), **look)
    for k, end in new_ends(one):
        mark = {"marker": ENDS[end].mark, "markersize": 5, "markerfacecolor": "white"}
        panel.plot(one["preload"][k], lives[k], color=COLOURS[name], zorder=4, **mark)


def new_ends(one: xr.Dataset) -> list[tuple[int, str]]:
    """Places along the preload from which on something else ends the life, and what."""
    names = one["end_criterion"].attrs["flag_meanings"].split()
    solved = np.flatnonzero((one["status"] == OK).values)
    ends = [names[int(flag)] for flag in one["end_criterion"].values[solved]]
    pairs = zip(solved[1:], ends, ends[1:], strict=False)
    return [(int(k), end) for k, before, end in pairs if end != before and end in ENDS]


def _hertzian(panel: Any, name: str, one: xr.Dataset) -> None:
    """Lives with grooves that keep their shape, beside those with grooves followed."""
    lives = one["hertzian_life"].where(lambda h: h > 0.0)
    panel.plot(one["preload"], lives, color=COLOURS[name], linewidth=0.8, linestyle=":")


def _over_stiffness(
    panel: Any, name: str, one: xr.Dataset, allowed: xr.DataArray, on_front: np.ndarray
) -> None:
    """Lives of a method, pale where a requirement is violated, with dots on the Pareto front."""
    lives = one["life"].where(lambda h: h > 0.0)
    stiffness = STIFFNESS_UNIT.of(stiffness_of(one).worst(one))
    look = {"color": COLOURS[name]}
    dot = {"linestyle": "none", "marker": "o", "markersize": 2.6, **look}
    panel.plot(stiffness, lives, **PALE, **look)
    panel.plot(stiffness, lives.where(allowed), **look)
    panel.plot(stiffness[on_front], lives[on_front], **dot)


def _recommended(panels: Any, name: str, chosen: xr.Dataset) -> None:
    """Stars at the recommended preload."""
    look = {"color": COLOURS[name], "zorder": 6}
    life = float(chosen["life"])
    over_preload, over_stiffness = panels
    preload, stiffness = (
        float(chosen["preload"]),
        STIFFNESS_UNIT.of(float(stiffness_of(chosen).worst(chosen))),
    )
    for panel, x in ((over_preload, preload), (over_stiffness, stiffness)):
        panel.plot(x, life, linestyle="none", **STAR, **look)


def _spread_bar(panel: Any, name: str, chosen: xr.Dataset, quantiles: xr.DataArray) -> None:
    """A bar at the recommended preload, from the least to the largest quantile."""
    ends = float(quantiles.min("probability")), float(quantiles.max("probability"))
    panel.vlines(float(chosen["preload"]), *ends, linewidth=1.2, color=COLOURS[name], zorder=5)


def _choices(figure: Figure, panels: Any, design: xr.Dataset) -> None:
    """Recommended preload of every friction and speed, with a letter for what limits it."""
    scene = scene_of(design)
    preload = design["recommended_preload"]
    low, high = float(preload.min()), float(preload.max())
    image = None
    for panel, (name, one) in zip(panels, methods(design), strict=False):
        values = one["recommended_preload"].transpose("friction", "shaft_speed")
        speeds, frictions = design["shaft_speed"].values / 1e3, design["friction"].values
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
        active = one["active_limit"].transpose("friction", "shaft_speed").values
        for i, j in np.ndindex(active.shape):
            dark = values.values[i, j] > 0.5 * (low + high)
            panel.text(
                speeds[j],
                frictions[i],
                LETTERS[ACTIVE[int(active[i, j])]],
                ha="center",
                va="center",
                fontsize=5.5,
                color="white" if dark else "0.2",
            )
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
        panel.set_title(f"recommended preload, {method_words(scene, name)}")
        panel.set_xlabel("shaft speed (1000 r/min)")
        panel.set_ylabel("friction coefficient")
    if image is not None:
        bar = figure.colorbar(image, ax=list(panels), shrink=0.9, pad=0.01)
        bar.set_label("preload (N)")


def counting_key(scene: Mapping[str, Any]) -> Any:
    """Legend of what counts as wear."""
    return key(f"wear of {counted_words(scene)}", color="0.3")


def _keys(scene: Mapping[str, Any], has_limit: bool, has_spread: bool) -> list[Any]:
    """Legend of the lives."""
    limit = key("required stiffness", **_LIMIT_LINE)
    return [
        counting_key(scene),
        key("a requirement is violated", color="0.3", **PALE),
        key("Pareto front", color="0.3", linestyle="none", marker="o", markersize=2.6),
        key(
            f"recommended{' (bar: 90 % of bearings)' if has_spread else ''}",
            color="0.6",
            linestyle="none",
            **STAR,
        ),
        *([limit] if has_limit else []),
    ]


def _groove_keys(followed: bool) -> list[Any]:
    """Legend of the grooves, where some are followed as they wear."""
    if not followed:
        return []
    return [
        key("worn grooves", color="0.3"),
        key("Hertzian grooves", color="0.3", linewidth=0.8, linestyle=":"),
    ]


def _end_keys(line: xr.Dataset) -> list[Any]:
    """Legend of the marks where the criterion that determines the end of life changes."""
    met = dict.fromkeys(end for _, one in methods(line) for _, end in new_ends(one))
    look = {"color": "0.3", "linestyle": "none", "markerfacecolor": "white"}
    return [
        key(f"beyond this kink, life limited by {ENDS[e].short}", marker=ENDS[e].mark, **look)
        for e in met
    ]


def _letter_keys(design: xr.Dataset) -> list[Any]:
    """Legend of the letters on the map."""
    shown = [ACTIVE[k] for k in np.unique(design["active_limit"].values)]
    held = {name: "limited by " for name in shown if name != ACTIVE[NO_PRELOAD]}
    return [
        *(
            key(
                f"{LETTERS[name]}: {held.get(name, '')}{LIMIT_WORDS[name]}",
                linestyle="none",
            )
            for name in shown
        ),
        key("scene", color="C3", linestyle="none", marker="o", markerfacecolor="none"),
    ]
