"""Balls and race in time, in plain NumPy and SciPy: an independent check and the speed to beat.

Like plain_scipy.py, whose pieces it uses, this imports nothing of bearingwear. The balls of an
angular contact bearing and its inner race under a thrust and a load that turns with the shaft, no
cage: arrays over balls, contacts and strips; ball centres and race by Newton's method from the last
answer; LSODA in time. Constant-force preload, no drag, no tilt. SI units and radians.
"""

from dataclasses import dataclass

import numpy as np
import plain_scipy as plain
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

STATES = 6  # of a ball: w_x, w_y, w_z, orbit rate, azimuth, time integral of its QV


def strip_rule(count):
    """Equal strips, each with its own part of the load: mid-points and weights as plain.strips."""
    edges = np.linspace(-1, 1, count + 1)
    xi = (edges[1:] + edges[:-1]) / 2
    share = np.diff(0.75 * (edges - edges**3 / 3))
    return xi, share / (0.75 * (1 - xi**2))


@dataclass
class Answer:
    """Where a run has come to, and what it took."""

    qv: float  # mean total QV [W]
    state: np.ndarray  # (balls, STATES) at the end
    steps: int


class Motion:
    """All balls and the inner race of a bearing."""

    def __init__(self, bearing, op, rotating, points=50):
        assert op.method == "constant_force" and op.drag == 0
        self.bearing, self.op, self.rotating = bearing, op, rotating
        self.D = bearing.D0 - op.loss
        self.mass, self.inertia = bearing.inertia(self.D)
        self.rule = strip_rule(points)
        # Hertz' constants follow the contact angle smoothly: a table saves an equation a contact.
        cosine = np.linspace(0.5, 1, 65)
        self.hertz = [
            CubicSpline(
                cosine,
                [plain.race_hertz(bearing, self.D, race, np.arccos(c))[0:3:2] for c in cosine],
            )
            for race in (0, 1)
        ]
        steady = plain.steady_state(bearing, op, self.rule)
        self.X = np.tile(steady["position"][:2], (bearing.count, 1))
        self.delta = np.array([steady["position"][2], 0.0, 0.0])
        self.rest = self.X, self.delta
        self.start = np.zeros((bearing.count, STATES))
        self.start[:, :3], self.start[:, 3] = steady["w"], steady["Omega"]
        self.start[:, 4] = 2 * np.pi * np.arange(bearing.count) / bearing.count

    def contacts(self, toward):
        """Loads, semi-major axes, unit vectors and stiffness matrices of all contacts.

        `toward` (balls, 2, 2): from ball centre to inner groove centre, from outer one to ball
        centre, both (axial, radial).
        """
        length = np.hypot(toward[..., 0], toward[..., 1])
        unit = toward / length[..., None]
        depth = np.maximum(length - (self.bearing.grooves - self.D / 2), 0)
        c_a, K = np.moveaxis(
            np.stack([self.hertz[race](unit[:, race, 1]) for race in (0, 1)], axis=1), -1, 0
        )
        load = K * depth**1.5
        outer = unit[..., :, None] * unit[..., None, :]
        across = (load / length)[..., None, None] * (np.eye(2) - outer)
        stiffness = (1.5 * K * np.sqrt(depth))[..., None, None] * outer + across
        return load, c_a * np.cbrt(load), unit, stiffness

    def equilibrium(self, t, Omega, psi):
        """Contacts when ball centres and race balance at an instant; 2 balls + 3 unknowns."""
        b, n = self.bearing, self.bearing.count
        theta = self.op.speed[0] * t
        force = np.array(
            [
                self.op.preload,
                -self.rotating * np.sin(theta),
                self.rotating * np.cos(theta),
            ]
        )
        # Axial and radial shift of a groove centre by the race's displacement.
        shift = np.zeros((n, 2, 3))
        shift[:, 0, 0] = 1
        shift[:, 1, 1], shift[:, 1, 2] = -np.sin(psi), np.cos(psi)
        free = b.BD * np.array([np.sin(b.a0), np.cos(b.a0)])
        place = np.arange(n)
        for _ in range(20):
            A = free + shift @ self.delta
            load, a, unit, k = self.contacts(np.stack([A - self.X, self.X], axis=1))
            pull = load[..., None] * unit
            left = pull[:, 0] - pull[:, 1]
            left[:, 1] += self.mass * (b.loci[1] + self.X[:, 1]) * Omega**2
            race = force - np.einsum("jia,ji->a", shift, pull[:, 0])
            coupling = k[:, 0] @ shift
            matrix = np.zeros((2 * n + 3, 2 * n + 3))
            blocks = matrix[: 2 * n, : 2 * n].reshape(n, 2, n, 2)
            blocks[place, :, place, :] = k.sum(axis=1)
            blocks[place, 1, place, 1] -= self.mass * Omega**2
            matrix[: 2 * n, 2 * n :] = -coupling.reshape(2 * n, 3)
            matrix[2 * n :, : 2 * n] = -coupling.reshape(2 * n, 3).T
            matrix[2 * n :, 2 * n :] = np.einsum("jia,jib->ab", shift, coupling)
            step = np.linalg.solve(matrix, np.append(left.ravel(), race))
            self.X = self.X + step[: 2 * n].reshape(n, 2)
            self.delta = self.delta + step[2 * n :]
            if np.abs(step).max() < 1e-10 * b.BD:
                return load, a, unit
        raise RuntimeError(f"no equilibrium at {t:.6g} s")

    def rates(self, t, y):
        """Time derivative of all states."""
        b, op = self.bearing, self.op
        y = y.reshape(b.count, STATES)
        w, Omega = y[:, :3, None, None], y[:, 3]
        load, a, unit = self.equilibrium(t, Omega, y[:, 4])
        xi, weight = self.rule
        R, r = self.D / 2, (b.loci[1] + self.X[:, 1])[:, None, None]
        side = np.array([[-1.0], [1.0]])
        sin, cos = unit[..., 0, None], unit[..., 1, None]
        R_d = (2 * b.grooves * R / (b.grooves + R))[:, None]
        a = a[..., None]
        x = a * xi
        h = np.sqrt(R_d**2 - x**2) - np.sqrt(R_d**2 - a**2) + np.sqrt(R**2 - a**2)
        p_x, p_z = x * cos + side * h * sin, -x * sin + side * h * cos
        v1 = -side * w[:, 1] * h
        v2 = r * Omega[:, None, None] - np.array(op.speed)[:, None] * (r + p_z)
        v2 -= w[:, 2] * p_x - w[:, 0] * p_z
        dQ = load[..., None] * (0.75 * (1 - xi**2) * weight)
        square = v1**2 + v2**2
        pull = op.mu * dQ / np.sqrt(square + op.v_r**2)
        f1, f2 = pull * v1, pull * v2
        out = np.empty_like(y)
        out[:, 0] = -(p_z * f2).sum(axis=(1, 2)) / self.inertia
        out[:, 1] = (side * h * f1).sum(axis=(1, 2)) / self.inertia + Omega * y[:, 2]
        out[:, 2] = (p_x * f2).sum(axis=(1, 2)) / self.inertia - Omega * y[:, 1]
        out[:, 3] = -f2.sum(axis=(1, 2)) / (self.mass * r[:, 0, 0])
        out[:, 4] = Omega
        out[:, 5] = (np.sqrt(square) * dQ).sum(axis=(1, 2))
        return out.ravel()

    def jacobian(self, t, y):
        """Derivative of `rates`, ball by ball, from five differences.

        The same state of all balls is moved at once: what couples them through the race is taken
        for their own. LSODA corrects with it; the answer does not depend on it.
        """
        n, ball = self.bearing.count, np.arange(self.bearing.count)
        out = np.zeros((n, STATES, n, STATES))
        here = self.rates(t, y).reshape(n, STATES)
        # Slip of a thousandth of v_r; an azimuth far below what a time step makes of it.
        increments = [1e-3 * self.op.v_r / (self.D / 2)] * 4 + [1e-7]
        for state, increment in enumerate(increments):
            there = y.reshape(n, STATES).copy()
            there[:, state] += increment
            there = self.rates(t, there.ravel()).reshape(n, STATES)
            out[ball, :, ball, state] = (there - here) / increment
        return out.reshape(y.size, y.size)

    def run(self, duration, rtol, by_ball=True):
        """From the steady state under the thrust alone over `duration` [s].

        `by_ball`: with `jacobian`, else with the differences LSODA takes itself.
        """
        n = self.bearing.count
        self.X, self.delta = self.rest[0].copy(), self.rest[1].copy()
        scale = np.array([self.op.speed[0]] * 4 + [1.0, 1e-2 * duration])
        done = solve_ivp(
            self.rates,
            (0, duration),
            self.start.ravel(),
            method="LSODA",
            rtol=rtol,
            atol=np.tile(rtol * scale, n),
            jac=self.jacobian if by_ball else None,
        )
        if not done.success:
            raise RuntimeError(f"motion: {done.message}")
        end = done.y[:, -1].reshape(n, STATES)
        return Answer(end[:, 5].sum() / duration, end, done.t.size - 1)
