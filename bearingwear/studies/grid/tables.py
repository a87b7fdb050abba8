"""The numbers of a study as a CSV table, and the few that matter as Markdown."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import xarray as xr

from bearingwear.document.document import Block, Document
from bearingwear.document.markdown import as_markdown
from bearingwear.document.table import dataset_csv, dataset_table
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.measures import ENDS
from bearingwear.results.pair_variables import method_words
from bearingwear.results.quantiles import (
    load_quantiles,
)
from bearingwear.results.units import display
from bearingwear.results.variables import of_all_balls
from bearingwear.results.words import datasets_by_bearing, in_words, methods, scene_of
from bearingwear.studies.dataset import loaded
from bearingwear.studies.grid.answer import lives_block, lives_of
from bearingwear.studies.grid.interpolated import NOT_INTERPOLATED

_LOSS = display("m")
AXES = {
    "preload_method": "preload_method",
    "friction": "friction",
    "ball_diameter_loss": "ball_diameter_loss (um)",
}
"""Dimensions of cases, and the heads of their columns."""

_WEAR = {
    "total_qv": "qv_error_estimate",
    "residual_preload": "residual_preload_error_estimate",
}
"""Numbers of the table of wear, and the estimates of their relative errors."""


def study_tables(study: Path, lives: Path, uncertainty: Sequence[Path] = ()) -> tuple[str, str]:
    """Step: the numbers of a scene as CSV, and the few that matter as Markdown."""
    cases = loaded(study, ball_diameter_loss=())
    known = [one for path in uncertainty for one in load_quantiles(path)]
    return cases_csv(cases), study_summary(cases, loaded(lives, interpolated_step=()), known)


def cases_csv(study: xr.Dataset) -> str:
    """A row for each case and a column for each number, with its unit in the header, as CSV.

    A variable over race or axis has a column for each of them; over balls, the mean or the
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
    """Effect of wear on QV and preload, the wear life, and what could not be solved, as Markdown.

    `known` are files of the study of uncertainty, if there are any. The description of the scene is
    left to the page: it makes no result anew.
    """
    scene = scene_of(study)
    unsolved = tuple(unsolved_cases(study)) or ("None: every case was solved and verified.",)
    table = lives_block("Wear life", lives_of(lives, known), scene, every=True)
    table = replace(table, lines=(*table.lines, *filter(None, [_not_compared(lives)])))
    blocks = (_wear(study), table, Block("Not solved", lines=unsolved))
    return as_markdown(Document((scene["name"],), blocks=blocks))


def _wear(study: xr.Dataset) -> Block:
    """QV and residual preload at the first and the last loss."""
    ends = datasets_by_bearing(study.isel(ball_diameter_loss=[0, -1]))
    columns = [
        (one[name].isel(ball_diameter_loss=k), f"{words}at {float(loss):g} µm")
        for words, one in [(f"{which} bearing, " if which else "", ends[which]) for which in ends]
        for name in _WEAR
        for k, loss in enumerate(one["ball_diameter_loss"])
    ]
    errors = [
        one[error].isel(ball_diameter_loss=k) if error in one else None
        for one in ends.values()
        for error in _WEAR.values()
        for k in range(one.sizes["ball_diameter_loss"])
    ]
    said = ("QV values are for the whole bearing.",)
    return dataset_table(
        study, ("preload_method", "friction"), columns, "Effect of wear", said, errors
    )


def _not_compared(lives: xr.Dataset) -> str:
    """Why some lives have no interpolated one beside them."""
    unknown = [ENDS[name].words for name in json.loads(lives.attrs.get(NOT_INTERPOLATED, "[]"))]
    said = []
    if bool(lives["life_route_difference"].isnull().any()):
        said.append(
            "A dash marks a life that cannot be interpolated between the cases. Such a life was "
            "computed with worn grooves, over a duty or for two different bearings, or the cases "
            "do not contain its end-of-life criterion."
        )
    if unknown:
        said.append(f"Criteria that the cases do not contain: {', '.join(unknown)}.")
    return " ".join(said)


def cases_in_words(study: xr.Dataset) -> Iterator[tuple[str, dict[str, int]]]:
    """Each case in words and its place in the grid."""
    scene = scene_of(study)
    for i, (name, _) in enumerate(methods(study)):
        words = method_words(scene, name)
        for j, mu in enumerate(study["friction"].values):
            for k, loss in enumerate(study["ball_diameter_loss"].values):
                place = dict(zip(AXES, (i, j, k), strict=True))
                yield f"{words}, friction {mu:g}, loss {loss:g} µm", place


def unsolved_cases(study: xr.Dataset, status: str = "status", model: str = "") -> Iterator[str]:
    """Cases whose status is not good, and that status."""
    for case, place in cases_in_words(study):
        code = int(study[status][place])
        if code != OK:
            yield f"{case}{model}: {in_words(STATUS_NAMES[code])}"
