"""One cycle of a duty: its conditions, and how much each adds to the mean rate of wear.

theory.md section 27.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from bearingwear.scene.duty import Duty, phase_cases
from bearingwear.scene.scene import Scene
from bearingwear.scene.slip import (
    LEAST_REGULARISATION,
    at_speed_share,
    regularisation_is_given,
    with_regularisation,
)

NO_FORCE_N = 1e-9
"""External force that makes both bearings of a symmetric pair be solved.

It is needed where the pair is alike in one phase and not in another. It is too small to change
their states.
"""


def ramp_points(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Returns n points of a linear ramp: shares of the full speed, and weights of the rates there.

    The weighted sum of the wear rates is the mean rate of a ramp from rest to full speed. The first
    point is the full speed.

    A wear rate is the speed times a smooth function of its square, because of the centrifugal
    effects. So the mean rate is half the integral of rate/speed over the square of the speed. Gauss
    and Radau's points of this integral include the full speed, at which the phase is solved anyway.
    """
    legendre = np.polynomial.legendre
    low, high = legendre.Legendre.basis(n - 1), legendre.Legendre.basis(n)
    # Radau's points on -1 to 1: -1, and the roots of (P_(n-1) + P_n)/(1 + x)
    inner = np.sort(((low + high) // legendre.Legendre([1.0, 1.0])).roots().real)
    weights = (1.0 - inner) / (n * low(inner)) ** 2
    squares = 0.5 * (1.0 - np.append(-1.0, inner))  # mirrored, so that the first is full speed
    speeds = np.sqrt(squares)
    return speeds, 0.25 * np.append(2.0 / n**2, weights) / speeds


@dataclass(frozen=True)
class Cycle:
    """The conditions of one cycle of a duty, and how much each adds to its mean wear rate.

    Conditions are the cases of the phases, each once, then the speeds on the way to them, then the
    instants of starts that warm up.
    """

    phases: tuple[str, ...]
    cases: tuple[str, ...]
    scenes: tuple[Scene, ...]  # of the conditions
    case_of_phase: tuple[int, ...]
    running: np.ndarray  # shares of the time of a cycle (phases, conditions)
    # weights of the rates on the way to the state of each phase and back (phases, conditions)
    starting: np.ndarray
    points: int  # of each ramp

    @property
    def bearings(self) -> int:
        """Returns the number of bearings that are solved in each condition."""
        return len(self.scenes[0].symmetric_half.sides)

    @property
    def case_scenes(self) -> tuple[Scene, ...]:
        """Returns the scenes of the cases, which are the first conditions."""
        return self.scenes[: len(self.cases)]

    @property
    def shares(self) -> np.ndarray:
        """Returns the weights of the conditions in the mean rate over a cycle (conditions,)."""
        shares_by_condition = np.concatenate([self.running, self.starting]).T
        # an exact sum does not depend on the order of the phases
        return np.array([math.fsum(shares) for shares in shares_by_condition])


def cycle_of(scene: Scene, points: int = 2) -> Cycle:
    """Returns the cycle of a scene's duty.

    Raises NotAvailable for a duty that warms up, where a start does not become steady.

    points: number of speeds of each ramp, the full speed included.
    """
    duty = scene.duty
    assert duty is not None
    scene_of_case = _with_equal_bearing_count(phase_cases(scene))
    cases = [*scene_of_case]
    case_of_phase = tuple(cases.index(duty.case_of(name)) for name in duty.phases)
    phases = [*zip(case_of_phase, duty.phases.values(), strict=True)]
    with_ramps = duty.steady_ramp_s > 0.0
    ramped = sorted({case for case, phase in phases if phase.starts and with_ramps})
    speeds, weights = ramp_points(points)
    scenes = [*scene_of_case.values()]
    scenes += [at_speed(scenes[case], speed) for case in ramped for speed in speeds[1:]]
    running, starting = np.zeros((2, len(phases), len(scenes)))
    for k, (case, phase) in enumerate(phases):
        running[k, case] = duty.running_s(phase) / duty.cycle_s
        if phase.starts and with_ramps:
            share = phase.starts * duty.steady_ramp_s / duty.cycle_s
            first = len(cases) + ramped.index(case) * (points - 1)
            starting[k, case] = share * weights[0]
            starting[k, first : first + points - 1] = share * weights[1:]
    cycle = Cycle(
        phases=tuple(duty.phases),
        cases=tuple(cases),
        scenes=tuple(scenes),
        case_of_phase=case_of_phase,
        running=running,
        starting=starting,
        points=points,
    )
    return _with_warm_starts(cycle, duty) if duty.warmup else cycle


def _with_warm_starts(cycle: Cycle, duty: Duty) -> Cycle:
    """Returns the cycle with the instants of its starts as further conditions.

    The bearings warm up in a start. The time that this takes is subtracted from the running time of
    the phase.
    """
    from bearingwear.lives.duty.warm import warm_start  # loads slowly; few lives need it

    scenes = [*cycle.scenes]
    running = cycle.running.copy()
    starting = cycle.starting
    phases = [*zip(cycle.case_of_phase, duty.phases.values(), strict=True)]

    def sort_key(k: int) -> tuple[float, ...]:
        """Returns the case, the hours and the starts of phase k."""
        case, phase = phases[k]
        return case, phase.hours, phase.starts

    # the conditions are in one order, whatever that of the phases
    for k in sorted(range(len(phases)), key=sort_key):
        case, phase = phases[k]
        if not phase.starts:
            continue
        longest = duty.running_s(phase) / phase.starts  # time at speed after each start [s]
        start = warm_start(cycle.scenes[case], duty.start_s, longest, cycle.points)
        running[k, case] -= phase.starts * start.warming_s / duty.cycle_s
        scenes += start.scenes
        no_share = np.zeros((len(cycle.phases), len(start.scenes)))
        running, starting = np.hstack([running, no_share]), np.hstack([starting, no_share])
        starting[k, -len(start.scenes) :] = phase.starts / duty.cycle_s * start.weights
    return replace(cycle, scenes=tuple(scenes), running=running, starting=starting)


def at_speed(scene: Scene, share: float) -> Scene:
    """Returns the scene with both races at a share of their speeds.

    A slip regularisation that the scene gives is scaled by the same share, as its error depends on
    its ratio to the slip. It is at least `LEAST_REGULARISATION`.
    """
    slower = at_speed_share(scene, share)
    if not regularisation_is_given(scene):
        return slower
    v_r = max(share * scene.friction.slip_regularisation_m_s, LEAST_REGULARISATION)
    friction = replace(slower.friction, slip_regularisation_m_s=v_r)
    return with_regularisation(replace(slower, friction=friction), is_given=True)


def _with_equal_bearing_count(scenes: dict[str, Scene]) -> dict[str, Scene]:
    """Returns the scenes of cases, changed so that each has the same number of bearings to solve.

    That number is one if every case has one bearing or a symmetric pair, and two otherwise.
    """
    reduced = {case: scene.symmetric_half for case, scene in scenes.items()}
    if len({len(scene.sides) for scene in reduced.values()}) == 1:
        return reduced
    tiny_force = {"arrangement.external_axial_N": NO_FORCE_N}
    return {
        case: scene if len(reduced[case].sides) > 1 else scene.with_(tiny_force)
        for case, scene in scenes.items()
    }
