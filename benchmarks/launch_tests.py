"""Peak pressures measured at launch, over computed ones: a section of docs/launch.md, its figure.

    python benchmarks/launch_tests.py docs

ESA, Proceedings of the 44th Aerospace Mechanisms Symposium (2018) 83: cartridges of two preloaded
bearings under random vibration. The size of the bearings, the spectra and the damping of the hard
pair are not given; those of `scene_of` are assumed. The pressures follow from measured
accelerations by their authors' model.
"""

from __future__ import annotations

import sys
import textwrap
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import bearingwear
from bearingwear.plotting.drawing import new_figure, save
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.launch import LaunchResult, launch_result

LEVELS = np.array([1.1, 1.6, 2.2, 4.5, 6.3, 8.9])  # of the random vibration [g rms]
BAND_HZ = 1980.0  # of a flat spectrum from 20 to 2000 Hz, assumed
TRIED = ("7000C", "7001C", "7002C", "7003C", "7004C", "7005C")  # of NSK
BEARING, MASS_KG, SPAN_MM = "7001C", 1.25, 40.0  # assumed
BEGIN, END = "<!-- launch tests: python benchmarks/launch_tests.py docs -->", "<!-- end -->"


@dataclass(frozen=True, kw_only=True)
class Cart:
    """A cartridge of two bearings on a shaker, and peak pressures at each of `LEVELS`."""

    name: str
    preload_N: float
    spring_N_um: float  # 0 of a rigid pair
    amplification: float  # of the soft pairs 3.5 to 6 as measured; assumed for the hard one
    three_sigma: tuple[float, ...]  # by Miles' equation, as its authors computed it [MPa]
    measured: tuple[float, ...]  # the largest [MPa]

    @property
    def load_ratios(self) -> np.ndarray:
        """Measured loads over those of three sigma: pressure goes as load^(1/3)."""
        return (np.array(self.measured) / self.three_sigma) ** 3


CARTS = (
    Cart(name="soft, 20 N, 250 N/mm", preload_N=20.0, spring_N_um=0.25, amplification=5.0,
         three_sigma=(940, 1120, 1188, 1569, 1693, 1830),
         measured=(1382, 1486, 1772, 2240, 2478, 2595)),
    Cart(name="soft, 20 N, 900 N/mm", preload_N=20.0, spring_N_um=0.9, amplification=5.0,
         three_sigma=(975, 1102, 1299, 1386, 1605, 1739),
         measured=(1534, 1661, 1902, 2049, 2171, 2563)),
    Cart(name="hard, 160 N", preload_N=160.0, spring_N_um=0.0, amplification=10.0,
         three_sigma=(1300, 1483, 1651, 2104, 2308, 2543),
         measured=(1541, 1762, 1949, 2457, 2613, 2899)),
)  # fmt: skip


def scene_of(cart: Cart, level: float, duration_s: float, bearing: str = BEARING) -> Scene:
    """A cartridge on a bearing of that kind, at a level of random vibration [g rms]."""
    method = "constant_force" if cart.spring_N_um else "fixed_position"
    arrangement = {"kind": "spring_pair" if cart.spring_N_um else "rigid_pair",
                   "rotor_mass_kg": MASS_KG, "span_mm": SPAN_MM}  # fmt: skip
    if cart.spring_N_um:
        arrangement["spring_stiffness_N_um"] = cart.spring_N_um
    scene = bearingwear.new(designation=bearing, maker="NSK", preload=cart.preload_N, speed=1000,
        preload_method=method)  # fmt: skip
    density = level**2 / BAND_HZ
    launch = {"axial_density_g2_Hz": density, "duration_s": duration_s,
              "amplification": cart.amplification}  # fmt: skip
    return scene.with_({"arrangement": arrangement, "launch": launch})


def responses(cart: Cart, duration_s: float, bearing: str = BEARING) -> list[LaunchResult]:
    return [launch_result(scene_of(cart, level, duration_s, bearing)) for level in LEVELS]


def pressures(cart: Cart, duration_s: float, bearing: str = BEARING) -> np.ndarray:
    """Computed peak pressures [MPa]."""
    found = responses(cart, duration_s, bearing)
    return np.array([1e-6 * one.pressure_share * one.pressure for one in found])


def pressure_ratios(cart: Cart, duration_s: float) -> np.ndarray:
    """Measured over computed peak pressures."""
    return np.array(cart.measured) / pressures(cart, duration_s)


def ratios_of_tried() -> dict[str, float]:
    """Computed over the authors' pressures of the hard pair at three sigma, for each bearing."""
    hard = CARTS[-1]
    return {
        name: float(np.exp(np.mean(np.log(pressures(hard, 0.0, name) / hard.three_sigma))))
        for name in TRIED
    }


def section() -> str:
    """What docs/launch.md says of the tests."""
    factors = [one.random["axial"].expected for cart in CARTS for one in responses(cart, 120.0)]
    lines = []
    for cart in CARTS:
        sigma, largest = (pressure_ratios(cart, duration) for duration in (0.0, 120.0))
        loads = cart.load_ratios
        text = (
            f"**{cart.name}**: the measured pressures are {_span(sigma)} times those computed at "
            f"three sigma and {_span(largest)} times those at the largest acceleration expected. "
            f"Over their authors' own three sigma, the loads are {_span(loads)} times."
        )
        lines.append(textwrap.fill(text, 100, initial_indent="- ", subsequent_indent="  "))
    soft = CARTS[:-1]
    own = [pressures(cart, 0.0) / cart.three_sigma for cart in soft]
    resonances = [one.frequencies[0] for cart in soft for one in responses(cart, 0.0)[:1]]
    tried = ratios_of_tried()
    others = ", ".join(f"{ratio:.2f} ({name})" for name, ratio in tried.items() if name != BEARING)
    named = (
        "The paper does not give the size of the bearing. Of NSK's small bearings, the "
        f"{BEARING} was taken, because its pressures of the hard pair at three sigma are nearest "
        f"to those that the authors computed: {tried[BEARING]:.2f} times on the mean, those of "
        f"others {others}. So the height of the ratios is fitted in part. Spectrum, duration and "
        "the amplification of the hard pair are missing, too; assumed are a flat spectrum from 20 "
        f"to 2000 Hz and an amplification of {CARTS[-1].amplification:g}. The largest acceleration "
        f"expected is then {_span(factors)} sigma. So the ratios of the hard pair are an order of "
        "magnitude, and only their course is a test: it rises with the level while the pair stays "
        "loaded."
    )
    soft_pairs = (
        f"The soft pairs have the mass of the tests ({MASS_KG:g} kg) and an amplification of "
        f"{soft[0].amplification:g}; 3.5 to 6 were measured. Their computed resonances of "
        f"{resonances[0]:.0f} and {resonances[1]:.0f} Hz lie near the upper end of the measured "
        "range of 260 to 420 Hz, which low levels reach, and the pressures at three sigma are "
        f"{_span(own)} times those of the authors. Both gap at every level."
    )
    paragraphs = (textwrap.fill(text, 100) for text in (named, soft_pairs))
    return "\n".join([*lines, "", "\n\n".join(paragraphs)])


def _span(values: object) -> str:
    found = np.array(values)
    return f"{found.min():.2f} to {found.max():.2f}"


def _draw() -> None:
    figure, ((left, right),) = new_figure(1, 2, 7.2, 3.0)
    for axes, duration, title in ((left, 0.0, "three sigma"), (right, 120.0, "largest expected")):
        axes.axhline(1.0, color="0.6", linewidth=0.8)
        for k, cart in enumerate(CARTS):
            axes.plot(LEVELS, pressure_ratios(cart, duration), "o-", color=f"C{k}", label=cart.name)
        axes.set_title(title)
        axes.set_xlabel("random vibration (g rms)")
        axes.set_ylim(0.8, 1.5)
    left.set_ylabel("measured over computed pressure")
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    save(figure, ["docs/figures/launch_tests.svg"])


if __name__ == "__main__":
    page = Path(sys.argv[1], "launch.md")
    before, rest = page.read_text(encoding="utf-8").split(BEGIN)
    _, after = rest.split(END)
    page.write_text(f"{before}{BEGIN}\n\n{section()}\n\n{END}{after}", encoding="utf-8")
    _draw()
