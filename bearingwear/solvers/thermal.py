"""Temperatures of rings and balls from the friction heat: a network of three parts.

Heat makes the parts grow, growth changes the loads, and loads make heat (theory.md section 18).
The thermal margin says how far a balance is from running away (section 28).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.scene import Scene
from bearingwear.scene.warmth import Temperature, Thermal

HEAT_BALANCED = 1e-7  # of the heat: largest difference of heat made and carried away
LARGEST_HEAT_RESIDUAL = 1e-5  # the same, for a verified solve
MOST_SOLVES = 40
LAST_BITS = 2.0**-49  # of a temperature
RUNAWAY = 0.999  # heat that one more watt of heat makes, above which it grows without bound [W/W]
JOINT_ROOT = 1e-9  # relative error of the heat of two bearings that is sought together
JOINT_STEP = 1e-3  # of all heat: step of a derivative by which their balance is called stable
MOST_STALLED = 3  # solves without gain after which what is left counts as an error of the heat
ABOVE_ERROR = 30.0  # largest such error, and least step of a slope, over the error that is expected
MOST_HALVED = 6  # halvings of a step at whose end the bearing has no state


class HeatFlow(NamedTuple):
    """Heat of a whole bearing [W]."""

    inner: float  # friction in the inner contacts
    outer: float
    drag: float  # power of the lubricant drag on the balls

    @property
    def total(self) -> float:
        """Returns the sum of all heat [W]."""
        return self.inner + self.outer + self.drag


NO_HEAT = HeatFlow(inner=0.0, outer=0.0, drag=0.0)

Heats = Callable[[Scene], tuple[int, HeatFlow]]
"""Status and heat of a scene with given temperatures."""


@dataclass(frozen=True)
class Warmed:
    """A scene at the temperatures at which its friction heat is carried away."""

    status: int
    scene: Scene  # with these temperatures given
    heat: HeatFlow  # as last solved
    solves: int
    slope: np.ndarray  # derivative of heat made less heat h by h, at the end of the search

    @classmethod
    def as_given(cls, scene: Scene) -> "Warmed":
        """Returns a scene with given temperatures as a balance, which took no solves."""
        return cls(status=code.OK, scene=scene, heat=NO_HEAT, solves=0, slope=np.zeros((3, 3)))

    @property
    def sentence(self) -> str:
        """Returns the state of a search that has not converged, in words."""
        t = self.scene.temperature or Temperature()
        return (
            f"not converged after {self.solves} iterations: {self.heat.total:.3g} W of heat, inner "
            f"ring {t.inner_ring_C:.4g}, balls {t.balls_C:.4g}, outer ring {t.outer_ring_C:.4g} "
            f"degC"
        )


HEAT_TO_PARTS = np.array([[0.5, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 0.5, 1.0]])
"""Share of each heat of `HeatFlow` that goes to the inner ring, the balls and the outer ring: half
of the friction heat of a contact to the ring and half to the ball, the heat of the drag to the
outer ring (both assumed)."""


def conductances(thermal: Thermal) -> np.ndarray:
    """Returns the matrix G (3, 3): G @ T is the heat that leaves each part at temperatures T [W/K].

    Parts are inner ring, balls and outer ring; T is relative to shaft and housing, equally warm.
    """
    G = thermal.conductance_W_K
    shaft, housing, ball = G.inner_ring_shaft, G.outer_ring_housing, G.ball_race
    return np.array(
        [
            [shaft + ball, -ball, 0.0],
            [-ball, 2.0 * ball, -ball],
            [0.0, -ball, ball + housing],
        ]
    )


def network_temperatures(thermal: Thermal, heat: HeatFlow) -> Temperature:
    """Returns the temperatures at which the network carries a heat away."""
    # relative to the shaft, so that no heat and no difference give its temperature to the last bit
    from_housing = thermal.conductance_W_K.outer_ring_housing * (
        thermal.housing_C - thermal.shaft_C
    )
    heat_in = HEAT_TO_PARTS @ np.array(heat) + [0.0, 0.0, from_housing]
    rises = np.linalg.solve(conductances(thermal), heat_in)
    return thermal.parts(*(thermal.shaft_C + float(t) for t in rises))


def heat_flow_residual(thermal: Thermal, t: Temperature, heat: HeatFlow) -> float:
    """Returns the largest imbalance of the heat flows of the three parts, over all heat [1].

    It is summed part by part, apart from the solver, less the effect of rounding. Heat that flows
    from a warm shaft to a cold housing counts as heat. 0 without any heat.
    """
    G = thermal.conductance_W_K
    assert t.inner_ring_C is not None and t.balls_C is not None and t.outer_ring_C is not None
    to_shaft = G.inner_ring_shaft * (t.inner_ring_C - thermal.shaft_C)
    to_housing = G.outer_ring_housing * (t.outer_ring_C - thermal.housing_C)
    from_inner = G.ball_race * (t.inner_ring_C - t.balls_C)
    to_outer = G.ball_race * (t.balls_C - t.outer_ring_C)
    imbalances = (
        0.5 * heat.inner - to_shaft - from_inner,
        0.5 * heat.inner + 0.5 * heat.outer + from_inner - to_outer,
        0.5 * heat.outer + heat.drag + to_outer - to_housing,
    )
    # the imbalance that the last bit of a temperature can make where there is hardly any heat
    hottest = max(abs(t.inner_ring_C), abs(t.balls_C), abs(t.outer_ring_C))
    rounding = LAST_BITS * hottest * max(G.inner_ring_shaft, G.outer_ring_housing, G.ball_race)
    scale = max(heat.total, abs(to_shaft), abs(to_housing))
    return max(max(map(abs, imbalances)) - rounding, 0.0) / scale if scale > 0.0 else 0.0


def at_temperatures(scene: Scene, heat: HeatFlow) -> Scene | None:
    """Returns the scene at the temperatures of a heat; None if it cannot be so warm."""
    assert scene.thermal is not None
    t = network_temperatures(scene.thermal, heat)
    try:
        return replace(scene, temperature=t, thermal=None)
    except SceneError:
        return None


def find_heat_balance(
    scene: Scene, heats: Heats, start: Warmed | None = None, heat_error: float = 0.0
) -> Warmed:
    """Returns a scene with a thermal network at the temperatures of its friction heat.

    Its status is OK; UNVERIFIED if the heat flows are not in balance; WARM_SEIZURE if the heat runs
    away; NO_HEAT_BALANCE if the search fails; or that of a bearing which has no state on the way.

    The heat h is a fixed point: at the temperatures of h the bearing makes h. Broyden's method
    finds it, from a solve nearby or cold; its first step takes the heat that the bearing makes.
    While one more watt of heat makes a watt or more, no balance is near. The heat is then followed
    upwards, to a balance or to where the bearing has none (`warm_seizure`).

    heats: returns status and heat of the scene at given temperatures.
    start: balance nearby to start from; if that fails, the search begins again from no heat.
    heat_error: relative error of the heats, which limits the balance.
    """
    if start is not None:
        balance = _search(scene, heats, np.array(start.heat), start.slope.copy(), heat_error)
        if balance.status == code.OK:
            return balance
    return _search(scene, heats, np.zeros(3), -np.eye(3), heat_error)


def _search(
    scene: Scene, heats: Heats, h: np.ndarray, slope: np.ndarray, heat_error: float
) -> Warmed:
    """Returns the balance found from a heat `h` (3,) [W] and its slope, see `Warmed.slope`.

    Steps are by Broyden's rule, halved where the bearing has no state at their end. The slope is
    changed in place. The statuses are those of `find_heat_balance`; after `MOST_SOLVES` the search
    has failed.
    """
    last_h = h
    last_excess = None
    step = np.zeros(3)
    last_scene = scene
    runs_away = False  # more heat makes still more
    halved, unsolved = 0, 0  # halvings of this step; heats at which the bearing had no state
    tolerance = max(HEAT_BALANCED, heat_error)
    least = math.inf  # imbalance [W]
    stalled = 0  # solves since then
    for solves in range(1, MOST_SOLVES + 1):
        warm = at_temperatures(scene, HeatFlow(*h))
        if warm is None:
            status = code.NO_HEAT_BALANCE
            heat = HeatFlow(*h)
        else:
            last_scene = warm
            status, heat = heats(warm)
        if status != code.OK:
            unsolved += 1
            is_last = halved == MOST_HALVED or unsolved > 2 * MOST_HALVED
            if last_excess is None or runs_away or is_last:
                failure = code.WARM_SEIZURE if runs_away else status
                return Warmed(
                    status=failure, scene=last_scene, heat=HeatFlow(*h), solves=solves, slope=slope
                )
            halved += 1
            step = 0.5 * step
            h = last_h + step
            continue
        excess = np.array(heat) - h
        imbalance = float(np.abs(excess).max())
        stalled = 0 if imbalance < least else stalled + 1
        least = min(least, imbalance)
        error = tolerance if stalled < MOST_STALLED else ABOVE_ERROR * tolerance
        if imbalance <= error * heat.total:
            return _verified_balance(scene, last_scene, heat, error, solves, slope)
        if last_excess is not None:
            if not step.any():
                break  # no heat below zero is left to try
            if np.abs(step).max() > ABOVE_ERROR * tolerance * heat.total:
                slope += np.outer(excess - last_excess - slope @ step, step) / (step @ step)
                runs_away = 1.0 + (excess - last_excess) @ step / (step @ step) > RUNAWAY
        last_h = h
        last_excess = excess
        halved = 0
        h = np.maximum(h + (excess if runs_away else -np.linalg.solve(slope, excess)), 0.0)
        step = h - last_h
    failure = code.WARM_SEIZURE if runs_away else code.NO_HEAT_BALANCE
    return Warmed(status=failure, scene=last_scene, heat=HeatFlow(*h), solves=solves, slope=slope)


def _verified_balance(
    scene: Scene, warm: Scene, heat: HeatFlow, error: float, solves: int, slope: np.ndarray
) -> Warmed:
    """Returns a balance with the status OK if its heat flows are in balance, else UNVERIFIED.

    scene, warm: with the thermal network, and at the temperatures found.
    error: relative error of the heat.
    solves, slope: see `Warmed`.
    """
    assert scene.thermal is not None and warm.temperature is not None
    residual = heat_flow_residual(scene.thermal, warm.temperature, heat)
    allowed = max(LARGEST_HEAT_RESIDUAL, error)
    status = code.OK if residual <= allowed else code.UNVERIFIED
    return Warmed(status=status, scene=warm, heat=heat, solves=solves, slope=slope)


class _Unsolved(Exception):
    """The bearings have no state with some heat."""


def find_joint_heat_balance(
    scenes: Sequence[Scene],
    heats: Callable[[Sequence[Scene]], Sequence[HeatFlow] | None],
    heat_error: float = 0.0,
) -> list[Warmed] | None:
    """Returns bearings on one rotor at their temperatures; None if no stable ones are found.

    The temperatures of all are sought together. A bearing may run away where the rotor is held at a
    place, and yet be stable where the rotor moves to its balance.

    scenes: bearings with thermal networks.
    heats: the heat of each in scenes with given temperatures; None without a state.
    heat_error: as in `find_heat_balance`.
    """
    size = len(HeatFlow._fields)
    solves = 0

    def warm_scenes(h: np.ndarray) -> list[Scene]:
        """Returns the scenes at the temperatures of heats (3 of each bearing,) [W].

        Raises _Unsolved if one cannot be so warm.
        """
        flows = (HeatFlow(*heat) for heat in h.reshape(-1, size))
        warm = [at_temperatures(scene, heat) for scene, heat in zip(scenes, flows, strict=True)]
        if None in warm:
            raise _Unsolved
        return warm  # type: ignore[return-value]

    def heat_made(h: np.ndarray) -> np.ndarray:
        """Returns the heats [W] that the bearings make at the temperatures that heats `h` cause.

        It counts in `solves`. Raises _Unsolved if the bearings have no state there.
        """
        nonlocal solves
        solves += 1
        heat_flows = heats(warm_scenes(h))
        if heat_flows is None:
            raise _Unsolved
        return np.ravel(heat_flows)

    from scipy.optimize import root  # loads slowly; few rotors need it

    try:
        start = heat_made(np.zeros(size * len(scenes)))
        options = {"eps": JOINT_STEP**2, "factor": 1.0}
        h = root(lambda h: heat_made(h) - h, start, tol=JOINT_ROOT, options=options).x
        heat_flows = heat_made(h)
        step = JOINT_STEP * heat_flows.sum()
        gains = [(heat_made(h + move) - heat_flows) / step for move in step * np.eye(h.size)]
    except _Unsolved:
        return None
    # one more watt of heat must make less than a watt
    is_stable = float(np.linalg.eigvals(gains).real.max()) < 1.0
    allowed = max(HEAT_BALANCED, heat_error) * heat_flows.reshape(-1, size).sum(
        axis=1, keepdims=True
    )
    if not (is_stable and np.all(np.abs(heat_flows - h).reshape(-1, size) <= allowed)):
        return None
    return [
        Warmed(
            status=code.OK, scene=scene, heat=HeatFlow(*heat), solves=solves, slope=-np.eye(size)
        )
        for scene, heat in zip(warm_scenes(h), heat_flows.reshape(-1, size).tolist(), strict=True)
    ]


PARTS_OF_BEARING = 3
LOW_MARGIN = 1.5
"""Thermal margin below which a design is warned of, a rule of thumb."""

DIFFERENCES = (0.5, 5e-3)
"""Temperature steps to both sides of a derivative of the heat [K]: the second where no state is
found beside the first. Narrow ones feel that the computed heat jumps by 3e-4 here and there, and
how roughly states on the way along a life are balanced."""

PartHeats = Callable[[np.ndarray], np.ndarray | None]
"""Heat of all parts (parts,) [W] at temperatures (bearing, part) [degC]; None without a state."""


def heat_of_parts(heats: Sequence[HeatFlow]) -> np.ndarray:
    """Returns the heat that goes to the parts of all bearings (parts,) [W]."""
    return np.concatenate([HEAT_TO_PARTS @ np.array(heat) for heat in heats])


def heat_slopes(heats: PartHeats, temperatures: np.ndarray) -> np.ndarray | None:
    """Returns derivatives of the heat of all parts by their temperatures (parts, parts) [W/K].

    None where states beside this one are missing for each of `DIFFERENCES`.

    temperatures: (bearing, part) [degC].
    """
    for step in DIFFERENCES:
        slopes = _central_slopes(heats, temperatures, step)
        if slopes is not None:
            return slopes
    return None


def _central_slopes(heats: PartHeats, temperatures: np.ndarray, step: float) -> np.ndarray | None:
    """Returns the change of the heat of all parts by their temperatures (parts, parts) [W/K].

    It is that by central differences; None where a state on either side is missing.

    step: of a temperature [K].
    """
    columns = []
    for k in range(temperatures.size):
        moved = np.zeros_like(temperatures)
        moved.flat[k] = step
        above, below = heats(temperatures + moved), heats(temperatures - moved)
        if above is None or below is None:
            return None
        columns.append((above - below) / (2.0 * step))
    return np.column_stack(columns)


def all_conductances(networks: Sequence[Thermal]) -> np.ndarray:
    """Returns the conductances of the parts of all bearings (parts, parts) [W/K]."""
    size = PARTS_OF_BEARING * len(networks)
    G = np.zeros((size, size))
    for k, network in enumerate(networks):
        parts = slice(PARTS_OF_BEARING * k, PARTS_OF_BEARING * (k + 1))
        G[parts, parts] = conductances(network)
    return G


def thermal_margin(networks: Sequence[Thermal], slopes: np.ndarray | None) -> float:
    """Returns conductance over slope of the heat: above 1 the state is stable, at its fold 1.

    It is the inverse of the largest real part of the eigenvalues of G^-1 dQ/dT. It is infinite
    where no heat grows with warmth, and zero where the slope is not known because a state beside
    this one is missing.

    networks: of the bearings.
    slopes: (parts, parts) [W/K], see `heat_slopes`.
    """
    if slopes is None:
        return 0.0
    gains = np.linalg.eigvals(np.linalg.solve(all_conductances(networks), slopes))
    fastest = float(gains.real.max())
    return 1.0 / fastest if fastest > 0.0 else math.inf
