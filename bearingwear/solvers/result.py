"""The result of a solve, independent of any file format."""

import functools
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from bearingwear.kernels.status import STATUS_NAMES, STATUS_SENTENCES

WITHOUT_PRELOAD = "no preload is set (operation.preload_N is 0), so the balls carry no load"


@dataclass
class Result:
    """Values of one solve, by the names of `bearingwear.results.variables`, in SI and radians."""

    values: dict[str, Any]
    attrs: dict[str, Any] = field(default_factory=dict)
    wall_time_s: float = 0.0  # of the solve alone

    @property
    def status(self) -> str:
        return STATUS_NAMES[int(self.values["status"])]

    @functools.cached_property
    def scene(self) -> Mapping[str, Any]:
        """The scene as plain data, empty if unknown; do not write to it."""
        return json.loads(self.attrs.get("scene", "{}"))

    @property
    def reason(self) -> str:
        return status_sentence(self.status, self.scene)


def status_sentence(status: str, scene: Mapping[str, Any]) -> str:
    """Meaning of a status for a scene, which may be empty if unknown."""
    if status == "preload_gone" and scene.get("operation", {}).get("preload_N") == 0.0:
        return WITHOUT_PRELOAD
    return STATUS_SENTENCES[status]
