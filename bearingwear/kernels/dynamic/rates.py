"""Right-hand side of the motion of balls, inner race and cage (theory.md section 8)."""

import math

from bearingwear.kernels.ball import drag_force
from bearingwear.kernels.cage.body import cage_rates
from bearingwear.kernels.cage.contacts import cage_contacts, set_race_velocity
from bearingwear.kernels.cage.law import (
    LAND_DAMPING,
    LAND_HEAT,
    LAND_TORQUE,
    LAND_WORK,
    POCKET_DAMPING,
    POCKET_HEAT,
    POCKET_TORQUE,
)
from bearingwear.kernels.decorators import jit
from bearingwear.kernels.dynamic.equilibrium import (
    correct_places,
    equilibrium,
    size_of_unbalanced,
)
from bearingwear.kernels.dynamic.friction import BallForces, race_friction
from bearingwear.kernels.dynamic.jacobian import ball_blocks
from bearingwear.kernels.dynamic.model import load_at
from bearingwear.kernels.dynamic.quasistatic import (
    FORCE_1,
    FORCE_2,
    find_contacts,
    inner_force,
    start_is_known,
    unbalanced_forces,
)
from bearingwear.kernels.layout import BALL, CAGE, CENTRE, OMEGA, PSI, W_X, W_Y, W_Z
from bearingwear.kernels.status import NOT_CONVERGED, OK

CORRECTIONS = 3  # of places, before `equilibrium` seeks them
AGREED = 1e-8  # share of the largest load that a balance may leave, a hundredth of what is verified


@jit(forceinline=True)
def add_ball_rates(y, bearing, balls, j, r, f, dy):
    """Rates of ball j under the forces f, and its part in the integrals that are sums."""
    g, layout, i = bearing.g, bearing.layout, BALL * j
    Omega = y[i + OMEGA]
    drag, _ = drag_force(g, bearing.D[j], bearing.op.drag, Omega)
    inertia = bearing.inertia[j]
    dy[i + W_X] = f.M_x / inertia
    dy[i + W_Y] = f.M_y / inertia + Omega * y[i + W_Z]
    dy[i + W_Z] = f.M_z / inertia - Omega * y[i + W_Y]
    dy[i + OMEGA] = -(f.F_y + drag) / (bearing.mass[j] * r)
    dy[i + PSI] = Omega
    dy[layout.drag] += drag * r * Omega
    dy[layout.turning] += 2.0 * bearing.mass[j] * r * r * Omega * dy[i + OMEGA]
    # dU/dpsi at a fixed race: the inner force times the shift of the groove centres.
    sp, cp = balls.turn[j, 0], balls.turn[j, 1]
    axial, radial = inner_force(balls, j)
    dA1 = -bearing.tilt * g.R_i * sp
    dA2 = -balls.delta[2] * sp - balls.delta[1] * cp
    dy[layout.azimuth] += Omega * (axial * dA1 + radial * dA2)


@jit
def store_cage_rates(y, bearing, contacts, dy):
    """Rates of the cage and of the integrals that its contacts feed."""
    n, layout, sums = bearing.D.size, bearing.layout, contacts.sums
    for j in range(n):
        dy[layout.pockets + j] = contacts.power[j]
    dy[layout.land] = contacts.power[n] + contacts.power[n + 1]
    dy[layout.cage_heat] = sums[POCKET_HEAT] + sums[LAND_HEAT]
    dy[layout.damping] = sums[POCKET_DAMPING] + sums[LAND_DAMPING]
    dy[layout.pocket_torque] = sums[POCKET_TORQUE]
    dy[layout.land_torque] = sums[LAND_TORQUE]
    dy[layout.gravity_torque] = 0.0
    if bearing.cage.present:
        begin, end, g = layout.cage, layout.cage + CAGE, bearing.cage.gravity
        cage_rates(bearing.cage, y[begin:end], contacts.force, contacts.R, dy[begin:end])
        off_y, off_z = y[begin + CENTRE + 1], y[begin + CENTRE + 2]
        dy[layout.gravity_torque] = bearing.cage.mass * (off_y * g[2] - off_z * g[1])


@jit
def hand_over_cage_forces(bearing, balls, contacts):
    """Forces of the cage to the balance of normal forces."""
    for j in range(bearing.D.size):
        x = balls.cage_linear[j]
        x[FORCE_1], x[FORCE_2] = contacts.ball_force[j, 0], contacts.ball_force[j, 2]
    balls.land_linear[FORCE_1] = contacts.race_force[0]
    balls.land_linear[FORCE_2] = contacts.race_force[1]


@jit
def rates_here(time, y, bearing, buf, dy, slopes):
    """Time derivative of the states of balls and cage and of the integrals, at the places of `buf`.

    And what these leave unbalanced (`balls.left`, `balls.race_left`): the algebraic equations.

    Parameters
    ----------
    time : float
        [s]
    y : ndarray
        State vector, see state.StateLayout.
    dy : ndarray
        Filled.
    slopes : bool
        Whether a step may begin here: `linearise` needs them.

    Returns
    -------
    int
        Whether the model describes all contacts.
    """
    m, balls, contacts, layout = bearing.op, buf.balls, buf.cage, bearing.layout
    load_at(bearing, time, balls.F)
    find_contacts(y, bearing, balls)
    if bearing.cage.present:
        set_race_velocity(time, bearing, contacts)
        cage_contacts(y, bearing, balls, contacts)
        hand_over_cage_forces(bearing, balls, contacts)
    heat = shaft = 0.0
    dy[layout.drag] = dy[layout.turning] = dy[layout.azimuth] = 0.0
    for j in range(bearing.D.size):
        moment = contacts.ball_moment[j]
        forces = BallForces(
            M_x=moment[0],
            M_y=moment[1],
            M_z=moment[2],
            F_y=contacts.ball_force[j, 1],
            heat=heat,
            shaft=shaft,
        )
        place = layout.qv + 2 * j
        status, forces = race_friction(y, bearing, buf, j, forces, dy[place : place + 2], slopes)
        if status != OK:
            return status
        heat, shaft = forces.heat, forces.shaft
        add_ball_rates(y, bearing, balls, j, balls.r[j], forces, dy)
    unbalanced_forces(y, bearing, balls)
    store_cage_rates(y, bearing, contacts, dy)
    dy[layout.shaft] = shaft + contacts.sums[LAND_WORK]
    dy[layout.heat] = heat
    dy[layout.hertz] = dy[layout.traction] = 0.0  # see step_control.work_of_places
    theta, rate = m.omega_i * time, m.omega_i * bearing.F_rot
    dy[layout.load] = -rate * (balls.delta[1] * math.cos(theta) + balls.delta[2] * math.sin(theta))
    return OK


@jit
def is_agreed(balls):
    """Whether the normal forces of the last `rates_here` are in balance."""
    return size_of_unbalanced(balls) <= AGREED * balls.Q.max()


@jit
def corrected_rates(time, y, bearing, buf, dy):
    """`rates_here` with slopes in equilibrium, from where it left its slopes nearby.

    By a few steps of Newton's method with the slopes of the tractions. `equilibrium` does without
    these, and sums friction seven times on its way.

    Returns
    -------
    int
        NOT_CONVERGED where the places of `buf` were not near enough.
    """
    for _ in range(CORRECTIONS):
        if is_agreed(buf.balls):
            return OK
        ball_blocks(y, bearing, buf)
        if not correct_places(bearing, buf):
            return NOT_CONVERGED
        status = rates_here(time, y, bearing, buf, dy, True)
        if status != OK:
            return status
    return OK if is_agreed(buf.balls) else NOT_CONVERGED


@jit
def state_rates(time, y, bearing, buf, dy, slopes):
    """`rates_here` where balls and race are in equilibrium, found from the places of `buf` on."""
    if slopes and bearing.traction and start_is_known(buf.balls):
        status = rates_here(time, y, bearing, buf, dy, True)
        if status == OK and corrected_rates(time, y, bearing, buf, dy) == OK:
            return OK
    status = equilibrium(time, y, bearing, buf)
    if status != OK:
        return status
    return rates_here(time, y, bearing, buf, dy, slopes)


@jit
def agreed_rates(time, y, bearing, buf, dy, slopes):
    """`rates_here` where the places of `buf` agree with the state, else `state_rates`.

    What was found stays as it is to the last bit, however often it is asked for.
    """
    status = NOT_CONVERGED
    if start_is_known(buf.balls):
        status = rates_here(time, y, bearing, buf, dy, slopes)
    if status != OK or not is_agreed(buf.balls):
        status = state_rates(time, y, bearing, buf, dy, slopes)
    return status
