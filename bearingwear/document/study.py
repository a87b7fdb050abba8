"""The sheet of a file of several cases or lives, and the spread of its lives."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bearingwear.document.document import VARIABLES, Block, Document, Row, quantity_row
from bearingwear.document.rows import counted_words, film_lines, values
from bearingwear.kernels.status import STATUS_NAMES
from bearingwear.results.kinds import LIFE_KIND, STUDY_KIND, WEAR_LIFE_KIND, kind_of
from bearingwear.results.quantiles import (
    BY_WEAR,
    GIVEN,
    KIND,
    NO_QUANTILES,
    PRELOAD_CHOICE,
    RECOMMENDED,
    SEE,
    TAKEN,
    band_by_wear,
    causes_told,
    spread_of,
    uncertainties_at,
)
from bearingwear.results.units import Rough, display

MOST_LISTED = 8
"""Values of a coordinate that are listed; of more, the first and the last are."""

STUDY_RANGES = ("total_qv", "residual_preload", "axial_stiffness", "shaft_torque", "life")


def several(file: Any) -> Document:
    """The sheet of a file with more than one case or life in it."""
    title = str(getattr(file, "title", "study"))
    points = tuple(
        Row(name, "", (dim.size,), note=_along(file, name)) for name, dim in file.dimensions.items()
    )
    blocks = [Block("dimension", ("points",), points)]
    if "status" in file.variables:
        blocks.append(Block("status", ("cases",), tuple(_statuses(file))))
    is_study = kind_of(file) in (STUDY_KIND, WEAR_LIFE_KIND)
    names = [n for n in STUDY_RANGES if n in file.variables] if is_study else _numbers_in(file)
    if names:
        ranges = tuple(_range_row(file, name) for name in names)
        blocks.append(Block("variable", ("least", "most"), ranges))
    return Document((title,), {"kind": kind_of(file), "title": title}, (*blocks, *_lives(file)))


def _statuses(file: Any) -> Iterator[Row]:
    """How many cases have each status; one that none has says why there was nothing to solve."""
    codes, counts = np.unique(values(file, "status"), return_counts=True)
    missing = str(getattr(file["status"], "missing", "-1: nothing to solve"))
    for code, count in zip(codes, counts, strict=True):
        name = "not solved"
        if np.isfinite(code):
            name = STATUS_NAMES[int(code)] if code >= 0 else missing.partition(": ")[2]
        yield Row(name, "", (int(count),), f"status.{name}")


def _range_row(file: Any, name: str) -> Row:
    """Least and most of a variable, in the unit that both are shown in."""
    found = values(file, name)
    solved = found[np.isfinite(found)]
    ends = (float(solved.min()), float(solved.max())) if solved.size else (np.nan, np.nan)
    known = VARIABLES.get(name)
    units = str(getattr(file[name], "units", ""))
    unit = display(units, *ends, shown=known.shown if known and known.units == units else "")
    return Row(name, unit.unit, tuple(unit.of(end) for end in ends), name)


def quantile_blocks(file: Any, path: Path) -> list[Block]:
    """The spread of the lives of a file, from itself or from files of uncertainty beside it."""
    lives = list(_lives_with_quantiles(file)) if hasattr(file, "scene") else []
    if not lives:
        unknown = f"{NO_QUANTILES}; {SEE}"
        return [Block("", lines=(unknown,))] if "life" in file.variables else []
    known, scene = uncertainties_at(path), json.loads(file.scene)
    blocks: list[Block] = []
    for label, method, friction, choice in lives:
        if spread := spread_of(known, scene, method, friction, choice):
            title = ": ".join(filter(None, ("spread in life", label)))
            blocks.append(Block(title, (), tuple(spread_rows([spread.rows]))))
    missing = len(lives) - len(blocks)
    where = f" for the other {missing}" if blocks else ""
    taken = dict.fromkeys(one.attrs[TAKEN] for one in known if TAKEN in one.attrs)
    lines = [*filter(None, [causes_told(scene)]), *taken] if blocks else []
    lines += [f"{NO_QUANTILES}{where}; {SEE}"] if missing else []
    lines += film_lines(scene) if kind_of(file) != LIFE_KIND else []  # its own sheet has it
    return [*blocks, *([Block(lines=tuple(lines))] if lines else [])]


def spread_rows(spreads: Sequence[Mapping[str, Any]]) -> list[Row]:
    """A row for each of `Spread.rows`, of several lives."""
    return [
        Row(name, "h", tuple(rough_value(one.get(name)) for one in spreads), _life_name(name))
        for name in dict.fromkeys(name for one in spreads for name in one)
    ]


def by_wear_row(scene: Mapping[str, Any], lives: Iterable[float]) -> tuple[Row, ...]:
    """Between which hours lives lie by what is unknown of wear alone, if that is stated."""
    bands = [band_by_wear(scene, life)[0] for life in lives]
    values = tuple(band or math.nan for band in bands)
    return (Row(BY_WEAR, "h", values, "life_by_wear_alone"),) if any(bands) else ()


def rough_value(value: Any) -> Any:
    """Hours as two digits; other cells as they are."""
    value = math.nan if value is None else value
    return Rough(value) if isinstance(value, float) else value


def _life_name(label: str) -> str:
    """`life_90_percent_of_bearings`, for programs."""
    return f"life_{label.strip()}".replace("%", "percent").replace(" ", "_")


def _lives_with_quantiles(file: Any) -> Iterator[tuple[str, str, float | None, int]]:
    """Label, preload method, friction and choice of preload of each life that may have L10.

    A film has no one friction.
    """
    kind = kind_of(file)
    if kind == LIFE_KIND:
        scene = json.loads(file.scene)
        yield "", scene["operation"]["preload_method"], scene["friction"].get("ball_race"), GIVEN
    elif kind == "recommendation" or (kind == KIND and PRELOAD_CHOICE in file.variables):
        mu = json.loads(file.scene)["friction"].get("ball_race")
        for method in _methods(file):
            for choice in values(file, PRELOAD_CHOICE) if kind == KIND else (RECOMMENDED,):
                where = "own" if choice == GIVEN else "recommended"
                yield f"{method}, {where}", method, mu, choice
    elif _has_lives(file):
        for method in _methods(file):
            for mu in values(file, "friction"):
                yield f"{method}, mu {mu:g}", method, float(mu), GIVEN


def _methods(file: Any) -> list[str]:
    """The preload methods along the dimension of that name."""
    names = file["preload_method"].flag_meanings.split()
    return [names[int(flag)] for flag in values(file, "preload_method")]


def _along(file: Any, name: str) -> str:
    """The values of a coordinate, or the first and the last where they are many."""
    if name not in file.variables or file[name].dimensions != (name,):
        return ""
    flags = str(getattr(file[name], "flag_meanings", "")).split()
    texts = [flags[int(v)] if flags else f"{v:g}" for v in values(file, name)]
    unit = str(getattr(file[name], "units", "")).replace("1", "", 1)
    listed = ", ".join(texts) if len(texts) <= MOST_LISTED else f"{texts[0]} to {texts[-1]}"
    return f"{listed} {unit}".rstrip()


def _numbers_in(file: Any) -> list[str]:
    """Variables with numbers that are no coordinates and no flags."""
    return [
        name
        for name, variable in file.variables.items()
        if name not in file.dimensions
        and variable.dtype is not str
        and "flag_values" not in variable.ncattrs()
        and name != "status"
    ]


def _has_lives(file: Any) -> bool:
    axes = ("preload_method", "friction")
    return "end_criterion" in file.variables and file["end_criterion"].dimensions == axes


def _lives(file: Any) -> list[Block]:
    """Each life of a file that has them over preload method and friction."""
    if not _has_lives(file):
        return []
    ends = file["end_criterion"].flag_meanings.split()
    criteria = values(file, "end_criterion").ravel()
    methods, frictions = _methods(file), values(file, "friction").tolist()
    points = list(itertools.product(methods, frictions))
    words = counted_words(json.loads(getattr(file, "scene", "{}")))
    met = tuple(ends[int(end)] if np.isfinite(end) else ends[-1] for end in criteria)
    rows = (
        Row("preload method", "", tuple(method for method, _ in points), "preload_method"),
        Row("friction", "", tuple(mu for _, mu in points), "friction", given=True),
        quantity_row(f"life, wear of {words}", "h", values(file, "life").ravel(), "life"),
        quantity_row("loss", "m", values(file, "loss_at_end").ravel(), "loss_at_end"),
        Row("ended by", "", met, "end_criterion"),
    )
    return [Block("lives", rows=rows, axes=2)]
