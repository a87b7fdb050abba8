"""Figure of a life that was solved with the dynamic model."""

from pathlib import Path
from typing import Any

import xarray as xr

from bearingwear.kernels.status import OK
from bearingwear.plotting.drawing import (
    Figure,
    failed_keys,
    frame,
    from_zero,
    key,
    mark_failed,
    new_figure,
    power_of_ten,
    scene_of,
    ten_to_the,
)
from bearingwear.results.netcdf import CaseFileError
from bearingwear.results.units import digits
from bearingwear.studies.dataset import counted
from bearingwear.studies.lives.life_file import dynamic_life, ended_by

_BALLS, _RACES, _POCKETS, _LAND = "C2", "C0", "C3", "C1"
_STEADY = {"color": "0.5", "linestyle": "--", "linewidth": 1.0}


def wear_history(life: Path) -> Figure:
    """Step: the history of a life.

    Raises
    ------
    CaseFileError
        One line: the life has no history.
    """
    solved = dynamic_life(life)
    if "history_ball_worn_volume" not in solved:
        raise CaseFileError(f"{life}: no step of this life was solved")
    return history_figure(solved)


def history_figure(life: xr.Dataset) -> Figure:
    """What has worn of each ball, races, pockets and land, and what preload is left, over the time.

    Parameters
    ----------
    life : Dataset
        A life file of fidelity dynamic with a history.
    """
    time = life["history_time"].isel(counts=counted(life))
    figure, panels = new_figure(2, 2, 7.6, 5.6, sharex=True)
    for panel, (part, lines) in zip(panels.flat, _worn(life).items(), strict=False):
        unit = power_of_ten([volume for volume, _ in lines])
        for volume, look in lines:
            panel.plot(time, 10.0**-unit * volume, linewidth=1.0, **look)
        panel.set_ylabel(f"worn off {part} ({_cubed(unit)})")
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
            from_zero(panel)
            panel.set_xlim(left=0.0)
            panel.tick_params(labelbottom=True)
            panel.set_xlabel("running time (h)")
    frame(figure, _message(life), [*_keys(life), *failed_keys(failed)], columns=4)
    return figure


def _with_cage(life: xr.Dataset) -> bool:
    return "history_pocket_worn_volume" in life


def _worn(life: xr.Dataset) -> dict[str, list[tuple[xr.DataArray, dict[str, Any]]]]:
    """Worn volumes and how they are drawn, by the part they are worn off."""
    races = life["history_race_worn_volume"]
    worn = {
        "one ball": [(life["history_ball_worn_volume"], {"color": _BALLS})],
        "whole race": [
            (races.isel(race=k), {"color": _RACES, "linestyle": dash})
            for k, dash in enumerate(("-", ":"))
        ],
    }
    if _with_cage(life):
        worn["cage"] = [
            (life["history_pocket_worn_volume"], {"color": _POCKETS}),
            (life["history_land_worn_volume"], {"color": _LAND}),
        ]
    return worn


def _keys(life: xr.Dataset) -> list[Any]:
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


def _cubed(exponent: int) -> str:
    """A unit of volume: cubes of 10^(exponent/3) m, exponent a multiple of three."""
    names = {-9: "mm³", -18: "µm³", 0: "m³"}
    if exponent in names:
        return names[exponent]
    base = -18 if exponent < -9 else -9
    return f"{ten_to_the(exponent - base)}\N{NO-BREAK SPACE}{names[base]}"


def _message(life: xr.Dataset) -> str:
    hours, name = float(life["life"][counted(life)]), scene_of(life)["name"]
    if int(life["status"]) != OK:
        return f"{name}: no end was reached in {digits(hours)} h ({ended_by(life)})"
    text = f"{name}: {ended_by(life)} ends the life after {digits(hours)} h"
    if "steady_life" in life:
        text += f", {hours / float(life['steady_life']):.3g} times the steady life"
    return text
