"""What is drawn and said of cases that were solved dynamically, for the workflow."""

from pathlib import Path

from bearingwear.plotting.drawing import Figure
from bearingwear.studies.grid.dynamic_tables import comparison
from bearingwear.studies.grid.figures.draw import draw_dynamic


def dynamic_report(study: Path, dynamic: Path) -> tuple[Figure, str, str]:
    """The figure, every number as CSV, and the few that matter as Markdown."""
    return (draw_dynamic(study, dynamic), *comparison(study, dynamic))
