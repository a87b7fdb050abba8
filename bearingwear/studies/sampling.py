"""How studies sample uncertain values."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Annotated

from bearingwear.scene.errors import SceneError
from bearingwear.scene.records import Key


def usable_cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


SAMPLES = 256
"""Base samples of a single life, where none are given."""


@dataclass(frozen=True, kw_only=True)
class Sampling:
    """Size and seed of a sample."""

    samples: Annotated[int, Key("Base samples, a power of two", minimum=1)] = SAMPLES
    chunks: Annotated[int, Key("Jobs that share them", minimum=1)] = 1
    seed: Annotated[int, Key("Seed of the sequence", minimum=0)] = 1

    def __post_init__(self) -> None:
        if self.samples & (self.samples - 1):
            raise SceneError("samples", f"got {self.samples}, expected a power of two")
        if self.chunks > self.samples:
            raise SceneError("chunks", f"got {self.chunks}, expected at most the samples")
