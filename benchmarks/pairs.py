"""Spring or spacer: lives of gyro_s1 at equal stiffness of the rotor on two bearings.

`python benchmarks/pairs.py` prints the table of docs/accuracy.md, "Spring or spacer". The preload
of each is the least that keeps the stiffness from new to the end of life; the rigid pair is set
cold, so an inner ring that is warmer adds preload.
"""

from pathlib import Path

import numpy as np
from scipy.optimize import brentq

from bearingwear.measures import LIMITED
from bearingwear.scene.read import variant
from bearingwear.scene.scene import Scene
from bearingwear.studies.design.map import life_point

SCENE = Path(__file__).resolve().parents[1] / "config" / "scenes" / "gyro_s1.yaml"
LEAST = LIMITED["system_axial_stiffness_N_um"]  # dynamic or quasi-static, the lesser
STIFFNESSES = (3.0, 5.0, 6.0)  # N/um
KINDS = {
    "spring pair": ("constant_force", "spring_pair"),
    "rigid pair": ("fixed_position", "rigid_pair"),
}
WARMER = (0.0, 10.0)  # K, inner ring above the rest
PRELOADS = np.geomspace(1.5, 25.0, 24)


def scene_of(method: str, kind: str, kelvin: float) -> Scene:
    changes = {"operation.preload_method": method, "arrangement.kind": kind}
    if kelvin:
        changes["temperature.inner_ring_C"] = 20.0 + kelvin
    return variant(SCENE, changes)


def least_preload(scene: Scene, stiffness: float) -> tuple[float, dict] | None:
    """The preload with the longest life that keeps both stiffnesses, and its point of a map."""

    def point(preload: float) -> dict:
        return life_point(scene.with_({"operation.preload_N": float(preload)}), None)

    def margin(preload: float) -> float:
        found = point(preload)
        return float(LEAST.margins(found, stiffness)) if not found["status"] else -1.0

    found = [margin(p) for p in PRELOADS]
    for k in range(1, len(found)):
        if found[k - 1] < 0.0 <= found[k]:
            p = brentq(margin, PRELOADS[k - 1], PRELOADS[k], xtol=1e-4)
            p += 2e-4
            return p, point(p)
    return (float(PRELOADS[0]), point(PRELOADS[0])) if found[0] >= 0.0 else None


def main() -> None:
    print("| minimum stiffness | inner ring | spring pair | rigid pair | longer life |")
    print("| ---: | ---: | ---: | ---: | --- |")
    for stiffness in STIFFNESSES:
        for kelvin in WARMER:
            cells, lives = [], {}
            for name, (method, kind) in KINDS.items():
                chosen = least_preload(scene_of(method, kind, kelvin), stiffness)
                if chosen is None:
                    cells.append("–")
                    continue
                preload, point = chosen
                lives[name] = float(point["life"]) / 3600.0
                cells.append(f"{preload:.3g} N, {lives[name]:.3g} h")
            longer = max(lives, key=lambda name: lives[name])
            ratio = max(lives.values()) / min(lives.values())
            print(
                f"| {stiffness:g} N/µm | +{kelvin:g} K | {cells[0]} | {cells[1]} "
                f"| {longer}, {ratio:.2f} times |"
            )


if __name__ == "__main__":
    main()
