"""Keys of a scene that decide its steady states and lives; other keys serve other results."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def reads_cage(data: Mapping[str, Any]) -> bool:
    """Whether a scene, as plain data, asks for results of its cage, or for the dynamic model."""
    model = data.get("model") or {}
    return bool(model.get("cage_results")) or model.get("fidelity") == "dynamic"


_UNREAD = ("description", "uncertainty", "cage_uncertainty")
"""Blocks that no solve reads."""


def decisive_data(data: Mapping[str, Any]) -> dict[str, Any]:
    """Returns plain data of a scene without description, uncertain values and unread cage keys.

    Without results of the cage, `cage` is the name of its material, or None: a life checks whether
    that material withstands its temperature.
    """
    decisive = {key: value for key, value in data.items() if key not in _UNREAD}
    if not reads_cage(data):
        decisive["friction"] = dict(data.get("friction") or {})
        decisive["friction"].pop("cage", None)
        decisive["cage"] = (data.get("cage") or {}).get("material")
    return decisive
