"""The JSON schema of a record, made from its keys, for editors and other validators.

`python benchmarks/scene_schema.py` prints that of a scene.
"""

from __future__ import annotations

import functools
import json
from typing import Any

from bearingwear.scene.checking.records import NAME, Part, file_part
from bearingwear.scene.scene import Scene


@functools.cache
def schema(record_type: type = Scene) -> dict[str, Any]:
    """The JSON schema of a file that holds a record."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": f"bearingwear {record_type.__name__.lower()}",
        "description": "Each key's description reads: meaning; unit; what is allowed.",
        **_block(file_part(record_type)),
    }


def _schema(part: Part) -> dict[str, Any]:
    found = _typed(part)
    if part.nullable and "type" in found:
        kinds = found["type"] if isinstance(found["type"], list) else [found["type"]]
        found["type"] = [*kinds, "null"]
    found["description"] = f"{part.key.meaning}; {part.unit}; {part.allowed}"
    if part.key.default_by:
        found["default_by"] = part.key.default_by
    elif not part.required:
        found["default"] = default(part)
    return found


def default(part: Part) -> Any:
    """The value of a key that is left out, as it would stand in a file."""
    if part.kind == "block" and part.default is not None:
        return {}
    if isinstance(part.default, tuple):
        return part.default[0] if part.key.single else list(part.default)
    return part.default


def _typed(part: Part) -> dict[str, Any]:
    key = part.key
    if part.kind == "block":
        return _block(part)
    if part.kind == "mapping":
        names = {"enum": list(key.names)} if key.names else {"pattern": NAME}
        return _without_none(
            type="object",
            minProperties=key.least or None,
            propertyNames=None if part.item.kind == "any" else names,
            additionalProperties=_schema(part.item),
        )
    if part.kind == "list":
        items = _schema(part.item)
        kinds: Any = [part.item.kind, "array"] if key.single else "array"
        limits = {"minItems": key.least or None, "maxItems": key.most}
        own = key.bounds if key.single else {}
        return _without_none(type=kinds, **own, items=items, **limits)
    if part.kind == "choice":
        return {"enum": [*key.choices, *key.synonyms, *([None] if part.nullable else [])]}
    if part.kind == "choice_or_number":
        return {"anyOf": [{"enum": list(key.choices)}, {"type": "number", **key.bounds}]}
    if part.kind in ("integer", "number"):
        return {"type": part.kind, **key.bounds}
    if part.kind == "text":
        text = {"maxLength": key.longest, "pattern": key.pattern or None}
        return _without_none(type="string", **text)
    return {"type": "boolean"} if part.kind == "boolean" else {}


def _block(part: Part) -> dict[str, Any]:
    required = [name for name, below in part.below.items() if below.required]
    return {
        "type": "object",
        "additionalProperties": False,
        **({"required": required} if required else {}),
        "properties": {name: _schema(below) for name, below in part.below.items()},
    }


def _without_none(**values: Any) -> dict[str, Any]:
    return {name: value for name, value in values.items() if value is not None}


if __name__ == "__main__":
    print(json.dumps(schema(), indent=2))
