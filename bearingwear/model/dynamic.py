"""The balls' motion in time: from a scene to what the integrators take.

The cage, output files and the command line's `fidelity: dynamic` are not there yet; what is here is
the motion of balls and inner race, verified by tests/verification/test_dynamic.py.
"""

import math
from dataclasses import dataclass

import numpy as np

from bearingwear.kernels.equilibrium import static_displacement
from bearingwear.kernels.integrators import ROSENBROCK, Tally, advance, stages
from bearingwear.kernels.motion import BALL, Account, Run, account, balls_motion, buffers
from bearingwear.model import parameters
from bearingwear.model.scene import Scene

FIRST_STEP = 1e-4  # of a shaft turn
STEPS_PER_TURN = 20  # at the least: a ball's loads change with its azimuth
TOLERANCE = 1e-3  # of the mean slip, see integrators.step_error


@dataclass
class Motion:
    """Balls and inner race of a scene at an instant, and how to move them on."""

    run: Run
    places: Account
    y: np.ndarray
    time: float = 0.0

    def __post_init__(self) -> None:
        n = len(self.run.D)
        self.buffers = buffers(n, self.run.rule)
        self.stages = stages(self.y.size)
        self.dy = np.zeros(self.y.size)
        self.h = FIRST_STEP * self.turn

    @classmethod
    def of(cls, scene: Scene, u: np.ndarray) -> "Motion":
        """Every ball of a scene moving as u = (w_x, w_y, w_z, Omega), evenly spaced."""
        g, operation = parameters.geometry(scene), scene.operation
        D = parameters.ball_diameters(scene)
        mass = g.rho * math.pi / 6.0 * D**3
        F_y, F_z = operation.radial_load_N
        run = Run(
            g=g,
            motion=parameters.motion(scene),
            D=D,
            mass=mass,
            inertia=0.1 * mass * D**2,
            first=0 if operation.preload_method == "constant_force" else 1,
            F_x=float(operation.preload_N),
            F_y=float(F_y),
            F_z=float(F_z),
            F_rot=float(operation.rotating_load_N),
            tilt=operation.tilt_mrad * 1e-3,
            rule=parameters.quadrature(scene),
        )
        n = len(D)
        places = account(n, BALL * n)
        y = np.zeros(places.size)
        y[: BALL * n].reshape(n, BALL)[:, :4] = u
        y[4 : BALL * n : BALL] = 2.0 * math.pi * np.arange(n) / n
        motion = cls(run, places, y)
        motion.buffers.s.delta[0] = static_displacement(g, run.F_x)
        return motion

    @property
    def turn(self) -> float:
        """Duration of a shaft turn, or of a turn of the faster race [s]."""
        m = self.run.motion
        return 2.0 * math.pi / max(abs(m.omega_i), abs(m.omega_o))

    @property
    def balls(self) -> np.ndarray:
        """States (n, 5) of the balls: w_x, w_y, w_z, Omega, psi; a view."""
        n = len(self.run.D)
        return self.y[: BALL * n].reshape(n, BALL)

    @property
    def qv(self) -> np.ndarray:
        """Time integral of QV (n, 2), inner and outer contact of each ball [J]; a view."""
        return self.y[self.places.qv : self.places.shaft].reshape(-1, 2)

    def rates(self) -> np.ndarray:
        """Time derivative of the state now; also brings `buffers.s` up to date."""
        balls_motion(self.time, self.y, self.run, self.buffers, self.dy, self.places)
        return self.dy

    def advance(
        self,
        duration: float,
        tolerance: float = TOLERANCE,
        method: int = ROSENBROCK,
        longest: float | None = None,
    ) -> Tally:
        """Move on in time; the tally's status says whether that went well."""
        tally = advance(
            method,
            self.time,
            self.time + duration,
            self.y,
            self.run,
            self.buffers,
            self.places,
            self.stages,
            tolerance,
            self.h,
            longest or self.turn / STEPS_PER_TURN,
        )
        self.time, self.h = tally.time, tally.h
        return tally

    def energy(self) -> dict[str, float]:
        """Terms of the energy account now (theory.md Eq. 26) [J].

        Over any stretch the change of `supplied` is that of the sum of all others.
        """
        self.rates()
        run, s, y, p = self.run, self.buffers.s, self.y, self.places
        r = run.g.R_o + s.X[:, 1]
        w, Omega = self.balls[:, :3], self.balls[:, 3]
        free = np.array([run.g.r_i, run.g.r_o]) - 0.5 * run.D[:, None]
        lengths = np.column_stack([np.hypot(*(s.A - s.X).T), np.hypot(s.X[:, 0], s.X[:, 1])])
        d = np.maximum(lengths - free, 0.0)
        orbit = run.mass * r**2 * Omega**2
        return {
            "supplied": y[p.shaft] + s.delta @ (self.buffers.F * self._held()) - y[p.load],
            "heat": y[p.heat],
            "drag": y[p.drag],
            "kinetic": 0.5 * (run.inertia * (w**2).sum(axis=1) + orbit).sum(),
            "elastic": 0.4 * (s.factors[:, :, 0] * d**2.5).sum(),
            "coriolis": -(orbit.sum() - y[p.turning]),
            "azimuth": -y[p.azimuth],
        }

    def _held(self) -> np.ndarray:
        """1 for the translations in which the load does work, 0 where the race is held."""
        return np.array([1.0 if self.run.first == 0 else 0.0, 1.0, 1.0])
