"""The figure and the table of the bearings that fit what the paper states."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.io.whole import write_text
from bearingwear.model.scene import COUNTS
from bearingwear.report.drawing import (
    COLOURS,
    Figure,
    frame,
    in_words,
    key,
    method_keys,
    methods,
    new_figure,
)
from bearingwear.report.tables import markdown_table
from bearingwear.study.design import counted
from bearingwear.study.family import FITS, FOUND, NO_ANGLE, NO_ROOM

MARKERS = "v^osDPX*"


def fitting(family: xr.Dataset) -> xr.Dataset:
    """The candidates that fit."""
    return family.isel(candidate=family["found"].values == FITS)


def family_figure(family: xr.Dataset) -> Figure:
    """The ridge of contact angle over pitch diameter, and how the lives of those on it spread."""
    figure, ((ridge, lives),) = new_figure(1, 2, 7.2, 4.4)
    found, fits = family["found"].values, fitting(family)
    other = ~np.isin(found, (FITS, NO_ANGLE, NO_ROOM))
    ridge.plot(
        family["pitch_diameter"][other], family["contact_angle"][other], linestyle="none",
        marker=".", color="0.75", markersize=4,
    )  # fmt: skip
    factors = fits["inner_groove_factor"].values
    counts = sorted({int(n) for n in family["ball_count"].values})
    image = None
    for marker, count in zip(MARKERS, counts, strict=False):
        of = fits["ball_count"].values == count
        # a little apart, so that markers of the same pitch diameter do not hide each other
        shift = 0.06 * (counts.index(count) - 0.5 * (len(counts) - 1))
        image = ridge.scatter(
            fits["pitch_diameter"].values[of] + shift, fits["contact_angle"].values[of],
            c=factors[of], marker=marker, s=22, cmap="viridis",
            vmin=factors.min(initial=1.0), vmax=factors.max(initial=0.5),
        )  # fmt: skip
    for name, dm, angle in zip(
        family.attrs["marks"].split(), family["mark_pitch_diameter_mm"].values,
        family["mark_contact_angle_deg"].values, strict=True,
    ):  # fmt: skip
        ridge.plot(dm, angle, marker="o", markersize=11, markerfacecolor="none", color="C1")
        ridge.annotate(name, (dm, angle), xytext=(6, 6), textcoords="offset points", color="C1")
    ridge.set_xlabel("pitch diameter (mm)")
    ridge.set_ylabel("free contact angle (°)")
    ridge.set_title("the ridge")
    if image is not None:
        figure.colorbar(image, ax=ridge, pad=0.01).set_label("inner groove factor")
    way = counted(family)
    for name, one in methods(fits):
        hours = np.sort(one["life"].isel(counts=way).values)
        hours = hours[np.isfinite(hours)]
        if hours.size:
            share = (np.arange(hours.size) + 0.5) / hours.size
            lives.plot(hours, share, color=COLOURS[name])
    lives.set_ylim(0.0, 1.0)
    lives.set_xlabel("wear life (h)")
    lives.set_ylabel("share of the family with a shorter life")
    lives.set_title(f"their lives, counting {in_words(COUNTS[way])}")
    handles = [
        *(
            key(f"{count} balls", color="0.3", linestyle="none", marker=marker)
            for marker, count in zip(MARKERS, counts, strict=False)
        ),
        key("loses as much, but fails another statement", color="0.75", linestyle="none",
            marker="."),
        *method_keys([name for name, _ in methods(family)]),
    ]  # fmt: skip
    frame(figure, family_message(family), handles, columns=4)
    return figure


def family_message(family: xr.Dataset) -> str:
    """What the family says, in a sentence."""
    fits, way = fitting(family), counted(family)
    if not fits.sizes["candidate"]:
        return "No bearing of the grid fits what is stated"
    spans = []
    for name, one in methods(fits):
        hours = one["life"].isel(counts=way).values
        spans.append(f"{np.nanmin(hours):.2f} to {np.nanmax(hours):.2f} h ({in_words(name)})")
    return (
        f"{fits.sizes['candidate']} bearings fit what the paper states; among them life spreads "
        f"over {' and '.join(spans)}"
    )


def write_family(family: xr.Dataset, path: str | Path) -> None:
    """Write what was stated, how many bearings fit it, and each of those."""
    stated = json.loads(family.attrs["statements"])
    count = np.bincount(family["found"].values, minlength=len(FOUND))
    fits, way = fitting(family), counted(family)
    names = [name for name, _ in methods(family)]
    rows = [
        [
            f"{float(one['pitch_diameter']):g}",
            f"{int(one['ball_count'])}",
            f"{float(one['inner_groove_factor']):g}",
            f"{float(one['contact_angle']):.2f}",
            f"{float(one['drag_low']):g} to {float(one['drag_high']):g}",
            f"{float(one['skid_ratio']):.3f}",
            *(f"{float(one['life'][k, c]):.4g}" for c in (way, 1 - way) for k in range(len(names))),
        ]
        for one in (fits.isel(candidate=i) for i in range(fits.sizes["candidate"]))
    ]
    ways = " | ".join(
        f"life, {in_words(name)}, counting {in_words(COUNTS[c])} (h)"
        for c in (way, 1 - way)
        for name in names
    )
    text = [
        "# Bearings that fit what the paper states",
        f"{family_message(family)}. A fit to a text, no validation.",
        markdown_table("statement | value", [[in_words(k), str(v)] for k, v in stated.items()]),
        markdown_table(
            "what was found | candidates",
            [[in_words(name), str(number)] for name, number in zip(FOUND, count, strict=True)],
        ),
        "That a ball slips in the rolling direction above 0.6 µm is not asked for: at the drags "
        "that fit, the largest skid ratio stands below.",
        markdown_table(
            "pitch diameter (mm) | balls | inner groove factor | contact angle (°) | "
            f"drag density that fits (kg/m3) | largest skid ratio | {ways}",
            rows,
        ),
    ]
    write_text(path, "\n\n".join(text) + "\n")
