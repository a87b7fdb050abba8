"""The numbers of a solved contact that files and wear need."""

import math

import numpy as np

from bearingwear.kernels.contact.film_friction import even_dissipation
from bearingwear.kernels.contact.points import area_shares, contact_points
from bearingwear.kernels.contact.profile import middle_height, profile, semi_axis
from bearingwear.kernels.contact.slip import (
    dissipation,
    loaded_contact,
    quick_dissipation,
    race_contacts,
    slip_coefficients,
    slip_velocity,
    surface_height,
)
from bearingwear.kernels.decorators import jit

# Columns of a summary row, one row a race.
LOAD, ANGLE, MAJOR, MINOR, PRESSURE, QV, HEAT, SHARE, TORQUE, SPIN, ROLL = range(11)
TRACK, FRICTION = 11, 12
COLUMNS = 13


@jit
def contact_summary(g, D, op, state, u, r, rule, buffers, out, quick):
    """Fill one row a race (columns above) for a ball in equilibrium that moves as u.

    Parameters
    ----------
    u : ndarray (4,)
        (w_x, w_y, w_z, Omega) [rad/s].
    r : float
        Orbit radius [m].
    rule : Rule
        For the ellipse.
    out : ndarray (2, COLUMNS)
    quick : bool
        Sums in any order: several times as fast, and right to rounding.
    """
    R = 0.5 * D
    contacts = race_contacts(g, op, state)
    for k in range(2):
        contact = contacts[k]
        hertz = state.hertz_i if k == 0 else state.hertz_o
        row = out[k]
        row[LOAD] = contact.Q
        row[ANGLE] = state.alpha_i if k == 0 else state.alpha_o
        row[MAJOR] = contact.a
        row[MINOR] = semi_axis(hertz.c_b, contact.Q)
        row[PRESSURE] = (
            1.5 * contact.Q / (math.pi * row[MAJOR] * row[MINOR]) if contact.Q > 0.0 else 0.0
        )
        c = slip_coefficients(contact, u, r)
        points = contact_points(rule, contact, R, c, op.v_r, buffers)
        mu = contact.mu - contact.mu_even
        row[QV], row[HEAT], row[SHARE], row[TORQUE] = (
            quick_dissipation(contact, c, mu, op.v_r, r, points)
            if quick
            else dissipation(contact, c, mu, op.v_r, r, points)
        )
        if contact.mu_even > 0.0:
            area_shares(rule, contact, R, c, op.v_r, points)
            heat, torque = even_dissipation(contact, c, op.v_r, r, points)
            row[HEAT] += heat
            row[TORQUE] += torque
        # Angular velocity of the ball against the race, along the normal and in the contact plane.
        w_rel = u[0] - contact.omega
        row[SPIN] = contact.sigma * (w_rel * contact.sin_a + u[2] * contact.cos_a)
        row[ROLL] = w_rel * contact.cos_a - u[2] * contact.sin_a
        middle = middle_height(profile(contact.r_g, R, contact.a))
        row[TRACK] = r + contact.sigma * middle * contact.cos_a
        row[FRICTION] = contact.mu


@jit
def slip_profile(g, D, op, u, r, k, row, t, h, v1, v2):
    """Slip of a ball against race k (0 inner, 1 outer), along both axes.

    Parameters
    ----------
    row : ndarray (COLUMNS,)
        Of `contact_summary`, with a load.
    t : ndarray (n,)
        Positions x/a.
    h, v1, v2 : ndarray (n,)
        Filled: height of the contact [m], slip along the major axis and along rolling [m/s].
    """
    sine, cosine = math.sin(row[ANGLE]), math.cos(row[ANGLE])
    contact = loaded_contact(g, op, k, row[LOAD], row[MAJOR], row[MINOR], sine, cosine)
    surface_height(contact, 0.5 * D, t, h)
    slip_velocity(contact, slip_coefficients(contact, u, r), t, h, v1, v2)


@jit
def slip_profiles(g, D, op, u, r, rows, t, v1, v2):
    """`slip_profile` of both contacts of all balls.

    Parameters
    ----------
    D, u, r : ndarray (balls,), (balls, 4), (balls,)
    rows : ndarray (balls, 2, COLUMNS)
    t : ndarray (n,)
    v1, v2 : ndarray (balls, 2, n)
        Filled, but for those without a load.
    """
    h = np.empty(t.size)
    for j in range(D.size):
        for k in range(2):
            if rows[j, k, LOAD] > 0.0:
                slip_profile(g, D[j], op, u[j], r[j], k, rows[j, k], t, h, v1[j, k], v2[j, k])
