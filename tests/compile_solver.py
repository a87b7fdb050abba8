"""Compiles what most tests call, before they begin: `make test` does it while it checks the text.

One process types once what kernels share, where the processes of the tests would each do it, and
wait for each other. `unworn` and `worn` share little, and take a core each.
"""

import sys

from support import scene_file

from bearingwear.lives.life import life
from bearingwear.scene.read import load_scene
from bearingwear.solvers.solve import solve

FOLLOWED = ["model.contact=auto", "model.normal_balance=frictionless"]
"""Grooves as they wear."""

if "unworn" in sys.argv:
    plain = load_scene(scene_file("gyro_s1"), ["model.simulated_turns=0.1"])
    for fidelity in ("race_control", "steady", "dynamic"):
        solve(plain, fidelity)
    life(load_scene(scene_file("gyro_s1")))
if "worn" in sys.argv:
    life(load_scene(scene_file("gyro_s1"), FOLLOWED))
