"""Strict reading of a small YAML file as plain data.

What YAML would quietly get wrong is refused instead: a key given twice (the last one would win),
anchors and aliases (a few lines can stand for gigabytes), tags, several documents. Numbers are
those of YAML 1.2, and so of JSON: `1e-5`, `1E3`, `5.`. What is another number to readers of YAML
1.1 stays text: `010` (octal), `1:30` (sexagesimal), `1_000`.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from typing import Any

import yaml

from bearingwear.atomic import SIGNATURE
from bearingwear.scene.checking.errors import (
    DEEPEST,
    SceneError,
    check_thousands,
    key_path,
)

LARGEST_FILE = 1_000_000  # bytes; a scene takes two thousand
MOST_VALUES = 5000  # and keys; a scene has some hundred, a thousand unequal balls a thousand more

_FIRST = list("-+0123456789.")
_BOOLEAN = re.compile(r"^(?:true|True|TRUE|false|False|FALSE)$")
_NULL = re.compile(r"^(?:~|null|Null|NULL|)$")
_INTEGER = re.compile(r"^[-+]?(?:0|[1-9][0-9]*)$")
_FLOAT = re.compile(
    r"^(?:[-+]?(?:(?:0|[1-9][0-9]*)(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
    r"|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN))$"
)


class _Loader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]
    yaml_implicit_resolvers: dict[str, list[Any]] = {}


_Loader.add_implicit_resolver("tag:yaml.org,2002:bool", _BOOLEAN, list("tTfF"))
_Loader.add_implicit_resolver("tag:yaml.org,2002:null", _NULL, ["~", "n", "N", ""])
_Loader.add_implicit_resolver("tag:yaml.org,2002:int", _INTEGER, _FIRST)
_Loader.add_implicit_resolver("tag:yaml.org,2002:float", _FLOAT, _FIRST)


class _Dumper(yaml.SafeDumper):
    """Puts texts in quotes that readers of YAML 1.1 or of 1.2 would take for something else."""

    yaml_implicit_resolvers = {k: [*v] for k, v in yaml.SafeDumper.yaml_implicit_resolvers.items()}


_Dumper.add_implicit_resolver("tag:yaml.org,2002:float", _FLOAT, _FIRST)


def yaml_of(data: Any) -> str:
    """Returns plain data as YAML, a line for each key of a block."""
    text: str = yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True)
    return text


def text_of(path: str | os.PathLike[str], kind: str = "YAML") -> str:
    """Reads a small UTF-8 text file; `kind` names its format in messages.

    SceneError: missing, unreadable, too large, or not text.
    """
    source = os.fspath(path)
    try:
        with open(source, "rb") as file:
            data = file.read(LARGEST_FILE + 1)
        if len(data) <= LARGEST_FILE:
            return data.decode("utf-8-sig")
        problem = f"got more than {LARGEST_FILE} bytes, expected at most that many"
    except UnicodeDecodeError as error:
        problem = f"got bytes that are not text (byte {error.start}), expected UTF-8"
        if data.startswith(SIGNATURE):
            problem = "got a result file, which `bearingwear show` prints, expected a scene"
    except IsADirectoryError:
        problem = f"got a folder, expected a {kind} file"
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        problem = f"got a file that cannot be read ({reason}), expected a {kind} file"
    raise SceneError("", problem, source=source)


def data_of(text: str, source: str, anchors: bool = False) -> Any:
    """Reads a YAML text as plain data (dict, list, str, int, float, bool, None).

    anchors: whether anchors, aliases and merge keys are allowed; a scene has none.

    SceneError: not YAML, or YAML with a key given twice, a tag, a second document, too many values
    or blocks, or a speed such as 18.000; its message names the source.
    """
    try:
        _check_events(text, anchors)
        loader = _Loader(text)
        try:
            node = loader.get_single_node()
            return None if node is None else _plain(loader, node, "", anchors)
        finally:
            loader.dispose()
    except SceneError as error:
        raise error.in_source(source) from None
    except yaml.YAMLError as error:
        raise SceneError("", _yaml_problem(error, text), source=source) from None


def _yaml_problem(error: yaml.YAMLError, text: str) -> str:
    """Returns what is wrong with a text that is no YAML, and on which line."""
    reason = getattr(error, "problem", None) or getattr(error, "reason", None) or "broken"
    mark = getattr(error, "problem_mark", None)
    if mark is None:
        return f"got text that is not YAML ({reason}), expected YAML"
    place = f"on line {mark.line + 1}, column {mark.column + 1}"
    lines = text.splitlines()
    line = lines[mark.line] if mark.line < len(lines) else ""
    if "\t" in _indent(line):
        return f"got a tab {place}, expected spaces before a key"
    problem = f"got text that is not YAML {place} ({reason}), expected YAML"
    return _mistyped_line(lines, mark.line) or problem


def _indent(line: str) -> str:
    """Returns the white space at the beginning of a line."""
    return line[: len(line) - len(line.lstrip())]


_NO_SPACE = re.compile(r"(\s*)(\w+):([^\s:/].*)")
_EQUALS = re.compile(r"(\s*)(\w+)\s*=\s*([^\s#]+)")
_NO_COLON = re.compile(r"([a-z_]+)\s*(?:#.*)?")


def _mistyped_line(lines: Sequence[str], index: int) -> str:
    """Returns what is probably wrong with a line, or with one of the two before it; "" if unclear.

    YAML finds a key without colon or space only at the next key. Empty lines do not count.

    index: of the line where YAML finds the fault, which may be behind the last one.
    """
    last = min(index, len(lines) - 1)
    nearby = [k for k in range(last, -1, -1) if lines[k].strip()][:3]
    for k in nearby:
        line, number = lines[k], k + 1
        if match := _EQUALS.fullmatch(line.partition("#")[0].rstrip()):
            return f"got an equals sign on line {number}, expected {match[2]}: {match[3]}"
        if match := _NO_SPACE.fullmatch(line.partition(" #")[0].rstrip()):
            return f"got no space after the colon on line {number}, expected {match[2]}: {match[3]}"
        if match := _NO_COLON.fullmatch(line):
            return f"got no colon on line {number}, expected {match[1]}:"
    if len(nearby) > 1 and nearby[0] == index and ":" in lines[index]:
        spaces, spaces_above = (len(_indent(lines[k])) for k in nearby[:2])
        if abs(spaces - spaces_above) == 1:
            return (
                f"got {spaces} spaces before the key on line {index + 1}, expected {spaces_above}"
            )
    return ""


def _check_events(text: str, anchors: bool) -> None:
    """Refuses, before anything is built, YAML that could grow large or change its meaning.

    anchors: whether anchors and aliases are allowed.
    """
    depth = documents = values = 0
    for event in yaml.parse(text, Loader=_Loader):
        documents += isinstance(event, yaml.DocumentStartEvent)
        values += isinstance(event, yaml.NodeEvent)
        depth += isinstance(event, yaml.CollectionStartEvent)
        depth -= isinstance(event, yaml.CollectionEndEvent)
        if getattr(event, "anchor", None) is not None and not anchors:
            fault, allowed = "an anchor or alias", "none"
        elif getattr(event, "tag", None) is not None:
            fault, allowed = "a tag", "none"
        elif documents > 1:
            fault, allowed = "a second document", "one"
        elif values > MOST_VALUES:
            fault, allowed = f"more than {MOST_VALUES} keys and values", "at most that many"
        elif depth > DEEPEST:
            fault, allowed = f"more than {DEEPEST} nested blocks", "at most that many"
        else:
            continue
        line = event.start_mark.line + 1
        raise SceneError("", f"got {fault} on line {line}, expected {allowed}")


def _plain(loader: Any, node: Any, path: str, anchors: bool, depth: int = 0) -> Any:
    """Returns a node of a YAML text as plain data; refuses a key that is given twice.

    path: of the node, for messages.
    anchors: whether `<<` merges the keys of another block.
    depth: number of nodes around it.
    """
    if depth > DEEPEST:  # an alias within its own anchor never ends
        raise SceneError(path, f"got more than {DEEPEST} nested blocks, expected at most that many")
    if isinstance(node, yaml.SequenceNode):
        return [
            _plain(loader, item, f"{path}[{i}]", anchors, depth + 1)
            for i, item in enumerate(node.value)
        ]
    if isinstance(node, yaml.MappingNode):
        return _plain_block(loader, node, path, anchors, depth)
    if path.endswith("_rpm"):
        check_thousands(path, node.value)
    try:
        return loader.construct_object(node)
    except ValueError:  # Python reads no integer of thousands of digits
        raise SceneError(path, f"got {len(node.value)} digits, expected fewer") from None


def _plain_block(loader: Any, node: Any, path: str, anchors: bool, depth: int) -> dict[str, Any]:
    """Returns the keys and values of a block of a YAML text; parameters are those of `_plain`."""
    block: dict[str, Any] = {}
    merged: dict[str, Any] = {}
    for key_node, value_node in node.value:
        line = key_node.start_mark.line + 1
        if not isinstance(key_node, yaml.ScalarNode):
            problem = f"got a list or block as a key on line {line}, expected text"
            raise SceneError(path, problem)
        key = key_node.value
        whole_key = key_path(path, key)
        if key in block:
            problem = f"got this key a second time on line {line}, expected it once"
            raise SceneError(whole_key, problem)
        value = _plain(loader, value_node, whole_key, anchors, depth + 1)
        if key == "<<" and anchors and isinstance(value, dict):
            merged = value
        else:
            block[key] = value
    return merged | block
