"""Charts of the design study: life, and what requirements apply to, over the preload."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from bearingwear.document.chart import Chart, ChartLine, Charts
from bearingwear.kernels.status import OK
from bearingwear.measures import LIMITED
from bearingwear.results.pair_variables import method_words
from bearingwear.results.quantiles import load_quantiles
from bearingwear.results.units import digits, printed_unit, scale_of
from bearingwear.results.words import methods, scene_of
from bearingwear.studies.design.choice import design_files, limit_margins, limits_of, line_of_scene
from bearingwear.studies.design.document.sheets import (
    NONE_VIOLATED,
    SAME,
    brief_rows,
    recommended_spreads,
)
from bearingwear.studies.design.document.words import ending_measure, limit_text
from bearingwear.studies.design.document.worst_conditions import (
    critical_condition_words,
    extent_words,
)
from bearingwear.studies.design.recommend import best_method

X_LABEL = "initial preload (N)"
_DECADES = 30.0
"""Of a quantity, the ratio from which its axis is logarithmic."""

Bands = Mapping[str, tuple[float, float]]
"""Lives between which those of most bearings lie [h], by method."""


class PointOverPreload(NamedTuple):
    """A point of a line over the preload."""

    preload: float  # [N]
    values: xr.Dataset


PreloadPoints = Mapping[str, Sequence[PointOverPreload]]
"""Points over the preload, by method."""


def preload_points(design: xr.Dataset, recommendation: xr.Dataset) -> PreloadPoints:
    """Returns the preloads of a map at the scene's friction and speed, and the recommended one."""
    recommended = dict(methods(recommendation))
    points = {}
    for method, line in methods(line_of_scene(design)):
        by_preload = {float(p): line.isel(preload=k) for k, p in enumerate(line["preload"].values)}
        best = recommended[method]
        if np.isfinite(best["preload"]):
            by_preload[float(best["preload"])] = best.assign_attrs(design.attrs)
        points[method] = [PointOverPreload(p, by_preload[p]) for p in sorted(by_preload)]
    return points


def design_charts(
    design: Path,
    recommendation: Path,
    uncertainty: Path | None = None,
    spread: Path | None = None,
) -> str:
    """Step: returns the question of the study and its charts as JSON.

    Files are those of `design_answer`.
    """
    lives, recommended, sampled = design_files(design, recommendation, uncertainty)
    sampled = sampled if spread is None else load_quantiles(spread)[0]
    question = "Which preload and preload method give the longest life?"
    if limits_of(lives).given:
        requirements = _achieved_requirements(recommended)
        question = f"User requirements, {extent_words(recommended)}: {requirements}."
    bands = {
        method: (life_spread.bearings.low, life_spread.bearings.high)
        for method, life_spread in recommended_spreads(recommended, sampled).items()
        if life_spread
    }
    charts = list(preload_charts(lives, recommended, bands))
    return Charts(question=question, charts=charts).stored


def _achieved_requirements(recommendation: xr.Dataset) -> str:
    """Returns the requirements, each with what the recommended bearing achieves."""
    best, limits = best_method(recommendation), limits_of(recommendation).given
    texts = [limit_text(name, value) for name, value in limits.items()]
    if best is None:
        return "; ".join(texts)
    point = recommendation.isel(preload_method=best)
    for k, (name, value) in enumerate(limits.items()):
        measure = LIMITED[name]
        achieved_value = digits(measure.shown(float(measure.worst(point))))
        achieved = f"{achieved_value} {printed_unit(measure.unit)}"
        margin = f"margin {100.0 * abs(float(measure.margins(point, value))):.0f} %"
        where = critical_condition_words(recommendation, point, name)
        if where:
            where = f" {where}" if where.startswith("at ") else f", {where}"
        texts[k] += f" (achieved: {achieved}{where}; {margin})"
    return "; ".join(texts)


def preload_charts(design: xr.Dataset, recommendation: xr.Dataset, bands: Bands) -> Iterator[Chart]:
    """Yields the life over the preload, then each quantity of the short tables."""
    scene, limits = scene_of(design), limits_of(design).given
    recommended = {method: float(point["preload"]) for method, point in methods(recommendation)}
    lines = preload_points(design, recommendation)
    violated = {method: _violated_ranges(line) for method, line in lines.items()}
    preloads = [point.preload for line in lines.values() for point in line]
    *rows, violations = brief_rows([point.values for line in lines.values() for point in line])
    for row in rows:
        is_life = row is rows[0]
        values, notes = iter(row.values), iter(violations.values)
        chart_lines = []
        for method, line in lines.items():
            points = [(point.preload, _finite_or_none(next(values))) for point in line]
            stars = [(x, y) for x, y in points if x == recommended[method] and y is not None]
            chart_lines.append(
                ChartLine(
                    name=method_words(scene, method),
                    method=method,
                    points=points,
                    ends=[_end_words(point.values) for point in line] if is_life else (),
                    notes=[next(notes).replace(NONE_VIOLATED, "") for _ in line],
                    beyond=violated[method],
                    star=stars[0] if stars else None,
                    band=bands.get(method) if is_life else None,
                )
            )
        key = "life_h" if is_life else row.name
        measure, limit = LIMITED.get(key), limits.get(key)
        if limit is not None and measure and not is_life:  # lives are in hours in files, too
            _, factor = scale_of(row.unit)
            limit = factor * measure.file_limit(limit, 1.0)
        bounds = [bound for band in bands.values() for bound in band] if is_life else []
        positive = [value for value in (*row.values, *bounds) if value > 0.0]
        yield Chart(
            title="Life versus initial preload" if is_life else row.label,
            x_label=X_LABEL,
            y_label=row.head,
            lines=chart_lines,
            limit=limit,
            at_least=bool(measure and measure.falls),
            log_x=max(preloads) > _DECADES * min(preloads),
            log_y=bool(positive) and max(positive) > _DECADES * min(positive),
        )


def _end_words(point: xr.Dataset) -> str:
    """Returns the criterion that ends the life of a point; empty where it is not known."""
    end = ending_measure(point)
    return end.words if end else ""


def _finite_or_none(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _violated_ranges(line: Sequence[PointOverPreload]) -> list[tuple[float, float]]:
    """Returns ranges of the preload in which a limit is violated.

    Their ends lie between two preloads, where the least margin, if it goes evenly, is zero.
    """
    margins = [_least_margin(point.values) for point in line]
    log_preloads = np.log([point.preload for point in line])
    edges = [float(log_preloads[0])] if margins[0] < -SAME else []
    for k, (a, b) in enumerate(zip(margins, margins[1:], strict=False)):
        if (a < -SAME) != (b < -SAME):
            share = min(max(a / (a - b), 0.0), 1.0) if abs(a) < 1.0 and abs(b) < 1.0 else 0.5
            edges.append(float(log_preloads[k] + share * (log_preloads[k + 1] - log_preloads[k])))
    edges += [float(log_preloads[-1])] if len(edges) % 2 else []
    ends = [float(f"{math.exp(edge):.4g}") for edge in edges]
    return list(zip(ends[::2], ends[1::2], strict=True))


def _least_margin(point: xr.Dataset) -> float:
    """Returns the least margin to all limits; -1 where a point is unsolved or impractical."""
    if int(point["status"]) != OK or int(point["impractical"]):
        return -1.0
    margins = limit_margins(point, limits_of(point))
    return min([float(margin) for margin in margins], default=math.inf)
