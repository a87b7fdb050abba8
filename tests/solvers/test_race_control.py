"""Jones-Harris race control: digits on which two other programs agree, and its definition."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from published_bearings import B218, MM2, NOSAKA

from bearingwear.kernels.equilibrium.kinematics import INNER_CONTROL, OUTER_CONTROL, race_control
from bearingwear.kernels.equilibrium.thrust_loaded import cold_start, thrust_equilibrium
from bearingwear.kernels.params import BallLoad
from bearingwear.kernels.status import OK

# bearing, thrust [N], speed [r/min], and the digits on which two programs agree, angles in degrees:
# delta_a, a_i, a_o, Q_i, Q_o, orbit, spin, pitch, M_g, F_c, inner spin/roll
CASES = {
    "nosaka": (NOSAKA, 2670.0, 50000.0, [5.192502e-5, 26.23256, 18.60540, 604.0509, 768.8183,
               2143.286, 12445.20, 15.45565, 0.09091663, 179.4921, 0.2462750]),
    "218": (B218, 17800.0, 10000.0, [1.475088e-5, 49.94110, 31.33649, 1453.520, 1921.563,
            476.2528, 3100.847, 26.75508, 1.472326, 636.9071, 0.5152054]),
    "2 mm": (MM2, 7.0, 30000.0, [8.741845e-7, 27.95258, 23.00838, 1.493363, 1.704299,
             1264.807, 6873.622, 18.88395, 3.677324e-5, 0.2352038, 0.2324457]),
}  # fmt: skip


def solved(g, F, rpm, law):
    """Returns shaft speed [rad/s], displacement [m], ball state and motion by a law of control.

    F: thrust [N]; rpm: shaft speed [r/min].
    """
    omega = rpm * math.pi / 30.0
    load = BallLoad(law, 0.0, omega, 0.0, 0.0, 0.0, 0.0, 0.0)
    delta_a, s = thrust_equilibrium(g, g.D0, load, F, 0.0, True, cold_start())
    assert s.status == OK
    return omega, delta_a, s, race_control(law, omega, 0.0, g.D0 / g.dm, s.alpha_i, s.alpha_o)


@pytest.mark.parametrize("name", CASES)
def test_outer_control_under_thrust_agrees_with_two_other_programs(name):
    """All numbers of CASES, to 1e-5: the digits on which these programs agree."""
    g, F, rpm, reference = CASES[name]
    omega, delta_a, s, k = solved(g, F, rpm, OUTER_CONTROL)
    m = g.rho * math.pi / 6 * g.D0**3
    # angular velocity of the ball against the inner race, along and across the contact normal
    w_x, w_z = k.Omega - k.w_R * math.cos(k.beta) - omega, k.w_R * math.sin(k.beta)
    spin = w_x * math.sin(s.alpha_i) + w_z * math.cos(s.alpha_i)
    roll = w_x * math.cos(s.alpha_i) - w_z * math.sin(s.alpha_i)
    result = [
        delta_a, math.degrees(s.alpha_i), math.degrees(s.alpha_o), s.Q_i, s.Q_o, k.Omega, k.w_R,
        math.degrees(k.beta), 0.1 * m * g.D0**2 * k.w_R * k.Omega * math.sin(k.beta),
        m * 0.5 * g.dm * k.Omega**2, abs(spin / roll),
    ]  # fmt: skip
    assert_allclose(result, reference, rtol=1e-5)


@pytest.mark.parametrize("law", [OUTER_CONTROL, INNER_CONTROL])
@pytest.mark.parametrize("speeds", [(3000.0, 0.0), (0.0, 800.0), (3000.0, -1500.0), (900.0, 900.0)])
def test_a_ball_does_not_spin_on_the_controlling_race(law, speeds):
    """By definition, there is no slip at the centres of both contacts either."""
    omega_i, omega_o = speeds
    gamma, a_i, a_o = 0.23, 0.5, 0.4
    k = race_control(law, omega_i, omega_o, gamma, a_i, a_o)
    w = np.array([k.Omega - k.w_R * math.cos(k.beta), 0.0, k.w_R * math.sin(k.beta)])
    for sigma, alpha, omega in ((-1.0, a_i, omega_i), (1.0, a_o, omega_o)):
        n = sigma * np.array([math.sin(alpha), 0.0, math.cos(alpha)])
        race = -omega * (1.0 / gamma + n[2])  # along y, ball radius 1
        ball = -k.Omega / gamma + np.cross(w, n)[1]
        assert_allclose(ball, race, atol=1e-10 * 3000.0 / gamma)
        if (law == OUTER_CONTROL) == (sigma > 0.0):
            assert_allclose((w - [omega, 0.0, 0.0]) @ n, 0.0, atol=1e-10 * 3000.0)


@pytest.mark.parametrize("law", [OUTER_CONTROL, INNER_CONTROL])
def test_gyroscopic_moment_is_carried_at_the_controlling_race(law):
    """Ball and inner race are in balance with the friction force 2 M_g/D."""
    g, F, rpm, _ = CASES["218"]
    _, _, s, k = solved(g, F, rpm, law)
    m = g.rho * math.pi / 6 * g.D0**3
    T = 0.2 * m * g.D0 * k.w_R * k.Omega * math.sin(k.beta)
    F_c = m * 0.5 * g.dm * k.Omega**2
    if law == OUTER_CONTROL:
        axial, radial = -T * math.cos(s.alpha_o), T * math.sin(s.alpha_o)
        on_race = s.Q_i * math.sin(s.alpha_i)
    else:
        axial, radial = T * math.cos(s.alpha_i), -T * math.sin(s.alpha_i)
        on_race = s.Q_i * math.sin(s.alpha_i) + axial
    balance = [
        s.Q_i * math.sin(s.alpha_i) - s.Q_o * math.sin(s.alpha_o) + axial,
        s.Q_i * math.cos(s.alpha_i) - s.Q_o * math.cos(s.alpha_o) + radial + F_c,
        g.n_balls * on_race - F,
    ]
    assert_allclose(balance, 0.0, atol=1e-9 * F)
