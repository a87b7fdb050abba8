"""Changes and costs of worn grooves in lives: a part of docs/accuracy.md."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import xarray as xr

from bearingwear.lives.groove_life import REQUIRED
from bearingwear.results.units import Rough, digits, span
from workflow.studies.accuracy.checked_table import (
    ROUNDED_DIGITS,
    Agreement,
    CheckedTable,
    answer_tolerance_text,
)
from workflow.studies.accuracy.gather import distinct_texts, points_where
from workflow.studies.accuracy.plan import Plan, cell_sweeps, groove_sweeps

_RATIOS = {"life": "life", "end QV": "end_qv", "time": "life_processor_time"}
_ERRORS = {"life": "life", "end QV": "end_qv"}
_LEAST_ERROR = 0.01  # percent


class TwoLives(NamedTuple):
    """Lives of a scene up to the same loss with Hertzian and with worn grooves."""

    end: str  # loss at the end over the gap at the edge of the contact, as a label has it
    hertz: xr.Dataset  # point of the study
    worn: xr.Dataset  # point of the study

    def ratio(self, name: str) -> float:
        """Returns a value with worn grooves over that with Hertzian ones."""
        return float(self.worn[name] / self.hertz[name])

    @property
    def needs_worn(self) -> bool:
        """Whether `auto` uses worn grooves: the loss exceeds `REQUIRED` times the gap."""
        return float(self.worn["wear_over_gap"]) > REQUIRED


def lives_by_loss(points: xr.Dataset, scene: str) -> Iterator[TwoLives]:
    """Yields the lives of a scene, with Hertzian and worn grooves, at each loss that ends them.

    points: of a sweep of `groove_sweeps`, with labels such as "0.5, worn".
    """
    scene_points = points_where(points, scene=scene)
    ends = dict.fromkeys(label.partition(", ")[0] for label in scene_points["label"].values)
    for end in ends:
        hertz = points_where(scene_points, label=f"{end}, hertz").isel(point=0)
        worn = points_where(scene_points, label=f"{end}, worn").isel(point=0)
        yield TwoLives(end, hertz, worn)


def groove_table(trade: xr.Dataset, plan: Plan, sweep: str) -> CheckedTable:
    """Returns a table of lives with worn grooves relative to Hertzian ones, by loss at the end.

    trade: all points of the study over `point`.
    plan: data of config/accuracy.yaml.
    sweep: one of `groove_sweeps`.
    """
    points = points_where(trade, sweep=sweep)
    rows = []
    for scene in distinct_texts(points, "scene"):
        for lives in lives_by_loss(points, scene):
            life, qv, time = map(lives.ratio, _RATIOS.values())
            uses_worn = "yes" if lives.needs_worn else "no"
            rows.append([f"loss of {lives.end} A a²", scene, life, qv, Rough(time), uses_worn])
    agreements = {name: Agreement() for name in _RATIOS} | {
        "time": Agreement(plan["tolerance"]["time"])
    }
    columns = agreements | {"worn profile": Agreement()}
    return CheckedTable(title=plan["sweeps"][sweep]["title"], columns=columns, rows=rows)


def errors_against_finest(points: xr.Dataset) -> Iterator[tuple[str, xr.Dataset]]:
    """Yields the settings of each life, and its point with variables against the finest one.

    These are the magnitudes of relative errors `error_life` and `error_end_qv`, and `faster`, the
    CPU time of the finest over its own. The settings are a label such as "0.25, 32 x 8": step over
    the gap, and cells. The finest point of each scene is among them.

    points: of a sweep of `cell_sweeps`, whose first point on each scene is the finest.
    """
    for scene in distinct_texts(points, "scene"):
        scene_points = points_where(points, scene=scene)
        finest = scene_points.isel(point=0)
        for k in range(scene_points.sizes["point"]):
            point = scene_points.isel(point=k)
            settings = str(point["label"].values)
            errors = {
                f"error_{name}": abs(point[name] / finest[name] - 1.0)
                for name in ("life", "end_qv")
            }
            faster = finest["life_processor_time"] / point["life_processor_time"]
            yield settings, point.assign(errors | {"faster": faster})


def cell_table(trade: xr.Dataset, plan: Plan, sweep: str) -> CheckedTable:
    """Returns a table of the largest errors [%] over the scenes, and of the median speed.

    It has a row for each choice of cells and steps in a sweep of `cell_sweeps`. Errors and speeds
    are relative to the finest choice.

    trade: all points of the study over `point`.
    plan: data of config/accuracy.yaml.
    """
    points_by_settings: dict[str, list[xr.Dataset]] = {}
    for settings, point in errors_against_finest(points_where(trade, sweep=sweep)):
        points_by_settings.setdefault(settings, []).append(point)
    rows = []
    for settings, points in points_by_settings.items():
        step, _, cells = settings.partition(", ")
        errors = [
            100.0 * max(float(point[f"error_{name}"]) for point in points)
            for name in _ERRORS.values()
        ]
        speed = np.median([float(point["faster"]) for point in points])
        rows.append([f"{cells} cells, steps of {step}", *map(Rough, [*errors, speed])])
    agreement = Agreement(ROUNDED_DIGITS * plan["tolerance"]["error"], _LEAST_ERROR, "%")
    columns = dict.fromkeys(_ERRORS, agreement) | {
        "times as fast": Agreement(plan["tolerance"]["time"])
    }
    return CheckedTable(
        title=plan["sweeps"][sweep]["title"], axes=("case",), columns=columns, rows=rows
    )


def auto_savings_sentence(trade: xr.Dataset, plan: Plan) -> str:
    """Returns sentences on the lives for which `auto` uses Hertzian contact: error, time saved.

    The error is the largest magnitude of Hertzian over worn life, less 1. Without such lives, a
    sentence says that `auto` uses worn grooves for all.

    trade: all points of the study over `point`.
    plan: data of config/accuracy.yaml.
    """
    errors, speedups = [], []
    count = 0
    for sweep in groove_sweeps(plan):
        points = points_where(trade, sweep=sweep)
        for scene in distinct_texts(points, "scene"):
            for lives in lives_by_loss(points, scene):
                count += 1
                if not lives.needs_worn:
                    speedups.append(float(f"{lives.ratio('life_processor_time'):.2g}"))
                    errors.append(abs(float(lives.hertz["life"] / lives.worn["life"]) - 1.0))
    if not speedups:
        return "`auto` selects worn grooves in all of these life calculations."
    return (
        f"In {len(speedups)} of these {count} life calculations, the loss at the end of life is "
        f"below {REQUIRED:g} times the gap, so `auto` selects Hertzian contact. This choice "
        f"reduces the computing time by a factor of {span(speedups)}. The resulting lives differ "
        f"from those computed with worn grooves by up to {digits(100.0 * max(errors))} %."
    )


def grooves_part(trade: xr.Dataset, plan: Plan) -> list[str | CheckedTable]:
    """Returns paragraphs, and tables of worn grooves by the loss at the end, and by cells.

    trade: all points of the study over `point`.
    plan: data of config/accuracy.yaml.
    """
    return [
        "Generated by `snakemake -j1 results/accuracy/effects.nc` and `make effects-docs`; do not "
        "edit. The life ends when the loss reaches the specified multiple of A a² (the gap between "
        "ball and groove at the edge of the unworn contact), or when the preload falls to 40 % of "
        "its initial value. The first two tables list values relative to those for Hertzian "
        'contact with the same criterion. The column "worn profile" states whether `auto` uses the '
        'worn profile. "End QV" is QV at the end of life. Times are CPU times of life calculations '
        "that include all error estimates. The last two tables list the largest errors over all "
        "scenes, relative to results with the finest cells and steps. These life calculations "
        "exclude error estimates, and step sizes are given as fractions of the gap. The study "
        "fails if a result differs from its value in these tables by more than "
        f"{answer_tolerance_text()}, if an error differs by more than a factor of "
        f"{plan['tolerance']['error']:g}, or if a time differs by more than a factor of "
        f"{plan['tolerance']['time']:g}.",
        auto_savings_sentence(trade, plan),
        *(groove_table(trade, plan, sweep) for sweep in groove_sweeps(plan)),
        *(cell_table(trade, plan, sweep) for sweep in cell_sweeps(plan)),
    ]
