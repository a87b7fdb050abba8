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

_HIGH, _WIDE = 0.62, 0.9


def cage_figure(motions: Path) -> Figure:
    """Draws `shares_and_work` of a file."""
    return shares_and_work(load_with_axes(motions, cage_friction=(), gravity=()))


def shares_and_work(motions: xr.Dataset) -> Figure:
    """Draws shares of motions and the work per turn of each cage; quiet cages are framed."""
    varied = [axis for axis in DESIGN[:-1] if motions.sizes[axis] > 1]
    designs = list(itertools.product(*(motions[axis].values.tolist() for axis in varied)))
    gravities = motions["gravity"].values
    width = 1.1 * motions.sizes["cage_friction"] + 0.6
    figure, panels = new_figure(
        1, len(gravities), width * len(gravities) + 2.0, 0.55 * len(designs) + 2.0, sharey=True
    )
    total = motions["mean_work"].isel(group=0)
    unit = display("J", total.values)
    fixed_axes = {axis: 0 for axis in DESIGN[:-1] if axis not in varied}
    for k, (panel, gravity) in enumerate(zip(panels[0], gravities, strict=True)):
        subset = motions.isel(fixed_axes | {"gravity": k})
        work = total.isel(fixed_axes | {"gravity": k})
        for row, values in enumerate(designs):
            design = dict(zip(varied, values, strict=True))
            shares = subset["share"].sel(design).values
            for column, (share, mean) in enumerate(
                zip(shares, work.sel(design).values, strict=True)
            ):
                _cell(panel, column, row, share, digits(float(unit.of(mean))))
        mu = motions["cage_friction"].values
        panel.set_xticks(range(mu.size), [f"{value:g}" for value in mu])
        panel.set_xlim(-0.6, mu.size - 0.4)
        panel.set_ylim(len(designs) - 0.4, -0.6)
        panel.set_xlabel("friction coefficient of the cage")
        panel.set_title(f"gravity {gravity:g} m/s²" if gravity else "weightless", loc="left")
    names = [", ".join(map(in_design_words, varied, values)) for values in designs]
    panels[0, 0].set_yticks(range(len(designs)), names)
    occurs = np.nansum(motions["share"].values.reshape(-1, len(MOTIONS)), axis=0) > 0.0
    handles = [
        key(name_in_words(MOTIONS[code]), color=MOTION_COLOURS[code], linewidth=5)
        for code in np.flatnonzero(occurs).tolist()
    ]
    handles.append(key(f"quiet; numbers: work per turn ({unit.printed})", color="black"))
    frame(figure, f"{plain_scene(motions)['name']}: {cage_choice_sentence(motions)}", handles, 3)
    return figure


def _cell(panel: Any, column: int, row: int, shares: np.ndarray, text: str) -> None:
    """Draws one cage: a bar of its shares of motions, and a text."""
    left, top = column - 0.5 * _WIDE, row - 0.5 * _HIGH
    for code, share in enumerate(np.nan_to_num(shares).tolist()):
        panel.add_patch(
            Rectangle((left, top), _WIDE * share, _HIGH, color=MOTION_COLOURS[code], linewidth=0)
        )
        left += _WIDE * share
    panel.text(column, row, text, ha="center", va="center")
    if shares[list(QUIET)].sum() >= MOSTLY:
        corner = (column - 0.5 * _WIDE, top)
        panel.add_patch(Rectangle(corner, _WIDE, _HIGH, fill=False, edgecolor="black"))
