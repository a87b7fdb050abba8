"""What a file of uncertain lives holds: its axes, and its statistics."""

from bearingwear.results.quantiles import PRELOAD_CHOICE, UNCERTAIN_INPUTS
from bearingwear.results.variable import Variable, table
from bearingwear.results.variables import STUDY_COORDINATES
from bearingwear.studies.uncertainty.plan import PRELOAD_CHOICES

UNCERTAINTY_AXES = table(
    STUDY_COORDINATES["preload_method"],
    Variable(PRELOAD_CHOICE, (PRELOAD_CHOICE,), "", "choice of preload", dtype="i1",
        flags=PRELOAD_CHOICES),
    Variable(UNCERTAIN_INPUTS, (UNCERTAIN_INPUTS,), "",
        "which uncertain inputs vary: all, or all but the wear coefficient and the hardness",
        dtype="i1", flags=("all", "all_but_wear")),
    Variable("probability", ("probability",), "1", "share of bearings that have failed"),
    Variable("batch_probability", ("batch_probability",), "1",
        "share of batches with a lower value, given the uncertainty of the batch"),
)  # fmt: skip
METHOD, CHOICE, INPUTS, PROBABILITY, BATCH = UNCERTAINTY_AXES

LONGEST_SHARE = ("longest_share", "longest_share_low", "longest_share_high")

QUANTILE, INDEX = (INPUTS, PROBABILITY), (INPUTS, "quantity")
ANALYSED = table(
    Variable("preload", (), "N", "initial axial preload, median of its distribution"),
    Variable("evaluations", (), "1", "number of lives evaluated", dtype="i8"),
    Variable("solved_share", (), "1", "share of the evaluated lives that could be computed"),
    Variable("index_share", (), "1", "share of the base samples used for the indices"),
    Variable("solved_lives", (), "1", "number of lives computed with Hertzian grooves"),
    Variable("interpolation_error", (), "1",
        "maximum relative error in the interpolated lives, except for interpolation_share of them",
        comment="estimated from computed lives not used in the fit, with 95 % confidence if "
        "several values vary; 0: no lives were interpolated"),
    Variable("interpolation_share", (), "1",
        "share of the interpolated lives whose error may exceed interpolation_error"),
    Variable("followed_lives", (), "1", "number of lives computed with worn grooves"),
    Variable("groove_error", (), "1",
        "maximum relative error in interpolated lives with worn grooves, except for groove_share "
        "of them",
        comment="as for interpolation_error; 0: all were computed with worn grooves, NaN: none"),
    Variable("groove_share", (), "1",
        "share of the interpolated lives with worn grooves whose error may exceed groove_error"),
    Variable("nominal_life", (), "h", "life with every value at its median"),
    Variable("batch_life_quantile", (BATCH, PROBABILITY), "h",
        "quantile of the lives in a batch, for each quantile of the batch uncertainty",
        comment="probability 0.1 gives L10; the middle of batch_probability gives the scatter "
        "within a batch, and its ends give the uncertainty of the batch"),
    Variable("batch_life_quantile_error", (BATCH, PROBABILITY), "h",
        "half-width of the confidence interval of batch_life_quantile, due to sampling",
        comment="the larger of the distances from the quantile to the ends of the interval, "
        "widened by the error in interpolated lives"),
    Variable("life_quantile", QUANTILE, "h",
        "quantile of life, allowing for scatter within a batch and the uncertainty of the batch",
        comment="90 % of bearings lie between probabilities 0.05 and 0.95"),
    Variable("life_quantile_low", QUANTILE, "h",
        "lower end of the confidence interval of life_quantile"),
    Variable("life_quantile_high", QUANTILE, "h",
        "upper end of the confidence interval of life_quantile"),
    Variable("longest_share", (), "1",
        "share of sampled bearings for which this method gives the longest life",
        comment="each bearing has the same uncertain values with every method"),
    Variable("longest_share_low", (), "1",
        "lower end of the confidence interval of longest_share"),
    Variable("longest_share_high", (), "1",
        "upper end of the confidence interval of longest_share"),
    Variable("life_one_at_a_time", ("quantity", "end"), "h",
        "life with one value at its 10 % and 90 % quantiles and the others at their medians"),
    Variable("first_index", INDEX, "1", "first-order Sobol index of log life"),
    Variable("first_index_error", INDEX, "1",
        "half-width of the confidence interval of first_index"),
    Variable("class_index", ("quantity",), "1",
        "total Sobol index of log life within the class of the value",
        comment="the two classes are values common to a batch and values that scatter within it; "
        "the values in the other class are set to those in the scene"),
    Variable("total_index", INDEX, "1", "total Sobol index of log life"),
    Variable("total_index_error", INDEX, "1",
        "half-width of the confidence interval of total_index"),
    Variable("life_sample", (INPUTS, "member"), "h",
        "sorted lives of independent bearings, at evenly spaced probabilities"),
)  # fmt: skip
"""Statistics of the sampled lives of a method at a preload; lives in hours."""
