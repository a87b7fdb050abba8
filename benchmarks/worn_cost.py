"""CPU time of a life with worn grooves, by cells.

    python benchmarks/worn_cost.py

prints a Markdown table for gyro_s1 to a wear depth of 0.7 um with constant force: one life without
its errors, the least of three, compiled code warm.
"""

import time
from pathlib import Path

from bearingwear.lives.grooves import EXACT_GROOVES, StiffGrooves, follow_grooves
from bearingwear.scene.read import load_scene

SCENE = Path(__file__).resolve().parents[1] / "config" / "scenes" / "gyro_s1.yaml"
CELLS = (24, 6), (32, 8), (48, 10), (64, 14), (96, 20), (128, 28)


def cost(cells: tuple[int, int]) -> tuple[float, int]:
    """CPU time [ms] and states solved."""
    scene = load_scene(SCENE, ["model.contact=worn"])
    times = []
    for _ in range(3):
        started = time.process_time()
        life = follow_grooves(StiffGrooves(scene, EXACT_GROOVES._replace(cells=cells)))
        times.append(1e3 * (time.process_time() - started))
    return min(times), life.solves


def main() -> None:
    print("| cells | CPU ms | states |")
    print("| --- |" + " ---: |" * 2)
    for cells in CELLS:
        row = [f"{value:.0f}" for value in cost(cells)]
        print(f"| {cells[0]} x {cells[1]} | {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main()
