"""The study of robustness: scenes far beyond the others, solved right or refused with a reason.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from bearingwear.studies.protocol import Step, Study, figure_step, step, table_step

from bearingwear.scene.checking.check import read_record
from workflow.studies.robustness.plan import ROBUSTNESS_FILE, RobustnessPlan

PLOTS = {
    "maps": "workflow.studies.robustness.figures:figure_of_map",
    "branches": "workflow.studies.robustness.figures:figure_of_branches",
}
"""Which function of a dataset draws a kind of file."""


def study(config: Mapping[str, Any]) -> Study:
    """Random scenes, maps and branches of config/robustness.yaml; how they ended; their figures."""
    plan = read_record(RobustnessPlan, ROBUSTNESS_FILE)

    def solve(name: str, folder: str, run: str, settings: Callable[..., Any]) -> Step:
        """A long job for each: thousands of scenes in one process."""
        names, scene = getattr(plan, folder), plan.scene_file
        made = f"{folder}/{{name}}.nc"
        return step(name, made, run, [*names], scene=scene, settings=settings, work=1.0)

    return Study(
        "robustness",
        plan,
        solve("random_scenes", "scene_classes", "run.random_scenes", plan.class_settings),
        solve("map", "maps", "maps.state_map", plan.map_settings),
        solve("branch", "branches", "branches.branch", plan.branch_settings),
        step("gather", "robustness.nc", "gather.counted_ends",
            paths=["scene_classes/{name}.nc", "maps/{name}.nc"]),
        *(
            figure_step(f"{folder}-{{name}}", f"figures.{name}_figure", name=f"figure_{name}",
                solved=f"{folder}/{{name}}.nc")
            for name, folder in (("map", "maps"), ("branches", "branches"))
        ),
        table_step("robustness", "tables.ends_table", counts="robustness.nc"),
        step("verdict", "verdict.txt", "tables.wrong_answers", counts="robustness.nc", last=True),
    )  # fmt: skip
