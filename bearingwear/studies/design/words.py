"""Limits of the design study and what holds a preload, in words."""

LIMIT_WORDS = {
    "gyroscopic_slip_share": "gyroscopic slip share",
    "axial_stiffness_N_um": "axial stiffness",
    "maximum_pressure_GPa": "contact pressure",
    "friction_power_W": "friction power",
    "system_axial_stiffness_N_um": "stiffness of the arrangement",
    "rotor_shift_um": "shift of the rotor",
    "preload_kept": "preload kept",
    "friction_used_by_gyroscopic_moment": "friction used by the gyroscopic moment",
    "lowest_frequency_Hz": "frequency of the rotor",
    "none": "nothing: life is longest there",
    "end_of_range": "end of the map",
    "not_solved": "an unsolved neighbour",
    "no_preload_within_limits": "no preload keeps to all limits",
    "end_of_life": "a change in what ends the life",
}
"""What keeps a preload from one with a longer life."""

_LIMIT_TEXT = {
    "gyroscopic_slip_share": "gyroscopic slip share at most {:g} % in any contact",
    "axial_stiffness_N_um": "axial stiffness at least {:g} N/µm",
    "maximum_pressure_GPa": "contact pressure at most {:g} GPa",
    "friction_power_W": "power of friction and drag at most {:g} W",
    "system_axial_stiffness_N_um": "axial stiffness of the arrangement at least {:g} N/µm",
    "rotor_shift_um": "shift of the rotor at most {:g} µm",
    "preload_kept": "preload kept at least {:g} %",
    "friction_used_by_gyroscopic_moment": "friction used by the gyroscopic moment at most {:g} %",
    "lowest_frequency_Hz": "lowest natural frequency of the rotor at least {:g} Hz",
}


def limit_text(name: str, value: float) -> str:
    """What a limit asks for."""
    return _LIMIT_TEXT[name].format(in_percent(name, value))


def in_percent(name: str, value: float) -> float:
    """A limit, or a value beside it, as it is shown: a share in per cent."""
    return 100.0 * value if limit_unit(name) == "%" else value


def limit_unit(name: str) -> str:
    """The unit in which a limit is shown."""
    ends = {"_N_um": "N/um", "_GPa": "GPa", "_W": "W", "_um": "um", "_mm": "mm", "_Hz": "Hz"}
    return next((unit for end, unit in ends.items() if name.endswith(end)), "%")


RECOMMENDED_WORDS = {
    "axial_stiffness": ("least axial stiffness", ""),
    "maximum_pressure": ("largest pressure", ""),
    "friction_power": ("largest friction power", ""),
    "gyroscopic_slip_share": ("largest gyroscopic slip share", "%"),
    "system_axial_stiffness": ("least stiffness, arrangement", ""),
    "rotor_axial_shift": ("largest shift of the rotor", ""),
    "friction_used_by_gyroscopic_moment": ("friction used by gyro", "%"),
    "lowest_frequency": ("lowest frequency of the rotor", ""),
    "residual_preload_at_end": ("residual preload at the end", ""),
}
"""Quantities beside a recommended life, and how they are shown where the unit does not say."""

NONE_BECAUSE = "none_because"
"""Attribute of a recommendation: for each method without a preload, which limits none keeps to."""

LIMIT_KEY, END_KEY = "limits.", "wear.end_of_life."
"""Before the name of an assumption that is a limit of the design, or an end of the life."""

FRICTION_KEY, WEAR_KEY = "friction.ball_race", "materials.wear_coefficient"
"""Other assumptions."""

ASSUMED_WORDS = {FRICTION_KEY: "friction of ball and race", WEAR_KEY: "wear coefficient"}

GROOVE_WORDS = {"hertzian": "Hertzian", "worn": "as it wears"}
"""Which groove a life is of."""

HERTZIAN_LIFE_WORDS = "with a Hertzian groove"

TRACK_WORDS = {"spread": "evenly", "bands": "in bands"}
"""How balls wear."""
