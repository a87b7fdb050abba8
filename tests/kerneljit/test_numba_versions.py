"""A version of numba whose internals are unknown solves as well, with the same numbers."""

import dataclasses
import json
import os
import subprocess
import sys
import tomllib

import numpy as np
import pytest
from support import ROOT, scene_file

from bearingwear.kernels.equilibrium.body_forces import body_forces
from bearingwear.kernels.params import BallLoad, Geometry
from bearingwear.kernels.project import PROJECT
from bearingwear.scene.read import load_scene
from kerneljit.kernel import Kernel
from kerneljit.versions import TESTED, is_tested

SWITCH = PROJECT.switch

SOLVE = """
import json, sys
import bearingwear
fidelity, file = sys.argv[1:]
scene = bearingwear.load(file).with_({"model.simulated_turns": 0.1})
dataset = bearingwear.solve(scene, fidelity)
assert dataset.status == "ok", dataset.message
numbers = {
    name: (v.attrs.get("units"), v.values.tolist())
    for name, v in dataset.data_vars.items()
    if v.dtype.kind in "fi"
}
numbers["strips"] = (None, dataset.sizes["strip"])
print(json.dumps(["kerneljit.code" in sys.modules, numbers]))
"""
ARGUMENTS = """(
    Geometry(9, 2e-3, 7.5e-3, 0.3, 2.5e-4, 3.5e-3, 3.6e-3, 1.1e-3, 1.2e-3, 1e11, 7800.0),
    2e-3,
    BallLoad(1, 0.0, 3000.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    0.0, 0.3, 0.9, 0.2, 0.95,
)"""
KERNEL = f"""
import json, sys
from bearingwear.kernels.equilibrium.body_forces import body_forces
from bearingwear.kernels.params import BallLoad, Geometry
numbers = list(body_forces(*{ARGUMENTS}))
print(json.dumps(["kerneljit.code" in sys.modules, numbers]))
"""
OTHER_VERSION = """
import numba, sys
numba.__version__ = sys.argv[1]
from bearingwear.kernels.linear import copy
print(type(copy).__module__, type(copy).__name__)
"""


def program_output(program, *arguments, **environment):
    """Returns what a program prints; environment: variables to set."""
    completed = subprocess.run(
        [sys.executable, "-c", program, *map(str, arguments)],
        env=os.environ | environment,
        capture_output=True,
        text=True,
    )
    assert completed.returncode == 0, completed.stderr
    return completed.stdout.strip()


def test_a_kernel_gives_the_same_numbers_without_numbas_internals():
    """One kernel here and in a process with SWITCH set; whole solves: the next test (long)."""
    assert isinstance(body_forces, Kernel)
    arguments = eval(ARGUMENTS, {"Geometry": Geometry, "BallLoad": BallLoad})
    numbers = list(body_forces(*arguments))
    builds_on_internals, public_numbers = json.loads(program_output(KERNEL, **{SWITCH: "1"}))
    assert not builds_on_internals and any(numbers)
    np.testing.assert_allclose(public_numbers, numbers, rtol=1e-12)


@pytest.mark.long
@pytest.mark.parametrize("fidelity", ["race_control", "steady", "dynamic"])
def test_the_public_interface_of_numba_gives_the_same_numbers(fidelity):
    arguments = (SOLVE, fidelity, scene_file("gyro_s1"))
    scene = load_scene(scene_file("gyro_s1"))
    builds_on_internals, numbers = json.loads(program_output(*arguments, **{SWITCH: ""}))
    assert builds_on_internals
    builds_on_internals, public_numbers = json.loads(program_output(*arguments, **{SWITCH: "1"}))
    assert not builds_on_internals
    assert numbers.keys() == public_numbers.keys() and len(numbers) > 30
    # Friction of strips that slip either way nearly cancels in the torque. A sum of n terms has an
    # error of at most n times the rounding of what they come to without their signs, which is here
    # friction times load times half the pitch diameter.
    bearing, mu = scene.bearing, scene.friction.ball_race
    load = np.max(numbers["contact_load"][1]) * bearing.ball_count
    largest = mu * load * 0.5e-3 * bearing.pitch_diameter_mm
    torque_error = np.finfo(float).eps * numbers["strips"][1] * largest
    for name, (units, number) in numbers.items():
        patched, public = np.array(number, float), np.array(public_numbers[name][1], float)
        # ratios may be as small as rounding, and are compared on a scale of at least one
        scale = np.nanmax(np.abs(patched), initial=1.0 if units == "1" else 0.0)
        # an error estimate is the difference of two solves with a looser tolerance
        allowed = 1e-10 if name.endswith("_error_estimate") else 1e-12
        atol = torque_error if name == "shaft_torque" else allowed * scale
        np.testing.assert_allclose(public, patched, rtol=0, atol=atol, err_msg=name)


def test_untested_versions_of_numba_compile_by_the_public_interface():
    for version in ("0.62.1", "0.69.0", "0.69.0rc1", "1.0.0", "0.100.0dev0+12.gab"):
        assert not is_tested(version)
    assert program_output(OTHER_VERSION, "0.69.0rc1").startswith("numba.")


def test_a_tested_version(monkeypatch):
    assert all(map(is_tested, ("0.67.0", "0.68.1", "0.68.0rc1")))
    for inputs, plain in (("0", False), ("1", True)):
        monkeypatch.setenv(SWITCH, inputs)
        assert dataclasses.replace(PROJECT).is_plain == plain


def test_the_pinned_numba_is_the_newest_tested_one():
    """pyproject.toml allows older versions than those tested; constraints.txt pins one of those."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    (allowed,) = (line for line in project["dependencies"] if line.startswith("numba"))
    name, oldest = allowed.split(">=")
    assert name == "numba" and tuple(map(int, oldest.split("."))) < TESTED[0]
    pinned = (ROOT / "constraints.txt").read_text(encoding="utf-8").split("\nnumba==")[1].split()[0]
    assert is_tested(pinned)
    assert tuple(map(int, pinned.split(".")[:2])) == TESTED[1]
