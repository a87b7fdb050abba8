"""Slip of a scene by its kinematics, and the regularisation of friction that is small against it.

Coulomb's law is regularised below a slip speed v_r. Its error depends on v_r over the slip alone,
so an allowed error asks for less v_r where a bearing turns slowly.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from bearingwear.scene.accuracy import accuracy_preset

if TYPE_CHECKING:
    from bearingwear.scene.scene import Material, Scene

SLOW_SLIP = 0.01
"""Mean slip [m/s] down to which a preset's regularisation serves. `standard` is 1 % of it, and the
torque 0.01 % too small; below, its regularisation stays 1 % of the slip (docs/verification.md)."""

LEAST_REGULARISATION = 1e-9  # [m/s], the least that the key takes

LEAST_SEMI_AXIS = 0.01
"""Semi-major axis over ball diameter that is assumed of a contact with less or without load."""

_GIVEN = "_regularisation_is_given"
"""Marks the friction of a scene whose regularisation was given, even if as the default has it."""

_MM, _GPA = 1e-3, 1e9
_RPM = math.pi / 30.0  # [rad/s]


def default_regularisation(scene: Scene) -> float:
    """Returns the regularisation [m/s] of a scene that gives none.

    It is that of the preset. Where the slip is slow, it is less in proportion, with two digits, so
    that it can be read and typed. A scene at rest, which has no slip, has that of the preset.
    """
    preset = accuracy_preset(scene.model.accuracy).slip_regularisation_m_s
    slip = mean_slip(scene)
    if not 0.0 < slip < SLOW_SLIP:
        return preset
    return max(float(f"{preset * slip / SLOW_SLIP:.2g}"), LEAST_REGULARISATION)


def with_regularisation(scene: Scene, is_given: bool) -> Scene:
    """Returns the scene with the default regularisation for its slip, unless it has its own.

    is_given: whether the scene states a regularisation. Then the scene itself is returned, and its
        friction is marked, so that the value stays when the slip changes.
    """
    if is_given:
        scene.friction.__dict__[_GIVEN] = True
        return scene
    default = default_regularisation(scene)
    if default == scene.friction.slip_regularisation_m_s:
        return scene
    return replace(scene, friction=replace(scene.friction, slip_regularisation_m_s=default))


def regularisation_is_given(scene: Scene) -> bool:
    """Whether the regularisation of a scene was given, by its mark or by another value."""
    friction = scene.friction
    if _GIVEN in friction.__dict__:
        return True
    return friction.slip_regularisation_m_s != default_regularisation(scene)


def at_speed_share(scene: Scene, share: float) -> Scene:
    """Returns a scene whose shaft and outer race turn at a share of their speeds.

    A default regularisation follows the slip at the new speeds.
    """
    operation = scene.operation
    shaft_speed = share * operation.shaft_speed_rpm
    slower = replace(
        operation,
        shaft_speed_rpm=shaft_speed,
        lowest_speed_rpm=min(operation.lowest_speed_rpm, shaft_speed),
        outer_speed_rpm=share * operation.outer_speed_rpm,
    )
    return with_regularisation(replace(scene, operation=slower), regularisation_is_given(scene))


def mean_slip(scene: Scene) -> float:
    """Estimates the mean slip speed of balls on races by rolling at the free contact angle [m/s].

    It is the sum of two slips. The spin of one contact (outer race control) is 3/16 a omega
    sin(alpha) in the mean of both contacts under a Hertzian load. The slip of a curved contact
    (Heathcote) is 0.26 V (a/D)^2.
    """
    bearing, operation = scene.bearing, scene.operation
    omega = abs(operation.shaft_speed_rpm - operation.outer_speed_rpm) * _RPM
    D, dm = _MM * bearing.ball_diameter_mm, _MM * bearing.pitch_diameter_mm
    a, sine = _semi_axis(scene), math.sin(math.radians(bearing.contact_angle_deg))
    # V = omega dm/4 is the speed at which a ball rolls over either race
    return omega * (3.0 / 16.0 * a * sine + 0.26 * 0.25 * dm * (a / D) ** 2)


def _semi_axis(scene: Scene) -> float:
    """Returns the semi-major axis [m] of the inner contact, by Brewe and Hamrock's fit (1977).

    It is that of the most loaded ball at the free contact angle, without centrifugal force, and at
    least `LEAST_SEMI_AXIS` ball diameters. At an angle of 0, the preload is left out.
    """
    bearing, operation = scene.bearing, scene.operation
    D, dm = _MM * bearing.ball_diameter_mm, _MM * bearing.pitch_diameter_mm
    alpha = math.radians(bearing.contact_angle_deg)
    radial_load = math.hypot(*operation.radial_load_N) + abs(operation.rotating_load_N)
    # Z times the load of the most loaded ball, which by Stribeck has 5/Z of a radial load
    load = 5.0 * radial_load / math.cos(alpha)
    if alpha > 0.0:
        load += operation.preload_N / math.sin(alpha)
    # half the curvatures across and along the direction of rolling, the fit of ellipticity and
    # elliptic integral by their ratio
    A = 1.0 / D - 0.5 / (bearing.inner_groove_factor * D)
    B = 1.0 / D + math.cos(alpha) / (dm - D * math.cos(alpha))
    kappa = 1.0339 * (B / A) ** 0.636
    E = 1.0003 + 0.5968 * A / B
    ball = scene.materials[bearing.ball_material]
    race = scene.materials[bearing.race_material]
    E_star = 1.0 / (_compliance(ball) + _compliance(race))
    cube = 3.0 * E * load / bearing.ball_count / (2.0 * math.pi * kappa * E_star * (A + B))
    return max(kappa * cube ** (1.0 / 3.0), LEAST_SEMI_AXIS * D)


def _compliance(material: Material) -> float:
    """Returns (1 - nu^2)/E of a material [1/Pa]."""
    return (1.0 - material.poisson_ratio**2) / (material.youngs_modulus_GPa * _GPA)
