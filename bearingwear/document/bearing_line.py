"""Lines about a bearing: which one it is and how it runs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from bearingwear.scene.arrangement import set_over_pair
from bearingwear.scene.new.catalogue import identity_line, speed_limit_line

_CONTACTS = {
    "paper": "contact model from the paper",
    "hertz": "Hertzian contact",
    "worn": "contact in worn grooves",
}


def bearing_line(scene: Mapping[str, Any]) -> str:
    """Which bearing it is and how it runs, on a line.

    scene: as a file states it; that of a study leaves out what is varied.
    """
    bearing, operation = scene["bearing"], scene["operation"]
    balls, races = (bearing[f"{part}_material"].replace("_", " ") for part in ("ball", "race"))
    mu = scene["friction"].get("ball_race")
    axial = (scene.get("arrangement") or {}).get("external_axial_N")
    drag = (scene.get("lubricant") or {}).get("drag_density_kg_m3") or 0.0
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
        f"{operation['shaft_speed_rpm']:g} r/min",
        *([f"friction {mu:g}"] if mu is not None else []),
        _warmth(scene),
        *_loads(scene),
        *([f"axial force {axial:g} N"] if axial else []),
        *([f"drag density {drag:g}\N{NO-BREAK SPACE}kg/m³"] if drag else []),
        *filter(None, [_CONTACTS.get((scene.get("model") or {}).get("contact", ""))]),
    )
    return "; ".join(parts)


def _loads(scene: Mapping[str, Any]) -> list[str]:
    """Loads across the shaft."""
    radial = math.hypot(*(scene["operation"].get("radial_load_N") or [0.0]))
    loads = {"radial load": radial, "rotating load": scene["operation"].get("rotating_load_N")}
    return [f"{words} {value:g} N" for words, value in loads.items() if value]


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
    return ", ".join(parts) or "temperatures neglected"


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
            side += f", as bearings matched for a pair of {matched_pair(a, preload):.3g} N give"
        words.append("{} and {} in tandem ({})".format(*a["tandem"], side))
    if a["external_axial_N"]:
        words.append(f"external axial force {a['external_axial_N']:g} N")
    if a["spring_stiffness_N_um"]:
        words.append(f"spring stiffness {a['spring_stiffness_N_um']:g} N/um")
    if a["second"]:
        words.append("second bearing: " + ", ".join(f"{k} {v}" for k, v in a["second"].items()))
    return words


def operation_lines(scene: Mapping[str, Any]) -> tuple[str, ...]:
    """Lines on the bearing, its operating point, and whose catalogue it is of."""
    bearing, operation = scene["bearing"], scene["operation"]
    loss = scene["wear"]["ball_diameter_loss_um"]
    worn = f"{loss:g} um" if isinstance(loss, float) else "unequal"
    outer = operation.get("outer_speed_rpm")
    speeds = [f"{operation['shaft_speed_rpm']:g} r/min", *([f"outer {outer:g}"] if outer else [])]
    method = operation["preload_method"].replace("_", " ")
    parts = (
        *speeds,
        f"{method} preload {operation['preload_N']:g} N",
        *_pair_words(scene.get("arrangement") or {}, operation["preload_N"]),
        *_loads(scene),
        f"friction {_friction(scene['friction'])}",
        f"ball diameter loss {worn}",
    )
    return (
        f"{scene['name']}: {bearing['ball_count']} balls of {bearing['ball_diameter_mm']:g} mm",
        ", ".join(parts),
        *filter(None, (identity_line(bearing), speed_limit_line(bearing, operation))),
    )


def _friction(given: Mapping[str, Any]) -> str:
    """Of balls and races: a coefficient, or that of a film."""
    film = given.get("film")
    if not film:
        return f"{given['ball_race']:g}"
    thick = film.get("thickness_um")
    return f"of a film ({film['shear_strength_MPa']:g} MPa{f', {thick:g} um' if thick else ''})"
