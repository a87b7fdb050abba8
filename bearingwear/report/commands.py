"""Commands of the report: figure, tables."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray as xr


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

    tables = commands.add_parser("tables", help="write the numbers of a study as CSV and Markdown")
    tables.add_argument("study", metavar="STUDY.nc", type=Path)
    tables.add_argument("life", metavar="WEAR_LIFE.nc", type=Path)
    tables.add_argument(
        "-o", "--output", required=True, nargs=2, metavar=("CASES.csv", "SUMMARY.md"), type=Path
    )
    tables.set_defaults(run=_tables)


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


def _tables(given: argparse.Namespace) -> int:
    from bearingwear.report.tables import write_cases, write_summary

    study = _loaded(given.study, ball_diameter_loss=())
    lives = _loaded(given.life, interpolated_step=())
    cases, summary = given.output
    write_cases(study, cases)
    write_summary(study, lives, summary)
    return 0


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
