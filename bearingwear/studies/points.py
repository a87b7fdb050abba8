"""The points of a sweep: scenes, and values of their keys along axes or in rows."""

from __future__ import annotations

import itertools
import json
import math
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from bearingwear.scene.arrangement import METHODS
from bearingwear.scene.changes import KIND_KEY
from bearingwear.scene.checking.check import fits, misfit_words
from bearingwear.scene.checking.errors import SceneError, shown
from bearingwear.scene.scene import Scene, key_of_scene
from bearingwear.studies.axis import GRID_KEYS

if TYPE_CHECKING:
    import xarray as xr

    from bearingwear.scene.checking.records import Part

ROW, SCENE = "row", "scene"
"""Dimensions of the rows of a sample, and of several scenes."""

Axes = Mapping[str, Iterable[Any]]
Rows = Sequence[Mapping[str, Any]]


class ScenePoint(NamedTuple):
    """The number of a scene, and a value for each key."""

    scene: int
    values: tuple[Any, ...]


@dataclass(frozen=True)
class SweepPoints:
    """All points of a sweep, in the order of its dimensions.

    columns: values of each key: those of its axis, or those of all rows.
    """

    names: tuple[str, ...]  # of the scenes
    columns: Mapping[str, Sequence[Any]]
    in_rows: bool

    @classmethod
    def of(cls, scenes: Sequence[Scene], points: Axes | Rows) -> SweepPoints:
        """Returns the points of scenes at values of their keys, along axes or in rows.

        Keys, names of scenes and values on axes are checked. Values in rows and combinations of
        values on axes are not: some of them may make no valid bearing.

        SceneError: a name, a key or a value that is not allowed.
        """
        names = tuple(scene.name for scene in scenes)
        if repeated := _repeated(names):
            raise SceneError(
                "name", f"got two scenes named {repeated[0]}, expected different names"
            )
        if isinstance(points, Mapping):
            columns = {key: _plain_values(key, values) for key, values in points.items()}
        else:
            columns = _columns_of_rows(points)
        if not columns and len(scenes) < 2:
            raise SceneError("", "got no key, expected one or more", source="axes")
        for key, values in columns.items():
            _check_key(scenes, key, values[0])
            if isinstance(points, Mapping):
                _check_axis(key, values)
        _check_kinds(scenes, columns.get(KIND_KEY))
        return cls(names, columns, not isinstance(points, Mapping))

    @classmethod
    def from_json(cls, text: str) -> SweepPoints:
        """Reads the points from the text of `json`."""
        data = json.loads(text)
        return cls(tuple(data["names"]), data["columns"], data["in_rows"])

    @property
    def json(self) -> str:
        """Returns the points as text."""
        return json.dumps(asdict(self))

    def __iter__(self) -> Iterator[ScenePoint]:
        """Yields the points scene by scene, each with all rows, or with the product of the axes.

        The last axis varies fastest.
        """
        columns = self.columns.values()
        rows = zip(*columns, strict=True) if self.in_rows else itertools.product(*columns)
        for scene, values in itertools.product(range(len(self.names)), rows):
            yield ScenePoint(scene, values)

    def __len__(self) -> int:
        """Returns the number of points of all scenes."""
        return math.prod(self.lengths([]).values())

    def key_names(self, used_names: Iterable[str]) -> dict[str, str]:
        """Returns the name of the dimension or coordinate of each key in a dataset.

        used_names: names that the dataset already has.
        """
        return names_of_keys(self.columns, {*used_names, SCENE, ROW})

    def lengths(self, used_names: Iterable[str]) -> dict[str, int]:
        """Returns the lengths of the dimensions of the sweep, by name, in their order.

        used_names: names that the dataset already has.
        """
        scene_length = {SCENE: len(self.names)} if len(self.names) > 1 else {}
        if self.in_rows:
            return scene_length | {ROW: len(next(iter(self.columns.values())))}
        keys = self.key_names(used_names)
        return scene_length | {keys[key]: len(values) for key, values in self.columns.items()}

    def coordinates(self, used_names: Iterable[str]) -> dict[str, xr.Variable]:
        """Returns the coordinates of the sweep by name; rows have a coordinate for each key.

        used_names: names that the dataset already has.
        """
        import numpy as np
        import xarray as xr

        keys = self.key_names(used_names)
        coordinates = {
            keys[key]: _coordinate(key, ROW if self.in_rows else keys[key], values)
            for key, values in self.columns.items()
        }
        if len(self.names) > 1:
            attributes = {"long_name": "name of the scene"}
            coordinates[SCENE] = xr.Variable(SCENE, np.array(self.names), attributes)
        return coordinates


def names_of_keys(keys: Iterable[str], used_names: Collection[str]) -> dict[str, str]:
    """Returns the name of each dotted key in a dataset, by the key.

    It is the name in studies (`friction` for `friction.ball_race`), else the last part of the key.
    Where that name is used or two keys have it, all parts are joined by `_`.
    """
    study_names = {key: name for name, key in GRID_KEYS.items() if name not in used_names}
    short_names = {key: study_names.get(key, key.rpartition(".")[2]) for key in keys}
    counts = Counter(short_names.values())
    return {
        key: key.replace(".", "_") if counts[name] > 1 or name in used_names else name
        for key, name in short_names.items()
    }


def _plain_values(key: str, values: Any) -> list[Any]:
    """Returns the plain data of a list or an array of values of a key.

    SceneError: no list, or an empty one.
    """
    if isinstance(values, str | bytes | Mapping) or not isinstance(values, Iterable):
        raise SceneError("", f"got {shown(values)}, expected a list of values", source=key)
    plain = values.tolist() if hasattr(values, "tolist") else list(values)
    if not plain:
        raise SceneError("", "got no value, expected one or more", source=key)
    return [value.item() if hasattr(value, "item") else value for value in plain]


def _columns_of_rows(rows: Any) -> dict[str, list[Any]]:
    """Returns the values of each key in all rows, by the keys, which all rows share.

    SceneError: no sequence of mappings, no row, or rows whose keys differ.
    """
    if not isinstance(rows, Sequence) or not all(isinstance(row, Mapping) for row in rows):
        problem = f"got {shown(rows)}, expected axes KEY: VALUES, or a list of rows KEY: VALUE"
        raise SceneError("", problem, source="axes")
    if not rows:
        raise SceneError("", "got no row, expected one or more", source="axes")
    for number, row in enumerate(rows):
        if row.keys() != rows[0].keys():
            problem = f"got the keys {', '.join(row)}, expected {', '.join(rows[0])} as in row 0"
            raise SceneError("", problem, source=f"row {number}")
    return {key: _plain_values(key, [row[key] for row in rows]) for key in rows[0]}


def _field_of_key(key: str) -> Part | None:
    """Returns the field of a dotted key of a scene or of its second bearing; None for no key."""
    return key_of_scene(key.removeprefix("arrangement.second."))


def _check_key(scenes: Sequence[Scene], key: str, value: Any) -> None:
    """Raises a SceneError for a key that no scene has.

    value: of the key, with which the scene's own check raises an error that names similar keys.
    """
    if _field_of_key(key) is None:
        scenes[0].with_({key: value})  # raises that error
        raise SceneError("", "got no key of a scene, expected one", source=key)


def _check_axis(key: str, values: Sequence[Any]) -> None:
    """Raises SceneError for a value on an axis that is repeated, or that its key does not take.

    Lists and dicts may repeat.
    """
    field = _field_of_key(key)
    assert field is not None
    for value in values:
        if not fits(value, field):
            problem = misfit_words(value, field, key.rpartition(".")[2])
            raise SceneError("", problem, source=key)
    hashable_values = [value for value in values if not isinstance(value, dict | list)]
    if repeated := _repeated(hashable_values):
        problem = f"got {shown(repeated[0])} twice, expected each value once"
        raise SceneError("", problem, source=key)


def _check_kinds(scenes: Sequence[Scene], kinds: Sequence[Any] | None) -> None:
    """Raises a SceneError for pairs beside single bearings, whose results have other dimensions.

    kinds: values of the key `arrangement.kind`; None if the scenes' own kinds stay.
    """
    if kinds is None:
        kinds = [scene.arrangement.kind if scene.arrangement else "single" for scene in scenes]
    if len({kind in METHODS for kind in kinds}) > 1:
        names = " and ".join(dict.fromkeys(kinds))
        problem = f"got {names}, expected either pairs or single bearings"
        raise SceneError(KIND_KEY, problem, source=scenes[0].name)


def _repeated(values: Iterable[Any]) -> list[Any]:
    """Returns the values that occur more than once, each once; they must be hashable."""
    return [value for value, count in Counter(values).items() if count > 1]


def _coordinate(key: str, dim: str, values: Sequence[Any]) -> xr.Variable:
    """Returns the values of a key as a coordinate along a dimension, in the unit of the key.

    Where not all values are numbers, the coordinate holds texts, with JSON for what is no text. The
    attribute `flag_meanings` of a choice has the allowed names.
    """
    import numpy as np
    import xarray as xr

    field = _field_of_key(key)
    assert field is not None
    attrs = {"long_name": field.key.meaning}
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        return xr.Variable(dim, np.array(values), attrs | {"units": field.unit})
    if field.kind == "choice":
        attrs["flag_meanings"] = " ".join(field.key.choices)
    texts = [value if isinstance(value, str) else json.dumps(value) for value in values]
    return xr.Variable(dim, np.array(texts), attrs)
