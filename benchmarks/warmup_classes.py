"""How far the preload and the pressure of rigid pairs rise above their steady values on the way.

`python benchmarks/warmup_classes.py docs/warmup.md` puts its table between the markers of that
page (ten seconds). Beside it stand the shares of the speed of a spring-loaded bearing that NSK
(p. 170) allows rigid pairs: the larger the preload, the smaller the share.

Each pair runs at its share of the maker's speed limit with grease. Conductances are those of
`benchmarks/speed_limits.py`; the housing warms to 35 degree C in ten minutes.
"""

from __future__ import annotations

import argparse
import warnings
from pathlib import Path

from comparison import table, with_block
from speed_limits import BALL_RACE, FACTORS, RING

import bearingwear
from bearingwear.scene.new.catalogue import MAKERS, entry_of

DESIGNATION, CLASSES = "7008C", ("L", "M", "H")  # light, medium, heavy
SHARES = dict(zip(MAKERS["NSK"].classes, FACTORS, strict=True))
QUANTITIES = ("residual_preload", "maximum_pressure")
HEADS = (
    "class", "share", "r/min", "set, N", "peak, N", "steady", "above", "peak, MPa",
    "steady", "at, s",
)  # fmt: skip
RAMP = 10.0  # s
HOUSING = {"housing_C": 35.0, "housing_time_constant_s": 600.0}


def warm_pair(name: str) -> bearingwear.Scene:
    """A rigid pair of one preload class at the speed that the maker allows it."""
    entry, _ = entry_of("NSK", DESIGNATION)
    scene = bearingwear.new(
        designation=DESIGNATION,
        maker="NSK",
        preload_class=name,
        preload_method="fixed_position",
        speed=SHARES[name] * entry.speed_grease,
    )
    dm = scene.bearing.pitch_diameter_mm
    conductance = {
        "inner_ring_shaft": RING * dm,
        "outer_ring_housing": RING * dm,
        "ball_race": BALL_RACE * dm,
    }
    capacity = {"inner_ring": 38.0, "balls": 16.0, "outer_ring": 45.0}
    network = {"conductance_W_K": conductance, "heat_capacity_J_K": capacity} | HOUSING
    return scene.with_({"thermal": network})


def row(name: str) -> list[str]:
    """Cells of one preload class."""
    scene = warm_pair(name)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        warmed = bearingwear.warmup(scene, RAMP)
    peaks = [float(warmed[f"peak_{quantity}"]) for quantity in QUANTITIES]
    ends = [float(warmed[f"end_{quantity}"]) for quantity in QUANTITIES]
    (preload, pressure), (last_preload, last_pressure) = peaks, ends
    return [
        name,
        f"{SHARES[name]:.2f}",
        f"{scene.operation.shaft_speed_rpm:.0f}",
        f"{scene.operation.preload_N:.0f}",
        f"{preload:.0f}",
        f"{last_preload:.0f}",
        f"{preload / last_preload - 1.0:+.0%}",
        f"{1e-6 * pressure:.0f}",
        f"{1e-6 * last_pressure:.0f}",
        f"{float(warmed['peak_residual_preload_time']):.0f}",
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("page", type=Path, help="the page with the table")
    page = parser.parse_args().page
    text = table(HEADS, [row(name) for name in CLASSES], 1)
    print(text)
    page.write_text(with_block(page.read_text("utf-8"), "classes", text), "utf-8")


if __name__ == "__main__":
    main()
