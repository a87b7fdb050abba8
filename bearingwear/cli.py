"""The command line: calls the handler in `commands` of what was typed (`arguments`).

Exit status: 0; 2 for bad input, with one line on standard error; 3 where the solver could not
reach a verified answer (the file is written, its `status` says why); 4 where no preload satisfies
the requirements, or a torque margin is insufficient; 74 where not even a line can be written, on a
full disk; 130 when interrupted.
"""

from __future__ import annotations

import argparse
import atexit
import difflib
import functools
import gc
import io
import os
import re
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TextIO

from bearingwear.arguments import command_parser
from bearingwear.console import (
    BAD_INPUT,
    NOT_SOLVED,
    SUCCESS,
    ProcessEnded,
    UsageError,
    one_line,
)
from bearingwear.measures import LIMITED
from bearingwear.scene.checking.records import SCENE_SUFFIXES
from bearingwear.scene.new.scene_file import OPTIONS

FULL_DISK, INTERRUPTED = 74, 130
RENAMED = {"compare": "show A.nc B.nc"}
"""What is typed today in place of commands that are gone."""

RENAMED_OPTIONS = {"--film": "--lubrication"}
"""Options of earlier versions."""

OPTIONS_MEANT = {
    "-n": "--speed", "--n": "--speed", "--rpm": "--speed", "-d": "--bore", "--id": "--bore",
    "-D": "--outside", "--od": "--outside", "--diameter": "--outside", "--mu": "--friction",
    "--alpha": "--contact-angle", "--material": "--ball-material", "--hybrid": "--ball-material",
    "--class": "--preload-class", "--arrangement": "--pair", "--lubricant": "--lubrication",
    "--out": "--output", "--gyro": "--slip", "--noise": "--frequency",
}  # fmt: skip
"""Options by other words that people type for them."""

_KEY_OF_OPTION = {option: key for option, key, *_ in OPTIONS}
"""Keys of a scene by the options of `new`, which other commands take as `--set KEY=VALUE`."""

_NEW_OBJECTS = 100_000  # before Python looks for garbage; 700 by default


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command; return its exit status."""
    _look_for_garbage_rarely()
    if sys.stdout.errors == "strict" and isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # a locale without `°` or `–`
    try:
        status = _status(sys.argv[1:] if argv is None else argv)
        # buffered text that cannot be printed is noticed here, not when Python shuts down
        print(end="", flush=True)
        return status
    except KeyboardInterrupt:
        sys.stderr.write("interrupted\n")
        return INTERRUPTED
    except BrokenPipeError:  # `bearingwear show FILE | head`
        _drop(sys.stdout)
        return SUCCESS
    except OSError as error:  # a full disk
        _drop(sys.stdout)
        try:
            sys.stderr.write(one_line(f"bearingwear: {error.strerror or error}"))
        except OSError:
            _drop(sys.stderr)
            return FULL_DISK
        return BAD_INPUT


@functools.cache
def _look_for_garbage_rarely() -> None:
    """Saves a quarter of a short command: modules and their tables are no garbage.

    Python looks through all of them again and again while they are loaded, and twice at its end.
    """
    gc.set_threshold(_NEW_OBJECTS, *gc.get_threshold()[1:])
    atexit.register(gc.freeze)


def _status(argv: Sequence[str]) -> int:
    try:
        return _run(_parsed_arguments(argv))
    except SystemExit as stop:
        if isinstance(stop.code, str):  # of a library
            sys.stderr.write(one_line(stop.code))
        return stop.code if isinstance(stop.code, int) else BAD_INPUT


def _drop(stream: TextIO) -> None:
    """Discard what is still buffered, because Python would try to print it once more."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _parsed_arguments(argv: Sequence[str]) -> argparse.Namespace:
    if "_ARGCOMPLETE" in os.environ:  # the shell asks how a line may go on
        import argcomplete

        argcomplete.autocomplete(command_parser())
    parser = command_parser(argv[0] if argv else "")
    of_commands: Mapping[str, Any] = parser._subparsers._group_actions[0].choices  # type: ignore[union-attr,assignment]
    if argv and not argv[0].startswith("-") and argv[0] not in of_commands:
        people = [name for name in of_commands if name != "step"]
        near = difflib.get_close_matches(argv[0], people, n=2)
        allowed = f"did you mean {' or '.join(near)}" if near else f"expected {', '.join(people)}"
        if argv[0] in RENAMED:
            allowed = f"it is now bearingwear {RENAMED[argv[0]]}"
        parser.error(f"got the command {argv[0]!r}; {allowed}")
    args, left = parser.parse_known_args(argv)
    if args.command == "plot":
        _sort_plot(parser, args)
    if args.command == "study":
        args.more, left = left, []
        _check_study(of_commands["study"], args, argv)
    # `--set A=1 B=2` is read as `--set A=1 --set B=2`
    if getattr(args, "set", None) and all(re.match(r"[\w.]+=", text) for text in left):
        args.set += left
    elif left:
        command = of_commands[args.command]
        option = left[0].partition("=")[0]
        accepted = command._option_string_actions
        near = difflib.get_close_matches(option, accepted, n=2)
        if OPTIONS_MEANT.get(option) in accepted:
            near = [OPTIONS_MEANT[option]]
        hint = f"; did you mean {' or '.join(near)}" if near else _hint_on_word(left[0], argv)
        if option in RENAMED_OPTIONS:
            hint = f"; it is now {RENAMED_OPTIONS[option]}"
        if option in _KEY_OF_OPTION and "--set" in accepted:
            value = " ".join(left).removeprefix(option).lstrip(" =").partition(" ")[0]
            hint = f"; write --set {_KEY_OF_OPTION[option]}={value}"
        command.error(f"got {left[0]!r}, which this command does not accept{hint}")
    return args


def _hint_on_word(word: str, argv: Sequence[str]) -> str:
    """Returns why a word may have been typed that no option takes; "" if nothing is likely."""
    place = argv.index(word) if word in argv else 0
    if place < 2 or word.startswith("-"):
        return ""
    option, before = argv[place - 2 : place]
    if re.fullmatch(r"[-+]?[\d.,]+", before):
        return f"; numbers are typed without a unit and without spaces ({before} alone)"
    if option == "--set" and "=" not in before:
        return f"; did you mean --set {before}={word}"
    return ""


def _check_study(
    parser: argparse.ArgumentParser, args: argparse.Namespace, argv: Sequence[str]
) -> None:
    """Refuse options of a scene without one, misspelt ones, and a name after other options."""
    from bearingwear.studies.launch import DRY_RUN

    options = [measure.option for measure in LIMITED.values()] + ["--output", "--jobs"]
    typed = [text for text in args.more if text.startswith("-") and text not in DRY_RUN]
    for text in typed:
        if near := difflib.get_close_matches(text.partition("=")[0], options, n=1, cutoff=0.8):
            parser.error(
                f"got {text!r}, which this command does not accept; did you mean {near[0]}"
            )
    before = argv[: argv.index(args.name)] if args.name in argv else []
    if first := [text for text in typed if text in before]:
        parser.error(f"got {args.name} after {first[0]}, expected the name of the study first")
    of_a_scene = [m.option for key, m in LIMITED.items() if getattr(args, key) is not None]
    of_a_scene += ["--output"] if args.output is not None else []
    if of_a_scene and not args.name.endswith(SCENE_SUFFIXES):
        scene_file = Path(f"{args.name}.yaml")
        advice = f"; did you mean {scene_file}" if scene_file.is_file() else ""
        parser.error(f"got {of_a_scene[0]} without a scene; only allowed with SCENE.yaml{advice}")


def _sort_plot(parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
    """Let the file that is drawn stand after the figures: `plot -o figure.png FILE.nc`."""
    if args.file is None:
        results = [path for path in args.output if path.suffix == ".nc"]
        if len(results) != 1:
            parser.error(f"plot: got {len(results)} result files, expected one (FILE.nc)")
        (args.file,) = results
        args.output.remove(args.file)
    args.output = args.output or [args.file.with_suffix(".svg")]


def _run(args: argparse.Namespace) -> int:
    # imported here: `--help` shall not wait
    from bearingwear.atomic import OutputError
    from bearingwear.results.kinds import function
    from bearingwear.results.netcdf import CaseFileError
    from bearingwear.scene.checking.errors import NotAvailable
    from bearingwear.scene.scene import SceneError

    handler = function(args.run)
    try:
        status: int = handler(args)
        return status
    except NotAvailable as error:
        # the model knows the scene by its name, the user by its file
        problem = str(error).partition(": ")[2]
        key, _, rest = problem.partition(": ")
        at_fault = key in [text.partition("=")[0] for text in getattr(args, "set", ())]
        if key == "model.fidelity" and getattr(args, "fidelity", None):
            problem = f"--fidelity: {rest}"
        elif key == "restart":
            problem = f"--restart: {rest}"
        elif at_fault:
            problem = f"--set {problem}"
        else:
            file = args.name if args.command == "study" else args.scene
            problem = f"{file}: {problem}"
        sys.stderr.write(one_line(problem))
    except ProcessEnded as error:
        sys.stderr.write(one_line(str(error)))
        return NOT_SOLVED
    except (SceneError, CaseFileError, OutputError, UsageError) as error:
        for problem in (error, *getattr(error, "further", ())):
            sys.stderr.write(one_line(str(problem)))
    return BAD_INPUT
