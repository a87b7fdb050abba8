"""End-of-life criteria in words: value, limit, and what to do about it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.scene import Scene
from bearingwear.sides import SHARED


@dataclass(frozen=True)
class Criterion:
    """A criterion in words.

    Attributes
    ----------
    words : str
    value : callable
        Its value, in the unit of its limit, at a step of the histories of a life.
    advice : str
        What keeps a bearing from meeting it.
    unit : str
        As shown, with the space before it.
    falls : bool
        Whether it is met from above.
    """

    words: str
    value: Callable[[Mapping[str, Any], int, Scene], float]
    advice: str
    unit: str = " %"
    falls: bool = False

    def number(self, value: float) -> str:
        """A value or limit with its unit."""
        return f"{100.0 * value if self.unit == ' %' else value:.3g}{self.unit}"

    def said(self, value: float) -> str:
        """The criterion at a value."""
        return f"{self.words} {self.number(value)}"


def _step(life: Mapping[str, Any], name: str, k: int, scene: Scene) -> np.ndarray:
    """Values of a history at a step, of both bearings where there are two."""
    history = np.asarray(life[f"history_{name}"])
    of_each = scene.pair is not None and f"history_{name}" not in SHARED
    return history[:, k] if of_each else history[k]


def _at(name: str, factor: float = 1.0) -> Callable[[Mapping[str, Any], int, Scene], float]:
    return lambda life, k, scene: factor * float(np.max(np.abs(_step(life, name, k, scene))))


def _kept(life: Mapping[str, Any], k: int, scene: Scene) -> float:
    """Residual preload over the initial one, of the bearing that has least."""
    initial = [side.operation.preload_N for side in scene.sides]
    return float(np.min(_step(life, "residual_preload", k, scene) / initial))


IN_WORDS = {
    "preload_fraction": Criterion(
        "residual preload",
        lambda life, k, s: _kept(life, k, s),
        "more preload, lower speed, or a spring",
        falls=True,
    ),
    "gyroscopic_slip_share": Criterion(
        "gyroscopic slip share",
        _at("gyroscopic_slip_share"),
        "lower speed, more preload or ceramic balls",
    ),
    "skid_ratio": Criterion(
        "skid ratio", _at("skid_ratio"), "more preload, lower speed or less lubricant drag"
    ),
    "ball_diameter_loss_um": Criterion(
        "interference loss",
        _at("ball_diameter_loss", 1e6),
        "start from less wear, or raise the limit",
        " um",
    ),
    "pocket_clearance_mm": Criterion(
        "pocket clearance",
        _at("pocket_clearance", 1e3),
        "start with less clearance, or raise the limit",
        " mm",
    ),
    "guide_clearance_mm": Criterion(
        "guide clearance",
        _at("guide_clearance", 1e3),
        "start with less clearance, or raise the limit",
        " mm",
    ),
    "rotor_shift_um": Criterion(
        "shift of the rotor",
        _at("rotor_axial_shift", 1e6),
        "two bearings that wear alike, or raise the limit",
        " um",
    ),
    "system_axial_stiffness_N_um": Criterion(
        "axial stiffness of the arrangement",
        _at("system_axial_stiffness", 1e-6),
        "more preload, or a rigid pair",
        " N/um",
        falls=True,
    ),
    "friction_used_by_gyroscopic_moment": Criterion(
        "friction used by the gyroscopic moment",
        _at("friction_used_by_gyroscopic_moment"),
        "lower speed, more preload or ceramic balls",
    ),
    "film_worn_share": Criterion(
        "share of a track without film", _at("film_worn_share"), "a thicker film, or less load"
    ),
    "maximum_pressure_GPa": Criterion(
        "contact pressure", _at("maximum_pressure", 1e-9), "less preload, or closer grooves", " GPa"
    ),
    "groove_depth_um": Criterion(
        "depth of a groove",
        _at("greatest_depth", 1e6),
        "less preload, lower speed, or raise the limit",
        " um",
    ),
}


def criterion_met(scene: Scene, values: Mapping[str, Any]) -> tuple[Criterion, float] | None:
    """The criterion that ends a life, and its limit; None if none does."""
    name, end = CRITERIA[int(values["end_criterion"])], scene.wear.end_of_life
    if end is None or name not in IN_WORDS or "history_ball_diameter_loss" not in values:
        return None
    return IN_WORDS[name], end.criteria[name]


def end_attribute(scene: Scene, values: Mapping[str, Any]) -> dict[str, str]:
    """Attribute of a life that says which criterion ended it, at what value and limit."""
    met = criterion_met(scene, values)
    if met is None:
        return {}
    criterion, limit = met
    said = criterion.said(criterion.value(values, -1, scene))
    return {"ended_by": f"{said}, limit {criterion.number(limit)}"}
