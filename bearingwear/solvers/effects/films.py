"""Sentences and warnings on films and running in."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from bearingwear.measures import plain
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.films import (
    MPA,
    PEAK_OVER_MEAN,
    Films,
    WearTable,
    contact_temperatures,
    pressure_of_load,
)
from bearingwear.solvers.bearing.mounted import UM, mounted_geometry
from bearingwear.solvers.effects.choice import Choice
from bearingwear.solvers.effects.evidence import Evidence, Finding


def film_sentences(chosen: Choice) -> Iterator[str]:
    """Yields sentences on friction and wear of films, and on running in."""
    scene = chosen.scene
    films = Films.of(chosen.scene)
    film = chosen.scene.friction.film
    if film is not None:
        offset = f" plus {film.pressure_coefficient:g}" if film.pressure_coefficient else ""
        yield (
            f"friction: film shear strength ({film.shear_strength_MPa:g} MPa) divided by the "
            f"mean pressure of each contact{offset}; about {_friction_at_rest(scene)} at rest"
        )
    if films.table is not None:
        temperature_words = "at the mean temperature of ring and balls"
        if np.isnan(contact_temperatures(scene)).any():
            temperature_words = (
                f"at {films.table.reference:g} degC (the scene gives no temperature)"
            )
        rows = _table_range(films.table)
        yield (
            f"wear of films: by their lives in tests ({rows}), under the Hertzian peak pressure of "
            f"each contact and {temperature_words}"
        )
    surfaces = {"races": films.race, "balls": films.ball}
    for part, surface in surfaces.items():
        if surface.film is None:
            continue
        factor = surface.film.factor
        thickness = "never worn through"
        if math.isfinite(surface.thickness):
            thickness = f"{surface.thickness / UM:g} um thick; {_worn_through_words(scene)}"
        yield f"film on the {part}: K_s/H {factor:.2g} m2/N; {thickness}"
    for part, surface in surfaces.items():
        if surface.running_in:
            yield (
                f"running-in of the {part}: K_s from {surface.initial_K_s:g} to "
                f"{float(surface.substrate.K_s):g}, over {surface.running_in / UM:g} um"
            )


def _table_range(table: WearTable) -> str:
    """Returns the range of pressures and temperatures of a table, in words."""
    # a table with a single pressure or temperature has no range of it
    pressures, temperatures = (
        " to ".join(dict.fromkeys(map(plain, values[[0, -1]])))
        for values in (table.pressure / MPA, table.temperature)
    )
    return f"{pressures} MPa, {temperatures} degC"


NEAR_TESTS_K = 5.0
"""Kelvin beyond the temperatures of a table above which there is a warning, assumed."""

KELVIN_PER_EXCESS = 100.0
"""Kelvin beyond that which weigh as much as twice the highest pressure of a table, assumed."""

FILM_SPEED = 0.6
"""Speed times pitch diameter [million mm r/min] above which a film is warned of: ten times that of
the one published test of a sputtered film in an angular contact bearing (docs/film_tests.md)."""


def film_too_fast(evidence: Evidence) -> Finding | None:
    """Returns the finding of speed times pitch diameter, whose limit is `FILM_SPEED`.

    None without a film.
    """
    if evidence.scene.friction.film is None:
        return None
    operation = evidence.scene.operation
    relative = abs(operation.shaft_speed_rpm - operation.outer_speed_rpm)
    return {
        "value": 1e-6 * relative * evidence.scene.bearing.pitch_diameter_mm,
        "limit": FILM_SPEED,
    }


class _Distance(NamedTuple):
    """How far a pressure or temperature lies beyond the range of a film's tests."""

    excess: float  # above 1 beyond the range, NaN without load
    quantity: str  # in words
    is_above: bool  # above the range, not below it


def film_beyond_tests(evidence: Evidence) -> Finding | None:
    """Returns the finding of the pressure or temperature farthest beyond a film's tests.

    None without a table of tests, and where neither a pressure nor a temperature is known.
    """
    table = Films.of(evidence.scene).table
    if table is None:
        return None
    distances = []
    pressures = PEAK_OVER_MEAN * pressure_of_load(
        evidence.scene, evidence.contacts("contact_load").mean(axis=0)
    )
    for pressure in pressures.tolist():
        low, high = table.pressure[[0, -1]].tolist()
        excess = max(pressure / high, low / pressure) if pressure > 0.0 else math.nan
        words = f"peak pressure of {plain(pressure / MPA)} MPa"
        distances.append(_Distance(excess, words, pressure > high))
    for celsius in contact_temperatures(
        evidence.scene, evidence.state["part_temperature"]
    ).tolist():
        low, high = table.temperature[[0, -1]].tolist()
        excess = 1.0 + (max(celsius - high, low - celsius) - NEAR_TESTS_K) / KELVIN_PER_EXCESS
        words = f"temperature of {plain(celsius)} degC"
        distances.append(_Distance(excess, words, celsius > high))
    distances = [distance for distance in distances if not math.isnan(distance.excess)]
    if not distances:
        return None
    farthest = max(distances)  # by the excess, the first field
    advice = "the life computed is cautious"
    if farthest.is_above:
        advice = "expect a shorter life than computed"
    return {
        "what": farthest.quantity,
        "range": _table_range(table),
        "advice": advice,
        "excess": farthest.excess,
    }


def film_worn(evidence: Evidence) -> Finding | None:
    """Returns the finding of a film worn through in a life that continues with its friction.

    None where no film is worn through, where that ends the life, and where the scene has another
    friction without film.
    """
    if evidence.life is None or "history_film_worn_share" not in evidence.life:
        return None
    shares, film = evidence.life["history_film_worn_share"], evidence.scene.friction.film
    if not shares.max() > 0.0 or (film is not None and film.bare_ball_race is not None):
        return None
    has_gone_on = len(shares) > 2 and shares[:-1].max() > 0.0  # worn through before the last state
    if not has_gone_on:
        return None
    races = [name for name, share in zip(("inner", "outer"), shares[-1], strict=True) if share]
    return {"races": " and ".join(races), "share": 100.0 * float(shares[-1].max())}


def _worn_through_words(scene: Scene) -> str:
    """Returns what happens where a film is worn through, in words."""
    end, film = scene.wear.end_of_life, scene.friction.film
    if end is not None and end.film_worn_share is not None:
        share = f"{100.0 * end.film_worn_share:g} %"
        return f"the life ends when the film is worn through over {share} of a track"
    if film is not None and film.bare_ball_race is not None:
        return f"where the film is worn through, friction is {film.bare_ball_race:g}"
    return "where the film is worn through, friction is unchanged"


def _friction_at_rest(scene: Scene) -> str:
    """Returns the friction coefficients at rest by fitted Hertz factors, in words."""
    # loaded here: its kernels load slowly, and other commands do not use them
    from bearingwear.solvers.bearing.parameters import friction_law

    g = mounted_geometry(scene)
    preload = scene.operation.preload_N
    law = friction_law(scene)
    sin_alpha = math.sin(g.alpha0)
    if not (preload > 0.0 and sin_alpha > 0.0):
        return f"at least {law.mu:.3g}"
    loads = np.full(2, preload / (g.n_balls * sin_alpha))
    coefficients = (
        law.mu + law.S / float(p) if law.S else law.mu for p in pressure_of_load(scene, loads)
    )
    return " (inner) and ".join(f"{mu:.2g}" for mu in coefficients) + " (outer)"
