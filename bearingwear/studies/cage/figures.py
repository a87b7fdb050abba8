"""The figure of a map of cages: how fast they whirl and what they wear."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.plotting.drawing import Figure, frame, in_words, key, new_figure, scene_of
from bearingwear.results.units import digits, display
from bearingwear.studies.cage.motion import (
    FLOATS,
    HANGS,
    IRREGULAR,
    MOTIONS,
    WHIRLS,
    WITH_BALLS,
    WITH_THEM,
)
from bearingwear.studies.dataset import loaded

MOTION_MARKERS = {FLOATS: "_", HANGS: "v", WITH_BALLS: "s", WHIRLS: "o", IRREGULAR: "x"}
_APART = 0.03
"""Relative distance in friction of cages that differ in clearance, so that all are seen."""


def cage_figure(motions: Path) -> Figure:
    """Step: `whirl_and_wear` of a file."""
    return whirl_and_wear(loaded(motions, cage_friction=(), start=()))


def whirl_and_wear(motions: xr.Dataset) -> Figure:
    """Whirl over the shaft's rate, wear in pockets and on the land, against the cage's friction."""
    gravities = motions["gravity"].values
    figure, panels = new_figure(
        3, len(gravities), 3.9 * len(gravities) + 0.4, 8.0, sharex=True, sharey="row"
    )
    wear = [motions[name] for name in ("cage_wear_rate", "cage_land_wear_rate")]
    unit = display("m3 s-1", *wear)
    rows = (
        ("whirl_ratio", 1.0, "whirl over the shaft's rate"),
        ("cage_wear_rate", unit.factor, unit.label("wear of the pockets")),
        ("cage_land_wear_rate", unit.factor, unit.label("wear at the land")),
    )
    for k, g in enumerate(gravities):
        at = motions.isel(gravity=k)
        for panel, (name, factor, text) in zip(panels[:, k], rows, strict=True):
            _points(panel, at, name, factor)
            panel.set_xscale("log")
            mu = motions["cage_friction"].values
            panel.set_xticks(mu, [f"{value:g}" for value in mu])
            panel.minorticks_off()
            if k == 0:
                panel.set_ylabel(text)
        panels[0, k].axhline(float(at["ball_ratio"].mean()), color="0.6", linewidth=0.8)
        panels[0, k].set_title(f"gravity {g:g} m/s²" if g else "weightless", loc="left")
        panels[2, k].set_xlabel("friction coefficient of the cage")
    frame(figure, f"{scene_of(motions)['name']}: {cage_message(motions)}", _keys(motions), 4)
    return figure


def _clearances(motions: xr.Dataset) -> list[tuple[int, int, str]]:
    """Indices of pocket and guide clearance, and both in words."""
    return [
        (p, c, f"pockets {digits(1e3 * pocket)} mm, land {digits(1e3 * guide)} mm")
        for p, pocket in enumerate(motions["pocket_clearance"].values)
        for c, guide in enumerate(motions["guide_clearance"].values)
    ]


def _points(panel: Any, at: xr.Dataset, name: str, factor: float) -> None:
    for k, (p, c, _) in enumerate(_clearances(at)):
        one = at.isel(pocket_clearance=p, guide_clearance=c)
        mu = one["cage_friction"].values * (1.0 + _APART * k)
        for s in range(one.sizes["start"]):
            motion, value = one["motion"].values[:, s], factor * one[name].values[:, s]
            for code, marker in MOTION_MARKERS.items():
                some = motion == code
                panel.plot(
                    mu[some], value[some], marker, color=f"C{k}", markersize=5, fillstyle="none"
                )


def _keys(motions: xr.Dataset) -> list[Any]:
    look = {"color": "0.3", "linestyle": "none", "fillstyle": "none"}
    found = set(np.unique(motions["motion"].values[np.isfinite(motions["motion"].values)]))
    return [
        *(
            key(words, color=f"C{k}", linewidth=3)
            for k, (_, _, words) in enumerate(_clearances(motions))
        ),
        *(
            key(in_words(MOTIONS[code]), marker=marker, **look)
            for code, marker in MOTION_MARKERS.items()
            if code in found
        ),
        key("rate of the balls", color="0.6", linewidth=0.8),
    ]


def own_clearances(motions: xr.Dataset) -> xr.Dataset:
    """The cages of the map whose clearances are next to those of the scene."""
    cage = scene_of(motions)["cage"]
    return motions.sel(
        pocket_clearance=1e-3 * cage["pocket_clearance_mm"],
        guide_clearance=1e-3 * cage["guide_clearance_mm"],
        method="nearest",
    )


def cage_message(motions: xr.Dataset) -> str:
    """Where a whirl branches off, and how many cages hang, in a sentence for each gravity."""
    own = own_clearances(motions)
    return "; ".join(
        _branching(own.isel(gravity=k), float(g), motions.attrs["turns"])
        for k, g in enumerate(own["gravity"].values)
    )


def _branching(own: xr.Dataset, g: float, turns: int) -> str:
    """From which friction on any start, and every start, ends in a whirl faster than the balls."""
    mu, motion = own["cage_friction"].values, own["motion"].values
    ratio, solved = own["whirl_ratio"].values, np.isfinite(own["motion"].values)
    than_balls = (1.0 + WITH_THEM) * own["ball_ratio"].values
    faster = np.isin(motion, (WHIRLS, IRREGULAR)) & (ratio > than_balls)
    hanging = int((motion == HANGS).sum())
    under = f"under {g:.3g} m/s²" if g else "weightless"
    tail = f", and {hanging} of {solved.sum()} runs hang after {turns} turns" if hanging else ""
    some, every = faster.any(axis=1), (faster | ~solved).all(axis=1)
    if not some.any():
        return f"{under}, no cage whirls faster than the balls{tail}"
    first = int(np.argmax(some))
    begin = f"at {mu[first]:g}" if first == 0 else f"between {mu[first - 1]:g} and {mu[first]:g}"
    rate = digits(float(ratio[first][faster[first]].mean()))
    alone = next((float(mu[k]) for k in range(first, mu.size) if every[k:].all()), None)
    when = "never the only motion" if alone is None else f"the only motion from {alone:g} on"
    return (
        f"{under}, a whirl of {rate} times the shaft's rate branches off {begin} of friction, "
        f"{when}{tail}"
    )
