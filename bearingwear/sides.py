"""Which values of a result two bearings share, and which differ between them."""

from collections.abc import Mapping
from typing import Any

SHARED = frozenset(
    {
        "system_axial_stiffness",
        "system_quasistatic_axial_stiffness",
        "lift_off_force",
        "rotor_axial_shift",
        "spring_travel",
        "natural_frequency",
        "rotor_balance_residual",
        "status",
        "life",
        "normalised_life",
        "life_error_bound",
        "life_error_estimate",
        "end_criterion",
        "history_time",
        "groove_step",
        "history_system_axial_stiffness",
        "thermal_margin",
        "history_thermal_margin",
        "history_system_quasistatic_axial_stiffness",
        "history_rotor_axial_shift",
        "life_cycles",
        "ending_phase",
        "phase_time_share",
        "phase_life",
        "phase_end_criterion",
        "palmgren_miner_life",
        "palmgren_miner_error",
        "ramp_error_estimate",
        "history_phase_residual_preload",
        "worst_residual_preload",
        "worst_gyroscopic_slip_share",
        "worst_skid_ratio",
        "worst_ball_diameter_loss",
        "worst_rotor_axial_shift",
        "worst_spring_travel",
        "worst_system_axial_stiffness",
        "worst_system_quasistatic_axial_stiffness",
        "worst_axial_stiffness",
        "worst_quasistatic_axial_stiffness",
        "worst_friction_used_by_gyroscopic_moment",
        "worst_film_worn_share",
        "worst_maximum_pressure",
        "worst_friction_power",
        "worst_greatest_depth",
        "worst_lowest_frequency",
        "worst_thermal_margin",
    }
)
"""Variables of a case or life with one value for both bearings."""


OF_ARRANGEMENT = {
    "system_axial_stiffness": "axial_stiffness",
    "system_quasistatic_axial_stiffness": "quasistatic_axial_stiffness",
}
"""Variables of an arrangement, and those of one bearing that determine them in a pair of equals."""


def values_of_bearing(values: Mapping[str, Any], k: int) -> dict[str, Any]:
    """Returns the values of one bearing of a pair, and those that both bearings share.

    values: values in a result of the pair by the names of variables. All but those of `SHARED` have
        a first axis over the two bearings.
    k: index of the bearing, 0 or 1.
    """
    return {name: value if name in SHARED else value[k] for name, value in values.items()}
