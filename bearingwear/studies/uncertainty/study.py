"""The study of uncertainty: the spread of lives at a scene's own and recommended preload.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from bearingwear.scene.checking import read_record
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.protocol import Files, Step, Study, Wildcards
from bearingwear.studies.uncertainty.plan import AS_RECOMMENDED, PRELOAD_CHOICES, UncertaintyPlan

_PLAN = "config/uncertainty.yaml"
_RUN = "studies.uncertainty"
_SCENE = "config/scenes/{scene}.yaml"
_FOLDER = "results/{scene}/design"  # beside the recommendation

SHEETS = {"calibration": "bearingwear.studies.uncertainty.calibration_shown:calibration_sheet"}
PLOTS = {"calibration": "bearingwear.studies.uncertainty.calibration_shown:calibration_figure"}
"""What `bearingwear show` and `plot` make of a calibration."""


def study(config: Mapping[str, Any]) -> UncertaintyStudy:
    """The study of config/uncertainty.yaml."""
    return UncertaintyStudy(read_record(UncertaintyPlan, _PLAN))


class UncertaintyStudy(Study):
    """Sampled lives, their quantiles, and which uncertain value decides."""

    name = "uncertainty"

    def __init__(self, plan: UncertaintyPlan) -> None:
        self.plan = plan
        self.sampling = asdict(plan.sampling)
        self.jobs = (
            Step(
                name="sample_lives",
                run=f"{_RUN}.sample.sampled_lives",
                inputs=self._sampled_from,
                outputs=(f"{_FOLDER}/samples/{{method}}-{{preload_choice}}-{{chunk}}.nc",),
                settings=self._sample_settings,
                matches={
                    "method": "|".join(PRELOAD_METHODS),
                    "preload_choice": "|".join(PRELOAD_CHOICES),
                    "chunk": r"\d+",
                },
                label="{scene}: uncertainty, {method}, {preload_choice} preload, part {chunk}",
                seconds=14.0,
            ),
            Step(
                name="quantiles",
                run=f"{_RUN}.quantiles.quantiles_and_indices",
                inputs=self._parts,
                outputs=(f"{_FOLDER}/uncertainty.nc",),
                settings={"sampling": self.sampling},
                label="{scene}: uncertainty of the life",
                seconds=5.0,
            ),
        )

    def targets(self) -> list[str]:
        return [f"results/{scene}/design/uncertainty.nc" for scene in self.plan.scenes]

    def inputs(self) -> list[str]:
        return [_SCENE.format(scene=scene) for scene in self.plan.scenes]

    def check(self) -> None:
        self.plan.check_scenes()

    def _sampled_from(self, wildcards: Wildcards) -> Files:
        files = {"scene": _SCENE.format(**wildcards)}
        if wildcards["preload_choice"] == AS_RECOMMENDED:
            files["recommendation"] = f"{_FOLDER}/recommendation.nc".format(**wildcards)
        return files

    def _sample_settings(self, wildcards: Wildcards) -> dict[str, Any]:
        return {
            "method": wildcards["method"],
            "preload_choice": wildcards["preload_choice"],
            "chunk": int(wildcards["chunk"]),
            "sampling": self.sampling,
        }

    def _parts(self, wildcards: Wildcards) -> Files:
        scene = wildcards["scene"]
        parts = [
            f"results/{scene}/design/samples/{method}-{choice}-{chunk}.nc"
            for method in self.plan.scenes[scene].preload_method
            for choice in PRELOAD_CHOICES
            for chunk in range(self.plan.sampling.chunks)
        ]
        return {"scene": _SCENE.format(scene=scene), "parts": parts}
