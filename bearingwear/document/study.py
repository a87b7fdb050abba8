"""The sheet of a file of several cases or lives, and the spread of its lives."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bearingwear.document.document import VARIABLES, Block, Document, Row, quantity_row
from bearingwear.document.rows import caveat_lines, counted_words, stored_scene, variable_values
from bearingwear.kernels.status import STATUS_NAMES
from bearingwear.results.kinds import LIFE_KIND, STUDY_KIND, WEAR_LIFE_KIND, kind_of
from bearingwear.results.pair_variables import method_words
from bearingwear.results.quantiles import (
    ASSUMED_SPREAD,
    BY_WEAR,
    CONFIDENCE,
    GIVEN,
    KIND,
    NO_QUANTILES,
    PRELOAD_CHOICE,
    RECOMMENDED,
    SEE,
    Spread,
    band_by_wear,
    causes_sentence,
    spread_of,
    uncertainties_at,
)
from bearingwear.results.units import Rough, display
from bearingwear.scene.new.minimum_preload import minimum_preload_lines

MOST_LISTED = 8
"""Largest number of values of a coordinate that are all listed."""

QUANTILE_COLUMNS = "quantiles", f"{100 * CONFIDENCE:g} % interval of each, due to sampling"

STUDY_RANGES = ("total_qv", "residual_preload", "axial_stiffness", "shaft_torque", "life")


def study_document(file: Any) -> Document:
    """Returns the sheet of an open file with several cases or lives: dimensions and ranges."""
    title = str(getattr(file, "title", "study"))
    points = tuple(
        Row(name, "", (dimension.size,), note=_coordinate_text(file, name))
        for name, dimension in file.dimensions.items()
    )
    blocks = [Block("dimension", ("points",), points)]
    if "status" in file.variables:
        blocks.append(Block("status", ("cases",), tuple(_status_rows(file))))
    names = _numeric_variables(file)
    if kind_of(file) in (STUDY_KIND, WEAR_LIFE_KIND):
        names = [name for name in STUDY_RANGES if name in file.variables]
    if names:
        ranges = tuple(_range_row(file, name) for name in names)
        blocks.append(Block("variable", ("least", "most"), ranges))
    blocks += _life_blocks(file)
    heading = [title]
    if kind_of(file) == KIND and "preload_N" in stored_scene(file)["operation"]:
        heading += minimum_preload_lines(stored_scene(file))
    return Document(tuple(heading), {"kind": kind_of(file), "title": title}, tuple(blocks))


def _status_rows(file: Any) -> Iterator[Row]:
    """Yields a row with the number of cases of each status, or the reason for having none."""
    codes, counts = np.unique(variable_values(file, "status"), return_counts=True)
    missing = str(getattr(file["status"], "missing", "-1: nothing to solve"))
    for code, count in zip(codes, counts, strict=True):
        name = "not solved"
        if np.isfinite(code):
            name = STATUS_NAMES[int(code)] if code >= 0 else missing.partition(": ")[2]
        yield Row(name, "", (int(count),), f"status.{name}")


def _range_row(file: Any, name: str) -> Row:
    """Returns a row with the smallest and the largest value of a variable; NaN without values."""
    numbers = variable_values(file, name)
    finite = numbers[np.isfinite(numbers)]
    ends = (float(finite.min()), float(finite.max())) if finite.size else (np.nan, np.nan)
    variable = VARIABLES.get(name)
    units = str(getattr(file[name], "units", ""))
    shown = variable.shown if variable and variable.units == units else ""
    unit = display(units, *ends, shown=shown)
    return Row(name, unit.unit, tuple(unit.of(end) for end in ends), name)


def spread_blocks(file: Any, path: Path) -> list[Block]:
    """Returns a block with the spread of each life of an open file, and one of sentences on them.

    path: of the file. The spreads are in it, or in files of uncertainty beside it.
    """
    lives = list(_lives_with_spread(file)) if hasattr(file, "scene") else []
    if not lives:
        unknown = f"{NO_QUANTILES}; {SEE}"
        return [Block("", lines=(unknown,))] if "life" in file.variables else []
    uncertainties, scene = uncertainties_at(path), stored_scene(file)
    blocks: list[Block] = []
    for life in lives:
        spread = spread_of(uncertainties, scene, life.method, life.friction, life.preload_choice)
        if spread:
            title = f"spread in life: {life.label}" if life.label else "spread in life"
            failures = (spread.failures_sentence,) if spread.failures_sentence else ()
            blocks.append(Block(title, QUANTILE_COLUMNS, tuple(_quantile_rows(spread)), failures))
    lines = []
    if blocks:
        assumed = [
            uncertainty.attrs[ASSUMED_SPREAD]
            for uncertainty in uncertainties
            if ASSUMED_SPREAD in uncertainty.attrs
        ]
        lines = [line for line in (causes_sentence(scene), *dict.fromkeys(assumed)) if line]
    if missing := len(lives) - len(blocks):
        remaining = f" for the other {missing}" if blocks else ""
        lines.append(f"{NO_QUANTILES}{remaining}; {SEE}")
    if kind_of(file) != LIFE_KIND:  # the sheet of a life contains these lines already
        lines += caveat_lines(scene)
    return [*blocks, *([Block(lines=tuple(lines))] if lines else [])]


def spread_rows(spreads: Sequence[Spread | None]) -> list[Row]:
    """Returns a row for each label of `Spread.rows`, with a column for each life.

    spreads: of each life; None for a life whose spread was not computed, which has NaN.
    """
    columns = [spread.rows if spread else {} for spread in spreads]
    labels = dict.fromkeys(label for column in columns for label in column)
    return [
        Row(
            label,
            "h",
            tuple(rough_value(column.get(label)) for column in columns),
            _row_name(label),
        )
        for label in labels
    ]


def _quantile_rows(spread: Spread) -> list[Row]:
    """Returns the rows of the spread of one life, with a confidence interval for each value."""
    return [
        row._replace(values=(*row.values, spread.errors[row.label]))
        for row in spread_rows([spread])
    ]


def by_wear_row(scene: Mapping[str, Any], lives: Iterable[float]) -> tuple[Row, ...]:
    """Returns a row with the interval of each life due to uncertain wear alone, NaN if unknown.

    Without any known interval, there is no row.

    scene: plain data.
    lives: [h].
    """
    bands = [band_by_wear(scene, life)[0] for life in lives]
    if not any(bands):
        return ()
    cells = tuple(math.nan if band is None else band for band in bands)
    return (Row(BY_WEAR, "h", cells, "life_by_wear_alone"),)


def rough_value(value: Any) -> Any:
    """Returns a float as a number of two digits, None as NaN, and any other cell unchanged."""
    if value is None:
        return Rough(math.nan)
    return Rough(value) if isinstance(value, float) else value


def _row_name(label: str) -> str:
    """Returns the name for programs of a row, such as `life_90_percent_of_bearings`."""
    return f"life_{label.strip()}".replace("%", "percent").replace(" ", "_")


class _LifeWithSpread(NamedTuple):
    """A life of a file whose spread may have been computed."""

    label: str
    method: str  # of preload
    friction: float | None  # None for a film, which has no single coefficient
    preload_choice: int = GIVEN


def _lives_with_spread(file: Any) -> Iterator[_LifeWithSpread]:
    """Yields each life of a file whose spread may have been computed."""
    kind = kind_of(file)
    if kind == LIFE_KIND:
        scene = stored_scene(file)
        method, friction = scene["operation"]["preload_method"], scene["friction"].get("ball_race")
        yield _LifeWithSpread(label="", method=method, friction=friction)
    elif kind == "recommendation" or (kind == KIND and PRELOAD_CHOICE in file.variables):
        yield from _lives_at_preload_choices(file, kind)
    elif _has_lives(file):
        for method in _preload_methods(file):
            for mu in variable_values(file, "friction"):
                label = f"{method}, mu {mu:g}"
                yield _LifeWithSpread(label=label, method=method, friction=float(mu))


def _lives_at_preload_choices(file: Any, kind: str) -> Iterator[_LifeWithSpread]:
    """Yields the lives at the scene's own and the recommended preload that a file contains."""
    frictions = variable_values(file, "friction").tolist() if "friction" in file.variables else []
    scene_friction = stored_scene(file)["friction"].get("ball_race")
    choices = variable_values(file, PRELOAD_CHOICE) if kind == KIND else (RECOMMENDED,)
    for mu, method in itertools.product(frictions or [scene_friction], _preload_methods(file)):
        words = method_words(stored_scene(file), method)
        point = f"{words}, mu {mu:g}" if frictions else words
        for choice in choices:
            preload = "preload of the scene" if choice == GIVEN else "recommended preload"
            yield _LifeWithSpread(
                label=f"{point}, {preload}", method=method, friction=mu, preload_choice=choice
            )


def _preload_methods(file: Any) -> list[str]:
    """Returns the names of the preload methods along that dimension of a file."""
    names = file["preload_method"].flag_meanings.split()
    return [names[int(flag)] for flag in variable_values(file, "preload_method")]


def _coordinate_text(file: Any, name: str) -> str:
    """Lists the values of a coordinate, or the ends of many, with the unit; "" without one."""
    if name not in file.variables or file[name].dimensions != (name,):
        return ""
    flags = str(getattr(file[name], "flag_meanings", "")).split()
    texts = [flags[int(value)] if flags else f"{value:g}" for value in variable_values(file, name)]
    unit = str(getattr(file[name], "units", "")).removeprefix("1")
    listed = ", ".join(texts) if len(texts) <= MOST_LISTED else f"{texts[0]} to {texts[-1]}"
    return f"{listed} {unit}".rstrip()


def _numeric_variables(file: Any) -> list[str]:
    """Returns the names of variables that are neither coordinates nor flags nor texts."""
    return [
        name
        for name, variable in file.variables.items()
        if name not in file.dimensions
        and variable.dtype is not str
        and "flag_values" not in variable.ncattrs()
        and name != "status"
    ]


def _has_lives(file: Any) -> bool:
    """Returns whether a file contains lives over preload method and friction."""
    axes = ("preload_method", "friction")
    return "end_criterion" in file.variables and file["end_criterion"].dimensions == axes


def _life_blocks(file: Any) -> list[Block]:
    """Returns a table of the lives over preload method and friction; empty without such lives."""
    if not _has_lives(file):
        return []
    criteria = file["end_criterion"].flag_meanings.split()
    flags = variable_values(file, "end_criterion").ravel()
    ends = tuple(criteria[int(flag)] if np.isfinite(flag) else criteria[-1] for flag in flags)
    methods, frictions = _preload_methods(file), variable_values(file, "friction").tolist()
    points = list(itertools.product(methods, frictions))
    counted = counted_words(stored_scene(file))
    lives, losses = (variable_values(file, name).ravel() for name in ("life", "loss_at_end"))
    rows = (
        Row("preload method", "", tuple(method for method, _ in points), "preload_method"),
        Row("friction", "", tuple(mu for _, mu in points), "friction", given=True),
        quantity_row(f"life, wear of {counted}", "h", lives, "life"),
        quantity_row("loss", "m", losses, "loss_at_end"),
        Row("ended by", "", ends, "end_criterion"),
    )
    return [Block("lives", rows=rows, axes=2)]
