"""`bearingwear calibrate`, and the same in Python."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from bearingwear.console import SUCCESS, ProgressLines
from bearingwear.options import given_scene, output_of
from bearingwear.printing import print_file, tell_line, tell_of_new_folder

if TYPE_CHECKING:
    from bearingwear.applications.calibrate.calibration import Calibration
    from bearingwear.scene.read import Source


def calibrate_command(args: argparse.Namespace) -> int:
    """Calibrates a scene, writes scene and data, and prints their sheet.

    Returns SUCCESS. All that is wrong is raised: OutputError, SceneError, CaseFileError.
    """
    from bearingwear.applications.calibrate.calibration import calibration_by_tests, data_file
    from bearingwear.atomic import check_output
    from bearingwear.studies.sampling import usable_cores

    args.output = output_of(args, "-calibrated.yaml")
    data = data_file(args.output)
    check_output(data, args.scene)
    with ProgressLines() as tell:
        calibration = calibration_by_tests(given_scene(args), args.tests, usable_cores(), tell)
    tell_of_new_folder(args.output)
    calibration.write(args.output)
    print_file(data, args)
    tell_line(f"{args.output}: calibrated scene; {data}: results, for `show` and `plot`")
    return SUCCESS


def calibrate(scene: Source, tests: str | Path, workers: int = 1) -> Calibration:
    """Calibrates a scene with bearing tests, like `bearingwear calibrate`.

    Parameters
    ----------
    scene : path, dict or Scene
        A scene with `uncertainty.wear_coefficient` and a value that scatters between bearings. A
        scene without `uncertainty` uses the one in the table of coefficients.
    tests : path
        CSV file with a header and one row per test (docs/calibrate.md).
    workers : int
        Number of processes that compute the lives.

    Returns
    -------
    Calibration
        `scene`, with the remaining uncertainty, and `data`: friction, K_s/H and life before and
        after the tests, and the tests.

    Raises
    ------
    SceneError, CaseFileError
        Both are ValueErrors with a one-line message that names the invalid row and column.
    """
    from bearingwear.applications.calibrate.calibration import calibration_by_tests
    from bearingwear.results.labels import labelled
    from bearingwear.scene.read import as_scene, scene_for_life

    calibration = calibration_by_tests(scene_for_life(as_scene(scene)), tests, workers)
    calibration.data = labelled(calibration.data)
    return calibration
