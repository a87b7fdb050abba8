"""The parser of the command line: commands, their arguments and options, and checks of values."""

from __future__ import annotations

import argparse
import itertools
import re
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

from bearingwear import __version__
from bearingwear.application import applications
from bearingwear.console import BAD_INPUT, one_line
from bearingwear.measures import LIMITED
from bearingwear.options import (
    add_case,
    add_formats,
    add_jobs,
    add_scene,
    number_in,
    positive_count,
    result_name,
    scene_keys,
)
from bearingwear.scene.checking.errors import did_you_mean, number_hint
from bearingwear.scene.checking.records import Key, Part
from bearingwear.scene.coefficients import LUBRICATIONS
from bearingwear.scene.new.assumed import BORE, CLASSES, OUTSIDE, PRELOAD_CLASSES
from bearingwear.scene.new.catalogue import MAKERS
from bearingwear.scene.new.designations import CLEARANCES
from bearingwear.scene.new.scene_file import BALL_MATERIALS, OPTIONS, PAIR_KINDS
from bearingwear.scene.scene import FIDELITIES, PRELOAD_METHODS, key_of_scene

AS_IN_DUTY = object()
"""Value of `--warmup` without a time: it stands for the time to full speed in the scene's duty."""

_CLEARANCE = Part("number", Key("", "um", "(0, 2000]"))
_FRICTION = Part("number", Key("", "1", "(0, 2]"))
_SECONDS = Part("number", Key("", "s", "[0, 1e9]"))
_DURATION = Part("number", Key("", "s", "(0, 1e9]"))
"""Units and ranges of numbers that are no keys of a scene."""

STUDIES = ("all", "design", "uncertainty", "lives", "cage", "accuracy", "robustness")
"""Studies of the workflow: names of rules that collect the results of each."""

MODELS = ("steady", "worn", "dynamic")
"""Models whose kernels `compile` compiles."""

_EXPECTED = {r"int value: '(.+)'": "a whole number", r"float value: '(.+)'": "a number"}
"""What is expected, in words, by patterns of argparse's messages on invalid numbers."""

_CHOICE = re.compile(r"invalid choice: '(.+?)' \(choose from (.+)\)")


def _integer_hint(text: str) -> str:
    """Returns how to write a whole number that was typed with decimals; "" for any other text."""
    match = re.fullmatch(r"([-+]?\d+)[.,]0*", text)
    return f"write {match[1]}" if match else ""


class _Parser(argparse.ArgumentParser):
    """A parser that reports an error in one line."""

    def error(self, message: str) -> NoReturn:
        """Prints a line that states what was given and what is expected; exits with `BAD_INPUT`."""
        message = _choice_message(_number_message(message))
        preload = re.match("argument --preload: got '([a-z]+)'", message)
        if preload and preload[1] in PRELOAD_CLASSES:
            message += f"; did you mean --preload-class {preload[1]}"
        self.exit(BAD_INPUT, one_line(f"{self.prog}: {message}; see {self.prog} --help"))


def _number_message(message: str) -> str:
    """Returns argparse's message on an invalid number in the words of this program.

    Any other message is returned unchanged.
    """
    for pattern, expected in _EXPECTED.items():
        if match := re.search(f"invalid {pattern}", message):
            typed = match[1]
            hint = _integer_hint(typed) or number_hint(typed)
            note = f" ({hint})" if hint else ""
            return f"{message[: match.start()]}got {typed!r}, expected {expected}{note}"
    return message


def _choice_message(message: str) -> str:
    """Returns argparse's message on an invalid choice in the words of this program.

    Any other message is returned unchanged.
    """
    match = _CHOICE.search(message)
    if match is None:
        return message
    typed, listed = match.groups()
    # argparse lists the empty list, which stands for no argument at all
    choices = [choice for choice in listed.replace("'", "").split(", ") if choice != "[]"]
    message = (
        f"{message[: match.start()]}got {typed!r}, expected {', '.join(choices)}"
        f"{did_you_mean(typed, choices)}"
    )
    if "argument --maker:" in message:
        message += "; designations of other makers are read without it"
    return message


def command_parser(typed: str | None = None) -> argparse.ArgumentParser:
    """Returns the parser of every command; `run` is the dotted name of its handler.

    typed: the command to parse, where that is known. Applications with other commands then get no
        options, which saves their imports.
    """
    parser = _Parser(
        prog="bearingwear",
        description="Friction and wear of high-speed angular contact ball bearings.",
        epilog="Exit status: 0 on success; 2 for bad input; 3 if no verified solution was found; "
        "4 if no preload satisfies all requirements, or a torque margin is insufficient; 74 on a "
        "full disk without room for an error line; 130 after Ctrl-C.",
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=f"bearingwear {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    def command(name: str, text: str, handler: str = "") -> argparse.ArgumentParser:
        """Adds a command, whose handler has its name by default, and returns its parser."""
        sub = commands.add_parser(name, help=text, description=text, allow_abbrev=False)
        sub.set_defaults(run=handler or f"bearingwear.commands:{name}")
        return sub

    _add_new(command("new", "write a commented scene file from a few catalogue values"))
    _add_one_scene(command)
    _add_show(
        command(
            "show", "print the main values of a result file, of two side by side, or of a scene"
        )
    )
    _add_plot(command("plot", "plot a result file"))
    _add_study(command("study", "run the study of a scene, or a study in the current folder"))
    _add_many(command)
    for application in applications():
        sub = command(application.command, application.description, application.handler)
        if typed in (None, application.command):
            application.add_options(sub)
    _add_step(commands.add_parser("step"))  # no help: rules call it, no person does
    return parser


# fmt: off
def _add_one_scene(add_command: Callable[[str, str], argparse.ArgumentParser]) -> None:
    """Adds the commands that check or solve a scene, or choose its preload.

    add_command: adds a command by its name and description, and returns its parser.
    """
    check = add_command("check", "check a scene; report its model and a table of effects")
    _add_fidelity(check)
    add_formats(check)
    add_case(check)
    solve = add_command("solve", "solve a scene and print a summary sheet; -o writes a case file")
    _add_fidelity(solve)
    solve.add_argument("--restart", metavar="CASE.nc",
        help="continue a dynamic case from its final state; the two scenes may differ only in "
        "wear, model and friction.slip_regularisation_m_s")
    add_case(solve)
    _add_result(solve, several=True)
    _add_quiet_formats(solve)
    life = add_command("life",
        "compute the wear life and print a summary sheet; -o writes a life file")
    _add_fidelity(life)
    add_case(life)
    _add_result(life)
    _add_quiet_formats(life)
    _add_uncertainty(add_command("uncertainty",
        "compute the spread in life due to the uncertain values in the scene"))
    recommend = add_command("recommend", "recommend a preload for given requirements")
    add_scene(recommend)
    _add_limits(recommend)
    add_formats(recommend)
    _add_warmup(add_command("warmup",
        "compute temperatures and preload from rest to the steady state"))


def _add_quiet_formats(sub: argparse.ArgumentParser) -> None:
    """Adds the options `--json`, `--csv` and `--quiet`, of which only one may be given."""
    add_formats(sub).add_argument("--quiet", action="store_true", help="print nothing")


def _add_sweep(sweep: argparse.ArgumentParser) -> None:
    """Adds the arguments of `sweep`."""
    sweep.add_argument("scenes", nargs="+", metavar="SCENE.yaml",
        help="a scene file, or several, whose results lie along the dimension scene")
    set_option = sweep.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
        help="replace a value in every scene; may be repeated")
    axis_option = sweep.add_argument("--axis", action="append", default=[], metavar="KEY=VALUES",
        help="values of a key, separated by commas, or LOW:HIGH:COUNT; may be repeated, and every "
        "combination is a point")
    for option in (set_option, axis_option):
        option.completer = scene_keys  # type: ignore[attr-defined]
    sweep.add_argument("--rows", metavar="FILE.csv", type=Path,
        help="a table instead of axes: its header has keys, and each row is a point")
    sweep.add_argument("--what", choices=("solve", "life"), default="solve",
        help="what to compute at each point (default: solve)")
    sweep.add_argument("--fidelity", choices=FIDELITIES, help="override model.fidelity")
    sweep.add_argument("--keep", type=_names, metavar="NAME,NAME...",
        help="variables to keep (default: all); or extremes: the life, and the worst value of each "
        "measure from new to the end of life; or study: the variables of a case in a study")
    sweep.add_argument("--part", type=_part, metavar="K/N",
        help="compute the K-th of N parts; `bearingwear gather` joins their files")
    add_jobs(sweep)
    sweep.add_argument("-n", "--dry-run", action="store_true",
        help="compute a few points and state the number of points and the expected time")
    sweep.add_argument("--record-failures", action="store_true",
        help="exit with status 0 even if no point is solved")
    sweep.add_argument("-o", "--output", metavar="FILE.nc", type=result_name,
        help="the file to write (default: SCENE-sweep.nc; of a part, SCENE-sweep-KofN.nc)")


def _add_step(step: argparse.ArgumentParser) -> None:
    """Adds the arguments of `step`."""
    step.add_argument("function", metavar="FUNCTION")
    step.add_argument("words", nargs="*", metavar="NAME=VALUE")
    step.add_argument("-o", "--output", required=True, nargs="+", metavar="FILE", type=Path)
    step.set_defaults(run="bearingwear.commands:step")


def _add_many(add_command: Callable[[str, str], argparse.ArgumentParser]) -> None:
    """Adds the commands for many cases.

    add_command: adds a command by its name and description, and returns its parser.
    """
    _add_sweep(add_command("sweep", "solve scenes or their lives at many values of their keys"))
    _add_gather(add_command("gather", "gather case files of one scene over their grid, or parts "
        "of a sweep, into one file"))
    _add_page(add_command("page", "write the report page of a study"))
    _add_compile(add_command("compile", "compile the solver in advance, not at the first solve"))


def _add_gather(gather: argparse.ArgumentParser) -> None:
    """Adds the arguments of `gather`."""
    gather.add_argument("files", nargs="+", metavar="CASE.nc", type=Path,
        help="case files that together fill a grid of preload methods, friction coefficients and "
        "wear states, or all parts of a sweep")
    gather.add_argument("-o", "--output", default=Path("gathered.nc"), metavar="FILE.nc",
        type=result_name,
        help="the file to write (default: gathered.nc)")


def _add_page(page: argparse.ArgumentParser) -> None:
    """Adds the arguments of `page`."""
    page.add_argument("results", nargs="*", metavar="FILE", type=Path,
        help="results of a study (.nc), tables (.md) and figures (.svg, .png)")
    for name, words in (
        ("answers", "answers (answer.json) that the page shows first, and their files"),
        ("docs", "documents to link"),
        ("scenes", "scene files, for their descriptions and the values that they assume"),
    ):
        page.add_argument(f"--{name}", nargs="*", default=[], metavar="FILE", type=Path, help=words)
    page.add_argument("-o", "--output", default="results/report/index.html", metavar="FILE.html",
        type=Path, help="the file to write (default: %(default)s); its links assume that it lies "
        "two folders below the study")


def _add_compile(compiling: argparse.ArgumentParser) -> None:
    """Adds the arguments of `compile`."""
    compiling.add_argument("models", nargs="*", metavar="MODEL", choices=[[], *MODELS],
        help=f"{', '.join(MODELS)} (default: all)")


def _add_new(new: argparse.ArgumentParser) -> None:
    """Adds the arguments of `new`."""
    new.add_argument("names", nargs="*", metavar="[MYBEARING.yaml] DESIGNATION",
        help="the scene file to write (default: named after the designation); an existing file is "
        "never overwritten. Designations: 70xx, 72xx, 73xx or 719xx with the suffix C, AC, A5, E, "
        "A or B, such as 7008C; 60xx, 62xx, 63xx or 6xx, such as 608; with --maker, any "
        "designation in that maker's catalogue")
    new.add_argument("--maker", choices=tuple(MAKERS),
        help="use the balls, grooves, preload classes and speed limits of this maker's bearing")
    new.add_argument("--list", nargs="+", metavar=("MAKER", "SERIES"),
        help="list the known bearings of a maker, or only those in SERIES, and exit")
    new.add_argument("--bore", type=number_in(BORE), metavar="MM",
        help="bore diameter, if no designation is given")
    new.add_argument("--outside", type=number_in(OUTSIDE), metavar="MM",
        help="outside diameter, if no designation is given")
    for option, key, metavar, text in OPTIONS:
        part = key_of_scene(key)
        assert part is not None
        number = number_in(part, key.rpartition(".")[2])
        kind: Callable[[str], float] = int if part.kind == "integer" else number
        text = f"{text} (assumed if omitted)"
        new.add_argument(option, dest=key, type=kind, metavar=metavar, help=text)
    new.add_argument("--preload-class", choices=CLASSES,
        help="preload class, as an alternative to --preload (default: light); with --maker, a "
        "class of that maker (EL, L, M, H for NSK; L, M, F for SNFA; L, M, S for GMN; default: L)")
    clearance = new.add_mutually_exclusive_group()
    clearance.add_argument("--clearance", choices=CLEARANCES,
        help="radial clearance group of a deep groove bearing, from which its free contact angle "
        "is computed (default: CN)")
    clearance.add_argument("--radial-clearance-um", dest="clearance", type=number_in(_CLEARANCE),
        metavar="UM",
        help="radial clearance, as an alternative to --clearance")
    new.add_argument("--lubrication", choices=LUBRICATIONS,
        help="sets wear and friction coefficients and their spread from the table in "
        "docs/coefficients.md; mos2 is a sputtered film (default: assumed coefficients)")
    new.add_argument("--pair", choices=tuple(PAIR_KINDS),
        help="two of these bearings on one rotor, preloaded by a spring or by a spacer (rigid); "
        "sets arrangement and the preload method (default: one bearing)")
    new.add_argument("--ball-material", choices=BALL_MATERIALS, help="material of the balls")
    new.add_argument("--preload-method", choices=PRELOAD_METHODS, help="spring or fixed position")


def _add_fidelity(sub: argparse.ArgumentParser) -> None:
    """Adds the scene and `--fidelity`."""
    add_scene(sub)
    sub.add_argument("--fidelity", choices=FIDELITIES, help="override model.fidelity")


def _add_limits(sub: argparse.ArgumentParser) -> None:
    """Adds the requirements of a preload."""
    for key, measure in LIMITED.items():
        meaning, allowed_range = measure.limit
        text = meaning[0].lower() + meaning[1:]
        metavar = {"%": "SHARE", "1": "RATIO"}.get(measure.unit)
        if metavar is None:
            text = f"{text}, {measure.unit}"
            metavar = measure.unit.upper().replace("/", "_")
        part = Part("number", Key("", measure.key_unit, allowed_range))
        sub.add_argument(measure.option, dest=key, type=number_in(part), metavar=metavar, help=text)
    sub.add_argument("--at-speed-only", action="store_true", help="apply the requirements at the "
        "speed of each case alone, not from operation.lowest_speed_rpm to that speed")
    sub.add_argument("--warmup", dest="warmup_s", type=number_in(_SECONDS), nargs="?",
        const=AS_IN_DUTY, metavar="S", help="apply the requirements to the new bearings during the "
        "warm-up, too; S is the time from rest to full speed (default: duty.start_s, else at once)")


def _add_result(sub: argparse.ArgumentParser, several: bool = False) -> None:
    """Adds the options for a result file; with `several`, also those for a file for each value."""
    if several:
        sub.add_argument("--each", metavar="KEY=VALUE,VALUE...",
            help="solve a case for each value of a key in the scene; -o then names a file for each")
    sub.add_argument("-o", "--output", metavar="FILE.nc", type=result_name,
        nargs="+" if several else None,
        help="the file to write; its folder is created if missing")
    sub.add_argument("--record-timing", action="store_true",
        help="store the solve time (result files of identical cases then differ)")
    sub.add_argument("--record-failures", action="store_true",
        help="exit with status 0 even if the solver fails, and store the reason in the file")


def _add_uncertainty(sub: argparse.ArgumentParser) -> None:
    """Adds the arguments of `uncertainty`."""
    sub.add_argument("scene", metavar="SCENE.yaml", help="the scene file")
    sub.add_argument("--friction", nargs="+", type=number_in(_FRICTION), default=[], metavar="MU",
        help="ball-race friction coefficients (default: the value in the scene)")
    sub.add_argument("--method", nargs="+", choices=PRELOAD_METHODS, default=[], metavar="METHOD",
        help=f"{' or '.join(PRELOAD_METHODS)}, or both (default: the method in the scene)")
    sub.add_argument("--samples", type=positive_count, metavar="N",
        help="number of bearings, bearings of a batch, and batches sampled, a power of two "
        "(default: 128)")
    sub.add_argument("--seed", type=int, default=1, metavar="N",
        help="random seed (default: 1)")
    sub.add_argument("-j", "--jobs", type=positive_count, metavar="N",
        help="number of parallel processes (default: one per core)")
    sub.add_argument("--record-failures", action="store_true",
        help="exit with status 0 even if no life could be computed")
    sub.add_argument("-o", "--output", metavar="FILE.nc", type=result_name,
        help="the file to write (default: SCENE-uncertainty.nc)")
    _add_quiet_formats(sub)


def _add_study(study: argparse.ArgumentParser) -> None:
    """Adds the arguments of `study`."""
    study.add_argument("name", nargs="?", default="all",
        metavar="SCENE.yaml | NAME | FILE",
        help="a scene to study (wear states, life and its spread, recommended preload, page), "
        f"the name of a study in the current folder ({', '.join(STUDIES)}), or one of its results "
        "to recompute (results/...); default: the main study")
    study.add_argument("-o", "--output", type=Path, metavar="FOLDER",
        help="folder for the study of a scene (default: the name of the scene file)")
    study.add_argument("-j", "--jobs", type=positive_count, metavar="N",
        help="number of parallel jobs (default: one per core)")
    _add_limits(study)
    study.epilog = (
        "Arguments after the name of a study are passed to Snakemake, as in `bearingwear study all "
        "--configfile other.yaml`."
    )


def _add_warmup(sub: argparse.ArgumentParser) -> None:
    """Adds the arguments of `warmup`."""
    add_scene(sub)
    add_case(sub)
    ramp = sub.add_mutually_exclusive_group()
    ramp.add_argument("--seconds", type=number_in(_SECONDS), default=None, metavar="S",
        help="time from rest to full speed, at constant acceleration (default: duty.start_s, else "
        "at once)")
    ramp.add_argument("--course", type=_course, metavar="S:RPM,S:RPM,...",
        help="times and shaft speeds, with linear changes between them")
    ramp.add_argument("--limit", nargs="+", type=_limit_of_ramp, metavar="NAME=VALUE",
        help="find the shortest ramp that satisfies pressure=GPA or preload=N from rest to the "
        "steady temperatures")
    sub.add_argument("--duration", type=number_in(_DURATION), metavar="S",
        help="time at which to end (default: once the temperatures are steady)")
    sub.add_argument("-o", "--output", metavar="FILE.nc", type=result_name,
        help="the file to write (default: SCENE-warmup.nc)")
    _add_quiet_formats(sub)


def _limit_of_ramp(text: str) -> tuple[str, float]:
    """Returns the name of a limit during a warm-up, and its value [GPa or N]: `pressure=1.8`.

    ArgumentTypeError: another name, no `=`, or a value out of its range.
    """
    name, equals, value = text.partition("=")
    if name not in ("pressure", "preload") or not equals:
        raise argparse.ArgumentTypeError(f"got {text}, expected pressure=GPA or preload=N")
    # up to the largest values that a scene takes for a pressure limit and for preload_N
    unit, allowed_range = ("GPa", "(0, 20]") if name == "pressure" else ("N", "(0, 1e7]")
    return name, number_in(Part("number", Key("", unit, allowed_range)))(value)


def _course(text: str) -> list[tuple[float, float]]:
    """Returns the pairs of time [s] and shaft speed [r/min] in a text such as `0:0,10:6000`.

    ArgumentTypeError: a pair that is not two numbers, or times that do not rise from 0.
    """
    points = []
    for pair in text.split(","):
        try:
            time, speed = map(float, pair.split(":"))
        except ValueError:
            raise argparse.ArgumentTypeError(
                f"got {text}, expected times and speeds such as 0:0,10:6000,60:12000"
            ) from None
        points.append((time, speed))
    times = [time for time, _ in points]
    are_rising = all(earlier < later for earlier, later in itertools.pairwise(times))
    if times[0] != 0.0 or not are_rising:
        raise argparse.ArgumentTypeError(f"got {text}, expected times that rise from 0")
    return points


def _add_show(sub: argparse.ArgumentParser) -> None:
    """Adds the arguments of `show`."""
    sub.add_argument("file", metavar="FILE", help="a result file of any kind, or a scene")
    sub.add_argument("second", nargs="?", metavar="B.nc",
        help="a second result file of the same kind; the differences are printed in percent")
    sub.add_argument("--all", action="store_true",
        help="also print residuals, error estimates, steps and versions")
    add_formats(sub)


def _add_plot(sub: argparse.ArgumentParser) -> None:
    """Adds the arguments of `plot`."""
    sub.add_argument("file", nargs="?", metavar="FILE.nc", type=Path, help="a result file")
    sub.add_argument("-o", "--output", nargs="+", default=[], metavar="FIGURE", type=Path,
        help="figure file; its suffix determines the format (SVG, PNG or PDF); default: FILE.svg "
             "in the folder of FILE")
    sub.add_argument("--bearing", choices=("first", "second"),
        help="which bearing of a pair to plot; required if the two bearings differ")


# fmt: on


def is_result(text: str) -> bool:
    """Whether the NAME of `bearingwear study` is a path in the folder `results`."""
    return Path(text).parts[:1] == ("results",)


def _names(text: str) -> list[str]:
    """Returns the names in a text that are separated by commas."""
    return text.split(",")


def _part(text: str) -> tuple[int, int]:
    """Returns K, the number of a part, and N, the count of all parts, of a text K/N.

    ArgumentTypeError: a text of another form. The sweep itself checks that 1 <= K <= N.
    """
    part, _, parts = text.partition("/")
    if not (part.isdecimal() and parts.isdecimal()):
        raise argparse.ArgumentTypeError(f"got {text!r}, expected K/N such as 3/10")
    return int(part), int(parts)
