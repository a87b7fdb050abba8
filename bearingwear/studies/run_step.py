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
_OUR_PACKAGES = ("bearingwear.", "workflow.")


class NotSolved(Exception):
    """Something in a study was not solved or is wrong; its text may have several lines."""


class StepError(UsageError):
    """A function that does not exist, or is called with wrong arguments; one line."""


def run_step(name: str, words: Sequence[str], outputs: Sequence[Path]) -> None:
    """Calls a function and writes its outputs, each whole or not at all.

    name: dotted name of the function.
    words: its arguments, `NAME=VALUE`; words that follow belong to the same list. The annotation of
        a parameter says whether they are paths, texts or plain data. A parameter without words
        takes its default.
    NotSolved: raised by the function itself; nothing is written.
    StepError: no such function, wrong arguments, or a number of outputs that does not fit.
    """
    function = _function(name)
    try:
        values = arguments(inspect.signature(function), words)
        call = inspect.signature(function).bind(**values)
    except (TypeError, ValueError) as error:
        raise StepError(f"step: got wrong arguments for {name}; {error}") from None
    results = function(*call.args, **call.kwargs)
    if _is_a(results, "Figure"):
        _save(results, outputs)
    else:
        write_outputs(results if isinstance(results, (tuple, Iterator)) else [results], outputs)


def _function(name: str) -> Any:
    """Returns a function of this program by its dotted name.

    StepError: a name outside of the program, or of no function.
    """
    module, _, function = name.rpartition(".")
    if not module.startswith(_OUR_PACKAGES):
        raise StepError(f"step: got {name}, expected bearingwear.MODULE.FUNCTION")
    try:
        return getattr(importlib.import_module(module), function)
    except (ModuleNotFoundError, AttributeError) as error:
        if isinstance(error, ModuleNotFoundError) and not module.startswith(str(error.name)):
            raise  # a library that is not installed
        raise StepError(f"step: got {name}, which does not exist") from None


def arguments(signature: inspect.Signature, words: Sequence[str]) -> dict[str, Any]:
    """Returns the arguments of a function by name, from words `NAME=VALUE` and further values.

    A parameter that is a sequence takes all values as a list, others exactly one. `NAME=` alone
    gives an empty list to a sequence; another parameter is left out, and takes its default. The
    last of several words with the same name counts.

    ValueError: a value before the first name, or several for a parameter that takes one.
    """
    texts: dict[str, list[str]] = {}
    name = ""
    for word in words:
        if named := _NAMED.fullmatch(word):
            name, word = named.groups()
            texts[name] = []
        if not name:
            raise ValueError(f"got {word!r}, expected NAME=VALUE")
        texts[name] += [word] if word else []
    values_by_name: dict[str, Any] = {}
    for name, values in texts.items():
        parameter = signature.parameters.get(name)
        annotation = str(parameter.annotation) if parameter else ""
        parsed: list[Any] = [
            Path(text) if "Path" in annotation else _typed_value(text, annotation)
            for text in values
        ]
        if annotation.partition("[")[0].endswith(("Sequence", "Iterable")):
            is_written_as_list = len(parsed) == 1 and isinstance(parsed[0], list)
            values_by_name[name] = parsed[0] if is_written_as_list else parsed
        elif len(parsed) > 1:
            raise ValueError(f"got {len(parsed)} values of {name}, expected one")
        elif parsed:
            values_by_name[name] = parsed[0]
    return values_by_name


def _typed_value(text: str, annotation: str) -> Any:
    """Returns the value that a word of a command stands for: a text, or data written in Python.

    annotation: of the parameter, as text or as `str` prints it; `str` keeps the word as it is.
    """
    if annotation.startswith(("str", "<class 'str'>")):
        return text
    try:
        return ast.literal_eval(text)
    except (ValueError, SyntaxError):
        return text


def write_outputs(results: Iterator[Any] | Sequence[Any], outputs: Sequence[Path]) -> None:
    """Writes each result to its file, and a figure to all files that differ only in their format.

    StepError: more results than files, or more files than results; what fits is written before.
    """
    paths_left = list(outputs)
    for result in results:
        if not paths_left:
            raise StepError(f"step: got {len(outputs)} files, expected one for each result")
        path = paths_left.pop(0)
        if _is_a(result, "Figure"):
            formats = [path]
            while paths_left and paths_left[0].with_suffix("") == path.with_suffix(""):
                formats.append(paths_left.pop(0))
            _save(result, formats)
        else:
            write_output(result, path)
    if paths_left:
        raise StepError(f"step: got no result for {paths_left[0]}")


def _save(figure: Any, paths: Sequence[Path]) -> None:
    """Saves a figure under each path, in the format of its suffix."""
    from bearingwear.plotting.drawing import save

    save(figure, paths)


def _is_a(result: Any, name: str) -> bool:
    """Whether a result is an instance of the class of this name; nothing is imported."""
    return any(kind.__name__ == name for kind in type(result).__mro__)


def write_output(result: Any, path: Path) -> None:
    """Writes a text, or a `Result` or an `xarray.Dataset` as netCDF, whole or not at all."""
    if isinstance(result, str):
        from bearingwear.atomic import write_text

        write_text(path, result)
    elif _is_a(result, "Result"):
        from bearingwear.results.netcdf import write_result

        write_result(result, path)
    else:
        from bearingwear.studies.dataset import write_dataset

        write_dataset(result, path)
