"""One cycle of a duty: its conditions, and how much each adds to the mean rate of wear.

theory.md section 27.
"""

from dataclasses import dataclass, replace

import numpy as np

from bearingwear.scene.duty import phase_cases
from bearingwear.scene.scene import Scene
from bearingwear.scene.slip import (
    LEAST_REGULARISATION,
    at_share,
    regularisation_is_given,
    regularised,
)

NO_FORCE_N = 1e-9
"""External force of a pair that is alike in one phase and not in another: none, but both bearings
are solved."""


def ramp_points(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Speeds over the full one, and weights of the wear rates there, of a ramp by n points.

    A wear rate is the speed times a smooth function of its square, because of the centrifugal
    effects: the mean over a ramp is half the integral of rate over speed over that square. Gauss
    and Radau's points on it include the full speed, at which the phase is solved anyway.
    """
    legendre = np.polynomial.legendre
    low, high = legendre.Legendre.basis(n - 1), legendre.Legendre.basis(n)
    inner = np.sort(((low + high) // legendre.Legendre([1.0, 1.0])).roots().real)
    weights = (1.0 - inner) / (n * low(inner)) ** 2
    squares = 0.5 * (1.0 - np.append(-1.0, inner))  # mirrored: the end is at full speed
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
    running: np.ndarray  # (phases, conditions) shares of the time of a cycle
    starting: np.ndarray  # weights of the rates on the way to the state of each phase and back
    points: int  # of each ramp

    @property
    def bearings(self) -> int:
        """Bearings that are solved in each condition."""
        return len(self.scenes[0].one_of_alike.sides)

    @property
    def shares(self) -> np.ndarray:
        """Weights (conditions,) of the rates in the mean over a cycle."""
        shares: np.ndarray = (self.running + self.starting).sum(axis=0)
        return shares


def cycle_of(scene: Scene, points: int = 2) -> Cycle:
    """The cycle of a scene's duty, with so many points of each ramp."""
    duty = scene.duty
    assert duty is not None
    scene_of_case = _solved_alike(phase_cases(scene))
    cases = [*scene_of_case]
    ramped = [
        case
        for case in cases
        if duty.steady_ramp_s > 0.0
        and any(p.starts for name, p in duty.phases.items() if duty.case_of(name) == case)
    ]
    speeds, weights = ramp_points(points)
    scenes = [*scene_of_case.values()]
    scenes += [at_speed(scene_of_case[case], s) for case in ramped for s in speeds[1:]]
    running, starting = np.zeros((2, len(duty.phases), len(scenes)))
    for k, (name, phase) in enumerate(duty.phases.items()):
        case = cases.index(duty.case_of(name))
        running[k, case] = duty.running_s(phase) / duty.cycle_s
        if phase.starts and duty.steady_ramp_s > 0.0:
            share = phase.starts * duty.steady_ramp_s / duty.cycle_s
            first = len(cases) + ramped.index(cases[case]) * (points - 1)
            starting[k, case] = share * weights[0]
            starting[k, first : first + points - 1] = share * weights[1:]
        if phase.starts and duty.warmup:
            from bearingwear.lives.duty.warm import warm_start  # loads slowly; few lives need it

            longest = duty.running_s(phase) / phase.starts
            start = warm_start(scene_of_case[cases[case]], duty.start_s, longest, points)
            running[k, case] -= phase.starts * start.warming_s / duty.cycle_s
            scenes += start.scenes
            more = np.zeros((len(duty.phases), len(start.scenes)))
            running, starting = np.hstack([running, more]), np.hstack([starting, more])
            starting[k, -len(start.scenes) :] = phase.starts / duty.cycle_s * start.weights
    of_phase = tuple(cases.index(duty.case_of(name)) for name in duty.phases)
    return Cycle(
        phases=tuple(duty.phases),
        cases=tuple(cases),
        scenes=tuple(scenes),
        case_of_phase=of_phase,
        running=running,
        starting=starting,
        points=points,
    )


def at_speed(scene: Scene, share: float) -> Scene:
    """The scene with both races at a share of their speeds.

    A regularisation that the scene gives follows: its error depends on it over the slip.
    """
    slower = at_share(scene, share)
    if not regularisation_is_given(scene):
        return slower
    given = max(share * scene.friction.slip_regularisation_m_s, LEAST_REGULARISATION)
    friction = replace(slower.friction, slip_regularisation_m_s=given)
    return regularised(replace(slower, friction=friction), given=True)


def _solved_alike(scenes: dict[str, Scene]) -> dict[str, Scene]:
    """Scenes of cases, each of one bearing or each of two."""
    alone = {name: one.one_of_alike for name, one in scenes.items()}
    if len({len(one.sides) for one in alone.values()}) == 1:
        return alone
    return {
        name: one if len(one.one_of_alike.sides) > 1 else one.with_(
            {"arrangement.external_axial_N": NO_FORCE_N}
        )
        for name, one in scenes.items()
    }  # fmt: skip
