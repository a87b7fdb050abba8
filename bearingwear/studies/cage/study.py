"""The study of a cage: which motion it takes, how fast it whirls, and what it wears.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from bearingwear.scene.checking import read_record
from bearingwear.studies.cage.plan import CAGE_FILE, CagePlan
from bearingwear.studies.protocol import Step, Study, Wildcards

_RUN = "studies.cage"
_FOLDER = "results/cage"
_MAP = f"{_FOLDER}/cage.nc"
_FIGURE = (f"{_FOLDER}/figures/cage.svg", f"{_FOLDER}/figures/cage.png")
_TABLE = f"{_FOLDER}/tables/cage.md"
_NAMED = r"mu[0-9.e-]+-pocket[0-9.e-]+-guide[0-9.e-]+-g[0-9.e-]+"

PLOTS = {"cage_map": "bearingwear.studies.cage.figures:whirl_and_wear"}
"""What `bearingwear plot` draws of the kinds of files that this study makes."""


def study(config: Mapping[str, Any]) -> CageStudy:
    """The study of config/cage.yaml."""
    return CageStudy(read_record(CagePlan, CAGE_FILE))


class CageStudy(Study):
    """A map of cages, each from several starts; its figure and table."""

    name = "cage"

    def __init__(self, plan: CagePlan) -> None:
        self.plan = plan
        self.jobs = (
            Step(
                name="run",
                run=f"{_RUN}.run.motions_from_starts",
                inputs={"scene": plan.scene_file},
                outputs=(f"{_FOLDER}/points/{{point}}.nc",),
                settings=self._settings,
                matches={"point": _NAMED},
                label="cage, dynamic: {point}",
                seconds=3.0 * len(plan.starts),
            ),
            Step(
                name="gather",
                run=f"{_RUN}.gather.gathered_motions",
                inputs={"scene": plan.scene_file, "paths": self._points()},
                outputs=(_MAP,),
                settings={"plan": asdict(plan)},
                label="cage: gather the map",
            ),
            Step(
                name="figure",
                run=f"{_RUN}.figures.cage_figure",
                inputs={"motions": _MAP},
                outputs=_FIGURE,
                label="cage: figure of the map",
                caption="cage",
                category="cage",
                result="map",
            ),
            Step(
                name="table",
                run=f"{_RUN}.tables.cage_table",
                inputs={"motions": _MAP},
                outputs=(_TABLE,),
                label="cage: table of the map",
                caption="cage",
                category="cage",
                result="table",
            ),
        )

    def _settings(self, wildcards: Wildcards) -> dict[str, Any]:
        plan = self.plan
        return {
            "changes": plan.changes_at(plan.points[wildcards["point"]]),
            "starts": list(plan.starts),
            "stretch_turns": plan.stretch_turns,
        }

    def _points(self) -> list[str]:
        return [f"{_FOLDER}/points/{name}.nc" for name in self.plan.points]

    def targets(self) -> list[str]:
        return [_MAP, *_FIGURE, _TABLE]

    def inputs(self) -> list[str]:
        return [self.plan.scene_file]

    def check(self) -> None:
        self.plan.check_scenes()
