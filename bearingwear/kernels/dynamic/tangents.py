"""What becomes of small disturbances of a run without a cage (theory.md section 22).

The linear equations M d' = J(t) d of disturbances d by the second-order backward differentiation
formula, with the matrix of the implicit integrator where each step ends. Fast disturbances die out
in it as they do in the motion, so that a few steps are enough for the slow ones.
"""

from bearingwear.kernels.decorators import jit
from bearingwear.kernels.dynamic.block_solve import solve_factorised
from bearingwear.kernels.dynamic.block_system import factorise


@jit
def carry_tangents(weights, old, older, y, bearing, buf, stage, new):
    """Carry disturbances of the balls' states over a step that has ended in a state.

    Parameters
    ----------
    weights : tuple of 3 floats
        Of `new`, `old` and `older` in the derivative by time there [1/s].
    old, older, new : ndarray (k, 5 n)
        Disturbances, one a row, where the step began, where the one before it did, and here: that
        is filled.
    y, bearing, buf, stage
        As `step_control.make_ready` left them.

    Returns
    -------
    bool
        False where the matrix is singular.
    """
    shift, last, second = weights
    side, U, size = stage.side, stage.error, new.shape[1]
    if not factorise(shift, y, bearing, buf, stage.system):
        return False
    side[:] = 0.0
    for i in range(new.shape[0]):
        for k in range(size):
            side[k] = -last * old[i, k] - second * older[i, k]
        solve_factorised(shift, side, U, bearing, stage.system)
        for k in range(size):
            new[i, k] = U[k]
    return True
