"""Tables that compare cases solved with the dynamic model with the steady ones."""

from collections.abc import Hashable, Iterator
from pathlib import Path

import xarray as xr

from bearingwear.document.document import Block, Document
from bearingwear.document.markdown import as_markdown
from bearingwear.document.table import dataset_table
from bearingwear.measures import plain
from bearingwear.results.variables import RACES
from bearingwear.results.words import plain_scene
from bearingwear.studies.dataset import load_with_dynamic
from bearingwear.studies.grid.tables import (
    AXES,
    cases_csv,
    cases_in_words,
    over_all_balls,
    unsolved_cases,
)

_MODELS = ("steady", "dynamic")
ALL_SOLVED = "None: every case was solved and verified with both models."
WEAR_LINE = "Means over all balls."
WEAR_LINE_WITH_CAGE = (
    "Means over all balls. Dynamic cases include wear in the cage pockets. If the land does not "
    "wear, the cage did not touch it during the averaged turns."
)
LARGEST_DRIFT = 0.02
"""Largest relative drift over the averaged turns at which a mean counts as settled."""


def steady_and_dynamic(study: xr.Dataset, dynamic: xr.Dataset) -> xr.Dataset:
    """Returns the cases of `dynamic` solved with both models: `NAME.steady` and `NAME.dynamic`.

    Variables over balls become means or extremes over all balls. Those without a steady value keep
    their names; those without a dynamic value are left out. Attributes are those of `dynamic`.

    study: steady cases, which contain every case of `dynamic`.
    """
    steady_cases = over_all_balls(study.sel({axis: dynamic[axis] for axis in AXES}))
    dynamic_cases = over_all_balls(dynamic)
    variables: dict[Hashable, xr.DataArray] = {}
    for name, variable in dynamic_cases.data_vars.items():
        if name in steady_cases:
            variables[f"{name}.steady"] = steady_cases[name]
            variables[f"{name}.dynamic"] = variable
    variables |= {
        name: variable
        for name, variable in dynamic_cases.data_vars.items()
        if name not in steady_cases
    }
    return xr.Dataset(variables, attrs=dynamic.attrs)


def dynamic_comparison(study: Path, dynamic: Path) -> tuple[str, str]:
    """Step: returns all numbers of both models as CSV, and the main ones as Markdown.

    CaseFileError: the files do not belong together.

    study: file of steady cases, which contains every case of `dynamic`.
    """
    steady_cases, dynamic_cases = load_with_dynamic(study, dynamic)
    solved = steady_and_dynamic(steady_cases, dynamic_cases)
    return cases_csv(solved), _comparison_markdown(solved)


def _comparison_markdown(solved: xr.Dataset) -> str:
    """Returns the main numbers of cases solved with both models, as Markdown.

    solved: of `steady_and_dynamic`.
    """
    unsolved = tuple(
        line
        for model in _MODELS
        for line in unsolved_cases(solved, f"status.{model}", f", {model}")
    )
    blocks = (
        _preload_table(solved),
        _wear_table(solved),
        _drift_table(solved),
        Block("Not solved", lines=unsolved or (ALL_SOLVED,)),
    )
    title = f"{plain_scene(solved)['name']}: dynamic solution compared with the steady state"
    return as_markdown(Document((title,), blocks=blocks))


def _preload_table(solved: xr.Dataset) -> Block:
    """Returns a table of QV, its difference between the models, and residual preload.

    solved: cases by both models; see `steady_and_dynamic`.
    """
    change = (solved["total_qv.dynamic"] / solved["total_qv.steady"] - 1.0).rename("total_qv")
    change.attrs = {"units": "1", "shown": "%"}
    columns: list[tuple[xr.DataArray | str, str]] = [
        *((f"total_qv.{model}", model) for model in _MODELS),
        (change, "relative difference, dynamic versus steady"),
        *((f"residual_preload.{model}", model) for model in _MODELS),
    ]
    lines = ("QV values are for the whole bearing.",)
    return dataset_table(solved, [*AXES], columns, "QV and preload", lines)


def _wear_table(solved: xr.Dataset) -> Block:
    """Returns a table of the wear rates of balls, races and, if there is one, cage.

    solved: cases by both models; see `steady_and_dynamic`.
    """
    columns: list[tuple[xr.DataArray | str, str]]
    columns = [(f"ball_wear_rate.{model}", model) for model in _MODELS]
    columns += [
        (solved[f"race_wear_rate.{model}"].isel(race=k), f"{race}, {model}")
        for k, race in enumerate(RACES)
        for model in _MODELS
    ]
    columns += [(name, "") for name in ("cage_wear_rate", "cage_land_wear_rate") if name in solved]
    line = WEAR_LINE_WITH_CAGE if "cage_wear_rate" in solved else WEAR_LINE
    return dataset_table(solved, [*AXES], columns, "Wear rates", (line,))


def _drift_table(solved: xr.Dataset) -> Block:
    """Returns a table of the turns and of the drift of the means, with a line on large drifts.

    solved: cases by both models; see `steady_and_dynamic`.
    """
    names = ("simulated_turns", "evaluated_turns", "qv_drift_per_turn", "wear_rate_drift_per_turn")
    columns = [(name, "") for name in names if name in solved]
    settled = f"No mean drifts by more than {100 * LARGEST_DRIFT:g} % over the averaged turns."
    lines = tuple(_drift_lines(solved)) or (settled,)
    return dataset_table(solved, [*AXES], columns, "Convergence of the means", lines)


def _drift_lines(solved: xr.Dataset) -> Iterator[str]:
    """Yields a line for each case and mean that drifts by more than `LARGEST_DRIFT`.

    The drift is the relative one per turn times the averaged turns, in either direction. Cases that
    were not solved have none.

    solved: cases by both models; see `steady_and_dynamic`.
    """
    drift_names = {"QV": "qv_drift_per_turn", "the total wear rate": "wear_rate_drift_per_turn"}
    for quantity, name in drift_names.items():
        if name not in solved:
            continue
        drift = solved[name] * solved["evaluated_turns"]
        for case, index in cases_in_words(solved):
            case_drift = float(drift[index])
            if abs(case_drift) > LARGEST_DRIFT:
                percent = f"{plain(100.0 * case_drift, 2, '+')} %"
                yield f"{case}: {quantity} still drifts by {percent} over the averaged turns"
