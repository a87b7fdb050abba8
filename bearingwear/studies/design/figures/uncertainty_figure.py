"""The figure of how sure lives are, and which uncertain value decides."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.plotting.drawing import (
    COLOURS,
    Figure,
    frame,
    key,
    method_keys,
    new_figure,
)
from bearingwear.results.pair_variables import method_words
from bearingwear.results.quantiles import (
    ALL_BUT_WEAR,
    ALL_INPUTS,
    available_preload_choice,
    quantities_of,
    spread_at,
    spread_text,
)
from bearingwear.results.words import methods, scene_of
from bearingwear.studies.design.figures.choice import counting_key

QUANTITY_WORDS = {
    "ball_diameter_mm": "ball diameter",
    "contact_angle_deg": "contact angle",
    "inner_groove_factor": "inner groove",
    "outer_groove_factor": "outer groove",
    "brinell_hardness_GPa": "hardness",
    "wear_coefficient": "wear coefficient",
    "preload_N": "preload",
    "ball_race": "friction",
    "shear_strength_MPa": "shear strength",
    "drag_density_kg_m3": "drag",
    "wear_scatter": "wear scatter",
}


def uncertainty_figure(uncertainty: xr.Dataset) -> Figure:
    """Spread of lives, the effect of each uncertain value, and the main one."""
    rows, scene = methods(uncertainty), scene_of(uncertainty)
    figure, panels = new_figure(len(rows), 3, 7.2, 2.9 * len(rows) + 0.9)
    names = quantities_of(uncertainty)
    failed = 0
    for (cumulated, tornado, bars), (name, one) in zip(panels, rows, strict=True):
        colour = COLOURS[name]
        drawn = one.sel(preload_choice=available_preload_choice(one))
        draw_cumulated(cumulated, drawn.sel(uncertain_inputs=ALL_INPUTS), colour)
        cumulated.set_title(f"{method_words(scene, name)}, {float(drawn['preload']):.3g} N")
        cumulated.set_xlabel("wear life (h)")
        cumulated.set_ylabel("share of bearings worn out")
        _tornado(tornado, drawn, names, colour)
        _bars(bars, drawn, colour)
        failed += int(one["status_count"].isel(life_status=slice(1, None)).sum())
    for row in panels:
        row[2].set_yticks(row[1].get_yticks(), [])
        row[2].set_ylim(row[1].get_ylim())
    handles = [
        *method_keys([name for name, _ in rows], scene),
        *cumulated_keys(scene),
        key("all values uncertain", color="0.3", linewidth=6),
        key("wear coefficient and hardness as stated", color="0.7", linewidth=6),
    ]
    frame(figure, _message(uncertainty, names, failed), handles, columns=3)
    return figure


def draw_cumulated(panel: Any, one: xr.Dataset, colour: str) -> None:
    """Shares of the lives that are over, and their quantiles with the sampling error."""
    lives = one["life_sample"].values
    lives = np.sort(lives[np.isfinite(lives)])
    if lives.size:
        panel.plot(lives, (np.arange(lives.size) + 0.5) / lives.size, color=colour)
    low, mid, high = (one[f"life_quantile{end}"].values for end in ("_low", "", "_high"))
    panel.errorbar(
        mid,
        one["probability"].values,
        xerr=np.stack([mid - low, high - mid]),
        fmt="o",
        color=colour,
        markersize=3,
        capsize=2,
        linewidth=1.0,
    )
    panel.set_xscale("log")
    panel.set_ylim(0.0, 1.0)


def cumulated_keys(scene: Mapping[str, Any]) -> list[Any]:
    """Legend of `draw_cumulated`."""
    text = "5, 10, 50, 90 and 95 % quantiles with sampling errors"
    return [counting_key(scene), key(text, color="0.3", linestyle="none", marker="o")]


def _ratios(one: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    """Lives with one value changed over the nominal one (values, 2), and ranks by their width."""
    ratio = (one["life_one_at_a_time"] / one["nominal_life"]).values
    width = np.abs(np.log(np.maximum(ratio, 1e-6))).max(axis=1)
    return ratio, np.argsort(np.argsort(np.nan_to_num(width)))


def _tornado(panel: Any, one: xr.Dataset, names: list[str], colour: str) -> None:
    ratio, places = _ratios(one)
    shown = np.nan_to_num(np.log2(np.clip(ratio, 1e-3, 1e3)))
    for q, y in enumerate(places):
        for end in (0, 1):
            panel.barh(y, shown[q, end], color=colour, alpha=0.9 if end else 0.45, height=0.7)
        # rounded first: no minus before a zero
        low, high = (round(100.0 * (r - 1.0), 1) + 0.0 for r in sorted(ratio[q]))
        panel.annotate(
            f"{low:+.1f} … {high:+.1f} %",
            (max(shown[q].max(), 0.0), y),
            xytext=(3, 0),
            textcoords="offset points",
            va="center",
            fontsize=6,
        )
    ends = int(np.ceil(np.abs(shown).max())) if shown.size else 1
    ticks = list(range(-ends, ends + 1, 1 + ends // 3))
    panel.set_xticks(ticks, [f"{2.0**t:g}" for t in ticks])
    panel.set_xlim(-ends - 0.2, ends + 0.55 * ends + 0.4)
    panel.set_yticks(places, [QUANTITY_WORDS[name] for name in names])
    panel.set_xlabel("life relative to nominal life")
    panel.set_title("one value varied from its 10 % to its 90 % quantile", fontsize=8)


def _bars(panel: Any, one: xr.Dataset, colour: str) -> None:
    _, places = _ratios(one)
    for inputs, shade, shift in ((ALL_INPUTS, colour, 0.2), (ALL_BUT_WEAR, "0.7", -0.2)):
        index = one.sel(uncertain_inputs=inputs)
        panel.barh(
            places + shift,
            index["total_index"],
            xerr=index["total_index_error"],
            height=0.38,
            error_kw={"linewidth": 0.8},
            color=shade,
        )
    panel.set_xlim(0.0, 1.25)
    panel.set_xlabel("share of the variance in log life")
    panel.set_title("total Sobol index", fontsize=8)


def _message(uncertainty: xr.Dataset, names: list[str], failed: int) -> str:
    method = uncertainty.isel(preload_method=0)
    one = method.sel(preload_choice=available_preload_choice(method))
    scene = scene_of(uncertainty)["name"]
    if not np.isfinite(one["total_index"]).any():
        return f"{scene}: too few lives could be computed to determine their spread"

    def decides(inputs: int) -> str:
        index = one["total_index"].sel(uncertain_inputs=inputs)
        known = np.isfinite(index).any()
        if not known:
            return "nothing"
        return f"the {QUANTITY_WORDS[names[int(np.nanargmax(index.values))]]}"

    spread = spread_at(one)
    unsolved = f"; {failed} lives could not be computed" if failed else ""
    return (
        f"{scene}: {spread_text(spread)}; {decides(ALL_INPUTS)} has the largest effect or, if the "
        f"wear coefficient is known, {decides(ALL_BUT_WEAR)}{unsolved}"
    )
