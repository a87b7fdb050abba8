"""Periodic motions found directly against marches: `python benchmarks/periodic.py [SCENES [SEED]]`.

Random radial, tilting and rotating loads on four bearings without their cages. Each motion is
marched on until an orbit's QV changes by less than 1e-7 of it, or 300 turns have passed, from the
steady state under the thrust alone. Turns are those simulated, the search with the three passings
recorded after it.
"""

import sys
import warnings
from pathlib import Path

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.model.dynamic import DynamicSystem
from bearingwear.model.periodic import periodic_motion
from bearingwear.model.start import start_of
from bearingwear.model.time_run import FEWEST_OF_TREND
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import Scene

SCENES = Path(__file__).resolve().parents[1] / "config" / "scenes"
MOST_TURNS = 300.0
SETTLED = 1e-7
TOLERANCE = 1e-3  # of a step


def drawn(rng: np.random.Generator) -> tuple[str, Scene]:
    """A bearing with a load, and what it is."""
    name = str(rng.choice(["gyro_s1", "turbopump", "bearing218", "turbine"]))
    preload = load_scene(SCENES / f"{name}.yaml").operation.preload_N
    load = preload * 10.0 ** rng.uniform(-1.5, 0.3)
    kind = rng.choice(["radial_load_N", "rotating_load_N", "tilt_mrad"])
    value = {"radial_load_N": f"[0, -{load:.4g}]", "rotating_load_N": f"{0.3 * load:.4g}",
             "tilt_mrad": f"{rng.uniform(0.05, 0.5):.3g}"}[kind]  # fmt: skip
    method = rng.choice(["constant_force", "fixed_position"])
    changes = [
        f"operation.{kind}={value}",
        f"operation.preload_method={method}",
        f"friction.ball_race={rng.uniform(0.02, 0.15):.3f}",
    ]
    scene = load_scene(SCENES / f"{name}.yaml", [*changes, "model.normal_balance=frictionless"])
    return f"{name:10s} {kind} {value}, {method}", scene.without_cage


def orbit_power(system: DynamicSystem, duration: float) -> float:
    """Mean QV over so long [W]; NaN where the run ends before."""
    before = system.qv.sum()
    if system.advance(duration, TOLERANCE).status != code.OK:
        return np.nan
    return float(system.qv.sum() - before) / duration


def main() -> None:
    warnings.simplefilter("ignore")
    count, seed = (int(text) for text in (sys.argv[1:] + ["24", "1"][len(sys.argv) - 1 :]))
    rng = np.random.default_rng(seed)
    print(f"{'':62s} {'turns':>6s} {'marched':>8s} {'ratio':>6s}  QV marched over found - 1")
    for _ in range(count):
        told, scene = drawn(rng)
        start = start_of(scene)
        system = DynamicSystem.of(scene, start.u)
        if system.update() != code.OK:
            continue
        begun, turn = (system.packed(), system.time), system.turn
        motion = periodic_motion(system, TOLERANCE, system.control().method, linear=start.linear)
        if motion is None:
            print(f"{told:62s} none found")
            continue
        orbit = motion.passing * len(motion.balls)
        system.unpack(begun[0], motion.time)
        system.balls[:] = motion.balls
        found = orbit_power(system, orbit)
        system.unpack(*begun)
        last = now = np.nan
        while (system.time - begun[1]) / turn < MOST_TURNS:
            last, now = now, orbit_power(system, orbit)
            if np.isnan(now) or abs(now - last) <= SETTLED * now:
                break
        turns, marched = (
            motion.turns + FEWEST_OF_TREND * motion.passing / turn,
            (system.time - begun[1]) / turn,
        )
        print(
            f"{told:62s} {turns:6.1f} {marched:8.1f} {marched / turns:6.1f}  {now / found - 1:+.1e}"
        )


if __name__ == "__main__":
    main()
