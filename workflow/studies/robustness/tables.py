"""Table of how scenes far beyond the other studies ended; fails if an answer is wrong."""

from pathlib import Path

import xarray as xr

from bearingwear.document.markdown import block_markdown
from bearingwear.document.table import points_block
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.results.words import name_in_words
from bearingwear.studies.dataset import load_with_axes
from bearingwear.studies.run_step import NotSolved
from workflow.studies.robustness.plan import WITHOUT_REASON

_KINDS = {"scene_classes": "random", "maps": "map"}
NO_REASON = [STATUS_NAMES[code] for code in (OK, *WITHOUT_REASON)]


def ends_table(counts: Path) -> str:
    """How the scenes ended, as Markdown."""
    found = load_with_axes(counts, set=(), end=())
    rows = [_row(found.isel(set=k)) for k in range(found.sizes["set"])]
    units = dict.fromkeys(rows[0], "") | {"maximum difference in QV": "%"}
    return block_markdown(points_block("", units, [[*row.values()] for row in rows])) + "\n"


def _row(one: xr.Dataset) -> dict[str, int | float | str]:
    reasons = [
        f"{name_in_words(name)} {int(number)}"
        for name, number in zip(one.attrs["ends"].split(), one["count"].values, strict=True)
        if number and name not in NO_REASON
    ]
    return {
        "scenes": f"{name_in_words(one['name'].item())}, {_KINDS[one['kind'].item()]}",
        "solved": int(one["trials"]),
        "verified": int(one["verified"]),
        "several states": int(one["multiple_states"]),
        "maximum difference in QV": 100.0 * float(one["largest_qv_ratio"]),
        "refused": int(one["refused"]),
        "reason": ", ".join(reasons) or "–",
        "without a reason": int(one["unexplained"]),
        "wrong": int(one["violations"]),
    }


def wrong_answers(counts: Path) -> str:
    """Says that no verified answer is wrong; else NotSolved, with the first."""
    found = load_with_axes(counts, set=(), end=())
    wrong = int(found["violations"].sum())
    if wrong:
        first = next(text for text in found["first_violation"].values if text)
        raise NotSolved(f"{counts}: incorrect results: {wrong} (first: {first})")
    return f"none of the {int(found['verified'].sum())} verified results is incorrect\n"
