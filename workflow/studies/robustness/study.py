"""The study of robustness: scenes far beyond the others, solved right or refused with a reason.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bearingwear.scene.checking import read_record
from bearingwear.scene.read import load_scene
from bearingwear.studies.protocol import Step, Study
from workflow.studies.robustness.plan import ROBUSTNESS_FILE, RobustnessPlan

_RUN = "studies.robustness"
_FOLDER = "results/robustness"
_COUNTS = f"{_FOLDER}/robustness.nc"
_TABLE = f"{_FOLDER}/tables/robustness.md"
_VERDICT = f"{_FOLDER}/verdict.txt"
PLOTS = {
    "maps": "workflow.studies.robustness.figures:figure_of_map",
    "branches": "workflow.studies.robustness.figures:figure_of_branches",
}
"""Which function of a dataset draws a kind of file."""

_NAMED = r"[A-Za-z0-9_-]+"


def study(config: Mapping[str, Any]) -> RobustnessStudy:
    """The study of config/robustness.yaml."""
    return RobustnessStudy(read_record(RobustnessPlan, ROBUSTNESS_FILE))


class RobustnessStudy(Study):
    """Random scenes, maps and branches; how they ended; their figures."""

    name = "robustness"

    def __init__(self, plan: RobustnessPlan) -> None:
        self.plan = plan
        self.jobs = (*self._solved(), *self._told())

    def _solved(self) -> list[Step]:
        """Each is one long job: thousands of scenes in one process."""
        plan, scene = self.plan, {"scene": self.plan.scene_file}
        return [
            Step(
                name="random_scenes",
                run=f"{_RUN}.run.random_scenes",
                inputs=scene,
                settings=lambda w: plan.class_settings(w["name"]),
                outputs=(f"{_FOLDER}/scene_classes/{{name}}.nc",),
                matches={"name": _NAMED},
                label="robustness: random scenes, {name}",
                seconds=60.0,
            ),
            Step(
                name="map",
                run=f"{_RUN}.maps.state_map",
                inputs=scene,
                settings=lambda w: plan.map_settings(w["name"]),
                outputs=(f"{_FOLDER}/maps/{{name}}.nc",),
                matches={"name": _NAMED},
                label="robustness: map, {name}",
                seconds=60.0,
            ),
            Step(
                name="branch",
                run=f"{_RUN}.branches.branch",
                inputs=scene,
                settings=lambda w: plan.branch_settings(w["name"]),
                outputs=(f"{_FOLDER}/branches/{{name}}.nc",),
                matches={"name": _NAMED},
                label="robustness: branches, {name}",
                seconds=10.0,
            ),
        ]

    def _told(self) -> list[Step]:
        return [
            Step(
                name="gather",
                run=f"{_RUN}.gather.counted_ends",
                inputs={"paths": [*self._files("scene_classes"), *self._files("maps")]},
                outputs=(_COUNTS,),
                label="robustness: count how the scenes ended",
            ),
            self._figure("map", "maps"),
            self._figure("branches", "branches"),
            Step(
                name="table",
                run=f"{_RUN}.tables.ends_table",
                inputs={"counts": _COUNTS},
                outputs=(_TABLE,),
                label="robustness: table",
                caption="robustness",
                category="robustness",
                result="table",
            ),
            Step(
                name="verdict",
                run=f"{_RUN}.tables.wrong_answers",
                inputs={"counts": _COUNTS},
                outputs=(_VERDICT,),
                label="robustness: look for answers that are wrong",
                after=[_TABLE, *self._figures()],
            ),
        ]

    def _figure(self, name: str, folder: str) -> Step:
        path = f"{_FOLDER}/figures/{folder}-{{name}}"
        return Step(
            name=f"figure_{name}",
            run=f"{_RUN}.figures.{name}_figure",
            inputs={"solved": f"{_FOLDER}/{folder}/{{name}}.nc"},
            outputs=(f"{path}.svg", f"{path}.png"),
            matches={"name": _NAMED},
            label="robustness: figure {name}",
            caption="robustness",
            category="robustness",
            result="{name}",
        )

    def _files(self, folder: str) -> list[str]:
        return [f"{_FOLDER}/{folder}/{name}.nc" for name in getattr(self.plan, folder)]

    def _figures(self) -> list[str]:
        return [
            f"{_FOLDER}/figures/{folder}-{name}.{suffix}"
            for folder in ("maps", "branches")
            for name in getattr(self.plan, folder)
            for suffix in ("svg", "png")
        ]

    def targets(self) -> list[str]:
        solved = [path for f in ("scene_classes", "maps", "branches") for path in self._files(f)]
        return [*solved, _COUNTS, *self._figures(), _TABLE, _VERDICT]

    def inputs(self) -> list[str]:
        return [self.plan.scene_file]

    def check(self) -> None:
        load_scene(self.plan.scene_file)
