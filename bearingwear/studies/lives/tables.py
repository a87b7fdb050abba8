"""Table of lives that were solved with the dynamic model."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.document.markdown import markdown_table
from bearingwear.results.units import Display, display
from bearingwear.studies.dataset import counted
from bearingwear.studies.lives.life_file import criterion, dynamic_life, ended_by

HOURS, LOSS, VOLUME = display("h"), display("m"), display("m3", 1e-9)


def lives_table(lives: Sequence[Path]) -> str:
    """Step: lives by the names of their files, beside the steady ones, as Markdown."""
    rows = [[path.stem, *_numbers(dynamic_life(path))] for path in lives]
    parts = [
        "# Wear life, followed dynamically",
        markdown_table(
            "life of | life (h) | ± (h) | ended by | steady life (h) | ended by "
            "| steady time to the same loss (h) | loss (µm) | balls' wear, least and most of the "
            f"mean | {VOLUME.label('pockets and land')}",
            rows,
        ),
        "±: error bound from the steps and the scatter of the runs. Balls' wear: lost by each "
        "since the start. The steady life is that of the same scene under its thrust alone, "
        "without the cage, at the mean loss.",
    ]
    return "\n\n".join(parts) + "\n"


def _numbers(life: xr.Dataset) -> list[str]:
    """A row of the table."""
    k = counted(life)

    def one(name: str, unit: Display = HOURS) -> str:
        return unit.text(life[name] if name in life else np.nan)

    # of a life that no run was solved for there is no history
    if "history_ball_worn_volume" not in life:
        return [*["–"] * 2, ended_by(life), one("steady_life"), *["–"] * 5]
    balls = life["history_ball_worn_volume"].values[-1]
    spread = balls / balls.mean() if balls.mean() > 0.0 else np.full(1, np.nan)
    cage = "–"
    if "history_pocket_worn_volume" in life:
        pockets = life["history_pocket_worn_volume"].values[-1].sum()
        land = life["history_land_worn_volume"].values[-1]
        cage = f"{VOLUME.text(pockets)}, {VOLUME.text(land)}"
    steady = criterion(life, "steady_end_criterion") if "steady_life" in life else "–"
    return [
        HOURS.text(life["life"][k]),
        HOURS.text(life["life_error_bound"][k]),
        ended_by(life),
        one("steady_life"),
        steady,
        one("steady_time_to_loss"),
        one("loss_at_end", LOSS),
        f"{spread.min():.3f}, {spread.max():.3f}",
        cage,
    ]
