"""The study of uncertainty: the spread of lives at a scene's own and recommended preload.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from bearingwear.scene.checking.check import read_record
from bearingwear.studies.protocol import SCENE, Study, step
from bearingwear.studies.uncertainty.plan import UncertaintyPlan

SHEETS = {"calibration": "bearingwear.studies.uncertainty.calibration_shown:calibration_sheet"}
PLOTS = {"calibration": "bearingwear.studies.uncertainty.calibration_shown:calibration_figure"}
"""What `bearingwear show` and `plot` make of a calibration."""


def study(config: Mapping[str, Any]) -> Study:
    """Sampled lives, their quantiles, and which value decides: config/uncertainty.yaml."""
    plan = read_record(UncertaintyPlan, "config/uncertainty.yaml")
    sampling = asdict(plan.sampling)
    return Study(
        "uncertainty",
        plan,
        step("sample_lives", "samples/{method}-{preload_choice}-{chunk}.nc", "sample.sampled_lives",
            {tuple(map(str, part)): part for part in plan.parts}, scene=SCENE,
            recommendation=lambda part: "recommendation.nc" if part.as_recommended else None,
            settings=lambda part: part.settings | {"sampling": sampling}, work=1.0),
        step("quantiles", "uncertainty.nc", "quantiles.quantiles_and_indices", scene=SCENE,
            parts="samples/{method}-{preload_choice}-{chunk}.nc", settings={"sampling": sampling},
            work=1.0),
        folder="results/{scene}/design",  # beside the recommendation
    )  # fmt: skip
