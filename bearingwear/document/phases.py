"""Blocks of a life over a duty: what each phase adds to the wear, and its worst measures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from bearingwear.document.document import Block, Row, row_of
from bearingwear.document.rows import values
from bearingwear.measures import ENDS, WORST
from bearingwear.results.life_variables import WORN_SURFACES

_HIDDEN = "ball_diameter_loss", "axial_stiffness", "quasistatic_axial_stiffness"
"""Worst values that other rows say."""


def phase_blocks(file: Any, scene: Mapping[str, Any]) -> list[Block]:
    """Shares of time and wear by phase, the lives of the phases alone, and their worst measures."""
    if "phase_time_share" not in file.variables:
        return []
    names = tuple(str(file.phases).split())
    wear, starts = (values(file, f"{one}_wear_share") for one in ("phase", "start"))
    rows = [row_of("phase_time_share", values(file, "phase_time_share"))]
    rows += _by_surface("phase_wear_share", wear)
    lines = []
    if np.any(starts > 0.0):
        rows += _by_surface("start_wear_share", starts)
        rows += _rows(file, "acceleration_friction_share")
    elif any(phase.get("starts") for phase in scene["duty"]["phases"].values()):
        lines.append("duty.start_s and duty.stop_s are 0: starts and stops cause no wear")
    alone = _rows(file, "phase_life")
    codes = file["phase_end_criterion"]
    criteria = np.array(codes.flag_meanings.split())[np.asarray(codes[...], dtype=int)]
    words = tuple(ENDS[one].short if one in ENDS else one for one in criteria)
    alone.append(Row("ended by", "", words, "phase_end_criterion"))
    worst = [row for name in WORST if name not in _HIDDEN for row in _rows(file, f"worst_{name}")]
    return [
        Block("phases of the duty", names, tuple(rows), tuple(lines)),
        Block("each phase alone, without starts", names, tuple(alone)),
        Block("worst in each phase", names, tuple(worst)),
    ]


def _by_surface(name: str, shares: np.ndarray) -> list[Row]:
    """A row for each surface, that of all wear first."""
    order = np.roll(np.arange(len(WORN_SURFACES)), 1).tolist()
    made = []
    for k in order:
        row = row_of(name, shares[:, k])
        surface = WORN_SURFACES[k].replace("_", " ")
        label = row.label if k == order[0] else f"{row.label}, {surface}"
        made.append(row._replace(label=label, name=f"{name}.{WORN_SURFACES[k]}"))
    return made


def _rows(file: Any, name: str) -> list[Row]:
    """The row of a variable of the phases, if the file has it."""
    return [row_of(name, values(file, name))] if name in file.variables else []
