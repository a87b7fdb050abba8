"""How a cage moves, by the tolerance of a step: `python benchmarks/cage_motions.py`.

First a whirl of gyro_s1's weightless cage, which starts close to its land, going round: power and
rate over fifteen turns. Then how long the cage hangs on its balls where the shaft lies, from the
usual start and from starts a nanometre apart: a whirl has begun where normal force times slip in
the pockets stays above 15 mW for four turns; a cage that hangs has 3 to 5 mW. Two minutes.
"""

import numpy as np

from bearingwear.kernels.status import OK
from bearingwear.scene.read import variant
from bearingwear.solvers.dynamic.system import CageStart, DynamicSystem
from bearingwear.solvers.start import start_of

SCENE = "config/scenes/gyro_s1.yaml"
GRAVITY = {"operation.gravity_m_s2": [0.0, 0.0, -9.81]}
TOLERANCES, STARTS, TURNS = (1e-3, 1e-4, 1e-5), 6, 200
WHIRL, LASTING = 15e-3, 4  # [W], turns


def whirl(friction: float, tolerance: float) -> tuple[float, float]:
    """Power in the pockets [W] and whirl over the shaft's rate, over turns 15 to 30."""
    scene = variant(SCENE, {"friction.cage": friction})
    system = DynamicSystem.of(scene, start_of(scene).u)
    system.start_cage(CageStart(offset=0.95, whirl=0.6875, lag=0.0))
    assert system.advance(15 * system.turn, tolerance).status == OK
    pockets = slice(system.layout.pockets, system.layout.land)
    before, place = system.y[pockets].sum(), []
    for _ in range(300):
        assert system.advance(system.turn / 20, tolerance).status == OK
        place.append(complex(*system.cage_state[1:3]))
    step = np.angle(np.sum(np.array(place[1:]) * np.conj(place[:-1])))
    power = (system.y[pockets].sum() - before) / (15 * system.turn)
    return float(power), float(20.0 * step / (2.0 * np.pi))


def turns_of_hanging(tolerance: float, seed: int) -> tuple[int, float]:
    """Turns until the cage whirls, at most TURNS, and the mean power in the pockets till then."""
    scene = variant(SCENE, GRAVITY)
    system = DynamicSystem.of(scene, start_of(scene).u)
    if seed:
        system.cage_state[:3] += 1e-9 * np.random.default_rng(seed).normal(size=3)
    layout, powers = system.layout, []
    for _ in range(TURNS):
        before = system.y[layout.pockets : layout.land].sum()
        assert system.advance(system.turn, tolerance).status == OK
        powers.append((system.y[layout.pockets : layout.land].sum() - before) / system.turn)
        if min(powers[-LASTING:]) > WHIRL and len(powers) > LASTING:
            del powers[-LASTING:]
            break
    return len(powers), float(np.mean(powers))


def main() -> None:
    """Two tables: the whirl, and how long a cage hangs."""
    print("whirl: mW in the pockets, and its rate over the shaft's")
    for friction in (0.05, 0.1):
        for tolerance in (1e-2, *TOLERANCES):
            power, rate = whirl(friction, tolerance)
            print(f"friction {friction:g}, tolerance {tolerance:g}: {1e3 * power:.2f}, {rate:.4f}")
    print(f"turns until the whirl (at most {TURNS}), and mW in the pockets till then")
    for tolerance in TOLERANCES:
        found = [turns_of_hanging(tolerance, seed) for seed in range(STARTS)]
        print(f"{tolerance:g}:", ", ".join(f"{n} ({1e3 * power:.1f})" for n, power in found))


if __name__ == "__main__":
    main()
