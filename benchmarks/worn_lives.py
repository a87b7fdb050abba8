"""Lives whose grooves are followed, beside those whose contacts stay Hertz'.

    python benchmarks/worn_lives.py          table of lives: bearings, methods, friction, tracks
    python benchmarks/worn_lives.py --loss   against the loss that ends the life; what `auto` saves
    python benchmarks/worn_lives.py --cost   cells and steps

A life ends at a loss of 0.35 of the balls' diameter in mm (L_eq 0.7 um on 2 mm), or at 40 % of the
preload, whichever comes first. All wear the same: K_s/H as in the scene, balls and races counted.
"""

import argparse
import time
from pathlib import Path

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.model.life import life
from bearingwear.model.worn_life import STEP, WORN_CELLS, WornLife
from bearingwear.model.worn_outputs import wear_over_gap
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


def scene_of(name: str, method: str, contact: str, *more: str, loss: float = 1.0) -> Scene:
    """A bearing whose life ends at so many times the usual loss."""
    file, changes = BEARINGS[name]
    made = load_scene(SCENES / f"{file}.yaml", [*changes, "cage=null"])
    limit = loss * 1e3 * LOSS_PER_DIAMETER * made.bearing.ball_diameter_mm
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


def hours(scene: Scene) -> tuple[float, float, float]:
    """Life [h], CPU time [s] and estimated error [1]; NaN where no criterion was met."""
    started = time.process_time()
    values = life(scene).values
    spent = time.process_time() - started
    known = values["status"] == code.OK
    estimate = np.asarray(values.get("life_error_estimate", [np.nan, np.nan]))[1]
    return (values["life"][1] / HOUR if known else np.nan), spent, float(estimate)


def told(value: float) -> str:
    return "-" if np.isnan(value) else f"{value:.3g}"


def table() -> None:
    """Hertzian and worn lives, balls worn evenly and in bands, films; also of a pair."""
    head = ("bearing", "method", "Hertzian h", "worn h", "worn/Hertzian", "in bands h", "filmed h")
    print("| " + " | ".join((*head, "CPU s")) + " |\n" + "| --- " * 8 + "|")
    rows: dict[str, dict[str, tuple[float, float, float, float]]] = {}
    for name in BEARINGS:
        for method in METHODS:
            hertz, _, _ = hours(scene_of(name, method, "hertz"))
            worn, spent, _ = hours(scene_of(name, method, "worn"))
            bands, _, _ = hours(scene_of(name, method, "worn", "wear.ball_track=bands"))
            films, _, _ = hours(scene_of(name, method, "worn", *filmed(name)))
            rows.setdefault(name, {})[method] = (hertz, worn, bands, films)
            cells = (hertz, worn, worn / hertz, bands, films, spent)
            print(f"| {name} | {method} | " + " | ".join(told(cell) for cell in cells) + " |")
    pair = ("arrangement.external_axial_N=50",)
    rigid = ("arrangement.kind=rigid_pair", *pair)
    spring = ("arrangement.kind=spring_pair", "arrangement.spring_stiffness_N_um=1", *pair)
    for method, kind in zip(METHODS, (spring, rigid), strict=True):
        name = "7008, mu 0.08"
        hertz, _, _ = hours(scene_of(name, method, "hertz", *kind))
        worn, spent, _ = hours(scene_of(name, method, "worn", *kind))
        bands, _, _ = hours(scene_of(name, method, "worn", *kind, "wear.ball_track=bands"))
        cells = (hertz, worn, worn / hertz, bands, np.nan, spent)  # films: refused
        print(f"| {name}, pair, 50 N | {method} | " + " | ".join(map(told, cells)) + " |")
    print(
        "\nConstant force over fixed position:\n\n| bearing | Hertzian | worn | in bands | filmed |"
    )
    print("| --- " * 5 + "|")
    for name, found in rows.items():
        spring_lives, rigid_lives = (found[method] for method in METHODS)
        ratios = [a / b for a, b in zip(spring_lives, rigid_lives, strict=True)]
        print(f"| {name} | " + " | ".join(told(ratio) for ratio in ratios) + " |")


def by_loss() -> None:
    """Hertzian over worn lives against the loss that ends them, and the time of each."""
    print("| bearing | method | loss over A a^2 | Hertzian/worn | worn s | Hertzian s | auto |")
    print("| --- " * 7 + "|")
    for name in ("gyro_s1, mu 0.08", "turbopump"):
        for method in METHODS:
            for loss in (0.01, 0.03, 0.1, 0.3, 1.0):
                worn, slow, _ = hours(scene_of(name, method, "worn", loss=loss))
                hertz, fast, _ = hours(scene_of(name, method, "hertz", loss=loss))
                auto = scene_of(name, method, "auto", loss=loss)
                share = wear_over_gap(auto)
                chosen = "worn" if "groove_depth" in life(auto).values else "Hertzian"
                cells = (share, hertz / worn, slow, fast)
                print(f"| {name} | {method} | " + " | ".join(map(told, cells)) + f" | {chosen} |")


def cost() -> None:
    """Lives by fewer and more cells and steps, over the finest, and CPU time."""
    print("| method | track | cells | step | life/finest - 1 | CPU s |\n" + "| --- " * 6 + "|")
    grid = [((24, 6), STEP), ((32, 8), STEP), (WORN_CELLS, 2.0 * STEP), (WORN_CELLS, STEP)]
    grid += [(WORN_CELLS, 0.5 * STEP), ((64, 14), 0.5 * STEP)]
    for method in METHODS:
        for track in ("spread", "bands"):
            scene = scene_of("gyro_s1, mu 0.08", method, "worn", f"wear.ball_track={track}")
            found = []
            for cells, step in grid:
                started = time.process_time()
                history = WornLife(scene, cells=cells, step=step).march()[0].history
                spent = time.process_time() - started
                found.append((cells, step, history.times[-1][1], spent))
            finest = found[-1][2]
            for cells, step, end, spent in found:
                size = f"{cells[0]} x {cells[1]}"
                print(
                    f"| {method} | {track} | {size} | {step:g} | {end / finest - 1.0:.1e} "
                    f"| {spent:.2f} |"
                )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--loss", action="store_true")
    parser.add_argument("--cost", action="store_true")
    chosen = parser.parse_args()
    (by_loss if chosen.loss else cost if chosen.cost else table)()


if __name__ == "__main__":
    main()
