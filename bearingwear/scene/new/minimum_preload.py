"""The least preload that a maker prescribes for a bearing, against slip of the balls.

GMN prints the least spring preload at the largest speed. SKF prints the factor A of a least axial
load A (n/1000)^2 kN. Both hold the balls against their gyroscopic moment, which goes with the
square of the speed; so GMN's number is taken to a lower speed by that rule, too.

Importing this file imports nothing heavy.
"""

from __future__ import annotations

import csv
import functools
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from bearingwear.measures import plain
from bearingwear.scene.new.catalogue import MAKERS, entry_of_bearing

SKF_SOURCE = "SKF, rolling bearings, pp. 399-417"
_OF_SKF = re.compile(r"7[23]\d\d(AC|B)")


@functools.cache
def skf_factors() -> Mapping[str, float]:
    """Returns SKF's minimum load factors A [kN] by designation, for 25 (AC) and 40 degrees (B).

    Bearings whose factor is not clear in the text of the catalogue are left out, as is the 7205AC,
    whose printed factor breaks the row of its neighbours. Those of 40 degrees have design E and
    cages of steel or plastic.
    """
    with Path(__file__).with_name("skf_minimum_load.csv").open(encoding="utf-8") as file:
        return {row["designation"]: float(row["factor_kN"]) for row in csv.DictReader(file)}


class MinimumPreload(NamedTuple):
    """The least axial load of one bearing by its maker."""

    bearing: str  # maker and designation
    load: float  # [N], at `speed`
    speed: float  # [r/min], of one ring against the other
    rule: str  # what the maker prints
    source: str


def minimum_preload(
    bearing: Mapping[str, Any], operation: Mapping[str, Any]
) -> MinimumPreload | None:
    """Returns the maker's least preload of a bearing at its speed; None where none is published.

    bearing, operation: blocks of a scene as mappings.
    """
    speed = abs(operation["shaft_speed_rpm"] - (operation.get("outer_speed_rpm") or 0.0))
    entry = entry_of_bearing(bearing)
    if entry is not None and entry.min_spring_preload is not None:
        return MinimumPreload(
            bearing=f"{entry.maker} {entry.designation}",
            load=entry.min_spring_preload * (speed / entry.speed_oil) ** 2,
            speed=speed,
            rule=f"{entry.min_spring_preload:g} N at {entry.speed_oil:.0f} r/min, taken with the "
            "square of the speed",
            source=MAKERS[entry.maker].source,
        )
    factor = skf_factors().get(str(bearing.get("designation")))
    if factor is None or bearing.get("maker"):  # SKF is none of `MAKERS`
        return None
    return MinimumPreload(
        bearing=f"SKF {bearing['designation']}",
        load=1e3 * factor * (1e-3 * speed) ** 2,
        speed=speed,
        rule=f"{factor:g} (n/1000)^2 kN",
        source=SKF_SOURCE,
    )


def minimum_preload_words(scenes: Iterable[Mapping[str, Any]]) -> str:
    """Returns the maker's least preload at the largest speed of some scenes, in words.

    It is "" if no maker publishes one.

    scenes: plain data, all of the same bearing; their preload need not be given.
    """
    minima = [minimum_preload(scene["bearing"], scene["operation"]) for scene in scenes]
    published = [minimum for minimum in minima if minimum is not None]
    if not published:
        return ""
    fastest = max(published, key=lambda minimum: minimum.speed)
    maker, _, _ = fastest.bearing.partition(" ")
    return f"{maker} minimum preload {plain(fastest.load)} N at {fastest.speed:g} r/min"


def minimum_preload_lines(scene: Mapping[str, Any]) -> list[str]:
    """Returns a line that compares the maker's least preload with that of a scene, in a list.

    For a bearing of SKF whose factor is not known, the line says so. The list is empty if no maker
    publishes a least preload.

    scene: plain data.
    """
    bearing, operation = scene["bearing"], scene["operation"]
    minimum = minimum_preload(bearing, operation)
    if minimum is None:
        name = str(bearing.get("designation"))
        if bearing.get("maker") or not _OF_SKF.fullmatch(name):
            return []
        return [f"SKF minimum preload for a {name}: factor not known here; see SKF's product table"]
    maker, _, name = minimum.bearing.partition(" ")
    balls = "" if bearing["ball_material"] == "bearing_steel" else " with steel balls"
    return [
        f"{maker} minimum preload for a {name}{balls}: {plain(minimum.load)} N at "
        f"{minimum.speed:g} r/min ({minimum.rule}); preload here {operation['preload_N']:g} N"
    ]
