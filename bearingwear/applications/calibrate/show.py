"""The sheet of a calibration, and its figure: before and after the tests."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from bearingwear.applications.calibrate.file import STAGES
from bearingwear.applications.calibrate.seen import (
    SEEN,
    SEEN_AS,
    SEEN_LIFE,
    SEEN_LOSS,
    SEEN_PRELOAD,
    SEEN_RUN_OUT,
)
from bearingwear.document.document import Block, Document, Row
from bearingwear.document.rows import stored_scene, variable_values
from bearingwear.measures import plain
from bearingwear.plotting.drawing import (
    Figure,
    frame,
    key,
    new_figure,
)
from bearingwear.results.units import Interval, counted_tests, digits
from bearingwear.results.words import plain_scene

_UNLIKELY = 0.01
"""Probability below which a test and the model are said to disagree."""

_FAR = 2.58
"""Shift of a mean, in standard deviations before the tests, beyond which a two-sided probability is
below 0.01."""

_COLOURS = dict(zip(STAGES, ("0.6", "black"), strict=True))

_LIFE_MARKS = {SEEN_LIFE: "o", SEEN_RUN_OUT: ">"}
_MARK_HEIGHT = 0.03  # of the mark of a life, just above the axis

_DENSITY = "density of the logarithm"
_WEAR_INTERVAL = "wear_over_hardness_interval"


class _Curve(NamedTuple):
    """The curves of a panel before and after the tests: two variables and their labels."""

    axis: str  # name of the variable of the abscissa
    name: str  # name of the variable of the ordinate
    x_label: str
    y_label: str


def calibration_sheet(file: Any) -> Document:
    """Returns the sheet of an open file: friction, K_s/H and life before and after, and the tests.

    Conflicts between tests and model are stated in its heading.
    """
    scene, conflict_sentences = stored_scene(file), conflicts(file)
    calibration = scene["calibrated"]
    words, unit = _friction_words_and_unit(scene)
    rows = [
        Row(
            "K_s/H, 90 % of batches", "m2/N", _stage_intervals(file, "wear_over_hardness_interval")
        ),
        Row("life, 90 % of bearings", "h", _stage_intervals(file, "life_quantile"), "life"),
        Row("L10, 90 % of batches", "h", _stage_intervals(file, "batch_life_quantile"), "L10"),
    ]
    if _has_uncertain_friction(file):
        intervals = _stage_intervals(file, "friction_interval")
        rows.insert(0, Row(f"{words}, 90 % of batches", unit, intervals))
    heading = (
        f"{scene['name']}: calibrated with {counted_tests(calibration['rows'])} from "
        f"{calibration['tests']} (SHA-256 {calibration['sha256'][:12]})",
        *(f"conflict: {sentence}" for sentence in conflict_sentences),
    )
    facts = {"kind": "calibration", "conflicts": conflict_sentences, **calibration}
    blocks = (
        Block("coefficients and life", STAGES, tuple(rows)),
        Block("test", ("seen", "expected", "probability"), tuple(_test_rows(file))),
        Block("", lines=_summary_sentences(file, scene)),
    )
    return Document(heading, facts, blocks)


def _friction_words_and_unit(scene: Mapping[str, Any]) -> tuple[str, str]:
    """Returns what a scene has as friction, `friction` or `film shear strength`, and its unit."""
    if "ball_race" in scene["friction"]:
        return "friction", ""
    return "film shear strength", "MPa"


def _has_uncertain_friction(file: Any) -> bool:
    """Returns whether tests could determine the friction of a calibration."""
    return "friction_density" in file.variables


def _summary_sentences(file: Any, scene: Mapping[str, Any]) -> tuple[str, ...]:
    """States the distributions of the calibrated scene, the scatter of a batch, and the error."""
    scatter, error = (
        float(variable_values(file, "scatter")),
        float(variable_values(file, "interpolation_error")),
    )
    intervals = [
        f"K_s/H {_interval(variable_values(file, 'wear_over_hardness_carried')).text} m2/N"
    ]
    if _has_uncertain_friction(file):
        words, unit = _friction_words_and_unit(scene)
        interval = _interval(variable_values(file, "friction_carried")).text
        intervals.insert(0, f"{words} {interval} {unit}".rstrip())
    return (
        "The calibrated scene carries lognormal distributions with the mean and the standard "
        f"deviation of the logarithms; their 90 % intervals are {' and '.join(intervals)}.",
        "Within a batch, two thirds of the lives are within a factor of "
        f"{digits(float(np.exp(scatter)))} of the median.",
        "The error in lives interpolated between friction values is at most "
        f"{plain(100.0 * error, 1)} %.",
        "The probability is that of a deviation from the model at least as large as in the test, "
        "given the other tests.",
    )


def conflicts(file: Any) -> list[str]:
    """Returns a sentence for each disagreement of tests and model that chance hardly explains.

    That is a test with a probability below `_UNLIKELY`, or a mean of K_s/H or friction that the
    tests shift by more than `_FAR` standard deviations.
    """
    sentences = []
    probabilities = variable_values(file, "probability_of_test")
    for label, probability in zip(_test_labels(file), probabilities, strict=True):
        if probability < _UNLIKELY:
            sentences.append(
                f"{label} has a probability of {plain(100.0 * probability, 2)} %, given the model "
                "and the other tests"
            )
    scene = stored_scene(file)
    for name, words in (("wear_moved", "K_s/H"), ("friction_moved", "friction")):
        shift = float(getattr(file, name))
        if abs(shift) > _FAR:
            distance = f"{abs(shift):.2g} standard deviations {'above' if shift > 0 else 'below'}"
            sentences.append(f"{words} from the tests is {distance} the value in {scene['name']}")
    return sentences


def _test_labels(file: Any) -> list[str]:
    """Returns line in the file and kind of result of each test as text: `row 2, torque`."""
    names = [SEEN[int(code)] for code in variable_values(file, "seen")]
    return [
        f"row {int(row)}, {SEEN_AS[name].words}"
        for row, name in zip(variable_values(file, "row"), names, strict=True)
    ]


def _test_rows(file: Any) -> Iterator[Row]:
    """Yields the row of each test: its result, the expected interval and its probability.

    Of a loss or a preload, the label states the result, and the cell the time that it took.
    """
    names = [SEEN[int(code)] for code in variable_values(file, "seen")]
    results, times = (
        variable_values(file, "value").tolist(),
        variable_values(file, "after").tolist(),
    )
    expected, probabilities = (
        variable_values(file, "expected"),
        variable_values(file, "probability_of_test"),
    )
    for k, label in enumerate(_test_labels(file)):
        name, unit = names[k], SEEN_AS[names[k]].unit
        text = digits(float(results[k]))
        if name in (SEEN_LOSS, SEEN_PRELOAD):
            label, text, unit = f"{label} {text} {unit} after", digits(float(times[k])), "h"
        elif name == SEEN_RUN_OUT:
            text = f"> {text}"
        percent = f"{plain(100.0 * probabilities[k], 2)} %"
        yield Row(label, unit, (text, _interval(expected[k]), percent))


def _stage_intervals(file: Any, name: str) -> tuple[Interval, ...]:
    """Returns the intervals from the first to the last quantile of a variable, before and after."""
    return tuple(_interval(quantiles[[0, -1]]) for quantiles in variable_values(file, name))


def _interval(ends: np.ndarray) -> Interval:
    """Returns the interval with a lower and an upper end (2,)."""
    return Interval(*map(float, ends))


def calibration_figure(calibration: xr.Dataset) -> Figure:
    """Returns a figure of friction, K_s/H and life, before and after the tests.

    A known friction has no panel. Lives and run-outs of the tests are marked on the axis of life.
    """
    scene = plain_scene(calibration)
    curves = [_Curve("wear_over_hardness", "wear_density", "K_s/H (m²/N)", _DENSITY)]
    if "friction_density" in calibration:
        words, unit = _friction_words_and_unit(scene)
        label = f"{words} ({unit})" if unit else words
        curves.insert(0, _Curve("friction", "friction_density", label, _DENSITY))
    curves.append(_Curve("hours", "failed_share", "life (h)", "share of failed bearings"))
    figure, axes = new_figure(1, len(curves), 3.2 * len(curves), 3.2)
    for panel, curve in zip(axes[0], curves, strict=True):
        for k, colour in enumerate(_COLOURS.values()):
            ordinates = calibration[curve.name].isel(stage=k)
            panel.plot(calibration[curve.axis], ordinates, color=colour)
        panel.set_xscale("log" if curve.axis != "friction" else "linear")
        panel.set_xlabel(curve.x_label)
        panel.set_ylabel(curve.y_label)
        panel.set_ylim(0.0)
    for code, hours in zip(calibration["seen"].values, calibration["after"].values, strict=True):
        if SEEN[code] in _LIFE_MARKS and np.isfinite(hours):
            axes[0][-1].plot(hours, _MARK_HEIGHT, _LIFE_MARKS[SEEN[code]], color="C3", markersize=5)
    before, after = (
        Interval(*row).text for row in calibration["life_quantile"].values[:, [0, -1]].tolist()
    )
    handles = [
        *(key(stage, color=colour) for stage, colour in _COLOURS.items()),
        key("life in a test", color="C3", linestyle="none", marker="o"),
        key("run-out", color="C3", linestyle="none", marker=">"),
    ]
    lives = f"{before} h before the tests, {after} h after"
    text = f"{scene['name']}: life of 90 % of bearings: {lives}"
    frame(figure, text, handles, columns=4)
    return figure
