"""The main study: the cases of every scene, their lives, what is solved in time, figures, tables.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bearingwear.studies.grid.plan import Plan
from bearingwear.studies.protocol import Step, Study, Wildcards

_RUN = "studies.grid"
_SCENE = "config/scenes/{scene}.yaml"

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
    default = True

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.steps = (*self._solved(), *self._gathered(), *self._figures(), *self._tables())

    def targets(self) -> list[str]:
        return self.plan.results()

    def inputs(self) -> list[str]:
        return self.plan.inputs()

    def check(self) -> None:
        self.plan.check_scenes()

    def judged(self) -> list[str]:
        return [*self.plan.studies(), *self.plan.dynamics(), *self.plan.lives()]

    def page_sections(self) -> list[str]:
        tables = [table for table in self.plan.tables() if table.endswith(".md")]
        studies = [*self.plan.studies(), *self.plan.lives(), *self.plan.dynamics()]
        return [*studies, *tables, *self.plan.figures()]

    def page_answers(self) -> list[str]:
        return self.plan.spreads_of_lives()

    def _solved(self) -> list[Step]:
        plan = self.plan
        return [
            Step(
                name="solve",
                run="studies.solve.solved_case",
                inputs={"scene": _SCENE},
                outputs=("results/{scene}/cases/{case}.nc",),
                settings=lambda w: {"changes": plan.grids[w["scene"]].cases()[w["case"]].changes},
                label=lambda w: f"{w['scene']}: {plan.grids[w['scene']].cases()[w['case']].label}",
                seconds=1.5,
            ),
            Step(
                name="solve_dynamic",
                run="studies.solve.solved_case",
                inputs={"scene": _SCENE},
                outputs=("results/{scene}/dynamic/{case}.nc",),
                settings=self._dynamic_settings,
                label=lambda w: (
                    f"{w['scene']}, in time: {plan.dynamic[w['scene']].cases()[w['case']].label}"
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
                inputs=lambda w: {"paths": self.plan.cases(w["scene"])},
                outputs=("results/{scene}/study.nc",),
                label="{scene}: gather the cases",
            ),
            Step(
                name="gather_dynamic",
                run=f"{_RUN}.gather.study",
                inputs=lambda w: {"paths": self.plan.dynamic_cases(w["scene"])},
                outputs=("results/{scene}/dynamic.nc",),
                label="{scene}: gather the cases solved in time",
            ),
            Step(
                name="quantiles",
                run="studies.uncertainty.quantiles.life_quantiles",
                inputs={"scene": _SCENE},
                outputs=("results/{scene}/spread/mu{mu}.nc",),
                settings=lambda w: {
                    "friction": float(w["mu"]),
                    "methods": self.plan.grids[w["scene"]].preload_method,
                    "samples": self.plan.uncertain_lives.samples,
                    "seed": self.plan.uncertain_lives.seed,
                },
                matches={"mu": r"\d+\.\d{3}"},
                label="{scene}: how its lives spread, mu {mu}",
                seconds=9.0,
            ),
        ]

    def _figures(self) -> list[Step]:
        plan = self.plan
        study, dynamic = "results/{scene}/study.nc", "results/{scene}/dynamic.nc"
        return [
            _figure(
                "friction",
                "{scene}/figures/{figure}",
                {"study": study},
                "{scene}: QV and load against friction, {figure}",
                settings=lambda w: {"loss_um": plan.losses[w["figure"]]},
                matches={"figure": "|".join(plan.losses)},
                result="{figure}",
            ),
            _figure(
                "slip",
                "{scene}/figures/fig09_slip",
                lambda w: {"cases": plan.slip_cases(w["scene"])},
                "{scene}: slip over the contact ellipse",
            ),
            _figure(
                "wear",
                "{scene}/figures/fig10_wear",
                {"studies": [study]},
                "{scene}: QV, preload, angles and wear rate against wear",
                settings=lambda w: {"friction": plan.frictions(w["scene"])},
            ),
            _figure(
                "life",
                "{scene}/figures/wear_life",
                lambda w: {
                    "lives": f"results/{w['scene']}/wear_life.nc",
                    "uncertainty": plan.spreads_of_lives(w["scene"]),
                },
                "{scene}: wear and preload over the life",
                settings=lambda w: {"friction": plan.frictions(w["scene"])},
            ),
            _figure(
                "dynamic",
                "{scene}/figures/dynamic",
                {"study": study, "dynamic": dynamic},
                "{scene}: solved in time, beside the steady state",
            ),
            _figure(
                "running_average",
                "{scene}/figures/fig06_running_average-{case}",
                lambda w: {
                    "case": f"results/{w['scene']}/dynamic/{w['case']}.nc",
                    **dict(zip(("reference",), plan.reference(w["scene"]), strict=False)),
                },
                "{scene}: wear rates of ball 1 and of the cage as they settle",
                result="fig06_running_average, {case}",
            ),
            _figure(
                "wear_columns",
                "figures/fig10_wear",
                {"studies": plan.studies(*plan.column_scenes)} if plan.column_scenes else {},
                "QV, preload, angles and wear rate against wear, across scenes",
                run="wear",
                caption="wear",
                settings={
                    "friction": [column.friction for column in plan.config.figures.wear_columns]
                },
                category="across scenes",
            ),
            _figure(
                "overlay",
                "figures/spread_{spread}",
                lambda w: {"studies": plan.studies(*plan.spreads[w["spread"]].scenes)},
                "scenes over each other: {spread}",
                settings=lambda w: {"friction": plan.spreads[w["spread"]].friction},
                category="across scenes",
                result="spread_{spread}",
            ),
        ]

    def _tables(self) -> list[Step]:
        return [
            Step(
                name="tables",
                run=f"{_RUN}.tables.study_tables",
                inputs=lambda w: {
                    "study": f"results/{w['scene']}/study.nc",
                    "lives": f"results/{w['scene']}/wear_life.nc",
                    "uncertainty": self.plan.spreads_of_lives(w["scene"]),
                },
                outputs=(
                    "results/{scene}/tables/cases.csv",
                    "results/{scene}/tables/summary.md",
                ),
                label="{scene}: tables",
                caption="summary",
                result="summary",
            ),
            Step(
                name="dynamic_tables",
                run=f"{_RUN}.dynamic_tables.comparison",
                inputs={
                    "study": "results/{scene}/study.nc",
                    "dynamic": "results/{scene}/dynamic.nc",
                },
                outputs=(
                    "results/{scene}/tables/dynamic.csv",
                    "results/{scene}/tables/dynamic.md",
                ),
                label="{scene}: tables of cases solved in time",
                caption="dynamic_tables",
                result="dynamic, table",
            ),
        ]


def _figure(
    name: str, path: str, inputs: Any, label: str, run: str = "", caption: str = "", **more: Any
) -> Step:
    """A step that draws one figure, as SVG and PNG."""
    more.setdefault("result", path.rpartition("/")[2])
    return Step(
        name=f"figure_{name}",
        run=f"{_RUN}.draw.draw_{run or name}",
        inputs=inputs,
        outputs=(f"results/{path}.svg", f"results/{path}.png"),
        label=label,
        caption=caption or name,
        **more,
    )
