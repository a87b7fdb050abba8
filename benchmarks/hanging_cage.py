"""How long a cage hangs on its balls before it whirls: `python benchmarks/hanging_cage.py`.

gyro_s1 with a shaft that lies, from the usual start and from starts a nanometre apart, at three
tolerances of a step. A whirl has begun where normal force times slip in the pockets stays above
15 mW for four turns; a cage that hangs has 3 to 5 mW. A minute.
"""

import numpy as np

from bearingwear.kernels.status import OK
from bearingwear.model.dynamic import DynamicSystem
from bearingwear.model.start import start_of
from bearingwear.scene.variant import variant

SCENE = "config/scenes/gyro_s1.yaml"
GRAVITY = {"operation.gravity_m_s2": [0.0, 0.0, -9.81]}
TOLERANCES, STARTS, TURNS = (1e-3, 1e-4, 1e-5), 6, 200
WHIRL, LASTING = 15e-3, 4  # [W], turns


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
    """One line for each tolerance."""
    print(f"turns until the whirl (at most {TURNS}), and mW in the pockets till then")
    for tolerance in TOLERANCES:
        found = [turns_of_hanging(tolerance, seed) for seed in range(STARTS)]
        print(f"{tolerance:g}:", ", ".join(f"{n} ({1e3 * power:.1f})" for n, power in found))


if __name__ == "__main__":
    main()
