"""Compiles the kernels of a model before many processes need them."""

from __future__ import annotations

from pathlib import Path

from bearingwear.scene.read import load_scene
from bearingwear.studies.launch import snakefile

_WORN_GROOVES = ("model.contact=auto", "model.normal_balance=frictionless")
"""Changes of the example with which a life follows its worn grooves."""


def compile_model(model: str) -> None:
    """Solves cases or lives that call every kernel of a model, which numba then stores on disk.

    The results are dropped. Cases are solved with slip on the centre line of the contact, as the
    example has it (`model.contact=paper`), and over the whole ellipse.

    model {"steady", "worn", "dynamic"}: "worn" stands for lives, with Hertzian and worn grooves.
    NoStudy: there is no workflow, which contains the example.
    """
    from bearingwear.lives.life import life
    from bearingwear.solvers.solve import solve

    example = Path(snakefile().parent / "config" / "scenes" / "gyro_s1.yaml")
    if model == "worn":
        life(load_scene(example))
        life(load_scene(example, _WORN_GROOVES))
    elif model == "dynamic":
        turns = ["model.simulated_turns=0.1"]  # a few steps call all kernels
        solve(load_scene(example, turns), "dynamic")
        solve(load_scene(example, [*turns, "model.contact=hertz"]), "dynamic")
    else:
        solve(load_scene(example), "steady")
        solve(load_scene(example, ["model.contact=hertz"]), "steady")
