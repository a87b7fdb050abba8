"""Result variables and warnings of a life over a duty: the wear and the demands of each phase."""

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
from bearingwear.measures import WORST, Measure
from bearingwear.scene.duty import Duty
from bearingwear.solvers.effects.warnings import LARGEST_EXCESS
from bearingwear.solvers.state import State

LARGEST_ACCELERATION = 0.1  # share of the friction that may accelerate the balls, else a warning
LARGEST_CYCLE = 0.1  # time of a cycle over a step of the integration, else a warning


def duty_values(duty: Duty, over_duty: DutyLife, alone: Mapping[str, Life]) -> dict[str, Any]:
    """Returns the result variables that only a life over a duty has.

    over_duty: a life longer than 0.
    alone: life of each case alone, by its name.
    """
    cycle, life = over_duty.cycle, over_duty.life
    phases = [duty.phases[name] for name in cycle.phases]
    time_shares = np.array([duty.phase_s(phase) for phase in phases]) / duty.cycle_s
    values: dict[str, Any] = {
        "life_cycles": life.last.time / duty.cycle_s,
        "ending_phase": cycle.case_of_phase.index(over_duty.ending_case_index),
        "phase_time_share": time_shares,
    }
    for name, by_case in worst_by_case(over_duty).items():
        values[name] = by_case[..., list(cycle.case_of_phase)]
    phase_lives = [alone[cycle.cases[case]] for case in cycle.case_of_phase]
    lengths = np.array(
        [other.last.time if other.status == code.OK else math.nan for other in phase_lives]
    )
    running_shares = np.array([duty.running_s(phase) for phase in phases]) / duty.cycle_s
    linear_life = palmgren_miner_life(running_shares, lengths)
    values |= {
        "phase_life": lengths,
        "phase_end_criterion": [other.criterion for other in phase_lives],
        "palmgren_miner_life": linear_life,
        "palmgren_miner_error": linear_life / life.last.time - 1.0,
    }
    values_by_bearing = [
        wear_shares(cycle, worn_volumes(over_duty, k)) | acceleration_values(duty, over_duty, k)
        for k in range(cycle.bearings)
    ]
    return values | joined(values_by_bearing)


def palmgren_miner_life(shares: np.ndarray, lives: np.ndarray) -> float:
    """Returns the life by the linear rule of Palmgren and Miner, in the unit of the lives.

    The inverse life is the sum of the share of each phase over its life. The life is NaN where that
    of a phase with a share is not known, and where that sum is 0.

    shares, lives: share of the time of each phase, and life in it alone (phases,).
    """
    has_share = shares > 0.0
    damage = float((shares[has_share] / lives[has_share]).sum())
    return 1.0 / damage if damage else math.nan


def worst_by_case(over_duty: DutyLife) -> dict[str, np.ndarray]:
    """Returns result variables: the worst of each measure (cases,), and preloads (nodes, cases).

    The worst is that along the life, of the worse bearing. A measure is left out unless all cases
    know it.
    """
    states_of_cases = [
        worse_states(life, scene)
        for life, scene in zip(over_duty.by_case.values(), over_duty.cycle.case_scenes, strict=True)
    ]
    values = {}
    for name, measure in WORST.items():
        extremes_by_case = [
            [measure.extreme(state[name]) for state in states if name in state.values]
            for states in states_of_cases
        ]
        if all(extremes_by_case):
            worst = [
                _worst_along_life(measure, case_extremes) for case_extremes in extremes_by_case
            ]
            values[f"worst_{name}"] = np.array(worst)
    preloads = [[state["residual_preload"] for state in states] for states in states_of_cases]
    values["history_phase_residual_preload"] = np.array(preloads).T
    return values


def _worst_along_life(measure: Measure, extremes: Sequence[float]) -> float:
    """Returns the worst extreme of a life; NaN if that at its start or at its end is NaN.

    NaN between the ends, where the measure was not computed, is left out.

    extremes: of the nodes of the life.
    """
    between = [extreme for extreme in extremes[1:-1] if not math.isnan(extreme)]
    return measure.extreme(np.array([extremes[0], *between, extremes[-1]]))


def worn_volumes(over_duty: DutyLife, k: int) -> np.ndarray:
    """Returns the volumes worn off bearing k (nodes, conditions, surfaces) [m3].

    They are worn off inner race, outer race and all balls from the start of the life to each node,
    as if each condition took all the time.
    """
    cycle, life = over_duty.cycle, over_duty.life
    balls = cycle.scenes[0].symmetric_half.sides[k].bearing.ball_count
    rates = [
        [
            [*state["race_wear_rate"], balls * state["ball_wear_rate"]]
            for state in node.states[k :: cycle.bearings]
        ]
        for node in life.nodes
    ]
    return _integrals(life.times, np.array(rates))


def _integrals(times: np.ndarray, rates: np.ndarray) -> np.ndarray:
    """Returns the integrals of rates over times up to each node, of the shape of the rates.

    They are those of monotone cubics. Two nodes have the same time where a film is worn through,
    and a new cubic starts there.

    times: of the nodes (nodes,) [s].
    rates: at the nodes, per second (nodes, ...).
    """
    from scipy.interpolate import PchipInterpolator  # loads slowly; few lives are over a duty

    total = np.zeros_like(rates)
    starts = [0, *(np.flatnonzero(np.diff(times) <= 0.0) + 1).tolist()]
    for start, end in zip(starts, [*starts[1:], times.size], strict=True):
        part = slice(start, end)
        total[part] = total[start - 1] if start else 0.0
        if end - start > 1:
            total[part] += PchipInterpolator(times[part], rates[part]).antiderivative()(times[part])
    return total


def wear_shares(cycle: Cycle, worn: np.ndarray) -> dict[str, np.ndarray]:
    """Returns result variables of the shares of the wear [1].

    `phase_wear_share` is the share of each phase in the wear of inner race, outer race, balls and
    all these together (phases, 4). `start_wear_share` is the part of it in starts and stops. The
    history has the wear of each phase up to each node over all wear at the end (nodes, phases). A
    surface that does not wear has NaN.

    worn: volumes by `worn_volumes` (nodes, conditions, surfaces) [m3].
    """
    surfaces = np.concatenate([worn, worn.sum(axis=-1, keepdims=True)], axis=-1)
    total = np.einsum("c,cs->s", cycle.shares, surfaces[-1])
    total = np.where(total > 0.0, total, math.nan)
    by_phase = cycle.running + cycle.starting
    histories = np.einsum("pc,nc->np", by_phase, surfaces[..., -1])
    return {
        "phase_wear_share": by_phase @ surfaces[-1] / total,
        "start_wear_share": cycle.starting @ surfaces[-1] / total,
        "history_phase_worn_share": histories / total[-1],
    }


def acceleration_values(duty: Duty, over_duty: DutyLife, k: int) -> dict[str, np.ndarray]:
    """Returns the result variable of the friction that accelerates the balls of bearing k [1].

    It is the share of the available friction in each phase (phases,): the larger one of start and
    end of the life, in the shorter ramp. It is 0 in a phase without starts. The dictionary is empty
    where a share is not known, or without any friction.
    """
    cycle = over_duty.cycle
    ramps = [seconds for seconds in (duty.start_s, duty.stop_s) if seconds > 0.0]
    ends_of_life = over_duty.life.nodes[0], over_duty.life.last
    shares = []
    for name, case in zip(cycle.phases, cycle.case_of_phase, strict=True):
        if not (ramps and duty.phases[name].starts):
            shares.append(0.0)
            continue
        states = [node.states[case * cycle.bearings + k] for node in ends_of_life]
        shares.append(max(acceleration_share(state, min(ramps)) for state in states))
    if not np.isfinite(shares).all():
        return {}
    return {"acceleration_friction_share": np.array(shares)}


def acceleration_share(state: State, ramp_s: float) -> float:
    """Returns the share of the friction available to a ball that brings it to speed in a time [1].

    The force accelerates the spin and the orbit, evenly over the time. NaN where the model has no
    balance of friction; infinite where no friction is available.

    ramp_s: time from rest to the full speed [s].
    """
    solution = state.answer
    if solution is None or not hasattr(solution.answer, "u"):
        return math.nan
    motion = solution.answer.u  # (three components of the spin, orbit, ...) [rad/s]
    g = solution.problem.g
    D = g.D0 - state.loss
    m = ball_mass(g.rho, D)
    mu, Q = (np.broadcast_to(state[name], 2) for name in ("friction_coefficient", "contact_load"))
    spin, orbit = float(np.linalg.norm(motion[:3])), abs(float(motion[3]))
    force = (ball_inertia(m, D) * spin / (0.5 * D) + m * 0.5 * g.dm * orbit) / ramp_s
    mu_i, mu_o = mu.tolist()
    Q_i, Q_o = Q.tolist()
    available = friction_capacity(mu_i, mu_o, Q_i, Q_o)
    return force / available if available > 0.0 else math.inf


def duty_warnings(
    duty: Duty, over_duty: DutyLife, values: Mapping[str, Any]
) -> list[dict[str, Any]]:
    """Returns up to two warnings: of balls that take much friction to accelerate, of long cycles.

    They have the form of `warnings_of`.

    values: result variables of the life.
    """
    life = over_duty.life
    warnings = []
    share = float(np.max(values.get("acceleration_friction_share", 0.0)))
    if share > LARGEST_ACCELERATION:
        shortest_ramp = min(seconds for seconds in (duty.start_s, duty.stop_s) if seconds)
        warnings.append(
            _warning(
                "duty_acceleration",
                f"accelerating the balls in {shortest_ramp:.3g} s "
                f"takes {100.0 * share:.3g} % of the available friction, so the wear of starts and "
                "stops, computed as steady at each speed, is a lower bound",
                "use longer start_s and stop_s",
                share / LARGEST_ACCELERATION,
            )
        )
    nodes = 1 if over_duty.is_worn else len(QUARTERS) + 1  # of a step
    step = nodes * float(np.median(np.diff(life.times))) if len(life.nodes) > 1 else math.inf
    excess = duty.cycle_s / (LARGEST_CYCLE * step)
    if excess > 1.0:
        cycles = life.last.time / duty.cycle_s
        warnings.append(
            _warning(
                "duty_cycle",
                f"the life has only {cycles:.3g} cycles of the duty, so it is known to about one "
                "cycle, and the order of the phases counts",
                "divide the hours and starts of all phases by the same number if they alternate "
                "more often",
                excess,
            )
        )
    return warnings


def _warning(id: str, sentence: str, advice: str, excess: float) -> dict[str, Any]:
    """Returns a warning in the form of `warnings_of`.

    excess: its value over the limit, of which three digits are kept.
    """
    excess = float(f"{min(excess, LARGEST_EXCESS):.3g}")
    return {
        "id": id,
        "sentence": sentence,
        "advice": advice,
        "impractical": False,
        "excess": excess,
    }


def warnings_over_cases(
    warnings_by_case: Mapping[str, Sequence[dict[str, Any]]],
) -> list[dict[str, Any]]:
    """Returns the warnings of the cases of a duty, each once and at its worst.

    A sentence begins with the case of the warning unless all cases say the same. A warning is at
    its worst where its excess is largest; one without an excess counts as 0.
    """
    by_id: dict[str, list[tuple[str, dict[str, Any]]]] = {}
    for case, warnings in warnings_by_case.items():
        for warning in warnings:
            by_id.setdefault(warning["id"], []).append((case, warning))
    merged = []
    for warnings_of_id in by_id.values():
        case, worst = max(warnings_of_id, key=lambda pair: pair[1]["excess"] or 0.0)
        is_in_all = all(
            any(warning["sentence"] == worst["sentence"] for warning in warnings)
            for warnings in warnings_by_case.values()
        )
        merged.append(worst if is_in_all else worst | {"sentence": f"{case}: {worst['sentence']}"})
    return merged
