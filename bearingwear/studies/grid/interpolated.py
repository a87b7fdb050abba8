"""Wear life between the cases of a study, without a solve."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK
from bearingwear.measures import ENDS, Measure
from bearingwear.results.variable import SECONDS_PER_HOUR, Variable, table
from bearingwear.scene.blocks import CRITERIA
from bearingwear.studies.dataset import dataset_of_rows

POINTS_PER_INTERVAL = 50
"""Points of the interpolated history in each interval of the grid."""

MICROMETRE = 1e-6

NOT_INTERPOLATED = "criteria_not_interpolated"
"""Attribute with the criteria that the cases do not contain and that end no interpolated life."""

_FROM_THE_STUDY = "interpolated from the study"
INTERPOLATED = table(
    Variable("interpolated_life", (), "h", f"wear life, {_FROM_THE_STUDY}"),
    Variable("interpolated_loss_at_end", (), "m",
        f"total wear depth at the end of life, {_FROM_THE_STUDY}"),
    Variable("interpolated_end_criterion", (), "",
        f"first criterion met, {_FROM_THE_STUDY}", "i1", flags=CRITERIA),
    Variable("interpolated_history_ball_diameter_loss", ("interpolated_step",), "m",
        f"total wear depth, {_FROM_THE_STUDY}"),
    Variable("interpolated_history_time", ("interpolated_step",), "h",
        f"running time, {_FROM_THE_STUDY}"),
    Variable("interpolated_history_residual_preload", ("interpolated_step",), "N",
        f"residual preload, {_FROM_THE_STUDY}"),
)  # fmt: skip


class Line(NamedTuple):
    """Cases of one condition over the loss, at one preload method and friction coefficient."""

    # over `ball_diameter_loss`; those from the first unsolved one on are not used
    cases: xr.Dataset
    preload_N: float | None  # of new bearings; None where no criterion ends a life
    share: float = 1.0  # of the time of a cycle


def interpolated_life(lines: Sequence[Line], criteria: Mapping[str, float]) -> xr.Dataset:
    """Returns the wear life at one preload method and friction, interpolated between its cases.

    lines: of the only condition, or of each condition of a duty. The mean of their loss rates
        decides the life, and the first criterion met in any of them ends it.
    criteria: limits by the names of `CRITERIA`; those that the cases do not contain
        (`interpolable_criteria`) are ignored.

    Returns: interpolated_life [h]; interpolated_end_criterion and interpolated_loss_at_end [m]; and
        the history over `interpolated_step` up to the end, of the condition that ends the life.
        Where no criterion is met, life and loss are NaN, the criterion is "none", and the history
        goes to the last case that is used. With fewer than two such cases, or if the first is
        worn, times and preloads are NaN, too.
    """
    losses = lines[0].cases["ball_diameter_loss"].values
    # cases before the first unsolved one of any condition
    usable = min(int(np.cumprod(line.cases["status"].values == OK).sum()) for line in lines)
    steps = POINTS_PER_INTERVAL * (len(losses) - 1) + 1
    loss = np.linspace(losses[0], losses[max(usable, 1) - 1], steps)
    time = np.full(steps, np.nan)
    end = _LineEnd(loss=np.nan, criterion="none", preload=np.full(steps, np.nan))
    if usable > 1 and losses[0] == 0.0:
        rate = np.zeros(steps)
        ends = []
        for line in lines:
            fine, usable_criteria = _between_cases(line, criteria, loss, usable)
            rate += line.share * fine["ball_diameter_loss_rate"].values
            if line.preload_N is not None:
                ends.append(_line_end(fine, usable_criteria, line.preload_N, loss))
        # a condition whose criteria are not met comes last
        end = min(ends, key=lambda line_end: (np.isnan(line_end.loss), line_end.loss))
        time = _running_time(loss, rate)
    life = np.interp(end.loss, loss, time)
    preload = end.preload
    # the history ends where the life does: the same number of steps up to there
    if np.isfinite(end.loss):
        loss_to_end = np.linspace(0.0, end.loss, steps)
        preload = np.interp(loss_to_end, loss, preload)
        time = np.interp(loss_to_end, loss, time)
        loss = loss_to_end
    values = {
        "interpolated_life": life,
        "interpolated_loss_at_end": end.loss * MICROMETRE,
        "interpolated_end_criterion": CRITERIA.index(end.criterion),
        "interpolated_history_ball_diameter_loss": loss * MICROMETRE,
        "interpolated_history_time": time,
        "interpolated_history_residual_preload": preload,
    }
    return dataset_of_rows(INTERPOLATED, {}, [values])


class _LineEnd(NamedTuple):
    """The end of life by the criteria of one condition, and its residual preload."""

    loss: float  # at the end [um]; NaN if no criterion is met
    criterion: str  # "none" if no criterion is met
    preload: np.ndarray  # (n,) [N] at each loss


def _line_end(
    fine: xr.Dataset, criteria: Mapping[str, float], preload_N: float, loss: np.ndarray
) -> _LineEnd:
    """Returns where the first criterion of a condition is met, and its preload at each loss.

    fine: cases interpolated at each loss (n,) [um].
    criteria: limits by name.
    preload_N: of new bearings.
    """
    in_metres = fine.assign_coords(ball_diameter_loss=loss * MICROMETRE)
    end_loss, criterion = _first_met(loss, _margins(in_metres, criteria, preload_N))
    return _LineEnd(end_loss, criterion, fine["residual_preload"].values)


def _running_time(loss: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Returns the time (n,) [h] from the first loss to each loss (n,) [um].

    It is the integral of 1 / rate over the loss, by the trapezoidal rule.

    rate: of the loss (n,) [m/s].
    """
    slowness = 1.0 / rate
    mean_slowness = 0.5 * (slowness[1:] + slowness[:-1])
    time = np.zeros(len(loss))
    time[1:] = np.cumsum(mean_slowness * np.diff(loss)) * MICROMETRE / SECONDS_PER_HOUR
    return time


def _between_cases(
    line: Line, criteria: Mapping[str, float], loss: np.ndarray, usable: int
) -> tuple[xr.Dataset, dict[str, float]]:
    """Returns the cases interpolated at each loss [um], and the criteria that they can meet.

    Preload, loss rate and the variables of these criteria are interpolated by monotone cubics
    (PCHIP), whose derivatives are continuous.

    criteria: limits by name; those are returned whose variables the cases contain. None is returned
        for a condition in which no criterion ends a life.
    usable: number of cases, from the first on, between which to interpolate.
    """
    cases = line.cases
    usable_criteria = {} if line.preload_N is None else interpolable_criteria(criteria, cases)
    names = {"residual_preload", "ball_diameter_loss_rate"}
    for name in usable_criteria:
        names |= {variable for variable in ENDS[name].variables if variable in cases}
    fine = (
        cases[sorted(names - set(cases.coords))]
        .isel(ball_diameter_loss=slice(usable))
        .interp(ball_diameter_loss=loss, method="pchip")
        .transpose("ball_diameter_loss", ...)
    )
    return fine, usable_criteria


def interpolable_criteria(criteria: Mapping[str, float], cases: xr.Dataset) -> dict[str, float]:
    """Returns the limits of the criteria that cases of a study can meet, by name.

    The cases must contain a variable of the criterion's measure.
    """
    return {
        name: limit
        for name, limit in criteria.items()
        if any(variable in cases.variables for variable in ENDS[name].variables)
    }


def _margins(
    fine: xr.Dataset, criteria: Mapping[str, float], preload_N: float
) -> dict[str, np.ndarray]:
    """Returns the margin (n,) of each criterion at each loss, by name.

    It is the distance of the worst value from the limit, over the limit: positive within it, <= 0
    where the criterion is met.

    fine: cases interpolated along `ball_diameter_loss` [m].
    criteria: limits by name.
    preload_N: of new bearings.
    """
    margins = {}
    for name, limit in criteria.items():
        values = _critical_values(fine, ENDS[name], preload_N)
        margins[name] = ENDS[name].margin(values, limit)
    return margins


def _critical_values(fine: xr.Dataset, measure: Measure, preload_N: float) -> np.ndarray:
    """Returns the worst value (n,) of a measure at each loss [SI]; missing variables are NaN.

    fine: cases interpolated along `ball_diameter_loss` [m].
    preload_N: of new bearings.
    """
    columns = {name: fine[name].values for name in measure.variables if name in fine}

    def critical_value(k: int) -> float:
        """Returns the worst value of all variables of the measure at a step."""

        def value_of(name: str) -> Any:
            return columns[name][k] if name in columns else np.nan

        value, _ = measure.critical(value_of, preload_N)
        return value

    return np.array([critical_value(k) for k in range(fine.sizes["ball_diameter_loss"])])


def _first_met(loss: np.ndarray, margins: dict[str, np.ndarray]) -> tuple[float, str]:
    """Returns the loss at which the first criterion is met, and its name; (nan, "none") if none.

    The margin is interpolated linearly between losses. A criterion that is met at the first loss
    ends the life there.

    margins: (n,) at each loss (n,), by the name of the criterion.
    """
    end_losses: dict[str, float] = {}
    for name, margin in margins.items():
        # the last loss of the grid may be the limit itself, and its margin a rounding error
        met_at = np.flatnonzero(margin <= 1e-12)
        if met_at.size:
            k = int(met_at[0])
            end_loss = loss[0]
            if k > 0:
                share = margin[k - 1] / (margin[k - 1] - margin[k])
                end_loss = loss[k - 1] + min(share, 1.0) * (loss[k] - loss[k - 1])
            end_losses[name] = float(end_loss)
    if not end_losses:
        return np.nan, "none"
    first = min(end_losses, key=lambda name: end_losses[name])
    return end_losses[first], first
