"""Figure of a life over a duty: worn volume and residual preload of each phase."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from bearingwear.measures import ENDS, plain
from bearingwear.plotting.drawing import SERIES, Figure, frame, new_figure, start_at_zero
from bearingwear.results.units import digits
from bearingwear.results.words import plain_scene


def duty_figure(life: xr.Dataset) -> Figure:
    """Returns the figure of a bearing's life over a duty.

    Its panels are the residual preload in each phase over time, and the worn volumes, stacked by
    phase. A dashed line is at the preload that would end the life, if the scene has that criterion.

    life: dataset of a life over a duty, of a single bearing.
    """
    time = life["history_time"].values
    phases = str(life.attrs["phases"]).split()
    figure, panels = new_figure(2, 1, 5.2, 6.0, sharex=True)
    preload_panel, wear_panel = panels.flat
    colours = [SERIES[k % len(SERIES)] for k in range(len(phases))]
    for k, colour in enumerate(colours):
        preload = life["history_phase_residual_preload"].isel(phase=k).values
        preload_panel.plot(time, preload, color=colour, marker=".", markersize=3)
    scene = plain_scene(life)
    end: dict[str, Any] = {"linestyle": "--", "linewidth": 1.0, "color": "0.3"}
    fraction = scene["wear"]["end_of_life"].get("preload_fraction")
    if fraction is not None:
        preload_panel.axhline(fraction * scene["operation"]["preload_N"], **end)
    worn_percent = 100.0 * life["history_phase_worn_share"].values
    wear_panel.stackplot(time, *worn_percent.T, colors=colours, alpha=0.8)
    preload_panel.set_ylabel("residual preload (N)")
    wear_panel.set_ylabel("worn volume (% of the end)")
    wear_panel.set_xlabel("time of use (h)")
    for panel in (preload_panel, wear_panel):
        # a life of 0 h needs an axis of some length, too
        panel.set_xlim(0.0, max(float(time[-1]), np.finfo(float).tiny))
        start_at_zero(panel)
    keys: list[Patch | Line2D] = [
        Patch(color=colour, label=f"{phase}: {100.0 * share:.3g} % of time, {worn:.3g} % of wear")
        for colour, phase, share, worn in zip(
            colours, phases, life["phase_time_share"].values, worn_percent[-1], strict=True
        )
    ]
    if fraction is not None:
        words = ENDS["preload_fraction"].words
        criterion = f"criterion: {words} {100.0 * fraction:g} %"
        if _ending_criterion(life) != "preload_fraction":
            criterion += ", not reached"
        keys.append(Line2D([], [], label=criterion, **end))
    frame(figure, duty_message(life), keys, columns=1)
    return figure


def duty_message(life: xr.Dataset) -> str:
    """Returns a sentence on the life over a duty, its cycles, and what ends it in which phase."""
    scene = plain_scene(life)
    hours = digits(float(life["life"]))
    cycles = plain(float(life["life_cycles"]))
    measure = ENDS.get(_ending_criterion(life))
    end = measure.words if measure else "no criterion"
    where = "all phases" if measure and measure.of_wear else life.attrs["ended_in"]
    words = f"life over the duty {hours} h, {cycles} cycles, ended by {end} in {where}"
    return f"{scene['name']}: {words}"


def _ending_criterion(life: xr.Dataset) -> str:
    """Returns the key of the criterion that ends a life, as in `ENDS`; `none` without one."""
    names: list[str] = life["end_criterion"].attrs["flag_meanings"].split()
    return names[int(life["end_criterion"])]
