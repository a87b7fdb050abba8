"""Figures of the design study: which preload to take, what lies around it, how sure its life is."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.colors import LogNorm
from matplotlib.ticker import LogLocator, NullFormatter

from bearingwear.kernels.status import OK
from bearingwear.model.scene import COUNTS
from bearingwear.report.drawing import (
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
from bearingwear.study.design import ACTIVE, best_method, counted, front, limits_of, margins

LIMIT_WORDS = {
    "gyroscopic_slip_share": "gyroscopic slip share",
    "axial_stiffness_N_um": "axial stiffness",
    "maximum_pressure_GPa": "contact pressure",
    "friction_power_W": "friction power",
    "none": "nothing: life is longest there",
    "end_of_range": "end of the map",
    "not_solved": "an unsolved neighbour",
    "no_preload_within_limits": "no preload keeps to all limits",
}
LETTERS = dict(zip(ACTIVE, "GSPFLEU×", strict=True))
WAYS = {"ball_and_races": "-", "ball": "--"}
STAR = {"marker": "*", "markersize": 11, "markeredgecolor": "black", "markeredgewidth": 0.6}
N_UM, GPA = 1e-6, 1e-9


def at_scene(design: xr.Dataset) -> xr.Dataset:
    """The line of a map at the scene's own friction and speed."""
    scene = scene_of(design)
    return design.sel(
        friction=scene["friction"]["ball_race"], shaft_speed=scene["operation"]["shaft_speed_rpm"]
    )


def of_method(dataset: xr.Dataset, flag: int) -> xr.Dataset:
    return dataset.sel(preload_method=flag)


def design(design: xr.Dataset, recommendation: xr.Dataset, uncertainty: xr.Dataset) -> Figure:
    """Life over preload and over stiffness, and the recommended preload over friction and speed."""
    figure, panels = new_figure(2, 2, 7.2, 7.4)
    counts, limits = counted(design), limits_of(design)
    line = at_scene(design)
    over_preload, over_stiffness = panels[0]
    failed = False
    best = front(line, counts)
    for k, (name, one) in enumerate(methods(line)):
        within = np.logical_and.reduce([m >= 0.0 for m in margins(one, limits)])
        for way, dash in WAYS.items():
            lives = one["life"].isel(counts=COUNTS.index(way)).where(lambda h: h > 0.0)
            look = {"color": COLOURS[name], "linestyle": dash}
            over_preload.plot(one["preload"], lives, alpha=0.35, linewidth=0.8, **look)
            over_preload.plot(one["preload"], lives.where(within), **look)
        lives = one["life"].isel(counts=counts).where(lambda h: h > 0.0)
        stiffness = N_UM * one["axial_stiffness"]
        look = {"color": COLOURS[name]}
        dot = {"linestyle": "none", "marker": "o", "markersize": 2.6, **look}
        over_stiffness.plot(stiffness, lives, alpha=0.35, linewidth=0.8, **look)
        over_stiffness.plot(stiffness, lives.where(within), **look)
        on_front = best.isel(preload_method=k).values
        over_stiffness.plot(stiffness[on_front], lives[on_front], **dot)
        failed |= mark_failed(over_preload, one["preload"], one["status"], COLOURS[name], k)
        _recommended(panels[0], name, k, recommendation, uncertainty, counts)
    limit = limits.axial_stiffness_N_um
    if limit is not None:
        over_stiffness.axvline(limit, color="0.3", linewidth=0.8, linestyle=":")
    for panel in panels[0]:
        panel.set_yscale("log")
        panel.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        panel.yaxis.set_major_formatter("{x:g}")
        panel.yaxis.set_minor_formatter(NullFormatter())
        panel.set_ylabel("wear life (h)")
    over_preload.set_xlabel("initial preload (N)")
    over_stiffness.set_xlabel("least axial stiffness over the life (N/µm)")
    over_preload.set_title("life over preload")
    over_stiffness.set_title("life against stiffness")
    _choices(figure, panels[1], design)
    handles = [
        *method_keys([name for name, _ in methods(line)]),
        *(key(f"counting {in_words(way)}", color="0.3", linestyle=d) for way, d in WAYS.items()),
        key("some limit passed", color="0.3", alpha=0.35, linewidth=0.8),
        key("Pareto front", color="0.3", linestyle="none", marker="o", markersize=2.6),
        key("recommended, bar: L10 to L90", color="0.6", linestyle="none", **STAR),
        *(
            [key("limit of stiffness", color="0.3", linewidth=0.8, linestyle=":")]
            if limit is not None
            else []
        ),
        *_letter_keys(design),
        key("the scene", color="C1", linestyle="none", marker="o", markerfacecolor="none"),
        *failed_keys(failed),
    ]
    frame(figure, message(recommendation, uncertainty), handles, columns=3)
    return figure


def _recommended(
    panels: Any,
    name: str,
    k: int,
    recommendation: xr.Dataset,
    uncertainty: xr.Dataset,
    counts: int,
) -> None:
    """Stars at the recommended preload, with what the life spreads over."""
    chosen = recommendation.isel(preload_method=k)
    if not np.isfinite(chosen["preload"]):
        return
    look = {"color": COLOURS[name], "zorder": 6}
    flag = int(chosen["preload_method"])
    spread = of_method(uncertainty, flag).isel(at=1, of=0)["life_quantile"]
    life = float(chosen["life"].isel(counts=counts))
    places = float(chosen["preload"]), N_UM * float(chosen["axial_stiffness"])
    low, high = (float(spread.isel(counts=counts, probability=p)) for p in (0, -1))
    panels[0].vlines(places[0], low, high, linewidth=1.2, color=COLOURS[name], zorder=5)
    for panel, x in zip(panels, places, strict=True):
        panel.plot(x, life, linestyle="none", **STAR, **look)


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
                speeds[j], frictions[i], LETTERS[ACTIVE[int(active[i, j])]], ha="center",
                va="center", fontsize=5.5, color="white" if dark else "0.2",
            )  # fmt: skip
        panel.plot(
            scene["operation"]["shaft_speed_rpm"] / 1e3, scene["friction"]["ball_race"],
            marker="o", markersize=9, markerfacecolor="none", color="C1", markeredgewidth=1.4,
        )  # fmt: skip
        panel.grid(False)
        panel.set_title(f"recommended preload, {in_words(name)}")
        panel.set_xlabel("shaft speed (1000 r/min)")
        panel.set_ylabel("friction coefficient")
    if image is not None:
        bar = figure.colorbar(image, ax=list(panels), shrink=0.9, pad=0.01)
        bar.set_label("preload (N)")


def _letter_keys(design: xr.Dataset) -> list[Any]:
    """Legend of the letters on the map."""
    shown = [ACTIVE[k] for k in np.unique(design["active_limit"].values)]
    return [
        key(
            f"{LETTERS[name]}: {'' if name == ACTIVE[-1] else 'held by '}{LIMIT_WORDS[name]}",
            linestyle="none",
        )
        for name in shown
    ]  # fmt: skip


def message(recommendation: xr.Dataset, uncertainty: xr.Dataset) -> str:
    """What the design study answers, in a sentence."""
    name = scene_of(recommendation)["name"]
    k = best_method(recommendation)
    if k is None:
        return f"{name}: no preload keeps to all limits"
    counts = counted(recommendation)
    chosen = recommendation.isel(preload_method=k)
    flag = int(chosen["preload_method"])
    spread = of_method(uncertainty, flag).isel(at=1, of=0, counts=counts)["life_quantile"]
    method = methods(recommendation)[k][0]
    held = LIMIT_WORDS[ACTIVE[int(chosen["active_limit"])]]
    return (
        f"{name}: {in_words(method)} at {float(chosen['preload']):.3g} N lives longest within the "
        f"limits, {float(chosen['life'][counts]):.3g} h (L10 {float(spread[0]):.2g} h, "
        f"L50 {float(spread[1]):.2g} h), counting {in_words(COUNTS[counts])}; held by {held}"
    )


MAPPED: dict[str, tuple[str, float, str]] = {
    "life": ("wear life (h)", 1.0, "viridis"),
    "time_to_slip_limit": ("time to the limit\nof gyroscopic slip (h)", 1.0, "viridis"),
    "residual_preload_at_end": ("residual preload\nat the end (N)", 1.0, "cividis"),
    "friction_power": ("largest friction\npower (W)", 1.0, "magma"),
    "axial_stiffness": ("least axial\nstiffness (N/µm)", N_UM, "cividis"),
}


def overview(design: xr.Dataset, recommendation: xr.Dataset, uncertainty: xr.Dataset) -> Figure:
    """The map over preload and friction at the scene's speed."""
    scene = scene_of(design)
    speed = scene["operation"]["shaft_speed_rpm"]
    plane = design.sel(shaft_speed=speed)
    quantities = {name: look for name, look in MAPPED.items() if name in design}
    columns = methods(plane)
    figure, panels = new_figure(
        len(quantities), len(columns), 7.2, 1.75 * len(quantities) + 0.9, sharex=True, sharey=True
    )
    counts = counted(design)
    failed = False
    for row, (quantity, (label, scale, cmap)) in zip(panels, quantities.items(), strict=True):
        image = None
        values = scale * plane[quantity]
        if "counts" in values.dims:
            values = values.isel(counts=counts)
        drawn = values.where(np.isfinite(values) & (values > 0.0))
        norm = LogNorm(float(drawn.min()), float(drawn.max()))
        for k, (panel, (_, one)) in enumerate(zip(row, columns, strict=True)):
            of = drawn.isel(preload_method=k).transpose("friction", "preload")
            image = panel.pcolormesh(
                plane["preload"],
                plane["friction"],
                of,
                shading="nearest",
                cmap=cmap,
                norm=norm,
                rasterized=True,
            )
            bad = np.argwhere((one["status"] != OK).transpose("friction", "preload").values)
            if bad.size:
                failed = True
                x, y = plane["preload"].values[bad[:, 1]], plane["friction"].values[bad[:, 0]]
                panel.plot(x, y, color="crimson", **{**FAILED, "markersize": 3})
            never = (values == np.inf).isel(preload_method=k).transpose("friction", "preload")
            panel.pcolormesh(
                plane["preload"], plane["friction"], never.where(never), shading="nearest",
                cmap="Greys", vmin=0.0, vmax=4.0, rasterized=True,
            )  # fmt: skip
            panel.grid(False)
        row[0].set_ylabel("friction coefficient")
        if image is not None:
            bar = figure.colorbar(image, ax=list(row), pad=0.01, format="{x:g}")
            bar.set_label(label)
            bar.ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
            bar.ax.yaxis.set_minor_formatter(NullFormatter())
    for panel, (name, _) in zip(panels[0], columns, strict=True):
        panel.set_title(in_words(name))
    for panel in panels[-1]:
        panel.set_xlabel("initial preload (N)")
    frame(
        figure,
        f"{scene['name']} at {speed:g} r/min: where life, stiffness and slip lie; counting "
        f"{in_words(COUNTS[counts])}",
        [
            key("white: zero, from the start on", linestyle="none"),
            key("limit of slip not reached in the life", color="0.87", linewidth=8),
            *failed_keys(failed),
        ],
        columns=3,
    )  # fmt: skip
    return figure


QUANTITY_WORDS = {
    "ball_diameter_mm": "ball diameter",
    "contact_angle_deg": "contact angle",
    "inner_groove_factor": "inner groove",
    "outer_groove_factor": "outer groove",
    "brinell_hardness_GPa": "hardness",
    "wear_coefficient": "wear coefficient",
    "preload_N": "preload",
    "ball_race": "friction",
    "drag_density_kg_m3": "drag",
}


def quantities_of(uncertainty: xr.Dataset) -> list[str]:
    """Names of the uncertain values, in the order of the file."""
    return uncertainty["quantity"].attrs["flag_meanings"].split()


def where_drawn(of: xr.Dataset) -> int:
    """The recommended preload, or the scene's own where none is recommended."""
    return 1 if np.isfinite(of["preload"][1]) else 0


def uncertainty(design: xr.Dataset, recommendation: xr.Dataset, uncertainty: xr.Dataset) -> Figure:
    """How lives spread, what each uncertain value does, and which one decides."""
    rows = methods(uncertainty)
    figure, panels = new_figure(len(rows), 3, 7.2, 2.9 * len(rows) + 0.9)
    counts = counted(uncertainty)
    names = quantities_of(uncertainty)
    failed = 0
    for (cumulated, tornado, bars), (name, one) in zip(panels, rows, strict=True):
        k = where_drawn(one)
        colour = COLOURS[name]
        _cumulated(cumulated, one, k, colour)
        cumulated.set_title(f"{in_words(name)}, {float(one['preload'][k]):.3g} N")
        cumulated.set_xlabel("wear life (h)")
        cumulated.set_ylabel("share worn out")
        _tornado(tornado, one.isel(at=k, counts=counts), names, colour)
        _bars(bars, one.isel(at=k, counts=counts), colour)
        failed += int(round(float(((1 - one["solved_share"]) * one["evaluations"]).sum())))
    for row in panels:
        row[2].set_yticks(row[1].get_yticks(), [])
        row[2].set_ylim(row[1].get_ylim())
    handles = [
        *method_keys([name for name, _ in rows]),
        *(key(f"counting {in_words(way)}", color="0.3", linestyle=d) for way, d in WAYS.items()),
        key("L10, L50, L90 with their sampling error", color="0.3", linestyle="none", marker="o"),
        key("all uncertain", color="0.3", linewidth=6),
        key("wear coefficient and hardness as stated", color="0.7", linewidth=6),
    ]
    frame(figure, _spread_message(uncertainty, names, counts, failed), handles, columns=3)
    return figure


def _cumulated(panel: Any, one: xr.Dataset, k: int, colour: str) -> None:
    for way, dash in WAYS.items():
        of = one.isel(at=k, of=0, counts=COUNTS.index(way))
        lives = of["life_sample"].values
        lives = np.sort(lives[np.isfinite(lives)])
        if lives.size:
            share = (np.arange(lives.size) + 0.5) / lives.size
            panel.plot(lives, share, color=colour, linestyle=dash)
        low, mid, high = (of[f"life_quantile{end}"].values for end in ("_low", "", "_high"))
        errors = np.stack([mid - low, high - mid])
        panel.errorbar(
            mid, one["probability"].values, xerr=errors, fmt="o", color=colour, markersize=3,
            capsize=2, linewidth=1.0,
        )  # fmt: skip
    panel.set_xscale("log")
    panel.set_ylim(0.0, 1.0)


def _tornado(panel: Any, one: xr.Dataset, names: list[str], colour: str) -> None:
    ratio = (one["swing"] / one["nominal_life"]).values
    width = np.abs(np.log(np.maximum(ratio, 1e-6))).max(axis=1)
    shown = np.nan_to_num(np.log2(np.clip(ratio, 1e-3, 1e3)))
    places = np.argsort(np.argsort(np.nan_to_num(width)))
    for q, y in enumerate(places):
        for end in (0, 1):
            panel.barh(y, shown[q, end], color=colour, alpha=0.9 if end else 0.45, height=0.7)
        # rounded first: no minus before a zero
        low, high = (round(100.0 * (r - 1.0), 1) + 0.0 for r in sorted(ratio[q]))
        panel.annotate(
            f"{low:+.1f} … {high:+.1f} %", (max(shown[q].max(), 0.0), y), xytext=(3, 0),
            textcoords="offset points", va="center", fontsize=6,
        )  # fmt: skip
    ends = int(np.ceil(np.abs(shown).max())) if shown.size else 1
    ticks = list(range(-ends, ends + 1, 1 + ends // 3))
    panel.set_xticks(ticks, [f"{2.0**t:g}" for t in ticks])
    panel.set_xlim(-ends - 0.2, ends + 0.55 * ends + 0.4)
    panel.set_yticks(places, [QUANTITY_WORDS[name] for name in names])
    panel.set_xlabel("life, times the nominal one")
    panel.set_title("one value, 10 % to 90 %", fontsize=8)


def _bars(panel: Any, one: xr.Dataset, colour: str) -> None:
    ratio = (one["swing"] / one["nominal_life"]).values
    width = np.abs(np.log(np.maximum(ratio, 1e-6))).max(axis=1)
    places = np.argsort(np.argsort(np.nan_to_num(width)))
    for k, (look, shift) in enumerate((({"color": colour}, 0.2), ({"color": "0.7"}, -0.2))):
        of = one.isel(of=k)
        panel.barh(
            places + shift, of["total_index"], xerr=of["total_index_error"], height=0.38,
            error_kw={"linewidth": 0.8}, **look,
        )  # fmt: skip
    panel.set_xlim(0.0, 1.25)
    panel.set_xlabel("share of the variance of log life")
    panel.set_title("total Sobol index", fontsize=8)


def _spread_message(spread: xr.Dataset, names: list[str], counts: int, failed: int) -> str:
    method = spread.isel(preload_method=0)
    one = method.isel(at=where_drawn(method), counts=counts)
    if not np.isfinite(one["total_index"]).any():
        return f"{scene_of(spread)['name']}: too few lives could be solved to say how they spread"
    first, second = (
        QUANTITY_WORDS[names[int(np.nanargmax(one["total_index"].isel(of=k).values))]]
        if np.isfinite(one["total_index"].isel(of=k)).any()
        else "nothing"
        for k in (0, 1)
    )
    low, high = (float(one["life_quantile"].isel(of=0, probability=p)) for p in (0, -1))
    unsolved = f"; {failed} lives not solved" if failed else ""
    return (
        f"{scene_of(spread)['name']}: life spreads by a factor of {high / low:.0f} between L10 and "
        f"L90, and the {first} decides; with it known, the {second}{unsolved}"
    )


FIGURES = {"design": design, "map": overview, "uncertainty": uncertainty}
