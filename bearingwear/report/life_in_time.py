"""Figure and table of wear lives that were followed in time."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.io.whole import write_text
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.model.scene import COUNTS
from bearingwear.report.drawing import (
    Figure,
    failed_keys,
    frame,
    from_zero,
    in_words,
    key,
    mark_failed,
    new_figure,
    scene_of,
)
from bearingwear.report.dynamic import power_of_ten
from bearingwear.report.tables import markdown_table

BALLS, RACES, POCKETS, LAND = "C2", "C0", "C3", "C1"
STEADY = {"color": "0.5", "linestyle": "--", "linewidth": 1.0}
MICRO = 1e6


def counted(life: xr.Dataset) -> int:
    """Place of the scene's own way of counting wear."""
    return COUNTS.index(scene_of(life)["wear"]["counts"])


def life_in_time(life: xr.Dataset) -> Figure:
    """What has worn of each ball, races, pockets and land, and what preload is left, over the time.

    Parameters
    ----------
    life : Dataset
        A life file of fidelity dynamic with a history.
    """
    time = life["history_time"].isel(counts=counted(life))
    with_cage = "history_pocket_worn_volume" in life
    figure, panels = new_figure(2, 2, 7.6, 5.6, sharex=True)
    volumes: list[tuple[Any, list[tuple[xr.DataArray, dict]]]] = [
        (panels[0, 0], [(life["history_ball_worn_volume"], {"color": BALLS})]),
        (
            panels[0, 1],
            [
                (life["history_race_worn_volume"].isel(race=k), {"color": RACES, "linestyle": dash})
                for k, dash in enumerate(("-", ":"))
            ],
        ),
    ]
    if with_cage:
        lines = [
            (life["history_pocket_worn_volume"], {"color": POCKETS}),
            (life["history_land_worn_volume"], {"color": LAND}),
        ]
        volumes.append((panels[1, 0], lines))
    else:
        panels[1, 0].axis("off")
    names = ("one ball", "whole race", "cage")
    failed = False
    for (panel, lines), name in zip(volumes, names, strict=False):
        unit = power_of_ten([volume for volume, _ in lines])
        for volume, look in lines:
            panel.plot(time, 10.0**-unit * volume, linewidth=1.0, **look)
        panel.set_ylabel(f"worn off {name} ({_cubed(unit)})")
    panels[1, 1].plot(time, life["history_residual_preload"], color="black", marker=".")
    panels[1, 1].set_ylabel("residual preload (N)")
    for panel in panels.flat:
        if panel.axison:
            if "steady_life" in life:
                panel.axvline(float(life["steady_life"]), **STEADY)
            failed |= mark_failed(panel, time, life["history_status"], "0.3", 0)
            from_zero(panel)
            panel.set_xlim(left=0.0)
            panel.tick_params(labelbottom=True)
            panel.set_xlabel("running time (h)")
    keys = [
        key("each ball", color=BALLS),
        key("inner race", color=RACES),
        key("outer race", color=RACES, linestyle=":"),
    ]
    if with_cage:
        keys += [key("each pocket", color=POCKETS), key("guiding land", color=LAND)]
    if "steady_life" in life:
        keys.append(key("steady life", **STEADY))
    frame(figure, _message(life), [*keys, *failed_keys(failed)], columns=4)
    return figure


def _cubed(exponent: int) -> str:
    """A unit of volume: cubes of 10^(exponent/3) m, exponent a multiple of three."""
    names = {-9: "mm³", -18: "µm³", 0: "m³"}
    if exponent in names:
        return names[exponent]
    base = -18 if exponent < -9 else -9
    digits = str(exponent - base).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"10{digits}\N{NO-BREAK SPACE}{names[base]}"


def ended_by(life: xr.Dataset) -> str:
    """What ended a life, in words; the status where nothing did."""
    status = int(life["status"])
    return criterion(life, "end_criterion") if status == OK else in_words(STATUS_NAMES[status])


def criterion(life: xr.Dataset, name: str) -> str:
    """A criterion of a life in words, without its unit."""
    met = life[name].attrs["flag_meanings"].split()[int(life[name])]
    return in_words(met.removesuffix("_mm").removesuffix("_um"))


def _message(life: xr.Dataset) -> str:
    hours, name = float(life["life"][counted(life)]), scene_of(life)["name"]
    if int(life["status"]) != OK:
        return f"{name}: no end was reached in {hours:.3g} h ({ended_by(life)})"
    text = f"{name}: {ended_by(life)} ends the life after {hours:.3g} h"
    if "steady_life" in life:
        text += f", {hours / float(life['steady_life']):.3g} times the steady life"
    return text


def write_lives(lives: Sequence[tuple[str, xr.Dataset]], path: str | Path) -> None:
    """Write a table of lives in time beside the steady ones, as Markdown.

    Parameters
    ----------
    lives : sequence of (str, Dataset)
        Names and life files of fidelity dynamic.
    """
    rows = [[name, *_numbers(life)] for name, life in lives]
    parts = [
        "# Wear life, followed in time",
        markdown_table(
            "life of | life (h) | ± (h) | ended by | steady life (h) | ended by "
            "| steady time to the same loss (h) | loss (µm) | balls' wear, least and most of the "
            "mean | pockets and land (10³ µm³)",
            rows,
        ),
        "±: bound of what steps and scatter of the runs do. Balls' wear: worn off each since the "
        "start. The steady life is that of what of the scene has one: thrust alone, no cage, mean "
        "loss.",
    ]
    write_text(path, "\n\n".join(parts) + "\n")


def _numbers(life: xr.Dataset) -> list[str]:
    """A row of the table."""
    k = counted(life)

    def one(name: str, scale: float = 1.0) -> str:
        value = float(life[name]) if name in life else float("nan")
        return f"{scale * value:.4g}"

    # of a life that no run was solved for there is no history
    if "history_ball_worn_volume" not in life:
        return [*["–"] * 2, ended_by(life), one("steady_life"), *["–"] * 5]
    balls = life["history_ball_worn_volume"].values[-1]
    spread = balls / balls.mean() if balls.mean() > 0.0 else np.full(1, np.nan)
    cage = "–"
    if "history_pocket_worn_volume" in life:
        pockets = life["history_pocket_worn_volume"].values[-1].sum()
        land = life["history_land_worn_volume"].values[-1]
        cage = f"{1e15 * pockets:.4g}, {1e15 * land:.4g}"
    steady = criterion(life, "steady_end_criterion") if "steady_life" in life else "–"
    return [
        f"{float(life['life'][k]):.4g}",
        f"{float(life['life_error_bound'][k]):.2g}",
        ended_by(life),
        one("steady_life"),
        steady,
        one("steady_time_to_loss"),
        one("loss_at_end", MICRO),
        f"{spread.min():.3f}, {spread.max():.3f}",
        cage,
    ]
