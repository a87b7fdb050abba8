"""Runs one step of a study: calls its function and writes what that returns.

The rules of the workflow call it as `bearingwear step STEP NAME=FILE ... -o FILE ...`.
"""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from bearingwear.console import UsageError
from bearingwear.studies import module_name

_OURS = ("bearingwear", "workflow")


class NotSolved(Exception):
    """Something in a study was not solved or is wrong; its text may have several lines."""


class StepError(UsageError):
    """A step that does not exist, or is called with wrong arguments; one line."""


def run_step(
    step: str,
    inputs: Mapping[str, Any],
    settings: Mapping[str, Any],
    outputs: Sequence[Path],
    workers: int = 1,
) -> None:
    """Call the function of a step and write its outputs, each whole or not at all.

    workers: processes, for a function that takes `workers`; they decide nothing.
    NotSolved: where the step itself fails; nothing is written.
    """
    function = _function(step)
    signature = inspect.signature(function)
    shared = {"workers": workers} if "workers" in signature.parameters else {}
    try:
        arguments = signature.bind(**shared, **inputs, **settings)
    except TypeError as error:
        raise StepError(f"step: got wrong arguments for {step}; {error}") from None
    made = function(*arguments.args, **arguments.kwargs)
    if isinstance(made, (tuple, Iterator)):
        for one, path in zip(made, outputs, strict=True):
            write_outputs(one, [path])
    else:
        write_outputs(made, outputs)


def _function(step: str) -> Any:
    module, _, name = step.rpartition(".")
    if not module.startswith(("studies.", "page.")):
        raise StepError(f"step: got {step}, expected studies.STUDY.MODULE.FUNCTION")
    try:
        return getattr(importlib.import_module(module_name(module)), name)
    except (ModuleNotFoundError, AttributeError) as error:
        if isinstance(error, ModuleNotFoundError) and not str(error.name).startswith(_OURS):
            raise  # a library that is not installed
        raise StepError(f"step: got {step}, which does not exist") from None


def write_outputs(made: Any, outputs: Sequence[Path]) -> None:
    """Write a Result, a Dataset or a text to its one output, a Figure to all of them."""
    if isinstance(made, str):
        from bearingwear.atomic import write_text

        (path,) = outputs
        write_text(path, made)
        return
    kinds = {kind.__name__ for kind in type(made).__mro__}
    if "Figure" in kinds:
        from bearingwear.plotting.drawing import save

        save(made, outputs)
    elif "Result" in kinds:
        from bearingwear.results.netcdf import write_result

        (path,) = outputs
        write_result(made, path)
    else:
        from bearingwear.studies.dataset import write_dataset

        (path,) = outputs
        write_dataset(made, path)
