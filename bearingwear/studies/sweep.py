"""Scenes at many values of their keys, as one dataset: `bearingwear.sweep`."""

from __future__ import annotations

import math
import pickle
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from bearingwear.scene.checking.errors import NotAvailable, SceneError
from bearingwear.scene.read import Source, as_scene, for_life
from bearingwear.scene.scene import Scene
from bearingwear.studies.answers import FAILURES, PROBLEM, Answer, Tell, Workers, points_at_once
from bearingwear.studies.points import Axes, Rows, ScenePoint, SweepPoints
from bearingwear.studies.sampling import usable_cores
from bearingwear.studies.sweep_dataset import (
    Kept,
    part_of_sweep,
    points_dataset,
    sweep_attributes,
    sweep_warnings,
    whole_sweep,
)

if TYPE_CHECKING:
    import xarray as xr

Question = str | Callable[[Scene], Mapping[str, Any]]
"""What is asked of a scene: "solve", "life", or a function of it."""

_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
"""Multiples of it, modulo 1, spread evenly."""

_MOST_LOOKED_AT = 20
"""Points at which it is seen which models a sweep needs."""

COARSEST = {
    "model.strips": 4,
    "model.tolerance": 1e-2,
    "model.simulated_turns": 0.02,
    "model.evaluated_turns": None,
}
"""Changes that make a solve fast; it compiles the same kernels."""


def sweep(
    scene: Source | Sequence[Source],
    points: Axes | Rows,
    what: Question = "solve",
    fidelity: str | None = None,
    workers: int | None = None,
    progress: bool | Tell = True,
    keep: str | Sequence[str] | None = None,
    part: tuple[int, int] | None = None,
) -> xr.Dataset:
    """Solve scenes or their lives at many values of their keys.

    Parameters
    ----------
    scene : path, dict or Scene, or a list of them
        Several scenes need different names.
    points : mapping, or list of mappings
        Axes: the values of each key, in the units of a scene file. Every combination is a point:
        `{"operation.preload_N": [5, 7, 9], "friction.ball_race": [0.05, 0.1]}`.
        Rows, such as a sample: `[{"operation.preload_N": 5.2, "friction.ball_race": 0.07}, ...]`,
        each of which is a point.
    what : {"solve", "life"} or function
        A function takes a `Scene` and returns a mapping of names to numbers, texts or arrays, each
        always of the same shape. `status` may be one of them, as a code.
    fidelity : {"auto", "race_control", "steady", "dynamic"}, optional
        Overrides `model.fidelity` of the scenes.
    workers : int, optional
        Number of processes (default: one per core). With 1, no process is started. Where Python
        spawns processes (macOS, Windows, Python 3.14 and later), a script must call this function
        below `if __name__ == "__main__":`.
    progress : bool
        Whether a sweep of more than a few seconds reports its progress on standard error (with
        tqdm, if installed).
    keep : list of str, "extremes" or "study", optional
        Names of the variables to keep (default: all); `status` always stays. "extremes" keeps the
        life itself and the worst value of each measure from new to the end of life; "study" leaves
        out profiles over the contacts, histories and states, as `study.nc` does.
    part : (int, int), optional
        `(3, 10)` computes the third of ten parts, for instance in ten jobs of a cluster.
        `bearingwear gather` joins their files.

    Returns
    -------
    xarray.Dataset
        The contents of a case or life file, with one more dimension for each key. A dimension is
        named after the last part of the key (`preload_N`), or after all parts if that name is in
        use (`operation_preload_N`); that of `friction.ball_race` is `friction`. Rows lie along
        `row`, several scenes along `scene`, and the points of a part along `point`. Values of a
        point that was not solved are NaN; `status` gives the reason, or is "none" where the values
        make no valid scene or no model can solve it.

    Raises
    ------
    SceneError
        A ValueError: a key or a value on an axis is not allowed (nothing is solved then), or no
        point is valid.

    Warns
    -----
    UserWarning
        Some points were not solved, or have warnings. Each warning is reported once, for the worst
        case.
    """
    asked = Sweep.of(scene, points, what, fidelity, keep)
    made = asked.dataset(workers, progress, part)
    for text in sweep_warnings(made):
        warnings.warn(f"{', '.join(asked.points.names)}: {text}", stacklevel=2)
    return made


@dataclass(frozen=True)
class Asked:
    """What is asked at each point of a sweep; called with a point, it answers."""

    scenes: tuple[Scene, ...]
    keys: tuple[str, ...]
    what: Question
    fidelity: str | None
    kept: Kept

    def scene(self, point: ScenePoint) -> Scene:
        """The scene of a point. Raises SceneError."""
        made = self.scenes[point.scene].with_(dict(zip(self.keys, point.values, strict=True)))
        return for_life(made) if self.what == "life" else made

    def __call__(self, point: ScenePoint) -> Answer:
        scene = self.scene(point)
        if callable(self.what):
            return self.kept.of_function(self.what(scene))
        return self.kept.of_result(scene, _result(scene, self.what, self.fidelity))


def _result(scene: Scene, what: str, fidelity: str | None) -> Any:
    from bearingwear.lives.life import life
    from bearingwear.solvers.solve import solve

    return life(scene, fidelity) if what == "life" else solve(scene, fidelity)


@dataclass(frozen=True)
class Sweep:
    """A sweep whose keys, values and names are allowed."""

    asked: Asked
    points: SweepPoints

    @classmethod
    def of(
        cls,
        scene: Source | Sequence[Source],
        points: Axes | Rows,
        what: Question = "solve",
        fidelity: str | None = None,
        keep: str | Sequence[str] | None = None,
    ) -> Sweep:
        """The sweep that `sweep` is asked for. Raises SceneError."""
        if not callable(what) and what not in ("solve", "life"):
            raise ValueError(f"what: got {what!r}, expected solve, life or a function")
        given: Sequence[Any] = scene if isinstance(scene, list | tuple) else [scene]
        if not given:
            raise SceneError("", "got no scene, expected one or more", source="scene")
        scenes = tuple(as_scene(one) for one in given)
        all_points = SweepPoints.of(scenes, points)
        kept = Kept.of(keep, "function" if callable(what) else what)
        return cls(Asked(scenes, (*all_points.columns,), what, fidelity, kept), all_points)

    def dataset(
        self,
        workers: int | None = None,
        progress: bool | Tell = True,
        part: tuple[int, int] | None = None,
    ) -> xr.Dataset:
        """The answers at all points, or at those of a part along `point`."""
        every = list(self.points)
        numbers = range(len(every)) if part is None else _numbers_of_part(part, len(every))
        what = self.asked.what
        cores = min(len(numbers), usable_cores() if workers is None else workers)
        order = _even_order(len(numbers), points_at_once(len(numbers), cores))
        points = [every[numbers[k]] for k in order]
        with Workers(cores, "sweep", progress) as pool:
            if cores > 1:
                if not callable(what):
                    self.compile(points)
                    pool.start()
                else:
                    check_can_be_sent(what)
            found = dict(zip(order, pool.answers_at(self.asked, points), strict=True))
        answers = [found[k] for k in range(len(numbers))]
        self._check_some_valid(every[numbers[0]], answers)
        made = points_dataset(self.asked.kept, answers)
        made.attrs |= sweep_attributes(self.asked.scenes, self.points, self.asked.kept.what)
        if part is not None:
            return part_of_sweep(made, self.points, numbers, part)
        return whole_sweep(made, self.points)

    def in_even_order(self) -> list[ScenePoint]:
        """All points, the first few of which lie far apart."""
        every = list(self.points)
        return [every[k] for k in _even_order(len(every))]

    def compile(self, points: Sequence[ScenePoint]) -> None:
        """Compile and load the kernels that points need; processes that are forked have them."""
        what = self.asked.what
        if callable(what):
            return
        for fidelity, scene in self.models(points).items():
            _result(scene.with_(COARSEST), "solve" if fidelity == "dynamic" else what, fidelity)

    def models(self, points: Sequence[ScenePoint]) -> dict[str, Scene]:
        """The models that some of the points need, each with a scene that needs it."""
        from bearingwear.solvers.effects.choice import choice, choice_for_life

        chosen = choice_for_life if self.asked.what == "life" else choice
        found = {}
        for point in points[:_MOST_LOOKED_AT]:
            try:
                scene = self.asked.scene(point)
                found[chosen(scene, self.asked.fidelity).fidelity] = scene
            except FAILURES:
                continue
        return found

    def _check_some_valid(self, first: ScenePoint, answers: Sequence[Answer]) -> None:
        """Raise the error of the first point where all of them have one."""
        if all(PROBLEM in answer for answer in answers):
            self.asked(first)
            raise NotAvailable(answers[0][PROBLEM])


def _even_order(count: int, together: int = 1) -> list[int]:
    """Numbers below a count, mixed: neighbours take alike long, and a time left is of others.

    together: how many neighbours stay so; what they share is computed once.
    """
    blocks = [range(k, min(k + together, count)) for k in range(0, count, together)]
    mixed = sorted(range(len(blocks)), key=lambda k: k * _GOLDEN % 1.0)
    return [number for k in mixed for number in blocks[k]]


def _numbers_of_part(part: tuple[int, int], count: int) -> range:
    """Numbers of the points of a part, which lie far apart: neighbours take alike long."""
    number, parts = part
    if not 1 <= number <= parts <= count:
        problem = f"got {number}/{parts}, expected K/N with 1 <= K <= N <= {count} points"
        raise SceneError("", problem, source="part")
    return range(number - 1, count, parts)


def check_can_be_sent(what: Callable[..., Any]) -> None:
    """Refuse a function that other processes cannot import."""
    try:
        pickle.dumps(what)
    except (pickle.PicklingError, AttributeError, TypeError):
        name = getattr(what, "__qualname__", what)
        problem = f"got {name}, expected a function of a module, or workers=1"
        raise SceneError("", problem, source="what") from None
