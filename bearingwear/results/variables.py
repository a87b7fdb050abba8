"""The one table of variables of result files: names, dimensions, units, meaning, display.

In the program, all values are in SI units and radians. `scale` converts them to the units of the
file, and `results/units.py` converts these to the units for people. Variables without a unit have
flags.

A study describes its own variables with `Variable` in a `table` of its own, with the dimensions of
one solve. `bearingwear.studies.dataset.dataset_of_rows` makes a dataset of them, from the axes of
the study and a row of values for each solve:

    POWERS = table(Variable("drag", (), "W", "power of the drag"), Variable("heat", ...), ...)
    dataset_of_rows(POWERS, {SPEED: speeds, PRELOAD: preloads}, [{"drag": 0.1, "heat": 0.3}, ...])
"""

from __future__ import annotations

from typing import Any

from bearingwear.results.life_variables import BEARING_PARTS, GROWN, LIFE, WORN_SURFACES
from bearingwear.results.pair_variables import PAIR_COORDINATES, SYSTEM
from bearingwear.results.variable import DEGREE, ESTIMATE, STATUS, Variable, table
from bearingwear.scene.scene import PRELOAD_METHODS

RACES = ("inner", "outer")
BALL_AXES = ("axial", "tangential", "radial")
DIRECTIONS = ("axial", "Y", "Z")
EDGES = ("at_negative_x", "at_positive_x")
BRANCHES = ("outer_spin", "inner_spin", "shared_spin", "skidding")
STABILITY = ("unstable", "stable")
DOFS = ("axial", "y", "z", "tilt_y", "tilt_z")

STIFFNESS_UNITS = ("N m-1", "N", "N m")
"""Units of a term of a stiffness matrix if none, one or both of row and column are tilts."""

_BALL, _RACE, _BOTH = ("ball",), ("race",), ("ball", "race")
_STRIPS = ("ball", "race", "strip")
TIME, _TIME_BALL, _TIME_BOTH = ("time",), ("time", "ball"), ("time", "ball", "race")
_TIME_DIRECTION = ("time", "direction")


def _history(
    name: str,
    dims: tuple[str, ...],
    units: str,
    long_name: str,
    scale: float = 1.0,
    comment: str | None = None,
) -> Variable:
    """Returns the variable of a history in a dynamic case, stored in single precision.

    name: without the prefix `history_`; the other parameters are as in `Variable`.
    """
    return Variable(f"history_{name}", dims, units, long_name, "f4", scale, comment=comment)


COORDINATES = (
    table(
        Variable("ball", _BALL, "1", "index of the ball", "i4"),
        Variable("race", _RACE, "", "race", "i1", flags=RACES),
        Variable("axis", ("axis",), "", "axis of the ball's azimuth frame", "i1", flags=BALL_AXES),
        Variable("strip", ("strip",), "1", "index of the strip on the contact ellipse", "i4"),
        Variable("steady_state", ("steady_state",), "1", "index of the steady state", "i4"),
        Variable("step", ("step",), "1", "index of the wear step", "i4"),
        # CF's standard_name "time" is for dates: it asks for units with a date to count from
        Variable("time", ("time",), "s", "simulated time"),
        Variable("direction", ("direction",), "", "direction in space", "i1", flags=DIRECTIONS),
        Variable("edge", ("edge",), "", "edge of the guiding land", "i1", flags=EDGES),
        Variable("part", ("part",), "", "part of the bearing or its surroundings", "i1",
            flags=BEARING_PARTS),
        Variable("state", ("state",), "1", "index in the vector final_state", "i4"),
        Variable("groove_state", ("groove_state",), "1", "index of the stored profile", "i4"),
        Variable("arc", ("arc",), "1", "index of the position across a groove", "i4"),
        Variable("band_place", ("band_place",), "1", "index of the latitude on a ball", "i4"),
        Variable("phase", ("phase",), "", "phase of the duty", "i1"),
        Variable("surface", ("surface",), "", "worn surface", "i1", flags=WORN_SURFACES),
        Variable("dof", ("dof",), "", "force or moment on the inner race", "i1", flags=DOFS),
        Variable("dof_column", ("dof_column",), "", "displacement or tilt of the inner race", "i1",
            flags=DOFS),
    )
    | PAIR_COORDINATES
)  # fmt: skip

STUDY_COORDINATES = table(
    Variable("preload_method", ("preload_method",), "", "preload method", "i1",
        flags=PRELOAD_METHODS),
    Variable("friction", ("friction",), "1", "ball/race friction coefficient"),
    Variable("ball_diameter_loss", ("ball_diameter_loss",), "um", "loss of ball diameter due to "
                                                                  "wear"),
)  # fmt: skip
"""Coordinates along which studies repeat solves."""

STRIP_POSITION = Variable("strip_position", ("strip",), "1",
    "position of the strip centre divided by the semi-major axis",
    comment="+1 denotes the end in the positive direction of the bearing axis")  # fmt: skip

INTERVAL_MEANS = {
    "history_contact_qv",
    "history_ball_wear_rate",
    "history_race_wear_rate",
    "history_cage_pocket_wear_rate",
    "history_cage_land_wear_rate",
}
"""Histories that are means over the interval which ends at the instant."""

EXTREMES = {
    "maximum_pressure": "max",
    "maximum_contact_load": "max",
    "minimum_contact_load": "min",
}
"""Variables whose largest or smallest value represents several: the evaluated turns of a dynamic
case, or all balls. Other variables are represented by their mean."""


def of_all_balls(name: str, values: Any, balls: int | str) -> Any:
    """Returns the mean of a variable over all balls or, for one in `EXTREMES`, the extreme.

    name: of the variable.
    values: NumPy array or `xarray.DataArray` with other dimensions, too.
    balls: axis, or name of the dimension, of the balls.
    """
    reduction = EXTREMES.get(name, "mean")  # name of a method of arrays
    return getattr(values, reduction)(balls)


# fmt: off
ALWAYS = table(STATUS) | table(
    Variable("contact_load", _BOTH, "N", "normal contact load", label="contact load"),
    Variable("contact_angle", _BOTH, "degree", "contact angle", scale=DEGREE,
        label="contact angle"),
    Variable("semi_major_axis", _BOTH, "m", "semi-major axis of the contact ellipse",
        label="semi-major axis"),
    Variable("semi_minor_axis", _BOTH, "m", "semi-minor axis of the contact ellipse",
        label="semi-minor axis"),
    Variable("maximum_pressure", _BOTH, "Pa", "maximum contact pressure", label="maximum pressure"),
    Variable("qv", _BOTH, "W", "integral of load times slip speed over the contact (QV)",
        label="QV"),
    Variable("friction_heat", _BOTH, "W", "friction heat generated in the contact",
        label="friction heat"),
    Variable("gyroscopic_slip", _STRIPS, "m s-1", "slip along the major axis, race minus ball"),
    Variable("rolling_slip", _STRIPS, "m s-1", "slip along the rolling direction, race minus ball",
        comment="positive along +y of the azimuth frame, which is opposite to the direction in "
            "which a ball orbits at a positive rate"),
    Variable("ball_angular_velocity", ("ball", "axis"), "rad s-1",
        "absolute angular velocity of the ball, resolved in its azimuth frame"),
    Variable("orbit_speed", _BALL, "rad s-1", "orbit rate of the ball",
        label="orbit speed of the balls"),
    Variable("spin_to_roll_ratio", _BOTH, "1", "spin-to-roll ratio of the ball on the race",
        label="spin/roll"),
    Variable("residual_preload", (), "N",
        "total axial force exerted by the balls on the inner race", label="residual preload"),
    Variable("axial_displacement", (), "m", "axial displacement of the inner race",
        comment="measured from the free (unloaded), unworn position", label="axial displacement"),
    Variable("gyroscopic_slip_share", _BOTH, "1", "load-weighted gyroscopic share of the slip",
        label="gyroscopic slip share", shown="%"),
    Variable("total_qv", (), "W", "total QV of the bearing", label="QV"),
    Variable("shaft_torque", (), "N m", "total torque exerted by the inner race on the balls",
        label="shaft torque"),
    Variable("drag_power", (), "W", "total power lost to lubricant drag",
        label="drag power"),
    Variable("axial_stiffness", (), "N m-1", "dynamic axial stiffness",
        comment="computed with speed and friction forces held constant; applies to vibration "
            "above stiffness_transition_frequency", label="dynamic axial stiffness"),
    Variable("ball_wear_rate", _BALL, "m3 s-1", "wear rate of one ball",
        label="wear rate of one ball"),
    Variable("race_wear_rate", _RACE, "m3 s-1", "wear rate of the whole race",
        label="wear rate, whole race"),
    always=True,
)
"""Variables of every case, solved or not."""

STATE = ALWAYS | table(
    Variable("cage_wear_rate", (), "m3 s-1", "wear rate of the cage pockets", averaged=True,
        label="wear rate, pockets"),
    Variable("pocket_wear_rate", _BALL, "m3 s-1", "cage wear rate in one pocket", averaged=True),
    Variable("cage_land_wear_rate", (), "m3 s-1", "cage wear rate at the guiding land",
        averaged=True, label="wear rate, land"),
    Variable("cage_friction_heat", (), "W", "friction heat generated at the cage", averaged=True,
        label="friction heat"),
    Variable("cage_speed", (), "rad s-1", "rotational speed of the cage", averaged=True,
        label="speed"),
    Variable("ball_diameter_loss", _BALL, "m", "loss of ball diameter due to wear"),
    Variable("ball_diameter_loss_rate", (), "m s-1",
        "rate of increase in total wear depth, averaged over the balls, with the wear depth of a "
        "groove averaged over the width of the contact", averaged=True,
        label="total wear depth, mean of tracks", shown="um/1000 h"),
    Variable("quasistatic_axial_stiffness", (), "N m-1", "quasi-static axial stiffness",
        comment="slope of axial force versus displacement in the steady state; motion and "
        "friction adapt, while temperatures and wear are held constant",
        label="quasi-static axial stiffness"),
    Variable("stiffness_transition_frequency", (), "Hz",
        "transition frequency between quasi-static and dynamic stiffness",
        comment="1/(2 pi slow_time_scale); the spin axis has time to settle during slower changes",
        label="stiffness transition"),
    Variable("stiffness_matrix", ("dof", "dof_column"), "N m-1",
        "dynamic stiffness of the bearing, with speed and friction forces held constant",
        comment="N m-1 for force over displacement, N for force over tilt or moment over "
        "displacement, N m for moment over tilt in radians; moments and tilts refer to the "
        "centre of the circle of inner groove centres"),
    Variable("quasistatic_stiffness_matrix", ("dof", "dof_column"), "N m-1",
        "quasi-static stiffness of the bearing",
        comment="units as in stiffness_matrix; not symmetric; applies to displacements fixed in "
        "space, which each ball encounters once per orbit; missing if the balls do not orbit"),
    Variable("initial_axial_displacement", (), "m",
        "axial displacement of the unworn bearing at rest"),
    Variable("gyroscopic_moment", _BALL, "N m", "magnitude of the gyroscopic moment on the ball",
        averaged=True),
    Variable("friction_used_by_gyroscopic_moment", _BALL, "1",
        "ratio of the gyroscopic moment to the maximum friction moment mu (Q_i + Q_o) R",
        averaged=True,
        label="friction used (gyroscopic)", shown="%"),
    Variable("friction_coefficient", _BOTH, "1", "friction coefficient of the contact",
        averaged=True, label="friction coefficient"),
    Variable("cage_frequency", (), "Hz", "mean orbital frequency of the balls",
        averaged=True, label="cage frequency"),
    Variable("ball_pass_frequency", _RACE, "Hz",
        "frequency at which balls pass a point on the race", averaged=True,
        label="ball pass frequency"),
    Variable("ball_spin_frequency", (), "Hz",
        "mean rotation frequency of the balls in their orbiting frames",
        averaged=True, label="ball spin frequency"),
    Variable("centrifugal_force", _BALL, "N", "centrifugal force on the ball", averaged=True),
    Variable("contact_track_radius", _BOTH, "m",
        "radius of the contact track about the bearing axis", averaged=True),
    Variable("race_control", _BALL, "", "race that controls the ball", "i1",
        flags=("outer", "inner")),
    Variable("skid_ratio", (), "1",
        "relative lag of the orbit rate behind that in pure rolling", averaged=True,
        label="skid ratio", shown="%"),
    Variable("stable", (), "", "stability of the state", "i1", flags=STABILITY),
    Variable("fast_time_scale", (), "s", "time scale of slip relaxation"),
    Variable("slow_time_scale", (), "s", "time scale over which the spin axis settles",
        label="slow time scale"),
    Variable("steady_state_branch", (), "", "race on which the ball spins", "i1", flags=BRANCHES),
    Variable("steady_state_count", (), "1", "number of steady-state solutions found", "i4"),
    Variable("steady_state_orbit_speed", ("steady_state",), "rad s-1", "orbit rate of each state"),
    Variable("steady_state_total_qv", ("steady_state",), "W", "QV of the bearing in each state"),
    Variable("steady_state_stable", ("steady_state",), "", "stability of each state", "i1",
        flags=STABILITY),
    Variable("friction_residual", (), "1",
        "residual of the friction balance, relative to the friction forces"),
    Variable("equilibrium_residual", (), "1",
        "residual of the normal force balance, relative to the contact load"),
    Variable("discretisation_residual", (), "1",
        "residual of the friction balance with four times as many points, relative to the friction "
        "forces"),
    Variable("discretisation_error_qv", (), "1",
        "relative change in QV with four times as many points"),
    Variable("qv_error_estimate", (), "1", "estimated relative numerical error in the total QV",
        comment=ESTIMATE, label="numerical error in QV", shown="%"),
    Variable("residual_preload_error_estimate", (), "1",
        "estimated relative numerical error in the residual preload", comment=ESTIMATE,
        label="error in residual preload", shown="%"),
    Variable("wear_rate_error_estimate", (), "1",
        "estimated relative numerical error in the rate of ball diameter loss", comment=ESTIMATE,
        label="error in the loss rate", shown="%"),
    Variable("shaft_torque_error_estimate", (), "1",
        "estimated relative numerical error in the shaft torque", comment=ESTIMATE,
        label="error in the torque", shown="%"),
    Variable("torque_lost_to_regularisation", (), "1",
        "share of the shaft torque that the regularisation of friction takes, from a second solve",
        comment="only where the regularisation is large against the slip", label="torque lost to "
        "regularisation", shown="%"),
    Variable("friction_power_error_estimate", (), "1",
        "estimated relative numerical error in the friction and drag power", comment=ESTIMATE,
        label="error in the friction power", shown="%"),
    Variable("power_balance_error", (), "1",
        "residual of the power balance, relative to the shaft power"),
    Variable("equilibrium_rounding", (), "1",
        "effect of rounding errors in positions on equilibrium_residual"),
    Variable("friction_rounding", (), "1",
        "effect of rounding errors in speeds on friction_residual"),
    Variable("power_rounding", (), "1",
        "effect of rounding errors in speeds on power_balance_error"),
)  # fmt: skip

DYNAMIC = table(
    Variable("simulated_turns", (), "1", "number of shaft turns simulated",
        label="turns simulated"),
    Variable("evaluated_turns", (), "1",
        "number of shaft turns at the end of the run over which results are averaged",
        label="turns averaged"),
    Variable("qv_drift_per_turn", (), "1", "relative change in QV per shaft turn",
        label="QV drift", shown="%/turn"),
    Variable("wear_rate_drift_per_turn", (), "1",
        "relative change in the wear rate per shaft turn", label="wear rate drift",
        shown="%/turn"),
    Variable("spacing_growth_per_turn", (), "1",
        "maximum growth rate, per shaft turn, of disturbances to the even ball spacing in a "
        "periodic motion", label="growth of uneven spacing", shown="%/turn",
        comment="if positive, the balls would bunch together without a cage"),
    Variable("disturbance_growth_per_turn", (), "1",
        "maximum growth rate, per shaft turn, of all other disturbances in a periodic motion",
        label="growth of disturbances", shown="%/turn", comment="if negative, disturbances decay"),
    Variable("steps_accepted", (), "1", "number of time integration steps", "i8", label="steps"),
    Variable("steps_rejected", (), "1", "number of steps repeated with a smaller step size", "i8",
        label="steps repeated"),
    Variable("evaluations", (), "1", "number of evaluations of the equations of motion", "i8"),
    Variable("contact_events", (), "1",
        "number of times that a contact with the cage or a race closed or opened", "i8",
        label="contact events"),
    Variable("energy_account_error", (), "1",
        "residual of the energy balance, relative to the energy dissipated",
        label="energy balance error", shown="%"),
    Variable("coriolis_energy_share", (), "1",
        "work done by the Coriolis force, relative to the energy dissipated",
        comment="neglected in the equations of motion"),
    Variable("azimuth_energy_share", (), "1",
        "work done by the circumferential component of the normal forces at the inner race, "
        "relative to the energy dissipated",
        comment="neglected in the equations of motion"),
    Variable("maximum_contact_load", _BOTH, "N", "normal contact load", label="maximum load"),
    Variable("minimum_contact_load", _BOTH, "N", "normal contact load", label="minimum load"),
    Variable("unloaded_share", _BOTH, "1",
        "fraction of the time during which the contact is unloaded", averaged=True),
    Variable("mean_pocket_torque", (), "N m",
        "torque exerted by the balls on the cage about the bearing axis", averaged=True,
        label="mean pocket torque"),
    Variable("mean_gravity_torque", (), "N m",
        "gravitational torque on the cage about the bearing axis", averaged=True),
    Variable("mean_land_torque", (), "N m",
        "torque exerted by the guiding land on the cage about the bearing axis", averaged=True,
        label="mean land torque"),
    Variable("cage_momentum_rate", (), "N m",
        "rate of change of the cage's angular momentum about the bearing axis", averaged=True),
    Variable("final_time", (), "s", "simulated time at the end of the run"),
    Variable("final_state", ("state",), "1", "final state of motion, for a restart",
        comment="in SI units; the layout is that of the solver version with the same source_hash"),
    _history("contact_load", _TIME_BOTH, "N", "normal contact load"),
    _history("slip", _TIME_BOTH, "m s-1", "load-weighted mean slip speed in the contact"),
    _history("contact_qv", _TIME_BOTH, "W", "QV of the contact"),
    _history("orbit_lead", _TIME_BALL, "degree",
        "azimuth of the ball relative to its pocket centre, positive if ahead", DEGREE,
        "relative to even spacing if there is no cage"),
    _history("residual_preload", TIME, "N",
        "total axial force exerted by the balls on the inner race"),
    _history("race_displacement", _TIME_DIRECTION, "m", "displacement of the inner race"),
    _history("ball_wear_rate", _TIME_BALL, "m3 s-1", "wear rate of one ball"),
    _history("race_wear_rate", ("time", "race"), "m3 s-1", "wear rate of the whole race"),
    _history("cage_position", _TIME_DIRECTION, "m", "position of the cage centre"),
    _history("cage_tilt", _TIME_DIRECTION, "degree", "tilt of the cage about a transverse axis",
        DEGREE),
    _history("cage_speed", TIME, "rad s-1", "rotational speed of the cage"),
    _history("pocket_force", _TIME_BALL, "N", "normal force between a ball and its cage pocket"),
    _history("land_force", ("time", "edge"), "N", "normal force between the cage and its guiding "
        "land"),
    _history("cage_pocket_wear_rate", TIME, "m3 s-1", "wear rate of the cage pockets"),
    _history("cage_land_wear_rate", TIME, "m3 s-1", "cage wear rate at the guiding land"),
)

CASE = STATE | DYNAMIC | GROWN | SYSTEM
# fmt: on

DIAGNOSTICS = frozenset(
    name
    for name in CASE | LIFE
    if name.endswith(("_residual", "_rounding", "_error", "_error_qv", "_error_estimate", "_bound"))
) | {
    "coriolis_energy_share",
    "azimuth_energy_share",
    "steps_accepted",
    "steps_rejected",
    "evaluations",
    "contact_events",
    "final_state",
    "final_time",
}
"""Variables that describe the accuracy of a result: residuals, error estimates, step counts."""
