"""Figures of the study of robustness: maps with their boundaries, and branches."""

from pathlib import Path
from typing import Any, NamedTuple

import matplotlib.colors
import numpy as np
import xarray as xr
from matplotlib.patches import Patch

from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.plotting.drawing import (
    Figure,
    frame,
    key,
    new_figure,
)
from bearingwear.results.netcdf import load_kind
from bearingwear.results.words import name_in_words
from workflow.studies.robustness.plan import WITHOUT_REASON

END_COLOURS = {
    "contact_lost": "C5",
    "preload_gone": "C3",
    "outside_hertz_range": "C4",
    "beyond_groove": "C2",
    "no_steady_state": "0.5",
    "below_rounding": "0.7",
    "undetermined": "0.85",
}
"""Colours of states that are not verified; those without a colour here are black."""

AXIS_LABELS = {
    "operation.shaft_speed_rpm": "shaft speed (r/min)",
    "operation.preload_N": "preload (N)",
    "friction.ball_race": "friction coefficient",
    "friction.slip_regularisation_m_s": "regularisation v_r (m/s)",
    "wear.ball_diameter_loss_um": "loss of ball diameter (µm)",
}


class LimitStyle(NamedTuple):
    """How the boundary at a limit is drawn, in the map and in the legend, and what it is called."""

    colour: str
    text: str
    legend_colour: str


_LIMITS = {
    "contact": LimitStyle(colour="white", text="loss of contact", legend_colour="0.6"),
    "gyroscopic_slip": LimitStyle(
        colour="crimson", text="gyroscopic slip share {:g}", legend_colour="crimson"
    ),
    "skid": LimitStyle(colour="cyan", text="skid ratio {:g}", legend_colour="cyan"),
}
SHARES = [0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.35, 0.5, 0.7, 1.0]


def edges(values: np.ndarray, log: bool) -> np.ndarray:
    """Returns the edges (n + 1,) of the cells around the points (n,) of an axis.

    They lie midway between neighbours, and as far beyond the first and last point as before them.

    values: rising, at least two.
    log: whether the points are evenly spaced in logarithm.
    """
    points = np.log(values) if log else values
    middle = 0.5 * (points[1:] + points[:-1])
    ends = [1.5 * points[0] - 0.5 * points[1], 1.5 * points[-1] - 0.5 * points[-2]]
    cell_edges = np.concatenate([ends[:1], middle, ends[1:]])
    return np.exp(cell_edges) if log else cell_edges


# Maps


def map_figure(solved: Path) -> Figure:
    """Step: returns the figure of a map in a file."""
    return figure_of_map(load_kind(solved, "maps"))


def figure_of_map(solved: xr.Dataset) -> Figure:
    """Returns a figure of a map: slip of verified states, status of the others, and boundaries.

    solved: dataset of `state_map`.
    """
    figure, panels = new_figure(1, 1, 6.6, 4.6)
    axes = panels[0, 0]
    axes.grid(False)
    x_edges = edges(solved["x"].values, bool(solved.attrs["x_log"]))
    y_edges = edges(solved["y"].values, bool(solved.attrs["y_log"]))
    status = solved["status"].values
    share = np.where(status == OK, solved["gyroscopic_slip_share"].values, np.nan)
    norm = matplotlib.colors.BoundaryNorm(SHARES, 256)
    mesh = axes.pcolormesh(x_edges, y_edges, share, cmap="cividis", norm=norm, rasterized=True)
    figure.colorbar(mesh, ax=axes, label="gyroscopic slip share, larger of the two contacts")
    handles: list[Any] = []
    for code in np.unique(status[status != OK]):
        name = STATUS_NAMES[int(code)]
        colour = END_COLOURS.get(name, "black")
        cells = np.where(status == code, 1.0, np.nan)
        cmap = matplotlib.colors.ListedColormap([colour])
        axes.pcolormesh(x_edges, y_edges, cells, cmap=cmap, rasterized=True)
        handles.append(Patch(color=colour, label=name_in_words(name)))
    handles += draw_boundaries(axes, solved)
    for axis in "xy":
        getattr(axes, f"set_{axis}label")(AXIS_LABELS[solved.attrs[f"{axis}_key"]])
        if solved.attrs[f"{axis}_log"]:
            getattr(axes, f"set_{axis}scale")("log")
    axes.set_xlim(x_edges[0], x_edges[-1])
    axes.set_ylim(max(y_edges[0], 0.0), y_edges[-1])
    frame(figure, map_title(solved), handles, columns=3)
    return figure


def draw_boundaries(axes: Any, solved: xr.Dataset) -> list[Any]:
    """Draws the boundaries in a map and their closed forms; returns their entries of the legend.

    A boundary that is nowhere in the map is left out, with its closed form.

    solved: dataset of `state_map`.
    """
    handles = []
    for limit, style in _LIMITS.items():
        boundary = solved.get(f"boundary_{limit}")
        if boundary is None or not np.isfinite(boundary).any():
            continue
        line: dict[str, Any] = {"color": style.colour, "linewidth": 2.0}
        axes.plot(solved["x"].values, boundary, **line)
        axes.plot(solved["x"].values, solved[f"estimate_{limit}"], **line | {"linestyle": ":"})
        text = style.text.format(boundary.attrs.get("limit"))  # that of contact has no number
        handles.append(key(text, **line | {"color": style.legend_colour}))
    return [*handles, key("closed-form estimate", color="0.3", linestyle=":", linewidth=2.0)]


def map_title(solved: xr.Dataset) -> str:
    """Returns a title on the number of verified points of a map, and on reasons for the others.

    solved: dataset of `state_map`.
    """
    status = solved["status"].values
    verified = int((status == OK).sum())
    total = status.size
    title = f"{solved.attrs['shown']}: {verified} of {total} points verified"
    if np.isin(status, WITHOUT_REASON).any():
        return f"{title}; no reason is given for some of the others"
    return f"{title}; a reason is given for the others" if verified < total else title


# Branches

_WAYS: dict[str, dict[str, Any]] = {
    "up": {"color": "C2", "linestyle": "-", "linewidth": 3.5, "alpha": 0.45},
    "down": {"color": "C3", "linestyle": "--"},
    "anew": {"color": "black", "linestyle": "none", "marker": ".", "markersize": 3},
}
_WAY_WORDS = {
    "up": "followed with increasing values",
    "down": "followed with decreasing values",
    "anew": "new search at each point (as in life calculations)",
}
_SHOWN = {
    "orbit_share": "orbit rate / shaft speed",
    "total_qv": "QV of the bearing (W)",
    "loss_rate": "rate of total wear depth (nm/s)",
}
_NANO = {"loss_rate": 1e9}


def branches_figure(solved: Path) -> Figure:
    """Step: returns the figure of the branches in a file."""
    return figure_of_branches(load_kind(solved, "branches"))


def figure_of_branches(solved: xr.Dataset) -> Figure:
    """Returns a figure of steady states followed up and down an axis, and searched anew.

    solved: dataset of `branch_states`.
    """
    figure, panels = new_figure(1, 3, 7.6, 3.0)
    along = solved["along"].values
    ways = solved.attrs["ways"].split()
    for axes, (name, text) in zip(panels.flat, _SHOWN.items(), strict=True):
        for way, values in zip(ways, solved[name].values, strict=True):
            axes.plot(along, _NANO.get(name, 1.0) * values, **_WAYS[way])
        axes.set_ylabel(text)
        axes.set_xlabel(AXIS_LABELS[solved.attrs["key"]])
        if solved.attrs["log"]:
            axes.set_xscale("log")
    handles = [key(_WAY_WORDS[way], **_WAYS[way]) for way in ways]
    title = f"{solved.attrs['shown']}: {hysteresis(solved)}"
    frame(figure, title[:1].upper() + title[1:], handles, columns=3)
    return figure


def hysteresis(solved: xr.Dataset) -> str:
    """Returns a phrase on whether both directions give the same states, or on where they differ.

    States differ if their QV does by more than a ten-thousandth, or if one is missing. The phrase
    gives the range from the first to the last such value of the key.

    solved: dataset of `branch_states`.
    """
    ways = solved.attrs["ways"].split()
    up, down = (solved["total_qv"].values[ways.index(way)] for way in ("up", "down"))
    is_missing_once = np.isfinite(up) != np.isfinite(down)
    # far beyond the error of a solve; false where a state is missing
    differs = np.abs(up / down - 1.0) > 1e-4
    if (is_missing_once | differs).any():
        affected = solved["along"].values[is_missing_once | differs]
        _, _, unit = AXIS_LABELS[solved.attrs["key"]].partition(" (")
        ends = f"{affected.min():.3g} to {affected.max():.3g} {unit.rstrip(')')}"
        return f"two steady states from {ends.strip()}"
    return "the same steady state in both directions at each point"
