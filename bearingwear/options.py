"""Arguments and options that several commands have, what they may be, and the scene they name."""

from __future__ import annotations

import argparse
import contextlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bearingwear.scene.checking.check import fits, option_misfit
from bearingwear.scene.checking.errors import SceneError, check_thousands
from bearingwear.scene.checking.records import Key, Part

if TYPE_CHECKING:
    from bearingwear.scene.scene import Scene


# fmt: off
def add_scene(sub: argparse.ArgumentParser) -> None:
    """Add the scene file and the changes to it."""
    sub.add_argument("scene", metavar="SCENE.yaml", help="the scene file")
    setting = sub.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
        help="replace a value in the scene, for example operation.preload_N=9; may be repeated")
    setting.completer = scene_keys  # type: ignore[attr-defined]


def add_case(sub: argparse.ArgumentParser) -> None:
    """Add the option that selects a case of the scene."""
    sub.add_argument("--case", metavar="NAME", help="select one of the cases in the scene")


def add_jobs(sub: argparse.ArgumentParser) -> None:
    """Add the number of processes."""
    sub.add_argument("-j", "--jobs", type=positive_count, metavar="N",
        help="number of processes (default: one per core)")


def add_formats(sub: argparse.ArgumentParser) -> Any:
    """Add the formats of the output, one at a time; returns their group."""
    formats = sub.add_mutually_exclusive_group()
    formats.add_argument("--json", action="store_true", help="print the sheet as JSON")
    formats.add_argument("--csv", action="store_true", help="print the sheet as CSV")
    return formats


# fmt: on


def given_scene(args: argparse.Namespace) -> Scene:
    """Reads the scene of the arguments, with their changes and case; refuses it as the output."""
    from bearingwear.atomic import check_output
    from bearingwear.scene.read import load_scene

    scene = load_scene(args.scene, args.set)
    if (case := getattr(args, "case", None)) is not None:
        from bearingwear.scene.cases import in_case

        scene = in_case(scene, case, "--case")
    if getattr(args, "output", None) is not None:
        check_output(args.output, args.scene)
    return scene


def output_of(args: argparse.Namespace, ending: str) -> Path:
    """Returns the file to write: that of -o, or one beside the scene, named after it."""
    scene = Path(args.scene)
    args.is_named = args.output is not None
    return Path(args.output or scene.with_name(f"{scene.stem}{ending}"))


def number_in(part: Part, key: str = "") -> Callable[[str], float]:
    """Return the reader of a number of an option.

    part: range and unit of the number.
    key: its name in a scene, where it has one.
    """

    def read(text: str) -> float:
        value: float | str = text
        with contextlib.suppress(ValueError):
            value = float(text)
        if part.unit == "r/min":
            try:
                check_thousands("", text)
            except SceneError as error:
                raise argparse.ArgumentTypeError(error.problem) from None
        if isinstance(value, str) or not fits(value, part):
            raise argparse.ArgumentTypeError(option_misfit(text, part, key))
        return value

    return read


_POSITIVE = Part("number", Key("", "-", "(0, inf)"))
_SHARE = Part("number", Key("", "1", "[0, 1)"))
_NOT_NEGATIVE = Part("number", Key("", "-", "[0, inf)"))


def positive(text: str) -> float:
    """Read a number above 0."""
    return number_in(_POSITIVE)(text)


def not_negative(text: str) -> float:
    """Read a number of at least 0."""
    return number_in(_NOT_NEGATIVE)(text)


def share_below_one(text: str) -> float:
    """Read a number from 0 to below 1."""
    return number_in(_SHARE)(text)


def file_name(text: str) -> Path:
    """Read the name of a file, which is no folder."""
    if not os.path.basename(text):
        raise argparse.ArgumentTypeError(f"got {text!r}, expected a file name")
    return Path(text)


_NO_RESULTS = (".csv", ".json", ".xlsx", ".txt", ".md", ".svg", ".png", ".pdf", ".html")


def result_name(text: str) -> Path:
    """Read the name of a result file to write, which is netCDF whatever it is called."""
    path = file_name(text)
    if path.suffix in _NO_RESULTS:
        advice = "; --csv prints the sheet" if path.suffix in (".csv", ".xlsx", ".txt") else ""
        if path.suffix in (".svg", ".png", ".pdf"):
            advice = "; `bearingwear plot` draws it"
        problem = f"got {text!r}, expected a name that ends in .nc{advice}"
        raise argparse.ArgumentTypeError(problem)
    return path


def positive_count(text: str) -> int:
    """Read a whole number of at least 1."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"got {text!r}, expected 1 or more")
    return int(text)


def scene_keys(**_: Any) -> list[str]:
    """Keys of `--set`, for completion in a shell."""
    from bearingwear.scene.checking.records import file_part, keys
    from bearingwear.scene.scene import Scene

    return [f"{key}=" for key, part in keys(file_part(Scene)) if part.kind != "block"]
