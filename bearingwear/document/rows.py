"""Rows of a result sheet, made of an open result file and the table of variables."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np

from bearingwear.document.document import Block, Row, row_of
from bearingwear.measures import ENDS, Measure
from bearingwear.results.units import scale_of
from bearingwear.scene.scene import COUNTS

COUNTED_WORDS = dict(zip(COUNTS, ("the balls alone", "balls and races"), strict=True))
"""What wear counts, in a sentence."""


def counted_words(scene: Mapping[str, Any]) -> str:
    """What wear a scene counts, in a sentence."""
    return COUNTED_WORDS[scene.get("wear", {}).get("counts", COUNTS[-1])]


FILM_TESTS = (
    "Film lives disagree with published tests: both predictions that can be checked fail, one by a "
    "factor of 40 or more (docs/film_tests.md)."
)


def film_lines(scene: Mapping[str, Any]) -> tuple[str, ...]:
    """What is known of the lives of films, for a scene with one that no test has calibrated."""
    coats = [scene.get("friction", {}), *scene.get("materials", {}).values()]
    has_film = any(coat.get("film") for coat in coats)
    return (FILM_TESTS,) if has_film and not scene.get("calibrated") else ()


def values(file: Any, name: str, factor: float = 1.0) -> np.ndarray:
    """Values of a variable, NaN where not solved; all NaN if it is not there."""
    if name not in file.variables:
        return np.array(np.nan)
    return np.ma.filled(np.ma.asarray(file[name][...], dtype=float), np.nan) * factor


def meaning(file: Any, name: str) -> str:
    """The word for a single flag."""
    return str(file[name].flag_meanings.split()[int(file[name][...])])


def solved_rows(block: Block) -> Block:
    """A block without its empty rows."""

    def known(value: Any) -> bool:
        return not isinstance(value, float) or not np.isnan(value)

    rows = tuple(row for row in block.rows if any(map(known, row.values)))
    return replace(block, rows=rows)


def in_one_unit(blocks: Iterable[Block]) -> list[Block]:
    """Blocks with every quantity in the largest of the units that it has in any of them."""
    known = list(blocks)
    largest: dict[tuple[str, str], tuple[float, str]] = {}
    for row in (row for block in known for row in block.rows):
        family, factor = scale_of(row.unit)
        key = row.name or row.label, family
        largest[key] = min(largest.get(key, (factor, row.unit)), (factor, row.unit))

    def converted(row: Row) -> Row:
        family, old = scale_of(row.unit)
        factor, unit = largest[row.name or row.label, family]
        if unit == row.unit:
            return row
        values = tuple(v * factor / old if isinstance(v, float) else v for v in row.values)
        limit, *limits = (
            None if one is None else one * factor / old for one in (row.limit, *row.limits)
        )
        return row._replace(unit=unit, values=values, limit=limit, limits=tuple(limits))

    return [replace(block, rows=tuple(map(converted, block.rows))) for block in known]


def side_by_side(of_each: Sequence[Sequence[Block]]) -> list[Block]:
    """Blocks of two bearings as one, with a column for each."""
    return [
        replace(
            blocks[0],
            columns=tuple(
                f"{k}: {column}" if column else f"bearing {k}"
                for k, block in enumerate(blocks, 1)
                for column in block.columns or ("",)
            ),
            rows=tuple(_joined(rows) for rows in zip(*(b.rows for b in blocks), strict=True)),
            lines=tuple(dict.fromkeys(line for block in blocks for line in block.lines)),
        )
        for blocks in zip(*of_each, strict=True)
    ]


def _joined(rows: Sequence[Row]) -> Row:
    """Rows of one quantity as one, in one unit, with limits that differ and notes of each."""
    rescaled = in_one_unit([Block("", rows=tuple(rows))])[0].rows
    alike = len({row.limit and f"{row.limit:.9g}" for row in rescaled}) == 1
    limits = tuple(row.limit for row in rescaled for _ in row.values)
    notes = [f"{row.note} by bearing {k}" for k, row in enumerate(rows, 1) if row.note]
    return rescaled[0]._replace(
        values=tuple(value for row in rescaled for value in row.values),
        limit=rescaled[0].limit if alike else None,
        limits=() if alike else limits,
        note=", ".join(notes),
    )


def mean(values: np.ndarray) -> float:
    return float(values.mean()) if values.size else float("nan")


def mean_rows(
    file: Any, names: Iterable[str], limits: Mapping[str, float] = MappingProxyType({})
) -> tuple[Row, ...]:
    """A row for each variable that is there, with the mean of its values."""
    return tuple(
        row_of(name, [mean(values(file, name))], limits.get(name))
        for name in names
        if name in file.variables
    )


def _criteria(file: Any) -> dict[str, tuple[Measure, float, float]]:
    """Criteria of the scene: measure, limit and initial preload, by each variable one looks at."""
    scene = json.loads(getattr(file, "scene", "{}"))
    given = scene.get("wear", {}).get("end_of_life") or {}
    preload = scene.get("operation", {}).get("preload_N", 0.0)
    return {
        variable: (measure, given[key], preload)
        for key, measure in ENDS.items()
        if given.get(key) and (preload or not measure.over_preload)
        for variable in measure.variables
    }


def limits_of_rows(file: Any) -> dict[str, float]:
    """Limits of what may end a life, by variable [units of the file]."""
    found = _criteria(file).items()
    return {name: measure.in_files(limit, preload) for name, (measure, limit, preload) in found}


def marked(rows: Iterable[Row], file: Any) -> tuple[Row, ...]:
    """Rows, of which those say so that are beyond their limit."""
    criteria, found = _criteria(file), []
    for row in rows:
        if row.limit is not None:
            measure, limit, preload = criteria[row.name]
            value = measure.value(values(file, row.name), preload)
            row = row._replace(note="violated" if measure.is_passed(value, limit) else "")
        found.append(row)
    return tuple(found)
