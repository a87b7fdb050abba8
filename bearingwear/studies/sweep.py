"""Scenes at many values of their keys, as one dataset: `bearingwear.sweep`."""

from __future__ import annotations

import math
import pickle
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from bearingwear.scene.checking.errors import NotAvailable, SceneError
from bearingwear.scene.read import Source, as_scene, scene_for_life
from bearingwear.scene.scene import Scene
from bearingwear.studies.answers import FAILURES, PROBLEM, Answer, Tell, Workers, points_at_once
from bearingwear.studies.points import Axes, Rows, ScenePoint, SweepPoints
from bearingwear.studies.sampling import usable_cores
from bearingwear.studies.sweep_dataset import (
    KeptVariables,
    part_of_sweep,
    points_dataset,
    sweep_attributes,
    sweep_warnings,
    whole_sweep,
)

if TYPE_CHECKING:
    import xarray as xr

    from bearingwear.solvers.result import Result

Question = str | Callable[[Scene], Mapping[str, Any]]
"""What a sweep computes of a scene: "solve", "life", or a function of it."""

_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
"""The golden ratio, whose first multiples, modulo 1, are spread evenly, however many they are."""

_MOST_LOOKED_AT = 20
"""Number of points from which a sweep finds the models that it needs."""

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
    """Solves scenes or their lives at many values of their keys.

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
    planned = Sweep.of(scene, points, what, fidelity, keep)
    results = planned.dataset(workers, progress, part)
    for text in sweep_warnings(results):
        warnings.warn(f"{', '.join(planned.points.names)}: {text}", stacklevel=2)
    return results


@dataclass(frozen=True)
class SceneQuestion:
    """Computation at each point of a sweep: called with a point, it returns the answer."""

    scenes: tuple[Scene, ...]
    keys: tuple[str, ...]  # dotted keys of the values of a point
    what: Question
    fidelity: str | None  # overrides `model.fidelity`
    kept: KeptVariables

    def scene(self, point: ScenePoint) -> Scene:
        """Returns the scene with the values of a point. Raises SceneError if they are invalid."""
        scene = self.scenes[point.scene].with_(dict(zip(self.keys, point.values, strict=True)))
        return scene_for_life(scene) if self.what == "life" else scene

    def __call__(self, point: ScenePoint) -> Answer:
        """Returns the kept values of the scene at a point, as of `KeptVariables`.

        An unsolved case or life has a status that says so; errors of a function are not caught.

        SceneError: the point makes no valid scene.
        NotAvailable: the model does not apply to the scene.
        """
        scene = self.scene(point)
        if callable(self.what):
            return self.kept.of_function(self.what(scene))
        return self.kept.of_result(scene, _result(scene, self.what, self.fidelity))


def _result(scene: Scene, what: str, fidelity: str | None) -> Result:
    """Returns the solved case of a scene, or its life.

    what {"solve", "life"}
    fidelity: overrides `model.fidelity`.
    """
    from bearingwear.lives.life import life
    from bearingwear.solvers.solve import solve

    return life(scene, fidelity) if what == "life" else solve(scene, fidelity)


@dataclass(frozen=True)
class Sweep:
    """A sweep whose keys, values and names are allowed."""

    question: SceneQuestion
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
        """Returns the sweep of checked arguments; they are those of the function `sweep`.

        ValueError: `what` is not allowed; a SceneError for scenes, points or names to keep.
        """
        if not callable(what) and what not in ("solve", "life"):
            raise ValueError(f"what: got {what!r}, expected solve, life or a function")
        sources: Sequence[Any] = scene if isinstance(scene, list | tuple) else [scene]
        if not sources:
            raise SceneError("", "got no scene, expected one or more", source="scene")
        scenes = tuple(as_scene(source) for source in sources)
        all_points = SweepPoints.of(scenes, points)
        kept = KeptVariables.of(keep, "function" if callable(what) else what)
        question = SceneQuestion(
            scenes=scenes,
            keys=tuple(all_points.columns),
            what=what,
            fidelity=fidelity,
            kept=kept,
        )
        return cls(question, all_points)

    def dataset(
        self,
        workers: int | None = None,
        progress: bool | Tell = True,
        part: tuple[int, int] | None = None,
    ) -> xr.Dataset:
        """Returns the results at all points over the axes, or at those of a part along `point`.

        The arguments are those of the function `sweep`.
        """
        all_points = list(self.points)
        count = len(all_points)
        numbers = range(count) if part is None else _numbers_of_part(part, count)
        points = [all_points[number] for number in numbers]
        answers = self._answers(points, workers, progress)
        self._check_some_valid(points[0], answers)
        results = points_dataset(self.question.kept, answers)
        results.attrs |= sweep_attributes(
            self.question.scenes, self.points, self.question.kept.what
        )
        if part is not None:
            return part_of_sweep(results, self.points, numbers, part)
        return whole_sweep(results, self.points)

    def _answers(
        self, points: Sequence[ScenePoint], workers: int | None, progress: bool | Tell
    ) -> list[Answer]:
        """Returns the answers at points, in their order; they are computed as of `_even_order`.

        workers, progress: as of the function `sweep`.
        """
        what = self.question.what
        cores = min(len(points), usable_cores() if workers is None else workers)
        order = _even_order(len(points), points_at_once(len(points), cores))
        ordered_points = [points[k] for k in order]
        with Workers(cores, "sweep", progress) as pool:
            if cores > 1 and callable(what):
                check_can_be_sent(what)
            elif cores > 1:
                self.compile(ordered_points)
                pool.start()
            answers = pool.answers_at(self.question, ordered_points)
            answer_by_number = dict(zip(order, answers, strict=True))
        return [answer_by_number[k] for k in range(len(points))]

    def in_even_order(self) -> list[ScenePoint]:
        """Returns all points in an order whose first few lie far apart."""
        points = list(self.points)
        return [points[k] for k in _even_order(len(points))]

    def compile(self, points: Sequence[ScenePoint]) -> None:
        """Compiles and loads the kernels that points need; processes forked later have them.

        For each model that the first points require, it solves one of them as coarsely as possible.
        For a sweep of a function, it does nothing.
        """
        what = self.question.what
        if callable(what):
            return
        for fidelity, scene in self._scene_by_fidelity(points).items():
            # a dynamic life repeats dynamic solves, and takes long
            _result(scene.with_(COARSEST), "solve" if fidelity == "dynamic" else what, fidelity)

    def _scene_by_fidelity(self, points: Sequence[ScenePoint]) -> dict[str, Scene]:
        """Returns a scene for each fidelity that the first points require, by the fidelity.

        Points without a valid scene, or that no model can solve, are skipped.
        """
        from bearingwear.solvers.effects.choice import choice, choice_for_life

        model_choice = choice_for_life if self.question.what == "life" else choice
        scenes = {}
        for point in points[:_MOST_LOOKED_AT]:
            try:
                scene = self.question.scene(point)
                scenes[model_choice(scene, self.question.fidelity).fidelity] = scene
            except FAILURES:
                continue
        return scenes

    def _check_some_valid(self, first: ScenePoint, answers: Sequence[Answer]) -> None:
        """Raises the error of the first point if all points were refused.

        NotAvailable: that point raises no error in this process.

        answers: at all points.
        """
        if all(PROBLEM in answer for answer in answers):
            self.question(first)  # raises the error
            raise NotAvailable(answers[0][PROBLEM])


def _even_order(count: int, block_size: int = 1) -> list[int]:
    """Returns the numbers from 0 to `count` - 1 in an order whose first few are spread evenly.

    The time left is then estimated well from the points that are solved.

    block_size: how many neighbours stay together, because they share computations.
    """
    blocks = [range(k, min(k + block_size, count)) for k in range(0, count, block_size)]
    block_order = sorted(range(len(blocks)), key=lambda k: k * _GOLDEN % 1.0)
    return [number for k in block_order for number in blocks[k]]


def _numbers_of_part(part: tuple[int, int], count: int) -> range:
    """Returns the numbers, from 0 on, of the points of part (K, N): every N-th, from number K - 1.

    Neighbours take similar times, so the parts take about equal times.

    SceneError: a part that does not exist, or more parts than points.
    """
    part_number, parts = part
    if not 1 <= part_number <= parts <= count:
        problem = f"got {part_number}/{parts}, expected K/N with 1 <= K <= N <= {count} points"
        raise SceneError("", problem, source="part")
    return range(part_number - 1, count, parts)


def check_can_be_sent(what: Callable[..., Any]) -> None:
    """Raises a SceneError for a function that cannot be pickled and sent to a process.

    what: function that a sweep computes. A lambda, for example, cannot be pickled.
    """
    try:
        pickle.dumps(what)
    except (pickle.PicklingError, AttributeError, TypeError):
        name = getattr(what, "__qualname__", what)
        problem = f"got {name}, expected a function of a module, or workers=1"
        raise SceneError("", problem, source="what") from None
