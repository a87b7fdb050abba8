"""The motion of balls, cage and inner race in time: from a scene to what the integrators take."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize

from bearingwear.kernels import status as code
from bearingwear.kernels.cage import (
    CAGE,
    ELASTIC,
    INNER_LAND,
    NO_LAND,
    OUTER_LAND,
    Cage,
    cage_energy,
)
from bearingwear.kernels.equilibrium import static_displacement
from bearingwear.kernels.hertz import INNER, OUTER, point_contact, race_contact
from bearingwear.kernels.integrators import ROSENBROCK, Tally, advance, stages
from bearingwear.kernels.kinematics import ORBIT
from bearingwear.kernels.motion import (
    BALL,
    Account,
    Run,
    account,
    buffers,
    contacts_at,
    free_equilibrium,
    load_at,
    motion_rates,
)
from bearingwear.kernels.params import Geometry
from bearingwear.kernels.race import ROW, race_equilibrium, stored_state
from bearingwear.model import parameters
from bearingwear.model.impact import land_damping, pocket_damping
from bearingwear.model.race_control import unseated
from bearingwear.model.scene import Scene

HERTZ_INTERVALS = 64
LIGHT_IMPACT = 1e-3  # of the cage's surface speed
RAMP = 0.2  # of the depth of a light impact
CAGE_LAG = 0.01  # share by which the cage turns slower than the balls at the start
FIRST_STEP = 1e-4  # of a shaft turn
STEPS_PER_TURN = 20  # at the least: a ball's loads change with its azimuth
TOLERANCE = 1e-3  # of the mean slip, see integrators.step_error


def cage_of(scene: Scene) -> Cage:
    """Geometry, inertia and contact laws of a scene's cage, or the absence of one."""
    c = scene.cage
    if c is None:
        return Cage(False, 1.0, 1.0, 1.0, 1.0, 1.0, NO_LAND, *np.ones(10).tolist())
    b = scene.bearing
    material = scene.materials[c.material]
    ball, race = scene.materials[b.ball_material], scene.materials[b.race_material]
    MM = parameters.MM
    r_i, r_o, width = (
        0.5 * c.inner_diameter_mm * MM,
        0.5 * c.outer_diameter_mm * MM,
        c.width_mm * MM,
    )
    R, clearance = 0.5 * b.ball_diameter_mm * MM, 0.5 * c.pocket_clearance_mm * MM
    # A ring less its pockets; the pockets take the same share of mass and inertia.
    ring = math.pi * (r_o**2 - r_i**2) * width
    pockets = b.ball_count * math.pi * (R + clearance) ** 2 * (r_o - r_i)
    mass = material.density_kg_m3 * (ring - pockets)
    # Ball in a concave cylinder. Without clearance Hertz' ellipse would be a ring: 1e-3 R is added.
    pocket = R + max(clearance, 1e-3 * R)
    hertz = point_contact(
        0.5 * (1.0 / R - 1.0 / pocket),
        0.5 / R,
        parameters.contact_modulus(ball, material),
        math.nan,
    )
    land = {"outer": OUTER_LAND, "inner": INNER_LAND, "ball": NO_LAND}[c.guiding_race]
    E_star = parameters.contact_modulus(race, material)
    k_land = scene.model.land_stiffness_factor * 0.25 * math.pi * E_star * 0.5 * width
    # A light impact, to say what is deep in such a contact.
    operation = scene.operation
    speed = max(abs(operation.shaft_speed_rpm), abs(operation.outer_speed_rpm)) * parameters.RPM
    impact = LIGHT_IMPACT * 0.25 * b.pitch_diameter_mm * MM * speed
    ball_mass = ball.density_kg_m3 * math.pi / 6.0 * (2.0 * R) ** 3
    m_eff = ball_mass * mass / (ball_mass + mass)
    return Cage(
        present=True,
        mass=mass,
        I_x=0.5 * mass * (r_i**2 + r_o**2),
        I_t=mass * (3.0 * (r_i**2 + r_o**2) + width**2) / 12.0,
        clearance=clearance,
        K_pocket=hertz.K,
        land=land,
        radius=r_i if land == INNER_LAND else r_o,
        gap=0.5 * c.guide_clearance_mm * MM,
        half_width=0.5 * width,
        k_land=k_land,
        mu=float(scene.friction.cage),
        v_r=float(scene.friction.slip_regularisation_m_s),
        damping_pocket=pocket_damping(c.restitution),
        # Both edges share the mass of a cage that meets the land squarely.
        damping_land=math.sqrt(0.5) * land_damping(c.restitution),
        ramp_pocket=max(RAMP * (1.25 * m_eff * impact**2 / hertz.K) ** 0.4, 1e-9),
        ramp_land=max(RAMP * impact * math.sqrt(mass / k_land), 1e-9),
    )


def exact_factors(g: Geometry, race: float, D: float, cos_alpha: float) -> tuple[float, float]:
    """Hertz factors K [N/m^1.5] and c_a [m/N^(1/3)] of a contact at a contact angle."""
    return race_contact(g, race, D, cos_alpha, math.nan)[:2]


def hertz_table(g: Geometry, D: np.ndarray, factors_of=exact_factors) -> np.ndarray:
    """Hertz factors of both contacts of each ball as cubic splines in the cosine of the angle.

    They follow the angle so weakly that the spline is exact to rounding; solving Hertz' equation
    anew would be a third of the time of a step.

    Parameters
    ----------
    factors_of : callable
        As `exact_factors`, or an approximation of it.

    Returns
    -------
    ndarray (n, 2, HERTZ_INTERVALS, 8)
        See quasistatic.hertz_at.
    """
    cosine = np.linspace(0.0, 1.0, HERTZ_INTERVALS + 1)
    powers = HERTZ_INTERVALS ** -np.arange(3.0, -1.0, -1.0)
    table = np.empty((len(D), 2, HERTZ_INTERVALS, 8))
    splines: dict[float, np.ndarray] = {}
    for j, diameter in enumerate(D):
        if diameter not in splines:
            factors = np.array(
                [[factors_of(g, race, diameter, c) for c in cosine] for race in (INNER, OUTER)]
            )
            c = CubicSpline(cosine, factors, axis=1).c  # (4, intervals, race, K or c_a)
            c = c * powers[:, None, None, None]
            splines[diameter] = np.moveaxis(c, (2, 1, 3, 0), (0, 1, 2, 3)).reshape(2, -1, 8)
        table[j] = splines[diameter]
    return table


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
        self.stages = stages(n, self.y.size)
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
            hertz=hertz_table(g, D),
            first=0 if operation.preload_method == "constant_force" else 1,
            F_x=float(operation.preload_N),
            F_y=float(F_y),
            F_z=float(F_z),
            F_rot=float(operation.rotating_load_N),
            tilt=operation.tilt_mrad * 1e-3,
            cage=cage_of(scene),
            rule=parameters.quadrature(scene),
        )
        n = len(D)
        places = account(n, run.cage.present)
        y = np.zeros(places.size)
        y[: BALL * n].reshape(n, BALL)[:, :4] = u
        y[4 : BALL * n : BALL] = 2.0 * math.pi * np.arange(n) / n
        motion = cls(run, places, y)
        motion.buffers.rest[0] = static_displacement(g, run.F_x)
        motion.buffers.s.delta[:] = motion.buffers.rest
        if run.cage.present:
            motion.place_cage()
        return motion

    def variant(self, **changes) -> "Motion":
        """The same bearing, some of what kernels are told replaced; to be unpacked into."""
        other = Motion(self.run._replace(**changes), self.places, self.y.copy())
        other.buffers.rest[:] = self.buffers.rest
        other.buffers.s.delta[:] = other.buffers.rest
        return other

    def place_cage(self) -> None:
        """The cage about to be towed: every ball in the middle of its pocket, the cage slower.

        Its centre hangs below the axis by half of its clearance. A cage that floats in the middle
        and turns with the balls would touch nothing, ever. Where that place squeezes it, because
        load or tilt moves the balls out of their plane, it starts where it is squeezed least.
        """
        p, b, run = self.places, self.buffers, self.run
        free_equilibrium(self.time, self.y, run, b)
        z = self.y[p.cage : p.cage + CAGE]
        z[:] = 0.0
        cage = run.cage
        room = cage.clearance if cage.land == NO_LAND else min(cage.clearance, cage.gap)
        z[0] = b.s.X[:, 0].mean()
        z[2] = -0.5 * room
        if cage.land == INNER_LAND:
            z[1:3] += b.s.delta[1:]
        pose = np.array([0, 1, 2, 6, 7, 8])
        middle = z[pose]

        def squeezed(shift: np.ndarray) -> float:
            z[pose] = middle + shift * scale
            contacts_at(self.y, run, b, p)
            return float(b.cage.sums[ELASTIC])

        scale = np.zeros(6)
        energy = squeezed(scale)
        if energy > 0.0:
            scale[:] = b.cage.approach.max()
            scale[3:] /= cage.radius
            squeezed(minimize(lambda shift: squeezed(shift) / energy, np.zeros(6)).x)
        z[9:] = cage.I_x * (1.0 - CAGE_LAG) * self.balls[:, 3].mean() * b.cage.R[:, 0]

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
        return self.y[self.places.qv : self.places.pockets].reshape(-1, 2)

    def settle(self) -> int:
        """Equilibrium at this instant; the status of the attempt."""
        return motion_rates(self.time, self.y, self.run, self.buffers, self.dy, self.places)

    def why(self, status: int) -> int:
        """The status; where it gives no reason, one that does, if there is one.

        From the last state that had an equilibrium: balls and race alone, without the cage, from a
        safe start.
        """
        if status not in (code.NOT_CONVERGED, code.UNVERIFIED):
            return status
        run, b, n = self.run, self.buffers, len(self.run.D)
        Omega, psi = self.balls[:, 3].copy(), self.balls[:, 4].copy()
        loads = np.zeros((n, 6))
        loads[:, 0], loads[:, 1] = ORBIT, Omega
        load_at(run, self.time, b.F)
        rows, delta = np.empty((n, ROW)), b.rest.copy()
        alone, *_ = race_equilibrium(
            run.g, run.D, loads, psi, b.F, run.tilt, run.first, delta, rows
        )
        if alone not in (code.OK, code.NOT_CONVERGED):
            return int(alone)
        if unseated([stored_state(row) for row in rows]):
            return code.RACE_UNSEATED
        if status == code.NOT_CONVERGED and alone == code.OK and run.cage.present:
            return code.CAGE_JAMMED
        return status

    def opened(self) -> tuple[float, np.ndarray, dict[str, float], float]:
        """Time, integrals, energies and the cage's angular momentum now."""
        energy = self.energy()
        momentum = self.cage_momentum() if self.run.cage.present else 0.0
        return self.time, self.y[self.places.qv :].copy(), energy, momentum

    def rates(self) -> np.ndarray:
        """Time derivative of the state now; also brings `buffers.s` up to date."""
        self.settle()
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

    def packed(self) -> np.ndarray:
        """All that a run needs to go on as if it had not stopped: see `unpack`."""
        s, cage = self.buffers.s, self.buffers.cage
        b = self.buffers
        parts = (self.y, [self.h], cage.R0, s.X, s.delta, b.extra, b.land)
        return np.concatenate([np.ravel(part) for part in parts])

    def unpack(self, state: np.ndarray, time: float) -> None:
        """Take up where the run that left `packed()` at `time` had come to."""
        s, cage = self.buffers.s, self.buffers.cage
        h = np.empty(1)
        b = self.buffers
        parts = (self.y, h, cage.R0, s.X, s.delta, b.extra, b.land)
        if state.size != sum(part.size for part in parts):
            raise ValueError(f"state of {state.size} numbers where {len(self.packed())} are")
        at = 0
        for part in parts:
            part[...] = state[at : at + part.size].reshape(part.shape)
            at += part.size
        self.h, self.time = float(h[0]), time
        s.factors[:] = 0.0  # known: the equilibrium goes on from X and delta

    def cage_momentum(self) -> float:
        """Angular momentum of the cage about the bearing axis [kg m2/s]."""
        z = self.y[self.places.cage : self.places.cage + CAGE]
        return float(z[9] + self.run.cage.mass * (z[1] * z[5] - z[2] * z[4]))

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
        cage = self.buffers.cage
        z = y[p.cage : p.cage + CAGE]
        cage_kinetic = cage_energy(run.cage, z, cage.R) if run.cage.present else 0.0
        return {
            "supplied": y[p.shaft] + s.delta @ (self.buffers.F * self._held()) - y[p.load],
            "heat": y[p.heat],
            "drag": y[p.drag],
            "cage heat": y[p.cage_heat],
            "damping": y[p.damping],
            "kinetic": 0.5 * (run.inertia * (w**2).sum(axis=1) + orbit).sum() + cage_kinetic,
            "elastic": 0.4 * (s.factors[:, :, 0] * d**2.5).sum() + cage.sums[ELASTIC],
            "coriolis": -(orbit.sum() - y[p.turning]),
            "azimuth": -y[p.azimuth],
            "hertz": -y[p.hertz],
        }

    def _held(self) -> np.ndarray:
        """1 for the translations in which the load does work, 0 where the race is held."""
        return np.array([1.0 if self.run.first == 0 else 0.0, 1.0, 1.0])
