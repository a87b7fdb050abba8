"""A scene calibrated by tests of bearings: friction and K_s/H as they have them, and the life.

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

import numpy as np
import xarray as xr
from scipy.interpolate import PchipInterpolator
from scipy.special import ndtr
from scipy.stats import qmc

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
from bearingwear.atomic import OutputError, write_text
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.results.labels import coded
from bearingwear.results.netcdf import CaseFileError
from bearingwear.results.units import digits
from bearingwear.results.variable import HOURS_PER_SECOND
from bearingwear.scene.blocks import Calibrated
from bearingwear.scene.checking.errors import NotAvailable, SceneError
from bearingwear.scene.checking.records import SCENE_SUFFIXES
from bearingwear.scene.checking.strict_yaml import yaml_of
from bearingwear.scene.coefficients import with_usual_spread
from bearingwear.scene.distributions import value_at
from bearingwear.scene.read import for_life, written_data
from bearingwear.scene.scene import WORN, Distribution, Scene
from bearingwear.scene.uncertain import FRICTION_KEYS, friction_correlation, is_same_for_batch
from bearingwear.solvers.bearing.films import Films
from bearingwear.solvers.solve import solve
from bearingwear.studies.answers import Workers
from bearingwear.studies.dataset import write_dataset
from bearingwear.studies.sampling import scene_with_values, with_wear
from bearingwear.studies.uncertainty.sample import sampled_lives

_NODES, _CHECKED = 9, 4
"""Points over ln mu at which lives are solved: for the interpolation, and to see its error."""

_SPAN = 3.0
"""Half the width that these points span, in standard deviations of ln mu before the tests."""

_SAMPLES = 32
"""Lives of the sample that shows how they scatter within a batch."""

_CLOSEST = 0.99999  # largest correlation that is carried

IMPOSSIBLE = 1e-6
"""Probability of tests below which they are refused."""

_LIKE_A_UNIT = 0.2  # a factor from 250 to 4000, or one over these

_NONE = -60.0  # logarithm of a life that is over when new


class Calibration:
    """Results of tests on a scene.

    scene: with the friction, the wear coefficients and their distributions that the tests leave.
    data: densities, lives and tests, before and after: what `bearingwear show` and `plot` take.
    """

    def __init__(self, scene: Scene, data: xr.Dataset):
        self.scene, self.data = scene, data

    def write(self, path: Path) -> None:
        """Write the scene, and the data beside it."""
        write_dataset(coded(self.data), files_of(path))
        write_text(path, yaml_of(written_data(self.scene)))


def files_of(path: Path) -> Path:
    """The file of the data beside that of a scene, which is new. Raises OutputError."""
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
    error: float  # largest of the interpolation, where it was checked
    scatter: float  # standard deviation between the bearings of a batch


def calibrated(
    scene: Scene,
    tests: str | Path,
    workers: int = 1,
    tell: Callable[[str], None] | None = None,
) -> Calibration:
    """A scene calibrated by the tests of a CSV file.

    scene: with an `uncertainty.wear_coefficient` and something that scatters, or no `uncertainty`:
        then that of the table of coefficients is taken.
    tell: given a line of progress before each condition.
    SceneError, CaseFileError: the scene lacks a distribution, a row is wrong, or the tests are out
        of all proportion to the scene.
    """
    scene, said = with_usual_spread(for_life(scene))
    if tell and said:
        tell(said)
    friction = _checked(scene)
    found = bearing_tests(tests, scene)
    digest = hashlib.sha256(Path(tests).read_bytes()).hexdigest()
    if scene.calibrated and scene.calibrated.sha256 == digest:
        raise CaseFileError(
            f"{tests}: got the tests used to calibrate the scene, expected different tests"
        )
    prior = _prior(scene, friction)
    if any(test.seen == SEEN_TORQUE for test in found) and not friction:
        row = next(test.row for test in found if test.seen == SEEN_TORQUE)
        key = FRICTION_KEYS[scene.friction.film is not None]
        problem = (
            f"got a result that would determine uncertainty.{key}, which the scene does not contain"
        )
        raise CaseFileError(f"{tests}: row {row}: {SEEN_TORQUE}: {problem}")
    curve = cache(partial(_curve, x=prior.x, friction=friction, workers=workers, tell=tell))
    own = _found(curve, scene, False, scene.name)
    rows = [f"{tests}: row {test.row}" for test in found]
    curves = [
        _found(curve, test.scene, test.seen == SEEN_TORQUE, row)
        for test, row in zip(found, rows, strict=True)
    ]
    seen = [_observation(*one) for one in zip(found, curves, rows, strict=True)]
    before, after = posterior(prior, []), posterior(prior, seen)
    agreed = conformities(prior, seen)
    _check_conformity(tests, found, [before.conformity(one) for one in seen], agreed, prior, after)
    calibration = Calibrated(tests=os.path.basename(tests), sha256=digest, rows=len(found))
    new = _carried(scene, friction, after, calibration)
    data = calibration_dataset(
        scene=new,
        unit=_wear_of(scene),
        prior=prior,
        stages=(before, after),
        life=own.model,
        scatter=own.scatter,
        error=max([own.error, *(one.error for one in curves)]),
        tests=found,
        seen=seen,
        probabilities=[one.probability for one in agreed],
    )
    return Calibration(new, data)


def _checked(scene: Scene) -> str:
    """The uncertain friction of a scene, empty without one; refuses a scene without the others."""
    given = scene.uncertainty or {}
    known = given.get("wear_coefficient")
    if known is None or not is_same_for_batch("wear_coefficient", known):
        raise SceneError(
            "uncertainty.wear_coefficient",
            "got no value that tests could determine, expected {distribution: lognormal, "
            "factor: 3}",
            source=scene.name,
        )
    if all(is_same_for_batch(name, one) for name, one in given.items()):
        raise SceneError(
            "uncertainty",
            "got no value that varies from bearing to bearing, expected wear_scatter: "
            "{distribution: lognormal, factor: 1.3}, or another distribution",
            source=scene.name,
        )
    names = (n for n in FRICTION_KEYS if n in given and is_same_for_batch(n, given[n]))
    return next(names, "")


def _check_conformity(
    path: str | Path,
    tests: Sequence[BearingTest],
    alone: Sequence[Conformity],
    with_others: Sequence[Conformity],
    prior: Prior,
    after: Posterior,
) -> None:
    """Refuse tests that no bearing of the scene can have given: CaseFileError.

    One that the scene alone makes impossible is named in place of those that it contradicts.
    """
    found: list[str] = []
    for agreed in (alone, with_others):
        each = zip(tests, agreed, strict=True)
        found = found or [_far(test, one) for test, one in each if one.probability < IMPOSSIBLE]
    normals = (("friction", prior.x, after.normal("x")), ("K_s/H", prior.y, after.normal("y")))
    found = found or [
        f"together: {digits(math.exp(now.mean - was.mean))} times the {words} of the scene"
        for words, was, now in normals
        if was.deviation and 2.0 * ndtr(-abs(now.mean - was.mean) / was.deviation) < IMPOSSIBLE
    ]
    if found:
        raise CaseFileError(
            f"{path}: got results with a probability below {IMPOSSIBLE:g} in this scene: "
            f"{'; '.join(found)}; correct them, or increase `uncertainty` in the scene"
        )


def _far(test: BearingTest, agreed: Conformity) -> str:
    """How far a test is from what the model expects, and whether a unit may be the reason."""
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
    """Of ln mu, and of ln K_s/H over that of the scene, of a batch."""
    x = Normal(0.0, 0.0)
    if friction:
        x = _log_normal(scene, friction)
    elif scene.friction.ball_race:
        x = Normal(math.log(scene.friction.ball_race), 0.0)
    y = _worn(scene, of_batch=True)
    _, rho = friction_correlation(scene.uncertainty or {})
    # hardness is part of y, and goes with nothing
    share = _log_normal(scene, "wear_coefficient").deviation / y.deviation
    return Prior(x, y, rho * share if friction else 0.0)


def _log_normal(scene: Scene, name: str) -> Normal:
    """Mean and standard deviation of the logarithm of an uncertain value."""
    given = (scene.uncertainty or {})[name]
    if given.distribution == "lognormal":
        median = scene.nominal(name) if given.median is None else given.median
        return Normal(math.log(median), math.log(given.factor or 1.0))
    logs = np.log(value_at(scene, name, (np.arange(1024) + 0.5) / 1024))
    return Normal(float(logs.mean()), float(logs.std()))


def _worn(scene: Scene, of_batch: bool) -> Normal:
    """Of ln K_s/H over that of the scene: of a batch, or within it."""
    given, mean, variance = scene.uncertainty or {}, 0.0, 0.0
    for name in (n for n in WORN if n in given and is_same_for_batch(n, given[n]) == of_batch):
        one = _log_normal(scene, name)
        sign = -1.0 if name == "brinell_hardness_GPa" else 1.0
        mean += sign * (one.mean - math.log(scene.nominal(name)))
        variance += one.deviation**2
    return Normal(mean, math.sqrt(variance))


def _found(curve: Callable[[Scene, bool], Curve], scene: Scene, torque: bool, where: str) -> Curve:
    """A curve, or a refusal that says where it is asked for."""
    try:
        return curve(scene, torque)
    except CaseFileError as error:
        raise CaseFileError(f"{where}: {error}") from None


def _observation(test: BearingTest, curve: Curve, where: str) -> Observation:
    scatter = math.hypot(curve.scatter, test.error)
    if scatter == 0.0:
        problem = "got 0 for bearings without scatter, expected a measurement error > 0"
        raise CaseFileError(f"{where}: error_percent: {problem}")
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
    torque: bool,
    *,
    x: Normal,
    friction: str,
    workers: int,
    tell: Callable[[str], None] | None,
) -> Curve:
    """Lives or torques of a scene over the friction that is possible, and how they scatter.

    CaseFileError: where the model has none at the middle of the friction.
    """
    if tell:
        tell(f"computing {'torque' if torque else 'life'} versus friction for one condition ...")
    nodes = np.array([x.mean])
    if friction:
        cosines = np.cos(np.pi * np.arange(_NODES) / (_NODES - 1))[::-1]
        checked = np.linspace(-0.4, 0.4, _CHECKED)
        nodes = x.mean + _SPAN * x.deviation * np.concatenate([cosines, checked])
    rows = np.exp(nodes)[:, None] if friction else np.empty((1, 0))
    names = [friction] if friction else []
    values = _logs(scene, names, rows, torque, workers)
    middle = float(values[_NODES // 2]) if friction else float(values[0])
    if not middle > _NONE:
        problem = "got no life from the model: it is zero or could not be computed"
        raise CaseFileError(f"{problem}; `bearingwear life` reports the reason")
    scatter, shift = _scatter(scene, torque, middle, workers)
    if not friction:
        constant = values[0] + shift
        return Curve(lambda x: np.full(len(x), constant), 0.0, scatter)
    positions, known = nodes[:_NODES], values[:_NODES]
    used = np.isfinite(known)
    line = PchipInterpolator(positions[used], known[used])
    missed = np.abs(line(nodes[_NODES:]) - values[_NODES:])
    error = float(np.nanmax(missed)) if np.isfinite(missed).any() else math.nan
    first, last = positions[used][[0, -1]]

    def model(x: np.ndarray) -> np.ndarray:
        near = np.clip(x, first, last)
        return line(near) + line.derivative()(near) * (x - near) + shift

    return Curve(model, error, scatter)


def _logs(
    scene: Scene, names: Sequence[str], rows: np.ndarray, torque: bool, workers: int
) -> np.ndarray:
    """Logarithms of lives [h] or torques [N m] (n,) at values (n, names); NaN where not solved."""
    given = scene.uncertainty or {}
    scene = replace(scene, uncertainty={name: given[name] for name in names})
    if torque:
        return np.array([_log_torque(scene, names, row) for row in rows])
    with Workers(workers, "calibrate", progress=False) as pool:
        hours = sampled_lives(scene, rows, pool).life * HOURS_PER_SECOND
    return np.log(np.maximum(hours, math.exp(_NONE)))


def _log_torque(scene: Scene, names: Sequence[str], row: np.ndarray) -> float:
    shape = {n: float(v) for n, v in zip(names, row, strict=True) if n not in WORN}
    other = scene_with_values(scene, shape)
    if other is None:
        return math.nan
    try:
        result = solve(other, "steady")
    except NotAvailable as error:
        raise CaseFileError(str(error)) from None
    if result.status != STATUS_NAMES[OK]:
        return math.nan
    return math.log(abs(float(np.sum(result.values["shaft_torque"]))))


def _scatter(scene: Scene, torque: bool, middle: float, workers: int) -> tuple[float, float]:
    """Standard deviation of the logarithm within a batch, and its mean less that of the middle."""
    given = scene.uncertainty or {}
    names = [n for n, one in given.items() if not is_same_for_batch(n, one) and n not in WORN]
    wear = _worn(scene, of_batch=False) if not torque else Normal(0.0, 0.0)
    if not names:
        return wear.deviation, -wear.mean
    unit = qmc.Sobol(len(names), seed=1).random(_SAMPLES)
    rows = np.stack([value_at(scene, n, unit[:, k]) for k, n in enumerate(names)], axis=-1)
    logs = _logs(scene, names, rows, torque, workers)
    logs = logs[np.isfinite(logs) & (logs > _NONE)]
    if not logs.size:
        return wear.deviation, -wear.mean
    shift = float(logs.mean()) - middle - wear.mean
    return math.hypot(float(logs.std()), wear.deviation), shift


def _carried(scene: Scene, friction: str, after: Posterior, calibration: Calibrated) -> Scene:
    """The scene with the middles that the tests leave, and what they leave unknown."""
    x, y = after.normal("x"), after.normal("y")
    spread = dict(scene.uncertainty or {})
    for name in (n for n in WORN if n in spread and is_same_for_batch(n, spread[n])):
        del spread[name]

    def remaining(deviation: float, rho: float | None = None) -> Distribution:
        factor = _rounded(math.exp(deviation))
        return Distribution(distribution="lognormal", factor=factor, friction_correlation=rho)

    rho = max(-_CLOSEST, min(_CLOSEST, _rounded(after.correlation()))) if friction else None
    spread["wear_coefficient"] = remaining(y.deviation, rho)
    found = with_wear(scene, {"wear_coefficient": _rounded(math.exp(y.mean))})
    if friction:
        spread[friction] = remaining(x.deviation)
        middle = scene_with_values(found, {friction: _short(x)})
        assert middle is not None
        found = middle
    return replace(found, uncertainty=spread, calibrated=calibration)


def _short(x: Normal) -> float:
    """The middle of a friction, in the three decimals that a study takes where they are enough."""
    value = math.exp(x.mean)
    short = round(value, 3)
    return short if abs(short / value - 1.0) < 0.1 * x.deviation else _rounded(value)


def _rounded(value: float) -> float:
    return float(f"{value:.5g}")


def _wear_of(scene: Scene) -> float:
    """K_s/H of what rubs while the races are new [m2/N]."""
    race = Films.of(scene).race
    part = race.below if race.film is None else race.film
    return part.factor
