"""What the report page shows of a warm-up."""

from __future__ import annotations

from pathlib import Path

import xarray as xr

from bearingwear.document.markdown import as_markdown
from bearingwear.plotting.drawing import Figure
from bearingwear.scene.read import load_scene
from bearingwear.studies.warmup.result import warm_up_dataset
from bearingwear.studies.warmup.sheet import warm_up_figure, warm_up_sheet
from bearingwear.studies.warmup.transient import ramp


def warm_up_report(scene: Path, seconds: float) -> tuple[xr.Dataset, str, Figure]:
    """Step: the warm-up of a scene after a ramp to speed, its sheet and its figure."""
    warmed = warm_up_dataset(load_scene(scene), ramp(seconds))
    return warmed, as_markdown(warm_up_sheet(warmed)), warm_up_figure(warmed)
