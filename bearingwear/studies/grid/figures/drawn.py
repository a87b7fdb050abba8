"""Figures and tables of the study, in bundles that one process does.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from bearingwear.studies.grid.plan import Plan
from bearingwear.studies.protocol import Bundle, Step, bundle, figure_step, table_step

_ACROSS = "across scenes"

_SHOWN = {
    "friction": "QV and contact load against friction",
    "slip": "slip across the contacts",
    "wear": "QV, preload and wear rates against wear",
    "life": "wear life",
    "dynamic": "dynamic cases with the cage",
    "running_average": "running averages of wear rates",
    "overlay": "QV, preload and loss rate of several scenes",
    "life_overlay": "QV until the end of life, several scenes",
}
"""Kinds of figures in words, for the report of the jobs."""


def bundles(plan: Plan) -> list[Bundle]:
    """Those of each scene, of each scene solved dynamically, and of several scenes side by side."""
    drawn = [
        *((f"drawn_{scene}", scene, _scene_steps(plan, scene)) for scene in plan.grids),
        *((f"dynamic_drawn_{scene}", scene, _dynamic_steps(plan, scene)) for scene in plan.dynamic),
        ("across_drawn", "", _steps_across(plan)),
    ]
    return [
        bundle(name, f"results/{scene}".rstrip("/"), scene or _ACROSS,
            f"{scene or _ACROSS}{', dynamic' * name.startswith('dynamic')}: figures and tables",
            *steps)
        for name, scene, steps in drawn
        if steps
    ]  # fmt: skip


def _scene_steps(plan: Plan, scene: str) -> list[Step]:
    lives = {"lives": "wear_life.nc", "uncertainty": plan.spreads_of_lives(scene)}
    return [
        *(step for one in plan.bearings(scene) for step in _bearing_steps(plan, scene, one, lives)),
        table_step(("cases.csv", "summary.md"), "tables.study_tables", name="summary",
            study="study.nc", caption="summary", result="cases and lives, table", **lives),
    ]  # fmt: skip


def _bearing_steps(
    plan: Plan, scene: str, bearing: str | None, lives: Mapping[str, Any]
) -> Iterator[Step]:
    """Figures of the only bearing of a scene, or of one of two that differ."""
    which, suffix = ({"bearing": bearing}, f"-{bearing}") if bearing else ({}, "")
    more = f", {bearing} bearing" if bearing else ""
    grid, mu = plan.grids[scene], {"friction": plan.frictions(scene), **which}
    for name, loss in plan.losses.items():
        if len(grid.friction) > 1 and loss in grid.ball_diameter_loss_um:
            settings = {"loss_um": loss, **which}
            worn = f", {loss:g} µm worn{more}" if loss else f", new{more}"
            yield _figure(name + suffix, "friction", worn, study="study.nc", settings=settings)
    if slip := plan.slip_cases(scene):
        yield _figure(f"fig09_slip{suffix}", "slip", more, cases=slip, settings=which)
    yield _figure(f"fig10_wear{suffix}", "wear", more, studies=["study.nc"], settings=mu)
    yield _figure(f"wear_life{suffix}", "life", more, settings=mu, **lives)


def _dynamic_steps(plan: Plan, scene: str) -> list[Step]:
    compared = {"study": "study.nc", "dynamic": "dynamic.nc"}
    reference = dict(zip(("reference",), plan.reference(scene), strict=False))
    averages = [
        _figure(f"fig06_running_average-{case}", "running_average", f", {case}",
            case=f"dynamic/{case}.nc", **reference)
        for case in plan.dynamic[scene].cases()
        if scene in plan.config.figures.running_averages
    ]  # fmt: skip
    if scene not in plan.compared:
        return averages
    return [
        _figure("dynamic", "dynamic", **compared),
        table_step(("dynamic.csv", "dynamic.md"), "dynamic_tables.comparison",
            name="dynamic_tables", caption="dynamic_tables", result="dynamic cases, table",
            **compared),
        *averages,
    ]  # fmt: skip


def _steps_across(plan: Plan) -> list[Step]:
    figures = plan.config.figures
    columns = figures.wear_columns
    wear = _figure("fig10_wear", "wear", studies=plan.studies(*(one.scene for one in columns)),
        settings={"friction": [column.friction for column in columns]})  # fmt: skip
    return [
        *([wear] if columns else []),
        *(
            _figure(f"spread_{name}", "overlay", f", {name}", studies=plan.studies(*overlay.scenes),
                settings={"friction": overlay.friction})
            for name, overlay in figures.spreads.items()
        ),
        *(
            _figure(f"lives_{name}", "life_overlay", f", {name}", lives=plan.lives(*overlay.scenes),
                settings={"friction": overlay.friction})
            for name, overlay in figures.lives.items()
        ),
    ]  # fmt: skip


def _figure(name: str, kind: str, more: str = "", **rest: Any) -> Step:
    run, result = f"figures.draw.draw_{kind}", f"{_SHOWN[kind]}{more}"
    return figure_step(name, run, name=f"figure_{kind}", caption=kind, result=result, **rest)
