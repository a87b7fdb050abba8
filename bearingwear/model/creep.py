"""Estimates of the creep at which friction saturates, and of the QV that micro-slip takes.

They need no kernel, so they are known before any solve. `micro_slip.py` solves micro-slip itself.
"""

import functools
import math

import numpy as np

from bearingwear.model.films import friction_at
from bearingwear.model.fitted_hertz import fitted_contact
from bearingwear.model.mounted import GPA, MM, RPM, contact_modulus
from bearingwear.scene.scene import Material, Scene

NEGLIGIBLE = 0.2
"""Creep at saturation over the mean creep up to which micro-slip is negligible."""

LOSS_OF_QV = 0.06
"""Share of QV that micro-slip takes over that ratio, a fit: 0.4 to 1.3 times it in gyro_s1,
turbopump and bearing218 where the ratio is 0.2 to 1 (tests/model/test_micro_slip.py)."""

MEAN_SPIN = 0.375
"""Mean slip of a spinning contact over spin times semi-major axis times E(m)."""

# Kalker's coefficients by b/a (b along rolling) and Poisson's ratio 0, 1/4, 1/2. Source: Kalker,
# Three-Dimensional Elastic Bodies in Rolling Contact (1990), appendix E; first in Kalker (1967).
_RATIOS = np.linspace(0.1, 1.0, 10)
_POISSON = (0.0, 0.25, 0.5)
_C11 = np.array([
    [2.51, 2.59, 2.68, 2.78, 2.88, 2.98, 3.09, 3.19, 3.29, 3.40],
    [3.31, 3.37, 3.44, 3.53, 3.62, 3.72, 3.81, 3.91, 4.01, 4.12],
    [4.85, 4.81, 4.80, 4.82, 4.83, 4.91, 4.97, 5.05, 5.12, 5.20],
])  # fmt: skip
_C22 = np.array([
    [2.51, 2.59, 2.68, 2.78, 2.88, 2.98, 3.09, 3.19, 3.29, 3.40],
    [2.52, 2.63, 2.75, 2.88, 3.01, 3.14, 3.28, 3.41, 3.54, 3.67],
    [2.53, 2.66, 2.81, 2.98, 3.14, 3.31, 3.48, 3.65, 3.82, 3.98],
])  # fmt: skip
_C23 = np.array([
    [0.334, 0.483, 0.607, 0.720, 0.827, 0.930, 1.03, 1.13, 1.23, 1.33],
    [0.473, 0.603, 0.715, 0.823, 0.929, 1.03, 1.14, 1.25, 1.36, 1.47],
    [0.731, 0.809, 0.889, 0.977, 1.07, 1.18, 1.29, 1.40, 1.51, 1.63],
])  # fmt: skip


def kalker_coefficients(ratio: float, poisson: float) -> tuple[float, float, float]:
    """C11 (rolling), C22 (across), C23 (spin) of an ellipse narrow along rolling.

    Parameters
    ----------
    ratio : float
        b/a, b the semi-axis along rolling; below 0.1 taken for 0.1, where C11 and C22 are within
        1 and 4 % of their limits.
    poisson : float
        0 to 0.5.
    """
    c11, c22, c23 = (float(np.interp(ratio, _RATIOS, row)) for row in _at_poisson(poisson))
    return c11, c22, c23


@functools.cache
def _at_poisson(poisson: float) -> tuple[np.ndarray, ...]:
    """The three tables at one Poisson's ratio, by the parabola through their rows."""
    share = [math.prod((poisson - q) / (p - q) for q in _POISSON if q != p) for p in _POISSON]
    return tuple(np.array(share) @ table for table in (_C11, _C22, _C23))


def shear_of_pair(first: Material, second: Material) -> tuple[float, float]:
    """Shear modulus [Pa] and Poisson's ratio of the two like bodies that stand for these."""
    yielding = [
        2.0 * (1.0 + m.poisson_ratio) / (m.youngs_modulus_GPa * GPA) for m in (first, second)
    ]
    G = 2.0 / sum(yielding)
    ratios = (first.poisson_ratio, second.poisson_ratio)
    return G, 0.5 * G * sum(nu * y for nu, y in zip(ratios, yielding, strict=True))


def pair_of(scene: Scene) -> tuple[Material, Material]:
    """Materials of balls and races."""
    b = scene.bearing
    return scene.materials[b.ball_material], scene.materials[b.race_material]


def saturation_slip(scene: Scene, sigma: float, load: float, major: float) -> float:
    """Slip at which friction of a contact saturates elastically, 3 mu Q V/(G a b C11) [m/s].

    Parameters
    ----------
    sigma : float
        -1 inner, +1 outer race.
    load, major : float
        [N] and [m].
    """
    D, dm, alpha = _sizes(scene)
    G, nu = shear_of_pair(*pair_of(scene))
    ratio = 1.0 / _aspect(scene, sigma)[0]
    c11, _, _ = kalker_coefficients(ratio, nu)
    rolling = 0.25 * _relative_speed(scene) * dm * (1.0 - (D / dm * math.cos(alpha)) ** 2)
    mu = friction_at(scene, load / (math.pi * ratio * major**2))
    return 3.0 * mu * load * rolling / (G * ratio * major**2 * c11)


def saturation_share(scene: Scene) -> float:
    """Slip at saturation over the mean slip of a ball, before any solve; NaN without preload.

    Takes the preload at rest, all spin in the outer contact and no other slip: rather too large.
    """
    alpha, relative = _sizes(scene)[2], _relative_speed(scene)
    preload = scene.operation.preload_N
    if not (preload > 0.0 and alpha > 0.0 and relative > 0.0):
        return math.nan
    Q = preload / (scene.bearing.ball_count * math.sin(alpha))
    (_, c_i, _), (_, c_o, over_line) = (_aspect(scene, sigma) for sigma in (-1.0, 1.0))
    a_i, a_o = c_i * Q ** (1.0 / 3.0), c_o * Q ** (1.0 / 3.0)
    slip = MEAN_SPIN * relative * math.sin(alpha) * a_o * over_line
    return (saturation_slip(scene, -1.0, Q, a_i) + saturation_slip(scene, 1.0, Q, a_o)) / slip


def micro_slip_told(scene: Scene) -> str | None:
    """The sentence on micro-slip of a steady solve; none where it is negligible."""
    share = saturation_share(scene)
    if scene.model.micro_slip:
        return "elastic micro-slip: evaluated at the motion found, without feedback on it"
    if scene.model.contact == "paper" or not share > NEGLIGIBLE:
        return None
    return (
        f"elastic micro-slip: left out; it would take up to about {100.0 * LOSS_OF_QV * share:.1g} "
        "% of QV (model.micro_slip: true)"
    )


def _sizes(scene: Scene) -> tuple[float, float, float]:
    """Ball and pitch diameter [m], free contact angle [rad]."""
    b = scene.bearing
    return MM * b.ball_diameter_mm, MM * b.pitch_diameter_mm, math.radians(b.contact_angle_deg)


def _relative_speed(scene: Scene) -> float:
    """Speed of one race against the other [rad/s]."""
    o = scene.operation
    return abs(o.shaft_speed_rpm - o.outer_speed_rpm) * RPM


def _aspect(scene: Scene, sigma: float) -> tuple[float, float, float]:
    """a/b and a/Q^(1/3) of a contact, and E(m), by the fit of Brewe and Hamrock."""
    D, dm, alpha = _sizes(scene)
    b = scene.bearing
    f = b.outer_groove_factor if sigma > 0.0 else b.inner_groove_factor
    A = 0.5 * (2.0 / D - 1.0 / (f * D))
    B = 0.5 * (2.0 / D - sigma * 2.0 * math.cos(alpha) / (dm + sigma * D * math.cos(alpha)))
    _, c_a, c_b = fitted_contact(A, B, contact_modulus(*pair_of(scene)))
    return c_a / c_b, c_a, 1.0003 + 0.5968 * A / B
