"""Functions that tests of several folders share: paths, scenes, differences, steps of studies."""

import ast
import functools
import importlib.util
import re
import shutil
import sys
import types
from collections.abc import Callable
from pathlib import Path

import numpy as np

import bearingwear
from bearingwear.cli import main
from bearingwear.kernels.steady.balance import BalanceProblem, balance_problem
from bearingwear.provenance import COMPILER
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem

ROOT = Path(__file__).resolve().parents[1]

PACKAGES = bearingwear.__name__, COMPILER
"""The packages that are imported together."""


def copy_tree(folder: Path, *names: str) -> None:
    """Copies packages, or other folders of the project, without compiled Python files."""
    ignored = shutil.ignore_patterns("__pycache__")
    for name in names:
        shutil.copytree(ROOT / name, folder / name, ignore=ignored)


def scene_file(name: str) -> Path:
    """Returns the path of a scene of the project's study."""
    return ROOT / "config" / "scenes" / f"{name}.yaml"


def warm_spindle() -> Scene:
    """Returns a bearing of 40 mm bore in a rigid pair, with a thermal network and capacities."""
    conductances = {"inner_ring_shaft": 2.0, "outer_ring_housing": 4.0, "ball_race": 1.0}
    capacities = {"inner_ring": 30.0, "balls": 12.0, "outer_ring": 40.0}
    scene = bearingwear.new(
        bore=40, outside=68, contact_angle=15, speed=12000, preload=140,
        preload_method="fixed_position",
    )  # fmt: skip
    network = {"conductance_W_K": conductances, "heat_capacity_J_K": capacities}
    return scene.with_({"thermal": network})


SLOW_HOUSING = {"thermal.housing_time_constant_s": 300.0, "thermal.housing_C": 35.0}
"""Changes of `warm_spindle` by which its housing warms more slowly than its bearings."""


@functools.cache
def syntax_nodes(file: Path) -> list[ast.AST]:
    """Returns the syntax nodes of a source file, the module first."""
    return list(ast.walk(ast.parse(file.read_bytes())))


def benchmark(name: str):
    """Returns a program of `benchmarks/` as a module, which may import others from there."""
    path = ROOT / "benchmarks" / f"{name}.py"
    if str(path.parent) not in sys.path:
        sys.path.append(str(path.parent))
    spec = importlib.util.spec_from_file_location(f"benchmark_{name}", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look themselves up there
    spec.loader.exec_module(module)
    return module


@functools.cache
def in_python(kernel, *compiled) -> Callable:
    """Returns a kernel as plain Python, which also calls other kernels as plain Python.

    A formula that is evaluated a few times is not worth compiling, which takes seconds.

    compiled: kernels that are called as compiled code all the same.
    """
    function = getattr(kernel, "py_func", kernel)
    global_names = dict(function.__globals__)
    for name in function.__code__.co_names:
        callee = global_names.get(name)
        is_function = hasattr(callee, "py_func") or isinstance(callee, types.FunctionType)
        if is_function and callee.__module__.startswith("bearingwear.") and callee not in compiled:
            global_names[name] = in_python(callee, *compiled)
    return types.FunctionType(
        function.__code__,
        global_names,
        function.__name__,
        function.__defaults__,
        function.__closure__,
    )


def balance_of(problem: ThrustProblem, D: float) -> BalanceProblem:
    """Returns the equations of motion of a ball of diameter D [m]."""
    return in_python(balance_problem)(problem.bearing(D), problem.rule, problem.traction)


def by_differences(function, point, steps) -> np.ndarray:
    """Returns the derivatives of a function at a point by central differences.

    Row i is the derivative with respect to coordinate i of the point.

    function: of a tuple of coordinates; it returns a number or an array.
    steps: for each coordinate, in its unit.
    """
    rows = []
    for i, step in enumerate(steps):
        below, above = list(point), list(point)
        below[i] -= step
        above[i] += step
        rows.append((function(tuple(above)) - function(tuple(below))) / (2.0 * step))
    return np.array(rows)


def numbers_in(text: str) -> list[float]:
    """Returns the numbers in a text in their order, without digits that are part of a name."""
    return [float(number) for number in re.findall(r"(?<![\w.-])-?\d+(?:\.\d+)?(?:e-?\d+)?", text)]


def without_waits(text: str) -> str:
    """Returns output without its lines on the time so far, which only a slow machine prints."""
    return re.sub(r"^.*\brunning for \d+ s.*\n", "", text, flags=re.M)


def only_line(capsys) -> str:
    """Returns the line that a command printed to standard error; fails if it printed more."""
    out, err = capsys.readouterr()
    assert not out and err.count("\n") == 1, (out, err)
    return err


def step_arguments(run: str, *outputs, settings: dict | None = None, **inputs) -> list[str]:
    """Returns arguments of `bearingwear` that run a step, as a rule of the workflow does.

    Parameters
    ----------
    run : str
        The function, such as `studies.grid.gather.gathered_study`.
    *outputs : path
        Files that the step writes.
    settings : dict, optional
        Arguments of the function that are no files.
    **inputs : path, or list of paths
        Arguments of the function that are files.
    """
    words = []
    for name, paths in inputs.items():
        listed = [paths] if isinstance(paths, str | Path) else paths
        words += [f"{name}=", *map(str, listed)]
    for name, value in (settings or {}).items():
        words.append(f"{name}={value if isinstance(value, str) else repr(value)}")
    return ["step", dotted(run), *words, "-o", *map(str, outputs)]


def dotted(run: str) -> str:
    """Returns the dotted name of a function of a study, which is in `bearingwear` or `workflow`."""
    study = run.split(".")[1]
    is_in_workflow = (ROOT / "workflow" / "studies" / study).is_dir()
    return f"{'workflow' if is_in_workflow else 'bearingwear'}.{run}"


def step(run: str, *outputs, settings: dict | None = None, **inputs) -> int:
    """Runs a step and returns its exit status. Arguments: `step_arguments`."""
    return main(step_arguments(run, *outputs, settings=settings, **inputs))
