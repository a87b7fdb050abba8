"""Table of lives that were solved with the dynamic model."""

import math
from collections.abc import Callable, Sequence
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
    """Step: returns a table of dynamic lives beside the steady ones, as Markdown.

    lives: files, whose names without suffix are the first cells of the lines.
    CaseFileError: a file of another kind.
    """
    datasets = [dynamic_life(path) for path in lives]
    rows = (
        Row("name", "", tuple(path.stem for path in lives)),
        _number_row("life", "h", datasets, "life"),
        _number_row("error bound", "h", datasets, "life_error_bound"),
        Row("ended by", "", tuple(map(ended_by, datasets))),
        _number_row("steady life", "h", datasets, "steady_life"),
        Row("steady life ended by", "", tuple(map(_steady_life_ended_by, datasets))),
        _number_row(
            "time to reach the same loss, steady model", "h", datasets, "steady_time_to_loss"
        ),
        _number_row("loss", "m", datasets, "loss_at_end"),
        Row("ball wear, least", "", tuple(_relative_ball_wear(life, np.min) for life in datasets)),
        Row("ball wear, most", "", tuple(_relative_ball_wear(life, np.max) for life in datasets)),
        *(
            quantity_row(f"wear, {part}", "m3", [_worn_volume(life, part) for life in datasets])
            for part in ("pocket", "land")
        ),
    )
    block = Block(rows=rows, axes=1, lines=(COLUMN_WORDS,))
    return as_markdown(Document(("Wear life according to the dynamic model",), blocks=(block,)))


def _number_row(label: str, unit: str, lives: Sequence[xr.Dataset], name: str) -> Row:
    """Returns the row of a variable of each life; NaN where a life lacks it.

    unit: of the variable in the files.
    """
    numbers = [float(life[name]) if name in life else math.nan for life in lives]
    return quantity_row(label, unit, numbers)


def _relative_ball_wear(life: xr.Dataset, extreme: Callable[[np.ndarray], float]) -> float:
    """Returns an extreme worn volume of the balls at the last step over their mean [1].

    It is NaN for a life without a solved step, or without wear of the balls.

    extreme: `np.min` or `np.max`.
    """
    if "history_ball_worn_volume" not in life:
        return math.nan
    balls = life["history_ball_worn_volume"].values[-1]
    return float(extreme(balls) / balls.mean()) if balls.mean() > 0.0 else math.nan


def _worn_volume(life: xr.Dataset, part: str) -> float:
    """Returns the worn volume of all pockets, or of the land, at the last step [m3].

    It is NaN for a life without a cage.

    part {"pocket", "land"}
    """
    name = f"history_{part}_worn_volume"
    return float(np.sum(life[name].values[-1])) if name in life else math.nan


def dynamic_life(path: Path) -> xr.Dataset:
    """Returns the dataset of a life file of fidelity dynamic. Raises CaseFileError."""
    life = load_with_axes(path)
    if life.attrs.get("fidelity") != "dynamic" or "end_criterion" not in life:
        raise CaseFileError(f"{path}: not a life file from the dynamic model")
    return life


def ended_by(life: xr.Dataset) -> str:
    """Returns in words the criterion that ended a life, or its status if it did not end."""
    status = int(life["status"])
    if status != OK:
        return name_in_words(STATUS_NAMES[status])
    return _criterion_words(life, "end_criterion")


def _steady_life_ended_by(life: xr.Dataset) -> str:
    """Returns in words the criterion that ended the steady life; a dash without a steady life."""
    return _criterion_words(life, "steady_end_criterion") if "steady_life" in life else "–"


def _criterion_words(life: xr.Dataset, variable: str) -> str:
    """Returns the words for the flag of a variable that names a criterion, without its unit."""
    flag_names = life[variable].attrs["flag_meanings"].split()
    words, _ = key_in_words(flag_names[int(life[variable])])
    return words
