"""The figure of the bearings that fit what the paper states."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.plotting.drawing import (
    COLOURS,
    Figure,
    frame,
    key,
    method_keys,
    new_figure,
)
from bearingwear.results.units import span
from bearingwear.results.words import in_words, methods
from bearingwear.scene.scene import COUNTS
from bearingwear.studies.dataset import counted, loaded
from workflow.studies.identify.search import FITS, NO_ANGLE, NO_ROOM

BALL_MARKERS = "v^osDPX*"


def fitting(candidates: xr.Dataset) -> xr.Dataset:
    return candidates.isel(candidate=candidates["fit_result"].values == FITS)


def candidates_figure(candidates: Path) -> Figure:
    """Step: `ridge_and_lives` of a file."""
    return ridge_and_lives(loaded(candidates, candidate=()))


def ridge_and_lives(found: xr.Dataset) -> Figure:
    """The ridge of contact angle over pitch diameter, and how the lives on it spread."""
    figure, ((ridge, lives),) = new_figure(1, 2, 7.2, 4.4)
    counts = sorted({int(n) for n in found["ball_count"].values})
    markers = dict(zip(counts, BALL_MARKERS, strict=False))
    _ridge(figure, ridge, found, markers)
    _lives(lives, found)
    handles = [
        *(
            key(f"{count} balls", color="0.3", linestyle="none", marker=marker)
            for count, marker in markers.items()
        ),
        key(
            "match the stated loss of preload, but not all statements",
            color="0.75",
            linestyle="none",
            marker=".",
        ),
        *method_keys([name for name, _ in methods(found)]),
    ]
    frame(figure, candidates_message(found), handles, columns=4)
    return figure


def _ridge(figure: Figure, panel: Any, found: xr.Dataset, markers: dict[int, str]) -> None:
    """Contact angle over pitch diameter, of all that lose the stated preload."""
    fits = fitting(found)
    others = found.isel(candidate=~np.isin(found["fit_result"], (FITS, NO_ANGLE, NO_ROOM)))
    panel.plot(
        others["pitch_diameter"],
        others["contact_angle"],
        linestyle="none",
        marker=".",
        color="0.75",
        markersize=4,
    )
    factors = fits["inner_groove_factor"].values
    image = None
    for k, (count, marker) in enumerate(markers.items()):
        some = fits["ball_count"].values == count
        # a little apart, so that markers of the same pitch diameter do not hide each other
        shift = 0.06 * (k - 0.5 * (len(markers) - 1))
        image = panel.scatter(
            fits["pitch_diameter"].values[some] + shift,
            fits["contact_angle"].values[some],
            c=factors[some],
            marker=marker,
            s=22,
            cmap="viridis",
            vmin=factors.min(initial=1.0),
            vmax=factors.max(initial=0.5),
        )
    for name, dm, angle in zip(
        found.attrs["marks"].split(),
        found["mark_pitch_diameter_mm"].values,
        found["mark_contact_angle_deg"].values,
        strict=True,
    ):
        panel.plot(dm, angle, marker="o", markersize=11, markerfacecolor="none", color="C3")
        panel.annotate(name, (dm, angle), xytext=(6, 6), textcoords="offset points", color="C3")
    panel.set_xlabel("pitch diameter (mm)")
    panel.set_ylabel("free contact angle (°)")
    panel.set_title("ridge of matching bearings")
    if image is not None:
        figure.colorbar(image, ax=panel, pad=0.01).set_label("inner groove factor")


def _lives(panel: Any, found: xr.Dataset) -> None:
    """Distribution of the lives of those that fit."""
    basis = counted(found)
    for name, one in methods(fitting(found)):
        hours = np.sort(one["life"].isel(loss_basis=basis).values)
        hours = hours[np.isfinite(hours)]
        if hours.size:
            share = (np.arange(hours.size) + 0.5) / hours.size
            panel.plot(hours, share, color=COLOURS[name])
    panel.set_ylim(0.0, 1.0)
    panel.set_xlabel("wear life (h)")
    panel.set_ylabel("share of these bearings with a shorter life")
    worn = in_words(COUNTS[basis]).replace("ball", "balls")
    panel.set_title(f"computed life, wear of {worn}")


def candidates_message(candidates: xr.Dataset) -> str:
    """What the study finds, in a sentence."""
    fits, basis = fitting(candidates), counted(candidates)
    if not fits.sizes["candidate"]:
        return "No bearing in the grid matches the statements"
    spans = []
    for name, one in methods(fits):
        hours = one["life"].isel(loss_basis=basis).values
        spans.append(f"{span(hours)} h ({in_words(name)})")
    return (
        f"{fits.sizes['candidate']} bearings match the statements in the paper; their computed "
        f"lives are {' and '.join(spans)}"
    )
