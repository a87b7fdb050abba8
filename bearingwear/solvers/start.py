"""Motion of the balls at the start of a dynamic solve."""

from dataclasses import dataclass, replace

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.equilibrium.kinematics import INNER_CONTROL
from bearingwear.kernels.steady.thrust import ThrustCase
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.films import COVERED, Bare
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem, time_scale_values
from bearingwear.solvers.condition import USABLE
from bearingwear.solvers.race_control import race_control_motion


@dataclass
class Start:
    """First motion of every ball, and its time scales from the steady solver."""

    u: np.ndarray  # (4,) or (n, 4)
    kind: str  # of this motion, in words
    scales: dict[str, float]  # fast_time_scale, slow_time_scale [s], if they are known
    case: ThrustCase | None = None  # the steady state under the thrust alone, where there is one
    bare: Bare = COVERED  # the contacts without film


def thrust_alone(scene: Scene) -> Scene:
    """Returns the scene without the loads that keep it from a steady state."""
    operation = replace(
        scene.operation, radial_load_N=(0.0, 0.0), rotating_load_N=0.0, tilt_mrad=0.0
    )
    return replace(scene, operation=operation)


def start_of(scene: Scene, bare: Bare = COVERED) -> Start:
    """Returns the motion of the steady state under the thrust alone, or else of race control.

    Where that has no solution either, it is that of inner race control at the free contact
    angle. Only the first has time scales and a `case`.

    bare: which contacts have no film left.
    """
    problem = parameters.where_bare(ThrustProblem.of(thrust_alone(scene)), scene, bare)
    if problem.undetermined() == code.OK:
        D = float(parameters.ball_diameters(scene).mean())
        case = problem.solve(D)
        if case.status in USABLE:
            scales = time_scale_values(problem.decay_rates(D, case))
            return Start(
                u=case.u,
                kind="the steady state under pure thrust",
                scales=scales,
                case=case,
                bare=bare,
            )
    u = race_control_motion(scene, bare)
    if u is not None:
        return Start(u, "race control", {}, bare=bare)
    u = problem.kinematic_start(INNER_CONTROL)
    return Start(u, "race control at the free contact angle", {}, bare=bare)
