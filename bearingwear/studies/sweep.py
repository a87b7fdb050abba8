"""One scene at every combination of some of its values, as one dataset: `bearingwear.sweep`."""

from __future__ import annotations

import itertools
import json
import math
import multiprocessing
import os
import sys
import time
import warnings
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import TYPE_CHECKING, Any

from bearingwear.scene.errors import SceneError, shown
from bearingwear.scene.read import Source, as_scene, for_life
from bearingwear.scene.scene import Scene, key_of_scene

if TYPE_CHECKING:
    import xarray as xr

    from bearingwear.model.result import Result

LINE_EVERY = 5.0
"""Seconds between two lines of progress, and before the first."""

CHUNKS_PER_WORKER = 8
"""How finely points are dealt out; a process asks for more when it has solved its share."""

COARSEST = {
    "model.strips": 4,
    "model.tolerance": 1e-2,
    "model.simulated_turns": 0.02,
    "model.evaluated_turns": None,
}
"""Changes with which a solve takes no time; it compiles the same kernels."""


def sweep(
    scene: Source,
    changes: Mapping[str, Iterable[Any]],
    what: str = "solve",
    fidelity: str | None = None,
    workers: int | None = None,
    progress: bool = True,
) -> xr.Dataset:
    """Solve a scene, or find its life, at every combination of some of its values.

    Parameters
    ----------
    scene : path, dict or Scene
    changes : mapping
        The values of each key, in the units of a scene file:
        `{"operation.preload_N": [5, 7, 9], "friction.ball_race": [0.05, 0.1]}`.
    what : {"solve", "life"}
    fidelity : {"auto", "race_control", "steady", "dynamic"}, optional
        Overrides `model.fidelity` of the scene.
    workers : int, optional
        Processes that share the points; all cores if left out. With 1 no process is started.
        Where Python starts processes anew (macOS, Windows, Python 3.14 and later), a script has
        to call this below `if __name__ == "__main__":`.
    progress : bool
        Whether what takes longer than some seconds says how far it is, on standard error (with
        tqdm, if that is installed).

    Returns
    -------
    xarray.Dataset
        What a case or life file holds, along one more dimension for each key. It has the name of
        the key's last part (`preload_N`), or of all its parts where that name is taken
        (`operation_preload_N`). A point that was not solved has its `status`, and NaN.

    Raises
    ------
    SceneError, NotAvailable
        Both are ValueErrors: a value that is not allowed, or that no model solves. Nothing has
        been solved then.

    Warns
    -----
    UserWarning
        Some points were not solved.
    """
    if what not in ("solve", "life"):
        raise ValueError(f"what: given {what!r}; allowed solve, life")
    base = as_scene(scene)
    axes = {key: _values(key, values) for key, values in changes.items()}
    points = _points(base, axes, what, fidelity)
    jobs = [(point, what, fidelity) for point, _ in points]
    cores = min(len(jobs), _cores() if workers is None else workers)
    if cores > 1:
        _compile(points, fidelity)
    results = list(_told(_solved_by(jobs, cores), len(jobs), progress))
    made = _stacked(results, base, axes, what)
    if any(result.status != "ok" for result in results):
        warnings.warn(f"{base.name}: {made.attrs['message']}", stacklevel=2)
    return made


def _values(key: str, values: Any) -> list[Any]:
    """The values of one key as plain data."""
    if isinstance(values, str | bytes | Mapping) or not isinstance(values, Iterable):
        raise SceneError("", f"given {shown(values)}; allowed a list of values", source=key)
    plain = values.tolist() if hasattr(values, "tolist") else list(values)
    if not plain:
        raise SceneError("", "given no value; allowed one or more", source=key)
    return [value.item() if hasattr(value, "item") else value for value in plain]


def _points(
    base: Scene, axes: Mapping[str, list[Any]], what: str, fidelity: str | None
) -> list[tuple[Scene, str]]:
    """The scene of every point, checked, and the model that solves it."""
    from bearingwear.model.fidelity import choice, choice_for_life

    found = []
    for point in itertools.product(*axes.values()):
        scene = base.with_(dict(zip(axes, point, strict=True)))
        if what == "life":
            found.append((for_life(scene), choice_for_life(scene, fidelity).tier))
        else:
            found.append((scene, choice(scene, fidelity).tier))
    return found


def _cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _compile(points: Sequence[tuple[Scene, str]], fidelity: str | None) -> None:
    """Have the kernels of every model compiled once, before the processes need them."""
    first = {tier: scene for scene, tier in reversed(points)}
    for scene in first.values():
        _solved((scene.with_(COARSEST), "solve", fidelity))


def _solved(job: tuple[Scene, str, str | None]) -> Result:
    scene, what, fidelity = job
    if what == "life":
        from bearingwear.model.life import life

        return life(scene, fidelity)
    from bearingwear.model.solve import solve

    return solve(scene, fidelity)


def _solved_by(jobs: Sequence[Any], workers: int) -> Iterator[Result]:
    """Results in the order of the jobs."""
    if workers <= 1:
        yield from map(_solved, jobs)
        return
    chunk = math.ceil(len(jobs) / (CHUNKS_PER_WORKER * workers))
    pool = ProcessPoolExecutor(workers)
    try:
        yield from pool.map(_solved, jobs, chunksize=chunk)
    except BrokenProcessPool:
        raise RuntimeError(
            "sweep: a process has ended. A script calls this below `if __name__ == '__main__':`, "
            f"since processes are started by {multiprocessing.get_start_method()}; or workers=1"
        ) from None
    except BaseException:  # Ctrl-C: nobody waits for what is still being solved
        for process in list(pool._processes.values()):
            process.terminate()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _told(results: Iterator[Result], count: int, progress: bool) -> Iterator[Result]:
    """The same results, with a word on how far they are."""
    if not progress:
        return results
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return _told_in_lines(results, count)
    return iter(tqdm(results, total=count, desc="sweep", delay=LINE_EVERY))


def _told_in_lines(results: Iterator[Result], count: int) -> Iterator[Result]:
    started = last = time.monotonic()
    for done, result in enumerate(results, 1):
        yield result
        now = time.monotonic()
        if now - last > LINE_EVERY and done < count:
            left = (now - started) * (count - done) / done
            print(f"sweep: {done} of {count} points, about {left:.0f} s left", file=sys.stderr)
            last = now


def _stacked(
    results: Sequence[Result], base: Scene, axes: Mapping[str, list[Any]], what: str
) -> xr.Dataset:
    from bearingwear.results.labels import labelled
    from bearingwear.results.netcdf import common_attributes, dataset
    from bearingwear.studies.dataset import stacked

    solved = [dataset(result) for result in results]
    taken = {str(name) for one in solved for name in one.variables}
    names = _dimensions(axes, taken)
    made = stacked(solved, {names[key]: len(values) for key, values in axes.items()})
    coords = {names[key]: _axis(key, names[key], values) for key, values in axes.items()}
    attrs = {
        "title": f"{what} of {base.name} at {len(results)} points",
        "kind": "sweep",
        "scene": json.dumps(base.to_dict()),
        "changed_keys": json.dumps({name: key for key, name in names.items()}),
        "fidelity": ", ".join(dict.fromkeys(result.attrs["fidelity"] for result in results)),
    }
    made = labelled(made).assign_coords(coords)
    made.attrs = common_attributes() | attrs
    made.attrs["message"] = _message([result.status for result in results])
    return made


def _dimensions(axes: Iterable[str], taken: set[str]) -> dict[str, str]:
    """Name of the dimension of each key: its last part, if nothing else has that name."""
    last = {key: key.rpartition(".")[2] for key in axes}
    often = Counter(last.values())
    return {
        key: key.replace(".", "_") if often[name] > 1 or name in taken else name
        for key, name in last.items()
    }


def _axis(key: str, dim: str, values: list[Any]) -> xr.Variable:
    """The coordinate of a key; values that are neither numbers nor names stand in it as text."""
    import numpy as np
    import xarray as xr

    part = key_of_scene(key)
    assert part is not None  # a scene with it was built
    attrs = {"long_name": part.key.meaning}
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        return xr.Variable(dim, np.array(values), attrs | {"units": part.unit})
    if part.kind == "choice":
        attrs["flag_meanings"] = " ".join(part.key.choices)
    texts = [value if isinstance(value, str) else json.dumps(value) for value in values]
    return xr.Variable(dim, np.array(texts), attrs)


def _message(statuses: Sequence[str]) -> str:
    """How many points were not solved, and why."""
    failed = Counter(status for status in statuses if status != "ok")
    if not failed:
        return "all points solved and verified"
    reasons = ", ".join(f"{name} {count}" for name, count in failed.items())
    return f"{failed.total()} of {len(statuses)} points were not solved: {reasons}"
