"""A cage's wear against tests of lead films on retainers: `python benchmarks/cage_tests.py`.

NASA's bearings of 40 mm bore ran at 30 000 r/min under 1780 N in liquid hydrogen; 50 um of lead on
the retainer lasted 15 h (docs/film_tests.md). No K_s/H of lead is known, so what is computed is the
work of a revolution, and the K_s/H that the test then stands for. Bearing and cage are assumed: a
7208C with a guided cage of `new`. A minute of CPU time.
"""

import numpy as np

import bearingwear
from bearingwear.lives.worn_parts import cage_surfaces

SPEED, HOURS, LEAD = 30_000.0, 15.0, 50e-6
OTHERS = (2.0, 6.0)  # h
LOADS = (890.0, 1780.0)


def main() -> None:
    """Work of a revolution by the load, and what the test says of K_s/H."""
    turns = HOURS * 60.0 * SPEED
    for load in LOADS:
        scene = bearingwear.new(
            designation="7208C", speed=SPEED, preload=load, preload_method="constant_force"
        ).with_({"uncertainty": None, "operation.gravity_m_s2": [0.0, 0.0, -9.81]})
        wall, surface = cage_surfaces(scene)
        found = bearingwear.cage(scene, runs=20, within=0.2, workers=2)
        share = found["share"].to_series()
        print(f"{load:g} N: {', '.join(f'{k} {100 * v:.0f} %' for k, v in share.items() if v)}")
        for part, area in (("pocket", scene.bearing.ball_count * wall), ("land", surface)):
            work = float(found[f"mean_{part}_work"].sel(group="all"))
            low, high = found[f"mean_{part}_work_interval"].sel(group="all").values
            ends = ", ".join(f"{1e3 * end:.3g}" for end in (low, high))
            print(f"  {part}: {1e3 * work:.3g} mJ a revolution ({ends})")
            if load == LOADS[-1] and work > 0.0:
                K = area * LEAD / (work * turns)
                print(f"    50 um in {HOURS:g} h: K_s/H {K:.2g} m2/N; ESA's example has 4e-15")
    thick = np.array(OTHERS) / HOURS * LEAD * 1e6
    print(f"2 to 6 h at the same K_s/H: {thick[0]:.2g} to {thick[1]:.2g} um of film")


if __name__ == "__main__":
    main()
