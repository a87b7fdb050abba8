"""The numbers of a study as a CSV table, and the few that matter as Markdown."""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.document.document import Block, Document, Row
from bearingwear.document.markdown import as_markdown
from bearingwear.document.table import dataset_csv, table_of
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.measures import ENDS
from bearingwear.plotting.drawing import in_words, methods, scene_of
from bearingwear.results.quantiles import (
    SEE,
    Spreads,
    causes_told,
    load_quantiles,
    spread_text,
    spreads_of,
)
from bearingwear.results.units import display
from bearingwear.results.variables import of_all_balls
from bearingwear.scene.scene import COUNTS
from bearingwear.studies.dataset import loaded
from bearingwear.studies.grid.life import NOT_INTERPOLATED

_LOSS = display("m")
AXES = {
    "preload_method": "preload_method",
    "friction": "friction",
    "ball_diameter_loss": "ball_diameter_loss (um)",
}
"""Dimensions of cases, and the heads of their columns."""


def study_tables(study: Path, lives: Path, uncertainty: Sequence[Path] = ()) -> tuple[str, str]:
    """Step: the numbers of a scene as CSV, and the few that matter as Markdown.

    Parameters
    ----------
    study, lives : path
        Of one scene.
    uncertainty : sequence of path
        How its lives spread, where that is known.
    """
    cases = loaded(study, ball_diameter_loss=())
    known = [load_quantiles(path) for path in uncertainty]
    return cases_csv(cases), study_summary(cases, loaded(lives, interpolated_step=()), known)


def cases_csv(study: xr.Dataset) -> str:
    """A row for each case and a column for each number, with its unit in the header, as CSV.

    A variable over race, axis or counts has a column for each of them; over balls, the mean or the
    extreme.
    """
    return dataset_csv(over_all_balls(study), AXES)


def over_all_balls(dataset: xr.Dataset) -> xr.Dataset:
    """A dataset without its balls: of each number the mean or the extreme, of flags the first."""

    def of_all(variable: xr.DataArray) -> xr.DataArray:
        if "ball" not in variable.dims:
            return variable
        if "flag_meanings" in variable.attrs:
            return variable.isel(ball=0)
        return of_all_balls(str(variable.name), variable, "ball")

    return dataset.map(of_all, keep_attrs=True).drop_vars("ball", errors="ignore")


def study_summary(study: xr.Dataset, lives: xr.Dataset, known: Sequence[xr.Dataset] = ()) -> str:
    """What wear does to QV and preload, the wear life, and what could not be solved, as Markdown.

    `known` are files of the study of uncertainty, if there are any.
    """
    scene = scene_of(study)
    unsolved = tuple(_unsolved(study)) or ("Nothing: every case was solved and verified.",)
    heading = (scene["name"],)
    blocks = (_wear(study), _lives(lives, scene, known), Block("Not solved", lines=unsolved))
    return as_markdown(Document(heading, blocks=blocks))


def _wear(study: xr.Dataset) -> Block:
    """QV and residual preload at the first and the last loss."""
    ends = study.isel(ball_diameter_loss=[0, -1])
    columns = [
        (ends[name].isel(ball_diameter_loss=k), f"at {float(loss):g} µm")
        for name in ("total_qv", "residual_preload")
        for k, loss in enumerate(ends["ball_diameter_loss"])
    ]
    said = ("QV is that of the whole bearing.",)
    return table_of(study, ("preload_method", "friction"), columns, "What wear does", said)


def _lives(lives: xr.Dataset, scene: Mapping[str, Any], known: Sequence[xr.Dataset]) -> Block:
    """Every life, its spread if that is known, and its end."""
    ends = lives["end_criterion"].attrs["flag_meanings"].split()
    points = [
        (name, float(mu), of_method.sel(friction=mu))
        for name, of_method in methods(lives)
        for mu in lives["friction"].values
    ]
    ones = [one for *_, one in points]
    spreads: list[Spreads] = [spreads_of(known, scene, name, mu) or {} for name, mu, _ in points]
    rows = [
        Row("preload method", "", tuple(in_words(name) for name, *_ in points)),
        Row("friction", "", tuple(mu for _, mu, _ in points), given=True),
    ]
    for k, (way, words) in enumerate(zip(COUNTS, ("ball alone", "balls and races"), strict=True)):
        hours = tuple(float(one["life"][k]) for one in ones)
        rows.append(Row(f"life, {words}", "h", hours, f"life.{way}"))
        rows.append(Row("its spread", "", tuple(spread_text(one.get(way)) for one in spreads)))
    routes = (float(one["life_route_difference"][-1]) for one in ones)
    rows += [
        Row("ended by", "", tuple(_end(ends[int(one["end_criterion"])]) for one in ones)),
        Row("at a loss of", "um", tuple(float(_LOSS.of(one["loss_at_end"])) for one in ones)),
        Row("interpolated against solved", "", tuple(map(_percent, routes))),
    ]
    said = (
        _not_compared(lives),
        causes_told(scene) if any(spreads) else "",
        f"Where no spread is computed, {SEE}." if not all(spreads) else "",
    )
    return Block("Wear life", rows=tuple(rows), axes=2, lines=tuple(filter(None, said)))


def _end(name: str) -> str:
    return ENDS[name].words if name in ENDS else name


def _percent(share: float) -> str:
    return f"{round(100.0 * share, 3) + 0.0:+.3f} %" if math.isfinite(share) else "–"


def _not_compared(lives: xr.Dataset) -> str:
    """Why some lives have no interpolated one beside them."""
    unknown = [ENDS[name].words for name in json.loads(lives.attrs.get(NOT_INTERPOLATED, "[]"))]
    said = []
    if bool(lives["life_route_difference"].isnull().any()):
        said.append(
            "A dash: grooves are followed as they wear, which lives interpolated between Hertzian "
            "cases are not, or the life has no end that these cases show."
        )
    if unknown:
        said.append(f"The cases do not hold: {', '.join(unknown)}.")
    return " ".join(said)


def _unsolved(study: xr.Dataset) -> Iterator[str]:
    for name, state in methods(study):
        for index in np.argwhere(state["status"].values != OK):
            one = state["status"][tuple(index)]
            yield (
                f"{in_words(name)}, friction {float(one['friction']):g}, "
                f"loss {float(one['ball_diameter_loss']):g} µm: {in_words(STATUS_NAMES[int(one)])}"
            )
