"""Time the solvers in one run against the plain NumPy/SciPy program.

    python benchmarks/speed.py

Both programs solve the same cases of gyro_s1 on one core, warm, and the answers are compared. Each
figure is the median of several repeats; the machine's load moves both columns alike, so the ratio
is the number to quote. Times are measurements, not requirements of any test.
"""

import statistics
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import plain_scipy as plain

import bearingwear
from bearingwear.kernels.contact.summary import QV
from bearingwear.kernels.equilibrium.kinematics import INNER_CONTROL
from bearingwear.lives.life import life
from bearingwear.scene.read import load_scene
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.race_control import RaceControlProblem, controlled_balance
from bearingwear.solvers.solve import solve

SCENE = Path(__file__).resolve().parents[1] / "config" / "scenes" / "gyro_s1.yaml"


def median_time(function, repeats):
    """Median duration [s] of a call, and its last answer."""
    function()
    times = []
    for _ in range(repeats):
        started = time.perf_counter()
        answer = function()
        times.append(time.perf_counter() - started)
    return statistics.median(times), answer


def row(name, ours, theirs=None, agreement=""):
    ratio = f"{theirs / ours:8.0f} x" if theirs else " " * 10
    other = f"{theirs * 1e3:10.2f}" if theirs else " " * 10
    print(f"{name:44s} {ours * 1e3:10.3f} {other} {ratio}  {agreement}")


def main():
    print(f"{'':44s} {'ours ms':>10s} {'plain ms':>10s} {'ratio':>10s}  largest difference")
    for method, mu, loss in (
        ("constant_force", 0.08, 0.0),
        ("fixed_position", 0.08, 0.5),
        ("fixed_position", 0.02, 0.5),
    ):
        scene = load_scene(
            SCENE, [f"operation.preload_method={method}", f"friction.ball_race={mu}"]
        )
        problem = ThrustProblem.of(scene)
        D = problem.g.D0 - loss * 1e-6
        operation = plain.Operation(7.0, (problem.op.omega_i, 0.0), mu, method, loss * 1e-6)
        ours, case = median_time(lambda p=problem, D=D: p.solve(D), 200)
        theirs, ref = median_time(lambda o=operation: plain.steady_state(plain.S1, o), 10)
        agree = abs(case.contacts[:, QV] / ref["traction"].qv - 1.0).max()
        row(f"steady, {method}, mu {mu}, loss {loss} um", ours, theirs, f"QV {agree:.0e}")
        near = problem.solve(D + 0.01e-6).u
        ours, _ = median_time(lambda p=problem, D=D, near=near: p.solve(D, near), 200)
        row("   the same, from a state 0.01 um away", ours, theirs)
    scene = load_scene(SCENE)
    problem = RaceControlProblem.of(scene)
    operation = plain.Operation(7.0, (problem.op.omega_i, 0.0))
    ours, (balance, laws) = median_time(lambda: controlled_balance(problem), 500)
    theirs, ref = median_time(lambda: plain.race_control(plain.S1, operation), 20)
    assert laws[0] == INNER_CONTROL
    agree = abs(balance.states[0].Q_i / ref["contacts"].load[0] - 1.0)
    row("race control, thrust, control found", ours, theirs, f"Q_i {agree:.0e}")
    loaded = RaceControlProblem.of(load_scene(SCENE, ["operation.radial_load_N=[0.0, 2.0]"]))
    ours, _ = median_time(lambda: controlled_balance(loaded), 50)
    row("race control, nine balls, radial load 2 N", ours)
    worn = load_scene(SCENE, ["operation.preload_method=fixed_position"])
    ours, _ = median_time(lambda: life(worn), 30)
    row("wear life, solver in the loop", ours)
    for name in ("constant_force", "fixed_position"):
        scene = load_scene(SCENE, [f"operation.preload_method={name}"])
        problem = ThrustProblem.of(scene)
        operation = plain.Operation(7.0, (problem.op.omega_i, 0.0), 0.08, name)
        theirs, _ = median_time(lambda o=operation: plain.steady_state(plain.S1, o), 10)
        for contact in ("paper", "hertz"):  # the plain program has the paper's alone
            there = scene.with_({"model.contact": contact})
            wall = [solve(there).wall_time_s for _ in range(300)]
            least = f"least {min(wall) * 1e3:.3f} ms"
            row(f"all of a steady solve, {contact}, {name}", statistics.median(wall), theirs, least)
            ours, _ = median_time(lambda s=there: bearingwear.solve(s), 100)
            row("   the same in Python, to a Dataset", ours)
    ours, _ = median_time(lambda: bearingwear.solve(SCENE), 100)
    row("   and from a scene file", ours)


if __name__ == "__main__":
    main()
