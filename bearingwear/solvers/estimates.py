"""Numerical error of an answer, estimated by a few more solves.

Each setting of accuracy is changed on its own. The change of the answer tells its error:

- the points are doubled: an error that falls at least in proportion to them is at most twice the
  difference; the regularisation is halved: where it is coarse its error falls with the square root;
- the tolerance of a step is ten times as loose: the difference is above the error as it was;
- the drift that a dynamic run still has is extrapolated over the slow time scale.

The parts are added without sign. Errors of the model (race control, no cage, ...) are not included.
docs/accuracy.md says how often the estimate exceeds the true error.
"""

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

ROUNDING = 1e-9  # what the checks after a solve let pass
DOUBLED = 2.0  # error over difference when the points are doubled, at the first order
HALVED = 3.5  # error over difference when the regularisation is halved, at the order 1/2
VISCOUS = 0.5  # change of the torque then, from which on slip is still far below it

ROUNDED_SLIP = 0.25
"""Regularisation over the mean slip of the balls above which the torque that it takes is told. At
this ratio it is 3 to 5 %, whatever the scene (docs/verification.md)."""

COULOMB_SLIP = 0.01
"""The same ratio where 0.01 % of the torque is missing: it stands for Coulomb's law."""

MEASURED = 5  # QV, residual preload, loss rate, shaft torque, friction power


def measured(values: Mapping[str, Any], balls: int) -> np.ndarray:
    """Quantities (5,) whose errors are estimated, in the order of `MEASURED`."""
    heat = np.asarray(values["friction_heat"]).sum(axis=-1).mean()
    power = balls * heat + values["drag_power"] + values.get("cage_friction_heat", 0.0)
    names = "total_qv", "residual_preload", "ball_diameter_loss_rate", "shaft_torque"
    return np.array([*(values[name] for name in names), power])


def changed(now: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Relative differences, without sign; 0 where both vanish."""
    scale, change = np.abs(now), np.abs(other - now)
    if (scale > 0.0).all():
        return change / scale
    with np.errstate(invalid="ignore", divide="ignore"):
        share = change / scale
    return np.where(scale > 0.0, share, np.where(other == now, 0.0, np.inf))


def halved_part(now: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Error by the regularisation, from the answer (5,) with half of it.

    Infinite where slip is far below it: the torque then goes with its inverse, and half of it says
    nothing of the limit.
    """
    change = changed(now, other)
    friction = change[3:]
    friction[~(friction < VISCOUS)] = np.inf
    return HALVED * change


def summed(parts: Iterable[np.ndarray]) -> dict[str, Any]:
    """Result variables of the parts of an error; none where a part is not known.

    Torque and power may be unknown where the others are not, and are then left out alone.
    """
    total = sum(parts, start=np.full(MEASURED, ROUNDING)).tolist()
    qv, preload, wear_rate, torque, power = total
    if not all(map(math.isfinite, total[:3])):
        return {}
    found = {
        "qv_error_estimate": qv,
        "residual_preload_error_estimate": preload,
        "wear_rate_error_estimate": wear_rate,
    }
    more = {"shaft_torque_error_estimate": torque, "friction_power_error_estimate": power}
    return found | {name: value for name, value in more.items() if math.isfinite(value)}


def coulomb_regularisation(v_r: float, qv: float, load: float) -> float | None:
    """Regularisation [m/s] that stands for Coulomb's law; None where `v_r` is small enough.

    By the QV [W] and the contact load [N] of the same contacts.
    """
    slip = qv / load if load > 0.0 else 0.0
    return COULOMB_SLIP * slip if 0.0 < ROUNDED_SLIP * slip < v_r else None


def torque_loss(torque: float, coulomb_torque: float) -> dict[str, Any]:
    """Result variable: the share of the torque that the regularisation takes; none of no torque."""
    lost = 1.0 - torque / coulomb_torque if coulomb_torque else math.nan
    return {"torque_lost_to_regularisation": lost} if math.isfinite(lost) else {}
