"""Figure of a life over a duty: what each phase wears off, and the preload that it has left."""

import numpy as np
import xarray as xr
from matplotlib.patches import Patch

from bearingwear.plotting.drawing import SERIES, Figure, frame, new_figure, start_at_zero
from bearingwear.results.quantiles import hours_in_words
from bearingwear.results.words import scene_of
from bearingwear.studies.lives.tables import ended_by


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
    shares = 100.0 * life["history_phase_worn_share"].values
    worn.stackplot(time, *shares.T, colors=colours, alpha=0.8)
    preload.set_ylabel("residual preload (N)")
    worn.set_ylabel("worn volume (% of that at the end of life)")
    for panel in (preload, worn):
        panel.set_xlabel("time of use (h)")
        panel.set_xlim(0.0, max(float(time[-1]), np.finfo(float).tiny))
        start_at_zero(panel)
    keys = [
        Patch(color=colour, label=f"{name}: {100.0 * share:.3g} % of time, {total:.3g} % of wear")
        for colour, name, share, total in zip(
            colours, names, life["phase_time_share"].values, shares[-1], strict=True
        )
    ]
    frame(figure, _title(life), keys, columns=2)
    return figure


def _title(life: xr.Dataset) -> str:
    scene, hours = scene_of(life), float(life["life"])
    when = hours_in_words(scene, hours)
    return (
        f"{scene['name']}: life over the duty {when}, {float(life['life_cycles']):.3g} cycles, "
        f"ended by {ended_by(life)} in {life.attrs['ended_in']}"
    )
