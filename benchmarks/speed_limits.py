"""Test the model with speed against a maker's rule for the speed of rigidly preloaded pairs.

`python benchmarks/speed_limits.py` puts its table into docs/validation.md and draws
docs/figures/speed_limits.svg (a minute).

NSK (p. 170) allows a rigid pair 0.85, 0.80, 0.65, 0.55 of the speed of one bearing under a light
spring, by class EL, L, M, H, and limits speed by pressure times slip of the balls. So: at which
share of that speed does a rigid pair reach the p v that the spring-loaded bearing has at its limit?
Heat by friction and growth at speed are solved. It is a rule of thumb, no measurement.
"""

import math
import warnings
from collections.abc import Mapping

import numpy as np
from comparison import FIGURES, PAGE, table, with_block

import bearingwear
from bearingwear.plotting.drawing import Figure, frame, key, new_figure, save, start_at_zero
from bearingwear.scene.new.catalogue import MAKERS, CatalogueBearing, entry_of

SIZES = [f"70{code:02d}C" for code in range(2, 22)]
CLASSES, FACTORS = MAKERS["NSK"].classes, MAKERS["NSK"].rigid_speed
FRICTION = 0.08  # assumed, as `new` has it
RING, BALL_RACE = 0.02, 0.037  # W/K over mm of pitch diameter, assumed: ring to its seat, balls
LEAST, MOST, STEPS = 0.02, 2.0, 12  # of the limit, in which a share is looked for, halved so often
COLD = 20.0  # degree C of shaft and housing


PV, HEAT = 0, 1


def severity(
    entry: CatalogueBearing, method: str, preload: float, speed: float
) -> tuple[float, float]:
    """Largest mean pressure times mean slip of a contact [Pa m/s], heat of friction of a ball [W].

    Infinite without a state.
    """
    scene = bearingwear.new(
        designation=entry.designation,
        maker=entry.maker,
        preload=preload,
        preload_method=method,
        speed=speed,
        friction=FRICTION,
    )
    dm = scene.bearing.pitch_diameter_mm
    conductance = {
        "inner_ring_shaft": RING * dm,
        "outer_ring_housing": RING * dm,
        "ball_race": BALL_RACE * dm,
    }
    warm = {"conductance_W_K": conductance, "shaft_C": COLD, "housing_C": COLD}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        # the rings expand freely, because the rule is of a bearing and not of its seats
        found = bearingwear.solve(scene.with_({"thermal": warm, "fits": None}))
    if found.status != "ok":
        return math.inf, math.inf
    slip = found.qv / found.contact_load
    return float((2.0 / 3.0 * found.maximum_pressure * slip).max()), float(
        found.friction_heat.sum()
    )


def share(entry: CatalogueBearing, preload: float, which: int, limit: float) -> float:
    """Share of the limiting speed at which a rigid pair reaches a p v or a heat [1]."""
    low, high = LEAST, MOST
    for _ in range(STEPS):
        middle = math.sqrt(low * high)
        found = severity(entry, "fixed_position", preload, middle * entry.speed_grease)[which]
        low, high = (middle, high) if found < limit else (low, middle)
    return math.sqrt(low * high)


def shares() -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """p v of spring-loaded bearings at their limit (sizes,) [Pa m/s], and shares (sizes, classes).

    The shares are for each bearing's own p v, for the median of all as the one limit, and for each
    bearing's own heat.
    """
    found = [entry_of("NSK", name)[0] for name in SIZES]
    own = np.array([severity(e, "constant_force", e.preloads["EL"], e.speed_grease) for e in found])
    pv, heat = own.T
    limits = {
        "own p v": (PV, pv),
        "common p v": (PV, np.full(len(pv), np.median(pv))),
        "own heat": (HEAT, heat),
    }
    made = {
        name: np.array(
            [
                [share(e, e.preloads[c], which, limit) for c in CLASSES]
                for e, limit in zip(found, each, strict=True)
            ]
        )
        for name, (which, each) in limits.items()
    }
    return pv, made


TITLES = {
    "own p v": "p v of each bearing",
    "common p v": "p v, one limit for all",
    "own heat": "heat of each bearing",
}


def drawn(own: np.ndarray, made: Mapping[str, np.ndarray]) -> Figure:
    figure, panels = new_figure(1, 4, 8.4, 2.9)
    places = np.arange(len(CLASSES))
    for axes, (name, values) in zip(panels[0][:3], made.items(), strict=True):
        for line in values:
            axes.plot(places, line, color="C2", linewidth=0.5, alpha=0.5)
        axes.plot(places, np.median(values, axis=0), color="C2", marker="o")
        axes.plot(places, FACTORS, color="C3", marker="_", markersize=12, linestyle="none")
        axes.set_xticks(places, CLASSES)
        axes.set_xlim(-0.4, len(CLASSES) - 0.6)
        axes.set_ylim(0.0, 1.0)
        axes.set_xlabel("preload class")
        axes.set_title(TITLES[name], loc="left")
    panels[0][0].set_ylabel("speed, rigid pair / sprung bearing")
    last = panels[0][3]
    last.plot([entry_of("NSK", name)[0].bore for name in SIZES], own / 1e6, color="C2", marker="o")
    start_at_zero(last)
    last.set_xlabel("bore (mm)")
    last.set_ylabel("p v at the grease limit (MPa m/s)")
    last.set_title("sprung bearings", loc="left")
    title = "Speed limits of rigid pairs: a limit on p v misses the trend of the catalogue"
    handles = [
        key("each of 20 sizes", color="C2", linewidth=0.5),
        key("median", color="C2", marker="o"),
        key("NSK", color="C3", marker="_", markersize=12, linestyle="none"),
    ]
    frame(figure, title, handles, 3)
    return figure


def main() -> None:
    own, made = shares()
    lines = []
    for k, name in enumerate(CLASSES):
        cells = [f"{FACTORS[k]:.2f}"]
        for values in made.values():
            low, middle, high = np.quantile(values[:, k], (0.0, 0.5, 1.0))
            cells += [f"{middle:.2f}", f"{low:.2f} to {high:.2f}"]
        lines.append((name, *cells))
    heads = ["class", "NSK"]
    for name in made:
        heads += [name, "range"]
    text = table(heads, lines, 1)
    text += (
        f"\n\np v at NSK's speed limit: {own.min() / 1e6:.0f} to {own.max() / 1e6:.0f} MPa m/s, "
        f"median {np.median(own) / 1e6:.0f}."
    )
    print(text)
    PAGE.write_text(with_block(PAGE.read_text("utf-8"), "speed", text), "utf-8")
    save(drawn(own, made), [FIGURES / "speed_limits.svg"])


if __name__ == "__main__":
    main()
