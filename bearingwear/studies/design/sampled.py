"""Uncertainty of the lives at some preloads, and which uncertain value decides."""

from __future__ import annotations

import xarray as xr

from bearingwear.document.document import Block, Row
from bearingwear.document.study import rough_value, spread_rows
from bearingwear.document.table import flag_names
from bearingwear.results.pair_variables import method_words
from bearingwear.results.quantiles import (
    ALL_BUT_WEAR,
    ALL_INPUTS,
    BEARINGS_BETWEEN,
    available_preload_choice,
    causes_sentence,
    interval_of,
    quantities_of,
    spread_at,
)
from bearingwear.results.units import Rough, key_in_words, text_to_error
from bearingwear.results.words import methods, name_in_words, scene_of
from bearingwear.scene.scene import PARAMETERS
from bearingwear.scene.uncertain import Distribution, is_same_for_batch

INDEX_WORDS = (
    "Total Sobol index: the share of the variance in log life due to the uncertain value, "
    "including interactions. The recommended preload is used; the scene defines the distributions. "
    "If a distribution specifies no mean or median, the value in the scene is used."
)


def sampled_blocks(uncertainty: xr.Dataset) -> list[Block]:
    """Spread of the lives, and its main cause."""
    if not uncertainty.sizes["preload_method"]:  # no preload is recommended
        return []
    indices = [_indices(uncertainty)] if "total_index" in uncertainty else []
    return [_quantiles(uncertainty), *indices]


def _quantiles(uncertainty: xr.Dataset) -> Block:
    scene = scene_of(uncertainty)
    points = [
        (
            method_words(scene, name),
            where,
            of_method.isel(preload_choice=c),
        )
        for name, of_method in methods(uncertainty)
        for c, where in enumerate(flag_names(uncertainty["preload_choice"]))
    ]
    ones = [one for *_, one in points]
    found = [spread_at(one) for one in ones]
    stated = [interval_of(one, ALL_BUT_WEAR) if spread_at(one) else None for one in ones]
    labels = dict.fromkeys(label for one in found if one for label in one.errors)
    longest = tuple(one and one.longest for one in found)
    rows = [
        Row("method", "", tuple(name for name, *_ in points), "preload_method"),
        Row("preload", "", tuple(where for _, where, *_ in points), "preload_choice"),
        Row("preload", "N", tuple(float(one["preload"]) for one in ones), "preload"),
        Row("nominal life", "h", tuple(Rough(one["nominal_life"]) for one in ones), "nominal_life"),
        *spread_rows(found),
        *(
            Row(f"{label.strip()}, interval due to sampling", "h",
                tuple(one.errors.get(label, "") if one else "" for one in found))
            for label in labels
        ),
        Row(
            f"{BEARINGS_BETWEEN}, wear coefficient and hardness as stated", "h",
            tuple(rough_value(one) for one in stated), "life_wear_as_stated",
        ),
        *([Row("this method gives the longest life", "%", longest)] if any(longest) else []),
        Row("lives computed", "%", tuple(100.0 * float(one["solved_share"]) for one in ones)),
        Row("lives solved", "", tuple(int(one["evaluations"]) for one in ones), "evaluations"),
    ]  # fmt: skip
    said = (
        f"{int(uncertainty.attrs['samples'])} sampled bearings, random seed "
        f"{int(uncertainty.attrs['seed'])}. {causes_sentence(scene)}",
        *(
            f"{name}, {where} preload: {one.failures_sentence}"
            for (name, where, _), one in zip(points, found, strict=True)
            if one and one.failures
        ),
    )
    return Block("Uncertainty in life", rows=tuple(rows), axes=2, lines=said)


def _indices(uncertainty: xr.Dataset) -> Block:
    """A line for each uncertain value, and columns for each method."""
    names = quantities_of(uncertainty)
    given = scene_of(uncertainty)["uncertainty"]
    same = [is_same_for_batch(name, Distribution(**given[name])) for name in names]
    units = ["batch" if one else "bearing" for one in same]
    rows = [
        Row("value", "", tuple(key_in_words(name)[0] for name in names)),
        Row("distribution", "", tuple(distribution_text(given[name]) for name in names)),
        Row("varies", "", tuple(f"from {s} to {s}" for s in units)),
    ]
    used = []
    for method, of_method in methods(uncertainty):
        one = of_method.sel(preload_choice=available_preload_choice(of_method))
        words = method_words(scene_of(uncertainty), method)
        for inputs, more in ((ALL_INPUTS, ""), (ALL_BUT_WEAR, ", wear as stated")):
            indices = one.sel(uncertain_inputs=inputs)
            known = zip(
                indices["total_index"].values, indices["total_index_error"].values, strict=True
            )
            texts = tuple(f"{text_to_error(a, b)} ± {text_to_error(b, b)}" for a, b in known)
            rows.append(Row(f"{words}{more}", "", texts, f"total_index.{method}{more}"))
        used.append(f"{100 * float(one['index_share']):.4g} % ({words})")
    said = (
        INDEX_WORDS,
        "The indices are based only on base samples for which every life was computed and is above "
        f"zero: {', '.join(used)}.",
    )
    return Block("What determines the life", rows=tuple(rows), axes=1, lines=said)


def distribution_text(given: dict[str, float | str]) -> str:
    """A distribution in words: `normal, standard deviation 0.35`."""
    needs, takes = PARAMETERS[str(given["distribution"])]
    parts = [f"{name_in_words(part)} {given[part]:g}" for part in (*takes, *needs) if part in given]
    return ", ".join([str(given["distribution"]), *parts])
