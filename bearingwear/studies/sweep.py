"""One scene at every combination of some of its values, as one dataset: `bearingwear.sweep`."""

from __future__ import annotations

import itertools
import json
import math
import warnings
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from bearingwear.console import LINE_EVERY
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.results.warnings import WARNING, gathered_warnings, warning_lines
from bearingwear.scene.checking.errors import SceneError, shown
from bearingwear.scene.read import Source, as_scene, for_life
from bearingwear.scene.scene import Scene, key_of_scene
from bearingwear.studies.answers import CHUNKS_PER_WORKER
from bearingwear.studies.axis import GRID_KEYS
from bearingwear.studies.pool import in_processes, told_in_lines
from bearingwear.studies.sampling import usable_cores

if TYPE_CHECKING:
    import xarray as xr

Job = tuple[Scene, str, str | None]
"""A scene, what is asked of it, and the fidelity."""

_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
"""Multiples of it, modulo 1, spread evenly."""

_POINT = "point"
"""Dimension of the points of a chunk."""

COARSEST = {
    "model.strips": 4,
    "model.tolerance": 1e-2,
    "model.simulated_turns": 0.02,
    "model.evaluated_turns": None,
}
"""Changes that make a solve fast; it compiles the same kernels."""


def sweep(
    scene: Source,
    changes: Mapping[str, Iterable[Any]],
    what: str = "solve",
    fidelity: str | None = None,
    workers: int | None = None,
    progress: bool = True,
) -> xr.Dataset:
    """Solve a scene or its life for every combination of some of its values.

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
        Number of processes (default: one per core). With 1, no process is started. Where Python
        spawns processes (macOS, Windows, Python 3.14 and later), a script must call this function
        below `if __name__ == "__main__":`.
    progress : bool
        Whether a sweep of more than a few seconds reports its progress on standard error (with
        tqdm, if installed).

    Returns
    -------
    xarray.Dataset
        The contents of a case or life file, with one more dimension for each key. A dimension is
        named after the last part of the key (`preload_N`), or after all parts if that name is in
        use (`operation_preload_N`); that of `friction.ball_race` is `friction`. Values of a point
        that was not solved are NaN; `status` gives the reason.

    Raises
    ------
    SceneError, NotAvailable
        Both are ValueErrors: a value is not allowed, or no model can solve it. In either case
        nothing is solved.

    Warns
    -----
    UserWarning
        Some points were not solved, or have warnings. Each warning is reported once, for the worst
        case.
    """
    if what not in ("solve", "life"):
        raise ValueError(f"what: got {what!r}, expected solve or life")
    if not changes:
        raise SceneError("", "got no key, expected one or more", source="changes")
    base = as_scene(scene)
    axes = {key: _values(key, values) for key, values in changes.items()}
    points = _points(base, axes, what, fidelity)
    cores = min(len(points), usable_cores() if workers is None else workers)
    if cores > 1:
        _compile(points, what)
    size = math.ceil(len(points) / (CHUNKS_PER_WORKER * max(cores, 1)))
    jobs = [(point, what, fidelity) for point, _ in points]
    chunks = [jobs[k : k + size] for k in range(0, len(jobs), size)]
    # neighbours take alike long; the time left is that of the others
    order = sorted(range(len(chunks)), key=lambda k: k * _GOLDEN % 1.0)
    solved = in_processes(_solved, [chunks[k] for k in order], cores, "sweep")
    found = _told(solved, len(jobs), progress)
    parts = dict(zip(order, found, strict=True))
    made = _side_by_side([parts[k] for k in range(len(chunks))], base, axes, what)
    _warn(made, base.name)
    return made


def _warn(made: xr.Dataset, name: str) -> None:
    """Warn where `sweep` is called of points not solved, and of what the solved ones warn of."""
    said = [made.attrs["message"]] if (made["status"] != STATUS_NAMES[OK]).any() else []
    for text in [*said, *(line.removeprefix(WARNING) for line in warning_lines(made.attrs))]:
        warnings.warn(f"{name}: {text}", stacklevel=3)


def _values(key: str, values: Any) -> list[Any]:
    """The values of one key as plain data."""
    if isinstance(values, str | bytes | Mapping) or not isinstance(values, Iterable):
        raise SceneError("", f"got {shown(values)}, expected a list of values", source=key)
    plain = values.tolist() if hasattr(values, "tolist") else list(values)
    if not plain:
        raise SceneError("", "got no value, expected one or more", source=key)
    return [value.item() if hasattr(value, "item") else value for value in plain]


def _points(
    base: Scene, axes: Mapping[str, list[Any]], what: str, fidelity: str | None
) -> list[tuple[Scene, str]]:
    """The scene of every point, checked, and the model that solves it."""
    from bearingwear.solvers.effects.choice import choice, choice_for_life

    found = []
    bearings = {}
    for point in itertools.product(*axes.values()):
        scene = base.with_(dict(zip(axes, point, strict=True)))
        bearings[len(scene.sides)] = scene.arrangement.kind if scene.arrangement else "single"
        if len(bearings) > 1:
            problem = (
                f"got {' and '.join(bearings.values())}, expected either pairs or single bearings"
            )
            raise SceneError("arrangement.kind", problem, source=base.name)
        if what == "life":
            found.append((for_life(scene), choice_for_life(scene, fidelity).fidelity))
        else:
            found.append((scene, choice(scene, fidelity).fidelity))
    return found


def _compile(points: Sequence[tuple[Scene, str]], what: str) -> None:
    """Have the kernels of every model compiled and loaded once, before processes are forked."""
    first = {fidelity: scene for scene, fidelity in reversed(points)}
    for fidelity, scene in first.items():
        asked = "solve" if fidelity == "dynamic" else what
        _solved([(scene.with_(COARSEST), asked, fidelity)])


def _solved(jobs: Sequence[Job]) -> xr.Dataset:
    """Some points, along the dimension `point`."""
    from bearingwear.lives.life import life
    from bearingwear.results.netcdf import datasets_of
    from bearingwear.solvers.solve import solve
    from bearingwear.studies.dataset import stacked

    results = [
        life(scene, fidelity) if what == "life" else solve(scene, fidelity)
        for scene, what, fidelity in jobs
    ]
    made = stacked(datasets_of(results, _POINT), {_POINT: len(results)}, along=_POINT)
    warnings = gathered_warnings(result.attrs for result in results)
    fidelities = [result.attrs["fidelity"] for result in results]
    return made.assign_attrs(fidelity=fidelities, warnings=warnings)


def _told(parts: Iterator[xr.Dataset], count: int, progress: bool) -> Iterator[xr.Dataset]:
    """The same parts, with a line of progress."""
    if not progress:
        return parts
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return _told_in_lines(parts, count)
    return _told_by_bar(parts, tqdm(total=count, desc="sweep", delay=LINE_EVERY))


def _told_by_bar(parts: Iterator[xr.Dataset], bar: Any) -> Iterator[xr.Dataset]:
    with bar:
        for part in parts:
            bar.update(part.sizes[_POINT])
            yield part


def _told_in_lines(parts: Iterator[xr.Dataset], count: int) -> Iterator[xr.Dataset]:
    return told_in_lines(parts, count, "sweep: {} of {} points", lambda one: one.sizes[_POINT])


def _side_by_side(
    parts: Sequence[xr.Dataset], base: Scene, axes: Mapping[str, list[Any]], what: str
) -> xr.Dataset:
    from bearingwear.results.entries import common_attributes
    from bearingwear.results.labels import labelled
    from bearingwear.studies.dataset import stacked

    names = _dimensions(axes, {str(name) for part in parts for name in part.variables})
    lengths = {names[key]: len(values) for key, values in axes.items()}
    made = labelled(stacked(parts, lengths, along=_POINT))
    made = made.assign_coords({names[key]: _axis(key, names[key], axes[key]) for key in axes})
    fidelities = dict.fromkeys(name for part in parts for name in part.attrs["fidelity"])
    made.attrs = common_attributes() | {
        "title": f"{what}: {base.name} at {math.prod(lengths.values())} points",
        "kind": "sweep",
        "scene": base.json,
        "changed_keys": json.dumps({name: key for key, name in names.items()}),
        "fidelity": ", ".join(fidelities),
        "warnings": gathered_warnings(part.attrs for part in parts),
        "message": _message(made["status"].values.ravel().tolist()),
    }
    return made


def _dimensions(axes: Iterable[str], taken: set[str]) -> dict[str, str]:
    """Name of the dimension of each key: that of a study, else its last part, if it is free."""
    of_study = {key: name for name, key in GRID_KEYS.items() if name not in taken}
    last = {key: of_study.get(key, key.rpartition(".")[2]) for key in axes}
    often = Counter(last.values())
    return {
        key: key.replace(".", "_") if often[name] > 1 or name in taken else name
        for key, name in last.items()
    }


def _axis(key: str, dim: str, values: list[Any]) -> xr.Variable:
    """The coordinate of a key; values that are neither numbers nor names stand in it as text."""
    import numpy as np
    import xarray as xr

    part = key_of_scene(key.removeprefix("arrangement.second."))
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
    failed = Counter(status for status in statuses if status != STATUS_NAMES[OK])
    if not failed:
        return "all points solved and verified"
    reasons = ", ".join(f"{name} {count}" for name, count in failed.items())
    return f"{failed.total()} of {len(statuses)} points were not solved: {reasons}"
