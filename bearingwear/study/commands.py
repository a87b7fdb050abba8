"""Commands of the study: gather, wear-life, verdict, and of the studies beside it."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

PLAN = Path("config/tradeoff.yaml")
EXTREMES = Path("config/extremes.yaml")


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Add the commands to the command line."""
    gather = commands.add_parser("gather", help="gather the cases of a scene in one study file")
    gather.add_argument("cases", nargs="+", metavar="CASE.nc", type=Path)
    gather.set_defaults(run=_gather)

    life = commands.add_parser("wear-life", help="find the wear life over a study, by two routes")
    life.add_argument("scene", metavar="SCENE.yaml", help="the scene of the study")
    life.add_argument("study", metavar="STUDY.nc", type=Path)
    life.set_defaults(run=_wear_life)

    verdict = commands.add_parser("verdict", help="fail if anything in a study was not solved")
    verdict.add_argument("files", nargs="+", metavar="STUDY.nc|WEAR_LIFE.nc", type=Path)
    verdict.set_defaults(run=_verdict)

    trade = commands.add_parser(
        "tradeoff", help="time and compare the settings of a sweep of the trade study on a scene"
    )
    trade.add_argument("scene", metavar="SCENE", help="a scene of the trade study")
    trade.add_argument("sweep", metavar="SWEEP", help="a sweep or a reference of the trade study")
    trade.add_argument("--plan", type=Path, default=PLAN, metavar="FILE.yaml", help=f"{PLAN}")
    trade.set_defaults(run=_tradeoff)

    traded = commands.add_parser(
        "gather-tradeoff", help="gather the sweeps of the trade study, with their errors"
    )
    traded.add_argument("files", nargs="+", metavar="POINTS.nc", type=Path)
    traded.set_defaults(run=_gather_tradeoff)

    extremes = commands.add_parser(
        "extremes", help="solve scenes far beyond the study: random ones, a map, or branches"
    )
    extremes.add_argument("kind", metavar="KIND", help="families, maps or branches")
    extremes.add_argument("name", metavar="NAME", help="a name under that")
    extremes.add_argument("--plan", type=Path, default=EXTREMES, metavar="FILE.yaml")
    extremes.add_argument(
        "--scenes", type=int, metavar="N", help="random scenes, if not the plan's"
    )
    extremes.add_argument("--seed", type=int, default=1, metavar="N", help="of random scenes")
    extremes.set_defaults(run=_extremes)

    stressed = commands.add_parser("gather-extremes", help="count how scenes of the extremes ended")
    stressed.add_argument("files", nargs="+", metavar="FILE.nc", type=Path)
    stressed.set_defaults(run=_gather_extremes)

    for parser in (gather, life, verdict, trade, traded, extremes, stressed):
        parser.add_argument("-o", "--output", required=True, metavar="FILE", type=Path)


def _gather(given: argparse.Namespace) -> int:
    from bearingwear.study.gather import study
    from bearingwear.study.stack import write

    write(study(given.cases), given.output)
    return 0


def _wear_life(given: argparse.Namespace) -> int:
    from bearingwear.io.netcdf import load
    from bearingwear.study.life import wear_life
    from bearingwear.study.stack import write

    write(wear_life(given.scene, load(given.study)), given.output)
    return 0


def _verdict(given: argparse.Namespace) -> int:
    from bearingwear.io.whole import write_text
    from bearingwear.study.verdict import verdict

    checked, unsolved = verdict(given.files)
    if unsolved:
        lines = [f"{len(unsolved)} of {checked} not solved:", *unsolved]
        sys.stderr.write("\n  ".join(lines) + "\n")
        return 3
    write_text(given.output, f"all {checked} solved and verified\n")
    return 0


def _tradeoff(given: argparse.Namespace) -> int:
    from bearingwear.io.netcdf import CaseFileError
    from bearingwear.study.stack import write
    from bearingwear.study.sweeps import TradePlan
    from bearingwear.study.trial import sweep

    plan = TradePlan.from_file(given.plan)
    if (given.scene, given.sweep) not in plan.jobs():
        raise CaseFileError(f"{given.plan}: has no sweep {given.sweep} of {given.scene}")
    write(sweep(plan, given.scene, given.sweep), given.output)
    return 0


def _gather_tradeoff(given: argparse.Namespace) -> int:
    from bearingwear.study.stack import write
    from bearingwear.study.tradeoff import gathered

    write(gathered(given.files), given.output)
    return 0


def _extremes(given: argparse.Namespace) -> int:
    from bearingwear.io.netcdf import CaseFileError
    from bearingwear.study.extremes import ExtremesPlan
    from bearingwear.study.stack import write
    from bearingwear.study.stress import branch, family, steady_map

    plan = ExtremesPlan.from_file(given.plan)
    if (given.kind, given.name) not in plan.jobs():
        raise CaseFileError(f"{given.plan}: has no {given.name} under {given.kind}")
    if given.kind == "families":
        found = family(plan, given.name, given.scenes, given.seed)
    elif given.kind == "maps":
        found = steady_map(plan, given.name)
    else:
        found = branch(plan, given.name)
    write(found, given.output)
    return 0


def _gather_extremes(given: argparse.Namespace) -> int:
    from bearingwear.study.counts import counted
    from bearingwear.study.stack import write

    write(counted(given.files), given.output)
    return 0
