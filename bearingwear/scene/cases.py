"""Cases of a scene: other conditions under which the same bearing has to do its work."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from bearingwear.scene.arrangement import flat_keys
from bearingwear.scene.checking.errors import SceneError, shown
from bearingwear.scene.checking.records import NAME

if TYPE_CHECKING:
    from bearingwear.scene.scene import Scene

NOMINAL = "nominal"
"""The scene as it stands, beside its cases."""

SHARED_BY_CASES = (
    "name",
    "description",
    "cases",
    "duty",
    "operation.preload_N",
    "operation.preload_method",
    "arrangement.kind",
)
"""Keys that a design has in all of its cases."""


def checked_cases(cases: Mapping[str, Mapping[str, Any]]) -> Mapping[str, dict[str, Any]]:
    """Returns cases by name, each with its values by whole keys such as `temperature.balls_C`.

    SceneError: a name that is not allowed, or a key that all cases share.

    cases: changes of the scene by the name of the case, with nested blocks or whole keys.
    """
    checked = {}
    for name, changes in cases.items():
        if name == NOMINAL or not re.fullmatch(NAME, name):
            problem = (
                f"got {shown(name)}, expected another name, because {NOMINAL} denotes the scene "
                "itself"
            )
            raise SceneError("cases", problem)
        checked[name] = flat_keys(changes)
        for key in checked[name]:
            if key in SHARED_BY_CASES or key.partition(".")[0] in SHARED_BY_CASES:
                problem = f"got {shown(checked[name][key])} for a key that all cases share"
                raise SceneError(f"cases.{name}.{key}", f"{problem}, expected another key")
    return MappingProxyType(checked)


def scenes_of_cases(scene: Scene) -> dict[str, Scene]:
    """Returns the scene in `nominal` and each of its cases by name, all without cases and duty.

    SceneError where a case is no valid scene.
    """
    nominal = replace(scene, cases=None, duty=None)
    scenes = {NOMINAL: nominal}
    for name, changes in (scene.cases or {}).items():
        try:
            scenes[name] = nominal.with_(changes)
        except SceneError as error:
            key = ".".join(filter(None, ("cases", name, error.source or error.key)))
            raise SceneError(key, error.problem, error.involved) from None
    return scenes


def cases_that_wear(scene: Scene) -> dict[str, Scene]:
    """Returns by name the cases in which one race turns against the other; all if none does.

    Bearings wear in no others. With a duty, the scene itself is the only one, because a duty has a
    single life over all its phases.
    """
    if scene.duty is not None:
        return {NOMINAL: scene}
    turning = {name: case for name, case in scene.in_cases.items() if case.operation.turns}
    return turning or dict(scene.in_cases)


def scene_in_case(scene: Scene, name: str, source: str) -> Scene:
    """Returns a scene in the case of a name, `nominal` or one of `cases`.

    source: what named the case, such as `--case`; the SceneError of an unknown name begins with it.
    """
    if name not in scene.in_cases:
        problem = f"got {name}, expected {', '.join(scene.in_cases)}"
        raise SceneError("", problem, source=source)
    return scene.in_cases[name]
