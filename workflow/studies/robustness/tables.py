"""Table of how scenes far beyond the other studies ended; fails if an answer is wrong."""

from pathlib import Path

import xarray as xr

from bearingwear.document.markdown import markdown_table
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.results.units import display
from bearingwear.results.words import in_words
from bearingwear.studies.dataset import loaded
from bearingwear.studies.run_step import NotSolved
from workflow.studies.robustness.ends import WITHOUT_REASON

_KINDS = {"scene_classes": "random", "maps": "map"}
_HEADER = (
    "scenes | solved | verified | of these with several states | refused | for what reason | "
    "without a reason | wrong"
)
NO_REASON = [STATUS_NAMES[code] for code in (OK, *WITHOUT_REASON)]


def ends_table(counts: Path) -> str:
    """Step: how the scenes ended, as Markdown."""
    found = loaded(counts, set=(), end=())
    names = found.attrs["ends"].split()
    rows = [_row(found.isel(set=k), names) for k in range(found.sizes["set"])]
    return markdown_table(_HEADER, rows) + "\n"


def _row(one: xr.Dataset, names: list[str]) -> list[str]:
    reasons = [
        f"{in_words(name)} {int(number)}"
        for name, number in zip(names, one["count"].values, strict=True)
        if number and name not in NO_REASON
    ]
    apart = display("1", shown="%").text(one["largest_qv_ratio"])
    multiple = f"{int(one['multiple_states'])}, by up to {apart} % of QV"
    return [
        f"{in_words(one['name'].item())}, {_KINDS[one['kind'].item()]}",
        f"{int(one['trials'])}",
        f"{int(one['verified'])}",
        multiple if one["multiple_states"] else "0",
        f"{int(one['refused'])}",
        ", ".join(reasons) or "–",
        f"{int(one['unexplained'])}",
        f"{int(one['violations'])}",
    ]


def wrong_answers(counts: Path) -> str:
    """Step: says that no verified answer is wrong.

    Raises
    ------
    NotSolved
        How many are wrong, and the first.
    """
    found = loaded(counts, set=(), end=())
    wrong = int(found["violations"].sum())
    if wrong:
        first = next(text for text in found["first_violation"].values if text)
        raise NotSolved(f"{counts}: {wrong} wrong, the first: {first}")
    return f"none of {int(found['verified'].sum())} verified answers is wrong\n"
