"""The sheet and the figure of an ensemble of cages, and of the life along it."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.applications.cage.life import WEARING
from bearingwear.applications.cage.motion import HANGS, JAMS, MOTIONS
from bearingwear.document.document import Block, Document, Row
from bearingwear.document.rows import stored_scene, variable_values
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.plotting.drawing import Figure, frame, key, new_figure
from bearingwear.results.units import (
    Display,
    Interval,
    Rough,
    display,
    key_in_words,
    text_to_error,
)
from bearingwear.results.words import name_in_words, plain_scene
from bearingwear.scene.accuracy import CAGE_ERROR, CAGE_TOLERANCE
from bearingwear.scene.blocks import CRITERIA

MOTION_COLOURS = dict(enumerate(("0.85", "C2", "C5", "0.4", "C4", "C3")))

LONG_RUN = 450
"""Shaft turns that a run of a hanging cage needs: every cage of gyro_s1 that hung for thirty turns
had changed its motion by then."""

_ROWS = (
    ("work", "work at the cage per turn"),
    ("pocket_work", "  in the pockets"),
    ("land_work", "  at the land"),
    ("pocket_force", "pocket force, mean"),
    ("pocket_force_99", "pocket force, 99 %"),
    ("land_force", "land force, mean"),
    ("land_force_99", "land force, 99 %"),
    ("shaft_torque", "shaft torque"),
    ("torque_noise", "turn-to-turn noise in the torque"),
    ("whirl_ratio", "whirl rate / shaft speed"),
)


def shares_in_words(shares: Any) -> str:
    """Lists the motions with the share of the runs that end in each, most frequent first.

    Motions without runs are left out; the text is empty if all shares are zero or NaN.

    shares: of each of `MOTIONS`.
    """
    by_frequency = np.argsort(-np.asarray(shares), kind="stable").tolist()
    return ", ".join(
        f"{name_in_words(MOTIONS[code])} {100.0 * shares[code]:.0f} %"
        for code in by_frequency
        if shares[code] > 0.0
    )


def ensemble_sheet(file: Any) -> Document:
    """Returns the sheet of an open file: motions, their wear, and the life of the cage."""
    scene, plan = stored_scene(file), json.loads(file.ensemble)
    share, runs = variable_values(file, "share"), variable_values(file, "status").size
    if file.met:
        width = f"at most {100.0 * plan['within']:g} %"
    else:
        width = f"above {100.0 * plan['within']:g} % after {runs} runs"
    heading = (
        f"{scene['name']}: cage, {runs} runs: {shares_in_words(share) or 'no motion'}",
        f"90 % intervals; half-width for the work {width}",
    )
    facts = {"kind": "cage ensemble", "scene": scene["name"], "runs": runs, "met": int(file.met)}
    blocks = (_motion_block(file), _mean_block(file), *_life_blocks(file))
    lines = _ensemble_lines(file, scene, plan)
    return Document(heading, facts, (*blocks, Block("", lines=tuple(lines))))


def _unsolved_line(file: Any) -> str:
    """Returns a sentence on the runs that were not solved; empty if all were.

    It counts these runs by status, and those without a motion, which are all but jams.
    """
    status = variable_values(file, "status").astype(int)
    unsolved = Counter(STATUS_NAMES[code] for code in status if code != OK)
    if not unsolved:
        return ""
    unclassified = sum(variable_values(file, "motion")[status != OK] != JAMS)
    counts = ", ".join(f"{name_in_words(name)} {count}" for name, count in unsolved.items())
    return (
        f"runs not solved: {unsolved.total()} ({counts}); motion that could not be classified: "
        f"{unclassified}"
    )


def _ensemble_lines(file: Any, scene: Mapping[str, Any], plan: Mapping[str, Any]) -> list[str]:
    """Returns sentences on assumptions, unsolved runs, hanging cages, tolerance and gravity.

    plan: the fields of the `Ensemble`.
    """
    lines = [line for line in (file.assumed, _unsolved_line(file)) if line]
    if variable_values(file, "share")[HANGS] > 0.0 and plan["least_turns"] < LONG_RUN:
        lines.append(
            "the motion of a hanging cage may change after hundreds of turns; use --least-turns "
            f"{LONG_RUN} --turns {LONG_RUN}"
        )
    if tolerance := getattr(file, "dynamic_tolerance", 0.0):
        error = f"{100.0 * CAGE_ERROR:g} %"
        accuracy = (
            f"the work in each motion has an error of up to {error}, not included in its interval"
            if tolerance <= CAGE_TOLERANCE
            else f"the error in the work may exceed {error}; the default tolerance is "
            f"{CAGE_TOLERANCE:g}"
        )
        lines.append(f"step tolerance {tolerance:g}: {accuracy}")
    if not any(scene["operation"].get("gravity_m_s2") or [0.0]):
        lines.append("weightless: operation.gravity_m_s2 is 0")
    return lines


def _interval(file: Any, name: str, group: int, factor: float) -> Interval:
    """Returns the interval of the mean of a variable over a group of runs, times a factor.

    group: 0 for all runs, 1 + code for those of a motion.
    """
    low, high = (factor * variable_values(file, f"mean_{name}_interval")[group]).tolist()
    return Interval(low, high)


def _motion_block(file: Any) -> Block:
    """Returns a block with a row for each motion that occurs: share, work and whirl rate."""
    share, ends = variable_values(file, "share"), variable_values(file, "share_interval")
    work = [variable_values(file, f"mean_{name}") for name in ("pocket_work", "land_work")]
    unit = display("J", *work)
    whirl = variable_values(file, "mean_whirl_ratio")
    rows = []
    for k, motion in enumerate(MOTIONS):
        if share[k] > 0.0:
            interval = Interval(*(100.0 * ends[k]).tolist())
            works = (float(unit.of(mean[k + 1])) for mean in work)  # 0 is the mean of all runs
            cells = (f"{100.0 * share[k]:.0f} %", interval, *works, float(whirl[k + 1]))
            rows.append(Row(name_in_words(motion), "", cells, motion))
    columns = ("of runs", "between, %", f"pockets, {unit.unit}", f"land, {unit.unit}", "whirl")
    return Block("motion", columns, tuple(rows))


def _mean_block(file: Any) -> Block:
    """Returns a block with a row for each of `_ROWS`: the mean over all runs, and its interval."""
    rows = []
    for name, label in _ROWS:
        units = str(file[f"mean_{name}"].units)
        mean = float(variable_values(file, f"mean_{name}")[0])
        unit = display(units, mean)
        cells = (float(unit.of(mean)), _interval(file, name, 0, unit.factor))
        rows.append(Row(label, unit.unit if unit.unit != "1" else "", cells, name))
    return Block("all runs", ("mean", "interval"), tuple(rows))


def _life_blocks(file: Any) -> Iterator[Block]:
    """Yields the block of the cage's life; nothing if no life was computed."""
    if "cage_end" not in file.variables:
        return
    life, hours = (float(variable_values(file, f"cage_{name}")) for name in ("life", "hours"))
    rows = []
    lines = [
        "the end of life was not reached" if math.isnan(life) else f"ended by: {file.cage_ended_by}"
    ]
    if not math.isnan(life):
        rows.append(Row("life of the cage", "", (f"{life:.2g}", Rough(hours)), "cage_life"))
        for name, label in (
            ("cage_life_interval", "scatter between runs only"),
            ("cage_life_interval_with_wear", "scatter between runs and uncertainty in K_s"),
        ):
            low, high = variable_values(file, name).tolist()
            in_hours = Interval(low * hours / life, high * hours / life)
            cells = (f"{low:.2g} to {high:.2g}", in_hours)
            rows.append(Row(f"  90 %, {label}", "", cells, name))
    lines += _film_lines(file)
    low, high = variable_values(file, "motion_changes").tolist()
    lines.append(
        "no other motion becomes dominant before the end of the calculation"
        if math.isnan(low)
        else f"another motion becomes dominant after {low:.3g} to {high:.3g} turns"
    )
    if "other_hours" in file.variables and math.isfinite(variable_values(file, "other_hours")):
        lines.append(_other_life_line(file, hours))
    yield Block("cage", ("turns", "h"), tuple(rows), tuple(lines))


def _film_lines(file: Any) -> Iterator[str]:
    """Yields a sentence for each film of the cage: when it is worn through, or that it is not."""
    for part, turns in zip(WEARING, variable_values(file, "film_gone").tolist(), strict=True):
        if math.isfinite(turns):
            yield f"film on the {part}: worn through after {turns:.3g} turns"
        elif not math.isnan(turns):
            yield f"film on the {part}: not worn through by the end of the calculation"


def _other_life_line(file: Any, cage_hours: float) -> str:
    """Returns a sentence that compares the life of balls and races with that of the cage.

    cage_hours: life of the cage; NaN if it meets no criterion, so that the cage lasts longer.
    """
    hours = float(variable_values(file, "other_hours"))
    interval = Interval(*variable_values(file, "other_hours_interval").tolist())
    criterion = key_in_words(CRITERIA[int(variable_values(file, "other_end"))])[0]
    longer = "the balls and races last" if cage_hours <= hours else "the cage lasts"
    return (
        f"balls and races: {Rough(hours).text} h (90 % interval due to uncertainty in K_s/H: "
        f"{interval.text} h), ended by {criterion}; {longer} longer"
    )


def ensemble_figure(ensemble: xr.Dataset) -> Figure:
    """Returns a figure of every run: work in pockets and at the land, offset and torque noise.

    A third panel shows the wear along a life, if that was computed.
    """
    has_life = "node_turns" in ensemble and ensemble.sizes["node"] > 1
    columns = 3 if has_life else 2
    figure, panels = new_figure(1, columns, 3.6 * columns, 3.4)
    motion = ensemble["motion"].values
    work_unit = display("J", ensemble["pocket_work"].values, ensemble["land_work"].values)
    offset_unit = display("m", ensemble["offset"].values)
    torque_unit = display("N m", ensemble["torque_noise"].values)
    _draw_runs(panels[0, 0], ensemble, {"pocket_work": work_unit, "land_work": work_unit})
    _draw_runs(panels[0, 1], ensemble, {"offset": offset_unit, "torque_noise": torque_unit})
    if has_life:
        _draw_life(panels[0, 2], ensemble)
    codes = [code for code in MOTION_COLOURS if (motion == code).any()]
    handles = [
        key(name_in_words(MOTIONS[code]), color=MOTION_COLOURS[code], linestyle="none", marker="o")
        for code in codes
    ]
    name = plain_scene(ensemble)["name"]
    frame(figure, f"{name}: {shares_in_words(ensemble['share'].values)}", handles, 4)
    return figure


def _draw_runs(panel: Any, ensemble: xr.Dataset, units: Mapping[str, Display]) -> None:
    """Draws two variables of every run against each other, in the colour of its motion.

    Runs without a motion, which were not solved, are left out.

    units: of the variable of the abscissa, then of that of the ordinate, by their names.
    """
    x_name, y_name = units
    for code, colour in MOTION_COLOURS.items():
        runs = ensemble.isel(run=ensemble["motion"].values == code)
        x, y = (unit.of(runs[name].values) for name, unit in units.items())
        panel.plot(x, y, "o", color=colour, markersize=4, fillstyle="none")
    panel.set_xlabel(units[x_name].label(name_in_words(x_name)))
    panel.set_ylabel(units[y_name].label(name_in_words(y_name)))


def _draw_life(panel: Any, ensemble: xr.Dataset) -> None:
    """Draws the wear depths of pockets and land against the turns along the life of a cage."""
    turns = ensemble["node_turns"].values
    for k, (part, dashes) in enumerate(zip(WEARING, ("-", "--"), strict=True)):
        depth_um = 1e6 * ensemble["node_depth"].values[:, k]
        panel.plot(turns, depth_um, dashes, color="black", marker=".", label=part)
    panel.set_xlabel("shaft turns")
    panel.set_ylabel("wear depth of the cage (µm)")
    panel.legend()


def mean_with_interval(mean: float, ends: Iterable[float], unit: Display) -> str:
    """Returns a mean and its interval as text, `1.5 (1.2 to 1.8)`, to the digits of the interval.

    mean, ends: in the unit of files; NaN where not known.
    unit: of the text.
    """
    low, high = (float(unit.of(float(end))) for end in ends)
    half_width = 0.5 * (high - low)
    texts = [text_to_error(number, half_width) for number in (unit.of(mean), low, high)]
    return f"{texts[0]} ({texts[1]} to {texts[2]})"
