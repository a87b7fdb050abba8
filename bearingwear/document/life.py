"""Blocks of the sheet of a life: its length, its end, and the wear."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from bearingwear.document.document import VARIABLES, Block, Row, row_of
from bearingwear.document.pair import bearing_views, blocks_by_bearing
from bearingwear.document.phases import phase_blocks
from bearingwear.document.rows import (
    blocks_in_one_unit,
    caveat_lines,
    counted_words,
    flag_name,
    mean,
    mean_rows,
    stored_scene,
    variable_values,
)
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.measures import ENDS, Measure, plain
from bearingwear.results.pair_variables import is_pair
from bearingwear.results.quantiles import BY_WEAR, band_by_wear
from bearingwear.results.units import counted_tests, display
from bearingwear.results.variables import RACES

LINEAR_LIFE, LINEAR_ERROR = "palmgren_miner_life", "palmgren_miner_error"
LINEAR_EQUAL = 5e-3  # relative difference below which the linear rule counts as equal
STEADY_LIFE = ("steady_life", "steady_loss_at_end", "steady_time_to_loss")
WORN_OF_EACH = ("history_ball_worn_volume", "history_pocket_worn_volume", "history_worn_diameter")
WORN_RACES = "history_race_worn_volume"
WITH_GROOVES = ("history_approach_loss", "history_greatest_depth")
EQUIVALENT_LOSS = "history_equivalent_loss"
EQUIVALENT = "total wear depth, equivalent"
"""Label of the loss with worn grooves, whose depth varies over their width."""

WITH_FILMS = ("history_friction_coefficient", "history_race_film", "history_ball_film")
WORN_THROUGH = ("race_film_worn_through", "ball_film_worn_through")
WORN_WHOLE = (
    "history_land_worn_volume",
    "history_groove_depth",
    "history_pocket_clearance",
    "history_guide_clearance",
    "history_pocket_film_worn_share",
    "history_land_film_worn_share",
)
LIMIT_MET_SHARE = 1e-3
"""Share of a limit within which the bearing of a pair that ends a life meets it."""

_ROUNDING = 1e-12  # share of the larger of two ends below which the smaller is shown as 0


def life_blocks(file: Any) -> list[Block]:
    """Returns the blocks of a life: those that two bearings share, then those of each."""
    first_bearing = bearing_views(file)[0].file
    return blocks_in_one_unit(
        [*_life_and_phase_blocks(first_bearing), *blocks_by_bearing(file, _wear_blocks)]
    )


def _life_and_phase_blocks(file: Any) -> list[Block]:
    """Returns the blocks of the life and of the phases of a duty, which two bearings share."""
    scene = stored_scene(file)
    life_h = float(variable_values(file, "life"))
    rows = [row_of("life", [life_h])._replace(label=f"life, wear of {counted_words(scene)}")]
    band, band_sentence = band_by_wear(scene, life_h)
    if band is not None:
        rows.append(Row(BY_WEAR, "h", (band,), "life_by_wear_alone"))
    rows += [
        row_of(name, [variable_values(file, name)])
        for name in ("normalised_life", "life_cycles")
        if name in file.variables
    ]
    rows += _linear_life_rows(file)
    rows.append(Row("ended by", "", (_criterion_words(file, "end_criterion"),), "end_criterion"))
    loss = row_of("loss_at_end", [variable_values(file, "loss_at_end")])
    rows.append(loss._replace(label=EQUIVALENT) if EQUIVALENT_LOSS in file.variables else loss)
    lines = (
        _end_phrase(file),
        _calibration_phrase(scene),
        band_sentence,
        *caveat_lines(scene),
    )
    life_block = Block("life", (), tuple(rows), tuple(line for line in lines if line))
    return [life_block, *phase_blocks(file, scene)]


def _linear_life_rows(file: Any) -> list[Row]:
    """Returns a row with the life over a duty by the linear rule, and its error in a note.

    Empty without a duty.
    """
    linear_life = float(variable_values(file, LINEAR_LIFE))
    error = float(variable_values(file, LINEAR_ERROR))
    if not math.isfinite(linear_life):
        return []
    note = f"{plain(100.0 * abs(error), 2)} % {'more' if error > 0.0 else 'less'} than the life"
    if abs(error) < LINEAR_EQUAL:
        note = "as long as the life"
    return [row_of(LINEAR_LIFE, [linear_life])._replace(note=note)]


def _end_phrase(file: Any) -> str:
    """States what ended a life and in which phase of a duty, or which phase was not solved."""
    end = str(getattr(file, "ended_by", ""))
    if end and (phase := str(getattr(file, "ended_in", ""))):
        criterion = ENDS.get(flag_name(file, "end_criterion"))
        return f"in {'all phases' if criterion and criterion.of_wear else phase}: {end}"
    if phase := str(getattr(file, "unsolved_phase", "")):
        return f"not solved in phase {phase}"
    return end


def _wear_blocks(file: Any) -> list[Block]:
    """Returns the blocks of one bearing: its histories, criteria, films and worn parts."""
    blocks = []
    if "step" in file.dimensions and file.dimensions["step"].size:
        criteria = _criterion_rows(file, stored_scene(file))
        blocks.append(Block("during the life", ("start", "end"), _history_rows(file)))
        blocks.append(Block("end-of-life criteria", ("start", "end"), criteria))
    return [*blocks, *_film_blocks(file), *_steady_life_blocks(file), *_worn_part_blocks(file)]


def _history_rows(file: Any) -> tuple[Row, ...]:
    """Returns rows of preload, QV, grooves, films and loss rate at the start and the end.

    Those of grooves and films are left out if the file does not contain them.
    """
    optional = (name for name in (*WITH_GROOVES, *WITH_FILMS) if name in file.variables)
    names = ("history_residual_preload", "history_total_qv", *optional)
    rows = [row for name in names for row in _start_and_end_rows(file, name)]
    loss_rate = variable_values(file, "history_ball_diameter_loss_rate")
    if loss_rate.ndim:
        row = row_of("ball_diameter_loss_rate", loss_rate[[0, -1]])
        label = EQUIVALENT if EQUIVALENT_LOSS in file.variables else row.label
        rows.append(row._replace(label=label, name="history_ball_diameter_loss_rate"))
    return tuple(rows)


def _calibration_phrase(scene: Mapping[str, Any]) -> str:
    """States with which tests the scene was calibrated; empty if it was not."""
    calibration = scene.get("calibrated")
    if not calibration:
        return ""
    return f"calibrated with {counted_tests(calibration['rows'])} from {calibration['tests']}"


def _start_and_end_rows(file: Any, name: str) -> list[Row]:
    """Returns a row with start and end of a history, or such a row for each race it has."""
    ends = np.atleast_1d(variable_values(file, name))[[0, -1]]
    ends = np.where(np.abs(ends) < _ROUNDING * np.abs(ends).max(initial=0.0), 0.0, ends)
    if ends.ndim == 1:
        return [row_of(name, ends)]
    label = VARIABLES[name].label
    return [
        row_of(name, race_ends)._replace(label=f"{label}, {race}", name=f"{name}.{race}")
        for race, race_ends in zip(RACES, ends.T, strict=True)
    ]


def _film_blocks(file: Any) -> list[Block]:
    """Returns a block with the times at which the films are worn through; empty without films."""
    rows = []
    for name in WORN_THROUGH:
        if name in file.variables:
            # the film of the balls has one time, which is shown for both races
            row = row_of(name, np.broadcast_to(variable_values(file, name), len(RACES)))
            times = tuple("not yet" if math.isnan(time) else time for time in row.values)
            rows.append(row._replace(values=times))
    return [Block("worn through after", RACES, tuple(rows))] if rows else []


def _criterion_rows(file: Any, scene: Mapping[str, Any]) -> tuple[Row, ...]:
    """Returns a row for each criterion of the scene: the value at start and end, and the limit.

    Of two bearings, the one that meets the criterion ends the life.
    """
    limits = scene["wear"].get("end_of_life") or {}
    end_criterion = flag_name(file, "end_criterion")
    rows = []
    for criterion, measure in ENDS.items():
        limit = limits.get(criterion)
        if limit is None:
            continue
        start, end = (_history_value(file, scene, measure, step) for step in (0, -1))
        ended_here = not is_pair(scene) or measure.margin(end.critical, limit) < LIMIT_MET_SHARE
        rows.append(
            Row(
                label=measure.short,
                unit=measure.unit,
                values=(start.shown, end.shown),
                name=criterion,
                limit=measure.shown_limit(limit),
                note="reached first" if criterion == end_criterion and ended_here else "",
            )
        )
    return tuple(rows)


class _HistoryValue(NamedTuple):
    """The value of a measure at a step of a life."""

    critical: float  # the worst value [SI]
    shown: float  # in the unit of the measure, with its sign if that matters


def _history_value(
    file: Any, scene: Mapping[str, Any], measure: Measure, step: int
) -> _HistoryValue:
    """Returns the worst value of a measure at a step of the history of a life."""

    def value_of(name: str) -> np.ndarray:
        """Returns the values of a variable at the step."""
        return np.atleast_1d(variable_values(file, f"history_{name}"))[step]

    critical, name = measure.critical(value_of, scene["operation"]["preload_N"])
    shown = measure.shown(float(value_of(name)) if measure.signed else critical)
    return _HistoryValue(critical=critical, shown=shown)


def _criterion_words(file: Any, name: str) -> str:
    """Returns the words for the criterion that a variable has as flag; for `none`, that name."""
    criterion = flag_name(file, name)
    return ENDS[criterion].words if criterion in ENDS else criterion


def _steady_life_blocks(file: Any) -> list[Block]:
    """Returns a block with the steady model's life for comparison, if a dynamic life has it."""
    if "steady_status" not in file.variables:
        return []
    status = int(variable_values(file, "steady_status"))
    end = _criterion_words(file, "steady_end_criterion") if status == OK else STATUS_NAMES[status]
    rows = (*mean_rows(file, STEADY_LIFE), Row("ended by", "", (end,), "steady_end_criterion"))
    return [Block(f"steady, {getattr(file, 'steady_life_of', '?')}", (), rows)]


def _worn_part_blocks(file: Any) -> list[Block]:
    """Returns a block with the wear of the parts of a bearing at the end of a dynamic life.

    All volumes have one unit, for comparison. Other lives have no such block.
    """
    if "history_ball_worn_volume" not in file.variables:
        return []
    at_end = {
        name: variable_values(file, name)[-1]
        for name in (*WORN_OF_EACH, WORN_RACES, *WORN_WHOLE)
        if name in file.variables
    }
    volumes = [name for name in at_end if VARIABLES[name].units == "m3"]
    volume_unit = display("m3", *(at_end[name] for name in volumes))
    units = dict.fromkeys(volumes, volume_unit)
    rows = []
    for name in WORN_OF_EACH:
        if name in at_end:
            numbers = (mean(at_end[name]), at_end[name].min(), at_end[name].max())
            rows.append(row_of(name, numbers, unit=units.get(name)))
    for race, volume in zip(RACES, at_end[WORN_RACES], strict=True):
        row = row_of(WORN_RACES, [volume], unit=units.get(WORN_RACES))
        rows.append(row._replace(label=f"{race} race", name=f"{WORN_RACES}.{race}"))
    for name in WORN_WHOLE:
        if name in at_end:
            rows.append(row_of(name, [at_end[name]], unit=units.get(name)))
    return [Block("wear since the start", ("mean", "minimum", "maximum"), tuple(rows))]
