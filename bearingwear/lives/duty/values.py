"""Result variables of a life over a duty: what each phase adds to the wear, and asks of it."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.ball import ball_inertia, ball_mass
from bearingwear.kernels.contact.friction import friction_capacity
from bearingwear.lives.duty.cycle import Cycle
from bearingwear.lives.duty.lives import DutyLife
from bearingwear.lives.follow import Life
from bearingwear.lives.history import joined
from bearingwear.lives.many import worse_states
from bearingwear.lives.methods import QUARTERS
from bearingwear.measures import WORST
from bearingwear.scene.duty import Duty
from bearingwear.solvers.state import State

LARGEST_ACCELERATION = 0.1  # share of the friction that accelerates the balls
LARGEST_CYCLE = 0.1  # of a step of the integration


def duty_values(duty: Duty, found: DutyLife, alone: Mapping[str, Life]) -> dict[str, Any]:
    """Result variables of a life over a duty, and of its phases alone by their cases."""
    cycle, life = found.cycle, found.life
    phases = [duty.phases[name] for name in cycle.phases]
    shares = np.array([duty.phase_s(phase) for phase in phases]) / duty.cycle_s
    values: dict[str, Any] = {
        "life_cycles": life.last.time / duty.cycle_s,
        "ending_phase": cycle.case_of_phase.index(found.ending_case),
        "phase_time_share": shares,
    }
    values |= _of_phases(worst_of_phases(found), cycle)
    each = [life_alone(alone[cycle.cases[case]]) for case in cycle.case_of_phase]
    lives = np.array([length for length, _ in each])
    running = np.array([duty.running_s(phase) for phase in phases]) / duty.cycle_s
    values |= {
        "phase_life": lives,
        "phase_end_criterion": [criterion for _, criterion in each],
        "palmgren_miner_life": palmgren_miner_life(running, lives),
    }
    values["palmgren_miner_error"] = values["palmgren_miner_life"] / life.last.time - 1.0
    own = []
    for k in range(cycle.bearings):
        worn = worn_volumes(found, k)
        own.append(wear_shares(cycle, worn) | acceleration_values(duty, found, k))
    return values | joined(own)


def palmgren_miner_life(shares: np.ndarray, lives: np.ndarray) -> float:
    """Life by the linear rule of Palmgren and Miner, 1/L = sum of share over life of each phase.

    In the unit of the lives; NaN where one of those that have a share is not known.
    """
    some = shares > 0.0
    damage = float((shares[some] / lives[some]).sum())
    return 1.0 / damage if damage else math.nan


def life_alone(life: Life) -> tuple[float, int]:
    """Life [s] and criterion of a phase alone; NaN where no criterion was met."""
    return (life.last.time if life.status == code.OK else math.nan), life.criterion


def worst_of_phases(found: DutyLife) -> dict[str, np.ndarray]:
    """The worst of each measure in each case, from new to the end of life, and preloads over it."""
    cycle = found.cycle
    each = [
        worse_states(life, scene)
        for life, scene in zip(found.by_case.values(), cycle.scenes, strict=False)
    ]
    values = {}
    for name, measure in WORST.items():
        worst = [[measure.extreme(s[name]) for s in states if name in s.values] for states in each]
        if all(worst):
            # what is not known between is what is known
            values[f"worst_{name}"] = np.array(
                [
                    measure.extreme(np.array([one[0], *(v for v in one[1:-1] if v == v), one[-1]]))
                    for one in worst
                ]
            )
    preloads = [[state["residual_preload"] for state in states] for states in each]
    values["history_phase_residual_preload"] = np.array(preloads).T
    return values


def _of_phases(values: Mapping[str, np.ndarray], cycle: Cycle) -> dict[str, np.ndarray]:
    """Values (..., cases) as phases have them (..., phases)."""
    return {name: value[..., list(cycle.case_of_phase)] for name, value in values.items()}


def worn_volumes(found: DutyLife, k: int) -> np.ndarray:
    """Worn off races and balls of bearing k by a full share of each condition [m3].

    (nodes, conditions, surfaces): from the start of the life to each of its nodes.
    """
    cycle, nodes = found.cycle, found.life.nodes
    states = [node.states[k :: cycle.bearings] for node in nodes]
    rates = np.array([[_volume_rates(found, k, state) for state in one] for one in states])
    return _integrals(found.life.times, rates)


def _volume_rates(found: DutyLife, k: int, state: State) -> np.ndarray:
    """Wear of inner and outer race and of all balls (3,) [m3/s]."""
    balls = found.cycle.scenes[0].one_of_alike.sides[k].bearing.ball_count
    return np.array([*state["race_wear_rate"], balls * state["ball_wear_rate"]])


def _integrals(times: np.ndarray, rates: np.ndarray) -> np.ndarray:
    """Integrals of rates (nodes, ...) up to each node, by monotone cubics between them.

    Where a film is worn through, two nodes have one time.
    """
    from scipy.interpolate import PchipInterpolator  # loads slowly; few lives are over a duty

    total = np.zeros_like(rates)
    begun = [0, *(np.flatnonzero(np.diff(times) <= 0.0) + 1).tolist()]
    for first, end in zip(begun, [*begun[1:], times.size], strict=True):
        part = slice(first, end)
        before = total[first - 1] if first else 0.0
        total[part] = before
        if end - first > 1:
            total[part] += PchipInterpolator(times[part], rates[part]).antiderivative()(times[part])
    return total


def wear_shares(cycle: Cycle, worn: np.ndarray) -> dict[str, np.ndarray]:
    """Shares of the wear by phase and surface, of its starts and stops alone, and over time."""
    surfaces = np.concatenate([worn, worn.sum(axis=-1, keepdims=True)], axis=-1)
    whole = np.einsum("c,cs->s", cycle.shares, surfaces[-1])
    whole = np.where(whole > 0.0, whole, math.nan)
    both = cycle.running + cycle.starting
    return {
        "phase_wear_share": both @ surfaces[-1] / whole,
        "start_wear_share": cycle.starting @ surfaces[-1] / whole,
        "history_phase_worn_share": np.einsum("pc,nc->np", both, surfaces[..., -1]) / whole[-1],
    }


def acceleration_values(duty: Duty, found: DutyLife, k: int) -> dict[str, np.ndarray]:
    """Share of the friction of bearing k that accelerates its balls, in each phase that starts."""
    cycle, ramps = found.cycle, [t for t in (duty.start_s, duty.stop_s) if t > 0.0]
    states = found.life.nodes[0].states, found.life.last.states
    shares = []
    for name, case in zip(cycle.phases, cycle.case_of_phase, strict=True):
        if not (ramps and duty.phases[name].starts):
            shares.append(0.0)
            continue
        of_case = [one[case * cycle.bearings + k] for one in states]
        shares.append(max(acceleration_share(state, min(ramps)) for state in of_case))
    return {"acceleration_friction_share": np.array(shares)} if np.isfinite(shares).all() else {}


def acceleration_share(state: State, ramp_s: float) -> float:
    """Share of the friction on a ball that brings its spin and orbit to speed in a time [s].

    NaN where the model has no balance of friction.
    """
    solution = state.answer
    if solution is None or not hasattr(solution.answer, "u"):
        return math.nan
    motion = solution.answer.u
    g = solution.problem.g
    D = g.D0 - state.loss
    m = ball_mass(g.rho, D)
    mu, Q = (np.broadcast_to(state[name], 2) for name in ("friction_coefficient", "contact_load"))
    spin, orbit = float(np.linalg.norm(motion[:3])), abs(float(motion[3]))
    force = (ball_inertia(m, D) * spin / (0.5 * D) + m * 0.5 * g.dm * orbit) / ramp_s
    available = friction_capacity(*mu.tolist(), *Q.tolist())
    return force / available if available > 0.0 else math.inf


def duty_warnings(
    duty: Duty, over_duty: DutyLife, values: Mapping[str, Any]
) -> list[dict[str, Any]]:
    """Warnings that a duty alone has: balls accelerated by too much friction, and long cycles."""
    life, found = over_duty.life, []
    share = float(np.max(values.get("acceleration_friction_share", 0.0)))
    if share > LARGEST_ACCELERATION:
        found.append(
            _warning(
                "duty_acceleration",
                f"accelerating the balls in {min(filter(None, (duty.start_s, duty.stop_s))):.3g} s "
                f"takes {100.0 * share:.3g} % of the available friction, so the wear of starts and "
                "stops, computed as steady at each speed, is a lower bound",
                "use longer start_s and stop_s",
                share / LARGEST_ACCELERATION,
            )
        )
    nodes = 1 if over_duty.is_worn else len(QUARTERS) + 1  # of a step
    step = nodes * float(np.median(np.diff(life.times))) if len(life.nodes) > 1 else math.inf
    if (excess := duty.cycle_s / (LARGEST_CYCLE * step)) > 1.0:
        cycles = life.last.time / duty.cycle_s
        found.append(
            _warning(
                "duty_cycle",
                f"the life has only {cycles:.3g} cycles of the duty, so it is known to about one "
                "cycle, and the order of the phases counts",
                "divide the hours and starts of all phases by the same number if they alternate "
                "more often",
                excess,
            )
        )
    return found


def _warning(id: str, sentence: str, advice: str, excess: float) -> dict[str, Any]:
    excess = float(f"{min(excess, 1e6):.3g}")
    return {
        "id": id,
        "sentence": sentence,
        "advice": advice,
        "impractical": False,
        "excess": excess,
    }


def in_phases(each: Mapping[str, Sequence[dict[str, Any]]]) -> list[dict[str, Any]]:
    """Warnings of the cases of a duty, each once and at its worst, with the case that it is of."""
    worst: dict[str, dict[str, Any]] = {}
    for case, warnings in each.items():
        for one in warnings:
            known = worst.get(one["id"])
            if known is None or (one["excess"] or 0.0) > (known["excess"] or 0.0):
                worst[one["id"]] = one | {"case": case}
    found = []
    for one in worst.values():
        case = one.pop("case")
        alike = all(
            any(other["sentence"] == one["sentence"] for other in warnings)
            for warnings in each.values()
        )
        found.append(one if alike else one | {"sentence": f"{case}: {one['sentence']}"})
    return found
