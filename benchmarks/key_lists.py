"""The keys of a record or of a JSON schema as Markdown.

`python benchmarks/key_lists.py config/README.md` puts lists between the markers of that file: of a
scene's keys, or of those of the record or the schema that a marker names.
"""

from __future__ import annotations

import importlib
import json
import re
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path

import yaml
from scene_schema import default

from bearingwear.scene.checking.errors import yaml_number
from bearingwear.scene.checking.records import Part, file_part, keys
from bearingwear.scene.scene import Scene

LINE_LENGTH = 100
"""Longest line of the Markdown."""

KEY_LISTS = re.compile(
    r"(<!-- keys(?: ([\w.]+):(\w+)| (\S+\.yaml))?: begin -->\n).*?(<!-- keys: end -->)", re.DOTALL
)
"""A list of keys in a text, of the record of `keys MODULE:RECORD: begin` or of a schema's file."""

ROOT = Path(__file__).resolve().parents[1]


def key_list(record_type: type = Scene) -> str:
    """Markdown list: key, unit, meaning, what is allowed, default."""
    return "\n".join(_item(path, part) for path, part in keys(file_part(record_type)))


def _item(path: str, part: Part) -> str:
    unit = "" if part.unit in ("", "-", "1") else f" [{part.unit}]"
    meaning = f" {part.key.meaning}." if part.key.meaning else ""
    default = _default(part)
    default = default if default == "required" else f"default: {default}"
    allowed = part.allowed
    if not allowed.startswith(("a-z", *part.key.choices)):
        allowed = allowed[:1].upper() + allowed[1:]
    text = f"- `{path}`{unit}:{meaning} *{allowed}; {default}.*"
    return _wrapped(text)


def schema_list(path: str) -> str:
    """Markdown list of the keys of a JSON schema: key, meaning, default."""
    schema = yaml.safe_load((ROOT / path).read_text(encoding="utf-8"))
    return "\n".join(_schema_items(schema, schema, ""))


def _schema_items(schema: dict, file_schema: dict, path: str) -> Iterator[str]:
    """Items of the keys below a part of a schema, whose references are in `file_schema`."""
    for name, given in schema.get("properties", {}).items():
        part = _resolved(given, file_schema)
        required = name in schema.get("required", ())
        default = "required" if required else f"default: {json.dumps(part.get('default'))}"
        key, choices = f"{path}{name}", part.get("enum") or part.get("items", {}).get("enum")
        allowed = f"{', '.join(map(str, choices))}; " if choices else ""
        text = f"- `{key}`: {part['description']}. *{allowed}{default.replace('null', 'none')}.*"
        yield _wrapped(text)
        for below, suffix in ((part, "."), (part.get("items"), "[]."),
                              (part.get("additionalProperties"), ".NAME.")):  # fmt: skip
            if isinstance(below, dict):
                yield from _schema_items(_resolved(below, file_schema), file_schema, key + suffix)


def _resolved(part: dict, file_schema: dict) -> dict:
    if "$ref" not in part:
        return part
    return file_schema["$defs"][part["$ref"].rpartition("/")[2]] | part


def _wrapped(text: str) -> str:
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
        begin, module, name, file, end = match.groups()
        if file:
            return f"{begin}{schema_list(file)}\n{end}"
        record_type = getattr(importlib.import_module(module), name) if module else Scene
        return f"{begin}{key_list(record_type)}\n{end}"

    return KEY_LISTS.sub(made, text)


if __name__ == "__main__":
    file = Path(sys.argv[1])
    file.write_text(renewed(file.read_text(encoding="utf-8")), encoding="utf-8")
