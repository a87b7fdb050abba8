"""The design study: which preload to take, what holds it, and whether the dynamic model agrees.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping
from glob import glob
from typing import Any

from bearingwear.scene.checking import read_record
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.design.plan import CHECKED, CHECKED_FIDELITIES, DesignPlan
from bearingwear.studies.protocol import Step, Study, Wildcards

_PLAN = "config/design.yaml"
_RUN = "studies.design"
_SCENE = "config/scenes/{scene}.yaml"
_FOLDER = "results/{scene}/design"
_FILES = {
    "design": f"{_FOLDER}/design.nc",
    "recommendation": f"{_FOLDER}/recommendation.nc",
    "uncertainty": f"{_FOLDER}/uncertainty.nc",  # made by the study of uncertainty
}
_FIGURES = ("design", "map", "uncertainty")

SHEETS = {"recommendation": "bearingwear.studies.design.show:recommendation_sheet"}
"""What `bearingwear show` says of the kinds of files that this study makes."""

PLOTS = {
    "design map": "bearingwear.studies.design.plots:map_plot",
    "uncertainty": "bearingwear.studies.design.plots:uncertainty_plot",
    "recommendation": "bearingwear.studies.design.plots:recommendation_plot",
}
"""What `bearingwear plot` draws of the kinds of files that this study makes and reads."""


def study(config: Mapping[str, Any]) -> DesignStudy:
    """The study of config/design.yaml."""
    return DesignStudy(read_record(DesignPlan, _PLAN))


class DesignStudy(Study):
    """A map of lives, the preload to take, and a check of it by the dynamic model."""

    name = "design"

    def __init__(self, plan: DesignPlan) -> None:
        self.plan = plan
        self.jobs = (*self._chosen(), *self._drawn(), *self._checked())

    def targets(self) -> list[str]:
        names = [
            *(f"figures/{name}.{suffix}" for name in _FIGURES for suffix in ("svg", "png")),
            *(f"tables/{name}.md" for name in ("design", "check")),
        ]
        return [f"results/{scene}/design/{name}" for scene in self.plan.scenes for name in names]

    def inputs(self) -> list[str]:
        return [_SCENE.format(scene=scene) for scene in self.plan.scenes]

    def check(self) -> None:
        self.plan.check_scenes()

    def page_answers(self) -> list[str]:
        kinds = ("tables/*.md", "figures/*.svg", "figures/*.png")
        there = [path for kind in kinds for path in glob(f"results/*/design/{kind}")]
        # the page takes its headline from the first table
        return sorted(there, key=lambda path: ("/design." not in path, path))

    def _chosen(self) -> list[Step]:
        plan = self.plan
        return [
            Step(
                name="map",
                run=f"{_RUN}.map.map_part",
                inputs={"scene": _SCENE},
                outputs=(f"{_FOLDER}/map/{{method}}-mu{{mu}}.nc",),
                settings=self._map_settings,
                matches={"method": "|".join(PRELOAD_METHODS), "mu": r"\d+\.\d{3}"},
                label="{scene}: design map, {method}, mu {mu}",
                seconds=6.5,  # 640 lives
            ),
            Step(
                name="gather",
                run=f"{_RUN}.choice.design_map",
                inputs=lambda w: {
                    "parts": [
                        f"results/{w['scene']}/design/map/{job}.nc"
                        for job in plan.scenes[w["scene"]].map.jobs
                    ]
                },
                outputs=(_FILES["design"],),
                settings=lambda w: {"limits": plan.scenes[w["scene"]].limits.given},
                label="{scene}: gather the design map",
            ),
            Step(
                name="recommend",
                run=f"{_RUN}.recommend.recommendation_of",
                inputs={"scene": _SCENE, "design": _FILES["design"]},
                outputs=(_FILES["recommendation"],),
                label="{scene}: recommended preload",
            ),
        ]

    def _map_settings(self, wildcards: Wildcards) -> dict[str, Any]:
        design = self.plan.scenes[wildcards["scene"]]
        return {
            "method": wildcards["method"],
            "friction": float(wildcards["mu"]),
            "shaft_speed_rpm": design.map.shaft_speed_rpm,
            "preload_N": design.map.preload_N,
            "slip_limit": design.limits.gyroscopic_slip_share,
        }

    def _drawn(self) -> list[Step]:
        return [
            *(
                Step(
                    name=f"figure_{name}",
                    run=f"{_RUN}.draw.draw_{name}",
                    inputs={"design": _FILES["design"]} if name == "map" else _FILES,
                    outputs=(f"{_FOLDER}/figures/{name}.svg", f"{_FOLDER}/figures/{name}.png"),
                    label=f"{{scene}}: figure {name} of the design study",
                    caption="design",
                    result=f"design, {name}",
                )
                for name in _FIGURES
            ),
            Step(
                name="tables",
                run=f"{_RUN}.tables.tables",
                inputs=_FILES,
                outputs=(f"{_FOLDER}/tables/map.csv", f"{_FOLDER}/tables/design.md"),
                label="{scene}: tables of the design study",
                caption="design",
                result="design, table",
            ),
        ]

    def _checked(self) -> list[Step]:
        check = f"{_FOLDER}/check"
        times = {"times": "|".join(CHECKED).replace(".", r"\.")}
        return [
            Step(
                name="check_scene",
                run=f"{_RUN}.dynamic_check.check_scene_text",
                inputs={"scene": _SCENE, "recommendation": _FILES["recommendation"]},
                outputs=(f"{check}/{{times}}.yaml",),
                settings=lambda w: {"times": float(w["times"])},
                matches=times,
                label="{scene}: scene at {times} times the recommended preload",
            ),
            Step(
                name="solve_check",
                run="studies.solve.solved_case",
                inputs={"scene": f"{check}/{{times}}.yaml"},
                outputs=(f"{check}/{{times}}-{{fidelity}}.nc",),
                settings=lambda w: {"fidelity": w["fidelity"]},
                matches={**times, "fidelity": "|".join(CHECKED_FIDELITIES)},
                label="{scene}: {times} times the recommended preload, {fidelity}",
                seconds=8.5,
            ),
            Step(
                name="check_table",
                run=f"{_RUN}.check_table.check_table",
                inputs={
                    "recommendation": _FILES["recommendation"],
                    "cases": [
                        f"{check}/{factor}-{fidelity}.nc"
                        for factor in CHECKED
                        for fidelity in CHECKED_FIDELITIES
                    ],
                },
                outputs=(f"{_FOLDER}/tables/check.md",),
                label="{scene}: the recommended preload, solved in time",
                caption="design",
                result="design, in time",
            ),
        ]
