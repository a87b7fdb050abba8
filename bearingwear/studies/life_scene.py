"""Scenes whose lives a study finds by the steady model."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from bearingwear.scene.friction import changes_as_it_wears
from bearingwear.scene.scene import Scene, SceneError


def life_scene(path: str | Path, settings: Sequence[str] = (), films: bool = False) -> Scene:
    """A scene with an end of life and a steady state; `films` says whether it may have any.

    May raise SceneError.
    """
    from bearingwear.scene.read import for_life, load_scene
    from bearingwear.solvers.effects.choice import choice_for_life

    scene = for_life(load_scene(path, settings), os.fspath(path))
    if not films and (scene.friction.film is not None or changes_as_it_wears(scene)):
        raise SceneError(
            "friction.film",
            "got a film, or materials with one or with running_in, expected, for a study, one "
            f"friction.ball_race (for its own life: bearingwear life {os.fspath(path)})",
            source=os.fspath(path),
        )
    fidelity = choice_for_life(scene).fidelity
    if fidelity != "steady":
        raise SceneError(
            "",
            f"got a scene whose life is found by {fidelity}, expected one with a steady "
            f"state (for its own life: bearingwear life {os.fspath(path)} --fidelity dynamic)",
            source=os.fspath(path),
        )
    return scene
