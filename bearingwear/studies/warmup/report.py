"""The warm-up of a scene for its page: dataset, sheet and figure."""

from __future__ import annotations

from pathlib import Path

import xarray as xr

from bearingwear.document.markdown import as_markdown
from bearingwear.plotting.drawing import Figure
from bearingwear.scene.read import load_scene
from bearingwear.solvers.warmup.transient import ramp
from bearingwear.studies.warmup.result import warm_up_dataset
from bearingwear.studies.warmup.sheet import warm_up_figure, warm_up_sheet


def warm_up_report(scene: Path, seconds: float | None) -> tuple[xr.Dataset, str, Figure]:
    """Step: returns the warm-up of a scene after a ramp to speed, its sheet and its figure.

    seconds: duration of the ramp [s]; None for that of the scene.
    """
    loaded = load_scene(scene)
    warmup = warm_up_dataset(loaded, ramp(loaded.start_s if seconds is None else seconds))
    return warmup, as_markdown(warm_up_sheet(warmup)), warm_up_figure(warmup)
