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
FARTHEST_G = 1e9  # in place of infinity, which cannot be interpolated
WIDEST_GAP = 1.0  # likewise [m]
THREE_SIGMA = 3.0
"""Factor on the rms by which launch loads are usually stated (FEMCI book, NASA Goddard, 2001)."""

_BALANCED = 1e-14  # unbalanced force, over the largest sum of loads
_MOST_STEPS = 300
_SOFTEST, _HARDEST = 1e-12, 1e6  # damping, over the stiffness of the balls
_DAMPING_STEP = 10.0  # factor on the damping after a step that gained nothing
_ROUNDED = 1e-12  # relative change of the energy that is rounding
_PLACE_ROUNDING = {"xtol": 1e-20, "rtol": 1e-15}
"""Tolerances [m] and [1] of the place as mounted: to the last bits."""
_PLANE = [1, 2]  # `_Z` and `_TILT`
_X, _Z, _TILT, _SLIDE = range(4)  # place of the rotor's middle, and of the second outer ring


class RestingSide(NamedTuple):
    """A bearing on the rotor, at rest."""

    g: Geometry
    D: np.ndarray  # (n,) ball diameters [m]
    psi: np.ndarray  # (n,) azimuths, the first along the load across [rad]
    tandem: int  # number of identical bearings that share the load
    mounted: float  # axial displacement of the inner race [m]
    motion: np.ndarray  # (3, 4) axial and radial displacement and tilt over `_X` to `_SLIDE`
    factor: np.ndarray  # (n,) load over deformation^1.5 of both contacts [N/m^1.5]
    peak: np.ndarray  # (n, 2) peak pressure under 1 N, inner and outer race [Pa]

    def balls(self, q: np.ndarray) -> "Balls":
        """Returns the balls at a position of the rotor.

        q: displacement along X and Z [m], tilt [rad], and slide of the second outer ring [m].
        """
        g, c = self.g, np.cos(self.psi)[:, None]
        slopes = np.array([self.motion[0] + g.R_i * c * self.motion[2], c * self.motion[1]])
        A1 = g.BD * math.sin(g.alpha0) + self.mounted + slopes[0] @ q
        A2 = g.BD * math.cos(g.alpha0) + slopes[1] @ q
        length = np.hypot(A1, A2)
        d = np.maximum(length - (self.g.r_i + self.g.r_o - self.D), 0.0)
        return Balls(
            A1=A1,
            A2=A2,
            length=length,
            s=A1 / length,
            c=A2 / length,
            d=d,
            Q=self.factor * d**1.5,
            slopes=slopes,
        )

    @property
    def touch(self) -> float:
        """Returns the axial displacement [m] at which the last ball loses its load."""
        return self._displacement_at(0.0)

    def denting_displacement(self, pressure: float) -> float:
        """Returns the axial displacement [m] at which a ball first has this peak pressure [Pa]."""
        return self._displacement_at(
            (pressure / self.peak.max(axis=1)) ** 2 / self.factor ** (2.0 / 3.0)
        )

    def _displacement_at(self, d: float | np.ndarray) -> float:
        """Returns the least axial displacement at which a ball has its deformation [m].

        d: sum of both contacts' deformations, one for all balls or one for each (n,) [m].
        """
        return float(race_displacement(self.g, self.g.r_i + self.g.r_o - self.D + d).min())

    def force(self, displacement: float) -> float:
        """Returns the axial force [N] of all bearings in tandem at an axial displacement [m]."""
        # motion[0, _X] is 1, or -1 in the second bearing, which faces the other way
        b = self.balls(np.array([(displacement - self.mounted) / self.motion[0, _X], 0, 0, 0]))
        return self.tandem * float(b.Q @ b.s)


def resting_side(scene: Scene, a: Arrangement, k: int, loss: float | None) -> RestingSide:
    """Returns a bearing of a rotor at rest, with its contacts as two springs in series.

    scene: bearing at rest.
    a: arrangement with the other one.
    k: its number on the rotor, 0 or 1; the second one faces the other way.
    loss: of ball diameter, in place of the scene's if it is not None [m].
    """
    g = geometry(scene)
    facing = 1.0 - 2.0 * k
    outwards = -1.0 if a.orientation == "back_to_back" else 1.0
    # place on the rotor of the inner groove centres, at which the balls' forces act
    arm = (g.r_i - 0.5 * g.D0) * math.sin(g.alpha0)
    position = facing * (outwards * 0.5 * (a.span_mm or 0.0) * MM + arm)
    motion = [[facing, 0.0, 0.0, k], [0.0, 1.0, -position, 0.0], [0.0, 0.0, facing, 0.0]]
    D = worn_diameters(scene, g) if loss is None else np.full(g.n_balls, g.D0 - loss)
    factor, peak = series_contact(g, D)
    return RestingSide(
        g=g,
        D=D,
        psi=azimuths(g.n_balls),
        tandem=a.tandem[k],
        mounted=place_as_mounted(mounted_geometry(scene), float(scene.operation.preload_N)),
        motion=np.array(motion),
        factor=factor,
        peak=peak,
    )


class Balls(NamedTuple):
    """Balls between the grooves, each value (n,)."""

    A1: np.ndarray  # axial distance of the groove centres [m]
    A2: np.ndarray  # radial distance of the groove centres [m]
    length: np.ndarray  # distance of the groove centres [m]
    s: np.ndarray  # sine of the contact angle
    c: np.ndarray  # cosine of the contact angle
    d: np.ndarray  # deformation of both contacts [m]
    Q: np.ndarray  # load [N]
    slopes: np.ndarray  # (2, n, 4) derivatives of A1 and A2 by the position of the rotor

    @property
    def along(self) -> np.ndarray:
        """Returns the derivative (n, 4) of the length by the position of the rotor."""
        return self.s[:, None] * self.slopes[0] + self.c[:, None] * self.slopes[1]

    def stiffness(self, factor: np.ndarray) -> np.ndarray:
        """Returns the stiffness of the bearing by the position of the rotor (4, 4).

        factor: load over deformation^1.5 of each ball (n,) [N/m^1.5].
        """
        along, (axial, radial) = self.along, self.slopes
        # derivative of the contact angle, times the length
        across = self.c[:, None] * axial - self.s[:, None] * radial
        compression = 1.5 * factor * np.sqrt(self.d)
        turning = self.Q / self.length
        return (along.T * compression) @ along + (across.T * turning) @ across


def series_contact(g: Geometry, D: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns the load factors of n balls (n,), and their peak pressures under 1 N (n, 2) [Pa].

    A factor is load over deformation^1.5 of both contacts [N/m^1.5]. The curvature is that at the
    free contact angle, as in ISO 76. Where the angle opens from 15 to 21 degrees, this changes the
    peak pressure by 0.22 % at most.
    """
    factors, peaks = [], []
    for diameter in D.tolist():
        contacts = [
            race_contact(g, race, diameter, math.cos(g.alpha0), math.nan) for race in (INNER, OUTER)
        ]
        factors.append(sum(contact.K ** (-2.0 / 3.0) for contact in contacts) ** -1.5)
        peaks.append([1.5 / (math.pi * contact.c_a * contact.c_b) for contact in contacts])
    return np.array(factors), np.array(peaks)


def place_as_mounted(g: Geometry, preload: float) -> float:
    """Returns the axial displacement of an unworn bearing at rest under its preload alone [m]."""
    (factor,), _ = series_contact(g, np.array([g.D0]))
    across = g.BD * math.cos(g.alpha0)

    def unbalanced(A1: float) -> float:
        """Returns the thrust beyond the preload at an axial distance of the groove centres [N]."""
        length = math.hypot(A1, across)
        return g.n_balls * factor * max(length - g.BD, 0.0) ** 1.5 * A1 / length - preload

    A1_free = g.BD * math.sin(g.alpha0)
    A1 = brent_root(unbalanced, A1_free, A1_free + g.BD, **_PLACE_ROUNDING)
    return A1 - A1_free


@dataclass(frozen=True)
class RestingBearing:
    """One bearing of the rotor under a load; of several in tandem, the share of one."""

    axial: float  # force on its balls along its own load direction [N]
    radial: float  # [N]
    load: np.ndarray  # (n,) of each ball [N]
    pressure: np.ndarray  # (n, 2) peak, inner and outer race [Pa]
    gap: float  # axial distance to its first contact; 0 where a ball is loaded [m]
    past: float  # the same if all balls press on the other side of their grooves, else 0 [m]

    @property
    def is_open(self) -> bool:
        """Returns whether it has lost contact on the side of its contact angle."""
        return self.past > 0.0 or not self.load.any()


@dataclass(frozen=True)
class RestingRotor:
    """A rotor in equilibrium under a load."""

    shift: float  # axial displacement of its middle, towards +X [m]
    across: float  # radial displacement of its middle [m]
    tilt: float  # [rad]
    slide: float  # displacement of the second outer ring, which extends the spring [m]
    on_stop: float  # force on the stop of the spring [N]
    bearings: tuple[RestingBearing, ...]
    residual: float  # unbalanced force over the largest one [1]

    @property
    def gap(self) -> float:
        """Returns the largest gap of a bearing [m]."""
        return max(max(bearing.gap, bearing.past) for bearing in self.bearings)

    @property
    def pressure(self) -> float:
        """Returns the largest peak pressure [Pa]."""
        return max(float(bearing.pressure.max()) for bearing in self.bearings)


class _Energy(NamedTuple):
    """Energy of a rotor and its derivatives by the position of the rotor."""

    value: float  # [J]
    slope: np.ndarray  # (coordinates,) unbalanced forces [N, N m]
    stiffness: np.ndarray  # (coordinates, coordinates)
    largest: float  # sum of the loads of a bearing's balls, the larger one [N]


@dataclass(frozen=True)
class RotorAtRest:
    """A rotor on two bearings as mounted: warm, but not turning.

    A single bearing is half of a symmetric pair, held by a spring or at a fixed position.
    """

    seats: tuple[RestingSide, RestingSide]
    offset: float  # distance of the centre of mass from the middle, towards +X [m]
    spring: PreloadSpring | None

    @classmethod
    def of(cls, scene: Scene, losses: Sequence[float] | None = None) -> "RotorAtRest":
        """Returns the rotor of a scene, with balls as worn as the scene says.

        losses: loss of ball diameter in each bearing, in place of the scene's [m].
        """
        # both bearings of a symmetric pair are the one of the scene
        side_losses = (None, None) if losses is None else (tuple(losses) * 2)[:2]
        a = scene.arrangement or Arrangement()
        speeds = ("shaft_speed_rpm", "lowest_speed_rpm", "outer_speed_rpm")
        at_rest = {f"operation.{name}": 0.0 for name in speeds}
        sides = ([side.with_(at_rest) for side in scene.sides] * 2)[:2]
        first, second = (
            resting_side(side, a, k, loss)
            for k, (side, loss) in enumerate(zip(sides, side_losses, strict=True))
        )
        stop = math.inf if a.stop_um is None else a.stop_um * UM
        spring = None
        if scene.operation.preload_method == "constant_force":
            force = float(scene.operation.preload_N)
            k_s = a.spring_stiffness_N_um * N_UM
            spring = PreloadSpring(force, k_s, stop)
        return cls((first, second), a.rotor_offset_mm * MM, spring)

    def under(self, axial: float, radial: float = 0.0) -> RestingRotor | None:
        """Returns the rotor under a force at its centre of mass, towards +X and across [N].

        None where nothing supports it: the spring has neither stiffness nor a stop.
        """
        force = np.array([axial, radial, -self.offset * radial, 0.0])
        k_s = np.zeros((4, 4))
        if self.spring is None:
            position = self._least_energy(force, k_s, [_X, _Z, _TILT], np.zeros(4))
            return self._state(position, force, k_s)
        force[_SLIDE] = self.spring.force
        k_s[_SLIDE, _SLIDE] = self.spring.stiffness
        stop = self.spring.stop
        if self.spring.stiffness == 0.0 and stop == math.inf and axial <= -self.spring.force:
            return None
        position = self._least_energy(force, k_s, [_X, _Z, _TILT, _SLIDE], np.zeros(4))
        if position[_SLIDE] < -stop:
            start = np.array([0.0, 0.0, 0.0, -stop])
            position = self._least_energy(force, k_s, [_X, _Z, _TILT], start)
        return self._state(position, force, k_s)

    def frequencies(self, a: Arrangement) -> np.ndarray:
        """Returns axial, radial and conical frequency of the rotor without a load (3,) [Hz].

        They are those in its balance, or where it was mounted if nothing holds it.
        """
        rest, q = self.under(0.0), np.zeros(4)
        if rest is not None:
            q = np.array([rest.shift, rest.across, rest.tilt, rest.slide])
        K_1, K_2 = (seat.tandem * seat.balls(q).stiffness(seat.factor) for seat in self.seats)
        first, second = K_1[_X, _X], K_2[_X, _X]
        axial = first + second
        if self.spring is not None:
            k_s = self.spring.stiffness
            axial = first + (k_s * second / (k_s + second) if second else 0.0)
        return plane_frequencies(a, float(axial), (K_1 + K_2)[np.ix_(_PLANE, _PLANE)])

    @property
    def axial_rotor(self) -> AxialRotor:
        """Returns the rotor without radial load."""
        first, second = self.seats
        return AxialRotor(self.seats, (first.mounted, second.mounted), self.spring)

    def denting_force(self, pressure: float) -> float:
        """Returns the least axial force [N], in either direction, that causes a pressure [Pa].

        0 if the bearings have that pressure as mounted.
        """
        first, second = (seat.denting_displacement(pressure) for seat in self.seats)
        dents_first = self.axial_rotor.external(0, first)
        dents_second = -self.axial_rotor.external(1, second)
        return max(min(dents_first, dents_second), 0.0)

    def _energy(self, force: np.ndarray, k_s: np.ndarray, q: np.ndarray) -> _Energy:
        """Returns the energy of the rotor at a position `q`, with its derivatives.

        force: load on the coordinates (4,) [N, N m].
        k_s: stiffness of the spring (4, 4) [N/m].
        """
        E = 0.5 * q @ k_s @ q - force @ q
        slope = k_s @ q - force
        K = k_s
        largest = 0.0
        for seat in self.seats:
            b = seat.balls(q)
            n = seat.tandem
            E = E + 0.4 * n * (b.Q @ b.d)  # the integral of a force that goes as d^1.5
            slope = slope + n * (b.Q @ b.along)
            K = K + n * b.stiffness(seat.factor)
            largest = max(largest, n * float(b.Q.sum()))
        return _Energy(float(E), slope, K, largest)

    def _least_energy(
        self, force: np.ndarray, k_s: np.ndarray, free: list[int], q: np.ndarray
    ) -> np.ndarray:
        """Returns the position (4,) of least energy, found from a start `q`.

        Damped Newton steps are taken: where balls are loose, nothing may resist in some direction.
        Where they do not lead to a balance, the last position is returned: `_state` says by how
        much it is off.

        force: load on the coordinates (4,) [N, N m].
        k_s: stiffness of the spring (4, 4) [N/m].
        free: the coordinates that may move.
        """
        # lengths: of the steps, so that a tilt counts by the displacement of the groove
        lengths = np.array([1.0, 1.0, 1.0 / self.seats[0].g.R_i, 1.0])[free]

        def free_energy(q: np.ndarray) -> _Energy:
            """Returns the energy with derivatives by the scaled free coordinates alone."""
            energy = self._energy(force, k_s, q)
            return energy._replace(
                slope=energy.slope[free] * lengths,
                stiffness=energy.stiffness[np.ix_(free, free)] * np.outer(lengths, lengths),
            )

        here = free_energy(q)
        scale = max(float(np.sum(seat.factor)) for seat in self.seats) * math.sqrt(UM)
        damping = 0.0
        for _ in range(_MOST_STEPS):
            steepest = abs(here.slope).max()
            if steepest <= _BALANCED * max(here.largest, abs(force[:2]).max()):
                break
            try:
                step = np.linalg.solve(here.stiffness + damping * np.eye(len(free)), -here.slope)
            except np.linalg.LinAlgError:
                damping = max(_DAMPING_STEP * damping, _SOFTEST * scale)
                continue
            trial_q = q.copy()
            trial_q[free] += step * lengths
            trial = free_energy(trial_q)
            is_level = trial.value - here.value <= _ROUNDED * abs(here.value)
            if trial.value < here.value or (is_level and abs(trial.slope).max() < steepest):
                q, here = trial_q, trial
                damping *= 0.1  # the inverse of `_DAMPING_STEP`
            elif damping > _HARDEST * scale:
                break
            else:
                damping = max(_DAMPING_STEP * damping, _SOFTEST * scale)
        return q

    def _state(self, q: np.ndarray, force: np.ndarray, k_s: np.ndarray) -> RestingRotor:
        """Returns the rotor at a position `q` of balance; the arguments are `_least_energy`'s.

        Its residual is the largest of axial and radial force and moment over R_i that are left,
        over the largest load; 0 without any load. The force on the second outer ring is not in it.
        """
        bearings = []
        unbalanced = k_s @ q - force
        for seat in self.seats:
            b = seat.balls(q)
            unbalanced = unbalanced + seat.tandem * (b.Q @ b.along)
            free = seat.g.r_i + seat.g.r_o - seat.D
            to_touch = float((np.sqrt(np.maximum(free**2 - b.A2**2, 0.0)) - b.A1).min())
            loaded = b.s[b.Q > 0.0]
            bearings.append(
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
        if self.spring is not None and q[_SLIDE] == -self.spring.stop:
            on_stop = float(unbalanced[_SLIDE])
        rotor_unbalanced = unbalanced[:3] / (1.0, 1.0, self.seats[0].g.R_i)
        largest = max(abs(force[:2]).max(), *(bearing.load.sum() for bearing in bearings))
        residual = float(abs(rotor_unbalanced).max() / largest) if largest > 0.0 else 0.0
        x, z, tilt, slide = q.tolist()
        return RestingRotor(
            shift=x,
            across=z,
            tilt=tilt,
            slide=slide,
            on_stop=max(on_stop, 0.0),
            bearings=tuple(bearings),
            residual=residual,
        )


@dataclass(frozen=True)
class LaunchLoad:
    """A load of the launch, and the rotor under it."""

    name: str
    axial: float  # towards +X [N]
    radial: float  # [N]
    rotor: RestingRotor | None  # None where nothing holds it


@dataclass(frozen=True)
class LaunchResult:
    """Results of a launch in one state of wear."""

    loads: tuple[LaunchLoad, ...]
    axial_g: float  # axial acceleration: that of the scene, or the largest expected one if random
    radial_g: float  # radial acceleration, likewise
    random: dict[str, "RandomResponse"]  # by the direction of each density that is given
    frequencies: np.ndarray | None  # axial, radial, conical, at rest; None without a span [Hz]
    opening_g: float  # axial acceleration at which a bearing opens
    denting_g: float  # axial acceleration at which a bearing is dented
    pressure: float  # that dents the weaker of balls and races [Pa]
    source: str  # of this pressure

    @property
    def gap(self) -> float:
        """Returns the largest gap under the loads [m].

        0 without loads, infinite if nothing supports the rotor under one.
        """
        gaps = [math.inf if load.rotor is None else load.rotor.gap for load in self.loads]
        return max(gaps, default=0.0)

    @property
    def pressure_share(self) -> float:
        """Returns the largest peak pressure over the one that dents [1]; 0 without loads.

        Loads under which nothing supports the rotor do not count.
        """
        pressures = [load.rotor.pressure for load in self.loads if load.rotor is not None]
        return max(pressures, default=0.0) / self.pressure


def miles(density: float, frequency: float, amplification: float) -> float:
    """Returns the rms acceleration of an oscillator under random vibration [g].

    J. W. Miles, J. Aeronautical Sciences (Nov 1954) 753.

    density: of the acceleration [g2/Hz].
    frequency: of the oscillator [Hz].
    amplification: at resonance [1].
    """
    return math.sqrt(0.5 * math.pi * frequency * amplification * density)


def expected_peak(frequency: float, duration: float) -> float:
    """Returns the largest expected peak over a duration [s], over the rms of the response [1].

    The response is narrow-band, about a frequency f [Hz]: sqrt(2 ln(f t)) for f t independent
    amplitudes after Rayleigh, by Cartwright and Longuet-Higgins, Proc. R. Soc. A 237 (1956) 212.
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
        """Returns three times the rms acceleration, in g."""
        return THREE_SIGMA * self.rms_g

    @property
    def largest_g(self) -> float:
        """Returns the largest expected acceleration, at least three sigma, in g."""
        return max(THREE_SIGMA, self.expected) * self.rms_g


def check_launch(scene: Scene, source: str) -> None:
    """Raises SceneError if the rotor of a scene lacks a value that the launch requires.

    source: file of the scene, for the message.
    """
    a = scene.arrangement
    launch = scene.launch or Launch()
    needed = ["rotor_mass_kg"]
    densities = (launch.axial_density_g2_Hz, launch.radial_density_g2_Hz)
    if launch.radial_g or densities != (None, None):
        needed.append("span_mm")
    for name in needed:
        if a is None or getattr(a, name) is None:
            problem = "got nothing, expected a number > 0 for the launch analysis"
            raise SceneError(f"arrangement.{name}", problem, ("launch",), source)


def launch_result(scene: Scene, losses: Sequence[float] | None = None) -> LaunchResult:
    """Returns the result of a launch for a scene whose rotor has a mass.

    The loads act in both directions of the axis, across it, and along and across together.

    losses: as in `RotorAtRest.of`. Race wear counts as that of balls: both open the contacts.
    """
    a = scene.arrangement
    launch = scene.launch or Launch()
    rest = RotorAtRest.of(scene, losses)
    assert a is not None and a.rotor_mass_kg is not None
    weight = a.rotor_mass_kg * GRAVITY
    frequencies = rest.frequencies(a) if a.span_mm is not None else None
    responses = _random_responses(launch, frequencies)
    axial_g = responses["axial"].largest_g if "axial" in responses else launch.axial_g
    radial_g = responses["radial"].largest_g if "radial" in responses else launch.radial_g
    forces = launch_forces(axial_g * weight, radial_g * weight)
    loads = tuple(
        LaunchLoad(name=name, axial=axial, radial=radial, rotor=rest.under(axial, radial))
        for name, (axial, radial) in forces.items()
    )
    weakest = min(map(yield_pressure, scene.sides), key=lambda limit: limit.GPa)
    return LaunchResult(
        loads=loads,
        axial_g=axial_g,
        radial_g=radial_g,
        random=responses,
        frequencies=frequencies,
        opening_g=rest.axial_rotor.opening_force / weight,
        denting_g=rest.denting_force(weakest.GPa * GPA) / weight,
        pressure=weakest.GPa * GPA,
        source=weakest.source,
    )


def _random_responses(launch: Launch, frequencies: np.ndarray | None) -> dict[str, RandomResponse]:
    """Returns the responses to the densities of a launch, by their direction.

    frequencies: axial, radial and conical (3,) [Hz]; not needed without a density.
    """
    densities = {"axial": launch.axial_density_g2_Hz, "radial": launch.radial_density_g2_Hz}
    responses = {}
    for k, (direction, density) in enumerate(densities.items()):
        if density is not None:
            assert frequencies is not None
            f = float(frequencies[k])
            rms_g = miles(density, f, launch.amplification)
            responses[direction] = RandomResponse(rms_g, expected_peak(f, launch.duration_s))
    return responses


def launch_forces(axial: float, across: float) -> dict[str, tuple[float, float]]:
    """Returns axial and radial force of each load by its name, without those that are zero [N].

    axial, across: largest forces along the axis and across it [N].
    """
    forces = {"along +X": (axial, 0.0), "along -X": (-axial, 0.0)} if axial else {}
    if across:
        forces |= {"across": (0.0, across)}
    if axial and across:
        forces |= {"+X, across": (axial, across), "-X, across": (-axial, across)}
    return forces


def wear_at_launch(
    scene: Scene, new: Sequence[float], end: Sequence[float] | None
) -> tuple[float, ...] | None:
    """Returns the largest loss of ball diameter in each bearing before a launch [m].

    It is that at the end of life, or less if `launch.after_wear_um` of the scene limits it. None if
    neither is known.

    new, end: losses of each bearing when new and at the end of life, None where that is not known.
    """
    limit = (scene.launch or Launch()).after_wear_um
    largest = None if limit is None else tuple(loss + limit * UM for loss in new)
    if end is None or largest is None:
        return largest if end is None else tuple(end)
    return tuple(map(min, largest, end))


def launch_values(scene: Scene, wear: Sequence[Sequence[float]] = ()) -> dict[str, float]:
    """Returns result variables of a launch that requirements limit, the worst of new and worn.

    They are empty without the rotor's mass. Without a span they are those of axial forces, and
    launch_gap and launch_pressure_share are missing, as they are without loads. Infinite values are
    replaced by `FARTHEST_G` and `WIDEST_GAP`.

    wear: losses of each bearing when new and at the end of life, or when new alone [m]; if empty,
        those of the scene.
    """
    a = scene.arrangement
    if a is None or a.rotor_mass_kg is None:
        return {}
    if scene.launch is not None and a.span_mm is None:
        # no loads: radial and random ones take a span
        scene = replace(scene, launch=replace(Launch(), after_wear_um=scene.launch.after_wear_um))
    states: list[Sequence[float] | None] = [wear[0] if wear else None]
    states += [wear_at_launch(scene, wear[0], end) for end in wear[1:]]
    results = [launch_result(scene, losses) for losses in states]
    opening_g = min(FARTHEST_G, *(result.opening_g for result in results))
    denting_g = min(FARTHEST_G, *(result.denting_g for result in results))
    values = {"opening_acceleration": GRAVITY * opening_g}
    values["denting_acceleration"] = GRAVITY * denting_g
    if results[0].loads:
        values["launch_gap"] = min(max(result.gap for result in results), WIDEST_GAP)
        values["launch_pressure_share"] = max(result.pressure_share for result in results)
    return values
