"""The one table of everything a result file can hold: names, dimensions, units, meaning.

Inside the program all values are SI and radians; `scale` takes them to the units of the file.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from bearingwear.kernels.status import STATUS_NAMES, STATUS_SENTENCES
from bearingwear.model.scene import COUNTS

DEGREE = 180.0 / math.pi
HOUR = 1.0 / 3600.0

RACES = ("inner", "outer")
AXES = ("axial", "tangential", "radial")
DIRECTIONS = ("axial", "Y", "Z")
EDGES = ("at_negative_x", "at_positive_x")
CRITERIA = (
    "preload_fraction",
    "gyroscopic_slip_share",
    "skid_ratio",
    "ball_diameter_loss_um",
    "pocket_clearance_mm",
    "guide_clearance_mm",
    "none",
)
BRANCHES = ("outer_spin", "inner_spin", "shared_spin", "skidding")


@dataclass(frozen=True)
class Variable:
    """One variable of a result file.

    Attributes
    ----------
    name : str
    dims : tuple of str
    units : str
        In the file; empty for flags, which have none.
    long_name : str
    dtype : str
        `f8` and `f4` have NaN as `_FillValue`; whole numbers have no fill value.
    scale : float
        What takes the program's SI value to the file's units.
    flags : tuple of str, optional
        Meanings of 0, 1, ...
    comment : str, optional
    always : bool
        Written also where it was not solved, as `_FillValue`; others are then left out.
    averaged : bool
        Of a transient, this is the mean over the evaluated turns; so is all that is `always` there.
    """

    name: str
    dims: tuple[str, ...]
    units: str
    long_name: str
    dtype: str = "f8"
    scale: float = 1.0
    flags: tuple[str, ...] | None = None
    comment: str | None = None
    always: bool = False
    averaged: bool = False


def _table(*variables: Variable) -> dict[str, Variable]:
    return {v.name: v for v in variables}


BALL, RACE, BOTH = ("ball",), ("race",), ("ball", "race")
STRIPS = ("ball", "race", "strip")

COORDINATES = _table(
    Variable("ball", BALL, "1", "number of the ball", "i4"),
    Variable("race", RACE, "", "race", "i1", flags=RACES),
    Variable("axis", ("axis",), "", "axis of the ball's azimuth frame", "i1", flags=AXES),
    Variable("strip", ("strip",), "1", "number of the strip on the contact ellipse", "i4"),
    Variable("counts", ("counts",), "", "what wear counts as loss", "i1", flags=COUNTS),
    Variable("steady_state", ("steady_state",), "1", "number of the steady state", "i4"),
    Variable("step", ("step",), "1", "number of the step along the life", "i4"),
    # CF's standard_name "time" is for dates: it asks for units with a date to count from
    Variable("time", ("time",), "s", "simulated time"),
    Variable("direction", ("direction",), "", "direction in space", "i1", flags=DIRECTIONS),
    Variable("edge", ("edge",), "", "edge of the guiding land", "i1", flags=EDGES),
    Variable("state", ("state",), "1", "number in the state of motion", "i4"),
)

STRIP_POSITION = Variable(
    "strip_position",
    ("strip",),
    "1",
    "position of the strip's middle over the semi-major axis",
    comment="+1 is the end towards the bearing axis' positive direction",
)

STATUS = Variable(
    "status",
    (),
    "",
    "whether the numbers may be used",
    "i1",
    flags=STATUS_NAMES,
    comment="; ".join(f"{name}: {STATUS_SENTENCES[name]}" for name in STATUS_NAMES),
)

ESTIMATE = "from solves with other settings of accuracy; differences of model are not in it"

STATE = _table(
    STATUS,
    Variable("contact_load", BOTH, "N", "normal load of the contact", always=True),
    Variable("contact_angle", BOTH, "degree", "contact angle", scale=DEGREE, always=True),
    Variable("semi_major_axis", BOTH, "m", "semi-major axis of the contact ellipse", always=True),
    Variable("semi_minor_axis", BOTH, "m", "semi-minor axis of the contact ellipse", always=True),
    Variable("maximum_pressure", BOTH, "Pa", "largest contact pressure", always=True),
    Variable(
        "qv", BOTH, "W", "integral of load times slip speed over the contact (QV)", always=True
    ),
    Variable("friction_heat", BOTH, "W", "friction heat of the contact", always=True),
    Variable(
        "gyroscopic_slip",
        STRIPS,
        "m s-1",
        "slip along the major axis, race minus ball",
        always=True,
    ),
    Variable(
        "rolling_slip",
        STRIPS,
        "m s-1",
        "slip along the rolling direction, race minus ball",
        comment="positive towards y of the azimuth frame, against the orbit of a positive rate",
        always=True,
    ),
    Variable(
        "ball_angular_velocity",
        ("ball", "axis"),
        "rad s-1",
        "absolute angular velocity of the ball in its azimuth frame",
        always=True,
    ),
    Variable("orbit_speed", BALL, "rad s-1", "orbit rate of the ball", always=True),
    Variable("spin_to_roll_ratio", BOTH, "1", "spin over roll of ball against race", always=True),
    Variable(
        "residual_preload", (), "N", "axial force of all balls on the inner race", always=True
    ),
    Variable(
        "axial_displacement",
        (),
        "m",
        "axial displacement of the inner race",
        comment="from the free-contact, unworn position",
        always=True,
    ),
    Variable(
        "gyroscopic_slip_share",
        BOTH,
        "1",
        "gyroscopic share of the slip, weighted by load",
        always=True,
    ),
    Variable("total_qv", (), "W", "QV of the whole bearing", always=True),
    Variable(
        "shaft_torque",
        (),
        "N m",
        "torque of the inner race on the balls, whole bearing",
        always=True,
    ),
    Variable("drag_power", (), "W", "power of the lubricant drag, whole bearing", always=True),
    Variable("axial_stiffness", (), "N m-1", "axial stiffness at constant speed", always=True),
    Variable("ball_wear_rate", BALL, "m3 s-1", "wear rate of one ball", always=True),
    Variable("race_wear_rate", RACE, "m3 s-1", "wear rate of the whole race", always=True),
    Variable("cage_wear_rate", (), "m3 s-1", "wear rate of the cage pockets", averaged=True),
    Variable(
        "pocket_wear_rate", BALL, "m3 s-1", "wear rate of the cage in one pocket", averaged=True
    ),
    Variable(
        "cage_land_wear_rate",
        (),
        "m3 s-1",
        "wear rate of the cage at its guiding land",
        averaged=True,
    ),
    Variable("cage_friction_heat", (), "W", "friction heat of the cage", averaged=True),
    Variable("cage_speed", (), "rad s-1", "speed of the cage", averaged=True),
    Variable("ball_diameter_loss", BALL, "m", "loss of ball diameter by wear"),
    Variable(
        "ball_diameter_loss_rate",
        ("counts",),
        "m s-1",
        "rate of the loss of ball diameter, mean over the balls",
        averaged=True,
    ),
    Variable("initial_axial_displacement", (), "m", "axial displacement at rest, unworn"),
    Variable(
        "gyroscopic_moment", BALL, "N m", "gyroscopic moment on the ball, magnitude", averaged=True
    ),
    Variable("centrifugal_force", BALL, "N", "centrifugal force on the ball", averaged=True),
    Variable(
        "contact_track_radius",
        BOTH,
        "m",
        "radius of the contact's track about the axis",
        averaged=True,
    ),
    Variable(
        "race_control", BALL, "", "race that controls the ball", "i1", flags=("outer", "inner")
    ),
    Variable(
        "skid_ratio",
        (),
        "1",
        "lag of the orbit behind pure rolling, over the pure-rolling rate",
        averaged=True,
    ),
    Variable("stable", (), "", "stability of the state", "i1", flags=("unstable", "stable")),
    Variable("fast_time_scale", (), "s", "time in which slip settles"),
    Variable("slow_time_scale", (), "s", "time in which the spin axis settles"),
    Variable("steady_state_branch", (), "", "where the ball spins", "i1", flags=BRANCHES),
    Variable("steady_state_count", (), "1", "number of steady states found", "i4"),
    Variable("steady_state_orbit_speed", ("steady_state",), "rad s-1", "orbit rate of each state"),
    Variable("steady_state_total_qv", ("steady_state",), "W", "QV of the bearing in each state"),
    Variable(
        "steady_state_stable",
        ("steady_state",),
        "",
        "stability of each state",
        "i1",
        flags=("unstable", "stable"),
    ),
    Variable(
        "friction_residual", (), "1", "friction balance after the solve, over friction forces"
    ),
    Variable(
        "equilibrium_residual", (), "1", "normal force balance after the solve, over contact load"
    ),
    Variable(
        "discretisation_residual",
        (),
        "1",
        "friction balance with four times the points, over friction forces",
    ),
    Variable(
        "discretisation_error_qv", (), "1", "change of QV with four times the points, over QV"
    ),
    Variable(
        "qv_error_estimate",
        (),
        "1",
        "estimated numerical error of total QV, over QV",
        comment=ESTIMATE,
    ),
    Variable(
        "residual_preload_error_estimate",
        (),
        "1",
        "estimated numerical error of the residual preload, over it",
        comment=ESTIMATE,
    ),
    Variable(
        "wear_rate_error_estimate",
        ("counts",),
        "1",
        "estimated numerical error of the loss rate of ball diameter, over it",
        comment=ESTIMATE,
    ),
    Variable("power_balance_error", (), "1", "power balance after the solve, over shaft power"),
    Variable(
        "equilibrium_rounding", (), "1", "what rounding of places can make of equilibrium_residual"
    ),
    Variable(
        "friction_rounding", (), "1", "what rounding of the speeds can make of friction_residual"
    ),
    Variable(
        "power_rounding", (), "1", "what rounding of the speeds can make of power_balance_error"
    ),
)

# Histories that are means over the interval which ends at the instant.
INTERVAL_MEANS = {
    "history_contact_qv",
    "history_ball_wear_rate",
    "history_race_wear_rate",
    "history_cage_pocket_wear_rate",
    "history_cage_land_wear_rate",
}
TIME, TIME_BALL, TIME_BOTH = ("time",), ("time", "ball"), ("time", "ball", "race")
TIME_DIRECTION = ("time", "direction")


def _history(
    name: str,
    dims: tuple[str, ...],
    units: str,
    long_name: str,
    scale: float = 1.0,
    comment: str | None = None,
) -> Variable:
    """Values of a transient at instants, in single precision."""
    return Variable(f"history_{name}", dims, units, long_name, "f4", scale, comment=comment)


DYNAMIC = _table(
    Variable("simulated_turns", (), "1", "shaft turns simulated"),
    Variable("evaluated_turns", (), "1", "shaft turns at their end that averages are taken over"),
    Variable("qv_drift_per_turn", (), "1", "change of QV per shaft turn, over QV"),
    Variable(
        "wear_rate_drift_per_turn", (), "1", "change of the wear rate per shaft turn, over the rate"
    ),
    Variable("steps_accepted", (), "1", "steps of the time integration", "i8"),
    Variable("steps_rejected", (), "1", "steps that were repeated with a shorter one", "i8"),
    Variable("evaluations", (), "1", "evaluations of the equations of motion", "i8"),
    Variable("contact_events", (), "1", "contacts of cage and races made or broken", "i8"),
    Variable("energy_account_error", (), "1", "gap in the energy account, over the heat"),
    Variable(
        "coriolis_energy_share",
        (),
        "1",
        "work of the Coriolis force, over the heat",
        comment="left out of the motion",
    ),
    Variable(
        "azimuth_energy_share",
        (),
        "1",
        "work of the inner force along the circumference, over the heat",
        comment="left out of the motion",
    ),
    Variable(
        "mean_pocket_torque",
        (),
        "N m",
        "torque of the balls on the cage about the axis",
        averaged=True,
    ),
    Variable(
        "mean_land_torque",
        (),
        "N m",
        "torque of the guiding land on the cage about the axis",
        averaged=True,
    ),
    Variable(
        "cage_momentum_rate",
        (),
        "N m",
        "change of the cage's angular momentum about the axis",
        averaged=True,
    ),
    Variable("final_time", (), "s", "simulated time at the end"),
    Variable(
        "final_state",
        ("state",),
        "1",
        "state of motion at the end, to go on from",
        comment="in SI units, laid out as the solver of the same source_hash has it",
    ),
    _history("contact_load", TIME_BOTH, "N", "normal load of the contact"),
    _history("slip", TIME_BOTH, "m s-1", "slip speed of the contact, mean by load"),
    _history("contact_qv", TIME_BOTH, "W", "QV of the contact"),
    _history(
        "orbit_lead",
        TIME_BALL,
        "degree",
        "azimuth of the ball ahead of the middle of its pocket",
        DEGREE,
        "ahead of even spacing where there is no cage",
    ),
    _history("residual_preload", TIME, "N", "axial force of all balls on the inner race"),
    _history("race_displacement", TIME_DIRECTION, "m", "displacement of the inner race"),
    _history("ball_wear_rate", TIME_BALL, "m3 s-1", "wear rate of one ball"),
    _history("race_wear_rate", ("time", "race"), "m3 s-1", "wear rate of the whole race"),
    _history("cage_position", TIME_DIRECTION, "m", "place of the cage's centre"),
    _history("cage_tilt", TIME_DIRECTION, "degree", "tilt of the cage about a direction", DEGREE),
    _history("cage_speed", TIME, "rad s-1", "speed of the cage"),
    _history("pocket_force", TIME_BALL, "N", "normal force of ball and cage pocket"),
    _history("land_force", ("time", "edge"), "N", "normal force of cage and guiding land"),
    _history("cage_pocket_wear_rate", TIME, "m3 s-1", "wear rate of the cage pockets"),
    _history("cage_land_wear_rate", TIME, "m3 s-1", "wear rate of the cage at its guiding land"),
)

CASE = STATE | DYNAMIC

STEP, STEP_RACE, STEP_COUNTS = ("step",), ("step", "race"), ("step", "counts")
STEP_BALL = ("step", "ball")
OF_STEADY = "of what of the scene has a steady life, see the attribute steady_life_of"

LIFE = _table(
    STATUS,
    Variable("life", ("counts",), "h", "time to the end of life", scale=HOUR, always=True),
    Variable(
        "normalised_life",
        ("counts",),
        "s Pa-1",
        "life times wear coefficient over hardness of the balls",
        always=True,
    ),
    Variable(
        "life_error_bound",
        ("counts",),
        "h",
        "bound on the integration error of the life",
        scale=HOUR,
        always=True,
    ),
    Variable(
        "life_error_estimate",
        ("counts",),
        "1",
        "estimated numerical error of the life, over it",
        comment=ESTIMATE,
    ),
    Variable(
        "end_criterion",
        (),
        "",
        "the criterion that was met first",
        "i1",
        flags=CRITERIA,
        always=True,
    ),
    Variable("loss_at_end", (), "m", "loss of ball diameter at the end of life", always=True),
    Variable("history_ball_diameter_loss", STEP, "m", "loss of ball diameter"),
    Variable("history_time", STEP_COUNTS, "h", "time since the start", scale=HOUR),
    Variable("history_residual_preload", STEP, "N", "axial force of all balls on the inner race"),
    Variable("history_total_qv", STEP, "W", "QV of the whole bearing"),
    Variable("history_qv", STEP_RACE, "W", "QV of one ball"),
    Variable("history_contact_angle", STEP_RACE, "degree", "contact angle", scale=DEGREE),
    Variable("history_contact_load", STEP_RACE, "N", "normal load of the contact"),
    Variable(
        "history_gyroscopic_slip_share",
        STEP_RACE,
        "1",
        "gyroscopic share of the slip, weighted by load",
    ),
    Variable("history_skid_ratio", STEP, "1", "lag of the orbit behind pure rolling"),
    Variable(
        "history_ball_diameter_loss_rate", STEP_COUNTS, "m s-1", "rate of the loss of ball diameter"
    ),
    Variable("history_ball_wear_rate", STEP, "m3 s-1", "wear rate of one ball"),
    Variable("history_race_wear_rate", STEP_RACE, "m3 s-1", "wear rate of the whole race"),
    # of a life in time alone
    Variable(
        "history_status", STEP, "", "whether the run in time was solved", "i1", flags=STATUS_NAMES
    ),
    Variable(
        "history_start",
        STEP,
        "",
        "where the run in time began",
        "i1",
        flags=("start_anew", "end_of_the_step_before"),
    ),
    Variable("history_simulated_turns", STEP, "1", "shaft turns simulated"),
    Variable(
        "history_worn_diameter",
        STEP_BALL,
        "m",
        "worn off the diameter of one ball since the start",
    ),
    Variable("history_groove_depth", STEP, "m", "depth worn into both grooves since the start"),
    Variable(
        "history_ball_worn_volume", STEP_BALL, "m3", "volume worn off one ball since the start"
    ),
    Variable(
        "history_race_worn_volume", STEP_RACE, "m3", "volume worn off the race since the start"
    ),
    Variable(
        "history_pocket_worn_volume",
        STEP_BALL,
        "m3",
        "volume worn off the cage in one pocket since the start",
    ),
    Variable(
        "history_land_worn_volume",
        STEP,
        "m3",
        "volume worn off the cage at its guiding land since the start",
    ),
    Variable("history_each_ball_wear_rate", STEP_BALL, "m3 s-1", "wear rate of each ball"),
    Variable(
        "history_pocket_wear_rate", STEP_BALL, "m3 s-1", "wear rate of the cage in one pocket"
    ),
    Variable("history_land_wear_rate", STEP, "m3 s-1", "wear rate of the cage at its guiding land"),
    Variable(
        "history_pocket_clearance", STEP, "m", "diametral clearance of pocket and most worn ball"
    ),
    Variable("history_guide_clearance", STEP, "m", "diametral clearance of cage and guiding land"),
    Variable(
        "steady_status",
        (),
        "",
        "whether there is a steady life to compare with",
        "i1",
        flags=STATUS_NAMES,
        comment=OF_STEADY,
    ),
    Variable(
        "steady_life",
        (),
        "h",
        "time to the end of life by the steady model",
        scale=HOUR,
        comment=OF_STEADY,
    ),
    Variable(
        "steady_end_criterion",
        (),
        "",
        "the criterion that the steady life meets first",
        "i1",
        flags=CRITERIA,
        comment=OF_STEADY,
    ),
    Variable(
        "steady_loss_at_end",
        (),
        "m",
        "loss of ball diameter at the end of the steady life",
        comment=OF_STEADY,
    ),
    Variable(
        "steady_time_to_loss",
        (),
        "h",
        "time that the steady model takes to loss_at_end",
        scale=HOUR,
        comment=OF_STEADY,
    ),
)
