"""How studies sample uncertain values."""

from __future__ import annotations

import os

from bearingwear.scene.errors import SceneError
from bearingwear.scene.records import keyed, setting


def usable_cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


SAMPLES = 256
"""Base samples of a single life, where none are given."""


@keyed
class Sampling:
    """Size and seed of a sample."""

    samples: int = setting("Base samples, a power of two", minimum=1, default=SAMPLES)
    chunks: int = setting("Jobs that share them", minimum=1, default=1)
    seed: int = setting("Seed of the sequence", minimum=0, default=1)

    def __post_init__(self) -> None:
        if self.samples & (self.samples - 1):
            raise SceneError("samples", f"got {self.samples}, expected a power of two")
        if self.chunks > self.samples:
            raise SceneError("chunks", f"got {self.chunks}, expected at most the samples")
