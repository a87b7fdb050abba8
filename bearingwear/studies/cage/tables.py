"""The table of a map of cages."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.document.data import flag_names
from bearingwear.document.markdown import markdown_table
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.plotting.drawing import in_words
from bearingwear.results.units import digits, display
from bearingwear.studies.cage.figures import cage_message
from bearingwear.studies.cage.motion import MOTIONS
from bearingwear.studies.dataset import loaded

MICROMETRES, WEAR, OF_MEAN = display("m"), display("m3 s-1"), display("1", shown="%")


def cage_table(motions: Path) -> str:
    """Step: every cage from every start, as Markdown."""
    found = loaded(motions, cage_friction=(), start=())
    every = found.stack(
        cage=("gravity", "pocket_clearance", "guide_clearance", "cage_friction"), create_index=False
    )
    rows = [
        row
        for k in range(every.sizes["cage"])
        for row in _rows(every.isel(cage=k), flag_names(found["start"]))
    ]
    stretch = found.attrs["stretch_turns"]
    text = [
        "# Motions of a cage",
        f"{cage_message(found)}.",
        markdown_table(
            "gravity (m/s²) | clearance of pockets, land (mm) | friction | start | motion | from "
            f"turn | whirl over shaft | centre Y, Z ({MICROMETRES.printed}) | "
            f"{MICROMETRES.label('off the axis')} | pockets (mW) | land (mW) | "
            f"{WEAR.label('wear of pockets')} | {WEAR.label('of the land')} | "
            f"{OF_MEAN.label('wear over the mean of the starts')}",
            rows,
        ),
        f"{found.attrs['turns']} turns each; the motion is named for every {stretch} turns, and "
        "all else is the mean over the evaluated turns at the end. The balls orbit at "
        f"{digits(float(found['ball_ratio'].mean()))} of the shaft's rate. Power: normal force "
        "times slip. Where starts end in one motion the last column says how well wear is "
        "reproduced.",
    ]
    return "\n\n".join(text) + "\n"


def _rows(cage: xr.Dataset, starts: list[str]) -> list[list[str]]:
    clearances = [digits(1e3 * float(cage[f"{name}_clearance"])) for name in ("pocket", "guide")]
    head = [
        f"{float(cage['gravity']):g}",
        ", ".join(clearances),
        f"{float(cage['cage_friction']):g}",
    ]
    wear = (cage["cage_wear_rate"] + cage["cage_land_wear_rate"]).values
    mean = np.nanmean(wear) if np.isfinite(wear).any() else np.nan
    return [
        [*head, in_words(start), *_run(cage.isel(start=s), wear[s] / mean if mean else np.nan)]
        for s, start in enumerate(starts)
    ]


def _run(run: xr.Dataset, share: float) -> list[str]:
    status = int(run["status"])
    if status != OK:
        return [in_words(STATUS_NAMES[status]), *["–"] * 9]
    y, z = (MICROMETRES.text(value) for value in run["centre"].values)
    return [
        in_words(MOTIONS[int(run["motion"])]),
        digits(float(run["begins"])),
        digits(float(run["whirl_ratio"])),
        f"{y}, {z}",
        MICROMETRES.text(run["offset"]),
        digits(1e3 * float(run["pocket_power"])),
        digits(1e3 * float(run["land_power"])),
        WEAR.text(run["cage_wear_rate"]),
        WEAR.text(run["cage_land_wear_rate"]),
        OF_MEAN.text(share),
    ]
