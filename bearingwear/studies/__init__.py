"""Studies: functions that solve many cases or lives, and tables and figures of their files.

The rules of the workflow (`workflow/rules`) call these functions. Studies that need the repository
are in `workflow/studies`.
"""

from __future__ import annotations

import sys
from pathlib import Path

from bearingwear.application import application_plots, application_sheets

_ROOT = Path(__file__).resolve().parents[2]
_PACKAGED = "bearingwear.studies"
_IN_REPOSITORY = "workflow.studies"

STUDY_SHEETS = {
    "recommendation": f"{_PACKAGED}.design.document.sheets:recommendation_sheet",
    "warm-up": f"{_PACKAGED}.warmup.sheet:warm_up_sheet",
    **application_sheets(),
}
"""Functions for `bearingwear show` by the kind of a file; each takes the open file."""

STUDY_PLOTS = {
    "case": f"{_PACKAGED}.grid.figures.plots:case_plot",
    "life": f"{_PACKAGED}.grid.figures.plots:life_plot",
    "study": f"{_PACKAGED}.grid.figures.plots:study_plot",
    "wear life": f"{_PACKAGED}.grid.figures.plots:lives_plot",
    "design map": f"{_PACKAGED}.design.figures.plots:map_plot",
    "uncertainty": f"{_PACKAGED}.design.figures.plots:uncertainty_plot",
    "recommendation": f"{_PACKAGED}.design.figures.plots:recommendation_plot",
    "warm-up": f"{_PACKAGED}.warmup.sheet:warm_up_figure",
    **application_plots(),
}
"""Functions for `bearingwear plot` by the kind of a file; each takes the dataset."""

if (_ROOT / "workflow" / "studies").is_dir():  # in a clone
    sys.path.append(str(_ROOT))
    STUDY_PLOTS |= {
        "accuracy against time": f"{_IN_REPOSITORY}.accuracy.figures:accuracy_plot",
        "maps": f"{_IN_REPOSITORY}.robustness.figures:figure_of_map",
        "branches": f"{_IN_REPOSITORY}.robustness.figures:figure_of_branches",
    }
