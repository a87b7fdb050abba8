"""Figures of a life that was solved with the dynamic model, and of one with worn grooves."""

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.ticker import MaxNLocator

from bearingwear.kernels.status import OK
from bearingwear.plotting.drawing import (
    SERIES,
    Figure,
    failed_keys,
    frame,
    key,
    mark_failed,
    new_figure,
    power_of_ten,
    start_at_zero,
    ten_to_the,
    with_data_files,
)
from bearingwear.results.netcdf import CaseFileError
from bearingwear.results.quantiles import hours_in_words
from bearingwear.results.units import Rough, digits
from bearingwear.results.words import plain_scene
from bearingwear.studies.lives.tables import dynamic_life, ended_by

_BALLS, _RACES, _POCKETS, _LAND = SERIES[:4]
_STEADY = {"color": "0.5", "linestyle": "--", "linewidth": 1.0}
_GROOVES = ("inner groove", "outer groove")
_AGES = "viridis_r"


def wear_history(life: Path) -> Figure:
    """Step: returns the figure of the history of a dynamic life in a file.

    CaseFileError: a file of another kind, or a life of which no step was solved.
    """
    dataset = dynamic_life(life)
    if "history_ball_worn_volume" not in dataset:
        raise CaseFileError(f"{life}: no step of this life calculation could be solved")
    return with_data_files(history_figure(dataset), life)


def history_figure(life: xr.Dataset) -> Figure:
    """Returns a figure of the worn volumes of balls, races and cage, and of preload, over time.

    Without a cage, its panel is missing. Crosses mark steps that were not solved, and a dashed line
    the life by the steady model, if the file has it.

    life: dataset of a life of fidelity dynamic.
    """
    time = life["history_time"]
    figure, panels = new_figure(2, 2, 7.6, 5.6, sharex=True)
    # the last panel is that of the preload
    for panel, (part, lines) in zip(panels.flat, _volume_lines(life).items(), strict=False):
        exponent = power_of_ten([volume for volume, _ in lines])
        for volume, style in lines:
            panel.plot(time, 10.0**-exponent * volume, linewidth=1.0, **style)
        panel.set_ylabel(f"wear volume of {part} ({_volume_unit(exponent)})")
    if not _with_cage(life):
        panels[1, 0].axis("off")
    panels[1, 1].plot(time, life["history_residual_preload"], color="black", marker=".")
    panels[1, 1].set_ylabel("residual preload (N)")
    failed = False
    for panel in panels.flat:
        if panel.axison:
            if "steady_life" in life:
                panel.axvline(float(life["steady_life"]), **_STEADY)
            failed |= mark_failed(panel, time, life["history_status"], "0.3", 0)
            start_at_zero(panel)
            panel.set_xlim(left=0.0)
            panel.tick_params(labelbottom=True)
            panel.set_xlabel("running time (h)")
    frame(figure, _history_title(life), [*_legend_keys(life), *failed_keys(failed)], columns=4)
    return figure


def _with_cage(life: xr.Dataset) -> bool:
    """Whether a life includes the wear of a cage."""
    return "history_pocket_worn_volume" in life


def _volume_lines(life: xr.Dataset) -> dict[str, list[tuple[xr.DataArray, dict[str, Any]]]]:
    """Returns the worn volumes over time and the styles of their lines, by the part that wears."""
    races = life["history_race_worn_volume"]
    lines = {
        "one ball": [(life["history_ball_worn_volume"], {"color": _BALLS})],
        "the whole race": [
            (races.isel(race=k), {"color": _RACES, "linestyle": dash})
            for k, dash in enumerate(("-", ":"))
        ],
    }
    if _with_cage(life):
        lines["the cage"] = [
            (life["history_pocket_worn_volume"], {"color": _POCKETS}),
            (life["history_land_worn_volume"], {"color": _LAND}),
        ]
    return lines


def _legend_keys(life: xr.Dataset) -> list[Any]:
    """Returns the entries of the legend of a history, without that of failures."""
    keys = [
        key("each ball", color=_BALLS),
        key("inner race", color=_RACES),
        key("outer race", color=_RACES, linestyle=":"),
    ]
    if _with_cage(life):
        keys += [key("each pocket", color=_POCKETS), key("guiding land", color=_LAND)]
    if "steady_life" in life:
        keys.append(key("steady life", **_STEADY))
    return keys


def _volume_unit(exponent: int) -> str:
    """Returns the unit of 10^exponent m3 as text, such as "mm³" for -9 and "10³ µm³" for -15."""
    names = {-9: "mm³", -18: "µm³", 0: "m³"}
    if exponent in names:
        return names[exponent]
    base = -18 if exponent < -9 else -9
    return f"{ten_to_the(exponent - base)}\N{NO-BREAK SPACE}{names[base]}"


def _history_title(life: xr.Dataset) -> str:
    """Returns a title on the length of a life, what ended it, and how the steady life compares."""
    scene = plain_scene(life)
    name = scene["name"]
    hours = float(life["life"])
    if int(life["status"]) != OK:
        return f"{name}: no end of life within {Rough(hours).text} h ({ended_by(life)})"
    text = f"{name}: life ended by {ended_by(life)} after {hours_in_words(scene, hours)}"
    if "steady_life" in life:
        text += f", {hours / float(life['steady_life']):.3g} times the steady life"
    return text


def groove_figure(life: xr.Dataset) -> Figure:
    """Returns a figure of the pressures and profiles of both grooves at some states of a life.

    It shows the part of each groove that is worn or pressed in any of these states.

    life: dataset of a life with worn grooves, which has profiles at its steps `groove_step`.
    """
    figure, panels = new_figure(2, 2, 7.6, 5.4)
    steps = life["groove_step"].values
    colours = [*matplotlib.colormaps[_AGES](np.linspace(0.1, 1.0, len(steps)))]
    hours = life["history_time"].values
    for race, title in enumerate(_GROOVES):
        arc = 1e3 * life["groove_arc"].isel(race=race).values
        pressure = 1e-9 * life["groove_pressure"].isel(race=race).values
        depth = 1e6 * life["groove_depth"].isel(race=race).values
        # where the groove is worn by a thousandth of its greatest depth, or pressed
        is_shown = (depth > 1e-3 * depth.max()).any(axis=0) | (pressure > 0.0).any(axis=0)
        shown = arc[is_shown]
        for k, colour in enumerate(colours):
            panels[0, race].plot(arc, pressure[k], color=colour)
            panels[1, race].plot(arc, -depth[k], color=colour)
        for panel in panels[:, race]:
            panel.set_xlim(shown.min(), shown.max())
            panel.set_xlabel("position across the groove, towards +X (mm)")
            panel.xaxis.set_major_locator(MaxNLocator(6))
        panels[0, race].set_title(title)
        start_at_zero(panels[0, race])
    panels[0, 0].set_ylabel("pressure on the centre line (GPa)")
    panels[1, 0].set_ylabel("worn groove profile (µm)")
    keys = [
        key(f"after {digits(hours[step])} h" if step else "new", color=colour)
        for step, colour in zip(steps, colours, strict=True)
    ]
    loss_um = 1e6 * float(life["history_ball_diameter_loss"][steps[-1]])
    name = plain_scene(life)["name"]
    title = f"{name}: groove profiles up to a total wear depth of {loss_um:.2g} µm"
    frame(figure, title, keys, columns=5)
    return figure
