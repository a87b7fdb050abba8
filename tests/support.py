"""Where things are, and how a step of a study is run, for tests of every kind."""

import ast
import functools
import importlib.util
import json
import sys
from pathlib import Path

import numpy as np
import yaml

from bearingwear.cli import main

ROOT = Path(__file__).resolve().parents[1]


def scene_file(name: str) -> Path:
    """Path of a scene of the study."""
    return ROOT / "config" / "scenes" / f"{name}.yaml"


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


def by_differences(function, c, steps) -> np.ndarray:
    """Central differences of a function of several numbers, a row for each of them."""
    out = []
    for i, step in enumerate(steps):
        moved = [tuple(x + (k == i) * s * step for k, x in enumerate(c)) for s in (-1.0, 1.0)]
        low, high = map(function, moved)
        out.append((high - low) / (2.0 * step))
    return np.array(out)


def with_value(file: Path, path: str, value: object, folder: Path) -> Path:
    """A copy of a YAML file in a folder, with one value replaced."""
    data = yaml.safe_load(file.read_text(encoding="utf-8"))
    *blocks, last = path.split(".")
    block = data
    for name in blocks:
        block = block[name]
    block[last] = value
    changed = folder / "plan.yaml"
    changed.write_text(yaml.safe_dump(data), encoding="utf-8")
    return changed


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
        The function, as `studies.grid.gather.study`.
    *outputs : path
    settings : dict, optional
    **inputs : path, or list of paths
    """
    given = [
        f"{name}={paths}" if isinstance(paths, str | Path) else f"{name}+={path}"
        for name, paths in inputs.items()
        for path in ([paths] if isinstance(paths, str | Path) else paths)
    ]
    return ["step", run, *given, "--settings", json.dumps(settings or {}), "-o", *map(str, outputs)]


def step(run: str, *outputs, settings: dict | None = None, **inputs) -> int:
    """Run a step; its exit status."""
    return main(step_arguments(run, *outputs, settings=settings, **inputs))
