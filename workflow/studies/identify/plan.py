"""The bearings that the study tries: config/identify.yaml, checked.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from pathlib import Path

from bearingwear.scene.checking.records import keyed, setting
from bearingwear.studies.axis import RisingAxis, check_rising


@keyed
class Statements:
    """What a text states about a bearing; all at fixed position."""

    preload_loss: float = setting("Share of the initial preload removed by wear", within="(0, inf)")
    preload_loss_at_um: float = setting(
        "Loss of ball diameter at which preload_loss applies", "um", "(0, inf)"
    )
    high_friction: float = setting("High friction coefficient", within="(0, inf)")
    low_friction: float = setting("Low friction coefficient", within="(0, inf)")
    qv_least_um: tuple[float, float] = setting(
        "Losses between which QV has its minimum at low friction", "um", "(0, inf)"
    )
    qv_rise: float = setting("Minimum relative increase in QV after the minimum", within="(0, inf)")
    qv_rise_at_um: float = setting(
        "Loss of ball diameter at which qv_rise applies", "um", "(0, inf)"
    )

    def __post_init__(self) -> None:
        check_rising("qv_least_um", self.qv_least_um)


@keyed
class IdentifyPlan:
    """Everything in config/identify.yaml."""

    scene: str = setting("Scene that provides all values that are not varied")
    marks: tuple[str, ...] = setting("Scenes that are also plotted")
    pitch_diameter_mm: RisingAxis = setting("Pitch diameters", "mm")
    ball_count: tuple[int, ...] = setting("Numbers of balls", within="[1, inf)", least=1)
    inner_groove_factor: RisingAxis = setting("Ratios of inner groove radius to ball diameter", "1")
    contact_angle_deg: RisingAxis = setting("Contact angles at which the search starts", "degree")
    drag_density_kg_m3: RisingAxis = setting("Drag densities to try", "kg/m3")
    statements: Statements = setting("Statements in the text")

    def __post_init__(self) -> None:
        check_rising("ball_count", self.ball_count)

    def check_scenes(self, folder: str | Path = "config/scenes") -> None:
        """Refuse scenes that do not exist."""
        for name in (self.scene, *self.marks):
            if not (Path(folder) / f"{name}.yaml").is_file():
                raise ValueError(
                    f"config/identify.yaml: got the scene {name}, which does not exist"
                )
