"""Identify the balls and the grooves of catalogue bearings from their printed ratings.

`python benchmarks/identify.py` writes bearingwear/scene/new/catalogue.csv, the table behind
`bearingwear new --maker`, from the printed numbers in benchmarks/catalogue/.

A catalogue prints the static rating C0 = f0 Z D^2 cos(a), often f0, and the dynamic rating C. All
follow from number Z and diameter D of the balls (ISO 76, ISO 281), D is of a standard size and Z
whole. So they can be found again, with no other assumption than a pitch circle half way between
bore and outside diameter.

Where the balls are printed, as GMN does, C0 gives the inner groove: a fifth of the load at which
its contact has 4.2 GPa (ISO 76).
"""

import csv
import functools
import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import plain_scipy as ps
from scipy.optimize import brentq

PRINTED = Path(__file__).parent / "catalogue"
TABLE = Path(__file__).resolve().parents[1] / "bearingwear" / "scene" / "new" / "catalogue.csv"

GROOVE, E_STAR, STATIC_PRESSURE = 0.52, 207e9 / (2.0 * (1.0 - 0.3**2)), 4.2e9  # as ISO 76 has it
RATED = 1.3 * 38.2  # b_m of ISO 281, and f_c of its table within 0.2 %
LARGE, LARGE_FACTOR = 25.4, 3.647  # mm; C goes with D^1.4 above, ISO 281

SCATTER, F0_SCATTER = 0.004, 0.03  # of ratings and f0 beside the rounding of what is printed
CERTAIN, REJECTED = 1.3, 3.0  # largest chi2 of the best balls, least chi2 of any other
NEIGHBOURS = 6  # sizes of a series by which a maker's own rule of rating is known
OWN_SCATTER = 0.006  # of that rule


NSK_GROOVE = 0.5225  # of both races of every bearing; meets the rigidities of makers.py
GMN_OUTER_GROOVE = 0.522  # of every bearing; meets all of GMN's rigidities in the mean


class Rating(NamedTuple):
    """Printed ratings of one bearing of a size."""

    angle: float  # [degree]
    C0: float  # [N]
    C: float  # [N]
    rounding: tuple[float, float]  # last digits of both [N]
    f0: float | None = None


class Balls(NamedTuple):
    """Balls that fit the ratings, best first."""

    Z: np.ndarray
    D: np.ndarray  # [mm]
    chi2: np.ndarray  # mean square of misfits over what rounding and scatter explain

    @property
    def certain(self) -> bool:
        """Whether these fit, and no others do."""
        return bool(self.chi2[0] <= CERTAIN and self.chi2[1] >= REJECTED)


def static_factor(gamma: float, groove: float = GROOVE) -> float:
    """f0 of ISO 76 by its inner ring: a fifth of the load that makes 4.2 GPa, over D^2 [N/mm2].

    gamma is D cos(a) over the pitch diameter, groove the groove radius over the ball diameter D.
    """
    across, along = 2.0 - 1.0 / groove, 2.0 + 2.0 * gamma / (1.0 - gamma)  # over D
    c_a, c_b, *_ = ps.hertz(across * 1e3, along * 1e3, E_STAR)  # of a ball of 1 mm
    return float((STATIC_PRESSURE * math.pi * c_a * c_b / 1.5) ** 3 / 5.0)


def inner_groove(C0: float, Z: int, D: float, dm: float, angle: float) -> float:
    """Groove factor of the inner race by the static rating [N]; lengths in mm, angle in degrees."""
    cosine = math.cos(math.radians(angle))
    gamma, f0 = D * cosine / dm, C0 / (Z * D**2 * cosine)
    return float(brentq(lambda f: static_factor(gamma, f) - f0, 0.501, 0.7, xtol=1e-9))


GAMMA = np.linspace(0.005, 0.45, 300)


@functools.cache
def static_factors() -> np.ndarray:
    return np.array([static_factor(gamma) for gamma in GAMMA])


def dynamic_rating(
    Z: np.ndarray,
    D: np.ndarray,
    dm: float,
    angle: float,
    inner: float = GROOVE,
    outer: float = GROOVE,
) -> np.ndarray:
    """C [N] of balls (n,) by ISO 281 with groove factors; lengths in mm, the angle in degrees."""
    cosine = math.cos(math.radians(angle))
    gamma = D * cosine / dm
    open_inner, open_outer = (2.0 * f / (2.0 * f - 1.0) for f in (inner, outer))
    of_rings = 1.04 * ((1.0 - gamma) / (1.0 + gamma)) ** 1.72 * (open_inner / open_outer) ** 0.41
    f_c = gamma**0.3 * (1.0 - gamma) ** 1.39 / np.cbrt(1.0 + gamma)
    f_c *= open_inner**0.41 * (1.0 + of_rings ** (10.0 / 3.0)) ** -0.3
    size = np.where(D <= LARGE, D**1.8, LARGE_FACTOR * D**1.4)
    return RATED * f_c * cosine**0.7 * np.cbrt(Z) ** 2 * size


def ratings(Z: np.ndarray, D: np.ndarray, dm: float, angle: float) -> tuple[np.ndarray, ...]:
    """C0, C [N] and f0 of balls (n,) on a pitch circle; lengths in mm, the angle in degrees."""
    cosine = math.cos(math.radians(angle))
    gamma = D * cosine / dm
    f0 = np.interp(gamma, GAMMA, static_factors())
    return f0 * Z * D**2 * cosine, dynamic_rating(Z, D, dm, angle), f0


@functools.cache
def standard_sizes() -> np.ndarray:
    """Ball diameters [mm]: 1/64 in, and half millimetres where no inch size is as near as 0.6 %."""
    inch = np.arange(1, 200) * 25.4 / 64.0
    metric = np.arange(2, 160) * 0.5
    apart = np.abs(metric[:, None] / inch - 1.0).min(axis=1) > 0.006
    return np.sort(np.concatenate([inch, metric[apart]]))


def candidates(bore: float, outside: float) -> tuple[np.ndarray, np.ndarray]:
    """Numbers and diameters of balls for which there is room."""
    section, dm, sizes = 0.5 * (outside - bore), 0.5 * (bore + outside), standard_sizes()
    found = []
    for D in sizes[(sizes > 0.35 * section) & (sizes < 0.8 * section)]:
        full = math.pi / math.asin(D / dm)
        found += [(Z, D) for Z in range(math.ceil(0.55 * full), math.floor(0.98 * full) + 1)]
    Z, D = np.array(found).T
    return Z, D


def identified(
    bore: float,
    outside: float,
    printed: Iterable[Rating],
    rule: Sequence[float] = (1.0, 1.0),
    scatter: float = SCATTER,
) -> Balls:
    """Balls of a size by the ratings of all its contact angles.

    Parameters
    ----------
    bore, outside : float
        [mm]
    printed : iterable of Rating
    rule : (float, float)
        C0 and C of the maker over those of the standards.
    scatter : float
        Relative, of the ratings.
    """
    Z, D = candidates(bore, outside)
    squares = []
    for one in printed:
        *made, f0 = ratings(Z, D, 0.5 * (bore + outside), one.angle)
        for value, factor, goal, step in zip(
            made, rule, (one.C0, one.C), one.rounding, strict=True
        ):
            variance = scatter**2 + (step / goal) ** 2 / 12.0
            squares.append((factor * value / goal - 1.0) ** 2 / variance)
        if one.f0 is not None:
            squares.append((f0 - one.f0) ** 2 / (F0_SCATTER**2 + 0.1**2 / 12.0))
    chi2 = np.mean(squares, axis=0)
    order = np.argsort(chi2, kind="stable")
    return Balls(Z[order].astype(int), D[order], chi2[order])


def rows_of(name: str) -> list[dict[str, str]]:
    """Rows of a file of printed numbers."""
    with (PRINTED / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def sizes_of(rows: Iterable[Mapping[str, str]]) -> dict[tuple[str, float, float], list]:
    """Rows of the same series, bore and outside diameter."""
    sizes = defaultdict(list)
    for row in rows:
        series = row["designation"].split()[0] if "C33_N" in row else ""
        sizes[series, float(row["bore_mm"]), float(row["outside_mm"])].append(row)
    return dict(sizes)


def last_digit(text: str) -> float:
    """Step to which a rating is rounded: its last digit, of at most three that count."""
    step = 10.0 ** -len(text.partition(".")[2])
    return max(step, 10.0 ** (math.floor(math.log10(float(text))) - 2))


def nsk_balls() -> dict[str, Balls]:
    """Balls of each NSK bearing by designation, those of one size alike."""
    found = {}
    for (_, bore, outside), rows in sizes_of(rows_of("nsk")).items():
        printed = [
            Rating(
                float(row["angle_deg"]),
                1e3 * float(row["C0r_kN"]),
                1e3 * float(row["Cr_kN"]),
                (1e3 * last_digit(row["C0r_kN"]), 1e3 * last_digit(row["Cr_kN"])),
                float(row["f0"]) if row["f0"] else None,
            )
            for row in rows
        ]
        balls = identified(bore, outside, printed)
        found |= dict.fromkeys((row["designation"] for row in rows), balls)
    return found


class Known(NamedTuple):
    """A size of SNFA: balls as printed, and as its ratings say them."""

    designation: str
    Z: int
    D: float  # [mm]
    found: Balls

    @property
    def right(self) -> bool:
        return self.Z == self.found.Z[0] and abs(self.found.D[0] - self.D) < 0.02


def snfa_found_again() -> list[Known]:
    """Each size of SNFA identified from its ratings, as if its balls were not printed.

    SNFA rates by rules of its own; how they compare with the standards is taken from the nearest
    sizes of the series, never from the size itself.
    """
    series = defaultdict(list)
    for (name, bore, outside), rows in sizes_of(rows_of("snfa")).items():
        Z, D = int(rows[0]["balls_Z"]), float(rows[0]["ball_mm"])
        nominal = standard_sizes()[np.argmin(np.abs(standard_sizes() - D))]
        printed = [
            Rating(
                float(row["angle_deg"]),
                float(row["C0_N"]),
                float(row["C33_N"]),
                tuple(max(10.0, 0.5 * last_digit(row[name])) for name in ("C0_N", "C33_N")),
            )
            for row in rows
        ]
        over = []
        for one in printed:
            C0, C, _ = ratings(
                np.array([Z]), np.array([nominal]), 0.5 * (bore + outside), one.angle
            )
            over.append((one.C0 / C0[0], one.C / C[0]))
        series[name].append(
            (bore, outside, rows[0]["designation"], Z, D, printed, np.mean(over, 0))
        )
    known = []
    for sizes in series.values():
        sizes.sort(key=lambda size: size[0])
        for k, (bore, outside, designation, Z, D, printed, _) in enumerate(sizes):
            near = range(max(0, k - NEIGHBOURS // 2), min(len(sizes), k + NEIGHBOURS // 2 + 1))
            rule = np.median([sizes[j][-1] for j in near if j != k], axis=0)
            balls = identified(bore, outside, printed, rule, OWN_SCATTER)
            known.append(Known(designation, Z, D, balls))
    return known


class Rated(NamedTuple):
    """A bearing of GMN: its inner groove by C0, and C by ISO 281 with that over the printed one."""

    designation: str
    groove: float
    dynamic: float


def gmn_rated() -> list[Rated]:
    """Every bearing of GMN whose print is clear."""
    found = []
    for row in rows_of("gmn"):
        if row["certain"] != "yes":
            continue
        C0, C, D, dm, angle = (
            float(row[name]) for name in ("C0_N", "C_N", "ball_mm", "pitch_mm", "angle_deg")
        )
        Z = int(row["balls"])
        groove = inner_groove(C0, Z, D, dm, angle)
        own = dynamic_rating(np.array(Z), np.array(D), dm, angle, groove, GMN_OUTER_GROOVE)
        found.append(Rated(row["designation"], groove, float(own) / C))
    return found


def table() -> list[list[str]]:
    """Rows of the package's table, its heads first."""
    heads = "maker designation angle_deg bore_mm outside_mm width_mm balls ball_mm source"
    grooves = ["pitch_mm", "inner_groove", "outer_groove"]
    speeds = ["speed_grease_rpm", "speed_oil_rpm", "min_spring_preload_N"]
    made = [[*heads.split(), *grooves, "preload_N", *speeds]]
    size = "designation", "angle_deg", "bore_mm", "outside_mm", "width_mm"
    found = nsk_balls()
    for row in rows_of("nsk"):
        balls = found[row["designation"]]
        source = "identified" if balls.certain else "uncertain"
        preloads = [row[f"preload_{name}_N"] for name in ("EL", "L", "M", "H")]
        made.append(
            ["NSK", *(row[name] for name in size), str(balls.Z[0]), f"{balls.D[0]:.6g}", source,
             "", *(2 * [str(NSK_GROOVE)]), "/".join(preloads) if any(preloads) else "",
             row["speed_grease_rpm"], row["speed_oil_rpm"], ""]
        )  # fmt: skip
    for row in rows_of("snfa"):
        preloads = [row[f"preload_{name}_N"] for name in ("L", "M", "F")]
        # printed for oil and 15 degrees; factors of pp. 18 and 67: grease 0.65, 25 degrees 0.9
        oil = float(row["speed_spring_rpm"]) * (0.9 if row["angle_deg"] == "25" else 1.0)
        made.append(
            ["SNFA", *(row[name] for name in size), row["balls_Z"], row["ball_mm"], "printed",
             "", "", "", "/".join(preloads) if any(preloads) else "", f"{0.65 * oil:.3g}",
             f"{oil:.6g}", ""]
        )  # fmt: skip
    for row in rows_of("gmn"):
        C0, D, dm, angle = (
            float(row[name]) for name in ("C0_N", "ball_mm", "pitch_mm", "angle_deg")
        )
        groove = inner_groove(C0, int(row["balls"]), D, dm, angle)
        made.append(
            ["GMN", row["designation"].removesuffix(" TA"), *(row[name] for name in size[1:]),
             row["balls"], row["ball_mm"], "printed" if row["certain"] == "yes" else "unclear",
             row["pitch_mm"], f"{groove:.4f}", str(GMN_OUTER_GROOVE),
             "/".join(row[f"preload_{name}_N"] for name in ("L", "M", "S")),
             row["speed_grease_rpm"], row["speed_oil_rpm"], row["min_spring_preload_N"]]
        )  # fmt: skip
    return made


def main() -> None:
    made = table()
    with TABLE.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(made)
    found = nsk_balls()
    certain = sum(balls.certain for balls in found.values())
    worst = max(balls.chi2[0] for balls in found.values() if balls.certain)
    print(f"{TABLE}: {len(made) - 1} bearings written")
    print(f"NSK: {len(found)} bearings, {certain} certain, chi2 of these at most {worst:.2f}")
    for name, balls in found.items():
        if not balls.certain:
            pairs = zip(balls.Z[:2], balls.D[:2], balls.chi2[:2], strict=True)
            words = "; ".join(f"{Z} x {D:.4g} mm, chi2 {chi2:.2f}" for Z, D, chi2 in pairs)
            print(f"  uncertain: {name}: {words}")
    known = snfa_found_again()
    sure = [one for one in known if one.found.certain]
    right = sum(one.right for one in known)
    print(f"SNFA: {right} of {len(known)} sizes found again")
    print(f"  of {len(sure)} that would be called certain {sum(one.right for one in sure)}")
    for series in ("S", "SM", "KH"):
        rated = [one for one in gmn_rated() if one.designation.split()[0] == series]
        off = 100.0 * np.array([one.dynamic - 1.0 for one in rated])
        middle = np.median([one.groove for one in rated])
        print(f"GMN {series}: inner groove {middle:.4f}, C by ISO 281 {off.mean():+.1f} % "
              f"(scatter {off.std():.1f} %)")  # fmt: skip


if __name__ == "__main__":
    main()
