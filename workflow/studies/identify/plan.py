"""The bearings that the study tries: config/identify.yaml, checked.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from bearingwear.scene.errors import SceneError
from bearingwear.scene.records import Key
from bearingwear.studies.axis import RisingAxis, check_rising


@dataclass(frozen=True, kw_only=True)
class Statements:
    """What a text states about a bearing; all at fixed position."""

    preload_loss: Annotated[float, Key("Share of the initial preload that wear takes", above=0)]
    preload_loss_at_um: Annotated[float, Key("At this loss of ball diameter", "um", above=0)]
    high_friction: Annotated[float, Key("High friction coefficient", above=0)]
    low_friction: Annotated[float, Key("Low friction coefficient", above=0)]
    qv_least_um: Annotated[
        tuple[float, float],
        Key("QV is least between these losses, at the low friction", "um", above=0),
    ]
    qv_rise: Annotated[float, Key("Share by which QV then rises at least", above=0)]
    qv_rise_at_um: Annotated[float, Key("At this loss of ball diameter", "um", above=0)]

    def __post_init__(self) -> None:
        try:
            check_rising(self.qv_least_um)
        except ValueError as error:
            raise SceneError("qv_least_um", str(error)) from None


@dataclass(frozen=True, kw_only=True)
class IdentifyPlan:
    """Everything in config/identify.yaml."""

    scene: Annotated[str, Key("Scene that has all that is not varied")]
    marks: Annotated[tuple[str, ...], Key("Scenes that are drawn as well")]
    pitch_diameter_mm: Annotated[RisingAxis, Key("Pitch diameters", "mm")]
    ball_count: Annotated[tuple[int, ...], Key("Numbers of balls", minimum=1, least=1)]
    inner_groove_factor: Annotated[RisingAxis, Key("Inner groove radii over ball diameter", "1")]
    contact_angle_deg: Annotated[RisingAxis, Key("Steps of the search for the angle", "degree")]
    drag_density_kg_m3: Annotated[RisingAxis, Key("Drag densities that are tried", "kg/m3")]
    statements: Annotated[Statements, Key("What the text states")]

    def __post_init__(self) -> None:
        try:
            check_rising(self.ball_count)
        except ValueError as error:
            raise SceneError("ball_count", str(error)) from None

    def check_scenes(self, folder: str | Path = "config/scenes") -> None:
        """Check that every scene exists.

        Raises
        ------
        ValueError
            One line.
        """
        for name in (self.scene, *self.marks):
            if not (Path(folder) / f"{name}.yaml").is_file():
                raise ValueError(f"config/identify.yaml: there is no scene {name}")
