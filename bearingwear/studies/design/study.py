"""The design study: which preload to take, what holds it, and whether the dynamic model agrees.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from glob import glob
from pathlib import Path
from typing import Any

from bearingwear.scene.checking import read_record
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.design.plan import CHECKED, CHECKED_FIDELITIES, DesignPlan
from bearingwear.studies.protocol import Bundle, Step, Study, Wildcards
from bearingwear.studies.uncertainty.plan import UncertaintyPlan

_PLAN = "config/design.yaml"
_SAMPLED = "config/uncertainty.yaml"
_RUN = "studies.design"
_SCENE = "config/scenes/{scene}.yaml"
_FOLDER = "results/{scene}/design"
_SMALL = "results/{scene}/preload"
_DESIGN, _RECOMMENDATION = f"{_FOLDER}/design.nc", f"{_FOLDER}/recommendation.nc"

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
    sampled = read_record(UncertaintyPlan, _SAMPLED).scenes if Path(_SAMPLED).is_file() else ()
    studied = [scene for block in config.get("studies", ()) for scene in block["scenes"]]
    plan = read_record(DesignPlan, _PLAN)
    return DesignStudy(plan, tuple(sampled), studied, config.get("uncertain_lives", {}))


class DesignStudy(Study):
    """A map of lives, the preload to take, and a check of it by the dynamic model.

    Parameters
    ----------
    plan : DesignPlan
    sampled : sequence of str
        Scenes whose lives the study of uncertainty samples.
    studied : sequence of str
        Scenes of the main study; their small maps are a part of it.
    spread : mapping, optional
        Of which of these `scenes` lives are sampled, from how many `samples`, by which `seed`.
    """

    name = "design"

    def __init__(
        self,
        plan: DesignPlan,
        sampled: Sequence[str] = (),
        studied: Sequence[str] = (),
        spread: Mapping[str, Any] | None = None,
    ) -> None:
        self.plan = plan
        self.spread = dict(spread or {})
        spread_of = self.spread.pop("scenes", ())
        # of a pair there are no states of wear to study, and its map is the whole study
        small = plan.small_maps.items()
        self.small_maps = {name: of for name, of in small if name in studied or not studied}
        self.spread_of = [scene for scene in self.small_maps if scene in spread_of]
        self.drawn = {
            scene: _drawn(scene, _FOLDER, several=True, sampled=scene in sampled)
            for scene in plan.maps
        }
        self.small = {
            scene: _drawn(
                scene,
                _SMALL,
                several=len(axes.friction) > 1,
                answered={
                    **({"beside": f"{_SMALL}/beside.nc"} if plan.beside(scene) else {}),
                    **({"spread": f"{_SMALL}/spread.nc"} if scene in self.spread_of else {}),
                },
            )
            for scene, axes in self.small_maps.items()
        }
        self.jobs = (
            *(self._chosen() if plan.maps else ()),
            *(self._small() if self.small_maps else ()),
            *self.drawn.values(),
            *self.small.values(),
            *(self._checked() if plan.maps else ()),
        )

    def targets(self) -> list[str]:
        drawn = [path for bundle in self.drawn.values() for path in bundle.outputs]
        checks = [f"results/{scene}/design/tables/check.md" for scene in self.drawn]
        return [*drawn, *checks, *self.default_targets()]

    def default_targets(self) -> list[str]:
        drawn = [path for bundle in self.small.values() for path in bundle.outputs]
        solved = [
            f"results/{scene}/preload/{name}.nc"
            for scene in self.small
            for name in ("design", "recommendation")
        ]
        beside = [
            f"{_SMALL}/beside.nc".format(scene=scene)
            for scene in self.small
            if self.plan.beside(scene)
        ]
        spread = [f"{_SMALL}/spread.nc".format(scene=scene) for scene in self.spread_of]
        return [*solved, *beside, *spread, *drawn]

    def inputs(self) -> list[str]:
        return [_SCENE.format(scene=scene) for scene in self.plan.scenes]

    def check(self) -> None:
        self.plan.check_scenes()

    def page_answers(self) -> list[str]:
        kinds = ("answer.json", "tables/*.md", "figures/*.svg", "figures/*.png")
        there = [path for kind in kinds for path in sorted(glob(f"results/*/design/{kind}"))]
        small = [path for path in self.default_targets() if not path.endswith((".csv", ".nc"))]
        return there or small

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
                        for job in plan.maps[w["scene"]].jobs
                    ]
                },
                outputs=(_DESIGN,),
                settings=lambda w: {"limits": plan.scenes[w["scene"]].limits.given},
                label="{scene}: gather the design map",
            ),
            Step(
                name="recommend",
                run=f"{_RUN}.recommend.recommendation_of",
                inputs={"scene": _SCENE, "design": _DESIGN},
                outputs=(_RECOMMENDATION,),
                label="{scene}: recommended preload",
            ),
        ]

    def _map_settings(self, wildcards: Wildcards) -> dict[str, Any]:
        axes = self.plan.maps[wildcards["scene"]]
        return {
            "method": wildcards["method"],
            "friction": float(wildcards["mu"]),
            "shaft_speed_rpm": axes.shaft_speed_rpm,
            "preload_N": axes.preload_N,
            "slip_limit": self.plan.scenes[wildcards["scene"]].limits.gyroscopic_slip_share,
        }

    def _small(self) -> list[Step]:
        maps, scenes = self.small_maps, self.plan.scenes
        return [
            Step(
                name="small_map",
                run=f"{_RUN}.recommend.small_map",
                inputs={"scene": _SCENE},
                outputs=(f"{_SMALL}/design.nc", f"{_SMALL}/recommendation.nc"),
                settings=lambda w: {
                    "axes": asdict(maps[w["scene"]]),
                    "limits": scenes[w["scene"]].limits.given,
                },
                matches={"scene": "|".join(map(re.escape, maps))},
                label="{scene}: small map and recommended preload",
                alone=True,
                tells=True,
            ),
            *(
                Step(
                    name=f"beside_{scene}",
                    run=f"{_RUN}.beside.lives_beside",
                    inputs={
                        "scene": _SCENE.format(scene=scene),
                        "recommendation": f"{_SMALL}/recommendation.nc".format(scene=scene),
                    },
                    outputs=(f"{_SMALL}/beside.nc".format(scene=scene),),
                    settings={"cases": self.plan.beside(scene)},
                    label=f"{scene}: other assumptions at the recommended preload",
                )
                for scene in maps
                if self.plan.beside(scene)
            ),
            *(
                Step(
                    name=f"spread_{scene}",
                    run="studies.uncertainty.quantiles.recommended_life_quantiles",
                    inputs={
                        "scene": _SCENE.format(scene=scene),
                        "recommendation": f"{_SMALL}/recommendation.nc".format(scene=scene),
                    },
                    outputs=(f"{_SMALL}/spread.nc".format(scene=scene),),
                    settings=self.spread,
                    label=f"{scene}: how lives at the recommended preload spread",
                    seconds=9.0,
                )
                for scene in self.spread_of
            ),
        ]

    def _checked(self) -> list[Step]:
        check = f"{_FOLDER}/check"
        times = {"times": "|".join(CHECKED).replace(".", r"\.")}
        return [
            Step(
                name="check_scene",
                run=f"{_RUN}.dynamic_check.check_scene_text",
                inputs={"scene": _SCENE, "recommendation": _RECOMMENDATION},
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
                    "recommendation": _RECOMMENDATION,
                    "cases": [
                        f"{check}/{factor}-{fidelity}.nc"
                        for factor in CHECKED
                        for fidelity in CHECKED_FIDELITIES
                    ],
                },
                outputs=(f"{_FOLDER}/tables/check.md",),
                label="{scene}: the recommended preload, solved dynamically",
                caption="design",
                result="design, dynamic",
            ),
        ]


def _drawn(
    scene: str,
    folder: str,
    several: bool,
    sampled: bool = False,
    answered: Mapping[str, str] | None = None,
) -> Bundle:
    """Figures and tables of a map.

    Parameters
    ----------
    scene, folder : str
    several : bool
        Whether it is of several friction coefficients.
    sampled : bool
        Whether the study of uncertainty samples lives of the scene.
    answered : mapping, optional
        What else the answer is made from, by the names of its arguments.
    """
    at = folder.format(scene=scene)
    sample = ("uncertainty",) if sampled else ()
    files = {name: f"{at}/{name}.nc" for name in ("design", "recommendation", *sample)}
    inputs = {"design": files, "map": {"design": files["design"]}, "uncertainty": files}
    figures = ("design", *(("map",) if several else ()), *sample)
    steps = [
        *(
            Step(
                name=f"figure_{name}",
                run=f"{_RUN}.draw.draw_{name}",
                inputs=inputs[name],
                outputs=(f"{at}/figures/{name}.svg", f"{at}/figures/{name}.png"),
                label=f"{scene}: figure {name} of the design study",
                result=f"design, {name}",
                caption="design",
                category=scene,
            )
            for name in figures
        ),
        Step(
            name="tables",
            run=f"{_RUN}.tables.tables",
            inputs=files,
            outputs=(f"{at}/tables/map.csv", f"{at}/tables/design.md"),
            label=f"{scene}: tables of the design study",
            result="design, table",
            caption="design",
            category=scene,
        ),
        Step(
            name="answer",
            run=f"{_RUN}.answer.design_answer",
            inputs=files | {k: v.format(scene=scene) for k, v in (answered or {}).items()},
            outputs=(f"{at}/answer.json",),
            label=f"{scene}: which preload to take",
        ),
    ]
    which, small = ("small map", "small_") if folder == _SMALL else ("map", "")
    label = f"{scene}: figures and tables of its {which}"
    return Bundle(name=f"{small}drawn_{scene}", steps=tuple(steps), label=label)
