"""Wear life between the cases of a study, without a solve."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK
from bearingwear.measures import ENDS, Measure
from bearingwear.results.variable import SECONDS_PER_HOUR, Variable, table
from bearingwear.scene.blocks import CRITERIA
from bearingwear.studies.dataset import filled

POINTS_PER_INTERVAL = 50
"""Points of the interpolated history in each interval of the grid."""

MICROMETRE = 1e-6

NOT_INTERPOLATED = "criteria_not_interpolated"
"""Attribute: criteria that the cases do not hold, by which no interpolated life ends."""

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


def interpolated_life(
    line: xr.Dataset, criteria: Mapping[str, float], preload_N: float
) -> xr.Dataset:
    """Wear life from the cases along one line of the grid.

    line: one preload method and friction coefficient of a study: cases over `ball_diameter_loss`.
        What lies behind the first case that was not solved is not used.
    criteria: limits by the names of `CRITERIA`; those that the cases do not hold (`known_of`) are
        not looked at.

    Returns: interpolated_life [h], NaN where no criterion is met on the line;
        interpolated_end_criterion, interpolated_loss_at_end [m]; and the history over
        `interpolated_step` up to the end.
    """
    losses = line["ball_diameter_loss"].values
    usable = int(np.cumprod(line["status"].values == OK).sum())
    steps = POINTS_PER_INTERVAL * (len(losses) - 1) + 1
    loss = np.linspace(losses[0], losses[max(usable, 1) - 1], steps)
    time = np.full(steps, np.nan)
    preload = np.full(steps, np.nan)
    end, criterion = np.nan, "none"
    if usable > 1 and losses[0] == 0.0:
        known = known_of(criteria, line)
        needed = {"residual_preload", "ball_diameter_loss_rate"}
        needed |= {one for name in known for one in ENDS[name].variables if one in line}
        fine = (
            line[sorted(needed - set(line.coords))]
            .isel(ball_diameter_loss=slice(usable))
            .interp(ball_diameter_loss=loss, method="pchip")
            .transpose("ball_diameter_loss", ...)
        )
        in_metres = fine.assign_coords(ball_diameter_loss=loss * MICROMETRE)
        end, criterion = _first_met(loss, _margins(in_metres, known, preload_N))
        preload = fine["residual_preload"].values
        slowness = 1.0 / fine["ball_diameter_loss_rate"].values
        mean = 0.5 * (slowness[1:] + slowness[:-1])
        time[0] = 0.0
        time[1:] = np.cumsum(mean * np.diff(loss)) * MICROMETRE / SECONDS_PER_HOUR
    life = np.interp(end, loss, time)
    # The history ends where the life does.
    if np.isfinite(end):
        kept = np.linspace(0.0, end, steps)
        preload = np.interp(kept, loss, preload)
        time = np.interp(kept, loss, time)
        loss = kept
    values = {
        "interpolated_life": life,
        "interpolated_loss_at_end": end * MICROMETRE,
        "interpolated_end_criterion": CRITERIA.index(criterion),
        "interpolated_history_ball_diameter_loss": loss * MICROMETRE,
        "interpolated_history_time": time,
        "interpolated_history_residual_preload": preload,
    }
    return filled(INTERPOLATED, {}, [values])


def known_of(criteria: Mapping[str, float], cases: xr.Dataset) -> dict[str, float]:
    """Those of some criteria whose measure the cases of a study hold."""
    return {
        name: limit
        for name, limit in criteria.items()
        if any(variable in cases.variables for variable in ENDS[name].variables)
    }


def _margins(fine: xr.Dataset, criteria: Mapping[str, float], preload_N: float) -> dict:
    """Distance of each criterion from its limit along the line; met where it is not positive."""
    found = {}
    for name, limit in criteria.items():
        measure = ENDS[name]

        def at(k: int, measure: Measure = measure) -> float:
            values = {one: fine[one].values[k] for one in measure.variables if one in fine}
            return measure.critical(lambda one: values.get(one, np.nan), preload_N)[0]

        margins = np.array([at(k) for k in range(fine.sizes["ball_diameter_loss"])])
        found[name] = measure.margin(margins, limit)
    return found


def _first_met(loss: np.ndarray, margins: dict[str, np.ndarray]) -> tuple[float, str]:
    """Where the first of the criteria is met, and which; (nan, "none") if none is."""
    end, first = np.nan, "none"
    for name, margin in margins.items():
        met = np.flatnonzero(margin <= 1e-12)  # the last grid point may be the limit itself
        if met.size:
            k = int(met[0])
            end_loss = loss[0]
            if k > 0:
                share = margin[k - 1] / (margin[k - 1] - margin[k])
                end_loss = loss[k - 1] + min(share, 1.0) * (loss[k] - loss[k - 1])
            if not end_loss >= end:
                end, first = float(end_loss), name
    return end, first
