"""Check the 269 rows of GMN's catalogue: against its text, and each against the others.

    python benchmarks/gmn_rows.py [TEXT.md]

TEXT.md is the text of the catalogue as benchmarks/catalogue/README.md names it; every number of
every row is compared with it. Without it, rows are checked by rules that the maker keeps, and the
table says how many wrong digits such checks would find (a minute).
"""

import functools
import math
import re
import sys
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from identify import GMN_OUTER_GROOVE, dynamic_rating, inner_groove, ratings, rows_of

BEFORE = ("bore_mm", "outside_mm", "width_mm", "pitch_mm", "ball_mm", "balls")
CLASSES = ("L", "M", "S")
AFTER = (
    "mass_kg", "angle_deg", "C_N", "C0_N", "C0_ceramic_N", "speed_oil_rpm", "speed_grease_rpm",
    *(f"{what}" for c in CLASSES for what in (f"preload_{c}_N", f"rigidity_{c}_N_um")),
    "min_spring_preload_N",
)  # fmt: skip
"""Columns in the order of the text; between them are the abutment dimensions."""

COLUMNS = (*BEFORE, *AFTER)
Numbers = dict[str, float]


def numbers() -> dict[str, Numbers]:
    """Every row by its designation."""
    return {
        row["designation"]: {name: float(row[name]) for name in COLUMNS} for row in rows_of("gmn")
    }


def units() -> dict[str, Numbers]:
    """Half a unit of the last printed digit of every number; trailing zeros may be rounded."""
    found = {}
    for row in rows_of("gmn"):
        found[row["designation"]] = {name: 0.5 * _last_digit(row[name]) for name in COLUMNS}
    return found


def _last_digit(text: str) -> float:
    _, point, decimals = text.partition(".")
    if point:
        return 10.0 ** -len(decimals)
    return 10.0 ** (len(text) - len(text.rstrip("0")))


def rows_of_text(text: str) -> dict[str, list[list[float]]]:
    """Numbers that stand between a designation and its repetition at the other end of a row."""
    known = {row["designation"] for row in rows_of("gmn")}
    lines = text.splitlines()
    places = [
        (k, name) for k, line in enumerate(lines) if (name := " ".join(line.split())) in known
    ]
    found: dict[str, list[list[float]]] = defaultdict(list)
    for (k, name), (end, other) in zip(places, places[1:], strict=False):
        if name == other:
            row = re.findall(r"\d+(?:\.\d+)?", " ".join(lines[k + 1 : end]))
            found[name].append([float(number) for number in row])
    return found


def differences_from_text(text: str) -> list[str]:
    """The rows whose numbers are not those of the text."""
    found = rows_of_text(text)
    wrong = []
    for name, row in numbers().items():
        before, after = ([row[column] for column in some] for some in (BEFORE, AFTER))
        if not any(one[: len(before)] == before and one[-len(after) :] == after
                   for one in found.get(name, [])):  # fmt: skip
            wrong.append(name)
    return wrong


def _series(name: str) -> str:
    return name.split()[0]


def _static(row: Numbers) -> float:
    """C0 of the balls by ISO 76, grooves of 0.52."""
    Z, D = np.array([row["balls"]]), np.array([row["ball_mm"]])
    return float(ratings(Z, D, row["pitch_mm"], row["angle_deg"])[0][0])


@functools.cache
def _dynamic(C0: float, Z: float, D: float, dm: float, angle: float) -> float:
    """C by ISO 281 with the inner groove that C0 gives; NaN where there is none."""
    try:
        groove = inner_groove(C0, int(Z), D, dm, angle)
    except (ValueError, ZeroDivisionError, OverflowError):
        return math.nan
    return float(dynamic_rating(np.array(Z), np.array(D), dm, angle, groove, GMN_OUTER_GROOVE))


def _dynamic_ratio(row: Numbers) -> float:
    inside = (row[name] for name in ("C0_N", "balls", "ball_mm", "pitch_mm", "angle_deg"))
    return row["C_N"] / _dynamic(*inside)


def _palmgren(row: Numbers, name: str) -> float:
    """Rigidity over that of Palmgren's formula, which goes with F^(1/3)."""
    sine = math.sin(math.radians(row["angle_deg"]))
    size = row["balls"] ** (2.0 / 3.0) * row["ball_mm"] ** (1.0 / 3.0) * sine ** (5.0 / 3.0)
    return row[f"rigidity_{name}_N_um"] / (size * row[f"preload_{name}_N"] ** (1.0 / 3.0))


def _steel(row: Numbers) -> float:
    """Volume of a solid ring of the size [mm3]."""
    return 0.25 * math.pi * row["width_mm"] * (row["outside_mm"] ** 2 - row["bore_mm"] ** 2)


RATIOS: dict[str, tuple[Callable[[Numbers], float], float, tuple[str, ...]]] = {
    "pitch over mean diameter": (
        lambda r: 2.0 * r["pitch_mm"] / (r["bore_mm"] + r["outside_mm"]), 0.01, ()
    ),
    "space for the balls": (
        lambda r: r["balls"] * r["ball_mm"] / (math.pi * r["pitch_mm"]), 0.45, ()
    ),
    "ball over section": (lambda r: r["ball_mm"] / (r["outside_mm"] - r["bore_mm"]), 0.25, ()),
    "width over section": (lambda r: r["width_mm"] / (r["outside_mm"] - r["bore_mm"]), 0.25, ()),
    "mass over volume": (lambda r: r["mass_kg"] / _steel(r), 0.12, ("mass_kg",)),
    "C0 over ISO 76": (lambda r: r["C0_N"] / _static(r), 0.45, ("C0_N",)),
    "C over ISO 281": (_dynamic_ratio, 0.07, ("C_N",)),
    "C0 of ceramic balls": (
        lambda r: r["C0_ceramic_N"] / r["C0_N"], 0.015, ("C0_N", "C0_ceramic_N")
    ),
    "n dm with oil": (lambda r: r["speed_oil_rpm"] * r["pitch_mm"], 0.05, ("speed_oil_rpm",)),
    "grease over oil": (
        lambda r: r["speed_grease_rpm"] / r["speed_oil_rpm"], 0.01,
        ("speed_grease_rpm", "speed_oil_rpm"),
    ),
    "least spring preload over C": (
        lambda r: r["min_spring_preload_N"] / r["C_N"], 0.05, ("C_N", "min_spring_preload_N")
    ),
    **{
        f"preload {c} over C": (
            lambda r, c=c: r[f"preload_{c}_N"] / r["C_N"], 0.10, ("C_N", f"preload_{c}_N")
        )
        for c in CLASSES
    },
    **{
        f"rigidity {c} over Palmgren": (
            lambda r, c=c: _palmgren(r, c), 0.20, (f"rigidity_{c}_N_um", f"preload_{c}_N")
        )
        for c in CLASSES
    },
    **{
        f"rigidity {c} over {b}": (
            lambda r, b=b, c=c: _palmgren(r, c) / _palmgren(r, b), 0.05,
            (f"rigidity_{c}_N_um", f"preload_{c}_N", f"rigidity_{b}_N_um", f"preload_{b}_N"),
        )
        for b, c in zip(CLASSES, CLASSES[1:], strict=False)
    },
}  # fmt: skip
"""Numbers that are nearly one for a series and an angle: how far from its median, beside rounding
of the named columns."""

OF_A_SIZE = ("bore_mm", "outside_mm", "width_mm")
OF_A_SERIES = ("pitch_mm", "ball_mm", "balls", "mass_kg")
ANGLES = {"C": (15.0, 17.0, 19.0), "E": (25.0,)}


class Checked:
    """The rows as printed, and what they have in common."""

    def __init__(self) -> None:
        self.rows, self.units = numbers(), units()
        self.of_size = self._others(lambda name: name.split()[1])
        self.of_series = self._others(lambda name: name.rpartition(" ")[0][:-2])
        values: dict[tuple[str, str, float], list[float]] = defaultdict(list)
        for name, row in self.rows.items():
            for check, (value, _, _) in RATIOS.items():
                values[check, _series(name), row["angle_deg"]].append(value(row))
        self.medians = {group: float(np.median(found)) for group, found in values.items()}

    def failures(self, name: str, row: Numbers) -> Iterator[str]:
        """The checks that a row fails, the others being as printed."""
        if min(row.values()) <= 0.0 or row["bore_mm"] >= row["outside_mm"]:
            yield "no bearing"
            return
        yield from (f"{column} by the angle" for column in ["angle_deg"]
                    if row["angle_deg"] not in ANGLES[name.split()[2]])  # fmt: skip
        for columns, kin in ((OF_A_SIZE, self.of_size), (OF_A_SERIES, self.of_series)):
            for column in columns:
                if kin[name] and row[column] not in [other[column] for other in kin[name]]:
                    yield f"{column} of the other bearings of its size"
        for check, (value, allowed, rounded) in RATIOS.items():
            median = self.medians.get((check, _series(name), row["angle_deg"]))
            if median is None:
                continue
            room = allowed + sum(self.units[name][column] / row[column] for column in rounded
                                 if row[column])  # fmt: skip
            if not abs(math.log(value(row) / median)) <= math.log1p(room):
                yield check

    def _others(self, group: Callable[[str], str]) -> dict[str, list[Numbers]]:
        """The other rows of the group of each row."""
        return {
            name: [row for key, row in self.rows.items() if key != name and group(key) == own]
            for name in self.rows
            for own in [group(name)]
        }

    def all_failures(self) -> dict[str, list[str]]:
        """Of every row that fails one."""
        found = {name: list(self.failures(name, row)) for name, row in self.rows.items()}
        return {name: checks for name, checks in found.items() if checks}


def wrong_digits(text: str) -> Iterator[str]:
    """A printed number with one digit misread."""
    for k, digit in enumerate(text):
        if digit.isdigit() and not (k >= len(text.rstrip("0")) and "." not in text):
            yield from (
                text[:k] + other + text[k + 1 :] for other in "0123456789" if other != digit
            )


def shares_found(every: int = 1) -> dict[str, float]:
    """By column: the share of misread digits that a check finds in rows that pass as printed."""
    checked = Checked()
    bad = checked.all_failures()
    shares = {}
    printed = [row for row in rows_of("gmn") if row["designation"] not in bad][::every]
    for column in COLUMNS:
        found = [
            any(checked.failures(name, checked.rows[name] | {column: float(text)}))
            for row in printed
            for name in [row["designation"]]
            for text in wrong_digits(row[column])
        ]
        shares[column] = float(np.mean(found))
    return shares


if __name__ == "__main__":
    if len(sys.argv) > 1:
        wrong = differences_from_text(Path(sys.argv[1]).read_text(encoding="utf-8"))
        print(
            f"{len(numbers()) - len(wrong)} of {len(numbers())} rows are those of the text", *wrong
        )
    else:
        for name, checks in Checked().all_failures().items():
            print(f"{name}: {', '.join(checks)}")
        for column, share in shares_found().items():
            print(f"{column:<22}{100.0 * share:5.0f} %")
