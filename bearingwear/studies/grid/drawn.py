"""Figures and tables of the study, in bundles that one process does.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from bearingwear.studies.grid.plan import Plan
from bearingwear.studies.protocol import Bundle, Files, Step

_RUN = "studies.grid"
_ACROSS = "across scenes"


def bundles(plan: Plan) -> list[Bundle]:
    """Those of each scene, of each scene solved dynamically, and of several scenes side by side."""
    of_scenes = [
        _bundle(f"drawn_{scene}", scene, _scene_steps(plan, scene)) for scene in plan.grids
    ]
    dynamic = [
        _bundle(f"dynamic_drawn_{scene}", f"{scene}, dynamic", steps)
        for scene in plan.dynamic
        if (steps := _dynamic_steps(plan, scene))
    ]
    across = _steps_across(plan)
    return [*of_scenes, *dynamic, *([_bundle("across_drawn", _ACROSS, across)] if across else [])]


def _bundle(name: str, what: str, steps: Sequence[Step]) -> Bundle:
    return Bundle(name=name, steps=tuple(steps), label=f"{what}: figures and tables")


def _scene_steps(plan: Plan, scene: str) -> list[Step]:
    study, lives = f"results/{scene}/study.nc", f"results/{scene}/wear_life.nc"
    uncertainty = plan.spreads_of_lives(scene)
    grid, friction = plan.grids[scene], plan.frictions(scene)
    losses = [(name, loss) for name, loss in plan.losses.items() if len(grid.friction) > 1]
    slip = plan.slip_cases(scene)
    return [
        *(
            _figure(scene, name, "friction", {"study": study}, {"loss_um": loss})
            for name, loss in losses
            if loss in grid.ball_diameter_loss_um
        ),
        *([_figure(scene, "fig09_slip", "slip", {"cases": slip})] if slip else []),
        _figure(scene, "fig10_wear", "wear", {"studies": [study]}, {"friction": friction}),
        _figure(
            scene,
            "wear_life",
            "life",
            {"lives": lives, "uncertainty": uncertainty},
            {"friction": friction},
        ),
        _tables(
            scene,
            ("cases.csv", "summary.md"),
            "tables.study_tables",
            {"study": study, "lives": lives, "uncertainty": uncertainty},
            caption="summary",
            result="summary",
        ),
    ]


def _dynamic_steps(plan: Plan, scene: str) -> list[Step]:
    compared = {"study": f"results/{scene}/study.nc", "dynamic": f"results/{scene}/dynamic.nc"}
    steps = [
        _figure(scene, "dynamic", "dynamic", compared),
        _tables(
            scene,
            ("dynamic.csv", "dynamic.md"),
            "dynamic_tables.comparison",
            compared,
            caption="dynamic_tables",
            result="dynamic, table",
        ),
    ]
    reference = dict(zip(("reference",), plan.reference(scene), strict=False))
    averages = [
        _figure(
            scene,
            f"fig06_running_average-{case}",
            "running_average",
            {"case": f"results/{scene}/dynamic/{case}.nc", **reference},
            result=f"fig06_running_average, {case}",
        )
        for case in plan.dynamic[scene].cases()
        if scene in plan.config.figures.running_averages
    ]
    return [*(steps if scene in plan.compared else []), *averages]


def _steps_across(plan: Plan) -> list[Step]:
    columns = plan.config.figures.wear_columns
    steps = [
        _figure(
            "",
            f"spread_{name}",
            "overlay",
            {"studies": plan.studies(*overlay.scenes)},
            {"friction": overlay.friction},
        )
        for name, overlay in plan.spreads.items()
    ]
    steps += [
        _figure(
            "",
            f"lives_{name}",
            "life_overlay",
            {"lives": plan.lives(*overlay.scenes)},
            {"friction": overlay.friction},
        )
        for name, overlay in plan.config.figures.lives.items()
    ]
    if columns:
        studies = {"studies": plan.studies(*plan.column_scenes)}
        frictions = {"friction": [column.friction for column in columns]}
        steps.insert(0, _figure("", "fig10_wear", "wear", studies, frictions))
    return steps


def _figure(
    scene: str,
    name: str,
    kind: str,
    inputs: Files,
    settings: Mapping[str, Any] | None = None,
    result: str = "",
) -> Step:
    """Draws one figure, as SVG and PNG; without a scene it lies across scenes."""
    path = f"results/{scene}/figures/{name}" if scene else f"results/figures/{name}"
    return Step(
        name=f"figure_{kind}",
        run=f"{_RUN}.draw.draw_{kind}",
        inputs=inputs,
        outputs=(f"{path}.svg", f"{path}.png"),
        settings=settings or {},
        label=f"{scene or _ACROSS}: {name}",
        caption=kind,
        category=scene or _ACROSS,
        result=result or name,
    )


def _tables(
    scene: str, names: Sequence[str], run: str, inputs: Files, caption: str, result: str
) -> Step:
    return Step(
        name=caption,
        run=f"{_RUN}.{run}",
        inputs=inputs,
        outputs=tuple(f"results/{scene}/tables/{name}" for name in names),
        label=f"{scene}: {result}",
        caption=caption,
        category=scene,
        result=result,
    )
