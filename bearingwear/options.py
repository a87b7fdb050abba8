"""Arguments and options of several commands, checks of their values, and the scene they give."""

from __future__ import annotations

import argparse
import math
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
    """Adds the argument `scene`, a file, and the option `--set`, a list of texts KEY=VALUE."""
    sub.add_argument("scene", metavar="SCENE.yaml", help="the scene file")
    setting = sub.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
        help="replace a value in the scene, for example operation.preload_N=9; may be repeated")
    setting.completer = scene_keys  # type: ignore[attr-defined]


def add_case(sub: argparse.ArgumentParser) -> None:
    """Adds the option that selects a case of the scene."""
    sub.add_argument("--case", metavar="NAME", help="select one of the cases in the scene")


def add_jobs(sub: argparse.ArgumentParser) -> None:
    """Adds the option `--jobs`, the number of processes; None if it is omitted."""
    sub.add_argument("-j", "--jobs", type=positive_count, metavar="N",
        help="number of processes (default: one per core)")


def add_formats(sub: argparse.ArgumentParser) -> Any:
    """Adds the options `--json` and `--csv`, which exclude each other; returns their group."""
    formats = sub.add_mutually_exclusive_group()
    formats.add_argument("--json", action="store_true", help="print the sheet as JSON")
    formats.add_argument("--csv", action="store_true", help="print the sheet as CSV")
    return formats


# fmt: on


def given_scene(args: argparse.Namespace) -> Scene:
    """Reads the scene file of a command, applies `--set` and `--case`, and returns the scene.

    SceneError: a scene, a change or a case that is not valid.
    OutputError: `--output` would replace the scene or a file that is no result, or cannot be
    written.
    """
    from bearingwear.atomic import check_output
    from bearingwear.scene.read import load_scene

    scene = load_scene(args.scene, args.set)
    if (case := getattr(args, "case", None)) is not None:
        from bearingwear.scene.cases import scene_in_case

        scene = scene_in_case(scene, case, "--case")
    if getattr(args, "output", None) is not None:
        check_output(args.output, args.scene)
    return scene


def output_of(args: argparse.Namespace, ending: str) -> Path:
    """Returns the file to write: that of -o, or one beside the scene, named after it.

    Sets `args.is_named`, whether -o names the file. If it does not, `tell_of_file` prints the name.

    ending: end of the name of a file beside the scene, such as `-warmup.nc`.
    """
    scene = Path(args.scene)
    args.is_named = args.output is not None
    return Path(args.output or scene.with_name(f"{scene.stem}{ending}"))


def number_in(part: Part, key: str = "") -> Callable[[str], float]:
    """Returns the `type` of an option for argparse, which reads a number from a text.

    It raises ArgumentTypeError for a text that is no finite number, a number out of the range, and
    a speed such as 18.000, which may mean 18 or 18000 r/min.

    part: unit and range of the number.
    key: name of the number in a scene, for the message; "" if it is no key of a scene.
    """

    def number(text: str) -> float:
        """Returns the number in a text."""
        if part.unit == "r/min":
            try:
                check_thousands("", text)
            except SceneError as error:
                raise argparse.ArgumentTypeError(error.problem) from None
        try:
            value = float(text)
        except ValueError:
            value = math.nan  # refused below
        if not (math.isfinite(value) and fits(value, part)):
            raise argparse.ArgumentTypeError(option_misfit(text, part, key))
        return value

    return number


_POSITIVE = Part("number", Key("", "-", "(0, inf)"))
_SHARE = Part("number", Key("", "1", "[0, 1)"))
_NOT_NEGATIVE = Part("number", Key("", "-", "[0, inf)"))


def positive(text: str) -> float:
    """Returns a typed number. ArgumentTypeError: it is not above 0."""
    return number_in(_POSITIVE)(text)


def not_negative(text: str) -> float:
    """Returns a typed number. ArgumentTypeError: it is not 0 or more."""
    return number_in(_NOT_NEGATIVE)(text)


def share_below_one(text: str) -> float:
    """Returns a typed number. ArgumentTypeError: it is not from 0 to below 1."""
    return number_in(_SHARE)(text)


def file_name(text: str) -> Path:
    """Returns the path of a file. ArgumentTypeError: an empty name, or one that ends in `/`."""
    if not os.path.basename(text):
        raise argparse.ArgumentTypeError(f"got {text!r}, expected a file name")
    return Path(text)


_ADVICE_BY_SUFFIX = {
    **dict.fromkeys((".csv", ".xlsx", ".txt"), "; --csv prints the sheet"),
    **dict.fromkeys((".svg", ".png", ".pdf"), "; `bearingwear plot` draws it"),
    **dict.fromkeys((".json", ".md", ".html"), ""),
}
"""Advice on how to get a file that is no result, by its suffix; empty without advice."""


def result_name(text: str) -> Path:
    """Returns the path of a result file, which is netCDF.

    ArgumentTypeError: no file name, or the suffix of another format.
    """
    path = file_name(text)
    if path.suffix in _ADVICE_BY_SUFFIX:
        expected = f"a name that ends in .nc{_ADVICE_BY_SUFFIX[path.suffix]}"
        raise argparse.ArgumentTypeError(f"got {text!r}, expected {expected}")
    return path


def positive_count(text: str) -> int:
    """Returns a typed whole number. ArgumentTypeError: it is not 1 or more."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"got {text!r}, expected 1 or more")
    return int(text)


def scene_keys(**_: Any) -> list[str]:
    """Returns the keys of a scene, each with `=`, for the completion of `--set` in a shell.

    **_: what argcomplete passes; it is not used.
    """
    from bearingwear.scene.checking.records import file_part, keys
    from bearingwear.scene.scene import Scene

    return [f"{key}=" for key, part in keys(file_part(Scene)) if part.kind != "block"]
