"""Plan of the study of accuracy against time, read from config/accuracy.yaml.

The keys of that file stand in workflow/schemas/accuracy.schema.yaml. This file imports nothing
heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bearingwear.scene.accuracy import NAMED_PRESETS
from bearingwear.scene.checking.errors import yaml_number
from bearingwear.studies.axis import place_of_errors
from bearingwear.studies.configuration import validated_config

ACCURACY_FILE = Path("config/accuracy.yaml")

Plan = Mapping[str, Any]
"""A configuration with its defaults, or a part of it."""

FIRST, _SCENE = "first", "scene"
"""Reference of a sweep that is compared with its first point; start of a sweep from the scene."""

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
"""Settings of a point that are no keys of a scene, and their values."""
_NUMBERS = ("end", "step")
"""More of them, which are numbers above zero."""

GROOVE_KEYS: dict[str, Mapping[str, Any]] = {
    "hertz": {"model.contact": "hertz"},
    "worn": {"model.contact": "worn"},
}
"""Keys that the setting `groove` changes: the contact model of a life."""

PRESET_KEYS: dict[str, Mapping[str, Any]] = {
    name: preset.keys("line") for name, preset in NAMED_PRESETS.items()
}
"""Keys that the setting `preset` changes: those of `model.accuracy`."""

_BY_NAME = {"preset": PRESET_KEYS, "groove": GROOVE_KEYS}

FIGURE_NAMES = ("overview", "steady", "life", "dynamic_model", "integration", "models", "grooves")


@dataclass(frozen=True, kw_only=True)
class SweepPoint:
    """A point of a sweep, which is solved once."""

    label: str  # values of the axes of its sweep
    value: float  # of a single axis as a number, else NaN
    fidelity: str  # of `TRADE_FIDELITIES`
    # empty where they are as usual
    start: str = ""  # of `STARTS`
    hertz: str = ""  # of `HERTZ`: Hertz factors
    warmth: str = ""  # of `WARMTHS`: growth by speed and heat
    machine: str = ""  # of `MACHINES`: the other bearing on the rotor
    # empty where they are those of the scene and of `life`
    end: str = ""  # loss at the end of life over the gap at the contact's edge
    step: str = ""  # of a life with worn grooves, over that gap
    cells: str = ""  # of `CELL_COUNTS`
    settings: tuple[str, ...]  # as `--set` takes them
    text: str  # all settings, as the file of the sweep gives them

    def overrides(self, scene_settings: Mapping[str, str]) -> list[str]:
        """Returns its settings and those of its scene that it does not change, for `--set`.

        They are texts `KEY=VALUE`; a setting of the point takes precedence.

        scene_settings: YAML texts by key.
        """
        point_settings = dict(text.split("=", 1) for text in self.settings)
        return [f"{key}={value}" for key, value in {**scene_settings, **point_settings}.items()]


def read_accuracy(path: Path) -> dict[str, Any]:
    """Returns a plan like config/accuracy.yaml, with defaults. Raises UsageError."""
    return validated_config(path, "accuracy", check_accuracy)


def check_accuracy(plan: Plan, path: Path = ACCURACY_FILE) -> None:
    """Refuses unknown names of sweeps, references, labels and scenes.

    plan: data of config/accuracy.yaml.
    ValueError: one line with the key, its value and the allowed ones. Scenes with the changes of
    all points are not checked, because that takes seconds.
    """
    with place_of_errors(str(path)):
        _check_references(plan)
        _check_rows(plan)
        cages = [plan["cages"]] if plan["cages"]["ensembles"] else []
        for scene in (*plan["scenes"].values(), *cages):
            file = path.parent / "scenes" / f"{scene['file']}.yaml"
            if not file.is_file():
                raise ValueError(f"got the scene {scene['file']}, expected a file {file}")


def _check_references(plan: Plan) -> None:
    """Refuses unknown references and scenes of sweeps, and impossible points.

    plan: data of config/accuracy.yaml.
    ValueError: the first of them, in one line with the key, its value and the allowed ones.
    """
    references = plan["references"]
    for name, scene in plan["scenes"].items():
        for reference in scene["references"]:
            check_allowed(reference, references, f"scenes.{name}.references")
    for name, sweep in plan["sweeps"].items():
        check_allowed(sweep["from"], (*references, _SCENE), f"sweeps.{name}.from")
        check_allowed(reference_name(sweep), (*references, FIRST), f"sweeps.{name}.against")
        for only in sweep["only"]:
            check_allowed(only, plan["scenes"], f"sweeps.{name}.only")
        with place_of_errors(f"sweeps.{name}"):
            sweep_points(plan, name)


def _check_rows(plan: Plan) -> None:
    """Refuses unknown sweeps and labels in rows of tables, and effects against a reference.

    The sweep of an effect has to be compared with its own first point.

    plan: data of config/accuracy.yaml.
    ValueError: the first of them, in one line with the key, its value and the allowed ones.
    """
    for table in ("table", "effects"):
        for row in plan[table]:
            check_allowed(row["sweep"], plan["sweeps"], f"{table}.sweep")
            labels = [point.label for point in sweep_points(plan, row["sweep"])]
            check_allowed(row["label"], labels, f"{table}, {row['sweep']}")
    for row in plan["effects"]:
        sweep = plan["sweeps"][row["sweep"]]
        check_allowed(reference_name(sweep), (FIRST,), f"sweeps.{row['sweep']}.against")


def reference_name(sweep: Mapping[str, Any]) -> str:
    """Returns the name of the reference of the errors of a sweep, or `FIRST`.

    sweep: its block in the plan.
    """
    return sweep["against"] or sweep["from"]


def scene_settings(plan: Plan, scene: str) -> dict[str, str]:
    """Returns the changes of a scene at all its points, as YAML texts by key.

    plan: data of config/accuracy.yaml.
    """
    return _texts(plan["scenes"][scene]["set"])


def sweep_jobs(plan: Plan) -> list[tuple[str, str]]:
    """Returns pairs of names of a scene, and of one of its references or a sweep run on it.

    plan: data of config/accuracy.yaml.
    """
    return [
        (name, sweep)
        for name, scene in plan["scenes"].items()
        for sweep in (*scene["references"], *plan["sweeps"])
        if sweep in scene["references"] or _takes_part(plan, name, sweep)
    ]


def _takes_part(plan: Plan, scene: str, name: str) -> bool:
    """Whether a sweep of a name is run on a scene.

    It is run on the scenes of its `only`, else on all that have references; in both cases only if
    the scene has the reference of the sweep, or its reference is its first point.

    plan: data of config/accuracy.yaml.
    """
    references = plan["scenes"][scene]["references"]
    sweep = plan["sweeps"][name]
    includes_scene = scene in sweep["only"] if sweep["only"] else bool(references)
    return includes_scene and reference_name(sweep) in (*references, FIRST)


def groove_sweeps(plan: Plan) -> list[str]:
    """Returns the sweeps of lives with worn grooves over the loss at their end.

    plan: data of config/accuracy.yaml.
    """
    return [name for name, sweep in plan["sweeps"].items() if "end" in sweep["grid"]]


def cell_sweeps(plan: Plan) -> list[str]:
    """Returns the sweeps of lives over cells and steps of worn grooves.

    plan: data of config/accuracy.yaml.
    """
    return [name for name, sweep in plan["sweeps"].items() if "cells" in sweep["grid"]]


def effect_jobs(plan: Plan) -> list[tuple[str, str]]:
    """Returns the pairs of `sweep_jobs` for the tables of effects and of worn grooves.

    plan: data of config/accuracy.yaml.
    """
    sweeps = {row["sweep"] for row in plan["effects"]} | {*groove_sweeps(plan), *cell_sweeps(plan)}
    return [(scene, sweep) for scene, sweep in sweep_jobs(plan) if sweep in sweeps]


def sweep_points(plan: Plan, name: str) -> list[SweepPoint]:
    """Returns the points of a sweep, or those of a reference and of its check.

    plan: data of config/accuracy.yaml.
    name: of the sweep or the reference.
    """
    if name in plan["references"]:
        reference = plan["references"][name]
        return [
            _point(plan, "reference", name, reference["set"], {}),
            _point(plan, "check", name, reference["set"], reference["check"]),
        ]
    sweep = plan["sweeps"][name]
    base = {} if sweep["from"] == _SCENE else plan["references"][sweep["from"]]["set"]
    return [
        _point(
            plan,
            ", ".join(map(_label_text, values)),
            sweep["from"] if sweep["from"] != _SCENE else reference_name(sweep),
            {**base, **sweep["set"]},
            dict(zip(sweep["grid"], values, strict=True)),
        )
        for values in itertools.product(*sweep["grid"].values())
    ]


def decisive_settings(plan: Plan, scene: str, name: str) -> dict[str, Any]:
    """Returns the settings that decide a sweep or a reference on a scene, without its file.

    They are plain data; a job runs again when they change.

    plan: data of config/accuracy.yaml.
    """
    sweep = plan["sweeps"].get(name, {})
    points = sweep_points(plan, name)
    return {
        "scene": scene_settings(plan, scene),
        "sweep": {key: sweep.get(key, "") for key in ("title", "kind", "from", "against")},
        "points": [f"{point.label}: {point.fidelity} {point.text}" for point in points],
        "repeats": plan["repeats"],
        "seconds": plan["seconds"],
    }


def _point(
    plan: Plan,
    label: str,
    reference: str,
    base: Mapping[str, Any],
    changes: Mapping[str, Any],
) -> SweepPoint:
    """Returns a point from the settings of its sweep, `base`, and its own changes.

    plan: data of config/accuracy.yaml.
    label: that sets the point apart from others of the sweep.
    reference: name of the reference whose model it has, unless a setting says otherwise.
    base, changes: values by keys of a scene, of `_SPECIAL` and of `_NUMBERS`.
    ValueError: a setting that is not allowed.
    """
    merged = {**base, **changes}
    for key, allowed in _SPECIAL.items():
        if key in merged:
            check_allowed(merged[key], allowed, key)
    for key in _NUMBERS:
        if not _number(merged.get(key, 1.0)) > 0.0:
            raise ValueError(f"{key}: got {merged[key]}, expected a number > 0")
    special = {key: str(merged.pop(key)) for key in (*_SPECIAL, *_NUMBERS) if key in merged}
    numbers = [_number(value) for value in changes.values()]
    settings = tuple(f"{key}={value}" for key, value in _texts(merged).items())
    text = " ".join([*settings, *(f"{key}={value}" for key, value in special.items())])
    return SweepPoint(
        label=label,
        value=numbers[0] if len(numbers) == 1 else float("nan"),
        fidelity=special.pop("fidelity", "") or plan["references"][reference]["fidelity"],
        settings=settings,
        text=text,
        **special,
    )


def check_allowed(value: Any, allowed: Iterable[Any], place: str) -> None:
    """Raises a ValueError that names the place of a value that is not allowed."""
    if value not in allowed:
        raise ValueError(f"{place}: got {value}, expected {', '.join(map(str, allowed))}")


def _texts(settings: Mapping[str, Any]) -> dict[str, str]:
    """Returns settings as YAML texts by keys of a scene; some settings set several keys.

    These are `rule`, such as "split 32" (quadrature and points), `preset` and `groove`.

    ValueError: an unknown preset or groove.
    """
    texts: dict[str, str] = {}
    for key, value in settings.items():
        if key == "rule":
            quadrature, _, points = str(value).partition(" ")
            texts |= {"model.quadrature": quadrature, "model.strips": points}
        elif key in _BY_NAME:
            check_allowed(value, _BY_NAME[key], key)
            texts |= _texts(_BY_NAME[key][value])
        else:
            texts[key] = _yaml(value)
    return texts


def _yaml(value: Any) -> str:
    """Returns a value as YAML on one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key}: {_yaml(part)}" for key, part in value.items()) + "}"
    return yaml_number(value) if isinstance(value, float) else json.dumps(value)


def _number(value: Any) -> float:
    """Returns the number at the end of a value, such as 50 of "strips 50"; NaN without one."""
    *_, last_word = str(value).rpartition(" ")
    try:
        return float(last_word)
    except ValueError:
        return float("nan")


def _label_text(value: Any) -> str:
    """Returns a value as it stands in a label."""
    return f"{value:g}" if isinstance(value, float) else str(value).replace("_", " ")
