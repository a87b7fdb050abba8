"""The study of accuracy: time and error of the settings of a solve.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from bearingwear.scene.checking import read_record
from bearingwear.studies.protocol import Step, Study
from workflow.studies.accuracy.plan import ACCURACY_FILE, FIGURE_NAMES, AccuracyPlan

_RUN = "studies.accuracy"
_FOLDER = "results/accuracy"
_TRADE = f"{_FOLDER}/accuracy.nc"
_TABLES = (f"{_FOLDER}/tables/accuracy.csv", f"{_FOLDER}/tables/accuracy.md")
_CHECK = f"{_FOLDER}/check.txt"
_EFFECTS = f"{_FOLDER}/effects.nc"
_EFFECTS_TABLE, _GROOVES_TABLE = f"{_FOLDER}/tables/effects.md", f"{_FOLDER}/tables/grooves.md"
_DOCS = "docs/accuracy.md"

PLOTS = {"accuracy against time": "workflow.studies.accuracy.figures:accuracy_plot"}
"""Which function of a dataset draws a kind of file."""


def study(config: Mapping[str, Any]) -> AccuracyStudy:
    """The study of config/accuracy.yaml."""
    return AccuracyStudy(read_record(AccuracyPlan, ACCURACY_FILE))


class AccuracyStudy(Study):
    """Sweeps on scenes, their errors, and what docs/accuracy.md says of them."""

    name = "accuracy"

    def __init__(self, plan: AccuracyPlan) -> None:
        self.plan = plan
        self.jobs = (*self._solved(), *self._shown())

    def _solved(self) -> tuple[Step, ...]:
        """Sweeps and single effects, each gathered into a file."""
        plan = self.plan
        return (
            Step(
                name="sweep",
                run=f"{_RUN}.run.solved_sweep",
                inputs=lambda w: {"scene": plan.scene_file(w["of_scene"])},
                settings=lambda w: plan.sweep_settings(w["of_scene"], w["sweep"]),
                outputs=(f"{_FOLDER}/points/{{of_scene}}-{{sweep}}.nc",),
                matches={
                    "of_scene": "|".join(plan.scenes),
                    "sweep": "|".join([*plan.references, *plan.sweeps]),
                },
                label="accuracy against time: {of_scene}, {sweep}",
                seconds=14.0,  # on the average; 3 minutes at most
                alone=True,
            ),
            Step(
                name="gather",
                run=f"{_RUN}.gather.gathered_sweeps",
                inputs={"paths": self._points(plan.jobs())},
                outputs=(_TRADE,),
                label="accuracy against time: gather the sweeps",
            ),
            Step(
                name="gather_effects",
                run=f"{_RUN}.gather.gathered_sweeps",
                inputs={"paths": self._points(plan.effect_jobs)},
                outputs=(_EFFECTS,),
                label="accuracy against time: gather single effects",
            ),
        )

    def _shown(self) -> tuple[Step, ...]:
        """Figure, tables, and what the docs say of them."""
        return (
            Step(
                name="figure",
                run=f"{_RUN}.figures.figure",
                inputs={"trade": _TRADE},
                settings=lambda w: {"which": w["figure"]},
                outputs=(f"{_FOLDER}/figures/{{figure}}.svg", f"{_FOLDER}/figures/{{figure}}.png"),
                matches={"figure": "|".join(FIGURE_NAMES)},
                label="accuracy against time: figure {figure}",
                caption="accuracy",
                category="accuracy against time",
                result="{figure}",
            ),
            Step(
                name="tables",
                run=f"{_RUN}.tables.accuracy_tables",
                inputs={"trade": _TRADE, "plan": ACCURACY_FILE},
                outputs=_TABLES,
                label="accuracy against time: tables",
                caption="accuracy",
                category="accuracy against time",
                result="table",
            ),
            Step(
                name="effects",
                run=f"{_RUN}.effects.effects_table",
                inputs={"trade": _EFFECTS, "plan": ACCURACY_FILE},
                outputs=(_EFFECTS_TABLE,),
                label="accuracy against time: single effects",
                caption="accuracy",
                category="accuracy against time",
                result="single effects",
            ),
            Step(
                name="grooves",
                run=f"{_RUN}.groove_tables.grooves_table",
                inputs={"trade": _EFFECTS, "plan": ACCURACY_FILE},
                outputs=(_GROOVES_TABLE,),
                label="accuracy against time: worn grooves",
                caption="accuracy",
                category="accuracy against time",
                result="worn grooves",
            ),
            Step(
                name="check",
                run=f"{_RUN}.tables.check_docs",
                inputs={"trade": _TRADE, "plan": ACCURACY_FILE, "docs": _DOCS},
                outputs=(_CHECK,),
                label=f"accuracy against time: compare with {_DOCS}",
                after=[*_TABLES, _EFFECTS_TABLE, _GROOVES_TABLE, *self._figures()],
            ),
        )

    def _points(self, jobs: Sequence[tuple[str, str]]) -> list[str]:
        return [f"{_FOLDER}/points/{scene}-{sweep}.nc" for scene, sweep in jobs]

    def _figures(self) -> list[str]:
        return [
            f"{_FOLDER}/figures/{name}.{end}" for name in FIGURE_NAMES for end in ("svg", "png")
        ]

    def targets(self) -> list[str]:
        tables = (*_TABLES, _EFFECTS_TABLE, _GROOVES_TABLE)
        return [*self._points(self.plan.jobs()), _TRADE, *self._figures(), *tables, _CHECK]

    def inputs(self) -> list[str]:
        return list(dict.fromkeys(map(self.plan.scene_file, self.plan.scenes)))
