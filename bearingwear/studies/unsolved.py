"""Whether every case and every life of a study was solved."""

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
    """Step: says that all was solved, or fails. A map alone keeps the status of each life.

    unsolved_is {"error", "warning"}: whether the step fails, or says so on standard error.
    """
    if not paths:
        return "nothing to check; cases and lives in maps keep their status\n"
    checked, unsolved = verdict(paths)
    if unsolved:
        said = "\n  ".join([f"{len(unsolved)} of {checked} not solved:", *unsolved])
        if unsolved_is == "error":
            raise NotSolved(said)
        sys.stderr.write(f"warning: {said}\n")
        return f"{said}\n"
    return f"all {checked} solved and verified\n"


def verdict(paths: Iterable[str | Path]) -> tuple[int, list[str]]:
    """Look at the status of everything in study files and files of wear life.

    A life that no criterion ends is an answer, not a failure.

    Returns `checked`: number of cases and lives.
    Returns `unsolved`: one line for each that was not solved: which, and why.
    """
    checked, unsolved = 0, []
    for path in map(Path, paths):
        dataset = load(path)
        if not {"preload_method", "friction"} <= set(dataset["status"].dims):
            raise CaseFileError(f"{path}: not a study")
        is_study = "ball_diameter_loss" in dataset.dims
        answers = {OK} if is_study else {OK, CRITERION_NOT_REACHED}
        folder = "dynamic" if dataset.attrs.get("fidelity") == "dynamic" else "cases"
        status = dataset["status"]
        checked += status.size
        for index in np.ndindex(status.shape):
            one = status[index]
            if int(one) in answers:
                continue
            name = STATUS_NAMES[int(one)]
            case = Case(
                PRELOAD_METHODS[int(one["preload_method"])],
                float(one["friction"]),
                float(one["ball_diameter_loss"]) if is_study else 0.0,
            )
            where = path.parent / folder / f"{case.id}.nc"
            what = str(where) if is_study else f"{path}: {case.id.rpartition('-')[0]}"
            unsolved.append(f"{what}: {name}: {STATUS_SENTENCES[name]}")
    return checked, unsolved
