"""Check that every case and every life of a study was solved."""

import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

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
    """Returns a line that all was solved, or fail; a step of the workflow.

    paths: study files and files of wear life; maps, which keep the status of each life, need none.
    unsolved_is {"error", "warning"}: whether an unsolved case is an error or a warning.
    """
    if not paths:
        return "nothing to check; cases and lives in maps keep their status\n"
    checked, unsolved = verdict(paths)
    if unsolved:
        message = "\n  ".join([f"{len(unsolved)} of {checked} not solved:", *unsolved])
        if unsolved_is == "error":
            raise NotSolved(message)
        sys.stderr.write(f"warning: {message}\n")
        return f"{message}\n"
    return f"all {checked} solved and verified\n"


def verdict(paths: Iterable[str | Path]) -> tuple[int, list[str]]:
    """Checks the status of all cases and lives in study files and files of wear life.

    A life that no criterion ends is an answer, not a failure.

    Returns `checked`: number of cases and lives.
    Returns `unsolved`: a line for each unsolved case or life, with its file and the reason.
    """
    checked, unsolved = 0, []
    for path in map(Path, paths):
        dataset = load(path)
        if not {"preload_method", "friction"} <= set(dataset["status"].dims):
            raise CaseFileError(f"{path}: not a study")
        is_study = "ball_diameter_loss" in dataset.dims
        good_statuses = {OK} if is_study else {OK, CRITERION_NOT_REACHED}
        folder = "dynamic" if dataset.attrs.get("fidelity") == "dynamic" else "cases"
        status = dataset["status"]
        checked += status.size
        for index in np.ndindex(status.shape):
            case_status = status[index]
            if int(case_status) in good_statuses:
                continue
            name = STATUS_NAMES[int(case_status)]
            case = Case(
                PRELOAD_METHODS[int(case_status["preload_method"])],
                float(case_status["friction"]),
                float(case_status["ball_diameter_loss"]) if is_study else 0.0,
            )
            case_file = path.parent / folder / f"{case.id}.nc"
            subject = str(case_file) if is_study else f"{path}: {case.id.rpartition('-')[0]}"
            unsolved.append(f"{subject}: {name}: {STATUS_SENTENCES[name]}")
    return checked, unsolved
