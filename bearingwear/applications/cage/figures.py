"""The figure of a map of cages: shares of their motions, and their work per turn."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.patches import Rectangle

from bearingwear.applications.cage.motion import MOTIONS
from bearingwear.applications.cage.show import MOTION_COLOURS
from bearingwear.applications.cage.tables import (
    DESIGN,
    MOSTLY,
    QUIET,
    cage_choice_sentence,
    in_design_words,
)
from bearingwear.plotting.drawing import (
    Figure,
    frame,
    key,
    new_figure,
)
from bearingwear.results.units import digits, display
from bearingwear.results.words import name_in_words, plain_scene
from bearingwear.studies.dataset import load_with_axes

_BAR_HEIGHT, _BAR_WIDTH = 0.62, 0.9
"""Size of the bar of a cage, whose cell is 1 by 1."""


def cage_figure(motions: Path) -> Figure:
    """Returns the figure of the map of cages in a file, see `cage_map_figure`."""
    return cage_map_figure(load_with_axes(motions, cage_friction=(), gravity=()))


def cage_map_figure(motions: xr.Dataset) -> Figure:
    """Returns a figure of a map: shares of motions and work per turn of each cage.

    It has a panel for each level of gravity, a row for each design and a column for each friction.
    Quiet cages are framed.

    motions: map of cages, from `gathered_ensembles`, with all its dimensions.
    """
    varied = [axis for axis in DESIGN[:-1] if motions.sizes[axis] > 1]
    axis_values = (motions[axis].values.tolist() for axis in varied)
    designs = [dict(zip(varied, values, strict=True)) for values in itertools.product(*axis_values)]
    gravities = motions["gravity"].values
    width = 1.1 * motions.sizes["cage_friction"] + 0.6
    figure, panels = new_figure(
        1, len(gravities), width * len(gravities) + 2.0, 0.55 * len(designs) + 2.0, sharey=True
    )
    total = motions["mean_work"].isel(group=0)
    unit = display("J", total.values)
    fixed_axes = {axis: 0 for axis in DESIGN[:-1] if axis not in varied}
    for k, (panel, gravity) in enumerate(zip(panels[0], gravities, strict=True)):
        shares = motions["share"].isel(fixed_axes | {"gravity": k})
        work = total.isel(fixed_axes | {"gravity": k})
        for row, design in enumerate(designs):
            design_shares, design_work = shares.sel(design).values, work.sel(design).values
            for column in range(motions.sizes["cage_friction"]):
                text = digits(float(unit.of(design_work[column])))
                _draw_cage(panel, column, row, design_shares[column], text)
        mu = motions["cage_friction"].values
        panel.set_xticks(range(mu.size), [f"{value:g}" for value in mu])
        panel.set_xlim(-0.6, mu.size - 0.4)
        panel.set_ylim(len(designs) - 0.4, -0.6)
        panel.set_xlabel("friction coefficient of the cage")
        panel.set_title(f"gravity {gravity:g} m/s²" if gravity else "weightless", loc="left")
    names = [", ".join(in_design_words(*item) for item in design.items()) for design in designs]
    panels[0, 0].set_yticks(range(len(designs)), names)
    occurs = np.nansum(motions["share"].values.reshape(-1, len(MOTIONS)), axis=0) > 0.0
    handles = [
        key(name_in_words(MOTIONS[code]), color=MOTION_COLOURS[code], linewidth=5)
        for code in np.flatnonzero(occurs).tolist()
    ]
    handles.append(key(f"quiet; numbers: work per turn ({unit.printed})", color="black"))
    frame(figure, f"{plain_scene(motions)['name']}: {cage_choice_sentence(motions)}", handles, 3)
    return figure


def _draw_cage(panel: Any, column: int, row: int, shares: np.ndarray, text: str) -> None:
    """Draws one cage: a bar of the shares of its motions, a frame if it is quiet, and a text.

    column, row: centre of its cell, in the coordinates of the panel.
    shares: of the runs that end in each of `MOTIONS`; NaN where there are no runs.
    """
    corner = column - 0.5 * _BAR_WIDTH, row - 0.5 * _BAR_HEIGHT
    left, top = corner
    for code, share in enumerate(np.nan_to_num(shares).tolist()):
        width, colour = _BAR_WIDTH * share, MOTION_COLOURS[code]
        panel.add_patch(Rectangle((left, top), width, _BAR_HEIGHT, color=colour, linewidth=0))
        left += width
    panel.text(column, row, text, ha="center", va="center")
    if shares[list(QUIET)].sum() >= MOSTLY:
        panel.add_patch(Rectangle(corner, _BAR_WIDTH, _BAR_HEIGHT, fill=False, edgecolor="black"))
