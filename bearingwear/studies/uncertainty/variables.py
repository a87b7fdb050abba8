"""Variables of a file of uncertain lives: its axes, and its statistics."""

from bearingwear.kernels.status import STATUS_NAMES
from bearingwear.results.quantiles import PRELOAD_CHOICE, SAMPLED_INPUTS, UNCERTAIN_INPUTS
from bearingwear.results.variable import Variable, table
from bearingwear.results.variables import STUDY_COORDINATES
from bearingwear.studies.answers import REFUSED
from bearingwear.studies.uncertainty.plan import PRELOAD_CHOICES

PROBABILITIES = (0.05, 0.1, 0.5, 0.9, 0.95)
"""Probabilities of the quantiles of life."""

LIFE_STATUSES = dict(zip(STATUS_NAMES, range(len(STATUS_NAMES)), strict=True)) | {
    "refused": REFUSED
}
"""Statuses of sampled lives by name; `refused` where no model takes the sampled values."""

FRICTION_AXIS, METHOD = STUDY_COORDINATES["friction"], STUDY_COORDINATES["preload_method"]
UNCERTAINTY_AXES = table(
    FRICTION_AXIS,
    METHOD,
    Variable(PRELOAD_CHOICE, (PRELOAD_CHOICE,), "", "choice of preload", dtype="i1",
        flags=PRELOAD_CHOICES),
    Variable(UNCERTAIN_INPUTS, (UNCERTAIN_INPUTS,), "",
        "which uncertain inputs vary: all; all but the wear coefficient and the hardness; those "
        "that scatter within a batch; those common to a batch", dtype="i1", flags=SAMPLED_INPUTS),
    Variable("probability", ("probability",), "1", "share of bearings that have failed"),
    Variable("life_status", ("life_status",), "", "status of a sampled life", dtype="i1",
        flags=tuple(LIFE_STATUSES)),
)  # fmt: skip
*_, CHOICE, INPUTS, PROBABILITY, STATUSES = UNCERTAINTY_AXES.values()

LONGEST_SHARE = ("longest_share", "longest_share_low", "longest_share_high")
QUANTILE = ("life_quantile", "life_quantile_low", "life_quantile_high")
"""Variables of a share or a quantile, and of the two ends of its confidence interval."""

_QUANTILE_DIMS, _INDEX_DIMS = (UNCERTAIN_INPUTS, "probability"), (UNCERTAIN_INPUTS, "quantity")
ANALYSED = table(
    Variable("preload", (), "N", "initial axial preload, median of its distribution"),
    Variable("evaluations", (), "1", "number of lives solved", dtype="i8",
        comment="sampled bearings that differ only in wear coefficient and hardness share a life"),
    Variable("solved_share", (), "1", "share of the sampled lives that could be computed",
        comment="the others are not in the quantiles"),
    Variable("status_count", ("life_status",), "1", "number of sampled lives with each status",
        dtype="i8"),
    Variable("index_share", (), "1", "share of the base samples used for the indices"),
    Variable("nominal_life", (), "h", "life with every value at its median"),
    Variable("life_quantile", _QUANTILE_DIMS, "h", "quantile of life",
        comment="90 % of bearings lie between probabilities 0.05 and 0.95; what does not vary is "
        "at its median, but wear coefficient and hardness as in the scene for all_but_wear"),
    Variable("life_quantile_low", _QUANTILE_DIMS, "h",
        "lower end of the confidence interval of life_quantile, due to the size of the sample"),
    Variable("life_quantile_high", _QUANTILE_DIMS, "h",
        "upper end of the confidence interval of life_quantile, due to the size of the sample"),
    Variable("longest_share", (), "1",
        "share of sampled bearings for which this method gives the longest life",
        comment="each bearing has the same uncertain values with every method"),
    Variable("longest_share_low", (), "1",
        "lower end of the confidence interval of longest_share"),
    Variable("longest_share_high", (), "1",
        "upper end of the confidence interval of longest_share"),
    Variable("life_one_at_a_time", ("quantity", "end"), "h",
        "life with one value at its 10 % and 90 % quantiles and the others at their medians"),
    Variable("first_index", _INDEX_DIMS, "1", "first-order Sobol index of log life",
        comment="of the samples all and all_but_wear"),
    Variable("first_index_error", _INDEX_DIMS, "1",
        "half-width of the confidence interval of first_index"),
    Variable("total_index", _INDEX_DIMS, "1", "total Sobol index of log life",
        comment="of the samples all and all_but_wear"),
    Variable("total_index_error", _INDEX_DIMS, "1",
        "half-width of the confidence interval of total_index"),
    Variable("life_sample", (UNCERTAIN_INPUTS, "member"), "h",
        "sorted lives of independent bearings, at evenly spaced probabilities"),
)  # fmt: skip
"""Statistics of the sampled lives of a method at a preload; lives in hours."""
