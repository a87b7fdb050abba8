"""Table of lives that were solved with the dynamic model."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.document.document import Block, Document, Row, quantity_row
from bearingwear.document.markdown import as_markdown
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.results.netcdf import CaseFileError
from bearingwear.results.units import key_in_words
from bearingwear.results.words import name_in_words
from bearingwear.studies.dataset import load_with_axes

COLUMN_WORDS = (
    "The error bound allows for the finite wear steps and the scatter between the runs. Ball wear "
    "is the diameter loss of a ball since the start, relative to the mean. The steady life is "
    "computed for the same scene under thrust only, without the cage, and with the mean initial "
    "loss on every ball."
)


def lives_table(lives: Sequence[Path]) -> str:
    """Step: lives by the names of their files, beside the steady ones, as Markdown."""
    found = [dynamic_life(path) for path in lives]
    steady = [
        criterion(one, "steady_end_criterion") if "steady_life" in one else "–" for one in found
    ]
    rows = (
        Row("name", "", tuple(path.stem for path in lives)),
        quantity_row("life", "h", [_number(one, "life") for one in found]),
        quantity_row("error bound", "h", [_number(one, "life_error_bound") for one in found]),
        Row("ended by", "", tuple(map(ended_by, found))),
        quantity_row("steady life", "h", [_number(one, "steady_life") for one in found]),
        Row("steady life ended by", "", tuple(steady)),
        quantity_row(
            "time to reach the same loss, steady model",
            "h",
            [_number(one, "steady_time_to_loss") for one in found],
        ),
        quantity_row("loss", "m", [_number(one, "loss_at_end") for one in found]),
        *(
            Row(f"ball wear, {word}", "", tuple(_share(one, word) for one in found))
            for word in ("least", "most")
        ),
        *(
            quantity_row(f"wear, {part}", "m3", [_worn(one, part) for one in found])
            for part in ("pocket", "land")
        ),
    )
    block = Block(rows=rows, axes=1, lines=(COLUMN_WORDS,))
    return as_markdown(Document(("Wear life according to the dynamic model",), blocks=(block,)))


def _number(life: xr.Dataset, name: str) -> float:
    return float(life[name]) if name in life else math.nan


def _share(life: xr.Dataset, word: str) -> float:
    """What the ball that wears least or most has lost, over the mean."""
    if "history_ball_worn_volume" not in life:
        return math.nan
    balls = life["history_ball_worn_volume"].values[-1]
    worn = balls.min() if word == "least" else balls.max()
    return float(worn / balls.mean()) if balls.mean() > 0.0 else math.nan


def _worn(life: xr.Dataset, part: str) -> float:
    """Volume that all pockets, or the land, have lost."""
    name = f"history_{part}_worn_volume"
    return float(np.sum(life[name].values[-1])) if name in life else math.nan


def dynamic_life(path: Path) -> xr.Dataset:
    """A life file of fidelity dynamic. Raises CaseFileError."""
    life = load_with_axes(path)
    if life.attrs.get("fidelity") != "dynamic" or "end_criterion" not in life:
        raise CaseFileError(f"{path}: not a life file from the dynamic model")
    return life


def ended_by(life: xr.Dataset) -> str:
    """Criterion that ended a life, in words; otherwise the status."""
    status = int(life["status"])
    return criterion(life, "end_criterion") if status == OK else name_in_words(STATUS_NAMES[status])


def criterion(life: xr.Dataset, name: str) -> str:
    """A criterion of a life in words, without its unit."""
    met = life[name].attrs["flag_meanings"].split()[int(life[name])]
    return key_in_words(met)[0]
