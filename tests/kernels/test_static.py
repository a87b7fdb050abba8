"""Static load distribution against a commercial program (github minzhun/ISO16281)."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq

from bearingwear.kernels.equilibrium.race import PACKED, race_equilibrium
from bearingwear.kernels.params import Geometry
from bearingwear.kernels.status import OK

TOLERANCE = 1e-3  # of the reference program; re-solved independently to 1e-4


def deep_groove(clearance):
    """Returns the geometry of the reference program's deep-groove bearing.

    clearance: diametral [m]; the free contact angle is acos(1 - clearance/2A), with the distance A
    of the groove centres.
    """
    D, dm, A = 11.5e-3, 43.5e-3, 0.05 * 11.5e-3
    alpha0 = math.acos(1.0 - clearance / (2.0 * A))
    R_o = 0.5 * dm - 0.03 * D * math.cos(alpha0)
    # The tilt lever of the reference program is dm/2.
    return Geometry(
        7, D, dm, alpha0, A, R_o, 0.5 * dm, 0.52 * D, 0.53 * D, 210e9 / (2 * 0.91), 7800.0
    )


def race_at_rest(g, F_a, F_r, start=(0.0, 0.0, 0.0), tilt=0.0):
    """Returns displacement (3,) [m], packed balls and azimuths in equilibrium with forces [N].

    start: displacement to start from (3,) [m]. tilt: [rad].
    """
    psi = 2 * np.pi * np.arange(g.n_balls) / g.n_balls
    rows, delta = np.empty((g.n_balls, PACKED)), np.array(start)
    status, residual, _ = race_equilibrium(
        g,
        np.full(g.n_balls, g.D0),
        np.zeros((g.n_balls, 6)),  # balls without orbit or forces of their own
        psi,
        np.array([F_a, 0.0, F_r]),
        tilt,
        0,  # the race moves in all directions from the first on
        delta,
        rows,
    )
    assert status == OK
    assert residual < 1e-9 * 1000.0  # [N], of the loads here
    return delta, rows, psi


@pytest.mark.parametrize(
    ("F_a", "F_r", "axis", "reference"),
    [(0.0, 1000.0, 2, 15.1101e-6), (1000.0, 0.0, 0, 133.5381e-6)],
)
def test_displacements_under_one_load_are_those_of_a_commercial_program(F_a, F_r, axis, reference):
    """In the other directions, the race does not move."""
    delta, _, _ = race_at_rest(deep_groove(0.0), F_a, F_r)
    assert_allclose(delta[axis], reference, rtol=TOLERANCE)
    assert_allclose(np.delete(delta, axis), 0.0, atol=1e-12)


def test_a_combined_load_with_free_tilt_agrees_with_a_commercial_program():
    """The loads are 1000 N radial and axial, the clearance is 0.01 mm, and there is no moment.

    The axial displacement counts from where both grooves have one plane.
    """
    g = deep_groove(1e-5)

    def moment(tilt):
        _, rows, psi = race_at_rest(g, 1000.0, 1000.0, (1e-5, 0.0, 1e-5), tilt)
        axial_force = rows[:, 17]  # of each ball on the inner race
        return (axial_force * np.cos(psi) * g.R_i).sum()

    tilt = brentq(moment, -6e-3, 6e-3, xtol=1e-14)
    delta, _, _ = race_at_rest(g, 1000.0, 1000.0, (1e-5, 0.0, 1e-5), tilt)
    axial = delta[0] + g.BD * math.sin(g.alpha0)
    assert_allclose(
        [delta[2], axial, abs(tilt)], [19.5923e-6, 146.4603e-6, 2.6872e-3], rtol=TOLERANCE
    )


def test_a_heavy_radial_load_unloads_the_far_balls():
    """The balls that stay loaded carry the whole load."""
    g = deep_groove(0.0)
    _, rows, psi = race_at_rest(g, 200.0, 3000.0)
    alpha_i, Q_i = rows[:, 3], rows[:, 5]
    assert 0 < (Q_i == 0.0).sum() < g.n_balls
    radial = (Q_i * np.cos(alpha_i) * np.cos(psi)).sum()
    axial = (Q_i * np.sin(alpha_i)).sum()
    assert_allclose([radial, axial], [3000.0, 200.0], rtol=1e-10)
