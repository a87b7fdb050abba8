"""Tables of the design study: what to choose as Markdown, the whole map as CSV."""

from __future__ import annotations

import csv
import itertools
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.io.spread import RECOMMENDED, SPREAD_TEXT, spread_of, spread_text
from bearingwear.io.whole import whole_file, write_text
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.model.scene import COUNTS, PARAMETERS
from bearingwear.report.design import (
    GPA,
    LIMIT_WORDS,
    N_UM,
    message,
    quantities_of,
    where_drawn,
)
from bearingwear.report.drawing import in_words, methods, scene_of
from bearingwear.report.tables import markdown_table, meanings, text_of
from bearingwear.study.design import ACTIVE, best_method, counted, limits_of

AXES = ("preload_method", "friction", "shaft_speed", "preload")
LIMIT_TEXT = {
    "gyroscopic_slip_share": "gyroscopic slip share at most {:g} in any contact",
    "axial_stiffness_N_um": "axial stiffness at least {:g} N/µm",
    "maximum_pressure_GPa": "contact pressure at most {:g} GPa",
    "friction_power_W": "power of friction and drag at most {:g} W",
}


def write_map(design: xr.Dataset, path: str | Path) -> None:
    """Write a row for each life and a column for each number, with its unit in the header."""
    lives = design[[name for name in design.data_vars if "preload" in design[name].dims]]
    columns: dict[str, Any] = {}
    for name, variable in lives.data_vars.items():
        values = variable.transpose(*AXES, ...)
        unit = f" ({variable.attrs['units']})" if variable.attrs.get("units", "1") != "1" else ""
        flags = variable.attrs.get("flag_meanings", "").split() or None
        parts = {str(name): values.values}
        if "counts" in values.dims:
            parts = {f"{name}.{way}": values.values[..., k] for k, way in enumerate(COUNTS)}
        for header, numbers in parts.items():
            columns[header + unit] = [text_of(x, flags) for x in numbers.ravel()]
    axes: list[list[str]] = [
        meanings(design["preload_method"]),
        *([f"{x:g}" for x in design[axis].values] for axis in AXES[1:]),
    ]
    with whole_file(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow([AXES[0], AXES[1], "shaft_speed (rpm)", "preload (N)", *columns])
        for point, row in zip(
            itertools.product(*axes), zip(*columns.values(), strict=True), strict=True
        ):
            table.writerow([*point, *row])


def write_design(
    design: xr.Dataset, recommendation: xr.Dataset, uncertainty: xr.Dataset, path: str | Path
) -> None:
    """Write the recommended preloads, how sure their lives are, and what could not be solved."""
    scene = scene_of(design)
    given = limits_of(design).given
    limits = "; ".join(LIMIT_TEXT[name].format(value) for name, value in given.items())
    text = [
        f"# Which preload for {scene['name']}",
        f"{message(recommendation, uncertainty)}.{_both_ways(recommendation, uncertainty)}",
        f"At {scene['operation']['shaft_speed_rpm']:g} r/min and friction "
        f"{scene['friction']['ball_race']:g}. Limits, from new to the end of life: "
        f"{limits or 'none'}.",
        *_choice(recommendation),
        "## How sure the life is",
        f"{int(uncertainty.attrs['samples'])} base samples, seed {int(uncertainty.attrs['seed'])}. "
        "In brackets: confidence intervals.",
        *_spread(uncertainty),
        "## What decides",
        "Total Sobol index of log life: the share of its variance that goes with the value, its "
        "interactions counted. "
        + ("Preload as recommended; the distributions are stated in the scene."),
        *_indices(uncertainty, scene),
        "## The map",
        *_statuses(design),
    ]
    write_text(path, "\n\n".join(part for part in text if part) + "\n")


def _both_ways(recommendation: xr.Dataset, uncertainty: xr.Dataset) -> str:
    """The recommended life with its spread, by each way of counting wear."""
    k = best_method(recommendation)
    if k is None:
        return ""
    one, scene = recommendation.isel(preload_method=k), scene_of(recommendation)
    method = methods(recommendation)[k][0]
    spread = spread_of([uncertainty], scene, method, scene["friction"]["ball_race"], RECOMMENDED)
    said = [
        f"{float(one['life'].isel(counts=c)):.4g} h counting {in_words(way)} "
        f"({spread_text((spread or {}).get(way, ()))})"
        for c, way in sorted(enumerate(COUNTS), key=lambda pair: pair[0] != counted(recommendation))
    ]
    return f" Life: {'; '.join(said)}. {SPREAD_TEXT}"


def _choice(recommendation: xr.Dataset) -> list[str]:
    counts = counted(recommendation)
    rows: dict[str, list[str]] = {}
    for _, one in methods(recommendation):
        cells = {
            "preload (N)": f"{float(one['preload']):.3f}",
            "held by": LIMIT_WORDS[ACTIVE[int(one["active_limit"])]],
            **{
                f"life counting {in_words(COUNTS[k])} (h)": f"{float(one['life'][k]):.4g}"
                for k in (counts, 1 - counts)
            },
            "estimated numerical error of the life": (
                f"{100 * float(one['life_error_estimate'][counts]):.2g} %"
            ),
            "largest gyroscopic slip share": f"{float(one['gyroscopic_slip_share']):.3f}",
            "least stiffness (N/µm)": f"{N_UM * float(one['axial_stiffness']):.3f}",
            "largest pressure (GPa)": f"{GPA * float(one['maximum_pressure']):.3f}",
            "largest friction power (W)": f"{float(one['friction_power']):.4f}",
            "preload left at the end (N)": f"{float(one['residual_preload_at_end']):.3f}",
        }
        for label, cell in cells.items():
            rows.setdefault(label, []).append(cell)
    names = " | ".join(in_words(name) for name, _ in methods(recommendation))
    return [
        markdown_table(f"recommended | {names}", [[label, *cells] for label, cells in rows.items()])
    ]


def _spread(uncertainty: xr.Dataset) -> list[str]:
    rows = []
    for name, one in methods(uncertainty):
        for k, where in enumerate(meanings(uncertainty["at"])):
            at = one.isel(at=k)
            for c, way in enumerate(COUNTS):
                of = at.isel(counts=c, of=0)
                cells = [
                    f"{float(of['life_quantile'][p]):.3g} "
                    f"[{float(of['life_quantile_low'][p]):.3g}, "
                    f"{float(of['life_quantile_high'][p]):.3g}]"
                    for p in range(uncertainty.sizes["probability"])
                ]
                known = at.isel(counts=c, of=1)["life_quantile"].values
                rows.append(
                    [
                        in_words(name),
                        f"{where}, {float(at['preload']):.3g} N",
                        in_words(way),
                        f"{float(of['nominal_life']):.4g}",
                        *cells,
                        f"{known[0]:.3g} to {known[-1]:.3g}",
                        f"{100 * float(at['solved_share']):.4g} % of {int(at['evaluations'])}",
                    ]
                )
    return [
        markdown_table(
            "method | preload | counting | nominal life (h) | L10 (h) | L50 (h) | L90 (h) | "
            "L10 to L90, wear coefficient and hardness as stated (h) | lives solved",
            rows,
        )
    ]


def _indices(uncertainty: xr.Dataset, scene: dict[str, Any]) -> list[str]:
    counts = counted(uncertainty)
    rows = []
    columns = [one.isel(at=where_drawn(one), counts=counts) for _, one in methods(uncertainty)]
    for q, name in enumerate(quantities_of(uncertainty)):
        cells = [
            f"{float(one['total_index'][k, q]):.3f} ± {float(one['total_index_error'][k, q]):.3f}"
            for k in (0, 1)
            for one in columns
        ]
        rows.append([f"`{name}`", distribution(scene["uncertainty"][name]), *cells])
    names = [in_words(name) for name, _ in methods(uncertainty)]
    return [
        markdown_table(
            "value | distribution | "
            + " | ".join(names)
            + " | "
            + " | ".join(f"{name}, wear coefficient and hardness as stated" for name in names),
            rows,
        ),
        "Distributions without a middle have the scene's own value for it. Of the base samples, "
        + ", ".join(
            f"{100 * float(one['index_share']):.4g} % ({name})"
            for one, name in zip(columns, names, strict=True)
        )
        + " could be used for the indices: all their lives solved, and longer than zero.",
    ]


def distribution(given: dict[str, Any]) -> str:
    """A distribution in words: `normal, standard deviation 0.35`."""
    needs, takes = PARAMETERS[given["distribution"]]
    parts = [f"{in_words(part)} {given[part]:g}" for part in (*takes, *needs) if part in given]
    return ", ".join([given["distribution"], *parts])


def _statuses(design: xr.Dataset) -> list[str]:
    status = design["status"].values
    solves = int(design["solves"].sum())
    failed = int(design["failed_solves"].sum())
    count = np.bincount(status.ravel(), minlength=len(STATUS_NAMES))
    rows = [[STATUS_NAMES[k], str(number)] for k, number in enumerate(count) if number or k == OK]
    return [
        f"{status.size} lives over preload, method, friction and speed (`map.csv`), made of "
        f"{solves} steady states, of which {failed} were not found. A life that was not solved "
        "keeps its status and is never chosen.",
        markdown_table("status of the life | lives", rows),
    ]
