"""Steady states with slip over the whole ellipse, against numbers found apart from this program."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bearingwear.kernels import status as code
from bearingwear.kernels.contact.summary import ANGLE, QV
from bearingwear.lives.life import life
from bearingwear.solvers.bearing.parameters import ellipse_rule
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.solve import solve

HERTZ = {
    "model.contact": "hertz",
    "model.normal_balance": "frictionless",
    "friction.slip_regularisation_m_s": 1e-3,
}
HELD = {"operation.preload_method": "fixed_position"}

# Plain NumPy and SciPy, Chebyshev points across, converged to 1e-6: QV of a ball, in all, inner and
# outer [W]; contact angles, inner and outer [deg]; orbit speed [rad/s].
WRITTEN_APART = [
    ("gyro_s1", {}, 0.0, (0.0748280, 0.0152525, 0.0595755), (21.52602, 19.95774), 1177.73170),
    ("gyro_s1", {}, 0.5, (0.0745506, 0.0149229, 0.0596277), (21.85507, 20.24134), 1178.53334),
    ("gyro_s1", HELD, 0.0, (0.0790467, 0.0163537, 0.0626930), (21.49408, 19.99564), 1177.83301),
    ("gyro_s1", HELD, 0.5, (0.0280671, 0.0152706, 0.0127965), (23.27473, 19.15567), 1180.93388),
    ("turbopump", {}, 0.0, (192.556, 133.555, 59.0014), (24.39476, 15.70489), 2232.85362),
]


@pytest.mark.parametrize(("name", "changes", "loss_um", "qv", "angles", "orbit"), WRITTEN_APART)
def test_steady_states_agree_with_a_program_written_apart(
    scene, name, changes, loss_um, qv, angles, orbit
):
    """Angles and orbit speed to 1e-6, to which the other program has converged.

    QV to 1e-4: this program places its points across by another rule.
    """
    accurate = {"model.quadrature": "split", "model.strips": 100, "model.points_across": 32}
    problem = ThrustProblem.of(scene(name, HERTZ | accurate | changes))
    case = problem.solve(problem.g.D0 - 1e-6 * loss_um)
    assert case.status == code.OK
    of_contacts = case.contacts[:, QV]
    assert_allclose([of_contacts.sum(), *of_contacts], qv, rtol=1e-4)
    assert_allclose(np.degrees(case.contacts[:, ANGLE]), angles, rtol=1e-6)
    assert_allclose(case.u[3], orbit, rtol=1e-6)


def test_angular_velocity_of_a_ball_agrees_with_a_program_written_apart(scene):
    """Axial, tangential and radial [rad/s], of gyro_s1 when new. The tangential one is small."""
    problem = ThrustProblem.of(scene("gyro_s1", HERTZ | {"model.accuracy": "reference"}))
    u = problem.solve(problem.g.D0).u
    assert_allclose(u[:3], [-3792.54113, 0.88930, 2498.85580], rtol=1e-6, atol=1e-4)


@pytest.mark.parametrize("name", ["gyro_s1", "turbopump", "bearing218"])
@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
@pytest.mark.parametrize("mu", [0.02, 0.08])
@pytest.mark.parametrize("loss_um", [0.0, 0.5])
def test_default_points_have_qv_to_a_thousandth(scene, name, method, mu, loss_um):
    """They are 20 strips and 8 points across; the exact QV is that of 100 and 32."""
    changes = {"operation.preload_method": method, "friction.ball_race": mu}
    problem = ThrustProblem.of(scene(name, HERTZ | changes))
    D = problem.g.D0 - 1e-6 * loss_um
    case = problem.solve(D)
    fine_rule = ellipse_rule("split", 100, 32)
    fine = replace(problem, rule=fine_rule, fine_rule=fine_rule).solve(D)
    assert case.status == fine.status == code.OK
    assert_allclose(case.contacts[:, QV].sum(), fine.contacts[:, QV].sum(), rtol=1e-3)


def test_slip_on_the_line_is_the_model_of_the_paper(scene):
    paper = solve(scene("gyro_s1", {"model.contact": "paper"}), "steady").values
    line = {
        "model.contact": "hertz",
        "model.slip_over": "line",
        "model.normal_balance": "frictionless",
    }
    on_line = solve(scene("gyro_s1", line), "steady").values
    assert (on_line["qv"] == paper["qv"]).all()


def test_slow_torque_goes_with_the_power_four_thirds(scene):
    """So does the sliding torque of the SKF friction model, G_sl ~ F_a^(4/3).

    Loads differ 16-fold. It agrees to 2 %, because the contact angle opens with the load.
    """
    torque_over_power = []
    for load in (125.0, 500.0, 2000.0):
        changes = {
            "operation.preload_N": load,
            "operation.shaft_speed_rpm": 10.0,
            "friction.slip_regularisation_m_s": 1e-7,  # far below the slip at this speed
        }
        values = solve(scene("bearing218", HERTZ | changes), "steady").values
        assert values["status"] == code.OK
        torque_over_power.append(values["shaft_torque"] / load ** (4 / 3))
    assert_allclose(torque_over_power, torque_over_power[1], rtol=2e-2)


@pytest.mark.parametrize(
    ("method", "hours"), [("constant_force", 1.2101), ("fixed_position", 1.2208)]
)
def test_life_with_even_wear_agrees_with_a_program_written_apart(scene, method, hours):
    """Hours to a loss of 0.7 um or to 40 % of the preload; the other program has them to 0.2 %."""
    values = life(scene("gyro_s1", HERTZ | {"operation.preload_method": method})).values
    assert_allclose(values["life"] / 3600.0, hours, rtol=2e-3)
