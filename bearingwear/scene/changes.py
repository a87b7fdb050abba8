"""Changes to the data of a scene, `{"operation.preload_N": 9.0}`, and the cause of a fault."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from bearingwear.scene.arrangement import METHODS, PAIRS
from bearingwear.scene.checking.errors import SceneError, check_thousands, did_you_mean, shown
from bearingwear.scene.checking.strict_yaml import data_of
from bearingwear.scene.scene import key_of_scene

METHOD_KEY, KIND_KEY = "operation.preload_method", "arrangement.kind"

KEY = r"[^\s.=\[\]]+(\.[^\s.=\[\]]+)*"


def changes_of(texts: Iterable[str]) -> dict[str, Any]:
    """Returns the values of some texts such as `operation.preload_N=9` by key, as YAML reads them.

    SceneError: a text without `=`, a value that is no YAML, or a key that is set twice.
    """
    changes: list[tuple[str, Any]] = []
    for text in texts:
        key, equals, value = text.partition("=")
        key = key.strip()
        if not equals or not re.fullmatch(KEY, key):
            problem = f"got {shown(text)}, expected KEY=VALUE, for example operation.preload_N=7"
            raise SceneError("", problem, source="--set")
        if key.endswith("_rpm"):
            check_thousands("", value.strip(), f"--set {key}")
        changes.append((key, data_of(value, f"--set {key}")))
    keys = [key for key, _ in changes]
    for key in keys:
        if keys.count(key) > 1:
            raise SceneError("", "set more than once, expected once", source=f"--set {key}")
    return dict(changes)


def with_changes(data: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Returns a copy of a scene's data with values replaced, in new blocks where needed.

    None removes an item of a mapping such as `materials`, and sets any other key to None. In a
    pair, either of preload method and kind of arrangement sets the other.

    SceneError where a key is below something that is no block.
    """
    result = dict(data)
    for key, value in {**changes, **joined_keys(data, changes)}.items():
        *blocks, last = key.split(".")
        block: dict[str, Any] = result
        for depth, name in enumerate(blocks, 1):
            inner = block.get(name)
            if not isinstance(inner, Mapping | None):
                path = ".".join(blocks[:depth])
                place = key_of_scene(path)
                allowed = place.allowed if place else "another value"
                problem = f"got a key under {path}, which is not a block, expected {allowed}"
                raise SceneError("", problem, source=f"--set {key}")
            copy = dict(inner or {})
            block[name] = copy
            block = copy
        parent = key_of_scene(".".join(blocks))
        if value is None and last in block and parent is not None and parent.kind == "mapping":
            del block[last]
        else:
            block[last] = value
    return result


def joined_keys(data: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the changes that a new preload method or a new kind of a pair implies.

    There are none for a scene without a pair, or if neither changes.
    """
    arrangement = data.get("arrangement")
    pair = arrangement if isinstance(arrangement, Mapping) else {}
    if str(pair.get("kind")) not in METHODS:
        return {}
    kind_of_method = PAIRS.get(str(changes.get(METHOD_KEY)))
    kind = str(changes.get(KIND_KEY, kind_of_method))
    if kind not in METHODS:
        return {}
    implied: dict[str, Any] = {METHOD_KEY: METHODS[kind], KIND_KEY: kind}
    if kind == "rigid_pair" and "spring_stiffness_N_um" in pair:
        implied["arrangement.spring_stiffness_N_um"] = 0.0
    return {key: value for key, value in implied.items() if key not in changes}


def error_of_change(
    error: SceneError, data: Mapping[str, Any], changes: Sequence[str]
) -> SceneError:
    """Returns the error with the change that caused it, such as `--set KEY`, as its source.

    If no change caused it, the error is returned unchanged. A change is the cause if it, or a block
    that it creates, holds the key at fault or one that contradicts it.

    data: of the scene without the changes.
    changes: their keys.
    """
    for faulty_key in (error.key, *error.involved):
        for key in changes:
            if not _is_within(faulty_key, key, _missing_block(data, key)):
                continue
            source = f"--set {key}"
            if problem := _unknown_material(key, data):
                return SceneError("", problem, error.involved, source)
            name = "" if error.key == key else error.key
            return SceneError(name, error.problem, error.involved, source)
    return error


def _is_within(key: str, *paths: str | None) -> bool:
    """Whether a key is one of some paths, or lies below one; None is no path."""
    for path in paths:
        if path is not None and (key == path or key.startswith((f"{path}.", f"{path}["))):
            return True
    return False


def _unknown_material(key: str, data: Mapping[str, Any]) -> str:
    """Returns the problem of a key such as `materials.steel.density_kg_m3` without its material.

    It is "" for a material that the data have, and for any other key.
    """
    block, _, path = key.partition(".")
    name, _, property_name = path.partition(".")
    materials = data.get("materials")
    if block != "materials" or not property_name or not isinstance(materials, Mapping):
        return ""
    if name in materials:
        return ""
    names = [str(material) for material in materials]
    return f"got the material {name}, expected {', '.join(names)}{did_you_mean(name, names)}"


def _missing_block(data: Any, key: str) -> str | None:
    """Returns the path of the outermost block of a key that data lack; None if they have all."""
    *blocks, _ = key.split(".")
    for depth, name in enumerate(blocks, 1):
        data = data.get(name)
        if data is None:
            return ".".join(blocks[:depth])
    return None
