"""Periodic motions found directly against marches: `python benchmarks/periodic.py [SCENES [SEED]]`.

Random radial, tilting and rotating loads on four bearings without their cages, all from the steady
state under the thrust alone. The motion found costs its search, the passing that its stability is
found from, and the three that are recorded; turns are those simulated, times those of a processor.

A march, of 300 turns or until the balls run into what the model does not describe, has settled
with the first of three orbits whose mean QV is within 1e-5 of that of the motion found:

- *each*: of every ball. The balls of a march keep the spacing that they had when the rest settled,
  or bunch: `growth` is that of uneven spacing in 1000 turns.
- *mean*: of all balls together, whatever lies between them.
- *even*: of every ball, in a march whose balls are put back to even spacing after each orbit, by
  their mean azimuths over it; and how far QV of any ball is off in the end. It knows nothing of
  how the motion was found, which is checked with it.
"""

import math
import sys
import time as clock
import warnings
from pathlib import Path

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.layout import BALL, PSI
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import Scene
from bearingwear.solvers.dynamic.periodic import PeriodicMotion, periodic_motion
from bearingwear.solvers.dynamic.system import DynamicSystem
from bearingwear.solvers.dynamic.windows import FEWEST_OF_TREND
from bearingwear.solvers.start import start_of

SCENES = Path(__file__).resolve().parents[1] / "config" / "scenes"
MOST_TURNS = 300.0
KEPT_EVEN = 16  # orbits
AGREED = 1e-5  # of QV
TOLERANCE = 1e-3  # of a step


def drawn(rng: np.random.Generator) -> tuple[str, Scene]:
    """A bearing with a load, and what it is."""
    name = str(rng.choice(["gyro_s1", "turbopump", "bearing218", "turbine"]))
    preload = load_scene(SCENES / f"{name}.yaml").operation.preload_N
    load = preload * 10.0 ** rng.uniform(-1.5, 0.3)
    kind = str(rng.choice(["radial", "rotating", "tilt"]))
    given = {"radial": load, "rotating": 0.3 * load, "tilt": rng.uniform(0.05, 0.5)}[kind]
    method = str(rng.choice(["constant_force", "fixed_position"]))
    loads = {"radial": "[0, 0]", "rotating": "0", "tilt": "0"}
    loads[kind] = f"[0, -{given:.4g}]" if kind == "radial" else f"{given:.4g}"
    keys = {"radial": "radial_load_N", "rotating": "rotating_load_N", "tilt": "tilt_mrad"}
    changes = [
        *(f"operation.{keys[other]}={value}" for other, value in loads.items()),
        f"operation.preload_method={method}",
        f"friction.ball_race={rng.uniform(0.02, 0.15):.3f}",
    ]
    scene = load_scene(SCENES / f"{name}.yaml", [*changes, "model.normal_balance=frictionless"])
    unit = "mrad" if kind == "tilt" else "N"
    held = "spring" if method == "constant_force" else "fixed"
    return f"{name} {kind} {float(f'{given:.3g}'):g} {unit} {held}", scene.without_cage


class March:
    """A march by orbits, from where a system is."""

    def __init__(self, system: DynamicSystem, motion: PeriodicMotion) -> None:
        self.system, self.n, self.passing = system, len(motion.balls), motion.passing
        self.orbit = self.n * motion.passing / system.turn  # turns
        self.load_rate = system.bearing.op.omega_i if system.bearing.F_rot else 0.0

    def qv(self) -> np.ndarray:
        """Mean QV (n,) of each ball over the next orbit [W], NaN where it ends; and azimuths."""
        before, self.azimuth = self.system.qv.copy(), np.zeros(self.n)
        for _ in range(self.n):
            if self.system.advance(self.passing, TOLERANCE).status != code.OK:
                return np.full(self.n, np.nan)
            self.azimuth += self.system.balls[:, PSI] / self.n
        return (self.system.qv - before).sum(axis=1) / (self.n * self.passing)

    def space(self) -> None:
        """Move each ball along its path to where even spacing has it."""
        ahead = self.azimuth - 2.0 * np.pi * np.arange(self.n) / self.n
        rates = self.system.rates()[: self.n * BALL].reshape(self.n, BALL).copy()
        rates[:, PSI] -= self.load_rate
        late = (ahead - ahead.mean()) / rates[:, PSI].mean()
        self.system.balls[:] -= late[:, np.newaxis] * rates


def settled(errors: np.ndarray) -> float:
    """Orbits marched when QV is first what it was found to be, and stays so for two more."""
    within = errors < AGREED
    (first,) = np.nonzero(within[:-2] & within[1:-1] & within[2:])
    return float(first[0] + 1) if first.size else math.inf


def compared(scene: Scene) -> tuple[list[str], float] | None:
    """Row of the table, and the growth of other disturbances; nothing without an equilibrium."""
    start = start_of(scene)
    system = DynamicSystem.of(scene, start.u)
    if system.update() != code.OK:
        return None
    begun, turn = (system.packed(), system.time), system.turn
    cpu = clock.process_time()
    motion = periodic_motion(system, TOLERANCE, system.control().method)
    if motion is None:
        return ["none found"], math.nan
    assert motion.growth is not None
    system.unpack(*begun)
    system.balls[:] = motion.balls
    before = system.qv.sum()
    recorded = FEWEST_OF_TREND * motion.passing
    system.advance(recorded, TOLERANCE)
    cpu = clock.process_time() - cpu
    found = (system.qv.sum() - before) / recorded / len(motion.balls)
    turns = motion.turns + recorded / turn
    system.unpack(*begun)
    march = March(system, motion)
    spent = clock.process_time()
    qv = np.array([march.qv() for _ in range(round(MOST_TURNS / march.orbit))]) / found - 1.0
    spent = (clock.process_time() - spent) / len(qv)  # of an orbit
    system.unpack(*begun)
    even = []
    for _ in range(KEPT_EVEN):
        even.append(np.abs(march.qv() / found - 1.0).max())
        march.space()
    row = [f"{turns:.1f}", f"{1e3 * cpu:.0f}"]
    for errors in (np.abs(qv).max(axis=1), np.abs(qv.mean(axis=1)), np.array(even)):
        orbits = settled(errors)
        more = "" if orbits < math.inf else ">"
        orbits = min(orbits, float(len(errors)))
        took = orbits * march.orbit, orbits * spent / cpu
        row += [f"{more}{figure:.{0 if figure >= 10.0 else 1}f}" for figure in took]
    row = [*row[:-1], f"{even[-1]:.0e}".replace("e-0", "e-"), f"{1e3 * motion.growth.spacing:.2g}"]
    return row, motion.growth.slip_and_spin


def main() -> None:
    """A table of both."""
    warnings.simplefilter("ignore")
    count, seed = (int(text) for text in (sys.argv[1:] + ["24", "1"][len(sys.argv) - 1 :]))
    heads = "turns | ms | each | time ratio | mean | time ratio | even | error | growth"
    print(f"| load | {heads} |\n| --- |{' ---: |' * (1 + heads.count('|'))}")
    rng = np.random.default_rng(seed)
    compared(drawn(np.random.default_rng(seed))[1])  # compiles
    others = []
    for _ in range(count):
        told, scene = drawn(rng)
        found = compared(scene)
        if found is not None:
            row, other = found
            print(f"| {told} | {' | '.join(row)} |", flush=True)
            others.append(-1.0 / other)
    print(f"\nother disturbances die out e-fold in {min(others):.2g} to {max(others):.2g} turns")


if __name__ == "__main__":
    main()
