"""Studies: functions that ask for many cases or lives, and what is said and drawn of their files.

The rules of the workflow (`workflow/rules`) call them. Those that need the repository lie in
`workflow/studies`.
"""

from __future__ import annotations

import sys
from pathlib import Path

from bearingwear.application import application_plots, application_sheets

_ROOT = Path(__file__).resolve().parents[2]
_HERE = "bearingwear.studies"
_THERE = "workflow.studies"

STUDY_SHEETS = {
    "recommendation": f"{_HERE}.design.document.sheets:recommendation_sheet",
    "warm-up": f"{_HERE}.warmup.sheet:warm_up_sheet",
    **application_sheets(),
}
"""What `bearingwear show` says of a file, by its kind: a function of the open file."""

STUDY_PLOTS = {
    "case": f"{_HERE}.grid.figures.plots:case_plot",
    "life": f"{_HERE}.grid.figures.plots:life_plot",
    "study": f"{_HERE}.grid.figures.plots:study_plot",
    "wear life": f"{_HERE}.grid.figures.plots:lives_plot",
    "design map": f"{_HERE}.design.figures.plots:map_plot",
    "uncertainty": f"{_HERE}.design.figures.plots:uncertainty_plot",
    "recommendation": f"{_HERE}.design.figures.plots:recommendation_plot",
    "warm-up": f"{_HERE}.warmup.sheet:warm_up_figure",
    **application_plots(),
}
"""What `bearingwear plot` draws of a file, by its kind: a function of the dataset."""

if (_ROOT / "workflow" / "studies").is_dir():  # in a clone
    sys.path.append(str(_ROOT))
    STUDY_PLOTS |= {
        "accuracy against time": f"{_THERE}.accuracy.figures:accuracy_plot",
        "maps": f"{_THERE}.robustness.figures:figure_of_map",
        "branches": f"{_THERE}.robustness.figures:figure_of_branches",
    }
