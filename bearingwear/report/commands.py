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
        help="tables (.md) and figures of a design study; its first sentence is the answer",
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
    from bearingwear.report import figures
    from bearingwear.report.drawing import save

    lives = _loaded(given.files[0], interpolated_step=(), friction=given.friction)
    save(figures.life(lives, given.friction), given.output)
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
    from bearingwear.report.tables import write_cases, write_summary

    study = _loaded(given.study, ball_diameter_loss=())
    lives = _loaded(given.life, interpolated_step=())
    cases, summary = given.output
    write_cases(study, cases)
    write_summary(study, lives, summary)
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
