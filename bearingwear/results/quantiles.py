"""The spread of a life, as the study of uncertainty found it for the same bearing."""

from __future__ import annotations

import contextlib
import json
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from bearingwear.results.netcdf import CaseFileError, header, load
from bearingwear.results.units import digits, key_in_words
from bearingwear.scene.scene import COUNTS
from bearingwear.scene.uncertain import Distribution, is_same_for_batch

if TYPE_CHECKING:
    import xarray as xr

KIND = "uncertainty"
PLACES_BESIDE = ("spread/*.nc", "design/uncertainty.nc", "uncertainty.nc")
"""Where such files stand beside the results of a scene; the last is that of the design study."""

PRELOAD_CHOICE, UNCERTAIN_INPUTS = "preload_choice", "uncertain_inputs"
"""Dimensions of such a file: which preload, and which of the uncertain inputs vary."""

GIVEN, RECOMMENDED = 0, 1
"""Values of `PRELOAD_CHOICE`: the scene's own preload, and the recommended one."""

ALL_INPUTS, ALL_BUT_WEAR = 0, 1
"""Values of `UNCERTAIN_INPUTS`: all that the scene calls uncertain, or all but the wear coefficient
and the hardness."""

MEDIAN = 0.5
"""Probability of the largest quantile that is quoted."""

CONFIDENCE = 0.95
"""Of the intervals of quantiles and Sobol indices."""

NO_QUANTILES = "no spread computed"
SEE = "the command bearingwear uncertainty computes it"
BATCHES = 0.9
"""Share of batches between the ends of an L10, by what is not known of them."""

SAMPLING, OF_BATCHES = f"{100 * CONFIDENCE:g} % confidence", f"{100 * BATCHES:g} % of batches"
"""What the ends of a quantile are of."""

QUANTILES_TEXT = (
    "Spread: L10 is the life that 10 % of the bearings of a batch do not reach, L50 the one that "
    f"half of them do not; in brackets what {100 * BATCHES:g} % of batches have, since wear "
    "coefficient, friction and drag are common to a batch and unknown. Where nothing but "
    f"scatter is uncertain, {100 * CONFIDENCE:g} % confidence by the size of the sample."
)


class Quantile(NamedTuple):
    """A quantile of the life over the bearings of a batch, and its ends [h]."""

    name: str  # L10: the life that 10 % of bearings do not reach
    hours: float
    low: float
    high: float
    solved: float = 1.0  # share of the sampled lives; the others are left out
    between: str = SAMPLING  # what the ends are of
    errors: tuple[float, float] = (math.nan, math.nan)  # of the ends, by the sample [h]

    @property
    def text(self) -> str:
        """`L10 1.2 h [1.1, 1.3]`, which breaks into lines before the bracket only."""
        new = ", beyond a limit when new" if self.hours == 0.0 else ""
        value = f"{self.name} {digits(self.hours)} h"
        ends = f"[{digits(self.low)}, {digits(self.high)}]"
        return " ".join(part.replace(" ", "\N{NO-BREAK SPACE}") for part in (value, ends)) + new

    @property
    def ends(self) -> str:
        """`1.1 ± 0.1 to 1.3 ± 0.2` [h]."""
        return interval_text((self.low, self.high), self.errors)


Quantiles = dict[str, tuple[Quantile, ...]]
"""L10 and L50 by each way of counting wear."""


def load_quantiles(path: str | Path) -> xr.Dataset:
    """A file of the study of uncertainty.

    Raises
    ------
    CaseFileError
    """
    found = load(path)
    if found.attrs.get("kind") != KIND:
        raise CaseFileError(f"{path}: not a file of the kind {KIND}")
    if not {PRELOAD_CHOICE, UNCERTAIN_INPUTS} <= set(found.dims):
        raise CaseFileError(f"{path}: got a file of an earlier version, expected one made again")
    return found


def uncertainties_at(path: str | Path) -> list[xr.Dataset]:
    """A file itself and the files beside it, as far as they are of uncertainty."""
    folder = Path(path).parent
    found = []
    for file in [path, *(file for place in PLACES_BESIDE for file in sorted(folder.glob(place)))]:
        with contextlib.suppress(CaseFileError):
            # most files are of another kind, and need not wait for xarray
            if header(file).get("kind") == KIND:
                found.append(load_quantiles(file))
    return found


def quantiles_of(
    known: Iterable[xr.Dataset],
    scene: Mapping[str, Any],
    method: str,
    friction: float,
    choice: int = GIVEN,
) -> Quantiles | None:
    """The spread of the life of a scene; None if it was not computed for exactly that scene.

    Parameters
    ----------
    known : iterable of Dataset
        Files of the study of uncertainty.
    scene : mapping
        The life's, as its file states it; that of a study leaves out what is varied.
    method, friction
        Of the life.
    choice : int
        The preload: the scene's own or the recommended one.
    """
    for dataset in known:
        sampled = json.loads(dataset.attrs["scene"])
        flags = dataset["preload_method"].attrs["flag_meanings"].split()
        methods = [flags[int(flag)] for flag in dataset["preload_method"].values]
        if (
            method in methods
            and choice in dataset[PRELOAD_CHOICE]
            and _point(scene, method, friction) == _point(sampled, method)
        ):
            one = dataset.isel(
                {"preload_method": methods.index(method), UNCERTAIN_INPUTS: ALL_INPUTS}
            ).sel({PRELOAD_CHOICE: choice})
            return {way: quantiles_at(one.isel(loss_basis=k)) for k, way in enumerate(COUNTS)}
    return None


def interval_text(ends: Iterable[float], errors: Iterable[float]) -> str:
    """Both ends with their errors, as far as they are known."""
    return " to ".join(
        digits(end) + (f" ± {digits(float(f'{error:.2g}'))}" if math.isfinite(error) else "")
        for end, error in zip(ends, errors, strict=True)
    )


def causes_told(scene: Mapping[str, Any]) -> str:
    """Where the interval of an L10 comes from, and what differs among the bearings of a batch."""
    given = {k: Distribution(**one) for k, one in (scene.get("uncertainty") or {}).items()}
    of_batch, scatter = (
        ", ".join(_cause(k) for k, one in given.items() if is_same_for_batch(k, one) == of)
        for of in (True, False)
    )
    if not of_batch:
        return f"Bearings differ in {scatter}; the interval of L10 is that of the sample."
    spread = f"Bearings of a batch differ in {scatter}. " if scatter else ""
    return (
        f"The interval of L10 covers {100 * BATCHES:g} % of batches, each with one unknown value "
        f"of {of_batch}. {spread}± is the error of its ends from the size of the sample, "
        f"{100 * CONFIDENCE:g} % confidence."
    )


def _cause(key: str) -> str:
    words = "friction of ball and race" if key == "ball_race" else key_in_words(key)[0]
    return words.replace("brinell", "Brinell")


def hours_of(lives: Iterable[Quantiles | None], way: str) -> dict[str, list[float]]:
    """Every L10 and every L50 of some lives, by its name, counting wear in one way [h]."""
    found: dict[str, list[float]] = {}
    for quantiles in lives:
        for one in (quantiles or {}).get(way, ()):
            found.setdefault(one.name, []).append(one.hours)
    return found


def quantiles_text(quantiles: Iterable[Quantile]) -> str:
    """L10 and L50 on a line, and of how many lives if not of all; or that there are none."""
    known = tuple(quantiles)
    if not known:
        return NO_QUANTILES
    share = known[0].solved
    of = f" (of the {100.0 * share:.3g} % of lives that were solved)" if share < 1.0 else ""
    return "; ".join(one.text for one in known) + of


def _point(scene: Mapping[str, Any], method: str, friction: float | None = None) -> dict[str, Any]:
    """A scene at a method and friction, with what a study leaves out filled in.

    Settings of accuracy move a life by far less than it spreads; they may differ.
    """
    wear = {"ball_diameter_loss_um": 0.0} | scene["wear"]
    mu = scene["friction"]["ball_race"] if friction is None else friction
    return {key: scene[key] for key in scene if key not in ("description", "model")} | {
        "operation": scene["operation"] | {"preload_method": method},
        "friction": scene["friction"] | {"ball_race": mu},
        "wear": wear,
    }


def quantiles_at(one: xr.Dataset) -> tuple[Quantile, ...]:
    """L10 and L50 over the bearings of a batch, between ends by what is not known of it.

    Where all of that is known, between those of their confidence intervals by the sample.
    """
    found = []
    for k, p in enumerate(one["probability"].values):
        if p > MEDIAN or not np.isfinite(one["life_quantile"][k]):
            continue
        columns = [one[f"life_quantile{end}"][k] for end in ("_low", "", "_high")]
        between, errors = SAMPLING, (math.nan, math.nan)
        if "batch_life_quantile" in one:
            ends = one["batch_life_quantile"].isel(probability=k)
            if bool(np.isfinite(ends).all()) and float(np.ptp(ends.values)) > 0.0:
                columns, between = list(ends.values), OF_BATCHES
                if "batch_life_quantile_error" in one:
                    error = one["batch_life_quantile_error"].isel(probability=k)
                    errors = float(error[0]), float(error[-1])
        low, hours, high = map(float, columns)
        name, solved = f"L{100.0 * float(p):.0f}", float(one["solved_share"])
        found.append(Quantile(name, hours, low, high, solved, between, errors))
    return tuple(found)
