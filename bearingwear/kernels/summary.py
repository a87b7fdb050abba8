"""The numbers of a solved contact that files and wear need."""

import math

from bearingwear.kernels.compile import jit
from bearingwear.kernels.contact import dissipation, slip_coefficients, surface_height
from bearingwear.kernels.ellipse import place
from bearingwear.kernels.steady import race_contacts

# Columns of a summary row, one row a race.
LOAD, ANGLE, MAJOR, MINOR, PRESSURE, QV, HEAT, SHARE, TORQUE, SPIN, ROLL, TRACK = range(12)
COLUMNS = 12


@jit
def contact_summary(g, D, motion, state, u, r, rule, work, out):
    """Fill one row a race (columns above) for a ball in equilibrium that moves as u.

    Parameters
    ----------
    u : ndarray (4,)
        (w_x, w_y, w_z, Omega) [rad/s].
    r : float
        Orbit radius [m].
    rule : Rule
        For the ellipse.
    work : Workspace
    out : ndarray (2, COLUMNS)
    """
    R = 0.5 * D
    contacts = race_contacts(g, motion, state)
    for k in range(2):
        contact = contacts[k]
        hertz = state.hertz_i if k == 0 else state.hertz_o
        row = out[k]
        row[LOAD] = contact.Q
        row[ANGLE] = state.alpha_i if k == 0 else state.alpha_o
        row[MAJOR] = contact.a
        row[MINOR] = hertz.c_b * contact.Q ** (1.0 / 3.0)
        row[PRESSURE] = (
            1.5 * contact.Q / (math.pi * row[MAJOR] * row[MINOR]) if contact.Q > 0.0 else 0.0
        )
        c = slip_coefficients(contact, u, r)
        t, weight = place(rule, contact, R, c, motion.v_r, work.t, work.weight)
        h = work.h[k]
        surface_height(contact, R, t, h)
        row[QV], row[HEAT], row[SHARE], row[TORQUE] = dissipation(
            contact, c, motion.mu, motion.v_r, r, t, weight, h
        )
        # Angular velocity of the ball against the race, along the normal and in the contact plane.
        w_rel = u[0] - contact.omega
        row[SPIN] = contact.sigma * (w_rel * contact.sin_a + u[2] * contact.cos_a)
        row[ROLL] = w_rel * contact.cos_a - u[2] * contact.sin_a
        R_d = 2.0 * contact.r_g * R / (contact.r_g + R)
        centre = R_d - math.sqrt(R_d**2 - contact.a**2) + math.sqrt(R**2 - contact.a**2)
        row[TRACK] = r + contact.sigma * centre * contact.cos_a
