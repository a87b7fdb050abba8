"""The sheet of a scene or of a result file: the numbers that matter, and on request accuracy."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from bearingwear.document.bearing_line import operation_lines
from bearingwear.document.document import Block, Document, Row, quantity_row, row_of
from bearingwear.document.life import life_blocks
from bearingwear.document.pair import of_bearings, system_blocks
from bearingwear.document.rows import (
    counted_words,
    limits_of_rows,
    marked,
    mean,
    mean_rows,
    solved_rows,
    values,
)
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.results.kinds import CASE_KIND, LIFE_KIND, Registry, function, kind_of
from bearingwear.results.life_variables import BEARING_PARTS
from bearingwear.results.netcdf import in_memory, opened
from bearingwear.results.pair_variables import SYSTEM
from bearingwear.results.units import digits
from bearingwear.results.variables import CASE, DIAGNOSTICS, EXTREMES, RACES, of_all_balls
from bearingwear.results.warnings import WARNING, warning_lines
from bearingwear.solvers.result import status_sentence

if TYPE_CHECKING:
    from bearingwear.scene.scene import Scene
    from bearingwear.solvers.result import Result

# Variables, in the order of their rows; labels and units are in the table of variables.
LOAD_RANGE = ("maximum_contact_load", "minimum_contact_load")
CONTACT = (
    "contact_load",
    *LOAD_RANGE,
    "contact_angle",
    "maximum_pressure",
    "semi_major_axis",
    "semi_minor_axis",
    "qv",
    "friction_heat",
    "gyroscopic_slip_share",
    "friction_coefficient",
    "spin_to_roll_ratio",
    "race_wear_rate",
    "ball_pass_frequency",
)
BEARING = (
    "residual_preload",
    "axial_displacement",
    "quasistatic_axial_stiffness",
    "axial_stiffness",
    "stiffness_transition_frequency",
    "orbit_speed",
    "skid_ratio",
    "friction_used_by_gyroscopic_moment",
    "total_qv",
    "shaft_torque",
)
LOSSES = ("drag_power", "ball_wear_rate", "cage_frequency", "ball_spin_frequency")
LOSS_PER_TIME = "ball_diameter_loss_rate"
TURN_COUNTS = ("simulated_turns", "evaluated_turns")
RUN = (
    *TURN_COUNTS,
    "qv_drift_per_turn",
    "wear_rate_drift_per_turn",
    "spacing_growth_per_turn",
    "disturbance_growth_per_turn",
    "slow_time_scale",
)
WARMTH = ("part_temperature", "thermal_growth")
FIT_ROWS = ("growth_by_fit", "fit_pressure")
"""Rows that are left out where no ring is tight on its seat."""
RINGS = ("growth_at_speed", *FIT_ROWS)
CAGE_MEANS = (
    "cage_speed",
    "cage_friction_heat",
    "mean_pocket_torque",
    "mean_land_torque",
    "cage_wear_rate",
    "cage_land_wear_rate",
)


def _further(*dims: tuple[str, ...]) -> tuple[str, ...]:
    """Variables with a label that have no row of their own above."""
    placed = {
        *CONTACT,
        *BEARING,
        *LOSSES,
        *RUN,
        *CAGE_MEANS,
        *WARMTH,
        *RINGS,
        *SYSTEM,
        LOSS_PER_TIME,
    }
    return tuple(
        name
        for name, one in CASE.items()
        if one.label and one.dims in dims and name not in placed | DIAGNOSTICS
    )


def sheet(
    path: str | os.PathLike[str], more: Registry = MappingProxyType({}), every: bool = False
) -> Document:
    """The sheet of a result file of any kind.

    more: for kinds of files that a study defines: a function that takes the open file
        (`netCDF4.Dataset`) and returns a `Document`, which it may make of `values` and `row_of`.
    every: with residuals, error estimates, counts of steps, versions.
    May raise CaseFileError.
    """
    from bearingwear.document.study import quantile_blocks
    from bearingwear.results.quantiles import KIND

    with opened(path) as file:
        made, spread = _sheet(file, more), quantile_blocks(file, Path(path))
        if kind_of(file) == KIND:  # what it holds besides is for those who ask
            made, spread = replace(made, blocks=tuple(spread)), list(made.blocks if every else ())
        further = [*spread, *(_diagnostics(file) if every else [])]
        return Document(made.heading, made.facts, (*made.blocks, *further))


def sheet_of_result(result: Result) -> Document:
    """The sheet of a case or life that is in no file."""
    with in_memory(result) as file:
        return _sheet(file, {})


def _sheet(file: Any, more: Registry) -> Document:
    kind = kind_of(file)
    if kind in more:
        made: Document = function(more[kind])(file)
        return made
    if kind in SHEETS:
        blocks = SHEETS[kind](file)
        if kind == CASE_KIND and int(values(file, "status")) != OK:
            blocks = [_known_unsolved(block, file) for block in blocks]
        known = tuple(block for block in map(solved_rows, blocks) if block.rows or block.lines)
        heading, facts = _heading(file)
        return Document(heading, {"kind": kind, **facts}, known)
    from bearingwear.document.study import several

    return several(file)


def _known_unsolved(block: Block, file: Any) -> Block:
    """What of a block holds though the case was not solved: nothing that was to be verified."""
    given = json.loads(getattr(file, "scene", "{}")).get("thermal") is None
    known = {*TURN_COUNTS, *(RINGS if given else RINGS[:1]), *(WARMTH if given else ())}
    return replace(block, rows=tuple(row for row in block.rows if row.name in known))


def _heading(file: Any) -> tuple[tuple[str, ...], dict[str, Any]]:
    """Heading lines, and the same as facts for programs."""
    scene = json.loads(getattr(file, "scene", "{}"))
    status = STATUS_NAMES[int(values(file, "status"))]
    fidelity = getattr(file, "fidelity", "?")
    why = (json.loads(getattr(file, "modelled", "[]")) or [""])[0].partition(": ")[2]
    attributes = {"warnings": getattr(file, "warnings", "[]")}
    lines = [
        *(operation_lines(scene) if scene else ()),
        f"model {fidelity}{f' ({why})' if why else ''}, status {status}: "
        f"{status_sentence(status, scene)}{_not_settled(file)}",
        *warning_lines(attributes),
    ]
    facts = {
        "scene": scene.get("name"),
        "fidelity": fidelity,
        "why": why,
        "status": status,
        "warnings": [text.removeprefix(WARNING) for text in warning_lines(attributes)],
    }
    return tuple(lines), facts


def _not_settled(file: Any) -> str:
    """What the first line adds for a run whose averages still drift."""
    verdict = str(getattr(file, "settled", "")).partition(":")[0]
    return f"; {verdict}" if verdict.startswith("not settled") else ""


def _race_row(file: Any, name: str, limits: Mapping[str, float]) -> Row:
    """Of all balls, the mean; of an extreme, the largest or the smallest."""
    found = values(file, name)
    of_all = found.reshape(-1, len(RACES)) if found.ndim else np.full((1, len(RACES)), np.nan)
    made = row_of(name, of_all_balls(name, of_all, 0), limits.get(name))
    several = found.ndim > 1 and found.shape[0] > 1 and name in EXTREMES
    return made._replace(label=f"{made.label}, all balls") if several else made


def _case(file: Any) -> list[Block]:
    """Blocks of a case."""
    return system_blocks(file) + of_bearings(file, _case_of)


def _case_of(file: Any) -> list[Block]:
    limits = limits_of_rows(file)
    balls = file.dimensions["ball"].size
    mean_of = f" (mean of {balls} balls)" if balls > 1 else ""
    contacts = (*CONTACT, *(name for name in _further(("ball", "race")) if name in file.variables))
    names = [name for name in contacts if name not in LOAD_RANGE or name in file.variables]
    contact = tuple(_race_row(file, name, limits) for name in names)
    bearing = (
        *mean_rows(file, BEARING, limits),
        quantity_row("friction power", "W", [_friction_power(file)], "friction_power"),
        *mean_rows(file, (*LOSSES, *_further((), ("ball",)))),
        *_stiffness_rows(file),
    )
    blocks = [
        Block(f"contact{mean_of}", RACES, marked(contact, file)),
        Block(f"bearing{mean_of}", (), marked(bearing, file)),
    ]
    if LOSS_PER_TIME in file.variables:
        rate = row_of(LOSS_PER_TIME, [values(file, LOSS_PER_TIME)])
        words = counted_words(json.loads(getattr(file, "scene", "{}")))
        blocks.append(Block(f"wear of {words}", (), (rate,)))
    blocks += _grown(file)
    return blocks + (_dynamics(file) if getattr(file, "fidelity", None) == "dynamic" else [])


def _stiffness_rows(file: Any) -> tuple[Row, ...]:
    """Dynamic radial and tilting stiffness, each the mean of both directions."""
    if "stiffness_matrix" not in file.variables:
        return ()
    each = np.diagonal(values(file, "stiffness_matrix"))
    units = {"radial": ("N m-1", each[1:3]), "tilting": ("N m rad-1", each[3:5])}
    return tuple(
        quantity_row(f"dynamic {way} stiffness", unit, [bearings.mean()], f"{way}_stiffness")
        for way, (unit, bearings) in units.items()
    )


def _friction_power(file: Any) -> float:
    """Power of friction in the contacts, drag and cage [W]."""
    heat = values(file, "friction_heat")
    alike = getattr(file["ball"], "represents", 1) if "ball" in file.variables else 1
    cage = values(file, "cage_friction_heat")
    drag = values(file, "drag_power")
    return float(heat.sum() * alike + np.nan_to_num(drag) + np.nan_to_num(cage))


def _dynamics(file: Any) -> list[Block]:
    """Blocks that only a dynamic case has."""
    settled = (str(file.settled),) if hasattr(file, "settled") else ()
    blocks = [Block("dynamic run", (), mean_rows(file, RUN), settled)]
    cage = mean_rows(file, CAGE_MEANS)
    if "cage_speed" in file.variables:
        ratio = mean(values(file, "cage_speed")) / mean(values(file, "orbit_speed"))
        cage += (Row("speed / orbit speed", "", (ratio,), "cage_speed_ratio"),)
    return [*blocks, *([Block("cage", (), cage)] if cage else [])]


def _grown(file: Any) -> list[Block]:
    """Block of growth by heat, speed and fits."""
    blocks = []
    for title, columns, names in (("parts", BEARING_PARTS, WARMTH), ("rings", RACES, RINGS)):
        found = [(name, values(file, name)) for name in names if name in file.variables]
        found = [
            (name, of_parts) for name, of_parts in found if name not in FIT_ROWS or any(of_parts)
        ]
        if found:
            known = np.isfinite(found[0][1])  # shaft and housing need not be
            heads = tuple(c.replace("_", " ") for c, k in zip(columns, known, strict=True) if k)
            said = (str(file.preload_spread),) if hasattr(file, "preload_spread") else ()
            rows = tuple(row_of(n, v[known]) for n, v in found)
            blocks.append(Block(title, heads, rows, said if title == "parts" else ()))
    return blocks


def _diagnostics(file: Any) -> list[Block]:
    """How well a result was solved, and what made it."""
    found = ((name, values(file, name)) for name in file.variables if name in DIAGNOSTICS)
    rows = (row_of(name, v[np.isfinite(v)].ravel()) for name, v in found if v.size <= len(RACES))
    elsewhere = ("scene", "warnings", "modelled", "title", "comment", "references", "Conventions")
    names = [name for name in file.ncattrs() if name not in elsewhere]
    attributes = tuple(f"{name}: {_short(file.getncattr(name))}" for name in names)
    blocks = (
        Block("accuracy of the solution", (), tuple(row for row in rows if row.values)),
        Block("modelled effects", lines=tuple(json.loads(getattr(file, "modelled", "[]")))),
        Block("provenance", lines=attributes),
    )
    return [block for block in blocks if block.rows or block.lines]


def _short(value: Any) -> str:
    if isinstance(value, float | np.floating):
        return digits(float(value))
    return str(value)


SHEETS: Mapping[str, Callable[[Any], list[Block]]] = {CASE_KIND: _case, LIFE_KIND: life_blocks}
"""Of the kinds that are not shown like any file of a study."""


def scene_sheet(scene: Scene) -> Document:
    """The main numbers of a scene."""
    b, m = scene.bearing, scene.materials
    angle = math.radians(b.contact_angle_deg)
    mass = m[b.ball_material].density_kg_m3 * math.pi / 6.0 * b.ball_diameter_mm**3 * 1e-9
    groove = (b.inner_groove_factor + b.outer_groove_factor - 1.0) * b.ball_diameter_mm
    end = scene.wear.end_of_life
    limits = end.criteria if end is not None else {}
    speed = scene.operation.shaft_speed_rpm
    bearing = (
        Row("ball diameter", "mm", (b.ball_diameter_mm,)),
        Row("pitch diameter", "mm", (b.pitch_diameter_mm,)),
        Row("free contact angle", "degree", (b.contact_angle_deg,)),
        Row("groove factor, inner", "", (b.inner_groove_factor,)),
        Row("groove factor, outer", "", (b.outer_groove_factor,)),
        Row("diametral clearance", "um", (2e3 * groove * (1.0 - math.cos(angle)),)),
        Row("ball mass", "g", (1e3 * mass,)),
        Row("speed x pitch diameter", "mm/min", (speed * b.pitch_diameter_mm,)),
    )
    materials = tuple(
        Row(
            f"{part}: {name}",
            "",
            (m[name].youngs_modulus_GPa, m[name].brinell_hardness_GPa, m[name].wear_coefficient),
        )
        for part, name in (("balls", b.ball_material), ("races", b.race_material))
    )
    ends = tuple(Row(name, "", (value,)) for name, value in limits.items()) or (Row("none given"),)
    blocks = (
        Block("bearing", (), bearing, given=True),
        Block("material", ("E, GPa", "H, GPa", "K_s"), materials, given=True),
        Block("end-of-life criteria", (), ends, given=True),
    )
    return Document(
        operation_lines(scene.to_dict()), {"kind": "scene", "scene": scene.name}, blocks
    )
