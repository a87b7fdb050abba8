"""The studies: each is a folder with a plan, steps, figures and tables; this is their registry.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bearingwear.studies.protocol import Study

NAMES = ("grid", "uncertainty", "lives", "design", "identify", "cage", "accuracy", "robustness")


def read(config: Mapping[str, Any]) -> dict[str, Study]:
    """The studies by their names, as `config` and the files config/NAME.yaml describe them.

    A study whose file is not there is left out; the main one is described by `config`.

    Raises
    ------
    ValueError
        One line: what is wrong with a configuration.
    """
    return {
        name: importlib.import_module(f"bearingwear.studies.{name}.study").study(config)
        for name in NAMES
        if name == NAMES[0] or Path(f"config/{name}.yaml").is_file()
    }


def registry(name: str) -> dict[str, str]:
    """What the studies' modules say under a name: SHEETS or PLOTS, by the kind of a file."""
    found: dict[str, str] = {}
    for study in NAMES:
        module = importlib.import_module(f"bearingwear.studies.{study}.study")
        found |= getattr(module, name, {})
    return found


def files(studies: Mapping[str, Study]) -> list[str]:
    """Every file that a study makes by default or is made from."""
    return [
        *(path for study in studies.values() for path in study.default_targets()),
        *dict.fromkeys(path for study in studies.values() for path in study.inputs()),
    ]
