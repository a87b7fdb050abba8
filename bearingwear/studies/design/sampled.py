"""Uncertainty of the lives at some preloads, and which uncertain value decides."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import xarray as xr

from bearingwear.document.document import Block, Row
from bearingwear.document.study import rough_value, spread_rows
from bearingwear.document.table import flag_names
from bearingwear.results.pair_variables import method_words
from bearingwear.results.quantiles import (
    ALL_BUT_WEAR,
    ALL_INPUTS,
    BEARINGS_BETWEEN,
    Spread,
    available_preload_choice,
    causes_sentence,
    interval_of,
    quantities_of,
    spread_at,
)
from bearingwear.results.units import key_in_words, text_to_error
from bearingwear.results.words import methods, name_in_words, plain_scene
from bearingwear.scene.scene import PARAMETERS
from bearingwear.scene.uncertain import Distribution, is_same_for_batch

INDEX_WORDS = (
    "Total Sobol index: the share of the variance in log life due to the uncertain value, "
    "including interactions. The recommended preload is used; the scene defines the distributions. "
    "If a distribution specifies no mean or median, the value in the scene is used."
)


class _SampledPreload(NamedTuple):
    """Lives of one method that were sampled at one preload."""

    method_words: str
    preload_words: str  # name of the choice of preload
    lives: xr.Dataset
    spread: Spread | None  # None without a life


def sampled_blocks(uncertainty: xr.Dataset) -> list[Block]:
    """Returns a table of the quantiles of lives and, if computed, one of their Sobol indices.

    The list is empty where no preload is recommended.

    uncertainty: dataset of the study of uncertainty.
    """
    if not uncertainty.sizes["preload_method"]:
        return []
    blocks = [_quantile_block(uncertainty)]
    if "total_index" in uncertainty:
        blocks.append(_index_block(uncertainty))
    return blocks


def _quantile_block(uncertainty: xr.Dataset) -> Block:
    """Returns a table of quantiles of lives, with a column for each method and preload."""
    points = _sampled_preloads(uncertainty)
    sentences = (
        f"{int(uncertainty.attrs['samples'])} sampled bearings, random seed "
        f"{int(uncertainty.attrs['seed'])}. {causes_sentence(plain_scene(uncertainty))}",
        *(
            f"{point.method_words}, {point.preload_words} preload: {point.spread.failures_sentence}"
            for point in points
            if point.spread and point.spread.failures
        ),
    )
    return Block("Uncertainty in life", rows=_quantile_rows(points), axes=2, lines=sentences)


def _sampled_preloads(uncertainty: xr.Dataset) -> list[_SampledPreload]:
    """Returns the lives at each preload, by methods and then by choices of preload."""
    scene = plain_scene(uncertainty)
    points = []
    for method, method_lives in methods(uncertainty):
        for k, preload_words in enumerate(flag_names(uncertainty["preload_choice"])):
            lives = method_lives.isel(preload_choice=k)
            words = method_words(scene, method)
            points.append(_SampledPreload(words, preload_words, lives, spread_at(lives)))
    return points


def _quantile_rows(points: Sequence[_SampledPreload]) -> tuple[Row, ...]:
    """Returns the rows of a table of quantiles of lives, with a value for each preload.

    points: lives at each preload.
    """
    spreads = [point.spread for point in points]
    wear_as_stated = tuple(
        rough_value(interval_of(point.lives, ALL_BUT_WEAR) if point.spread else None)
        for point in points
    )
    longest = tuple(spread.longest if spread else None for spread in spreads)
    error_labels = dict.fromkeys(label for spread in spreads if spread for label in spread.errors)
    return (
        Row("method", "", tuple(point.method_words for point in points), "preload_method"),
        Row("preload", "", tuple(point.preload_words for point in points), "preload_choice"),
        Row("preload", "N", _floats(points, "preload"), "preload"),
        Row("life with median values", "h", _floats(points, "nominal_life"), "nominal_life"),
        *spread_rows(spreads),
        *(
            Row(f"{label.strip()}, interval due to sampling", "h",
                tuple(spread.errors.get(label, "") if spread else "" for spread in spreads))
            for label in error_labels
        ),
        Row(
            f"{BEARINGS_BETWEEN}, wear coefficient and hardness as stated", "h",
            wear_as_stated, "life_wear_as_stated",
        ),
        *([Row("this method gives the longest life", "%", longest)] if any(longest) else []),
        Row("lives computed", "%", tuple(100.0 * x for x in _floats(points, "solved_share"))),
        Row("lives solved", "", tuple(map(int, _floats(points, "evaluations"))), "evaluations"),
    )  # fmt: skip


def _floats(points: Sequence[_SampledPreload], name: str) -> tuple[float, ...]:
    """Returns a value of the lives at each preload, in the unit of the file.

    points: lives at each preload.
    name: of the variable with the value, which has no dimensions.
    """
    return tuple(float(point.lives[name]) for point in points)


def _index_block(uncertainty: xr.Dataset) -> Block:
    """Returns a table of total Sobol indices, with a line for each uncertain value.

    Each method has a column with all values uncertain, and one with wear as stated.
    """
    scene = plain_scene(uncertainty)
    names = quantities_of(uncertainty)
    distributions = [scene["uncertainty"][name] for name in names]
    units = [
        "batch" if is_same_for_batch(name, Distribution(**distribution)) else "bearing"
        for name, distribution in zip(names, distributions, strict=True)
    ]
    rows = [
        Row("value", "", tuple(key_in_words(name)[0] for name in names)),
        Row("distribution", "", tuple(map(distribution_text, distributions))),
        Row("varies", "", tuple(f"from {unit} to {unit}" for unit in units)),
    ]
    shares_used = []
    for method, method_lives in methods(uncertainty):
        lives = method_lives.sel(preload_choice=available_preload_choice(method_lives))
        words = method_words(scene, method)
        for inputs, suffix in ((ALL_INPUTS, ""), (ALL_BUT_WEAR, ", wear as stated")):
            indices = lives.sel(uncertain_inputs=inputs)
            values = indices["total_index"].values
            errors = indices["total_index_error"].values
            texts = tuple(
                f"{text_to_error(value, error)} ± {text_to_error(error, error)}"
                for value, error in zip(values, errors, strict=True)
            )
            rows.append(Row(f"{words}{suffix}", "", texts, f"total_index.{method}{suffix}"))
        shares_used.append(f"{100 * float(lives['index_share']):.4g} % ({words})")
    sentences = (
        INDEX_WORDS,
        "The indices are based only on base samples for which every life was computed and is above "
        f"zero: {', '.join(shares_used)}.",
    )
    return Block("What determines the life", rows=tuple(rows), axes=1, lines=sentences)


def distribution_text(distribution: dict[str, float | str]) -> str:
    """Returns a distribution in words, such as "normal, standard deviation 0.35".

    distribution: plain data of a scene: the key `distribution` has its kind, others its parameters.
    """
    kind = str(distribution["distribution"])
    required, optional = PARAMETERS[kind]
    parts = [
        f"{name_in_words(name)} {distribution[name]:g}"
        for name in (*optional, *required)
        if name in distribution
    ]
    return ", ".join([kind, *parts])
