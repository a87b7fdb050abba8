"""Numerical error of an answer, estimated by a few more solves.

Each setting of accuracy is changed on its own, and what that does to the answer is taken for what
the setting costs:

- the points are doubled: an error that falls at least in proportion to them is at most twice the
  difference; the regularisation is halved: where it is coarse its error falls with the square root;
- the tolerance of a step is ten times as loose: the difference is above the error as it was;
- what drift is left in time is followed to where the slow time scale ends.

The parts are added without sign. Differences of model (race control, the cage left out, ...) are no
part of it. How often the estimate is above the true error is measured (docs/accuracy.md).
"""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

ROUNDING = 1e-9  # what the checks after a solve let pass
DOUBLED = 2.0  # error over difference when the points are doubled, at the first order
HALVED = 3.5  # error over difference when the regularisation is halved, at the order 1/2
VISCOUS = 0.5  # change of the torque then, from which on slip is still far below it


MEASURED = 6
"""QV, residual preload, loss rates counted both ways, shaft torque, friction power."""


def measured(values: Mapping[str, Any], balls: int) -> np.ndarray:
    """Quantities (6,) whose errors are estimated, in the order of `MEASURED`."""
    heat = np.asarray(values["friction_heat"]).sum(axis=-1).mean()
    return np.array(
        [
            values["total_qv"],
            values["residual_preload"],
            *values["ball_diameter_loss_rate"],
            values["shaft_torque"],
            balls * heat + values["drag_power"] + values.get("cage_friction_heat", 0.0),
        ]
    )


def changed(now: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Relative differences, without sign; 0 where both vanish."""
    scale = np.abs(now)
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.abs(other - now) / scale
    return np.where(scale > 0.0, share, np.where(other == now, 0.0, np.inf))


def halved_part(now: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Error by the regularisation, from the answer (6,) with half of it.

    Where slip is far below it the torque goes by its inverse, and a half says nothing of the limit:
    infinite.
    """
    change = changed(now, other)
    friction = change[4:]
    return HALVED * np.append(change[:4], np.where(friction < VISCOUS, friction, np.inf))


def summed(parts: Iterable[np.ndarray]) -> dict[str, Any]:
    """Result variables of the parts of an error; none where a part is not known.

    Torque and power may be unknown where the others are not, and are then left out alone.
    """
    total = np.sum([np.full(MEASURED, ROUNDING), *parts], axis=0)
    qv, preload, balls, both, torque, power = total
    if not np.isfinite((qv, preload, balls, both)).all():
        return {}
    found = {
        "qv_error_estimate": qv,
        "residual_preload_error_estimate": preload,
        "wear_rate_error_estimate": np.array([balls, both]),
        "shaft_torque_error_estimate": torque,
        "friction_power_error_estimate": power,
    }
    return {name: error for name, error in found.items() if np.isfinite(error).all()}
