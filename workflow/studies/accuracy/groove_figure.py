"""Figure of lives with worn grooves: over the loss that ends them, and by cells and steps."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.ticker import LogLocator

from bearingwear.lives.groove_life import REQUIRED
from bearingwear.plotting.drawing import Figure, frame, in_words, key, new_figure
from bearingwear.results.units import span
from workflow.studies.accuracy.groove_tables import against_finest, by_end
from workflow.studies.accuracy.plan import CELL_COUNTS
from workflow.studies.accuracy.points import names, points_where

_SWEEPS = (("grooves_spring", "cells_spring"), ("grooves_held", "cells_held"))
_TITLES = ("constant force", "fixed position")
_TRACKS = {"worn": "-", "bands": "--"}
_MARKERS = dict(zip(CELL_COUNTS, "v^oD", strict=True))
_LEAST = 1e-5  # smaller errors are drawn there
_AUTO = {"color": "0.5", "linewidth": 0.8, "linestyle": ":"}


def grooves_figure(trade: xr.Dataset) -> Figure:
    """Worn over Hertzian lives and QV by the loss; errors of cells and steps by time."""
    figure, panels = new_figure(2, 3, 10.4, 6.4, sharex="col")
    scenes = names(points_where(trade, sweep=_SWEEPS[0][0]), "scene")
    colours = {scene: f"C{k}" for k, scene in enumerate(scenes)}
    ratios: dict[str, list[float]] = {"life": [], "end_qv": []}
    for row, (ends, cells), method in zip(panels, _SWEEPS, _TITLES, strict=True):
        points = points_where(trade, sweep=ends)
        for axes, name in zip(row, ratios, strict=False):
            ratios[name] += _ratio_panel(axes, points, name, colours)
        row[0].set_ylabel(f"{method}\nlife over Hertz'")
        row[1].set_ylabel("QV at the end over Hertz'")
        _cost_panel(row[2], points_where(trade, sweep=cells), colours)
    for axes in panels[1, :2]:
        axes.set_xlabel("loss at the end of life over the gap A a²")
    panels[1, 2].set_xlabel("processor time of a life (s)")
    title = (
        f"As the grooves wear, lives last {span(ratios['life'])} times as long as with Hertz' "
        f"contact, and end with {span(ratios['end_qv'])} times its QV"
    )
    handles = [key(in_words(scene), color=colour, linewidth=3) for scene, colour in colours.items()]
    tracks = (("balls worn evenly", "-"), ("balls worn in bands", "--"))
    handles += [key(text, color="0.3", linestyle=dash) for text, dash in tracks]
    handles.append(key("auto follows the grooves beyond", **_AUTO))
    cell_keys = [
        key(f"{cells} cells", color="0.3", marker=mark, linestyle="none")
        for cells, mark in _MARKERS.items()
    ]
    frame(figure, title, [*handles, *cell_keys], columns=4)
    return figure


def _ratio_panel(axes: Any, points: xr.Dataset, name: str, colours: dict[str, str]) -> list[float]:
    """Lines over the loss; the ratios that are drawn."""
    found = []
    for scene, colour in colours.items():
        lives = [one for _, one in by_end(points, scene)]
        loss = [float(one["worn"]["wear_over_gap"]) for one in lives]
        for track, dash in _TRACKS.items():
            ratio = [float(one[track][name] / one["hertz"][name]) for one in lives]
            axes.plot(loss, ratio, color=colour, linestyle=dash, marker="o", markersize=3)
            found += ratio
    axes.axhline(1.0, color="0.8", linewidth=0.8, zorder=0)
    axes.axvline(REQUIRED, **_AUTO)
    axes.set_xscale("log")
    return found


def _cost_panel(axes: Any, points: xr.Dataset, colours: dict[str, str]) -> None:
    """Errors against the finest cells and steps; steps of the same cells are joined."""
    for scene in names(points, "scene"):
        lines: dict[tuple[str, str], list[tuple[float, float]]] = {}
        for track, settings, point in against_finest(points_where(points, scene=scene)):
            cells = settings.partition(", ")[2]
            error, time = float(point["error_life"]), float(point["life_processor_time"])
            if error > 0.0:  # not the finest itself
                lines.setdefault((track, cells), []).append((time, max(error, _LEAST)))
        for (track, cells), line in lines.items():
            style = {"color": colours[scene], "linestyle": _TRACKS[track], "linewidth": 0.8}
            axes.plot(*np.transpose(line), marker=_MARKERS[cells], markersize=4, **style)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.set_ylabel("error of life, to the finest")
