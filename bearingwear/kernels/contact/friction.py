"""The friction law of the ball/race contacts, in one place (theory.md Eqs. 11-12).

A point that presses with dQ and slips by v feels the friction force

    dF = mu dQ v / sqrt(|v|^2 + v_r^2),

Coulomb's law, smoothed below the slip v_r. A film adds its shear strength times the area dA in
place of mu dQ. The force is the gradient, by the slip, of the convex potential
mu dQ sqrt(|v|^2 + v_r^2). The functions give force, slope and potential for a given mu dQ or, where
a sum is scaled by mu Q afterwards, for a share of load or area.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.contact.profile import semi_axis
from bearingwear.kernels.decorators import inlined, jit


class Law(NamedTuple):
    """Friction of ball and race: under the pressure p a film is sheared at S + mu p (Eq. 79)."""

    mu: float  # coefficient of what follows the pressure, Coulomb's without a film [1]
    S: float  # shear strength of the film, 0 without one [Pa]


@inlined
def force_per_slip(load, v_2, v_r2):
    """Friction force over slip, |dF|/|v|.

    Parameters
    ----------
    load : float
        mu dQ [N], or a share of it.
    v_2 : float
        Squared slip |v|^2 [m2/s2].
    v_r2 : float
        Squared regularisation [m2/s2].
    """
    return load / math.sqrt(v_2 + v_r2)


@inlined
def force_slope(load, v1, v2, v_r2):
    """Friction force over slip, and the derivatives of the force by the slip (v1, v2).

    The derivatives are written without the difference of `force_per_slip` and its own slope, which
    would cancel where the slip is along one axis.

    Returns
    -------
    f, p_11, p_12, p_22 : float
        |dF|/|v|; dF1/dv1, dF1/dv2 = dF2/dv1, dF2/dv2.
    """
    e_2 = v1 * v1 + v_r2
    w_2 = e_2 + v2 * v2
    f = load / math.sqrt(w_2)
    f3 = f / w_2
    return f, f3 * (v2 * v2 + v_r2), -f3 * v1 * v2, f3 * e_2


@inlined
def inverse_root(value):
    """1/sqrt(value) to two digits less than the last, of a value that single precision holds.

    From the estimate of single precision by one step of third order. Root and division of double
    precision would be most of what a sum over points takes; under `ESTIMATE_ROOTS` there are none.
    """
    start = np.float64(np.float32(1.0) / math.sqrt(np.float32(value)))
    error = 1.0 - value * start * start
    return start + start * error * (0.5 + 0.375 * error)


@inlined
def quick_force_per_slip(load, v_2, v_r2):
    """`force_per_slip` where the motion in time sums it."""
    return load * inverse_root(v_2 + v_r2)


@inlined
def quick_force_slope(load, v1, v2, v_r2):
    """`force_slope` where the motion in time sums it."""
    e_2, v2_2 = v1 * v1 + v_r2, v2 * v2
    inverse = inverse_root(e_2 + v2_2)
    f = load * inverse
    f3 = f * inverse * inverse
    return f, f3 * (v2_2 + v_r2), -f3 * v1 * v2, f3 * e_2


@inlined
def potential(load, v_2, v_r2):
    """Potential of the friction force [W for a load in N]."""
    return load * math.sqrt(v_2 + v_r2)


@jit
def law_coefficients(law, Q, a, b):
    """Friction coefficient of a contact, and the part of it that is even over its ellipse [1].

    The even part is S/p_m with the mean pressure p_m.

    Parameters
    ----------
    Q, a, b : float
        Load [N] and semi-axes [m].
    """
    even = law.S * math.pi * a * b / Q if law.S > 0.0 and Q > 0.0 else 0.0
    return law.mu + even, even


@jit
def friction_coefficient(law, Q, hertz):
    """Friction coefficient of a contact [1], from its Hertz factors."""
    a = b = 0.0
    if law.S > 0.0:
        a, b = semi_axis(hertz.c_a, Q), semi_axis(hertz.c_b, Q)
    return law_coefficients(law, Q, a, b)[0]


@jit
def friction_coefficients(op, state):
    """Friction coefficients (inner, outer) of a ball in equilibrium [1]."""
    return (
        friction_coefficient(op.law_i, state.Q_i, state.hertz_i),
        friction_coefficient(op.law_o, state.Q_o, state.hertz_o),
    )


@inlined
def has_friction(op):
    """Whether anything holds a ball's gyroscopic moment."""
    return max(op.law_i.mu, op.law_i.S, op.law_o.mu, op.law_o.S) > 0.0


@inlined
def friction_capacity(mu_i, mu_o, Q_i, Q_o):
    """Largest friction force on a ball with the contact loads Q_i and Q_o, the scale of its
    balance [N]."""
    return mu_o * (Q_i + Q_o) + (mu_i - mu_o) * Q_i
