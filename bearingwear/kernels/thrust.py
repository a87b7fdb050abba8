"""One thrust-loaded case: solve the steady state, sum it up, check it."""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.compile import jit
from bearingwear.kernels.equilibrium import groove_distance
from bearingwear.kernels.kinematics import rolling_orbit
from bearingwear.kernels.status import BELOW_ROUNDING, CONTACT_LOST, NOT_CONVERGED, OK, UNVERIFIED
from bearingwear.kernels.steady import full_jacobian, rounding, steady_state, workspace
from bearingwear.kernels.summary import COLUMNS, SPIN, contact_summary
from bearingwear.kernels.verification import friction_check, polygon_residual

LARGEST_RESIDUAL = 1e-9  # of the friction forces, of the contact load and of the shaft power
MOST_ROUNDING = 1e-5  # of these that the last bit of the speeds may amount to instead

ROUNDING_MARGIN = 10.0  # by which its estimate may be too low, for the name of a refusal
ALL_BUT_LOST = 1e-3  # of the outer load: friction on such an inner load hardly moves the ball

OUTER_SPIN, INNER_SPIN, SHARED_SPIN, SKIDDING = range(4)
BRANCH_NAMES = ("outer_spin", "inner_spin", "shared_spin", "skidding")


class Check(NamedTuple):
    """What the checks after the solve found, all as shares [1]."""

    equilibrium: float  # of the contact load
    friction: float  # of the friction forces, same points
    discretisation: float  # of the friction forces, four times the points
    discretisation_qv: float  # of QV, four times the points
    power: float  # of the shaft power
    equilibrium_rounding: float  # what the last bits of places and speeds make of `equilibrium`,
    friction_rounding: float  # of `friction`
    power_rounding: float  # and of `power`


class ThrustCase(NamedTuple):
    """A steady state, its summary and its checks."""

    status: int
    delta_a: float  # axial displacement [m]
    u: np.ndarray  # (4,) ball angular velocity and orbit rate [rad/s]
    r: float  # orbit radius [m]
    P_r: float  # centrifugal force [N]
    S_xx: float  # axial stiffness of one ball's inner force [N/m]
    skid: float  # lag of the orbit behind pure rolling [1]
    branch: int
    iterations: int
    contacts: np.ndarray  # (2, COLUMNS), see summary.py
    jacobian: np.ndarray  # (4, 4) of the equations of motion times the inertias [N m s]
    check: Check
    held: bool  # points held at fixed places, since those of the split rule found no state


@jit
def skid_ratio(motion, state_alpha_i, state_alpha_o, R, r, u):
    """Lag of the orbit behind rolling without slip at both contact centres (Eq. 19) [1].

    The ball's own spin axis is taken; positive where the ball lags behind the turning race.
    """
    beta = math.atan2(u[2], u[3] - u[0])
    Omega, w_R = rolling_orbit(
        motion.omega_i,
        motion.omega_o,
        r / R - math.cos(state_alpha_i),
        r / R + math.cos(state_alpha_o),
        beta - state_alpha_i,
        beta - state_alpha_o,
    )
    span = abs(Omega - motion.omega_o)
    return (Omega - u[3]) / span if span > 0.0 else 0.0


@jit
def branch_of(contacts, skid):
    """Name the state by where the ball spins."""
    if abs(skid) > 0.1:
        return SKIDDING
    inner, outer = abs(contacts[0, SPIN]), abs(contacts[1, SPIN])
    if outer > 2.0 * inner:
        return OUTER_SPIN
    if inner > 2.0 * outer:
        return INNER_SPIN
    return SHARED_SPIN


@jit
def passes(found, rounding, most):
    """Whether a check found no more than is allowed, or than rounding explains up to `most`."""
    return found <= max(LARGEST_RESIDUAL, min(rounding, most))  # NaN does not


@jit
def all_pass(check, most, margin):
    """Whether all checks of a state pass, rounding counted so many times over."""
    return (
        passes(check.equilibrium, margin * check.equilibrium_rounding, most)
        and passes(check.friction, margin * check.friction_rounding, most)
        and passes(check.power, margin * check.power_rounding, most)
    )


@jit
def thrust_case(g, D, motion, preload, rule, fine_rule, start, v_start, tolerance):
    """Solve, sum up and check the steady state under thrust.

    Parameters
    ----------
    g : Geometry
    D : float
        Worn ball diameter [m].
    motion : Motion
    preload : Preload
    rule, fine_rule : Rule
        For the ellipse; the fine one has four times the points.
    start : ndarray (4,)
        Start of (w_x, w_y, w_z, Omega).
    v_start : float
        Regularisation of the first level, see `steady_state` [m/s].
    tolerance : float

    Returns
    -------
    ThrustCase
    """
    u = start.copy()
    work = workspace(rule)
    contacts = np.full((2, COLUMNS), np.nan)
    s = steady_state(g, D, motion, preload, rule, work, u, v_start, tolerance)
    state = s.state
    r = g.R_o + state.X2
    status = s.status
    if status == NOT_CONVERGED and state.Q_i < ALL_BUT_LOST * state.Q_o:
        status = CONTACT_LOST
    if status != OK:
        work.jacobian[:, :] = np.nan
        nan = math.nan
        nothing = Check(nan, nan, nan, nan, nan, nan, nan, nan)
        return ThrustCase(
            status, s.delta_a, u, r, state.P_r, math.nan, math.nan, SKIDDING, s.iterations,
            contacts, work.jacobian, nothing, False,
        )  # fmt: skip
    full_jacobian(g, D, motion, motion.v_r, preload, s.delta_a, state, u, rule, work)
    contact_summary(g, D, motion, state, u, r, rule, work, contacts)
    skid = skid_ratio(motion, state.alpha_i, state.alpha_o, 0.5 * D, r, u)
    A1, A2 = groove_distance(g, 0.0, s.delta_a, 0.0, 0.0, 0.0)
    residual, power, scale, qv = friction_check(g, D, motion, state, u, rule)
    fine_residual, _, _, fine_qv = friction_check(g, D, motion, state, u, fine_rule)
    share, watts, light = rounding(g, D, motion.mu, state, u, work.jacobian)
    check = Check(
        polygon_residual(g, D, state, A1, A2, max(state.Q_i, state.Q_o)),
        residual,
        fine_residual,
        abs(qv / fine_qv - 1.0) if fine_qv > 0.0 else 0.0,
        power,
        light,
        share,
        watts / scale,
    )
    if not all_pass(check, MOST_ROUNDING, 1.0):
        status = UNVERIFIED
        if all_pass(check, math.inf, ROUNDING_MARGIN):
            # Explained by rounding: of a load that is all but gone, or of the slip.
            gone = check.equilibrium_rounding > 0.5 * check.friction_rounding
            status = CONTACT_LOST if gone else BELOW_ROUNDING
    return ThrustCase(
        status, s.delta_a, u, r, state.P_r, state.S_xx, skid, branch_of(contacts, skid),
        s.iterations, contacts, work.jacobian, check, False,
    )  # fmt: skip
