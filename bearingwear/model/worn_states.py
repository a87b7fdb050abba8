"""States of a bearing whose grooves are worn as they are worn (theory.md section 21).

Depths stand on fixed grids: each groove's along its own arc, the balls' along their latitude.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d

from bearingwear.kernels import status as code
from bearingwear.kernels.ball import drag_force
from bearingwear.kernels.equilibrium import groove_distance
from bearingwear.kernels.hertz import INNER, OUTER, elliptic_integrals, race_contact
from bearingwear.kernels.params import Hertz
from bearingwear.kernels.profile import contact_approach, contact_load, middle_height, profile
from bearingwear.kernels.steady_balance import ThrustBearing
from bearingwear.kernels.summary import ANGLE, LOAD, MAJOR
from bearingwear.kernels.thrust import LARGEST_RESIDUAL
from bearingwear.kernels.worn_balance import (
    Arc,
    WornForce,
    WornRace,
    arc_shift,
    find_stiffness,
    latitude,
)
from bearingwear.kernels.worn_cells import contact_buffers
from bearingwear.kernels.worn_contact import contact_cells
from bearingwear.kernels.worn_friction import friction_work, unworn_contact, worn_dissipation
from bearingwear.kernels.worn_state import WornSeat, pitch, state_work, worn_state
from bearingwear.kernels.worn_verification import contact_check
from bearingwear.model.steady import ThrustProblem

SIDES = (INNER, OUTER)
ARC_STEP = 0.05  # of the initial semi-major axis
ARC_END = 5.0  # initial semi-major axes from where the contact was, new
BAND_END = 0.8  # latitude up to which a ball may wear in bands [rad]
CELLS_END = 1.9  # semi-major axes, cells along them as asked for; more where the contact is longer
SPARE = 3.0  # cells beyond the contact, at least
LARGEST_GAP = 1e-7  # left by a contact, over the approach
LARGEST_POWER_ERROR = 1e-8  # of the shaft power
WIDER = 1.2  # of the cells, where the contact has grown to their ends


_NO_HERTZ = Hertz(K=0.0, c_a=0.0, c_b=0.0, log_kappa=0.0, E=0.0)
_NO_FORCE = WornForce(code.OK, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, _NO_HERTZ)
NOWHERE = WornSeat(code.NOT_CONVERGED, 0.0, 0.0, 0.0, 0.0, _NO_FORCE, _NO_FORCE, 0.0, 0.0)
"""Of a point that was not solved."""


@dataclass(frozen=True, eq=False)
class WornDepths:
    """What has been worn off, of even shares and of depths over the grids."""

    ball: float  # even loss of ball diameter [m]
    grooves: np.ndarray  # (2, arcs) depth [m]
    band: np.ndarray  # (latitudes,) of the balls, empty where they wear evenly [m]

    def plus(self, dt: float, rate: "WornDepths") -> "WornDepths":
        """Wear after the time dt at a rate, itself a wear per second."""
        return WornDepths(
            self.ball + dt * rate.ball,
            self.grooves + dt * rate.grooves,
            self.band + dt * rate.band,
        )

    def mean(self, other: "WornDepths") -> "WornDepths":
        """Half of the sum of two rates."""
        return WornDepths(
            0.5 * (self.ball + other.ball),
            0.5 * (self.grooves + other.grooves),
            0.5 * (self.band + other.band),
        )


@dataclass(frozen=True, eq=False)
class WornPoint:
    """A steady state with some wear, or what it failed with."""

    status: int
    wear: WornDepths
    seat: WornSeat = NOWHERE
    u: np.ndarray = field(default_factory=lambda: np.zeros(0))  # (4,) motion of a ball [rad/s]
    slip: np.ndarray = field(default_factory=lambda: np.zeros(0))  # (2, 4), see kernel
    qv_along: tuple[np.ndarray, ...] = ()  # QV per length at the cells, inner and outer [W/m]
    x: tuple[np.ndarray, ...] = ()  # the cells along the major axis [m]
    pressure: tuple[np.ndarray, ...] = ()  # (m, n) each, over the peak of Hertz
    track: np.ndarray = field(default_factory=lambda: np.zeros(0))  # (2,) radius [m]
    stiffness: float = np.nan  # axial, of the whole bearing [N/m]


class WornBearing:
    """A bearing under thrust whose contacts follow its worn grooves."""

    def __init__(
        self,
        problem: ThrustProblem,
        D: float,
        cells: tuple[int, int] = (48, 10),
        bands: bool = False,
        wander: float = 0.1,
    ):
        self.problem, self.D, self.cell_numbers = problem, D, cells
        self.bands, self.traction, self.wander = bands, problem.traction, wander
        self.case = problem.solve(D)
        self.status = self.case.status
        if self.status == code.OK:
            self._start()

    def _start(self) -> None:
        g, c = self.problem.g, self.case.contacts
        self.major, self.angle = c[:, MAJOR].copy(), c[:, ANGLE].copy()
        self.arc_step = ARC_STEP * self.major
        steps = round(ARC_END / ARC_STEP)
        self.arc = self.arc_step[:, None] * np.arange(-steps, steps + 1)  # (2, arcs) [m]
        self.band_step = float(ARC_STEP * self.major.min() / (0.5 * self.D))
        count = round(BAND_END / self.band_step) if self.bands else 0
        self.latitude = self.band_step * np.arange(-count, count + 1)[: 2 * count + self.bands]
        self.ends = np.full(2, CELLS_END)
        self.reference = np.zeros(2)
        self.races = tuple(self._race(k) for k in range(2))
        hertz = race_contact(g, OUTER, self.D, np.cos(self.angle[1]), np.nan)
        length = g.r_o - 0.5 * self.D + contact_approach(hertz.K, c[1, LOAD])
        self.seat = WornSeat(
            status=code.OK,
            X1=float(length * np.sin(self.angle[1])),
            X2=float(length * np.cos(self.angle[1])),
            delta_a=float(self.case.delta_a),
            beta=float(pitch(self.case.u)),
            inner=_NO_FORCE,
            outer=_NO_FORCE,
            F_i=float(self.case.T_i),
            F_o=float(self.case.T_o),
        )
        self.u = self.case.u[:4].copy()
        self.state = state_work()

    def _race(self, k: int) -> WornRace:
        """Race k with cells for its present length of contact, unworn."""
        n, m = self.cell_numbers
        n = 2 * round(0.5 * n * self.ends[k] / CELLS_END)
        hertz = race_contact(
            self.problem.g, SIDES[k], self.D, float(np.cos(self.angle[k])), float("nan")
        )
        end = float(self.ends[k])
        status, cells = contact_cells(hertz.log_kappa, -end, end, n, m)
        if status != code.OK:
            self.status = status
        return WornRace(
            cells=cells,
            work=contact_buffers(n, m),
            pressure=cells.fresh.copy(),
            wear=np.zeros(n),
            x=np.zeros(n),
            rise=np.zeros(n),
            groove=self._spline(self.arc[k], self.arc_step[k], np.zeros(self.arc[k].size)),
            band=self._spline(self.latitude, self.band_step, np.zeros(self.latitude.size)),
            alpha_ref=float(self.angle[k]),
        )

    @staticmethod
    def _spline(places: np.ndarray, step: float, depth: np.ndarray) -> Arc:
        if not depth.size:
            return Arc(0.0, 1.0, np.zeros((4, 0)))
        c = np.ascontiguousarray(CubicSpline(places, depth).c)
        return Arc(float(places[0]), float(step), c)

    def unworn(self, ball: float = 0.0) -> WornDepths:
        """No wear but an even loss of ball diameter."""
        return WornDepths(ball, np.zeros_like(self.arc), np.zeros_like(self.latitude))

    def solve(self, wear: WornDepths, stiffness: bool = True) -> WornPoint:
        """Steady state with some wear, from the last one solved; with its stiffness or without."""
        D = self.D - wear.ball
        band = self._spline(self.latitude, self.band_step, wear.band)
        for _ in range(6):
            races = tuple(
                race._replace(
                    groove=self._spline(self.arc[k], self.arc_step[k], wear.grooves[k]), band=band
                )
                for k, race in enumerate(self.races)
            )
            n, m = max(r.x.size for r in races), self.cell_numbers[1]
            work, u, p = friction_work(self.problem.rule, n, m), self.u.copy(), self.problem
            bearing = ThrustBearing(p.g, D, p.op, p.preload, self.traction)
            seat = worn_state(
                bearing, races, self.reference, p.rule, work, self.state, self.seat, u
            )
            status = seat.status
            if status not in (code.OK, code.BEYOND_GROOVE) or not self._widened(races):
                break
        if status != code.OK:
            for race in races:  # nothing to start from
                np.copyto(race.pressure, race.cells.fresh)
            self.state.slope.fill(0.0)
            return WornPoint(status, wear)
        self.seat, self.u = seat, u
        slip = np.empty((2, 4))
        qv_along = np.empty((2, max(r.x.size for r in races)))
        worn_dissipation(p.g, p.op, D, races, seat, p.rule, work, u, slip, qv_along)
        forces = (seat.inner, seat.outer)
        if not self._verified(races, seat, slip, u, D):
            return WornPoint(code.UNVERIFIED, wear)
        self.reference = np.array(
            [
                self.reference[k] + f.approach - contact_approach(f.hertz.K, f.Q)
                for k, f in enumerate(forces)
            ]
        )
        r = p.g.R_o + seat.X2
        return WornPoint(
            status=status,
            wear=wear,
            seat=seat,
            u=u.copy(),
            slip=slip,
            qv_along=tuple(qv_along[k, : race.x.size] for k, race in enumerate(races)),
            x=tuple(race.x.copy() for race in races),
            pressure=tuple(race.pressure.copy() for race in races),
            track=np.array(
                [
                    r + s * middle_height(profile(r_g, 0.5 * D, f.a)) * np.cos(f.alpha)
                    for s, r_g, f in zip(SIDES, (p.g.r_i, p.g.r_o), forces, strict=True)
                ]
            ),
            stiffness=self._axial_stiffness(races, seat, D) if stiffness else np.nan,
        )

    def rate(self, point: WornPoint, ball: float, race: float) -> WornDepths:
        """Wear per second in a state (theory.md Eqs. 73-74).

        Parameters
        ----------
        ball, race : float
            K_s/H of ball and race [1/Pa].
        """
        g, D = self.problem.g, self.D - point.wear.ball
        R = 0.5 * D
        grooves, band = np.zeros_like(self.arc), np.zeros_like(self.latitude)
        beta = pitch(point.u)
        for k, (force, sigma) in enumerate(zip(self.forces(point), SIDES, strict=True)):
            x, qv = point.x[k], point.qv_along[k]
            shift = arc_shift(self.races[k], (g.r_i, g.r_o)[k], sigma, force.alpha)
            along = wandering(self.arc[k], x + shift, qv, self.wander * self.major[k])
            grooves[k] = g.n_balls * race * along / (2.0 * np.pi * point.track[k])
            if self.bands:
                places = latitude(sigma, force.alpha, beta) - x / R
                wander = self.wander * self.major[k] / R
                along = wandering(self.latitude, places[::-1], qv[::-1] * R, wander) / R
                band += ball * along / (2.0 * np.pi * R * np.cos(self.latitude))
        even = 0.0 if self.bands else 2.0 * ball * point.slip[:, 0].sum() / (np.pi * D * D)
        return WornDepths(float(even), grooves, band)

    @staticmethod
    def forces(point: WornPoint) -> tuple[WornForce, WornForce]:
        """Of both contacts, inner and outer."""
        return point.seat.inner, point.seat.outer

    def lengths(self, point: WornPoint) -> np.ndarray:
        """Approaches of both contacts, (2,): of ball and groove as they were when new [m]."""
        g, seat, R = self.problem.g, point.seat, 0.5 * (self.D - point.wear.ball)
        A1, A2 = groove_distance(g, 0.0, seat.delta_a, 0.0, 0.0, 0.0)
        inner = np.hypot(A1 - seat.X1, A2 - seat.X2) - (g.r_i - R)
        return np.array([inner, np.hypot(seat.X1, seat.X2) - (g.r_o - R)])

    def gap_at_edge(self, point: WornPoint) -> np.ndarray:
        """A a^2 of both contacts, (2,): gap of the unworn bodies at the edge of the ellipse [m]."""
        gaps = []
        for race, force in zip(self.races, self.forces(point), strict=True):
            s = elliptic_integrals(float(np.exp(-race.cells.log_kappa)))[2]
            gaps.append(s * force.approach)
        return np.array(gaps)

    def _verified(self, races, seat: WornSeat, slip: np.ndarray, u: np.ndarray, D: float) -> bool:
        """Whether contacts and power balance by sums that the solver did not take."""
        g, op = self.problem.g, self.problem.op
        for race, force in zip(races, (seat.inner, seat.outer), strict=True):
            check = contact_check(race.cells, race.wear, race.pressure)
            unworn = race.cells.fresh.sum() * race.cells.area
            load = contact_load(force.hertz.K, force.approach) * check.load / unworn
            if not (
                max(check.gap, check.overlap) <= LARGEST_GAP
                and check.tension == 0.0
                and abs(load / force.Q - 1.0) <= LARGEST_RESIDUAL
            ):
                return False
        r = g.R_o + seat.X2
        drag = drag_force(g, D, op.drag, u[3])[0] * r * u[3]
        power = slip[0, 3] * op.omega_i + slip[1, 3] * op.omega_o
        given = max(abs(slip[0, 3] * op.omega_i), abs(slip[1, 3] * op.omega_o))
        mu = max(unworn_contact(g, op, k, f).mu for k, f in enumerate((seat.inner, seat.outer)))
        floor = mu * (seat.inner.Q + seat.outer.Q) * op.v_r
        self.power_error = abs(power - slip[:, 1].sum() - drag) / max(given, floor)
        return bool(self.power_error <= LARGEST_POWER_ERROR)

    def _axial_stiffness(self, races, seat: WornSeat, D: float) -> float:
        """N times the axial stiffness of one ball, its centre free [N/m]."""
        g, beta = self.problem.g, pitch(self.u)
        A1, A2 = groove_distance(g, 0.0, seat.delta_a, 0.0, 0.0, 0.0)
        places = ((A1 - seat.X1, A2 - seat.X2), (seat.X1, seat.X2))
        k_i, k_o = found = np.empty((2, 2, 2))
        for race, sigma, reference, y, k in zip(
            races, SIDES, self.reference, places, found, strict=True
        ):
            find_stiffness(g, D, race, sigma, reference, *y, beta, k)
        series = k_i - k_i @ np.linalg.solve(k_i + k_o, k_i)
        return float(g.n_balls * series[0, 0])

    def _widened(self, races: tuple[WornRace, ...]) -> bool:
        """Give contacts that have grown to the ends of their cells more of them."""
        wider = False
        kept = list(self.races)
        for k, race in enumerate(races):
            X = race.cells.X
            loaded = np.abs(X[race.pressure.max(axis=0) > 0.0])
            if loaded.size and loaded.max() > X[-1] - (SPARE - 1.0) * (X[1] - X[0]):
                self.ends[k] *= WIDER
                kept[k] = self._race(k)
                wider = True
        self.races = tuple(kept)
        return wider


def wandering(
    grid: np.ndarray, places: np.ndarray, values: np.ndarray, wander: float
) -> np.ndarray:
    """Values at equally spaced places on a grid, wandering about; their integral is kept.

    Parameters
    ----------
    wander : float
        rms of the places, in the unit of the grid.
    """
    found = np.interp(grid, places, values, left=0.0, right=0.0)
    step = grid[1] - grid[0]
    total = found.sum() * step
    if total > 0.0:
        found *= values.sum() * (places[1] - places[0]) / total
    if wander > 0.0:
        found = gaussian_filter1d(found, wander / step, mode="constant", truncate=6.0)
    return found
