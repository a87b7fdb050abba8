"""The sheet of a recommendation: the preload to take by each method, and what holds it."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from bearingwear.results.rows import values
from bearingwear.results.sheet import Block, Row, Sheet
from bearingwear.results.units import display, in_ascii
from bearingwear.scene.scene import COUNTS
from bearingwear.studies.design.words import LIMIT_TEXT, LIMIT_WORDS

SHOWN = {
    "preload": "preload",
    "axial_stiffness": "least axial stiffness",
    "maximum_pressure": "largest pressure",
    "friction_power": "largest friction power",
    "gyroscopic_slip_share": "largest gyroscopic slip share",
    "residual_preload_at_end": "preload left at the end",
}
AS = {"gyroscopic_slip_share": "%"}
"""What a share is shown as."""


def recommendation_sheet(file: Any) -> Sheet:
    """What to take, a column for each preload method."""
    scene = json.loads(file.scene)
    names = file["preload_method"].flag_meanings.split()
    columns = tuple(names[int(flag)].replace("_", " ") for flag in values(file, "preload_method"))
    lives = values(file, "life")
    rows = [
        Row("held by", "", tuple(_held(file)), "active_limit"),
        *(
            Row(f"life, {way.replace('_and_', ' + ')}", "h", tuple(lives[:, k].tolist()), "life")
            for k, way in enumerate(COUNTS)
        ),
        *(_row(file, name, label) for name, label in SHOWN.items() if name in file.variables),
    ]
    given = json.loads(getattr(file, "limits", "{}"))
    limits = [in_ascii(LIMIT_TEXT[name].format(value)) for name, value in given.items() if value]
    rows = [row._replace(values=tuple(map(_known, row.values))) for row in rows]
    heading = (
        f"{scene['name']}: {getattr(file, 'title', 'recommended preload').lower()} "
        f"at {scene['operation']['shaft_speed_rpm']:g} r/min, "
        f"friction {scene['friction']['ball_race']:g}",
        *(f"limit: {text}" for text in limits),
    )
    facts = {"kind": "recommendation", "scene": scene["name"], "limits": limits}
    return Sheet(heading, facts, (Block("recommended", columns, tuple(rows)),))


def _held(file: Any) -> list[str]:
    names = file["active_limit"].flag_meanings.split()
    return [LIMIT_WORDS[names[int(flag)]] for flag in values(file, "active_limit")]


def _known(value: Any) -> Any:
    """A dash where there is no preload to say it of."""
    return "–" if isinstance(value, float) and np.isnan(value) else value


def _row(file: Any, name: str, label: str) -> Row:
    found = values(file, name)
    unit = display(str(file[name].units), found, shown=AS.get(name, ""))
    return Row(label, unit.unit, tuple(float(x) for x in np.atleast_1d(unit.of(found))), name)
