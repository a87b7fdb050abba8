"""The table that sets a recommended preload, solved dynamically, beside the steady values."""

from __future__ import annotations

import math
from collections.abc import Sequence
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
from bearingwear.results.words import name_in_words, scene_of
from bearingwear.studies.design.choice import limits_of
from bearingwear.studies.design.plan import CHECKED_FIDELITIES
from bearingwear.studies.design.recommend import RECOMMENDATION

LOSS_RATE = display("m s-1", shown="um/1000 h")
SHARE_LABEL = "maximum gyroscopic slip share"
WITH_CAGE = (
    "The scene has no cage.",
    "Only the dynamic cases include the cage, whose pockets slow and wear the balls. This "
    "increases the wear depth, especially if wear.counts is ball.",
)
"""Without a cage, and with one."""


@dataclass(frozen=True, kw_only=True)
class Compared:
    """One number by both models."""

    preload: float  # [N]
    name: str
    steady: float
    dynamic: float
    # both estimates of the numerical error together, relative; NaN where there is none
    errors: float = np.nan

    @property
    def difference(self) -> float:
        """Relative difference of the dynamic value from the steady one."""
        return self.dynamic / self.steady - 1.0

    @property
    def beyond(self) -> bool:
        """Whether they differ by more than both estimates together."""
        return abs(self.difference) > self.errors


@dataclass(frozen=True, kw_only=True)
class CheckedPreload:
    """One preload by both models."""

    preload: float  # [N]
    numbers: list[Compared]  # none where a model has no answer
    settled: str  # how far the dynamic means are settled
    status: dict[str, str]  # by fidelity


def check_table(recommendation: Path, cases: Sequence[Path]) -> str:
    """Step: steady and dynamic numbers of some preloads, and whether they agree, as Markdown."""
    chosen = load(recommendation)
    of_preload = _cases(chosen, cases)
    points = [_point(preload, fidelities) for preload, fidelities in sorted(of_preload.items())]
    scene = scene_of(chosen)
    first = scene_of(next(iter(of_preload.values()))["steady"])
    limit = limits_of(chosen).gyroscopic_slip_share
    method = name_in_words(first["operation"]["preload_method"])
    known = np.isfinite(chosen["preload"].values).any()
    middle = "the recommended preload" if known else "the scene's preload (no recommendation)"
    operation, friction = scene["operation"], scene["friction"]["ball_race"]
    said = (
        f"The values apply to a new bearing ({method}, {operation['shaft_speed_rpm']:g} r/min, "
        f"friction coefficient {friction:g}) at and near {middle}. The wear life is based on the "
        f"wear of the {name_in_words(scene['wear']['counts'])}. {WITH_CAGE['cage' in first]} Each "
        "dynamic run starts from the steady state. Agreement therefore means that the motion "
        "remains in that state, not that every initial state leads to it. The gyroscopic slip "
        "share has no error estimate."
    )
    settled = tuple(f"{digits(point.preload)} N: {point.settled}" for point in points)
    made = Document(
        (
            f"Dynamic model at the recommended preload of {scene['name']}",
            agreement(points),
            said,
        ),
        blocks=(_numbers_of(points, limit), Block("Drift of the means", lines=settled)),
    )
    return as_markdown(made)


def _numbers_of(points: Sequence[CheckedPreload], limit: float | None) -> Block:
    """A line for each number by both models; of a preload that was not solved, its statuses."""
    lines: list[tuple[Any, ...]] = []
    for point in points:
        if not point.numbers:
            states = (name_in_words(point.status[name]) for name in CHECKED_FIDELITIES)
            lines.append((point.preload, "not solved", *states, math.nan, math.nan, "–"))
        for one in point.numbers:
            errors = Rough(100.0 * one.errors)
            numbers = (one.steady, one.dynamic, 100.0 * one.difference, errors)
            lines.append((point.preload, one.name, *numbers, _beyond(one, limit)))
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


def _beyond(one: Compared, limit: float | None) -> str:
    """Whether both differ by more than their errors; of the slip share, which side of its limit."""
    if one.name == SHARE_LABEL and limit is not None:
        allowed = (one.steady <= limit) + (one.dynamic <= limit)
        words = ("both violate", "one violates", "both satisfy")
        return f"{words[allowed]} the requirement of {limit:g}"
    return ("yes" if one.beyond else "no") if np.isfinite(one.errors) else "–"


def _cases(
    recommendation: xr.Dataset, paths: Sequence[str | Path]
) -> dict[float, dict[str, xr.Dataset]]:
    """Both cases of each preload."""
    if recommendation.attrs.get("kind") != RECOMMENDATION:
        raise CaseFileError("got no recommendation, expected recommendation.nc of a design study")
    name = scene_of(recommendation)["name"]
    cases: dict[float, dict[str, xr.Dataset]] = {}
    for path in paths:
        case = load(path)
        fidelity = case.attrs.get("fidelity")
        if fidelity not in CHECKED_FIDELITIES or "total_qv" not in case or case["status"].ndim:
            raise CaseFileError(
                f"{path}: got a file of another kind, expected a steady or dynamic case"
            )
        scene = scene_of(case)
        if scene["name"] != name:
            raise CaseFileError(f"{path}: got the scene {scene['name']}, expected {name}")
        cases.setdefault(scene["operation"]["preload_N"], {})[str(fidelity)] = case
    for preload, fidelities in cases.items():
        for fidelity in CHECKED_FIDELITIES:
            if fidelity not in fidelities:
                raise CaseFileError(f"preload {preload:g} N: got no {fidelity} case")
    return cases


def _point(preload: float, fidelities: dict[str, xr.Dataset]) -> CheckedPreload:
    status = {fidelity: STATUS_NAMES[int(case["status"])] for fidelity, case in fidelities.items()}
    solved = set(status.values()) == {STATUS_NAMES[OK]}
    return CheckedPreload(
        preload=preload,
        numbers=_numbers(preload, fidelities["steady"], fidelities["dynamic"]) if solved else [],
        settled=str(fidelities["dynamic"].attrs.get("settled", "–")),
        status=status,
    )


def _numbers(preload: float, steady: xr.Dataset, dynamic: xr.Dataset) -> list[Compared]:
    def compared(name: str, variable: str, error: str, unit: Display) -> Compared:
        cases = steady, dynamic
        values = [unit.of(float(case[variable])) for case in cases]
        errors = [float(case[error]) if error in case else np.nan for case in cases]
        return Compared(
            preload=preload,
            name=unit.label(name),
            steady=values[0],
            dynamic=values[1],
            errors=sum(errors),
        )

    share = "gyroscopic_slip_share"
    power = display("W", steady["total_qv"], dynamic["total_qv"])
    return [
        compared("QV of the bearing", "total_qv", "qv_error_estimate", power),
        compared(
            CASE["ball_diameter_loss_rate"].label,
            "ball_diameter_loss_rate",
            "wear_rate_error_estimate",
            LOSS_RATE,
        ),
        Compared(
            preload=preload,
            name=SHARE_LABEL,
            steady=float(steady[share].max()),
            dynamic=float(dynamic[share].max()),
        ),
    ]


def agreement(points: Sequence[CheckedPreload]) -> str:
    """Whether both models agree, in a sentence or two."""
    unsolved = [
        f"{fidelity} at {digits(point.preload)} N: {name_in_words(state)}"
        for point in points
        for fidelity, state in point.status.items()
        if state != STATUS_NAMES[OK]
    ]
    numbers = [one for point in points for one in point.numbers]
    said = ["The dynamic model cannot be compared with the steady values."]
    if numbers:
        # of each name the last: beyond the estimates if any is, and there the largest
        worst = {
            one.name: one for one in sorted(numbers, key=lambda n: (n.beyond, abs(n.difference)))
        }
        share = worst.pop(SHARE_LABEL)
        allowed, beyond = (
            "; ".join(
                f"{one.name.partition(' (')[0]}, {_at(one)} (estimates: "
                f"{plain(100.0 * one.errors, 2)} %)"
                for one in worst.values()
                if one.beyond == way and np.isfinite(one.errors)
            )
            for way in (False, True)
        )
        agrees = "agrees" if allowed else "does not agree"
        partly = " within the estimated numerical errors"
        if allowed and beyond:
            agrees, partly = "agrees only partly", ""
        said = [
            f"The dynamic model {agrees} with the steady values of the map{partly}.",
            *([f"Largest differences within the error estimates: {allowed}."] if allowed else []),
            *([f"Differences beyond the error estimates: {beyond}."] if beyond else []),
            f"The largest difference in the {SHARE_LABEL} is {_at(share)}.",
        ]
    if unsolved:
        said.append(f"Not solved: {'; '.join(unsolved)}.")
    return " ".join(said)


def _at(one: Compared) -> str:
    return f"{plain(100.0 * one.difference, 2, '+')} % at {digits(one.preload)} N"
