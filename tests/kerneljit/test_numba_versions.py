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
"""Variable of the environment that makes kernels compile by the public interface of numba alone."""

# prints whether numba's internals are in use, and all numbers of a solve with their units
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
# of a kernel: a ball of 2 mm of a bearing, as text for two processes
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
# prints the class of a kernel under another version of numba
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
    """One kernel here and in a process with SWITCH set, to 1e-12; whole solves: the next test."""
    assert isinstance(body_forces, Kernel)
    arguments = eval(ARGUMENTS, {"Geometry": Geometry, "BallLoad": BallLoad})  # text of this file
    numbers = list(body_forces(*arguments))
    builds_on_internals, public_numbers = json.loads(program_output(KERNEL, **{SWITCH: "1"}))
    assert not builds_on_internals
    assert any(numbers)  # not all are zero
    np.testing.assert_allclose(public_numbers, numbers, rtol=1e-12)


@pytest.mark.long
@pytest.mark.parametrize("fidelity", ["race_control", "steady", "dynamic"])
def test_the_public_interface_of_numba_gives_the_same_numbers(fidelity):
    """All numbers of a solve, to 1e-12 of the largest of their variable.

    Error estimates agree to 1e-10, and the shaft torque to its rounding, for the reasons below.
    """
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
    """Older and newer ones than TESTED; with one of them, kernels are functions of numba itself."""
    for version in ("0.62.1", "0.69.0", "0.69.0rc1", "1.0.0", "0.100.0dev0+12.gab"):
        assert not is_tested(version)
    assert program_output(OTHER_VERSION, "0.69.0rc1").startswith("numba.")


@pytest.mark.parametrize("version", ["0.67.0", "0.68.1", "0.68.0rc1"])
def test_releases_of_tested_minor_versions_are_tested(version):
    """Releases for bugs, and candidates, belong to their minor version."""
    assert is_tested(version)


@pytest.mark.parametrize(("value", "is_plain"), [("0", False), ("1", True)])
def test_a_switch_avoids_the_internals_of_a_tested_version(monkeypatch, value, is_plain):
    """A copy of the project reads the variable of the environment anew."""
    monkeypatch.setenv(SWITCH, value)
    assert dataclasses.replace(PROJECT).is_plain == is_plain


def test_the_pinned_numba_is_the_newest_tested_one():
    """constraints.txt pins a version of the newest tested minor one, which is `TESTED[1]`.

    pyproject.toml allows older versions than the oldest tested, `TESTED[0]`.
    """
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    (allowed,) = (line for line in project["dependencies"] if line.startswith("numba"))
    name, oldest = allowed.split(">=")
    assert name == "numba" and tuple(map(int, oldest.split("."))) < TESTED[0]
    pinned = (ROOT / "constraints.txt").read_text(encoding="utf-8").split("\nnumba==")[1].split()[0]
    assert is_tested(pinned)
    assert tuple(map(int, pinned.split(".")[:2])) == TESTED[1]
