"""Figure of a design map: lives and the worst values over preload and friction."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.colors import LogNorm
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, NullFormatter

from bearingwear.document.rows import counted_words
from bearingwear.kernels.status import OK
from bearingwear.plotting.drawing import FAILED, Figure, failed_keys, frame, new_figure
from bearingwear.results.pair_variables import method_words
from bearingwear.results.units import display
from bearingwear.results.words import methods, plain_scene
from bearingwear.studies.design.document.worst_conditions import extent_words, lives_condition_words
from bearingwear.studies.design.figures.choice import set_preload_scale


class MappedQuantity(NamedTuple):
    """Display of a quantity over preload and friction."""

    label: str  # of the axis
    units: str  # in the file
    cmap: str  # name of the colour map


MAPPED = {
    "life": MappedQuantity("wear life", "h", "viridis"),
    "time_to_slip_limit": MappedQuantity(
        "time to reach the\ngyroscopic slip limit", "h", "viridis"
    ),
    "residual_preload_at_end": MappedQuantity("residual preload\nat end of life", "N", "cividis"),
    "friction_power": MappedQuantity("maximum friction\npower", "W", "magma"),
    "system_axial_stiffness": MappedQuantity(
        "minimum dynamic\nstiffness of the\narrangement", "N m-1", "cividis"
    ),
}


def map_overview(design: xr.Dataset) -> Figure:
    """Returns a figure of lives and worst values over preload and friction, at the scene's speed.

    It has a row for each of `MAPPED` in the map, and a column for each preload method.
    """
    scene = plain_scene(design)
    speed = scene["operation"]["shaft_speed_rpm"]
    plane = design.sel(shaft_speed=speed)
    quantities = {name: quantity for name, quantity in MAPPED.items() if name in design}
    columns = methods(plane)
    figure, panels = new_figure(
        len(quantities), len(columns), 7.2, 1.75 * len(quantities) + 0.9, sharex=True, sharey=True
    )
    has_zero = has_infinite = False
    for row, (name, quantity) in zip(panels, quantities.items(), strict=True):
        unit = display(quantity.units, plane[name])
        values = unit.of(plane[name])
        has_zero |= bool((values == 0.0).any())
        has_infinite |= bool((values == np.inf).any())
        _draw_quantity(figure, row, plane, values, quantity.cmap, unit.label(quantity.label))
    for panel, (method, _) in zip(panels[0], columns, strict=True):
        panel.set_title(method_words(scene, method))
    for panel in panels[-1]:
        panel.set_xlabel("initial preload (N)")
        set_preload_scale(panel, design)
    blank = [Patch(facecolor="white", edgecolor="0.6", label="zero: reached when new")]
    grey = [Patch(color="0.87", label="slip limit not reached before the end of life")]
    frame(
        figure,
        f"{scene['name']}: life {lives_condition_words(design)} and the worst values "
        f"{extent_words(design)}, against preload and friction; wear of {counted_words(scene)}",
        [
            *(blank if has_zero else []),
            *(grey if has_infinite else []),
            *failed_keys(bool((plane["status"] != OK).any())),
        ],
        columns=3,
    )
    return figure


def _draw_quantity(
    figure: Figure,
    row: np.ndarray,
    plane: xr.Dataset,
    values: xr.DataArray,
    cmap: str,
    label: str,
) -> None:
    """Draws a quantity over preload and friction, with a panel for each preload method.

    Infinite values are grey, cells of zero stay blank, and points that were not solved are marked.
    If no value is above zero and finite, the panels are left empty, without axes.

    row: panels.
    plane: map at one speed.
    values: of the quantity, in the unit of the label.
    """
    positive = values.where(np.isfinite(values) & (values > 0.0))
    if not bool(positive.notnull().any()):  # never solved, or nothing but zeros
        for panel in row:
            panel.axis("off")
        return
    norm = LogNorm(float(positive.min()), float(positive.max()))
    image = None
    for k, (panel, (_, points)) in enumerate(zip(row, methods(plane), strict=True)):
        finite = positive.isel(preload_method=k).transpose("friction", "preload")
        image = panel.pcolormesh(
            plane["preload"],
            plane["friction"],
            finite,
            shading="nearest",
            cmap=cmap,
            norm=norm,
            rasterized=True,
        )
        _mark_failed_points(panel, points)
        _fill_infinite(panel, values.isel(preload_method=k))
        panel.grid(False)
    row[0].set_ylabel("friction coefficient")
    if image is not None:
        bar = figure.colorbar(image, ax=list(row), pad=0.01, format="{x:g}")
        bar.set_label(label)
        bar.ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
        bar.ax.yaxis.set_minor_formatter(NullFormatter())


def _mark_failed_points(panel: Any, points: xr.Dataset) -> None:
    """Draws a cross at each point over preload and friction that was not solved.

    points: map of a method at one speed.
    """
    is_failed = (points["status"] != OK).transpose("friction", "preload").values
    rows, columns = np.nonzero(is_failed)
    if rows.size:
        preloads = points["preload"].values[columns]
        frictions = points["friction"].values[rows]
        panel.plot(preloads, frictions, color="crimson", **{**FAILED, "markersize": 3})


def _fill_infinite(panel: Any, values: xr.DataArray) -> None:
    """Fills the cells over preload and friction whose values are infinite with grey."""
    is_infinite = (values == np.inf).transpose("friction", "preload")
    panel.pcolormesh(
        values["preload"],
        values["friction"],
        is_infinite.where(is_infinite),
        shading="nearest",
        cmap="Greys",
        vmin=0.0,
        vmax=4.0,  # a light grey
        rasterized=True,
    )
