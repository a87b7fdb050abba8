"""That a scene was calibrated by tests, as keys of a scene; and what a test sees."""

from __future__ import annotations

from typing import NamedTuple

from bearingwear.scene.checking.records import keyed, setting

SEEN_LIFE, SEEN_RUN_OUT, SEEN_LOSS, SEEN_PRELOAD, SEEN_TORQUE = SEEN = (
    "life_h",
    "run_out_h",
    "loss_um",
    "preload_left_N",
    "torque_Nmm",
)
"""Columns of what was seen: a life, a run that had not ended, a loss of ball diameter or a residual
preload after a time, a shaft torque."""


class Seen(NamedTuple):
    """One of them in words, its unit, and its standard error where none is given, assumed [%]."""

    words: str
    unit: str
    error: float


SEEN_AS = {
    SEEN_LIFE: Seen("life", "h", 0.0),
    SEEN_RUN_OUT: Seen("run-out", "h", 0.0),
    SEEN_LOSS: Seen("loss", "um", 10.0),
    SEEN_PRELOAD: Seen("preload left", "N", 10.0),
    SEEN_TORQUE: Seen("torque", "N mm", 10.0),
}


@keyed
class Calibrated:
    """Tests from which `bearingwear calibrate` derived friction and wear coefficients of a "
    "scene."""

    tests: str = setting("Name of the file of tests", pattern=r"^[^\u0000-\u001f\u007f]*$")
    sha256: str = setting("Its SHA-256", pattern=r"^[0-9a-f]{64}$", longest=64)
    rows: int = setting("Tests in it", "1", within="[1, inf)")
