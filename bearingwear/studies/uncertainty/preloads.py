"""The preloads at which lives are sampled, and a scene at one of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.scene.arrangement import with_method
from bearingwear.scene.scene import PRELOAD_METHODS, Scene
from bearingwear.studies.design.recommend import recommended_for


def recommended_preloads(
    scene: Scene, recommendation: Path, methods: Sequence[str] = ()
) -> dict[str, float]:
    """Returns the recommended preload [N] of each method in a file; NaN where there is none.

    methods: those that the file must have.
    CaseFileError: a file that is no recommendation for this scene, or lacks a method.
    """
    dataset = recommended_for(scene, load(recommendation))
    flags, values = dataset["preload_method"].values.tolist(), dataset["preload"].values.tolist()
    preloads = {PRELOAD_METHODS[flag]: value for flag, value in zip(flags, values, strict=True)}
    for method in methods:
        if method not in preloads:
            raise CaseFileError(f"the recommendation does not contain {method}")
    return preloads


def with_preload(scene: Scene, method: str, preload_N: float) -> Scene:
    """Returns the scene with a method and a preload, whose distribution is scaled with it."""
    distributions = dict(scene.uncertainty or {})
    if "preload_N" in distributions:
        scale, spread = preload_N / scene.operation.preload_N, distributions["preload_N"]
        scaled = {
            key: value * scale
            for key in ("mean", "standard_deviation", "median", "low", "high")
            if (value := getattr(spread, key)) is not None
        }
        distributions["preload_N"] = replace(spread, **scaled)
    return replace(with_method(scene, method, preload_N), uncertainty=distributions)
