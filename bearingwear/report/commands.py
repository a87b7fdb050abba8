"""Commands of the report: figure, tables, and those of the studies beside it."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray as xr

PLAN = Path("config/tradeoff.yaml")


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Add the commands to the command line."""
    figure = commands.add_parser("figure", help="draw a figure from result files")
    figures = figure.add_subparsers(dest="figure", required=True, metavar="FIGURE")

    def add(name: str, run: Callable, text: str, kind: str, several: bool = False) -> Callable:
        parser = figures.add_parser(name, help=text)
        parser.add_argument("files", nargs="+" if several else 1, metavar=kind, type=Path)
        parser.add_argument("-o", "--output", required=True, nargs="+", metavar="FILE", type=Path)
        parser.set_defaults(run=run)
        return parser.add_argument

    add("family", _family_figure, "the bearings that fit what the paper states", "FAMILY.nc")
    option = add("friction", _friction, "QV and contact load against friction", "STUDY.nc")
    option("--loss-um", required=True, type=float, metavar="UM", help="the state of wear")
    add("slip", _slip, "slip over the contact ellipse", "CASE.nc", several=True)
    option = add("wear", _wear, "QV, preload, angles and wear rate", "STUDY.nc", several=True)
    option(
        "--friction", required=True, nargs="+", type=float, metavar="MU",
        help="one for each file, or several of one file",
    )  # fmt: skip
    option = add("life", _life, "wear and preload over the life", "WEAR_LIFE.nc")
    option("--friction", required=True, nargs="+", type=float, metavar="MU")
    option("--uncertainty", nargs="*", default=[], metavar="UNCERTAINTY.nc", type=Path,
           help="how lives spread")  # fmt: skip
    option = add("spread", _spread, "scenes over each other", "STUDY.nc", several=True)
    option("--friction", required=True, type=float, metavar="MU")

    dynamic = figures.add_parser("dynamic", help="cases solved in time beside the steady ones")
    option = add("running-average", _running_average, "wear rates as they settle", "CASE.nc")
    option("--reference", metavar="FILE.csv", type=Path, help="values of others to draw as well")

    add("life-in-time", _life_in_time, "what wears over a life followed in time", "LIFE.nc")
    lives = commands.add_parser(
        "tables-lives", help="set lives followed in time beside the steady ones, as Markdown"
    )
    lives.add_argument("files", nargs="+", metavar="LIFE.nc", type=Path)
    lives.add_argument("-o", "--output", required=True, metavar="LIVES.md", type=Path)
    lives.set_defaults(run=_tables_lives)

    in_time = commands.add_parser(
        "tables-dynamic",
        help="set cases solved in time beside the steady ones, as CSV and Markdown",
    )
    for parser in (dynamic, in_time):
        parser.add_argument("study", metavar="STUDY.nc", type=Path)
        parser.add_argument("dynamic", metavar="DYNAMIC.nc", type=Path)
    dynamic.add_argument("-o", "--output", required=True, nargs="+", metavar="FILE", type=Path)
    dynamic.set_defaults(run=_dynamic)
    in_time.add_argument(
        "-o", "--output", required=True, nargs=2, metavar=("ALL.csv", "SUMMARY.md"), type=Path
    )
    in_time.set_defaults(run=_tables_dynamic)

    trade = figures.add_parser("tradeoff", help="wall time against error")
    trade.add_argument("which", metavar="WHICH", help="overview, steady, in_time, ...")
    trade.add_argument("trade", metavar="TRADEOFF.nc", type=Path)
    trade.add_argument("-o", "--output", required=True, nargs="+", metavar="FILE", type=Path)
    trade.set_defaults(run=_trade_figure)

    designed = figures.add_parser("design", help="which preload to take, and how sure that is")
    designed.add_argument("which", metavar="WHICH", help="design, map, uncertainty")
    written = commands.add_parser(
        "tables-design", help="write a design map as CSV, and what to choose as Markdown"
    )
    for parser in (designed, written):
        parser.add_argument("design", metavar="DESIGN.nc", type=Path)
        parser.add_argument("recommendation", metavar="RECOMMENDATION.nc", type=Path)
        parser.add_argument("uncertainty", metavar="UNCERTAINTY.nc", type=Path)
    designed.add_argument("-o", "--output", required=True, nargs="+", metavar="FILE", type=Path)
    designed.set_defaults(run=_design_figure)
    written.add_argument(
        "-o", "--output", required=True, nargs=2, metavar=("MAP.csv", "DESIGN.md"), type=Path
    )
    written.set_defaults(run=_design_tables)

    checked = commands.add_parser(
        "tables-check", help="set a recommended preload solved in time beside the steady one"
    )
    checked.add_argument("recommendation", metavar="RECOMMENDATION.nc", type=Path)
    checked.add_argument("cases", nargs="+", metavar="CASE.nc", type=Path)
    checked.add_argument("-o", "--output", required=True, metavar="CHECK.md", type=Path)
    checked.set_defaults(run=_check_table)

    listed = commands.add_parser("tables-family", help="write the bearings that fit as Markdown")
    listed.add_argument("files", nargs=1, metavar="FAMILY.nc", type=Path)
    listed.add_argument("-o", "--output", required=True, metavar="FAMILY.md", type=Path)
    listed.set_defaults(run=_family_table)

    extremes = figures.add_parser("extremes", help="a map or branches far beyond the study")
    extremes.add_argument("file", metavar="FILE.nc", type=Path)
    extremes.add_argument("-o", "--output", required=True, nargs="+", metavar="FILE", type=Path)
    extremes.set_defaults(run=_extremes_figure)

    ends = commands.add_parser(
        "tables-extremes", help="write how scenes of the extremes end; exit 3 if one is wrong"
    )
    ends.add_argument("counts", metavar="EXTREMES.nc", type=Path)
    ends.add_argument("-o", "--output", required=True, metavar="TABLE.md", type=Path)
    ends.set_defaults(run=_extremes_table)

    numbers = commands.add_parser(
        "tables-tradeoff", help="write what each simplification costs, as CSV and Markdown"
    )
    docs = commands.add_parser(
        "docs-tradeoff", help="write the measured trade into docs/accuracy.md, or compare them"
    )
    for parser in (numbers, docs):
        parser.add_argument("trade", metavar="TRADEOFF.nc", type=Path)
        parser.add_argument("--plan", type=Path, default=PLAN, metavar="FILE.yaml")
    numbers.add_argument(
        "-o", "--output", required=True, nargs=2, metavar=("ALL.csv", "SUMMARY.md"), type=Path
    )
    numbers.set_defaults(run=_trade_tables)
    docs.add_argument("docs", metavar="DOCS.md", type=Path)
    docs.add_argument("--check", action="store_true", help="only compare; exit 3 if they differ")
    docs.set_defaults(run=_trade_docs)

    tables = commands.add_parser("tables", help="write the numbers of a study as CSV and Markdown")
    tables.add_argument("study", metavar="STUDY.nc", type=Path)
    tables.add_argument("life", metavar="WEAR_LIFE.nc", type=Path)
    tables.add_argument(
        "--uncertainty", nargs="*", default=[], metavar="UNCERTAINTY.nc", type=Path,
        help="how lives spread",
    )  # fmt: skip
    tables.add_argument(
        "-o", "--output", required=True, nargs=2, metavar=("CASES.csv", "SUMMARY.md"), type=Path
    )
    tables.set_defaults(run=_tables)

    page = commands.add_parser("report", help="write one HTML page of everything a study found")
    page.add_argument(
        "results", nargs="+", metavar="FILE", type=Path,
        help="study.nc, wear_life.nc and dynamic.nc of scenes, their tables (.md) and figures "
        "(.svg, and .png for heavy ones); the answer is about the first scene",
    )  # fmt: skip
    page.add_argument(
        "--docs", nargs="*", default=[], metavar="FILE.md", type=Path, help="texts to append"
    )
    page.add_argument(
        "--design", nargs="*", default=[], metavar="FILE", type=Path,
        help="tables (.md), figures and uncertainty.nc of a design study; the first sentence of "
        "its design.md is the answer",
    )  # fmt: skip
    page.add_argument("-o", "--output", required=True, metavar="PAGE.html", type=Path)
    page.set_defaults(run=_page)


def _friction(given: argparse.Namespace) -> int:
    from bearingwear.report import figures
    from bearingwear.report.drawing import save

    study = _loaded(given.files[0], ball_diameter_loss=[given.loss_um])
    save(figures.friction(study, given.loss_um), given.output)
    return 0


def _slip(given: argparse.Namespace) -> int:
    from bearingwear.report import figures
    from bearingwear.report.drawing import save

    save(figures.slip([_loaded(path, strip=()) for path in given.files]), given.output)
    return 0


def _wear(given: argparse.Namespace) -> int:
    from bearingwear.io.netcdf import CaseFileError
    from bearingwear.report import figures
    from bearingwear.report.drawing import save

    paths = given.files * len(given.friction) if len(given.files) == 1 else given.files
    if len(paths) != len(given.friction):
        raise CaseFileError(f"--friction: given {len(given.friction)}; allowed {len(paths)}")
    studies = [
        _loaded(path, friction=[mu], ball_diameter_loss=())
        for path, mu in zip(paths, given.friction, strict=True)
    ]
    save(figures.wear(studies, given.friction), given.output)
    return 0


def _life(given: argparse.Namespace) -> int:
    from bearingwear.io.spread import uncertainty
    from bearingwear.report import figures
    from bearingwear.report.drawing import save

    lives = _loaded(given.files[0], interpolated_step=(), friction=given.friction)
    known = [uncertainty(path) for path in given.uncertainty]
    save(figures.life(lives, given.friction, known), given.output)
    return 0


def _spread(given: argparse.Namespace) -> int:
    from bearingwear.report.drawing import save
    from bearingwear.report.spread import spread

    studies = [
        _loaded(path, friction=[given.friction], ball_diameter_loss=()) for path in given.files
    ]
    save(spread(studies, given.friction), given.output)
    return 0


def _dynamic(given: argparse.Namespace) -> int:
    from bearingwear.report.drawing import save
    from bearingwear.report.dynamic import beside_steady

    save(beside_steady(*_both_ways(given)), given.output)
    return 0


def _running_average(given: argparse.Namespace) -> int:
    from bearingwear.io.netcdf import CaseFileError
    from bearingwear.report.drawing import save
    from bearingwear.report.dynamic import running_average

    case = _loaded(given.files[0])
    if case.attrs.get("fidelity") != "dynamic" or "status" not in case or case["status"].dims:
        raise CaseFileError(f"{given.files[0]}: not a case solved in time")
    save(running_average(case, given.reference), given.output)
    return 0


def _life_in_time(given: argparse.Namespace) -> int:
    from bearingwear.io.netcdf import CaseFileError
    from bearingwear.report.drawing import save
    from bearingwear.report.life_in_time import life_in_time

    life = _lived_in_time(given.files[0])
    if "history_ball_worn_volume" not in life:
        raise CaseFileError(f"{given.files[0]}: no step of this life was solved")
    save(life_in_time(life), given.output)
    return 0


def _tables_lives(given: argparse.Namespace) -> int:
    from bearingwear.report.life_in_time import write_lives

    write_lives([(path.stem, _lived_in_time(path)) for path in given.files], given.output)
    return 0


def _lived_in_time(path: Path) -> xr.Dataset:
    """A life file of fidelity dynamic."""
    from bearingwear.io.netcdf import CaseFileError

    life = _loaded(path)
    if life.attrs.get("fidelity") != "dynamic" or "end_criterion" not in life:
        raise CaseFileError(f"{path}: not a life followed in time")
    return life


def _tables_dynamic(given: argparse.Namespace) -> int:
    from bearingwear.report.comparison import write_comparison

    write_comparison(*_both_ways(given), *given.output)
    return 0


def _both_ways(given: argparse.Namespace) -> tuple[xr.Dataset, xr.Dataset]:
    """Study and cases solved in time, all of which are also in the study."""
    from bearingwear.io.netcdf import CaseFileError
    from bearingwear.report.drawing import scene_of

    dynamic = _loaded(given.dynamic, preload_method=(), friction=(), ball_diameter_loss=())
    if dynamic.attrs.get("fidelity") != "dynamic":
        raise CaseFileError(f"{given.dynamic}: not cases solved in time")
    axes = ("preload_method", "friction", "ball_diameter_loss")
    points = {axis: dynamic[axis].values.tolist() for axis in axes}
    study = _loaded(given.study, **points)
    if scene_of(study)["name"] != scene_of(dynamic)["name"]:
        raise CaseFileError(f"{given.dynamic}: not of the scene of {given.study}")
    return study, dynamic


def _tables(given: argparse.Namespace) -> int:
    from bearingwear.io.spread import uncertainty
    from bearingwear.report.tables import write_cases, write_summary

    study = _loaded(given.study, ball_diameter_loss=())
    lives = _loaded(given.life, interpolated_step=())
    known = [uncertainty(path) for path in given.uncertainty]
    cases, summary = given.output
    write_cases(study, cases)
    write_summary(study, lives, summary, known)
    return 0


def _page(given: argparse.Namespace) -> int:
    from bearingwear.report.page import write_page

    write_page(given.results, given.docs, given.design, given.output)
    return 0


def _trade_figure(given: argparse.Namespace) -> int:
    from bearingwear.io.netcdf import CaseFileError
    from bearingwear.report.drawing import save
    from bearingwear.report.tradeoff import FIGURES

    if given.which not in FIGURES:
        raise CaseFileError(f"WHICH: given {given.which}; allowed {', '.join(FIGURES)}")
    save(FIGURES[given.which](_loaded(given.trade, point=())), given.output)
    return 0


def _trade_tables(given: argparse.Namespace) -> int:
    from bearingwear.io.whole import write_text
    from bearingwear.report.trade_table import markdown, write_points
    from bearingwear.study.sweeps import TradePlan

    trade, plan = _loaded(given.trade, point=()), TradePlan.from_file(given.plan)
    everything, summary = given.output
    write_points(trade, everything)
    write_text(summary, markdown(trade, plan))
    return 0


def _trade_docs(given: argparse.Namespace) -> int:
    from bearingwear.report.trade_table import block, differences, write_block
    from bearingwear.study.sweeps import TradePlan

    trade, plan = _loaded(given.trade, point=()), TradePlan.from_file(given.plan)
    if not given.check:
        write_block(block(trade, plan), given.docs)
        return 0
    found = differences(trade, plan, given.docs)
    for line in found:
        sys.stderr.write(f"{line}\n")
    print(f"{given.docs}: {len(found)} numbers differ" if found else f"{given.docs}: agrees")
    return 3 if found else 0


def _family_figure(given: argparse.Namespace) -> int:
    from bearingwear.report.drawing import save
    from bearingwear.report.family import family_figure

    save(family_figure(_loaded(given.files[0], candidate=())), given.output)
    return 0


def _family_table(given: argparse.Namespace) -> int:
    from bearingwear.report.family import write_family

    write_family(_loaded(given.files[0], candidate=()), given.output)
    return 0


def _design_figure(given: argparse.Namespace) -> int:
    from bearingwear.io.netcdf import CaseFileError
    from bearingwear.report.design import FIGURES
    from bearingwear.report.drawing import save

    if given.which not in FIGURES:
        raise CaseFileError(f"WHICH: given {given.which}; allowed {', '.join(FIGURES)}")
    save(FIGURES[given.which](*_design_files(given)), given.output)
    return 0


def _design_tables(given: argparse.Namespace) -> int:
    from bearingwear.report.design_table import write_design, write_map

    files = _design_files(given)
    write_map(files[0], given.output[0])
    write_design(*files, given.output[1])
    return 0


def _check_table(given: argparse.Namespace) -> int:
    from bearingwear.io.netcdf import load
    from bearingwear.report.check_table import write_check

    write_check(load(given.recommendation), given.cases, given.output)
    return 0


def _design_files(given: argparse.Namespace) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    """Design map, recommendation and uncertainty of one scene."""
    from bearingwear.io.netcdf import CaseFileError, load

    paths = given.design, given.recommendation, given.uncertainty
    found = load(paths[0]), load(paths[1]), load(paths[2])
    kinds = ("design map", "recommendation", "uncertainty")
    for path, dataset, kind in zip(paths, found, kinds, strict=True):
        if dataset.attrs.get("kind") != kind:
            raise CaseFileError(f"{path}: not a file of the kind {kind}")
        if dataset.attrs["scene"] != found[0].attrs["scene"]:
            raise CaseFileError(f"{path}: not of the scene of {paths[0]}")
    return found


def _extremes_figure(given: argparse.Namespace) -> int:
    from bearingwear.report.drawing import save
    from bearingwear.report.extremes import figure_of

    save(figure_of(given.file), given.output)
    return 0


def _extremes_table(given: argparse.Namespace) -> int:
    from bearingwear.report.extremes import write_table

    counts = _loaded(given.counts, set=(), end=())
    wrong = write_table(counts, given.output)
    if wrong:
        first = next(text for text in counts["first_wrong"].values if text)
        sys.stderr.write(f"{given.counts}: {wrong} wrong, the first: {first}\n")
    return 3 if wrong else 0


def _loaded(path: Path, **axes: Sequence[float]) -> xr.Dataset:
    """A file that has the given dimensions and, along them, the given values."""
    from bearingwear.io.netcdf import CaseFileError, load

    dataset = load(path)
    for axis, values in axes.items():
        if axis not in dataset.dims:
            raise CaseFileError(f"{path}: not a file for this command; it has no {axis}")
        for value in values:
            if value not in dataset[axis]:
                allowed = ", ".join(f"{known:g}" for known in dataset[axis].values)
                raise CaseFileError(f"{path}: {axis}: given {value:g}; allowed {allowed}")
    return dataset
