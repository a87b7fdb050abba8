"""What following the grooves changes and costs: a part of docs/accuracy.md."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from bearingwear.lives.groove_life import REQUIRED
from bearingwear.results.units import Rough, digits, span
from workflow.studies.accuracy.checked_table import Agreement, CheckedTable, answers_agree_within
from workflow.studies.accuracy.gather import names, points_where
from workflow.studies.accuracy.plan import Plan, cell_sweeps, groove_sweeps

_RATIOS = {"life": "life", "end QV": "end_qv", "time": "life_processor_time"}
_ERRORS = {"life": "life", "end QV": "end_qv"}
_LEAST_ERROR = 0.01  # percent


def by_end(points: xr.Dataset, scene: str) -> Iterator[tuple[str, dict[str, xr.Dataset]]]:
    """Lives of a scene that end at the same loss: `hertz`, `worn` at each end."""
    here = points_where(points, scene=scene)
    ends = dict.fromkeys(label.partition(", ")[0] for label in here["label"].values)
    for end in ends:
        yield (
            end,
            {
                groove: points_where(here, label=f"{end}, {groove}").isel(point=0)
                for groove in ("hertz", "worn")
            },
        )


def groove_table(trade: xr.Dataset, plan: Plan, sweep: str) -> CheckedTable:
    """Worn grooves over Hertz' by the loss at the end."""
    points, rows = points_where(trade, sweep=sweep), []
    for scene in names(points, "scene"):
        for end, one in by_end(points, scene):
            life, qv, time = (
                float(one["worn"][name] / one["hertz"][name]) for name in _RATIOS.values()
            )
            followed = "yes" if float(one["worn"]["wear_over_gap"]) > REQUIRED else "no"
            row = [f"loss of {end} A a²", scene, life, qv, Rough(time), followed]
            rows.append(row)
    agreements = {name: Agreement() for name in _RATIOS} | {
        "time": Agreement(plan["tolerance"]["time"])
    }
    columns = agreements | {"worn profile": Agreement()}
    return CheckedTable(title=plan["sweeps"][sweep]["title"], columns=columns, rows=rows)


def against_finest(points: xr.Dataset) -> Iterator[tuple[str, xr.Dataset]]:
    """Settings and point of each life, its `error_*` and `faster` against the finest."""
    for scene in names(points, "scene"):
        here = points_where(points, scene=scene)
        first = here.isel(point=0)
        for k in range(here.sizes["point"]):
            point = here.isel(point=k)
            settings = str(point["label"].values)
            errors = {
                f"error_{name}": abs(point[name] / first[name] - 1.0) for name in ("life", "end_qv")
            }
            faster = first["life_processor_time"] / point["life_processor_time"]
            yield settings, point.assign(errors | {"faster": faster})


def cell_table(trade: xr.Dataset, plan: Plan, sweep: str) -> CheckedTable:
    """The worst error of all scenes, and the median of how much faster."""
    found: dict[str, list[xr.Dataset]] = {}
    for settings, point in against_finest(points_where(trade, sweep=sweep)):
        found.setdefault(settings, []).append(point)
    rows = []
    for settings, points in found.items():
        step, _, cells = settings.partition(", ")
        errors = [max(float(p[f"error_{n}"]) for p in points) for n in _ERRORS.values()]
        numbers = [*(100.0 * e for e in errors), np.median([float(p["faster"]) for p in points])]
        rows.append([f"{cells} cells, steps of {step}", *map(Rough, numbers)])
    agreement = Agreement(
        1.05 * plan["tolerance"]["error"], _LEAST_ERROR, "%"
    )  # and what digits round
    columns = dict.fromkeys(_ERRORS, agreement) | {
        "times as fast": Agreement(plan["tolerance"]["time"])
    }
    return CheckedTable(
        title=plan["sweeps"][sweep]["title"], axes=("case",), columns=columns, rows=rows
    )


def what_auto_saves(trade: xr.Dataset, plan: Plan) -> str:
    """What lives lose and save whose grooves `auto` does not follow."""
    errors, saved, lives = [], [], 0
    for sweep in groove_sweeps(plan):
        points = points_where(trade, sweep=sweep)
        for scene in names(points, "scene"):
            for _, one in by_end(points, scene):
                lives += 1
                if float(one["worn"]["wear_over_gap"]) > REQUIRED:
                    continue
                times = [float(one[of]["life_processor_time"]) for of in ("worn", "hertz")]
                saved.append(float(f"{times[0] / times[1]:.2g}"))
                errors.append(abs(float(one["hertz"]["life"] / one["worn"]["life"]) - 1.0))
    if not saved:
        return "`auto` selects worn grooves in all of these life calculations."
    return (
        f"In {len(saved)} of these {lives} life calculations, the loss at the end of life is below "
        f"{REQUIRED:g} times the gap, so `auto` selects Hertzian contact. This choice reduces the "
        f"computing time by a factor of {span(saved)}. The resulting lives differ from those "
        f"computed with worn grooves by up to {digits(100.0 * max(errors))} %."
    )


def grooves_part(trade: xr.Dataset, plan: Plan) -> list[str | CheckedTable]:
    """Lives by the loss that ends them, and by cells and steps."""
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
        f"{answers_agree_within()}, if an error differs by more than a factor of "
        f"{plan['tolerance']['error']:g}, or if a time differs by more than a factor of "
        f"{plan['tolerance']['time']:g}.",
        what_auto_saves(trade, plan),
        *(groove_table(trade, plan, sweep) for sweep in groove_sweeps(plan)),
        *(cell_table(trade, plan, sweep) for sweep in cell_sweeps(plan)),
    ]
