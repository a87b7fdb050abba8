"""Charts of the design study: life, and what requirements apply to, over the preload."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.document.chart import Chart, ChartLine, Charts
from bearingwear.kernels.status import OK
from bearingwear.measures import LIMITED
from bearingwear.results.pair_variables import method_words
from bearingwear.results.quantiles import RECOMMENDED, load_quantiles, spread_of
from bearingwear.results.units import printed_unit, scale_of
from bearingwear.results.words import methods, scene_of
from bearingwear.studies.design.choice import design_files, limit_margins, limits_of, line_of_scene
from bearingwear.studies.design.document.held import decides_words, worst_words
from bearingwear.studies.design.document.sheets import NONE_VIOLATED, SAME, brief_rows
from bearingwear.studies.design.document.words import ending_measure, limit_text
from bearingwear.studies.design.recommend import best_method

X_LABEL = "initial preload (N)"
_DECADES = 30.0
"""Of a quantity, the ratio from which its axis is logarithmic."""

Bands = Mapping[str, tuple[float, float]]
PreloadPoints = Mapping[str, Sequence[tuple[float, xr.Dataset]]]


def preload_points(design: xr.Dataset, recommendation: xr.Dataset) -> PreloadPoints:
    """Of each method the preloads [N] of the map at the scene's friction and speed, and the one
    that is recommended.
    """
    chosen = dict(methods(recommendation))
    found = {}
    for name, one in methods(line_of_scene(design)):
        points = {float(p): one.isel(preload=k) for k, p in enumerate(one["preload"].values)}
        best = chosen[name]
        if np.isfinite(best["preload"]):
            points[float(best["preload"])] = best.assign_attrs(design.attrs)
        found[name] = sorted(points.items(), key=lambda point: point[0])
    return found


def design_charts(
    design: Path,
    recommendation: Path,
    uncertainty: Path | None = None,
    spread: Path | None = None,
) -> str:
    """Step: the question of the study, and its charts, as JSON; files as of `design_answer`."""
    lives, found, sampled = design_files(design, recommendation, uncertainty)
    sampled = sampled if spread is None else load_quantiles(spread)[0]
    given = limits_of(lives).given
    asked = f"User requirements, {worst_words(found)}: {_reached(found)}."
    question = asked if given else "Which preload and preload method give the longest life?"
    bands = {} if sampled is None else _bands(found, sampled)
    charts = list(preload_charts(lives, found, bands))
    return Charts(question=question, charts=charts).stored


def _reached(found: xr.Dataset) -> str:
    """Requirements, each with what the recommended bearing reaches."""
    best, given = best_method(found), limits_of(found).given
    texts = [limit_text(name, value) for name, value in given.items()]
    if best is None:
        return "; ".join(texts)
    point = found.isel(preload_method=best)
    for k, (name, value) in enumerate(given.items()):
        one = LIMITED[name]
        reached, margin = one.shown(float(one.worst(point))), float(one.margins(point, value))
        left = f"margin {100.0 * abs(margin):.0f} %"
        where = decides_words(found, point, name)
        where = f" {where}" if where.startswith("at ") else where and f", {where}"
        texts[k] += f" (achieved: {reached:.3g} {printed_unit(one.unit)}{where}; {left})"
    return "; ".join(texts)


def _bands(recommendation: xr.Dataset, sampled: xr.Dataset) -> Bands:
    scene = scene_of(recommendation)
    mu = scene["friction"].get("ball_race")
    found = {
        name: spread_of([sampled], scene, name, mu, RECOMMENDED)
        for name, _ in methods(recommendation)
    }
    return {name: (one.bearings.low, one.bearings.high) for name, one in found.items() if one}


def preload_charts(design: xr.Dataset, recommendation: xr.Dataset, bands: Bands) -> Iterator[Chart]:
    """Life over the preload, then each quantity of the short tables."""
    points, scene = preload_points(design, recommendation), scene_of(design)
    given = limits_of(design).given
    beyond = {name: _beyond(line) for name, line in points.items()}
    taken = {name: float(one["preload"]) for name, one in methods(recommendation)}
    preloads = [preload for line in points.values() for preload, _ in line]
    *rows, notes = brief_rows([one for line in points.values() for _, one in line])
    for row in rows:
        measure, (_, factor) = LIMITED.get(row.name), scale_of(row.unit)
        limit = given.get(row.name) if measure else None
        values, texts = iter(row.values), iter(notes.values)
        lines = []
        for name, line in points.items():
            found = [(preload, _number(next(values))) for preload, _ in line]
            stars = [(x, y) for x, y in found if x == taken[name] and y is not None]
            lines.append(
                ChartLine(
                    name=method_words(scene, name),
                    method=name,
                    points=found,
                    ends=[_ended_by(one) for _, one in line] if row is rows[0] else (),
                    notes=[next(texts).replace(NONE_VIOLATED, "") for _ in line],
                    beyond=beyond[name],
                    star=stars[0] if stars else None,
                    band=bands.get(name) if row is rows[0] else None,
                )
            )
        known = [value for value in row.values if value > 0.0]
        yield Chart(
            title=row.label if row is not rows[0] else "Life versus initial preload",
            x_label=X_LABEL,
            y_label=row.head,
            lines=lines,
            limit=None if limit is None or not measure else factor * measure.file_limit(limit, 1.0),
            at_least=bool(measure and measure.falls),
            log_x=max(preloads) > _DECADES * min(preloads),
            log_y=bool(known) and max(known) > _DECADES * min(known),
        )


def _ended_by(one: xr.Dataset) -> str:
    end = ending_measure(one)
    return end.words if end else ""


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _beyond(line: Sequence[tuple[float, xr.Dataset]]) -> list[tuple[float, float]]:
    """Ranges of the preload in which a limit is passed, its place between two preloads guessed."""
    margins = [_margin(one) for _, one in line]
    log_preloads = np.log([preload for preload, _ in line])
    edges = [float(log_preloads[0])] if margins[0] < -SAME else []
    for k, (a, b) in enumerate(zip(margins, margins[1:], strict=False)):
        if (a < -SAME) != (b < -SAME):
            share = min(max(a / (a - b), 0.0), 1.0) if abs(a) < 1.0 and abs(b) < 1.0 else 0.5
            edges.append(float(log_preloads[k] + share * (log_preloads[k + 1] - log_preloads[k])))
    edges += [float(log_preloads[-1])] if len(edges) % 2 else []
    ends = [float(f"{math.exp(edge):.4g}") for edge in edges]
    return list(zip(ends[::2], ends[1::2], strict=True))


def _margin(one: xr.Dataset) -> float:
    """The least of a point to all limits; -1 where it was not solved or is impractical."""
    if int(one["status"]) != OK or int(one["impractical"]):
        return -1.0
    return min([float(m) for m in limit_margins(one, limits_of(one))], default=math.inf)
