"""`bearingwear cage`, and the same in Python."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from bearingwear.console import NOT_SOLVED, SUCCESS, ProgressLines, one_line
from bearingwear.options import given_scene, output_of
from bearingwear.printing import print_file, tell_of_file, tell_of_new_folder

if TYPE_CHECKING:
    import xarray as xr

    from bearingwear.scene.read import Source


def cage_command(args: argparse.Namespace) -> int:
    """Runs an ensemble, writes its file and prints its sheet.

    Returns SUCCESS if any run succeeded. Otherwise it says so on stderr and returns NOT_SOLVED, or
    SUCCESS with `--record-failures`.
    """
    args.output = output_of(args, "-cage.nc")
    scene = given_scene(args)
    from bearingwear.applications.cage.life import cage_results
    from bearingwear.applications.cage.plan import Ensemble
    from bearingwear.scene.checking.check import record
    from bearingwear.studies.sampling import usable_cores

    names = ("runs", "within", "seed", "least_turns", "most_turns")
    settings = {name: getattr(args, name) for name in names if getattr(args, name) is not None}
    plan = record(Ensemble, settings, "cage")
    tell_of_new_folder(args.output)
    with ProgressLines(args.scene) as tell:
        workers = args.jobs or usable_cores()
        results = cage_results(scene, plan, args.life, workers, tell, args.output)
    tell_of_file(args)
    if not args.quiet:
        print_file(args.output, args)
    if (results["status"] == 0).any():  # the flag of `ok`
        return SUCCESS
    sys.stderr.write(one_line(f"{args.scene}: none of the cage runs succeeded"))
    return SUCCESS if args.record_failures else NOT_SOLVED


def cage(
    scene: Source,
    runs: int = 200,
    within: float = 0.1,
    seed: int = 1,
    life: bool = False,
    workers: int = 1,
    path: str | os.PathLike[str] | None = None,
    least_turns: int = 30,
    turns: int = 150,
) -> xr.Dataset:
    """Computes cage motion and cage wear from an ensemble of runs, like `bearingwear cage`.

    Parameters
    ----------
    scene : path, dict or Scene
        A scene with a cage. Random values are drawn from `uncertainty` and `cage_uncertainty`.
    runs : int
        Maximum number of runs.
    within : float
        Target relative half-width of the 90 % interval of the mean work per turn.
    seed : int
        Random seed of the draws.
    life : bool
        Whether to compute the life of the cage as well, from ensembles at successive wear states.
        The files of these stand beside `path`.
    workers : int
        Number of processes, which affects only the time.
    path : path, optional
        File to write. If a call is interrupted, the next one continues from this file.
    least_turns, turns : int
        Minimum and maximum number of shaft turns in a run.

    Returns
    -------
    xarray.Dataset
        The results of each `run`; the `share` of each motion; `mean_*` over all runs and over the
        runs of each motion (`group`), with intervals; for a life, `cage_life` (turns),
        `cage_hours` and `node_*`.

    Raises
    ------
    SceneError
        A ValueError with a one-line message.
    """
    from bearingwear.applications.cage.life import cage_results
    from bearingwear.applications.cage.plan import Ensemble
    from bearingwear.results.labels import labelled
    from bearingwear.scene.checking.check import record
    from bearingwear.scene.read import as_scene

    settings = {"runs": runs, "within": within, "seed": seed}
    settings |= {"least_turns": least_turns, "most_turns": turns}
    plan = record(Ensemble, settings, "cage")
    file = None if path is None else Path(path)
    return labelled(cage_results(as_scene(scene), plan, life, workers, path=file))
