"""Lives of a film in a bearing over those of its tests, even and with worn grooves.

`python benchmarks/film_grooves.py` prints what section 23 of docs/theory says (some minutes): for
each test of the table, the life of `mos2_gyro` whose outer contact is pressed and as warm as the
film of the test, relative to that at 1500 MPa and 23 degC, over the relative life of the test.
"""

import warnings
from itertools import product
from pathlib import Path

import bearingwear
from bearingwear.scene.coefficients import MOS2_LIVES
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import Scene

MOS2 = Path(__file__).parents[1] / "config" / "scenes" / "mos2_gyro.yaml"
NAMES = ("pressure_MPa", "temperature_C", "relative_life")
REFERENCE = (1500.0, 23.0)
STEEL = "materials.bearing_steel.wear_coefficient"
CONTACTS = ("hertz", "worn")


def scene_of(pressure: float, celsius: float, speed: float, slip: float | None) -> Scene:
    """The bearing with its outer contact pressed so much [MPa], at a speed [r/min].

    slip: mean slip speed of the outer contact [m/s] that replaces the speed of the shaft.
    """
    parts = ("inner_ring_C", "balls_C", "outer_ring_C", "reference_C")
    scene = load_scene(MOS2).with_(
        {
            "friction.film.wear_table": [dict(zip(NAMES, row, strict=True)) for row in MOS2_LIVES],
            "bearing.inner_groove_factor": 0.52,  # the outer contact bears the higher pressure
            "wear.end_of_life": {"film_worn_share": 0.5},
            "temperature": dict.fromkeys(parts, celsius),
            "operation.preload_N": 30.0,
            "operation.shaft_speed_rpm": speed,
            "model.contact": "hertz",
        }
    )
    for _ in range(6):
        case = bearingwear.solve(scene, "steady")
        off = 1e6 * pressure / float(case.maximum_pressure.max())
        speed *= slip / outer_slip(scene) if slip else 1.0
        scene = scene.with_(
            {
                "operation.preload_N": scene.operation.preload_N * off**3,
                "operation.shaft_speed_rpm": speed,
            }
        )
    return scene


def outer_slip(scene: Scene) -> float:
    """Slip speed of the outer contact, weighted by pressure [m/s]."""
    case = bearingwear.solve(scene, "steady")
    return float(case.qv.values[0, 1] / case.contact_load.values[0, 1])


def lives(scene: Scene) -> list[float]:
    """Lives [h] of an even film and with worn grooves."""
    even, worn = (bearingwear.life(scene.with_({"model.contact": c})) for c in CONTACTS)
    return [even.life.item(), worn.life.item()]


def steel_factor(pressure: float, relative_life: float) -> float:
    """Wear of the film over that in the test whose life is 1."""
    return (REFERENCE[0] / pressure) ** 2 / relative_life


def steel_life(scene: Scene, factor: float) -> float:
    """With worn grooves and steel that wears so many times as fast."""
    K_s = scene.materials["bearing_steel"].wear_coefficient
    return bearingwear.life(scene.with_({"model.contact": "worn", STEEL: factor * K_s})).life.item()


def main() -> None:
    warnings.simplefilter("ignore")
    print(f"{'r/min':>6} {'slip':>6}{'MPa':>6}{'degC':>6}{'even':>8}{'worn':>8}{'steel too':>11}")
    for speed, is_one_slip in product((3000.0, 30000.0), (False, True)):
        start = scene_of(*REFERENCE, speed, None)
        slip = outer_slip(start) if is_one_slip else None
        first = lives(start)
        for pressure, celsius, tested in MOS2_LIVES:
            scene = scene_of(pressure, celsius, speed, slip)
            own = [*lives(scene), steel_life(scene, steel_factor(pressure, tested))]
            ratios = [h / h0 / tested for h, h0 in zip(own, [*first, first[1]], strict=True)]
            print(f"{speed:6.0f} {'one' if slip else 'own':>6}{pressure:6.0f}{celsius:6.0f}"
                  f"{ratios[0]:8.3f}{ratios[1]:8.3f}{ratios[2]:11.3f}", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
