"""Commands around files: new, show, compare."""

from __future__ import annotations

import argparse
from pathlib import Path

OK, DIFFERENT = 0, 1

BALL_MATERIALS = ("bearing_steel", "silicon_nitride")
PRELOAD_METHODS = ("constant_force", "fixed_position")

# What `new` takes beside bore and outside diameter: option, key of the scene, metavar, meaning.
OPTIONS = (
    ("--balls", "bearing.ball_count", "Z", "number of balls"),
    ("--ball-diameter", "bearing.ball_diameter_mm", "MM", "ball diameter"),
    ("--pitch-diameter", "bearing.pitch_diameter_mm", "MM", "pitch diameter"),
    ("--contact-angle", "bearing.contact_angle_deg", "DEG", "free contact angle"),
    ("--speed", "operation.shaft_speed_rpm", "RPM", "speed of the shaft"),
    ("--preload", "operation.preload_N", "N", "axial preload, initial"),
    ("--friction", "friction.ball_race", "MU", "Coulomb coefficient of ball and race"),
)


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Add the commands to the command line."""

    def command(name: str, text: str) -> argparse.ArgumentParser:
        return commands.add_parser(name, help=text, description=text, allow_abbrev=False)

    new = command("new", "write a commented scene from a few catalogue numbers")
    new.add_argument("file", metavar="MYBEARING.yaml", help="the scene to write; never replaced")
    new.add_argument("--bore", required=True, type=float, metavar="MM", help="bore diameter")
    new.add_argument("--outside", required=True, type=float, metavar="MM", help="outside diameter")
    for option, key, metavar, text in OPTIONS:
        kind = int if key == "bearing.ball_count" else float
        text = f"{text}; assumed if left out"
        new.add_argument(option, dest=key, type=kind, metavar=metavar, help=text)
    new.add_argument("--ball-material", choices=BALL_MATERIALS, help="material of the balls")
    new.add_argument(
        "--preload-method", choices=PRELOAD_METHODS, help="a spring or a fixed distance"
    )
    new.set_defaults(run=_new)

    show = command("show", "print the main numbers of a result file, or of a scene")
    show.add_argument("file", metavar="FILE", help="a result file of any kind, or a scene")
    show.set_defaults(run=_show)

    compare = command("compare", "say what differs between two result files; exit 1 if they do")
    compare.add_argument("first", metavar="A.nc", help="a result file")
    compare.add_argument("second", metavar="B.nc", help="another one of the same kind")
    compare.add_argument(
        "--tolerance",
        type=_share,
        default=0.0,
        metavar="SHARE",
        help="numbers no further apart than this share of their variable's largest are the same",
    )
    compare.set_defaults(run=_compare)


def _share(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0.0 <= value < 1.0:
        raise argparse.ArgumentTypeError(f"given {text!r}; allowed a number >= 0 and < 1")
    return value


def _new(given: argparse.Namespace) -> int:
    from bearingwear.io.catalogue import write_scene

    values = {key: getattr(given, key) for _, key, *_ in OPTIONS}
    known = {key: value for key, value in values.items() if value is not None}
    assumed = write_scene(
        given.file, given.bore, given.outside, known, given.ball_material, given.preload_method
    )
    print(f"{given.file}: written; assumed, and marked so in it:")
    for line in assumed:
        print(f"  {line}")
    return OK


def _show(given: argparse.Namespace) -> int:
    from bearingwear.io.summary import scene_summary, summary

    if Path(given.file).suffix in (".yaml", ".yml"):
        from bearingwear.io.config import load_scene

        text = scene_summary(load_scene(given.file))
    else:
        text = summary(given.file)
    _print(text)
    return OK


def _print(text: str) -> None:
    """Names in a file of somebody else may hold what a terminal obeys."""
    print("\n".join("".join(c if c.isprintable() else "?" for c in s) for s in text.split("\n")))


def _compare(given: argparse.Namespace) -> int:
    from bearingwear.io.difference import difference

    text, same = difference(given.first, given.second, given.tolerance)
    _print(text)
    return OK if same else DIFFERENT
