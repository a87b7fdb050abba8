"""What a run of the study makes: every file, from config.yaml.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import yaml

from bearingwear.io.config import for_life, load_scene
from bearingwear.study.design_plan import SAMPLES, Sampling
from bearingwear.study.grid import Case, Grid, grids

PAGE = "results/report/index.html"


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
    dynamic : dict
        Grid of each scene that is solved in time.
    overrides : dict
        For each of these, keys of the scene's block `model` and what they are set to.
    worn_loss_um : float
        The worn state of the figures against friction and of slip [um].
    figure_friction : tuple of float
        Coefficients compared in the figures of slip, wear and life [1].
    column_scenes, column_frictions : tuple
        Columns of the figure of wear across scenes; empty: no such figure.
    spreads : dict
        Figures of spread by their name.
    uncertain_lives : tuple of str
        Scenes whose lives are quoted with the spread that their block `uncertainty` gives them.
    sampling : Sampling
        How their values are sampled.
    lives_in_time : dict
        For each life that is followed in time, its scene and what is changed in it.
    running_averages : dict
        For each scene of `dynamic` with figures of running averages, the name of its file
        config/reference/NAME.csv, or None.
    """

    grids: dict[str, Grid]
    dynamic: dict[str, Grid]
    overrides: dict[str, Mapping]
    worn_loss_um: float
    figure_friction: tuple[float, ...]
    column_scenes: tuple[str, ...]
    column_frictions: tuple[float, ...]
    spreads: dict[str, Spread]
    running_averages: dict[str, str | None]
    uncertain_lives: tuple[str, ...]
    sampling: Sampling
    lives_in_time: dict[str, tuple[str, tuple[str, ...]]]

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
        dynamic = config.get("dynamic", [])
        uncertain = config.get("uncertain_lives", {})
        return cls(
            grids=grids(config["studies"]),
            dynamic=grids(dynamic, "dynamic"),
            overrides={
                scene: block.get("model", {}) for block in dynamic for scene in block["scenes"]
            },
            worn_loss_um=float(figures["worn_loss_um"]),
            figure_friction=tuple(sorted(float(mu) for mu in figures["friction"])),
            column_scenes=tuple(column["scene"] for column in columns),
            column_frictions=tuple(float(column["friction"]) for column in columns),
            spreads={
                name: Spread(tuple(spread["scenes"]), float(spread["friction"]))
                for name, spread in figures.get("spreads", {}).items()
            },
            running_averages={
                scene: (given or {}).get("reference")
                for scene, given in figures.get("running_averages", {}).items()
            },
            uncertain_lives=tuple(uncertain.get("scenes", [])),
            sampling=Sampling(uncertain.get("samples", SAMPLES), 1, uncertain.get("seed", 1)),
            lives_in_time={
                name: (life["scene"], _settings(life.get("set", {})))
                for name, life in config.get("lives_in_time", {}).items()
            },
        )

    def __post_init__(self) -> None:
        for scene, mu in zip(self.column_scenes, self.column_frictions, strict=True):
            self._check_studied("wear_columns", scene, mu)
        for name, spread in self.spreads.items():
            for scene in spread.scenes:
                self._check_studied(f"spreads.{name}", scene, spread.friction)
        for scene in self.uncertain_lives:
            if scene not in self.grids:
                allowed = ", ".join(self.grids)
                raise ValueError(
                    f"config: uncertain_lives.scenes: given {scene}; allowed {allowed}"
                )
        for scene in self.running_averages:
            if scene not in self.dynamic:
                allowed = ", ".join(self.dynamic) or "none, since dynamic is empty"
                raise ValueError(
                    f"config: figures.running_averages: given scene {scene}; allowed {allowed}"
                )
        for scene in self.compared:
            # a case in time without its steady twin could not be set beside it
            for case_id in self.dynamic[scene].cases():
                if case_id not in self.grids[scene].cases():
                    raise ValueError(
                        f"config: dynamic: given {scene}, {case_id}; "
                        "allowed cases of the same scene under studies"
                    )

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

    @property
    def compared(self) -> list[str]:
        """Scenes that are solved both ways."""
        return [scene for scene in self.dynamic if scene in self.grids]

    def check_scenes(self) -> None:
        """Read every scene as it stands and as each of its cases changes it.

        Raises
        ------
        ValueError
            One line: the first thing that is wrong with a scene or with a value of its grid.
        """
        for scene, grid in self.grids.items():
            path = _scene_file(scene)
            for_life(load_scene(path), path)
            for case in grid.cases().values():
                _check_case(scene, case, case.settings)
        for scene, grid in self.dynamic.items():
            load_scene(_scene_file(scene))
            for case in grid.cases().values():
                _check_case(scene, case, self.dynamic_settings(scene, case))
        for scene in self.uncertain_lives:
            if not load_scene(_scene_file(scene)).uncertainty:
                raise ValueError(
                    f"config: uncertain_lives.scenes: given {scene}, whose file has no "
                    "uncertainty; allowed scenes that have"
                )
        for name, (scene, settings) in self.lives_in_time.items():
            try:
                for_life(load_scene(_scene_file(scene), settings))
            except ValueError as error:
                what = str(error).removeprefix("--set ")
                raise ValueError(f"config: lives_in_time.{name}: {what}") from None

    def dynamic_settings(self, scene: str, case: Case) -> tuple[str, ...]:
        """What `bearingwear solve --set` is given to solve a case in time."""
        given = {f"model.{key}": value for key, value in self.overrides[scene].items()}
        return (*case.settings, *_settings(given))

    def reference(self, scene: str) -> list[str]:
        """The file of values that a scene's running averages are drawn with, if any."""
        name = self.running_averages.get(scene)
        return [f"config/reference/{name}.csv"] if name else []

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

    def dynamic_cases(self, *scenes: str) -> list[str]:
        """Files of the cases solved in time, of the given scenes or of all."""
        return [
            f"results/{scene}/dynamic/{case_id}.nc"
            for scene in scenes or self.dynamic
            for case_id in self.dynamic[scene].cases()
        ]

    def dynamics(self) -> list[str]:
        """Files that hold all cases of a scene solved in time."""
        return [f"results/{scene}/dynamic.nc" for scene in self.dynamic]

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

    def spreads_of_lives(self, *scenes: str) -> list[str]:
        """Files of how lives spread, of those of the given scenes that have one, or of all."""
        return [
            f"results/{scene}/spread/mu{mu:.3f}.nc"
            for scene in self.uncertain_lives
            if scene in (scenes or self.uncertain_lives)
            for mu in self.grids[scene].friction
        ]

    def tables(self) -> list[str]:
        """Tables and summaries of the scenes."""
        names = [f"{scene}/tables/{n}" for scene in self.grids for n in ("cases.csv", "summary.md")]
        names += [
            f"{scene}/tables/{n}" for scene in self.compared for n in ("dynamic.csv", "dynamic.md")
        ]
        return [f"results/{name}" for name in names]

    def figures(self) -> list[str]:
        """Every figure, as SVG and PNG."""
        names = [
            f"{scene}/figures/{name}" for scene in self.grids for name in self._scene_figures(scene)
        ]
        names += [f"{scene}/figures/dynamic" for scene in self.compared]
        names += [
            f"{scene}/figures/fig06_running_average-{case_id}"
            for scene in self.running_averages
            for case_id in self.dynamic[scene].cases()
        ]
        names += ["figures/fig10_wear"] if self.column_scenes else []
        names += [f"figures/spread_{name}" for name in self.spreads]
        return [f"results/{name}.{suffix}" for name in names for suffix in ("svg", "png")]

    def inputs(self) -> list[str]:
        """Files the cases and figures are made from, besides the program."""
        scenes = [_scene_file(scene) for scene in dict.fromkeys([*self.grids, *self.dynamic])]
        return [*scenes, *(path for scene in self.dynamic for path in self.reference(scene))]

    def results(self) -> list[str]:
        """Every file of the study."""
        parts = (self.cases, self.dynamic_cases, self.studies, self.dynamics, self.lives)
        named = [path for part in parts for path in part()]
        return [
            *named,
            *self.spreads_of_lives(),
            *self.tables(),
            *self.figures(),
            PAGE,
            "results/verdict.txt",
        ]

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


def _settings(given: Mapping) -> tuple[str, ...]:
    """What `--set` is given; as YAML, since Python's 1e-05 would be read as a text."""
    texts = {
        key: yaml.safe_dump(value, default_flow_style=True, width=math.inf)
        for key, value in given.items()
    }
    return tuple(f"{key}={text.splitlines()[0]}" for key, text in texts.items())


def _scene_file(scene: str) -> str:
    return f"config/scenes/{scene}.yaml"


def _check_case(scene: str, case: Case, settings: Sequence[str]) -> None:
    """Read a scene as a case changes it."""
    try:
        load_scene(_scene_file(scene), settings)
    except ValueError as error:
        what = str(error).removeprefix("--set ")
        raise ValueError(f"config: {scene}, {case.id}: {what}") from None


def _case_file(scene: str, case: Case) -> str:
    return f"results/{scene}/cases/{case.id}.nc"
