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
from bearingwear.solvers.warmup.transient import WarmUp, network_at, ramp, warm_up

LATER_POINTS = 2  # more points of the time at speed than of the ramp
_LATER = 3  # power of the time at speed in which its points are spread: most are early


class WarmStart(NamedTuple):
    """One start from the mounting temperature: scenes on the way, and times they stand for [s]."""

    scenes: Sequence[Scene]
    weights: np.ndarray
    warming_s: float  # from the end of the ramp to the steady state


@functools.lru_cache(maxsize=32)
def _warmed(scene: Scene, start_s: float) -> WarmUp:
    found = warm_up(scene, ramp(start_s))
    if found.status != code.OK:
        end, ending = found.instants[-1].time, "runaway" if found.runs_away else "no state"
        raise NotAvailable(
            f"{scene.name}: duty.warmup: got a start without a steady state ({ending} after "
            f"{end:.3g} s: {code.STATUS_NAMES[found.status]}), expected starts that warm up"
        )
    return found


def warm_start(scene: Scene, start_s: float, longest_s: float, points: int) -> WarmStart:
    """A start of a scene, by so many points of its ramp and a few more until it is warm.

    longest_s: time at speed after which the bearings stop, warm or not. Temperatures are those of
    the bearings as the scene describes them. Points are Gauss and Legendre's.
    """
    found = _warmed(scene, start_s)
    times = np.array([one.time for one in found.instants])
    course = PchipInterpolator(times, [one.temperatures for one in found.instants])
    warming_s = min(float(times[-1]) - start_s, longest_s)
    x, w = np.polynomial.legendre.leggauss(points)
    at, weights = 0.5 * start_s * (x + 1.0), 0.5 * start_s * w
    x, w = np.polynomial.legendre.leggauss(points + LATER_POINTS)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    at = np.append(at, start_s + warming_s * x**_LATER)
    weights = np.append(weights, warming_s * w * _LATER * x ** (_LATER - 1))
    some = weights > 0.0
    shares = ramp(start_s)
    scenes = [_at(scene, shares.at(t), t, course(t)) for t in at[some].tolist()]
    return WarmStart(scenes, weights[some], warming_s)


def _at(scene: Scene, share: float, time: float, temperatures: np.ndarray) -> Scene:
    """The scene at a share of its speed and temperatures (bearing, part) [degC] of an instant."""
    sides = scene.one_of_alike.sides
    parts = []
    for side, T in zip(sides, temperatures.tolist(), strict=True):
        assert side.thermal is not None
        parts.append(vars(network_at(side.thermal, time).parts(*T)))
    changes: dict[str, Any] = {"thermal": None, "temperature": parts[0]}
    if len(parts) > 1 and scene.arrangement is not None:
        kept = {k: v for k, v in scene.arrangement.second.items() if not k.startswith("thermal")}
        second = {f"temperature.{key}": value for key, value in parts[1].items()}
        changes["arrangement.second"] = kept | second
    return at_speed(scene, share).with_(changes)
