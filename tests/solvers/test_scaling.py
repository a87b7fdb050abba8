"""Symmetries and scaling laws that any answer must obey, to rounding."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from support import scene_file

from bearingwear.kernels import status as code
from bearingwear.scene.read import load_scene
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.solve import solve

# What Newton leaves: 1e-12 of the friction forces, times the softness of the slow spin-axis drift.
SOLVED = 1e-7


def gyro(method, mu, loss):
    """Returns gyro_s1 with a method of preload, a friction and a loss of ball diameter [um]."""
    return load_scene(
        scene_file("gyro_s1"),
        [
            f"operation.preload_method={method}",
            f"friction.ball_race={mu:.6f}",
            f"wear.ball_diameter_loss_um={loss:.6f}",
        ],
    )


methods = st.sampled_from(["constant_force", "fixed_position"])
frictions = st.floats(0.01, 0.3)
losses = st.floats(0.0, 0.8)


@settings(max_examples=30, deadline=None, derandomize=True)
@given(method=methods, mu=frictions, loss=losses, s=st.floats(0.3, 8.0))
def test_similar_bearings_have_similar_states(method, mu, loss, s):
    """Lengths x s, loads x s^2, speed / s, v_r the same: QV x s^2, pressure and slip the same."""
    base = gyro(method, mu, loss)
    result, scaled_result = solve(base), solve(scaled(base, s))
    assert result.status == scaled_result.status == "ok"
    values, scaled_values = result.values, scaled_result.values
    assert_allclose(scaled_values["contact_load"], s**2 * values["contact_load"], rtol=1e-8)
    assert_allclose(scaled_values["maximum_pressure"], values["maximum_pressure"], rtol=1e-8)
    assert_allclose(scaled_values["contact_angle"], values["contact_angle"], rtol=1e-8)
    assert_allclose(scaled_values["qv"], s**2 * values["qv"], rtol=SOLVED)
    assert_allclose(scaled_values["orbit_speed"], values["orbit_speed"] / s, rtol=SOLVED)


def scaled(scene, s):
    """Returns the scene of a bearing s times as large, with s^2 the loads and 1/s the speed."""
    b, o = scene.bearing, scene.operation
    return replace(
        scene,
        cage=None,
        bearing=replace(
            b,
            ball_diameter_mm=s * b.ball_diameter_mm,
            pitch_diameter_mm=s * b.pitch_diameter_mm,
        ),
        operation=replace(o, shaft_speed_rpm=o.shaft_speed_rpm / s, preload_N=s * s * o.preload_N),
        wear=replace(
            scene.wear,
            ball_diameter_loss_um=tuple(s * x for x in scene.wear.ball_diameter_loss_um),
            end_of_life=None,
        ),
    )


@settings(max_examples=30, deadline=None, derandomize=True)
@given(method=methods, mu=frictions, loss=losses, outer=st.floats(-20000.0, 20000.0))
def test_mirror_image_turns_the_other_way(method, mu, loss, outer):
    """Mirrored in a plane through the axis: w_x, w_z, Omega change sign, w_y and QV do not."""
    problem = ThrustProblem.of(gyro(method, mu, loss))
    D = problem.g.D0 - loss * 1e-6
    omega_i, omega_o = 3141.59, outer * np.pi / 30
    cases = []
    for sign in (1.0, -1.0):
        motion = problem.op._replace(
            omega_i=sign * omega_i, omega_o=sign * omega_o, v_r=1e-3, drag=200.0
        )
        cases.append(replace(problem, op=motion).solve(D))
    assert cases[0].status == cases[1].status
    if cases[0].status == code.OK:
        scale = np.abs(cases[0].u).max()
        mirror = np.array([-1.0, 1.0, -1.0, -1.0])
        assert_allclose(cases[1].u, mirror * cases[0].u, atol=SOLVED * scale)
        # loads, angles, axes, QV and heat; torque and angular velocities change sign with u
        assert_allclose(cases[1].contacts[:, :7], cases[0].contacts[:, :7], rtol=1e-5, atol=1e-9)


@pytest.mark.parametrize("tilt", [0.0, 1.0])
def test_a_mirrored_radial_load_mirrors_the_balls(tilt):
    """Load along -Y instead of +Y: the balls at psi and -psi change places."""
    values = [
        solve(
            load_scene(
                scene_file("gyro_s1"),
                [f"operation.radial_load_N=[{y}, 1.0]", f"operation.tilt_mrad={tilt}"],
            ),
            "race_control",
        ).values
        for y in (1.5, -1.5)
    ]
    order = [0, *range(8, 0, -1)]
    for name in ("contact_load", "contact_angle", "qv", "orbit_speed"):
        assert_allclose(values[1][name], values[0][name][order], rtol=1e-9)


def test_a_load_turned_by_one_ball_pitch_moves_every_value_on_by_one_ball():
    """2 N turn by 40 degrees from Z towards -Y, the way in which azimuths of balls count."""
    psi = 2.0 * np.pi / 9
    loads = ([0.0, 2.0], [-2.0 * np.sin(psi), 2.0 * np.cos(psi)])
    values = [
        solve(
            load_scene(scene_file("gyro_s1"), [f"operation.radial_load_N=[{y:.15f}, {z:.15f}]"]),
            "race_control",
        ).values
        for y, z in loads
    ]
    for name in ("contact_load", "contact_angle", "qv"):
        assert_allclose(values[1][name], np.roll(values[0][name], 1, axis=0), rtol=1e-9)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(
    speed=st.floats(100.0, 100000.0),
    preload=st.floats(0.5, 100.0),
    mu=st.floats(0.005, 0.5),
    loss=st.floats(0.0, 3.0),
    outer=st.floats(-20000.0, 20000.0),
    drag=st.floats(0.0, 400.0),
    angle=st.floats(10.0, 40.0),
    groove=st.floats(0.52, 0.6),
    method=methods,
)
def test_every_answer_is_verified_or_refused(
    speed, preload, mu, loss, outer, drag, angle, groove, method
):
    """Any scene ends as ok with closed balances, or with a status; never NaN, never unverified."""
    result = solve(
        load_scene(
            scene_file("gyro_s1"),
            [
                f"operation.shaft_speed_rpm={speed:.6f}",
                f"operation.preload_N={preload:.6f}",
                f"operation.outer_speed_rpm={outer:.6f}",
                f"operation.preload_method={method}",
                f"friction.ball_race={mu:.6f}",
                f"wear.ball_diameter_loss_um={loss:.6f}",
                f"lubricant.drag_density_kg_m3={drag:.6f}",
                f"bearing.contact_angle_deg={angle:.6f}",
                f"bearing.inner_groove_factor={groove:.6f}",
                "cage=null",
            ],
        )
    )
    assert result.status in ("ok", "contact_lost", "preload_gone", "beyond_groove")
    for name, value in result.values.items():
        assert np.all(np.isfinite(value)), name
    if result.status == "ok":
        values = result.values
        assert values["friction_residual"] <= 1e-9
        assert values["power_balance_error"] <= 1e-9
        assert np.all(values["friction_heat"] <= mu * values["qv"] * (1 + 1e-12))
