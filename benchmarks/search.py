"""The search for other steady states against one from unlike starts, on random scenes.

    python benchmarks/search.py [SCENES [SEED [CONTACT]]]

The package follows the force left along the orbit over the orbit rate (theory.md section 4). Here
balls settle from unlike motions instead, in pseudo-transient steps on their equations of motion.
Both are told the same state to begin with. A state that the package misses is sought again by a
rule with many points, from its own motion and from that of the known state: where both then agree
the two were one, which few points or a tiny v_r had made two. So they are where QV agrees to what
rounding makes of the balance: friction that light leaves the motion open in the last digits.
"""

import sys
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.contact.summary import QV
from bearingwear.kernels.equilibrium.kinematics import INNER_CONTROL, OUTER_CONTROL
from bearingwear.kernels.equilibrium.thrust_loaded import cold_start
from bearingwear.kernels.steady.balance import Seat, balance_problem, motion_equilibrium
from bearingwear.kernels.steady.level_solver import pseudo_transient
from bearingwear.kernels.steady.solver import unknowns
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import SceneError
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.thrust_problem import SAME_STATE, ThrustProblem, is_new
from workflow.studies.robustness.draw import drawn_scene
from workflow.studies.robustness.plan import (
    base_scene,
    draw_blocks,
    drawn_values,
    draws,
    read_robustness,
)

CONFIG = Path(__file__).resolve().parents[1] / "config"
STARTS, SETTLED, MOST_STEPS = 4, 1e-9, 300
MANY = 4096  # points


def unlike_starts(problem, count):
    """So many unlike motions (4,), the same ones each time.

    First those of a kind of their own: spinning on the outer race, lagging behind, turning about
    the tangent, spinning on the inner race; then any.
    """
    rolling = problem.kinematic_start(OUTER_CONTROL)
    tumbling = rolling.copy()
    tumbling[1:3] = -tumbling[2], 0.0
    kinds = [rolling, 0.3 * rolling, tumbling, problem.kinematic_start(INNER_CONTROL)]
    random = np.random.default_rng(0)
    spin = np.linalg.norm(rolling[:3])
    for _ in range(count - len(kinds)):
        axis = random.normal(size=3)
        axis *= spin * random.uniform(0.2, 1.5) / np.linalg.norm(axis)
        kinds.append(np.array([*axis, rolling[3] * random.uniform(0.2, 1.2)]))
    return kinds[:count]


def settled_from_starts(problem, D, case, count=STARTS):
    """Steady states other than `case` in which balls settle from unlike starts."""
    found = [case]
    p = balance_problem(problem.bearing(D), problem.rule, problem.traction)
    for start in unlike_starts(problem, count):
        u = unknowns(p, start)  # with its tractions, where they bear on the normal forces
        seat = motion_equilibrium(p.bearing, u, Seat(delta_a=case.delta_a, state=cold_start()))
        if seat.state.status != code.OK:
            continue
        s = pseudo_transient(p, p.bearing.op.v_r, seat, u, SETTLED, MOST_STEPS)
        if s.status == code.OK and is_new(u[:4], found):
            other = problem.solve(D, start=u[:4])
            if other.status == code.OK and is_new(other.u, found):
                found.append(other)
    return found[1:]


def one_by_many_points(problem, D, first, second):
    """Whether two states are one by a rule with many points, or to rounding, or one is none."""
    across = problem.rule.across.size
    many = parameters.ellipse_rule("split", MANY, across if across == 1 else 4 * across)
    fine = replace(problem, rule=many, fine_rule=many)
    a, b = (fine.solve(D, start=case.u) for case in (first, second))
    qv = [c.contacts[:, QV].sum() for c in (a, b)]
    alike = not is_new(b.u, [a]) or abs(qv[1] / qv[0] - 1.0) < first.residuals.friction_rounding
    return a.status == code.OK and (b.status != code.OK or alike)


def compared(problem, D, case, most):
    """How both searches end: a name, and the states missed and found besides."""
    stable = problem.stable(D, case)
    started = time.thread_time()
    reference = settled_from_starts(problem, D, case)
    between = time.thread_time()
    ours = problem.other_states(D, case, stable, most)
    times = between - started, time.thread_time() - between
    missed = [c for c in reference if is_new(c.u, [case, *ours])]
    besides = [c for c in ours if is_new(c.u, [case, *reference])]
    if any(not one_by_many_points(problem, D, case, c) for c in missed):
        kind = "MISSED"
    elif missed:
        kind = "missed, but one state"
    elif besides:
        kind = "found more"
    else:
        kind = "the same, several" if reference else "the same, one"
    return kind, missed, besides, times


def main():
    given = sys.argv[1:]
    count, seed = (int(text) for text in (given + ["3000", "7"][len(given) :])[:2])
    contact = given[2] if len(given) > 2 else "paper"
    file = CONFIG / "robustness.yaml"
    plan = read_robustness(file)
    base = load_scene(base_scene(plan, file), [f"model.contact={contact}"]).to_dict()
    for name in ("steady", "steady_stress"):
        ends, spent = Counter(), np.zeros(2)
        draw = draws(draw_blocks(plan, name))
        for k, values in enumerate(drawn_values(draw, seed, count)):
            try:
                scene = drawn_scene(base, values)
            except SceneError:
                continue
            problem, D = ThrustProblem.of(scene), float(parameters.ball_diameters(scene)[0])
            case = problem.solve(D) if problem.undetermined() == code.OK else None
            if case is None or case.status != code.OK:
                continue
            kind, missed, besides, times = compared(problem, D, case, scene.model.steady_starts)
            ends[kind] += 1
            spent += times
            if missed or besides:
                scale = np.abs(case.u).max()
                far = [f"{np.abs(c.u - case.u).max() / scale:.2g}" for c in (*missed, *besides)]
                print(f"  {name} {seed}-{k}: {kind}; as far as {', '.join(far)}", flush=True)
        each = 1e3 * spent / max(sum(ends.values()), 1)
        print(f"{name}: {dict(ends)}; a search takes {each[1]:.2f} ms, from starts {each[0]:.2f}")
        print(f"  (states apart by less than {SAME_STATE:g} of the speeds count as one)")


if __name__ == "__main__":
    main()
