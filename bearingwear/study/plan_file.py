"""Reads the files that say what the studies beside the main one solve, with one line for a fault.

This file imports nothing heavy: the Snakefile reads plans each time it is parsed.
"""

import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeVar

import yaml

from bearingwear.model.scene import SceneError

T = TypeVar("T")


def read_plan(path: str | Path, build: Callable[[Any], T]) -> T:
    """What `build` makes of the data in a YAML file.

    Raises
    ------
    SceneError
        One line that names the file: it cannot be read, or `build` raised a KeyError for a key that
        is missing, a TypeError or AttributeError for a value of another kind, or a ValueError.
    """
    try:
        return build(yaml.safe_load(Path(path).read_text(encoding="utf-8")))
    except (OSError, TypeError, AttributeError, ValueError, yaml.YAMLError) as error:
        problem = " ".join(str(error).split())
    except KeyError as error:
        problem = f"{error}: given nothing"
    raise SceneError("", problem, source=os.fspath(path))


def known(given: Any, allowed: Iterable[Any], where: str) -> None:
    """Refuse what is not one of the allowed values.

    Raises
    ------
    ValueError
    """
    if given not in allowed:
        raise ValueError(f"{where}: given {given}; allowed {', '.join(map(str, allowed))}")
