"""The main study: every scene's cases, lives and dynamic cases, with figures and tables.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from bearingwear.studies.grid.drawn import bundles
from bearingwear.studies.grid.grid import Case
from bearingwear.studies.grid.plan import Plan
from bearingwear.studies.protocol import Step, Study, Wildcards

_RUN = "studies.grid"
_SCENE = "config/scenes/{scene}.yaml"
_ANSWER = "results/answer.json"

START = 1.0
"""What a process takes before it solves [s]."""

SOLVE = 0.03
"""What a point takes, with its file [s]."""

PLOTS = {
    "case": "bearingwear.studies.grid.plots:case_plot",
    "life": "bearingwear.studies.grid.plots:life_plot",
    "study": "bearingwear.studies.grid.plots:study_plot",
    "wear life": "bearingwear.studies.grid.plots:lives_plot",
}
"""What `bearingwear plot` draws of the kinds of files that this study makes."""


def study(config: Mapping[str, Any]) -> GridStudy:
    """The study of a config.yaml that fits its schema."""
    return GridStudy(Plan.from_config(config))


class GridStudy(Study):
    """Everything that config.yaml asks for."""

    name = "grid"

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.drawn = bundles(plan)
        self.jobs = (*self._solved(), *self._lived(), *self._gathered(), *self.drawn)

    def targets(self) -> list[str]:
        plan = self.plan
        solved = [path for scene in plan.grids for path in plan.solved(scene)]
        gathered = [*plan.studies(), *plan.dynamics(), *plan.lives(), *plan.spreads_of_lives()]
        drawn = [path for bundle in self.drawn for path in bundle.outputs]
        return [*solved, *plan.dynamic_cases(), *gathered, *drawn, *self.page_answers()]

    def default_targets(self) -> list[str]:
        return self.targets()

    def inputs(self) -> list[str]:
        return self.plan.inputs()

    def refused(self, path: str) -> str | None:
        return self.plan.refused(path)

    def check(self) -> None:
        self.plan.check_scenes()

    def judged(self) -> list[str]:
        return [*self.plan.studies(), *self.plan.dynamics(), *self.plan.lives()]

    def page_sections(self) -> list[str]:
        drawn = [path for bundle in self.drawn for path in bundle.outputs]
        tables = [path for path in drawn if path.endswith(".md")]
        figures = [path for path in drawn if path.endswith((".svg", ".png"))]
        studies = [*self.plan.studies(), *self.plan.lives(), *self.plan.dynamics()]
        return [*studies, *tables, *figures]

    def page_answers(self) -> list[str]:
        return [_ANSWER] if self.plan.lives() else []

    def _solved(self) -> list[Step]:
        """A rule for each list of losses that a job solves; wildcards say scene and line."""
        plan = self.plan
        parts: dict[tuple[float, ...], list[str]] = {}
        for scene, grid in plan.grids.items():
            for losses in plan.losses_of_jobs(grid):
                parts.setdefault(losses, []).append(re.escape(scene))
        lines = [
            Step(
                name="solve" if number == 1 else f"solve_{number}",
                run=f"{_RUN}.solve.solved_line",
                inputs={"scene": _SCENE},
                outputs=tuple(
                    f"results/{{scene}}/cases/{{line}}-{Case('', 0.0, loss).loss_id}.nc"
                    for loss in losses
                ),
                settings=_line_settings(losses),
                about="{scene}: cases of one preload method and friction, over the wear",
                matches={"scene": "|".join(scenes), "line": r"[a-z_]+-mu\d+\.\d{3}"},
                label=_line_label(losses),
                seconds=START + SOLVE * len(losses),
            )
            for number, (losses, scenes) in enumerate(parts.items(), 1)
        ]
        chunks = [
            Step(
                name="solve_chunk",
                run=f"{_RUN}.chunks.solved_chunk",
                inputs={"scene": _SCENE},
                outputs=("results/{scene}/chunks/{chunk}.nc",),
                settings=self._chunk_settings,
                matches={"chunk": r"\d+-[0-9a-f]{8}"},
                label="{scene}: chunk {chunk} of the grid",
                seconds=START + SOLVE * (plan.config.points_per_job or 0),
            )
        ]
        return [*lines, *(chunks if any(map(plan.chunks, plan.grids)) else [])]

    def _chunk_settings(self, wildcards: Wildcards) -> dict[str, Any]:
        scene = wildcards["scene"]
        lines = self.plan.chunks(scene)[f"results/{scene}/chunks/{wildcards['chunk']}.nc"]
        return {"lines": lines, "losses_um": self.plan.grids[scene].ball_diameter_loss_um}

    def _lived(self) -> list[Step]:
        plan = self.plan
        return [
            Step(
                name="solve_dynamic",
                run="studies.solve.solved_case",
                inputs={"scene": _SCENE},
                outputs=("results/{scene}/dynamic/{case}.nc",),
                settings=self._dynamic_settings,
                about="{scene}: a case solved dynamically",
                label=lambda w: (
                    f"{w['scene']}, dynamic: {plan.dynamic[w['scene']].cases()[w['case']].label}"
                ),
                seconds=8.5,  # at 60 turns of the shaft
                priority=1,  # the longest jobs
            ),
            Step(
                name="wear_life",
                run=f"{_RUN}.life.study_life",
                inputs={"scene": _SCENE, "study": "results/{scene}/study.nc"},
                outputs=("results/{scene}/wear_life.nc",),
                label="{scene}: wear life",
                seconds=1.7,
            ),
            Step(
                name="quantiles",
                run="studies.uncertainty.quantiles.life_quantiles",
                inputs={"scene": _SCENE},
                outputs=("results/{scene}/spread/mu{mu}.nc",),
                settings=lambda w: {
                    "friction": float(w["mu"]),
                    "methods": plan.grids[w["scene"]].preload_method,
                    "samples": plan.uncertain_lives.samples,
                    "seed": plan.uncertain_lives.seed,
                },
                matches={"mu": r"\d+\.\d{3}"},
                label="{scene}: how its lives spread, mu {mu}",
                seconds=9.0,
            ),
        ]

    def _dynamic_settings(self, wildcards: Wildcards) -> dict[str, Any]:
        scene = wildcards["scene"]
        case = self.plan.dynamic[scene].cases()[wildcards["case"]]
        return {"changes": self.plan.dynamic_changes(scene, case), "fidelity": "dynamic"}

    def _gathered(self) -> list[Step]:
        return [
            Step(
                name="gather",
                run=f"{_RUN}.gather.study",
                inputs=lambda w: {"paths": self.plan.solved(w["scene"])},
                outputs=("results/{scene}/study.nc",),
                label="{scene}: gather the cases",
            ),
            Step(
                name="gather_dynamic",
                run=f"{_RUN}.gather.study",
                inputs=lambda w: {"paths": self.plan.dynamic_cases(w["scene"])},
                outputs=("results/{scene}/dynamic.nc",),
                label="{scene}: gather the cases solved dynamically",
            ),
            Step(
                name="answer",
                run=f"{_RUN}.answer.lives_answer",
                inputs={
                    "lives": self.plan.lives(),
                    "uncertainty": self.plan.spreads_of_lives(),
                },
                outputs=(_ANSWER,),
                label="what the lives say",
            ),
        ]


def _line_settings(losses: Sequence[float]) -> Callable[[Wildcards], dict[str, Any]]:
    def settings(wildcards: Wildcards) -> dict[str, Any]:
        method, _, friction = wildcards["line"].partition("-mu")
        return {"method": method, "friction": float(friction), "losses_um": losses}

    return settings


def _line_label(losses: Sequence[float]) -> Callable[[Wildcards], str]:
    wear = f"loss {losses[0]:.2f} um" + (f" to {losses[-1]:.2f} um" if len(losses) > 1 else "")

    def label(wildcards: Wildcards) -> str:
        method, _, friction = wildcards["line"].partition("-mu")
        return f"{wildcards['scene']}: {method.replace('_', ' ')}, mu {friction}, {wear}"

    return label
