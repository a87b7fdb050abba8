"""The tables that set cases solved dynamically beside the steady ones."""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.document.markdown import markdown_table
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.plotting.drawing import in_words, methods, scene_of
from bearingwear.results.units import Display, digits, display
from bearingwear.studies.dataset import both_ways
from bearingwear.studies.grid.tables import AXES, cases_csv, over_all_balls

_RATE, _PERCENT = display("m3 s-1"), display("1", shown="%")
LARGEST_DRIFT = 0.02  # of a mean over the turns it is taken of; beyond, it is not settled


def steady_and_dynamic(study: xr.Dataset, dynamic: xr.Dataset) -> xr.Dataset:
    """The cases of `dynamic` as solved both ways: `NAME.steady` and `NAME.dynamic`.

    Over balls, the mean or the extreme; what only one of them has keeps its name.
    """
    one = over_all_balls(study.sel({axis: dynamic[axis] for axis in AXES}))
    other = over_all_balls(dynamic)
    shared = [name for name in other.data_vars if name in one]
    both = {
        f"{name}.{way}": found[name]
        for name in shared
        for way, found in (("steady", one), ("dynamic", other))
    }
    alone = {name: v for name, v in other.data_vars.items() if name not in shared}
    return xr.Dataset(both | alone, attrs=dynamic.attrs)


def comparison(study: Path, dynamic: Path) -> tuple[str, str]:
    """Step: every number of both as CSV, and the few that matter as Markdown."""
    both = steady_and_dynamic(*both_ways(study, dynamic))
    return cases_csv(both), _text(both)


def _text(both: xr.Dataset) -> str:
    power = display("W", both["total_qv.steady"], both["total_qv.dynamic"])
    parts = [
        f"# {scene_of(both)['name']}: solved dynamically, beside the steady state",
        "## QV and preload",
        _table(
            both,
            [
                (f"{power.label('QV')}, steady", _number(both, "total_qv.steady", power)),
                ("dynamic", _number(both, "total_qv.dynamic", power)),
                ("dynamic over steady", _ratio(both, "total_qv")),
                ("residual preload (N), steady", _number(both, "residual_preload.steady")),
                ("dynamic", _number(both, "residual_preload.dynamic")),
            ],
        ),
        "QV is that of the whole bearing.",
        f"## {_RATE.label('Wear rates')}",
        _table(both, _wear_rates(both)),
        "The mean of all balls. Those solved dynamically also wear in the pockets of the cage. "
        "Where the land does not wear, the cage did not reach it in the turns averaged."
        if "cage_wear_rate" in both
        else "The mean of all balls.",
        "## How settled the means are",
        _table(
            both,
            [
                ("turns simulated", _number(both, "simulated_turns")),
                ("averaged over", _number(both, "evaluated_turns")),
                (
                    "drift of QV per turn (%)",
                    _number(both, "qv_drift_per_turn", _PERCENT, form="+z.3f"),
                ),
                (
                    "drift of the wear of all parts per turn (%)",
                    _number(both, "wear_rate_drift_per_turn", _PERCENT, form="+z.3f"),
                ),
            ],
        ),
        "\n".join(_unsettled(both))
        or f"No mean drifts by more than {100 * LARGEST_DRIFT:g} % over the turns averaged.",
        "## Not solved",
        "\n".join(_unsolved(both)) or "Nothing: every case was solved and verified both ways.",
    ]
    return "\n\n".join(parts) + "\n"


def _wear_rates(both: xr.Dataset) -> list[tuple[str, Callable]]:
    """Columns of the wear of each part, both ways."""
    ways = (("steady", ".steady"), ("dynamic", ".dynamic"))
    parts: list[tuple[str, str, str, int | None]]
    parts = [(f"one ball, {words}", "ball_wear_rate", way, None) for words, way in ways]
    parts += [
        (f"{race} race, {words}", "race_wear_rate", way, k)
        for k, race in enumerate(("inner", "outer"))
        for words, way in ways
    ]
    parts += [("cage pockets", "cage_wear_rate", "", None)]
    parts += [("cage land", "cage_land_wear_rate", "", None)]
    return [
        (label, _number(both, name + way, _RATE, race))
        for label, name, way, race in parts
        if name + way in both
    ]


def _table(both: xr.Dataset, columns: list[tuple[str, Callable]]) -> str:
    """A row for each case; a column from a function of its place in the grid."""
    header = " | ".join(["preload method", "friction", "loss (µm)", *(name for name, _ in columns)])
    return markdown_table(
        header,
        [[*words, *(text(index) for _, text in columns)] for words, index in _points(both)],
    )


def _points(both: xr.Dataset) -> Iterator[tuple[list[str], tuple[int, ...]]]:
    """Each case in words and its place in the grid."""
    for i, (name, _) in enumerate(methods(both)):
        for j, mu in enumerate(both["friction"].values):
            for k, loss in enumerate(both["ball_diameter_loss"].values):
                yield [in_words(name), f"{mu:g}", f"{loss:g}"], (i, j, k)


def _number(
    both: xr.Dataset,
    name: str,
    unit: Display | None = None,
    race: int | None = None,
    form: str = "",
) -> Callable[[tuple[int, ...]], str]:
    """Text of a variable at a place in the grid, with three digits or in a form; a dash where it
    is not known."""
    if name not in both:
        return lambda index: "–"
    values = both[name] if race is None else both[name].isel(race=race)
    numbers = (unit.of(values) if unit else values).transpose(*AXES).values

    def text(index: tuple[int, ...]) -> str:
        known = form and np.isfinite(numbers[index])
        return f"{numbers[index]:{form}}" if known else digits(numbers[index])

    return text


def _ratio(both: xr.Dataset, name: str) -> Callable[[tuple[int, ...]], str]:
    ratio = both[f"{name}.dynamic"] / both[f"{name}.steady"]
    return _number(xr.Dataset({name: ratio}), name, form=".4f")


def _unsettled(both: xr.Dataset) -> Iterator[str]:
    drifts = {"QV": "qv_drift_per_turn", "the wear of all parts": "wear_rate_drift_per_turn"}
    for what, name in drifts.items():
        if name in both:
            drift = (both[name] * both["evaluated_turns"]).transpose(*AXES).values
            for words, index in _points(both):
                if abs(drift[index]) > LARGEST_DRIFT:
                    case, change = _case_in_words(words), f"{100 * drift[index]:+.2g} %"
                    yield f"- {case}: {what} still drifts by {change} over the turns averaged"


def _unsolved(both: xr.Dataset) -> Iterator[str]:
    for words, index in _points(both):
        for way, said in (("steady", "steady"), ("dynamic", "dynamic")):
            status = int(both[f"status.{way}"].transpose(*AXES).values[index])
            if status != OK:
                yield f"- {_case_in_words(words)}, {said}: {in_words(STATUS_NAMES[status])}"


def _case_in_words(words: list[str]) -> str:
    method, mu, loss = words
    return f"{method}, friction {mu}, loss {loss} µm"
