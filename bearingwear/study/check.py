"""The scene at a recommended preload and beside it, to be solved in time as well.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import xarray as xr
import yaml

from bearingwear.io.whole import write_text
from bearingwear.model.scene import Scene
from bearingwear.study.design import best_method, recommended_for
from bearingwear.study.grid import PRELOAD_METHODS

TURNS = 200.0
"""Shaft turns at the most: the blows of a cage take longer to average out than contacts to settle.
A run that is settled ends before."""


def check_scene(scene: Scene, recommendation: xr.Dataset, times: float) -> Scene:
    """The scene with the recommended method, and its preload times a factor.

    Where no preload is recommended, with the scene's own method and preload times the factor.

    Raises
    ------
    CaseFileError
        Where the recommendation is not of this scene.
    SceneError
        A preload that cannot be.
    """
    recommended_for(scene, recommendation)
    method, preload = scene.operation.preload_method, scene.operation.preload_N
    k = best_method(recommendation)
    if k is not None:
        method = PRELOAD_METHODS[int(recommendation["preload_method"][k])]
        preload = float(recommendation["preload"][k])
    operation = replace(scene.operation, preload_method=method, preload_N=times * preload)
    model = replace(scene.model, simulated_turns=max(TURNS, scene.model.simulated_turns))
    # its spread is that of another preload
    return replace(scene, operation=operation, uncertainty=None, model=model)


def write_check_scene(
    scene: Scene, recommendation: xr.Dataset, times: float, path: str | Path
) -> None:
    """Write `check_scene` as a scene file."""
    text = yaml.safe_dump(
        check_scene(scene, recommendation, times).to_dict(), sort_keys=False, allow_unicode=True
    )
    head = f"# {scene.name} at {times:g} times its recommended preload.\n"
    write_text(path, head + text)
