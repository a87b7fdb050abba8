"""The report on cases that were solved with the dynamic model, for the workflow."""

from pathlib import Path

from bearingwear.plotting.drawing import Figure
from bearingwear.studies.grid.dynamic_tables import dynamic_comparison
from bearingwear.studies.grid.figures.draw import draw_dynamic


def dynamic_report(study: Path, dynamic: Path) -> tuple[Figure, str, str]:
    """Step: returns a figure of dynamic and steady cases, their numbers as CSV, and a summary.

    The summary is Markdown.

    study: file of steady cases, which contains every case of `dynamic`.
    """
    csv, markdown = dynamic_comparison(study, dynamic)
    return draw_dynamic(study, dynamic), csv, markdown
