"""Warnings of a result, or of a scene before any solve, from the table of effects."""

import re
import string
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from bearingwear.measures import plain
from bearingwear.scene.scene import Scene
from bearingwear.sides import values_of_bearing
from bearingwear.solvers.effects.choice import Choice
from bearingwear.solvers.effects.evidence import Evidence, Finding, evidence_of
from bearingwear.solvers.effects.table import WARNINGS, Effect


class _Sentences(string.Formatter):
    """Sentences whose numbers have no powers of ten."""

    def format_field(self, value: Any, format_spec: str) -> str:
        """Returns a value in words; a number of significant digits by `plain`."""
        match = re.fullmatch(r"(\+?)\.(\d)g", format_spec)
        if match is None:
            return str(super().format_field(value, format_spec))
        return plain(value, int(match[2]), match[1])


_SENTENCES = _Sentences()


class _RatedFinding(NamedTuple):
    """A finding beyond its limit."""

    excess: float | None  # value over limit; None for a fact
    finding: Finding


LARGEST_EXCESS = 1e6
"""Excess that represents a ratio whose denominator is zero."""


def warnings_of(
    scene: Scene, chosen: Choice, values: Mapping[str, Any] | None = None
) -> list[dict[str, Any]]:
    """Returns the warnings of a solved case or life, or of a scene before any solve.

    Each has id, sentence, advice, whether it is `impractical` (`table.Effect`), and `excess`: the
    ratio of value to limit, None for a fact.

    values: result variables of the case or life; None before a solve.
    """
    if len(scene.sides) > 1:
        return _pair_warnings(scene, chosen, values or {})
    states = list(evidence_of(scene, chosen, values or {}))
    warnings = []
    with np.errstate(divide="ignore", invalid="ignore"):
        for effect in WARNINGS:
            findings = list(_findings(effect, states))
            if findings:
                warnings.append(_warning(effect, max(findings, key=lambda f: f.excess or 0.0)))
    return warnings


def _pair_warnings(scene: Scene, chosen: Choice, values: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Returns the warnings of both bearings of a pair, each once.

    The sentence is that of the worse bearing, which it names unless both have the same sentence.
    """
    by_id: dict[str, list[dict[str, Any]]] = {}
    for k, side in enumerate(scene.sides):
        for warning in warnings_of(side, chosen, values_of_bearing(values, k) if values else None):
            by_id.setdefault(warning["id"], []).append(warning | {"bearing": k + 1})
    worst_warnings = []
    for warnings in by_id.values():
        worst = max(warnings, key=lambda warning: warning["excess"] or 0.0)
        number = worst.pop("bearing")
        sentence = worst["sentence"]
        if [warning["sentence"] for warning in warnings] != [sentence] * len(scene.sides):
            sentence = f"bearing {number}: {sentence}"
        worst_warnings.append(worst | {"sentence": sentence})
    return worst_warnings


def _findings(effect: Effect, states: Iterable[Evidence]) -> Iterator[_RatedFinding]:
    """Yields the findings of an effect that are beyond their limit, and those that are facts."""
    for evidence in states:
        finding = effect.size(evidence)
        if finding is None:
            continue
        excess = finding.get("excess")
        if excess is None and "limit" in finding:
            excess = finding["value"] / finding["limit"]
        if excess is None or excess > 1.0:
            yield _RatedFinding(excess, finding)


def _warning(effect: Effect, rated: _RatedFinding) -> dict[str, Any]:
    """Returns a warning of an effect with its sentences; the keys are those of `warnings_of`."""
    excess, finding = rated
    return {
        "id": effect.id,
        "sentence": _SENTENCES.format(effect.sentence, **finding),
        "advice": _SENTENCES.format(effect.advice, **finding),
        "impractical": effect.impractical,
        "excess": None if excess is None else float(f"{min(excess, LARGEST_EXCESS):.3g}"),
    }
