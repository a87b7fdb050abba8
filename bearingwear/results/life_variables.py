"""The variables of a life file: a part of the table in `results/variables.py`."""

from __future__ import annotations

from bearingwear.kernels.status import STATUS_NAMES
from bearingwear.results.growth_variables import GROWN
from bearingwear.results.variable import DEGREE, ESTIMATE, HOURS_PER_SECOND, STATUS, Variable, table
from bearingwear.scene.blocks import CRITERIA

_STEP, _STEP_RACE, _STEP_COUNTS = ("step",), ("step", "race"), ("step", "counts")
_STEP_BALL = ("step", "ball")
_OF_STEADY = "of what of the scene has a steady life, see the attribute steady_life_of"

# fmt: off
LIFE = table(
    STATUS,
    Variable("life", ("counts",), "h", "time to the end of life", scale=HOURS_PER_SECOND,
        always=True, label="life"),
    Variable("normalised_life", ("counts",), "s Pa-1",
        "life times wear coefficient over hardness of the balls", always=True,
        label="life times K_s/H"),
    Variable("life_error_bound", ("counts",), "h", "bound on the integration error of the life",
        scale=HOURS_PER_SECOND, always=True, label="bound of the integration"),
    Variable("life_error_estimate", ("counts",), "1",
        "estimated numerical error of the life, over it", comment=ESTIMATE,
        label="numerical error, all", shown="%"),
    Variable("end_criterion", (), "", "the criterion that was met first", "i1", flags=CRITERIA,
        always=True),
    Variable("loss_at_end", (), "m", "loss of ball diameter at the end of life", always=True,
        label="loss of ball diameter"),
    Variable("history_ball_diameter_loss", _STEP, "m", "loss of ball diameter"),
    Variable("history_time", _STEP_COUNTS, "h", "time since the start", scale=HOURS_PER_SECOND),
    Variable("history_residual_preload", _STEP, "N", "axial force of all balls on the inner race",
        label="residual preload"),
    Variable("history_total_qv", _STEP, "W", "QV of the whole bearing", label="QV"),
    Variable("history_qv", _STEP_RACE, "W", "QV of one ball"),
    Variable("history_contact_angle", _STEP_RACE, "degree", "contact angle", scale=DEGREE),
    Variable("history_contact_load", _STEP_RACE, "N", "normal load of the contact"),
    Variable("history_semi_major_axis", _STEP_RACE, "m",
        "semi-major axis of the contact ellipse"),
    Variable("history_maximum_pressure", _STEP, "Pa", "largest pressure of all contacts"),
    Variable("history_gyroscopic_slip_share", _STEP_RACE, "1",
        "gyroscopic share of the slip, weighted by load"),
    Variable("history_skid_ratio", _STEP, "1", "lag of the orbit behind pure rolling"),
    Variable("history_ball_diameter_loss_rate", _STEP_COUNTS, "m s-1",
        "rate of the loss of ball diameter"),
    Variable("history_ball_wear_rate", _STEP, "m3 s-1", "wear rate of one ball"),
    Variable("history_race_wear_rate", _STEP_RACE, "m3 s-1", "wear rate of the whole race"),
    # of a life in time alone
    Variable("history_status", _STEP, "", "whether the run in time was solved", "i1",
        flags=STATUS_NAMES),
    Variable("history_start", _STEP, "", "where the run in time began", "i1",
        flags=("start_anew", "end_of_the_step_before")),
    Variable("history_simulated_turns", _STEP, "1", "shaft turns simulated"),
    Variable("history_worn_diameter", _STEP_BALL, "m",
        "worn off the diameter of one ball since the start", label="diameter of one ball"),
    Variable("history_groove_depth", _STEP, "m", "depth worn into both grooves since the start",
        label="both grooves, depth"),
    Variable("history_ball_worn_volume", _STEP_BALL, "m3",
        "volume worn off one ball since the start", label="one ball"),
    Variable("history_race_worn_volume", _STEP_RACE, "m3",
        "volume worn off the race since the start"),
    Variable("history_pocket_worn_volume", _STEP_BALL, "m3",
        "volume worn off the cage in one pocket since the start", label="one pocket"),
    Variable("history_land_worn_volume", _STEP, "m3",
        "volume worn off the cage at its guiding land since the start", label="guiding land"),
    Variable("history_each_ball_wear_rate", _STEP_BALL, "m3 s-1", "wear rate of each ball"),
    Variable("history_pocket_wear_rate", _STEP_BALL, "m3 s-1",
        "wear rate of the cage in one pocket"),
    Variable("history_land_wear_rate", _STEP, "m3 s-1",
        "wear rate of the cage at its guiding land"),
    Variable("history_pocket_clearance", _STEP, "m",
        "diametral clearance of pocket and most worn ball", label="pocket clearance then"),
    Variable("history_guide_clearance", _STEP, "m", "diametral clearance of cage and guiding land",
        label="guide clearance then"),
    Variable("steady_status", (), "", "whether there is a steady life to compare with", "i1",
        flags=STATUS_NAMES, comment=_OF_STEADY),
    Variable("steady_life", (), "h", "time to the end of life by the steady model",
        scale=HOURS_PER_SECOND, comment=_OF_STEADY, label="steady life"),
    Variable("steady_end_criterion", (), "", "the criterion that the steady life meets first", "i1",
        flags=CRITERIA, comment=_OF_STEADY),
    Variable("steady_loss_at_end", (), "m", "loss of ball diameter at the end of the steady life",
        comment=_OF_STEADY, label="loss at its end"),
    Variable("steady_time_to_loss", (), "h", "time that the steady model takes to loss_at_end",
        scale=HOURS_PER_SECOND, comment=_OF_STEADY, label="its time to the loss above"),
) | GROWN
# fmt: on
