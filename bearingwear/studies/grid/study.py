"""The main study: every scene's cases, lives and dynamic cases, with figures and tables.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from bearingwear.solvers.effects.choice import LARGEST_KERNEL
from bearingwear.studies.axis import GRID_KEYS, in_name
from bearingwear.studies.grid.figures.drawn import bundles
from bearingwear.studies.grid.grid import Case, Line
from bearingwear.studies.grid.plan import Plan
from bearingwear.studies.protocol import SCENE, Bundle, Step, Study, step

_ANSWER = "results/answer.json"

PLOTS = {
    "case": "bearingwear.studies.grid.figures.plots:case_plot",
    "life": "bearingwear.studies.grid.figures.plots:life_plot",
    "study": "bearingwear.studies.grid.figures.plots:study_plot",
    "wear life": "bearingwear.studies.grid.figures.plots:lives_plot",
}
"""What `bearingwear plot` draws of the kinds of files that this study makes."""


def study(config: Mapping[str, Any]) -> GridStudy:
    """The study of a config.yaml that fits its schema."""
    return GridStudy(Plan.from_config(config))


class GridStudy(Study):
    """Everything that config.yaml asks for; a plain `snakemake` makes all of it."""

    def __init__(self, plan: Plan) -> None:
        super().__init__(
            "grid",
            plan,
            *_solved(plan),
            *_lived(plan),
            *_gathered(plan),
            *bundles(plan),
            folder="results/{scene}",
            default=True,
        )

    def inputs(self) -> list[str]:
        return self.plan.inputs()

    def refused(self, path: str) -> str | None:
        return self.plan.refused(path)

    def judged(self) -> list[str]:
        return [*self.plan.studies(), *self.plan.dynamics(), *self.plan.lives()]

    def page_sections(self) -> list[str]:
        drawn = [path for job in self.jobs if isinstance(job, Bundle) for path in job.outputs]
        tables = [path for path in drawn if path.endswith(".md")]
        figures = [path for path in drawn if path.endswith((".svg", ".png"))]
        studies = [*self.plan.studies(), *self.plan.lives(), *self.plan.dynamics()]
        return [*studies, *tables, *figures]

    def page_answers(self) -> list[str]:
        return [_ANSWER] if self.plan.lives() else []


def _solved(plan: Plan) -> list[Step]:
    """A rule for each list of losses that a job solves, and one for chunks of several lines.

    Where a scene is solved in chunks, its single lines are solved for who asks for them.
    """
    parts: dict[tuple[tuple[float, ...], bool], dict[tuple[str, str], Line]] = {}
    for scene, grid in plan.grids.items():
        lines = {(scene, Case(*line, 0.0).line_id): line for line in grid.lines()}
        for losses in plan.losses_of_jobs(grid):
            parts.setdefault((losses, bool(plan.chunks(scene))), {}).update(lines)
    solve = [
        step("solve" if number == 1 else f"solve_{number}",
            [f"cases/{{line}}-{Case('', 0.0, loss).loss_id}.nc" for loss in losses],
            "solve.solved_line", lines, scene=SCENE, replaced=tuple(GRID_KEYS.values()),
            settings=functools.partial(_line_settings, losses),
            about="{scene}: cases with one preload method and one friction coefficient, in all "
            "wear states",
            label=f"{{scene}}: {{line}}, loss {_span(losses)} um", work=len(losses),
            on_request=in_chunks)
        for number, ((losses, in_chunks), lines) in enumerate(parts.items(), 1)
    ]  # fmt: skip
    chunks = step(
        "solve_chunk",
        "chunks/{chunk}.nc",
        "chunks.solved_chunk",
        {
            (scene, Path(file).stem): (scene, lines)
            for scene in plan.grids
            for file, lines in plan.chunks(scene).items()
        },
        scene=SCENE,
        replaced=tuple(GRID_KEYS.values()),
        settings=lambda chunk: {
            "lines": chunk[1],
            "losses_um": plan.grids[chunk[0]].ball_diameter_loss_um,
        },
        label="{scene}: chunk {chunk} of the grid",
        work=plan.config.points_per_job or 1,
    )
    return [*solve, chunks]


def _line_settings(losses: Sequence[float], line: Line) -> dict[str, Any]:
    method, friction = line
    return {"method": method, "friction": friction, "losses_um": losses}


def _span(losses: Sequence[float]) -> str:
    return f"{losses[0]:g}" + (f" to {losses[-1]:g}" if len(losses) > 1 else "")


def _lived(plan: Plan) -> list[Step]:
    lives = plan.config.uncertain_lives
    return [
        step(
            "solve_dynamic",
            "dynamic/{case}.nc",
            "studies.solve.solved_case",
            {
                (scene, name): (scene, case)
                for scene, grid in plan.dynamic.items()
                for name, case in grid.cases().items()
            },
            scene=SCENE,
            replaced=tuple(GRID_KEYS.values()),
            settings=lambda point: {"changes": plan.dynamic_changes(*point), "fidelity": "dynamic"},
            about="{scene}: a case solved dynamically",
            label="{scene}, dynamic: {case}",
            work=1.0,
            priority=1,  # the longest to compile
            kernel=LARGEST_KERNEL["dynamic"],
        ),
        step("wear_life", "wear_life.nc", "life.study_life", [*plan.grids], scene=SCENE,
            study="study.nc", label="{scene}: wear life", work=1.0),
        step("quantiles", "spread/mu{mu}.nc", "studies.uncertainty.quantiles.life_quantiles",
            {
                (scene, in_name(mu, 3)): (scene, mu)
                for scene in lives.scenes
                if scene in plan.grids
                for mu in plan.grids[scene].friction
            },
            scene=SCENE,
            settings=lambda point: {
                "friction": point[1],
                "methods": plan.grids[point[0]].preload_method,
                "samples": lives.samples,
                "seed": lives.seed,
            },
            label="{scene}: spread in life, mu {mu}", work=1.0),
    ]  # fmt: skip


def _gathered(plan: Plan) -> list[Step]:
    lives = step("answer", _ANSWER, "answer.lives_answer", lives=plan.lives(),
        uncertainty=plan.spreads_of_lives(), label="summary of the lives")  # fmt: skip
    return [
        step("gather", "study.nc", "gather.study", [*plan.grids], paths=plan.solved,
            label="{scene}: gather the cases"),
        step("gather_dynamic", "dynamic.nc", "gather.study", paths="dynamic/{case}.nc",
            label="{scene}: gather the cases solved dynamically"),
        *([lives] if plan.lives() else []),
    ]  # fmt: skip
