"""Applications: commands that use the rest of the program, each in a folder of `applications`.

A folder's `__init__` gives its command, and the dotted names (`module:function`) of its handler,
functions, sheets and figures. Nothing is imported before it is needed. No other code refers to the
folder: if it is deleted, only its command is missing (docs/develop.md).
"""

from __future__ import annotations

import functools
import importlib
import os
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

_FOLDER = os.path.join(os.path.dirname(__file__), "applications")


class Application(NamedTuple):
    """What an application adds to the command line, to Python, to `show` and to `plot`."""

    command: str
    description: str  # of the command, in --help
    add_options: Callable[[Any], None]  # to the parser of the command
    handler: str  # a function of the parsed arguments, which returns the exit status
    functions: Mapping[str, str] = {}  # by their names in `bearingwear`
    sheets: Mapping[str, str] = {}  # by the kind of the file
    plots: Mapping[str, str] = {}  # by the kind of the file


@functools.cache
def applications() -> tuple[Application, ...]:
    """Returns the applications that are installed, in the order of their folders."""
    folders = sorted(os.listdir(_FOLDER))
    names = [name for name in folders if os.path.isfile(f"{_FOLDER}/{name}/__init__.py")]
    modules = [importlib.import_module(f"bearingwear.applications.{name}") for name in names]
    return tuple(module.APPLICATION for module in modules)


def application_functions() -> dict[str, str]:
    """Returns dotted names of all applications' functions, by their names in `bearingwear`."""
    return {name: dotted for app in applications() for name, dotted in app.functions.items()}


def application_sheets() -> dict[str, str]:
    """Returns dotted names of the sheets of all applications, by the kind of the file."""
    return {kind: dotted for app in applications() for kind, dotted in app.sheets.items()}


def application_plots() -> dict[str, str]:
    """Returns dotted names of the figures of all applications, by the kind of the file."""
    return {kind: dotted for app in applications() for kind, dotted in app.plots.items()}
