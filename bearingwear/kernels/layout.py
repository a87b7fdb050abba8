"""Layout of the state vector: the balls' states, the cage's, then the time integrals."""

from typing import NamedTuple

from bearingwear.kernels.decorators import jit

BALL = 5  # states of a ball
W_X, W_Y, W_Z, OMEGA, PSI = range(BALL)  # its angular velocity, orbit rate [rad/s], azimuth [rad]
CAGE = 12  # states of a cage
# Its centre of mass [m] and velocity [m/s], its rotation vector since the start of the step [rad]
# and its angular momentum about that centre [kg m2/s]: three inertial components each.
CENTRE, VELOCITY, ROTATION, MOMENTUM = 0, 3, 6, 9


class StateLayout(NamedTuple):
    """Offsets into the state vector; ball j begins at BALL j."""

    cage: int  # states of the cage, if there is one
    qv: int  # 2 n: of each ball, inner and outer [J]
    pockets: int  # n: normal force times slip in each pocket [J]
    land: int  # normal force times slip at the land, both edges [J]
    shaft: int  # work of both races on balls and cage [J]
    heat: int  # friction heat of the ball/race contacts [J]
    drag: int  # work of the drag [J]
    turning: int  # sum of m r^2 2 Omega dOmega/dt, for the Coriolis term [J]
    azimuth: int  # sum of Omega dU/dpsi: the circumferential force left out [J]
    load: int  # delta . dF/dt of the loads that change [J]
    hertz: int  # elastic energy from Hertz factors that change with the contact angle [J]
    traction: int  # work of tractions on ball centres and race [J]
    cage_heat: int  # friction heat of pockets and land [J]
    damping: int  # of pockets and land [J]
    pocket_torque: int  # angular impulse of the pockets on the cage [N m s]
    land_torque: int  # and of the land
    gravity_torque: int  # and of gravity
    size: int


@jit
def state_layout(n, with_cage):
    """Layout for n balls."""
    cage = BALL * n
    qv = cage + (CAGE if with_cage else 0)
    pockets = qv + 2 * n
    land = pockets + n
    return StateLayout(
        cage=cage,
        qv=qv,
        pockets=pockets,
        land=land,
        shaft=land + 1,
        heat=land + 2,
        drag=land + 3,
        turning=land + 4,
        azimuth=land + 5,
        load=land + 6,
        hertz=land + 7,
        traction=land + 8,
        cage_heat=land + 9,
        damping=land + 10,
        pocket_torque=land + 11,
        land_torque=land + 12,
        gravity_torque=land + 13,
        size=land + 14,
    )
