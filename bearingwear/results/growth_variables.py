"""Variables of growth by heat, speed and fits: a part of the table in `results/variables.py`."""

from __future__ import annotations

from bearingwear.results.variable import Variable, table

BEARING_PARTS = ("inner_ring", "balls", "outer_ring", "shaft", "housing")

# fmt: off
GROWN = table(
    Variable("part_temperature", ("part",), "degC", "temperature of the part",
        comment="none of shaft or housing: axial places are as mounted", label="temperature"),
    Variable("thermal_growth", ("part",), "1", "thermal growth of the part, relative",
        label="thermal growth", shown="%"),
    Variable("growth_at_speed", ("race",), "m", "growth of the track's radius by rotation",
        label="growth at speed"),
    Variable("growth_by_fit", ("race",), "m", "growth of the track's radius by the fit",
        label="growth by the fit"),
    Variable("fit_pressure", ("race",), "Pa", "pressure on the seat of the ring",
        label="pressure on the seat"),
    Variable("heat_flow_residual", (), "1",
        "heat that the network does not carry away after the solve, over all heat",
        comment="of a life, the largest along it"),
    Variable("thermal_solves", (), "1", "solves that found the temperatures", "i4",
        comment="of a life, of all its states"),
    Variable("history_part_temperature", ("step", "part"), "degC",
        "temperature of the part along a life", label="temperature"),
)
"""Of a bearing that does not run as it was mounted."""
