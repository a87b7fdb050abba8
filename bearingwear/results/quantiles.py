"""The spread of a life, as the study of uncertainty found it for the same bearing."""

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
from bearingwear.results.units import Interval, Rough, key_in_words
from bearingwear.scene.changes import with_changes
from bearingwear.scene.coefficients import NINETY, usual_spread
from bearingwear.scene.decisive import decisive_data
from bearingwear.scene.scene import WORN
from bearingwear.scene.uncertain import Distribution, is_same_for_batch

if TYPE_CHECKING:
    import xarray as xr

KIND = "uncertainty"
PLACES_BESIDE = ("spread.nc", "design/uncertainty.nc", "uncertainty.nc")
"""Where such files stand beside the results of a scene; the last is that of the design study."""

ASSUMED_SPREAD = "spread_taken"
"""Attribute of such a file: what distributions it has where the scene has none."""

PRELOAD_CHOICE, UNCERTAIN_INPUTS = "preload_choice", "uncertain_inputs"
"""Dimensions of such a file: which preload, and which of the uncertain inputs vary."""

GIVEN, RECOMMENDED = 0, 1
"""Values of `PRELOAD_CHOICE`: the scene's own preload, and the recommended one."""

SAMPLED_INPUTS = ("all", "all_but_wear", "scatter", "batch")
ALL_INPUTS, ALL_BUT_WEAR, SCATTER_ONLY, BATCH_ONLY = range(len(SAMPLED_INPUTS))
"""Values of `UNCERTAIN_INPUTS`: all that the scene calls uncertain; all but the wear coefficient
and the hardness; what scatters from bearing to bearing; what all bearings of a batch share."""

CONFIDENCE = 0.95
"""Of the intervals of quantiles and Sobol indices."""

INTERVAL = (0.05, 0.95)
"""Probabilities at the ends of the intervals that are quoted."""

QUOTED_SHARE = f"{100 * (INTERVAL[1] - INTERVAL[0]):g} %"
"""Of bearings or of batches in such an interval, in words."""

NO_QUANTILES = "the spread in life was not computed"
SEE = "use the command bearingwear uncertainty"

BEARINGS_BETWEEN = f"{QUOTED_SHARE} of bearings"
"""Label of the interval that matters most."""

WITHIN_BATCH, OF_BATCH = "  scatter within a batch", "  uncertainty of the batch"
"""Labels of its two parts."""

BY_WEAR = f"  {BEARINGS_BETWEEN}, wear only"
"""Label of `band_by_wear`."""


class Spread(NamedTuple):
    """Between which lives bearings lie, and why [h]."""

    bearings: Interval  # including all uncertain values
    scatter: Interval | None  # within the middle batch; None: bearings of a batch are alike
    unknown: Interval | None  # of the middle bearing of a batch; None: batches are alike
    quantiles: Mapping[str, float]  # L10 and L50 of the middle batch; empty without scatter
    errors: Mapping[str, str]  # confidence intervals of these, by the labels of `rows`
    solved: float  # share of the sampled lives; the others are left out
    failures: Mapping[str, int]  # the number of those, by their status
    longest: Interval | None  # of bearings by this method, of several [%]
    longest_share: float  # the same of the sampled bearings

    @property
    def sentence(self) -> str:
        """`90 % of bearings have lives between 0.34 and 5.8 h`, and of how many if not all."""
        low, high = self.bearings.text.split(" to ")
        text = f"{BEARINGS_BETWEEN} have lives between {low} and {high} h".replace(
            " %", "\N{NO-BREAK SPACE}%"
        )
        if self.bearings.low == 0.0:
            text += " (0: some bearings meet an end-of-life criterion when new)"
        share = (
            f" (among the {plain(100.0 * self.solved)} % of bearings whose lives could be computed)"
        )
        return text + (share if self.solved < 1.0 else "")

    @property
    def failures_sentence(self) -> str:
        """`3 sampled lives could not be computed (beyond groove: 3)`, or nothing."""
        count = sum(self.failures.values())
        each = ", ".join(f"{name}: {n}" for name, n in self.failures.items())
        verb = "life" if count == 1 else "lives"
        left_out = f"{count} sampled {verb} could not be computed and count in no quantile"
        return f"{left_out} ({each})." if count else ""

    @property
    def rows(self) -> dict[str, Interval | float | str]:
        """Rows of a sheet or a table, by label."""
        return {
            BEARINGS_BETWEEN: self.bearings,
            WITHIN_BATCH: self.scatter or "none",
            OF_BATCH: self.unknown or "none",
            **self.quantiles,
        }


def band_by_wear(scene: Mapping[str, Any], life: float) -> tuple[Interval | None, str]:
    """Between which lives 90 % of bearings lie by what is not known of wear; life goes as 1/K_s.

    scene: as a file states it. Without distributions it has those of the table of coefficients.

    Returns: in the unit of the life; none where the distributions do not say, or not as lognormal.
    Returns: what distributions were taken, empty if its own.
    """
    spread, taken = scene.get("uncertainty"), ""
    if scene and not spread:
        spread, taken = usual_spread(scene)
    given = [one for name, one in (spread or {}).items() if name in WORN]
    if not given or not life > 0.0 or any("factor" not in d or "median" in d for d in given):
        return None, ""
    deviation = math.hypot(*(math.log(one["factor"]) for one in given))
    return Interval(*(life * math.exp(z * deviation) for z in (-NINETY, NINETY))), taken


def hours_in_words(scene: Mapping[str, Any], life: float) -> str:
    """A life that stands alone: `0.66 h (by wear 0.11 to 4 h)`."""
    band, _ = band_by_wear(scene, life)
    return f"{Rough(life).text} h" + (f" ({band.text} h if only wear is uncertain)" if band else "")


def spread_text(spread: Spread | None) -> str:
    """`Spread.sentence`, or a note that there is none."""
    return spread.sentence if spread else NO_QUANTILES


def load_quantiles(path: str | Path) -> list[xr.Dataset]:
    """The quantiles in a file of the study of uncertainty, as `at_each_friction`."""
    found = load_kind(path, KIND)
    if found.sizes.get(UNCERTAIN_INPUTS) != len(SAMPLED_INPUTS) or PRELOAD_CHOICE not in found.dims:
        problem = "got a file written by an earlier version, expected a recomputed file"
        raise CaseFileError(f"{path}: {problem}")
    return at_each_friction(found)


def at_each_friction(uncertainty: xr.Dataset) -> list[xr.Dataset]:
    """A dataset for each friction coefficient of a file, with the scene at it; one without any."""
    if "friction" not in uncertainty.dims:
        return [uncertainty]
    scene = json.loads(uncertainty.attrs["scene"])
    return [
        uncertainty.sel(friction=mu, drop=True).assign_attrs(
            scene=json.dumps(with_changes(scene, {"friction.ball_race": mu}))
        )
        for mu in uncertainty["friction"].values.tolist()
    ]


def uncertainties_at(path: str | Path) -> list[xr.Dataset]:
    """A file itself and the files beside it, as far as they are of uncertainty."""
    folder = Path(path).parent
    found = []
    for file in [path, *(file for place in PLACES_BESIDE for file in sorted(folder.glob(place)))]:
        with contextlib.suppress(CaseFileError):
            # most files are of another kind, and need not wait for xarray
            if header(file).get("kind") == KIND:
                found += load_quantiles(file)
    return found


def spread_of(
    known: Iterable[xr.Dataset],
    scene: Mapping[str, Any],
    method: str,
    friction: float | None,
    choice: int = GIVEN,
) -> Spread | None:
    """The spread of the life of a scene; None if it was not computed for exactly that scene.

    known: files of the study of uncertainty.
    scene: the life's, as its file states it; that of a study leaves out what is varied.
    method, friction: of the life; no friction of one with a film.
    choice: the preload: the scene's own or the recommended one.
    """
    for dataset in known:
        sampled = json.loads(dataset.attrs["scene"])
        if ASSUMED_SPREAD in dataset.attrs and "uncertainty" not in scene:
            del sampled["uncertainty"]
        flags = dataset["preload_method"].attrs["flag_meanings"].split()
        methods = [flags[int(flag)] for flag in dataset["preload_method"].values]
        if (
            method in methods
            and choice in dataset[PRELOAD_CHOICE]
            and _point(scene, method, friction) == _point(sampled, method)
        ):
            of_method = dataset.isel(preload_method=methods.index(method))
            return spread_at(of_method.sel({PRELOAD_CHOICE: choice}))
    return None


def causes_sentence(scene: Mapping[str, Any]) -> str:
    """Uncertain values of a scene, by the labels of `Spread.rows`."""
    given = {k: Distribution(**one) for k, one in (scene.get("uncertainty") or {}).items()}
    parts = (("Scatter within a batch", False), ("Uncertainty of the batch", True))
    found = [
        (
            text,
            ", ".join(_cause(k) for k, one in given.items() if is_same_for_batch(k, one) == cause),
        )
        for text, cause in parts
    ]
    middle = "L10 and L50 refer to the median batch. " if all(name for _, name in found) else ""
    return middle + " ".join(f"{text}: {names}." for text, names in found if names)


def causes(scene: Mapping[str, Any]) -> list[str]:
    """Uncertain values of a scene, in words."""
    return [_cause(key) for key in scene.get("uncertainty") or {}]


def _cause(key: str) -> str:
    words = "ball-race friction" if key == "ball_race" else key_in_words(key)[0]
    return words.replace("brinell", "Brinell")


def _point(scene: Mapping[str, Any], method: str, friction: float | None = None) -> dict[str, Any]:
    """A scene at a method and friction, with what a study leaves out filled in.

    Settings of accuracy move a life by far less than it spreads; they may differ.
    """
    varied: dict[str, Any] = {"operation.preload_method": method}
    if friction is not None:
        varied["friction.ball_race"] = friction
    known = decisive_data(scene).items()
    whole = {key: value for key, value in known if key not in ("name", "model")}
    wear = {"ball_diameter_loss_um": 0.0} | scene["wear"]
    return with_changes(whole | {"wear": wear}, varied)


def spread_at(one: xr.Dataset) -> Spread | None:
    """The spread of the lives of a method at a preload; None where no life was solved."""
    bearings = interval_of(one, ALL_INPUTS)
    if not math.isfinite(bearings.low):
        return None
    scatter, unknown = interval_of(one, SCATTER_ONLY), interval_of(one, BATCH_ONLY)
    alike = scatter.low == scatter.high
    intervals = {BEARINGS_BETWEEN: ALL_INPUTS, WITHIN_BATCH: SCATTER_ONLY, OF_BATCH: BATCH_ONLY}
    errors = {
        label: ", ".join(_error_text(one, inputs, p) for p in INTERVAL)
        for label, inputs in intervals.items()
    }
    labels = {} if alike else {"L10": 0.1, "L50": 0.5}
    errors |= {label: _error_text(one, SCATTER_ONLY, p) for label, p in labels.items()}
    within = one["life_quantile"].sel({UNCERTAIN_INPUTS: SCATTER_ONLY})
    return Spread(
        bearings=bearings,
        scatter=None if alike else scatter,
        unknown=None if unknown.low == unknown.high else unknown,
        quantiles={label: float(within.sel(probability=p)) for label, p in labels.items()},
        errors=errors,
        solved=float(one["solved_share"]),
        failures=_failures(one),
        longest=_longest(one),
        longest_share=100.0 * float(one.get("longest_share", math.nan)),
    )


def interval_of(one: xr.Dataset, inputs: int) -> Interval:
    """The lives of 90 % of the bearings of a sample, by its flag of `UNCERTAIN_INPUTS`."""
    quantiles = one["life_quantile"].sel({UNCERTAIN_INPUTS: inputs})
    return Interval(*quantiles.sel(probability=list(INTERVAL)).values.tolist())


def _failures(one: xr.Dataset) -> dict[str, int]:
    """How many sampled lives could not be computed, by their status in words."""
    names = one["life_status"].attrs["flag_meanings"].split()
    counts = zip(names, one["status_count"].values.tolist(), strict=True)
    return {name.replace("_", " "): int(n) for name, n in counts if n and name != STATUS_NAMES[OK]}


def _error_text(one: xr.Dataset, inputs: int, probability: float) -> str:
    """The confidence interval of a quantile, whose ends the sample may not have, as two digits."""
    at = {UNCERTAIN_INPUTS: inputs, "probability": probability}
    low, high = (float(one[f"life_quantile_{end}"].sel(at)) for end in ("low", "high"))
    if math.isfinite(low) and math.isfinite(high):
        return " to ".join(dict.fromkeys(Rough(end).text for end in (low, high)))
    if math.isfinite(high):
        return f"up to {Rough(high).text}"
    return f"from {Rough(low).text}" if math.isfinite(low) else "not known"


def _longest(one: xr.Dataset) -> Interval | None:
    """In how many of 100 bearings the method gives the longest life; none of a single method."""
    names = "longest_share_low", "longest_share_high"
    ends = [100.0 * float(one.get(name, math.nan)) for name in names]
    return Interval(*ends) if math.isfinite(ends[0]) else None


def quantities_of(uncertainty: xr.Dataset) -> list[str]:
    """Names of the uncertain values, in the order of the file."""
    return uncertainty["quantity"].attrs["flag_meanings"].split()


def preload_drawn(one: xr.Dataset) -> int:
    """The recommended preload, or the scene's own where none is recommended."""
    if RECOMMENDED not in one["preload_choice"]:
        return GIVEN
    recommended = one["preload"].sel(preload_choice=RECOMMENDED)
    return RECOMMENDED if np.isfinite(recommended) else GIVEN
