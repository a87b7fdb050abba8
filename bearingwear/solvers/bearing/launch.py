"""Two bearings at rest under a load on their rotor, as at launch (theory.md section 25).

Balls without friction and without motion: each pulls the groove centres together along their line,
its two contacts are springs in series, and the energy of all is a convex function of the place of
the rotor. The balance is where it is least.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.contact.hertz import INNER, OUTER, race_contact
from bearingwear.kernels.params import Geometry
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.requirements import Launch
from bearingwear.scene.scene import Arrangement, Scene
from bearingwear.solvers.bearing.arrangement import N_UM, plane_frequencies
from bearingwear.solvers.bearing.at_rest import AxialRotor, PreloadSpring, race_displacement
from bearingwear.solvers.bearing.mounted import GPA, MM, UM, mounted_geometry, yield_pressure
from bearingwear.solvers.bearing.parameters import geometry, worn_diameters
from bearingwear.solvers.bearing.stiffness import azimuths
from bearingwear.solvers.roots import brent_root

GRAVITY = 9.80665  # standard [m/s2]
FARTHEST_G = 1e9  # in place of no end, which cannot be interpolated
THREE_SIGMA = 3.0
"""Factor on the rms by which launch loads are usually stated (FEMCI book, NASA Goddard, 2001)."""

_BALANCED = 1e-14  # force left, over the largest sum of loads
_MOST_STEPS = 300
_SOFTEST, _HARDEST = 1e-12, 1e6  # damping, over the stiffness of the balls
_ROUNDED = 1e-12  # change of the energy, relative, that is none
_PLANE = [1, 2]
_X, _Z, _TILT, _SLIDE = range(4)  # place of the rotor's middle, and of the second outer ring


class RestingSide(NamedTuple):
    """A bearing on the rotor, at rest."""

    g: Geometry
    D: np.ndarray  # (n,) ball diameters [m]
    psi: np.ndarray  # (n,) azimuths, the first along the load across [rad]
    tandem: int
    mounted: float  # axial displacement of the inner race [m]
    motion: np.ndarray  # (3, 4) own axial and radial displacement and tilt, by `_X` to `_SLIDE`
    factor: np.ndarray  # (n,) load over deformation^1.5 of both contacts [N/m^1.5]
    peak: np.ndarray  # (n, 2) peak pressure under 1 N, inner and outer race [Pa]

    def balls(self, q: np.ndarray) -> "Balls":
        """Its balls at a place of the rotor."""
        g, c = self.g, np.cos(self.psi)[:, None]
        slopes = np.array([self.motion[0] + g.R_i * c * self.motion[2], c * self.motion[1]])
        A1 = g.BD * math.sin(g.alpha0) + self.mounted + slopes[0] @ q
        A2 = g.BD * math.cos(g.alpha0) + slopes[1] @ q
        length = np.hypot(A1, A2)
        d = np.maximum(length - (self.g.r_i + self.g.r_o - self.D), 0.0)
        return Balls(A1, A2, length, A1 / length, A2 / length, d, self.factor * d**1.5, slopes)

    @property
    def touch(self) -> float:
        """Axial displacement at which its last ball comes off, without load across [m]."""
        return self._displaced(0.0)

    def dented(self, pressure: float) -> float:
        """Axial displacement at which a ball first presses a race with this peak pressure [m]."""
        return self._displaced((pressure / self.peak.max(axis=1)) ** 2 / self.factor ** (2.0 / 3.0))

    def _displaced(self, d: float | np.ndarray) -> float:
        return float(race_displacement(self.g, self.g.r_i + self.g.r_o - self.D + d).min())

    def force(self, displacement: float) -> float:
        """Axial force of all in tandem at an axial displacement [m] alone [N]."""
        b = self.balls(np.array([(displacement - self.mounted) / self.motion[0, _X], 0, 0, 0]))
        return self.tandem * float(b.Q @ b.s)


class Balls(NamedTuple):
    """Balls between the grooves, each value (n,)."""

    A1: np.ndarray  # distance of the groove centres, axial [m]
    A2: np.ndarray  # and radial [m]
    length: np.ndarray  # of both [m]
    s: np.ndarray  # sine and cosine of the contact angle
    c: np.ndarray
    d: np.ndarray  # deformation of both contacts [m]
    Q: np.ndarray  # load [N]
    slopes: np.ndarray  # (2, n, 4) of A1 and A2 by the place

    @property
    def along(self) -> np.ndarray:
        """Slope (n, 4) of the length by the place."""
        return self.s[:, None] * self.slopes[0] + self.c[:, None] * self.slopes[1]

    def stiffness(self, factor: np.ndarray) -> np.ndarray:
        """Stiffness of the bearing by position (4, 4)."""
        along, (axial, radial) = self.along, self.slopes
        # slope of the direction, times the length
        across = self.c[:, None] * axial - self.s[:, None] * radial
        k, turn = 1.5 * factor * np.sqrt(self.d), self.Q / self.length
        return (along.T * k) @ along + (across.T * turn) @ across


def series_contact(g: Geometry, D: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Load over deformation^1.5 (n,) of both contacts of a ball; peak pressures (n, 2) under 1 N.

    With the curvature at the free contact angle, as ISO 76 rates them: where the angle opens from
    15 to 21 degrees, the peak pressure is within 0.22 % of that with its own.
    """
    factor, peak = [], []
    for diameter in D.tolist():
        contacts = [
            race_contact(g, race, diameter, math.cos(g.alpha0), math.nan) for race in (INNER, OUTER)
        ]
        factor.append(sum(one.K ** (-2.0 / 3.0) for one in contacts) ** -1.5)
        peak.append([1.5 / (math.pi * one.c_a * one.c_b) for one in contacts])
    return np.array(factor), np.array(peak)


def place_as_mounted(g: Geometry, preload: float) -> float:
    """Axial displacement of an unworn bearing under its preload alone, at rest [m]."""
    (factor,), _ = series_contact(g, np.array([g.D0]))
    across = g.BD * math.cos(g.alpha0)

    def left(A1: float) -> float:
        length = math.hypot(A1, across)
        return g.n_balls * factor * max(length - g.BD, 0.0) ** 1.5 * A1 / length - preload

    free = g.BD * math.sin(g.alpha0)
    return brent_root(left, free, free + g.BD, xtol=1e-20, rtol=1e-15) - free


@dataclass(frozen=True)
class RestingBearing:
    """One bearing of the rotor under the load; of one in tandem, its share."""

    axial: float  # force on its inner race's balls, along its own load direction [N]
    radial: float  # [N]
    load: np.ndarray  # (n,) of each ball [N]
    pressure: np.ndarray  # (n, 2) peak, inner and outer race [Pa]
    gap: float  # axial distance to its first contact, where none is left [m]
    past: float  # the same where it is pressed, through its gap, on the other side of its grooves

    @property
    def is_open(self) -> bool:
        """Whether it has lost contact on the side of its contact angle."""
        return self.past > 0.0 or not self.load.any()


@dataclass(frozen=True)
class RestingRotor:
    shift: float  # of its middle towards +X [m]
    across: float  # the same across the axis [m]
    tilt: float  # [rad]
    slide: float  # of the second outer ring, as its spring extends [m]
    on_stop: float  # force on the stop of the spring [N]
    bearings: tuple[RestingBearing, ...]
    residual: float  # of the balance, over the largest force [1]

    @property
    def gap(self) -> float:
        """The largest gap of a bearing [m]."""
        return max(max(one.gap, one.past) for one in self.bearings)

    @property
    def pressure(self) -> float:
        """The largest peak pressure [Pa]."""
        return max(float(one.pressure.max()) for one in self.bearings)


@dataclass(frozen=True)
class RotorAtRest:
    """A rotor on two bearings, as mounted, warm but not turning.

    A single bearing is half of a symmetric pair, held by a spring or at a fixed position.
    """

    seats: tuple[RestingSide, RestingSide]
    offset: float  # of the centre of mass from the middle, towards +X [m]
    spring: PreloadSpring | None

    @classmethod
    def of(cls, scene: Scene, losses: Sequence[float] | None = None) -> "RotorAtRest":
        """Rotor of a scene, its balls as worn as the scene says.

        losses: of ball diameter, of each bearing, in place of the scene's [m].
        """
        worn = (None, None) if losses is None else (tuple(losses) * 2)[:2]
        a = scene.arrangement or Arrangement()
        speeds = ("shaft_speed_rpm", "lowest_speed_rpm", "outer_speed_rpm")
        at_rest = {f"operation.{name}": 0.0 for name in speeds}
        still = [one.with_(at_rest) for one in scene.sides]
        outwards = -1.0 if a.orientation == "back_to_back" else 1.0
        seats = []
        for k, (one, n, loss) in enumerate(zip((still * 2)[:2], a.tandem, worn, strict=True)):
            g, own = geometry(one), 1.0 - 2.0 * k
            # place on the rotor of the inner groove centres, at which the balls' forces act
            arm = (g.r_i - 0.5 * g.D0) * math.sin(g.alpha0)
            position = own * (outwards * 0.5 * (a.span_mm or 0.0) * MM + arm)
            motion = np.array(
                [[own, 0.0, 0.0, k], [0.0, 1.0, -position, 0.0], [0.0, 0.0, own, 0.0]]
            )
            D, preload = worn_diameters(one, g), float(one.operation.preload_N)
            if loss is not None:
                D = np.full_like(D, g.D0 - loss)
            mounted = place_as_mounted(mounted_geometry(one), preload)
            contact = series_contact(g, D)
            seats.append(RestingSide(g, D, azimuths(g.n_balls), n, mounted, motion, *contact))
        stop = math.inf if a.stop_um is None else a.stop_um * UM
        spring = None
        if scene.operation.preload_method == "constant_force":
            force, k_s = float(scene.operation.preload_N), a.spring_stiffness_N_um * N_UM
            spring = PreloadSpring(force, k_s, stop)
        return cls((seats[0], seats[1]), a.rotor_offset_mm * MM, spring)

    def under(self, axial: float, radial: float = 0.0) -> RestingRotor | None:
        """The rotor under a force at its centre of mass, towards +X and across [N].

        None where nothing holds it: a spring of no stiffness without a stop.
        """
        free = [_X, _Z, _TILT] if self.spring is None else [_X, _Z, _TILT, _SLIDE]
        force = np.array([axial, radial, -self.offset * radial, 0.0])
        k_s = np.zeros((4, 4))
        if self.spring is not None:
            F_s, k_s[_SLIDE, _SLIDE], stop = self.spring
            force[_SLIDE] = F_s
            if k_s[_SLIDE, _SLIDE] == 0.0 and stop == math.inf and axial <= -F_s:
                return None
        found = self._balanced(force, k_s, free, np.zeros(4))
        if self.spring is not None and found[_SLIDE] < -stop:
            start = np.array([0.0, 0.0, 0.0, -stop])
            found = self._balanced(force, k_s, free[:3], start)
        return self._state(found, force, k_s)

    def frequencies(self, a: Arrangement) -> np.ndarray:
        """Axial, radial and conical frequency of the rotor without a load (3,) [Hz]."""
        rest, q = self.under(0.0), np.zeros(4)
        if rest is not None:
            q = np.array([rest.shift, rest.across, rest.tilt, rest.slide])
        one, two = (seat.tandem * seat.balls(q).stiffness(seat.factor) for seat in self.seats)
        axial, soft = one[_X, _X] + two[_X, _X], two[_X, _X]
        if self.spring is not None:
            k_s = self.spring.stiffness
            axial = one[_X, _X] + (k_s * soft / (k_s + soft) if soft else 0.0)
        return plane_frequencies(a, float(axial), (one + two)[np.ix_(_PLANE, _PLANE)])

    @property
    def along(self) -> AxialRotor:
        """Without load across."""
        one, two = self.seats
        return AxialRotor(self.seats, (one.mounted, two.mounted), self.spring)

    def denting_force(self, pressure: float) -> float:
        """Least axial force, either way, at which a contact has that peak pressure [Pa] [N]."""
        one, two = (seat.dented(pressure) for seat in self.seats)
        return max(min(self.along.external(0, one), -self.along.external(1, two)), 0.0)

    def _balanced(
        self, force: np.ndarray, k_s: np.ndarray, free: list[int], q: np.ndarray
    ) -> np.ndarray:
        """The place of least energy, from a start `q`, of what is free to move.

        Damped Newton steps: where balls are loose, nothing may resist in some direction.
        """
        lengths = np.array([1.0, 1.0, 1.0 / self.seats[0].g.R_i, 1.0])[free]
        block = np.ix_(free, free)

        def energy(q: np.ndarray) -> tuple[float, np.ndarray, np.ndarray, float]:
            E, slope, K, largest = 0.5 * q @ k_s @ q - force @ q, k_s @ q - force, k_s, 0.0
            for seat in self.seats:
                b, n = seat.balls(q), seat.tandem
                E = E + 0.4 * n * (b.Q @ b.d)
                slope = slope + n * (b.Q @ b.along)
                K = K + n * b.stiffness(seat.factor)
                largest = max(largest, n * float(b.Q.sum()))
            return float(E), slope[free] * lengths, K[block] * np.outer(lengths, lengths), largest

        E, slope, K, largest = energy(q)
        firm = max(float(np.sum(one.factor)) for one in self.seats) * math.sqrt(UM)
        damping = 0.0
        for _ in range(_MOST_STEPS):
            if abs(slope).max() <= _BALANCED * max(largest, abs(force[:2]).max()):
                break
            try:
                step = np.linalg.solve(K + damping * np.eye(len(free)), -slope)
            except np.linalg.LinAlgError:
                damping = max(10.0 * damping, _SOFTEST * firm)
                continue
            trial = q.copy()
            trial[free] += step * lengths
            new = energy(trial)
            level = new[0] - E <= _ROUNDED * abs(E) and abs(new[1]).max() < abs(slope).max()
            if new[0] < E or level:
                q, (E, slope, K, largest), damping = trial, new, 0.1 * damping
            elif damping > _HARDEST * firm:
                break
            else:
                damping = max(10.0 * damping, _SOFTEST * firm)
        return q

    def _state(self, q: np.ndarray, force: np.ndarray, k_s: np.ndarray) -> RestingRotor:
        found, left = [], k_s @ q - force
        for seat in self.seats:
            b = seat.balls(q)
            left = left + seat.tandem * (b.Q @ b.along)
            free = seat.g.r_i + seat.g.r_o - seat.D
            to_touch = float((np.sqrt(np.maximum(free**2 - b.A2**2, 0.0)) - b.A1).min())
            loaded = b.s[b.Q > 0.0]
            found.append(
                RestingBearing(
                    axial=float(b.Q @ b.s),
                    radial=float(b.Q @ (b.c * np.cos(seat.psi))),
                    load=b.Q,
                    pressure=seat.peak * np.cbrt(b.Q)[:, None],
                    gap=0.0 if loaded.size else to_touch,
                    past=to_touch if loaded.size and loaded.max() < 0.0 else 0.0,
                )
            )
        on_stop = 0.0
        if self.spring is not None and q[_SLIDE] == -self.spring[2]:
            on_stop = float(left[_SLIDE])
        unbalanced = left[:3] / (1.0, 1.0, self.seats[0].g.R_i)
        largest = max(abs(force[:2]).max(), *(one.load.sum() for one in found))
        residual = float(abs(unbalanced).max() / largest) if largest > 0.0 else 0.0
        x, z, tilt, slide = q.tolist()
        return RestingRotor(x, z, tilt, slide, max(on_stop, 0.0), tuple(found), residual)


@dataclass(frozen=True)
class LaunchLoad:
    name: str
    axial: float  # [N], towards +X
    radial: float  # [N]
    rotor: RestingRotor | None  # None where nothing holds it


@dataclass(frozen=True)
class Launched:
    loads: tuple[LaunchLoad, ...]
    axial_g: float  # given or by Miles' equation
    radial_g: float  # the same across
    random: dict[str, "RandomResponse"]  # by the direction of each density that is given
    frequencies: np.ndarray | None  # axial, radial, conical, at rest; None without a span [Hz]
    opening_g: float  # along the axis alone, at which a bearing opens
    denting_g: float  # the same, at which one is dented
    pressure: float  # that dents the weaker of balls and races [Pa]
    source: str  # of that

    @property
    def gap(self) -> float:
        """The largest gap under its loads [m]; infinite where nothing holds the rotor."""
        gaps = [math.inf if one.rotor is None else one.rotor.gap for one in self.loads]
        return max(gaps, default=0.0)

    @property
    def pressure_share(self) -> float:
        """The largest peak pressure over that which dents [1]."""
        held = [one.rotor.pressure for one in self.loads if one.rotor is not None]
        return max(held, default=0.0) / self.pressure


def miles(density: float, frequency: float, amplification: float) -> float:
    """The rms acceleration of an oscillator under a density, both in one unit.

    J. W. Miles, J. Aeronautical Sciences (Nov 1954) 753.
    """
    return math.sqrt(0.5 * math.pi * frequency * amplification * density)


def expected_peak(frequency: float, duration: float) -> float:
    """The largest expected of a narrow-band response over a duration [s], over its rms [1].

    sqrt(2 ln(f t)), of f t independent amplitudes after Rayleigh: Cartwright and Longuet-Higgins,
    Proc. R. Soc. A 237 (1956) 212.
    """
    cycles = frequency * duration
    return math.sqrt(2.0 * math.log(cycles)) if cycles > 1.0 else 0.0


@dataclass(frozen=True)
class RandomResponse:
    """Acceleration of the rotor under random vibration in one direction."""

    rms_g: float
    expected: float  # largest over the duration of the test, over the rms [1]

    @property
    def three_sigma_g(self) -> float:
        return THREE_SIGMA * self.rms_g

    @property
    def largest_g(self) -> float:
        """The largest expected, at least three sigma."""
        return max(THREE_SIGMA, self.expected) * self.rms_g


def check_launch(scene: Scene, source: str) -> None:
    """Refuse a scene of whose rotor too little is known."""
    a, asked = scene.arrangement, scene.launch or Launch()
    needed = ["rotor_mass_kg"]
    densities = (asked.axial_density_g2_Hz, asked.radial_density_g2_Hz)
    if asked.radial_g or densities != (None, None):
        needed.append("span_mm")
    for name in needed:
        if a is None or getattr(a, name) is None:
            problem = "got nothing, expected a number > 0 for the launch analysis"
            raise SceneError(f"arrangement.{name}", problem, ("launch",), source)


def launched(scene: Scene, losses: Sequence[float] | None = None) -> Launched:
    """Launch loads and gaps of the bearings of a scene with the mass of its rotor.

    Along both ways of the axis, across it, and along and across together.

    losses: as of `RotorAtRest.of`. Race wear counts as that of balls: both part their surfaces.
    """
    a, asked, rest = scene.arrangement, scene.launch or Launch(), RotorAtRest.of(scene, losses)
    assert a is not None and a.rotor_mass_kg is not None
    weight = a.rotor_mass_kg * GRAVITY
    frequencies = rest.frequencies(a) if a.span_mm is not None else None
    given_g = {"axial": asked.axial_g, "radial": asked.radial_g}
    densities = (asked.axial_density_g2_Hz, asked.radial_density_g2_Hz)
    random = {}
    for k, (way, density) in enumerate(zip(given_g, densities, strict=True)):
        if density is not None:
            assert frequencies is not None
            f = float(frequencies[k])
            rms_g = miles(density, f, asked.amplification)
            random[way] = RandomResponse(rms_g, expected_peak(f, asked.duration_s))
            given_g[way] = random[way].largest_g
    axial, across = (g * weight for g in given_g.values())
    asked_for = {"along +X": (axial, 0.0), "along -X": (-axial, 0.0)} if axial else {}
    if across:
        asked_for |= {"across": (0.0, across)}
        if axial:
            asked_for |= {"+X, across": (axial, across), "-X, across": (-axial, across)}
    loads = [LaunchLoad(name, *F, rest.under(*F)) for name, F in asked_for.items()]
    limit, source = min((yield_pressure(one) for one in scene.sides), key=lambda one: one[0])
    return Launched(
        loads=tuple(loads),
        axial_g=given_g["axial"],
        radial_g=given_g["radial"],
        random=random,
        frequencies=frequencies,
        opening_g=rest.along.opening_force / weight,
        denting_g=rest.denting_force(limit * GPA) / weight,
        pressure=limit * GPA,
        source=source,
    )


def wear_at_launch(
    scene: Scene, new: Sequence[float], end: Sequence[float] | None
) -> tuple[float, ...] | None:
    """Most wear of each bearing before a launch [m]: at the end of life, or less as the scene says.

    new, end: losses of each bearing when new and at the end of life, None where that is not known.
    """
    limit = (scene.launch or Launch()).after_wear_um
    most = None if limit is None else tuple(one + limit * UM for one in new)
    if end is None or most is None:
        return most if end is None else tuple(end)
    return tuple(map(min, most, end))


def launch_values(scene: Scene, wear: Sequence[Sequence[float]] = ()) -> dict[str, float]:
    """Limited quantities of a launch [SI], new and worn the worst; empty without the rotor's mass.

    wear: losses of each bearing when new and at the end of life, or when new alone [m].
    """
    a = scene.arrangement
    if a is None or a.rotor_mass_kg is None:
        return {}
    if scene.launch is not None and a.span_mm is None:
        scene = replace(scene, launch=replace(Launch(), after_wear_um=scene.launch.after_wear_um))
    states = [*wear[:1], *(wear_at_launch(scene, wear[0], end) for end in wear[1:])] or [None]
    found = [launched(scene, losses) for losses in states]
    values = {
        "opening_acceleration": GRAVITY * min(FARTHEST_G, *(one.opening_g for one in found)),
        "denting_acceleration": GRAVITY * min(FARTHEST_G, *(one.denting_g for one in found)),
    }
    if found[0].loads:
        values["launch_gap"] = min(max(one.gap for one in found), 1.0)
        values["launch_pressure_share"] = max(one.pressure_share for one in found)
    return values
