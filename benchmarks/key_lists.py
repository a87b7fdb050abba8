"""The keys of a record as Markdown.

`python benchmarks/key_lists.py config/README.md` puts lists between the markers of that file: of a
scene's keys, or of those of the record that a marker names.
"""

from __future__ import annotations

import importlib
import json
import re
import sys
import textwrap
from pathlib import Path

from scene_schema import default

from bearingwear.scene.checking.errors import yaml_number
from bearingwear.scene.checking.records import Part, keys, whole
from bearingwear.scene.scene import Scene

LINE_LENGTH = 100
"""Longest line of the Markdown."""

KEY_LISTS = re.compile(
    r"(<!-- keys(?: ([\w.]+):(\w+))?: begin -->\n).*?(<!-- keys: end -->)", re.DOTALL
)
"""A list of keys in a text, of the record RECORD where it says `keys MODULE:RECORD: begin`."""


def key_list(record_type: type = Scene) -> str:
    """Markdown list: key, unit, meaning, what is allowed, default."""
    return "\n".join(_item(path, part) for path, part in keys(whole(record_type)))


def _item(path: str, part: Part) -> str:
    unit = "" if part.unit in ("", "-", "1") else f" [{part.unit}]"
    meaning = f" {part.key.meaning}." if part.key.meaning else ""
    default = _default(part)
    default = default if default == "required" else f"default: {default}"
    allowed = part.allowed
    if not allowed.startswith(("a-z", *part.key.choices)):
        allowed = allowed[:1].upper() + allowed[1:]
    text = f"- `{path}`{unit}:{meaning} *{allowed}; {default}.*"
    return textwrap.fill(
        text, LINE_LENGTH, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False
    )


def _default(part: Part) -> str:
    if part.required:
        return "required"
    if part.key.default_by:
        return f"by `{part.key.default_by}`"
    value = default(part)
    if value is None:
        return "none"
    if part.kind == "block":
        return "the defaults of its keys"
    if value == "":
        return "empty"
    return yaml_number(value) if isinstance(value, float) else json.dumps(value).strip('"')


def renewed(text: str) -> str:
    """A text with the lists between its markers made again."""

    def made(match: re.Match[str]) -> str:
        begin, module, name, end = match.groups()
        record_type = getattr(importlib.import_module(module), name) if module else Scene
        return f"{begin}{key_list(record_type)}\n{end}"

    return KEY_LISTS.sub(made, text)


if __name__ == "__main__":
    file = Path(sys.argv[1])
    file.write_text(renewed(file.read_text(encoding="utf-8")), encoding="utf-8")
