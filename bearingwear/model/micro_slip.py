"""QV with elastic micro-slip, at the motion of a steady state."""

import math

import numpy as np

from bearingwear.kernels.contact import loaded_contact, slip_coefficients
from bearingwear.kernels.micro_slip import Flexibility, MicroSlip, micro_slip, rolling_speed
from bearingwear.kernels.params import Geometry, OperatingPoint
from bearingwear.kernels.summary import ANGLE, LOAD, MAJOR, MINOR
from bearingwear.model.creep import kalker_coefficients, pair_of, shear_of_pair
from bearingwear.scene.scene import Scene

STRIPS, CELLS = 200, 60
"""Per contact: QV is within 1e-3 of what finer ones give."""


def flexibility(scene: Scene, a: float, b: float) -> Flexibility:
    """Of a contact with the semi-axes a and b (along rolling) [m]."""
    G, nu = shear_of_pair(*pair_of(scene))
    c11, c22, c23 = kalker_coefficients(b / a, nu)
    return Flexibility(
        rolling=8.0 * b / (3.0 * G * c11),
        lateral=8.0 * b / (3.0 * G * c22),
        spin=math.pi * b * math.sqrt(b / a) / (4.0 * G * c23),
    )


def sums_of_contacts(
    scene: Scene, g: Geometry, op: OperatingPoint, D: float, u: np.ndarray, r: float, rows
) -> list[MicroSlip]:
    """Inner and outer contact of a ball of the diameter D [m].

    Parameters
    ----------
    u : ndarray (4,)
        (w_x, w_y, w_z, Omega) [rad/s].
    r : float
        Orbit radius [m].
    rows : ndarray (2, COLUMNS)
        `bearingwear.kernels.summary` rows.
    """
    found = []
    for k, row in enumerate(rows):
        a, b = float(row[MAJOR]), float(row[MINOR])
        sine, cosine = math.sin(row[ANGLE]), math.cos(row[ANGLE])
        contact = loaded_contact(g, op, k, float(row[LOAD]), a, b, sine, cosine)
        c = slip_coefficients(contact, u, r)
        V = rolling_speed(contact, 0.5 * D, r, float(u[3]))
        bed = flexibility(scene, a, b)
        found.append(micro_slip(contact, 0.5 * D, c, contact.mu, V, bed, STRIPS, CELLS))
    return found


def micro_slip_values(
    scene: Scene, g: Geometry, op: OperatingPoint, D: float, u: np.ndarray, r: float, rows
) -> dict:
    """Result variables of a steady state; parameters as in `sums_of_contacts`.

    None where a ball stands still against a race: nothing rolls.
    """
    if u[3] in (op.omega_i, op.omega_o):
        return {}
    sums = sums_of_contacts(scene, g, op, D, u, r, rows)
    qv, full = (np.array([getattr(s, name) for s in sums]) for name in ("qv", "full_qv"))
    return {
        "micro_slip_qv_ratio": (qv / full)[None],
        "micro_slip_total_qv_ratio": qv.sum() / full.sum(),
        "stuck_load_share": np.array([[s.stuck for s in sums]]),
    }
