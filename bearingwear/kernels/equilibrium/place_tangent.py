"""How the inner force of a ball follows its inner groove under a law of forces (theory.md 2)."""

from bearingwear.kernels.contact.profile import contact_approach
from bearingwear.kernels.decorators import jit
from bearingwear.kernels.equilibrium.thrust_loaded import ball_equilibrium, groove_distance

TANGENT_STEP = 1e-4  # of the inner approach, which loads follow with the power 3/2


@jit
def place_tangent(g, D, load, psi, delta, tilt, state):
    """Derivatives of the inner force on a ball by the place of its groove, as central differences.

    The forces of race control, or what else `load` says, follow the place.

    Parameters
    ----------
    psi : float
        Azimuth [rad].
    delta : tuple of 3 floats
        Displacement of the inner race [m].
    tilt : float
        [rad]
    state : BallState
        Equilibrium, the inner contact closed.

    Returns
    -------
    k_xx, k_xr, k_rx, k_rr : float
        Of the axial (x) and radial (r) force by the axial and radial displacement [N/m].
    """
    A1, A2 = groove_distance(g, psi, delta[0], delta[1], delta[2], tilt)
    h = TANGENT_STEP * contact_approach(state.hertz_i.K, state.Q_i)
    high = ball_equilibrium(g, D, load, A1 + h, A2, state)
    low = ball_equilibrium(g, D, load, A1 - h, A2, state)
    out = ball_equilibrium(g, D, load, A1, A2 + h, state)
    back = ball_equilibrium(g, D, load, A1, A2 - h, state)
    return (
        (high.F_ix - low.F_ix) / (2.0 * h),
        (out.F_ix - back.F_ix) / (2.0 * h),
        (high.F_ir - low.F_ir) / (2.0 * h),
        (out.F_ir - back.F_ir) / (2.0 * h),
    )
