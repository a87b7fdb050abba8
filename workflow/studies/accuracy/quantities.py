"""The variables of a sweep: quantities with errors, and further values of a point."""

from bearingwear.results.variable import STATUS, Variable, table

QUANTITIES = table(
    Variable("total_qv", (), "W", "QV of the bearing"),
    Variable("qv_inner", (), "W", "mean QV of the inner contacts"),
    Variable("qv_outer", (), "W", "mean QV of the outer contacts"),
    Variable("residual_preload", (), "N", "residual preload"),
    Variable(
        "wear_rate",
        (),
        "m s-1",
        "rate of increase in total wear depth, with the definition of loss set in the scene",
    ),
    Variable("cage_wear_rate", (), "m3 s-1", "wear rate of the cage, pockets and land"),
    Variable("life", (), "h", "wear life from new, with the definition of loss set in the scene"),
    Variable("end_qv", (), "W", "QV of the bearing at the end of life"),
)
"""Quantities whose errors the study determines."""

EXTRA = table(
    Variable(
        "wall_time", (), "s", "duration of the solve with compiled code, median of the repeats"
    ),
    Variable("wall_time_least", (), "s", "duration of the fastest repeat"),
    Variable(
        "processor_time", (), "s", "CPU time of a solve with compiled code, median of the repeats"
    ),
    Variable("repeats", (), "1", "number of timed solves"),
    Variable("life_wall_time", (), "s", "time to compute the life, median of the repeats"),
    Variable("life_processor_time", (), "s", "CPU time to compute the life, median of the repeats"),
    Variable(
        "wear_over_gap",
        (),
        "1",
        "ratio of the loss at the end of life to the gap at the contact edge",
    ),
    Variable(
        "simulated_turns",
        (),
        "1",
        "shaft turns simulated until the run settled or reached its limit",
    ),
    Variable("steps", (), "1", "number of accepted and rejected steps"),
    Variable("estimate_total_qv", (), "1", "estimated error in QV of the bearing"),
    Variable("estimate_residual_preload", (), "1", "estimated error in the residual preload"),
    Variable(
        "estimate_wear_rate", (), "1", "estimated error in the rate of increase in total wear depth"
    ),
    Variable("estimate_life", (), "1", "estimated error in the wear life"),
    Variable(
        "coriolis_energy_share",
        (),
        "1",
        "ratio of the work done by the Coriolis force to the energy lost",
    ),
    Variable(
        "azimuth_energy_share",
        (),
        "1",
        "ratio of the work done by the circumferential force to the energy lost",
    ),
)
"""Further values of a point."""

SWEEP = (
    table(
        Variable("label", (), "", "setting of the point", "O"),
        Variable("value", (), "", "setting as a number"),
        Variable("settings", (), "", "all settings of the point", "O"),
        STATUS,
    )
    | QUANTITIES
    | EXTRA
)
