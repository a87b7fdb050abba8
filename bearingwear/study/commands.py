"""Commands of the study: gather, wear-life, verdict."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path


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

    for parser in (gather, life, verdict):
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
    from bearingwear.study.verdict import verdict

    checked, unsolved = verdict(given.files)
    if unsolved:
        lines = [f"{len(unsolved)} of {checked} not solved:", *unsolved]
        sys.stderr.write("\n  ".join(lines) + "\n")
        return 3
    given.output.parent.mkdir(parents=True, exist_ok=True)
    given.output.write_text(f"all {checked} solved and verified\n", encoding="utf-8")
    return 0
