"""Tables of a study: all numbers as CSV, and the main ones as Markdown."""

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
from bearingwear.results.quantiles import load_quantiles
from bearingwear.results.variables import of_all_balls
from bearingwear.results.words import datasets_by_bearing, methods, name_in_words, plain_scene
from bearingwear.studies.dataset import load_with_axes
from bearingwear.studies.grid.answer import detailed_lives_block, lives_of
from bearingwear.studies.grid.interpolated import NOT_INTERPOLATED

AXES = {
    "preload_method": "preload_method",
    "friction": "friction",
    "ball_diameter_loss": "ball_diameter_loss (um)",
}
"""Head of the column of each dimension of the cases."""

_WEAR = {
    "total_qv": "qv_error_estimate",
    "residual_preload": "residual_preload_error_estimate",
}
"""Variables in the table of wear, and the estimates of their relative errors."""


def study_tables(study: Path, lives: Path, uncertainty: Sequence[Path] = ()) -> tuple[str, str]:
    """Step: returns the numbers of a study of one scene as CSV, and the main ones as Markdown.

    study, lives: files of `gathered_study` and `study_life`.
    uncertainty: files of the study of uncertainty.
    """
    cases = load_with_axes(study, ball_diameter_loss=())
    uncertainties = [dataset for path in uncertainty for dataset in load_quantiles(path)]
    life_dataset = load_with_axes(lives, interpolated_step=())
    return cases_csv(cases), study_summary(cases, life_dataset, uncertainties)


def cases_csv(study: xr.Dataset) -> str:
    """Returns CSV with a row for each case and a column for each number.

    A variable over races or axes has a column for each of these; one over balls has a column for
    its mean or extreme.
    """
    return dataset_csv(over_all_balls(study), AXES)


def over_all_balls(dataset: xr.Dataset) -> xr.Dataset:
    """Returns a dataset without the dimension `ball`: means or extremes, and flags of ball 1.

    A variable of an extreme, such as the maximum pressure, becomes the extreme over all balls.
    """

    def without_balls(variable: xr.DataArray) -> xr.DataArray:
        """Returns a variable without the dimension `ball`."""
        if "ball" not in variable.dims:
            return variable
        if "flag_meanings" in variable.attrs:
            return variable.isel(ball=0)
        return of_all_balls(str(variable.name), variable, "ball")

    return dataset.map(without_balls, keep_attrs=True).drop_vars("ball", errors="ignore")


def study_summary(
    study: xr.Dataset, lives: xr.Dataset, uncertainties: Sequence[xr.Dataset] = ()
) -> str:
    """Returns the effect of wear, the wear lives, and the unsolved cases, as Markdown.

    The description of the scene is only on the page: a change of it leaves the summary valid.

    uncertainties: datasets of the study of uncertainty.
    """
    scene = plain_scene(study)
    unsolved = tuple(unsolved_cases(study)) or ("None: every case was solved and verified.",)
    lives_table = detailed_lives_block("Wear life", lives_of(lives, uncertainties), scene)
    lives_table = replace(lives_table, lines=(*lives_table.lines, *_interpolation_lines(lives)))
    blocks = (_wear_block(study), lives_table, Block("Not solved", lines=unsolved))
    return as_markdown(Document((scene["name"],), blocks=blocks))


def _wear_block(study: xr.Dataset) -> Block:
    """Returns a table of QV and residual preload at the first and the last loss, for each bearing.

    Numbers have as many digits as their error estimates allow, where there are any.

    study: cases over preload method, friction and loss.
    """
    columns: list[tuple[xr.DataArray | str, str]] = []
    errors = []
    for bearing, cases in datasets_by_bearing(study.isel(ball_diameter_loss=[0, -1])).items():
        prefix = f"{bearing} bearing, " if bearing else ""
        for name, error in _WEAR.items():
            for k, loss in enumerate(cases["ball_diameter_loss"]):
                words = f"{prefix}at {float(loss):g} µm"
                columns.append((cases[name].isel(ball_diameter_loss=k), words))
                errors.append(cases[error].isel(ball_diameter_loss=k) if error in cases else None)
    return dataset_table(
        study,
        axes=("preload_method", "friction"),
        columns=columns,
        title="Effect of wear",
        lines=("QV values are for the whole bearing.",),
        errors=errors,
    )


def _interpolation_lines(lives: xr.Dataset) -> list[str]:
    """Returns a line on why some lives cannot be interpolated; no line if all can.

    The line also names the criteria of the scene that the cases of the study do not contain.

    lives: dataset of `grid.life.wear_life`.
    """
    missing_criteria = [
        ENDS[name].words for name in json.loads(lives.attrs.get(NOT_INTERPOLATED, "[]"))
    ]
    sentences = []
    if bool(lives["life_route_difference"].isnull().any()):
        sentences.append(
            "A dash marks a life that cannot be interpolated between the cases. Such a life was "
            "computed with worn grooves or for two different bearings, or the cases do not contain "
            "its end-of-life criterion."
        )
    if missing_criteria:
        sentences.append(f"Criteria that the cases do not contain: {', '.join(missing_criteria)}.")
    return [" ".join(sentences)] if sentences else []


def cases_in_words(study: xr.Dataset) -> Iterator[tuple[str, dict[str, int]]]:
    """Yields each case in words, and its index along each dimension of the grid."""
    scene = plain_scene(study)
    for i, (name, _) in enumerate(methods(study)):
        words = method_words(scene, name)
        for j, mu in enumerate(study["friction"].values):
            for k, loss in enumerate(study["ball_diameter_loss"].values):
                index = dict(zip(AXES, (i, j, k), strict=True))
                yield f"{words}, friction {mu:g}, loss {loss:g} µm", index


def unsolved_cases(study: xr.Dataset, status: str = "status", model: str = "") -> Iterator[str]:
    """Yields a line for each case that was not solved, with its status.

    status: name of its variable.
    model: words that follow the case.
    """
    for case, index in cases_in_words(study):
        code = int(study[status][index])
        if code != OK:
            yield f"{case}{model}: {name_in_words(STATUS_NAMES[code])}"
