"""The tables that set cases solved dynamically beside the steady ones."""

from collections.abc import Iterator
from pathlib import Path

import xarray as xr

from bearingwear.document.document import Block, Document
from bearingwear.document.markdown import as_markdown
from bearingwear.document.table import dataset_table
from bearingwear.measures import plain
from bearingwear.results.variables import RACES
from bearingwear.results.words import scene_of
from bearingwear.studies.dataset import both_ways
from bearingwear.studies.grid.tables import (
    AXES,
    cases_csv,
    cases_in_words,
    over_all_balls,
    unsolved_cases,
)

WAYS = ("steady", "dynamic")
ALL_SOLVED = "None: every case was solved and verified with both models."
WEAR_WORDS = (
    "Means over all balls.",
    "Means over all balls. Dynamic cases include wear in the cage pockets. If the land does not "
    "wear, the cage did not touch it during the averaged turns.",
)
"""Without a cage, and with one."""
LARGEST_DRIFT = 0.02  # of a mean over the turns it is taken of; beyond, it is not settled


def steady_and_dynamic(study: xr.Dataset, dynamic: xr.Dataset) -> xr.Dataset:
    """The cases of `dynamic` as solved both ways: `NAME.steady` and `NAME.dynamic`.

    Over balls, the mean or the extreme; what only one of them has keeps its name.
    """
    one = over_all_balls(study.sel({axis: dynamic[axis] for axis in AXES}))
    other = over_all_balls(dynamic)
    shared = [name for name in other.data_vars if name in one]
    solved = {
        f"{name}.{way}": found[name]
        for name in shared
        for way, found in (("steady", one), ("dynamic", other))
    }
    alone = {name: v for name, v in other.data_vars.items() if name not in shared}
    return xr.Dataset(solved | alone, attrs=dynamic.attrs)


def comparison(study: Path, dynamic: Path) -> tuple[str, str]:
    """Step: every number of both as CSV, and the few that matter as Markdown."""
    solved = steady_and_dynamic(*both_ways(study, dynamic))
    return cases_csv(solved), _text(solved)


def _text(solved: xr.Dataset) -> str:
    change = (solved["total_qv.dynamic"] / solved["total_qv.steady"] - 1.0).rename("total_qv")
    change.attrs = {"units": "1", "shown": "%"}
    wear: list[tuple[xr.DataArray | str, str]]
    wear = [(f"ball_wear_rate.{way}", way) for way in WAYS]
    wear += [
        (solved[f"race_wear_rate.{way}"].isel(race=k), f"{race}, {way}")
        for k, race in enumerate(RACES)
        for way in WAYS
    ]
    wear += [(name, "") for name in ("cage_wear_rate", "cage_land_wear_rate") if name in solved]
    drift = ("simulated_turns", "evaluated_turns", "qv_drift_per_turn", "wear_rate_drift_per_turn")
    still = f"No mean drifts by more than {100 * LARGEST_DRIFT:g} % over the averaged turns."
    unsolved = tuple(
        line for way in WAYS for line in unsolved_cases(solved, f"status.{way}", f", {way}")
    )
    blocks = (
        dataset_table(
            solved,
            [*AXES],
            [
                *((f"total_qv.{way}", way) for way in WAYS),
                (change, "relative difference, dynamic versus steady"),
                *((f"residual_preload.{way}", way) for way in WAYS),
            ],
            "QV and preload",
            ("QV values are for the whole bearing.",),
        ),
        dataset_table(
            solved, [*AXES], wear, "Wear rates", (WEAR_WORDS["cage_wear_rate" in solved],)
        ),
        dataset_table(
            solved,
            [*AXES],
            [(name, "") for name in drift if name in solved],
            "Convergence of the means",
            tuple(_unsettled(solved)) or (still,),
        ),
        Block("Not solved", lines=unsolved or (ALL_SOLVED,)),
    )
    title = f"{scene_of(solved)['name']}: dynamic solution compared with the steady state"
    return as_markdown(Document((title,), blocks=blocks))


def _unsettled(solved: xr.Dataset) -> Iterator[str]:
    drifts = {"QV": "qv_drift_per_turn", "the total wear rate": "wear_rate_drift_per_turn"}
    for what, name in drifts.items():
        if name in solved:
            drift = solved[name] * solved["evaluated_turns"]
            for case, index in cases_in_words(solved):
                if abs(change := float(drift[index])) > LARGEST_DRIFT:
                    change_text = f"{plain(100.0 * change, 2, '+')} %"
                    yield f"{case}: {what} still drifts by {change_text} over the averaged turns"
