"""The keys of config/config.yaml: what each means and takes.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bearingwear.scene.checking.records import NAME, keyed, setting
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.sampling import SAMPLES

_SCENES = "Names of scene files, config/scenes/NAME.yaml"
UNSOLVED = ("error", "warning")


@keyed
class GridBlock:
    """Scenes that share a grid."""

    scenes: tuple[str, ...] = setting(_SCENES, pattern=NAME, least=1, allowed="scene names")
    preload_method: tuple[str, ...] = setting("Preload method", choices=PRELOAD_METHODS, least=1)
    friction: tuple[float, ...] = setting(
        "Ball/race friction coefficients", "", "[0, inf)", least=1
    )
    ball_diameter_loss_um: tuple[float, ...] = setting(
        "Wear states", unit="um", within="[0, inf)", least=1
    )


@keyed
class DynamicBlock(GridBlock):
    """Scenes that are solved dynamically, with their cage, over a grid of their own."""

    model: Mapping[str, Any] = setting(
        "Keys to set in the scene's `model` block for these runs", default_factory=dict
    )


@keyed
class UncertainLives:
    """Scenes whose lives are quoted with the spread that their block `uncertainty` gives them."""

    # fmt: off
    scenes: tuple[str, ...] = setting(_SCENES, pattern=NAME, least=1, allowed="scene names",
        default=())
    samples: int = setting(
        "Half the number of lives sampled for each method and friction coefficient (a power of "
        "two)",
        within="[16, 4096]", default=SAMPLES)
    # fmt: on
    seed: int = setting("Random seed for the sample", within="[0, inf)", default=1)

    def __post_init__(self) -> None:
        if self.samples & (self.samples - 1):
            raise ValueError(f"samples: got {self.samples}, expected a power of two")


@keyed
class Column:
    """A column of the figure of wear across scenes."""

    scene: str = setting("Name of a scene file, config/scenes/NAME.yaml", pattern=NAME)
    friction: float = setting("Ball/race friction coefficient", within="[0, inf)")


@keyed
class Overlay:
    """A figure with several scenes overlaid."""

    scenes: tuple[str, ...] = setting(_SCENES, pattern=NAME, least=1, allowed="scene names")
    friction: float = setting("Ball/race friction coefficient", within="[0, inf)")


@keyed
class RunningAverage:
    """Figures of the mean wear rates since the start."""

    reference: str | None = setting(
        "Name of a reference file (config/reference/NAME.csv) whose values are also plotted",
        pattern=NAME,
        default=None,
    )


@keyed
class Figures:
    """Comparisons in the figures."""

    # fmt: off
    worn_loss_um: float | None = setting("Wear state shown in the friction and slip figures "
        "(null: the most worn state in the first grid)", unit="um", default=None)
    friction: tuple[float, ...] = setting("Friction coefficients to compare in the slip, wear "
        "and life figures, if the grid contains them (if omitted, all those in the grid)",
        within="[0, inf)", default=())
    wear_columns: tuple[Column, ...] = setting(
        "Columns of an additional figure of QV, preload, contact angles and wear rates; each "
        "column shows one scene",
        default=())
    spreads: Mapping[str, Overlay] = setting("Figures that overlay several scenes",
        default_factory=dict)
    lives: Mapping[str, Overlay] = setting("Figures that overlay the lives computed for several "
        "scenes",
        default_factory=dict)
    running_averages: Mapping[str, RunningAverage | None] = setting(
        "Scenes in `dynamic` for which the mean wear rates since the start are plotted",
        default_factory=dict)
    # fmt: on


@keyed
class Config:
    """config/config.yaml."""

    # fmt: off
    studies: tuple[GridBlock, ...] = setting(
        "Groups of scenes that share a grid (if empty, only the small maps in config/design.yaml "
        "are computed)")
    dynamic: tuple[DynamicBlock, ...] = setting(
        "Groups of scenes that are also solved dynamically", default=())
    points_per_job: int | None = setting("Number of grid points solved per job; each point "
        "has its own file. A job that solves more than one line (all losses for one scene, method "
        "and friction coefficient) writes whole lines to one file. Null means one line of at most "
        "200 points",
        within="[1, inf)",
        default=None)
    unsolved: str = setting("Effect of a failed case or life calculation: the study ends with "
        "an error, or only writes a warning to standard error (the page reports the failure in "
        "either case)",
        choices=UNSOLVED, default=UNSOLVED[0])
    uncertain_lives: UncertainLives = setting("Scenes for which the spread in life is reported",
        default=UncertainLives())
    # fmt: on
    figures: Figures = setting("Scope of the figures", default=Figures())
