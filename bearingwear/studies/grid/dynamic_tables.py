"""The tables that set cases solved dynamically beside the steady ones."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.document.document import Block, Document, Row
from bearingwear.document.markdown import as_markdown
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.plotting.drawing import in_words, methods, scene_of
from bearingwear.results.units import Display, display
from bearingwear.results.variables import RACES
from bearingwear.studies.dataset import both_ways
from bearingwear.studies.grid.tables import AXES, cases_csv, over_all_balls

_RATE, _PERCENT = display("m3 s-1"), display("1", shown="%")
ALL_SOLVED = "Nothing: every case was solved and verified both ways."
CAGE_WORDS = (
    " Those solved dynamically also wear in the pockets of the cage. Where the land does not wear, "
    "the cage did not reach it in the turns averaged."
)
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
    ratio = _values(both["total_qv.dynamic"] / both["total_qv.steady"])
    preload = display("N")
    of_wear = "The mean of all balls." + CAGE_WORDS * ("cage_wear_rate" in both)
    still = f"No mean drifts by more than {100 * LARGEST_DRIFT:g} % over the turns averaged."
    blocks = (
        _block(
            "QV and preload",
            _row(both, "QV, steady", "total_qv.steady", power),
            _row(both, "dynamic", "total_qv.dynamic", power),
            Row("dynamic over steady", "", tuple(_formed(x, ".4f") for x in ratio)),
            _row(both, "residual preload, steady", "residual_preload.steady", preload),
            _row(both, "dynamic", "residual_preload.dynamic", preload),
            both=both,
            lines=("QV is that of the whole bearing.",),
        ),
        _block("Wear rates", *_wear_rates(both), both=both, lines=(of_wear,)),
        _block(
            "How settled the means are",
            _row(both, "turns simulated", "simulated_turns"),
            _row(both, "averaged over", "evaluated_turns"),
            _row(both, "drift of QV per turn", "qv_drift_per_turn", _PERCENT, form="+z.3f"),
            _row(
                both, "drift of the wear of all parts per turn", "wear_rate_drift_per_turn",
                _PERCENT, form="+z.3f",
            ),
            both=both,
            lines=tuple(_unsettled(both)) or (still,),
        ),
        Block("Not solved", lines=tuple(_unsolved(both)) or (ALL_SOLVED,)),
    )  # fmt: skip
    title = f"{scene_of(both)['name']}: solved dynamically, beside the steady state"
    return as_markdown(Document((title,), blocks=blocks))


def _wear_rates(both: xr.Dataset) -> list[Row]:
    """Wear of each part, both ways."""
    ways = ("steady", "dynamic")
    parts: list[tuple[str, str, int | None]]
    parts = [(f"one ball, {way}", f"ball_wear_rate.{way}", None) for way in ways]
    parts += [
        (f"{race} race, {way}", f"race_wear_rate.{way}", k)
        for k, race in enumerate(RACES)
        for way in ways
    ]
    parts += [("cage pockets", "cage_wear_rate", None), ("cage land", "cage_land_wear_rate", None)]
    return [_row(both, label, name, _RATE, race) for label, name, race in parts if name in both]


def _block(title: str, *rows: Row, both: xr.Dataset, lines: tuple[str, ...]) -> Block:
    """A line for each case."""
    names, mus, losses = zip(*(words for words, _ in _points(both)), strict=True)
    axes = (Row("preload method", "", names), Row("friction", "", mus), Row("loss", "um", losses))
    return Block(title, rows=(*axes, *rows), axes=len(axes), lines=lines)


def _points(both: xr.Dataset) -> Iterator[tuple[list[str], tuple[int, ...]]]:
    """Each case in words and its place in the grid."""
    for i, (name, _) in enumerate(methods(both)):
        for j, mu in enumerate(both["friction"].values):
            for k, loss in enumerate(both["ball_diameter_loss"].values):
                yield [in_words(name), f"{mu:g}", f"{loss:g}"], (i, j, k)


def _row(
    both: xr.Dataset,
    label: str,
    name: str,
    unit: Display | None = None,
    race: int | None = None,
    form: str = "",
) -> Row:
    """A variable in all cases, with three digits or in a form."""
    unit = unit or display("1")
    if name not in both:
        return Row(label, unit.unit, ("–",) * sum(1 for _ in _points(both)), name)
    numbers = _values(unit.of(both[name] if race is None else both[name].isel(race=race)))
    found = tuple(_formed(x, form) for x in numbers) if form else tuple(numbers)
    return Row(label, unit.unit, found, name if race is None else f"{name}.{RACES[race]}")


def _values(variable: xr.DataArray) -> list[float]:
    return variable.transpose(*AXES).values.ravel().tolist()


def _formed(value: float, form: str) -> str:
    return f"{value:{form}}" if np.isfinite(value) else "–"


def _unsettled(both: xr.Dataset) -> Iterator[str]:
    drifts = {"QV": "qv_drift_per_turn", "the wear of all parts": "wear_rate_drift_per_turn"}
    for what, name in drifts.items():
        if name in both:
            drift = (both[name] * both["evaluated_turns"]).transpose(*AXES).values
            for words, index in _points(both):
                if abs(drift[index]) > LARGEST_DRIFT:
                    case, change = _case_in_words(words), f"{100 * drift[index]:+.2g} %"
                    yield f"{case}: {what} still drifts by {change} over the turns averaged"


def _unsolved(both: xr.Dataset) -> Iterator[str]:
    for words, index in _points(both):
        for way in ("steady", "dynamic"):
            status = int(both[f"status.{way}"].transpose(*AXES).values[index])
            if status != OK:
                yield f"{_case_in_words(words)}, {way}: {in_words(STATUS_NAMES[status])}"


def _case_in_words(words: list[str]) -> str:
    method, mu, loss = words
    return f"{method}, friction {mu}, loss {loss} µm"
