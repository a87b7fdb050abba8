"""Estimates of the numerical error of an answer, made after the solve by solving a little more.

Each setting of accuracy is changed on its own, and what that does to the answer is taken for what
the setting costs:

- the points are doubled: an error that falls at least in proportion to them is at most twice the
  difference; the regularisation is halved: where it is coarse its error falls with the square root;
- the tolerance of a step is ten times as loose: the difference is above the error as it was;
- what drift is left in time is followed to where the slow time scale ends.

The parts are added without sign. Differences of model (race control, the cage left out, ...) are no
part of it. How often the estimate is above the true error is measured (docs/accuracy.md).
"""

from collections.abc import Iterable
from typing import Any

import numpy as np

ROUNDING = 1e-9  # what the checks after a solve let pass
DOUBLED = 2.0  # error over difference when the points are doubled, at the first order
HALVED = 3.5  # error over difference when the regularisation is halved, at the order 1/2


def measured(values: dict[str, Any]) -> np.ndarray:
    """What errors are estimated of (4,): QV, residual preload, loss rates counted both ways."""
    return np.array(
        [values["total_qv"], values["residual_preload"], *values["ball_diameter_loss_rate"]]
    )


def changed(now: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Relative differences, without sign; 0 where both vanish."""
    scale = np.abs(now)
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.abs(other - now) / scale
    return np.where(scale > 0.0, share, np.where(other == now, 0.0, np.inf))


def summed(parts: Iterable[np.ndarray]) -> dict[str, Any]:
    """Result variables of the parts of an error; none where a part is not known."""
    total = np.sum([np.full(4, ROUNDING), *parts], axis=0)
    if not np.isfinite(total).all():
        return {}
    return {
        "qv_error_estimate": total[0],
        "residual_preload_error_estimate": total[1],
        "wear_rate_error_estimate": total[2:],
    }
