"""The spread of a life, from files of the study of uncertainty for the same bearing."""

from __future__ import annotations

import contextlib
import json
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.measures import plain
from bearingwear.results.netcdf import CaseFileError, header, load_kind
from bearingwear.results.units import Interval, Rough, digits, key_in_words
from bearingwear.results.words import methods, plain_scene
from bearingwear.scene.changes import with_changes
from bearingwear.scene.coefficients import NINETY, usual_spread
from bearingwear.scene.decisive import decisive_data
from bearingwear.scene.scene import WORN
from bearingwear.scene.uncertain import Distribution, is_same_for_batch

if TYPE_CHECKING:
    import xarray as xr

KIND = "uncertainty"
"""Kind of the files of the study of uncertainty, with quantiles of sampled lives."""

PLACES_BESIDE = ("spread.nc", "design/uncertainty.nc", "uncertainty.nc")
"""Files of uncertainty, from the folder of a result; the last is for results in `design`."""

ASSUMED_SPREAD = "spread_taken"
"""Attribute of a file of uncertainty: which distributions were assumed for a scene without any."""

PRELOAD_CHOICE, UNCERTAIN_INPUTS = "preload_choice", "uncertain_inputs"
"""Dimensions of a file of uncertainty: which preload, and which of the uncertain inputs vary."""

GIVEN, RECOMMENDED = 0, 1
"""Values of `PRELOAD_CHOICE`: the scene's own preload, and the recommended one."""

SAMPLED_INPUTS = ("all", "all_but_wear", "scatter", "batch")
ALL_INPUTS, ALL_BUT_WEAR, SCATTER_ONLY, BATCH_ONLY = range(len(SAMPLED_INPUTS))
"""Values of `UNCERTAIN_INPUTS`: all uncertain values of the scene; all but the wear coefficient and
the hardness; those that scatter from bearing to bearing; those that a batch of bearings shares."""

CONFIDENCE = 0.95
"""Confidence of the intervals of quantiles and Sobol indices."""

INTERVAL = (0.05, 0.95)
"""Probabilities at the ends of the intervals that are quoted."""

QUOTED_SHARE = f"{100 * (INTERVAL[1] - INTERVAL[0]):g} %"
"""The share of bearings or batches in the interval `INTERVAL`, in words."""

NO_QUANTILES = "the spread in life was not computed"
SEE = "use the command bearingwear uncertainty"

BEARINGS_BETWEEN = f"{QUOTED_SHARE} of bearings"
"""Label of the interval due to all uncertain values."""

WITHIN_BATCH, OF_BATCH = "  scatter within a batch", "  uncertainty of the batch"
"""Labels of the intervals due to each of the two kinds of uncertain values alone."""

MEDIAN_BATCH = {"L10 of the median batch": 0.1, "L50 of the median batch": 0.5}
"""Probabilities of the quantiles due to scatter alone, by their labels."""

BY_WEAR = f"  {BEARINGS_BETWEEN}, wear only"
"""Label of the interval of `band_by_wear`."""


class Spread(NamedTuple):
    """The lives of 90 % of the bearings, and its two causes [h]."""

    bearings: Interval  # due to all uncertain values
    scatter: Interval | None  # within the median batch; None: bearings of a batch are alike
    unknown: Interval | None  # of the median bearing of a batch; None: batches are alike
    quantiles: Mapping[str, float]  # L10 and L50 of the median batch; empty without scatter
    errors: Mapping[str, str]  # confidence intervals of all of these, by the labels of `rows`
    solved: float  # share of the sampled lives that could be computed
    failures: Mapping[str, int]  # number of the other lives, by status in words
    # share of all bearings in which this preload method gives the longest life [%]: its interval,
    # None for a single method, and its value in the sample
    longest: Interval | None
    longest_share: float

    @property
    def sentence(self) -> str:
        """States the interval of lives: `90 % of bearings have lives between 0.34 and 5.8 h`.

        If some sampled lives could not be computed, it also states the share of the others.
        """
        low, high = Rough(self.bearings.low).text, Rough(self.bearings.high).text
        bearings = BEARINGS_BETWEEN.replace(" %", "\N{NO-BREAK SPACE}%")
        text = f"{bearings} have lives between {low} and {high} h"
        if self.bearings.low == 0.0:
            text += " (0: some bearings meet an end-of-life criterion when new)"
        if self.solved < 1.0:
            percent = plain(100.0 * self.solved)
            text += f" (among the {percent} % of bearings whose lives could be computed)"
        return text

    @property
    def failures_sentence(self) -> str:
        """States how many sampled lives could not be computed, by status; empty if all could."""
        count = sum(self.failures.values())
        if not count:
            return ""
        counts = ", ".join(f"{status}: {number}" for status, number in self.failures.items())
        noun = "life" if count == 1 else "lives"
        return f"{count} sampled {noun} could not be computed and count in no quantile ({counts})."

    @property
    def rows(self) -> dict[str, Interval | float | str]:
        """Returns the intervals and quantiles [h] by the labels of their rows in a sheet or table.

        `none` stands for the interval of a cause that the scene does not have.
        """
        return {
            BEARINGS_BETWEEN: self.bearings,
            WITHIN_BATCH: self.scatter or "none",
            OF_BATCH: self.unknown or "none",
            **self.quantiles,
        }


def band_by_wear(scene: Mapping[str, Any], life: float) -> tuple[Interval | None, str]:
    """Returns the interval with the lives of 90 % of bearings if only wear is uncertain.

    The life is proportional to 1/K_s. The interval is None unless the life is above 0 and all
    distributions of wear are lognormal about the value of the scene. A text states which
    distributions were assumed; it is empty if the scene has some, or without an interval.

    scene: plain data. Without distributions, those of the table of coefficients apply.
    life: in any unit, which is that of the interval.
    """
    distributions, assumed = scene.get("uncertainty") or {}, ""
    if scene and not distributions:
        distributions, assumed = usual_spread(scene)
    wear_spreads = [spread for name, spread in distributions.items() if name in WORN]
    are_lognormal = all("factor" in spread and "median" not in spread for spread in wear_spreads)
    if not wear_spreads or not are_lognormal or not life > 0.0:
        return None, ""
    # variances of independent logarithms add up
    deviation = math.hypot(*(math.log(spread["factor"]) for spread in wear_spreads))
    low, high = life * math.exp(-NINETY * deviation), life * math.exp(NINETY * deviation)
    return Interval(low, high), assumed


def hours_in_words(scene: Mapping[str, Any], life_h: float) -> str:
    """Returns a life with its interval: `0.658 h (0.11 to 4 h if only wear is uncertain)`.

    The interval is left out if `band_by_wear` returns none.

    scene: plain data.
    """
    band, _ = band_by_wear(scene, life_h)
    interval = f" ({band.text} h if only wear is uncertain)" if band else ""
    return f"{digits(life_h)} h{interval}"


def spread_text(spread: Spread | None) -> str:
    """Returns `Spread.sentence`; without a spread, that it was not computed."""
    return spread.sentence if spread else NO_QUANTILES


def load_quantiles(path: str | Path) -> list[xr.Dataset]:
    """Returns a dataset for each friction coefficient in a file of the study of uncertainty.

    CaseFileError: the file cannot be read, or is of another kind or of an earlier version.
    """
    dataset = load_kind(path, KIND)
    has_inputs = dataset.sizes.get(UNCERTAIN_INPUTS) == len(SAMPLED_INPUTS)
    if not has_inputs or PRELOAD_CHOICE not in dataset.dims:
        problem = "got a file written by an earlier version, expected a recomputed file"
        raise CaseFileError(f"{path}: {problem}")
    return at_each_friction(dataset)


def at_each_friction(uncertainty: xr.Dataset) -> list[xr.Dataset]:
    """Returns a dataset for each friction coefficient, whose scene has that coefficient.

    uncertainty: contents of a file of uncertainty; without the dimension `friction`, they are
        returned as the only dataset.
    """
    if "friction" not in uncertainty.dims:
        return [uncertainty]
    scene = plain_scene(uncertainty)
    return [
        uncertainty.sel(friction=mu, drop=True).assign_attrs(
            scene=json.dumps(with_changes(scene, {"friction.ball_race": mu}))
        )
        for mu in uncertainty["friction"].values.tolist()
    ]


def uncertainties_at(path: str | Path) -> list[xr.Dataset]:
    """Returns the datasets of `load_quantiles` from a file and the files of uncertainty beside it.

    Files of another kind, and those that cannot be read, are left out.
    """
    folder, files = Path(path).parent, [Path(path)]
    for place in PLACES_BESIDE:
        files += sorted(folder.glob(place))
    uncertainties = []
    for file in files:
        with contextlib.suppress(CaseFileError):
            # most files are of another kind, and need not wait for xarray
            if header(file).get("kind") == KIND:
                uncertainties += load_quantiles(file)
    return uncertainties


def spread_of(
    uncertainties: Iterable[xr.Dataset],
    scene: Mapping[str, Any],
    method: str,
    friction: float | None,
    choice: int = GIVEN,
) -> Spread | None:
    """Returns the spread of the life of a scene; None if it was not computed for that scene.

    uncertainties: contents of files of the study of uncertainty, as from `load_quantiles`.
    scene: of the life, as in its file; that of a study leaves out the keys that it varies.
    method: preload method of the life.
    friction: ball-race friction coefficient of the life; None for that of the scene, or of a film.
    choice: the scene's own preload, `GIVEN`, or the recommended one, `RECOMMENDED`.
    """
    for uncertainty in uncertainties:
        sampled_scene = plain_scene(uncertainty)
        if ASSUMED_SPREAD in uncertainty.attrs and "uncertainty" not in scene:
            del sampled_scene["uncertainty"]
        by_method = dict(methods(uncertainty))
        if method not in by_method or choice not in uncertainty[PRELOAD_CHOICE]:
            continue
        sampled = _decisive_scene(sampled_scene, method)
        if _decisive_scene(scene, method, friction) == sampled:
            return spread_at(by_method[method].sel({PRELOAD_CHOICE: choice}))
    return None


def causes_sentence(scene: Mapping[str, Any]) -> str:
    """Returns sentences that name the uncertain values of a scene by the spread that they cause.

    That is the scatter within a batch, or the uncertainty of the batch. The text is empty if no
    value is uncertain.

    scene: plain data.
    """
    distributions = {
        key: Distribution(**content) for key, content in (scene.get("uncertainty") or {}).items()
    }
    of_batch: list[str] = []
    of_bearing: list[str] = []
    for key, distribution in distributions.items():
        causes = of_batch if is_same_for_batch(key, distribution) else of_bearing
        causes.append(_cause_words(key))
    sentences = []
    if of_batch and of_bearing:
        sentences.append("L10 and L50 are those of wear within the median batch, not of fatigue.")
    if of_bearing:
        sentences.append(f"Scatter within a batch: {', '.join(of_bearing)}.")
    if of_batch:
        sentences.append(f"Uncertainty of the batch: {', '.join(of_batch)}.")
    return " ".join(sentences)


def _cause_words(key: str) -> str:
    """Returns the words for a key of the block `uncertainty`, without its unit."""
    if key == "ball_race":
        return "ball-race friction"
    words, _ = key_in_words(key)
    return words


def _decisive_scene(
    scene: Mapping[str, Any], method: str, friction: float | None = None
) -> dict[str, Any]:
    """Returns the data of a scene that determine its spread, at a preload method and friction.

    Settings of accuracy are left out, since they change a life by far less than its spread.

    friction: ball-race friction coefficient; None for that of the scene.
    """
    changes: dict[str, Any] = {"operation.preload_method": method}
    if friction is not None:
        changes["friction.ball_race"] = friction
    blocks = {
        key: block for key, block in decisive_data(scene).items() if key not in ("name", "model")
    }
    # the scene in a file of a study lacks the loss, which the study varies
    blocks["wear"] = {"ball_diameter_loss_um": 0.0} | scene["wear"]
    return with_changes(blocks, changes)


def spread_at(uncertainty: xr.Dataset) -> Spread | None:
    """Returns the spread of the lives at one preload; None if no life was solved.

    uncertainty: quantiles at one preload method, choice of preload, and friction.
    """
    bearings = interval_of(uncertainty, ALL_INPUTS)
    if not math.isfinite(bearings.low):
        return None
    scatter = interval_of(uncertainty, SCATTER_ONLY)
    unknown = interval_of(uncertainty, BATCH_ONLY)
    has_scatter = scatter.low != scatter.high
    probabilities = MEDIAN_BATCH if has_scatter else {}
    within_batch = uncertainty["life_quantile"].sel({UNCERTAIN_INPUTS: SCATTER_ONLY})
    return Spread(
        bearings=bearings,
        scatter=scatter if has_scatter else None,
        unknown=None if unknown.low == unknown.high else unknown,
        quantiles={
            label: float(within_batch.sel(probability=p)) for label, p in probabilities.items()
        },
        errors=_error_texts(uncertainty, probabilities),
        solved=float(uncertainty["solved_share"]),
        failures=_failure_counts(uncertainty),
        longest=_longest_life_interval(uncertainty),
        longest_share=100.0 * float(uncertainty.get("longest_share", math.nan)),
    )


def _error_texts(uncertainty: xr.Dataset, probabilities: Mapping[str, float]) -> dict[str, str]:
    """Returns the confidence intervals of the rows of `Spread.rows`, by their labels.

    A row with an interval has one for each of its ends.

    probabilities: of the quantiles due to scatter alone, by their labels.
    """
    inputs_of = {BEARINGS_BETWEEN: ALL_INPUTS, WITHIN_BATCH: SCATTER_ONLY, OF_BATCH: BATCH_ONLY}
    texts = {
        label: ", ".join(_error_text(uncertainty, inputs, end) for end in INTERVAL)
        for label, inputs in inputs_of.items()
    }
    for label, probability in probabilities.items():
        texts[label] = _error_text(uncertainty, SCATTER_ONLY, probability)
    return texts


def interval_of(uncertainty: xr.Dataset, inputs: int) -> Interval:
    """Returns the interval with the lives of 90 % of the bearings [unit of the file].

    inputs: which of the uncertain inputs vary, a value of `UNCERTAIN_INPUTS`.
    """
    quantiles = uncertainty["life_quantile"].sel({UNCERTAIN_INPUTS: inputs})
    return Interval(*quantiles.sel(probability=list(INTERVAL)).values.tolist())


def _failure_counts(uncertainty: xr.Dataset) -> dict[str, int]:
    """Returns the numbers of sampled lives that could not be computed, by status in words.

    A status that no life has is left out; the dict is empty if all lives could be computed.
    """
    names = uncertainty["life_status"].attrs["flag_meanings"].split()
    counts = dict(zip(names, uncertainty["status_count"].values.tolist(), strict=True))
    return {
        name.replace("_", " "): int(count)
        for name, count in counts.items()
        if count and name != STATUS_NAMES[OK]
    }


def _error_text(uncertainty: xr.Dataset, inputs: int, probability: float) -> str:
    """Returns the confidence interval of a quantile [unit of the file] as text with two digits.

    An end may be unknown: `up to 5.8`, `from 0.34`, `not known`.

    inputs: which of the uncertain inputs vary, a value of `UNCERTAIN_INPUTS`.
    """
    index = {UNCERTAIN_INPUTS: inputs, "probability": probability}
    low = Rough(uncertainty["life_quantile_low"].sel(index))
    high = Rough(uncertainty["life_quantile_high"].sel(index))
    if math.isfinite(low) and math.isfinite(high):
        return low.text if low.text == high.text else f"{low.text} to {high.text}"
    if math.isfinite(high):
        return f"up to {high.text}"
    return f"from {low.text}" if math.isfinite(low) else "not known"


def _longest_life_interval(uncertainty: xr.Dataset) -> Interval | None:
    """Returns the confidence interval of the share of bearings that last longest with a method [%].

    It is None for a file with a single preload method.

    uncertainty: contents of a file at one preload method.
    """
    low = 100.0 * float(uncertainty.get("longest_share_low", math.nan))
    high = 100.0 * float(uncertainty.get("longest_share_high", math.nan))
    return Interval(low, high) if math.isfinite(low) else None


def quantities_of(uncertainty: xr.Dataset) -> list[str]:
    """Returns the names of the uncertain values, in the order of the file."""
    return uncertainty["quantity"].attrs["flag_meanings"].split()


def available_preload_choice(uncertainty: xr.Dataset) -> int:
    """Returns `RECOMMENDED` if there is a recommended preload, else `GIVEN`.

    uncertainty: contents of a file at one preload method.
    """
    if RECOMMENDED not in uncertainty["preload_choice"]:
        return GIVEN
    recommended = uncertainty["preload"].sel(preload_choice=RECOMMENDED)
    return RECOMMENDED if np.isfinite(recommended) else GIVEN
