"""The studies: each is a folder with a plan, steps, figures and tables; this is their registry.

Those that bearings are designed with are in this package, those that need the repository in
`workflow/studies`.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bearingwear.studies.protocol import Study

_ROOT = Path(__file__).resolve().parents[2]

INSTALLED = ("grid", "uncertainty", "lives", "design", "cage")
IN_REPOSITORY = tuple(
    sorted(file.parent.name for file in _ROOT.glob("workflow/studies/*/study.py"))
)
"""Studies that are not installed: they need the repository, and are found in it."""

NAMES = (*INSTALLED, *IN_REPOSITORY)
if IN_REPOSITORY:
    sys.path.append(str(_ROOT))


def module_name(name: str) -> str:
    """Dotted name of the module that a step names: `studies.grid.solve`, `studies.accuracy.run`."""
    study = f"{name}.".split(".")[1]
    return f"{'workflow' if study in IN_REPOSITORY else 'bearingwear'}.{name}"


def read(config: Mapping[str, Any]) -> dict[str, Study]:
    """The studies by their names, as `config` and the files config/NAME.yaml describe them.

    A study whose file is not there is left out; the main one is described by `config`.

    ValueError: what is wrong with a configuration.
    """
    return {
        name: _module(name).study(config)
        for name in NAMES
        if name == NAMES[0] or Path(f"config/{name}.yaml").is_file()
    }


def registry(name: str) -> dict[str, str]:
    """Entries of the studies' modules under SHEETS or PLOTS, by the kind of a file."""
    found: dict[str, str] = {}
    for study in NAMES:
        found |= getattr(_module(study), name, {})
    return found


def _module(study: str) -> Any:
    return importlib.import_module(module_name(f"studies.{study}.study"))


def files(studies: Mapping[str, Study]) -> list[str]:
    """Every file that a study makes by default or is made from."""
    return [
        *(path for study in studies.values() for path in study.default_targets()),
        *dict.fromkeys(path for study in studies.values() for path in study.inputs()),
    ]
