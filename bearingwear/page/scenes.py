"""Scenes in words, for a page: every number of theirs, and how they differ."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import Any

from bearingwear.results.units import in_print, key_in_words
from bearingwear.scene.changes import leaves

KeyRow = tuple[str, list[str], bool]
_NAMES = ("name", "description")
_MOST = 4  # scene_differences that are named


def key_rows(scenes: Sequence[Mapping[str, Any]]) -> Iterator[KeyRow]:
    """Rows of the table of scenes: key in words, a value for each, whether they differ."""
    flat = [{key: _value(value) for key, value in leaves(scene).items()} for scene in scenes]
    names = list(dict.fromkeys(name for values in flat for name in values))
    blocks = list(dict.fromkeys(name.partition(".")[0] for name in names))
    for name in sorted(names, key=lambda name: blocks.index(name.partition(".")[0])):
        if name not in _NAMES:
            row = [values.get(name, "–") for values in flat]
            yield key_label(name), row, len(set(row)) > 1


def key_blocks(scenes: Sequence[Mapping[str, Any]]) -> Iterator[tuple[str, list[KeyRow]]]:
    """Rows of `key_rows` by the block of the scene that they belong to."""
    rows = groupby(key_rows(scenes), key=lambda row: row[0].partition(": ")[0])
    for block, members in rows:
        yield (
            block,
            [(name.partition(": ")[2] or name, values, differ) for name, values, differ in members],
        )


def scene_differences(first: Mapping[str, Any], other: Mapping[str, Any]) -> str:
    """Differences of another scene from the first, in words, without `uncertainty`."""
    rows = key_rows([_certain(first), _certain(other)])
    said = [
        f"{label.partition(': ')[2] or label} {values[1]} instead of {values[0]}"
        for label, values, differ in rows
        if differ
    ]
    more = f"; {len(said) - _MOST} more" if len(said) > _MOST else ""
    return "; ".join(said[:_MOST]) + more


def _certain(scene: Mapping[str, Any]) -> dict[str, Any]:
    return {block: value for block, value in scene.items() if block != "uncertainty"}


def key_label(key: str) -> str:
    """A key of a scene in words: `bearing: ball diameter (mm)`."""
    blocks = ", ".join(block.replace("_", " ") for block in key.split(".")[:-1])
    words, unit = key_in_words(key)
    return f"{blocks}: {words}" + (f" ({in_print(unit)})" if unit else "")


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list):
        return ", ".join(map(_value, value))
    return "–" if value is None else str(value).replace("_", " ")
