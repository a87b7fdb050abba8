"""The keys of config/config.yaml: what each means and takes.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from bearingwear.scene.records import NAME, Key
from bearingwear.scene.scene import PRELOAD_METHODS

SceneName = Annotated[str, Key("Name of a file config/scenes/NAME.yaml", pattern=NAME)]
SceneNames = Annotated[
    tuple[str, ...],
    Key("Names of files config/scenes/NAME.yaml", pattern=NAME, least=1, allowed="scene names"),
]
Frictions = Annotated[
    tuple[float, ...],
    Key("Ball/race friction coefficients, at most three decimals", minimum=0.0, least=1),
]


UNSOLVED = ("error", "warning")


@dataclass(frozen=True, kw_only=True)
class GridBlock:
    """Scenes that share a grid."""

    scenes: SceneNames
    preload_method: Annotated[
        tuple[str, ...], Key("How the preload is applied", choices=PRELOAD_METHODS, least=1)
    ]
    friction: Frictions
    ball_diameter_loss_um: Annotated[
        tuple[float, ...],
        Key("States of wear, at most two decimals", unit="um", minimum=0.0, least=1),
    ]


@dataclass(frozen=True, kw_only=True)
class DynamicBlock(GridBlock):
    """Scenes that are solved dynamically, with their cage, over a grid of their own."""

    model: Annotated[
        Mapping[str, Any], Key("Keys of the scene's block model, set for these runs")
    ] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class UncertainLives:
    """Scenes whose lives are quoted with the spread that their block `uncertainty` gives them."""

    scenes: SceneNames = ()
    samples: Annotated[
        int,
        Key(
            "Half of the lives that are sampled for each method and friction, a power of two",
            minimum=16,
            maximum=4096,
        ),
    ] = 256
    seed: Annotated[int, Key("Of the sample", minimum=0)] = 1

    def __post_init__(self) -> None:
        if self.samples & (self.samples - 1):
            raise ValueError(f"samples: got {self.samples}, expected a power of two")


@dataclass(frozen=True, kw_only=True)
class Column:
    """A column of the figure of wear across scenes."""

    scene: SceneName
    friction: Annotated[float, Key("Ball/race friction coefficient", minimum=0.0)]


@dataclass(frozen=True, kw_only=True)
class Overlay:
    """A figure that lays several scenes over each other."""

    scenes: SceneNames
    friction: Annotated[float, Key("Ball/race friction coefficient", minimum=0.0)]


@dataclass(frozen=True, kw_only=True)
class RunningAverage:
    """Figures of the mean wear rates since the start."""

    reference: Annotated[
        str | None,
        Key("Name of a file config/reference/NAME.csv whose values are drawn too", pattern=NAME),
    ] = None


@dataclass(frozen=True, kw_only=True)
class Figures:
    """What the figures compare."""

    worn_loss_um: Annotated[
        float, Key("The worn state in the figures against friction and of slip", unit="um")
    ]
    friction: Annotated[
        tuple[float, ...],
        Key(
            "The coefficients compared in the figures of slip, wear and life; those a grid lacks "
            "are left out",
            minimum=0.0,
            least=1,
        ),
    ]
    wear_columns: Annotated[
        tuple[Column, ...],
        Key("One more figure of QV, preload, angles and wear rate, columns of different scenes"),
    ] = ()
    spreads: Annotated[
        Mapping[str, Overlay], Key("Figures that lay several scenes over each other")
    ] = field(default_factory=dict)
    lives: Annotated[
        Mapping[str, Overlay], Key("Figures that lay the lives of several scenes over each other")
    ] = field(default_factory=dict)
    running_averages: Annotated[
        Mapping[str, RunningAverage | None],
        Key("Scenes of `dynamic` with figures of the mean wear rates since the start"),
    ] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Config:
    """config/config.yaml."""

    studies: Annotated[
        tuple[GridBlock, ...],
        Key("Groups of scenes that share a grid; none: the small maps of config/design.yaml alone"),
    ]
    dynamic: Annotated[
        tuple[DynamicBlock, ...], Key("Groups of scenes that are solved dynamically as well")
    ] = ()
    points_per_job: Annotated[
        int | None,
        Key(
            "Points of the grid that one job solves, each into a file of its own; above the points "
            "of a line (all losses of a scene, method and friction) it solves whole lines into one "
            "file. Null: a line, of at most 200",
            minimum=1,
        ),
    ] = None
    unsolved: Annotated[
        str,
        Key(
            "What a case or a life that could not be solved does to the study. Its page says so "
            "and shows the rest; then it ends with an error, or with a line on standard error",
            choices=UNSOLVED,
        ),
    ] = UNSOLVED[0]
    uncertain_lives: Annotated[
        UncertainLives, Key("Scenes whose lives are quoted with their spread")
    ] = UncertainLives()
    figures: Annotated[Figures, Key("What the figures compare")]
