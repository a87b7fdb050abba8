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

ROUNDING = 1e-9  # relative error that the checks after a solve permit
DOUBLED = 2.0  # error over difference when the points are doubled, at the first order
HALVED = 3.5  # error over difference when the regularisation is halved, at the order 1/2
VISCOUS = 0.5  # change of the torque then, above which the slip is far below it

ROUNDED_SLIP = 0.25
"""Regularisation over the mean slip of the balls above which the lost torque is reported. At this
ratio 3 to 5 % are lost, whatever the scene (docs/verification.md)."""

COULOMB_SLIP = 0.01
"""The same ratio where 0.01 % of the torque are lost: it represents Coulomb's law."""

QUANTITY_COUNT = 5
"""QV, residual preload, loss rate, shaft torque and friction power have estimated errors."""


def estimated_quantities(values: Mapping[str, Any], balls: int) -> np.ndarray:
    """Returns the quantities (5,) whose errors are estimated, in the order of `QUANTITY_COUNT`.

    values: result variables of a case.
    balls: number of balls of the bearing.
    """
    heat = np.asarray(values["friction_heat"]).sum(axis=-1).mean()
    power = balls * heat + values["drag_power"] + values.get("cage_friction_heat", 0.0)
    names = "total_qv", "residual_preload", "ball_diameter_loss_rate", "shaft_torque"
    return np.array([*(values[name] for name in names), power])


def relative_change(reference: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Returns relative differences, without sign; 0 without any, inf over a reference of 0.

    NaN over an infinite reference, which a solve with a number that is not finite may have.
    """
    scale = np.abs(reference)
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.abs(other - reference) / scale
    return np.where(scale > 0.0, share, np.where(other == reference, 0.0, np.inf))


def regularisation_error(reference: np.ndarray, with_half: np.ndarray) -> np.ndarray:
    """Returns the relative error (5,) by the regularisation, from an answer with half of it.

    That of torque and power is infinite where slip is far below the regularisation: they are then
    in proportion to its inverse, and half of it does not show the limit.

    reference, with_half: `estimated_quantities` with the whole and with half of it.
    """
    change = relative_change(reference, with_half)
    friction = change[3:]  # of torque and power; a view
    friction[~(friction < VISCOUS)] = np.inf
    return HALVED * change


def error_values(parts: Iterable[np.ndarray]) -> dict[str, Any]:
    """Returns result variables of the sum of errors; empty if one of the first three is not finite.

    Those three are the errors of QV, preload and loss rate. Torque and power are left out by
    themselves where theirs is not finite.

    parts: relative errors (5,) by each setting, of the quantities in the order of `QUANTITY_COUNT`.
    """
    total = sum(parts, start=np.full(QUANTITY_COUNT, ROUNDING))
    qv, preload, wear_rate, torque, power = total.tolist()
    if not all(map(math.isfinite, (qv, preload, wear_rate))):
        return {}
    values = {
        "qv_error_estimate": qv,
        "residual_preload_error_estimate": preload,
        "wear_rate_error_estimate": wear_rate,
    }
    friction_values = {
        "shaft_torque_error_estimate": torque,
        "friction_power_error_estimate": power,
    }
    return values | {name: value for name, value in friction_values.items() if math.isfinite(value)}


def coulomb_regularisation(v_r: float, qv: float, load: float) -> float | None:
    """Returns a regularisation [m/s] that represents Coulomb's law; None if `v_r` does.

    qv, load: QV [W] and contact load [N] of the same contacts.
    """
    slip = qv / load if load > 0.0 else 0.0
    return COULOMB_SLIP * slip if 0.0 < ROUNDED_SLIP * slip < v_r else None


def torque_loss(torque: float, coulomb_torque: float) -> dict[str, Any]:
    """Returns the result variable of the share of the torque lost to the regularisation.

    It is left out without any torque.

    torque: with the regularisation of the scene.
    coulomb_torque: with one that represents Coulomb's law.
    """
    lost = 1.0 - torque / coulomb_torque if coulomb_torque else math.nan
    return {"torque_lost_to_regularisation": lost} if math.isfinite(lost) else {}
