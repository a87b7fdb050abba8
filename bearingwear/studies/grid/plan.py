"""What a run of the study makes: every file, from config.yaml.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

import difflib
import functools
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from bearingwear.provenance import text_hash
from bearingwear.results.pair_variables import BEARINGS
from bearingwear.scene.arrangement import Arrangement, one_bearing
from bearingwear.scene.checking.check import record
from bearingwear.scene.read import as_data, changed_scene, for_life, load_scene, scene_files
from bearingwear.studies.axis import in_name, place_of_errors
from bearingwear.studies.grid.config import Config
from bearingwear.studies.grid.grid import Case, Grid, Line, grids

MOST_FILES = 200
"""Files that one job writes at the most: their names are a command, which the shell limits."""


@dataclass(frozen=True)
class Plan:
    """Every file of the study."""

    config: Config

    @classmethod
    def from_config(cls, config: Mapping) -> "Plan":
        """The plan of a config.yaml."""
        return cls(record(Config, config, "config"))

    @functools.cached_property
    def grids(self) -> dict[str, Grid]:
        return grids(self.config.studies)

    @functools.cached_property
    def dynamic(self) -> dict[str, Grid]:
        """Grid of each scene that is solved dynamically."""
        return grids(self.config.dynamic, "dynamic")

    def __post_init__(self) -> None:
        figures = self.config.figures
        known = sorted({mu for grid in self.grids.values() for mu in grid.friction})
        for mu in figures.friction if known else ():
            if mu not in known:
                allowed = ", ".join(f"{one:g}" for one in known)
                raise ValueError(f"config: figures.friction: got {mu:g}, expected {allowed}")
        for column in figures.wear_columns:
            self._check_studied("wear_columns", column.scene, column.friction)
        for kind, overlays in (("spreads", figures.spreads), ("lives", figures.lives)):
            for name, overlay in overlays.items():
                for scene in overlay.scenes:
                    self._check_studied(f"{kind}.{name}", scene, overlay.friction)
        for scene in self.config.uncertain_lives.scenes:
            # without any grid, as of a pair, they go with recommended preloads alone
            if self.grids and scene not in self.grids:
                allowed = ", ".join(self.grids)
                raise ValueError(f"config: uncertain_lives.scenes: got {scene}, expected {allowed}")
        for scene in figures.running_averages:
            if scene not in self.dynamic:
                allowed = ", ".join(self.dynamic) or "none, because dynamic is empty"
                raise ValueError(
                    f"config: figures.running_averages: got scene {scene}, expected {allowed}"
                )
        for scene in self.compared:
            # a dynamic case without its steady twin could not be set beside it
            for case_id in self.dynamic[scene].cases():
                if case_id not in self.grids[scene].cases():
                    raise ValueError(
                        f"config: dynamic: got {scene}, {case_id}, "
                        "expected cases of the same scene under studies"
                    )

    def _check_studied(self, key: str, scene: str, mu: float) -> None:
        if scene not in self.grids:
            allowed = ", ".join(self.grids) or "none, because studies is empty"
            raise ValueError(f"config: figures.{key}: got scene {scene}, expected {allowed}")
        if mu not in self.grids[scene].friction:
            allowed = ", ".join(f"{value:g}" for value in self.grids[scene].friction)
            raise ValueError(
                f"config: figures.{key}: got {scene}, friction {mu:g}, expected {allowed}"
            )

    @property
    def losses(self) -> dict[str, float]:
        """State of wear of the figures against friction [um]."""
        return {"fig07_fresh": 0.0, "fig08_worn": self.worn_loss_um}

    @property
    def worn_loss_um(self) -> float:
        """Loss of ball diameter of the worn state that figures show [um]."""
        given = self.config.figures.worn_loss_um
        if given is not None or not self.grids:
            return given or 0.0
        return next(iter(self.grids.values())).ball_diameter_loss_um[-1]

    @property
    def compared(self) -> list[str]:
        """Scenes that are solved both ways."""
        return [scene for scene in self.dynamic if scene in self.grids]

    def check_scenes(self) -> None:
        """Read every scene as it stands, and with each value of its grid."""
        for scene, grid in self.grids.items():
            path = _scene_file(scene)
            for_life(load_scene(path), path)
            _check_cases(scene, {case: case.changes for case in grid.every_value()})
        for scene, grid in self.dynamic.items():
            cases = grid.every_value()
            one_bearing(load_scene(_scene_file(scene)), _scene_file(scene))
            _check_cases(scene, {case: self.dynamic_changes(scene, case) for case in cases})
        for scene in self.config.uncertain_lives.scenes:
            if not load_scene(_scene_file(scene)).uncertainty:
                raise ValueError(
                    f"config: uncertain_lives.scenes: got {scene}, whose file has no uncertainty "
                    "block, expected scenes with one"
                )

    def dynamic_changes(self, scene: str, case: Case) -> dict[str, Any]:
        (block,) = [block for block in self.config.dynamic if scene in block.scenes]
        return case.changes | {f"model.{key}": value for key, value in block.model.items()}

    def reference(self, scene: str) -> list[str]:
        """The file of values that a scene's running averages are drawn with, if any."""
        block = self.config.figures.running_averages.get(scene)
        return [f"config/reference/{block.reference}.csv"] if block and block.reference else []

    def frictions(self, scene: str) -> list[float]:
        """Coefficients that the figures of one scene compare."""
        grid = self.grids[scene]
        if not (wanted := sorted(self.config.figures.friction)):
            return [*grid.friction]
        return [mu for mu in wanted if mu in grid.friction] or [grid.friction[0]]

    def bearings(self, scene: str) -> tuple[str | None, ...]:
        """Bearings of a scene that have figures of their own; None: one, or two that are alike."""
        given = as_data(_scene_file(scene))[0].get("arrangement")
        alone = given is None or not (a := record(Arrangement, given)).is_pair or a.is_symmetric
        return (None,) if alone else BEARINGS

    def cases(self, *scenes: str) -> list[str]:
        """Case files of the given scenes, or of all."""
        return [
            _case_file(scene, case)
            for scene in scenes or self.grids
            for case in self.grids[scene].cases().values()
        ]

    def losses_of_jobs(self, grid: Grid) -> list[tuple[float, ...]]:
        """Losses of ball diameter that each job of a line of a grid solves [um]."""
        losses = grid.ball_diameter_loss_um
        most = min(self.config.points_per_job or MOST_FILES, MOST_FILES)
        return [losses[k : k + most] for k in range(0, len(losses), most)]

    def chunks(self, scene: str) -> dict[str, tuple[Line, ...]]:
        """Lines of each chunk of a scene by its file; none where a job is a line or less."""
        return _chunks(scene, self.grids[scene], self.config.points_per_job or 0)

    def solved(self, scene: str) -> list[str]:
        """Files that together hold every case of a scene."""
        return list(self.chunks(scene)) or self.cases(scene)

    def dynamics(self) -> list[str]:
        """Files that hold all cases of a scene solved dynamically."""
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

    def lives(self, *scenes: str) -> list[str]:
        """Files of wear life of the given scenes, or of all."""
        return [f"results/{scene}/wear_life.nc" for scene in scenes or self.grids]

    def spreads_of_lives(self, *scenes: str) -> list[str]:
        """Files of how lives spread, of those of the given scenes that have one, or of all."""
        return [
            f"results/{scene}/spread/mu{in_name(mu, 3)}.nc"
            for scene in self.config.uncertain_lives.scenes
            if scene in (scenes or self.grids)
            for mu in self.grids[scene].friction
        ]

    def refused(self, path: str) -> str | None:
        """Why a case file cannot be made: its point is not on the grid; one line."""
        found = re.fullmatch(r"results/([^/]+)/(cases|dynamic|chunks)/([^/]+)\.nc", path)
        if not found:
            return None
        scene, folder, case = found.groups()
        if folder == "chunks":
            known = [file for name in self.grids for file in self.chunks(name)]
            return None if path in known else f"{path}: got a chunk that is not in config.yaml"
        grids = self.grids if folder == "cases" else self.dynamic
        if scene not in grids:
            return f"{path}: got scene {scene}, expected {', '.join(grids) or 'none'}"
        if case in grids[scene].cases():
            return None
        if near := _meant(case, grids[scene].cases()):
            return f"{path}: got an unknown point; did you mean {near}"
        axes = "; ".join(
            f"{axis} {', '.join(map(str, values))}" for axis, values in vars(grids[scene]).items()
        )
        return f"{path}: got a point outside the grid in config.yaml, expected {axes}"

    def inputs(self) -> list[str]:
        """Files the cases and figures are made from, besides the program."""
        scenes = map(_scene_file, [*self.grids, *self.dynamic])
        files = dict.fromkeys(file for path in scenes for file in scene_files(path))
        return [*files, *(path for scene in self.dynamic for path in self.reference(scene))]


@functools.cache  # the rules look up each of their jobs
def _chunks(scene: str, grid: Grid, points: int) -> dict[str, tuple[Line, ...]]:
    losses, lines = grid.ball_diameter_loss_um, grid.lines()
    most = points // len(losses)
    if most < 2:
        return {}
    parts = [lines[k : k + most] for k in range(0, len(lines), most)]
    # named by their points, so that a file of other points never passes for it
    names = [text_hash(repr((part, losses)))[:8] for part in parts]
    return {
        f"results/{scene}/chunks/{k:05d}-{name}.nc": part
        for k, (name, part) in enumerate(zip(names, parts, strict=True))
    }


def _meant(name: str, cases: Mapping[str, Case]) -> str | None:
    """The case that a name stands for, if it has other digits or a slip of the pen."""
    if found := re.fullmatch(r"(\w+)-mu(\d*\.?\d+)-loss(\d*\.?\d+)", name):
        case = Case(found[1], float(found[2]), float(found[3]))
        return case.id if case.id in cases else None
    return next(iter(difflib.get_close_matches(name, cases, n=1)), None)


def _scene_file(scene: str) -> str:
    return f"config/scenes/{scene}.yaml"


def _check_cases(scene: str, cases: Mapping[Case, Mapping[str, Any]]) -> None:
    """Check a scene, read once, as each of its cases changes it."""
    data, source = as_data(_scene_file(scene))
    for case, changes in cases.items():
        with place_of_errors(f"config: {scene}, {case.id}"):
            changed_scene(data, changes, source)


def _case_file(scene: str, case: Case) -> str:
    return f"results/{scene}/cases/{case.id}.nc"
