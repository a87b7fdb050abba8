"""Charts of the design study: life, and what requirements apply to, over the preload."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
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
from bearingwear.results.words import methods, plain_scene
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
_LOGARITHMIC_FROM = 30.0
"""Ratio of the largest value to the smallest above which an axis is logarithmic."""

Bands = Mapping[str, tuple[float, float]]
"""Lowest and highest life of 90 % of bearings [h], by method."""


class PointOverPreload(NamedTuple):
    """A point of a line over the preload."""

    preload: float  # [N]
    values: xr.Dataset


PreloadPoints = Mapping[str, Sequence[PointOverPreload]]
"""Points over the preload, by method."""


def preload_points(design: xr.Dataset, recommendation: xr.Dataset) -> PreloadPoints:
    """Returns the points at the preloads of a map and at the recommended one, rising, by method.

    They are those at the scene's own friction and speed.
    """
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

    The arguments are those of `design_answer`.
    """
    lives, recommended, sampled = design_files(design, recommendation, uncertainty)
    if spread is not None:
        sampled = load_quantiles(spread)[0]
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
    """Returns the requirements in words, each with what the recommended bearing achieves."""
    best = best_method(recommendation)
    texts = []
    for name, limit in limits_of(recommendation).given.items():
        text = limit_text(name, limit)
        if best is not None:
            point = recommendation.isel(preload_method=best)
            measure = LIMITED[name]
            achieved = digits(measure.shown(float(measure.worst(point))))
            margin_percent = 100.0 * abs(float(measure.margins(point, limit)))
            decimals = 0 if margin_percent >= 1.0 else 1
            where = critical_condition_words(recommendation, point, name)
            if where:
                where = f" {where}" if where.startswith("at ") else f", {where}"
            text += (
                f" (achieved: {achieved} {printed_unit(measure.unit)}{where}; "
                f"margin {margin_percent:.{decimals}f} %)"
            )
        texts.append(text)
    return "; ".join(texts)


def preload_charts(design: xr.Dataset, recommendation: xr.Dataset, bands: Bands) -> Iterator[Chart]:
    """Yields a chart of the life over the preload, then one of each quantity of short tables."""
    limits = limits_of(design).given
    points = preload_points(design, recommendation)
    preloads = [point.preload for line in points.values() for point in line]
    life_row, *rows, violations = brief_rows(
        [point.values for line in points.values() for point in line]
    )
    for row in (life_row, *rows):
        is_life = row is life_row
        key = "life_h" if is_life else row.name
        measure, limit = LIMITED.get(key), limits.get(key)
        if limit is not None and measure and not is_life:  # lives are in hours in files, too
            _, factor = scale_of(row.unit)
            limit = factor * measure.file_limit(limit, 1.0)
        bounds = [bound for band in bands.values() for bound in band] if is_life else []
        positive = [value for value in (*row.values, *bounds) if value > 0.0]
        lines = _chart_lines(points, recommendation, row.values, violations.values)
        if is_life:
            lines = [
                replace(
                    line,
                    ends=[_end_words(point.values) for point in points[line.method]],
                    band=bands.get(line.method),
                )
                for line in lines
            ]
        yield Chart(
            title="Life versus initial preload" if is_life else row.label,
            x_label=X_LABEL,
            y_label=row.head,
            lines=lines,
            limit=limit,
            at_least=bool(measure and measure.falls),
            log_x=max(preloads) > _LOGARITHMIC_FROM * min(preloads),
            log_y=bool(positive) and max(positive) > _LOGARITHMIC_FROM * min(positive),
        )


def _chart_lines(
    points: PreloadPoints,
    recommendation: xr.Dataset,
    values: Sequence[float],
    violations: Sequence[str],
) -> list[ChartLine]:
    """Returns a line over the preload for each method, with a star at the recommended preload.

    values: of the quantity, at all points of one method after the other.
    violations: the violated requirements in words, at the same points.
    """
    scene = plain_scene(recommendation)
    recommended = dict(methods(recommendation))
    values_left = iter(values)
    violations_left = iter(violations)
    lines = []
    for method, line in points.items():
        coordinates = [(point.preload, _finite_or_none(next(values_left))) for point in line]
        preload = float(recommended[method]["preload"])
        stars = [(x, y) for x, y in coordinates if x == preload and y is not None]
        lines.append(
            ChartLine(
                name=method_words(scene, method),
                method=method,
                points=coordinates,
                notes=[next(violations_left).replace(NONE_VIOLATED, "") for _ in line],
                beyond=_violated_ranges(line),
                star=stars[0] if stars else None,
            )
        )
    return lines


def _end_words(point: xr.Dataset) -> str:
    """Returns the words for the criterion that ends the life of a point; empty if not known."""
    end = ending_measure(point)
    return end.words if end else ""


def _finite_or_none(value: float) -> float | None:
    """Returns a finite number unchanged, and None for NaN and infinity, which JSON lacks."""
    return value if math.isfinite(value) else None


def _violated_ranges(line: Sequence[PointOverPreload]) -> list[tuple[float, float]]:
    """Returns the ranges of the preload [N] in which a limit is violated.

    Their ends lie between two preloads, where the least margin is zero if it changes evenly with
    the logarithm of the preload. They are in the middle if one margin is 1 or more, or -1 or less.

    line: points with rising preload.
    """
    margins = [_least_margin(point.values) for point in line]
    log_preloads = np.log([point.preload for point in line]).tolist()
    edges = [log_preloads[0]] if margins[0] < -SAME else []
    for k in range(len(line) - 1):
        start, end = margins[k], margins[k + 1]
        if (start < -SAME) != (end < -SAME):
            share = 0.5
            if abs(start) < 1.0 and abs(end) < 1.0:
                share = min(max(start / (start - end), 0.0), 1.0)
            edges.append(log_preloads[k] + share * (log_preloads[k + 1] - log_preloads[k]))
    if len(edges) % 2:
        edges.append(log_preloads[-1])
    preloads = [float(f"{math.exp(edge):.4g}") for edge in edges]
    return list(zip(preloads[::2], preloads[1::2], strict=True))


def _least_margin(point: xr.Dataset) -> float:
    """Returns the least relative margin of all limits; -1 at an unsolved or impractical point.

    It is infinite without limits.
    """
    if int(point["status"]) != OK or int(point["impractical"]):
        return -1.0
    margins = limit_margins(point, limits_of(point))
    return min([float(margin) for margin in margins], default=math.inf)
