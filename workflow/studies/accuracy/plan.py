"""What the study of accuracy against time runs: config/accuracy.yaml, checked.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

import itertools
import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from bearingwear.scene.accuracy import NAMED_PRESETS
from bearingwear.scene.checking.errors import SceneError, yaml_number
from bearingwear.scene.checking.records import NAME, keyed, setting
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import Scene
from bearingwear.studies.cage.plan import FEWEST, Ensemble

ACCURACY_FILE = "config/accuracy.yaml"

FIRST, _SCENE = "first", "scene"
"""A sweep against its own first point; a sweep that starts from the scene as it stands."""

SWEEP_KINDS = ("numerical", "model")
TRADE_FIDELITIES = (
    "race_control",
    "steady",
    "three_balls",
    "no_cage",
    "dynamic",
)
STARTS = ("steady", "race_control", "kinematic")
HERTZ = ("exact", "fit")
WARMTHS = ("mounted", "at_speed", "warm_ring", "network")
MACHINES = ("alone", "alike", "pushed", "worn_apart")
CELL_COUNTS = ("24 x 6", "32 x 8", "48 x 10", "64 x 14")
"""Cells of a worn contact: along the major axis, and on each side of it."""

_SPECIAL = {
    "fidelity": TRADE_FIDELITIES,
    "start": STARTS,
    "hertz": HERTZ,
    "warmth": WARMTHS,
    "machine": MACHINES,
    "cells": CELL_COUNTS,
}
"""Settings of a point that are no keys of a scene, and what they take."""
_NEVER_MET = 1e-9
"""An interval that ends no ensemble."""
_NUMBERS = ("end", "step")
"""More of them, which are numbers above zero."""

GROOVE_KEYS: dict[str, Mapping[str, Any]] = {
    "hertz": {"model.contact": "hertz"},
    "worn": {"model.contact": "worn"},
    "bands": {"model.contact": "worn", "wear.ball_track": "bands"},
}
"""What `groove` stands for: what a life takes the grooves for, and how balls wear."""

PRESET_KEYS: dict[str, Mapping[str, Any]] = {
    name: preset.keys("line") for name, preset in NAMED_PRESETS.items()
}
"""What `preset` stands for: the settings of `model.accuracy`."""

_BY_NAME = {"preset": PRESET_KEYS, "groove": GROOVE_KEYS}

FIGURE_NAMES = ("overview", "steady", "life", "dynamic_model", "integration", "models", "grooves")


@dataclass(frozen=True, kw_only=True)
class SweepPoint:
    """One solve."""

    label: str  # what sets it apart from the other points of its sweep
    value: float  # the same as a number, NaN where it is none
    fidelity: str  # model to solve
    # how it starts, its Hertz factors, what has grown, what stands beside it on the rotor; empty
    # where they are the usual ones
    start: str = ""
    hertz: str = ""
    warmth: str = ""
    machine: str = ""
    # Loss at the end of life over the gap at the contact's edge; steps (over that gap) and cells of
    # a life that follows the grooves. Empty as the scene, and `life`, have them.
    end: str = ""
    step: str = ""
    cells: str = ""
    settings: tuple[str, ...]  # as `--set` takes them
    text: str  # all of it, as the file of the sweep says it

    def overrides(self, scene_settings: Mapping[str, str]) -> list[str]:
        """Its settings and those of its scene, as `--set` takes them."""
        own = dict(text.split("=", 1) for text in self.settings)
        return [f"{key}={value}" for key, value in {**scene_settings, **own}.items()]


@keyed
class Reference:
    """The reference of a scene, and its check."""

    fidelity: str = setting("Model to solve", choices=TRADE_FIDELITIES)
    changes: Mapping[str, Any] = setting("Settings", name="set", default_factory=dict)
    check: Mapping[str, Any] = setting("Settings of the check")


@keyed
class TradeScene:
    """A scene of the study."""

    file: str = setting("Name of a file in config/scenes", pattern=NAME)
    changes: Mapping[str, Any] = setting("Settings", name="set", default_factory=dict)
    references: tuple[str, ...] = setting(
        "Reference solutions of the scene; if there are none, only sweeps that name the scene are "
        "run",
        default=(),
    )


@keyed
class Sweep:
    """Points that differ in the keys of `grid`."""

    title: str = setting("Title in the legend")
    kind: str = setting(
        "Kind of difference between the points", choices=SWEEP_KINDS, default="numerical"
    )
    base: str = setting(
        "Reference solution whose settings the sweep varies, or `scene`", name="from"
    )
    errors_against: str = setting(
        "Reference solution for the errors, or `first`; default: `from`", name="against", default=""
    )
    changes: Mapping[str, Any] = setting("Settings", name="set", default_factory=dict)
    grid: Mapping[str, Any] = setting("Lists of values; every combination is a point")
    only: tuple[str, ...] = setting("Scenes in the sweep; default: all", default=())

    def __post_init__(self) -> None:
        for key, values in self.grid.items():
            if not isinstance(values, list):
                raise SceneError(f"grid.{key}", f"got {values!r}, expected a list")

    @property
    def against(self) -> str:
        return self.errors_against or self.base


@keyed
class TableRow:
    """A row of the table of what simplifications cost and save."""

    sweep: str = setting("Name of the sweep")
    label: str = setting("Label of the point")
    text: str = setting("Text of the first cell")


@keyed
class CageRow:
    """An ensemble of cages of the study."""

    text: str = setting("Text of the first cell")
    changes: Mapping[str, Any] = setting("Settings", name="set", default_factory=dict)
    least_turns: int = setting("As in `cage.yaml`", default=Ensemble.least_turns)
    most_turns: int = setting("As in `cage.yaml`", default=Ensemble.most_turns)


@keyed
class CageTrade:
    """Ensembles of one cage; each is compared with the first, run by run."""

    file: str = setting("Name of a file in config/scenes", pattern=NAME)
    changes: Mapping[str, Any] = setting("Settings", name="set", default_factory=dict)
    runs: int = setting("Number of runs in each ensemble", within=f"[{FEWEST}, inf)")
    ensembles: Mapping[str, CageRow] = setting("Ensembles by the names of their files")

    def ensemble_settings(self, name: str) -> dict[str, Any]:
        """Settings of an ensemble of which all runs are made."""
        row = self.ensembles[name]
        turns = {"least_turns": row.least_turns, "most_turns": row.most_turns}
        return {
            "changes": {**self.changes, **row.changes},
            "ensemble": {"runs": self.runs, "within": _NEVER_MET, **turns},
        }


@keyed
class Tolerance:
    """How far a number in docs/accuracy.md may differ from a run."""

    error: float = setting("Permitted factor between errors", within="[1, inf)")
    floor: float = setting(
        "Error in a steady state below which differences are regarded as noise", within="[0, inf)"
    )
    floor_dynamic: float = setting(
        "Error in a dynamic solution below which differences are regarded as noise",
        within="[0, inf)",
    )
    time: float = setting("Permitted factor between times", within="[1, inf)")


@keyed
class AccuracyPlan:
    """Everything in config/accuracy.yaml."""

    repeats: int = setting("Number of timed solves; the median time is used", within="[1, inf)")
    seconds: float = setting(
        "Total time after which a solve is not repeated", unit="s", within="(0, inf)"
    )
    tolerance: Tolerance = setting("Permitted differences between docs/accuracy.md and a run")
    references: Mapping[str, Reference] = setting("Solutions treated as exact")
    scenes: Mapping[str, TradeScene] = setting("Scenes, by their names in the study")
    sweeps: Mapping[str, Sweep] = setting("Sweeps")
    table: tuple[TableRow, ...] = setting("Rows of the table in docs/accuracy.md")
    effects: tuple[TableRow, ...] = setting(
        "Rows of the tables of single effects in each scene, relative to the first point of the "
        "sweep",
        default=(),
    )

    cages: CageTrade = setting("Ensembles of cage runs for the table of turns and tolerances")

    def __post_init__(self) -> None:
        for name, scene in self.scenes.items():
            for reference in scene.references:
                _check_known(reference, self.references, f"scenes.{name}.references")
        for name, sweep in self.sweeps.items():
            where = f"sweeps.{name}"
            _check_known(sweep.base, (*self.references, _SCENE), f"{where}.from")
            _check_known(sweep.against, (*self.references, FIRST), f"{where}.against")
            for only in sweep.only:
                _check_known(only, self.scenes, f"{where}.only")
            self.points(name)
        for table, rows in (("table", self.table), ("effects", self.effects)):
            for row in rows:
                _check_known(row.sweep, self.sweeps, f"{table}.sweep")
                labels = [point.label for point in self.points(row.sweep)]
                _check_known(row.label, labels, f"{table}, {row.sweep}")
        for row in self.effects:
            _check_known(self.sweeps[row.sweep].against, (FIRST,), f"sweeps.{row.sweep}.against")

    def check_scenes(self) -> None:
        """Refuse scenes that do not exist; to read them as all points change them takes seconds."""
        for name in self.scenes:
            if not os.path.isfile(self.scene_file(name)):
                raise ValueError(
                    f"{ACCURACY_FILE}: got the scene {self.scenes[name].file}, which does not exist"
                )

    def varied(self, name: str, point: SweepPoint) -> Scene:
        return load_scene(self.scene_file(name), point.overrides(self.scene_settings(name)))

    def scene_file(self, name: str) -> str:
        return f"config/scenes/{self.scenes[name].file}.yaml"

    def scene_settings(self, name: str) -> dict[str, str]:
        """What is changed in a scene at all its points, as YAML texts by key."""
        return _texts(self.scenes[name].changes)

    def jobs(self) -> list[tuple[str, str]]:
        """Every scene with each reference and each sweep that is run on it."""
        return [
            (name, sweep)
            for name, scene in self.scenes.items()
            for sweep in (*scene.references, *self.sweeps)
            if sweep in scene.references or self._takes_part(name, self.sweeps[sweep])
        ]

    @property
    def groove_sweeps(self) -> list[str]:
        """Sweeps of lives with worn grooves over the loss that ends them."""
        return [name for name, sweep in self.sweeps.items() if "end" in sweep.grid]

    @property
    def cell_sweeps(self) -> list[str]:
        """Sweeps of lives over cells and steps of worn grooves."""
        return [name for name, sweep in self.sweeps.items() if "cells" in sweep.grid]

    @property
    def effect_jobs(self) -> list[tuple[str, str]]:
        """Those of them that the tables of effects and of worn grooves are made of."""
        asked = {row.sweep for row in self.effects} | {*self.groove_sweeps, *self.cell_sweeps}
        return [(scene, sweep) for scene, sweep in self.jobs() if sweep in asked]

    def _takes_part(self, scene: str, sweep: Sweep) -> bool:
        references = self.scenes[scene].references
        asked = scene in sweep.only if sweep.only else bool(references)
        return asked and sweep.against in (*references, FIRST)

    def points(self, name: str) -> list[SweepPoint]:
        """The points of a sweep; of a reference, itself and what checks it."""
        if name in self.references:
            given = self.references[name]
            found: tuple[tuple[str, Mapping], ...] = (("reference", {}), ("check", given.check))
            return [self._point(label, name, given.changes, more) for label, more in found]
        sweep = self.sweeps[name]
        base = {} if sweep.base == _SCENE else self.references[sweep.base].changes
        return [
            self._point(
                ", ".join(map(_shown, values)),
                sweep.base if sweep.base != _SCENE else sweep.against,
                {**base, **sweep.changes},
                dict(zip(sweep.grid, values, strict=True)),
            )
            for values in itertools.product(*sweep.grid.values())
        ]

    def sweep_settings(self, scene: str, name: str) -> dict[str, Any]:
        """What decides a sweep or a reference on a scene, besides the scene's file."""
        sweep = self.sweeps.get(name)
        return {
            "scene_name": scene,
            "scene_settings": self.scene_settings(scene),
            "sweep_name": name,
            "title": sweep.title if sweep else name,
            "kind": sweep.kind if sweep else "reference",
            "against": sweep.against if sweep else name,
            "points": [asdict(point) for point in self.points(name)],
            "repeats": self.repeats,
            "seconds": self.seconds,
        }

    def _point(
        self, label: str, reference: str, base: Mapping[str, Any], more: Mapping[str, Any]
    ) -> SweepPoint:
        merged = {**base, **more}
        for key, allowed in _SPECIAL.items():
            if key in merged:
                _check_known(merged[key], allowed, key)
        for key in _NUMBERS:
            if not _number(merged.get(key, 1.0)) > 0.0:
                raise SceneError(key, f"got {merged[key]}, expected a number > 0")
        special = {key: str(merged.pop(key)) for key in (*_SPECIAL, *_NUMBERS) if key in merged}
        numbers = [_number(value) for value in more.values()]
        settings = tuple(f"{key}={value}" for key, value in _texts(merged).items())
        text = " ".join([*settings, *(f"{key}={value}" for key, value in special.items())])
        return SweepPoint(
            label=label,
            value=numbers[0] if len(numbers) == 1 else float("nan"),
            fidelity=special.pop("fidelity", "") or self.references[reference].fidelity,
            settings=settings,
            text=text,
            **special,
        )


def _check_known(given: Any, allowed: Iterable[Any], where: str) -> None:
    """Refuse what is not one of the allowed values."""
    if given not in allowed:
        raise SceneError(where, f"got {given}, expected {', '.join(map(str, allowed))}")


def _texts(settings: Mapping[str, Any]) -> dict[str, str]:
    """Keys of a scene, values as YAML texts; some settings stand for several keys."""
    texts: dict[str, str] = {}
    for key, value in settings.items():
        if key == "rule":
            quadrature, _, points = str(value).partition(" ")
            texts |= {"model.quadrature": quadrature, "model.strips": points}
        elif key in _BY_NAME:
            _check_known(value, _BY_NAME[key], key)
            texts |= _texts(_BY_NAME[key][value])
        else:
            texts[key] = _yaml(value)
    return texts


def _yaml(value: Any) -> str:
    """A value as YAML on one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key}: {_yaml(part)}" for key, part in value.items()) + "}"
    return yaml_number(value) if isinstance(value, float) else json.dumps(value)


def _number(value: Any) -> float:
    try:
        return float(str(value).rpartition(" ")[2])
    except ValueError:
        return float("nan")


def _shown(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value).replace("_", " ")
