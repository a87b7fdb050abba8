"""Solves a scene with some keys changed: a case, or its life. Steps of several studies do."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

from bearingwear.scene.read import for_life, variant
from bearingwear.solvers.result import Result

NONE: Mapping[str, Any] = MappingProxyType({})


def solved_case(
    scene: str | Path, changes: Mapping[str, Any] = NONE, fidelity: str | None = None
) -> Result:
    """One case. A failure is in its status and on standard error."""
    from bearingwear.solvers.solve import solve

    solved = solve(variant(scene, changes), fidelity, progress=_report)
    return told(solved, scene)


def solved_life(
    scene: str | Path, changes: Mapping[str, Any] = NONE, fidelity: str | None = None
) -> Result:
    """The wear life of a scene. A failure is reported as by `told`."""
    from bearingwear.lives.life import life

    return told(life(for_life(variant(scene, changes), str(scene)), fidelity, _report), scene)


def told(result: Result, scene: str | Path) -> Result:
    """The result; a failure is reported on standard error."""
    if result.status != "ok":
        _report(f"{scene}: {result.status}: {result.reason}")
    return result


def _report(text: str) -> None:
    sys.stderr.write(f"{text}\n")
    sys.stderr.flush()
