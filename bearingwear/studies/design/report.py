"""Figure, tables and page of a recommended preload, for the workflow."""

from __future__ import annotations

from pathlib import Path

from bearingwear.plotting.drawing import Figure
from bearingwear.studies.design.document.charts import design_charts
from bearingwear.studies.design.document.sheets import design_answer, tables
from bearingwear.studies.design.figures.draw import draw_design


def preload_report(
    design: Path,
    recommendation: Path,
    uncertainty: Path | None = None,
    spread: Path | None = None,
) -> tuple[Figure, str, str, str, str]:
    """Step: returns the figure, map as CSV, table as Markdown, answer as JSON and charts as JSON.

    design, recommendation: files of a map and of its recommendation.
    uncertainty: file of the study of uncertainty.
    spread: file of quantiles of lives at the recommended preloads, in place of `uncertainty`; the
        figure and the tables do not use it.
    """
    csv, markdown = tables(design, recommendation, uncertainty)
    return (
        draw_design(design, recommendation, uncertainty),
        csv,
        markdown,
        design_answer(design, recommendation, uncertainty, spread),
        design_charts(design, recommendation, uncertainty, spread),
    )
