"""A line about a bearing: which one it is and how it runs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bearingwear.scene.catalogue import identity_line

_CONTACTS = {
    "paper": "contact model of the paper",
    "hertz": "Hertzian contact",
    "worn": "contact in the groove as it wears",
}


def bearing_line(scene: Mapping[str, Any]) -> str:
    """Which bearing it is and how it runs, on a line.

    Parameters
    ----------
    scene : mapping
        As a file states it; that of a study leaves out what is varied.
    """
    bearing, operation = scene["bearing"], scene["operation"]
    balls, races = (bearing[f"{part}_material"].replace("_", " ") for part in ("ball", "race"))
    loads = [
        f"{words} {value:g}\N{NO-BREAK SPACE}N"
        for words, value in (
            ("radial load", _length(operation.get("radial_load_N"))),
            ("rotating load", operation.get("rotating_load_N") or 0.0),
            ("axial force", (scene.get("arrangement") or {}).get("external_axial_N") or 0.0),
        )
        if value
    ]
    mu = scene["friction"].get("ball_race")
    drag = (scene.get("lubricant") or {}).get("drag_density_kg_m3") or 0.0
    size = [
        f"{words} {bearing[key]:g}\N{NO-BREAK SPACE}mm"
        for words, key in (("bore", "bore_mm"), ("outside", "outside_diameter_mm"))
        if bearing.get(key)
    ]
    parts = (
        *filter(None, [identity_line(bearing)]),
        *([", ".join(size)] if size else []),
        f"{bearing['ball_count']} balls of {bearing['ball_diameter_mm']:g}\N{NO-BREAK SPACE}mm "
        f"on a pitch of {bearing['pitch_diameter_mm']:g}\N{NO-BREAK SPACE}mm",
        f"contact angle {bearing['contact_angle_deg']:g}°",
        balls if balls == races else f"{balls} on {races}",
        f"{operation['shaft_speed_rpm']:g}\N{NO-BREAK SPACE}r/min",
        *([f"friction {mu:g}"] if mu is not None else []),
        _arrangement(scene.get("arrangement") or {}),
        _warmth(scene),
        *loads,
        *([f"drag density {drag:g}\N{NO-BREAK SPACE}kg/m³"] if drag else []),
        *filter(None, [_CONTACTS.get((scene.get("model") or {}).get("contact", ""))]),
    )
    return "; ".join(parts)


def _length(vector: Any) -> float:
    return float(sum(part * part for part in vector or ()) ** 0.5)


def _arrangement(arrangement: Mapping[str, Any]) -> str:
    kind = arrangement.get("kind", "single")
    words = {"single": "single bearing", "rigid_pair": "rigid pair", "spring_pair": "spring pair"}
    way = arrangement.get("orientation", "").replace("_", " ")
    return words[kind] if kind == "single" else f"{words[kind]}, {way}"


def _warmth(scene: Mapping[str, Any]) -> str:
    if scene.get("thermal"):
        return "warmed by its friction"
    given = scene.get("temperature") or {}
    parts = [
        f"{name.removesuffix('_C').replace('_', ' ')} {value:g}\N{NO-BREAK SPACE}°C"
        for name, value in given.items()
        if value is not None and name != "reference_C"
    ]
    return ", ".join(parts) or "cold"
