"""The sheet of a calibration, and its figure: before and after the tests."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

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
from bearingwear.document.rows import stored_scene, values
from bearingwear.measures import plain
from bearingwear.plotting.drawing import (
    Figure,
    frame,
    key,
    new_figure,
)
from bearingwear.results.units import Interval, digits
from bearingwear.results.words import plain_scene

_UNLIKELY = 0.01
"""Probability below which a test and the model are said to disagree."""

_FAR = 2.58
"""Shift of a mean, in standard deviations before the tests, with a probability of 0.01."""

_COLOURS = dict(zip(STAGES, ("0.6", "black"), strict=True))


def calibration_sheet(file: Any) -> Document:
    """Reports friction, K_s/H and life before and after, the tests, and conflicts."""
    scene = stored_scene(file)
    calibration = scene["calibrated"]
    film = "ball_race" not in scene["friction"]
    friction = ("film shear strength", "MPa") if film else ("friction", "")
    rows = [
        Row(f"{friction[0]}, 90 % of batches", friction[1], _pair(file, "friction_interval")),
        Row("K_s/H, 90 % of batches", "m2/N", _pair(file, "wear_over_hardness_interval")),
        Row("life, 90 % of bearings", "h", _pair(file, "life_quantile", (0, -1)), "life"),
        Row("L10, 90 % of batches", "h", _pair(file, "batch_life_quantile", (0, -1)), "L10"),
    ]
    if "friction_density" not in file.variables:  # its friction is known
        del rows[0]
    heading = (
        f"{scene['name']}: calibrated with {calibration['rows']} "
        f"test{'s' * (calibration['rows'] > 1)} from {calibration['tests']} (SHA-256 "
        f"{calibration['sha256'][:12]})",
        *(f"conflict: {text}" for text in conflicts(file)),
    )
    facts = {"kind": "calibration", "conflicts": conflicts(file), **calibration}
    tests = Block("test", ("seen", "expected", "probability"), tuple(_test_rows(file)))
    scatter, error = float(values(file, "scatter")), float(values(file, "interpolation_error"))
    carried_intervals = [
        f"{words} {_interval(values(file, name)).text}{unit}"
        for words, name, unit in (
            (friction[0], "friction_carried", f" {friction[1]}".rstrip()),
            ("K_s/H", "wear_over_hardness_carried", " m2/N"),
        )
        if name == "wear_over_hardness_carried" or "friction_density" in file.variables
    ]
    summary = (
        "The calibrated scene carries lognormal distributions with the mean and the standard "
        f"deviation of the logarithms; their 90 % intervals are {' and '.join(carried_intervals)}.",
        "Within a batch, two thirds of the lives are within a factor of "
        f"{digits(float(np.exp(scatter)))} of the median.",
        "The error in lives interpolated between friction values is at most "
        f"{plain(100.0 * error, 1)} %.",
        "The probability is that of a deviation from the model at least as large as in the test, "
        "given the other tests.",
    )
    return Document(
        heading,
        facts,
        (Block("coefficients and life", STAGES, tuple(rows)), tests, Block("", lines=summary)),
    )


def conflicts(file: Any) -> list[str]:
    """Lists in words where tests and model disagree by more than chance explains."""
    sentences = []
    for label, share in zip(_labels(file), values(file, "probability_of_test"), strict=True):
        if share < _UNLIKELY:
            sentences.append(
                f"{label} has a probability of {plain(100.0 * share, 2)} %, given the model and "
                "the other tests"
            )
    scene = stored_scene(file)
    for name, words in (("wear_moved", "K_s/H"), ("friction_moved", "friction")):
        shift = float(getattr(file, name))
        if abs(shift) > _FAR:
            distance = f"{abs(shift):.2g} standard deviations {'above' if shift > 0 else 'below'}"
            sentences.append(f"{words} from the tests is {distance} the value in {scene['name']}")
    return sentences


def _labels(file: Any) -> list[str]:
    """Returns row and kind of result of each test."""
    names = [SEEN[int(code)] for code in values(file, "seen")]
    return [
        f"row {int(row)}, {SEEN_AS[name].words}"
        for row, name in zip(values(file, "row"), names, strict=True)
    ]


def _test_rows(file: Any) -> Iterator[Row]:
    """Yields the row of each test: its result, the expected interval and its probability."""
    columns = (values(file, name) for name in ("seen", "value", "after", "expected"))
    tests = zip(_labels(file), *columns, values(file, "probability_of_test"), strict=True)
    for label, code, value, after, expected, probability in tests:
        name = SEEN[int(code)]
        percent = f"{plain(100.0 * probability, 2)} %"
        interval = Interval(*map(float, expected))
        unit = SEEN_AS[name].unit
        if name in (SEEN_LOSS, SEEN_PRELOAD):
            label, value, unit = f"{label} {digits(float(value))} {unit} after", after, "h"
        text = f"> {digits(float(value))}" if name == SEEN_RUN_OUT else digits(float(value))
        yield Row(label, unit, (text, interval, percent))


def _pair(file: Any, name: str, ends: tuple[int, int] = (0, 1)) -> tuple[Interval, ...]:
    """Returns the intervals of a variable before and after."""
    return tuple(_interval(row[list(ends)]) for row in values(file, name))


def _interval(ends: np.ndarray) -> Interval:
    return Interval(*map(float, ends))


def calibration_figure(calibration: xr.Dataset) -> Figure:
    """Draws friction, K_s/H and life, before and after the tests."""
    scene = plain_scene(calibration)
    panels = [("wear_over_hardness", "wear_density", "K_s/H (m²/N)", "density of the logarithm")]
    if "friction_density" in calibration:
        label = "friction" if "ball_race" in scene["friction"] else "film shear strength (MPa)"
        panels.insert(0, ("friction", "friction_density", label, "density of the logarithm"))
    panels.append(("hours", "failed_share", "life (h)", "share of failed bearings"))
    figure, axes = new_figure(1, len(panels), 3.2 * len(panels), 3.2)
    for panel, (axis, name, x_label, y_label) in zip(axes[0], panels, strict=True):
        for k, colour in enumerate(_COLOURS.values()):
            panel.plot(calibration[axis], calibration[name].isel(stage=k), color=colour)
        panel.set_xscale("log" if axis != "friction" else "linear")
        panel.set_xlabel(x_label)
        panel.set_ylabel(y_label)
        panel.set_ylim(0.0)
    for k, time in enumerate(calibration["after"].values):
        if np.isfinite(time) and SEEN[int(calibration["seen"][k])] in (SEEN_LIFE, SEEN_RUN_OUT):
            mark = ">" if SEEN[int(calibration["seen"][k])] == SEEN_RUN_OUT else "o"
            axes[0][-1].plot(time, 0.03, mark, color="C3", markersize=5)
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
