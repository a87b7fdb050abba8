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
    draw_lines,
    failed_keys,
    frame,
    key,
    label_edges,
    list_failed,
    method_keys,
    new_figure,
    race_keys,
    start_at_zero,
)
from bearingwear.results.pair_variables import is_pair, method_words
from bearingwear.results.quantiles import BEARINGS_BETWEEN, NO_QUANTILES, spread_of
from bearingwear.results.units import Display, Interval, display, span
from bearingwear.results.words import friction_text, methods, percent, plain_scene

WEAR_RATE = display("m3 s-1")


def worn_in_words(loss_um: float | Sequence[float]) -> str:
    """Returns words for a loss of ball diameter [um], such as "1.5 µm worn", for a title.

    loss_um: of all balls, or a sequence with that of each ball, whose values are not given.
    """
    if not isinstance(loss_um, (int, float)):
        return "balls worn unequally"
    return f"{loss_um:g} µm worn" if loss_um else "unworn"


def friction_figure(study: xr.Dataset, loss_um: float) -> Figure:
    """Returns a figure of QV and contact load of a ball against friction (Figs. 7, 8).

    study: cases over preload method, friction and loss.
    loss_um: of ball diameter, one of the study's.
    """
    figure, ((qv_panel, load_panel),) = new_figure(1, 2, 7.2, 3.8)
    cases = study.sel(ball_diameter_loss=loss_um)
    mean = cases[["qv", "contact_load"]].mean("ball")
    status = cases["status"]
    states = methods(cases)
    power = power_unit(cases)
    draw_lines(qv_panel, mean["qv"].sum("race", skipna=False), "friction", unit=power, **BALL_STYLE)
    failed = draw_lines(qv_panel, mean["qv"], "friction", "QV", power, status)
    draw_lines(
        load_panel, mean["contact_load"], "friction", "normal contact load", display("N"), status
    )
    start_at_zero(qv_panel)
    for panel in (qv_panel, load_panel):
        panel.set_xticks(study["friction"])
    frame(
        figure,
        f"{plain_scene(study)['name']}, {worn_in_words(loss_um)}: "
        f"{_friction_message(study['friction'], states)}",
        method_keys((name for name, _ in states), plain_scene(study))
        + race_keys()
        + failed_keys(failed),
        columns=5,
    )
    return figure


def _friction_message(mu: xr.DataArray, states: Sequence[tuple[str, xr.Dataset]]) -> str:
    """Returns a sentence on QV at the largest solved friction over that at the smallest.

    A friction counts as solved if it is with every preload method; with fewer than two such
    frictions, the sentence says so.

    mu: friction coefficients, rising.
    states: cases over `mu` with each preload method.
    """
    solved = np.all([state["status"].values == OK for _, state in states], axis=0)
    if solved.sum() < 2:
        return "too few cases were solved for a comparison"
    first, last = np.flatnonzero(solved)[[0, -1]]
    ratios = " and ".join(
        f"{percent(float(state['total_qv'][last] / state['total_qv'][first]))} "
        f"({method_words(plain_scene(state), name)})"
        for name, state in states
    )
    first_mu = friction_text(float(mu[first]))
    last_mu = friction_text(float(mu[last]))
    return f"QV at {last_mu} is {ratios} of QV at {first_mu}"


def power_unit(*states: xr.Dataset) -> Display:
    """Returns the unit, mW, W or kW, in which QV of contacts and balls is shown for some cases.

    It suits the largest QV of a ball, the sum over its races.
    """
    return display("W", *(state["qv"].sum("race", skipna=False) for state in states))


def slip_figure(cases: Sequence[xr.Dataset]) -> Figure:
    """Returns a figure of slip of ball 1 along both axes over the contact ellipses (Fig. 9).

    The title has the largest gyroscopic slip share of all balls and races at each friction. A panel
    names the cases that were not solved.

    cases: single cases of a scene, with slip of each strip, whose preload method and friction vary.
    """
    figure, panels = new_figure(2, 2, 7.2, 5.2, sharex=True, sharey="row")
    scenes = [plain_scene(case) for case in cases]
    styles = dashes(sorted({scene["friction"]["ball_race"] for scene in scenes}))
    largest_shares: dict[float, float] = {}
    unsolved = []
    for case, scene in zip(cases, scenes, strict=True):
        name = scene["operation"]["preload_method"]
        mu = scene["friction"]["ball_race"]
        if int(case["status"]) != OK:
            unsolved.append(f"{method_words(scene, name)}, {friction_text(mu)}")
            continue
        share = float(case["gyroscopic_slip_share"].max())
        largest_shares[mu] = max(largest_shares.get(mu, 0.0), share)
        _draw_slip(panels, case, color=COLOURS[name], linestyle=styles[mu])
    for k, race in enumerate(RACE_STYLES):
        panels[0, k].set_title(f"{race} contact")
        panels[1, k].set_xlabel("position along the major axis, x/a")
    panels[0, 0].set_ylabel("slip along the\nrolling direction (m/s)")
    panels[1, 0].set_ylabel("gyroscopic slip, along\nthe major axis (m/s)")
    for panel in panels.flat:
        panel.axhline(0.0, color="0.5", linewidth=0.7)
        panel.set_xticks([-1.0, -0.5, 0.0, 0.5, 1.0])
    list_failed(panels[0, 0], unsolved)
    reached = " and ".join(
        f"{percent(share)} at {friction_text(mu)}" for mu, share in largest_shares.items()
    )
    loss_um = scenes[0]["wear"]["ball_diameter_loss_um"]
    names = dict.fromkeys(scene["operation"]["preload_method"] for scene in scenes)
    frame(
        figure,
        f"{scenes[0]['name']}, {worn_in_words(loss_um)}: the gyroscopic slip share reaches "
        f"{reached or '–'}",
        method_keys(names, scenes[0]) + dash_keys(styles),
        columns=5,
    )
    return figure


def _draw_slip(panels: np.ndarray, case: xr.Dataset, **look: str) -> None:
    """Draws the slip of ball 1: a row of panels for each direction, a column for each race.

    case: single case with slip of each strip.
    """
    for row, variable in zip(panels, ("rolling_slip", "gyroscopic_slip"), strict=True):
        for k, panel in enumerate(row):
            slip = case[variable].isel(ball=0, race=k)
            panel.plot(case["strip_position"], slip, **look)


def wear_figure(studies: Sequence[xr.Dataset], frictions: Sequence[float]) -> Figure:
    """Returns a figure of QV, preload, angles and wear rates against wear (Fig. 10).

    The title has QV at the last loss over that at the first, with the last preload method.

    studies: dataset of cases for each column.
    frictions: coefficient of each column.
    """
    columns = len(frictions)
    figure, panels = new_figure(4, columns, max(4.4, 3.6 * columns), 8.6, sharex=True, sharey="row")
    failed = False
    ratio_texts: list[str] = []
    cases_of_columns = [
        study.sel(friction=mu) for study, mu in zip(studies, frictions, strict=True)
    ]
    power = power_unit(*cases_of_columns)
    for column, cases, mu in zip(panels.T, cases_of_columns, frictions, strict=True):
        failed |= _draw_wear_column(column, cases, power)
        _, state = methods(cases)[-1]
        ratio_text = percent(float(state["total_qv"][-1] / state["total_qv"][0]))
        title = friction_text(mu)
        if columns > 1:
            bearing_text = _bearing_text(plain_scene(cases))
            ratio_text += f" ({bearing_text}, {title})"
            title = f"{bearing_text}: {title}"
        column[0].set_title(title)
        ratio_texts.append(ratio_text)
    label_edges(panels)
    for panel in panels[[0, 1, 3]].flat:
        start_at_zero(panel)
    names = [name for name, _ in methods(cases_of_columns[-1])]
    scene = plain_scene(cases_of_columns[-1])
    loss = float(studies[0]["ball_diameter_loss"][-1])
    prefix = f"{_bearing_text(scene)}: " if columns == 1 else ""
    method = f"{'in a' if is_pair(scene) else 'with'} {method_words(scene, names[-1])}"
    frame(
        figure,
        f"{prefix}QV {method} after {loss:g} µm of wear, relative to new: {', '.join(ratio_texts)}",
        method_keys(names, plain_scene(studies[0]))
        + race_keys()
        + [key("whole bearing", color="0.3", marker="d"), *failed_keys(failed)],
        columns=2 if columns == 1 else 3,
    )
    return figure


def _bearing_text(scene: Mapping[str, Any]) -> str:
    """Returns the name of a scene, with the density of its drag if it has any."""
    drag = scene.get("lubricant", {}).get("drag_density_kg_m3", 0.0)
    return f"{scene['name']}, drag {drag:g} kg/m³" if drag else scene["name"]


class _WearLine(NamedTuple):
    """A line over wear in one of the panels of a column."""

    panel: int  # of the column, from the top
    values: xr.DataArray
    label: str
    unit: Display
    look: Mapping[str, Any] = {}


def _draw_wear_column(column: np.ndarray, cases: xr.Dataset, power: Display) -> bool:
    """Draws the four panels of a column; returns whether a case was not solved, which has a cross.

    column: (4,) panels.
    cases: over loss and preload method.
    power: unit of QV.
    """
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
        # the crosses of a panel are drawn with the lines of races, not again with those of balls
        status = None if line.look == BALL_STYLE else cases["status"]
        failed |= draw_lines(
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
    """Returns a figure of total wear depth and residual preload over time, to the end of life.

    A mark shows the criterion that ends a life; the first panel names the lives that were not
    solved. Lives that were interpolated between the cases of the study are dots.

    lives: over preload method and friction.
    frictions: coefficients of the lives drawn.
    uncertainties: datasets of the study of uncertainty; the title states the spread of the lives.
    """
    figure, panels = new_figure(2, 1, 5.4, 5.4, sharex="col", sharey="row")
    column = panels[:, 0]
    scene = plain_scene(lives)
    styles = dashes(frictions)
    flag_names = lives["end_criterion"].attrs["flag_meanings"].split()
    criteria_met: list[str] = []
    unsolved: list[str] = []
    for name, method_lives in methods(lives):
        for mu in frictions:
            life = method_lives.sel(friction=mu)
            criterion = flag_names[int(life["end_criterion"])]
            if int(life["status"]) not in (OK, CRITERION_NOT_REACHED):
                unsolved.append(f"{method_words(scene, name)}, {friction_text(mu)}")
            elif criterion not in criteria_met:
                criteria_met.append(criterion)
            look = {"color": COLOURS[name], "linestyle": styles[mu]}
            _draw_life_column(column, life, look, END_MARKS[criterion].marker)
    column[0].set_title(f"wear of {counted_words(scene)}")
    column[1].set_xlabel("running time (h)")
    for panel in column:
        panel.set_xlim(left=0.0)
        start_at_zero(panel)
    list_failed(column[0], unsolved)
    column[0].set_ylabel("total wear depth (µm)")
    column[1].set_ylabel("residual preload (N)")
    keys = method_keys((name for name, _ in methods(lives)), scene) + dash_keys(styles)
    if _is_interpolated(lives, frictions):
        keys.append(key("interpolated, Hertzian grooves", color="0.3", **_INTERPOLATED))
    for criterion in criteria_met:
        mark = END_MARKS[criterion]
        keys.append(key(mark.text, color="0.3", linestyle="none", marker=mark.marker))
    frame(
        figure,
        f"{scene['name']}: {_life_range_phrase(lives, frictions)}; "
        f"{_spread_sentence(lives, frictions, uncertainties)}",
        keys,
        columns=2,
    )
    return figure


def _is_interpolated(lives: xr.Dataset, frictions: Sequence[float]) -> bool:
    """Whether any of the lives was interpolated between the cases of a study.

    frictions: coefficients of the lives drawn.
    """
    times = lives.get("interpolated_history_time")
    return times is not None and bool(times.sel(friction=frictions).notnull().any())


_INTERPOLATED = {"linestyle": "none", "marker": ".", "markersize": 3}
_STEPS_PER_DOT = 50
"""Steps of an interpolated history for each dot: those of an interval of the grid."""


def _draw_life_column(
    column: np.ndarray, life: xr.Dataset, look: Mapping[str, Any], end_marker: str
) -> None:
    """Draws a life in two panels, and the interpolated life as dots of the same colour.

    column: two panels.
    look: of the lines.
    end_marker: of the end of life.
    """
    scales = {"ball_diameter_loss": 1e6, "residual_preload": 1.0}  # [um], [N]
    for panel, (variable, scale) in zip(column, scales.items(), strict=True):
        if "history_time" in life:
            is_finite = np.isfinite(life["history_time"].values)
            time = life["history_time"].values[is_finite]
            values = scale * life[f"history_{variable}"].values[is_finite]
            if time.size:
                panel.plot(time, values, **look)
                mark = {"marker": end_marker, "markersize": 6.5, "zorder": 4, "clip_on": False}
                panel.plot(time[-1:], values[-1:], color=look["color"], **mark)
        if "interpolated_history_time" in life:
            panel.plot(
                life["interpolated_history_time"][::_STEPS_PER_DOT],
                scale * life[f"interpolated_history_{variable}"][::_STEPS_PER_DOT],
                color=look["color"],
                zorder=5,
                **_INTERPOLATED,
            )


def _life_range_phrase(lives: xr.Dataset, frictions: Sequence[float]) -> str:
    """Returns a phrase on the range of the lives [h] that end by a criterion, or that none ends so.

    Of a single life, it also names preload method and friction.

    frictions: coefficients of the lives drawn.
    """
    scene = plain_scene(lives)
    hours_by_condition: dict[str, float] = {}
    for name, method_lives in methods(lives):
        for mu in frictions:
            life = method_lives.sel(friction=mu)
            if int(life["status"]) == OK:
                condition = f"{method_words(scene, name)}, {friction_text(mu)}"
                hours_by_condition[condition] = float(life["life"])
    if not hours_by_condition:
        return "no end of life was found"
    details = f"wear of {counted_words(scene)}"
    if len(hours_by_condition) == 1:
        details += f"; {next(iter(hours_by_condition))}"
    return f"life {span(hours_by_condition.values())} h ({details})"


def _spread_sentence(
    lives: xr.Dataset, frictions: Sequence[float], uncertainties: Sequence[xr.Dataset]
) -> str:
    """Returns a sentence on the interval of the lives of bearings, or on why there is none.

    It spans the intervals with 90 % of the bearings at all methods and frictions.

    frictions: coefficients of the lives drawn.
    uncertainties: datasets of the study of uncertainty.
    """
    scene = plain_scene(lives)
    spreads = [
        spread_of(uncertainties, scene, name, mu) for name, _ in methods(lives) for mu in frictions
    ]
    intervals = [spread.bearings for spread in spreads if spread]
    if not intervals:
        return NO_QUANTILES
    low = min(interval.low for interval in intervals)
    high = max(interval.high for interval in intervals)
    return f"{BEARINGS_BETWEEN}, allowing for all uncertain values: {Interval(low, high).text} h"
