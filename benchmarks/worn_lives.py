"""Lives whose grooves are followed, beside those whose contacts stay Hertz'.

    python benchmarks/worn_lives.py

prints a table of lives: bearings, methods, friction, tracks, films. How they go by the loss that
ends them, and by cells and steps, is in docs/accuracy.md (`make effects-docs`).
A life ends at a loss of 0.35 of the balls' diameter in mm (L_eq 0.7 um on 2 mm), or at 40 % of the
preload, whichever comes first. All wear the same: K_s/H as in the scene, balls and races counted.
"""

import time
from pathlib import Path

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.life import life
from bearingwear.results.words import name_in_words
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import Scene

SCENES = Path(__file__).resolve().parents[1] / "config" / "scenes"
METHODS = ("constant_force", "fixed_position")
SPINDLE_7008 = (  # angular contact ball bearing 7008 C, inside as most makers build it: assumed
    "bearing.ball_count=17",
    "bearing.ball_diameter_mm=7.938",
    "bearing.pitch_diameter_mm=54",
    "bearing.contact_angle_deg=15",
    "bearing.inner_groove_factor=0.54",
    "bearing.outer_groove_factor=0.52",
    "operation.shaft_speed_rpm=15000",
    "operation.preload_N=150",
)
BEARINGS: dict[str, tuple[str, tuple[str, ...]]] = {
    "gyro_s1, mu 0.08": ("gyro_s1", ("friction.ball_race=0.08",)),
    "gyro_s1, mu 0.02": ("gyro_s1", ("friction.ball_race=0.02",)),
    "turbopump": ("turbopump", ()),
    "7008, mu 0.08": ("gyro_s1", SPINDLE_7008),
}
FILM_PER_DIAMETER = 0.25e-3  # of MoS2 on the races, friction and thickness as in mos2_gyro
LOSS_PER_DIAMETER = 0.35e-3
PRELOAD_LEFT = 0.4
HOUR = 3600.0


def scene_of(name: str, method: str, contact: str, *more: str) -> Scene:
    """A bearing with its life ended as above."""
    file, changes = BEARINGS[name]
    made = load_scene(SCENES / f"{file}.yaml", [*changes, "cage=null"])
    limit = 1e3 * LOSS_PER_DIAMETER * made.bearing.ball_diameter_mm
    end = f"wear.end_of_life={{ball_diameter_loss_um: {limit:g}, preload_fraction: {PRELOAD_LEFT}}}"
    keys = (f"operation.preload_method={method}", f"model.contact={contact}", end, *more)
    new = {key.partition("=")[0] for key in keys}
    kept = [change for change in changes if change.partition("=")[0] not in new]
    return load_scene(SCENES / f"{file}.yaml", [*kept, "cage=null", *keys])


def filmed(name: str) -> tuple[str, ...]:
    """Changes that put a film on the races; it wears as all the rest does."""
    made = load_scene(SCENES / f"{BEARINGS[name][0]}.yaml", [*BEARINGS[name][1], "cage=null"])
    um = 1e3 * FILM_PER_DIAMETER * made.bearing.ball_diameter_mm
    film = "{shear_strength_MPa: 24.8, pressure_coefficient: 0.001, bare_ball_race: 0.4, "
    film += f"thickness_um: {um:g}, wear_coefficient: 5.0e-6}}"
    return "friction.ball_race=null", "uncertainty=null", f"friction.film={film}"


def hours(scene: Scene) -> tuple[float, float]:
    """Life [h], NaN where no criterion was met, and CPU time [s]."""
    started = time.process_time()
    values = life(scene).values
    spent = time.process_time() - started
    return (values["life"] / HOUR if values["status"] == code.OK else np.nan), spent


def told(value: float) -> str:
    return "-" if np.isnan(value) else f"{value:.3g}"


def table() -> None:
    """Hertzian and worn lives, with and without films; also of a pair."""
    head = ("bearing", "method", "Hertzian, h", "worn, h", "worn/Hertzian")
    print("| " + " | ".join((*head, "with film, h", "CPU, s")) + " |\n" + "| --- " * 7 + "|")
    rows: dict[str, dict[str, tuple[float, float, float]]] = {}
    for name in BEARINGS:
        for method in METHODS:
            hertz, _ = hours(scene_of(name, method, "hertz"))
            worn, spent = hours(scene_of(name, method, "worn"))
            films, _ = hours(scene_of(name, method, "worn", *filmed(name)))
            rows.setdefault(name, {})[method] = (hertz, worn, films)
            cells = (hertz, worn, worn / hertz, films, spent)
            print(
                f"| {name} | {name_in_words(method)} | "
                + " | ".join(told(cell) for cell in cells)
                + " |"
            )
    pair = ("arrangement.external_axial_N=50",)
    rigid = ("arrangement.kind=rigid_pair", *pair)
    spring = ("arrangement.kind=spring_pair", "arrangement.spring_stiffness_N_um=1", *pair)
    for method, kind in zip(METHODS, (spring, rigid), strict=True):
        name = "7008, mu 0.08"
        hertz, _ = hours(scene_of(name, method, "hertz", *kind))
        worn, spent = hours(scene_of(name, method, "worn", *kind))
        cells = (hertz, worn, worn / hertz, np.nan, spent)  # films: refused
        print(
            f"| {name}, pair, 50 N | {name_in_words(method)} | "
            + " | ".join(map(told, cells))
            + " |"
        )
    print(
        "\nLife with constant force divided by life with fixed position:\n\n"
        "| bearing | Hertzian | worn | with film |"
    )
    print("| --- " * 4 + "|")
    for name, found in rows.items():
        spring_lives, rigid_lives = (found[method] for method in METHODS)
        ratios = [a / b for a, b in zip(spring_lives, rigid_lives, strict=True)]
        print(f"| {name} | " + " | ".join(told(ratio) for ratio in ratios) + " |")


if __name__ == "__main__":
    table()
