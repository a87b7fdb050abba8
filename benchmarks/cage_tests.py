"""A cage's wear against tests of lead films on retainers: `python benchmarks/cage_tests.py FOLDER`.

NASA's bearings of 40 mm bore ran at 30 000 r/min under 1780 N in liquid hydrogen; 50 um of lead on
the retainer lasted 15 h, other films 2 to 6 h (docs/film_tests.md). No K_s/H of lead is known, so
what is computed is the work of a revolution, the K_s/H that the test then stands for, and ratios of
lives, which depend on no K_s/H. Bearing and cage are assumed: a 7208C with a guided cage of `new`.
Draws docs/figures/cage_tests.svg. Ensembles of the folder are not repeated. Five minutes of CPU
time.
"""

import sys
from pathlib import Path

import numpy as np

import bearingwear
from bearingwear.plotting.drawing import key, new_figure, save

SPEED, HOURS, LEAD = 30_000.0, 15.0, 50e-6
TURNS, ESA = HOURS * 60.0 * SPEED, 4e-15  # K_s/H of ESA's example of a cage [m2/N]
OTHERS, ALLOYS = (2.0, 6.0), (22.5, 19.3)  # h
LOADS = (890.0, 1780.0, 3560.0)
TESTED = LOADS.index(1780.0)
RUNS = {"runs": 20, "within": 0.2, "workers": 2}
PARTS = {"pocket": ("C4", "o"), "land": ("C2", "s")}
TESTED_FILM = {"color": "C3", "marker": "D", "markersize": 8, "markerfacecolor": "none"}


def bearing(load: float) -> bearingwear.Scene:
    scene = bearingwear.new(
        designation="7208C", speed=SPEED, preload=load, preload_method="constant_force"
    )
    return scene.with_({"uncertainty": None, "operation.gravity_m_s2": [0.0, 0.0, -9.81]})


def works(folder: Path) -> dict[str, np.ndarray]:
    """Work of a revolution in each part by the load: the mean and its interval (loads, 3) [J]."""
    found: dict[str, list] = {part: [] for part in PARTS}
    for load in LOADS:
        ensemble = bearingwear.cage(bearing(load), **RUNS, path=folder / f"load_{load:g}.nc")
        share = ensemble["share"].to_series()
        print(f"{load:g} N: {', '.join(f'{k} {100 * v:.0f} %' for k, v in share.items() if v)}")
        for part in PARTS:
            all_runs = ensemble.sel(group="all")
            ends = all_runs[f"mean_{part}_work_interval"].values
            found[part].append([float(all_runs[f"mean_{part}_work"]), *ends])
            mean, low, high = (f"{1e3 * one:.3g}" for one in found[part][-1])
            print(f"  {part}: {mean} mJ a revolution ({low} to {high})")
    return {part: np.array(one) for part, one in found.items()}


def lives(folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Depths worn off pockets and land (n, 2) [m], and when, over the life of the first film."""
    film = {"thickness_um": 1e6 * LEAD, "wear_coefficient": 1e8 * ESA, "brinell_hardness_GPa": 0.1}
    scene = bearing(LOADS[TESTED]).with_({"cage.film": film})
    found = bearingwear.cage(scene, life=True, **RUNS, path=folder / "life.nc")
    turns = found["node_turns"].values
    print(f"a film of 50 um: {found.attrs['cage_ended_by']}; ensembles at wear of pockets and land")
    for depths, turn in zip(found["node_depth"].values, turns, strict=True):
        print(
            f"  {1e6 * depths[0]:.3g}, {1e6 * depths[1]:.3g} um: {turn / turns[-1]:.3g} of the life"
        )
    ends = ", ".join(f"{ESA * end / TURNS:.2g}" for end in found["cage_life_interval"].values)
    print(f"50 um in {HOURS:g} h is K_s/H {ESA * turns[-1] / TURNS:.2g} m2/N ({ends}); ESA: {ESA}")
    return found["node_depth"].values, turns / turns[-1]


def draw(work: dict[str, np.ndarray], depth: np.ndarray, life: np.ndarray) -> None:
    figure, ((left, right),) = new_figure(1, 2, 7.2, 3.2)
    first = int(np.argmax(depth[-1]))
    left.plot(1e6 * depth[1:, first], life[1:], "s-", color="C2", markersize=3.5, fillstyle="none")
    left.plot(1e6 * LEAD * np.array([0.1, 1.0]), [0.1, 1.0], ":", color="black")
    left.plot(1e6 * LEAD, 1.0, **TESTED_FILM)
    left.set_xlabel("thickness of the film (µm)")
    left.set_ylabel("life over that of 50 µm at 1780 N")
    for k, (part, (colour, marker)) in enumerate(PARTS.items()):
        mean, low, high = work[part][TESTED, 0] / work[part].T
        at = np.array(LOADS) * (0.94 + 0.12 * k)
        right.errorbar(at, mean, [mean - high, low - mean], fmt=marker, color=colour, capsize=2)
    right.plot(LOADS[TESTED], 1.0, **TESTED_FILM)
    right.plot([LOADS[TESTED]] * 2, np.array(ALLOYS) / HOURS, "_", color="C3", markersize=10)
    right.set_xlabel("load (N)")
    right.set_xscale("log")
    right.set_xticks(LOADS, [f"{load:g}" for load in LOADS])
    for panel in (left, right):
        panel.axhspan(*np.array(OTHERS) / HOURS, color="C3", alpha=0.2, linewidth=0)
        panel.set_yscale("log")
        panel.set_ylim(0.08, 3.0)
        panel.set_yticks((0.1, 0.2, 0.5, 1, 2), ("0.1", "0.2", "0.5", "1", "2"))
        panel.minorticks_off()
    left.set_xscale("log")
    left.set_xticks((5, 10, 20, 50), ("5", "10", "20", "50"))
    left.minorticks_off()
    handles = [
        *(
            key(f"model, film {words}", color=PARTS[part][0], marker=PARTS[part][1])
            for part, words in (("pocket", "of the pockets"), ("land", "at the land"))
        ),
        key("proportional", color="black", linestyle=":"),
        key("test: 50 µm lasted 15 h", linestyle="none", **TESTED_FILM),
        key("tests: 2 to 6 h, thickness unknown", color="C3", linewidth=6, alpha=0.2),
        key("tests of alloys, 22.5 and 19.3 h", color="C3", linestyle="none", marker="_"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=2)
    figure.suptitle("Lead on a retainer: life by thickness and load, over that of 50 µm")
    save(figure, ["docs/figures/cage_tests.svg"])


def main() -> None:
    """Work by the load, what the test says of K_s/H, lives by the thickness, and the figure."""
    folder = Path(sys.argv[1])
    folder.mkdir(exist_ok=True)
    work, (depth, life) = works(folder), lives(folder)
    thick = 1e6 * np.interp(np.array(OTHERS) / HOURS, life, depth.max(axis=1))
    print(f"2 to 6 h at the same K_s/H: {thick[0]:.2g} to {thick[1]:.2g} um of film")
    draw(work, depth, life)


if __name__ == "__main__":
    main()
