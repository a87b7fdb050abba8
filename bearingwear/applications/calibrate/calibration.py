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
"""Numbers of points over ln mu where lives are solved: to interpolate, and to check the error."""

_CHECKED_UP_TO = 0.4
"""Distance of the outer checked points from the middle, as a share of `_SPAN`."""

_SPAN = 3.0
"""Half the width of the range of the points over ln mu, in standard deviations of its prior."""

_SAMPLES = 32
"""Number of lives in the sample for their scatter within a batch."""

_CLOSEST = 0.99999  # largest magnitude of a correlation in a calibrated scene

IMPOSSIBLE = 1e-6
"""Probability of tests below which they are refused."""

_LIKE_A_UNIT = 0.2
"""Largest distance of |log(factor)|, to base 1000, from 1 at which a wrong unit is suspected.

That is for factors from 250 to 4000, or one over these.
"""

_LOG_OF_ZERO = -60.0  # stands for ln(life / 1 h) of a bearing that is at its end when new

_SIGNIFICANT = 0.1
"""Share of a standard deviation below which rounding of a median does not matter."""

_PROBABILITIES = (np.arange(1024) + 0.5) / 1024
"""At which a distribution is evaluated for the moments of its logarithm."""


class Calibration:
    """A calibrated scene and the data of its calibration.

    scene: with the calibrated friction, wear coefficients and distributions.
    data: dataset of densities, lives and tests, before and after, for `bearingwear show` and
        `plot`.
    """

    def __init__(self, scene: Scene, data: xr.Dataset):
        self.scene, self.data = scene, data

    def write(self, path: Path) -> None:
        """Writes the scene to a new file, and the data beside it with the suffix .nc.

        Raises OutputError as `data_file`, or where a file cannot be written.
        """
        bearingwear.save(self.data, data_file(path))
        bearingwear.save(self.scene, path)


def data_file(path: Path) -> Path:
    """Returns the path of the data file beside a new scene file.

    OutputError: the scene file exists, or has another suffix than .yaml or .yml.
    """
    if path.suffix not in SCENE_SUFFIXES:
        raise OutputError(f"{path}: got this file name, expected one that ends in .yaml or .yml")
    if path.exists():
        raise OutputError(
            f"{path}: already exists and will not be overwritten; choose another name"
        )
    return path.with_suffix(".nc")


@dataclass(frozen=True)
class Curve:
    """The logarithm of a life [h] or a torque [N m] as a function of ln mu."""

    model: LogModel  # mean of the logarithm over the bearings of a batch
    error: float  # largest error of the interpolation, where it was checked; NaN if nowhere
    scatter: float  # standard deviation of the logarithm between the bearings of a batch


def calibration_by_tests(
    scene: Scene,
    path: str | Path,
    workers: int = 1,
    tell: Callable[[str], None] | None = None,
) -> Calibration:
    """Returns a scene calibrated with the tests of a CSV file, and the data of the calibration.

    scene: with `uncertainty.wear_coefficient` and a value that scatters between bearings. Without
        `uncertainty`, that of the table of coefficients is used.
    workers: number of processes that compute the lives.
    tell: receives a line of progress before each condition.
    SceneError: the scene lacks a distribution.
    CaseFileError: a row is invalid, or the tests are improbable in the scene.
    """
    scene, assumption = with_usual_spread(scene_for_life(scene))
    if tell and assumption:
        tell(assumption)
    friction = _uncertain_friction(scene)
    tests = bearing_tests(path, scene)
    digest = hashlib.sha256(Path(path).read_bytes()).hexdigest()
    _refuse_unusable_tests(path, tests, scene, friction, digest)
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
    with_others = conformities(prior, observations)
    # of several kinds of problems the first is told, from which the others may follow
    problems = (
        _improbable_tests(tests, [before.conformity(observation) for observation in observations])
        or _improbable_tests(tests, with_others)
        or _improbable_shifts(prior, after)
    )
    if problems:
        raise CaseFileError(
            f"{path}: got results with a probability below {IMPOSSIBLE:g} in this scene: "
            f"{'; '.join(problems)}; correct them, or increase `uncertainty` in the scene"
        )
    calibration = Calibrated(tests=os.path.basename(path), sha256=digest, rows=len(tests))
    new_scene = _calibrated_scene(scene, friction, after, calibration)
    data = calibration_dataset(
        scene=new_scene,
        wear_over_hardness=_wear_over_hardness(scene),
        prior=prior,
        stages=(before, after),
        life=scene_curve.model,
        scatter=scene_curve.scatter,
        error=max(curve.error for curve in (scene_curve, *curves)),
        tests=tests,
        observations=observations,
        probabilities=[conformity.probability for conformity in with_others],
    )
    return Calibration(new_scene, data)


def _refuse_unusable_tests(
    path: str | Path, tests: Sequence[BearingTest], scene: Scene, friction: str, digest: str
) -> None:
    """Raises CaseFileError for tests that cannot calibrate a scene.

    Such tests have calibrated it already, or are torques although no uncertain friction is the
    same for all bearings of a batch.

    friction: name of such a friction, empty without one.
    digest: SHA-256 of the file of the tests.
    """
    if scene.calibrated and scene.calibrated.sha256 == digest:
        raise CaseFileError(
            f"{path}: got the tests used to calibrate the scene, expected different tests"
        )
    for test in tests:
        if test.seen == SEEN_TORQUE and not friction:
            key = "ball_race" if scene.friction.film is None else "shear_strength_MPa"
            raise CaseFileError(
                f"{path}: row {test.row}: {SEEN_TORQUE}: got a torque, expected uncertainty.{key} "
                "in the scene, the same for all bearings of a batch"
            )


def _uncertain_friction(scene: Scene) -> str:
    """Returns the name in `uncertainty` of a friction that tests can determine; empty without one.

    Tests can determine a friction that is the same for all bearings of a batch.

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


def _improbable_shifts(prior: Prior, after: Posterior) -> list[str]:
    """Returns a sentence for friction and for K_s/H if tests shift it improbably in the scene.

    The probability of such a shift of the mean, in either direction, is below `IMPOSSIBLE`. The
    sentence states the factor.
    """
    normals = (("friction", prior.x, after.normal("x")), ("K_s/H", prior.y, after.normal("y")))
    sentences = []
    for words, before, now in normals:
        shift = now.mean - before.mean
        if before.deviation and 2.0 * ndtr(-abs(shift) / before.deviation) < IMPOSSIBLE:
            sentences.append(f"together: {digits(math.exp(shift))} times the {words} of the scene")
    return sentences


def _improbable_tests(tests: Sequence[BearingTest], conformity: Sequence[Conformity]) -> list[str]:
    """Returns a description of each test whose probability is below `IMPOSSIBLE`.

    conformity: of each test.
    """
    return [
        _deviation_words(test, agreement)
        for test, agreement in zip(tests, conformity, strict=True)
        if agreement.probability < IMPOSSIBLE
    ]


def _deviation_words(test: BearingTest, agreement: Conformity) -> str:
    """States by which factor a test is off the expected value, and whether a unit may be why."""
    words, unit, _ = SEEN_AS[test.seen]
    has_time = test.seen in (SEEN_LOSS, SEEN_PRELOAD)
    suffix = " in time" if has_time else ""
    text = f"row {test.row}, {words}: {digits(agreement.factor)} times the expected value{suffix}"
    thousands = abs(math.log(agreement.factor)) / math.log(1000.0)
    if abs(thousands - 1.0) < _LIKE_A_UNIT:
        text += f" (a factor near 1000 or 0.001 suggests a wrong unit; expected {unit}"
        text += " after h)" if has_time else ")"
    return text


def _prior(scene: Scene, friction: str) -> Prior:
    """Returns the prior of ln mu, and of ln K_s/H of a batch less that of the scene.

    friction: name of the uncertain friction; if empty, friction is known.
    """
    x = Normal(0.0, 0.0)  # of a known film friction, over which no curve varies
    if friction:
        x = _log_normal(scene, friction)
    elif scene.friction.ball_race:
        x = Normal(math.log(scene.friction.ball_race), 0.0)
    y = _log_wear(scene, _wear_names_of_batch(scene))
    _, rho = friction_correlation(scene.uncertainty or {})
    # y contains the hardness, which is not correlated with friction; it is uncertain, as K_s is
    wear_share = _log_normal(scene, "wear_coefficient").deviation / y.deviation
    return Prior(x, y, rho * wear_share if friction else 0.0)


def _wear_names_of_batch(scene: Scene) -> list[str]:
    """Returns the names of the uncertain values of `WORN` that are the same for all of a batch."""
    uncertainty = scene.uncertainty or {}
    return [
        name for name in WORN if name in uncertainty and is_same_for_batch(name, uncertainty[name])
    ]


def _log_normal(scene: Scene, name: str) -> Normal:
    """Returns mean and standard deviation of the natural logarithm of an uncertain value.

    The value is in the unit of its name. Unless the distribution is lognormal, they are estimated
    from its quantiles at evenly spaced probabilities.
    """
    distribution = (scene.uncertainty or {})[name]
    if distribution.distribution == "lognormal":
        median = scene.nominal(name) if distribution.median is None else distribution.median
        return Normal(math.log(median), math.log(distribution.factor or 1.0))
    logs = np.log(value_quantiles(scene, name, _PROBABILITIES))
    return Normal(float(logs.mean()), float(logs.std()))


def _log_wear(scene: Scene, names: Sequence[str]) -> Normal:
    """Returns mean and standard deviation of ln K_s/H less that of the scene.

    names: those of `WORN` that are uncertain; the others are as in the scene.
    """
    mean = variance = 0.0
    for name in names:
        log_value = _log_normal(scene, name)
        sign = -1.0 if name == "brinell_hardness_GPa" else 1.0
        mean += sign * (log_value.mean - math.log(scene.nominal(name)))
        variance += log_value.deviation**2
    return Normal(mean, math.sqrt(variance))


def _curve_at(
    place: str, curve_of: Callable[[Scene, _Result], Curve], scene: Scene, result: _Result
) -> Curve:
    """Returns the curve of a result; its CaseFileError begins with a place.

    place: what the error is about, such as a row of a file.
    """
    try:
        return curve_of(scene, result)
    except CaseFileError as error:
        raise CaseFileError(f"{place}: {error}") from None


def _observation(test: BearingTest, curve: Curve, row: str) -> Observation:
    """Returns the logarithm of a test's result, with its model and its scatter.

    The result is a torque [N m] or a time [h], such as that until a loss or a residual preload.

    row: file and row, which an error names. CaseFileError: nothing of the test scatters.
    """
    scatter = math.hypot(curve.scatter, test.error)
    if scatter == 0.0:
        problem = "got 0 for bearings without scatter, expected a measurement error > 0"
        raise CaseFileError(f"{row}: error_percent: {problem}")
    is_torque = test.seen == SEEN_TORQUE
    return Observation(
        seen=math.log(1e-3 * test.value if is_torque else test.after),
        model=curve.model,
        scatter=scatter,
        depends_on_wear=not is_torque,
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
    """Returns the logarithm of the life or torque of a scene over ln mu, and its scatter.

    Solves results at Chebyshev points within `_SPAN` standard deviations, interpolates between
    those that have one, and checks the interpolation at further points. If friction is known, the
    curve is constant, of one result.

    x: prior of ln mu.
    friction: name of the uncertain friction; if empty, friction is known.
    CaseFileError: the model has no result at the median friction.
    """
    if tell:
        tell(f"computing {result.words} versus friction for one condition ...")
    if not friction:
        (constant,) = result.logs(scene, [], np.empty((1, 0)), workers)
        batch = _batch_scatter(scene, result, _existing_log(constant), workers)
        return Curve(
            lambda log_mu: np.full(len(log_mu), constant + batch.mean), 0.0, batch.deviation
        )
    nodes = np.cos(np.pi * np.arange(_NODES) / (_NODES - 1))[::-1]  # Chebyshev points
    checked = np.linspace(-_CHECKED_UP_TO, _CHECKED_UP_TO, _CHECKED)
    positions = x.mean + _SPAN * x.deviation * np.concatenate([nodes, checked])
    logs = result.logs(scene, [friction], np.exp(positions)[:, None], workers)
    batch = _batch_scatter(scene, result, _existing_log(logs[_NODES // 2]), workers)
    node_positions, node_logs = positions[:_NODES], logs[:_NODES]
    is_solved = np.isfinite(node_logs)
    line = PchipInterpolator(node_positions[is_solved], node_logs[is_solved])
    errors = np.abs(line(positions[_NODES:]) - logs[_NODES:])
    error = float(np.nanmax(errors)) if np.isfinite(errors).any() else math.nan
    first, last = node_positions[is_solved][[0, -1]]

    def model(log_mu: np.ndarray) -> np.ndarray:
        """Returns the interpolated logarithms; beyond the solved points, straight lines."""
        inside = np.clip(log_mu, first, last)
        return line(inside) + line.derivative()(inside) * (log_mu - inside) + batch.mean

    return Curve(model, error, batch.deviation)


def _existing_log(log: float) -> float:
    """Returns the logarithm of a life or torque as it is.

    CaseFileError: it is NaN, or at most `_LOG_OF_ZERO`, as of a life of zero.
    """
    if not log > _LOG_OF_ZERO:
        problem = "got no life from the model: it is zero or could not be computed"
        raise CaseFileError(f"{problem}; `bearingwear life` reports the reason")
    return float(log)


def _with_uncertain(scene: Scene, names: Sequence[str]) -> Scene:
    """Returns the scene in which only the values with these names are uncertain."""
    uncertainty = scene.uncertainty or {}
    return replace(scene, uncertainty={name: uncertainty[name] for name in names})


def _log_lives(scene: Scene, names: Sequence[str], rows: np.ndarray, workers: int) -> np.ndarray:
    """Returns logarithms of lives [h] (n,); `_LOG_OF_ZERO` for a life of zero, NaN if not solved.

    names: of the uncertain values that differ from the scene's.
    rows: these values for each life (n, names).
    """
    scene = _with_uncertain(scene, names)
    with Workers(workers, "calibrate", progress=False) as pool:
        hours = sampled_lives(scene, rows, pool).life * HOURS_PER_SECOND
    return np.log(np.maximum(hours, math.exp(_LOG_OF_ZERO)))


def _log_torques(scene: Scene, names: Sequence[str], rows: np.ndarray, workers: int) -> np.ndarray:
    """Returns logarithms of torques [N m] (n,); NaN where not solved.

    CaseFileError: a torque could not be computed for another reason.

    names: of the uncertain values that differ from the scene's.
    rows: these values for each torque (n, names).
    """
    scene = _with_uncertain(scene, names)
    with Workers(workers, "calibrate", progress=False) as pool:
        answers = list(pool.answers_at(partial(torque_answer, scene, names), rows.tolist()))
    if problem := next((answer[PROBLEM] for answer in answers if PROBLEM in answer), None):
        raise CaseFileError(problem)
    return np.array([answer["log_torque"] for answer in answers])


def torque_answer(scene: Scene, names: Sequence[str], row: Sequence[float]) -> dict[str, float]:
    """Returns `log_torque`, the logarithm of the magnitude of the torque [N m]; NaN if not solved.

    The torque is that of all bearings, by the steady model.

    names, row: uncertain values that differ from the scene's. Those of wear change no torque.
    """
    values = {name: value for name, value in zip(names, row, strict=True) if name not in WORN}
    changed = scene_with_values(scene, values)
    result = None if changed is None else solve(changed, "steady")
    if result is None or result.status != "ok":
        return {"log_torque": math.nan}
    return {"log_torque": math.log(abs(float(np.sum(result.values["shaft_torque"]))))}


class _Result(NamedTuple):
    """A result of a bearing that tests report, and how it is computed."""

    words: str
    logs: Callable[[Scene, Sequence[str], np.ndarray, int], np.ndarray]  # as `_log_lives`
    depends_on_wear: bool  # whether it is inversely proportional to K_s/H


_LIFE = _Result("life", _log_lives, depends_on_wear=True)
_TORQUE = _Result("torque", _log_torques, depends_on_wear=False)


def _batch_scatter(scene: Scene, result: _Result, log_median: float, workers: int) -> Normal:
    """Returns mean and deviation within a batch of the logarithm of a result, less `log_median`.

    Values that scatter within a batch vary: those of wear by their distributions, others in a
    sample of `_SAMPLES` results. Results that are zero or not solved are left out; if all are, wear
    varies alone.

    log_median: logarithm of the result of the median bearing.
    """
    uncertainty = scene.uncertainty or {}
    varying = [
        name
        for name, distribution in uncertainty.items()
        if not is_same_for_batch(name, distribution)
    ]
    names = [name for name in varying if name not in WORN]
    wear = Normal(0.0, 0.0)
    if result.depends_on_wear:
        wear = _log_wear(scene, [name for name in WORN if name in varying])
    by_wear_alone = Normal(-wear.mean, wear.deviation)
    if not names:
        return by_wear_alone
    probabilities = qmc.Sobol(len(names), seed=1).random(_SAMPLES)
    rows = np.stack(
        [value_quantiles(scene, name, probabilities[:, k]) for k, name in enumerate(names)], axis=-1
    )
    logs = result.logs(scene, names, rows, workers)
    logs = logs[np.isfinite(logs) & (logs > _LOG_OF_ZERO)]
    if not logs.size:
        return by_wear_alone
    mean = float(logs.mean()) - log_median - wear.mean
    return Normal(mean, math.hypot(float(logs.std()), wear.deviation))


def _calibrated_scene(
    scene: Scene, friction: str, after: Posterior, calibration: Calibrated
) -> Scene:
    """Returns the scene with the calibrated medians and their remaining uncertainty.

    friction: name of the uncertain friction, empty without one.
    calibration: the block of the scene that names the tests.
    """
    x, y = after.normal("x"), after.normal("y")
    batch_names = _wear_names_of_batch(scene)
    spread = {
        name: distribution
        for name, distribution in (scene.uncertainty or {}).items()
        if name not in batch_names
    }
    rho = None
    if friction:
        rho = max(-_CLOSEST, min(_CLOSEST, _rounded(after.correlation())))
    spread["wear_coefficient"] = _lognormal(y.deviation, rho)
    # exp(y) is a factor on K_s/H of the scene, as `with_wear` takes it
    calibrated = with_wear(scene, {"wear_coefficient": _rounded(math.exp(y.mean))})
    if friction:
        spread[friction] = _lognormal(x.deviation)
        with_friction = scene_with_values(calibrated, {friction: _median_friction(x)})
        assert with_friction is not None
        calibrated = with_friction
    return replace(calibrated, uncertainty=spread, calibrated=calibration)


def _lognormal(deviation: float, rho: float | None = None) -> Distribution:
    """Returns a lognormal distribution whose median is the value in its scene.

    deviation: standard deviation of the logarithm.
    rho: correlation with friction; None without one.
    """
    factor = _rounded(math.exp(deviation))
    return Distribution(distribution="lognormal", factor=factor, friction_correlation=rho)


def _median_friction(x: Normal) -> float:
    """Returns the median friction, with three decimals if that changes it little.

    Studies have frictions with three decimals. Otherwise it has five significant digits.

    x: distribution of ln mu.
    """
    value = math.exp(x.mean)
    three_decimals = round(value, 3)
    changes_little = abs(three_decimals / value - 1.0) < _SIGNIFICANT * x.deviation
    return three_decimals if changes_little else _rounded(value)


def _rounded(value: float) -> float:
    """Returns a number with the five significant digits that a calibrated scene has."""
    return float(f"{value:.5g}")


def _wear_over_hardness(scene: Scene) -> float:
    """Returns K_s/H of new races [m2/N]: of their film if they have one."""
    race = Films.of(scene).race
    archard = race.substrate if race.film is None else race.film
    return archard.factor
