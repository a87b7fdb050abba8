"""Blocks of a life over a duty: what each phase adds to the wear, and its worst measures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from bearingwear.document.document import Block, Row, row_of
from bearingwear.document.rows import variable_values
from bearingwear.measures import ENDS, WORST
from bearingwear.results.life_variables import WORN_SURFACES

_HIDDEN = "ball_diameter_loss", "axial_stiffness", "quasistatic_axial_stiffness"
"""Variables of measures without a row, because other rows contain their worst values."""


def phase_blocks(file: Any, scene: Mapping[str, Any]) -> list[Block]:
    """Returns blocks of the phases: shares of time and wear, lives alone, and worst measures.

    Empty for a life without a duty.
    """
    if "phase_time_share" not in file.variables:
        return []
    phases = tuple(str(file.phases).split())
    has_starts = any(phase.get("starts") for phase in scene["duty"]["phases"].values())
    causes_start_wear = bool(np.any(variable_values(file, "start_wear_share") > 0.0))
    all_wear, *surface_wear = _surface_rows(file, "phase_wear_share")
    rows = [*_phase_rows(file, "phase_time_share"), all_wear]
    if causes_start_wear:
        rows += _surface_rows(file, "start_wear_share")[:1]  # of all surfaces
    rows += surface_wear
    if causes_start_wear:
        rows += _phase_rows(file, "acceleration_friction_share")
    lines: tuple[str, ...] = ()
    if has_starts and not causes_start_wear:
        lines = ("duty.start_s and duty.stop_s are 0: starts and stops cause no wear",)
    has_spring = scene["operation"]["preload_method"] == "constant_force"
    hidden = _HIDDEN if has_spring else (*_HIDDEN, "spring_travel")
    worst_rows = [
        row for name in WORST if name not in hidden for row in _phase_rows(file, f"worst_{name}")
    ]
    return [
        Block("phases of the duty", phases, tuple(rows), lines),
        Block(
            "each phase alone, without starts", phases, _life_rows(file), _shorter_life_lines(file)
        ),
        Block("worst in each phase", phases, tuple(worst_rows)),
    ]


def _life_rows(file: Any) -> tuple[Row, ...]:
    """Returns rows of the life in each phase alone, and of the criterion that would end it."""
    codes = file["phase_end_criterion"]
    criteria = np.array(codes.flag_meanings.split())[np.asarray(codes[...], dtype=int)]
    words = tuple(ENDS[name].short if name in ENDS else name for name in criteria)
    return (
        *_phase_rows(file, "phase_life"),
        Row("ended by", "", words, "phase_end_criterion"),
    )


def _shorter_life_lines(file: Any) -> tuple[str, ...]:
    """Returns a line on why the life over the duty is shorter than in any phase alone.

    Empty if it is not shorter. The lives in a phase alone are without starts.
    """
    if not float(variable_values(file, "life")) < np.min(variable_values(file, "phase_life")):
        return ()
    names = str(file.phases).split()
    ending = names[int(variable_values(file, "ending_phase"))]
    shorter = "The life over the duty is shorter than the life in any phase alone."
    if len(names) == 1:
        return (f"{shorter} Starts and stops wear the bearing, too.",)
    starts_wear = np.any(variable_values(file, "start_wear_share") > 0.0)
    all_wear = "All phases, starts and stops wear" if starts_wear else "All phases wear"
    return (
        f"{shorter} {all_wear} the bearing, and phase {ending} meets its criterion at a wear that "
        "the others would survive.",
    )


def _surface_rows(file: Any, name: str) -> list[Row]:
    """Returns a row for each worn surface, with a value for each phase; that of all comes first.

    name: of a variable over phase and surface.
    """
    shares = variable_values(file, name)
    last = len(WORN_SURFACES) - 1  # of all surfaces
    rows = []
    for k in (last, *range(last)):
        row = row_of(name, shares[:, k])
        surface = WORN_SURFACES[k]
        label = row.label if k == last else f"{row.label}, {surface.replace('_', ' ')}"
        rows.append(row._replace(label=label, name=f"{name}.{surface}"))
    return rows


def _phase_rows(file: Any, name: str) -> list[Row]:
    """Returns the row of a variable over the phases, if the file contains it."""
    return [row_of(name, variable_values(file, name))] if name in file.variables else []
