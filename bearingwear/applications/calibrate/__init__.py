"""Friction and wear coefficients fitted to tests of bearings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearingwear.application import Application

if TYPE_CHECKING:
    import argparse


# fmt: off
def calibrate_options(sub: argparse.ArgumentParser) -> None:
    """Adds the arguments of `bearingwear calibrate`."""
    from pathlib import Path

    from bearingwear.applications.calibrate.seen import SEEN
    from bearingwear.options import add_formats, add_scene

    add_scene(sub)
    sub.add_argument("tests", metavar="TESTS.csv",
        help="a table with a header and one row per test; the columns are scene keys and one "
        f"result ({', '.join(SEEN)})")
    sub.add_argument("-o", "--output", metavar="CALIBRATED.yaml", type=Path,
        help="the scene file to write (default: SCENE-calibrated.yaml); values before and after "
        "calibration are stored in an .nc file of the same name")
    add_formats(sub)

# fmt: on


APPLICATION = Application(
    command="calibrate",
    description="fit friction and wear coefficients to test results",
    add_options=calibrate_options,
    handler=f"{__name__}.command:calibrate_command",
    functions={"calibrate": f"{__name__}.command:calibrate"},
    sheets={"calibration": f"{__name__}.show:calibration_sheet"},
    plots={"calibration": f"{__name__}.show:calibration_figure"},
)
