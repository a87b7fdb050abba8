"""Sentences and warnings on films and running in."""

import math
from collections.abc import Iterator

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
    scene, films, given = chosen.scene, Films.of(chosen.scene), chosen.scene.friction.film
    if given is not None:
        plus = f" plus {given.pressure_coefficient:g}" if given.pressure_coefficient else ""
        yield (
            f"friction: film shear strength ({given.shear_strength_MPa:g} MPa) divided by the "
            f"mean pressure of each contact{plus}; about {_at_rest(scene)} at rest"
        )
    if films.table is not None:
        warmth = "at the mean temperature of ring and balls"
        if np.isnan(contact_temperatures(scene)).any():
            warmth = f"at {films.table.reference:g} degC (the scene gives no temperature)"
        rows = _table_range(films.table)
        yield (
            f"wear of films: by their lives in tests ({rows}), under the Hertzian peak pressure of "
            f"each contact and {warmth}"
        )
    coated = {"races": films.race, "balls": films.ball}
    for part, surface in coated.items():
        if surface.film is None:
            continue
        factor = surface.film.factor
        thick = "never worn through"
        if math.isfinite(surface.thickness):
            thick = f"{surface.thickness / UM:g} um thick; {_then(scene)}"
        yield f"film on the {part}: K_s/H {factor:.2g} m2/N; {thick}"
    for part, surface in coated.items():
        if surface.running_in:
            yield (
                f"running-in of the {part}: K_s from {surface.first:g} to "
                f"{float(surface.below.K_s):g}, over {surface.running_in / UM:g} um"
            )


def _table_range(table: WearTable) -> str:
    """Range of pressures and temperatures of a table."""
    both = (table.pressure / MPA, table.temperature)
    pressures, temperatures = (" to ".join(dict.fromkeys(map(plain, one[[0, -1]]))) for one in both)
    return f"{pressures} MPa, {temperatures} degC"


NEAR_TESTS_K = 5.0
"""Kelvin beyond the temperatures of a table from which on it is warned of, assumed."""


def film_beyond_tests(e: Evidence) -> Finding | None:
    """The contact whose pressure or temperature lies farthest beyond the tests of its film."""
    table, found = Films.of(e.scene).table, []
    if table is None:
        return None
    pressures = PEAK_OVER_MEAN * pressure_of_load(e.scene, e.contacts("contact_load").mean(axis=0))
    for pressure in pressures.tolist():
        low, high = table.pressure[[0, -1]].tolist()
        excess = max(pressure / high, low / pressure) if pressure > 0.0 else math.nan
        found.append((excess, f"peak pressure of {plain(pressure / MPA)} MPa", pressure > high))
    for kelvin in contact_temperatures(e.scene, e.state["part_temperature"]).tolist():
        low, high = table.temperature[[0, -1]].tolist()
        excess = 1.0 + (max(kelvin - high, low - kelvin) - NEAR_TESTS_K) / 100.0
        found.append((excess, f"temperature of {plain(kelvin)} degC", kelvin > high))
    beyond = [one for one in found if not math.isnan(one[0])]
    if not beyond:
        return None
    excess, what, above = max(beyond)
    advice = "expect a shorter life than computed" if above else "the life computed is cautious"
    return {"what": what, "range": _table_range(table), "advice": advice, "excess": excess}


def film_worn(e: Evidence) -> Finding | None:
    """A film worn through in a life that continues with the film's friction."""
    if e.life is None or "history_film_worn_share" not in e.life:
        return None
    shares, given = e.life["history_film_worn_share"], e.scene.friction.film
    if not shares.max() > 0.0 or (given is not None and given.bare_ball_race is not None):
        return None
    if len(shares) < 3 or not shares[:-1].max() > 0.0:  # it ends there
        return None
    races = [name for name, share in zip(("inner", "outer"), shares[-1], strict=True) if share]
    return {"races": " and ".join(races), "share": 100.0 * float(shares[-1].max())}


def _then(scene: Scene) -> str:
    end, given = scene.wear.end_of_life, scene.friction.film
    if end is not None and end.film_worn_share is not None:
        share = f"{100.0 * end.film_worn_share:g} %"
        return f"the life ends when the film is worn through over {share} of a track"
    if given is not None and given.bare_ball_race is not None:
        return f"where the film is worn through, friction is {given.bare_ball_race:g}"
    return "where the film is worn through, friction is unchanged"


def _at_rest(scene: Scene) -> str:
    """Friction coefficients under the preload at rest, by fitted Hertz factors."""
    # loaded here: its kernels load slowly, and other commands do not use them
    from bearingwear.solvers.bearing.parameters import friction_law

    g, preload, law = mounted_geometry(scene), scene.operation.preload_N, friction_law(scene)
    sine = math.sin(g.alpha0)
    if not (preload > 0.0 and sine > 0.0):
        return f"at least {law.mu:.3g}"
    loads = np.full(2, preload / (g.n_balls * sine))
    pair = (law.mu + law.S / float(p) if law.S else law.mu for p in pressure_of_load(scene, loads))
    return " (inner) and ".join(f"{mu:.2g}" for mu in pair) + " (outer)"
