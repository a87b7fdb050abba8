"""A scene calibrated by tests of bearings: its friction, K_s/H and life.

Theory: docs/theory.md, section 24.
"""

from __future__ import annotations

import hashlib
import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.interpolate import PchipInterpolator
from scipy.special import ndtr
from scipy.stats import qmc

import bearingwear
from bearingwear import Scene, SceneError
from bearingwear.applications.calibrate.bearing_tests import BearingTest, bearing_tests
from bearingwear.applications.calibrate.file import calibration_dataset
from bearingwear.applications.calibrate.posterior import (
    Conformity,
    LogModel,
    Normal,
    Observation,
    Posterior,
    Prior,
    conformities,
    posterior,
)
from bearingwear.applications.calibrate.seen import (
    SEEN_AS,
    SEEN_LOSS,
    SEEN_PRELOAD,
    SEEN_RUN_OUT,
    SEEN_TORQUE,
)
from bearingwear.atomic import OutputError
from bearingwear.results.netcdf import CaseFileError
from bearingwear.results.units import digits
from bearingwear.results.variable import HOURS_PER_SECOND
from bearingwear.scene.blocks import Calibrated
from bearingwear.scene.checking.records import SCENE_SUFFIXES
from bearingwear.scene.coefficients import with_usual_spread
from bearingwear.scene.distributions import value_quantiles
from bearingwear.scene.read import scene_for_life
from bearingwear.scene.scene import WORN, Distribution
from bearingwear.scene.uncertain import FRICTION_KEYS, friction_correlation, is_same_for_batch
from bearingwear.solvers.bearing.films import Films
from bearingwear.solvers.solve import solve
from bearingwear.studies.answers import PROBLEM, Workers
from bearingwear.studies.sampling import scene_with_values, with_wear
from bearingwear.studies.uncertainty.sample import sampled_lives

_NODES, _CHECKED = 9, 4
"""Points over ln mu at which lives are solved: for the interpolation, and to check its error."""

_SPAN = 3.0
"""Half the width of the range of these points, in standard deviations of the prior of ln mu."""

_SAMPLES = 32
"""Number of lives in the sample for their scatter within a batch."""

_CLOSEST = 0.99999  # largest correlation that is carried

IMPOSSIBLE = 1e-6
"""Probability of tests below which they are refused."""

_LIKE_A_UNIT = 0.2  # a factor from 250 to 4000, or one over these

_NONE = -60.0  # logarithm of a life that is over when new


class Calibration:
    """Results of tests on a scene.

    scene: the scene with the calibrated friction, wear coefficients and distributions.
    data: densities, lives and tests, before and after, for `bearingwear show` and `plot`.
    """

    def __init__(self, scene: Scene, data: xr.Dataset):
        self.scene, self.data = scene, data

    def write(self, path: Path) -> None:
        """Writes the scene, and the data beside it."""
        bearingwear.save(self.data, data_file(path))
        bearingwear.save(self.scene, path)


def data_file(path: Path) -> Path:
    """Returns the data file beside a new scene file. Raises OutputError."""
    if path.suffix not in SCENE_SUFFIXES:
        raise OutputError(f"{path}: got this file name, expected one that ends in .yaml or .yml")
    if path.exists():
        raise OutputError(
            f"{path}: already exists and will not be overwritten; choose another name"
        )
    return path.with_suffix(".nc")


@dataclass(frozen=True)
class Curve:
    """The logarithm of a life [h] or a torque [N m] of the median bearing, by ln mu."""

    model: LogModel
    error: float  # largest error of the interpolation, where it was checked
    scatter: float  # standard deviation between the bearings of a batch


def calibration_by_tests(
    scene: Scene,
    path: str | Path,
    workers: int = 1,
    tell: Callable[[str], None] | None = None,
) -> Calibration:
    """Calibrates a scene with the tests of a CSV file.

    scene: with `uncertainty.wear_coefficient` and a value that scatters between bearings. Without
        `uncertainty`, that of the table of coefficients is used.
    tell: receives a line of progress before each condition.
    SceneError, CaseFileError: the scene lacks a distribution, a row is wrong, or the tests are out
        of all proportion to the scene.
    """
    scene, assumption = with_usual_spread(scene_for_life(scene))
    if tell and assumption:
        tell(assumption)
    friction = _uncertain_friction(scene)
    tests = bearing_tests(path, scene)
    digest = hashlib.sha256(Path(path).read_bytes()).hexdigest()
    if scene.calibrated and scene.calibrated.sha256 == digest:
        raise CaseFileError(
            f"{path}: got the tests used to calibrate the scene, expected different tests"
        )
    torque_row = next((test.row for test in tests if test.seen == SEEN_TORQUE), None)
    if torque_row is not None and not friction:
        key = FRICTION_KEYS[scene.friction.film is not None]
        problem = (
            f"got a result that would determine uncertainty.{key}, which the scene does not contain"
        )
        raise CaseFileError(f"{path}: row {torque_row}: {SEEN_TORQUE}: {problem}")
    prior = _prior(scene, friction)
    curve_of = cache(partial(_curve, x=prior.x, friction=friction, workers=workers, tell=tell))
    scene_curve = _curve_at(scene.name, curve_of, scene, _LIFE)
    rows = [f"{path}: row {test.row}" for test in tests]
    curves = [
        _curve_at(row, curve_of, test.scene, _TORQUE if test.seen == SEEN_TORQUE else _LIFE)
        for test, row in zip(tests, rows, strict=True)
    ]
    observations = [
        _observation(test, curve, row) for test, curve, row in zip(tests, curves, rows, strict=True)
    ]
    before, after = posterior(prior, []), posterior(prior, observations)
    alone = [before.conformity(observation) for observation in observations]
    with_others = conformities(prior, observations)
    _check_conformity(path, tests, alone, with_others, prior, after)
    calibration = Calibrated(tests=os.path.basename(path), sha256=digest, rows=len(tests))
    new_scene = _calibrated_scene(scene, friction, after, calibration)
    data = calibration_dataset(
        scene=new_scene,
        unit=_wear_over_hardness(scene),
        prior=prior,
        stages=(before, after),
        life=scene_curve.model,
        scatter=scene_curve.scatter,
        error=max(curve.error for curve in (scene_curve, *curves)),
        tests=tests,
        seen=observations,
        probabilities=[conformity.probability for conformity in with_others],
    )
    return Calibration(new_scene, data)


def _uncertain_friction(scene: Scene) -> str:
    """Returns the name of a scene's uncertain friction, empty without one.

    SceneError: the scene lacks an uncertain wear coefficient, or a value that scatters.
    """
    uncertainty = scene.uncertainty or {}
    wear = uncertainty.get("wear_coefficient")
    if wear is None or not is_same_for_batch("wear_coefficient", wear):
        raise SceneError(
            "uncertainty.wear_coefficient",
            "got no value that tests could determine, expected {distribution: lognormal, "
            "factor: 3}",
            source=scene.name,
        )
    if all(is_same_for_batch(name, distribution) for name, distribution in uncertainty.items()):
        raise SceneError(
            "uncertainty",
            "got no value that varies from bearing to bearing, expected wear_scatter: "
            "{distribution: lognormal, factor: 1.3}, or another distribution",
            source=scene.name,
        )
    for name in FRICTION_KEYS:
        if name in uncertainty and is_same_for_batch(name, uncertainty[name]):
            return name
    return ""


def _check_conformity(
    path: str | Path,
    tests: Sequence[BearingTest],
    alone: Sequence[Conformity],
    with_others: Sequence[Conformity],
    prior: Prior,
    after: Posterior,
) -> None:
    """Refuses tests that no bearing of the scene can have given: CaseFileError.

    A test that is impossible in the scene alone is named; otherwise those that contradict others.
    """
    problems = _improbable(tests, alone) or _improbable(tests, with_others)
    normals = (("friction", prior.x, after.normal("x")), ("K_s/H", prior.y, after.normal("y")))
    problems = problems or [
        f"together: {digits(math.exp(now.mean - was.mean))} times the {words} of the scene"
        for words, was, now in normals
        if was.deviation and 2.0 * ndtr(-abs(now.mean - was.mean) / was.deviation) < IMPOSSIBLE
    ]
    if problems:
        raise CaseFileError(
            f"{path}: got results with a probability below {IMPOSSIBLE:g} in this scene: "
            f"{'; '.join(problems)}; correct them, or increase `uncertainty` in the scene"
        )


def _improbable(tests: Sequence[BearingTest], conformity: Sequence[Conformity]) -> list[str]:
    """Describes each test whose probability is below `IMPOSSIBLE`."""
    return [
        _deviation_words(test, agreed)
        for test, agreed in zip(tests, conformity, strict=True)
        if agreed.probability < IMPOSSIBLE
    ]


def _deviation_words(test: BearingTest, agreed: Conformity) -> str:
    """States how far a test is from the expected value, and whether a unit may be the reason."""
    words, unit, _ = SEEN_AS[test.seen]
    timed = test.seen in (SEEN_LOSS, SEEN_PRELOAD)
    time = " in time" if timed else ""
    text = f"row {test.row}, {words}: {digits(agreed.factor)} times the expected value{time}"
    thousands = abs(math.log(agreed.factor)) / math.log(1000.0)
    if abs(thousands - 1.0) < _LIKE_A_UNIT:
        text += f" (a factor near 1000 or 0.001 suggests a wrong unit; expected {unit}"
        text += " after h)" if timed else ")"
    return text


def _prior(scene: Scene, friction: str) -> Prior:
    """Returns the prior of ln mu, and of ln K_s/H of a batch less that of the scene."""
    x = Normal(0.0, 0.0)
    if friction:
        x = _log_normal(scene, friction)
    elif scene.friction.ball_race:
        x = Normal(math.log(scene.friction.ball_race), 0.0)
    y = _log_wear(scene, of_batch=True)
    _, rho = friction_correlation(scene.uncertainty or {})
    # hardness is part of y, and is correlated with nothing
    wear_share = _log_normal(scene, "wear_coefficient").deviation / y.deviation
    return Prior(x, y, rho * wear_share if friction else 0.0)


def _log_normal(scene: Scene, name: str) -> Normal:
    """Returns mean and standard deviation of the logarithm of an uncertain value."""
    distribution = (scene.uncertainty or {})[name]
    if distribution.distribution == "lognormal":
        median = scene.nominal(name) if distribution.median is None else distribution.median
        return Normal(math.log(median), math.log(distribution.factor or 1.0))
    logs = np.log(value_quantiles(scene, name, (np.arange(1024) + 0.5) / 1024))
    return Normal(float(logs.mean()), float(logs.std()))


def _log_wear(scene: Scene, of_batch: bool) -> Normal:
    """Returns the distribution of ln K_s/H less that of the scene.

    of_batch: whether between batches, or between the bearings of one.
    """
    uncertainty, mean, variance = scene.uncertainty or {}, 0.0, 0.0
    for name in WORN:
        if name not in uncertainty or is_same_for_batch(name, uncertainty[name]) != of_batch:
            continue
        log_value = _log_normal(scene, name)
        sign = -1.0 if name == "brinell_hardness_GPa" else 1.0
        mean += sign * (log_value.mean - math.log(scene.nominal(name)))
        variance += log_value.deviation**2
    return Normal(mean, math.sqrt(variance))


def _curve_at(
    place: str, curve_of: Callable[[Scene, _Result], Curve], scene: Scene, result: _Result
) -> Curve:
    """Returns the curve of a result; an error names the place of the test, such as its row."""
    try:
        return curve_of(scene, result)
    except CaseFileError as error:
        raise CaseFileError(f"{place}: {error}") from None


def _observation(test: BearingTest, curve: Curve, row: str) -> Observation:
    """Returns the logarithm of a test's result, with its model and its scatter."""
    scatter = math.hypot(curve.scatter, test.error)
    if scatter == 0.0:
        problem = "got 0 for bearings without scatter, expected a measurement error > 0"
        raise CaseFileError(f"{row}: error_percent: {problem}")
    torque = test.seen == SEEN_TORQUE
    return Observation(
        seen=math.log(1e-3 * test.value if torque else test.after),
        model=curve.model,
        scatter=scatter,
        of_wear=not torque,
        censored=test.seen == SEEN_RUN_OUT,
        count=test.count,
    )


def _curve(
    scene: Scene,
    result: _Result,
    *,
    x: Normal,
    friction: str,
    workers: int,
    tell: Callable[[str], None] | None,
) -> Curve:
    """Computes lives or torques of a scene over the possible friction, and their scatter.

    CaseFileError: the model has no result at the median friction.
    """
    if tell:
        tell(f"computing {result.words} versus friction for one condition ...")
    nodes = np.array([x.mean])
    if friction:
        cosines = np.cos(np.pi * np.arange(_NODES) / (_NODES - 1))[::-1]
        checked = np.linspace(-0.4, 0.4, _CHECKED)
        nodes = x.mean + _SPAN * x.deviation * np.concatenate([cosines, checked])
    frictions = np.exp(nodes)[:, None] if friction else np.empty((1, 0))
    names = [friction] if friction else []
    logs = result.logs(scene, names, frictions, workers)
    median = float(logs[_NODES // 2]) if friction else float(logs[0])
    if not median > _NONE:
        problem = "got no life from the model: it is zero or could not be computed"
        raise CaseFileError(f"{problem}; `bearingwear life` reports the reason")
    scatter, shift = _scatter(scene, result, median, workers)
    if not friction:
        constant = logs[0] + shift
        return Curve(lambda x: np.full(len(x), constant), 0.0, scatter)
    positions, node_values = nodes[:_NODES], logs[:_NODES]
    solved = np.isfinite(node_values)
    line = PchipInterpolator(positions[solved], node_values[solved])
    errors = np.abs(line(nodes[_NODES:]) - logs[_NODES:])
    error = float(np.nanmax(errors)) if np.isfinite(errors).any() else math.nan
    first, last = positions[solved][[0, -1]]

    def model(x: np.ndarray) -> np.ndarray:
        near = np.clip(x, first, last)
        return line(near) + line.derivative()(near) * (x - near) + shift

    return Curve(model, error, scatter)


def _with_uncertain(scene: Scene, names: Sequence[str]) -> Scene:
    """Returns the scene with no other uncertain values than those of some names."""
    uncertainty = scene.uncertainty or {}
    return replace(scene, uncertainty={name: uncertainty[name] for name in names})


def _log_lives(scene: Scene, names: Sequence[str], rows: np.ndarray, workers: int) -> np.ndarray:
    """Returns logarithms of lives [h] (n,); `_NONE` for a life of zero, NaN where not solved.

    names, rows: uncertain values that differ from the scene's, and their values (n, names).
    """
    scene = _with_uncertain(scene, names)
    with Workers(workers, "calibrate", progress=False) as pool:
        hours = sampled_lives(scene, rows, pool).life * HOURS_PER_SECOND
    return np.log(np.maximum(hours, math.exp(_NONE)))


def _log_torques(scene: Scene, names: Sequence[str], rows: np.ndarray, workers: int) -> np.ndarray:
    """Returns logarithms of torques [N m] (n,); NaN where not solved. Arguments: `_log_lives`."""
    scene = _with_uncertain(scene, names)
    with Workers(workers, "calibrate", progress=False) as pool:
        answers = list(pool.answers_at(partial(torque_answer, scene, names), rows.tolist()))
    if problem := next((answer[PROBLEM] for answer in answers if PROBLEM in answer), None):
        raise CaseFileError(problem)
    return np.array([answer["log_torque"] for answer in answers])


def torque_answer(scene: Scene, names: Sequence[str], row: Sequence[float]) -> dict[str, float]:
    """Returns the logarithm of the torque [N m] at uncertain values; NaN where not solved."""
    values = {name: value for name, value in zip(names, row, strict=True) if name not in WORN}
    changed = scene_with_values(scene, values)
    result = None if changed is None else solve(changed, "steady")
    if result is None or result.status != "ok":
        return {"log_torque": math.nan}
    return {"log_torque": math.log(abs(float(np.sum(result.values["shaft_torque"]))))}


class _Result(NamedTuple):
    """A result of a bearing that tests report."""

    words: str
    logs: Callable[[Scene, Sequence[str], np.ndarray, int], np.ndarray]
    of_wear: bool  # whether it is inversely proportional to K_s/H


_LIFE = _Result("life", _log_lives, of_wear=True)
_TORQUE = _Result("torque", _log_torques, of_wear=False)


def _scatter(scene: Scene, result: _Result, middle: float, workers: int) -> tuple[float, float]:
    """Returns the standard deviation of the logarithm within a batch, and its shift.

    The shift is the mean of the logarithm less `middle`, that of the median bearing.
    """
    uncertainty = scene.uncertainty or {}
    names = [
        name
        for name, distribution in uncertainty.items()
        if not is_same_for_batch(name, distribution) and name not in WORN
    ]
    wear = _log_wear(scene, of_batch=False) if result.of_wear else Normal(0.0, 0.0)
    if not names:
        return wear.deviation, -wear.mean
    probabilities = qmc.Sobol(len(names), seed=1).random(_SAMPLES)
    rows = np.stack(
        [value_quantiles(scene, name, probabilities[:, k]) for k, name in enumerate(names)], axis=-1
    )
    logs = result.logs(scene, names, rows, workers)
    logs = logs[np.isfinite(logs) & (logs > _NONE)]
    if not logs.size:
        return wear.deviation, -wear.mean
    shift = float(logs.mean()) - middle - wear.mean
    return math.hypot(float(logs.std()), wear.deviation), shift


def _calibrated_scene(
    scene: Scene, friction: str, after: Posterior, calibration: Calibrated
) -> Scene:
    """Returns the scene with the calibrated medians and their remaining uncertainty."""
    x, y = after.normal("x"), after.normal("y")
    spread = dict(scene.uncertainty or {})
    for name in (name for name in WORN if name in spread and is_same_for_batch(name, spread[name])):
        del spread[name]

    def remaining(deviation: float, rho: float | None = None) -> Distribution:
        factor = _rounded(math.exp(deviation))
        return Distribution(distribution="lognormal", factor=factor, friction_correlation=rho)

    rho = max(-_CLOSEST, min(_CLOSEST, _rounded(after.correlation()))) if friction else None
    spread["wear_coefficient"] = remaining(y.deviation, rho)
    calibrated = with_wear(scene, {"wear_coefficient": _rounded(math.exp(y.mean))})
    if friction:
        spread[friction] = remaining(x.deviation)
        with_friction = scene_with_values(calibrated, {friction: _median_friction(x)})
        assert with_friction is not None
        calibrated = with_friction
    return replace(calibrated, uncertainty=spread, calibrated=calibration)


def _median_friction(x: Normal) -> float:
    """Returns the median friction, in the three decimals of a study where these are enough."""
    value = math.exp(x.mean)
    three_decimals = round(value, 3)
    is_enough = abs(three_decimals / value - 1.0) < 0.1 * x.deviation
    return three_decimals if is_enough else _rounded(value)


def _rounded(value: float) -> float:
    return float(f"{value:.5g}")


def _wear_over_hardness(scene: Scene) -> float:
    """Returns K_s/H of the rubbing surfaces while the races are new [m2/N]."""
    race = Films.of(scene).race
    archard = race.substrate if race.film is None else race.film
    return archard.factor
