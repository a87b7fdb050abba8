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
from bearingwear.document.rows import values
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.plotting.drawing import Figure, frame, key, new_figure
from bearingwear.results.units import Interval, Rough, display, key_in_words, text_to_error
from bearingwear.results.words import name_in_words, scene_of
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
    """Motions with the share of the runs that end in each, the most frequent first."""
    order = [int(k) for k in np.argsort(-np.asarray(shares), kind="stable") if shares[k] > 0.0]
    return ", ".join(f"{name_in_words(MOTIONS[k])} {100.0 * shares[k]:.0f} %" for k in order)


def ensemble_sheet(file: Any) -> Document:
    """Motions of an ensemble, what they wear, and how long the cage lasts."""
    scene, plan = json.loads(file.scene), json.loads(file.ensemble)
    status = values(file, "status").astype(int)
    share, runs = values(file, "share"), status.size
    heading = [
        f"{scene['name']}: cage, {runs} runs: {shares_in_words(share) or 'no motion'}",
        f"90 % intervals; half-width for the work {'at most' if int(file.met) else 'above'} "
        f"{100.0 * plan['within']:g} %{'' if int(file.met) else f' after {runs} runs'}",
    ]
    facts = {"kind": "cage ensemble", "scene": scene["name"], "runs": runs, "met": int(file.met)}
    blocks = [_motions(file), _means(file), *_life(file)]
    unsolved = [STATUS_NAMES[code] for code in status if code != OK]
    lines = [file.assumed] if file.assumed else []
    unnamed = sum(values(file, "motion")[status != OK] != JAMS)
    if unsolved:
        counted = {name: unsolved.count(name) for name in dict.fromkeys(unsolved)}
        text = ", ".join(f"{name_in_words(name)} {n}" for name, n in counted.items())
        lines.append(
            f"runs not solved: {len(unsolved)} ({text}); motion that could not be classified: "
            f"{unnamed}"
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
    low, high = (factor * values(file, f"mean_{name}_interval")[group]).tolist()
    return Interval(low, high)


def _motions(file: Any) -> Block:
    share, ends = values(file, "share"), values(file, "share_interval")
    work = [values(file, f"mean_{name}") for name in ("pocket_work", "land_work")]
    unit = display("J", *work)
    rows = [
        Row(
            name_in_words(motion),
            "",
            (
                f"{100.0 * share[k]:.0f} %",
                Interval(*(100.0 * ends[k]).tolist()),
                *(float(unit.of(one[k + 1])) for one in work),
                float(values(file, "mean_whirl_ratio")[k + 1]),
            ),
            motion,
        )
        for k, motion in enumerate(MOTIONS)
        if share[k] > 0.0
    ]
    columns = ("of runs", "between, %", f"pockets, {unit.unit}", f"land, {unit.unit}", "whirl")
    return Block("motion", columns, tuple(rows))


def _means(file: Any) -> Block:
    rows = []
    for name, label in _ROWS:
        units = str(file[f"mean_{name}"].units)
        mean = float(values(file, f"mean_{name}")[0])
        unit = display(units, mean)
        shown = (float(unit.of(mean)), _interval(file, name, 0, unit.factor))
        rows.append(Row(label, unit.unit if unit.unit != "1" else "", shown, name))
    return Block("all runs", ("mean", "interval"), tuple(rows))


def _life(file: Any) -> Iterator[Block]:
    """The life of the cage, if that was followed."""
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
            shown = f"{low:.2g} to {high:.2g}", in_hours
            rows.append(Row(f"  90 %, {label}", "", shown, name))
    for k, part in enumerate(WEARING):
        gone = float(values(file, "film_gone")[k])
        if not math.isnan(gone):
            text = "not worn through by the end of the calculation"
            if math.isfinite(gone):
                text = f"worn through after {gone:.3g} turns"
            lines.append(f"film on the {part}: {text}")
    low, high = values(file, "motion_changes").tolist()
    lines.append(
        "no other motion becomes dominant before the end of the calculation"
        if math.isnan(low)
        else f"another motion becomes dominant after {low:.3g} to {high:.3g} turns"
    )
    if "other_hours" in file.variables and math.isfinite(other := values(file, "other_hours")):
        words = key_in_words(CRITERIA[int(values(file, "other_end"))])[0]
        first = "the cage lasts longer" if not hours <= other else "the balls and races last longer"
        ends = Interval(*values(file, "other_hours_interval").tolist())
        lines.append(f"balls and races: {Rough(float(other)).text} h (90 % interval due "
            f"to uncertainty in K_s/H: {ends.text} h), ended by {words}; {first}")  # fmt: skip
    yield Block("cage", ("turns", "h"), tuple(rows), tuple(lines))


def ensemble_figure(found: xr.Dataset) -> Figure:
    """Work in pockets and at the land of every run, by its motion; along a life if there is one."""
    lives = "node_turns" in found and found.sizes["node"] > 1
    figure, panels = new_figure(1, 2 + lives, 3.6 * (2 + lives), 3.4)
    motion = found["motion"].values
    unit = display("J", found["pocket_work"].values, found["land_work"].values)
    torque = display("N m", found["torque_noise"].values)
    pairs = (("pocket_work", "land_work", unit, unit), ("offset", "torque_noise", None, torque))
    for panel, (x_name, y_name, x_unit, y_unit) in zip(panels[0], pairs, strict=False):
        x_unit = x_unit or display("m", found[x_name].values)
        for code, colour in MOTION_COLOURS.items():
            some = motion == code
            panel.plot(
                x_unit.of(found[x_name].values[some]), y_unit.of(found[y_name].values[some]),
                "o", color=colour, markersize=4, fillstyle="none",
            )  # fmt: skip
        panel.set_xlabel(x_unit.label(name_in_words(x_name)))
        panel.set_ylabel(y_unit.label(name_in_words(y_name)))
    if lives:
        _draw_life(panels[0, 2], found)
    seen = [code for code in MOTION_COLOURS if (motion == code).any()]
    handles = [
        key(name_in_words(MOTIONS[code]), color=MOTION_COLOURS[code], linestyle="none", marker="o")
        for code in seen
    ]
    name = scene_of(found)["name"]
    frame(figure, f"{name}: {shares_in_words(found['share'].values)}", handles, 4)
    return figure


def _draw_life(panel: Any, found: xr.Dataset) -> None:
    turns = found["node_turns"].values
    for k, (part, line) in enumerate(zip(WEARING, ("-", "--"), strict=True)):
        depth = 1e6 * found["node_depth"].values[:, k]
        panel.plot(turns, depth, line, color="black", marker=".", label=part)
    panel.set_xlabel("shaft turns")
    panel.set_ylabel("wear depth of the cage (µm)")
    panel.legend()


def within(mean: float, ends: Any, unit: Any) -> str:
    """A mean and its interval in a unit."""
    low, high = (float(unit.of(float(end))) for end in ends)
    number, first, last = (text_to_error(x, 0.5 * (high - low)) for x in (unit.of(mean), low, high))
    return f"{number} ({first} to {last})"
