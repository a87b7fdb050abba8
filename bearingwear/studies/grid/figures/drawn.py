"""Figures and tables of the study, in bundles that one process does.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from typing import Any

from bearingwear.studies.grid.plan import Plan
from bearingwear.studies.protocol import Bundle, Step, bundle, figure_step, table_step

_ACROSS = "across scenes"


def bundles(plan: Plan) -> list[Bundle]:
    """Those of each scene, of each scene solved dynamically, and of several scenes side by side."""
    drawn = [
        *((f"drawn_{scene}", scene, _scene_steps(plan, scene)) for scene in plan.grids),
        *((f"dynamic_drawn_{scene}", scene, _dynamic_steps(plan, scene)) for scene in plan.dynamic),
        ("across_drawn", "", _steps_across(plan)),
    ]
    return [
        bundle(
            name,
            f"results/{scene}".rstrip("/"),
            scene or _ACROSS,
            f"{scene or _ACROSS}{', dynamic' * name.startswith('dynamic')}: figures and tables",
            *steps,
        )
        for name, scene, steps in drawn
        if steps
    ]


def _scene_steps(plan: Plan, scene: str) -> list[Step]:
    lives = {"lives": "wear_life.nc", "uncertainty": plan.spreads_of_lives(scene)}
    grid, mu = plan.grids[scene], {"friction": plan.frictions(scene)}
    slip = plan.slip_cases(scene)
    steps = [
        _figure(name, "friction", study="study.nc", settings={"loss_um": loss})
        for name, loss in plan.losses.items()
        if len(grid.friction) > 1 and loss in grid.ball_diameter_loss_um
    ]
    if slip:
        steps.append(_figure("fig09_slip", "slip", cases=slip))
    return [
        *steps,
        _figure("fig10_wear", "wear", studies=["study.nc"], settings=mu),
        _figure("wear_life", "life", settings=mu, **lives),
        table_step(
            ("cases.csv", "summary.md"),
            "tables.study_tables",
            name="summary",
            study="study.nc",
            caption="summary",
            result="summary",
            **lives,
        ),
    ]


def _dynamic_steps(plan: Plan, scene: str) -> list[Step]:
    compared = {"study": "study.nc", "dynamic": "dynamic.nc"}
    reference = dict(zip(("reference",), plan.reference(scene), strict=False))
    averages = [
        _figure(
            f"fig06_running_average-{case}",
            "running_average",
            case=f"dynamic/{case}.nc",
            result=f"fig06_running_average, {case}",
            **reference,
        )
        for case in plan.dynamic[scene].cases()
        if scene in plan.config.figures.running_averages
    ]
    if scene not in plan.compared:
        return averages
    return [
        _figure("dynamic", "dynamic", **compared),
        table_step(
            ("dynamic.csv", "dynamic.md"),
            "dynamic_tables.comparison",
            name="dynamic_tables",
            caption="dynamic_tables",
            result="dynamic, table",
            **compared,
        ),
        *averages,
    ]


def _steps_across(plan: Plan) -> list[Step]:
    columns = plan.config.figures.wear_columns
    wear = _figure(
        "fig10_wear",
        "wear",
        studies=plan.studies(*plan.column_scenes),
        settings={"friction": [column.friction for column in columns]},
    )
    return [
        *([wear] if columns else []),
        *(
            _figure(
                f"spread_{name}",
                "overlay",
                studies=plan.studies(*overlay.scenes),
                settings={"friction": overlay.friction},
            )
            for name, overlay in plan.spreads.items()
        ),
        *(
            _figure(
                f"lives_{name}",
                "life_overlay",
                lives=plan.lives(*overlay.scenes),
                settings={"friction": overlay.friction},
            )
            for name, overlay in plan.config.figures.lives.items()
        ),
    ]


def _figure(name: str, kind: str, **rest: Any) -> Step:
    run = f"figures.draw.draw_{kind}"
    return figure_step(name, run, **{"name": f"figure_{kind}", "caption": kind, **rest})
