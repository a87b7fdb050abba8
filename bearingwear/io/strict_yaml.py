"""Strict reading of a small YAML file as plain data.

What YAML would quietly get wrong is refused instead: a key given twice (the last one would win),
anchors and aliases (a few lines can stand for gigabytes), tags, several documents. Only numbers
that every YAML reader takes for the same number are numbers: `010` (octal in YAML 1.1), `1:30`
(sexagesimal) and `1e-5` (text in YAML 1.1, a number in 1.2) stay text, which the scene's schema
then refuses as such.
"""

from __future__ import annotations

import os
import re
from typing import Any

import yaml

from bearingwear.model.scene import SceneError

LARGEST_FILE = 1_000_000
"""Size limit of a scene file [bytes]; a scene takes two thousand."""

DEEPEST = 20
"""Limit of blocks within blocks; a scene has three."""

MOST_VALUES = 5000
"""Limit of values and keys; a scene has some hundred, a thousand unequal balls a thousand more."""

_FIRST = list("-+0123456789.")
_BOOLEAN = re.compile(r"^(?:true|True|TRUE|false|False|FALSE)$")
_NULL = re.compile(r"^(?:~|null|Null|NULL|)$")
_INTEGER = re.compile(r"^[-+]?(?:0|[1-9][0-9]*)$")
_FLOAT = re.compile(
    r"^(?:[-+]?(?:0|[1-9][0-9]*)\.[0-9]*(?:[eE][-+][0-9]+)?|[-+]?\.[0-9]+(?:[eE][-+][0-9]+)?"
    r"|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN))$"
)


class _Loader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]
    yaml_implicit_resolvers: dict[str, list[Any]] = {}


_Loader.add_implicit_resolver("tag:yaml.org,2002:bool", _BOOLEAN, list("tTfF"))
_Loader.add_implicit_resolver("tag:yaml.org,2002:null", _NULL, ["~", "n", "N", ""])
_Loader.add_implicit_resolver("tag:yaml.org,2002:int", _INTEGER, _FIRST)
_Loader.add_implicit_resolver("tag:yaml.org,2002:float", _FLOAT, _FIRST)


def text_of(path: str | os.PathLike[str]) -> str:
    """Contents of a small UTF-8 text file.

    Raises
    ------
    SceneError
        Missing, unreadable, too large, or not text.
    """
    source = os.fspath(path)
    try:
        with open(source, "rb") as file:
            data = file.read(LARGEST_FILE + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise SceneError(
            "", f"given a file that cannot be read ({reason}); allowed a YAML file", source=source
        ) from None
    if len(data) > LARGEST_FILE:
        raise SceneError(
            "", f"given more than {LARGEST_FILE} bytes; allowed at most that", source=source
        )
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise SceneError(
            "", f"given bytes that are not text (byte {error.start}); allowed UTF-8", source=source
        ) from None


def data_of(text: str, source: str) -> Any:
    """Plain data (dict, list, str, int, float, bool, None) of a YAML text.

    Raises
    ------
    SceneError
        Not YAML, or YAML that is refused (see above).
    """
    try:
        _check_events(text, source)
        loader = _Loader(text)
        try:
            node = loader.get_single_node()
            return None if node is None else _plain(loader, node, "", source)
        finally:
            loader.dispose()
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f" in line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        reason = getattr(error, "problem", None) or getattr(error, "reason", None) or "broken"
        raise SceneError(
            "", f"given text that is not YAML{where} ({reason}); allowed YAML", source=source
        ) from None


def _check_events(text: str, source: str) -> None:
    """Refuse, before anything is built, what could grow large or change meaning."""
    depth = documents = values = 0
    for event in yaml.parse(text, Loader=_Loader):
        line = event.start_mark.line + 1
        if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None) is not None:
            raise SceneError(
                "", f"given an anchor or alias in line {line}; allowed none", source=source
            )
        if getattr(event, "tag", None) is not None:
            raise SceneError("", f"given a tag in line {line}; allowed none", source=source)
        if isinstance(event, yaml.DocumentStartEvent):
            documents += 1
            if documents > 1:
                raise SceneError(
                    "", f"given a second document in line {line}; allowed one", source=source
                )
        values += isinstance(event, yaml.NodeEvent)
        if values > MOST_VALUES:
            raise SceneError(
                "",
                f"given more than {MOST_VALUES} keys and values in line {line}; "
                "allowed at most that",
                source=source,
            )
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
            if depth > DEEPEST:
                raise SceneError(
                    "",
                    f"given more than {DEEPEST} blocks within each other in line {line}; "
                    "allowed at most that",
                    source=source,
                )
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1


def _plain(loader: Any, node: Any, path: str, source: str) -> Any:
    if isinstance(node, yaml.SequenceNode):
        return [_plain(loader, part, f"{path}[{i}]", source) for i, part in enumerate(node.value)]
    if isinstance(node, yaml.MappingNode):
        block: dict[str, Any] = {}
        for key_node, value_node in node.value:
            if not isinstance(key_node, yaml.ScalarNode):
                line = key_node.start_mark.line + 1
                raise SceneError(
                    path, f"given a list or block as a key in line {line}; allowed text", (), source
                )
            key = key_node.value
            here = f"{path}.{key}" if path else key
            if key in block:
                line = key_node.start_mark.line + 1
                raise SceneError(
                    here, f"given a second time in line {line}; allowed once", source=source
                )
            block[key] = _plain(loader, value_node, here, source)
        return block
    try:
        return loader.construct_object(node)
    except ValueError:  # an integer of thousands of digits
        raise SceneError(
            path, f"given {len(node.value)} digits; allowed a number that can be read", (), source
        ) from None
