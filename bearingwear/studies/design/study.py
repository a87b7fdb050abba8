"""The design study: which preload to take, what holds it, and whether the dynamic model agrees.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from glob import glob
from pathlib import Path
from typing import Any

from bearingwear.scene.checking.check import read_record
from bearingwear.studies.design.plan import CHECKED, CHECKED_FIDELITIES, DesignPlan
from bearingwear.studies.protocol import (
    SCENE,
    Bundle,
    Step,
    Study,
    bundle,
    figure_step,
    step,
    table_step,
)
from bearingwear.studies.uncertainty.plan import UncertaintyPlan

_SAMPLED = Path("config/uncertainty.yaml")
_SMALL = "results/{scene}/preload"

SHEETS = {"recommendation": "bearingwear.studies.design.document.sheets:recommendation_sheet"}
"""What `bearingwear show` says of the kinds of files that this study makes."""

PLOTS = {
    "design map": "bearingwear.studies.design.figures.plots:map_plot",
    "uncertainty": "bearingwear.studies.design.figures.plots:uncertainty_plot",
    "recommendation": "bearingwear.studies.design.figures.plots:recommendation_plot",
}
"""What `bearingwear plot` draws of the kinds of files that this study makes and reads."""


_SHOWN = {
    "design": "life and requirements against preload",
    "map": "life and requirements against preload and friction",
    "uncertainty": "uncertainty in life",
}
"""Figures in words, for the report of the jobs."""


def study(config: Mapping[str, Any]) -> DesignStudy:
    """The study of config/design.yaml."""
    sampled = read_record(UncertaintyPlan, _SAMPLED).scenes if _SAMPLED.is_file() else ()
    studied = [scene for block in config.get("studies", ()) for scene in block["scenes"]]
    plan = read_record(DesignPlan, "config/design.yaml")
    return DesignStudy(plan, tuple(sampled), studied, config.get("uncertain_lives", {}))


class DesignStudy(Study):
    """A map of lives, the preload to take, and a check of it by the dynamic model.

    sampled: scenes whose lives the study of uncertainty samples.
    studied: scenes of the main study; their small maps are a part of it.
    spread: of which of these `scenes` lives are sampled, from how many `samples`, by which `seed`.
    """

    def __init__(
        self,
        plan: DesignPlan,
        sampled: Sequence[str] = (),
        studied: Sequence[str] = (),
        spread: Mapping[str, Any] | None = None,
    ) -> None:
        # without states of wear the maps are the whole study
        small = [name for name in plan.small_maps if name in studied or not studied]
        sample = dict(spread or {})
        spread_of = [scene for scene in small if scene in sample.pop("scenes", ())]
        super().__init__(
            "design",
            plan,
            *_chosen(plan),
            *_small(plan, small, spread_of, sample, alone=len(studied) < 2),
            *(_drawn(scene, scene in sampled) for scene in plan.maps),
            *(_small_drawn(plan, scene, scene in spread_of) for scene in small),
            *_checked(plan),
            folder="results/{scene}/design",
        )

    def page_answers(self) -> list[str]:
        data = ("answer.json", "charts.json", "recommendation.nc")
        kinds = (*data, "tables/*.md", "figures/*.svg", "figures/*.png")
        there = [path for kind in kinds for path in sorted(glob(f"results/*/design/{kind}"))]
        # what design.md says is in the answer; of data only the recommendation has the scene
        left_out = (".csv", "design.nc", "spread.nc", "beside.nc", "tables/design.md")
        return [path for path in there or self.default_targets() if not path.endswith(left_out)]


def _chosen(plan: DesignPlan) -> list[Step]:
    """The map, in parts, and the preload to take."""
    return [
        step("map", "map/{method}-mu{mu}.nc", "map.map_part", plan.map_parts, scene=SCENE,
            settings=plan.part_settings, work=1.0),
        step("gather", "design.nc", "choice.design_map", [*plan.maps],
            parts="map/{method}-mu{mu}.nc",
            settings=lambda scene: {"limits": plan.scenes[scene].limits.stored}),
        step("recommend", "recommendation.nc", "recommend.recommendation_of", design="design.nc",
            scene=SCENE),
    ]  # fmt: skip


def _small(
    plan: DesignPlan,
    scenes: Sequence[str],
    spread_of: Sequence[str],
    sample: Mapping[str, Any],
    alone: bool,
) -> list[Step]:
    """The small map, and lives at the preload that it recommends."""
    found: dict[str, Any] = {
        "scene": SCENE,
        "recommendation": f"{_SMALL}/recommendation.nc",
        "default": True,
    }
    return [
        step("small_map", (f"{_SMALL}/design.nc", f"{_SMALL}/recommendation.nc"),
            "recommend.small_map", scenes, scene=SCENE,
            settings=lambda scene: {
                "axes": asdict(plan.small_maps[scene]),
                "limits": plan.scenes[scene].limits.stored,
            },
            label="{scene}: small map and recommended preload", default=True,
            # most of the work of a study of one scene; else the start of the longest chain
            alone=alone, priority=int(not alone), tells=True),
        step("beside", f"{_SMALL}/beside.nc", "beside.lives_beside",
            [scene for scene in scenes if plan.beside(scene)],
            settings=lambda scene: {"cases": plan.beside(scene)},
            label="{scene}: other assumptions at the recommended preload", **found),
        step("spread", f"{_SMALL}/spread.nc",
            "studies.uncertainty.quantiles.recommended_life_quantiles", spread_of, settings=sample,
            label="{scene}: spread in life at the recommended preload", work=1.0, **found),
    ]  # fmt: skip


def _checked(plan: DesignPlan) -> list[Step]:
    """The recommended preload, and some beside it, solved dynamically."""
    check = "check/{times}-{fidelity}.nc"
    return [
        step("check_scene", "check/{times}.yaml", "dynamic_check.check_scene_text",
            {(scene, times): times for scene in plan.maps for times in CHECKED}, scene=SCENE,
            recommendation="recommendation.nc", settings=lambda times: {"times": float(times)},
            label="{scene}: scene file with {times} times the recommended preload"),
        step("solve_check", check, "studies.solve.solved_case",
            {
                (scene, times, fidelity): fidelity
                for scene in plan.maps
                for times in CHECKED
                for fidelity in CHECKED_FIDELITIES
            },
            scene="check/{times}.yaml", settings=lambda fidelity: {"fidelity": fidelity},
            label="{scene}: {times} times the recommended preload, {fidelity}", work=1.0),
        table_step("check", "document.check_table.check_table", name="check_table",
            recommendation="recommendation.nc", cases=check,
            label="{scene}: the recommended preload, solved dynamically",
            result="dynamic check, table"),
    ]  # fmt: skip


def _drawn(scene: str, sampled: bool) -> Bundle:
    """Figures and tables of a map."""
    files = ("design", "recommendation", *(("uncertainty",) if sampled else ()))
    inputs = {name: f"{name}.nc" for name in files}
    figures = [_figure("design", inputs), _figure("map", {"design": "design.nc"})]
    if sampled:
        figures.append(_figure("uncertainty", inputs))
    return bundle(f"drawn_{scene}", f"results/{scene}/design", scene,
        f"{scene}: figures and tables of the map", *figures, *_told(inputs, inputs))  # fmt: skip


def _small_drawn(plan: DesignPlan, scene: str, with_spread: bool) -> Bundle:
    """Figures and tables of a small map, and which preload to take."""
    inputs = {name: f"{name}.nc" for name in ("design", "recommendation")}
    more = {"beside": bool(plan.beside(scene)), "spread": with_spread}
    several = len(plan.small_maps[scene].friction) > 1
    return bundle(f"small_drawn_{scene}", f"results/{scene}/preload", scene,
        f"{scene}: figures and tables of the small map", _figure("design", inputs),
        *([_figure("map", {"design": "design.nc"})] if several else ()),
        *_told(inputs, inputs | {name: f"{name}.nc" for name, there in more.items() if there}),
        default=True)  # fmt: skip


def _figure(name: str, inputs: Mapping[str, str]) -> Step:
    run = f"figures.draw.draw_{name}"
    return figure_step(name, run, name=f"figure_{name}", inputs=inputs, result=_SHOWN[name])


def _told(inputs: Mapping[str, str], answered: Mapping[str, str]) -> list[Step]:
    """Tables, and the answer."""
    paths = ("map.csv", "design.md")
    return [
        table_step(paths, "document.sheets.tables", name="tables", inputs=inputs,
            result="recommendation, table"),
        step("answer", "answer.json", "document.sheets.design_answer", inputs=answered),
        step("charts", "charts.json", "document.charts.design_charts",
            inputs={name: path for name, path in answered.items() if name != "beside"}),
    ]  # fmt: skip
