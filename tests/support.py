"""Where things are, and how a step of a study is run, for tests of every kind."""

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
    """Copy packages, or other folders of the project, without what Python has made of them."""
    ignored = shutil.ignore_patterns("__pycache__")
    for name in names:
        shutil.copytree(ROOT / name, folder / name, ignore=ignored)


def scene_file(name: str) -> Path:
    """Path of a scene of the study."""
    return ROOT / "config" / "scenes" / f"{name}.yaml"


def warm_spindle() -> Scene:
    """A bearing of 40 mm bore in a rigid pair, with a thermal network and heat capacities."""
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
    """Nodes of a source, the module first: several tests look through all of ours."""
    return list(ast.walk(ast.parse(file.read_bytes())))


def benchmark(name: str):
    """A program of `benchmarks/`, as a module; it may import others from there."""
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
    """A kernel as plain Python with all that it calls, except for what stays `compiled`.

    A formula that is evaluated a few times is not worth compiling, which takes seconds.
    """
    function = getattr(kernel, "py_func", kernel)
    own = dict(function.__globals__)
    for name in function.__code__.co_names:
        other = own.get(name)
        is_function = hasattr(other, "py_func") or isinstance(other, types.FunctionType)
        if is_function and other.__module__.startswith("bearingwear.") and other not in compiled:
            own[name] = in_python(other, *compiled)
    more = function.__name__, function.__defaults__, function.__closure__
    return types.FunctionType(function.__code__, own, *more)


def balance_of(problem: ThrustProblem, D: float) -> BalanceProblem:
    """The equations of motion of a ball of diameter D [m]."""
    return in_python(balance_problem)(problem.bearing(D), problem.rule, problem.traction)


def by_differences(function, c, steps) -> np.ndarray:
    """Central differences of a function of several numbers, a row for each of them."""
    out = []
    for i, step in enumerate(steps):
        moved = [tuple(x + (k == i) * s * step for k, x in enumerate(c)) for s in (-1.0, 1.0)]
        low, high = map(function, moved)
        out.append((high - low) / (2.0 * step))
    return np.array(out)


def numbers_in(text: str) -> list[float]:
    """Returns the numbers in a text, in their order; digits within a name are none."""
    return [float(number) for number in re.findall(r"(?<![\w.-])-?\d+(?:\.\d+)?(?:e-?\d+)?", text)]


def without_waits(text: str) -> str:
    """Output without the lines that say how long a slow machine has been at work."""
    return re.sub(r"^.*\brunning for \d+ s.*\n", "", text, flags=re.M)


def only_line(capsys) -> str:
    """The line that a command has printed to standard error, and nothing else."""
    out, err = capsys.readouterr()
    assert not out and err.count("\n") == 1, (out, err)
    return err


def step_arguments(run: str, *outputs, settings: dict | None = None, **inputs) -> list[str]:
    """Arguments of `bearingwear` that run a step, as a rule of the workflow gives them.

    Parameters
    ----------
    run : str
        The function, as `studies.grid.gather.gathered_study`.
    *outputs : path
    settings : dict, optional
    **inputs : path, or list of paths
    """
    words = []
    for name, paths in inputs.items():
        listed = [paths] if isinstance(paths, str | Path) else paths
        words += [f"{name}=", *map(str, listed)]
    for name, value in (settings or {}).items():
        words.append(f"{name}={value if isinstance(value, str) else repr(value)}")
    return ["step", dotted(run), *words, "-o", *map(str, outputs)]


def dotted(run: str) -> str:
    """Dotted name of a function of a study: `studies.grid.gather.gathered_study` in the package."""
    study = run.split(".")[1]
    there = (ROOT / "workflow" / "studies" / study).is_dir()
    return f"{'workflow' if there else 'bearingwear'}.{run}"


def step(run: str, *outputs, settings: dict | None = None, **inputs) -> int:
    """Run a step; its exit status."""
    return main(step_arguments(run, *outputs, settings=settings, **inputs))
