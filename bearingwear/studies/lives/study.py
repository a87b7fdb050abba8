"""The study of lives: wear is followed with the dynamic model, cage and all, to the end of life.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bearingwear.scene.checking import read_record
from bearingwear.studies.lives.plan import LIVES_FILE, LivesPlan
from bearingwear.studies.protocol import Step, Study, Wildcards

_RUN = "studies.lives"
_TABLE = "results/lives/tables/lives.md"
_NAMED = r"[A-Za-z0-9_-]+"


def study(config: Mapping[str, Any]) -> LivesStudy:
    """The study of config/lives.yaml."""
    return LivesStudy(read_record(LivesPlan, LIVES_FILE))


class LivesStudy(Study):
    """A life each, its figure, and one table."""

    name = "lives"

    def __init__(self, plan: LivesPlan) -> None:
        self.plan = plan
        self.jobs = (
            Step(
                name="solve",
                run="studies.solve.solved_life",
                inputs=lambda w: {"scene": plan.lives[w["life"]].scene_file},
                outputs=("results/lives/{life}.nc",),
                settings=self._settings,
                matches={"life": _NAMED},
                label="life, dynamic: {life}",
                seconds=60.0,
            ),
            Step(
                name="figure",
                run=f"{_RUN}.figures.wear_history",
                inputs={"life": "results/lives/{life}.nc"},
                outputs=("results/lives/figures/{life}.svg", "results/lives/figures/{life}.png"),
                matches={"life": _NAMED},
                label="life, dynamic: figure {life}",
                caption="lives",
                category="lives",
                result="{life}",
            ),
            Step(
                name="table",
                run=f"{_RUN}.tables.lives_table",
                inputs={"lives": self._files()},
                outputs=(_TABLE,),
                label="lives, dynamic: table",
                caption="lives",
                category="lives",
                result="table",
            ),
        )

    def _settings(self, wildcards: Wildcards) -> dict[str, Any]:
        changes = self.plan.lives[wildcards["life"]].changes
        return {"changes": dict(changes), "fidelity": "dynamic"}

    def _files(self) -> list[str]:
        return [f"results/lives/{name}.nc" for name in self.plan.lives]

    def targets(self) -> list[str]:
        figures = [
            f"results/lives/figures/{name}.{suffix}"
            for name in self.plan.lives
            for suffix in ("svg", "png")
        ]
        return [*self._files(), *figures, *([_TABLE] if self.plan.lives else [])]

    def inputs(self) -> list[str]:
        return list(dict.fromkeys(life.scene_file for life in self.plan.lives.values()))

    def check(self) -> None:
        self.plan.check_scenes()
