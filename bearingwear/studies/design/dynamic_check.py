"""The scene at a recommended preload and beside it, to be solved dynamically as well.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import xarray as xr

from bearingwear.results.netcdf import load
from bearingwear.scene.arrangement import with_method
from bearingwear.scene.checking.strict_yaml import yaml_of
from bearingwear.scene.scene import PRELOAD_METHODS, Scene
from bearingwear.studies.design.recommend import best_method, recommended_for
from bearingwear.studies.solve import life_scene

TURNS = 200.0
"""Shaft turns that a check simulates at most, unless the scene simulates more.

A run that has settled ends before. Impacts of a cage take longer to average out than contacts to
settle.
"""


def check_scene(scene: Scene, recommendation: xr.Dataset, times: float) -> Scene:
    """Returns the scene with the recommended method, and its preload times a factor.

    The method is the one with the longest life. Where no preload is recommended, the scene keeps
    its own method, and its own preload is multiplied. A run simulates up to `TURNS`, or more if the
    scene does.

    recommendation: for this scene, else a CaseFileError is raised.
    times: the factor.
    """
    recommended_for(scene, recommendation)
    best = best_method(recommendation)
    if best is None:
        method = scene.operation.preload_method
        preload = scene.operation.preload_N
    else:
        method = PRELOAD_METHODS[int(recommendation["preload_method"][best])]
        preload = float(recommendation["preload"][best])
    model = replace(scene.model, simulated_turns=max(TURNS, scene.model.simulated_turns))
    # the uncertainty of the scene is that of another preload
    return replace(with_method(scene, method, times * preload), uncertainty=None, model=model)


def check_scene_text(scene: Path, recommendation: Path, times: float) -> str:
    """Step: returns a scene at a factor times its recommended preload, as the text of a file.

    recommendation: file of `bearingwear recommend`.
    times: the factor.
    """
    base = life_scene(scene)
    plain = check_scene(base, load(recommendation), times).to_dict()
    comment = f"# {base.name} at {times:g} times its recommended preload.\n"
    return comment + yaml_of(plain)
