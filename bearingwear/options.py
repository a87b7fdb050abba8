"""Arguments and options that several commands have, what they may be, and the scene they name."""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bearingwear.scene.checking.errors import SceneError, check_thousands, number_hint

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


def _number(text: str, within: Callable[[float], bool], allowed: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan  # within nothing
    if not within(value):
        hint = number_hint(text)
        hint = f" ({hint})" if hint else ""
        raise argparse.ArgumentTypeError(f"got {text!r}, expected a number {allowed}{hint}")
    return value


def speed(text: str) -> float:
    """Read a speed [r/min], which has no separator of thousands."""
    try:
        check_thousands("", text)
    except SceneError as error:
        raise argparse.ArgumentTypeError(error.problem) from None
    return _number(text, math.isfinite, "in r/min")


def positive(text: str) -> float:
    """Read a number above 0."""
    return _number(text, lambda value: 0.0 < value < math.inf, "> 0")


def not_negative(text: str) -> float:
    """Read a number of at least 0."""
    return _number(text, lambda value: 0.0 <= value < math.inf, ">= 0")


def share_below_one(text: str) -> float:
    """Read a number from 0 to below 1."""
    return _number(text, lambda value: 0.0 <= value < 1.0, ">= 0 and < 1")


def file_name(text: str) -> Path:
    """Read the name of a file, which is no folder."""
    if not os.path.basename(text):
        raise argparse.ArgumentTypeError(f"got {text!r}, expected a file name")
    return Path(text)


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
