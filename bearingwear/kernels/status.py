"""Status codes of a solve: what the kernels return, files store and people read."""

OK = 0
NOT_CONVERGED = 1
CONTACT_LOST = 2
NO_STEADY_STATE = 3
PRELOAD_GONE = 4
UNDETERMINED = 5
OUTSIDE_HERTZ_RANGE = 6
UNVERIFIED = 7
CRITERION_NOT_REACHED = 8
BEYOND_GROOVE = 9
BELOW_ROUNDING = 10
NO_RACE_CONTROL = 11
RACE_UNSEATED = 12
TOO_STIFF = 13
CAGE_JAMMED = 14
WARM_SEIZURE = 15
NO_HEAT_BALANCE = 16
LIFTED_OFF = 17

STATUS_NAMES = (
    "ok",
    "not_converged",
    "contact_lost",
    "no_steady_state",
    "preload_gone",
    "undetermined",
    "outside_hertz_range",
    "unverified",
    "criterion_not_reached",
    "beyond_groove",
    "below_rounding",
    "no_race_control",
    "race_unseated",
    "too_stiff",
    "cage_jammed",
    "warm_seizure",
    "no_heat_balance",
    "lifted_off",
)

STATUS_SENTENCES = {
    "ok": "solved and verified",
    "not_converged": "the iteration did not converge; do not use the values of this case",
    "contact_lost": "centrifugal force separates, or nearly separates, a ball from the inner race, "
    "and no solution was found",
    "no_steady_state": "no stable steady-state solution was found: either the balls or, in a "
    "pair, the rotor does not settle",
    "preload_gone": "wear or load has eliminated the preload: a ball carries no load",
    "undetermined": "without friction, the rotation of the balls is indeterminate",
    "outside_hertz_range": "a contact ellipse is too large relative to its ball for Hertzian "
    "theory to apply",
    "unverified": "the solution failed verification",
    "criterion_not_reached": "no end-of-life criterion was met within the solvable range",
    "beyond_groove": "a contact angle is outside the range of 0 to 90 degrees: the ball leaves "
    "its groove",
    "below_rounding": "a slip speed or load is so small relative to the others that it is lost "
    "in rounding errors, or slip_regularisation_m_s is too small",
    "no_race_control": "no equilibrium exists under race control: neither race can prevent "
    "gyroscopic rotation of the balls, or a pair has no equilibrium where control passes from one "
    "race to the other",
    "race_unseated": "load or tilt separates the inner race from some balls, and the preload does "
    "not press it against the others",
    "too_stiff": "the motion requires far too many time steps per turn, and no averages were "
    "obtained; race control finds loads and pressures (--fidelity race_control)",
    "cage_jammed": "no equilibrium of the cage was found: its clearance is too small, or pocket "
    "friction locks a ball that only inertia, which is neglected, could release",
    "warm_seizure": "friction heat and preload increase each other without limit: the bearing "
    "seizes",
    "no_heat_balance": "no heat balance was found in which every part expands by less than 1 %",
    "lifted_off": "the rotor has lifted off one bearing of the pair: wear or the external force "
    "has eliminated that bearing's preload",
}
