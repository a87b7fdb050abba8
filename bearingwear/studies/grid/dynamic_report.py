"""The report on cases that were solved with the dynamic model, for the workflow."""

from pathlib import Path

from bearingwear.plotting.drawing import Figure
from bearingwear.studies.grid.dynamic_tables import comparison
from bearingwear.studies.grid.figures.draw import draw_dynamic


def dynamic_report(study: Path, dynamic: Path) -> tuple[Figure, str, str]:
    """Step: returns the figure, all numbers as CSV, and the main ones as Markdown."""
    return (draw_dynamic(study, dynamic), *comparison(study, dynamic))
