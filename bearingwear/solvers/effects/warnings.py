"""Warnings of a result, or of a scene before any solve, from the table of effects."""

import re
import string
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from bearingwear.measures import plain
from bearingwear.scene.scene import Scene
from bearingwear.sides import of_bearing
from bearingwear.solvers.effects.choice import Choice
from bearingwear.solvers.effects.evidence import Evidence, Finding, evidence_of
from bearingwear.solvers.effects.table import WARNINGS, Effect


class _Sentences(string.Formatter):
    """Sentences whose numbers have no powers of ten."""

    def format_field(self, value: Any, format_spec: str) -> str:
        if (match := re.fullmatch(r"(\+?)\.(\d)g", format_spec)) is None:
            return str(super().format_field(value, format_spec))
        return plain(value, int(match[2]), match[1])


_SENTENCES = _Sentences()

LARGEST_EXCESS = 1e6
"""Stands for a ratio whose denominator is zero."""


def warnings_of(
    scene: Scene, chosen: Choice, values: Mapping[str, Any] | None = None
) -> list[dict[str, Any]]:
    """Warnings of a solved case or life, by its values, or of a scene before any solve.

    Each has id, sentence, advice, whether it is `impractical` (`table.Effect`), and `excess`: how
    many times the value is the limit, None for a fact.
    """
    if len(scene.sides) > 1:
        return _of_both(scene, chosen, values or {})
    every = list(evidence_of(scene, chosen, values or {}))
    with np.errstate(divide="ignore", invalid="ignore"):
        return [
            _said(effect, *max(found, key=lambda one: one[0] or 0.0))
            for effect in WARNINGS
            if (found := list(_beyond(effect, every)))
        ]


def _of_both(scene: Scene, chosen: Choice, values: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Warnings of both bearings of a pair, each once, and which of them it is of."""
    said: dict[str, list[dict[str, Any]]] = {}
    for k, side in enumerate(scene.sides):
        for found in warnings_of(side, chosen, of_bearing(values, k) if values else None):
            said.setdefault(found["id"], []).append(found | {"bearing": k + 1})
    worst = []
    for findings in said.values():
        found = max(findings, key=lambda one: one["excess"] or 0.0)
        number, sentence = found.pop("bearing"), found["sentence"]
        if [one["sentence"] for one in findings] != [sentence] * len(scene.sides):
            sentence = f"bearing {number}: {sentence}"
        worst.append(found | {"sentence": sentence})
    return worst


def _beyond(effect: Effect, every: Iterable[Evidence]) -> Iterator[tuple[float | None, Finding]]:
    """What is to be warned of, and the value over its limit, None of a fact."""
    for e in every:
        found = effect.size(e)
        if found is None:
            continue
        excess = found.get("excess")
        if excess is None and "limit" in found:
            excess = found["value"] / found["limit"]
        if excess is None or excess > 1.0:
            yield excess, found


def _said(effect: Effect, excess: float | None, found: Finding) -> dict[str, Any]:
    return {
        "id": effect.id,
        "sentence": _SENTENCES.format(effect.sentence, **found),
        "advice": _SENTENCES.format(effect.advice, **found),
        "impractical": effect.impractical,
        "excess": None if excess is None else float(f"{min(excess, LARGEST_EXCESS):.3g}"),
    }
