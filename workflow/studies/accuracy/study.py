"""The study of accuracy: time and error of the settings of a solve.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bearingwear.studies.protocol import Step, Study, figure_step, step, table_step

from bearingwear.scene.checking.check import read_record
from workflow.studies.accuracy.plan import ACCURACY_FILE, FIGURE_NAMES, AccuracyPlan

PLOTS = {"accuracy against time": "workflow.studies.accuracy.figures:accuracy_plot"}
"""Which function of a dataset draws a kind of file."""


def study(config: Mapping[str, Any]) -> Study:
    """The study of config/accuracy.yaml."""
    return study_of_accuracy(read_record(AccuracyPlan, ACCURACY_FILE))


def study_of_accuracy(plan: AccuracyPlan) -> Study:
    """Sweeps on scenes, their errors, and what docs/accuracy.md says of them."""
    trade: dict[str, Any] = {"trade": "accuracy.nc", "plan": ACCURACY_FILE}
    effects: dict[str, Any] = {"trade": "effects.nc", "plan": ACCURACY_FILE}
    return Study(
        "accuracy",
        plan,
        step("sweep", "points/{of_scene}-{sweep}.nc", "run.solved_sweep", plan.jobs(),
            scene=lambda job: plan.scene_file(job[0]),
            settings=lambda job: plan.sweep_settings(*job), work=1.0, alone=True),
        step("gather", "accuracy.nc", "gather.gathered_sweeps",
            paths="points/{of_scene}-{sweep}.nc"),
        step("gather_effects", "effects.nc", "gather.gathered_sweeps",
            paths=[f"points/{scene}-{sweep}.nc" for scene, sweep in plan.effect_jobs]),
        figure_step("{figure}", "figures.figure", FIGURE_NAMES, trade="accuracy.nc",
            settings=lambda name: {"which": name}),
        table_step(("accuracy.csv", "accuracy.md"), "docs.accuracy_tables", name="tables", **trade),
        *(
            table_step(part, "docs.part_tables", name=part, settings={"part": part}, **effects)
            for part in ("effects", "grooves")
        ),
        *_ensembles(plan),
        step("check", "check.txt", "docs.check_docs", docs="docs/accuracy.md", cages="cages.nc",
            last=True, **trade),
    )  # fmt: skip


def _ensembles(plan: AccuracyPlan) -> list[Step]:
    """Ensembles of a cage, and their table."""
    return [
        step("cages", "cages/{ensemble}.nc", "studies.cage.ensemble.cage_ensemble",
            [*plan.cages.ensembles], scene=f"config/scenes/{plan.cages.file}.yaml",
            settings=plan.cages.ensemble_settings, work=1.0),
        step("gather_cages", "cages.nc", "cages.gathered_cages", paths="cages/{ensemble}.nc"),
        table_step("cages", "docs.part_tables", name="cages_table", settings={"part": "cages"},
            trade="cages.nc", plan=ACCURACY_FILE),
    ]  # fmt: skip
