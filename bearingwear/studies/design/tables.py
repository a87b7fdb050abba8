"""Tables of the design study: what to choose as Markdown, the whole map as CSV."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.document.data import dataset_csv, flag_names
from bearingwear.document.markdown import markdown_table
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.plotting.drawing import in_words, methods, scene_of
from bearingwear.results.pair_variables import method_words
from bearingwear.results.quantiles import (
    ALL_BUT_WEAR,
    ALL_INPUTS,
    BEARINGS_BETWEEN,
    RECOMMENDED,
    causes_told,
    spread_at,
    spread_cells,
    spread_text,
    spreads_of,
)
from bearingwear.results.units import Rough, digits, display, in_print, key_in_words
from bearingwear.scene.scene import COUNTS, PARAMETERS
from bearingwear.scene.uncertain import Distribution, is_same_for_batch
from bearingwear.studies.dataset import counted
from bearingwear.studies.design.choice import ACTIVE, limits_of, preload_text
from bearingwear.studies.design.draw import design_files
from bearingwear.studies.design.figures import design_message
from bearingwear.studies.design.map import MAP_AXES, WORN_GROOVE
from bearingwear.studies.design.recommend import best_method
from bearingwear.studies.design.show import (
    ROOM_COLUMNS,
    ROOM_TOLD,
    flag_words,
    methods_told,
    quantities_told,
    room_rows,
    track_told,
)
from bearingwear.studies.design.uncertainty_figure import preload_drawn, quantities_of
from bearingwear.studies.design.words import (
    GROOVE_WORDS,
    HERTZIAN_LIFE_WORDS,
    LIMIT_WORDS,
    NONE_BECAUSE,
    limit_text,
    without_limits,
)


def tables(design: Path, recommendation: Path, uncertainty: Path | None = None) -> tuple[str, str]:
    """Step: the whole map as CSV, and what to choose as Markdown."""
    files = design_files(design, recommendation, uncertainty)
    summary = design_summary(files.design, files.recommendation, files.uncertainty)
    return map_csv(files.design), summary


def map_csv(design: xr.Dataset) -> str:
    """A row for each life and a column for each number, with its unit in the header."""
    heads = ("preload_method", "friction", "shaft_speed (rpm)", "preload (N)")
    return dataset_csv(design, dict(zip(MAP_AXES, heads, strict=True)))


def design_summary(
    design: xr.Dataset, recommendation: xr.Dataset, uncertainty: xr.Dataset | None
) -> str:
    """The recommended preloads, how sure their lives are, and what could not be solved."""
    scene = scene_of(design)
    given = limits_of(design).given
    limits = "; ".join(limit_text(name, value) for name, value in given.items())
    text = [
        f"# Which preload for {scene['name']}",
        f"{design_message(recommendation, uncertainty)}.{_both_ways(recommendation, uncertainty)}",
        f"At {scene['operation']['shaft_speed_rpm']:g} r/min and friction "
        f"{scene['friction']['ball_race']:g}. Limits, from new to the end of life: "
        f"{limits or 'none'}.",
        *_choice(recommendation),
        *none_because(recommendation),
        *_room(recommendation),
        *(_sampled(uncertainty, scene) if uncertainty is not None else ()),
        "## The map",
        *_statuses(design),
    ]
    return "\n\n".join(part for part in text if part) + "\n"


def _room(recommendation: xr.Dataset) -> list[str]:
    """How far an assumption may move before the other method is better."""
    rows = [
        [
            f"{one.label} ({in_print(one.unit)})" if one.unit else one.label,
            *map(digits, one.numbers),
        ]
        for one in room_rows(recommendation)
    ]
    if not rows:
        return []
    return [
        "## How far the choice holds",
        " ".join([ROOM_TOLD, *track_told(recommendation)]),
        markdown_table(" | ".join(("limit", *ROOM_COLUMNS)), rows),
    ]


def none_because(recommendation: xr.Dataset) -> list[str]:
    """Why no preload is recommended, a sentence for each method without one."""
    scene = scene_of(recommendation)
    because = recommendation.attrs.get(NONE_BECAUSE, "{}")
    if not limits_of(recommendation).given:
        return list(filter(None, without_limits(because)[1:]))
    return [
        f"No preload by {method_words(scene, method)} keeps to all limits: {why}."
        for method, why in json.loads(because).items()
    ]


def _sampled(uncertainty: xr.Dataset, scene: dict[str, Any]) -> list[str]:
    """How sure the lives are, and which uncertain value decides."""
    return [
        "## How sure the life is",
        f"{int(uncertainty.attrs['samples'])} base samples, seed {int(uncertainty.attrs['seed'])}. "
        "In brackets: confidence intervals.",
        *_quantiles(uncertainty),
        "## What decides",
        "Total Sobol index of log life: the share of its variance that goes with the value, its "
        "interactions counted. "
        + ("Preload as recommended; the distributions are stated in the scene."),
        *_indices(uncertainty, scene),
    ]


def _both_ways(recommendation: xr.Dataset, uncertainty: xr.Dataset | None) -> str:
    """The recommended life with its spread, by each way of counting wear."""
    k = best_method(recommendation)
    if k is None:
        return ""
    scene = scene_of(recommendation)
    method, one = methods(recommendation)[k]
    sampled = [] if uncertainty is None else [uncertainty]
    known = spreads_of(sampled, scene, method, scene["friction"]["ball_race"], RECOMMENDED)
    said = [
        f"{Rough(one['life'].isel(loss_basis=c)).text} h counting {in_words(way)}"
        + (f" ({spread_text((known or {}).get(way))})" if sampled else "")
        for c, way in sorted(enumerate(COUNTS), key=lambda pair: pair[0] != counted(recommendation))
    ]
    return f" Life: {'; '.join(said)}." + (f" {causes_told(scene)}" if sampled else "")


def _choice(recommendation: xr.Dataset) -> list[str]:
    basis = counted(recommendation)
    rows: dict[str, list[str]] = {}
    quantities = {
        name: (label, display(recommendation[name].attrs["units"], recommendation[name], shown=as_))
        for name, (label, as_) in quantities_told(recommendation).items()
    }
    grooves = flag_words(recommendation, "groove")
    for k, (_, one) in enumerate(methods(recommendation)):
        error = float(one["life_error_estimate"].isel(loss_basis=basis))
        known = f"{100 * error:.2g} %" if np.isfinite(error) else "–"
        cells = {
            "initial preload (N)": preload_text(one),
            "held by": LIMIT_WORDS[ACTIVE[int(one["active_limit"])]],
            **{
                f"life counting {in_words(COUNTS[c])} (h)": (
                    digits(float(one["life"].isel(loss_basis=c)))
                )
                for c in (basis, 1 - basis)
            },
            "groove of these numbers": GROOVE_WORDS[grooves[k]],
            **(_with_hertzian_groove(one, basis) if "worn" in grooves else {}),
            "estimated numerical error of the life": known,
            **{
                unit.label(label): unit.text(one[name])
                for name, (label, unit) in quantities.items()
            },
        }
        for label, cell in cells.items():
            rows.setdefault(label, []).append(cell)
    names = " | ".join(methods_told(recommendation))
    return [
        markdown_table(f"recommended | {names}", [[label, *cells] for label, cells in rows.items()])
    ]


def _with_hertzian_groove(one: xr.Dataset, basis: int) -> dict[str, str]:
    """The life beside that of a groove followed as it wears."""
    life = digits(float(one["hertzian_life"].isel(loss_basis=basis)))
    return {f"life {HERTZIAN_LIFE_WORDS}, at this preload (h)": life}


def _quantiles(uncertainty: xr.Dataset) -> list[str]:
    rows, found = [], []
    for name, of_method in methods(uncertainty):
        for choice, where in enumerate(flag_names(uncertainty["preload_choice"])):
            at_preload = of_method.isel(preload_choice=choice)
            for c, way in enumerate(COUNTS):
                one = at_preload.isel(loss_basis=c)
                rows.append([in_words(name), *_sampled_cells(one, where, way)])
                found.append(spread_at(one.sel(uncertain_inputs=ALL_INPUTS)))
    spreads = spread_cells(found)
    columns = [
        *("method", "preload", "counting", "nominal life (h)"),
        *(f"{BEARINGS_BETWEEN}, wear coefficient and hardness as stated (h)", "lives solved"),
    ]
    return [
        markdown_table(
            " | ".join([*columns[:4], *spreads, *columns[4:]]),
            [
                [*row[:4], *(cells[k] for cells in spreads.values()), *row[4:]]
                for k, row in enumerate(rows)
            ],
        ),
        causes_told(scene_of(uncertainty)),
        *_with_grooves(uncertainty),
    ]


def _with_grooves(uncertainty: xr.Dataset) -> list[str]:
    """How many lives follow their grooves, and how well the others are known."""
    followed, error = uncertainty["followed_lives"], uncertainty["groove_error"]
    if not bool((followed > 0).any()):
        return []
    return [
        f"Grooves are followed as they wear in {int(followed.sum())} of the sampled lives. The "
        "others are scaled by an interpolated ratio, with an rms error of at most "
        f"{100.0 * float(error.max()):.2g} % on lives left out of its fit."
    ]


def _sampled_cells(one: xr.Dataset, where: str, way: str) -> list[str]:
    """Of one method, preload and way of counting: all but the spread."""
    known = spread_at(one.sel(uncertain_inputs=ALL_BUT_WEAR))
    return [
        f"{where}, {digits(float(one['preload']))} N",
        in_words(way),
        Rough(one["nominal_life"]).text,
        known.bearings.text if known else "–",
        f"{100 * float(one['solved_share']):.4g} % of {int(one['evaluations'])}",
    ]


def _indices(uncertainty: xr.Dataset, scene: dict[str, Any]) -> list[str]:
    basis = counted(uncertainty)
    columns = [
        one.sel(preload_choice=preload_drawn(one)).isel(loss_basis=basis)
        for _, one in methods(uncertainty)
    ]
    rows = []
    for q, name in enumerate(quantities_of(uncertainty)):
        indices = [
            one.isel(quantity=q).sel(uncertain_inputs=inputs)
            for inputs in (ALL_INPUTS, ALL_BUT_WEAR)
            for one in columns
        ]
        cells = [
            f"{float(one['total_index']):.3f} ± {float(one['total_index_error']):.3f}"
            for one in indices
        ]
        given = scene["uncertainty"][name]
        of = "batch" if is_same_for_batch(name, Distribution(**given)) else "bearing"
        within = [f"{float(one['class_index'].isel(quantity=q)):.3f}" for one in columns]
        rows.append([key_in_words(name)[0], distribution_text(given), of, *within, *cells])
    names = [in_words(name) for name, _ in methods(uncertainty)]
    return [
        markdown_table(
            "value | distribution | differs from each to each | "
            + " | ".join(f"{name}, within its kind" for name in names)
            + " | "
            + " | ".join(names)
            + " | "
            + " | ".join(f"{name}, wear coefficient and hardness as stated" for name in names),
            rows,
        ),
        "A distribution without its own centre has the scene's value there. Of the base samples, "
        + ", ".join(
            f"{100 * float(one['index_share']):.4g} % ({name})"
            for one, name in zip(columns, names, strict=True)
        )
        + " could be used for the indices: all their lives solved, and longer than zero.",
    ]


def distribution_text(given: dict[str, Any]) -> str:
    """A distribution in words: `normal, standard deviation 0.35`."""
    needs, takes = PARAMETERS[given["distribution"]]
    parts = [f"{in_words(part)} {given[part]:g}" for part in (*takes, *needs) if part in given]
    return ", ".join([given["distribution"], *parts])


def _grooves_of(design: xr.Dataset) -> str:
    """Which grooves the lives of a map have."""
    worn = int((design["groove"] == WORN_GROOVE).sum())
    if not worn:
        return "All of them are of Hertzian grooves."
    return f"In {worn} of them the grooves are followed as they wear; the others are Hertzian."


def _statuses(design: xr.Dataset) -> list[str]:
    status = design["status"].values
    solves = int(design["solves"].sum())
    failed = int(design["failed_solves"].sum())
    count = np.bincount(status.ravel(), minlength=len(STATUS_NAMES))
    rows = [
        [in_words(STATUS_NAMES[k]), str(number)]
        for k, number in enumerate(count)
        if number or k == OK
    ]
    return [
        f"{status.size} lives over preload, method, friction and speed (in map.csv), made of "
        f"{solves} steady states, of which {failed} were not found. A life that was not solved "
        f"keeps its status and is never chosen. {_grooves_of(design)}",
        markdown_table("status of the life | lives", rows),
    ]
