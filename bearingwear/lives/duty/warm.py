"""Starts from the mounting temperature: the speeds and temperatures on the way to a steady state.

theory.md section 27.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

from bearingwear.kernels import status as code
from bearingwear.lives.duty.cycle import at_speed
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.scene.scene import Scene
from bearingwear.solvers.warmup.transient import NoState, WarmUp, network_at, ramp, warm_up

LATER_POINTS = 2  # number of points of the time at speed, less that of the ramp
_EARLY_POWER = 3  # exponent of the share of the time at speed, so that most points are early


class WarmStart(NamedTuple):
    """One start from the mounting temperature: scenes on the way, and times they stand for [s]."""

    scenes: Sequence[Scene]
    weights: np.ndarray  # time that each scene stands for (scenes,) [s]
    warming_s: float  # from the end of the ramp to the steady state, or to the stop


@functools.lru_cache(maxsize=32)
def _steady_warm_up(scene: Scene, start_s: float) -> WarmUp:
    """Returns the warm-up of a start; raises NotAvailable where it does not become steady.

    start_s: time from rest to the full speed [s].
    """
    try:
        warmup = warm_up(scene, ramp(start_s))
    except NoState as unsolved:
        raise NotAvailable(
            f"{scene.name}: duty.warmup: got bearings without a state as mounted "
            f"({code.STATUS_NAMES[unsolved.status]}), expected starts that warm up"
        ) from None
    if warmup.status != code.OK:
        end = warmup.instants[-1].time
        ending = "runaway" if warmup.runs_away else "no state"
        raise NotAvailable(
            f"{scene.name}: duty.warmup: got a start without a steady state ({ending} after "
            f"{end:.3g} s: {code.STATUS_NAMES[warmup.status]}), expected starts that warm up"
        )
    return warmup


def warm_start(scene: Scene, start_s: float, longest_s: float, points: int) -> WarmStart:
    """Returns a start of a scene from its mounting temperature.

    Temperatures are those of the bearings with the wear that the scene states, also later in a
    life. Raises NotAvailable where the start does not become steady.

    start_s: time from rest to the full speed [s].
    longest_s: time at speed after which the bearings stop, warm or not [s].
    points: number of Gauss and Legendre's points of the ramp; `LATER_POINTS` more are at speed.
    """
    instants = _steady_warm_up(scene, start_s).instants
    temperatures = PchipInterpolator(
        np.array([instant.time for instant in instants]),
        [instant.temperatures for instant in instants],
    )
    warming_s = min(float(instants[-1].time) - start_s, longest_s)
    x, w = np.polynomial.legendre.leggauss(points)
    ramp_times, ramp_weights = 0.5 * start_s * (x + 1.0), 0.5 * start_s * w
    x, w = np.polynomial.legendre.leggauss(points + LATER_POINTS)
    x, w = 0.5 * (x + 1.0), 0.5 * w  # on 0 to 1
    later_times = start_s + warming_s * x**_EARLY_POWER
    later_weights = warming_s * w * _EARLY_POWER * x ** (_EARLY_POWER - 1)
    times = np.append(ramp_times, later_times)
    weights = np.append(ramp_weights, later_weights)
    has_weight = weights > 0.0  # false for a ramp of no time, or a stop at its end
    speed = ramp(start_s)
    scenes = [
        _scene_at(scene, speed.at(time), time, temperatures(time))
        for time in times[has_weight].tolist()
    ]
    return WarmStart(scenes=scenes, weights=weights[has_weight], warming_s=warming_s)


def _scene_at(scene: Scene, share: float, time: float, temperatures: np.ndarray) -> Scene:
    """Returns the scene at an instant, with given temperatures in place of its thermal network.

    share: of the full speed.
    time: since the start [s].
    temperatures: of the nodes of the network (bearings, nodes) [degC], of one bearing or of two.
    """
    sides = scene.symmetric_half.sides
    parts = []
    for side, T in zip(sides, temperatures.tolist(), strict=True):
        assert side.thermal is not None
        parts.append(vars(network_at(side.thermal, time).parts(*T)))
    changes: dict[str, Any] = {"thermal": None, "temperature": parts[0]}
    if len(parts) > 1 and scene.arrangement is not None:
        second = {
            key: value
            for key, value in scene.arrangement.second.items()
            if not key.startswith("thermal")
        }
        second |= {f"temperature.{key}": value for key, value in parts[1].items()}
        changes["arrangement.second"] = second
    return at_speed(scene, share).with_(changes)
