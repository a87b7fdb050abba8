"""Which values of a scene file are assumed, as its comments state."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence

import yaml

from bearingwear.scene.checking.strict_yaml import data_of, text_of
from bearingwear.scene.read import scene_files

_ASSUMED = re.compile(r"(^|\s)#\s*(all )?assumed\b")


def assumed_keys(path: str | os.PathLike[str]) -> set[str]:
    """Keys that a comment marks as assumed: `bearing.ball_count: 15  # assumed: ...`.

    The comment is on the line of the key, or alone on the line above it. That of a block stands
    for all its keys. A scene that is based on another one has its keys, but for those that it sets.
    """
    *own, base = scene_files(path)
    text = text_of(base)
    node = yaml.compose(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    keys = set(_marked(node, text.splitlines()))
    for file in own:
        changed = tuple(data_of(text_of(file), file).get("set", {}))
        keys = {key for key in keys if not f"{key}.".startswith(tuple(f"{c}." for c in changed))}
    return keys


def _marked(
    node: yaml.MappingNode, lines: Sequence[str], block: str = "", assumed: bool = False
) -> Iterator[str]:
    for name, value in node.value:
        at = name.start_mark.line
        above = lines[at - 1].strip() if at else ""
        is_marked = assumed or bool(
            _ASSUMED.search(lines[at]) or (above.startswith("#") and _ASSUMED.search(above))
        )
        if isinstance(value, yaml.MappingNode):
            yield from _marked(value, lines, f"{block}{name.value}.", is_marked)
        elif is_marked:
            yield f"{block}{name.value}"
