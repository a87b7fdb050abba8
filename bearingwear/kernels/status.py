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
    "not_converged": "the iteration did not converge; no number of this case may be used",
    "contact_lost": "centrifugal force lifts a ball off the inner race, or so nearly that no state "
    "was found",
    "no_steady_state": "no stable steady state was found: the balls, or the rotor of a pair, do "
    "not settle",
    "preload_gone": "wear or load has taken the preload: a ball carries no load at all",
    "undetermined": "without friction the ball's rotation is undetermined",
    "outside_hertz_range": "a contact ellipse is too large for its ball for Hertz' small contacts",
    "unverified": "the answer failed the check made after the solve",
    "criterion_not_reached": "no end-of-life criterion was met within the range that can be solved",
    "beyond_groove": "a contact angle is not between 0 and 90 degrees: the ball leaves its groove",
    "below_rounding": "rounding hides a slip or load: it is too small beside the others, or "
    "slip_regularisation_m_s is too small",
    "no_race_control": "race control has no equilibrium: neither race can hold the balls against "
    "their gyroscopic moments, or the rotor of a pair has no place where the control changes",
    "race_unseated": "load or tilt lifts the inner race off some of its balls, and the preload "
    "does not seat it on the others",
    "too_stiff": "the motion asks for far more steps than its turns are worth; no average was "
    "found",
    "cage_jammed": "the cage does not fit between balls and race: it has no room, or friction in a "
    "pocket holds a ball that only inertia across its orbit, which is not modelled, would free",
    "warm_seizure": "friction heat and preload drive each other up and no temperature bounds them: "
    "the bearing seizes",
    "no_heat_balance": "no temperatures were found that carry the friction heat away with every "
    "part growing by less than 1 %",
    "lifted_off": "the rotor has come off one bearing of the pair: wear or the external force has "
    "taken its preload",
}
