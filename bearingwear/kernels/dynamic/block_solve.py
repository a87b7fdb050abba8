"""Solves with the factors of block_system.py, and the change of powers in a step."""

from bearingwear.kernels.cage.body import INNER_LAND
from bearingwear.kernels.decorators import jit
from bearingwear.kernels.dynamic.block_system import (
    ALGEBRAIC,
    BORDER,
    CAGE_BORDER,
    FORCE,
    LOCAL,
    POCKET,
)
from bearingwear.kernels.dynamic.jacobian import F_ORBIT, HEAT_POWER, SHAFT_POWER
from bearingwear.kernels.layout import (
    BALL,
    CENTRE,
    MOMENTUM,
    OMEGA,
    PSI,
    ROTATION,
    VELOCITY,
    W_X,
    W_Y,
    W_Z,
)
from bearingwear.kernels.linear import solve_factored
from bearingwear.kernels.vectors import cross, minus, plus, triple


@jit
def known_forces(shift, side, bearing, system):
    """Forces of closed contacts that follow from places known in advance.

    Of azimuths and cage, by the right-hand sides of their own equations; into `system.known`.
    """
    n, z = bearing.D.size, bearing.layout.cage
    c, theta = z + CENTRE, z + ROTATION
    for j in range(n + 2):
        if not system.touching[j]:
            continue
        a = system.hold[j]
        d0 = side[c] + side[theta + 1] * a[2] - side[theta + 2] * a[1]
        d1 = side[c + 1] + side[theta + 2] * a[0] - side[theta] * a[2]
        d2 = side[c + 2] + side[theta] * a[1] - side[theta + 1] * a[0]
        if j < n:
            along = system.r[j] * side[BALL * j + PSI]
            d1 += along * system.turn[j, 1]
            d2 += along * system.turn[j, 0]
        for i in range(3):
            K = system.K[j]
            system.known[j, i] = (K[i, 0] * d0 + K[i, 1] * d1 + K[i, 2] * d2) / shift


@jit
def add_cage_side(bearing, h, arm, side):
    """Take the force h (3,) on a partner out of the cage's right-hand sides."""
    for k in range(3):
        side[k] -= h[k] / bearing.cage.mass
    side[3] -= arm[1] * h[2] - arm[2] * h[1]
    side[4] -= arm[2] * h[0] - arm[0] * h[2]
    side[5] -= arm[0] * h[1] - arm[1] * h[0]


@jit
def ball_alone(shift, side, bearing, j, system):
    """Solve for a ball whose race and cage are held, and return its effect on the two."""
    v, border, places = system.alone[j], system.side, bearing.layout.qv
    touching, inverse = system.touching[j], system.inverse[j]
    by_azimuth, psi = system.by_azimuth[j], side[BALL * j + PSI] / shift
    known, right = system.known[j], system.rows[0]
    for p in range(LOCAL):
        value = side[places + 2 * j + p] if p < ALGEBRAIC else side[BALL * j + p - ALGEBRAIC]
        value += by_azimuth[p] * psi
        if touching:
            for q in range(3):
                value += system.gain[j, p, FORCE + q] * known[q]
        right[p] = value
    for p in range(LOCAL):
        value = 0.0
        for q in range(LOCAL):
            value += inverse[p, q] * right[q]
        v[p] = value
    reading, turning = system.reading[j], system.race_by_azimuth[j]
    f0, f1, f2 = turning[0] * psi, turning[1] * psi, turning[2] * psi
    for p in range(LOCAL):
        f0 += reading[0, p] * v[p]
        f1 += reading[1, p] * v[p]
        f2 += reading[2, p] * v[p]
    sp, cp = system.turn[j, 0], system.turn[j, 1]
    border[CAGE_BORDER] -= f0
    border[CAGE_BORDER + 1] -= cp * f2 - sp * f1
    border[CAGE_BORDER + 2] -= cp * f1 + sp * f2
    if touching:
        for i in range(3):
            value = known[i]
            for p in range(LOCAL):
                value += reading[POCKET + i, p] * v[p]
            known[i] = value
        add_cage_side(bearing, known, system.arm[j], border)


@jit
def solve_factorised(shift, side, U, bearing, system):
    """Solve with the factors for the steps U of states and places, from the right-hand side.

    Parameters
    ----------
    side, U : ndarray
        States of balls and cage, then ball centres (n, 2) and race (3,): for these the unbalanced
        forces [N], and the steps [m].
    """
    n, layout, border = bearing.D.size, bearing.layout, system.side
    places, z, with_cage = layout.qv, layout.cage, bearing.cage.present
    race = places + 2 * n
    for k in range(CAGE_BORDER):
        border[k] = 0.0
    for k in range(3):
        border[CAGE_BORDER + k] = side[race + k]
        if with_cage:
            border[k], border[3 + k] = side[z + VELOCITY + k], side[z + MOMENTUM + k]
    if with_cage:
        known_forces(shift, side, bearing, system)
        for j in range(n, n + 2):
            if system.touching[j]:
                add_cage_side(bearing, system.known[j], system.arm[j], border)
                if bearing.cage.land == INNER_LAND:
                    border[CAGE_BORDER + 1] += system.known[j, 1]
                    border[CAGE_BORDER + 2] += system.known[j, 2]
    for j in range(n):
        ball_alone(shift, side, bearing, j, system)
    if bearing.axial_is_held:
        border[CAGE_BORDER] = 0.0
    solve_factored(system.border, system.pivots, border, BORDER)
    for k in range(3):
        U[race + k] = border[CAGE_BORDER + k]
        if with_cage:
            U[z + VELOCITY + k], U[z + MOMENTUM + k] = border[k], border[3 + k]
            w = 0.0
            for q in range(3):
                w += system.inertia[k, q] * border[3 + q]
            U[z + CENTRE + k] = (side[z + CENTRE + k] + border[k]) / shift
            U[z + ROTATION + k] = (side[z + ROTATION + k] + w) / shift
    for j in range(n):
        follow_border(shift, side, U, bearing, j, system)


@jit
def follow_border(shift, side, U, bearing, j, system):
    """Steps of ball j once race and cage are known."""
    v, border, places = system.alone[j], system.side, bearing.layout.qv
    a1 = border[CAGE_BORDER]
    a2 = system.turn[j, 1] * border[CAGE_BORDER + 2] - system.turn[j, 0] * border[CAGE_BORDER + 1]
    h0 = h1 = h2 = 0.0
    touching, response = system.touching[j], system.response[j]
    if touching:
        slope = system.cage_slope[j]
        for q in range(CAGE_BORDER):
            h0 += slope[0, q] * border[q]
            h1 += slope[1, q] * border[q]
            h2 += slope[2, q] * border[q]
    for p in range(LOCAL):
        value = v[p] + response[p, 0] * a1 + response[p, 1] * a2
        if touching:
            value += response[p, 2] * h0 + response[p, 3] * h1 + response[p, 4] * h2
        if p < ALGEBRAIC:
            U[places + 2 * j + p] = value
        else:
            U[BALL * j + p - ALGEBRAIC] = value
    U[BALL * j + PSI] = (side[BALL * j + PSI] + U[BALL * j + OMEGA]) / shift


@jit
def add_ball_powers(U, y, rates, bearing, buf, system, out):
    """Add to `out` how a step U of states and places changes shaft power, heat and rotation.

    Parameters
    ----------
    rates : ndarray
        Where the step begins.
    """
    layout, border = bearing.layout, bearing.layout.qv + 2 * bearing.D.size
    for j in range(bearing.D.size):
        i, at = BALL * j, layout.qv + 2 * j
        sp, cp, r = system.turn[j, 0], system.turn[j, 1], system.r[j]
        X1, X2 = U[at], U[at + 1]
        Y1 = U[border] + system.groove_turn[j, 0] * U[i + PSI] - X1
        Y2 = cp * U[border + 2] - sp * U[border + 1] + system.groove_turn[j, 1] * U[i + PSI] - X2
        moved = (Y1, Y2, X1, X2, U[i + W_X], U[i + W_Y], U[i + W_Z], U[i + OMEGA])
        shaft = heat = force = 0.0
        for v in range(8):
            shaft += buf.blocks[j, SHAFT_POWER, v] * moved[v]
            heat += buf.blocks[j, HEAT_POWER, v] * moved[v]
            force += buf.blocks[j, F_ORBIT, v] * moved[v]
        out[layout.shaft] += shaft
        out[layout.heat] += heat
        Omega, before = y[i + OMEGA], -bearing.mass[j] * r * rates[i + OMEGA]
        turning = r * Omega * force + before * (r * U[i + OMEGA] + Omega * X2)
        out[layout.turning] -= 2.0 * turning


@jit(forceinline=True)
def cage_point_step(U, bearing, j, system):
    """Change of velocity and place, in a step U, of the cage's point at contact j."""
    z, inertia = bearing.layout.cage, system.inertia
    arm, L = triple(system.arm[j], 0), triple(U, bearing.layout.cage + MOMENTUM)
    w = (
        inertia[0, 0] * L[0] + inertia[0, 1] * L[1] + inertia[0, 2] * L[2],
        inertia[1, 0] * L[0] + inertia[1, 1] * L[1] + inertia[1, 2] * L[2],
        inertia[2, 0] * L[0] + inertia[2, 1] * L[1] + inertia[2, 2] * L[2],
    )
    hold = triple(system.hold[j], 0)
    place = plus(cross(triple(U, z + ROTATION), hold), triple(U, z + CENTRE))
    return plus(cross(w, arm), triple(U, z + VELOCITY)), place


@jit(forceinline=True)
def over_ball_step(U, y, bearing, j, velocity, place, system):
    """Those changes less the ball's at its contact point."""
    i, at, r = BALL * j, bearing.layout.qv + 2 * j, system.r[j]
    sp, cp = system.turn[j, 0], system.turn[j, 1]
    w_y, w_z, X1, X2 = U[i + W_Y], U[i + W_Z], U[at], U[at + 1]
    w = (U[i + W_X], w_y * cp - w_z * sp, w_y * sp + w_z * cp)
    u = minus(velocity, cross(w, triple(system.reach[j], 0)))
    along, far = r * U[i + OMEGA] + X2 * y[i + OMEGA], r * U[i + PSI]
    velocity = (u[0], u[1] + cp * along, u[2] + sp * along)
    place = (place[0] - X1, place[1] + cp * far + sp * X2, place[2] + sp * far - cp * X2)
    return velocity, place


@jit
def add_cage_powers(U, y, bearing, system, out):
    """Add to `out` how a step U changes the cage's heats, torques and work.

    For the contacts that `linearise` kept: the integrals' rows of the same matrix.
    """
    n, layout, m = bearing.D.size, bearing.layout, bearing.op
    y_cage, z_cage = y[layout.cage + CENTRE + 1], y[layout.cage + CENTRE + 2]
    inner = bearing.cage.land == INNER_LAND
    land_speed, race = (m.omega_i if inner else m.omega_o), layout.qv + 2 * n
    for j in range(n + 2):
        if not system.touching[j]:
            continue
        u, d = cage_point_step(U, bearing, j, system)
        in_pocket = j < n
        if in_pocket:
            u, d = over_ball_step(U, y, bearing, j, u, d, system)
            sign = -1.0
        else:
            if inner:
                d = (d[0], d[1] - U[race + 1], d[2] - U[race + 2])
            # The motion is that of the land against the cage.
            u, d = (-u[0], -u[1], -u[2]), (-d[0], -d[1], -d[2])
            sign = 1.0
        h1 = h2 = 0.0
        for k in range(3):
            h1 += system.C[j, 1, k] * u[k] + system.K[j, 1, k] * d[k]
            h2 += system.C[j, 2, k] * u[k] + system.K[j, 2, k] * d[k]
            out[layout.cage_heat] += system.heat[j, k] * u[k] + system.heat[j, 3 + k] * d[k]
            out[layout.damping] += system.loss[j, k] * u[k] + system.loss[j, 3 + k] * d[k]
        arm = system.arm[j]
        torque = sign * ((y_cage + arm[1]) * h2 - (z_cage + arm[2]) * h1)
        if in_pocket:
            out[layout.pocket_torque] += torque
            along = h1 * system.turn[j, 1] + h2 * system.turn[j, 0]
            out[layout.turning] -= 2.0 * system.r[j] * y[BALL * j + OMEGA] * along
        else:
            out[layout.land_torque] += torque
            out[layout.shaft] += land_speed * torque
