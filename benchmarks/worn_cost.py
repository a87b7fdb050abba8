"""CPU time of a life with worn grooves, by cells and by spread or banded wear of the balls.

    python benchmarks/worn_cost.py

prints a Markdown table for gyro_s1 to a wear depth of 0.7 um with constant force: one life without
its errors, the least of three, compiled code warm.
"""

import time
from pathlib import Path

from bearingwear.lives.grooves import Grooves, follow_grooves
from bearingwear.scene.read import load_scene

SCENE = Path(__file__).resolve().parents[1] / "config" / "scenes" / "gyro_s1.yaml"
CELLS = (24, 6), (32, 8), (48, 10), (64, 14), (96, 20), (128, 28)


def cost(track: str, cells: tuple[int, int]) -> tuple[float, int]:
    """CPU time [ms] and states solved."""
    scene = load_scene(SCENE, ["model.contact=worn", f"wear.ball_track={track}"])
    times = []
    for _ in range(3):
        started = time.process_time()
        life = follow_grooves(Grooves(scene, cells))
        times.append(1e3 * (time.process_time() - started))
    return min(times), life.solves


def main() -> None:
    print("| cells | spread: CPU ms | states | bands: CPU ms | states |")
    print("| --- |" + " ---: |" * 4)
    for cells in CELLS:
        row = [f"{value:.0f}" for track in ("spread", "bands") for value in cost(track, cells)]
        print(f"| {cells[0]} x {cells[1]} | {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main()
