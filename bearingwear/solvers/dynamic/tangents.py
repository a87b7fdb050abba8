"""What a run makes of small disturbances of its balls, without a cage."""

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.dynamic.integrators import ROSENBROCK
from bearingwear.kernels.dynamic.step_control import StepControl
from bearingwear.kernels.dynamic.tangents import carry_tangents
from bearingwear.kernels.layout import BALL
from bearingwear.solvers.dynamic.system import DynamicSystem

STEPS = 8  # of the disturbances' equations in a stretch, each as many of the motion as it needs


def tangents(system: DynamicSystem, control: StepControl, duration: float) -> np.ndarray | None:
    """Derivative (5 n, 5 n) of the balls' states after a time by those now; None where a run fails.

    The system moves to that time, by the implicit method, whose matrix this takes.
    """
    control = control._replace(method=ROSENBROCK)
    old = np.eye(len(system.balls) * BALL)
    older, new, rate = old.copy(), old.copy(), STEPS / duration
    for step in range(STEPS):
        tally = system.simulate(control, duration / STEPS)
        if tally.status != code.OK:
            return None
        system.time, system.h = tally.time, tally.h
        weights = (1.5 * rate, -2.0 * rate, 0.5 * rate) if step else (rate, -rate, 0.0)
        of = (system.y, system.bearing, system.buffers, system.stages)
        if not carry_tangents(weights, old, older, *of, new):
            return None
        old, older, new = new, old, older
    return old.T
