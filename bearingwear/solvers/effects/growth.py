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
    fit_loss_speed,
    grown_geometry,
    growth_of,
    growth_with_bore,
    growth_with_fits,
    inner_growth,
    is_held,
)
from bearingwear.solvers.bearing.mounted import MM, UM, mounted_geometry
from bearingwear.solvers.effects.choice import Choice
from bearingwear.solvers.effects.evidence import Evidence, Finding
from bearingwear.solvers.effects.motion import rolling_rates
from bearingwear.solvers.thermal import LOW_MARGIN

USUAL_BORE = 1.75
"""Pitch diameter less bore, over ball diameter; assumed where no bore is given."""

MOST_LEFT_OUT = 0.1
"""Largest relative change of a fixed-position preload by growth that may be neglected, assumed."""

WARMER = 5.0
"""Temperature of the inner ring above the rest [K] in the warning, assumed."""

TRIED_UM = (5.0, 12.0)
"""Interference on the shaft [um] whose effect is reported where none is given: a light fit, and
that of a fast spindle."""

_NO_MARGIN = 1e-9
"""Thermal margin in place of zero, over which a ratio stays finite."""

_STILL, _COLD = RingGrowth(), Expansion()


def preload_change(scene: Scene, growth: Growth) -> float:
    """Estimates the relative change of a fixed-position preload at rest by growth [1].

    It is that of the unworn bearing at rest, by fitted Hertz factors; NaN without a preload.
    """
    a = scene.arrangement or Arrangement()
    F = scene.operation.preload_N
    if not F > 0.0:
        return math.nan
    return _change_of_preload(
        mounted_geometry(scene), F, growth, (a.span_mm or 0.0) * MM, a.orientation
    )


@functools.lru_cache(maxsize=64)
def _change_of_preload(
    g: Geometry, F: float, growth: Growth, span: float, orientation: str
) -> float:
    """Returns the relative change of a preload by growth at rest [1].

    It is cached, because a solve requires it several times.

    g: geometry as mounted.
    F: preload at rest, without growth [N].
    span: distance of the two bearings [m].
    """
    axial = g.BD * math.sin(g.alpha0) + fitted_displacement(g, F)
    running = grown_geometry(g, growth, 0.0)
    running_preload = fitted_preload(
        running, axial + axial_change(growth.heat, axial, span, orientation)
    )
    return running_preload / fitted_preload(g, axial) - 1.0


def assumed_bore(scene: Scene) -> float:
    """Returns the bore of the inner ring [m], or the usual one for its balls if none is given."""
    b = scene.bearing
    usual = max(b.pitch_diameter_mm - USUAL_BORE * b.ball_diameter_mm, 0.0)
    return MM * (usual if b.bore_mm is None else b.bore_mm)


def change_at_speed(scene: Scene) -> float:
    """Returns the change of a fixed-position preload by the growth of turning rings alone [1]."""
    growth = growth_with_bore(scene, assumed_bore(scene))
    alone = Growth(_COLD, growth.inner._replace(fit=0.0), growth.outer._replace(fit=0.0))
    return preload_change(scene, alone)


def change_by_warm_ring(scene: Scene, kelvin: float) -> float:
    """Returns the change of a fixed-position preload by an inner ring warmer than the rest [1]."""
    strain = kelvin * expansion(scene, scene.bearing.race_material)
    return preload_change(scene, Growth(_COLD._replace(inner_ring=strain), _STILL, _STILL))


def change_by_warmth(scene: Scene) -> float:
    """Returns the change of a fixed-position preload by the temperatures of a scene [1].

    If it gives none, the inner ring is `WARMER` than the rest; NaN if a network determines them.
    """
    if scene.thermal is not None:
        return math.nan
    if scene.temperature is None:
        return change_by_warm_ring(scene, WARMER)
    return preload_change(scene, Growth(growth_of(scene).heat, _STILL, _STILL))


def _effect_words(scene: Scene, relative_change: Callable[[Scene], float]) -> str:
    """Returns the effect of a growth on the preload, in words.

    relative_change: returns the relative change of a scene's fixed-position preload [1].
    """
    if not is_held(scene):
        return "a second-order effect, because the preload force is constant"
    percent = 100.0 * relative_change(scene)
    if math.isnan(percent):
        return "effect on the preload: unknown before the solve"
    size = f"{percent:+.2g}" if abs(percent) < 10.0 else f"{percent:+.0f}"
    return f"effect on the preload at rest: about {size} %"


def speed_growth_sentences(chosen: Choice) -> Iterator[str]:
    """Yields sentences on the growth of the rings at speed."""
    scene, bearing, operation = chosen.scene, chosen.scene.bearing, chosen.scene.operation
    if operation.shaft_speed_rpm or operation.outer_speed_rpm:
        size = _effect_words(scene, change_at_speed)
        if bearing.bore_mm is not None:
            yield f"growth of the rings at speed: included; {size}"
        else:
            bore = f" (a bore of {assumed_bore(scene) / MM:.3g} mm is assumed for this estimate)"
            yield (
                "growth of the rings at speed: neglected, because bearing.bore_mm is not given; "
                f"{size}{bore if is_held(scene) else ''}"
            )
    if operation.outer_speed_rpm and bearing.outside_diameter_mm is None:
        yield (
            "growth of the rotating outer ring: neglected, because bearing.outside_diameter_mm is "
            "not given"
        )


def temperature_sentences(chosen: Choice) -> Iterator[str]:
    """Yields a sentence on the effect of temperatures."""
    scene = chosen.scene
    is_fixed = is_held(chosen.scene)
    if scene.thermal is not None:
        caveat = (
            "; conductances, and therefore the preload, are rough estimates" if is_fixed else ""
        )
        yield f"temperature: computed for rings and balls from the friction heat{caveat}"
    elif scene.temperature is not None:
        yield f"temperature: given; {_effect_words(scene, change_by_warmth)}"
    else:
        size = _effect_words(scene, lambda warmer_scene: change_by_warm_ring(warmer_scene, 1.0))
        per_kelvin = " for each kelvin by which the inner ring is warmer than the other parts"
        yield f"temperature: neglected; {size}{per_kelvin if is_fixed else ''}"


def fit_sentences(chosen: Choice) -> Iterator[str]:
    """Yields a sentence on fits; none without fits where the preload force is constant."""
    scene = chosen.scene.sides[0]
    if has_interference(scene):
        effect = _effect_words(scene, change_by_fits)
        assert scene.fits is not None
        loss_speed = _speed_words(fit_loss_speed(scene, assumed_bore(scene), scene.fits))
        yield f"fits: included; {effect}; the inner ring is loose from {loss_speed}"
    elif is_held(scene):
        fit = "no interference" if scene.fits else "none given, so no interference is assumed"
        tried = tried_fits(scene, estimated_preload)
        size = f": {interference_sizes(tried, tried[0].running)}" if tried[1:] else ""
        bore = f" (a bore of {assumed_bore(scene) / MM:.3g} mm is assumed for this estimate)"
        is_assumed = scene.bearing.bore_mm is None and tried[1:]
        yield f"fits: {fit}{size}{bore if is_assumed else ''}"
    elif scene.fits is not None:
        yield f"fits: no interference; {_effect_words(scene, change_at_speed)}"


def has_interference(scene: Scene) -> bool:
    """Returns whether a scene has a tight fit."""
    fits = scene.fits or Fits()
    return fits.shaft_interference_um > 0.0 or fits.housing_interference_um > 0.0


@dataclass(frozen=True)
class TriedFit:
    """Estimated effect of an interference on the shaft on a fixed-position preload."""

    um: float
    at_rest: float  # preload at mounting temperature [N]
    running: float  # preload of the running bearing [N]
    leaves_rpm: float  # speed at which the ring leaves its seat


def tried_fits(scene: Scene, running_preload: Callable[[Scene, Growth], float]) -> list[TriedFit]:
    """Returns the effects of no interference, and of each of `TRIED_UM` that the bore allows.

    Empty without a preload or a bore.

    running_preload: returns the preload of a scene's bearing with its growth [N].
    """
    F = scene.operation.preload_N
    bore = assumed_bore(scene)
    if not (F > 0.0 and bore > 0.0):
        return []
    is_warm = scene.temperature is not None or scene.thermal is not None
    cold = replace(scene, temperature=None, thermal=None) if is_warm else scene
    tried = []
    for um in (0.0, *TRIED_UM):
        if um * UM > LARGEST_STRAIN * bore:
            continue
        fits = replace(scene.fits or Fits(), shaft_interference_um=um)
        at_rest = Growth(_COLD, inner_growth(cold, _COLD, bore, fits, 0.0), _STILL)
        running = running_preload(scene, growth_with_fits(scene, bore, fits))
        loss_speed = fit_loss_speed(scene, bore, fits)
        tried.append(
            TriedFit(
                um=um,
                at_rest=F * (1.0 + preload_change(cold, at_rest)),
                running=running,
                leaves_rpm=loss_speed,
            )
        )
    return tried


def change_by_fits(scene: Scene) -> float:
    """Returns the change of a fixed-position preload by the fits of a scene [1].

    If none is tight, it is the largest change by `TRIED_UM`; NaN without a preload or a bore.
    """
    if has_interference(scene):
        growth = growth_of(scene)
        inner, outer = (ring._replace(speed=0.0) for ring in (growth.inner, growth.outer))
        return preload_change(scene, Growth(_COLD, inner, outer))
    tried = tried_fits(scene, estimated_preload)
    return largest_change(tried, tried[0].running) if tried[1:] else math.nan


def largest_change(tried: Sequence[TriedFit], running: float) -> float:
    """Returns the largest relative change by a tried fit, of the preload at speed or at rest [1].

    Infinite where no preload is left at speed without a fit.

    tried: without interference first.
    running: preload at speed without a fit [N].
    """
    at_rest = max(fit.at_rest for fit in tried) / tried[0].at_rest - 1.0
    increase = max(fit.running for fit in tried) - tried[0].running
    return max(at_rest, increase / running if running > 0.0 else math.inf)


def estimated_preload(scene: Scene, growth: Growth) -> float:
    """Estimates the preload of the running bearing by its contacts at rest, before a solve [N]."""
    return scene.operation.preload_N * (1.0 + preload_change(scene, growth))


def frictionless_preload(scene: Scene, growth: Growth) -> float:
    """Returns the preload of the running bearing under centrifugal force, without friction [N].

    It uses kernels, which are compiled once a solve has been made.
    """
    from bearingwear.solvers.bearing.at_rest import Mechanics
    from bearingwear.solvers.bearing.parameters import running_geometry, static_place

    g = running_geometry(scene, growth)
    _, orbit_rate = rolling_rates(scene)
    return Mechanics(g, g.D0, orbit_rate).force(static_place(scene))


def interference_sizes(tried: Sequence[TriedFit], running: float | None) -> str:
    """Returns the preload without a fit and with each tried fit, in words.

    tried: no interference, then fits of usual size.
    running: preload at speed without a fit [N]; None before a solve: an estimate without the
        centrifugal force of the balls would be far too small.
    """
    without, *others = tried
    clauses = []
    for fit in others:
        forces = plain(fit.at_rest)
        if running is not None:
            forces += f" N at rest and {plain(running + fit.running - without.running)} N at speed"
        else:
            forces += " N"
        clauses.append(f"{fit.um:g} um gives {forces} (loose from {_speed_words(fit.leaves_rpm)})")
    without_words = f"{plain(without.at_rest)} N at rest"
    if running is not None:
        without_words += f" and about {plain(running)} N at speed"
    return f"{without_words}; on the shaft, {', '.join(clauses)}"


def _speed_words(rpm: float) -> str:
    """Returns the speed from which a ring is loose, in words."""
    return f"{float(f'{rpm:.2g}'):.0f} r/min" if math.isfinite(rpm) else "no speed"


def fit_left_out(evidence: Evidence) -> Finding | None:
    """Returns the finding of a fixed position without interference on the shaft.

    Its excess is the largest change of the preload by a usual fit, over the one that may be
    neglected. None where a fit is given, the preload force is constant, or the bore is unknown.
    """
    scene = evidence.scene
    if has_interference(scene) or not is_held(scene) or scene.bearing.bore_mm is None:
        return None
    solved = float(evidence.state["residual_preload"])
    is_solved = math.isfinite(solved)
    tried = tried_fits(scene, frictionless_preload if is_solved else estimated_preload)
    if not tried[1:]:
        return None
    is_new = is_solved and not evidence.mean("ball_diameter_loss") > 0.0
    running = solved if is_new else tried[0].running  # the warning concerns a new bearing
    preload_words = "fixed position" if evidence.chosen.scene.pair is None else "rigid pair"
    change = largest_change(tried, running)
    sizes = interference_sizes(tried, running if is_solved else None)
    return {"excess": change / MOST_LEFT_OUT, "held": preload_words, "sizes": sizes}


def growth_left_out(evidence: Evidence) -> Finding | None:
    """Returns the finding of neglected growth of the inner ring at speed, at a fixed position.

    None where the growth is modelled or the preload force is constant.
    """
    if evidence.scene.bearing.bore_mm is not None or not is_held(evidence.scene):
        return None
    return _growth_finding(evidence, change_at_speed(evidence.scene)) | {
        "bore": assumed_bore(evidence.scene) / MM
    }


def temperature_left_out(evidence: Evidence) -> Finding | None:
    """Returns the finding of neglected temperatures of a bearing at a fixed position.

    None where temperatures are modelled or the preload force is constant.
    """
    is_given = evidence.scene.temperature is not None or evidence.scene.thermal is not None
    if is_given or not is_held(evidence.scene):
        return None
    return _growth_finding(evidence, change_by_warm_ring(evidence.scene, WARMER)) | {
        "kelvin": WARMER
    }


def _growth_finding(evidence: Evidence, change: float) -> Finding:
    """Returns the finding of a neglected growth: the change of the preload in percent and [N].

    change: relative change of the preload [1].
    """
    # each bearing of a pair is evaluated alone
    preload_words = "fixed position" if evidence.chosen.scene.pair is None else "rigid pair"
    newtons = change * evidence.scene.operation.preload_N
    excess = abs(change) / MOST_LEFT_OUT
    return {"value": 100.0 * change, "newtons": newtons, "excess": excess, "held": preload_words}


def thermal_margin_low(evidence: Evidence) -> Finding | None:
    """Returns the finding of the thermal margin; its excess is above 1 where that is low.

    None where the margin is unknown.
    """
    margin = evidence.state.values.get("thermal_margin")
    if margin is None:
        return None
    return {"value": float(margin), "excess": LOW_MARGIN / max(float(margin), _NO_MARGIN)}


def fit_lost(evidence: Evidence) -> Finding | None:
    """Returns the finding of seats that are tight at rest and loose at speed; None without any."""
    if evidence.scene.fits is None:
        return None
    growth = growth_of(evidence.scene)
    seats = {"shaft": growth.inner.seat_lost, "housing": growth.outer.seat_lost}
    names = " and ".join(seat for seat, is_lost in seats.items() if is_lost)
    return {"seats": names} if names else None
