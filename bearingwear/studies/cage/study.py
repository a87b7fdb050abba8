"""The study of a cage: which motions it takes and how often, what it wears, which cage to take.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from glob import glob
from typing import Any

from bearingwear.scene.checking.check import read_record
from bearingwear.studies.cage.plan import CAGE_FILE, CagePlan
from bearingwear.studies.protocol import Study, figure_step, step, table_step

SHEETS = {"cage ensemble": "bearingwear.studies.cage.show:ensemble_sheet"}
PLOTS = {
    "cage ensemble": "bearingwear.studies.cage.show:ensemble_figure",
    "cage map": "bearingwear.studies.cage.figures:shares_and_work",
}
"""What `bearingwear show` and `plot` make of the kinds of files that this study makes."""


def study(config: Mapping[str, Any]) -> Study:
    """The study of config/cage.yaml."""
    return study_of_cages(read_record(CagePlan, CAGE_FILE))


class CageStudy(Study):
    """A map of cages; the page reports one that was made."""

    def page_answers(self) -> list[str]:
        kinds = (".json", ".svg", ".png")
        if self.default:
            return [path for path in self.default_targets() if path.endswith(kinds)]
        found = [*glob("results/cage/answer.json"), *sorted(glob("results/cage/figures/*"))]
        return [path for path in found if path.endswith(kinds)]


def study_of_cages(plan: CagePlan) -> CageStudy:
    """A map of cages, each an ensemble; its figure and table."""
    return CageStudy(
        "cage",
        plan,
        step("run", "points/{point}.nc", "ensemble.cage_ensemble", plan.points,
            scene=plan.scene_file, settings=plan.settings_at, work=plan.ensemble.runs),
        step("gather", "cage.nc", "gather.gathered_ensembles", scene=plan.scene_file,
            paths="points/{point}.nc", settings={"plan": asdict(plan)}),
        step("answer", "answer.json", "tables.cage_answer", motions="cage.nc"),
        figure_step("cage", "figures.cage_figure", motions="cage.nc"),
        table_step("cage", "tables.cage_table", motions="cage.nc"),
        default=plan.in_main_study,
    )  # fmt: skip
