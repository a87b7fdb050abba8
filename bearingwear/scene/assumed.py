"""Keys of a scene file whose values are assumed, as its comments state."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence

import yaml

from bearingwear.scene.checking.strict_yaml import data_of, text_of
from bearingwear.scene.read import scene_files

_ASSUMED = re.compile(r"(^|\s)#\s*(all )?assumed\b")


def assumed_keys(path: str | os.PathLike[str]) -> set[str]:
    """Returns keys that a comment marks as assumed: `bearing.ball_count: 15  # assumed: ...`.

    The comment is on the line of the key, or alone on the line above it; at a block it holds for
    all its keys. A scene that is based on another one has its marks, except on keys that it sets.
    """
    *derived, base = scene_files(path)
    text = text_of(base)
    node = yaml.compose(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    keys = set(_assumed_keys_of_block(node, text.splitlines()))
    for file in derived:
        changes = data_of(text_of(file), file).get("set", {})
        blocks = tuple(f"{key}." for key in changes)  # a changed block has new values in all keys
        keys = {key for key in keys if not f"{key}.".startswith(blocks)}
    return keys


def _assumed_keys_of_block(
    node: yaml.MappingNode, lines: Sequence[str], block: str = "", block_is_assumed: bool = False
) -> Iterator[str]:
    """Yields the keys of a block that comments mark as assumed, with those of inner blocks.

    lines: of the file.
    block: path of the block, with a dot at its end.
    block_is_assumed: whether a comment at the block, or around it, marks all its keys.
    """
    for name, value in node.value:
        line = name.start_mark.line
        above = lines[line - 1].strip() if line else ""
        is_marked = block_is_assumed or bool(
            _ASSUMED.search(lines[line]) or (above.startswith("#") and _ASSUMED.search(above))
        )
        if isinstance(value, yaml.MappingNode):
            yield from _assumed_keys_of_block(value, lines, f"{block}{name.value}.", is_marked)
        elif is_marked:
            yield f"{block}{name.value}"
