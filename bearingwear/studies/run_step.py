"""Calls a function of the program for a rule of the workflow, and writes what it returns.

Rules call it as `bearingwear step FUNCTION NAME=VALUE ... -o FILE ...`.
"""

from __future__ import annotations

import ast
import importlib
import inspect
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from bearingwear.console import UsageError

_NAMED = re.compile(r"([a-z]\w*)=(.*)", re.DOTALL)
_OURS = ("bearingwear.", "workflow.")


class NotSolved(Exception):
    """Something in a study was not solved or is wrong; its text may have several lines."""


class StepError(UsageError):
    """A function that does not exist, or is called with wrong arguments; one line."""


def run_step(name: str, words: Sequence[str], outputs: Sequence[Path]) -> None:
    """Call a function and write its outputs, each whole or not at all.

    name: its dotted name.
    words: its arguments, `NAME=VALUE`; words that follow belong to the same list. The annotation of
        a parameter says whether they are paths, texts, or plain data. A parameter without
        words takes its default.
    NotSolved: where the function itself fails; nothing is written.
    """
    function = _function(name)
    try:
        given = arguments(inspect.signature(function), words)
        called = inspect.signature(function).bind(**given)
    except (TypeError, ValueError) as error:
        raise StepError(f"step: got wrong arguments for {name}; {error}") from None
    made = function(*called.args, **called.kwargs)
    if _is_a(made, "Figure"):
        _save(made, outputs)
    else:
        write_outputs(made if isinstance(made, (tuple, Iterator)) else [made], outputs)


def _function(name: str) -> Any:
    module, _, function = name.rpartition(".")
    if not module.startswith(_OURS):
        raise StepError(f"step: got {name}, expected bearingwear.MODULE.FUNCTION")
    try:
        return getattr(importlib.import_module(module), function)
    except (ModuleNotFoundError, AttributeError) as error:
        if isinstance(error, ModuleNotFoundError) and not module.startswith(str(error.name)):
            raise  # a library that is not installed
        raise StepError(f"step: got {name}, which does not exist") from None


def arguments(signature: inspect.Signature, words: Sequence[str]) -> dict[str, Any]:
    """Arguments of a function by name, from `NAME=VALUE` and values that follow."""
    texts: dict[str, list[str]] = {}
    name = ""
    for word in words:
        if named := _NAMED.fullmatch(word):
            name, word = named.groups()
            texts[name] = []
        if not name:
            raise ValueError(f"got {word!r}, expected NAME=VALUE")
        texts[name] += [word] if word else []
    found: dict[str, Any] = {}
    for name, values in texts.items():
        kind = str(getattr(signature.parameters.get(name), "annotation", ""))
        each: list[Any] = [Path(one) if "Path" in kind else _value(one, kind) for one in values]
        if kind.partition("[")[0].endswith(("Sequence", "Iterable")):
            found[name] = each[0] if len(each) == 1 and isinstance(each[0], list) else each
        elif len(each) > 1:
            raise ValueError(f"got {len(each)} values of {name}, expected one")
        elif each:
            found[name] = each[0]
    return found


def _value(text: str, kind: str) -> Any:
    """A text, or a number, list or block as a rule's params are written in its command."""
    if kind.startswith("str"):
        return text
    try:
        return ast.literal_eval(text)
    except (ValueError, SyntaxError):
        return text


def write_outputs(made: Iterator[Any] | Sequence[Any], outputs: Sequence[Path]) -> None:
    """Write each result to its file; a figure to the files of one name in several formats."""
    left = list(outputs)
    for one in made:
        if not left:
            raise StepError(f"step: got {len(outputs)} files, expected one for each result")
        first = left.pop(0)
        if _is_a(one, "Figure"):
            formats = [first]
            while left and left[0].with_suffix("") == first.with_suffix(""):
                formats.append(left.pop(0))
            _save(one, formats)
        else:
            write_output(one, first)
    if left:
        raise StepError(f"step: got no result for {left[0]}")


def _save(figure: Any, paths: Sequence[Path]) -> None:
    from bearingwear.plotting.drawing import save

    save(figure, paths)


def _is_a(made: Any, name: str) -> bool:
    return any(kind.__name__ == name for kind in type(made).__mro__)


def write_output(made: Any, path: Path) -> None:
    """Write a text, a Result or a Dataset."""
    if isinstance(made, str):
        from bearingwear.atomic import write_text

        write_text(path, made)
    elif _is_a(made, "Result"):
        from bearingwear.results.netcdf import write_result

        write_result(made, path)
    else:
        from bearingwear.studies.dataset import write_dataset

        write_dataset(made, path)
