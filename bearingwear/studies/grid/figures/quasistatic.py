"""Figures of one scene from datasets.

Those of friction, slip and wear correspond, panel by panel, to Figs. 7 to 10 of Zhang, Chen, Gu and
Wang (2018). Every title states what its data show.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from bearingwear.document.rows import counted_words
from bearingwear.kernels.status import CRITERION_NOT_REACHED, OK
from bearingwear.measures import ENDS
from bearingwear.plotting.drawing import (
    BALL_STYLE,
    COLOURS,
    RACE_STYLES,
    Figure,
    dash_keys,
    dashes,
    failed_keys,
    frame,
    key,
    label_edges,
    lines,
    list_failed,
    method_keys,
    new_figure,
    race_keys,
    start_at_zero,
)
from bearingwear.results.pair_variables import is_pair, method_words
from bearingwear.results.quantiles import BEARINGS_BETWEEN, NO_QUANTILES, spread_of
from bearingwear.results.units import Display, Interval, digits, display
from bearingwear.results.words import friction_text, methods, percent, scene_of

WEAR_RATE = display("m3 s-1")


def worn_in_words(loss_um: float | Sequence[float]) -> str:
    """Writes a loss of ball diameter [um], or that of each ball, for a title."""
    if not isinstance(loss_um, (int, float)):
        return "balls worn unequally"
    return f"{loss_um:g} µm worn" if loss_um else "unworn"


def friction_figure(study: xr.Dataset, loss_um: float) -> Figure:
    """Draws QV and contact load of a ball against friction, at a state of wear (Figs. 7, 8)."""
    figure, ((qv_panel, load_panel),) = new_figure(1, 2, 7.2, 3.8)
    cases = study.sel(ball_diameter_loss=loss_um)
    mean, status, states = (
        cases[["qv", "contact_load"]].mean("ball"),
        cases["status"],
        methods(cases),
    )
    power = power_unit(cases)
    lines(qv_panel, mean["qv"].sum("race", skipna=False), "friction", unit=power, **BALL_STYLE)
    failed = lines(qv_panel, mean["qv"], "friction", "QV", power, status)
    lines(load_panel, mean["contact_load"], "friction", "normal contact load", display("N"), status)
    start_at_zero(qv_panel)
    for panel in (qv_panel, load_panel):
        panel.set_xticks(study["friction"])
    frame(
        figure,
        f"{scene_of(study)['name']}, {worn_in_words(loss_um)}: "
        f"{_friction_message(study['friction'], states)}",
        method_keys((name for name, _ in states), scene_of(study))
        + race_keys()
        + failed_keys(failed),
        columns=5,
    )
    return figure


def _friction_message(mu: xr.DataArray, states: Sequence[tuple[str, xr.Dataset]]) -> str:
    """States QV at the largest solved friction coefficient relative to that at the smallest."""
    solved = np.all([state["status"].values == OK for _, state in states], axis=0)
    if solved.sum() < 2:
        return "too few cases were solved for a comparison"
    first, last = np.flatnonzero(solved)[[0, -1]]
    ratios = " and ".join(
        f"{percent(float(state['total_qv'][last] / state['total_qv'][first]))} "
        f"({method_words(scene_of(state), name)})"
        for name, state in states
    )
    last_mu, first_mu = (friction_text(float(mu[k])) for k in (last, first))
    return f"QV at {last_mu} is {ratios} of QV at {first_mu}"


def power_unit(*states: xr.Dataset) -> Display:
    """Returns the unit for QV of the contacts and of a ball in some cases."""
    return display("W", *(state["qv"].sum("race", skipna=False) for state in states))


def slip_figure(cases: Sequence[xr.Dataset]) -> Figure:
    """Draws slip along both axes over the contact ellipses of single cases (Fig. 9)."""
    figure, panels = new_figure(2, 2, 7.2, 5.2, sharex=True, sharey="row")
    scenes = [scene_of(case) for case in cases]
    styles = dashes(sorted({scene["friction"]["ball_race"] for scene in scenes}))
    shares: dict[float, float] = {}
    failed = []
    for case, scene in zip(cases, scenes, strict=True):
        name, mu = scene["operation"]["preload_method"], scene["friction"]["ball_race"]
        if int(case["status"]) != OK:
            failed.append(f"{method_words(scene, name)}, {friction_text(mu)}")
            continue
        shares[mu] = max(shares.get(mu, 0.0), float(case["gyroscopic_slip_share"].max()))
        for row, variable in zip(panels, ("rolling_slip", "gyroscopic_slip"), strict=True):
            for k, panel in enumerate(row):
                panel.plot(
                    case["strip_position"],
                    case[variable].isel(ball=0, race=k),
                    color=COLOURS[name],
                    linestyle=styles[mu],
                )
    for k, race in enumerate(RACE_STYLES):
        panels[0, k].set_title(f"{race} contact")
        panels[1, k].set_xlabel("position along the major axis, x/a")
    panels[0, 0].set_ylabel("slip along the\nrolling direction (m/s)")
    panels[1, 0].set_ylabel("gyroscopic slip, along\nthe major axis (m/s)")
    for panel in panels.flat:
        panel.axhline(0.0, color="0.5", linewidth=0.7)
        panel.set_xticks([-1.0, -0.5, 0.0, 0.5, 1.0])
    list_failed(panels[0, 0], failed)
    reached = " and ".join(
        f"{percent(share)} at {friction_text(mu)}" for mu, share in shares.items()
    )
    loss_um = scenes[0]["wear"]["ball_diameter_loss_um"]
    frame(
        figure,
        f"{scenes[0]['name']}, {worn_in_words(loss_um)}: the gyroscopic slip share reaches "
        f"{reached or '–'}",
        method_keys(
            dict.fromkeys(scene["operation"]["preload_method"] for scene in scenes), scenes[0]
        )
        + dash_keys(styles),
        columns=5,
    )
    return figure


def wear_figure(studies: Sequence[xr.Dataset], frictions: Sequence[float]) -> Figure:
    """Draws QV, preload, angles and wear rates against wear, a column for each study (Fig. 10)."""
    columns = len(frictions)
    figure, panels = new_figure(4, columns, max(4.4, 3.6 * columns), 8.6, sharex=True, sharey="row")
    failed = False
    shares: list[str] = []
    cases = [study.sel(friction=mu) for study, mu in zip(studies, frictions, strict=True)]
    power = power_unit(*cases)
    for column, friction_cases, mu in zip(panels.T, cases, frictions, strict=True):
        failed |= _draw_wear_column(column, friction_cases, power)
        states = methods(friction_cases)
        name, state = states[-1]
        share = percent(float(state["total_qv"][-1] / state["total_qv"][0]))
        scene = scene_of(friction_cases)
        drag = scene.get("lubricant", {}).get("drag_density_kg_m3", 0.0)
        bearing_text = scene["name"] + (f", drag {drag:g} kg/m³" if drag else "")
        column[0].set_title(
            f"{bearing_text}: {friction_text(mu)}" if columns > 1 else friction_text(mu)
        )
        shares.append(f"{share} ({bearing_text}, {friction_text(mu)})" if columns > 1 else share)
    label_edges(panels)
    for panel in panels[[0, 1, 3]].flat:
        start_at_zero(panel)
    loss = float(studies[0]["ball_diameter_loss"][-1])
    frame(
        figure,
        (f"{bearing_text}: " if columns == 1 else "")
        + f"QV {'in a' if is_pair(scene) else 'with'} {method_words(scene, name)} after "
        f"{loss:g} µm of wear, "
        "relative to new: " + ", ".join(shares),
        method_keys((name for name, _ in states), scene_of(studies[0]))
        + race_keys()
        + [key("whole bearing", color="0.3", marker="d"), *failed_keys(failed)],
        columns=2 if columns == 1 else 3,
    )
    return figure


class _WearLine(NamedTuple):
    """A line over wear in one of the panels of a column."""

    panel: int
    values: xr.DataArray
    label: str
    unit: Display
    look: Mapping[str, Any] = {}


def _draw_wear_column(column: np.ndarray, cases: xr.Dataset, power: Display) -> bool:
    """Draws the four panels of a column; returns whether a case was not solved."""
    mean = cases[["qv", "contact_angle", "ball_wear_rate"]].mean("ball")
    ball = mean["qv"].sum("race", skipna=False)
    rate_label = "wear rate of race and ball\n"
    lines_shown = (
        _WearLine(0, mean["qv"], "QV", power),
        _WearLine(0, ball, "QV", power, BALL_STYLE),
        _WearLine(1, cases["residual_preload"], "residual preload", display("N"), {"marker": "d"}),
        _WearLine(2, mean["contact_angle"], "contact angle", display("degree")),
        _WearLine(3, cases["race_wear_rate"], rate_label, WEAR_RATE),
        _WearLine(3, mean["ball_wear_rate"], rate_label, WEAR_RATE, BALL_STYLE),
    )
    failed = False
    for line in lines_shown:
        status = None if line.look == BALL_STYLE else cases["status"]
        failed |= lines(
            column[line.panel],
            line.values,
            "ball_diameter_loss",
            line.label,
            line.unit,
            status,
            **line.look,
        )
    return failed


class EndMark(NamedTuple):
    """How the end of a life is drawn, and its text in the legend."""

    marker: str
    text: str


END_MARKS = {name: EndMark(end.mark, f"end: {end.short}") for name, end in ENDS.items()}
END_MARKS["none"] = EndMark("x", "end of life not reached")


def life_figure(
    lives: xr.Dataset, frictions: Sequence[float], uncertainties: Sequence[xr.Dataset] = ()
) -> Figure:
    """Draws total wear depth and residual preload in hours, up to the end of life.

    uncertainties: files of the study of uncertainty; the title states the spread of the lives.
    """
    figure, panels = new_figure(2, 1, 5.4, 5.4, sharex="col", sharey="row")
    column = panels[:, 0]
    styles = dashes(frictions)
    ends = lives["end_criterion"].attrs["flag_meanings"].split()
    criteria_met: list[str] = []
    failed: list[str] = []
    for name, method_lives in methods(lives):
        for mu in frictions:
            life = method_lives.sel(friction=mu)
            end = ends[int(life["end_criterion"])]
            if int(life["status"]) not in (OK, CRITERION_NOT_REACHED):
                failed.append(f"{method_words(scene_of(lives), name)}, {friction_text(mu)}")
            elif end not in criteria_met:
                criteria_met.append(end)
            line = {"color": COLOURS[name], "linestyle": styles[mu]}
            _draw_life_column(column, life, line, END_MARKS[end].marker)
    column[0].set_title(f"wear of {counted_words(scene_of(lives))}")
    column[1].set_xlabel("running time (h)")
    for panel in column:
        panel.set_xlim(left=0.0)
        start_at_zero(panel)
    list_failed(column[0], failed)
    column[0].set_ylabel("total wear depth (µm)")
    column[1].set_ylabel("residual preload (N)")
    frame(
        figure,
        f"{scene_of(lives)['name']}: {_shortest_and_longest(lives, frictions)}; "
        f"{_spread_sentence(lives, frictions, uncertainties)}",
        method_keys((name for name, _ in methods(lives)), scene_of(lives))
        + dash_keys(styles)
        + [
            key("interpolated, Hertzian grooves", color="0.3", **_INTERPOLATED)
            for _ in range(_is_interpolated(lives, frictions))
        ]
        + [
            key(mark.text, color="0.3", linestyle="none", marker=mark.marker)
            for mark in map(END_MARKS.__getitem__, criteria_met)
        ],
        columns=2,
    )
    return figure


def _is_interpolated(lives: xr.Dataset, frictions: Sequence[float]) -> bool:
    """Whether one of the lives was interpolated from the study."""
    times = lives.get("interpolated_history_time")
    return times is not None and bool(times.sel(friction=frictions).notnull().any())


_INTERPOLATED = {"linestyle": "none", "marker": ".", "markersize": 3}


def _draw_life_column(column: np.ndarray, life: xr.Dataset, line: dict, end_mark: str) -> None:
    """Draws a life in two panels, and the interpolated life as dots of the same colour."""
    scales = {"ball_diameter_loss": 1e6, "residual_preload": 1.0}
    for panel, (variable, scale) in zip(column, scales.items(), strict=True):
        is_known = (
            np.isfinite(life["history_time"].values) if "history_time" in life else np.array(False)
        )
        if is_known.any():
            time = life["history_time"].values[is_known]
            values = scale * life[f"history_{variable}"].values[is_known]
            panel.plot(time, values, **line)
            mark = {"marker": end_mark, "markersize": 6.5, "zorder": 4, "clip_on": False}
            panel.plot(time[-1:], values[-1:], color=line["color"], **mark)
        if "interpolated_history_time" in life:
            panel.plot(
                life["interpolated_history_time"][::50],
                scale * life[f"interpolated_history_{variable}"][::50],
                color=line["color"],
                zorder=5,
                **_INTERPOLATED,
            )


def _shortest_and_longest(lives: xr.Dataset, frictions: Sequence[float]) -> str:
    """States the range of the lives that have an end."""
    lives_found = [
        (float(life["life"]), f"{method_words(scene_of(lives), name)}, {friction_text(mu)}")
        for name, method_lives in methods(lives)
        for mu in frictions
        if int((life := method_lives.sel(friction=mu))["status"]) == OK
    ]
    if not lives_found:
        return "no end of life was found"
    (shortest, condition), (longest, _) = min(lives_found), max(lives_found)
    ends = " to ".join(dict.fromkeys(digits(hours) for hours in (shortest, longest)))
    condition = f"; {condition}" if len(lives_found) == 1 else ""
    return f"life {ends} h (wear of {counted_words(scene_of(lives))}{condition})"


def _spread_sentence(
    lives: xr.Dataset, frictions: Sequence[float], uncertainties: Sequence[xr.Dataset]
) -> str:
    """States the interval of the lives of bearings, where it was computed."""
    points = [(name, mu) for name, _ in methods(lives) for mu in frictions]
    spreads = [spread_of(uncertainties, scene_of(lives), *point) for point in points]
    intervals = [spread.bearings for spread in spreads if spread]
    if not intervals:
        return NO_QUANTILES
    low = min(interval.low for interval in intervals)
    high = max(interval.high for interval in intervals)
    return f"{BEARINGS_BETWEEN}, allowing for all uncertain values: {Interval(low, high).text} h"
