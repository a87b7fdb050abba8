"""Cage motion and cage wear, from ensembles of runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearingwear.application import Application

if TYPE_CHECKING:
    import argparse


# fmt: off
def cage_options(sub: argparse.ArgumentParser) -> None:
    """Adds the arguments of `bearingwear cage`."""
    from bearingwear.options import (
        add_formats,
        add_jobs,
        add_scene,
        result_name,
        share_below_one,
    )

    add_scene(sub)
    sub.add_argument("--runs", type=int, metavar="N", help="maximum number of runs (default: 200)")
    sub.add_argument("--within", type=share_below_one, metavar="SHARE",
        help="target relative half-width of the 90 %% interval for the mean work (default: 0.1)")
    sub.add_argument("--seed", type=int, metavar="N", help="random seed (default: 1)")
    sub.add_argument("--least-turns", type=int, metavar="N",
        help="minimum number of shaft turns per run (default: 30); the motion of a hanging cage "
        "may change after hundreds of turns")
    sub.add_argument("--turns", dest="most_turns", type=int, metavar="N",
        help="maximum number of shaft turns in a run that has not settled (default: 150)")
    sub.add_argument("--life", action="store_true",
        help="also compute the wear life of the cage from ensembles at successive wear states")
    add_jobs(sub)
    sub.add_argument("--record-failures", action="store_true",
        help="exit with status 0 even if no run succeeds, and store the reasons in the file")
    sub.add_argument("-o", "--output", metavar="FILE.nc", type=result_name,
        help="the file to write (default: SCENE-cage.nc)")
    add_formats(sub).add_argument("--quiet", action="store_true", help="print nothing")

# fmt: on


APPLICATION = Application(
    command="cage",
    description="compute cage motion and cage wear from an ensemble of runs",
    add_options=cage_options,
    handler=f"{__name__}.command:cage_command",
    functions={"cage": f"{__name__}.command:cage"},
    sheets={"cage ensemble": f"{__name__}.show:ensemble_sheet"},
    plots={
        "cage ensemble": f"{__name__}.show:ensemble_figure",
        "cage map": f"{__name__}.figures:cage_map_figure",
    },
)
