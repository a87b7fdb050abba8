"""The sheet of a scene or of a result: the main numbers and, on request, those of accuracy."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from bearingwear.document.bearing_line import operation_lines
from bearingwear.document.document import Block, Document, Row, quantity_row, row_of
from bearingwear.document.life import life_blocks
from bearingwear.document.pair import blocks_by_bearing, system_blocks
from bearingwear.document.rows import (
    counted_words,
    mean,
    mean_rows,
    rows_with_violations,
    stored_scene,
    variable_limits,
    variable_values,
    without_empty_rows,
)
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.results.contents_view import ContentsView
from bearingwear.results.entries import contents_of
from bearingwear.results.kinds import CASE_KIND, LIFE_KIND, Registry, imported_function, kind_of
from bearingwear.results.life_variables import BEARING_PARTS
from bearingwear.results.netcdf import open_result
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
TEMPERATURES = ("part_temperature", "thermal_growth")
FIT_ROWS = ("growth_by_fit", "fit_pressure")
"""Variables without a row if no ring has an interference fit."""
GROWTH_AT_SPEED = "growth_at_speed"
RINGS = (GROWTH_AT_SPEED, *FIT_ROWS)
CAGE_MEANS = (
    "cage_speed",
    "cage_friction_heat",
    "mean_pocket_torque",
    "mean_land_torque",
    "cage_wear_rate",
    "cage_land_wear_rate",
)


def _other_variables(*dims: tuple[str, ...]) -> tuple[str, ...]:
    """Returns the variables of a case that have a label, but no place of their own in a sheet.

    Those of `DIAGNOSTICS` are left out, too.

    *dims: alternative dimensions of the variables, such as `("ball", "race")`.
    """
    listed = {
        *CONTACT,
        *BEARING,
        *LOSSES,
        *RUN,
        *CAGE_MEANS,
        *TEMPERATURES,
        *RINGS,
        *SYSTEM,
        LOSS_PER_TIME,
    }
    return tuple(
        name
        for name, variable in CASE.items()
        if variable.label and variable.dims in dims and name not in listed | DIAGNOSTICS
    )


def sheet(
    path: str | os.PathLike[str], more: Registry = MappingProxyType({}), every: bool = False
) -> Document:
    """Returns the sheet of a result file of any kind. May raise CaseFileError.

    It contains the spread of lives, if this file or one beside it does.

    more: for the kinds of files that studies define, a function that takes the open file
        (`netCDF4.Dataset`) and returns a `Document`, by its dotted name, `module:function`.
    every: whether to add residuals, error estimates, counts of steps, and versions.
    """
    from bearingwear.document.study import spread_blocks
    from bearingwear.results.quantiles import KIND

    with open_result(path) as file:
        main, spread = _main_sheet(file, more), spread_blocks(file, Path(path))
        if kind_of(file) == KIND:  # the spread comes first, and the other blocks only on request
            blocks = [*spread, *(main.blocks if every else ())]
        else:
            blocks = [*main.blocks, *spread]
        if every:
            blocks += _diagnostic_blocks(file)
        return Document(main.heading, main.facts, tuple(blocks))


def sheet_of_result(result: Result) -> Document:
    """Returns the sheet of a case or life that is not in a file."""
    return _main_sheet(ContentsView(contents_of(result)), {})


def _main_sheet(file: Any, more: Registry) -> Document:
    """Returns the sheet of an open file without the spread of lives and diagnostics.

    more: as in `sheet`.
    """
    kind = kind_of(file)
    if kind in more:
        document: Document = imported_function(more[kind])(file)
        return document
    if kind not in SHEETS:
        from bearingwear.document.study import study_document

        return study_document(file)
    blocks = SHEETS[kind](file)
    if kind == CASE_KIND and int(variable_values(file, "status")) != OK:
        names = _rows_without_solution(file)
        blocks = [
            replace(block, rows=tuple(row for row in block.rows if row.name in names))
            for block in blocks
        ]
    blocks = [without_empty_rows(block) for block in blocks]
    heading, facts = _heading_and_facts(file)
    return Document(
        heading,
        {"kind": kind, **facts},
        tuple(block for block in blocks if block.rows or block.lines),
    )


def _rows_without_solution(file: Any) -> set[str]:
    """Returns the names of the rows of an unsolved case, whose values follow from inputs alone."""
    if stored_scene(file).get("thermal") is None:  # temperatures are inputs
        return {*TURN_COUNTS, *RINGS, *TEMPERATURES}
    return {*TURN_COUNTS, GROWTH_AT_SPEED}


def _heading_and_facts(file: Any) -> tuple[tuple[str, ...], dict[str, Any]]:
    """Returns the heading lines of a case or life, and its facts for programs by their names."""
    scene = stored_scene(file)
    status = STATUS_NAMES[int(variable_values(file, "status"))]
    fidelity = getattr(file, "fidelity", "?")
    # the first of the modelled effects is the model and the reason for it: `steady: REASON`
    why = (json.loads(getattr(file, "modelled", "[]")) or [""])[0].partition(": ")[2]
    warnings = warning_lines({"warnings": getattr(file, "warnings", "[]")})
    reason = f" ({why})" if why else ""
    heading = (
        *(operation_lines(scene) if scene else ()),
        f"model {fidelity}{reason}, status {status}: "
        f"{status_sentence(status, scene)}{_drift_phrase(file)}",
        *warnings,
    )
    facts = {
        "scene": scene.get("name"),
        "fidelity": fidelity,
        "why": why,
        "status": status,
        "warnings": [line.removeprefix(WARNING) for line in warnings],
    }
    return heading, facts


def _drift_phrase(file: Any) -> str:
    """States, after a semicolon, that the averages of a run still drift; empty if they settled."""
    verdict = str(getattr(file, "settled", "")).partition(":")[0]
    return f"; {verdict}" if verdict.startswith("not settled") else ""


def _race_row(file: Any, name: str, limits: Mapping[str, float]) -> Row:
    """Returns a row with a value for each race: the mean of all balls, or their extreme.

    The variables of `EXTREMES` have an extreme.

    limits: by variable [units of the file].
    """
    numbers = variable_values(file, name)
    if not numbers.ndim:  # the file does not contain the variable
        return row_of(name, [math.nan] * len(RACES), limits.get(name))
    by_ball = numbers.reshape(-1, len(RACES))
    row = row_of(name, of_all_balls(name, by_ball, 0), limits.get(name))
    if len(by_ball) > 1 and name in EXTREMES:
        return row._replace(label=f"{row.label}, all balls")
    return row


def _case_blocks(file: Any) -> list[Block]:
    """Returns the blocks of a case: the arrangement, then each bearing."""
    return system_blocks(file) + blocks_by_bearing(file, _bearing_blocks)


def _bearing_blocks(file: Any) -> list[Block]:
    """Returns the blocks of one bearing: contacts, bearing, wear, growth, and dynamic run."""
    balls = file.dimensions["ball"].size
    suffix = f" (mean of {balls} balls)" if balls > 1 else ""
    blocks = [
        Block(f"contact{suffix}", RACES, rows_with_violations(_contact_rows(file), file)),
        Block(f"bearing{suffix}", (), rows_with_violations(_bearing_rows(file), file)),
    ]
    if LOSS_PER_TIME in file.variables:
        rate = row_of(LOSS_PER_TIME, [variable_values(file, LOSS_PER_TIME)])
        counted = counted_words(stored_scene(file))
        blocks.append(Block(f"wear of {counted}", (), (rate,)))
    blocks += _growth_blocks(file)
    if getattr(file, "fidelity", None) == "dynamic":
        blocks += _dynamic_blocks(file)
    return blocks


def _contact_rows(file: Any) -> list[Row]:
    """Returns a row for each quantity of the contacts, with a value for each race.

    Quantities of `CONTACT` that the file lacks have NaN, except the range of the load.
    """
    limits, other_variables = variable_limits(file), _other_variables(("ball", "race"))
    optional = {*LOAD_RANGE, *other_variables}
    return [
        _race_row(file, name, limits)
        for name in (*CONTACT, *other_variables)
        if name not in optional or name in file.variables
    ]


def _bearing_rows(file: Any) -> tuple[Row, ...]:
    """Returns a row for each quantity of the bearing, with the mean of a quantity of balls."""
    return (
        *mean_rows(file, BEARING, variable_limits(file)),
        quantity_row("friction power", "W", [_friction_power(file)], "friction_power"),
        *mean_rows(file, (*LOSSES, *_other_variables((), ("ball",)))),
        *_stiffness_rows(file),
    )


def _stiffness_rows(file: Any) -> tuple[Row, ...]:
    """Returns rows of the dynamic radial and tilting stiffness, each the mean of both directions.

    Empty if the file contains no stiffness matrix.
    """
    if "stiffness_matrix" not in file.variables:
        return ()
    # the diagonal has one axial, two radial and two tilting stiffnesses
    diagonal = np.diagonal(variable_values(file, "stiffness_matrix"))
    radial, tilting = float(diagonal[1:3].mean()), float(diagonal[3:5].mean())
    return (
        quantity_row("dynamic radial stiffness", "N m-1", [radial], "radial_stiffness"),
        quantity_row("dynamic tilting stiffness", "N m rad-1", [tilting], "tilting_stiffness"),
    )


def _friction_power(file: Any) -> float:
    """Returns the sum of the powers of friction, at all contacts and the cage, and of drag [W].

    Drag and cage count as zero if they were not computed.
    """
    heat = variable_values(file, "friction_heat")
    balls_per_value = getattr(file["ball"], "represents", 1) if "ball" in file.variables else 1
    cage = variable_values(file, "cage_friction_heat")
    drag = variable_values(file, "drag_power")
    return float(heat.sum() * balls_per_value + np.nan_to_num(drag) + np.nan_to_num(cage))


def _dynamic_blocks(file: Any) -> list[Block]:
    """Returns the blocks of the run and, if it has results, of the cage of a dynamic case."""
    settled = (str(file.settled),) if hasattr(file, "settled") else ()
    blocks = [Block("dynamic run", (), mean_rows(file, RUN), settled)]
    cage = mean_rows(file, CAGE_MEANS)
    if "cage_speed" in file.variables:
        ratio = mean(variable_values(file, "cage_speed")) / mean(
            variable_values(file, "orbit_speed")
        )
        cage += (Row("speed / orbit speed", "", (ratio,), "cage_speed_ratio"),)
    return [*blocks, *([Block("cage", (), cage)] if cage else [])]


def _growth_blocks(file: Any) -> list[Block]:
    """Returns blocks of temperature and growth of all parts, and of growth and fits of rings.

    A block is left out if the file contains none of its variables.
    """
    parts = _growth_block(file, "parts", BEARING_PARTS, TEMPERATURES)
    if parts is not None and hasattr(file, "preload_spread"):
        parts = replace(parts, lines=(str(file.preload_spread),))
    rings = _growth_block(file, "rings", RACES, RINGS)
    return [block for block in (parts, rings) if block is not None]


def _growth_block(
    file: Any, title: str, parts: Sequence[str], names: Sequence[str]
) -> Block | None:
    """Returns a block of variables over `parts`, with a column for each part that has values.

    The first variable decides which parts have values. The variables of `FIT_ROWS` are left out if
    they are zero. Returns None if no variable is left.

    names: of the variables, each over `parts`.
    """
    by_name = {}
    for name in names:
        if name in file.variables:
            numbers = variable_values(file, name)
            if name not in FIT_ROWS or any(numbers):
                by_name[name] = numbers
    if not by_name:
        return None
    is_known = np.isfinite(next(iter(by_name.values())))  # shaft and housing need not be
    columns = tuple(
        part.replace("_", " ") for part, has_value in zip(parts, is_known, strict=True) if has_value
    )
    rows = tuple(row_of(name, numbers[is_known]) for name, numbers in by_name.items())
    return Block(title, columns, rows)


def _diagnostic_blocks(file: Any) -> list[Block]:
    """Returns blocks of residuals and error estimates, modelled effects, and provenance.

    Variables with more values than there are races are left out, and so are NaN and empty blocks.
    """
    rows = []
    for name in file.variables:
        if name in DIAGNOSTICS:
            numbers = variable_values(file, name)
            finite = numbers[np.isfinite(numbers)].ravel()
            if numbers.size <= len(RACES) and finite.size:
                rows.append(row_of(name, finite))
    in_other_parts = {
        "scene", "warnings", "modelled", "title", "comment", "references", "Conventions",
    }  # fmt: skip
    provenance = tuple(
        f"{name}: {_attribute_text(file.getncattr(name))}"
        for name in file.ncattrs()
        if name not in in_other_parts
    )
    blocks = (
        Block("accuracy of the solution", (), tuple(rows)),
        Block("modelled effects", lines=tuple(json.loads(getattr(file, "modelled", "[]")))),
        Block("provenance", lines=provenance),
    )
    return [block for block in blocks if block.rows or block.lines]


def _attribute_text(value: Any) -> str:
    """Returns an attribute as text, a float with three digits."""
    if isinstance(value, float | np.floating):
        return digits(float(value))
    return str(value)


SHEETS: Mapping[str, Callable[[Any], list[Block]]] = {
    CASE_KIND: _case_blocks,
    LIFE_KIND: life_blocks,
}
"""Functions that return the blocks of an open file, for kinds that no study defines."""


def scene_sheet(scene: Scene) -> Document:
    """Returns the sheet of a scene: dimensions, materials, and end-of-life criteria."""
    end_of_life = scene.wear.end_of_life
    limits = end_of_life.criteria if end_of_life is not None else {}
    criteria = tuple(Row(name, "", (limit,)) for name, limit in limits.items())
    blocks = (
        Block("bearing", (), _dimension_rows(scene), given=True),
        Block("material", ("E, GPa", "H, GPa", "K_s"), _material_rows(scene), given=True),
        Block("end-of-life criteria", (), criteria or (Row("none given"),), given=True),
    )
    return Document(operation_lines(scene.plain), {"kind": "scene", "scene": scene.name}, blocks)


def _dimension_rows(scene: Scene) -> tuple[Row, ...]:
    """Returns rows of the dimensions of a bearing, its clearance, ball mass and speed factor.

    The diametral clearance follows from the free contact angle: 2 (r_i + r_o - D) (1 - cos alpha).
    """
    bearing = scene.bearing
    diameter = bearing.ball_diameter_mm
    density = scene.materials[bearing.ball_material].density_kg_m3
    ball_kg = density * math.pi / 6.0 * diameter**3 * 1e-9
    centres_mm = (bearing.inner_groove_factor + bearing.outer_groove_factor - 1.0) * diameter
    clearance_um = 2e3 * centres_mm * (1.0 - math.cos(math.radians(bearing.contact_angle_deg)))
    speed = scene.operation.shaft_speed_rpm * bearing.pitch_diameter_mm
    return (
        Row("ball diameter", "mm", (diameter,)),
        Row("pitch diameter", "mm", (bearing.pitch_diameter_mm,)),
        Row("free contact angle", "degree", (bearing.contact_angle_deg,)),
        Row("groove factor, inner", "", (bearing.inner_groove_factor,)),
        Row("groove factor, outer", "", (bearing.outer_groove_factor,)),
        Row("diametral clearance", "um", (clearance_um,)),
        Row("ball mass", "g", (1e3 * ball_kg,)),
        Row("speed x pitch diameter", "mm/min", (speed,)),
    )


def _material_rows(scene: Scene) -> tuple[Row, ...]:
    """Returns rows of balls and races: Young's modulus [GPa], hardness [GPa], and K_s [1]."""
    rows = []
    for part, name in (
        ("balls", scene.bearing.ball_material),
        ("races", scene.bearing.race_material),
    ):
        material = scene.materials[name]
        rows.append(
            Row(
                f"{part}: {name}",
                "",
                (
                    material.youngs_modulus_GPa,
                    material.brinell_hardness_GPa,
                    material.wear_coefficient,
                ),
            )
        )
    return tuple(rows)
