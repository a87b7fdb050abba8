"""Compiles the kernels that most tests use, so that test processes side by side need not.

Each kind of model is solved once, as coarsely as may be; what is compiled already takes a second.
"""

from support import scene_file

from bearingwear.model.life import life
from bearingwear.model.solve import solve
from bearingwear.scene.read import load_scene

COARSE = ("model.strips=4", "model.tolerance=1.0e-2", "model.simulated_turns=0.02")

if __name__ == "__main__":
    for fidelity, *changes in (
        ("race_control",),
        ("steady", "operation.preload_method=constant_force"),
        ("steady", "operation.preload_method=fixed_position"),
        ("dynamic",),
        ("dynamic", "model.integrator=runge_kutta"),
    ):
        solve(load_scene(scene_file("gyro_s1"), [*COARSE, *changes]), fidelity)
    life(load_scene(scene_file("gyro_s1"), [*COARSE, "operation.preload_method=fixed_position"]))
