"""From a YAML file, or plain data, to a checked `Scene`, with one line for whatever is wrong."""

from __future__ import annotations

import contextlib
import difflib
import os
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from bearingwear.scene.accuracy import REGULARISATION, Model, accuracy_preset, slip_region
from bearingwear.scene.blocks import OF_CAGE
from bearingwear.scene.changes import KEY, changes_of, error_of_change, joined_keys, with_changes
from bearingwear.scene.checking.check import (
    build_record,
    changed_record,
    checked_data,
    fits,
    record,
)
from bearingwear.scene.checking.errors import DEEPEST, SceneError, short, shown
from bearingwear.scene.checking.records import NAME, SCENE_SUFFIXES, file_part, keyed, setting
from bearingwear.scene.checking.strict_yaml import data_of, text_of
from bearingwear.scene.duty import check_phases
from bearingwear.scene.scene import IS_CHECKED, EndOfLife, Scene, key_of_scene, plain_data
from bearingwear.scene.slip import regularisation_is_given, with_regularisation
from bearingwear.scene.uncertain import uncertain_key

Source = str | os.PathLike[str] | Mapping[str, Any] | Scene


def load_scene(path: str | os.PathLike[str], overrides: Iterable[str] = ()) -> Scene:
    """Reads and checks a scene file.

    overrides: changes such as `"operation.preload_N=9"`, whose values are read as YAML.
    SceneError: one line that names the file (or the `--set`), the key, what was given, what is
    allowed.
    """
    data, source = as_data(path)
    return changed_scene(data, changes_of(overrides), source)


def as_scene(scene: Source) -> Scene:
    """Returns a checked scene from a path, a dict of a scene file's shape, or a `Scene`.

    A `Scene` that is already checked is returned itself. SceneError: it is not valid.
    """
    if isinstance(scene, Scene) and _is_checked(scene):
        return scene
    return scene_from_dict(*as_data(scene))


def source_name(scene: Source) -> str:
    """Returns the name of a scene in error messages: its file, if it is one."""
    return os.fspath(scene) if isinstance(scene, str | os.PathLike) else "scene"


def as_data(scene: Source) -> tuple[Mapping[str, Any], str]:
    """Returns the data of a scene, not checked, and its name in error messages."""
    source = source_name(scene)
    if isinstance(scene, Scene):
        # a Scene that was built in Python has unchecked values, so it goes the way of a dict
        return _data_without_accuracy(scene), source
    if isinstance(scene, Mapping):
        return scene, source
    if isinstance(scene, str | os.PathLike):
        return _read(scene).data, source
    raise TypeError(f"got {type(scene).__name__}, expected a path, a dict or a Scene")


def changed_scene(data: Mapping[str, Any], changes: Mapping[str, Any], source: str) -> Scene:
    """Returns the checked scene of plain data with some values replaced.

    source: name of the scene in error messages.
    SceneError: begins with `--set KEY` where a change causes it.
    """
    changed_data = with_changes(data, changes)
    try:
        return scene_from_dict(changed_data, source)
    except SceneError as error:
        raise error_of_change(error, data, list(changes)) from None


def scene_from_dict(data: Mapping[str, Any], source: str = "scene") -> Scene:
    """Checks plain nested data and builds the scene from it.

    SceneError: it begins with the source, and names the gravest fault.

    source: name of the scene in error messages.
    """
    try:
        plain = checked_data(Scene, data)
        _check_spread(plain)
        plain["description"] = " ".join(plain.get("description", "").split())
        regularisation_given = "slip_regularisation_m_s" in plain["friction"]
        scene = build_record(Scene, _with_accuracy(plain))
        return _with_checked_cases(with_regularisation(scene, regularisation_given))
    except SceneError as error:
        raise error.in_source(source) from None


def _with_checked_cases(scene: Scene) -> Scene:
    """Checks the cases and the duty of a scene whose keys were checked, and marks it as checked.

    SceneError: a case is no valid scene, or changes what all phases of the duty share.
    """
    if scene.cases:
        _ = scene.in_cases  # computing them raises the error of an invalid case
    check_phases(scene)
    scene.__dict__[IS_CHECKED] = True
    return scene


def _is_checked(scene: Scene) -> bool:
    """Whether a scene is marked as checked."""
    return IS_CHECKED in scene.__dict__


def scene_for_life(scene: Scene, source: str = "scene") -> Scene:
    """Returns the scene unchanged; refuses one without a criterion for the end of life.

    It also refuses a criterion of the share of a preload that is 0.

    source: name of the scene in the SceneError.
    """
    end = scene.wear.end_of_life
    if end is None or not end.criteria:
        names = ", ".join(file_part(EndOfLife).below)
        raise SceneError(
            "wear.end_of_life", f"got no criterion, expected at least one of {names}", (), source
        )
    if end.preload_fraction is not None and scene.operation.preload_N == 0.0:
        raise SceneError(
            "wear.end_of_life.preload_fraction",
            "got a fraction of a zero preload, expected a preload > 0",
            ("operation.preload_N",),
            source,
        )
    return scene


# files


@keyed
class BasedOn:
    """A scene file that is another one with some keys changed."""

    name: str = setting("Name of the scene", pattern=NAME)
    description: str = setting("Description, which replaces that of the other scene", default="")
    # fmt: off
    based_on: str = setting("Name of the other scene, a file in the same folder (without .yaml)",
        pattern=NAME)
    changes: Mapping[str, Any] = setting(
        "Keys of the other scene that are changed, and their new values",
        name="set", default_factory=dict)
    # fmt: on

    def __post_init__(self) -> None:
        """Refuses changes whose keys are no paths of a scene."""
        for key in self.changes:
            if not re.fullmatch(KEY, key):
                raise SceneError(
                    "set", f"got {shown(key)}, expected keys such as operation.preload_N"
                )


class _SceneFile(NamedTuple):
    """Data of a scene, and the files that they were read from."""

    data: dict[str, Any]
    files: list[str]


def scene_files(path: str | os.PathLike[str]) -> list[str]:
    """Returns the files of a scene: its own, the one that it is based on, the base of that, ...

    SceneError: a file that cannot be read, or a scene that is based on itself.
    """
    return _read(path).files


_A_SCENE = "expected a scene, such as `bearingwear new mine.yaml 7008C` writes"


def _block_names() -> set[str]:
    """Returns the names of the blocks of a scene."""
    return {name for name, part in file_part(Scene).below.items() if part.kind != "text"}


def _unreadable_scene_error(error: SceneError, source: str) -> SceneError:
    """Returns the error of a file that cannot be read as YAML, with advice where it is likely."""
    path = Path(source)
    with contextlib.suppress(OSError, ValueError):
        if not path.exists():
            return _missing_file_error(error, path)
        if path.is_file() and path.suffix not in SCENE_SUFFIXES and "not YAML" in error.problem:
            kind = f"a {path.suffix} file" if path.suffix else "text"
            problem = f"got {kind}, {_A_SCENE}"
            return SceneError("", problem, source=source)
    return error


def _missing_file_error(error: SceneError, path: Path) -> SceneError:
    """Returns the error of a file that does not exist, with the names of similar ones."""
    scenes = [file.name for file in path.parent.glob("*") if file.suffix in SCENE_SUFFIXES]
    similar = [name for name in scenes if Path(name).stem == path.name]
    similar = similar or difflib.get_close_matches(path.name, scenes, n=2)
    advice = ""
    if similar:
        advice = f"; did you mean {' or '.join(str(path.with_name(name)) for name in similar)}"
    elif not path.suffix and re.search(r"\d\d\d", path.name):
        advice = (
            f"; `bearingwear new {path.name}` writes a scene of a bearing with this designation"
        )
    return SceneError("", f"{error.problem}{advice}", source=error.source)


def _data_of_file(source: str) -> dict[str, Any]:
    """Reads one YAML file; refuses it if it has neither a block of a scene nor `based_on`."""
    try:
        data = data_of(text_of(source, "scene"), source)
    except SceneError as error:
        raise _unreadable_scene_error(error, source) from None
    if not isinstance(data, dict):
        problem = f"got {shown(data)}, expected a scene, which is a block of keys"
        raise SceneError("", problem, source=source)
    if data and not data.keys() & (_block_names() | {"based_on"}):
        names = ", ".join(short(str(name)) for name in [*data][:3])
        problem = f"got a file without any block of a scene ({names}), {_A_SCENE}"
        raise SceneError("", problem, source=source)
    return data


def _read(path: str | os.PathLike[str], depth: int = 0) -> _SceneFile:
    """Reads a scene file and, with its changes applied, the one that it is based on.

    depth: number of files that led here through `based_on`.
    """
    source = os.fspath(path)
    data = _data_of_file(source)
    if "based_on" not in data:
        stem = Path(source).stem
        default_name = {"name": stem} if re.search(NAME, stem) else {}
        return _SceneFile(default_name | data, [source])
    derived = record(BasedOn, data, source)
    if depth > DEEPEST:  # only a circle is so long
        problem = f"got {derived.based_on}, based on itself, expected another scene"
        raise SceneError("based_on", problem, source=source)
    base = _read(Path(path).with_name(f"{derived.based_on}.yaml"), depth + 1)
    texts = {key: data[key] for key in ("name", "description") if key in data}
    try:
        changed = with_changes(base.data, texts | dict(derived.changes))
        return _SceneFile(changed, [source, *base.files])
    except SceneError as error:
        key = error.source.removeprefix("--set ")
        raise SceneError(f"set.{key}", error.problem, source=source) from None


# what the keys alone do not say


def _check_spread(data: Mapping[str, Any]) -> None:
    """Refuses a mean, median or bound of a distribution that the key itself may not have."""
    for name, distribution in (data.get("uncertainty") or {}).items():
        part = key_of_scene(uncertain_key(name, "NAME"))
        if part is None:  # wear_scatter, which is no key of a scene
            continue
        for end in ("mean", "median", "low", "high"):
            value = distribution.get(end)
            if value is not None and not fits(value, part):
                raise SceneError(
                    f"uncertainty.{name}.{end}", f"got {shown(value)}, expected {part.allowed}"
                )


def written_data(scene: Scene) -> dict[str, Any]:
    """Returns the data of a scene as it is written to a file.

    A regularisation that follows the slip is left out, or it would not follow another speed.
    """
    plain = scene.to_dict()
    if not regularisation_is_given(scene):
        del plain["friction"]["slip_regularisation_m_s"]
    return plain


def _data_without_accuracy(scene: Scene) -> dict[str, Any]:
    """Returns the data of a scene without the values set by its accuracy, so that it can change."""
    plain = scene.to_dict()
    preset = accuracy_preset(scene.model.accuracy)
    for path, value in preset.keys(scene.model.slip_region, _cage_wears(plain)).items():
        block, _, name = path.partition(".")
        if path == REGULARISATION:
            by_accuracy = not regularisation_is_given(scene)
        else:
            by_accuracy = plain[block][name] == value
        if by_accuracy:
            del plain[block][name]
    return plain


def _cage_wears(plain: Mapping[str, Any]) -> bool:
    """Whether a scene requests motion or wear of the cage."""
    end = (plain.get("wear") or {}).get("end_of_life") or {}
    cage_results = (plain.get("model") or {}).get("cage_results", Model.cage_results)
    return bool(cage_results) or any(end.get(name) is not None for name in OF_CAGE)


def _with_accuracy(plain: dict[str, Any]) -> dict[str, Any]:
    """Fills in the keys that the accuracy sets where a scene lacks them, and returns its data.

    plain: the data, in which changed blocks are replaced by new ones.
    """
    model = plain.get("model") or {}
    region = slip_region(model.get("contact", Model.contact), model.get("slip_over"))
    preset = accuracy_preset(model.get("accuracy", Model.accuracy))
    for path, value in preset.keys(region, _cage_wears(plain)).items():
        block, _, name = path.partition(".")
        plain[block] = {name: value} | (plain.get(block) or {})
    return plain


def variant(source: Source, changes: Mapping[str, Any]) -> Scene:
    """Returns a checked scene with some of its values replaced.

    changes: `{"operation.preload_N": 9.0}`; missing blocks are created, None removes an optional
        key.

    SceneError: one line that names the file, or the change (as `--set`, which makes such
    changes).
    """
    if isinstance(source, Scene):
        changed = _quick_variant(source, changes)
        if changed is not None:
            return changed
    data, name = as_data(source)
    return changed_scene(data, changes, name)


# fmt: off
_INDEPENDENT_BLOCKS = {
    "bearing", "materials", "operation", "arrangement", "temperature", "thermal", "fits",
    "friction", "lubricant", "wear",
}
# fmt: on
"""Blocks on which nothing elsewhere depends but what a scene checks when it is made."""

_SCENE_FILE = file_part(Scene)

_END = "wear.end_of_life"
"""Block whose limits of the cage decide the accuracy of the motion in time."""


def _quick_variant(scene: Scene, changes: Mapping[str, Any]) -> Scene | None:
    """Returns the changed scene with only the changed values checked; ten times as fast.

    None where other blocks depend on them, or where a value is wrong: a full check then reports it.
    """
    for key in changes:
        block, dot, _ = key.partition(".")
        if not dot or block not in _INDEPENDENT_BLOCKS or key.startswith(_END):
            return None
    if not _is_checked(scene):
        return None
    pair = {"arrangement": plain_data(scene.arrangement)} if scene.arrangement is not None else {}
    all_changes = {**changes, **joined_keys(pair, changes)}
    values_by_path = {tuple(key.split(".")): value for key, value in all_changes.items()}
    regularisation_given = REGULARISATION in changes or regularisation_is_given(scene)
    try:
        changed = changed_record(scene, _SCENE_FILE, values_by_path)
        return _with_checked_cases(with_regularisation(changed, regularisation_given))
    except ValueError:
        return None
