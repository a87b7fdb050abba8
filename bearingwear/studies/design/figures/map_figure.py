"""Figure of the design study: what lies around a preload, over preload and friction."""

from __future__ import annotations

from typing import NamedTuple

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
from bearingwear.results.words import methods, scene_of
from bearingwear.studies.design.document.held import lives_words, worst_words
from bearingwear.studies.design.figures.choice import as_wide_as_it_is


class Mapped(NamedTuple):
    """Display of a quantity over preload and friction."""

    label: str
    units: str
    cmap: str


MAPPED = {
    "life": Mapped("wear life", "h", "viridis"),
    "time_to_slip_limit": Mapped("time to reach the\ngyroscopic slip limit", "h", "viridis"),
    "residual_preload_at_end": Mapped("residual preload\nat end of life", "N", "cividis"),
    "friction_power": Mapped("maximum friction\npower", "W", "magma"),
    "system_axial_stiffness": Mapped(
        "minimum dynamic\nstiffness of the\narrangement", "N m-1", "cividis"
    ),
}


def map_overview(design: xr.Dataset) -> Figure:
    """The map over preload and friction at the scene's speed."""
    scene = scene_of(design)
    speed = scene["operation"]["shaft_speed_rpm"]
    plane = design.sel(shaft_speed=speed)
    quantities = {name: look for name, look in MAPPED.items() if name in design}
    columns = methods(plane)
    figure, panels = new_figure(
        len(quantities), len(columns), 7.2, 1.75 * len(quantities) + 0.9, sharex=True, sharey=True
    )
    zero = never = False
    for row, (quantity, look) in zip(panels, quantities.items(), strict=True):
        unit = display(look.units, plane[quantity])
        values = unit.of(plane[quantity])
        zero, never = zero or bool((values == 0.0).any()), never or bool((values == np.inf).any())
        _mapped(figure, row, plane, values, look.cmap, unit.label(look.label))
    for panel, (name, _) in zip(panels[0], columns, strict=True):
        panel.set_title(method_words(scene_of(design), name))
    for panel in panels[-1]:
        panel.set_xlabel("initial preload (N)")
        as_wide_as_it_is(panel, design)
    blank = [Patch(facecolor="white", edgecolor="0.6", label="zero: reached when new")]
    grey = [Patch(color="0.87", label="slip limit not reached before the end of life")]
    frame(
        figure,
        f"{scene['name']}: life {lives_words(design)} and the worst values {worst_words(design)}, "
        f"against preload and friction; wear of {counted_words(scene)}",
        [
            *(blank if zero else []),
            *(grey if never else []),
            *failed_keys(bool((plane["status"] != OK).any())),
        ],
        columns=3,
    )
    return figure


def _mapped(
    figure: Figure,
    row: np.ndarray,
    plane: xr.Dataset,
    values: xr.DataArray,
    cmap: str,
    label: str,
) -> None:
    """A quantity of every method, a panel each."""
    drawn = values.where(np.isfinite(values) & (values > 0.0))
    if not bool(drawn.notnull().any()):  # never solved, or nothing but zeros
        for panel in row:
            panel.axis("off")
        return
    norm = LogNorm(float(drawn.min()), float(drawn.max()))
    axes = plane["preload"], plane["friction"]
    image = None
    for k, (panel, (_, one)) in enumerate(zip(row, methods(plane), strict=True)):
        shown = drawn.isel(preload_method=k).transpose("friction", "preload")
        image = panel.pcolormesh(
            *axes, shown, shading="nearest", cmap=cmap, norm=norm, rasterized=True
        )
        bad = np.argwhere((one["status"] != OK).transpose("friction", "preload").values)
        if bad.size:
            x, y = plane["preload"].values[bad[:, 1]], plane["friction"].values[bad[:, 0]]
            panel.plot(x, y, color="crimson", **{**FAILED, "markersize": 3})
        never = (values == np.inf).isel(preload_method=k).transpose("friction", "preload")
        panel.pcolormesh(
            *axes,
            never.where(never),
            shading="nearest",
            cmap="Greys",
            vmin=0.0,
            vmax=4.0,
            rasterized=True,
        )
        panel.grid(False)
    row[0].set_ylabel("friction coefficient")
    if image is not None:
        bar = figure.colorbar(image, ax=list(row), pad=0.01, format="{x:g}")
        bar.set_label(label)
        bar.ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
        bar.ax.yaxis.set_minor_formatter(NullFormatter())
