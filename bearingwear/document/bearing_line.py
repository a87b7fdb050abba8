"""Lines about a bearing: which one it is and how it runs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from bearingwear.measures import plain
from bearingwear.scene.arrangement import flat_keys, set_preload_ratio
from bearingwear.scene.cases import NOMINAL
from bearingwear.scene.new.catalogue import identity_line, speed_limit_line
from bearingwear.scene.new.minimum_preload import minimum_preload_lines, minimum_preload_words

_CONTACTS = {
    "paper": "contact model from the paper",
    "hertz": "Hertzian contact",
    "worn": "contact in worn grooves",
}
"""Words for the values of `model.contact`; other values have none."""

_NEGLECTED_TEMPERATURE = "temperature_left_out"
"""The `id` of the warning about a scene without temperatures."""

_NO_TEMPERATURES = "temperatures neglected"


def bearing_line(scene: Mapping[str, Any]) -> str:
    """Describes a bearing and its operation in all cases of its scene, on one line.

    scene: content of a scene file, or of the scene in a file of a study, which leaves out the keys
        that the study varies.
    """
    bearing, scenes = scene["bearing"], scenes_by_case(scene)
    balls, races = (bearing[f"{part}_material"].replace("_", " ") for part in ("ball", "race"))
    contact_model = _CONTACTS.get((scene.get("model") or {}).get("contact", ""), "")
    phrases = (
        identity_line(bearing) or "",
        _arrangement_phrase(scene.get("arrangement") or {}),
        _boundary_dimensions_phrase(bearing),
        f"{bearing['ball_count']} balls of {bearing['ball_diameter_mm']:g} mm, "
        f"pitch diameter {bearing['pitch_diameter_mm']:g} mm",
        f"contact angle {bearing['contact_angle_deg']:g}°",
        balls if balls == races else f"{balls} on {races}",
        *_speed_and_friction_phrases(list(scenes.values())),
        _temperature_phrase_of_cases(scenes),
        *_load_phrases(scenes.values()),
        minimum_preload_words(scenes.values()),
        contact_model,
        worst_case_phrase(scenes) if len(scenes) > 1 else "",
    )
    return "; ".join(phrase for phrase in phrases if phrase)


def _boundary_dimensions_phrase(bearing: Mapping[str, Any]) -> str:
    """States bore and outside diameter [mm]; empty for a bearing without them."""
    diameters = (("bore", "bore_mm"), ("outside diameter", "outside_diameter_mm"))
    return ", ".join(f"{words} {bearing[key]:g} mm" for words, key in diameters if bearing.get(key))


def _speed_and_friction_phrases(scenes: Sequence[Mapping[str, Any]]) -> list[str]:
    """States the range of the speeds of scenes, and of their friction coefficients if all exist."""
    speeds = [scene["operation"]["shaft_speed_rpm"] for scene in scenes]
    frictions = [scene["friction"].get("ball_race") for scene in scenes]
    phrases = [f"{_range_text(speeds)} r/min"]
    if None not in frictions:
        phrases.append(f"friction {_range_text(frictions)}")
    return phrases


def scenes_by_case(scene: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """Returns the content of a scene for each of its cases; the first is the scene unchanged."""
    scenes: dict[str, Mapping[str, Any]] = {NOMINAL: scene}
    for name, changes in (scene.get("cases") or {}).items():
        scenes[name] = _scene_with_changes(scene, flat_keys(changes))
    return scenes


def _scene_with_changes(scene: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Returns a copy of a scene, or of a block of one, with some values replaced.

    changes: the new values by their dotted keys.
    """
    copy = dict(scene)
    for dotted_key, value in changes.items():
        name, _, key_in_block = dotted_key.partition(".")
        if key_in_block:
            value = _scene_with_changes(copy.get(name) or {}, {key_in_block: value})
        copy[name] = value
    return copy


def warning_with_cases(
    warning: Mapping[str, Any], scene: Mapping[str, Any], names: Sequence[str] = ()
) -> dict[str, Any]:
    """Returns a warning whose sentence names the cases that have it, if not all of them do.

    A sentence that already begins with the name of a case, as in a duty, is not changed.

    warning: with its `id` and its `sentence`.
    names: of the cases that have the warning. If omitted, they are determined for the warning about
        missing temperatures, and any other warning is not changed.
    """
    scenes = scenes_by_case(scene)
    if warning["sentence"].startswith(tuple(f"{name}: " for name in scenes)):
        return dict(warning)
    if not names and warning["id"] == _NEGLECTED_TEMPERATURE:
        names = [name for name, case in scenes.items() if not _has_temperatures(case)]
    words = ""
    if 0 < len(names) < len(scenes):
        words = f"{'case' if len(names) == 1 else 'cases'} {', '.join(names)}: "
    return {**warning, "sentence": words + warning["sentence"]}


def _has_temperatures(scene: Mapping[str, Any]) -> bool:
    """Returns whether a scene gives temperatures, or a network that determines them."""
    return bool(scene.get("temperature") or scene.get("thermal"))


def worst_case_phrase(cases: Iterable[str]) -> str:
    """Returns the words that name the cases whose worst value is shown.

    Example: `worst of 2: nominal, fast`.
    """
    names = list(cases)
    return f"worst of {len(names)}: {', '.join(names)}"


def _radial_load_phrases(scene: Mapping[str, Any]) -> list[str]:
    """States the radial and the rotating load [N], if they are not zero."""
    loads_N = {
        "radial load": _radial_load_N(scene),
        "rotating load": scene["operation"].get("rotating_load_N"),
    }
    return [f"{words} {load_N:g} N" for words, load_N in loads_N.items() if load_N]


def _radial_load_N(scene: Mapping[str, Any]) -> float:
    """Returns the magnitude of the radial load of a scene [N]."""
    return math.hypot(*(scene["operation"].get("radial_load_N") or [0.0]))


def _range_text(values: Sequence[float]) -> str:
    """Returns `10` for equal values, `10 to 20` for others."""
    low, high = min(values), max(values)
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def _load_phrases(scenes: Iterable[Mapping[str, Any]]) -> list[str]:
    """States each load and the drag density as ranges over all cases; zeros are left out."""
    loads: dict[str, list[float]] = {}
    for scene in scenes:
        operation = scene["operation"]
        for words, value in (
            ("radial load {} N", _radial_load_N(scene)),
            ("rotating load {} N", operation.get("rotating_load_N")),
            ("axial force {} N", (scene.get("arrangement") or {}).get("external_axial_N")),
            ("drag density {}\N{NO-BREAK SPACE}kg/m³",
             (scene.get("lubricant") or {}).get("drag_density_kg_m3")),
        ):  # fmt: skip
            loads.setdefault(words, []).append(value or 0.0)
    return [words.format(_range_text(values)) for words, values in loads.items() if any(values)]


def _arrangement_phrase(arrangement: Mapping[str, Any]) -> str:
    """States kind and orientation of an arrangement, a block of a scene."""
    kind = arrangement.get("kind", "single")
    if kind == "single":
        return "one bearing of a symmetric pair"
    return f"{kind}, {arrangement.get('orientation', '')}".replace("_", " ")


def _temperature_phrase(scene: Mapping[str, Any]) -> str:
    """States the temperatures in a single case of a scene."""
    if scene.get("thermal"):
        return "heated by its own friction"
    temperatures = scene.get("temperature") or {}
    phrases = [
        f"{name.removesuffix('_C').replace('_', ' ')} {value:g}\N{NO-BREAK SPACE}°C"
        for name, value in temperatures.items()
        if value is not None and name != "reference_C"
    ]
    return ", ".join(phrases) or _NO_TEMPERATURES


def _temperature_phrase_of_cases(scenes: Mapping[str, Mapping[str, Any]]) -> str:
    """States the temperatures of all cases if they agree, otherwise which cases have some."""
    phrases = {name: _temperature_phrase(scene) for name, scene in scenes.items()}
    if len(set(phrases.values())) == 1:
        return phrases[NOMINAL]
    names = [name for name, phrase in phrases.items() if phrase != _NO_TEMPERATURES]
    return f"temperatures given in {', '.join(names)}"


def duty_lines(scene: Mapping[str, Any]) -> list[str]:
    """Describes the duty of a scene: its cycle, each phase, and what its starts cause."""
    duty, scenes = scene["duty"], scenes_by_case(scene)
    ramp_s = duty["start_s"] + duty["stop_s"]
    phase_h = {
        name: phase["hours"] + phase["starts"] * ramp_s / 3600.0
        for name, phase in duty["phases"].items()
    }
    cycle_h = sum(phase_h.values())
    lines = [f"duty: a cycle of {plain(cycle_h)} h, repeated until the life ends"]
    for name, phase in duty["phases"].items():
        case, starts = phase.get("case") or name, phase["starts"]
        phrases = [
            f"{plain(scenes[case]['operation']['shaft_speed_rpm'], 6)} r/min",
            f"{plain(100.0 * phase_h[name] / cycle_h)} % of the time",
        ]
        if starts:
            phrases.append(f"{plain(starts)} {'start' if starts == 1 else 'starts'} a cycle")
        if case != name:
            phrases.append(f"case {case}")
        lines.append(f"  {name}: {', '.join(phrases)}")
    has_starts = any(phase["starts"] for phase in duty["phases"].values())
    if has_starts and duty["warmup"]:
        lines.append("  each start warms the bearings up from the mounting temperature")
    elif has_starts and not ramp_s:
        lines.append("  start_s and stop_s are 0: starts and stops cause no wear")
    return lines


def pair_preload_N(arrangement: Mapping[str, Any], preload_N: float) -> float:
    """Returns the preload [N] that the bearings of a rigid tandem set have as a mere pair.

    arrangement: block of the scene with the set.
    preload_N: preload of each side of the set.
    """
    return preload_N / set_preload_ratio(arrangement["tandem"])


def _pair_phrases(arrangement: Mapping[str, Any], preload_N: float) -> list[str]:
    """Describes an arrangement and the differences of its bearings; empty for a single bearing.

    preload_N: of each side.
    """
    if arrangement.get("kind", "single") == "single":
        return []
    phrases = [f"{arrangement['kind']} {arrangement['orientation']}".replace("_", " ")]
    if max(arrangement.get("tandem", [1])) > 1:
        first, second = arrangement["tandem"]
        side = f"{preload_N:g} N on each side"
        if arrangement["kind"] == "rigid_pair":
            pair_N = plain(pair_preload_N(arrangement, preload_N))
            side += f", as bearings matched for a pair of {pair_N} N give"
        phrases.append(f"{first} and {second} in tandem ({side})")
    if arrangement["external_axial_N"]:
        phrases.append(f"external axial force {arrangement['external_axial_N']:g} N")
    if arrangement["spring_stiffness_N_um"]:
        phrases.append(f"spring stiffness {arrangement['spring_stiffness_N_um']:g} N/um")
    if arrangement["second"]:
        differences = ", ".join(f"{key} {value}" for key, value in arrangement["second"].items())
        phrases.append(f"second bearing: {differences}")
    return phrases


def operation_lines(scene: Mapping[str, Any]) -> tuple[str, ...]:
    """Describes the bearing, its operating point, and the limits of its maker's catalogue."""
    bearing, operation = scene["bearing"], scene["operation"]
    catalogue_lines = identity_line(bearing), speed_limit_line(bearing, operation)
    return (
        f"{scene['name']}: {bearing['ball_count']} balls of {bearing['ball_diameter_mm']:g} mm",
        ", ".join(_operation_phrases(scene)),
        *(line for line in catalogue_lines if line),
        *minimum_preload_lines(scene),
    )


def _operation_phrases(scene: Mapping[str, Any]) -> list[str]:
    """States speeds, preload, loads, friction, wear and cases of a scene."""
    operation, cases = scene["operation"], scenes_by_case(scene)
    phrases = [f"{operation['shaft_speed_rpm']:g} r/min"]
    if outer_rpm := operation.get("outer_speed_rpm"):
        phrases.append(f"outer {outer_rpm:g}")
    method = operation["preload_method"].replace("_", " ")
    phrases.append(f"{method} preload {operation['preload_N']:g} N")
    phrases += _pair_phrases(scene.get("arrangement") or {}, operation["preload_N"])
    phrases += _radial_load_phrases(scene)
    phrases.append(f"friction {_friction_phrase(scene['friction'])}")
    loss_um = scene["wear"]["ball_diameter_loss_um"]
    loss = f"{loss_um:g} um" if isinstance(loss_um, float) else "unequal"
    phrases.append(f"ball diameter loss {loss}")
    if len(cases) > 1:
        phrases.append(f"nominal of {len(cases)} cases: {', '.join(cases)}")
    return phrases


def _friction_phrase(friction: Mapping[str, Any]) -> str:
    """States the friction of balls and races: the coefficient, or the shear strength of a film."""
    film = friction.get("film")
    if not film:
        return f"{friction['ball_race']:g}"
    thickness = f", {film['thickness_um']:g} um" if film.get("thickness_um") else ""
    return f"of a film ({film['shear_strength_MPa']:g} MPa{thickness})"
