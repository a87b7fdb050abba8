"""Commands of the study: gather, wear-life, verdict, and of the studies beside it."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from bearingwear.study.grid import PRELOAD_METHODS

PLAN = Path("config/tradeoff.yaml")
DESIGN_PLAN = Path("config/design.yaml")
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

    mapped = commands.add_parser(
        "design-map", help="find the lives of a scene over preload and speed"
    )
    mapped.add_argument("scene", metavar="SCENE.yaml", type=Path)
    mapped.add_argument("--friction", required=True, type=float, metavar="MU")
    mapped.set_defaults(run=_design_map)

    gathered = commands.add_parser(
        "gather-design", help="gather the parts of a design map, and choose preloads"
    )
    gathered.add_argument("files", nargs="+", metavar="PART.nc", type=Path)
    gathered.set_defaults(run=_gather_design)

    recommend = commands.add_parser(
        "recommend", help="find the preload with the longest life within the limits of a design map"
    )
    recommend.add_argument("scene", metavar="SCENE.yaml", type=Path)
    recommend.add_argument("design", metavar="DESIGN.nc", type=Path)
    recommend.set_defaults(run=_recommend)

    checked = commands.add_parser(
        "check-scene", help="write the scene at its recommended preload, or at a multiple of it"
    )
    checked.add_argument("scene", metavar="SCENE.yaml", type=Path)
    checked.add_argument("recommendation", metavar="RECOMMENDATION.nc", type=Path)
    checked.add_argument("--times", type=float, default=1.0, metavar="FACTOR", help="default 1")
    checked.set_defaults(run=_check_scene)

    sample = commands.add_parser("sample-lives", help="find lives at sampled uncertain values")
    sample.add_argument("scene", metavar="SCENE.yaml", type=Path)
    sample.add_argument("--recommendation", metavar="FILE.nc", type=Path, help="take its preload")
    sample.add_argument("--chunk", required=True, type=int, metavar="NUMBER", help="from 0")
    sample.set_defaults(run=_sample_lives)

    own = commands.add_parser(
        "life-spread", help="quantiles of life at a scene's own preload, of sampled lives"
    )
    own.add_argument("scene", metavar="SCENE.yaml", type=Path)
    own.add_argument("--friction", type=float, metavar="MU", help="if not the scene's")
    own.add_argument(
        "--method", nargs="+", choices=PRELOAD_METHODS, help="if not the scene's alone"
    )
    own.add_argument("--samples", type=int, metavar="N", help="half of the lives, a power of two")
    own.add_argument("--seed", type=int, default=1, metavar="N")
    own.set_defaults(run=_life_spread)

    spread = commands.add_parser(
        "spread", help="quantiles of life and Sobol indices from sampled lives"
    )
    spread.add_argument("scene", metavar="SCENE.yaml", type=Path)
    spread.add_argument("files", nargs="+", metavar="LIVES.nc", type=Path)
    spread.set_defaults(run=_spread)

    identify = commands.add_parser(
        "identify", help="find the bearings that fit what the paper states"
    )
    identify.add_argument("scenes", metavar="FOLDER", type=Path, help="folder of the scenes")
    identify.set_defaults(run=_identify)

    for parser in (mapped, sample):
        parser.add_argument("--method", required=True, choices=PRELOAD_METHODS)
    for parser in (mapped, sample, spread, identify):
        parser.add_argument("--plan", type=Path, default=DESIGN_PLAN, metavar="FILE.yaml")
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

    for parser in (gather, life, verdict, trade, traded, mapped, gathered, recommend, checked,
                   sample, own, spread, identify, extremes, stressed):  # fmt: skip
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


def _design_map(given: argparse.Namespace) -> int:
    from bearingwear.io.netcdf import CaseFileError
    from bearingwear.study.design import chunk
    from bearingwear.study.design_plan import DesignPlan, design_scene
    from bearingwear.study.stack import write

    scene, plan = design_scene(given.scene), DesignPlan.from_file(given.plan)
    if scene.name not in plan.scenes:
        raise CaseFileError(f"{given.plan}: scenes: has no {scene.name}")
    write(chunk(scene, plan.scenes[scene.name], given.method, given.friction), given.output)
    return 0


def _gather_design(given: argparse.Namespace) -> int:
    from bearingwear.study.design import gathered
    from bearingwear.study.stack import write

    write(gathered(given.files), given.output)
    return 0


def _recommend(given: argparse.Namespace) -> int:
    from bearingwear.io.netcdf import load
    from bearingwear.study.design import recommendation
    from bearingwear.study.design_plan import design_scene
    from bearingwear.study.stack import write

    write(recommendation(design_scene(given.scene), load(given.design)), given.output)
    return 0


def _check_scene(given: argparse.Namespace) -> int:
    from bearingwear.io.netcdf import CaseFileError, load
    from bearingwear.study.check import write_check_scene
    from bearingwear.study.design_plan import design_scene

    if not 0.0 < given.times < float("inf"):
        raise CaseFileError(f"--times: given {given.times:g}; allowed a number > 0")
    scene = design_scene(given.scene)
    write_check_scene(scene, load(given.recommendation), given.times, given.output)
    return 0


def _sample_lives(given: argparse.Namespace) -> int:
    from bearingwear.io.netcdf import CaseFileError, load
    from bearingwear.study.design_plan import AT, DesignPlan, design_scene
    from bearingwear.study.stack import write
    from bearingwear.study.uncertainty import chunk

    scene, plan = design_scene(given.scene), DesignPlan.from_file(given.plan).sampling
    if not 0 <= given.chunk < plan.chunks:
        raise CaseFileError(f"--chunk: given {given.chunk}; allowed 0 to {plan.chunks - 1}")
    recommendation = None if given.recommendation is None else load(given.recommendation)
    where = AT[0] if recommendation is None else AT[1]
    write(chunk(scene, plan, given.method, where, given.chunk, recommendation), given.output)
    return 0


def _life_spread(given: argparse.Namespace) -> int:
    from bearingwear.io.netcdf import CaseFileError
    from bearingwear.study.design_plan import SAMPLES, checked_sampling, design_scene
    from bearingwear.study.stack import write
    from bearingwear.study.uncertainty import life_spread

    samples = SAMPLES if given.samples is None else given.samples
    numbers = {"samples": samples, "chunks": 1, "seed": given.seed}
    try:
        plan = checked_sampling(numbers, "--")
    except ValueError as error:
        raise CaseFileError(str(error)) from None
    settings = [] if given.friction is None else [f"friction.ball_race={given.friction!r}"]
    scene = design_scene(given.scene, settings)
    methods = list(dict.fromkeys(given.method or [scene.operation.preload_method]))
    write(life_spread(scene, methods, plan), given.output)
    return 0


def _spread(given: argparse.Namespace) -> int:
    from bearingwear.study.design_plan import DesignPlan, design_scene
    from bearingwear.study.stack import write
    from bearingwear.study.uncertainty import spread

    plan = DesignPlan.from_file(given.plan).sampling
    write(spread(given.files, design_scene(given.scene), plan), given.output)
    return 0


def _identify(given: argparse.Namespace) -> int:
    from bearingwear.study.design_plan import DesignPlan
    from bearingwear.study.family import identified
    from bearingwear.study.stack import write

    write(identified(DesignPlan.from_file(given.plan).family, given.scenes), given.output)
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
