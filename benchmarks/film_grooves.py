"""Lives of a film in a bearing over those of its tests, even and with worn grooves.

`python benchmarks/film_grooves.py` prints what section 23 of docs/theory says (some minutes): for
each test of the table, the life of `mos2_gyro` whose outer contact is pressed and as warm as the
film of the test, relative to that at 1500 MPa and 23 degC, over the relative life of the test.
"""

import warnings
from pathlib import Path
from typing import NamedTuple

import bearingwear
from bearingwear.scene.coefficients import MOS2_LIVES
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import Scene

MOS2 = Path(__file__).parents[1] / "config" / "scenes" / "mos2_gyro.yaml"
NAMES = ("pressure_MPa", "temperature_C", "relative_life")
REFERENCE = (1500.0, 23.0)
STEEL = "materials.bearing_steel.wear_coefficient"
CONTACTS = ("hertz", "worn")
SPEED = 3000.0  # loads of the contacts are those of the preload alone [r/min]


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


class Lives(NamedTuple):
    """Lives [h] of an even film and with worn grooves, and how much wider its contact becomes."""

    even: float
    worn: float
    wider: float  # half-length of the outer contact at the end over that at the start


def lives(scene: Scene) -> Lives:
    even, worn = (bearingwear.life(scene.with_({"model.contact": c})) for c in CONTACTS)
    half = worn.history_contact_half_length.values[:, 1]
    return Lives(even.life.item(), worn.life.item(), float(half[-1] / half[0]))


def steel_factor(pressure: float, relative_life: float) -> float:
    """Wear of the film over that in the test whose life is 1."""
    return (REFERENCE[0] / pressure) ** 2 / relative_life


def steel_life(scene: Scene, factor: float) -> float:
    """With worn grooves and steel that wears so many times as fast."""
    K_s = scene.materials["bearing_steel"].wear_coefficient
    return bearingwear.life(scene.with_({"model.contact": "worn", STEEL: factor * K_s})).life.item()


def main() -> None:
    warnings.simplefilter("ignore")
    print(f"{'slip':>4}{'MPa':>6}{'degC':>6}{'even':>8}{'worn':>8}{'steel too':>11}{'wider':>8}")
    start = scene_of(*REFERENCE, SPEED, None)
    first = lives(start)
    for slip in (None, outer_slip(start)):
        for pressure, celsius, tested in MOS2_LIVES:
            scene = scene_of(pressure, celsius, SPEED, slip)
            found, steel = lives(scene), steel_life(scene, steel_factor(pressure, tested))
            even, worn, both = (
                hours / of_first / tested
                for hours, of_first in (
                    (found.even, first.even), (found.worn, first.worn), (steel, first.worn)
                )
            )  # fmt: skip
            print(f"{'one' if slip else 'own':>4}{pressure:6.0f}{celsius:6.0f}{even:8.3f}"
                  f"{worn:8.3f}{both:11.3f}{found.wider:8.2f}", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
