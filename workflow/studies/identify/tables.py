"""The table of the bearings that fit what the paper states."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from bearingwear.document.markdown import markdown_table
from bearingwear.results.units import digits, display, in_print, span
from bearingwear.results.words import in_words, methods
from bearingwear.scene.scene import COUNTS
from bearingwear.studies.dataset import counted, loaded
from workflow.studies.identify.figures import candidates_message, fitting
from workflow.studies.identify.search import FIT_RESULTS

_SKID = display("1", shown="%")


def candidates_table(candidates: Path) -> str:
    """Step: what was stated, how many bearings fit it, and each of those, as Markdown."""
    found = loaded(candidates, candidate=())
    stated = json.loads(found.attrs["statements"])
    count = np.bincount(found["fit_result"].values, minlength=len(FIT_RESULTS))
    fits, basis = fitting(found), counted(found)
    names = [name for name, _ in methods(found)]
    rows = [
        [
            digits(float(one["pitch_diameter"])),
            str(int(one["ball_count"])),
            digits(float(one["inner_groove_factor"])),
            digits(float(one["contact_angle"])),
            span([float(one["drag_low"]), float(one["drag_high"])]),
            _SKID.text(one["skid_ratio"]),
            *(
                digits(float(life.isel(loss_basis=c)))
                for c in (basis, 1 - basis)
                for life in one["life"]
            ),
        ]
        for one in (fits.isel(candidate=i) for i in range(fits.sizes["candidate"]))
    ]
    ways = " | ".join(
        f"life, {in_words(name)}, counting {in_words(COUNTS[c])} (h)"
        for c in (basis, 1 - basis)
        for name in names
    )
    text = [
        "# Bearings that fit what the paper states",
        f"{candidates_message(found)}. A fit to a text, no validation.",
        markdown_table("statement | value", [[in_words(k), str(v)] for k, v in stated.items()]),
        markdown_table(
            "what was found | candidates",
            [
                [in_words(name), str(number)]
                for name, number in zip(FIT_RESULTS, count, strict=True)
            ],
        ),
        "Slip of the whole ball in the rolling direction above 0.6 µm is not required. The table "
        "has the largest skid ratio at the drags that fit.",
        markdown_table(
            "pitch diameter (mm) | balls | inner groove factor | contact angle (°) | "
            f"drag density that fits ({in_print('kg/m3')}) | {_SKID.label('largest skid ratio')} | "
            f"{ways}",
            rows,
        ),
    ]
    return "\n\n".join(text) + "\n"
