"""Measurements that are bounds alone: skidding, forces on a cage, lives of starved bearings.

`python benchmarks/bounds.py` (two minutes of CPU) puts its rows into docs/validation.md. Their
papers were not read beyond what is quoted there, so the bearings are guessed where it says so.
"""

import textwrap
import warnings

import numpy as np
from comparison import PAGE, table, with_block

import bearingwear

SKID_BOUND = 0.06  # at 25 000 r/min, bore 120 mm
POCKET_BOUND, LAND_BOUND = 25.0, 20.0  # N, at up to 12 000 r/min, bore 110 mm

SKIDDING = {
    "bore": 120.0,
    "outside": 190.0,
    "balls": 15,
    "ball_diameter": 20.6375,
    "pitch_diameter": 155.0,
    "contact_angle": 24.0,
    "preload": 22240.0,
    "speed": 25000.0,
    "preload_method": "constant_force",
}  # recalled, not read
FRICTIONS, DRAGS = (0.02, 0.05, 0.08), (0.0, 20.0, 100.0)

CAGED = {
    "designation": "7222C",
    "maker": "NSK",
    "preload": 4450.0,
    "speed": 12000.0,
    "preload_method": "constant_force",
}  # a bearing of that bore; its kind and load are not known


STARVED = {
    "bore": 6.35,
    "outside": 15.875,
    "balls": 8,
    "ball_diameter": 2.38125,
    "preload": 28.9,
    "speed": 3000.0,
    "preload_method": "constant_force",
}  # an R4; its balls are of 3/32 in
STARVED_GROOVES = {"bearing.inner_groove_factor": 0.52, "bearing.outer_groove_factor": 0.53}
"""Groove factors that give nearly the reported pressure."""
STARVED_LIVES = {"bearing_steel": 2e9, "silicon_nitride": 5.3e9}
"""Revolutions of R4 bearings by the material of their balls that did not end by wear of the races:
of 32 motors with steel balls, 4 had failed and 3 are named that reached 2.2e9; two with ceramic
balls ran 5.3e9. NESC, 45th Aerospace Mechanisms Symposium (2020), pp. 277-286."""
STARVED_PRESSURE = 855.0  # MPa, mean; theirs


def solved(scene):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = bearingwear.solve(scene)
    if found.status != "ok":
        raise RuntimeError(found.attrs["message"])
    return found


def skid_lines() -> list[tuple[str, ...]]:
    """Skid ratio over friction and drag."""
    scene = bearingwear.new(**SKIDDING).with_(
        {"bearing.inner_groove_factor": 0.54, "bearing.outer_groove_factor": 0.52}
    )
    lines = []
    for drag in DRAGS:
        cells = [f"skidding, drag {drag:g} kg/m³, friction {', '.join(map(str, FRICTIONS))}"]
        found = [
            float(
                solved(
                    scene.with_({"friction.ball_race": mu, "lubricant.drag_density_kg_m3": drag})
                ).skid_ratio
            )
            for mu in FRICTIONS
        ]
        cells += [f"at most {100 * SKID_BOUND:g} %"]
        cells += [", ".join(f"{100 * one:.2g}" for one in found) + " %"]
        lines.append(tuple(cells))
    return lines


def cage_lines() -> list[tuple[str, ...]]:
    """Forces of pockets and land while the cage turns, peaks and what 99 % of instants keep."""
    scene = bearingwear.new(**CAGED).with_(
        {"model.cage_results": True, "cage.guiding_race": "inner",
         "cage.inner_diameter_mm": 145.0, "cage.outer_diameter_mm": 165.0}
    )  # fmt: skip
    found = solved(scene)
    lines = []
    for name, what, bound in (
        ("pocket", "a ball", POCKET_BOUND),
        ("land", "the land", LAND_BOUND),
    ):
        force = found[f"history_{name}_force"].values
        peak, most = np.nanmax(force), np.nanquantile(force, 0.99)
        lines.append(
            (f"force exerted on the cage by {what}", f"at most {bound:g} N",
             f"peak {peak:.0f} N, 99th percentile {most:.2g} N")
        )  # fmt: skip
    return lines


def starved_scene(ball_material: str):
    return bearingwear.new(**STARVED, ball_material=ball_material).with_(STARVED_GROOVES)


def starved_bound(ball_material: str) -> float:
    """Largest K_s/H [m2/N] of the races at which wear would not have ended the life first.

    Lives go with 1/K_s: so the bound is that of the scene times its own life over the tested one.
    """
    scene = starved_scene(ball_material)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        hours = float(bearingwear.life(scene).life.min())  # with the wear of balls and races
    steel = scene.materials["bearing_steel"]
    factor = steel.wear_coefficient / (1e9 * steel.brinell_hardness_GPa)
    return factor * 60.0 * scene.operation.shaft_speed_rpm * hours / STARVED_LIVES[ball_material]


def starved_sentence() -> str:
    """The bounds, and how near the guessed bearing is to theirs."""
    pressure = 2e-6 / 3.0 * float(solved(starved_scene("bearing_steel")).maximum_pressure.max())
    loss = starved_scene("bearing_steel").wear.end_of_life.ball_diameter_loss_um
    steel, hybrid = (starved_bound(name) for name in STARVED_LIVES)
    return textwrap.fill(
        f"If a ball diameter loss of {loss:.2g} um had ended the lives, K_s/H would be at most "
        f"{steel:.2g} m2/N with steel balls and {hybrid:.2g} m2/N with ceramic balls. The computed "
        f"mean pressure of the assumed bearing is {pressure:.0f} MPa (groove factors 0.52 and "
        f"0.53), and the reported one is {STARVED_PRESSURE:g} MPa.",
        100,
        break_on_hyphens=False,
    )


def main() -> None:
    text = table(("quantity", "measured", "computed"), [*skid_lines(), *cage_lines()], 3)
    print(text)
    page = with_block(PAGE.read_text("utf-8"), "bounds", text)
    PAGE.write_text(with_block(page, "starved", starved_sentence()), "utf-8")


if __name__ == "__main__":
    main()
