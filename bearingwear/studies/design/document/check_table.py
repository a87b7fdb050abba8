"""Table of a recommended preload by the steady and the dynamic model."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.document.document import Block, Document, Row
from bearingwear.document.markdown import as_markdown
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.measures import plain
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.results.units import Display, Rough, digits, display
from bearingwear.results.variables import CASE
from bearingwear.results.words import name_in_words, plain_scene
from bearingwear.studies.design.choice import limits_of
from bearingwear.studies.design.plan import CHECKED_FIDELITIES
from bearingwear.studies.design.recommend import RECOMMENDATION

LOSS_RATE = display("m s-1", shown="um/1000 h")
SHARE_LABEL = "maximum gyroscopic slip share"
WITHOUT_CAGE = "The scene has no cage."
WITH_CAGE = (
    "Only the dynamic cases include the cage, whose pockets slow and wear the balls. This "
    "increases the wear depth, especially if wear.counts is ball."
)


@dataclass(frozen=True, kw_only=True)
class ComparedNumber:
    """A number by both models."""

    preload: float  # [N]
    name: str  # with the unit
    steady: float
    dynamic: float
    # sum of both relative estimates of the numerical error; NaN without an estimate
    errors: float = np.nan

    @property
    def difference(self) -> float:
        """Returns the relative difference of the dynamic value from the steady one."""
        return self.dynamic / self.steady - 1.0

    @property
    def exceeds_errors(self) -> bool:
        """Returns whether the models differ by more than the sum of the error estimates."""
        return abs(self.difference) > self.errors


@dataclass(frozen=True, kw_only=True)
class CheckedPreload:
    """A preload by both models."""

    preload: float  # [N]
    numbers: list[ComparedNumber]  # none where a model has no answer
    settled: str  # how far the dynamic means have settled, in words
    status: dict[str, str]  # names of statuses, by fidelity


def check_table(recommendation: Path, cases: Sequence[Path]) -> str:
    """Step: returns a table of steady and dynamic numbers at some preloads, as Markdown.

    recommendation: file for the scene of the cases.
    cases: files, a steady and a dynamic case at each preload.
    """
    recommended = load(recommendation)
    cases_by_preload = _cases_by_preload(recommended, cases)
    points = [
        _checked_preload(preload, cases_by_fidelity)
        for preload, cases_by_fidelity in sorted(cases_by_preload.items())
    ]
    steady_case = next(iter(cases_by_preload.values()))["steady"]
    limit = limits_of(recommended).gyroscopic_slip_share
    drifts = tuple(f"{digits(point.preload)} N: {point.settled}" for point in points)
    document = Document(
        (
            f"Dynamic model at the recommended preload of {plain_scene(recommended)['name']}",
            agreement(points),
            _explanation(recommended, plain_scene(steady_case)),
        ),
        blocks=(_numbers_block(points, limit), Block("Drift of the means", lines=drifts)),
    )
    return as_markdown(document)


def _explanation(recommendation: xr.Dataset, case_scene: Mapping[str, Any]) -> str:
    """Returns sentences on the operation to which the numbers apply, and what agreement means.

    case_scene: plain data of the scene of a case.
    """
    scene = plain_scene(recommendation)
    method = name_in_words(case_scene["operation"]["preload_method"])
    has_preload = np.isfinite(recommendation["preload"].values).any()
    middle = "the recommended preload" if has_preload else "the scene's preload (no recommendation)"
    operation = scene["operation"]
    friction = scene["friction"]["ball_race"]
    cage_sentences = WITH_CAGE if "cage" in case_scene else WITHOUT_CAGE
    return (
        f"The values apply to a new bearing ({method}, {operation['shaft_speed_rpm']:g} r/min, "
        f"friction coefficient {friction:g}) at and near {middle}. The wear life is based on the "
        f"wear of the {name_in_words(scene['wear']['counts'])}. {cage_sentences} Each "
        "dynamic run starts from the steady state. Agreement therefore means that the motion "
        "remains in that state, not that every initial state leads to it. The gyroscopic slip "
        "share has no error estimate."
    )


def _numbers_block(points: Sequence[CheckedPreload], limit: float | None) -> Block:
    """Returns a table with a line for each number by both models.

    A preload that was not solved has a line with its statuses.

    points: at all checked preloads.
    limit: of the gyroscopic slip share; None without one.
    """
    lines: list[tuple[Any, ...]] = []
    for point in points:
        if not point.numbers:
            states = (name_in_words(point.status[name]) for name in CHECKED_FIDELITIES)
            lines.append((point.preload, "not solved", *states, math.nan, math.nan, "–"))
        for number in point.numbers:
            errors = Rough(100.0 * number.errors)
            values = (number.steady, number.dynamic, 100.0 * number.difference, errors)
            lines.append((point.preload, number.name, *values, _verdict(number, limit)))
    heads = (
        ("preload", "N"),
        ("quantity", ""),
        ("steady, as in the map", ""),
        ("dynamic", ""),
        ("difference", "%"),
        ("sum of error estimates", "%"),
        ("difference exceeds estimates", ""),
    )
    columns = zip(*lines, strict=True)
    rows = (Row(label, unit, column) for (label, unit), column in zip(heads, columns, strict=True))
    return Block(rows=tuple(rows), axes=2)


def _verdict(number: ComparedNumber, limit: float | None) -> str:
    """Returns "yes" if the difference exceeds the errors, "no" if not, a dash if these are unknown.

    For the slip share, if it has a limit, the words say how many models violate this.

    limit: of the gyroscopic slip share; None without one.
    """
    if number.name == SHARE_LABEL and limit is not None:
        violations = sum(not share <= limit for share in (number.steady, number.dynamic))
        words = ("both satisfy", "one violates", "both violate")
        return f"{words[violations]} the requirement of {limit:g}"
    if not np.isfinite(number.errors):
        return "–"
    return "yes" if number.exceeds_errors else "no"


def _cases_by_preload(
    recommendation: xr.Dataset, paths: Sequence[str | Path]
) -> dict[float, dict[str, xr.Dataset]]:
    """Returns the steady and the dynamic case at each preload [N], by preload and fidelity.

    paths: of the files of the cases.

    CaseFileError: no recommendation, a file of another scene or kind, or a missing case.
    """
    if recommendation.attrs.get("kind") != RECOMMENDATION:
        raise CaseFileError("got no recommendation, expected recommendation.nc of a design study")
    name = plain_scene(recommendation)["name"]
    cases: dict[float, dict[str, xr.Dataset]] = {}
    for path in paths:
        case = load(path)
        fidelity = case.attrs.get("fidelity")
        if fidelity not in CHECKED_FIDELITIES or "total_qv" not in case or case["status"].ndim:
            raise CaseFileError(
                f"{path}: got a file of another kind, expected a steady or dynamic case"
            )
        scene = plain_scene(case)
        if scene["name"] != name:
            raise CaseFileError(f"{path}: got the scene {scene['name']}, expected {name}")
        cases.setdefault(scene["operation"]["preload_N"], {})[str(fidelity)] = case
    for preload, cases_by_fidelity in cases.items():
        for fidelity in CHECKED_FIDELITIES:
            if fidelity not in cases_by_fidelity:
                raise CaseFileError(f"preload {preload:g} N: got no {fidelity} case")
    return cases


def _checked_preload(preload: float, cases: Mapping[str, xr.Dataset]) -> CheckedPreload:
    """Returns the numbers of both models at a preload [N], and their statuses.

    cases: the case by each model, with the keys `steady` and `dynamic`.
    """
    steady, dynamic = cases["steady"], cases["dynamic"]
    status = {fidelity: STATUS_NAMES[int(case["status"])] for fidelity, case in cases.items()}
    is_solved = set(status.values()) == {STATUS_NAMES[OK]}
    return CheckedPreload(
        preload=preload,
        numbers=_compared_numbers(preload, steady, dynamic) if is_solved else [],
        settled=str(dynamic.attrs.get("settled", "–")),
        status=status,
    )


def _compared_numbers(
    preload: float, steady: xr.Dataset, dynamic: xr.Dataset
) -> list[ComparedNumber]:
    """Returns QV, wear rate and slip share of a case by both models.

    steady, dynamic: solved cases of a new bearing at the preload [N].
    """

    def compared(label: str, variable: str, error: str, unit: Display) -> ComparedNumber:
        """Returns a variable by both models, with the sum of their relative error estimates."""
        cases = steady, dynamic
        errors = (float(case[error]) if error in case else np.nan for case in cases)
        return ComparedNumber(
            preload=preload,
            name=unit.label(label),
            steady=unit.of(float(steady[variable])),
            dynamic=unit.of(float(dynamic[variable])),
            errors=sum(errors),
        )

    share = "gyroscopic_slip_share"
    rate = "ball_diameter_loss_rate"
    power = display("W", steady["total_qv"], dynamic["total_qv"])
    return [
        compared("QV of the bearing", "total_qv", "qv_error_estimate", power),
        compared(CASE[rate].label, rate, "wear_rate_error_estimate", LOSS_RATE),
        ComparedNumber(
            preload=preload,
            name=SHARE_LABEL,
            steady=float(steady[share].max()),
            dynamic=float(dynamic[share].max()),
        ),
    ]


def agreement(points: Sequence[CheckedPreload]) -> str:
    """Returns whether both models agree, by how much they differ, and what was not solved.

    points: at all checked preloads.
    """
    numbers = [number for point in points for number in point.numbers]
    if numbers:
        sentences = _agreement_sentences(numbers)
    else:
        sentences = ["The dynamic model cannot be compared with the steady values."]
    unsolved = [
        f"{fidelity} at {digits(point.preload)} N: {name_in_words(status)}"
        for point in points
        for fidelity, status in point.status.items()
        if status != STATUS_NAMES[OK]
    ]
    if unsolved:
        sentences.append(f"Not solved: {'; '.join(unsolved)}.")
    return " ".join(sentences)


def _agreement_sentences(numbers: Sequence[ComparedNumber]) -> list[str]:
    """Returns sentences on whether both models agree, and on the largest difference by quantity.

    numbers: at all preloads, among them slip shares.
    """
    # rising, so that the dictionary keeps the worst number of each name
    ordered = sorted(numbers, key=lambda n: (n.exceeds_errors, abs(n.difference)))
    worst = {number.name: number for number in ordered}
    share = worst.pop(SHARE_LABEL)
    with_errors = [number for number in worst.values() if np.isfinite(number.errors)]
    within = "; ".join(_difference_text(n) for n in with_errors if not n.exceeds_errors)
    beyond = "; ".join(_difference_text(n) for n in with_errors if n.exceeds_errors)
    if not with_errors:
        verdict = "lacks an error estimate, so its agreement with the steady values is not known"
    elif within and beyond:
        verdict = "agrees only partly with the steady values of the map"
    else:
        verb = "agrees" if within else "does not agree"
        verdict = f"{verb} with the steady values of the map within the estimated numerical errors"
    sentences = [f"The dynamic model {verdict}."]
    if within:
        sentences.append(f"Largest differences within the error estimates: {within}.")
    if beyond:
        sentences.append(f"Differences beyond the error estimates: {beyond}.")
    return [
        *sentences,
        f"The largest difference in the {SHARE_LABEL} is {_percent_text(share)}.",
    ]


def _difference_text(number: ComparedNumber) -> str:
    """Returns text with a number's name without its unit, its difference, and its errors."""
    name, _, _ = number.name.partition(" (")
    errors = plain(100.0 * number.errors, 2)
    return f"{name}, {_percent_text(number)} (estimates: {errors} %)"


def _percent_text(number: ComparedNumber) -> str:
    """Returns text with the difference of a number [%], and its preload."""
    return f"{plain(100.0 * number.difference, 2, '+')} % at {digits(number.preload)} N"
