"""Figures of the study of accuracy: error over computing time, and effects of simplifications."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter

from bearingwear.plotting.drawing import SERIES, Figure, frame, key, new_figure, series_look
from bearingwear.results.netcdf import CaseFileError
from bearingwear.results.units import Rough, span
from bearingwear.results.words import name_in_words, percent_in_text
from bearingwear.studies.dataset import load_with_axes, pareto
from workflow.studies.accuracy.gather import distinct_texts, finite_statistic, points_where
from workflow.studies.accuracy.groove_figure import grooves_figure

LEAST_ERROR = 1e-8  # smaller errors are drawn there
LEAST_DIFFERENCE = 1e-6  # smaller differences between models are drawn there
_CPU = "processor_time"

_STEADY_SWEEPS = ("strips", "gauss", "split", "regularisation", "life_tolerance")
_DYNAMIC_SWEEPS = ("turns", "tolerance", "points_dynamic", "regularisation_dynamic", "runge_kutta")
_SINGLE_POINTS = {"color": "0.65", "marker": ".", "linestyle": "none"}
STYLES: dict[str, dict[str, Any]] = {
    **{name: series_look(k) for k, name in enumerate(_STEADY_SWEEPS)},
    **{name: series_look(k) for k, name in enumerate(_DYNAMIC_SWEEPS)},
    "start": {"color": SERIES[3], "marker": "P", "linestyle": "none"},
    "mixed_steady": _SINGLE_POINTS,
    "mixed_dynamic": _SINGLE_POINTS,
}
PRESET_MARKERS = {"draft": "v", "standard": "*", "reference": "^"}
PRESET_STYLE = {"color": "black", "markersize": 8, "linestyle": "none", "zorder": 5}
FRONT = {"color": "0.3", "linewidth": 3.0, "alpha": 0.35, "zorder": 1}
REFERENCE_UNCERTAINTY = {"color": "0.5", "linewidth": 0.8, "linestyle": ":"}

QUANTITY = {
    "total_qv": "error in total QV",
    "contact_qv": "error in QV at one contact",
    "wear_rate": "error in wear rate",
    "life": "error in wear life",
}


def numerical_points(trade: xr.Dataset, against: str, leave_out: Iterable[str] = ()) -> xr.Dataset:
    """Returns the points of numerical settings, not of models, that are against a reference.

    trade: all points of the study over `point`.
    against: name of the reference.
    leave_out: names of sweeps.
    """
    points = points_where(trade, against=against, kind="numerical")
    return points.isel(point=~np.isin(points["sweep"].values.astype(str), list(leave_out)))


def drawn_error(error: np.ndarray) -> np.ndarray:
    """Returns the magnitude of an error, at least `LEAST_ERROR`."""
    return np.maximum(np.abs(error), LEAST_ERROR)


def draw_panel(axes: Any, points: xr.Dataset, quantity: str, time: str = "wall_time") -> None:
    """Draws errors over computing time: lines of sweeps, the Pareto front and the presets.

    Errors are magnitudes, at least `LEAST_ERROR`; unsolved points are left out.

    points: of one scene, or medians over scenes.
    quantity: key of `QUANTITY`.
    time: name of the variable with the computing time.
    """
    for name in distinct_texts(points, "sweep"):
        line = points_where(points, sweep=name)
        seconds = line[time].values
        error = drawn_error(line[f"error_{quantity}"].values)
        if name.startswith("preset"):
            for label, x, y in zip(line["label"].values, seconds, error, strict=True):
                axes.plot(x, y, marker=PRESET_MARKERS.get(label, "*"), **PRESET_STYLE)
        else:
            is_solved = np.isfinite(seconds) & np.isfinite(error)
            look = {"markersize": 3.5, "linewidth": 1.0, **STYLES[name]}
            axes.plot(seconds[is_solved], error[is_solved], **look)
    seconds = points[time].values
    error = drawn_error(points[f"error_{quantity}"].values)
    front = np.flatnonzero(pareto(seconds, error))
    front = front[np.argsort(seconds[front])]
    axes.plot(seconds[front], error[front], drawstyle="steps-post", **FRONT)
    set_log_scales(axes)


def set_log_scales(axes: Any) -> None:
    """Sets both scales to logarithmic, and at most six ticks on the axis of errors."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(numticks=6))


def label_times(axes: Any) -> None:
    """Sets few tick labels on the axis of time where it spans little more than a decade.

    A range up to a factor of 5 has three labels, one up to 20 has those of 1, 2 and 5 in a decade.
    A longer one stays as it is.
    """
    low, high = axes.get_xlim()
    if high < 5.0 * low:
        axes.xaxis.set_major_locator(MaxNLocator(3))
    elif high < 20.0 * low:
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))


def draw_uncertainty_of_reference(
    axes: Any, trade: xr.Dataset, scene: str, against: str, quantity: str
) -> None:
    """Draws a line at the uncertainty of a reference on a scene: the error of its check.

    Without a solved check, it draws nothing.

    trade: all points of the study over `point`.
    against: name of the reference.
    """
    check = points_where(trade, scene=scene, sweep=against, label="check")
    if check.sizes["point"] and np.isfinite(check[f"error_{quantity}"].values[0]):
        axes.axhline(drawn_error(check[f"error_{quantity}"].values)[0], **REFERENCE_UNCERTAINTY)


def legend_keys(points: xr.Dataset) -> list[Any]:
    """Returns the legend of the sweeps, the front and the presets.

    points: of one scene or of several, over `point`.
    """
    handles = []
    for name in distinct_texts(points, "sweep"):
        if not name.startswith("preset"):
            title = distinct_texts(points_where(points, sweep=name), "sweep_title")[0]
            handles.append(key(title, **STYLES[name]))
    handles.append(key("Pareto front", **FRONT))
    if any(name.startswith("preset") for name in distinct_texts(points, "sweep")):
        handles += [
            key(f"preset: {label}", marker=mark, **PRESET_STYLE)
            for label, mark in PRESET_MARKERS.items()
        ]
    return [*handles, key("uncertainty of the reference", **REFERENCE_UNCERTAINTY)]


def small_multiples(
    trade: xr.Dataset,
    points: xr.Dataset,
    quantities: Sequence[str],
    title: str,
    time: str = "wall_time",
) -> Figure:
    """Returns a figure of errors over computing time, by scene (column) and quantity (row).

    trade: all points of the study, among which are the references.
    points: those that are drawn, all of them against the same reference.
    time: name of the variable with the computing time.
    """
    scenes = distinct_texts(points, "scene")
    rows, columns = len(quantities), len(scenes)
    figure, panels = new_figure(
        rows, columns, 1.9 * columns + 0.6, 2.0 * rows + 1.2, sharex="col", sharey="row"
    )
    against, *_ = distinct_texts(points, "against")
    for row, quantity in zip(panels, quantities, strict=True):
        for axes, scene in zip(row, scenes, strict=True):
            draw_panel(axes, points_where(points, scene=scene), quantity, time)
            draw_uncertainty_of_reference(axes, trade, scene, against, quantity)
        row[0].set_ylabel(QUANTITY[quantity])
    for axes, scene in zip(panels[0], scenes, strict=True):
        axes.set_title(name_in_words(scene))
    for axes in panels[-1]:
        axes.set_xlabel("wall time (s)")
        label_times(axes)
    frame(figure, title, legend_keys(points), columns=6)
    return figure


# Figures


def steady_figure(trade: xr.Dataset) -> Figure:
    """Returns a figure of errors by quadrature and regularisation of the steady state.

    trade: all points of the study over `point`.
    """
    points = numerical_points(trade, "steady", leave_out=["life_tolerance"])
    strips = points_where(points, sweep="strips", label="strips 50")
    split = points_where(points, sweep="split", label="split 32")
    strips_error = percent_in_text(_largest_error(strips, "total_qv"))
    split_error = percent_in_text(_largest_error(split, "total_qv"))
    times = span(map(Rough, time_ratios(split, strips)))
    title = (
        f"Steady state: the error in total QV is up to {strips_error} with 50 equal "
        f"strips and up to {split_error} with 32 split Gauss points, which take {times} "
        "times as long"
    )
    return small_multiples(trade, points, ("total_qv", "contact_qv"), title)


def life_tolerance_figure(trade: xr.Dataset) -> Figure:
    """Returns a figure of the errors in wear life by the settings of the steady state.

    trade: all points of the study over `point`.
    """
    points = numerical_points(trade, "steady")
    regularised = points_where(points, sweep="regularisation", label="0.001")
    largest_error = percent_in_text(_largest_error(regularised, "life"))
    title = f"Wear life: at v_r = 1e-3 m/s, the error is up to {largest_error}"
    return small_multiples(trade, points, ("life",), title, "life_wall_time")


def dynamic_figure(trade: xr.Dataset) -> Figure:
    """Returns a figure of errors of dynamic runs by turns, start, tolerance and regularisation.

    trade: all points of the study over `point`.
    """
    points = numerical_points(trade, "long")
    short_runs = points_where(points, sweep="turns", label="2")
    long_runs = points_where(points, sweep="turns", label="50")
    short_error = percent_in_text(_largest_error(short_runs, "total_qv"))
    long_error = percent_in_text(_largest_error(long_runs, "total_qv"))
    title = (
        f"Dynamic model: the error in total QV is up to {short_error} with 2 turns and up "
        f"to {long_error} with 50"
    )
    return small_multiples(trade, points, ("total_qv", "wear_rate"), title)


def integration_figure(trade: xr.Dataset) -> Figure:
    """Returns a figure of errors by tolerance, integrator, regularisation and points.

    All runs have the same number of turns.

    trade: all points of the study over `point`.
    """
    points = numerical_points(trade, "short")
    small, large = "0.0001", "0.1"  # regularisation v_r [m/s]
    explicit = points_where(points, sweep="runge_kutta")
    implicit = points_where(points, sweep="regularisation_dynamic")
    explicit_small = points_where(explicit, label=small)
    implicit_small = points_where(implicit, label=small)
    explicit_ratio = _largest_text(time_ratios(explicit_small, points_where(explicit, label=large)))
    implicit_ratio = _largest_text(time_ratios(implicit_small, points_where(implicit, label=large)))
    speedup = _largest_text(time_ratios(explicit_small, implicit_small))
    title = (
        f"Same number of turns: a reduction in v_r from {large} to {small} m/s increases the "
        f"computing time by a factor of at most {explicit_ratio} with Runge-Kutta and "
        f"{implicit_ratio} with Rosenbrock; at {small} m/s, Rosenbrock is up to {speedup} times as "
        "fast as Runge-Kutta"
    )
    return small_multiples(trade, points, ("total_qv", "contact_qv"), title)


def overview_figure(trade: xr.Dataset) -> Figure:
    """Returns a figure of errors and times of both models, medians over the scenes.

    trade: all points of the study over `point`.
    """
    figure, panels = new_figure(1, 2, 7.6, 4.4)
    titles = {
        "steady": "steady state: times differ by little more than noise",
        "long": "dynamic solves",
    }
    for axes, (against, text) in zip(panels[0], titles.items(), strict=True):
        points = median_over_scenes(numerical_points(trade, against, leave_out=["life_tolerance"]))
        draw_panel(axes, points, "total_qv", _CPU)
        label_times(axes)
        axes.set_title(text)
        axes.xaxis.set_major_formatter(lambda seconds, _: f"{1e3 * seconds:g}")
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_xlabel("CPU time per solve (ms), median over the scenes")
        # a median has no reference of its own
        *keys, _ = legend_keys(points)
        axes.legend(handles=keys, loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2)
    panels[0, 0].set_ylabel("relative error in total QV, median over the scenes")
    presets = median_over_scenes(numerical_points(trade, "long"))
    draft, standard, reference = (
        float(points_where(presets, sweep="preset_dynamic", label=label)[_CPU].mean())
        for label in ("draft", "standard", "reference")
    )
    title = (
        "Cost of accuracy: in dynamic solves, draft is "
        f"{standard / draft:.0f} times as fast as standard, and standard "
        f"{reference / standard:.0f} times as fast as reference"
    )
    frame(figure, title, [], columns=1)
    return figure


def median_over_scenes(points: xr.Dataset) -> xr.Dataset:
    """Returns one point for each sweep and label, with medians over the scenes that solved it.

    The medians are those of CPU times and of the magnitudes of errors. Other variables are those of
    the first scene.

    points: of one scene or of several, over `point`.
    """
    names = [_CPU, *(name for name in points if str(name).startswith("error_"))]
    median_points = []
    for sweep in distinct_texts(points, "sweep"):
        line = points_where(points, sweep=sweep)
        for label in distinct_texts(line, "label"):
            scene_points = points_where(line, label=label)
            median_point = scene_points.isel(point=[0]).copy()
            for name in names:
                median = finite_statistic(np.median, np.abs(scene_points[name].values))
                median_point[name] = ("point", [median])
            median_points.append(median_point)
    return xr.concat(median_points, "point")


class ModelPoint(NamedTuple):
    """A point of the study with a simpler model, and its text in the figure."""

    sweep: str
    label: str
    text: str
    variable: str = ""  # drawn in the panel of total QV alone; if empty, the error of each panel


SIMPLER = (
    ModelPoint("fidelity_steady", "race control", "race control instead of the steady model"),
    ModelPoint("across", "1", "slip on the centre line of the ellipse"),
    ModelPoint("normal_balance", "with traction", "traction in the balance of normal forces"),
    ModelPoint("fidelity", "race control", "race control instead of the dynamic model"),
    ModelPoint("fidelity", "steady", "steady state, pure thrust"),
    ModelPoint("fidelity", "three balls", "three balls, dynamic, pure thrust"),
    ModelPoint("fidelity", "no cage", "all balls, dynamic, without the cage"),
    ModelPoint("hertz", "fit", "Hamrock and Brewe's fit"),
)
NEGLECTED_WORK = (
    ModelPoint("long", "reference", "Coriolis force neglected", "coriolis_energy_share"),
    ModelPoint("long", "reference", "circumferential force neglected", "azimuth_energy_share"),
)
"""Work of neglected forces at the reference, relative to the heat."""
_MARKERS = ("o", "s", "D", "^", "v", "P", "X")


def models_figure(trade: xr.Dataset) -> Figure:
    """Returns a figure of differences between models, rather than between numerical settings.

    trade: all points of the study over `point`.
    """
    figure, panels = new_figure(1, 3, 8.6, 4.8, sharey=True)
    scenes = distinct_texts(points_where(trade, kind="reference"), "scene")
    texts = [point.text for point in (*SIMPLER, *NEGLECTED_WORK)]
    marks = {
        scene: {**series_look(k), "marker": _MARKERS[k % len(_MARKERS)], "linestyle": "none"}
        for k, scene in enumerate(scenes)
    }
    for axes, quantity in zip(panels[0], ("total_qv", "contact_qv", "wear_rate"), strict=True):
        _draw_differences(axes, trade, quantity, marks)
    panels[0, 0].set_yticks(range(len(texts)), texts)
    panels[0, 0].invert_yaxis()
    handles = [key(name_in_words(scene), **mark) for scene, mark in marks.items()]
    frame(figure, _models_title(trade), handles, columns=6)
    return figure


def _draw_differences(
    axes: Any, trade: xr.Dataset, quantity: str, marks: Mapping[str, Mapping[str, Any]]
) -> None:
    """Draws a row of marks for each simpler model, a mark for each scene that was solved.

    A mark is at the magnitude of the difference, at least `LEAST_DIFFERENCE`. The marks of a row
    are a little apart in height, so that they do not hide each other.

    trade: all points of the study over `point`.
    quantity: key of `QUANTITY`; the panel of total QV also has the work of neglected forces.
    marks: looks by scene.
    """
    points = (*SIMPLER, *NEGLECTED_WORK) if quantity == "total_qv" else SIMPLER
    middle = 0.5 * (len(marks) - 1)
    for row, point in enumerate(points):
        variable = point.variable or f"error_{quantity}"
        for k, (scene, mark) in enumerate(marks.items()):
            solved = points_where(trade, sweep=point.sweep, label=point.label, scene=scene)
            differences = np.abs(solved[variable].values)
            if differences.size and np.isfinite(differences[0]):
                x = max(differences[0], LEAST_DIFFERENCE)
                axes.plot(x, row + 0.09 * (k - middle), **mark)
    axes.set_xscale("log")
    axes.set_title(QUANTITY[quantity].replace("error", "difference"))
    axes.set_xlabel("relative to the more complete model")


def _models_title(trade: xr.Dataset) -> str:
    """Returns the title of `models_figure`, with the largest differences over the scenes.

    trade: all points of the study over `point`.
    """
    race_control = points_where(trade, sweep="fidelity_steady", label="race control")
    without_cage = points_where(trade, sweep="fidelity", label="no cage")
    total = percent_in_text(_largest_error(race_control, "total_qv"))
    contact = percent_in_text(_largest_error(race_control, "contact_qv"))
    cage = percent_in_text(_largest_error(without_cage, "total_qv"))
    return (
        f"With race control, the error is up to {total} in total QV and up to {contact} in QV at "
        f"one contact; without the cage, total QV changes by up to {cage}"
    )


_FIGURES: dict[str, Callable[[xr.Dataset], Figure]] = {
    "overview": overview_figure,
    "steady": steady_figure,
    "life": life_tolerance_figure,
    "dynamic_model": dynamic_figure,
    "integration": integration_figure,
    "models": models_figure,
    "grooves": grooves_figure,
}


def figure(trade: Path, which: str) -> Figure:
    """Step: returns a figure of the study by its name.

    trade: file of all points.
    which: key of `_FIGURES`; a CaseFileError is raised for another one.
    """
    if which not in _FIGURES:
        raise CaseFileError(f"figure: got {which}, expected {', '.join(_FIGURES)}")
    return _FIGURES[which](load_with_axes(trade, point=()))


def accuracy_plot(trade: xr.Dataset) -> Figure:
    """Returns the overview of all sweeps for `bearingwear plot`.

    trade: all points of the study over `point`.
    CaseFileError: a single sweep, which has no errors yet, or sweeps of one kind.
    """
    if "scene" not in trade:
        raise CaseFileError("got a single sweep, expected a file with all sweeps")
    if not all(numerical_points(trade, against).sizes["point"] for against in ("steady", "long")):
        raise CaseFileError("got sweeps of one kind, expected steady and dynamic ones")
    return overview_figure(trade)


def time_ratios(points: xr.Dataset, others: xr.Dataset) -> np.ndarray:
    """Returns the wall times of points over those of others, in each scene that solved both.

    points, others: a point of each scene at most; the array may be empty.
    """
    times, other_times = (
        dict(zip(dataset["scene"].values, dataset["wall_time"].values, strict=True))
        for dataset in (points, others)
    )
    ratios = np.array([time / other_times.get(scene, np.nan) for scene, time in times.items()])
    return ratios[np.isfinite(ratios)]


def _largest_text(ratios: np.ndarray) -> str:
    """Returns the largest of some ratios as text with two digits; a dash if there are none."""
    return Rough(finite_statistic(np.max, ratios)).text


def _largest_error(points: xr.Dataset, quantity: str) -> float:
    """Returns the largest magnitude of the relative errors in a quantity; NaN without any.

    points: of one scene or of several, over `point`.
    quantity: key of `QUANTITY`.
    """
    return finite_statistic(np.max, np.abs(points[f"error_{quantity}"].values))
