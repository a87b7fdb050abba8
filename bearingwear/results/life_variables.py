"""Variables of growth and of a life file: parts of the table in `results/variables.py`."""

from __future__ import annotations

from bearingwear.kernels.status import STATUS_NAMES
from bearingwear.measures import WORST
from bearingwear.results.variable import DEGREE, ESTIMATE, HOURS_PER_SECOND, STATUS, Variable, table
from bearingwear.scene.blocks import CRITERIA, OF_CAGE

_STEP, _STEP_RACE = ("step",), ("step", "race")
_STEP_BALL = ("step", "ball")
_SHOWN, _PROFILE = ("groove_state",), ("groove_state", "race", "arc")
_EQUIVALENT = "with worn grooves, the uniform loss of ball diameter with the same effect"
_OF_STEADY = "the attribute steady_life_of lists the neglected effects"

BEARING_PARTS = ("inner_ring", "balls", "outer_ring", "shaft", "housing")

# fmt: off
GROWN = table(
    Variable("part_temperature", ("part",), "degC", "temperature of the part",
        comment="if no shaft or housing temperature is given, axial positions are as mounted",
        label="temperature"),
    Variable("thermal_growth", ("part",), "1", "relative thermal expansion of the part",
        label="thermal growth", shown="%"),
    Variable("growth_at_speed", ("race",), "m", "growth of the track radius due to rotation",
        label="growth at speed"),
    Variable("growth_by_fit", ("race",), "m", "growth of the track radius due to the fit",
        label="growth due to the fit"),
    Variable("fit_pressure", ("race",), "Pa", "pressure between the ring and its seat",
        label="pressure on the seat"),
    Variable("heat_flow_residual", (), "1",
        "heat not removed by the thermal network at the computed temperatures, relative to the "
        "total heat",
        comment="in a life file, the maximum over its states"),
    Variable("thermal_solves", (), "1",
        "number of solves required to compute the temperatures", "i4",
        comment="in a life file, the sum over its states"),
    Variable("thermal_margin", (), "1", "conductance over slope of the friction heat",
        comment="above 1 the temperatures are stable", label="thermal margin"),
    Variable("history_thermal_margin", _STEP, "1", "thermal margin at each step"),
    Variable("history_part_temperature", ("step", "part"), "degC",
        "temperature of the part at each step", label="temperature"),
)
"""Variables of a bearing whose parts grow by heat, speed or fits."""

_PHASE, _PHASE_SURFACE = ("phase",), ("phase", "surface")
_OF_DUTY = "in the order of the attribute phases"
WORN_SURFACES = ("inner_race", "outer_race", "balls", "all")

DUTY = table(
    Variable("life_cycles", (), "1", "number of cycles of the duty to the end of life",
        label="life in cycles"),
    Variable("ending_phase", (), "1", "index of the phase whose criterion ends the life", "i4",
        comment=f"{_OF_DUTY}; the histories without a phase are those of this phase"),
    Variable("phase_time_share", _PHASE, "1", "share of a cycle taken by the phase, its starts and "
        "stops", comment=_OF_DUTY, label="share of time", shown="%"),
    Variable("phase_wear_share", _PHASE_SURFACE, "1", "share of the volume worn off a surface "
        "during the phase, its starts and stops", comment=_OF_DUTY, label="share of wear",
        shown="%"),
    Variable("start_wear_share", _PHASE_SURFACE, "1", "share of the volume worn off a surface "
        "during the starts and stops of the phase", comment=_OF_DUTY,
        label="  at starts and stops alone", shown="%"),
    Variable("phase_life", _PHASE, "h", "life in the condition of the phase alone",
        scale=HOURS_PER_SECOND, comment=_OF_DUTY, label="life"),
    Variable("phase_end_criterion", _PHASE, "", "first criterion met in the condition of the phase "
        "alone", "i1", flags=CRITERIA, comment=_OF_DUTY),
    Variable("palmgren_miner_life", (), "h", "life that the linear rule of Palmgren and Miner "
        "gives from the lives of the phases, 1/L = sum of share of time over phase_life",
        scale=HOURS_PER_SECOND, comment="without starts and stops",
        label="Palmgren and Miner would promise"),
    Variable("palmgren_miner_error", (), "1", "palmgren_miner_life over life, minus 1",
        shown="%"),
    Variable("ramp_error_estimate", (), "1", "estimated relative error of the mean wear rate from "
        "the few speeds at which starts and stops are solved",
        label="error of the starts and stops",
        shown="%"),
    Variable("acceleration_friction_share", _PHASE, "1", "share of the available friction used by "
        "the acceleration of the balls during a start or stop", comment=_OF_DUTY,
        label="friction used by acceleration", shown="%"),
    Variable("history_phase_residual_preload", ("step", "phase"), "N",
        "residual preload in each phase", comment=f"{_OF_DUTY}; of a pair, of the worse side"),
    Variable("history_phase_worn_share", ("step", "phase"), "1", "volume worn off during the "
        "phase, its starts and stops since the start, over all that is worn off at the end of life",
        comment=_OF_DUTY),
    *(
        Variable(f"worst_{name}", _PHASE, "N" if measure.over_preload else measure.si_unit,
            f"{measure.worst_word} {measure.words_of(name)} during the phase, from new to the end "
            "of life", comment=f"{_OF_DUTY}; of a pair, that of the worse bearing",
            label=measure.words_of(name, short=True),
            shown="" if measure.over_preload else measure.shown_as)
        for name, measure in WORST.items()
        if measure.key not in OF_CAGE
    ),
)
"""Variables that only a life over a duty has."""

LIFE = table(
    STATUS,
    Variable("life", (), "h", "time to the end of life", scale=HOURS_PER_SECOND,
        always=True, label="life"),
    Variable("normalised_life", (), "s Pa-1",
        "life multiplied by the ratio K_s/H of the balls", always=True,
        label="life times K_s/H"),
    Variable("life_error_bound", (), "h",
        "bound on the integration error in the computed life", scale=HOURS_PER_SECOND,
        always=True, label="integration error bound"),
    Variable("life_error_estimate", (), "1",
        "estimated relative numerical error in the computed life", comment=ESTIMATE,
        label="total numerical error", shown="%"),
    Variable("end_criterion", (), "", "first criterion met", "i1", flags=CRITERIA,
        always=True),
    Variable("loss_at_end", (), "m", "total wear depth at the end of life", always=True,
        comment=_EQUIVALENT, label="total wear depth"),
    Variable("history_ball_diameter_loss", _STEP, "m", "total wear depth", comment=_EQUIVALENT),
    Variable("history_time", _STEP, "h", "time since the start", scale=HOURS_PER_SECOND),
    Variable("history_residual_preload", _STEP, "N",
        "total axial force exerted by the balls on the inner race", label="residual preload"),
    Variable("history_total_qv", _STEP, "W", "total QV of the bearing", label="QV"),
    Variable("history_qv", _STEP_RACE, "W", "QV of one ball at the race"),
    Variable("history_contact_angle", _STEP_RACE, "degree", "contact angle", scale=DEGREE),
    Variable("history_contact_load", _STEP_RACE, "N", "normal contact load"),
    Variable("history_semi_major_axis", _STEP_RACE, "m",
        "semi-major axis of the contact ellipse"),
    Variable("history_maximum_pressure", _STEP, "Pa", "maximum pressure in any contact"),
    Variable("history_gyroscopic_slip_share", _STEP_RACE, "1",
        "load-weighted gyroscopic share of the slip"),
    Variable("history_skid_ratio", _STEP, "1",
        "relative lag of the orbit rate behind that in pure rolling"),
    Variable("history_ball_diameter_loss_rate", _STEP, "m s-1",
        "rate of increase in total wear depth",
        comment="with worn grooves, the rate of increase in history_equivalent_loss; otherwise, "
        "with the wear depth of a groove averaged over the width of the contact"),
    Variable("history_ball_wear_rate", _STEP, "m3 s-1", "wear rate of one ball"),
    Variable("history_race_wear_rate", _STEP_RACE, "m3 s-1", "wear rate of the whole race"),
    Variable("history_axial_displacement", _STEP, "m", "axial displacement of the inner race"),
    Variable("history_friction_used_by_gyroscopic_moment", _STEP, "1",
        "ratio of the gyroscopic moment to the maximum friction moment mu (Q_i + Q_o) R"),
    Variable("history_system_axial_stiffness", _STEP, "N m-1",
        "dynamic axial stiffness of the arrangement",
        comment="a single bearing counts as half of a symmetric pair"),
    Variable("history_system_quasistatic_axial_stiffness", _STEP, "N m-1",
        "quasi-static axial stiffness of the arrangement",
        comment="a single bearing counts as half of a symmetric pair; with the dynamic model, "
            "the value is that of the steady state with the same wear or, if the balls differ, "
            "that of race control"),
    Variable("history_rotor_axial_shift", _STEP, "m",
        "axial shift of the rotor from its mounted position",
        comment="a single bearing counts as half of a symmetric pair"),
    Variable("history_greatest_depth", _STEP, "m", "wear depth of the more deeply worn groove",
        label="deepest groove"),
    # of films alone
    Variable("history_friction_coefficient", _STEP_RACE, "1",
        "load-weighted mean friction coefficient in the contact", label="friction"),
    Variable("history_film_worn_share", _STEP_RACE, "1",
        "share of the track without film"),
    Variable("history_race_film", _STEP_RACE, "m",
        "remaining film thickness at the most worn point of the race", label="film"),
    Variable("history_ball_film", _STEP, "m",
        "remaining film thickness at the most worn point of each ball",
        label="film, balls"),
    Variable("race_film_worn_through", ("race",), "h",
        "time at which the film on the race is worn through (NaN if never)",
        scale=HOURS_PER_SECOND, label="film"),
    Variable("ball_film_worn_through", (), "h",
        "time at which the film on the balls is worn through (NaN if never)",
        scale=HOURS_PER_SECOND, label="film, balls"),
    # of a life with worn grooves alone
    Variable("history_approach_loss", _STEP, "m",
        "diameter loss of a ball plus the additional approach at its contacts due to wear",
        label="total approach"),
    Variable("history_equivalent_loss", _STEP, "m",
        "uniform loss of ball diameter that gives the same rotor position as the worn grooves or, "
        "with fixed-position preload, the same preload"),
    Variable("history_deepest_groove", _STEP_RACE, "m", "maximum wear depth of the groove"),
    Variable("history_groove_width", _STEP_RACE, "m",
        "width of the worn groove at one hundredth of its maximum depth"),
    Variable("history_contact_half_length", _STEP_RACE, "m",
        "half the length of the contact along its major axis"),
    Variable("history_one_ball_worn_volume", _STEP, "m3",
        "wear volume of each ball since the start", label="each ball"),
    Variable("groove_step", _SHOWN, "1", "indices of the history steps whose profiles are "
        "stored", "i4"),
    Variable("groove_arc", ("race", "arc"), "m",
        "position across the groove, from the centre of the new contact towards +X"),
    Variable("groove_depth", _PROFILE, "m", "wear depth of the groove"),
    Variable("groove_pressure", _PROFILE, "Pa",
        "contact pressure across the groove, at the centre of the contact in the rolling "
        "direction"),
    # of a dynamic life alone
    Variable("history_status", _STEP, "", "whether the dynamic run succeeded", "i1",
        flags=STATUS_NAMES),
    Variable("history_start", _STEP, "", "starting point of the dynamic run", "i1",
        flags=("start_anew", "end_of_the_step_before")),
    Variable("history_simulated_turns", _STEP, "1", "number of shaft turns simulated"),
    Variable("history_spacing_growth_per_turn", _STEP, "1",
        "maximum growth rate, per shaft turn, of disturbances to the even ball spacing in a "
        "periodic motion"),
    Variable("history_disturbance_growth_per_turn", _STEP, "1",
        "maximum growth rate, per shaft turn, of all other disturbances in a periodic motion"),
    Variable("history_worn_diameter", _STEP_BALL, "m",
        "diameter loss of each ball since the start", label="diameter of one ball"),
    Variable("history_groove_depth", _STEP, "m",
        "combined wear depth of both grooves since the start", label="depth, both grooves"),
    Variable("history_ball_worn_volume", _STEP_BALL, "m3",
        "wear volume of one ball since the start", label="one ball"),
    Variable("history_race_worn_volume", _STEP_RACE, "m3",
        "wear volume of the race since the start"),
    Variable("history_pocket_worn_volume", _STEP_BALL, "m3",
        "cage wear volume in one pocket since the start", label="one pocket"),
    Variable("history_land_worn_volume", _STEP, "m3",
        "cage wear volume at the guiding land since the start", label="guiding land"),
    Variable("history_each_ball_wear_rate", _STEP_BALL, "m3 s-1", "wear rate of each ball"),
    Variable("history_pocket_wear_rate", _STEP_BALL, "m3 s-1",
        "cage wear rate in one pocket"),
    Variable("history_land_wear_rate", _STEP, "m3 s-1",
        "cage wear rate at the guiding land"),
    Variable("history_pocket_clearance", _STEP, "m",
        "diametral clearance between a pocket and the most worn ball", label="pocket clearance"),
    Variable("history_guide_clearance", _STEP, "m",
        "diametral clearance between the cage and its guiding land", label="guide clearance"),
    Variable("history_pocket_film_worn_share", _STEP, "1",
        "ratio of the wear depth of the pockets to the thickness of the cage film",
        label="film worn off, pockets", shown="%"),
    Variable("history_land_film_worn_share", _STEP, "1",
        "ratio of the wear depth at the land to the thickness of the cage film",
        label="film worn off, land", shown="%"),
    Variable("steady_status", (), "",
        "whether a life computed with the steady model is available for comparison", "i1",
        flags=STATUS_NAMES, comment=_OF_STEADY),
    Variable("steady_life", (), "h", "time to the end of life according to the steady model",
        scale=HOURS_PER_SECOND, comment=_OF_STEADY, label="steady life"),
    Variable("steady_end_criterion", (), "",
        "first criterion met according to the steady model", "i1",
        flags=CRITERIA, comment=_OF_STEADY),
    Variable("steady_loss_at_end", (), "m",
        "total wear depth at the end of life according to the steady model",
        comment=_OF_STEADY, label="total wear depth, steady model"),
    Variable("steady_time_to_loss", (), "h",
        "time at which the total wear depth reaches loss_at_end according to the steady model",
        scale=HOURS_PER_SECOND, comment=_OF_STEADY, label="time to the same loss, steady model"),
) | GROWN | DUTY
# fmt: on
