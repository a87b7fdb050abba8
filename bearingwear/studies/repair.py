"""Checks the files of earlier runs before a run relies on them.

Snakemake believes that a file is good if it is there, and up to date if it is not older than what
it was made from. Neither holds after a full disk, a broken transfer or a clock that was set back.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from bearingwear.studies.grid.grid import Case

if TYPE_CHECKING:
    from bearingwear.studies.protocol import Study

OFF_GRID = "off_grid"
"""Folder beside the points of a grid that holds those which it has no more."""

SET_ASIDE = ".damaged"
"""Suffix a file gets that cannot be used, so that nothing is deleted and its place is free."""

ABANDONED = 60.0
"""Age at which a file that is still being written was left so by a process that was killed [s]."""


def survey(paths: Iterable[str]) -> Iterator[str]:
    """Set aside results that cannot be used, and take back dates that lie in the future.

    Parts of files that nobody writes any more are removed.

    What is set aside is then missing, so that a run makes it anew. A result from the future would
    pass for newer than whatever is made from now on, and nothing can be made from an input of the
    future: Snakemake refuses what is older than its input. Both are dated now; whether a result
    still fits its inputs is told by their contents (`made_from` in the rules).

    paths: results and inputs of a study, of which any may be missing. Damage is looked for in those
        that end in `.nc`.

    Yields: one line for each damaged file, and one for all dates.
    OSError: a file that cannot be renamed, dated or removed.
    """
    paths = list(paths)
    _remove_abandoned(paths)
    there = filter(os.path.lexists, paths)
    redated = 0
    for path in there:
        fault = damage(path) if path.endswith(".nc") else None
        if fault:
            os.replace(path, path + SET_ASIDE)
            yield f"{fault}; the file was renamed to {path}{SET_ASIDE} and will be recomputed"
        elif os.path.getmtime(path) > time.time():
            os.utime(path)
            redated += 1
    if redated:
        yield f"{redated} files had dates in the future; these dates were set to today"


def _remove_abandoned(paths: Iterable[str]) -> None:
    """Remove what writers of these files left when they were killed."""
    ours = set(map(Path, paths))
    for folder in {path.parent for path in ours}:
        for part in folder.glob(".*.part"):
            name = re.fullmatch(r"\.(.+)\.\d+\.part", part.name)
            if name and folder / name[1] in ours:
                with contextlib.suppress(FileNotFoundError):  # just now finished
                    if time.time() - part.stat().st_mtime > ABANDONED:
                        part.unlink()


def off_grid(studies: Iterable[Study]) -> Iterator[str]:
    """Set aside files of points that a grid has no more, and take back those that it has again.

    Yields: one line for each folder.
    """
    several = list(studies)
    planned = {path for study in several for job in study.jobs for path in job.made()}
    for folder in map(Path, sorted({name for study in several for name in study.point_folders()})):
        aside = folder / OFF_GRID
        for file in aside.glob("*.nc"):
            place = folder / file.name
            if str(place) in planned and not place.exists():
                file.replace(place)
        if stale := sorted(file for file in folder.glob("*.nc") if str(file) not in planned):
            aside.mkdir(exist_ok=True)
            for file in stale:
                file.replace(aside / file.name)
            some = ", ".join(file.name for file in stale[:2]) + (", ..." if stale[2:] else "")
            moved = f"files outside the grid were moved to {OFF_GRID}/ ({len(stale)})"
            yield f"{folder}: {moved}: {some}"


def damage(path: str) -> str | None:
    """Why a result file of a study cannot be used, on one line; None if it can.

    It is opened, not read to its end; whoever reads the values does that.
    """
    from bearingwear.results.netcdf import CaseFileError, header

    try:
        found = header(path)
        is_case = Path(path).parent.name in ("cases", "dynamic")
        if is_case and (held := _case_id(found)) != Path(path).stem:
            expected = f"{path}: got a file of another kind, expected a case of a study"
            return f"{path}: contains the case {held}" if held else expected
    except CaseFileError as error:
        return str(error)
    return None


def _case_id(attributes: dict) -> str | None:
    """Id of the case that a file holds; None if it holds none."""
    try:
        scene = json.loads(attributes["scene"])
        return Case(
            scene["operation"]["preload_method"],
            float(scene["friction"]["ball_race"]),
            float(scene["wear"]["ball_diameter_loss_um"]),
        ).id
    except (KeyError, TypeError, ValueError, RecursionError):
        return None
