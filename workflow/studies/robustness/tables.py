"""Table of the outcomes of extreme scenes; a check that fails if an answer is wrong."""

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
    """Step: returns a table of the outcomes of random scenes and of maps, as Markdown.

    counts: file of `counted_ends`.
    """
    outcomes = load_with_axes(counts, set=(), end=())
    rows = [_outcome_cells(outcomes.isel(set=k)) for k in range(outcomes.sizes["set"])]
    units = dict.fromkeys(rows[0], "") | {"maximum difference in QV": "%"}
    return block_markdown(points_block("", units, [[*row.values()] for row in rows])) + "\n"


def _outcome_cells(outcome: xr.Dataset) -> dict[str, int | float | str]:
    """Returns the cells of the row of a file by the heads of their columns.

    The cell "reason" counts the statuses with a physical reason; a dash stands for none.

    outcome: of `counted_ends`, at the file.
    """
    reasons = [
        f"{name_in_words(name)} {int(count)}"
        for name, count in zip(outcome.attrs["ends"].split(), outcome["count"].values, strict=True)
        if count and name not in NO_REASON
    ]
    return {
        "scenes": f"{name_in_words(outcome['name'].item())}, {_KINDS[outcome['kind'].item()]}",
        "solved": int(outcome["trials"]),
        "verified": int(outcome["verified"]),
        "several states": int(outcome["multiple_states"]),
        "maximum difference in QV": 100.0 * float(outcome["largest_qv_ratio"]),
        "refused": int(outcome["refused"]),
        "reason": ", ".join(reasons) or "–",
        "without a reason": int(outcome["unexplained"]),
        "wrong": int(outcome["violations"]),
    }


def wrong_answers(counts: Path) -> str:
    """Step: returns a line that says that no verified answer is wrong; raises if one is.

    Scenes whose solve crashed count as wrong answers, too.

    counts: file of `counted_ends`.
    NotSolved: some are wrong; the line has their number and the first violation.
    """
    outcomes = load_with_axes(counts, set=(), end=())
    wrong = int(outcomes["violations"].sum())
    if wrong:
        first_violation = next(text for text in outcomes["first_violation"].values if text)
        raise NotSolved(f"{counts}: incorrect results: {wrong} (first: {first_violation})")
    return f"none of the {int(outcomes['verified'].sum())} verified results is incorrect\n"
