"""Figures of the design study: which preload to take, and what lies around it."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.colors import LogNorm
from matplotlib.ticker import LogLocator, NullFormatter

from bearingwear.kernels.status import OK
from bearingwear.plotting.drawing import (
    COLOURS,
    FAILED,
    Figure,
    failed_keys,
    frame,
    in_words,
    key,
    mark_failed,
    method_keys,
    methods,
    new_figure,
    scene_of,
)
from bearingwear.results.quantiles import ALL_INPUTS, RECOMMENDED
from bearingwear.results.units import digits, display
from bearingwear.scene.scene import COUNTS
from bearingwear.studies.dataset import counted
from bearingwear.studies.design.choice import (
    ACTIVE,
    NO_PRELOAD,
    front,
    limit_margins,
    limits_of,
    preload_text,
    stiffness_of,
)
from bearingwear.studies.design.recommend import best_method
from bearingwear.studies.design.words import LIMIT_WORDS

LETTERS = dict(zip(ACTIVE, "GSPFARKMLEU×N", strict=True))
LOSS_DASHES = {"ball_and_races": "-", "ball": "--"}
STAR = {"marker": "*", "markersize": 11, "markeredgecolor": "black", "markeredgewidth": 0.6}
STIFFNESS_UNIT = display("N m-1")


def at_scene(design: xr.Dataset) -> xr.Dataset:
    """The line of a map at the scene's own friction and speed."""
    scene = scene_of(design)
    return design.sel(
        friction=scene["friction"]["ball_race"], shaft_speed=scene["operation"]["shaft_speed_rpm"]
    )


def recommended_quantiles(uncertainty: xr.Dataset, flag: int) -> xr.DataArray:
    """Quantiles of the life at the recommended preload of a method, with all that is uncertain."""
    one = uncertainty.sel(
        preload_method=flag, preload_choice=RECOMMENDED, uncertain_inputs=ALL_INPUTS
    )
    return one["life_quantile"]


def design_figure(
    design: xr.Dataset, recommendation: xr.Dataset, uncertainty: xr.Dataset | None
) -> Figure:
    """Life over preload and over stiffness, and the recommended preload over friction and speed.

    The latter only of a map that has several of both.
    """
    area = min(design.sizes["friction"], design.sizes["shaft_speed"]) > 1
    figure, panels = new_figure(2 if area else 1, 2, 7.2, 7.4 if area else 4.2)
    basis, limits = counted(design), limits_of(design)
    line = at_scene(design)
    over_preload, over_stiffness = panels[0]
    failed = False
    best = front(line, basis)
    for k, (name, one) in enumerate(methods(line)):
        within = one["status"] == OK
        for margin in limit_margins(one, limits):
            within &= margin >= 0.0
        _over_preload(over_preload, name, one, within)
        on_front = best.isel(preload_method=k).values
        _over_stiffness(over_stiffness, name, one.isel(loss_basis=basis), within, on_front)
        failed |= mark_failed(over_preload, one["preload"], one["status"], COLOURS[name], k)
        chosen = recommendation.isel(preload_method=k, loss_basis=basis)
        if np.isfinite(chosen["preload"]):
            _recommended(panels[0], name, chosen)
            if uncertainty is not None:
                lives = recommended_quantiles(uncertainty, int(chosen["preload_method"]))
                _spread_bar(over_preload, name, chosen, lives.isel(loss_basis=basis))
    system = limits.system_axial_stiffness_N_um
    limit = limits.axial_stiffness_N_um if system is None else system
    if limit is not None:
        over_stiffness.axvline(limit, color="0.3", linewidth=0.8, linestyle=":")
    for panel in panels[0]:
        panel.set_ylabel("wear life (h)")
        if bool((line["life"].isel(loss_basis=basis) > 0.0).any()):
            _logarithmic(panel)
    over_preload.set_xlabel("initial preload (N)")
    over_stiffness.set_xlabel(
        STIFFNESS_UNIT.label(
            f"least axial stiffness{'' if system is None else ', arrangement'}, over the life"
        )
    )
    over_preload.set_title("life over preload")
    over_stiffness.set_title("life against stiffness")
    _as_wide_as_it_is(over_preload, design)
    if area:
        _choices(figure, panels[1], design)
    handles = [
        *method_keys([name for name, _ in methods(line)]),
        *_keys(limit is not None, uncertainty is not None),
        *(_letter_keys(design) if area else ()),
        *failed_keys(failed),
    ]
    frame(figure, design_message(recommendation, uncertainty), handles, columns=3)
    return figure


def _logarithmic(panel: Any) -> None:
    """A logarithmic axis of life; matplotlib needs at least one that is above zero."""
    panel.set_yscale("log")
    panel.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    panel.yaxis.set_major_formatter("{x:g}")
    panel.yaxis.set_minor_formatter(NullFormatter())


def _as_wide_as_it_is(panel: Any, design: xr.Dataset) -> None:
    """A logarithmic axis of preload where it spans more than a decade and a half."""
    preloads = design["preload"].values
    if preloads[-1] > 30.0 * preloads[0]:
        panel.set_xscale("log")
        panel.xaxis.set_major_formatter("{x:g}")


def _over_preload(panel: Any, name: str, one: xr.Dataset, within: xr.DataArray) -> None:
    """Lives of a method by both ways of counting, pale where a limit is passed."""
    for way, dash in LOSS_DASHES.items():
        lives = one["life"].isel(loss_basis=COUNTS.index(way)).where(lambda h: h > 0.0)
        look = {"color": COLOURS[name], "linestyle": dash}
        panel.plot(one["preload"], lives, alpha=0.35, linewidth=0.8, **look)
        panel.plot(one["preload"], lives.where(within), **look)


def _over_stiffness(
    panel: Any, name: str, one: xr.Dataset, within: xr.DataArray, on_front: np.ndarray
) -> None:
    """Lives of a method, pale where a limit is passed, with dots on the Pareto front."""
    lives = one["life"].where(lambda h: h > 0.0)
    stiffness = STIFFNESS_UNIT.of(one[stiffness_of(one)])
    look = {"color": COLOURS[name]}
    dot = {"linestyle": "none", "marker": "o", "markersize": 2.6, **look}
    panel.plot(stiffness, lives, alpha=0.35, linewidth=0.8, **look)
    panel.plot(stiffness, lives.where(within), **look)
    panel.plot(stiffness[on_front], lives[on_front], **dot)


def _recommended(panels: Any, name: str, chosen: xr.Dataset) -> None:
    """Stars at the recommended preload."""
    look = {"color": COLOURS[name], "zorder": 6}
    life = float(chosen["life"])
    over_preload, over_stiffness = panels
    preload, stiffness = (
        float(chosen["preload"]),
        STIFFNESS_UNIT.of(float(chosen[stiffness_of(chosen)])),
    )
    for panel, x in ((over_preload, preload), (over_stiffness, stiffness)):
        panel.plot(x, life, linestyle="none", **STAR, **look)


def _spread_bar(panel: Any, name: str, chosen: xr.Dataset, quantiles: xr.DataArray) -> None:
    """A bar at the recommended preload, from the least to the largest quantile."""
    ends = float(quantiles.min("probability")), float(quantiles.max("probability"))
    panel.vlines(float(chosen["preload"]), *ends, linewidth=1.2, color=COLOURS[name], zorder=5)


def _choices(figure: Figure, panels: Any, design: xr.Dataset) -> None:
    """Recommended preload of every friction and speed, with a letter for what holds it."""
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
            color="C1",
            markeredgewidth=1.4,
        )
        panel.grid(False)
        panel.set_title(f"recommended preload, {in_words(name)}")
        panel.set_xlabel("shaft speed (1000 r/min)")
        panel.set_ylabel("friction coefficient")
    if image is not None:
        bar = figure.colorbar(image, ax=list(panels), shrink=0.9, pad=0.01)
        bar.set_label("preload (N)")


def _keys(has_limit: bool, has_spread: bool) -> list[Any]:
    """Legend of the lives."""
    limit = key("limit of stiffness", color="0.3", linewidth=0.8, linestyle=":")
    return [
        *(
            key(f"counting {in_words(way)}", color="0.3", linestyle=d)
            for way, d in LOSS_DASHES.items()
        ),
        key("some limit passed", color="0.3", alpha=0.35, linewidth=0.8),
        key("Pareto front", color="0.3", linestyle="none", marker="o", markersize=2.6),
        key(
            f"recommended{', bar: L10 to L90' if has_spread else ''}",
            color="0.6",
            linestyle="none",
            **STAR,
        ),
        *([limit] if has_limit else []),
    ]


def _letter_keys(design: xr.Dataset) -> list[Any]:
    """Legend of the letters on the map."""
    shown = [ACTIVE[k] for k in np.unique(design["active_limit"].values)]
    held = {name: "held by " for name in shown if name != ACTIVE[NO_PRELOAD]}
    return [
        *(
            key(
                f"{LETTERS[name]}: {held.get(name, '')}{LIMIT_WORDS[name]}",
                linestyle="none",
            )
            for name in shown
        ),
        key("the scene", color="C1", linestyle="none", marker="o", markerfacecolor="none"),
    ]


def design_message(recommendation: xr.Dataset, uncertainty: xr.Dataset | None = None) -> str:
    """What the design study answers, in a sentence."""
    name = scene_of(recommendation)["name"]
    k = best_method(recommendation)
    if k is None:
        return f"{name}: no preload keeps to all limits"
    basis = counted(recommendation)
    method, chosen = methods(recommendation)[k]
    chosen = chosen.isel(loss_basis=basis)
    spread = ""
    if uncertainty is not None:
        lives = recommended_quantiles(uncertainty, int(chosen["preload_method"]))
        l10, l50 = (float(lives.isel(loss_basis=basis).sel(probability=p)) for p in (0.1, 0.5))
        spread = f" (L10 {digits(l10)} h, L50 {digits(l50)} h)"
    within = " within the limits" if limits_of(recommendation).given else ""
    held = LIMIT_WORDS[ACTIVE[int(chosen["active_limit"])]]
    life = digits(float(chosen["life"]))
    return (
        f"{name}: {in_words(method)} at {preload_text(chosen)} N lives longest{within}, "
        f"{life} h{spread}, counting {in_words(COUNTS[basis])}; held by {held}"
    )


class Mapped(NamedTuple):
    """How a quantity is drawn over preload and friction."""

    label: str
    units: str
    cmap: str


MAPPED = {
    "life": Mapped("wear life", "h", "viridis"),
    "time_to_slip_limit": Mapped("time to the limit\nof gyroscopic slip", "h", "viridis"),
    "residual_preload_at_end": Mapped("residual preload\nat the end", "N", "cividis"),
    "friction_power": Mapped("largest friction\npower", "W", "magma"),
    "axial_stiffness": Mapped("least axial\nstiffness", "N m-1", "cividis"),
}


def map_overview(design: xr.Dataset) -> Figure:
    """The map over preload and friction at the scene's speed."""
    scene = scene_of(design)
    speed = scene["operation"]["shaft_speed_rpm"]
    plane = design.sel(shaft_speed=speed)
    quantities = {name: look for name, look in MAPPED.items() if name in design}
    columns = methods(plane)
    figure, panels = new_figure(
        len(quantities), len(columns), 7.2, 1.75 * len(quantities) + 0.9, sharex=True, sharey=True
    )
    basis = counted(design)
    for row, (quantity, look) in zip(panels, quantities.items(), strict=True):
        unit = display(look.units, plane[quantity])
        values = unit.of(plane[quantity])
        if "loss_basis" in values.dims:
            values = values.isel(loss_basis=basis)
        _mapped(figure, row, plane, values, look.cmap, unit.label(look.label))
    for panel, (name, _) in zip(panels[0], columns, strict=True):
        panel.set_title(in_words(name))
    for panel in panels[-1]:
        panel.set_xlabel("initial preload (N)")
        _as_wide_as_it_is(panel, design)
    frame(
        figure,
        f"{scene['name']} at {speed:g} r/min: where life, stiffness and slip lie; counting "
        f"{in_words(COUNTS[basis])}",
        [
            key("white: zero, from the start on", linestyle="none"),
            key("limit of slip not reached in the life", color="0.87", linewidth=8),
            *failed_keys(bool((plane["status"] != OK).any())),
        ],
        columns=3,
    )
    return figure


def _mapped(
    figure: Figure,
    row: np.ndarray,
    plane: xr.Dataset,
    values: xr.DataArray,
    cmap: str,
    label: str,
) -> None:
    """A quantity of every method, a panel each."""
    drawn = values.where(np.isfinite(values) & (values > 0.0))
    if not bool(drawn.notnull().any()):  # never solved, or nothing but zeros
        for panel in row:
            panel.axis("off")
        return
    norm = LogNorm(float(drawn.min()), float(drawn.max()))
    axes = plane["preload"], plane["friction"]
    image = None
    for k, (panel, (_, one)) in enumerate(zip(row, methods(plane), strict=True)):
        shown = drawn.isel(preload_method=k).transpose("friction", "preload")
        image = panel.pcolormesh(
            *axes, shown, shading="nearest", cmap=cmap, norm=norm, rasterized=True
        )
        bad = np.argwhere((one["status"] != OK).transpose("friction", "preload").values)
        if bad.size:
            x, y = plane["preload"].values[bad[:, 1]], plane["friction"].values[bad[:, 0]]
            panel.plot(x, y, color="crimson", **{**FAILED, "markersize": 3})
        never = (values == np.inf).isel(preload_method=k).transpose("friction", "preload")
        panel.pcolormesh(
            *axes,
            never.where(never),
            shading="nearest",
            cmap="Greys",
            vmin=0.0,
            vmax=4.0,
            rasterized=True,
        )
        panel.grid(False)
    row[0].set_ylabel("friction coefficient")
    if image is not None:
        bar = figure.colorbar(image, ax=list(row), pad=0.01, format="{x:g}")
        bar.set_label(label)
        bar.ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
        bar.ax.yaxis.set_minor_formatter(NullFormatter())
