"""The keys of a scene: the table of all, made from the schema, and their values in nested data.

`python -m bearingwear.io.keys config/README.md` puts it between that file's two markers.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from bearingwear.io.config import schema, yaml_number

BEGIN, END = "<!-- keys: begin -->", "<!-- keys: end -->"


def key_table() -> str:
    """Markdown table: key, meaning, unit, what is allowed, default."""
    lines = ["| key | meaning | unit | allowed | default |", "| --- | --- | --- | --- | --- |"]
    lines += ["| " + " | ".join(row) + " |" for row in _rows(schema(), "")]
    return "\n".join(lines)


def _rows(block: Mapping[str, Any], path: str) -> Iterator[tuple[str, ...]]:
    for name, part in block["properties"].items():
        key = f"{path}{name}"
        meaning, unit, allowed = part["description"].split("; ")
        default = _default(part, required=name in block.get("required", ()))
        yield f"`{key}`", meaning, "" if unit == "-" else unit, allowed, default
        below = part
        if isinstance(part.get("additionalProperties"), dict):  # blocks under names of one's own
            below, key = part["additionalProperties"], f"{key}.NAME"
        if "properties" in below:
            yield from _rows(below, f"{key}.")


def scene_keys() -> list[str]:
    """Every key of a scene that takes a value of its own, `operation.preload_N`."""
    return [row[0].strip("`") for row in _rows(schema(), "") if "a block of keys" not in row[3]]


def leaves(block: Mapping[str, Any], path: str = "") -> dict[str, Any]:
    """Values of nested data by their whole keys, `operation.preload_N`."""
    found: dict[str, Any] = {}
    for key, value in block.items():
        if isinstance(value, Mapping):
            found |= leaves(value, f"{path}{key}.")
        else:
            found[f"{path}{key}"] = value
    return found


def _default(part: Mapping[str, Any], required: bool) -> str:
    if required:
        return "required"
    if "default_by" in part:
        return f"by `{part['default_by']}`"
    value = part.get("default")
    if value is None:
        return "none"
    if value == {}:
        return "the defaults of its keys"
    if value == "":
        return "empty"
    return yaml_number(value) if isinstance(value, float) else json.dumps(value).strip('"')


def renewed(text: str) -> str:
    """A text with the table between its markers made anew."""
    before, _, rest = text.partition(BEGIN)
    _, _, after = rest.partition(END)
    return f"{before}{BEGIN}\n{key_table()}\n{END}{after}"


if __name__ == "__main__":
    file = Path(sys.argv[1])
    file.write_text(renewed(file.read_text(encoding="utf-8")), encoding="utf-8")
