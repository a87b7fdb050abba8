"""The scene at a recommended preload and beside it, to be solved dynamically as well.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import xarray as xr

from bearingwear.results.netcdf import load
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.checking.strict_yaml import yaml_of
from bearingwear.scene.scene import PRELOAD_METHODS, Scene
from bearingwear.studies.design.recommend import best_method, recommended_for
from bearingwear.studies.solve import life_scene

TURNS = 200.0
"""Most shaft turns: impacts of a cage take longer to average out than contacts to settle.
A run that is settled ends before."""


def check_scene(scene: Scene, recommendation: xr.Dataset, times: float) -> Scene:
    """The scene with the recommended method, and its preload times a factor.

    Where no preload is recommended, with the scene's own method and preload times the factor.
    """
    recommended_for(scene, recommendation)
    method, preload = scene.operation.preload_method, scene.operation.preload_N
    k = best_method(recommendation)
    if k is not None:
        method = PRELOAD_METHODS[int(recommendation["preload_method"][k])]
        preload = float(recommendation["preload"][k])
    model = replace(scene.model, simulated_turns=max(TURNS, scene.model.simulated_turns))
    # its spread is that of another preload
    return replace(held_by(scene, method, times * preload), uncertainty=None, model=model)


def check_scene_text(scene: Path, recommendation: Path, times: float) -> str:
    """Step: `check_scene` as a scene file."""
    base = life_scene(scene)
    plain = check_scene(base, load(recommendation), times).to_dict()
    head = f"# {base.name} at {times:g} times its recommended preload.\n"
    return head + yaml_of(plain)
