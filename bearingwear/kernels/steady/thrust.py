"""One thrust-loaded case: solve the steady state, sum it up, check it."""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.ball import ball_mass
from bearingwear.kernels.contact.summary import COLUMNS, SPIN, contact_summary
from bearingwear.kernels.contact.verification import friction_check, polygon_residual
from bearingwear.kernels.decorators import compile_together, jit
from bearingwear.kernels.equilibrium.kinematics import rolling_orbit
from bearingwear.kernels.equilibrium.thrust_loaded import groove_distance
from bearingwear.kernels.status import BELOW_ROUNDING, CONTACT_LOST, NOT_CONVERGED, OK, UNVERIFIED
from bearingwear.kernels.steady.balance import (
    add_load_columns,
    balance_problem,
    friction_balance,
    motion_load,
    rounding,
)
from bearingwear.kernels.steady.linear_response import (
    find_exact_changes,
    linear_response,
    quasistatic_stiffness,
)
from bearingwear.kernels.steady.search import settled_elsewhere
from bearingwear.kernels.steady.solver import steady_state, unknowns

LARGEST_RESIDUAL = 1e-9  # of the friction forces, of the contact load and of the shaft power
MOST_ROUNDING = 1e-5  # of these that the last bit of the speeds may amount to instead

ROUNDING_MARGIN = 10.0  # by which its estimate may be too low, for the name of a refusal
ALL_BUT_LOST = 1e-3  # of the outer load: friction on such an inner load hardly moves the ball

SKIDS = 0.1  # lag of the orbit above which a ball skids
SPINS_MORE = 2.0  # by so much one contact must spin more than the other, else both share the spin

OUTER_SPIN, INNER_SPIN, SHARED_SPIN, SKIDDING = range(4)
BRANCH_NAMES = ("outer_spin", "inner_spin", "shared_spin", "skidding")


class Residuals(NamedTuple):
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
    T_i: float  # traction that bears on the balance of normal forces, inner and outer [N]
    T_o: float
    r: float  # orbit radius [m]
    P_r: float  # centrifugal force [N]
    S_xx: float  # axial stiffness of one ball's inner force, friction held [N/m]
    S_quasistatic: float  # the same, motion and friction following the place [N/m]
    response: np.ndarray  # (k + 2, k + 2) of k unknowns, see linear_response.py
    skid: float  # lag of the orbit behind pure rolling [1]
    branch: int
    iterations: int
    contacts: np.ndarray  # (2, COLUMNS), see summary.py
    jacobian: np.ndarray  # (4, 4) of the equations of motion times the inertias [N m s]
    residuals: Residuals
    held: bool  # points held at fixed places, since those of the split rule found no state

    @property
    def motion(self) -> np.ndarray:
        """(w_x, w_y, w_z, Omega) [rad/s] and (T_i, T_o) [N]: the start of a solve nearby."""
        return np.array([*self.u, self.T_i, self.T_o])


@jit
def skid_ratio(op, alpha_i, alpha_o, R, r, u):
    """Lag of the orbit behind rolling without slip at both contact centres (Eq. 19) [1].

    The ball's own spin axis is taken; positive where the ball lags behind the turning race.
    """
    beta = math.atan2(u[2], u[3] - u[0])
    Omega, w_R = rolling_orbit(
        op.omega_i,
        op.omega_o,
        r / R - math.cos(alpha_i),
        r / R + math.cos(alpha_o),
        beta - alpha_i,
        beta - alpha_o,
    )
    span = abs(Omega - op.omega_o)
    return (Omega - u[3]) / span if span > 0.0 else 0.0


@jit
def branch_of(contacts, skid):
    """Name the state by where the ball spins."""
    if abs(skid) > SKIDS:
        return SKIDDING
    inner, outer = abs(contacts[0, SPIN]), abs(contacts[1, SPIN])
    if outer > SPINS_MORE * inner:
        return OUTER_SPIN
    if inner > SPINS_MORE * outer:
        return INNER_SPIN
    return SHARED_SPIN


@jit
def passes(found, rounding, most):
    """Whether a check found no more than is allowed, or than rounding explains up to `most`."""
    return found <= max(LARGEST_RESIDUAL, min(rounding, most))  # NaN does not


@jit
def all_pass(residuals, most, margin):
    """Whether all checks of a state pass, rounding counted so many times over."""
    return (
        passes(residuals.equilibrium, margin * residuals.equilibrium_rounding, most)
        and passes(residuals.friction, margin * residuals.friction_rounding, most)
        and passes(residuals.power, margin * residuals.power_rounding, most)
    )


@jit
def case_status(residuals):
    """Status of a converged state by its residuals: OK, or why it must not be used."""
    if all_pass(residuals, MOST_ROUNDING, 1.0):
        return OK
    if not all_pass(residuals, math.inf, ROUNDING_MARGIN):
        return UNVERIFIED
    # Explained by rounding: of a load that is all but gone, or of the slip.
    gone = residuals.equilibrium_rounding > 0.5 * residuals.friction_rounding
    return CONTACT_LOST if gone else BELOW_ROUNDING


@jit
def checked(p, seat, u, fine_rule):
    """Residuals of a solved state, by formulas the solver does not use (verification.py).

    Parameters
    ----------
    p : BalanceProblem
        Its `jacobian` is that of the state.
    u : ndarray (4,)
        (w_x, w_y, w_z, Omega) [rad/s].
    fine_rule : Rule
        With as many points as the solver's it is the same.
    """
    state = seat.state
    g, D, op = p.bearing.g, p.bearing.D, p.bearing.op
    A1, A2 = groove_distance(g, 0.0, seat.delta_a, 0.0, 0.0, 0.0)
    bears = p.bearing.traction
    residual, power, scale, qv = friction_check(g, D, op, state, u, p.rule, bears)
    fine_residual, fine_qv = residual, qv
    if fine_rule.t.size != p.rule.t.size or fine_rule.across.size != p.rule.across.size:
        fine_residual, _, _, fine_qv = friction_check(g, D, op, state, u, fine_rule, bears)
    noise = rounding(p.bearing, state, u, p.jacobian)
    return Residuals(
        equilibrium=polygon_residual(g, D, state, A1, A2, max(state.Q_i, state.Q_o)),
        friction=residual,
        discretisation=fine_residual,
        discretisation_qv=abs(qv / fine_qv - 1.0) if fine_qv > 0.0 else 0.0,
        power=power,
        equilibrium_rounding=noise.light,
        friction_rounding=noise.share,
        power_rounding=noise.power / scale,
    )


@jit
def unsolved(p, s, u, contacts):
    """The case of a solve that failed; what was not found is NaN."""
    state, nan = s.seat.state, math.nan
    status = s.status
    if status == NOT_CONVERGED and state.Q_i < ALL_BUT_LOST * state.Q_o:
        status = CONTACT_LOST
    p.jacobian[:, :] = nan
    return ThrustCase(
        status=status,
        delta_a=s.seat.delta_a,
        u=u[:4].copy(),
        T_i=nan,
        T_o=nan,
        r=p.bearing.g.R_o + state.X2,
        P_r=nan,
        S_xx=nan,
        S_quasistatic=nan,
        response=np.empty((0, 0)),
        skid=nan,
        branch=SKIDDING,
        iterations=s.iterations,
        contacts=contacts,
        jacobian=p.jacobian[:4, :4].copy(),
        residuals=Residuals(
            equilibrium=nan,
            friction=nan,
            discretisation=nan,
            discretisation_qv=nan,
            power=nan,
            equilibrium_rounding=nan,
            friction_rounding=nan,
            power_rounding=nan,
        ),
        held=False,
    )


@jit
def motion_jacobian(p):
    """Jacobian (4, 4) of the equations of motion: tractions follow the motion at once."""
    J = p.jacobian[:4, :4].copy()
    if p.step.size == 4:
        return J
    a, b, c, d = p.jacobian[4, 4], p.jacobian[4, 5], p.jacobian[5, 4], p.jacobian[5, 5]
    det = a * d - b * c
    for j in range(4):
        y_i, y_o = p.jacobian[4, j], p.jacobian[5, j]
        t_i, t_o = (b * y_o - d * y_i) / det, (c * y_i - a * y_o) / det
        for i in range(4):
            J[i, j] += p.jacobian[i, 4] * t_i + p.jacobian[i, 5] * t_o
    return J


@jit(level=1)  # as fast as at level 3
def thrust_case(bearing, rule, fine_rule, start, v_start, tolerance):
    """Solve, sum up and check the steady state under thrust.

    Parameters
    ----------
    rule, fine_rule : Rule
        For the ellipse; the fine one has four times the points.
    start : ndarray (4,) or (6,)
        Start of (w_x, w_y, w_z, Omega), or also of (T_i, T_o); see `unknowns`.
    v_start : float
        Regularisation of the first level, see `steady_state` [m/s].
    """
    p = balance_problem(bearing, rule, bearing.traction)
    return balanced_case(p, fine_rule, start, v_start, tolerance)


@jit
def balanced_case(p, fine_rule, start, v_start, tolerance):
    """`thrust_case` of a balance: references to its buffers are not counted here."""
    g, D, op = p.bearing.g, p.bearing.D, p.bearing.op
    u = unknowns(p, start)
    contacts = np.full((2, COLUMNS), np.nan)
    s = steady_state(p, u, v_start, tolerance)
    if s.status != OK:
        return unsolved(p, s, u, contacts)
    state = s.seat.state
    r = g.R_o + state.X2
    response = np.empty((u.size + 2, u.size + 2))
    friction_balance(p, op.v_r, state, u, p.residual, True)
    find_exact_changes(p, state, u, np.empty((2, 5)))
    linear_response(p, s.seat, u, response)
    add_load_columns(p, s.seat, u)
    contact_summary(g, D, op, state, u, r, p.rule, p.points, contacts, False)
    skid = skid_ratio(op, state.alpha_i, state.alpha_o, 0.5 * D, r, u)
    residuals, load = checked(p, s.seat, u, fine_rule), motion_load(u)
    jacobian = motion_jacobian(p)
    quasistatic = quasistatic_stiffness(p, op.v_r, s.seat, u, response)
    return ThrustCase(
        status=case_status(residuals),
        delta_a=s.seat.delta_a,
        u=u[:4].copy(),
        T_i=load.T_i,
        T_o=load.T_o,
        r=r,
        P_r=ball_mass(g.rho, D) * r * u[3] * u[3],
        S_xx=state.S_xx,
        S_quasistatic=quasistatic,
        response=response,
        skid=skid,
        branch=branch_of(contacts, skid),
        iterations=s.iterations,
        contacts=contacts,
        jacobian=jacobian,
        residuals=residuals,
        held=False,
    )


compile_together(
    thrust_case,
    settled_elsewhere,
    lambda bearing, rule, fine_rule, start, v_start, tolerance: (
        bearing, rule, rule, v_start, v_start, start, rule[0], bearing[0][0],
    ),
)  # fmt: skip
