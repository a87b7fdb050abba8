"""Compiles the kernels that most tests call; `make test` runs it while it checks the sources.

Otherwise the processes of the tests would each compile kernels, and wait for each other. The
arguments `unworn` and `worn` name kernels that share little code: one process can compile each.
"""

import sys

from support import scene_file

from bearingwear.lives.life import life
from bearingwear.scene.read import load_scene
from bearingwear.solvers.solve import solve

WORN_GROOVES = ["model.contact=auto", "model.normal_balance=frictionless"]
"""Settings with which a life follows the profiles of the grooves."""

if "unworn" in sys.argv:
    plain = load_scene(scene_file("gyro_s1"), ["model.simulated_turns=0.1"])
    for fidelity in ("race_control", "steady", "dynamic"):
        solve(plain, fidelity)
    life(load_scene(scene_file("gyro_s1")))
if "worn" in sys.argv:
    life(load_scene(scene_file("gyro_s1"), WORN_GROOVES))
