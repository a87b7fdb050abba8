"""Which rule integrates friction over the contact ellipse best for its time.

    python benchmarks/rules.py

Two tables, errors as median and worst over scenes and v_r = 1e-3 to 1e-6 m/s:

(a) the integrals alone, against 4 x 60 points gathered by a sinh map (within 1e-9 of SciPy's
    adaptive quadrature where the two were compared), for contacts in their steady state and for
    the same contacts in pure rolling without gyroscopic slip, where friction turns round within
    v_r. Time is that of placing the points and of one sum of forces and QV in the steady state,
    one core, warm.
(b) the steady state solved anew with the rule, against 2 x 2000 Gauss points.
"""

import math
import time
from dataclasses import replace
from pathlib import Path

import numba
import numpy as np
from scipy.special import roots_jacobi

from bearingwear.kernels.contact.points import (
    FAR,
    Rule,
    most_points,
    quadrature_points,
    rolling_points,
)
from bearingwear.kernels.contact.slip import race_contacts, slip_coefficients, surface_height
from bearingwear.kernels.contact.summary import QV
from bearingwear.kernels.contact.traction import quick_strip_sums
from bearingwear.kernels.equilibrium.kinematics import OUTER_CONTROL
from bearingwear.kernels.equilibrium.thrust_loaded import cold_start
from bearingwear.kernels.status import OK
from bearingwear.kernels.steady.balance import Seat, orbit_equilibrium
from bearingwear.scene.read import load_scene
from bearingwear.solvers.bearing.parameters import ellipse_rule
from bearingwear.solvers.bearing.quadrature import gathered_points, gauss_legendre
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem

SCENES = Path(__file__).resolve().parents[1] / "config" / "scenes"
REGULARISATIONS = (1e-3, 1e-4, 1e-5, 1e-6)
REPEATS = 20_000


def scene(name, method, mu, loss, v_r):
    s = replace(load_scene(SCENES / f"{name}.yaml"), cage=None)
    return replace(
        s,
        operation=replace(s.operation, preload_method=method),
        friction=replace(s.friction, ball_race=mu, slip_regularisation_m_s=v_r),
        wear=replace(s.wear, ball_diameter_loss_um=(loss,)),
    )


def scenes(v_r):
    for method in ("constant_force", "fixed_position"):
        for mu in (0.02, 0.05, 0.08, 0.11):
            for loss in (0.0, 0.5, 0.7):
                yield scene("gyro_s1", method, mu, loss, v_r)
        for name in ("gyro_s2", "gyro_s3", "gyro_s1_drag"):
            for mu in (0.02, 0.08):
                yield scene(name, method, mu, 0.5, v_r)
    for mu in (0.03, 0.07):  # the 218 bearing of Jones and Harris
        s = scene("gyro_s1", "constant_force", mu, 0.0, v_r)
        large = replace(
            s.bearing, ball_count=16, ball_diameter_mm=22.225, pitch_diameter_mm=125.26,
            contact_angle_deg=40.0, inner_groove_factor=0.5232, outer_groove_factor=0.5232,
        )  # fmt: skip
        heavy = replace(s.operation, shaft_speed_rpm=10_000, preload_N=17_800.0)
        yield replace(s, bearing=large, operation=heavy)


# The rules


def density(t, w):
    return Rule(False, t, 0.75 * (1.0 - t * t) * w, np.ones(t.size))


def jacobi(n):
    t, w = roots_jacobi(n, 1, 1)
    return Rule(False, t, 0.75 * w, np.ones(t.size))


def clenshaw_curtis(n):
    angle = np.pi * np.arange(n) / (n - 1)
    k = np.arange(0, n, 2)
    moments = 2.0 / (1.0 - k**2)
    moments[0] *= 0.5
    if (n - 1) % 2 == 0:
        moments[-1] *= 0.5
    w = 2.0 / (n - 1) * np.cos(np.outer(angle, k)) @ moments
    w[[0, -1]] *= 0.5
    return density(np.cos(angle), w)


def composite(n, panels=4):
    x, w = gauss_legendre(n // panels)
    middles = (2.0 * np.arange(panels) + 1.0) / panels - 1.0
    return density((middles[:, None] + x / panels).ravel(), np.tile(w / panels, panels))


def split_power(m, power):
    x, w = gauss_legendre(m)
    z = 0.5 * (x + 1.0)
    return Rule(True, z**power, 0.5 * w * power * z ** (power - 1), np.ones(m))


@numba.njit(error_model="numpy")
def place_sinh(rule, contact, R, c, v_r, t, weight):
    """Sinh-transformed Gauss: as `place`, but the points gather as closely as the contact asks."""
    a = contact.a
    R_d = 2.0 * contact.r_g * R / (contact.r_g + R)
    e = math.hypot(c[0] * R, v_r)
    low, high = rolling_points(contact, R, c, v_r)
    low, high = min(low, high), max(low, high)
    if abs(low) > FAR:
        low = high
    if abs(high) > FAR:
        high = low
    if abs(low) > FAR:
        low = high = 0.0
    low, high = min(max(low, -1.0), 1.0), min(max(high, -1.0), 1.0)
    n = 0
    for i in range(4):
        start = low if i < 2 else high
        end = (-1.0, 0.5 * (low + high), 0.5 * (low + high), 1.0)[i]
        length = end - start
        if length == 0.0:
            continue
        slope = abs(c[3] * a - c[2] * a * a * start / R_d) + e
        rest = c[1] + c[2] * (R - 0.5 * (a * start) ** 2 / R_d) + c[3] * a * start
        top = math.asinh(abs(length) * slope / math.hypot(e, rest))
        scale = math.sinh(top)
        for k in range(rule.t.size):
            y = top * rule.t[k]
            x = start + length * math.sinh(y) / scale
            t[n] = x
            slice_ = abs(length) * top * math.cosh(y) / scale * rule.weight[k]
            weight[n] = 0.75 * (1.0 - x * x) * slice_
            n += 1
    return t[:n], weight[:n]


def rules():
    """(name, placing of the points, rule) of all candidates; the number is points, of split rules
    a side."""
    for n in (4, 10, 20, 50, 100, 200, 400):
        yield f"equal strips {n}", quadrature_points, ellipse_rule("strips", n)
    for n in (20, 50, 100, 200):
        yield f"Gauss {n}", quadrature_points, density(*gauss_legendre(n))
        yield f"Gauss-Jacobi {n}", quadrature_points, jacobi(n)
        yield f"Clenshaw-Curtis {n + 1}", quadrature_points, clenshaw_curtis(n + 1)
        yield f"Gauss, 4 panels {n}", quadrature_points, composite(n)
    for n in (20, 30, 50, 100, 200, 400):
        yield f"Gauss, halves {n}", quadrature_points, ellipse_rule("gauss", n)
    for m in (4, 6, 8, 10, 12):
        yield f"split, plain {m}", quadrature_points, split_power(m, 1)
        yield f"split, square {m}", quadrature_points, split_power(m, 2)
        yield f"split, sinh {m}", place_sinh, split_power(m, 1)
        yield f"split {m}", quadrature_points, Rule(True, *gathered_points(m), np.ones(m))


# The cases


def contacts(problem, D, case):
    """(contact, R, slip in the steady state, slip in pure rolling) of both races."""
    m = problem.op
    Omega, delta_a = case.u[3], case.delta_a
    seat = Seat(delta_a=delta_a, state=cold_start())
    _, state = orbit_equilibrium(problem.balance(D).bearing, Omega, seat)
    rolling = problem.kinematic_start(OUTER_CONTROL)
    for contact in race_contacts(problem.g, m, state):
        yield tuple(
            (contact, 0.5 * D, slip_coefficients(contact, u, case.r), contact.mu, m.v_r)
            for u in (case.u, rolling)
        )


def integrals(how, rule, contact, R, c, mu, v_r):
    """Mean slip, both friction forces and the moment of the second, and the number of points."""
    t, w = np.empty(most_points(rule)), np.empty(most_points(rule))
    t, w = how(rule, contact, R, c, v_r, t, w)
    h = np.empty(t.size)
    surface_height(contact, R, t, h)
    g_1, g_0, _, g_x, qv = quick_strip_sums(contact, c, mu, v_r, t, w, h)
    forces = np.array([g_1 / R, g_0, g_x / contact.a]) / (mu * contact.Q)
    return np.array([qv / contact.Q, *forces]), len(t)


@numba.njit(error_model="numpy")
def repeat(how, rule, contact, R, c, mu, v_r, t, weight, h, n):
    total = 0.0
    for i in range(n):
        slip = (c[0], c[1] * (1.0 + 1e-12 * i), c[2], c[3])
        points, shares = how(rule, contact, R, slip, v_r, t, weight)
        surface_height(contact, R, points, h)
        total += quick_strip_sums(contact, slip, mu, v_r, points, shares, h)[4]
    return total


def nanoseconds(how, rule, cases):
    buffers = np.empty((3, most_points(rule)))
    times = []
    for case in cases:
        repeat(how, rule, *case, *buffers, 1)
        best = math.inf
        for _ in range(3):
            start = time.perf_counter()
            repeat(how, rule, *case, *buffers, REPEATS)
            best = min(best, time.perf_counter() - start)
        times.append(best / REPEATS * 1e9)
    return np.mean(times)


def spread(errors):
    return f"{np.median(errors):8.1e}{np.max(errors):8.1e}"


def solved_cases():
    """Scene, ball diameter and case of every steady state."""
    cases = []
    for v_r in REGULARISATIONS:
        for s in scenes(v_r):
            problem = replace(ThrustProblem.of(s), rule=ellipse_rule("gauss", 4000))
            D = problem.g.D0 - 1e-6 * s.wear.ball_diameter_loss_um[0]
            case = problem.solve(D)
            assert case.status == OK, s.name
            cases.append((problem, D, case))
    return cases


def main():
    cases = solved_cases()
    pairs = [pair for case in cases for pair in contacts(*case)]
    fine = split_power(60, 1)
    exact = [[integrals(place_sinh, fine, *c)[0] for c in pair] for pair in pairs]
    print(f"(a) the integrals of {len(pairs)} contacts")
    print(
        f"{'':22s}{'points':>7s}{'ns':>6s}{'steady: QV':>16s}{'forces':>16s}"
        f"{'rolling: QV':>16s}{'forces':>16s}"
    )
    for name, how, rule in rules():
        qv, forces, points = ([], []), ([], []), []
        for pair, right in zip(pairs, exact, strict=True):
            for k in range(2):
                found, n = integrals(how, rule, *pair[k])
                off = np.abs(found - right[k])
                qv[k].append(off[0] / right[k][0])
                forces[k].append(off[1:].max())
                points += [n] if k == 0 else []
        ns = nanoseconds(how, rule, [pair[0] for pair in pairs[::29]])
        print(
            f"{name:22s}{np.mean(points):7.1f}{ns:6.0f}"
            + "".join(spread(qv[k]) + spread(forces[k]) for k in range(2)),
            flush=True,
        )
    print(f"\n(b) {len(cases)} steady states; w_y is the tangential speed of the ball")
    print(
        f"{'':22s}{'solved':>7s}{'ms':>6s}{'Newton':>8s}{'total QV':>16s}"
        f"{'QV of a contact':>16s}{'w_y':>16s}"
    )
    for name, how, rule in rules():
        if how is not quadrature_points:
            continue
        errors, seconds, iterations = [], 0.0, []
        for problem, D, case in cases:
            trial = replace(problem, rule=rule, fine_rule=ellipse_rule("gauss", 2))
            start = time.perf_counter()
            found = trial.solve(D)
            seconds += time.perf_counter() - start
            iterations.append(found.iterations)
            if found.status == OK:
                qv, right = found.contacts[:, QV], case.contacts[:, QV]
                errors.append(
                    [
                        abs(qv.sum() / right.sum() - 1.0),
                        np.abs(qv / right - 1.0).max(),
                        abs(found.u[1] / case.u[1] - 1.0),
                    ]
                )
        print(
            f"{name:22s}{len(errors):7d}{seconds / len(cases) * 1e3:6.2f}{np.mean(iterations):8.1f}"
            + "".join(spread(column) for column in np.transpose(errors)),
            flush=True,
        )


if __name__ == "__main__":
    main()
