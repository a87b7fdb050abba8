"""Scene files, dicts and `--set` to a checked `Scene`, with one line for whatever is wrong."""

from __future__ import annotations

import difflib
import functools
import json
import math
import numbers
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from bearingwear.io.strict_yaml import DEEPEST, data_of, text_of
from bearingwear.model.accuracy import rung
from bearingwear.model.scene import (
    UNCERTAIN,
    WORN,
    Bearing,
    Cage,
    Distribution,
    EndOfLife,
    Friction,
    Lubricant,
    Material,
    Model,
    Operation,
    Scene,
    SceneError,
    Wear,
)

__all__ = [
    "SCHEMA_FILE",
    "SceneError",
    "as_scene",
    "for_life",
    "load_scene",
    "scene_from_dict",
    "schema",
    "schema_at",
    "yaml_number",
]

SCHEMA_FILE = Path(__file__).parent / "schema" / "scene.schema.json"

_LONGEST = 60


@functools.cache
def schema() -> dict[str, Any]:
    """The JSON schema of a scene."""
    return json.loads(SCHEMA_FILE.read_text(encoding="utf-8"))


def load_scene(path: str | os.PathLike[str], overrides: Iterable[str] = ()) -> Scene:
    """Read and check a scene file.

    Parameters
    ----------
    path : path
        The YAML file.
    overrides : iterable of str
        `"operation.preload_N=9"` each, as `--set` takes them; the value is read as YAML.

    Raises
    ------
    SceneError
        One line that names the file (or the `--set`), the key, what was given, what is allowed.
    """
    source = os.fspath(path)
    data = data_of(text_of(path), source)
    if not isinstance(data, dict):
        raise SceneError(
            "", f"given {_shown(data)}; allowed a block of keys, a scene", source=source
        )
    changes = [_override(text) for text in overrides]
    made = [_apply(data, key, value) for key, value in changes]
    keys = [key for key, _ in changes]
    for key in keys:
        if keys.count(key) > 1:
            raise SceneError("", "given more than once; allowed once", source=f"--set {key}")
    try:
        return scene_from_dict(data, source)
    except SceneError as error:
        raise _blamed(error, keys, made) from None


def as_scene(scene: str | os.PathLike[str] | Mapping[str, Any] | Scene) -> Scene:
    """A checked scene from a path, a dict of a scene file's shape, or a `Scene`."""
    if isinstance(scene, Scene):
        # checked like any other: whoever builds one in Python skips the schema
        return scene_from_dict(scene.to_dict())
    if isinstance(scene, Mapping):
        return scene_from_dict(scene)
    if isinstance(scene, str | os.PathLike):
        return load_scene(scene)
    raise TypeError(f"a scene is a path, a dict or a Scene, not {type(scene).__name__}")


def scene_from_dict(data: Mapping[str, Any], source: str = "scene") -> Scene:
    """Check plain nested data and build the scene from it.

    Parameters
    ----------
    data : mapping
        The shape of a scene file; not changed.
    source : str
        What error messages name.

    Raises
    ------
    SceneError
    """
    try:
        plain = _copied(data, "", 0)
        _check_schema(plain)
        _check_spread(plain)
        return _built(_dialled(_completed(plain, schema())))
    except SceneError as error:
        raise SceneError(error.key, error.problem, error.involved, source) from None


def for_life(scene: Scene, source: str = "scene") -> Scene:
    """The scene, if it says when its life ends."""
    end = scene.wear.end_of_life
    if end is None or not end.criteria:
        names = ", ".join(schema_at("wear.end_of_life")["properties"])
        raise SceneError(
            "wear.end_of_life", f"given no criterion; allowed, for a life: {names}", (), source
        )
    if end.preload_fraction is not None and scene.operation.preload_N == 0.0:
        raise SceneError(
            "wear.end_of_life.preload_fraction",
            "given with a preload of 0; allowed only with a preload",
            ("operation.preload_N",),
            source,
        )
    return scene


def schema_at(key: str) -> dict[str, Any]:
    """Part of the schema that describes a key, `materials.steel.density_kg_m3`; {} if none."""
    part = schema()
    for name in re.findall(r"[^.\[\]]+", key):
        extra = part.get("additionalProperties")
        part = part.get("properties", {}).get(name) or part.get("items") or extra or {}
    return part


def allowed(key: str) -> str:
    """What a key takes, in words."""
    return schema_at(key).get("description", "").rpartition("; ")[2] or "another value"


# overrides


def _override(text: str) -> tuple[str, Any]:
    key, equals, value = text.partition("=")
    key = key.strip()
    if not equals or not re.fullmatch(r"[^\s.=\[\]]+(\.[^\s.=\[\]]+)*", key):
        raise SceneError(
            "", f"given {_shown(text)}; allowed KEY=VALUE, operation.preload_N=7", source="--set"
        )
    return key, data_of(value, f"--set {key}")


def _apply(data: dict[str, Any], key: str, value: Any) -> str | None:
    """Set a value; return the path of a block that had to be made for it."""
    *blocks, last = key.split(".")
    made = None
    path = ""
    for name in blocks:
        path = f"{path}.{name}" if path else name
        if data.get(name) is None:
            data[name] = {}
            made = made or path
        data = data[name]
        if not isinstance(data, dict):
            raise SceneError(
                "", f"given a key of {path}, which is no block; allowed {allowed(path)}", (),
                f"--set {key}",
            )  # fmt: skip
    data[last] = value
    return made


def _blamed(error: SceneError, keys: Sequence[str], made: Sequence[str | None]) -> SceneError:
    """The same error, naming the override that brought it about, if one did."""
    for at_fault in (error.key, *error.involved):
        for key, block in zip(keys, made, strict=True):
            for cause in filter(None, (key, block)):
                if at_fault == cause or at_fault.startswith((f"{cause}.", f"{cause}[")):
                    name = "" if error.key == key else error.key
                    return SceneError(name, error.problem, error.involved, f"--set {key}")
    return error


# the checks


def _copied(value: Any, path: str, depth: int) -> Any:
    """Plain copy of nested data, refusing what is not plain or not finite."""
    if depth > DEEPEST:
        raise SceneError(path, f"given more than {DEEPEST} blocks within each other; allowed less")
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                raise SceneError(path, f"given the key {_shown(key)}; allowed text as a key")
        return {k: _copied(v, f"{path}.{k}" if path else k, depth + 1) for k, v in value.items()}
    if hasattr(value, "tolist"):  # numpy numbers and arrays
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [_copied(part, f"{path}[{i}]", depth + 1) for i, part in enumerate(value)]
    if value is None or isinstance(value, bool | str | int):
        return value
    if isinstance(value, numbers.Real):
        if not math.isfinite(value):
            raise SceneError(path, f"given {_shown(float(value))}; allowed {allowed(path)}")
        return float(value)
    raise SceneError(path, f"given {_shown(value)}; allowed {allowed(path)}")


@functools.cache
def _validator() -> Any:
    import jsonschema  # only where a scene is read: `--help` does without

    return jsonschema.Draft202012Validator(schema())


# a mistyped key is both unknown and missing: name it as what it is
_ORDER = {"additionalProperties": 1, "type": 2, "required": 9}


def _rank(error: Any) -> int:
    # an impossible name comes first: the path of whatever is wrong below it would hold it
    return 0 if _is_name(error) else _ORDER.get(error.validator, 5)


def _is_name(error: Any) -> bool:
    return "propertyNames" in error.absolute_schema_path


def _check_schema(data: Any) -> None:
    errors = list(_validator().iter_errors(data))
    if not errors:
        return
    error = min(errors, key=lambda e: (_rank(e), _place(data, e.absolute_path)))
    path = ""
    for part in error.absolute_path:
        path += f"[{part}]" if isinstance(part, int) else f".{part}" if path else part
    raise _schema_error(error, path)


def _place(data: Any, path: Iterable[str | int]) -> list[int]:
    """Where a path stands in the data, to name what comes first in the file."""
    place = []
    for part in path:
        place.append(part if isinstance(part, int) else list(data).index(part))
        data = data[part]
    return place


def uncertain_key(name: str, material: str) -> str:
    """The key whose value an uncertainty is about."""
    block = f"{UNCERTAIN[name]}.{material}" if name in WORN else UNCERTAIN[name]
    return f"{block}.{name}"


def _check_spread(data: Any) -> None:
    """The middle and the ends of a distribution are values that the key itself may take."""
    import jsonschema

    for name, spread in (data.get("uncertainty") or {}).items():
        key = uncertain_key(name, "NAME")
        for part in ("mean", "median", "low", "high"):
            value = spread.get(part)
            if value is not None and not jsonschema.Draft202012Validator(schema_at(key)).is_valid(
                value
            ):
                raise SceneError(
                    f"uncertainty.{name}.{part}", f"given {_shown(value)}; allowed {allowed(key)}"
                )


def _schema_error(error: Any, path: str) -> SceneError:
    def below(name: str) -> str:
        return f"{path}.{name}" if path else name

    given = error.instance
    if error.validator == "additionalProperties":
        known = list(error.schema["properties"])
        unknown = next(key for key in given if key not in known)
        near = difflib.get_close_matches(unknown, known, n=2, cutoff=0.6)
        free = [key for key in known if key not in given] or known
        names = " or ".join(near) if near else ", ".join(free)
        return SceneError(
            below(_short(unknown)),
            f"given an unknown key; {'nearest ' if near else ''}allowed: {names}",
        )
    if error.validator == "required":
        missing = next(key for key in error.validator_value if key not in given)
        return SceneError(below(missing), f"given nothing; allowed {allowed(below(missing))}")
    if _is_name(error):
        return SceneError(path, f"given the name {_shown(given)}; allowed {allowed(path)}")
    if error.validator in ("minItems", "maxItems"):
        return SceneError(path, f"given a list of {len(given)}; allowed {allowed(path)}")
    return SceneError(path, f"given {_given(given, error)}; allowed {allowed(path)}")


def _given(value: Any, error: Any) -> str:
    kinds = error.schema.get("type", [])
    wanted = {kinds} if isinstance(kinds, str) else set(kinds)
    if error.validator == "type" and isinstance(value, str) and wanted & {"number", "integer"}:
        hint = _as_yaml_number(value)
        return f"{_shown(value)}, text, not a number" + (f" (write {hint})" if hint else "")
    return _shown(value)


def _as_yaml_number(text: str) -> str | None:
    """How a text that was meant as a number must be written to be one."""
    try:
        value = float(text)
    except ValueError:
        return None
    if not math.isfinite(value):
        return None
    return str(int(value)) if value == int(value) and abs(value) < 1e9 else yaml_number(value)


def yaml_number(value: float) -> str:
    """A number written so that every YAML reader takes it for one: 1.0e-5, not 1e-05."""
    mantissa, e, exponent = repr(value).partition("e")
    if not e:
        return mantissa
    return f"{mantissa if '.' in mantissa else mantissa + '.0'}e{int(exponent):+d}"


def _short(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."


def _shown(value: Any) -> str:
    """A value as it would stand in a scene file, on one short line."""
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Mapping):
        return f"a block of {len(value)} keys"
    if isinstance(value, list | tuple):
        return f"a list of {len(value)}"
    if isinstance(value, int) and abs(value) > 10**30:
        return "a whole number of more than 30 digits"
    if isinstance(value, float) and not math.isfinite(value):
        return ".nan" if math.isnan(value) else ".inf" if value > 0 else "-.inf"
    return _short(yaml_number(value) if isinstance(value, float) else repr(value))


def _completed(value: Any, part: Mapping[str, Any]) -> Any:
    """Fill in defaults; whole numbers become floats where a number is meant."""
    if isinstance(value, dict):
        properties = part.get("properties")
        if properties is None:
            return {k: _completed(v, part["additionalProperties"]) for k, v in value.items()}
        filled = {k: value.get(k, p.get("default")) for k, p in properties.items()}
        return {k: _completed(v, properties[k]) for k, v in filled.items()}
    if value is None and isinstance(part.get("default"), dict):
        return _completed(part["default"], part)
    if isinstance(value, list):
        return [_completed(v, part["items"]) for v in value]
    if isinstance(value, int | float) and not isinstance(value, bool):
        return int(value) if part.get("type") == "integer" else float(value)
    return value


def _dialled(d: dict[str, Any]) -> dict[str, Any]:
    """Fill in what the accuracy asked for decides, where the scene does not."""
    for path, value in rung(d["model"]["accuracy"]).keys.items():
        block, _, name = path.partition(".")
        if d[block][name] is None:
            d[block][name] = value
    return d


def _built(d: dict[str, Any]) -> Scene:
    """The scene of checked and completed data."""
    wear = dict(d["wear"])
    loss, end = wear.pop("ball_diameter_loss_um"), wear.pop("end_of_life")
    operation = dict(d["operation"])
    radial = operation.pop("radial_load_N")
    return Scene(
        name=d["name"],
        description=" ".join(d["description"].split()),
        bearing=Bearing(**d["bearing"]),
        materials={name: Material(**m) for name, m in d["materials"].items()},
        cage=None if d["cage"] is None else Cage(**d["cage"]),
        operation=Operation(radial_load_N=tuple(radial), **operation),
        friction=Friction(**d["friction"]),
        lubricant=Lubricant(**d["lubricant"]),
        wear=Wear(
            ball_diameter_loss_um=tuple(loss) if isinstance(loss, list) else (loss,),
            end_of_life=None if end is None else EndOfLife(**end),
            **wear,
        ),
        uncertainty=None
        if d["uncertainty"] is None
        else {name: Distribution(**spread) for name, spread in d["uncertainty"].items()},
        model=Model(**d["model"]),
    )
