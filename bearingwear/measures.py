"""The one table of measures: quantities that may end a life or limit a design.

A new measure needs only a row. Keys of scenes and limits, options, messages, margins, the worse
bearing of a pair, extremes of a map, rows of sheets and marks of figures are loops over the rows.

This file imports no slow library, since the command line takes the names of options from it.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple


class _Unit(NamedTuple):
    """A unit in which people give or read values."""

    si: str  # the SI unit in files
    size: float  # of one such unit, in the SI unit


_UNITS = {
    "1": _Unit("1", 1.0),
    "%": _Unit("1", 1.0),  # keys and limits are shares, which only texts show in percent
    "um": _Unit("m", 1e-6),
    "mm": _Unit("m", 1e-3),
    "N/um": _Unit("N m-1", 1e6),
    "GPa": _Unit("Pa", 1e9),
    "W": _Unit("W", 1.0),
    "Hz": _Unit("Hz", 1.0),
    "g": _Unit("m s-2", 9.80665),
    "h": _Unit("s", 3600.0),
}


_ROUNDING = 1e-9
"""Largest magnitude of a negative margin that counts as zero, since it may come from rounding."""


def plain(value: float, digits: int = 3, sign: str = "") -> str:
    """Returns a number as text, rounded to significant digits and without trailing zeros.

    Magnitudes below 0.0001, and from ten million on, have an exponent.

    digits: number of significant digits, at most 7.
    sign: `+` to write the sign of positive numbers, too.
    """
    return f"{float(f'{value:.{digits}g}'):{sign}.7g}"


@dataclass(frozen=True, kw_only=True)
class Measure:
    """A quantity that may end a life or limit a design."""

    key: str  # of its limit in a design and, unless `end_key` is given, of its criterion in a scene
    words: str  # its name in a sentence
    unit: str = "%"  # of shown values and, unless it is a share, of limits
    # result variables, of which the worst counts; those that a state does not have are NaN
    variables: tuple[str, ...]
    kinds: tuple[str, ...] = ("",)  # an adjective to `words` for each of several variables
    falls: bool = False  # whether smaller values are worse; otherwise larger magnitudes are
    signed: bool = False  # whether sheets show its sign, which limits ignore
    over_preload: bool = False  # whether its variable counts as a share of the initial preload
    advice: str  # how to satisfy its limit
    label: str = ""  # its name in a row of a sheet, if not `words`
    end_key: str = ""
    # as a criterion and as a limit of a design: meaning of the key and its range
    end: tuple[str, ...] = ()
    limit: tuple[str, ...] = ()
    note: str = ""  # on the meaning of a limit
    means: str = ""  # an explanation for readers of a report, half a sentence
    # added to values and limits [as in its key] before their ratio, so that a limit may be 0
    base: float = 0.0
    needs: tuple[str, ...] = ()  # keys of `arrangement` that a limit requires in the scene
    block: str = ""  # a block that a limit requires in the scene
    option: str = ""  # of the limit on the command line
    # in figures: marker of lives that it ends, and letter of preloads that it limits
    mark: str = ""
    letter: str = ""
    brief: bool = False  # whether short tables contain it too
    resting: bool = False  # whether it is computed at rest, independent of the speed
    of_life: bool = False  # whether it belongs to a whole life, not to a state
    of_wear: bool = False  # whether it is a depth of wear, which no phase of a duty has alone

    @property
    def of_speed(self) -> bool:
        """Whether it has a value in each state at each speed."""
        return not (self.resting or self.of_life)

    @property
    def short(self) -> str:
        """Returns the name in a row of a sheet."""
        return self.label or self.words

    @property
    def key_unit(self) -> str:
        """Returns the unit of its keys in scenes and limits."""
        return "1" if self.unit == "%" else self.unit

    @property
    def si_unit(self) -> str:
        """Returns the unit of its variables in files."""
        return _UNITS[self.unit].si

    @property
    def shown_as(self) -> str:
        """Returns `Variable.shown` of its variables: `%` for a share shown in percent, else ""."""
        return "%" if self.unit == "%" else ""

    @property
    def worst_word(self) -> str:
        """Returns the word for the worse extreme: `minimum` or `maximum`."""
        return "minimum" if self.falls else "maximum"

    @property
    def extremes(self) -> tuple[str, ...]:
        """Returns the variables of a design map with its worst values from new to the end of life.

        They have the names of its variables. A share of the initial preload has the name of its
        key.
        """
        return (self.key,) if self.over_preload else self.variables

    def extreme(self, values: Any) -> float:
        """Returns the smallest of some values if the measure `falls`, else the largest magnitude.

        values: a number or an array. One NaN in a NumPy array gives NaN; those in a `DataArray` are
            skipped.
        """
        if isinstance(values, float):  # NumPy takes ten times as long
            return float(values) if self.falls else abs(float(values))
        import numpy as np  # here, because the command line needs only the names

        return float(np.min(values) if self.falls else np.abs(values).max())

    def value(self, values: Any, preload_N: Any = 1.0) -> float:
        """Returns the worst of the values of one variable [SI], by the rule of `extreme`.

        values: of the variable in files [SI], a number or an array.
        preload_N: initial preload, by which values are divided if the measure is `over_preload`.
        """
        return self.extreme(values / preload_N if self.over_preload else values)

    def critical(self, value_of: Callable[[str], Any], preload_N: Any = 1.0) -> tuple[float, str]:
        """Returns the worst value of all variables [SI], and the name of its variable.

        Variables whose worst value is NaN are left out; the value is NaN if all are.

        value_of: returns the values of a variable by its name, in a state or at a step of a life.
        preload_N: initial preload, by which values are divided if the measure is `over_preload`;
            one number, or one for each value.
        """
        worst_values = [self.value(value_of(name), preload_N) for name in self.variables]
        return self._worst_with_name(worst_values, self.variables)

    def critical_extreme(self, value_of: Callable[[str], Any]) -> tuple[float, str]:
        """Returns the worst of all extremes in a design map [SI], and the name of its variable.

        Extremes whose worst value is NaN are left out; the value is NaN if all are.

        value_of: returns the values of an extreme by its name, in the map or at a point of it.
        """
        worst_values = [self.extreme(value_of(name)) for name in self.extremes]
        return self._worst_with_name(worst_values, self.extremes)

    def _worst_with_name(self, values: list[float], names: tuple[str, ...]) -> tuple[float, str]:
        """Returns the worst of some values, and its name; NaN only if all are NaN.

        values: one for each name; magnitudes, unless the measure `falls`.
        """
        pairs = list(zip(values, names, strict=True))
        numbers = [pair for pair in pairs if not math.isnan(pair[0])] or pairs
        return min(numbers) if self.falls else max(numbers)

    def ratio(self, value: Any, limit: float) -> Any:
        """Returns (value + `base`) / (limit + `base`), with the value in the unit of the limit.

        value: worst value [SI], as `critical` returns it; a number or an array.
        limit: in `key_unit`.
        """
        return (value / _UNITS[self.unit].size + self.base) / (limit + self.base)

    def margin(self, value: Any, limit: float) -> Any:
        """Returns how far a value [SI] is from a limit [`key_unit`], as a share of the limit.

        It is `ratio` - 1 if the measure falls, else 1 - `ratio`: positive where the limit is kept,
        zero at the limit, and negative where it is violated.
        """
        ratio = self.ratio(value, limit)
        return ratio - 1.0 if self.falls else 1.0 - ratio

    def margins(self, values: Any, limit: float) -> Any:
        """Returns the smallest `margin` of all extremes: at each point of a map, or at one point.

        An extreme that is NaN is left out; the margin is NaN where all are.

        values: the map or point, which contains the value of an extreme under its name.
        limit: in `key_unit`.
        """
        import numpy as np

        return functools.reduce(
            np.fmin, [self.margin(extreme, limit) for extreme in self._extremes_in(values)]
        )

    def worst(self, values: Any) -> Any:
        """Returns the worst of all extremes [SI]: at each point of a map, or at one point.

        It is NaN only where all of them are.

        values: as for `margins`.
        """
        import numpy as np

        return functools.reduce(np.fmin if self.falls else np.fmax, self._extremes_in(values))

    def _extremes_in(self, values: Any) -> list[Any]:
        """Returns the values [SI] of the extremes that a map, or a point of it, contains."""
        return [_in_si(values[name]) for name in self.extremes if name in values]

    def words_of(self, name: str, short: bool = False) -> str:
        """Returns the words for one of its variables or extremes, with the adjective of its kind.

        name: of the variable or extreme.
        short: whether to use the label of a row in place of the name in a sentence.
        """
        kinds = dict(zip(self.variables, self.kinds, strict=True))
        return f"{kinds.get(name, '')} {self.short if short else self.words}".strip()

    def shown(self, value: Any) -> Any:
        """Returns a value [SI] in the shown unit, `unit`."""
        return self.shown_limit(value / _UNITS[self.unit].size)

    def shown_limit(self, limit: Any) -> Any:
        """Returns a limit [`key_unit`] in the shown unit, `unit`: a share in percent."""
        return 100.0 * limit if self.unit == "%" else limit

    def file_limit(self, limit: float, preload_N: float) -> float:
        """Returns a limit [`key_unit`] in the unit of its variable in files [SI].

        preload_N: initial preload, of which the limit of the residual preload is a share.
        """
        return limit * _UNITS[self.unit].size * (preload_N if self.over_preload else 1.0)

    def excess(self, value: float, limit: float) -> float:
        """Returns a value [SI] over its limit; if it `falls`, the limit over the value.

        `base` is added to both. It exceeds 1 where the limit is violated, and is infinite for a
        falling value whose `ratio` is 0 or less.
        """
        ratio = self.ratio(value, limit)
        if not self.falls:
            return float(ratio)
        return 1.0 / ratio if ratio > 0.0 else math.inf

    def is_passed(self, value: float, limit: float) -> bool:
        """Whether a value [SI] violates a limit [`key_unit`] by more than rounding.

        It does not at the limit itself, nor if it is NaN.
        """
        return bool(self.margin(value, limit) < -_ROUNDING)

    def violation_phrase(self, value: float, limit: float, name: str) -> str:
        """Returns words for a value [SI] that is at its limit or violates it.

        They would be wrong for a value within the limit.

        limit: in `key_unit`.
        name: of the variable or extreme that has the value.
        """
        side = "below" if self.falls else "above"
        if self.margin(value, limit) == 0.0:
            side = "at"
        return f"{self.words_of(name)} {self.text(value)} {side} {self.limit_text(limit)}"

    def criterion_phrase(self, value: float, limit: float, name: str) -> str:
        """Returns words for a value [SI] and the criterion of the end of life that it reached.

        limit: value of the criterion in `key_unit`.
        name: of the variable that has the value.
        """
        return f"{self.words_of(name)} {self.text(value)}, criterion {self.limit_text(limit)}"

    def text(self, value: float) -> str:
        """Returns a value [SI] as text with the shown unit."""
        return self._with_unit(self.shown(value))

    def limit_text(self, limit: float) -> str:
        """Returns a limit [`key_unit`] as text with the shown unit."""
        return self._with_unit(self.shown_limit(limit))

    def _with_unit(self, number: float) -> str:
        """Returns a number in the shown unit as text, with that unit."""
        return plain(number) if self.unit == "1" else f"{plain(number)} {self.unit}"


def _in_si(values: Any) -> Any:
    """Returns values in SI units: hours converted to seconds, and others unchanged.

    values: a number, or a `DataArray` of a point or file, whose attribute `units` is `h` for hours.
    """
    units = getattr(values, "attrs", {}).get("units")
    return values * _UNITS["h"].size if units == "h" else values


_STIFFNESSES = "dynamic", "quasi-static"

# fmt: off
MEASURES = (
    Measure(key="preload_kept", end_key="preload_fraction", words="residual preload",
        variables=("residual_preload",), over_preload=True, falls=True,
        advice="increase the preload, reduce the speed, or use a spring",
        end=("Ratio of the residual preload to preload_N at or below which the life ends",
            "(0, 1)"),
        limit=("Minimum ratio of residual to initial preload", "(0, 1)"),
        option="--preload-kept", mark="v", letter="K"),
    Measure(key="gyroscopic_slip_share", words="gyroscopic slip share",
        variables=("gyroscopic_slip_share",),
        advice="reduce the speed, increase the preload, or use ceramic balls",
        end=("Gyroscopic slip share in any contact at or above which the life ends", "(0, 1]"),
        limit=("Maximum gyroscopic slip share in any contact", "(0, 1]"),
        means="share of a ball's sliding that is perpendicular to its rolling direction",
        option="--slip", mark="s", letter="G", brief=True),
    Measure(key="skid_ratio", words="skid ratio", variables=("skid_ratio",), signed=True,
        advice="increase the preload, or reduce the speed or the lubricant drag",
        end=("Skid ratio (relative lag of the orbit rate behind that in pure rolling) at or above "
            "which the life ends", "(0, 1]"),
        mark="P"),
    Measure(key="ball_diameter_loss_um", words="total wear depth", unit="um",
        variables=("ball_diameter_loss",),
        advice="start with less wear, or raise the criterion value",
        end=("Total wear depth at which the life ends (less than 10 % of the ball diameter)",
            "(0, 50000]"), mark="o", of_wear=True),
    Measure(key="pocket_clearance_mm", words="pocket clearance", unit="mm",
        variables=("pocket_clearance",),
        advice="start with less clearance, or raise the criterion value",
        end=("Diametral clearance between the most worn ball and its pocket at which the life ends "
            "(requires a cage and the dynamic model)", "(0, 50]"), mark="p"),
    Measure(key="guide_clearance_mm", words="guide clearance", unit="mm",
        variables=("guide_clearance",),
        advice="start with less clearance, or raise the criterion value",
        end=("Diametral clearance between the cage and its guiding land at which the life ends "
            "(requires a race-guided cage and the dynamic model)", "(0, 50]"), mark="h"),
    Measure(key="rotor_shift_um", words="rotor shift", unit="um",
        variables=("rotor_axial_shift",),
        advice="use two bearings with equal wear, or raise the criterion value",
        end=("Axial shift of the rotor from its mounted position, in either direction, at "
            "which the life ends", "(0, 50000]"),
        limit=("Maximum axial shift of the rotor from its mounted position", "(0, 50000]"),
        option="--shift", mark="<", letter="R"),
    Measure(key="spring_travel_um", words="travel of the preload spring", label="spring travel",
        unit="um", variables=("spring_travel",),
        advice="keep the temperatures of the rings closer together, or use a smaller span",
        limit=("Maximum travel of the preload spring from where it was mounted, in either "
            "direction", "(0, inf)"),
        note="the room that the sliding ring requires; zero in a rigid pair, and a single bearing "
            "counts as half of a symmetric pair",
        means="how far the ring on which the spring acts slides in its seat",
        option="--spring-travel", letter="Y"),
    Measure(key="system_axial_stiffness_N_um", words="axial stiffness of the arrangement",
        label="stiffness, arrangement", unit="N/um",
        variables=("system_axial_stiffness", "system_quasistatic_axial_stiffness"),
        kinds=_STIFFNESSES, falls=True, advice="increase the preload, or use a rigid pair",
        end=("Axial stiffness of the arrangement (a single bearing counts as half of a symmetric "
            "pair) at or below which the life ends", "(0, 1e6]"),
        limit=("Minimum axial stiffness of the arrangement", "(0, 10000]"),
        note="a single bearing counts as half of a symmetric pair: a spring pair or, with "
            "fixed-position preload, a rigid pair",
        means="with fixed-position preload, both bearings contribute; with constant-force preload, "
            "only one does",
        option="--stiffness", mark="d", letter="A", brief=True),
    Measure(key="axial_stiffness_N_um", words="axial stiffness of one bearing",
        label="stiffness, one bearing", unit="N/um",
        variables=("axial_stiffness", "quasistatic_axial_stiffness"),
        kinds=_STIFFNESSES, falls=True, advice="increase the preload",
        limit=("Minimum axial stiffness of one bearing", "(0, 10000]"),
        option="--bearing-stiffness", letter="S", brief=True),
    Measure(key="friction_used_by_gyroscopic_moment",
        words="share of available friction used by the gyroscopic moment",
        label="friction used (gyroscopic)",
        variables=("friction_used_by_gyroscopic_moment",),
        advice="reduce the speed, increase the preload, or use ceramic balls",
        end=("Share of the available friction used by gyroscopic moments, M_g/(mu (Q_i + Q_o) R), "
            "at or above which the life ends", "(0, 10]"),
        limit=("Maximum share of the available friction used by gyroscopic moments", "(0, 10]"),
        option="--friction-used", mark="*", letter="M"),
    Measure(key="film_worn_share", words="share of a track without film",
        label="track without film", variables=("film_worn_share",),
        advice="use a thicker film, or reduce the load",
        end=("Share of a race track without film at or above which the life ends", "(0, 1]"),
        mark="^"),
    Measure(key="maximum_pressure_GPa", words="contact pressure", unit="GPa",
        variables=("maximum_pressure",),
        advice="reduce the preload, or use grooves with closer conformity",
        end=("Peak contact pressure at or above which the life ends", "(0, 20]"),
        limit=("Maximum contact pressure", "(0, 20]"),
        option="--pressure", mark="D", letter="P", brief=True),
    Measure(key="friction_power_W", words="friction power", unit="W",
        variables=("friction_power",),
        advice="reduce the preload, the speed or the lubricant drag",
        limit=("Maximum friction and drag power", "(0, 100000]"),
        option="--power", letter="F", brief=True),
    Measure(key="groove_depth_um", words="groove wear depth", unit="um",
        variables=("greatest_depth",),
        advice="reduce the preload or the speed, or raise the criterion value",
        end=("Groove wear depth, at the deepest point, at which the life ends", "(0, 50000]"),
        mark=">", of_wear=True),
    Measure(key="cage_film_worn_share", words="film worn off the cage",
        variables=("pocket_film_worn_share", "land_film_worn_share"), kinds=("pocket", "land"),
        advice="use a thicker film, or reduce the clearance at the land",
        end=("Fraction of the cage.film thickness worn off, in a pocket or at the land, at "
            "which the life ends (requires the dynamic model or `bearingwear cage`)", "(0, 1]"),
        mark="X"),
    Measure(key="lowest_frequency_Hz", words="lowest natural frequency of the rotor",
        label="rotor frequency", unit="Hz", variables=("lowest_frequency",), falls=True,
        advice="increase the preload, or use a rigid pair",
        limit=("Minimum value of the rotor's lowest natural frequency", "(0, 100000]"),
        note="the scene must specify the rotor mass and span",
        needs=("rotor_mass_kg", "span_mm"), option="--frequency", letter="H"),
    Measure(key="launch_g", words="acceleration at launch",
        label="launch acceleration", unit="g",
        variables=("opening_acceleration", "denting_acceleration"), kinds=("gapping", "denting"),
        falls=True,
        advice="increase the preload to prevent gapping, or reduce it to prevent denting",
        limit=("Minimum value of the axial acceleration at which a bearing gaps or dents",
            "(0, 100000]"),
        note="the scene must specify the rotor mass", needs=("rotor_mass_kg",), option="--launch-g",
        letter="Q", resting=True),
    Measure(key="gap_um", words="gap at launch", unit="um", variables=("launch_gap",), base=1.0,
        advice="increase the preload, or add a stop",
        limit=("Maximum gap of a bearing at launch", "[0, 50000]"),
        note="under the launch loads in the scene", needs=("rotor_mass_kg", "span_mm"),
        block="launch", option="--gap-um", letter="O", resting=True),
    Measure(key="launch_pressure_share", words="ratio of launch pressure to denting pressure",
        label="launch pressure", variables=("launch_pressure_share",),
        advice="reduce the preload",
        limit=("Maximum ratio of peak launch pressure to denting pressure", "(0, 10]"),
        note="under the launch loads in the scene", needs=("rotor_mass_kg", "span_mm"),
        block="launch", option="--launch-pressure", letter="D", resting=True),
    Measure(key="thermal_margin", words="thermal margin", unit="1",
        variables=("thermal_margin",), falls=True,
        advice="cool better, reduce the preload or the speed, or use a spring",
        end=("Thermal margin (conductance over slope of the friction heat) at or below which the "
            "life ends (requires a thermal network)", "(0, 1000]"),
        limit=("Minimum thermal margin", "(0, 1000]"),
        note="the scene must specify a thermal network", block="thermal",
        means="how much more strongly the cooling than the friction heat grows with temperature",
        option="--thermal-margin", mark="H", letter="C"),
    Measure(key="torque_margin", words="torque margin", variables=("torque_margin",), falls=True,
        base=1.0, advice="reduce the preload or the friction, or use a stronger drive",
        limit=("Minimum torque margin of the drive, as defined by the standard in the scene",
            "[0, 1000]"),
        note="when new and when worn, over the entire friction interval", block="drive",
        option="--torque-margin", letter="T", resting=True),
    Measure(key="life_h", words="wear life", unit="h", variables=("life",), falls=True,
        advice="relax another requirement, or reduce the wear",
        limit=("Minimum wear life", "(0, 1e9]"), option="--life", letter="W", of_life=True),
)
# fmt: on

ENDS = {measure.end_key or measure.key: measure for measure in MEASURES if measure.end}
"""Measures that may end a life, by the keys of a scene, in the order of the flags in files."""

LIMITED = {measure.key: measure for measure in MEASURES if measure.limit}
"""Measures that may limit a design, by the keys of their limits."""

WORST = {name: measure for measure in MEASURES if measure.of_speed for name in measure.variables}
"""Measures by their variables, for the variables whose worst value in a phase is reported."""
