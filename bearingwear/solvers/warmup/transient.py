"""Temperatures of rings and balls on the way to speed, with the preload and pressure they make.

The balls settle a million times faster than metal warms, so each instant is a steady state at the
temperatures and the speed of that instant. Theory: docs/theory.md, section 28.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.integrate import BDF

from bearingwear.kernels import status as code
from bearingwear.scene.scene import Scene
from bearingwear.scene.slip import at_speed_share
from bearingwear.scene.warmth import Thermal, check_heat_capacities
from bearingwear.solvers.bearing_states import bearings_at_temperatures, heats_of, states_of
from bearingwear.solvers.compose import solver_of
from bearingwear.solvers.condition import SolvedBearing, States
from bearingwear.solvers.rotor import Alone, OnRotor, RotorState
from bearingwear.solvers.thermal import (
    PARTS_OF_BEARING,
    HeatFlow,
    all_conductances,
    heat_of_parts,
    heat_slopes,
    thermal_margin,
)

LINEAR_SHARE = 0.01
"""Share of the full speed below which the heat goes in proportion to the speed, as it does with
Coulomb friction and without centrifugal loads."""

STEP_TOLERANCE = 1e-5
"""Relative error of a step, of the largest temperature rise."""

COARSER = 10.0
"""Factor on the tolerance of the steps in a second warm-up, by which the error is estimated."""

LEAST_RISE = 0.01
"""Least temperature rise by which the absolute tolerance of a step is scaled [K]."""

SETTLED_TO = 1e-3
"""Distance to the steady temperatures at which a warm-up ends, over the rise to them."""

_MOST_SHORTER, _SHORTER = 12, 0.2  # of the longest step, where the bearings have no state after it
_BETWEEN_CHECKS = 5  # steps
_LONGEST = 300.0  # slowest time constants of the network without heat that a warm-up may last


class NoState(Exception):
    """The bearings have no state at the temperatures and the speed of an instant."""

    def __init__(self, status: int):
        super().__init__()
        self.status = status


class SpeedCourse(NamedTuple):
    """Shares of the full speed (n,) at times (n,) [s]; constant after the last one."""

    times: tuple[float, ...]
    shares: tuple[float, ...]

    def at(self, time: float) -> float:
        """Returns the share of the full speed at a time [s]."""
        return float(np.interp(time, self.times, self.shares))


def ramp(seconds: float) -> SpeedCourse:
    """Returns the course of a constant acceleration from rest to full speed in some seconds."""
    return SpeedCourse((0.0, seconds), (0.0, 1.0)) if seconds else SpeedCourse((0.0,), (1.0,))


def course_of(scene: Scene, pairs: Sequence[tuple[float, float]]) -> SpeedCourse:
    """Returns the course of speeds, as shares of the speed of a scene.

    pairs: times [s] and speeds [r/min].
    """
    times, speeds = zip(*pairs, strict=True)
    return SpeedCourse(times, tuple(rpm / scene.operation.shaft_speed_rpm for rpm in speeds))


class Instant(NamedTuple):
    """Bearings at one instant of a warm-up."""

    time: float  # [s]
    share: float  # of the full speed
    temperatures: np.ndarray  # (bearing, part) [degC]
    states: States
    heats: tuple[HeatFlow, ...]
    stiffness: float  # axial, of the arrangement [N/m]


@dataclass(frozen=True)
class WarmUp:
    """Instants of a warm-up, and how it ended."""

    scene: Scene
    instants: tuple[Instant, ...]
    status: int  # why there is no state after the last instant; ok where the bearings settled
    margin: float  # thermal margin at the last instant
    left: float  # distance to the steady temperatures at the last instant, over the rise

    @property
    def runs_away(self) -> bool:
        """Returns whether the heat grew faster than it could flow off until no state was left."""
        return self.status != code.OK and self.margin < 1.0


class _SolvedInstant(NamedTuple):
    """Bearings of an instant, solved."""

    bearings: Alone | OnRotor
    rotor: RotorState
    heats: tuple[HeatFlow, ...]  # of each bearing


class ThermalBearings:
    """Bearings of a scene with a thermal network, at temperatures and speeds that are given."""

    def __init__(self, scene: Scene):
        self.scene = scene
        self.sides = scene.symmetric_half.sides
        check_heat_capacities(self.sides, scene.name)
        self.near: list[SolvedBearing | None] = [None] * len(self.sides)
        self.solves = 0
        # the last share of the speed, and the bearings at that share
        self._last: tuple[float, Alone | OnRotor] = (np.nan, solver_of(scene).bearings)

    def networks(self) -> list[Thermal]:
        """Returns the thermal network of each bearing, which all have."""
        networks = [side.thermal for side in self.sides]
        assert all(networks)
        return networks  # type: ignore[return-value]

    def instant(self, time: float, share: float, temperatures: np.ndarray) -> Instant:
        """Returns the bearings at a share of their speed and temperatures (bearing, part) [degC].

        Raises NoState where they have none.

        time: for the temperatures of shaft and housing [s].
        """
        solved = self._solved(time, share, temperatures)
        states = states_of(solved.bearings, solved.bearings.start, solved.rotor)
        return Instant(
            time=time,
            share=share,
            temperatures=temperatures,
            states=states,
            heats=solved.heats,
            stiffness=solved.rotor.stiffness,
        )

    def heat(self, time: float, share: float, temperatures: np.ndarray) -> np.ndarray:
        """Returns the heat of all parts (parts,) [W]; the arguments are those of `instant`.

        It takes one solve, where `instant` may take more for the thermal margin. Raises NoState.
        """
        return heat_of_parts(self._solved(time, share, temperatures).heats)

    def _solved(self, time: float, share: float, temperatures: np.ndarray) -> _SolvedInstant:
        """Returns the bearings solved as in `instant`, each from its last solution in `near`.

        Renews `near` and counts `solves`. Below `LINEAR_SHARE` of the speed, they are solved at
        that share, and their heat is reduced in proportion. Raises NoState.
        """
        solved_share = max(share, LINEAR_SHARE)
        networks = [network_at(network, time) for network in self.networks()]
        bearings = bearings_at_temperatures(self._bearings(solved_share), temperatures, networks)
        if bearings is None:
            raise NoState(code.WARM_SEIZURE)
        if isinstance(bearings, Alone):
            bearings.near = self.near[0]
        else:
            bearings.near = list(self.near)
        self.solves += 1
        rotor = bearings.solve(bearings.start)
        if rotor.status != code.OK:
            raise NoState(rotor.status)
        self.near = list(rotor.sides)
        heats = tuple(
            HeatFlow(*(share / solved_share * np.array(heat))) for heat in heats_of(bearings, rotor)
        )
        return _SolvedInstant(bearings, rotor, heats)

    def _bearings(self, share: float) -> Alone | OnRotor:
        """Returns the bearings at a share of their speed, the last ones if the share is theirs."""
        last_share, bearings = self._last
        if share != last_share:
            bearings = solver_of(at_speed_share(self.scene, share)).bearings
            self._last = share, bearings
        return bearings

    def heat_slopes(self, instant: Instant) -> np.ndarray | None:
        """Returns derivatives of the heat of all parts by their temperatures (parts, parts) [W/K].

        None where states beside that of the instant are missing for each of `DIFFERENCES`.
        """

        def heats(temperatures: np.ndarray) -> np.ndarray | None:
            """Returns the heat of all parts at other temperatures; None without a state."""
            try:
                return self.heat(instant.time, instant.share, temperatures)
            except NoState:
                return None

        return heat_slopes(heats, instant.temperatures)


class HeatEquation:
    """C dT/dt = heat(T, t) - G (T - temperatures of the surroundings), of all parts."""

    def __init__(self, bearings: ThermalBearings, course: SpeedCourse):
        self.bearings, self.course = bearings, course
        self.networks = bearings.networks()
        self.G = all_conductances(self.networks)
        capacities: list[float] = []
        for network in self.networks:
            parts = network.heat_capacity_J_K
            assert parts is not None
            capacities += [parts.inner_ring, parts.balls, parts.outer_ring]
        self.C = np.array(capacities)

    @property
    def start(self) -> np.ndarray:
        """Returns the mounting temperatures of all parts (parts,) [degC]."""
        references = [network.reference_C for network in self.networks]
        return np.repeat(references, PARTS_OF_BEARING).astype(float)

    @property
    def slowest(self) -> float:
        """Returns the slowest time constant without heat, of parts, shaft and housing [s]."""
        rates = np.linalg.eigvals(self.G / self.C[:, None]).real
        time_constants = [1.0 / float(rates.min())]
        for network in self.networks:
            time_constants += [network.shaft_time_constant_s, network.housing_time_constant_s]
        return max(time_constants)

    def heat_from_surroundings(self, time: float) -> np.ndarray:
        """Returns the heat that shaft and housing conduct into parts at 0 degC (parts,) [W]."""
        flows = []
        for network in self.networks:
            G = network.conductance_W_K
            now = network_at(network, time)
            flows += [G.inner_ring_shaft * now.shaft_C, 0.0, G.outer_ring_housing * now.housing_C]
        return np.array(flows)

    def instant(self, time: float, y: np.ndarray) -> Instant:
        """Returns the bearings at a time [s] and temperatures (parts,) [degC]; raises NoState."""
        temperatures = np.reshape(y, (-1, PARTS_OF_BEARING))
        return self.bearings.instant(time, self.course.at(time), temperatures)

    def __call__(self, time: float, y: np.ndarray) -> np.ndarray:
        """Returns dT/dt (parts,) [K/s] at temperatures (parts,) [degC]; raises NoState."""
        temperatures = np.reshape(y, (-1, PARTS_OF_BEARING))
        heat = self.bearings.heat(time, self.course.at(time), temperatures)
        return (heat + self.heat_from_surroundings(time) - self.G @ y) / self.C


def network_at(network: Thermal, time: float) -> Thermal:
    """Returns the network with the temperatures of shaft and housing at a time [s]."""
    start = network.reference_C
    return replace(
        network,
        shaft_C=_temperature_at(time, start, network.shaft_C, network.shaft_time_constant_s),
        housing_C=_temperature_at(time, start, network.housing_C, network.housing_time_constant_s),
    )


def _temperature_at(time: float, start: float, end: float, constant: float) -> float:
    """Returns a temperature that approaches its end exponentially, or at once if constant is 0.

    constant: time constant [s].
    """
    return end + (start - end) * float(np.exp(-time / constant)) if constant else end


def warm_up(
    scene: Scene,
    course: SpeedCourse,
    duration: float | None = None,
    tolerance: float = STEP_TOLERANCE,
) -> WarmUp:
    """Returns the warm-up of a scene with heat capacities, until its temperatures are steady.

    It also ends after `_LONGEST`, and where the bearings have no state, with that status; the
    status is OK otherwise. Raises NoState without a state at the start, and SceneError without heat
    capacities.

    duration: end in place of steady temperatures, which are then not looked for [s].
    tolerance: relative error of a step.
    """
    equation = HeatEquation(ThermalBearings(scene), course)
    last = course.times[-1]
    end = duration or last + _LONGEST * equation.slowest
    instants = [equation.instant(0.0, equation.start)]
    status, left = code.OK, np.inf
    # the acceleration changes at corners, so a step ends there
    for corner in [*(time for time in course.times[1:] if time < end), end]:
        checked = len(instants)
        for answer in _steps(equation, instants[-1], corner, tolerance):
            if isinstance(answer, int):
                status = answer
                break
            instants.append(answer)
            is_late = duration is None and answer.time >= last
            if is_late and len(instants) >= checked + _BETWEEN_CHECKS:
                checked, left = len(instants), _distance_left(equation, answer)
                if left < SETTLED_TO:
                    break
        if status != code.OK or left < SETTLED_TO:
            break
    slopes = equation.bearings.heat_slopes(instants[-1])
    return WarmUp(
        scene=scene,
        instants=tuple(instants),
        status=status,
        margin=thermal_margin(equation.networks, slopes),
        left=left,
    )


def _steps(
    equation: HeatEquation, start: Instant, end: float, tolerance: float
) -> Iterator[Instant | int]:
    """Yields the instants after each step up to an end [s].

    Where there is no state before the end, a status is the last that is yielded: that of the
    bearings, after some shorter steps, or NO_HEAT_BALANCE if the integration fails.

    tolerance: relative error of a step.
    """
    time = start.time
    y = start.temperatures.ravel()
    bearings = equation.bearings
    near = list(equation.bearings.near)
    longest = np.inf
    lost = 0
    while time < end:
        rise = max(float(np.abs(y - equation.start).max()), LEAST_RISE)
        reach = end - time
        try:
            method = BDF(
                equation, time, y, end, rtol=tolerance, atol=tolerance * rise, max_step=longest
            )
            while method.status == "running":
                method.step()
                if method.status == "failed":
                    yield code.NO_HEAT_BALANCE
                    return
                instant = equation.instant(method.t, method.y.copy())
                time = method.t
                y = instant.temperatures.ravel()
                near = list(bearings.near)
                yield instant
        except NoState as unsolved:
            lost += 1
            if lost == _MOST_SHORTER:
                yield unsolved.status
                return
            bearings.near = list(near)
            longest = _SHORTER * min(longest, reach)


def _distance_left(equation: HeatEquation, instant: Instant) -> float:
    """Returns the distance to the steady temperatures by one Newton step, over the rise so far [1].

    While shafts and housings alone are farther away than `SETTLED_TO`, it is their distance, which
    takes no solves. It is infinite where a state beside that of the instant is missing.
    """
    y = instant.temperatures.ravel()
    rise = max(float(np.abs(y - equation.start).max()), LEAST_RISE)
    surroundings = _shaft_and_housing_left(equation, instant.time) / rise
    if surroundings >= SETTLED_TO:
        return surroundings
    slopes = equation.bearings.heat_slopes(instant)
    if slopes is None:
        return np.inf
    step = np.linalg.solve(equation.G - slopes, equation.C * equation(instant.time, y))
    return max(float(abs(step).max()) / rise, surroundings)


def _shaft_and_housing_left(equation: HeatEquation, time: float) -> float:
    """Returns how far shafts and housings are from their final temperatures at most [K]."""
    distances = []
    for network in equation.networks:
        now = network_at(network, time)
        distances += [abs(now.shaft_C - network.shaft_C), abs(now.housing_C - network.housing_C)]
    return max(distances)
