"""The study of lives: wear is followed with the dynamic model, cage and all, to the end of life.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bearingwear.scene.checking.check import read_record
from bearingwear.studies.lives.plan import LIVES_FILE, DynamicLife, LivesPlan
from bearingwear.studies.protocol import Study, figure_step, step, table_step


def study(config: Mapping[str, Any]) -> Study:
    """The study of config/lives.yaml."""
    return study_of_lives(read_record(LivesPlan, LIVES_FILE))


def study_of_lives(plan: LivesPlan) -> Study:
    """A life each, its figure, and one table."""
    return Study(
        "lives",
        plan,
        step(
            "solve",
            "{life}.nc",
            "studies.solve.solved_life",
            plan.lives,
            scene=DynamicLife.scene_file,
            settings=DynamicLife.settings,
            work=1.0,
        ),
        figure_step("{life}", "figures.wear_history", life="{life}.nc"),
        table_step("lives", "tables.lives_table", lives="{life}.nc"),
    )
