"""The table of the bearings that fit what the paper states."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.document.document import Block, Document
from bearingwear.document.markdown import as_markdown
from bearingwear.document.table import points_block, table_of
from bearingwear.results.words import in_words, methods
from bearingwear.scene.scene import COUNTS
from bearingwear.studies.dataset import counted, loaded
from workflow.studies.identify.figures import candidates_message, fitting
from workflow.studies.identify.search import CANDIDATE, FIT_RESULTS

_SKID_NOTE = (
    "Above 0.6 µm of wear, the fit does not require the whole ball to slip in the rolling "
    "direction. The table lists the maximum skid ratio over the drag densities that match "
    "the statements."
)


def candidates_table(candidates: Path) -> str:
    """Step: what was stated, how many bearings fit it, and each of those, as Markdown."""
    found = loaded(candidates, candidate=())
    stated = json.loads(found.attrs["statements"]).items()
    count = np.bincount(found["fit_result"].values, minlength=len(FIT_RESULTS)).tolist()
    results = [*zip(map(in_words, FIT_RESULTS), count, strict=True)]
    blocks = (
        points_block("", {"statement": "", "value": ""}, [(in_words(k), v) for k, v in stated]),
        points_block("", {"result": "", "candidates": ""}, results),
        _fits(found),
    )
    message = f"{candidates_message(found)}. A fit to a text is not a validation."
    return as_markdown(
        Document(("Bearings that match the statements in the paper", message), blocks=blocks)
    )


def _fits(found: xr.Dataset) -> Block:
    """A line for each bearing that fits."""
    fits, basis = fitting(found), counted(found)
    columns = [(fits[n], "") for n in CANDIDATE if n not in ("fit_result", "skid_ratio", "life")]
    columns.append((fits["skid_ratio"].assign_attrs(shown="%"), ""))
    worn = [in_words(parts).replace("ball", "balls") for parts in COUNTS]
    columns += [
        (one["life"].isel(loss_basis=c), f"{in_words(name)}, wear of {worn[c]}")
        for c in (basis, 1 - basis)
        for name, one in methods(fits)
    ]
    return table_of(fits, ("candidate",), columns, lines=(_SKID_NOTE,))
