"""The study of the paper's bearing: which bearings fit what its text states.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from bearingwear.studies.protocol import SCENE, Study, figure_step, step, table_step

from bearingwear.scene.checking.check import read_record
from workflow.studies.identify.plan import IdentifyPlan

PLOTS = {"candidates": "workflow.studies.identify.figures:ridge_and_lives"}
"""What `bearingwear plot` draws of the kinds of files that this study makes."""


def study(config: Mapping[str, Any]) -> Study:
    """Every bearing of the grid in config/identify.yaml: does it fit what the text states?"""
    plan = read_record(IdentifyPlan, "config/identify.yaml")
    return Study(
        "identify",
        plan,
        step("candidates", "candidates.nc", "search.identified",
            scene=SCENE.format(scene=plan.scene),
            marks=[SCENE.format(scene=name) for name in plan.marks],
            settings={"plan": asdict(plan)}, work=1.0),
        figure_step("candidates", "figures.candidates_figure", candidates="candidates.nc"),
        table_step("candidates", "tables.candidates_table", candidates="candidates.nc"),
    )  # fmt: skip
