"""The result sheet of a life: its length, its end, and the wear."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from bearingwear.document.document import VARIABLES, Block, Row, row_of
from bearingwear.document.pair import bearings_of, of_bearings
from bearingwear.document.phases import phase_blocks
from bearingwear.document.rows import (
    counted_words,
    film_lines,
    in_one_unit,
    mean,
    mean_rows,
    meaning,
    values,
)
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.measures import ENDS, Measure
from bearingwear.results.pair_variables import is_pair
from bearingwear.results.quantiles import BY_WEAR, band_by_wear
from bearingwear.results.units import display
from bearingwear.results.variables import RACES

OF_DUTY = ("life_cycles", "palmgren_miner_life", "palmgren_miner_error")
STEADY_LIFE = ("steady_life", "steady_loss_at_end", "steady_time_to_loss")
WORN_OF_EACH = ("history_ball_worn_volume", "history_pocket_worn_volume", "history_worn_diameter")
WORN_RACES = "history_race_worn_volume"
WITH_GROOVES = ("history_approach_loss", "history_greatest_depth")
EQUIVALENT_LOSS = "history_equivalent_loss"
EQUIVALENT = "total wear depth, equivalent"
"""Label of the loss with worn grooves, which are not as deep over all of their width."""

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
MET = 1e-3
"""Share of a limit within which the bearing of a pair that ends a life meets it."""

_ROUNDING = 1e-12  # of the larger of two ends: what is smaller is shown as nothing


def life_blocks(file: Any) -> list[Block]:
    """Blocks of a life."""
    ((_, first), *_) = bearings_of(file)
    return in_one_unit([*_of_both(first), *of_bearings(file, _of_each)])


def _scene_of(file: Any) -> dict[str, Any]:
    return json.loads(getattr(file, "scene", "{}"))


def _of_both(file: Any) -> list[Block]:
    """Blocks that are shown once for two bearings."""
    scene = _scene_of(file)
    life = float(values(file, "life"))
    lives = [row_of("life", [life])._replace(label=f"life, wear of {counted_words(scene)}")]
    band, taken = band_by_wear(scene, life)
    if band is not None:
        lives.append(Row(BY_WEAR, "h", (band,), "life_by_wear_alone"))
    if "normalised_life" in file.variables:
        lives.append(row_of("normalised_life", [values(file, "normalised_life")]))
    loss = row_of("loss_at_end", [values(file, "loss_at_end")])
    if EQUIVALENT_LOSS in file.variables:
        loss = loss._replace(label=EQUIVALENT)
    ended = Row("ended by", "", (_words(file, "end_criterion"),), "end_criterion")
    ended_by = str(getattr(file, "ended_by", ""))
    if ended_by and (phase := str(getattr(file, "ended_in", ""))):
        ended_by = f"in {phase}: {ended_by}"
    elif phase := str(getattr(file, "unsolved_phase", "")):
        ended_by = f"not solved in phase {phase}"
    lines = filter(None, [ended_by, *_calibrated(scene), taken, *film_lines(scene)])
    lives += [row_of(n, [values(file, n)]) for n in OF_DUTY if n in file.variables]
    return [Block("life", (), (*lives, ended, loss), tuple(lines)), *phase_blocks(file, scene)]


def _of_each(file: Any) -> list[Block]:
    """Blocks of a bearing."""
    scene = _scene_of(file)
    blocks = []
    if "step" in file.dimensions and file.dimensions["step"].size:
        more = (name for name in (*WITH_GROOVES, *WITH_FILMS) if name in file.variables)
        names = ("history_residual_preload", "history_total_qv", *more)
        ends = tuple(row for n in names for row in _ends(file, n))
        rate = values(file, "history_ball_diameter_loss_rate")
        if rate.ndim:
            loss_rate = row_of("ball_diameter_loss_rate", rate[[0, -1]])
            label = EQUIVALENT if EQUIVALENT_LOSS in file.variables else loss_rate.label
            name = "history_ball_diameter_loss_rate"
            ends += (loss_rate._replace(label=label, name=name),)
        blocks.append(Block("during the life", ("start", "end"), ends))
        blocks.append(Block("end-of-life criteria", ("start", "end"), _criteria(file, scene)))
    return [*blocks, *_films(file), *_steady_life(file), *_worn(file)]


def _calibrated(scene: Mapping[str, Any]) -> tuple[str, ...]:
    """By which tests the scene was calibrated."""
    calibration = scene.get("calibrated")
    return (
        (
            f"calibrated with {calibration['rows']} test{'s' * (calibration['rows'] > 1)} from "
            f"{calibration['tests']}",
        )
        if calibration
        else ()
    )


def _ends(file: Any, name: str) -> list[Row]:
    """A row of a history at start and end, or one for each race."""
    found = np.atleast_1d(values(file, name))[[0, -1]]
    found = np.where(np.abs(found) < _ROUNDING * np.abs(found).max(initial=0.0), 0.0, found)
    if found.ndim == 1:
        return [row_of(name, found)]
    label = VARIABLES[name].label
    return [
        row_of(name, row)._replace(label=f"{label}, {race}", name=f"{name}.{race}")
        for race, row in zip(RACES, found.T, strict=True)
    ]


def _films(file: Any) -> list[Block]:
    """When the films are worn through."""
    rows = [row_of(n, np.atleast_1d(values(file, n))) for n in WORN_THROUGH if n in file.variables]
    rows = [
        row._replace(values=tuple("not yet" if t != t else t for t in (row.values * 2)[:2]))
        for row in rows
    ]
    return [Block("worn through after", RACES, tuple(rows))] if rows else []


def _criteria(file: Any, scene: Mapping[str, Any]) -> tuple[Row, ...]:
    """A row for each criterion that the scene gives: what it was, what it came to, its limit.

    Of two bearings, the one that meets the criterion ends the life.
    """
    given = scene["wear"].get("end_of_life") or {}
    ended = meaning(file, "end_criterion")
    rows = []
    for criterion, measure in ENDS.items():
        if (limit := given.get(criterion)) is None:
            continue

        def at(k: int, measure: Measure = measure) -> tuple[float, float]:
            """Value that counts, and value shown."""

            def of(name: str) -> np.ndarray:
                return np.atleast_1d(values(file, f"history_{name}"))[k]

            found, name = measure.critical(of, scene["operation"]["preload_N"])
            return found, measure.shown(float(of(name)) if measure.signed else found)

        (_, start), (end, shown) = at(0), at(-1)
        met = not is_pair(scene) or measure.margin(end, limit) < MET
        rows.append(
            Row(
                measure.short,
                measure.unit,
                (start, shown),
                criterion,
                measure.shown_limit(limit),
                "reached first" if criterion == ended and met else "",
            )
        )
    return tuple(rows)


def _words(file: Any, name: str) -> str:
    found = meaning(file, name)
    return ENDS[found].words if found in ENDS else found


def _steady_life(file: Any) -> list[Block]:
    """The life by the steady model, which a dynamic life has beside its own."""
    if "steady_status" not in file.variables:
        return []
    status = int(values(file, "steady_status"))
    end = _words(file, "steady_end_criterion") if status == OK else STATUS_NAMES[status]
    rows = (*mean_rows(file, STEADY_LIFE), Row("ended by", "", (end,), "steady_end_criterion"))
    return [Block(f"steady, {getattr(file, 'steady_life_of', '?')}", (), rows)]


def _worn(file: Any) -> list[Block]:
    """Wear of the parts of a bearing at the end of a dynamic life."""
    if "history_ball_worn_volume" not in file.variables:
        return []
    at_end = {
        name: values(file, name)[-1]
        for name in (*WORN_OF_EACH, WORN_RACES, *WORN_WHOLE)
        if name in file.variables
    }
    cubic = [name for name in at_end if VARIABLES[name].units == "m3"]
    unit = display("m3", *(at_end[name] for name in cubic))

    def worn(name: str, *numbers: float) -> Row:
        """One unit for all volumes, for comparison."""
        return row_of(name, numbers, unit=unit if name in cubic else None)

    rows = [
        worn(name, mean(at_end[name]), at_end[name].min(), at_end[name].max())
        for name in WORN_OF_EACH
        if name in at_end
    ]
    for race, volume in zip(RACES, at_end[WORN_RACES], strict=True):
        row = worn(WORN_RACES, volume)
        rows.append(row._replace(label=f"{race} race", name=f"{WORN_RACES}.{race}"))
    rows += [worn(name, at_end[name]) for name in WORN_WHOLE if name in at_end]
    return [Block("wear since the start", ("mean", "minimum", "maximum"), tuple(rows))]
