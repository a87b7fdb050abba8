"""Values of a result that its warnings look at."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from bearingwear.model.fidelity import Choice
from bearingwear.model.growth import part_temperatures
from bearingwear.model.stability import GROWTHS
from bearingwear.scene.scene import Scene

INNER_SIDE, OUTER_SIDE = 0, 1


def _none() -> np.ndarray:
    return np.full((1, 2), math.nan)


@dataclass(frozen=True)
class Evidence:
    """Values that warnings look at; NaN and empty where the case was not solved."""

    scene: Scene
    chosen: Choice
    pressure: float = math.nan  # the largest [Pa]
    angle: np.ndarray = field(default_factory=_none)  # (n, 2) [rad]
    major: np.ndarray = field(default_factory=_none)  # (n, 2) semi-major axes [m]
    load: np.ndarray = field(default_factory=_none)  # (n, 2) [N]
    slip: float = math.nan  # mean by load [m/s]
    torque_error: float = math.nan  # estimated, of the friction torque
    lifted: float = 0.0  # share of time that any ball is off the inner race
    loss: float = math.nan  # of ball diameter [m]
    preload: float = math.nan  # as it runs [N]
    warmth: np.ndarray = field(default_factory=lambda: np.full(5, math.nan))  # of the parts [degC]
    life: Mapping[str, Any] | None = None  # values of a life
    case: Mapping[str, Any] | None = None  # values of a case
    growth: Mapping[str, float] = field(default_factory=dict)  # see `GrowthRates.values`


def evidence_of(scene: Scene, chosen: Choice, values: Mapping[str, Any]) -> Iterator[Evidence]:
    """A case, or the first and the last state of a life."""
    history = "end_criterion" in values
    prefix = "history_" if history else ""
    warmth = np.atleast_2d(values.get(prefix + "part_temperature", part_temperatures(scene)))
    names = {"pressure": "maximum_pressure", "angle": "contact_angle", "major": "semi_major_axis"}
    names |= {"load": "contact_load", "loss": "ball_diameter_loss"}
    solved = {key: np.asarray(values.get(prefix + name, ())) for key, name in names.items()}
    if not all(found.size for found in solved.values()):
        yield Evidence(scene, chosen, warmth=warmth[-1])
        return
    running = np.atleast_1d(values.get(prefix + "residual_preload", math.nan))
    growth = {name: values[prefix + name] for name in GROWTHS if prefix + name in values}
    for k in (0, -1) if history else (...,):
        state = {key: np.atleast_2d(solved[key][k]) for key in ("angle", "major", "load")}
        qv = np.atleast_2d(values.get(f"{prefix}qv", np.full((1, 2), math.nan))[k])
        if "maximum_contact_load" in values:
            with np.errstate(invalid="ignore", divide="ignore"):
                peak = np.cbrt(np.asarray(values["maximum_contact_load"]) / state["load"])
            state["major"] = state["major"] * np.where(np.isfinite(peak), peak, 1.0)
        yield Evidence(
            scene,
            chosen,
            pressure=float(np.max(solved["pressure"][k])),
            lifted=float(np.max(values.get("unloaded_share", state["load"] == 0.0)[:, INNER_SIDE])),
            loss=float(np.mean(solved["loss"][k])),
            preload=float(np.mean(running[k])),
            warmth=warmth[k if history else -1],
            slip=float(qv.sum() / state["load"].sum()) if state["load"].any() else math.nan,
            torque_error=float(values.get("shaft_torque_error_estimate", math.nan)),
            life=values if history else None,
            case=None if history else values,
            growth={name: float(np.asarray(found)[k]) for name, found in growth.items()},
            **state,
        )
