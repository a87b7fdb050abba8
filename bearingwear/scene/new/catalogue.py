"""Bearings of makers' catalogues: sizes, balls, preload classes and limits of speed.

`catalogue.csv` is made by `benchmarks/identify.py`, which has the sources. NSK prints no balls:
theirs are identified from the load ratings. `source` says so, and how certain that is. No maker
prints grooves: `Maker.groove_rules` says where those of the table come from.

Importing this file imports nothing heavy: the command line takes its options from it.
"""

from __future__ import annotations

import csv
import functools
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from bearingwear.scene.checking.errors import SceneError, shown
from bearingwear.scene.new.letters import gmn_parts


class Maker(NamedTuple):
    """Data of a maker that apply to all its bearings."""

    classes: tuple[str, ...]  # of preload, the lightest first
    # allowed speed of a rigidly preloaded pair of each class, over that of one bearing under
    # a light spring
    rigid_speed: tuple[float, ...]
    source: str
    # where the inner and the outer groove factor of its bearings come from
    groove_rules: tuple[str, str] = ("assumed", "assumed")


MAKERS: Mapping[str, Maker] = {
    "NSK": Maker(
        classes=("EL", "L", "M", "H"),
        rigid_speed=(0.85, 0.80, 0.65, 0.55),
        source="NSK, super-precision bearings, pp. 50-61, 156-170",
        groove_rules=2 * ("inferred from the printed rigidities",),
    ),
    "SNFA": Maker(
        classes=("L", "M", "F"),
        rigid_speed=(0.80, 0.65, 0.40),
        source="SNFA, general catalogue, pp. 66-107",
    ),
    "GMN": Maker(
        classes=("L", "M", "S"),
        rigid_speed=(0.80, 0.70, 0.50),
        source="GMN, catalogue 4000 0813 EN, pp. 20-43",
        groove_rules=(
            "inferred from the printed static load rating",
            "inferred from the printed rigidities",
        ),
    ),
}

MAKERS_CLASSES = tuple(dict.fromkeys(name for maker in MAKERS.values() for name in maker.classes))

SOURCES = {
    "printed": "printed in the catalogue",
    "identified": "identified from the printed load ratings",
    "uncertain": "identified with some uncertainty from the printed load ratings",
    "unclear": "printed unclearly in the catalogue",
}
"""Where number and diameter of the balls come from."""


_SNFA_ANGLES = {"1": 15.0, "3": 25.0}
"""Contact angle [degree] by the last digit of SNFA's code of accuracy, cage and angle (7CE1)."""


class CatalogueBearing(NamedTuple):
    """A bearing of a catalogue; lengths in mm, speeds in r/min of one under a light spring."""

    maker: str
    designation: str
    angle: float  # [degree]
    bore: float
    outside: float
    width: float
    balls: int
    ball: float  # diameter
    source: str
    pitch: float | None  # pitch diameter, where it is printed
    grooves: tuple[float, float] | None  # inner and outer groove factor
    preloads: Mapping[str, float]  # by class [N], none where none is printed
    speed_grease: float
    speed_oil: float
    min_spring_preload: float | None  # at `speed_oil` [N], where it is printed

    @property
    def rated(self) -> float:
        """Returns Z^(2/3) D^(1/3) with D in mm, to which axial rigidity is proportional (Palmgren).

        That holds at a given preload and contact angle.
        """
        return float(self.balls ** (2.0 / 3.0) * self.ball ** (1.0 / 3.0))

    def speed_factor(self, method: str, preload: float) -> tuple[float, str]:
        """Returns the allowed speed over that under a light spring, and the class of preload.

        Under a spring, they are 1 and "". In a fixed position, the class is the lightest of at
        least that preload, or the heaviest if the preload is above all classes or none is printed.

        method, preload: of a scene [N].
        """
        if method != "fixed_position":
            return 1.0, ""
        maker = MAKERS[self.maker]
        # preloads are printed in whole numbers, and a class shall hold its own preload
        sufficient = (
            name
            for name, class_preload in self.preloads.items()
            if preload <= 1.001 * class_preload
        )
        name = next(sufficient, maker.classes[-1])
        return maker.rigid_speed[maker.classes.index(name)], name


@functools.cache
def bearings() -> tuple[CatalogueBearing, ...]:
    """Reads every bearing of the catalogues, in the order of catalogue.csv; once in a process."""
    with Path(__file__).with_name("catalogue.csv").open(encoding="utf-8", newline="") as file:
        return tuple(_entry(row) for row in csv.DictReader(file))


def _entry(row: Mapping[str, str]) -> CatalogueBearing:
    """Returns the bearing of a row of catalogue.csv."""

    def number_or_none(column: str) -> float | None:
        return float(row[column]) if row[column] else None

    maker = row["maker"]
    # not strict: a bearing without printed preloads has an empty cell
    preload_texts = zip(MAKERS[maker].classes, row["preload_N"].split("/"), strict=False)
    inner, outer = number_or_none("inner_groove"), number_or_none("outer_groove")
    return CatalogueBearing(
        maker=maker,
        designation=row["designation"],
        angle=float(row["angle_deg"]),
        bore=float(row["bore_mm"]),
        outside=float(row["outside_mm"]),
        width=float(row["width_mm"]),
        balls=int(row["balls"]),
        ball=float(row["ball_mm"]),
        source=row["source"],
        pitch=number_or_none("pitch_mm"),
        grooves=None if inner is None or outer is None else (inner, outer),
        preloads={name: float(text) for name, text in preload_texts if text},
        speed_grease=float(row["speed_grease_rpm"]),
        speed_oil=float(row["speed_oil_rpm"]),
        min_spring_preload=number_or_none("min_spring_preload_N"),
    )


def entry_of(
    maker: str, designation: str, angle: float | None = None
) -> tuple[CatalogueBearing, str]:
    """Returns a bearing by its maker's designation, and the suffixes that are not used.

    SceneError: the catalogue lacks it.

    angle: contact angle [degree]; of several bearings with the designation, the one nearest to it
        is returned. If None, it is that of a code of SNFA in the suffixes, or the smallest.
    """
    entries, ignored = _entries_of(maker, designation)
    if not entries:
        raise _unknown_bearing_error(maker, designation)
    if angle is None and maker == "SNFA":
        angle = _snfa_angle(designation, ignored, entries)
    if angle is None:
        return entries[0], ignored  # the catalogue lists the smallest angle first
    return min(entries, key=lambda entry: abs(entry.angle - angle)), ignored


def _unknown_bearing_error(maker: str, designation: str) -> SceneError:
    """Returns the error of a designation that a maker's catalogue lacks, with similar ones."""
    problem = f"got {shown(designation)}"
    if makers := makers_with(designation):
        problem += f", which is in the catalogue of {' or '.join(makers)}"
    names = ", ".join(nearest_names(maker, designation)) or "one of its bearings"
    expected = f"{names} (all: bearingwear new --list {maker})"
    return SceneError("", f"{problem}, expected {expected}", source=f"{maker} designation")


def _snfa_angle(
    designation: str, suffixes: str, entries: Sequence[CatalogueBearing]
) -> float | None:
    """Returns the contact angle [degree] by SNFA's code (7CE1) in the suffixes; None without it.

    SceneError where no bearing of the designation has that angle.

    entries: the bearings of the designation.
    """
    code = re.search(r"\d[A-Z]+([0-3])", suffixes)
    if code is None:
        return None
    angle = _SNFA_ANGLES.get(code[1])
    if angle not in {entry.angle for entry in entries}:
        angles = " or ".join(dict.fromkeys(f"{entry.angle:g}" for entry in entries))
        problem = f"got {shown(designation)}, whose code {code[0]} is none of {angles} degrees"
        raise SceneError("", f"{problem}, expected --contact-angle", source="SNFA designation")
    return angle


def nearest_names(maker: str, designation: str) -> list[str]:
    """Returns up to six designations of a maker that begin most like an unknown one.

    They share the most characters at the beginning; the list is empty if none shares two.
    """
    plain, entries_by_name = _plain(designation), _entries_by_name(maker)
    for length in range(len(plain), 1, -1):
        similar = [
            entries[0].designation
            for name, entries in entries_by_name.items()
            if name.startswith(plain[:length])
        ]
        if similar:
            return similar[:6]
    return []


def has_bearing(maker: str, designation: str) -> bool:
    """Whether a maker's catalogue has a bearing of a designation."""
    entries, _ = _entries_of(maker, designation)
    return bool(entries)


def makers_with(designation: str) -> list[str]:
    """Returns the names of the makers whose catalogue has a bearing of that designation."""
    return [maker for maker in MAKERS if has_bearing(maker, designation)]


@functools.cache
def _entries_by_name(maker: str) -> dict[str, list[CatalogueBearing]]:
    """Returns the bearings of a maker by their plain designations."""
    entries_by_name: dict[str, list[CatalogueBearing]] = {}
    for entry in bearings():
        if entry.maker == maker:
            entries_by_name.setdefault(_plain(entry.designation), []).append(entry)
    return entries_by_name


def _entries_of(maker: str, designation: str) -> tuple[list[CatalogueBearing], str]:
    """Returns a maker's bearings of a designation, and its suffixes that are not used as a text.

    They are an empty list and "" if the catalogue has none. Several differ in the contact angle.
    """
    words = [word for word in re.split(r"[\s/_.-]+", designation.upper()) if word]
    if words and maker == "NSK":
        words[0] = re.sub(r"^719(?=\d\d)", "79", words[0])  # as other makers name series 79
    if maker == "GMN" and (parts := gmn_parts(designation)):
        words = [parts.name, *parts.rest]
    return _longest_match(words, _entries_by_name(maker))


def _longest_match(
    words: Sequence[str], entries_by_name: Mapping[str, list[CatalogueBearing]]
) -> tuple[list[CatalogueBearing], str]:
    """Returns the bearings of the longest name that a designation begins with, and the rest of it.

    Names that end with a word of the designation come first. Without a name, they are [] and "".

    words: of the designation, in capitals.
    entries_by_name: bearings of a maker by their designations without separators.
    """
    for count in range(len(words), 0, -1):
        if entries := entries_by_name.get("".join(words[:count])):
            return entries, " ".join(words[count:])
    joined = "".join(words)
    for name in sorted(entries_by_name, key=len, reverse=True):
        # a digit would continue the number of the name
        if joined.startswith(name) and joined[len(name)].isalpha():
            return entries_by_name[name], joined[len(name) :]
    return [], ""


def _plain(designation: str) -> str:
    """Returns a designation in capitals without separators."""
    return re.sub(r"[\s/_.-]", "", designation).upper()


def same_size(bore: float, outside: float, angle: float) -> list[CatalogueBearing]:
    """Returns bearings of any maker by bore, outside diameter [mm] and contact angle [degree]."""
    return [
        entry
        for entry in bearings()
        if (entry.bore, entry.outside, entry.angle) == (bore, outside, angle)
    ]


def entry_of_bearing(bearing: Mapping[str, Any]) -> CatalogueBearing | None:
    """Returns the catalogue's bearing of the maker and designation in a scene; None without them.

    Of several, it is the one with the nearest contact angle.

    bearing: block of a scene as plain data.
    """
    maker, name = bearing.get("maker"), bearing.get("designation")
    if maker not in MAKERS or not name:
        return None
    entries = [entry for entry in bearings() if (entry.maker, entry.designation) == (maker, name)]
    angle = bearing["contact_angle_deg"]
    return min(entries, key=lambda entry: abs(entry.angle - angle), default=None)


def identity_line(bearing: Mapping[str, Any]) -> str:
    """Returns a line on the designation of a bearing and the sources of balls and grooves.

    It is the designation alone where no catalogue has the bearing, and "" without one.

    bearing: block of a scene as plain data.
    """
    entry = entry_of_bearing(bearing)
    if entry is None:
        return bearing.get("designation") or ""
    balls = SOURCES[entry.source]
    if (bearing["ball_count"], bearing["ball_diameter_mm"]) != (entry.balls, entry.ball):
        balls = f"other than the {entry.balls} balls of {entry.ball:g} mm in the catalogue"
    inner = outer = "assumed"
    if (bearing["inner_groove_factor"], bearing["outer_groove_factor"]) == entry.grooves:
        inner, outer = MAKERS[entry.maker].groove_rules
    rules = inner if inner == outer else f"{inner} (inner) and {outer} (outer)"
    return f"{entry.maker} {entry.designation}: balls {balls}, groove factors {rules}"


def speed_limit_line(bearing: Mapping[str, Any], operation: Mapping[str, Any]) -> str:
    """Returns a line on the catalogue's speed limits, or "" for a bearing of no catalogue.

    bearing, operation: blocks of a scene as plain data.
    """
    entry = entry_of_bearing(bearing)
    if entry is None:
        return ""
    factor, name = entry.speed_factor(operation["preload_method"], operation["preload_N"])
    kind = f"a rigid pair of class {name}" if name else "a bearing with light spring preload"
    return (
        f"{entry.maker} speed limit for {kind}: {factor * entry.speed_grease:.0f} r/min with "
        f"grease, {factor * entry.speed_oil:.0f} with oil"
    )


def bearings_table(maker: str, series: str = "") -> list[str]:
    """Returns the lines of a table of a maker's bearings: title, heads, and one for each bearing.

    series: beginning of their designations. SceneError where there is none.
    """
    start = _plain(series)
    of_maker = [entry for entry in bearings() if entry.maker == maker]
    entries = [entry for entry in of_maker if _plain(entry.designation).startswith(start)]
    if not entries:
        names = dict.fromkeys(map(_series, of_maker))
        problem = f"got {shown(series)}, expected {', '.join(names)}"
        raise SceneError("", problem, source=f"--list {maker}")
    classes = MAKERS[maker].classes
    heads = [
        "designation", "angle", "bore", "outside", "width", "balls", "mm", "", *classes, "grease",
        "oil",
    ]  # fmt: skip
    widths = "{:<12}{:>6}{:>6}{:>8}{:>7}{:>7}{:>9} {:<11}" + "{:>7}" * len(classes) + "{:>9}{:>9}"
    title = (
        f"{MAKERS[maker].source}; preload classes in N, speed limits with grease and oil in r/min"
    )
    if any(entry.min_spring_preload for entry in entries):
        title += "; spring: least spring preload in N at the limit with oil"
        heads.append("spring")
        widths += "{:>8}"
    rows = [heads, *(_cells(entry, classes) for entry in entries)]
    return [title, *(widths.format(*row) for row in rows)]


def _cells(entry: CatalogueBearing, classes: Sequence[str]) -> list[str]:
    """Returns the values of a bearing as text, with a dash for a class without a preload."""
    preloads = [f"{entry.preloads[name]:g}" if name in entry.preloads else "-" for name in classes]
    cells = [
        entry.designation,
        f"{entry.angle:g}",
        f"{entry.bore:g}",
        f"{entry.outside:g}",
        f"{entry.width:g}",
        str(entry.balls),
        f"{entry.ball:.5g}",
        entry.source,
        *preloads,
        f"{entry.speed_grease:.0f}",
        f"{entry.speed_oil:.0f}",
    ]
    if entry.min_spring_preload:
        cells.append(f"{entry.min_spring_preload:g}")
    return cells


def _series(entry: CatalogueBearing) -> str:
    """Returns the first letters of a designation of SNFA or GMN, the first two digits of NSK's."""
    match = re.match(r"[A-Z]+|\d\d", entry.designation)
    return match[0] if match else entry.designation
