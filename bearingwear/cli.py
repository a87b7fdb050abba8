"""The command line: parses what was typed (`arguments`), and calls its handler (`commands`).

Exit status: 0 on success; 2 for bad input, with one line on standard error; 3 if the solver found
no verified solution (the `status` in the file gives the reason); 4 if no preload satisfies the
requirements, or a torque margin is insufficient; 74 on a full disk without room even for a line;
130 after an interrupt.
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
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

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
from bearingwear.scene.checking.errors import synonym
from bearingwear.scene.checking.records import SCENE_SUFFIXES
from bearingwear.scene.new.scene_file import OPTIONS

if TYPE_CHECKING:
    from bearingwear.scene.checking.errors import NotAvailable

FULL_DISK, INTERRUPTED = 74, 130
RENAMED = {"compare": "show A.nc B.nc"}
"""What to type in place of commands of earlier versions."""

RENAMED_OPTIONS = {"--film": "--lubrication"}
"""Options of earlier versions, and those that replace them."""

_KEY_OF_OPTION = {option: key for option, key, *_ in OPTIONS}
"""Keys of a scene by the options of `new`; other commands set them by `--set KEY=VALUE`."""

_GARBAGE_THRESHOLD = 100_000
"""Number of new objects after which Python looks for garbage; its default is 700."""


def main(argv: Sequence[str] | None = None) -> int:
    """Runs a command and returns its exit status, as the module's docstring explains it.

    From here on, printed characters that the locale lacks become question marks.

    argv: arguments after the name of the program; by default those of this process.
    """
    _collect_garbage_rarely()
    if sys.stdout.errors == "strict" and isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # a locale without `°` or `–`
    try:
        status = _exit_status(sys.argv[1:] if argv is None else argv)
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
def _collect_garbage_rarely() -> None:
    """Makes Python look for garbage rarely, and not as it ends.

    This saves a quarter of the time of a short command, which has no garbage. By default, Python
    searches all modules and tables many times while they are loaded, and twice as it ends.
    """
    gc.set_threshold(_GARBAGE_THRESHOLD, *gc.get_threshold()[1:])
    atexit.register(gc.freeze)


def _exit_status(argv: Sequence[str]) -> int:
    """Runs a command and returns its exit status, also if it raises SystemExit.

    A SystemExit with a message prints it as a line, and gives the status of bad input.
    """
    try:
        return _run(_parsed_arguments(argv))
    except SystemExit as stop:
        if isinstance(stop.code, str):  # libraries exit with their message
            sys.stderr.write(one_line(stop.code))
        return stop.code if isinstance(stop.code, int) else BAD_INPUT


def _drop(stream: TextIO) -> None:
    """Discards the buffered text of a stream, which Python would otherwise print as it ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _parsed_arguments(argv: Sequence[str]) -> argparse.Namespace:
    """Parses a command line; exits with one line if it has no command or an unknown argument.

    Of `study`, arguments that it does not have are stored in `more`, for Snakemake.
    """
    if "_ARGCOMPLETE" in os.environ:  # the shell asks how a line may go on
        import argcomplete

        argcomplete.autocomplete(command_parser())
    parser = command_parser(argv[0] if argv else "")
    parsers: Mapping[str, Any] = parser._subparsers._group_actions[0].choices  # type: ignore[union-attr,assignment]
    if argv and not argv[0].startswith("-") and argv[0] not in parsers:
        parser.error(f"got the command {argv[0]!r}; {_command_hint(argv[0], parsers)}")
    args, unknown = parser.parse_known_args(argv)
    if args.command == "plot":
        _sort_plot(parser, args)
    if args.command == "study":
        args.more, unknown = unknown, []
        _check_study(parsers["study"], args, argv)
    # `--set A=1 B=2` is read as `--set A=1 --set B=2`
    if getattr(args, "set", None) and all(re.match(r"[\w.]+=", text) for text in unknown):
        args.set += unknown
    elif unknown:
        command = parsers[args.command]
        hint = _argument_hint(unknown, command._option_string_actions, argv)
        command.error(f"got {unknown[0]!r}, which this command does not accept{hint}")
    return args


def _command_hint(typed: str, commands: Iterable[str]) -> str:
    """Returns advice on what to type in place of a command that does not exist."""
    if typed in RENAMED:
        return f"it is now bearingwear {RENAMED[typed]}"
    names = [name for name in commands if name != "step"]  # only rules of the workflow call `step`
    if similar := difflib.get_close_matches(typed, names, n=2):
        return f"did you mean {' or '.join(similar)}"
    return f"expected {', '.join(names)}"


def _argument_hint(unknown: Sequence[str], options: Collection[str], argv: Sequence[str]) -> str:
    """Returns advice on arguments that a command does not accept, after a semicolon, or "".

    unknown: the arguments that are not accepted; the advice is on the first one.
    options: options of the command.
    argv: the whole command line.
    """
    option, _, value = unknown[0].partition("=")
    if option in _KEY_OF_OPTION and "--set" in options:
        value = value or "".join(unknown[1:2])
        return f"; write --set {_KEY_OF_OPTION[option]}={value}"
    if option in RENAMED_OPTIONS:
        return f"; it is now {RENAMED_OPTIONS[option]}"
    if other_name := synonym(option, options):
        return f"; did you mean {other_name}"
    if similar := difflib.get_close_matches(option, options, n=2):
        return f"; did you mean {' or '.join(similar)}"
    return _word_hint(unknown[0], argv)


def _word_hint(word: str, argv: Sequence[str]) -> str:
    """Returns advice on a word that no option takes, after a semicolon, or "".

    argv: the whole command line.
    """
    place = argv.index(word) if word in argv else 0
    # an option and its value must stand before the word
    if place < 2 or word.startswith("-"):
        return ""
    option, value = argv[place - 2 : place]
    if re.fullmatch(r"[-+]?[\d.,]+", value):
        return f"; numbers are typed without a unit and without spaces ({value} alone)"
    if option == "--set" and "=" not in value:
        return f"; did you mean --set {value}={word}"
    return ""


def _check_study(
    parser: argparse.ArgumentParser, args: argparse.Namespace, argv: Sequence[str]
) -> None:
    """Exits with one line if arguments of `study` are misspelt, or do not fit together.

    Options for Snakemake come after the name of the study. Requirements and `--output` are only for
    the study of a scene.

    parser: of the command `study`.
    argv: the whole command line.
    """
    from bearingwear.studies.launch import DRY_RUN

    key_of_option = {measure.option: key for key, measure in LIMITED.items()}
    key_of_option |= {"--warmup": "warmup_s", "--output": "output"}
    options = [*key_of_option, "--at-speed-only", "--jobs"]
    snakemake_options = [text for text in args.more if text.startswith("-") and text not in DRY_RUN]
    for text in snakemake_options:
        for option in difflib.get_close_matches(text.partition("=")[0], options, n=1, cutoff=0.8):
            parser.error(f"got {text!r}, which this command does not accept; did you mean {option}")
    before_name = argv[: argv.index(args.name)] if args.name in argv else []
    for text in snakemake_options:
        if text in before_name:
            parser.error(f"got {args.name} after {text}, expected the name of the study first")
    scene_options = [
        option for option, key in key_of_option.items() if getattr(args, key) is not None
    ]
    if args.at_speed_only:
        scene_options.append("--at-speed-only")
    if scene_options and not args.name.endswith(SCENE_SUFFIXES):
        scene_file = Path(f"{args.name}.yaml")
        advice = f"; did you mean {scene_file}" if scene_file.is_file() else ""
        problem = f"got {scene_options[0]} without a scene"
        parser.error(f"{problem}; only allowed with SCENE.yaml{advice}")


def _sort_plot(parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
    """Sets `args.file` to the result file to draw, and `args.output` to its figure files.

    In `plot -o figure.png FILE.nc`, `-o` takes the result file for a figure. Without `-o`, the
    figure is an SVG beside the file. Exits with one line unless exactly one result file is named.
    """
    if args.file is None:
        files = [path for path in args.output if path.suffix == ".nc"]
        if len(files) != 1:
            parser.error(f"plot: got {len(files)} result files, expected one (FILE.nc)")
        args.file = files[0]
        args.output.remove(args.file)
    args.output = args.output or [args.file.with_suffix(".svg")]


def _run(args: argparse.Namespace) -> int:
    """Calls the handler of a command and returns its exit status.

    Errors of input are printed as lines, with the status `BAD_INPUT`. If a process ended before it
    answered, the status is `NOT_SOLVED`. Other exceptions pass.
    """
    # imported here, because `--help` does not need them
    from bearingwear.atomic import OutputError
    from bearingwear.results.kinds import imported_function
    from bearingwear.results.netcdf import CaseFileError
    from bearingwear.scene.checking.errors import NotAvailable
    from bearingwear.scene.scene import SceneError

    handler = imported_function(args.run)
    try:
        status: int = handler(args)
        return status
    except NotAvailable as error:
        sys.stderr.write(one_line(_not_available_line(error, args)))
    except ProcessEnded as error:
        sys.stderr.write(one_line(str(error)))
        return NOT_SOLVED
    except (SceneError, CaseFileError, OutputError, UsageError) as error:
        for problem in (error, *getattr(error, "further", ())):
            sys.stderr.write(one_line(str(problem)))
    return BAD_INPUT


def _not_available_line(error: NotAvailable, args: argparse.Namespace) -> str:
    """Returns the line on a scene that no model solves: the typed option or file, and the problem.

    They replace the name of the scene, with which the text of the error begins.
    """
    _, _, problem = str(error).partition(": ")
    key, _, explanation = problem.partition(": ")
    if key == "model.fidelity" and getattr(args, "fidelity", None):
        return f"--fidelity: {explanation}"
    if key == "restart":
        return f"--restart: {explanation}"
    changed_keys = [text.partition("=")[0] for text in getattr(args, "set", ())]
    if key in changed_keys:
        return f"--set {problem}"
    file = args.name if args.command == "study" else args.scene
    return f"{file}: {problem}"
