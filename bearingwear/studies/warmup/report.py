"""What the report page shows of a warm-up."""

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
    """Step: the warm-up of a scene after a ramp to speed, its sheet and its figure."""
    given = load_scene(scene)
    warmed = warm_up_dataset(given, ramp(given.start_s if seconds is None else seconds))
    return warmed, as_markdown(warm_up_sheet(warmed)), warm_up_figure(warmed)
