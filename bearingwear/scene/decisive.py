"""What of a scene decides its steady states and lives, and what only other results read."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def reads_cage(data: Mapping[str, Any]) -> bool:
    """Whether a scene, as plain data, asks for the motion or the wear of its cage."""
    model = data.get("model") or {}
    return bool(model.get("cage_results")) or model.get("fidelity") == "dynamic"


_UNREAD = ("description", "uncertainty", "cage_uncertainty")


def decisive_data(data: Mapping[str, Any]) -> dict[str, Any]:
    """Plain data of a scene without description, uncertain values and what cages alone read.

    Of a cage, a life knows the material, which bears its temperature or not.
    """
    left = {key: value for key, value in data.items() if key not in _UNREAD}
    if reads_cage(data):
        return left
    friction = {k: v for k, v in (data.get("friction") or {}).items() if k != "cage"}
    return left | {"friction": friction, "cage": (data.get("cage") or {}).get("material")}
