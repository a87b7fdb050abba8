"""What the table of `cautions` says of a result, or of a scene before any solve."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from bearingwear.scene.scene import Scene
from bearingwear.sides import of_bearing
from bearingwear.solvers.effects.cautions import CAUTIONS, Caution, Finding
from bearingwear.solvers.effects.choice import Choice
from bearingwear.solvers.effects.evidence import Evidence, evidence_of

LARGEST_EXCESS = 1e6
"""Stands for a ratio whose denominator is zero."""


def warnings_of(
    scene: Scene, chosen: Choice, values: Mapping[str, Any] | None = None
) -> list[dict[str, Any]]:
    """Warnings of a solved case or life, or of a scene before any solve.

    Parameters
    ----------
    scene : Scene
    chosen : Choice
        The model that solves it.
    values : mapping, optional
        Of the result.

    Returns
    -------
    list of dict
        id, sentence, advice, whether it is `impractical` (`cautions.Caution`), and `excess`: how
        many times the value is the limit, None for a fact.
    """
    if len(scene.sides) > 1:
        return _of_both(scene, chosen, values or {})
    every = list(evidence_of(scene, chosen, values or {}))
    return [
        _said(caution, *max(findings, key=lambda finding: finding[0] or 0.0))
        for caution in CAUTIONS
        if (findings := list(_beyond(caution, every)))
    ]


def _of_both(scene: Scene, chosen: Choice, values: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Warnings of both bearings of a pair, each once, and which of them it is of."""
    said: dict[str, list[dict[str, Any]]] = {}
    for k, side in enumerate(scene.sides):
        for found in warnings_of(side, chosen, of_bearing(values, k) if values else None):
            said.setdefault(found["id"], []).append(found | {"bearing": k + 1})
    worst = []
    for both in said.values():
        found = max(both, key=lambda one: one["excess"] or 0.0)
        number, sentence = found.pop("bearing"), found["sentence"]
        if [one["sentence"] for one in both] != [sentence] * len(scene.sides):
            sentence = f"bearing {number}: {sentence}"
        worst.append(found | {"sentence": sentence})
    return worst


def _beyond(caution: Caution, every: Iterable[Evidence]) -> Iterator[Finding]:
    for e in every:
        with np.errstate(divide="ignore", invalid="ignore"):
            finding = caution.look(e)
        if finding is not None and (finding[0] is None or finding[0] > 1.0):
            yield finding


def _said(caution: Caution, excess: float | None, words: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "id": caution.id,
        "sentence": caution.sentence.format(**words),
        "advice": caution.advice.format(**words),
        "impractical": caution.impractical,
        "excess": None if excess is None else float(f"{min(excess, LARGEST_EXCESS):.3g}"),
    }
