"""Figures and table of the study of the extremes."""

from pathlib import Path
from typing import Any

import matplotlib.colors
import numpy as np
import xarray as xr
from matplotlib.patches import Patch

from bearingwear.io.netcdf import CaseFileError, load
from bearingwear.io.whole import write_text
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.report.drawing import Figure, frame, in_words, key, new_figure
from bearingwear.report.tables import markdown_table

ENDS = {
    "contact_lost": "C5", "preload_gone": "C3", "outside_hertz_range": "C4", "beyond_groove": "C2",
    "no_steady_state": "0.5", "below_rounding": "0.7", "undetermined": "0.85",
    "not_converged": "black", "unverified": "black",
}  # fmt: skip
"""Colours of what is not verified."""

AXES = {
    "operation.shaft_speed_rpm": "shaft speed (r/min)",
    "operation.preload_N": "preload (N)",
    "friction.ball_race": "friction coefficient",
    "friction.slip_regularisation_m_s": "regularisation v_r (m/s)",
    "wear.ball_diameter_loss_um": "loss of ball diameter (µm)",
}

LIMITS = {
    "contact": ("white", "loss of contact"),
    "gyroscopic_slip": ("C1", "gyroscopic slip share 0.25"),
    "skid": ("C0", "lag behind rolling 0.1"),
}
SHARES = [0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.35, 0.5, 0.7, 1.0]


def figure_of(path: Path) -> Figure:
    """Figure of a map or of branches.

    Raises
    ------
    CaseFileError
        One line that names the file.
    """
    dataset = load(path)
    kind = dataset.attrs.get("kind")
    if kind == "maps":
        return stress_map(dataset)
    if kind == "branches":
        return branches(dataset)
    raise CaseFileError(f"{path}: given neither a map nor branches of the extremes")


def edges(values: np.ndarray, log: bool) -> np.ndarray:
    """Edges of the cells around the points of an axis."""
    points = np.log(values) if log else values
    middle = 0.5 * (points[1:] + points[:-1])
    ends = [1.5 * points[0] - 0.5 * points[1], 1.5 * points[-1] - 0.5 * points[-2]]
    found = np.concatenate([ends[:1], middle, ends[1:]])
    return np.exp(found) if log else found


def stress_map(found: xr.Dataset) -> Figure:
    """Where steady states are verified, their gyroscopic slip, and why there are none."""
    figure, panels = new_figure(1, 1, 6.6, 4.6)
    axes = panels[0, 0]
    axes.grid(False)
    x, y = found["x"].values, found["y"].values
    x_edges = edges(x, bool(found.attrs["x_log"]))
    y_edges = edges(y, bool(found.attrs["y_log"]))
    status = found["status"].values
    share = np.where(status == OK, found["gyroscopic_slip_share"].values, np.nan)
    norm = matplotlib.colors.BoundaryNorm(SHARES, 256)
    mesh = axes.pcolormesh(x_edges, y_edges, share, cmap="cividis", norm=norm, rasterized=True)
    figure.colorbar(mesh, ax=axes, label="gyroscopic share of the slip, larger of both contacts")
    handles: list[Any] = []
    for code in np.unique(status[status != OK]):
        name = STATUS_NAMES[int(code)]
        cmap = matplotlib.colors.ListedColormap([ENDS.get(name, "black")])
        cells = np.where(status == code, 1.0, np.nan)
        axes.pcolormesh(x_edges, y_edges, cells, cmap=cmap, rasterized=True)
        handles.append(Patch(color=ENDS.get(name, "black"), label=in_words(name)))
    for limit, (colour, text) in LIMITS.items():
        if f"boundary_{limit}" not in found or not np.isfinite(found[f"boundary_{limit}"]).any():
            continue
        line = {"color": colour, "linewidth": 2.0}
        axes.plot(x, found[f"boundary_{limit}"], **line)
        axes.plot(x, found[f"estimate_{limit}"], **line | {"linestyle": ":"})
        shown = line | {"color": "0.6"} if colour == "white" else line
        handles.append(key(text, **shown))
    handles.append(key("its closed form", color="0.3", linestyle=":", linewidth=2.0))
    for along, log in (("x", found.attrs["x_log"]), ("y", found.attrs["y_log"])):
        getattr(axes, f"set_{along}label")(AXES[found.attrs[f"{along}_key"]])
        if log:
            getattr(axes, f"set_{along}scale")("log")
    axes.set_xlim(x_edges[0], x_edges[-1])
    axes.set_ylim(max(y_edges[0], 0.0), y_edges[-1])
    verified, total = int((status == OK).sum()), status.size
    title = f"{found.attrs['shown']}: {verified} of {total} points verified"
    title += ", the others named" if verified < total else ""
    if np.isin(status, [STATUS_NAMES.index(n) for n in ("not_converged", "unverified")]).any():
        title = (
            f"{found.attrs['shown']}: {verified} of {total} points verified, not all others named"
        )
    frame(figure, title, handles, columns=3)
    return figure


WAYS: dict[str, dict[str, Any]] = {
    "up": {"color": "C0", "linestyle": "-", "linewidth": 3.5, "alpha": 0.45},
    "down": {"color": "C1", "linestyle": "--"},
    "anew": {"color": "black", "linestyle": "none", "marker": ".", "markersize": 3},
}
SHOWN = {
    "orbit_share": "orbit rate over shaft rate",
    "total_qv": "QV of the bearing (W)",
    "loss_rate": "rate of loss (m/s)",
}


def branches(found: xr.Dataset) -> Figure:
    """Steady states followed up, down, and found anew."""
    figure, panels = new_figure(1, 3, 7.6, 3.0)
    along = found["along"].values
    ways = found.attrs["ways"].split()
    for axes, (name, text) in zip(panels[0], SHOWN.items(), strict=True):
        for k, way in enumerate(ways):
            axes.plot(along, found[name].values[k], **WAYS[way])
        axes.set_ylabel(text)
        axes.set_xlabel(AXES[found.attrs["key"]])
        if found.attrs["log"]:
            axes.set_xscale("log")
    handles = [
        key({"anew": "found anew (life)"}.get(way, f"followed {way}"), **WAYS[way]) for way in ways
    ]
    frame(figure, f"{found.attrs['shown']}: {verdict(found)}", handles, columns=3)
    return figure


def verdict(found: xr.Dataset) -> str:
    """Whether both ways lead over the same states."""
    both = found["total_qv"].values[:2]
    one = np.isfinite(both).sum(axis=0)
    apart = np.abs(both[0] / both[1] - 1.0) > 1e-4
    if (one == 1).any() or (apart & (one == 2)).any():
        where = found["along"].values[(one == 1) | (apart & (one == 2))]
        return f"two answers from {where.min():.3g} to {where.max():.3g}"
    return "up and down lead over the same states"


KINDS = {"families": "random", "maps": "map"}


def write_table(counts: xr.Dataset, path: Path) -> int:
    """Write how the scenes ended as Markdown; returns how many were wrong."""
    names = counts.attrs["ends"].split()
    rows = []
    for k in range(counts.sizes["set"]):
        one = counts.isel(set=k)
        reasons = [
            f"{in_words(names[code])} {int(number)}"
            for code, number in enumerate(one["count"].values)
            if number and names[code] not in ("ok", "not_converged", "unverified")
        ]
        rows.append(
            [
                f"{in_words(one['name'].item())}, {KINDS[one['kind'].item()]}",
                f"{int(one['trials'])}",
                f"{int(one['verified'])}",
                f"{int(one['several'])}, by {float(one['largest_other_qv']):.0e} of QV"
                if one["several"]
                else "0",
                f"{int(one['refused'])}",
                ", ".join(reasons) or "–",
                *(f"{int(one[key])}" for key in ("unnamed", "wrong")),
            ]
        )
    header = (
        "scenes | solved | verified | of these with several states | refused | for what reason | "
        "without a reason | wrong"
    )
    write_text(path, markdown_table(header, rows) + "\n")
    return int(counts["wrong"].sum())
