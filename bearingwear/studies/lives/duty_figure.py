"""Figure of a life over a duty: worn volume and residual preload of each phase."""

import numpy as np
import xarray as xr
from matplotlib.patches import Patch

from bearingwear.plotting.drawing import SERIES, Figure, frame, new_figure, start_at_zero
from bearingwear.results.quantiles import hours_in_words
from bearingwear.results.words import scene_of
from bearingwear.studies.lives.tables import ended_by


def duty_figure(life: xr.Dataset) -> Figure:
    """Returns residual preloads over time, and worn volumes over time, stacked by phase."""
    time = life["history_time"].values
    phases = str(life.attrs["phases"]).split()
    figure, panels = new_figure(1, 2, 7.6, 3.6)
    preload_panel, wear_panel = panels.flat
    colours = [SERIES[k % len(SERIES)] for k in range(len(phases))]
    for k, colour in enumerate(colours):
        preload = life["history_phase_residual_preload"].isel(phase=k).values
        preload_panel.plot(time, preload, color=colour, marker=".", markersize=3)
    worn_percent = 100.0 * life["history_phase_worn_share"].values
    wear_panel.stackplot(time, *worn_percent.T, colors=colours, alpha=0.8)
    preload_panel.set_ylabel("residual preload (N)")
    wear_panel.set_ylabel("worn volume (% of that at the end of life)")
    for panel in (preload_panel, wear_panel):
        panel.set_xlabel("time of use (h)")
        panel.set_xlim(0.0, max(float(time[-1]), np.finfo(float).tiny))
        start_at_zero(panel)
    keys = [
        Patch(color=colour, label=f"{phase}: {100.0 * share:.3g} % of time, {worn:.3g} % of wear")
        for colour, phase, share, worn in zip(
            colours, phases, life["phase_time_share"].values, worn_percent[-1], strict=True
        )
    ]
    frame(figure, _title(life), keys, columns=2)
    return figure


def _title(life: xr.Dataset) -> str:
    """Returns the length of a life over a duty in words, and what ended it."""
    scene = scene_of(life)
    length = hours_in_words(scene, float(life["life"]))
    return (
        f"{scene['name']}: life over the duty {length}, {float(life['life_cycles']):.3g} cycles, "
        f"ended by {ended_by(life)} in {life.attrs['ended_in']}"
    )
