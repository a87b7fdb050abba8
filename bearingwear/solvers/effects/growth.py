"""Sentences on growth, and estimates of its effect on a fixed position before a solve."""

import functools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from bearingwear.kernels.params import Geometry
from bearingwear.measures import plain
from bearingwear.scene.scene import Arrangement, Scene
from bearingwear.scene.warmth import LARGEST_STRAIN, Fits, expansion
from bearingwear.solvers.bearing.fitted_hertz import fitted_displacement, fitted_preload
from bearingwear.solvers.bearing.growth import (
    Expansion,
    Growth,
    RingGrowth,
    axial_change,
    grown,
    growth_of,
    growth_with_bore,
    growth_with_fits,
    inner_growth,
    is_held,
    speed_that_takes_the_fit,
)
from bearingwear.solvers.bearing.mounted import MM, UM, mounted_geometry
from bearingwear.solvers.effects.choice import Choice
from bearingwear.solvers.effects.evidence import Evidence, Finding
from bearingwear.solvers.effects.motion import rolling_rates
from bearingwear.solvers.thermal import LOW_MARGIN

USUAL_BORE = 1.75
"""Pitch diameter less bore, over ball diameter; assumed where no bore is given."""

MOST_LEFT_OUT = 0.1
"""Largest relative change of a fixed-position preload by neglected growth, assumed."""

WARMER = 5.0
"""Temperature of the inner ring above the rest [K] in the warning, assumed."""

TRIED_UM = (5.0, 12.0)
"""Interference on the shaft [um] whose effect is told where none is given: a light fit, and a fit
of a fast spindle."""

_NO_MARGIN = 1e-9

_STILL, _COLD = RingGrowth(), Expansion()


def preload_change(scene: Scene, growth: Growth) -> float:
    """Change of a fixed-position preload at rest by growth, over the preload, estimated [1].

    The unworn bearing at rest, by fitted Hertz factors; NaN without a preload.
    """
    a, F = scene.arrangement or Arrangement(), scene.operation.preload_N
    if not F > 0.0:
        return math.nan
    return _preload_change(
        mounted_geometry(scene), F, growth, (a.span_mm or 0.0) * MM, a.orientation
    )


@functools.lru_cache(maxsize=64)
def _preload_change(g: Geometry, F: float, growth: Growth, span: float, orientation: str) -> float:
    """`preload_change` of a geometry as mounted; cached, since a solve uses it several times."""
    axial = g.BD * math.sin(g.alpha0) + fitted_displacement(g, F)
    running = grown(g, growth, 0.0)
    now = fitted_preload(running, axial + axial_change(growth.heat, axial, span, orientation))
    return now / fitted_preload(g, axial) - 1.0


def assumed_bore(scene: Scene) -> float:
    """Bore of the inner ring [m]; the usual one for its balls where the scene gives none."""
    b = scene.bearing
    usual = max(b.pitch_diameter_mm - USUAL_BORE * b.ball_diameter_mm, 0.0)
    return MM * (usual if b.bore_mm is None else b.bore_mm)


def change_at_speed(scene: Scene) -> float:
    """Change of a fixed-position preload by the growth of the turning rings alone [1]."""
    growth = growth_with_bore(scene, assumed_bore(scene))
    alone = Growth(_COLD, growth.inner._replace(fit=0.0), growth.outer._replace(fit=0.0))
    return preload_change(scene, alone)


def change_by_warm_ring(scene: Scene, kelvin: float) -> float:
    """Change of a fixed-position preload by an inner ring warmer than the rest [1]."""
    strain = kelvin * expansion(scene, scene.bearing.race_material)
    return preload_change(scene, Growth(_COLD._replace(inner_ring=strain), _STILL, _STILL))


def change_by_warmth(scene: Scene) -> float:
    """Change of a fixed-position preload by the temperatures of a scene [1].

    Where it gives none, by an inner ring that is `WARMER` than the rest; NaN where a network finds
    them.
    """
    if scene.thermal is not None:
        return math.nan
    if scene.temperature is None:
        return change_by_warm_ring(scene, WARMER)
    return preload_change(scene, Growth(growth_of(scene).heat, _STILL, _STILL))


def _effect(scene: Scene, relative_change: Callable[[Scene], float]) -> str:
    if not is_held(scene):
        return "a second-order effect, because the preload force is constant"
    percent = 100.0 * relative_change(scene)
    if math.isnan(percent):
        return "effect on the preload: unknown before the solve"
    size = f"{percent:+.2g}" if abs(percent) < 10.0 else f"{percent:+.0f}"
    return f"effect on the preload at rest: about {size} %"


def growth_at_speed(chosen: Choice) -> Iterator[str]:
    scene, b, o = chosen.scene, chosen.scene.bearing, chosen.scene.operation
    if o.shaft_speed_rpm or o.outer_speed_rpm:
        size = _effect(scene, change_at_speed)
        if b.bore_mm is not None:
            yield f"growth of the rings at speed: included; {size}"
        else:
            bore = f" (a bore of {assumed_bore(scene) / MM:.3g} mm is assumed for this estimate)"
            yield (
                "growth of the rings at speed: neglected, because bearing.bore_mm is not given; "
                f"{size}{bore if is_held(scene) else ''}"
            )
    if o.outer_speed_rpm and b.outside_diameter_mm is None:
        yield (
            "growth of the rotating outer ring: neglected, because bearing.outside_diameter_mm is "
            "not given"
        )


def temperature(chosen: Choice) -> Iterator[str]:
    scene, held = chosen.scene, is_held(chosen.scene)
    if scene.thermal is not None:
        rough = "; conductances, and therefore the preload, are rough estimates" if held else ""
        yield f"temperature: computed for rings and balls from the friction heat{rough}"
    elif scene.temperature is not None:
        yield f"temperature: given; {_effect(scene, change_by_warmth)}"
    else:
        size = _effect(scene, lambda one: change_by_warm_ring(one, 1.0))
        each = " for each kelvin by which the inner ring is warmer than the other parts"
        per_kelvin = each if held else ""
        yield f"temperature: neglected; {size}{per_kelvin}"


def seats(chosen: Choice) -> Iterator[str]:
    """What a fit makes of a preload at a fixed position; of any other preload only a given fit."""
    scene = chosen.scene.sides[0]
    if has_interference(scene):
        effect = _effect(scene, change_by_fits)
        assert scene.fits is not None
        leaves = _leaving(speed_that_takes_the_fit(scene, assumed_bore(scene), scene.fits))
        yield f"fits: included; {effect}; the inner ring is loose from {leaves}"
    elif is_held(scene):
        given = "no interference" if scene.fits else "none given, so no interference is assumed"
        found = tried_fits(scene, estimated_preload)
        size = f": {interference_sizes(found, found[0].running)}" if found[1:] else ""
        bore = f" (a bore of {assumed_bore(scene) / MM:.3g} mm is assumed for this estimate)"
        assumed = scene.bearing.bore_mm is None and found[1:]
        yield f"fits: {given}{size}{bore if assumed else ''}"
    elif scene.fits is not None:
        yield f"fits: no interference; {_effect(scene, change_at_speed)}"


def has_interference(scene: Scene) -> bool:
    """Whether a scene has a fit that is tight."""
    fits = scene.fits or Fits()
    return fits.shaft_interference_um > 0.0 or fits.housing_interference_um > 0.0


@dataclass(frozen=True)
class TriedFit:
    """What an interference on the shaft makes of a fixed-position preload, estimated."""

    um: float
    at_rest: float  # preload at mounting temperature [N]
    running: float  # preload of the running bearing [N]
    leaves_rpm: float  # speed at which the ring leaves its seat


def tried_fits(scene: Scene, running_preload: Callable[[Scene, Growth], float]) -> list[TriedFit]:
    """No interference, and each of `TRIED_UM` that the bore allows; none without a preload.

    running_preload: of the bearing of a scene with its growth [N].
    """
    F, bore = scene.operation.preload_N, assumed_bore(scene)
    if not (F > 0.0 and bore > 0.0):
        return []
    warm = scene.temperature is not None or scene.thermal is not None
    cold = replace(scene, temperature=None, thermal=None) if warm else scene
    found = []
    for um in (0.0, *TRIED_UM):
        if um * UM > LARGEST_STRAIN * bore:
            continue
        fits = replace(scene.fits or Fits(), shaft_interference_um=um)
        still = Growth(_COLD, inner_growth(cold, _COLD, bore, fits, 0.0), _STILL)
        running = running_preload(scene, growth_with_fits(scene, bore, fits))
        leaves = speed_that_takes_the_fit(scene, bore, fits)
        found.append(TriedFit(um, F * (1.0 + preload_change(cold, still)), running, leaves))
    return found


def change_by_fits(scene: Scene) -> float:
    """Change of a fixed-position preload by the fits of a scene [1].

    Where none is tight, the largest by those of `TRIED_UM`; NaN without a preload.
    """
    if has_interference(scene):
        growth = growth_of(scene)
        inner, outer = (ring._replace(speed=0.0) for ring in (growth.inner, growth.outer))
        return preload_change(scene, Growth(_COLD, inner, outer))
    found = tried_fits(scene, estimated_preload)
    return largest_change(found, found[0].running) if found[1:] else math.nan


def largest_change(found: Sequence[TriedFit], running: float) -> float:
    """Largest change by a fit that is tried, of the running preload [N] or of that at rest [1]."""
    at_rest = max(one.at_rest for one in found) / found[0].at_rest - 1.0
    grown = max(one.running for one in found) - found[0].running
    return max(at_rest, grown / running if running > 0.0 else math.inf)


def estimated_preload(scene: Scene, growth: Growth) -> float:
    """Preload of the running bearing by its contacts at rest, before any solve [N]."""
    return scene.operation.preload_N * (1.0 + preload_change(scene, growth))


def frictionless_preload(scene: Scene, growth: Growth) -> float:
    """Preload of the running bearing by its contacts under centrifugal force, without friction [N].

    It needs kernels, which are compiled after a solve.
    """
    from bearingwear.solvers.bearing.at_rest import Mechanics
    from bearingwear.solvers.bearing.parameters import running_geometry, static_place

    g = running_geometry(scene, growth)
    return Mechanics(g, g.D0, rolling_rates(scene)[1]).force(static_place(scene))


def interference_sizes(found: Sequence[TriedFit], running: float) -> str:
    """What fits of usual size make of the preload, as a clause; `running` is it without one [N]."""
    without, *fits = found
    made = []
    for one in fits:
        at_speed = plain(running + one.running - without.running)
        loose = f"loose from {_leaving(one.leaves_rpm)}"
        made.append(f"{one.um:g} um about {plain(one.at_rest)} and {at_speed} N ({loose})")
    now = f"{plain(without.at_rest)} N at rest and about {plain(running)} N at speed"
    return f"{now}; on the shaft, {', '.join(made)}"


def _leaving(rpm: float) -> str:
    return f"{float(f'{rpm:.2g}'):.0f} r/min" if math.isfinite(rpm) else "no speed"


def fit_left_out(e: Evidence) -> Finding | None:
    """No interference on the shaft of a bearing at a fixed position whose bore is known."""
    scene = e.scene
    if has_interference(scene) or not is_held(scene) or scene.bearing.bore_mm is None:
        return None
    solved = float(e.state["residual_preload"])
    is_solved = math.isfinite(solved)
    found = tried_fits(scene, frictionless_preload if is_solved else estimated_preload)
    if not found[1:]:
        return None
    is_new = is_solved and not e.mean("ball_diameter_loss") > 0.0
    running = solved if is_new else found[0].running  # what is told is of a new bearing
    held = "fixed position" if e.chosen.scene.pair is None else "rigid pair"
    change = largest_change(found, running)
    sizes = interference_sizes(found, running)
    return {"excess": change / MOST_LEFT_OUT, "held": held, "sizes": sizes}


def growth_left_out(e: Evidence) -> Finding | None:
    """Neglected growth of the inner ring at speed, at a fixed position."""
    if e.scene.bearing.bore_mm is not None or not is_held(e.scene):
        return None
    return _left_out(e, change_at_speed(e.scene)) | {"bore": assumed_bore(e.scene) / MM}


def temperature_left_out(e: Evidence) -> Finding | None:
    given = e.scene.temperature is not None or e.scene.thermal is not None
    if given or not is_held(e.scene):
        return None
    return _left_out(e, change_by_warm_ring(e.scene, WARMER)) | {"kelvin": WARMER}


def _left_out(e: Evidence, change: float) -> Finding:
    # each bearing of a pair is looked at alone
    held = "fixed position" if e.chosen.scene.pair is None else "rigid pair"
    newtons = change * e.scene.operation.preload_N
    excess = abs(change) / MOST_LEFT_OUT
    return {"value": 100.0 * change, "newtons": newtons, "excess": excess, "held": held}


def thermal_margin_low(e: Evidence) -> Finding | None:
    """A thermal network near the point from which on its temperatures run away."""
    margin = e.state.values.get("thermal_margin")
    if margin is None:
        return None
    return {"value": float(margin), "excess": LOW_MARGIN / max(float(margin), _NO_MARGIN)}


def fit_lost(e: Evidence) -> Finding | None:
    """Seats that are tight at rest and loose when the bearing runs."""
    if e.scene.fits is None:
        return None
    growth = growth_of(e.scene)
    lost = {"shaft": growth.inner.seat_lost, "housing": growth.outer.seat_lost}
    named = " and ".join(seat for seat, is_lost in lost.items() if is_lost)
    return {"seats": named} if named else None
