"""Figure of the spread of lives, and of the uncertain values that cause it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.measures import plain
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
from bearingwear.results.words import methods, plain_scene
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
    """Returns a figure of the spread of lives, the effect of each uncertain value, and its index.

    It has a row for each preload method.

    uncertainty: dataset with Sobol indices.
    """
    scene = plain_scene(uncertainty)
    lives_by_method = methods(uncertainty)
    rows = len(lives_by_method)
    figure, panels = new_figure(rows, 3, 7.2, 2.9 * rows + 0.9)
    names = quantities_of(uncertainty)
    failed = 0
    for (cumulated, tornado, bars), (method, choices) in zip(panels, lives_by_method, strict=True):
        colour = COLOURS[method]
        lives = choices.sel(preload_choice=available_preload_choice(choices))
        draw_cumulated(cumulated, lives.sel(uncertain_inputs=ALL_INPUTS), colour)
        cumulated.set_title(f"{method_words(scene, method)}, {plain(float(lives['preload']))} N")
        _draw_tornado(tornado, lives, names, colour)
        _draw_indices(bars, lives, colour)
        failed += int(choices["status_count"].isel(life_status=slice(1, None)).sum())
    for _, tornado, bars in panels:
        bars.set_yticks(tornado.get_yticks(), [])
        bars.set_ylim(tornado.get_ylim())
    handles = [
        *method_keys([method for method, _ in lives_by_method], scene),
        *cumulated_keys(scene),
        key("all values uncertain", color="0.3", linewidth=6),
        key("wear coefficient and hardness as stated", color="0.7", linewidth=6),
    ]
    frame(figure, _spread_title(uncertainty, names, failed), handles, columns=3)
    return figure


def draw_cumulated(panel: Any, sampled: xr.Dataset, colour: str) -> None:
    """Draws the share of worn bearings over the life, and quantiles with their sampling errors.

    sampled: lives of one method, preload and class of uncertain values.
    """
    lives = sampled["life_sample"].values
    lives = np.sort(lives[np.isfinite(lives)])
    if lives.size:
        panel.plot(lives, (np.arange(lives.size) + 0.5) / lives.size, color=colour)
    low, mid, high = (sampled[f"life_quantile{end}"].values for end in ("_low", "", "_high"))
    panel.errorbar(
        mid,
        sampled["probability"].values,
        xerr=np.stack([mid - low, high - mid]),
        fmt="o",
        color=colour,
        markersize=3,
        capsize=2,
        linewidth=1.0,
    )
    panel.set_xscale("log")
    panel.set_ylim(0.0, 1.0)
    panel.set_xlabel("wear life (h)")
    panel.set_ylabel("share of bearings worn out")


def cumulated_keys(scene: Mapping[str, Any]) -> list[Any]:
    """Returns the entries of the legend for `draw_cumulated`."""
    text = "5, 10, 50, 90 and 95 % quantiles with sampling errors"
    return [counting_key(scene), key(text, color="0.3", linestyle="none", marker="o")]


def _life_ratios(lives: xr.Dataset) -> np.ndarray:
    """Returns lives at the 10 and 90 % quantile of each value over the nominal one (values, 2)."""
    ratios: np.ndarray = (lives["life_one_at_a_time"] / lives["nominal_life"]).values
    return ratios


def _places(ratios: np.ndarray) -> np.ndarray:
    """Returns the height of each value in a panel (values,): 0, 1, ..., the largest effect on top.

    ratios: as from `_life_ratios`.
    """
    least_ratio = 1e-6  # a life may be zero, which has no logarithm
    # the larger effect; that of a life that was not solved does not count
    effects = np.fmax.reduce(np.abs(np.log(np.maximum(ratios, least_ratio))), axis=1)
    return np.argsort(np.argsort(np.nan_to_num(effects)))  # sorted twice: the rank of each effect


def _change_text(ratio: float) -> str:
    """Returns a ratio of lives as a signed change [%], a dash for a life that was not solved."""
    if not np.isfinite(ratio):
        return "–"
    return f"{round(100.0 * (ratio - 1.0), 1) + 0.0:+.1f}"  # adding 0.0 leaves no minus zero


def _draw_tornado(panel: Any, lives: xr.Dataset, names: list[str], colour: str) -> None:
    """Draws the lives with one value changed at a time, as bars from the nominal life.

    The pale bar belongs to the 10 % quantile of the value. The axis is logarithmic; texts state the
    changes in percent.

    names: of the uncertain values.
    """
    ratios = _life_ratios(lives)
    places = _places(ratios)
    # a bar ends at a factor of 1000: a life may be zero
    octaves = np.nan_to_num(np.log2(np.clip(ratios, 1e-3, 1e3)))
    for place, ends, value_ratios in zip(places, octaves, ratios, strict=True):
        panel.barh(place, ends[0], color=colour, alpha=0.45, height=0.7)
        panel.barh(place, ends[1], color=colour, alpha=0.9, height=0.7)
        low, high = map(_change_text, np.sort(value_ratios))
        panel.annotate(
            f"{low} … {high} %",
            (max(ends.max(), 0.0), place),
            xytext=(3, 0),
            textcoords="offset points",
            va="center",
            fontsize=6,
        )
    span = int(np.ceil(np.abs(octaves).max())) if octaves.size else 1
    ticks = list(range(-span, span + 1, 1 + span // 3))
    panel.set_xticks(ticks, [f"{2.0**tick:g}" for tick in ticks])
    panel.set_xlim(-span - 0.2, span + 0.55 * span + 0.4)  # with room for the texts
    panel.set_yticks(places, [QUANTITY_WORDS[name] for name in names])
    panel.set_xlabel("life relative to nominal life")
    panel.set_title("one value varied from its 10 % to its 90 % quantile", fontsize=8)


def _draw_indices(panel: Any, lives: xr.Dataset, colour: str) -> None:
    """Draws the total Sobol index of each value, with wear uncertain and with wear as stated."""
    places = _places(_life_ratios(lives))
    for inputs, shade, shift in ((ALL_INPUTS, colour, 0.2), (ALL_BUT_WEAR, "0.7", -0.2)):
        indices = lives.sel(uncertain_inputs=inputs)
        panel.barh(
            places + shift,
            indices["total_index"],
            xerr=indices["total_index_error"],
            height=0.38,
            error_kw={"linewidth": 0.8},
            color=shade,
        )
    panel.set_xlim(0.0, 1.25)
    panel.set_xlabel("share of the variance in log life")
    panel.set_title("total Sobol index", fontsize=8)


def _spread_title(uncertainty: xr.Dataset, names: list[str], failed: int) -> str:
    """Returns a title on the spread of the first method's lives, and its main causes.

    names: of the uncertain values.
    failed: number of lives that were not solved.
    """
    choices = uncertainty.isel(preload_method=0)
    lives = choices.sel(preload_choice=available_preload_choice(choices))
    scene_name = plain_scene(uncertainty)["name"]
    if not np.isfinite(lives["total_index"]).any():
        return f"{scene_name}: too few lives could be computed to determine their spread"

    def main_cause(inputs: int) -> str:
        """Returns the value with the largest index in a class of uncertain values, in words."""
        indices = lives["total_index"].sel(uncertain_inputs=inputs).values
        if not np.isfinite(indices).any():
            return "nothing"
        return f"the {QUANTITY_WORDS[names[int(np.nanargmax(indices))]]}"

    unsolved = f"; {failed} lives could not be computed" if failed else ""
    return (
        f"{scene_name}: {spread_text(spread_at(lives))}; {main_cause(ALL_INPUTS)} has the largest "
        f"effect or, if the wear coefficient is known, {main_cause(ALL_BUT_WEAR)}{unsolved}"
    )
