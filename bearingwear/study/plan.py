"""What a run of the study makes: every file, from config.yaml.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from bearingwear.study.grid import Case, Grid, grids


@dataclass(frozen=True)
class Spread:
    """A figure that lays scenes over each other at one friction coefficient."""

    scenes: tuple[str, ...]
    friction: float


@dataclass(frozen=True)
class Plan:
    """The grids of a study and the figures made from them.

    Attributes
    ----------
    grids : dict
        Grid of each scene.
    worn_loss_um : float
        The worn state of the figures against friction and of slip [um].
    figure_friction : tuple of float
        Coefficients compared in the figures of slip, wear and life [1].
    column_scenes, column_frictions : tuple
        Columns of the figure of wear across scenes; empty: no such figure.
    spreads : dict
        Figures of spread by their name.
    """

    grids: dict[str, Grid]
    worn_loss_um: float
    figure_friction: tuple[float, ...]
    column_scenes: tuple[str, ...]
    column_frictions: tuple[float, ...]
    spreads: dict[str, Spread]

    @classmethod
    def from_config(cls, config: Mapping) -> "Plan":
        """The plan of a config.yaml that fits its schema.

        Raises
        ------
        ValueError
            One line; also where a figure wants a scene or a coefficient that is not studied.
        """
        figures = config["figures"]
        columns = figures.get("wear_columns", [])
        return cls(
            grids=grids(config["studies"]),
            worn_loss_um=float(figures["worn_loss_um"]),
            figure_friction=tuple(sorted(float(mu) for mu in figures["friction"])),
            column_scenes=tuple(column["scene"] for column in columns),
            column_frictions=tuple(float(column["friction"]) for column in columns),
            spreads={
                name: Spread(tuple(spread["scenes"]), float(spread["friction"]))
                for name, spread in figures.get("spreads", {}).items()
            },
        )

    def __post_init__(self) -> None:
        for scene, mu in zip(self.column_scenes, self.column_frictions, strict=True):
            self._check_studied("wear_columns", scene, mu)
        for name, spread in self.spreads.items():
            for scene in spread.scenes:
                self._check_studied(f"spreads.{name}", scene, spread.friction)

    def _check_studied(self, key: str, scene: str, mu: float) -> None:
        if scene not in self.grids:
            allowed = ", ".join(self.grids)
            raise ValueError(f"config: figures.{key}: given scene {scene}; allowed {allowed}")
        if mu not in self.grids[scene].friction:
            allowed = ", ".join(f"{value:g}" for value in self.grids[scene].friction)
            raise ValueError(
                f"config: figures.{key}: given {scene}, friction {mu:g}; allowed {allowed}"
            )

    @property
    def losses(self) -> dict[str, float]:
        """State of wear of the figures against friction [um]."""
        return {"fig07_fresh": 0.0, "fig08_worn": self.worn_loss_um}

    def scene_files(self) -> list[str]:
        """Every scene that is studied."""
        return [f"config/scenes/{scene}.yaml" for scene in self.grids]

    def frictions(self, scene: str) -> list[float]:
        """Coefficients that the figures of one scene compare."""
        grid = self.grids[scene]
        return [mu for mu in self.figure_friction if mu in grid.friction] or [grid.friction[0]]

    def cases(self, *scenes: str) -> list[str]:
        """Case files of the given scenes, or of all."""
        return [
            _case_file(scene, case)
            for scene in scenes or self.grids
            for case in self.grids[scene].cases().values()
        ]

    def slip_cases(self, scene: str) -> list[str]:
        """Case files behind the figure of slip."""
        return [
            _case_file(scene, case)
            for case in self.grids[scene].cases().values()
            if case.friction in self.frictions(scene)
            and case.ball_diameter_loss_um == self.worn_loss_um
        ]

    def studies(self, *scenes: str) -> list[str]:
        """Study files of the given scenes, or of all."""
        return [f"results/{scene}/study.nc" for scene in scenes or self.grids]

    def lives(self) -> list[str]:
        """Files of wear life."""
        return [f"results/{scene}/wear_life.nc" for scene in self.grids]

    def tables(self) -> list[str]:
        """Tables and summaries of the scenes."""
        names = ("cases.csv", "summary.md")
        return [f"results/{scene}/tables/{name}" for scene in self.grids for name in names]

    def figures(self) -> list[str]:
        """Every figure, as SVG and PNG."""
        names = [
            f"{scene}/figures/{name}" for scene in self.grids for name in self._scene_figures(scene)
        ]
        names += ["figures/fig10_wear"] if self.column_scenes else []
        names += [f"figures/spread_{name}" for name in self.spreads]
        return [f"results/{name}.{suffix}" for name in names for suffix in ("svg", "png")]

    def _scene_figures(self, scene: str) -> list[str]:
        grid = self.grids[scene]
        names = ["fig10_wear", "wear_life"]
        if len(grid.friction) > 1:
            names += [
                name for name, loss in self.losses.items() if loss in grid.ball_diameter_loss_um
            ]
        if self.slip_cases(scene):
            names += ["fig09_slip"]
        return sorted(names)


def _case_file(scene: str, case: Case) -> str:
    return f"results/{scene}/cases/{case.id}.nc"
