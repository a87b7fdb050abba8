"""What the trade study of accuracy against time runs: config/tradeoff.yaml, checked.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

import itertools
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from bearingwear.io.config import load_scene, yaml_number
from bearingwear.model.accuracy import NAMED
from bearingwear.study.plan_file import known, read_plan

FIRST, SCENE = "first", "scene"
"""A sweep against its own first point; a sweep that starts from the scene as it stands."""

KINDS = ("numerical", "model")
TIERS = ("race_control", "traction", "steady", "three_balls", "no_cage", "dynamic")
STARTS = ("steady", "race_control", "kinematic")
HERTZ = ("exact", "fit")

SPECIAL = {"tier": TIERS, "start": STARTS, "hertz": HERTZ}
"""Settings of a point that are no keys of a scene, and what they take."""


@dataclass(frozen=True)
class Point:
    """One solve.

    Attributes
    ----------
    label : str
        What sets it apart from the other points of its sweep.
    value : float
        The same as a number, NaN where it is none.
    fidelity : str
        Model to solve, where `special` names no tier.
    settings : tuple of str
        As `--set` takes them.
    special : dict
        tier, start, hertz: those that are not the usual ones.
    """

    label: str
    value: float
    fidelity: str
    settings: tuple[str, ...]
    special: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Reference:
    """What is held for right, and how it is checked."""

    fidelity: str
    settings: Mapping[str, Any]
    check: Mapping[str, Any]


@dataclass(frozen=True)
class Bench:
    """A scene of the study."""

    file: str
    settings: Mapping[str, Any]
    references: tuple[str, ...]


@dataclass(frozen=True)
class Sweep:
    """Points that differ in the keys of `grid`."""

    title: str
    kind: str
    base: str
    against: str
    settings: Mapping[str, Any]
    grid: Mapping[str, list]
    only: tuple[str, ...]


@dataclass(frozen=True)
class Row:
    """A row of the table of what simplifications cost and save."""

    sweep: str
    label: str
    text: str


@dataclass(frozen=True)
class TradePlan:
    """Everything in config/tradeoff.yaml."""

    repeats: int
    seconds: float
    spread: Mapping[str, float]
    dial: Mapping[str, Mapping[str, Any]]
    references: Mapping[str, Reference]
    scenes: Mapping[str, Bench]
    sweeps: Mapping[str, Sweep]
    table: tuple[Row, ...]

    @classmethod
    def from_file(cls, path: str | Path) -> "TradePlan":
        """Read the file; the settings of the dial are those of `model.accuracy`.

        Raises
        ------
        SceneError
            One line.
        """
        return read_plan(path, cls._of)

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> "TradePlan":
        plan = cls(
            repeats=int(data["repeats"]),
            seconds=float(data["seconds"]),
            spread=data["spread"],
            dial={name: named.keys for name, named in NAMED.items()},
            references={
                name: Reference(given["fidelity"], given.get("set", {}), given["check"])
                for name, given in data["references"].items()
            },
            scenes={
                name: Bench(given["file"], given.get("set", {}), tuple(given["references"]))
                for name, given in data["scenes"].items()
            },
            sweeps={
                name: Sweep(
                    given["title"],
                    given.get("kind", "numerical"),
                    given["from"],
                    given.get("against", given["from"]),
                    given.get("set", {}),
                    given["grid"],
                    tuple(given.get("only", data["scenes"])),
                )
                for name, given in data["sweeps"].items()
            },
            table=tuple(Row(**row) for row in data["table"]),
        )
        plan.check()
        return plan

    def check(self) -> None:
        """Look at what the points are made of.

        Raises
        ------
        ValueError
        """
        for name, bench in self.scenes.items():
            for reference in bench.references:
                known(reference, self.references, f"scenes.{name}.references")
        for name, sweep in self.sweeps.items():
            where = f"sweeps.{name}"
            known(sweep.kind, KINDS, f"{where}.kind")
            known(sweep.base, (*self.references, SCENE), f"{where}.from")
            known(sweep.against, (*self.references, FIRST), f"{where}.against")
            for scene in sweep.only:
                known(scene, self.scenes, f"{where}.only")
            self.points(name)
        for row in self.table:
            known(row.sweep, self.sweeps, "table.sweep")
            labels = [point.label for point in self.points(row.sweep)]
            known(row.label, labels, f"table, {row.sweep}")

    def check_scenes(self) -> None:
        """Read every scene as each of its points changes it.

        Raises
        ------
        ValueError
            One line.
        """
        for scene, sweep in self.jobs():
            for point in self.points(sweep):
                try:
                    self.scene(scene, point)
                except ValueError as error:
                    what = f"{scene}, {sweep}, {point.label}"
                    raise ValueError(f"config/tradeoff.yaml: {what}: {error}") from None

    def scene(self, name: str, point: Point, folder: str | Path = "config/scenes"):
        """A scene as a point changes it."""
        bench = self.scenes[name]
        given = dict(text.split("=", 1) for text in point.settings)
        settings = [
            f"{key}={value}" for key, value in (_texts(bench.settings, self.dial) | given).items()
        ]
        return load_scene(Path(folder) / f"{bench.file}.yaml", settings)

    def jobs(self) -> list[tuple[str, str]]:
        """Every scene with each reference and each sweep that is run on it."""
        return [
            (scene, name)
            for scene, bench in self.scenes.items()
            for name in (*bench.references, *self.sweeps)
            if name in bench.references or self._takes_part(scene, self.sweeps[name])
        ]

    def _takes_part(self, scene: str, sweep: Sweep) -> bool:
        references = self.scenes[scene].references
        return scene in sweep.only and sweep.against in (*references, FIRST)

    def points(self, name: str) -> list[Point]:
        """The points of a sweep; of a reference, itself and what checks it."""
        if name in self.references:
            given = self.references[name]
            found: tuple[tuple[str, Mapping], ...] = (("reference", {}), ("check", given.check))
            return [self._point(label, name, given.settings, more) for label, more in found]
        sweep = self.sweeps[name]
        base = {} if sweep.base == SCENE else self.references[sweep.base].settings
        return [
            self._point(
                ", ".join(map(_shown, values)),
                sweep.base if sweep.base != SCENE else sweep.against,
                {**base, **sweep.settings},
                dict(zip(sweep.grid, values, strict=True)),
            )
            for values in itertools.product(*sweep.grid.values())
        ]

    def text(self, scene: str, name: str) -> str:
        """All that decides a sweep or a reference on a scene, to see when it changes."""
        points = [(p.label, p.fidelity, p.settings, dict(p.special)) for p in self.points(name)]
        bench = self.scenes[scene]
        return json.dumps([points, bench.file, bench.settings, self.repeats, self.seconds])

    def _point(
        self, label: str, reference: str, base: Mapping[str, Any], more: Mapping[str, Any]
    ) -> Point:
        merged = {**base, **more}
        for key, allowed in SPECIAL.items():
            if key in merged:
                known(merged[key], allowed, key)
        special = {key: str(merged.pop(key)) for key in SPECIAL if key in merged}
        numbers = [_number(value) for value in more.values()]
        return Point(
            label,
            numbers[0] if len(numbers) == 1 else float("nan"),
            self.references[reference].fidelity,
            tuple(f"{key}={value}" for key, value in _texts(merged, self.dial).items()),
            special,
        )


def _texts(settings: Mapping[str, Any], dial: Mapping[str, Mapping]) -> dict[str, str]:
    """Keys of a scene and their values as YAML text; `rule` and `dial` stand for several keys."""
    texts: dict[str, str] = {}
    for key, value in settings.items():
        if key == "rule":
            quadrature, _, points = str(value).partition(" ")
            texts |= {"model.quadrature": quadrature, "model.strips": points}
        elif key == "dial":
            known(value, dial, "dial")
            texts |= _texts(dial[value], dial)
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
