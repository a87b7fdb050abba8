"""Figure of a life over a duty: what each phase wears off, and the preload that it has left."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from bearingwear.measures import ENDS
from bearingwear.plotting.drawing import SERIES, Figure, frame, new_figure, start_at_zero
from bearingwear.results.quantiles import hours_in_words
from bearingwear.results.words import scene_of


def duty_figure(life: xr.Dataset) -> Figure:
    """Residual preload in each phase over time, and the worn volume, stacked by phase."""
    time = life["history_time"].values
    names = str(life.attrs["phases"]).split()
    figure, panels = new_figure(1, 2, 7.6, 3.6)
    preload, worn = panels.flat
    colours = [SERIES[k % len(SERIES)] for k in range(len(names))]
    for k, colour in enumerate(colours):
        one = life["history_phase_residual_preload"].isel(phase=k).values
        preload.plot(time, one, color=colour, marker=".", markersize=3)
    scene = scene_of(life)
    end: dict[str, Any] = {"linestyle": "--", "linewidth": 1.0, "color": "0.3"}
    share = scene["wear"]["end_of_life"].get("preload_fraction")
    if share is not None:
        preload.axhline(share * scene["operation"]["preload_N"], **end)
    shares = 100.0 * life["history_phase_worn_share"].values
    worn.stackplot(time, *shares.T, colors=colours, alpha=0.8)
    preload.set_ylabel("residual preload (N)")
    worn.set_ylabel("worn volume (% of that at the end of life)")
    for panel in (preload, worn):
        panel.set_xlabel("time of use (h)")
        panel.set_xlim(0.0, max(float(time[-1]), np.finfo(float).tiny))
        start_at_zero(panel)
    keys: list[Patch | Line2D] = [
        Patch(color=colour, label=f"{name}: {100.0 * share:.3g} % of time, {total:.3g} % of wear")
        for colour, name, share, total in zip(
            colours, names, life["phase_time_share"].values, shares[-1], strict=True
        )
    ]
    if share is not None:
        words = ENDS["preload_fraction"].words
        keys.append(Line2D([], [], label=f"end of life by {words}, {100.0 * share:g} %", **end))
    frame(figure, duty_message(life), keys, columns=2)
    return figure


def duty_message(life: xr.Dataset) -> str:
    """Returns the life over a duty and what ends it, as the message of a figure."""
    scene, hours = scene_of(life), float(life["life"])
    when = hours_in_words(scene, hours)
    criterion = life["end_criterion"].attrs["flag_meanings"].split()[int(life["end_criterion"])]
    end = ENDS[criterion].words if criterion in ENDS else "no criterion"
    return (
        f"{scene['name']}: life over the duty {when}, {float(life['life_cycles']):.3g} cycles, "
        f"ended by {end} in {life.attrs['ended_in']}"
    )
