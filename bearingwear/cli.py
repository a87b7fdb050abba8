"""The command line.

Exit status: 0; 1 where two files that are compared differ; 2 for bad input, with one line on
standard error; 3 where the solver could not reach a verified answer (the file is written, its
`status` says why); 130 when interrupted.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import re
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import bearingwear.io.commands
import bearingwear.report.commands
import bearingwear.study.commands
from bearingwear import __version__

if TYPE_CHECKING:
    from bearingwear.model.result import Result
    from bearingwear.model.scene import Scene

OK, BAD_INPUT, NOT_SOLVED, INTERRUPTED = 0, 2, 3, 130
FIDELITIES = ("auto", "race_control", "steady", "dynamic")


class _Parser(argparse.ArgumentParser):
    """A parser whose errors take one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(BAD_INPUT, _line(f"{self.prog}: {message}; see {self.prog} --help"))


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command; return its exit status."""
    try:
        status = _status(sys.argv[1:] if argv is None else argv)
        # buffered text that cannot be printed is noticed here, not when Python shuts down
        print(end="", flush=True)
        return status
    except KeyboardInterrupt:
        sys.stderr.write("interrupted\n")
        return INTERRUPTED
    except BrokenPipeError:  # `bearingwear show FILE | head`
        _drop_output()
        return OK
    except OSError as error:  # a full disk
        _drop_output()
        sys.stderr.write(_line(f"bearingwear: {error.strerror or error}"))
        return BAD_INPUT


def _status(argv: Sequence[str]) -> int:
    try:
        return _run(_parsed(argv))
    except SystemExit as stop:
        return stop.code if isinstance(stop.code, int) else BAD_INPUT


def _drop_output() -> None:
    """Send what is still buffered nowhere, since Python would try to print it once more."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="bearingwear",
        description="Friction and wear of high-speed angular contact ball bearings.",
        epilog="Exit status: 0, 1 where compared files differ, 2 for bad input, 3 where no "
        "verified answer was reached.",
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=f"bearingwear {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    def command(name: str, help: str, run: Callable[[argparse.Namespace], int]) -> _Parser:
        sub = commands.add_parser(name, help=help, description=help, allow_abbrev=False)
        sub.set_defaults(run=run)
        return sub

    solve = command("solve", "solve a scene and write a case file", _solve)
    life = command("life", "follow wear to the end of life and write a life file", _life)
    check = command("check", "check a scene; say which model would be solved, and why", _check)
    for sub in (solve, life, check):
        sub.add_argument("scene", metavar="SCENE.yaml", help="the scene file")
        setting = sub.add_argument(
            "--set",
            action="append",
            default=[],
            metavar="KEY=VALUE",
            help="replace a value of the scene, as in operation.preload_N=9; may be repeated",
        )
        setting.completer = _scene_keys  # type: ignore[attr-defined]
    for sub in (solve, check):
        sub.add_argument("--fidelity", choices=FIDELITIES, help="overrides model.fidelity")
    solve.add_argument(
        "--restart",
        metavar="CASE.nc",
        help="go on from the end of a dynamic case; its scene may differ in wear and model only",
    )
    for sub in (solve, life):
        sub.add_argument("-o", "--output", required=True, metavar="FILE.nc", type=_file_name)
        sub.add_argument(
            "--record-timing",
            action="store_true",
            help="store the duration of the solve (files of the same case then differ)",
        )
        sub.add_argument(
            "--record-failures",
            action="store_true",
            help="exit 0 also where the solver fails; the file's status says so",
        )
    bearingwear.io.commands.add_parser(commands)
    bearingwear.study.commands.add_parser(commands)
    bearingwear.report.commands.add_parser(commands)
    return parser


def _file_name(text: str) -> Path:
    if not os.path.basename(text):
        raise argparse.ArgumentTypeError(f"given {text!r}; allowed a file name")
    return Path(text)


def _parsed(argv: Sequence[str]) -> argparse.Namespace:
    parser = _parser()
    if "_ARGCOMPLETE" in os.environ:  # the shell asks how a line may go on
        import argcomplete

        argcomplete.autocomplete(parser)
    given, left = parser.parse_known_args(argv)
    # `--set A=1 B=2` is read as `--set A=1 --set B=2`
    if getattr(given, "set", None) and all(re.match(r"[\w.]+=", text) for text in left):
        given.set += left
    elif left:
        parser.error(f"given {left[0]!r}; allowed no such argument")
    return given


def _run(given: argparse.Namespace) -> int:
    # imported here: `--help` shall not wait
    from bearingwear.io.netcdf import CaseFileError
    from bearingwear.io.whole import OutputError
    from bearingwear.model.fidelity import NotAvailable
    from bearingwear.model.scene import SceneError

    try:
        return given.run(given)
    except NotAvailable as error:
        # the model knows the scene by its name, the user by its file
        problem = str(error).partition(": ")[2]
        key, _, rest = problem.partition(": ")
        at_fault = [k for k in [text.partition("=")[0] for text in given.set] if k == key]
        if key == "model.fidelity" and getattr(given, "fidelity", None):
            problem = f"--fidelity: {rest}"
        elif key == "restart":
            problem = f"--restart: {rest}"
        elif at_fault:
            problem = f"--set {problem}"
        else:
            problem = f"{given.scene}: {problem}"
        sys.stderr.write(_line(problem))
    except (SceneError, CaseFileError, OutputError) as error:
        sys.stderr.write(_line(str(error)))
    return BAD_INPUT


def _line(text: str) -> str:
    return "".join(c if c.isprintable() else "?" for c in text) + "\n"


def _solve(given: argparse.Namespace) -> int:
    scene = _scene(given)
    from bearingwear.model.solve import solve

    restart = _restart(scene, given) if given.restart is not None else None
    result = solve(scene, given.fidelity, restart, lambda text: _tell(f"{given.scene}: {text}"))
    return _finish(result, given)


def _restart(scene: Scene, given: argparse.Namespace) -> dict[str, Any]:
    """What a run goes on from; the scene is asked first, whether it moves in time at all."""
    from bearingwear.io.restart import restart_from
    from bearingwear.model.fidelity import choice
    from bearingwear.model.solve import check_restart

    check_restart(scene, choice(scene, given.fidelity))
    return restart_from(given.restart, scene)


def _tell(text: str) -> None:
    """Write a line at once; a run goes on where nobody reads about its progress any more."""
    with contextlib.suppress(OSError, ValueError):
        sys.stderr.write(_line(text))
        sys.stderr.flush()


def _life(given: argparse.Namespace) -> int:
    from bearingwear.io.config import for_life

    scene = for_life(_scene(given), given.scene)
    from bearingwear.model.life import life

    return _finish(life(scene), given)


def _scene(given: argparse.Namespace) -> Scene:
    from bearingwear.io.config import load_scene

    scene = load_scene(given.scene, given.set)
    if "output" in given:
        _check_output(given.output, given.scene)
    return scene


def _check_output(path: Path, scene: str) -> None:
    """Refuse, before anything is solved, an output that must not be replaced."""
    from bearingwear.io.whole import OutputError

    try:
        if path.exists():
            if not path.is_file():
                raise OutputError(f"{path}: given something that is no file; allowed a file name")
            if path.samefile(scene):
                raise OutputError(f"{path}: given the scene itself; allowed another file name")
    except OutputError:
        raise
    except OSError as error:  # a name that is too long
        raise OutputError(f"{path}: cannot be written ({error.strerror})") from None


def _finish(result: Result, given: argparse.Namespace) -> int:
    """Write the file; say so if the solver failed."""
    from bearingwear.io.netcdf import write
    from bearingwear.kernels.status import STATUS_SENTENCES

    if given.record_timing:
        result.attrs["wall_time_s"] = float(result.wall_time_s)
    write(result, given.output)
    if result.status == "ok":
        return OK
    sentence = STATUS_SENTENCES[result.status]
    sys.stderr.write(_line(f"{given.scene}: {result.status}: {sentence} (see {given.output})"))
    return OK if given.record_failures else NOT_SOLVED


def _check(given: argparse.Namespace) -> int:
    from bearingwear.model.fidelity import accuracy_told, choice, effort

    scene = _scene(given)
    chosen = choice(scene, given.fidelity)
    print(f"{given.scene}: valid; {scene.name} would be solved with {chosen.tier}")
    for reason in chosen.reasons:
        print(f"  {reason}")
    print(f"  {accuracy_told(scene, chosen)}")
    print(f"  {effort(scene, chosen)}")
    return OK


def _scene_keys(**_: Any) -> list[str]:
    """What `--set` takes, for a shell that completes it."""
    from bearingwear.io.keys import scene_keys

    return [f"{key}=" for key in scene_keys()]
