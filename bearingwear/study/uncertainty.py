"""How sure a life is: sampled lives, their quantiles, and which uncertain value decides.

Theory: docs/theory.md, section 15.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from SALib.analyze import sobol as sobol_analysis
from SALib.sample import sobol as sobol_sample
from scipy import stats

from bearingwear.io.config import schema_at, uncertain_key
from bearingwear.io.netcdf import CaseFileError, common_attributes, load
from bearingwear.io.spread import CONFIDENCE
from bearingwear.io.variables import CRITERIA, HOUR, STATUS
from bearingwear.kernels.status import BEYOND_GROOVE, OK, STATUS_NAMES
from bearingwear.model.life import course_of, steady_states
from bearingwear.model.sampled import sampled
from bearingwear.model.scene import COUNTS, WORN, Distribution, Scene
from bearingwear.study.design import COUNTED, attrs, flags, recommended_for
from bearingwear.study.design_plan import AT, Sampling
from bearingwear.study.grid import PRELOAD_METHODS

OF = ("life", "life_at_stated_wear")
"""What is spread: life with all that is uncertain, and with the scene's own K_s and hardness."""

PROBABILITIES = (0.1, 0.5, 0.9)
RESAMPLES = 200  # of the bootstrap that the errors of the indices come from


def frozen(scene: Scene, name: str) -> Any:
    """The distribution of an uncertain value, as `scipy.stats` has it."""
    given: Distribution = (scene.uncertainty or {})[name]
    if given.distribution == "uniform":
        assert given.low is not None and given.high is not None
        return stats.uniform(given.low, given.high - given.low)
    if given.distribution == "normal":
        mean = scene.nominal(name) if given.mean is None else given.mean
        return stats.norm(mean, given.standard_deviation)
    median = scene.nominal(name) if given.median is None else given.median
    assert given.factor is not None
    return stats.lognorm(np.log(given.factor), scale=median)


def possible(scene: Scene, name: str) -> tuple[float, float]:
    """Least and largest value that a scene may have there."""
    part = schema_at(uncertain_key(name, scene.bearing.race_material))
    low = part.get("minimum", part.get("exclusiveMinimum", -np.inf))
    return low, part.get("maximum", part.get("exclusiveMaximum", np.inf))


def value_at(scene: Scene, name: str, probability: np.ndarray) -> np.ndarray:
    """Quantiles of an uncertain value, its distribution cut off where it would be impossible."""
    spread = frozen(scene, name)
    below, upto = spread.cdf(possible(scene, name))
    return spread.ppf(below + (upto - below) * np.asarray(probability))


def problem(scene: Scene) -> dict[str, Any]:
    """The uncertain values as SALib takes them, by their probabilities."""
    names = list(scene.uncertainty or {})
    return {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}


def sample(scene: Scene, plan: Sampling) -> np.ndarray:
    """Values (samples, values + 2, values): of each base sample A, A with one value of B each, B.

    A scrambled Sobol sequence in Saltelli's arrangement; the same for the same seed.
    """
    of = problem(scene)
    unit = sobol_sample.sample(of, plan.samples, calc_second_order=False, seed=plan.seed)
    columns = [value_at(scene, name, unit[:, k]) for k, name in enumerate(of["names"])]
    return np.stack(columns, axis=-1).reshape(plan.samples, -1, of["num_vars"])


def lives(scene: Scene, rows: np.ndarray) -> tuple[np.ndarray, ...]:
    """Lives (n, 2) [s], status (n,), end criterion (n,) and factor (n,) at values (n, values).

    The factor is what the life is longer by than with the scene's own K_s and H.

    Life is proportional to H/K_s, exactly: rows that differ in these alone are solved once.
    """
    names = list(scene.uncertainty or {})
    shape = [k for k, name in enumerate(names) if name not in WORN]
    factor = np.ones(len(rows))
    for k, name in enumerate(names):
        if name in WORN:
            ratio = rows[:, k] / scene.nominal(name)
            factor = factor * (ratio if name == "brinell_hardness_GPa" else 1.0 / ratio)
    unlike, which = np.unique(rows[:, shape], axis=0, return_inverse=True)
    found = [_life(scene, {names[k]: float(v) for k, v in zip(shape, row, strict=True)})
             for row in unlike]  # fmt: skip
    life, status, criterion = (np.array(part)[which.ravel()] for part in zip(*found, strict=True))
    return life * factor[:, None], status, criterion, factor


def _life(scene: Scene, values: Mapping[str, float]) -> tuple[np.ndarray, int, int]:
    other = sampled(scene, values)
    if other is None:
        return np.full(2, np.nan), BEYOND_GROOVE, len(CRITERIA) - 1
    course = course_of(other, steady_states(other))
    life = course.times[-1] if course.status == OK else np.full(2, np.nan)
    return life, course.status, course.criterion


def with_preload(scene: Scene, method: str, preload_N: float) -> Scene:
    """The scene with a method and a preload; the spread of the preload goes with it."""
    spreads = dict(scene.uncertainty or {})
    if "preload_N" in spreads:
        share, old = preload_N / scene.operation.preload_N, spreads["preload_N"]
        parts = {
            part: getattr(old, part) * share
            for part in ("mean", "standard_deviation", "median", "low", "high")
            if getattr(old, part) is not None
        }
        spreads["preload_N"] = replace(old, **parts)
    operation = replace(scene.operation, preload_method=method, preload_N=preload_N)
    return replace(scene, operation=operation, uncertainty=spreads)


def preload_at(scene: Scene, method: str, where: str, recommendation: xr.Dataset | None) -> float:
    """The scene's own or the recommended preload; NaN if none is recommended."""
    if where == AT[0]:
        return scene.operation.preload_N
    flag = PRELOAD_METHODS.index(method)
    recommendation = recommended_for(scene, recommendation)
    if flag not in recommendation["preload_method"]:
        raise CaseFileError(f"the recommendation has no {method}")
    return float(recommendation["preload"].sel(preload_method=flag))


def chunk(
    scene: Scene,
    plan: Sampling,
    method: str,
    where: str,
    number: int,
    recommendation: xr.Dataset | None,
) -> xr.Dataset:
    """One part of the sampled lives; empty where there is no preload to take."""
    preload = preload_at(scene, method, where, recommendation)
    base = np.array_split(np.arange(plan.samples), plan.chunks)[number]
    file = common_attributes() | {
        "title": f"Sampled lives of {scene.name}: {method}, {where} preload",
        "kind": "sampled lives",
        "scene": json.dumps(scene.to_dict()),
        "preload_method": method,
        "at": where,
        "samples": np.int64(plan.samples),
        "seed": np.int64(plan.seed),
        "chunk": np.int64(number),
        "chunks": np.int64(plan.chunks),
        "preload_N": np.float64(preload),
    }
    if np.isnan(preload):
        return xr.Dataset(attrs=file)
    of = with_preload(scene, method, preload)
    rows = sample(of, plan)[base]
    life, status, criterion, factor = lives(of, rows.reshape(-1, rows.shape[-1]))
    dims, shape = ("base", "row"), rows.shape[:2]
    return xr.Dataset(
        {
            "status": (dims, status.reshape(shape).astype(np.int8),
                       flags(STATUS.long_name, STATUS_NAMES)),
            "end_criterion": (dims, criterion.reshape(shape).astype(np.int8),
                              flags("criterion that ends the life", CRITERIA)),
            "wear_factor": (dims, factor.reshape(shape),
                            attrs("life over the one with the scene's own K_s and hardness", "1")),
            "life": ((*dims, "counts"), (life * HOUR).reshape(*shape, 2), attrs("wear life", "h")),
        },
        {
            "base": ("base", base, attrs("number of the base sample", "1")),
            "counts": ("counts", np.arange(2, dtype=np.int8),
                       flags(COUNTED, COUNTS)),
        },
        file,
    )  # fmt: skip


def spread(paths: Iterable[str | Path], scene: Scene, plan: Sampling) -> xr.Dataset:
    """Quantiles of life and Sobol indices of its logarithm, from all parts of the sampled lives.

    Raises
    ------
    CaseFileError
        One line: a file that is no such part, of another scene or sampling, or parts missing.
    """
    parts: dict[tuple[str, str], list[xr.Dataset]] = {}
    for path in map(Path, paths):
        part = load(path)
        if part.attrs.get("kind") != "sampled lives":
            raise CaseFileError(f"{path}: not a part of sampled lives")
        of = (part.attrs["samples"], part.attrs["seed"], part.attrs["chunks"])
        if json.loads(part.attrs["scene"]) != scene.to_dict() or of != (
            plan.samples, plan.seed, plan.chunks,
        ):  # fmt: skip
            raise CaseFileError(f"{path}: not of this scene and sampling")
        parts.setdefault((part.attrs["preload_method"], part.attrs["at"]), []).append(part)
    methods = [m for m in PRELOAD_METHODS if any(m == method for method, _ in parts)]
    for method in methods:
        for where in AT:
            numbers = sorted(int(part.attrs["chunk"]) for part in parts.get((method, where), []))
            if numbers != list(range(plan.chunks)):
                raise CaseFileError(f"sampled lives of {method}, {where} preload: parts missing")
    table = [
        [_analysed(scene, method, parts[method, where], plan) for where in AT] for method in methods
    ]
    names = tuple(scene.uncertainty or {})
    quantity = np.arange(len(names), dtype=np.int8)
    coords = {"quantity": ("quantity", quantity, flags("uncertain value", names))}
    return _file(scene, plan, methods, AT, table).assign_coords(coords)


def life_spread(scene: Scene, methods: Sequence[str], plan: Sampling) -> xr.Dataset:
    """Quantiles of the life at the scene's own preload: 2 x samples lives, and no indices."""
    names = list(scene.uncertainty or {})
    rows = sample(scene, plan)[:, [0, -1]].reshape(-1, len(names))
    table = []
    for method in methods:
        of = with_preload(scene, method, scene.operation.preload_N)
        life, status, _, factor = lives(of, np.vstack([_middle(of), rows]))
        hours, solved = life * HOUR, status[1:] == OK
        found = {
            "preload": scene.operation.preload_N,
            "evaluations": solved.size,
            "solved_share": solved.mean(),
            "nominal_life": hours[0],
        }
        table.append([found | _quantiles_of(hours[1:], factor[1:])])
    return _file(scene, plan, methods, AT[:1], table)


def _file(
    scene: Scene,
    plan: Sampling,
    methods: Sequence[str],
    at: Sequence[str],
    table: Sequence[Sequence[Mapping[str, Any]]],
) -> xr.Dataset:
    """What was found, by method and preload, as a file of the kind `uncertainty`."""
    coords = {
        "preload_method": (
            "preload_method", np.array([PRELOAD_METHODS.index(m) for m in methods], dtype=np.int8),
            flags("how the preload is applied", PRELOAD_METHODS),
        ),
        "at": ("at", np.arange(len(at), dtype=np.int8), flags("which preload", AT)),
        "counts": ("counts", np.arange(2, dtype=np.int8), flags(COUNTED, COUNTS)),
        "of": ("of", np.arange(len(OF), dtype=np.int8), flags("what is spread", OF)),
        "probability": ("probability", list(PROBABILITIES),
                        attrs("share of bearings that have failed", "1")),
    }  # fmt: skip
    variables = {
        name: (
            ("preload_method", "at", *dims),
            np.array([[analysed[name] for analysed in row] for row in table]),
            attrs(long_name, units),
        )
        for name, (dims, long_name, units) in ANALYSED.items()
        if name in table[0][0]
    }
    return xr.Dataset(
        variables,
        coords,
        common_attributes()
        | {
            "title": f"Uncertainty of the life of {scene.name}",
            "kind": "uncertainty",
            "scene": json.dumps(scene.to_dict()),
            "samples": np.int64(plan.samples),
            "seed": np.int64(plan.seed),
            "confidence": CONFIDENCE,
        },
    )


ANALYSED: dict[str, tuple[tuple[str, ...], str, str]] = {
    "preload": ((), "initial axial preload, middle of its spread", "N"),
    "evaluations": ((), "lives evaluated", "1"),
    "solved_share": ((), "share of the lives that were solved", "1"),
    "index_share": ((), "share of the base samples that the indices are taken from", "1"),
    "nominal_life": (("counts",), "life with every value at its median", "h"),
    "life_quantile": (("of", "probability", "counts"), "quantile of the life", "h"),
    "life_quantile_low": (
        ("of", "probability", "counts"), "lower end of the quantile's confidence interval", "h",
    ),
    "life_quantile_high": (
        ("of", "probability", "counts"), "upper end of the quantile's confidence interval", "h",
    ),
    "swing": (
        ("quantity", "end", "counts"),
        "life with one value at its 10 % and 90 % quantile, the others at their medians", "h",
    ),
    "first_index": (("of", "quantity", "counts"), "first-order Sobol index of log life", "1"),
    "first_index_error": (("of", "quantity", "counts"), "half its confidence interval", "1"),
    "total_index": (("of", "quantity", "counts"), "total Sobol index of log life", "1"),
    "total_index_error": (("of", "quantity", "counts"), "half its confidence interval", "1"),
    "life_sample": (("of", "member", "counts"), "sampled lives, independent ones, sorted", "h"),
}  # fmt: skip
"""What is made of the sampled lives of a method at a preload: dimensions, meaning, units."""


def indices(scene: Scene, y: np.ndarray, seed: int) -> dict[str, np.ndarray]:
    """Sobol indices (values,) of an answer y (samples, values + 2) in the order of `sample`."""
    found = sobol_analysis.analyze(
        problem(scene), y.ravel(), calc_second_order=False, num_resamples=RESAMPLES,
        conf_level=CONFIDENCE, seed=seed,
    )  # fmt: skip
    names = {"first_index": "S1", "total_index": "ST"}
    return {name: np.asarray(found[key]) for name, key in names.items()} | {
        f"{name}_error": np.asarray(found[f"{key}_conf"]) for name, key in names.items()
    }


def _analysed(
    scene: Scene, method: str, parts: Sequence[xr.Dataset], plan: Sampling
) -> dict[str, Any]:
    """`ANALYSED` of one method at one preload; NaN where there is no preload or nothing solved."""
    names = list(scene.uncertainty or {})
    sizes = {"counts": 2, "of": len(OF), "probability": len(PROBABILITIES), "end": 2,
             "quantity": len(names), "member": 2 * plan.samples}  # fmt: skip
    found: dict[str, Any] = {
        name: np.full([sizes[dim] for dim in dims], np.nan)
        for name, (dims, _, _) in ANALYSED.items()
    }
    found["preload"], found["evaluations"] = parts[0].attrs["preload_N"], 0
    if "life" not in parts[0]:
        return found
    whole = xr.concat(sorted(parts, key=lambda part: int(part.attrs["chunk"])), "base")
    solved = whole["status"].values == OK
    found["evaluations"] = solved.size
    found["solved_share"] = solved.mean()
    usable = (solved & (whole["life"].values > 0.0).all(axis=-1)).all(axis=1)
    found["index_share"] = usable.mean()
    life, factor = whole["life"].values, whole["wear_factor"].values
    both = life, life / factor[..., None]
    found |= _quantiles_of(  # of A and B; the others repeat them
        *(np.concatenate([part[:, 0], part[:, -1]]) for part in (life, factor))
    )
    for k, one in enumerate(both):
        for c in range(2):
            y = np.log(one[usable, :, c])
            if y.size and np.ptp(y) > 0.0:
                for name, values in indices(scene, y, plan.seed).items():
                    found[name][k, :, c] = values
    of = with_preload(scene, method, float(found["preload"]))
    middle = _middle(of)
    rows = [middle] + [
        [float(value_at(of, names[j], np.array(p))) if i == j else v for i, v in enumerate(middle)]
        for j in range(len(names))
        for p in (PROBABILITIES[0], PROBABILITIES[-1])
    ]
    around = lives(of, np.array(rows))[0] * HOUR
    found["nominal_life"], found["swing"] = around[0], around[1:].reshape(len(names), 2, 2)
    return found


def _middle(scene: Scene) -> list[float]:
    """Every uncertain value at its median."""
    return [float(value_at(scene, name, np.array(0.5))) for name in scene.uncertainty or {}]


def _quantiles_of(life: np.ndarray, factor: np.ndarray) -> dict[str, np.ndarray]:
    """Those of independent lives (n, 2) [h], and of lives without what K_s and H do (n,)."""
    both = np.stack([life, life / factor[:, None]])
    found = np.array([[quantiles(one[:, c]) for c in range(2)] for one in both])
    names = ("life_quantile", "life_quantile_low", "life_quantile_high")
    ends = {name: found[:, :, k].swapaxes(1, 2) for k, name in enumerate(names)}
    return ends | {"life_sample": np.sort(both, axis=1)}


def quantiles(life: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`PROBABILITIES` quantiles of lives (n,) and the ends of their confidence intervals.

    The intervals are those of order statistics, whatever the distribution. They take the members of
    the sample for independent; a Sobol sequence is spread more evenly, so they are rather wide.
    """
    known = life[np.isfinite(life)]
    found = np.full((3, len(PROBABILITIES)), np.nan)
    if known.size:
        for k, p in enumerate(PROBABILITIES):
            interval = stats.quantile_test(known, p=p).confidence_interval(CONFIDENCE)
            found[:, k] = np.quantile(known, p), interval.low, interval.high
    return found[0], found[1], found[2]
