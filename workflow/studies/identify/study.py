"""The study of the paper's bearing: which bearings fit what its text states.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from bearingwear.scene.checking import read_record
from bearingwear.studies.protocol import Step, Study
from workflow.studies.identify.plan import IdentifyPlan

_PLAN = "config/identify.yaml"
_RUN = "studies.identify"
_FOLDER = "results/identify"
_CANDIDATES = f"{_FOLDER}/candidates.nc"
_FIGURE = (f"{_FOLDER}/figures/candidates.svg", f"{_FOLDER}/figures/candidates.png")
_TABLE = f"{_FOLDER}/tables/candidates.md"

PLOTS = {"candidates": "workflow.studies.identify.figures:ridge_and_lives"}
"""What `bearingwear plot` draws of the kinds of files that this study makes."""


def study(config: Mapping[str, Any]) -> IdentifyStudy:
    """The study of config/identify.yaml."""
    return IdentifyStudy(read_record(IdentifyPlan, _PLAN))


class IdentifyStudy(Study):
    """Every bearing of a grid: does it fit what the text states?"""

    name = "identify"

    def __init__(self, plan: IdentifyPlan) -> None:
        self.plan = plan
        self.jobs = (
            Step(
                name="candidates",
                run=f"{_RUN}.search.identified",
                inputs={
                    "scene": _scene_file(plan.scene),
                    "marks": [_scene_file(name) for name in plan.marks],
                },
                outputs=(_CANDIDATES,),
                settings={"plan": asdict(plan)},
                label="bearings that fit what the paper states",
                seconds=15.0,
            ),
            Step(
                name="figure",
                run=f"{_RUN}.figures.candidates_figure",
                inputs={"candidates": _CANDIDATES},
                outputs=_FIGURE,
                label="figure of the bearings that fit",
                caption="identify",
                category="all scenes",
                result="candidates",
            ),
            Step(
                name="table",
                run=f"{_RUN}.tables.candidates_table",
                inputs={"candidates": _CANDIDATES},
                outputs=(_TABLE,),
                label="table of the bearings that fit",
            ),
        )

    def targets(self) -> list[str]:
        return [*_FIGURE, _TABLE]

    def inputs(self) -> list[str]:
        return [_scene_file(name) for name in self.plan.scene_names]

    def check(self) -> None:
        self.plan.check_scenes()


def _scene_file(name: str) -> str:
    return f"config/scenes/{name}.yaml"
