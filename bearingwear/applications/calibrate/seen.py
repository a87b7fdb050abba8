"""Results that a test of bearings may have: the columns of a file of tests."""

from typing import NamedTuple

SEEN_LIFE, SEEN_RUN_OUT, SEEN_LOSS, SEEN_PRELOAD, SEEN_TORQUE = SEEN = (
    "life_h",
    "run_out_h",
    "loss_um",
    "preload_left_N",
    "torque_Nmm",
)
"""Columns of results: a life, a run that had not ended, a loss of ball diameter or a residual
preload after a time, a shaft torque."""


class Seen(NamedTuple):
    """A kind of result that a test may have."""

    words: str
    unit: str
    error: float  # standard error of its measurement, assumed if the file states none [%]


SEEN_AS = {
    SEEN_LIFE: Seen("life", "h", 0.0),
    SEEN_RUN_OUT: Seen("run-out", "h", 0.0),
    SEEN_LOSS: Seen("loss", "um", 10.0),
    SEEN_PRELOAD: Seen("residual preload", "N", 10.0),
    SEEN_TORQUE: Seen("torque", "N mm", 10.0),
}
