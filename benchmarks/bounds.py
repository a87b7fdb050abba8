"""Two measurements of which little is public, as bounds: skidding, and forces on a cage.

`python benchmarks/bounds.py` (two minutes of CPU) puts its rows into docs/validation.md. Their
papers were not read beyond what is quoted there, so the bearings are guessed where it says so.
"""

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


def main() -> None:
    text = table(("quantity", "measured", "computed"), [*skid_lines(), *cage_lines()], 3)
    print(text)
    PAGE.write_text(with_block(PAGE.read_text("utf-8"), "bounds", text), "utf-8")


if __name__ == "__main__":
    main()
