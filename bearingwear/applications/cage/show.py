"""The sheet and the figure of an ensemble of cages, and of the life along it."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.applications.cage.life import WEARING
from bearingwear.applications.cage.motion import HANGS, JAMS, MOTIONS
from bearingwear.document.document import Block, Document, Row
from bearingwear.document.rows import stored_scene, values
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.plotting.drawing import Figure, frame, key, new_figure
from bearingwear.results.units import Interval, Rough, display, key_in_words, text_to_error
from bearingwear.results.words import name_in_words, plain_scene
from bearingwear.scene.accuracy import CAGE_ERROR, CAGE_TOLERANCE
from bearingwear.scene.blocks import CRITERIA

MOTION_COLOURS = dict(enumerate(("0.85", "C2", "C5", "0.4", "C4", "C3")))

LONG_RUN = 450
"""Shaft turns in which every cage of gyro_s1 that hung for thirty has changed."""

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
    """Lists the motions with the share of the runs that end in each, most frequent first."""
    codes = [
        int(code) for code in np.argsort(-np.asarray(shares), kind="stable") if shares[code] > 0.0
    ]
    return ", ".join(
        f"{name_in_words(MOTIONS[code])} {100.0 * shares[code]:.0f} %" for code in codes
    )


def ensemble_sheet(file: Any) -> Document:
    """Reports the motions of an ensemble, their wear, and the life of the cage."""
    scene, plan = stored_scene(file), json.loads(file.ensemble)
    status = values(file, "status").astype(int)
    share, runs = values(file, "share"), status.size
    heading = [
        f"{scene['name']}: cage, {runs} runs: {shares_in_words(share) or 'no motion'}",
        f"90 % intervals; half-width for the work {'at most' if int(file.met) else 'above'} "
        f"{100.0 * plan['within']:g} %{'' if int(file.met) else f' after {runs} runs'}",
    ]
    facts = {"kind": "cage ensemble", "scene": scene["name"], "runs": runs, "met": int(file.met)}
    blocks = [_motion_block(file), _mean_block(file), *_life_blocks(file)]
    unsolved = [STATUS_NAMES[code] for code in status if code != OK]
    lines = [file.assumed] if file.assumed else []
    unclassified = sum(values(file, "motion")[status != OK] != JAMS)
    if unsolved:
        counted = {name: unsolved.count(name) for name in dict.fromkeys(unsolved)}
        counts = ", ".join(f"{name_in_words(name)} {n}" for name, n in counted.items())
        lines.append(
            f"runs not solved: {len(unsolved)} ({counts}); motion that could not be classified: "
            f"{unclassified}"
        )
    if share[HANGS] > 0.0 and plan["least_turns"] < LONG_RUN:
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
    return Document(tuple(heading), facts, (*blocks, Block("", lines=tuple(lines))))


def _interval(file: Any, name: str, group: int, factor: float) -> Interval:
    """Returns the interval of a mean in another unit."""
    low, high = (factor * values(file, f"mean_{name}_interval")[group]).tolist()
    return Interval(low, high)


def _motion_block(file: Any) -> Block:
    """Returns a row for each motion that occurs: share, work and whirl rate."""
    share, ends = values(file, "share"), values(file, "share_interval")
    work = [values(file, f"mean_{name}") for name in ("pocket_work", "land_work")]
    unit = display("J", *work)
    whirl = values(file, "mean_whirl_ratio")
    rows = []
    for k, motion in enumerate(MOTIONS):
        if share[k] > 0.0:
            interval = Interval(*(100.0 * ends[k]).tolist())
            works = (float(unit.of(mean[k + 1])) for mean in work)
            cells = (f"{100.0 * share[k]:.0f} %", interval, *works, float(whirl[k + 1]))
            rows.append(Row(name_in_words(motion), "", cells, motion))
    columns = ("of runs", "between, %", f"pockets, {unit.unit}", f"land, {unit.unit}", "whirl")
    return Block("motion", columns, tuple(rows))


def _mean_block(file: Any) -> Block:
    """Returns a row for each mean over all runs, with its interval."""
    rows = []
    for name, label in _ROWS:
        units = str(file[f"mean_{name}"].units)
        mean = float(values(file, f"mean_{name}")[0])
        unit = display(units, mean)
        cells = (float(unit.of(mean)), _interval(file, name, 0, unit.factor))
        rows.append(Row(label, unit.unit if unit.unit != "1" else "", cells, name))
    return Block("all runs", ("mean", "interval"), tuple(rows))


def _life_blocks(file: Any) -> Iterator[Block]:
    """Yields the block of the cage's life, if that was computed."""
    if "cage_end" not in file.variables:
        return
    life, hours = (float(values(file, f"cage_{name}")) for name in ("life", "hours"))
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
            low, high = values(file, name).tolist()
            in_hours = Interval(low * hours / life, high * hours / life)
            cells = f"{low:.2g} to {high:.2g}", in_hours
            rows.append(Row(f"  90 %, {label}", "", cells, name))
    lines += _film_lines(file)
    low, high = values(file, "motion_changes").tolist()
    lines.append(
        "no other motion becomes dominant before the end of the calculation"
        if math.isnan(low)
        else f"another motion becomes dominant after {low:.3g} to {high:.3g} turns"
    )
    if "other_hours" in file.variables and math.isfinite(values(file, "other_hours")):
        lines.append(_other_life_line(file, hours))
    yield Block("cage", ("turns", "h"), tuple(rows), tuple(lines))


def _film_lines(file: Any) -> Iterator[str]:
    """States when each film of the cage is worn through."""
    for part, turns in zip(WEARING, values(file, "film_gone").tolist(), strict=True):
        if math.isfinite(turns):
            yield f"film on the {part}: worn through after {turns:.3g} turns"
        elif not math.isnan(turns):
            yield f"film on the {part}: not worn through by the end of the calculation"


def _other_life_line(file: Any, cage_hours: float) -> str:
    """Compares the life of balls and races with that of the cage."""
    hours = float(values(file, "other_hours"))
    interval = Interval(*values(file, "other_hours_interval").tolist())
    criterion = key_in_words(CRITERIA[int(values(file, "other_end"))])[0]
    longer = "the balls and races last" if cage_hours <= hours else "the cage lasts"
    return (
        f"balls and races: {Rough(hours).text} h (90 % interval due to uncertainty in K_s/H: "
        f"{interval.text} h), ended by {criterion}; {longer} longer"
    )


def ensemble_figure(ensemble: xr.Dataset) -> Figure:
    """Draws the work in pockets and at the land of every run, and the wear along a life."""
    has_life = "node_turns" in ensemble and ensemble.sizes["node"] > 1
    figure, panels = new_figure(1, 2 + has_life, 3.6 * (2 + has_life), 3.4)
    motion = ensemble["motion"].values
    unit = display("J", ensemble["pocket_work"].values, ensemble["land_work"].values)
    torque = display("N m", ensemble["torque_noise"].values)
    pairs = (("pocket_work", "land_work", unit, unit), ("offset", "torque_noise", None, torque))
    for panel, (x_name, y_name, x_unit, y_unit) in zip(panels[0], pairs, strict=False):
        x_unit = x_unit or display("m", ensemble[x_name].values)
        for code, colour in MOTION_COLOURS.items():
            in_motion = motion == code
            x, y = (ensemble[name].values[in_motion] for name in (x_name, y_name))
            panel.plot(
                x_unit.of(x), y_unit.of(y), "o", color=colour, markersize=4, fillstyle="none"
            )
        panel.set_xlabel(x_unit.label(name_in_words(x_name)))
        panel.set_ylabel(y_unit.label(name_in_words(y_name)))
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


def _draw_life(panel: Any, ensemble: xr.Dataset) -> None:
    """Draws the wear depths along the life of a cage."""
    turns = ensemble["node_turns"].values
    for k, (part, line) in enumerate(zip(WEARING, ("-", "--"), strict=True)):
        depth = 1e6 * ensemble["node_depth"].values[:, k]
        panel.plot(turns, depth, line, color="black", marker=".", label=part)
    panel.set_xlabel("shaft turns")
    panel.set_ylabel("wear depth of the cage (µm)")
    panel.legend()


def mean_with_interval(mean: float, ends: Any, unit: Any) -> str:
    """Writes a mean and its interval in a unit."""
    low, high = (float(unit.of(float(end))) for end in ends)
    number, first, last = (text_to_error(x, 0.5 * (high - low)) for x in (unit.of(mean), low, high))
    return f"{number} ({first} to {last})"
