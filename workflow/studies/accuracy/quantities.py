"""The variables of a sweep: what errors are of, and what else is kept of a point."""

from bearingwear.studies.dataset import attrs

QUANTITIES = {
    "total_qv": attrs("QV of the bearing", "W"),
    "qv_inner": attrs("QV of an inner contact, mean over the balls", "W"),
    "qv_outer": attrs("QV of an outer contact, mean over the balls", "W"),
    "residual_preload": attrs("residual preload", "N"),
    "wear_rate": attrs("rate of the interference loss, counted as the scene says", "m s-1"),
    "cage_wear_rate": attrs("wear rate of the cage, pockets and land", "m3 s-1"),
    "life": attrs("wear life from new, counted as the scene says", "h"),
    "end_qv": attrs("QV of the bearing at the end of its life", "W"),
}
"""What the errors are of."""

EXTRA = {
    "wall_time": attrs("duration of the solve, warm, median of the repeats", "s"),
    "wall_time_least": attrs("duration of the fastest repeat", "s"),
    "processor_time": attrs("processor time of the solve, warm, median of the repeats", "s"),
    "repeats": attrs("times that the solve was timed", "1"),
    "life_wall_time": attrs("duration of finding the life, warm, median of the repeats", "s"),
    "life_processor_time": attrs(
        "processor time of finding the life, warm, median of the repeats", "s"
    ),
    "wear_over_gap": attrs(
        "loss at the end of life over the gap at the contact's edge, before any solve", "1"
    ),
    "simulated_turns": attrs("shaft turns simulated until settled or used up", "1"),
    "steps": attrs("steps taken and repeated", "1"),
    "estimate_total_qv": attrs("estimated error of QV of the bearing, as the case has it", "1"),
    "estimate_residual_preload": attrs("estimated error of the residual preload", "1"),
    "estimate_wear_rate": attrs("estimated error of the rate of the interference loss", "1"),
    "estimate_life": attrs("estimated error of the wear life", "1"),
    "coriolis_energy_share": attrs("work of the Coriolis force left out, of the heat", "1"),
    "azimuth_energy_share": attrs("work of the circumferential force left out, of the heat", "1"),
}
"""What else is kept of a point."""
