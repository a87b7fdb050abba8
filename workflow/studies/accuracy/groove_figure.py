"""Figure of lives with worn grooves by the loss at their end, and by cells and steps."""

from typing import Any

import xarray as xr
from matplotlib.ticker import LogLocator

from bearingwear.lives.groove_life import REQUIRED
from bearingwear.plotting.drawing import SERIES, Figure, frame, key, new_figure
from bearingwear.results.units import span
from bearingwear.results.words import name_in_words
from workflow.studies.accuracy.gather import distinct_texts, points_where
from workflow.studies.accuracy.groove_tables import errors_against_finest, lives_by_loss
from workflow.studies.accuracy.plan import CELL_COUNTS

_SWEEPS = (("grooves_spring", "cells_spring"), ("grooves_held", "cells_held"))
_TITLES = ("constant force", "fixed position")
_MARKERS = dict(zip(CELL_COUNTS, "v^oD", strict=True))
_LEAST = 1e-5  # smaller errors are drawn there
_AUTO = {"color": "0.5", "linewidth": 0.8, "linestyle": ":"}


def grooves_figure(trade: xr.Dataset) -> Figure:
    """Returns a figure of ratios of worn to Hertzian lives by loss, and of errors by CPU time.

    It has a row for each preload method.

    trade: all points of the study over `point`.
    """
    figure, panels = new_figure(2, 3, 10.4, 6.4, sharex="col")
    first_sweep, _ = _SWEEPS[0]
    scenes = distinct_texts(points_where(trade, sweep=first_sweep), "scene")
    colours = dict(zip(scenes, SERIES, strict=False))  # more colours than scenes
    ratios: dict[str, list[float]] = {"life": [], "end_qv": []}
    for row, (groove_sweep, cell_sweep), method in zip(panels, _SWEEPS, _TITLES, strict=True):
        points = points_where(trade, sweep=groove_sweep)
        # the third panel is that of the costs
        for axes, name in zip(row, ratios, strict=False):
            ratios[name] += _draw_ratios(axes, points, name, colours)
        row[0].set_ylabel(f"{method}\nlife / life with Hertzian contact")
        row[1].set_ylabel("end QV / end QV with Hertzian contact")
        _draw_costs(row[2], points_where(trade, sweep=cell_sweep), colours)
    for axes in panels[1, :2]:
        axes.set_xlabel("loss at the end of life / gap A a²")
    panels[1, 2].set_xlabel("CPU time per life calculation (s)")
    title = (
        "Relative to Hertzian contact, worn grooves change life by a factor of "
        f"{span(ratios['life'])} and QV at the end of life by a factor of {span(ratios['end_qv'])}"
    )
    handles = [
        key(name_in_words(scene), color=colour, linewidth=3) for scene, colour in colours.items()
    ]
    handles.append(key("auto: worn grooves above this loss", **_AUTO))
    cell_keys = [
        key(f"{cells} cells", color="0.3", marker=mark, linestyle="none")
        for cells, mark in _MARKERS.items()
    ]
    frame(figure, title, [*handles, *cell_keys], columns=4)
    return figure


def _draw_ratios(axes: Any, points: xr.Dataset, name: str, colours: dict[str, str]) -> list[float]:
    """Draws values with worn over those with Hertzian grooves over the loss; returns the ratios.

    A dotted line is at the loss from which on `auto` follows worn grooves.

    points: of a sweep of `groove_sweeps`.
    name: of the variable.
    colours: by scene.
    """
    ratios = []
    for scene, colour in colours.items():
        lives_at_ends = list(lives_by_loss(points, scene))
        loss = [float(lives.worn["wear_over_gap"]) for lives in lives_at_ends]
        scene_ratios = [lives.ratio(name) for lives in lives_at_ends]
        axes.plot(loss, scene_ratios, color=colour, marker="o", markersize=3)
        ratios += scene_ratios
    axes.axhline(1.0, color="0.8", linewidth=0.8, zorder=0)
    axes.axvline(REQUIRED, **_AUTO)
    axes.set_xscale("log")
    return ratios


def _draw_costs(axes: Any, points: xr.Dataset, colours: dict[str, str]) -> None:
    """Draws magnitudes of errors of lives against the finest cells and steps, over the CPU time.

    Errors below `_LEAST` are drawn there; the finest point itself has none.

    points: of a sweep of `cell_sweeps`.
    colours: by scene.
    """
    for scene in distinct_texts(points, "scene"):
        for settings, point in errors_against_finest(points_where(points, scene=scene)):
            _, _, cells = settings.partition(", ")
            error = float(point["error_life"])
            time = float(point["life_processor_time"])
            if error > 0.0:  # not the finest itself
                look = {"color": colours[scene], "marker": _MARKERS[cells], "linestyle": "none"}
                axes.plot(time, max(error, _LEAST), markersize=4.5, **look)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.set_ylabel("relative error in life")
