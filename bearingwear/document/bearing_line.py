"""Lines about a bearing: which one it is and how it runs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from bearingwear.measures import plain
from bearingwear.scene.arrangement import flat_keys, set_over_pair
from bearingwear.scene.cases import NOMINAL
from bearingwear.scene.new.catalogue import identity_line, speed_limit_line
from bearingwear.scene.new.minimum_preload import minimum_preload_line, minimum_preload_words

_CONTACTS = {
    "paper": "contact model from the paper",
    "hertz": "Hertzian contact",
    "worn": "contact in worn grooves",
}


_TEMPERATURE_LEFT_OUT = "temperature_left_out"
"""Warning of a scene without temperatures."""

_NOT_GIVEN = "temperatures neglected"


def bearing_line(scene: Mapping[str, Any]) -> str:
    """Which bearing it is and how it runs, on a line; of several cases, from which to which.

    scene: as a file states it; that of a study leaves out what is varied.
    """
    bearing, each = scene["bearing"], scenes_by_case(scene)
    balls, races = (bearing[f"{part}_material"].replace("_", " ") for part in ("ball", "race"))
    mu = [one["friction"].get("ball_race") for one in each.values()]
    size = [
        f"{words} {bearing[key]:g} mm"
        for words, key in (("bore", "bore_mm"), ("outside diameter", "outside_diameter_mm"))
        if bearing.get(key)
    ]
    parts = (
        *filter(None, [identity_line(bearing)]),
        _arrangement(scene.get("arrangement") or {}),
        *([", ".join(size)] if size else []),
        f"{bearing['ball_count']} balls of {bearing['ball_diameter_mm']:g} mm, "
        f"pitch diameter {bearing['pitch_diameter_mm']:g} mm",
        f"contact angle {bearing['contact_angle_deg']:g}°",
        balls if balls == races else f"{balls} on {races}",
        f"{_range([one['operation']['shaft_speed_rpm'] for one in each.values()])} r/min",
        *([f"friction {_range(mu)}"] if None not in mu else []),
        _warmth_of(each),
        *_loads(each.values()),
        *filter(None, [minimum_preload_words(each.values())]),
        *filter(None, [_CONTACTS.get((scene.get("model") or {}).get("contact", ""))]),
        *([cases_words(each)] if len(each) > 1 else []),
    )
    return "; ".join(parts)


def scenes_by_case(scene: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """A scene, as plain data, in each of its cases; as it stands first."""
    found: dict[str, Mapping[str, Any]] = {NOMINAL: scene}
    for name, changes in (scene.get("cases") or {}).items():
        found[name] = _changed(scene, flat_keys(changes))
    return found


def _changed(scene: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    made = dict(scene)
    for key, value in changes.items():
        block, _, rest = key.partition(".")
        made[block] = _changed(made.get(block) or {}, {rest: value}) if rest else value
    return made


def settled_by_a_case(warning: Mapping[str, Any], scene: Mapping[str, Any]) -> bool:
    """Whether a case of a scene answers a warning: temperatures are neglected, but it has some."""
    cases = list(scenes_by_case(scene).values())[1:]
    warm = any(one.get("temperature") or one.get("thermal") for one in cases)
    return warm and warning["id"] == _TEMPERATURE_LEFT_OUT


def cases_words(cases: Iterable[str]) -> str:
    """Whose worst is said: `worst of 2: nominal, fast`."""
    names = list(cases)
    return f"worst of {len(names)}: {', '.join(names)}"


def _forces(scene: Mapping[str, Any]) -> list[str]:
    """Loads across the shaft."""
    radial = math.hypot(*(scene["operation"].get("radial_load_N") or [0.0]))
    loads = {"radial load": radial, "rotating load": scene["operation"].get("rotating_load_N")}
    return [f"{words} {value:g} N" for words, value in loads.items() if value]


def _range(values: Sequence[float]) -> str:
    low, high = min(values), max(values)
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def _loads(scenes: Iterable[Mapping[str, Any]]) -> list[str]:
    """Loads and drag, of all cases from the least to the most."""
    loads: dict[str, list[float]] = {}
    for one in scenes:
        operation = one["operation"]
        for words, value in (
            ("radial load {} N", math.hypot(*(operation.get("radial_load_N") or [0.0]))),
            ("rotating load {} N", operation.get("rotating_load_N")),
            ("axial force {} N", (one.get("arrangement") or {}).get("external_axial_N")),
            ("drag density {}\N{NO-BREAK SPACE}kg/m³",
             (one.get("lubricant") or {}).get("drag_density_kg_m3")),
        ):  # fmt: skip
            loads.setdefault(words, []).append(value or 0.0)
    return [words.format(_range(values)) for words, values in loads.items() if any(values)]


def _arrangement(arrangement: Mapping[str, Any]) -> str:
    kind = arrangement.get("kind", "single")
    if kind == "single":
        return "one bearing of a symmetric pair"
    return f"{kind}, {arrangement.get('orientation', '')}".replace("_", " ")


def _warmth(scene: Mapping[str, Any]) -> str:
    if scene.get("thermal"):
        return "heated by its own friction"
    given = scene.get("temperature") or {}
    parts = [
        f"{name.removesuffix('_C').replace('_', ' ')} {value:g}\N{NO-BREAK SPACE}°C"
        for name, value in given.items()
        if value is not None and name != "reference_C"
    ]
    return ", ".join(parts) or _NOT_GIVEN


def _warmth_of(cases: Mapping[str, Mapping[str, Any]]) -> str:
    """Temperatures of a scene; where cases have others, in which they are given."""
    texts = {name: _warmth(one) for name, one in cases.items()}
    if len(set(texts.values())) == 1:
        return texts[NOMINAL]
    given = [name for name, text in texts.items() if text != _NOT_GIVEN]
    return f"temperatures given in {', '.join(given)}"


def duty_lines(scene: Mapping[str, Any]) -> list[str]:
    """Lines on the duty of a scene: its cycle, and speed, time and starts of each phase."""
    duty, cases = scene["duty"], scenes_by_case(scene)
    ramp_s = duty["start_s"] + duty["stop_s"]
    times = {
        name: phase["hours"] + phase["starts"] * ramp_s / 3600.0
        for name, phase in duty["phases"].items()
    }
    cycle = sum(times.values())
    lines = [f"duty: a cycle of {plain(cycle)} h, repeated until the life ends"]
    for name, phase in duty["phases"].items():
        case = phase.get("case") or name
        rpm, n = cases[case]["operation"]["shaft_speed_rpm"], phase["starts"]
        words = [
            f"{plain(rpm, 6)} r/min",
            f"{plain(100.0 * times[name] / cycle)} % of the time",
            *([f"{plain(n)} start{'s' * (n != 1)} a cycle"] if n else []),
            *([f"case {case}"] if case != name else []),
        ]
        lines.append(f"  {name}: {', '.join(words)}")
    starts = any(phase["starts"] for phase in duty["phases"].values())
    if starts and duty["warmup"]:
        lines.append("  each start warms the bearings up from the mounting temperature")
    elif starts and not ramp_s:
        lines.append("  start_s and stop_s are 0: starts and stops cause no wear")
    return lines


def matched_pair(a: Mapping[str, Any], preload: float) -> float:
    """Preload [N] of a pair of the same bearings as a rigid set, which has `preload` on a side."""
    return preload / set_over_pair(a["tandem"])


def _pair_words(a: Mapping[str, Any], preload: float) -> list[str]:
    """Lines on the arrangement of two bearings, and on their differences."""
    if a.get("kind", "single") == "single":
        return []
    words = [f"{a['kind']} {a['orientation']}".replace("_", " ")]
    if max(a.get("tandem", [1])) > 1:
        side = f"{preload:g} N on each side"
        if a["kind"] == "rigid_pair":
            side += f", as bearings matched for a pair of {plain(matched_pair(a, preload))} N give"
        words.append("{} and {} in tandem ({})".format(*a["tandem"], side))
    if a["external_axial_N"]:
        words.append(f"external axial force {a['external_axial_N']:g} N")
    if a["spring_stiffness_N_um"]:
        words.append(f"spring stiffness {a['spring_stiffness_N_um']:g} N/um")
    if a["second"]:
        words.append("second bearing: " + ", ".join(f"{k} {v}" for k, v in a["second"].items()))
    return words


def operation_lines(scene: Mapping[str, Any]) -> tuple[str, ...]:
    """Lines on the bearing, its operating point, and what its maker's catalogue says."""
    bearing, operation = scene["bearing"], scene["operation"]
    loss = scene["wear"]["ball_diameter_loss_um"]
    worn = f"{loss:g} um" if isinstance(loss, float) else "unequal"
    outer = operation.get("outer_speed_rpm")
    speeds = [f"{operation['shaft_speed_rpm']:g} r/min", *([f"outer {outer:g}"] if outer else [])]
    method = operation["preload_method"].replace("_", " ")
    cases = scenes_by_case(scene)
    parts = (
        *speeds,
        f"{method} preload {operation['preload_N']:g} N",
        *_pair_words(scene.get("arrangement") or {}, operation["preload_N"]),
        *_forces(scene),
        f"friction {_friction(scene['friction'])}",
        f"ball diameter loss {worn}",
        *([f"nominal of {len(cases)} cases: {', '.join(cases)}"] if len(cases) > 1 else []),
    )
    return (
        f"{scene['name']}: {bearing['ball_count']} balls of {bearing['ball_diameter_mm']:g} mm",
        ", ".join(parts),
        *filter(
            None,
            (
                identity_line(bearing),
                speed_limit_line(bearing, operation),
                minimum_preload_line(bearing, operation),
            ),
        ),
    )


def _friction(given: Mapping[str, Any]) -> str:
    """Of balls and races: a coefficient, or that of a film."""
    film = given.get("film")
    if not film:
        return f"{given['ball_race']:g}"
    thick = film.get("thickness_um")
    return f"of a film ({film['shear_strength_MPa']:g} MPa{f', {thick:g} um' if thick else ''})"
