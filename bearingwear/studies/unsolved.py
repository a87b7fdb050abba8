"""Check that every case and every life of a study was solved."""

import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.kernels.status import (
    CRITERION_NOT_REACHED,
    OK,
    STATUS_NAMES,
    STATUS_SENTENCES,
)
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.grid.grid import Case
from bearingwear.studies.run_step import NotSolved


def verdict_text(paths: Sequence[Path] = (), unsolved_is: str = "error") -> str:
    """Step: returns a text with the number of solved cases and lives, or with the unsolved ones.

    The text is one line if all cases and lives were solved. Otherwise it counts the unsolved ones,
    and has a line for each (see `unsolved_lines`).

    paths: study files and files of wear life. Without any, as in a study of design maps alone, the
        text says that nothing was checked.
    unsolved_is {"error", "warning"}: whether an unsolved case or life raises `NotSolved`, or the
        text goes to standard error as a warning and is returned.
    NotSolved: there is an unsolved case or life, and that is an error.
    CaseFileError: a file of another kind.
    """
    if not paths:
        return "nothing to check; cases and lives in maps keep their status\n"
    checked, unsolved = unsolved_lines(paths)
    if unsolved:
        message = "\n  ".join([f"{len(unsolved)} of {checked} not solved:", *unsolved])
        if unsolved_is == "error":
            raise NotSolved(message)
        sys.stderr.write(f"warning: {message}\n")
        return f"{message}\n"
    return f"all {checked} solved and verified\n"


def unsolved_lines(paths: Iterable[str | Path]) -> tuple[int, list[str]]:
    """Returns the number of cases and lives in files, and a line for each unsolved one.

    The line names the file and the reason. A case is named by a file of its own beside the study,
    even if several cases share a file. A life that no criterion ends counts as solved.

    paths: study files and files of wear life.
    CaseFileError: a file of another kind.
    """
    checked = 0
    unsolved = []
    for path in map(Path, paths):
        dataset = load(path)
        status = dataset.get("status")
        if status is None or not {"preload_method", "friction"} <= set(status.dims):
            raise CaseFileError(f"{path}: not a study")
        is_study = "ball_diameter_loss" in dataset.dims
        good_statuses = {OK} if is_study else {OK, CRITERION_NOT_REACHED}
        folder = "dynamic" if dataset.attrs.get("fidelity") == "dynamic" else "cases"
        checked += status.size
        for index in np.ndindex(status.shape):
            code = int(status[index])
            if code in good_statuses:
                continue
            case = _case_at(status[index])
            case_file = path.parent / folder / f"{case.id}.nc"
            subject = str(case_file) if is_study else f"{path}: {case.line_id}"
            name = STATUS_NAMES[code]
            unsolved.append(f"{subject}: {name}: {STATUS_SENTENCES[name]}")
    return checked, unsolved


def _case_at(status: xr.DataArray) -> Case:
    """Returns the case at the coordinates of a single status; that of a life has a loss of 0."""
    return Case(
        preload_method=PRELOAD_METHODS[int(status["preload_method"])],
        friction=float(status["friction"]),
        ball_diameter_loss_um=float(status.coords.get("ball_diameter_loss", 0.0)),
    )
