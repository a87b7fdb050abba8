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
    """Returns the recommended preload [N] by the methods in a file; NaN where none is allowed.

    recommendation: file of `bearingwear recommend`.
    methods: those that the file must have, with a preload or NaN.
    CaseFileError: the file is no recommendation for this scene, or lacks a method.
    """
    dataset = recommended_for(scene, load(recommendation))
    names = [PRELOAD_METHODS[flag] for flag in dataset["preload_method"].values.tolist()]
    preloads = dict(zip(names, dataset["preload"].values.tolist(), strict=True))
    for method in methods:
        if method not in preloads:
            raise CaseFileError(f"the recommendation does not contain {method}")
    return preloads


def with_preload(scene: Scene, method: str, preload_N: float) -> Scene:
    """Returns the scene with a preload method and a preload [N].

    A distribution of the preload keeps its shape: its mean, spread and ends change in proportion to
    the preload. A factor about the preload of the scene needs no change.

    scene: with a preload above 0 if that is uncertain.
    """
    distributions = dict(scene.uncertainty or {})
    if "preload_N" in distributions:
        scale = preload_N / scene.operation.preload_N
        spread = distributions["preload_N"]
        keys = ("mean", "standard_deviation", "median", "low", "high")
        values = {key: getattr(spread, key) for key in keys}
        scaled = {key: value * scale for key, value in values.items() if value is not None}
        distributions["preload_N"] = replace(spread, **scaled)
    return replace(with_method(scene, method, preload_N), uncertainty=distributions)
