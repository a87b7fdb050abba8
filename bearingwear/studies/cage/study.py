"""The study of a cage: which motion it takes, how fast it whirls, and what it wears.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from bearingwear.scene.checking import read_record
from bearingwear.studies.cage.plan import CAGE_FILE, CagePlan
from bearingwear.studies.protocol import Study, figure_step, step, table_step

PLOTS = {"cage_map": "bearingwear.studies.cage.figures:whirl_and_wear"}
"""What `bearingwear plot` draws of the kinds of files that this study makes."""


def study(config: Mapping[str, Any]) -> Study:
    """The study of config/cage.yaml."""
    return study_of_cages(read_record(CagePlan, CAGE_FILE))


def study_of_cages(plan: CagePlan) -> Study:
    """A map of cages, each from several starts; its figure and table."""
    return Study(
        "cage",
        plan,
        step(
            "run",
            "points/{point}.nc",
            "run.motions_from_starts",
            plan.points,
            scene=plan.scene_file,
            settings=plan.settings_at,
            seconds=3.0 * len(plan.starts),
        ),
        step(
            "gather",
            "cage.nc",
            "gather.gathered_motions",
            scene=plan.scene_file,
            paths="points/{point}.nc",
            settings={"plan": asdict(plan)},
        ),
        figure_step("cage", "figures.cage_figure", motions="cage.nc"),
        table_step("cage", "tables.cage_table", motions="cage.nc"),
    )
