"""What each command does. Exit statuses: `cli`.

A handler takes the parsed arguments and returns the exit status. Only what a command needs is
imported, when it runs: `solve` shall not wait for xarray, nor `show` for numba.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import re
import shlex
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bearingwear.atomic import check_folder, check_output
from bearingwear.console import ProgressLines, UsageError, one_line, printable
from bearingwear.measures import LIMITED, plain
from bearingwear.scene.checking.records import SCENE_SUFFIXES
from bearingwear.scene.new.scene_file import OPTIONS

if TYPE_CHECKING:
    from bearingwear.document.document import Document
    from bearingwear.scene.scene import Scene
    from bearingwear.solvers.result import Result
    from bearingwear.studies.design.plan import DesignLimits

OK, NOT_SOLVED, INFEASIBLE = 0, 3, 4

NEXT = (
    ("check", ""),
    ("solve", ".nc"),
    ("life", "-life.nc"),
    ("uncertainty", "-uncertainty.nc"),
    ("recommend", ""),
    ("study", ""),
)
"""What is typed after `new`: the command, and how the name of its output ends."""

TO_CHOOSE_BY = ("recommend", "study")
"""Those of them that need a limit, which `new` takes from the bearing at rest."""


def new(args: argparse.Namespace) -> int:
    from bearingwear.scene.new.scene_file import usual_stiffness, write_scene

    if args.list is not None:
        return _list(args.list)
    path, designation = _file_and_designation(args.names)
    values = {key: getattr(args, key) for _, key, *_ in OPTIONS}
    known = {key: value for key, value in values.items() if value is not None}
    names = "bore outside clearance ball_material preload_method preload_class maker pair film"
    others = {name: getattr(args, name) for name in names.split()}
    check_folder(Path(path))
    _tell_of_new_folder(Path(path))
    lines = write_scene(path, given=known, designation=designation, **others)
    print(f"{path}: written; values assumed or taken from a catalogue, as marked in the file:")
    for line in lines:
        print(f"  {line}")
    for line in _tried(path):
        print(line)
    print("next:")
    limits = ["--stiffness", f"{usual_stiffness(path):g}", "--pressure", "2"]
    stem = str(Path(path).with_suffix(""))
    filmed = args.film not in (None, "none")  # which no limit is chosen by
    for name, output in NEXT:
        if filmed and name in TO_CHOOSE_BY:
            continue
        words = ["bearingwear", name, path, *(["-o", f"{stem}{output}"] if output else [])]
        print(f"  {shlex.join([*words, *(limits if name in TO_CHOOSE_BY else ())])}")
    return OK


def _list(words: list[str]) -> int:
    """The bearings of a maker."""
    from bearingwear.scene.checking.errors import SceneError, shown
    from bearingwear.scene.new.catalogue import MAKERS, listed

    maker = words[0].upper()
    if maker not in MAKERS:
        problem = f"got {shown(words[0])}, expected {', '.join(MAKERS)}"
        raise SceneError("", problem, source="--list")
    _print("\n".join(listed(maker, " ".join(words[1:]))))
    return OK


def _file_and_designation(names: list[str]) -> tuple[str, str | None]:
    """The scene's file and the designation, of words that are typed; SEA 60 is two."""
    if not names:
        from bearingwear.scene.checking.errors import SceneError

        problem = "got nothing, expected MYBEARING.yaml, a designation such as 7008C, or both"
        raise SceneError("", problem, source="new")
    file, *words = names
    if "." in file or "/" in file:
        return file, " ".join(words) or None
    designation = " ".join(names)
    return re.sub(r"[^A-Za-z0-9_-]", "", designation) + ".yaml", designation


def check(args: argparse.Namespace) -> int:
    from bearingwear.document.effects import check_document
    from bearingwear.solvers.effects.choice import choice

    scene = _scene(args)
    chosen = choice(scene, args.fidelity)
    if scene.duty is not None:
        from bearingwear.lives.duty.result import choices_of_phases

        choices_of_phases(scene, args.fidelity)
    _print_sheet(check_document(args.scene, scene, chosen), args)
    return OK


def solve(args: argparse.Namespace) -> int:
    if args.each is not None:
        return _solve_each(args)
    args.output = _only_output(args.output)
    with ProgressLines(args.scene) as tell:
        scene = _scene(args)
        from bearingwear.solvers.solve import solve as solved

        restart = _restart(scene, args) if args.restart is not None else None
        result = solved(scene, args.fidelity, restart, tell)
    return _finish(result, args)


def _only_output(paths: list[str] | None) -> str | None:
    """The one file that a solve writes."""
    if paths is None or len(paths) == 1:
        return paths[0] if paths else None
    raise UsageError(f"-o: got {len(paths)} files, expected one, or --each KEY=VALUE,VALUE...")


def _solve_each(args: argparse.Namespace) -> int:
    """A case for each value of `--each`, in a file of its own."""
    key, _, values = args.each.partition("=")
    each, outputs = values.split(","), args.output or []
    if not (key and values) or len(outputs) != len(each):
        raise UsageError(
            f"--each: got {args.each} with {len(outputs)} files after -o, expected KEY=VALUE,VALUE "
            "and a file for each value"
        )
    if args.restart is not None:
        raise UsageError("--each: got it with --restart, expected one of them")
    for path in outputs:
        check_output(path, args.scene)
    from bearingwear.results.netcdf import write_result
    from bearingwear.scene.changes import changes_of
    from bearingwear.studies.solve import solved_variants

    variants = [changes_of([*args.set, f"{key}={value}"]) for value in each]
    solved = solved_variants(args.scene, variants, args.fidelity, args.case)
    status = OK
    for result, path in zip(solved, outputs, strict=True):
        if args.record_timing:
            result.attrs["wall_time_s"] = float(result.wall_time_s)
        write_result(result, path)
        if result.status != "ok" and not args.record_failures:
            status = NOT_SOLVED
    return status


def sweep(args: argparse.Namespace) -> int:
    args.scene = args.scenes[0]  # which errors name
    if args.output is None and not args.dry_run:
        raise UsageError("-o: got nothing, expected a file, or --dry-run")
    from bearingwear.scene.changes import changes_of
    from bearingwear.scene.read import variant
    from bearingwear.studies.points_given import points_given
    from bearingwear.studies.sweep import Sweep

    changes = changes_of(args.set)
    scenes = [variant(path, changes) for path in args.scenes]
    keep = args.keep[0] if args.keep is not None and len(args.keep) == 1 else args.keep
    points = points_given(args.axis, args.rows)
    asked = Sweep.of(scenes, points, args.what, args.fidelity, keep)
    if args.dry_run:
        from bearingwear.studies.sweep_cost import cost_lines

        print("\n".join(cost_lines(asked, args.jobs, args.part[1] if args.part else 1)))
        return OK
    for path in args.scenes:
        check_output(args.output, path)
    _tell_of_new_folder(args.output)
    with ProgressLines() as tell:
        made = asked.dataset(args.jobs, tell, args.part)
    from bearingwear.results.labels import coded
    from bearingwear.studies.dataset import write_dataset
    from bearingwear.studies.sweep_dataset import sweep_warnings

    write_dataset(coded(made), args.output)
    for text in sweep_warnings(made):
        sys.stderr.write(one_line(f"{args.output}: {text}"))
    return OK if args.record_failures or (made["status"] == "ok").any() else NOT_SOLVED


def gather(args: argparse.Namespace) -> int:
    from bearingwear.results.netcdf import header
    from bearingwear.studies.dataset import write_dataset

    if "part" in header(args.files[0]):
        from bearingwear.results.labels import coded
        from bearingwear.studies.sweep_dataset import gathered_parts

        write_dataset(coded(gathered_parts(args.files)), args.output)
        return OK
    from bearingwear.studies.grid.gather import study as gathered

    write_dataset(gathered(args.files), args.output)
    return OK


def page(args: argparse.Namespace) -> int:
    from bearingwear.atomic import write_text
    from bearingwear.page.page import page as written

    write_text(args.output, written(args.results, args.docs, args.answers, args.scenes))
    return OK


def compile(args: argparse.Namespace) -> int:
    from bearingwear.arguments import MODELS
    from bearingwear.studies.compile_model import compile_model

    for model in args.models or MODELS:
        with ProgressLines(model):
            compile_model(model)
    return OK


def life(args: argparse.Namespace) -> int:
    with ProgressLines(args.scene) as tell:
        from bearingwear.scene.read import for_life

        scene = for_life(_scene(args), args.scene)
        from bearingwear.lives.life import life as lived

        result = lived(scene, args.fidelity, tell)
    return _finish(result, args)


def uncertainty(args: argparse.Namespace) -> int:
    check_output(args.output, args.scene)
    with ProgressLines(args.scene) as tell:
        from bearingwear.studies.dataset import write_dataset
        from bearingwear.studies.sampling import SAMPLES, usable_cores
        from bearingwear.studies.uncertainty.quantiles import uncertain_lives

        found = uncertain_lives(
            args.scene,
            frictions=args.friction,
            methods=args.method,
            samples=SAMPLES if args.samples is None else args.samples,
            seed=args.seed,
            workers=args.jobs or usable_cores(),
            tell=tell,
        )
    _tell_of_new_folder(args.output)
    write_dataset(found, args.output)
    if not (found["solved_share"] > 0.0).any():
        sys.stderr.write(one_line(f"{args.scene}: no life could be computed (see {args.output})"))
        return OK if args.record_failures else NOT_SOLVED
    if not args.quiet:
        _print_file(args.output, args)
    return OK


def cage(args: argparse.Namespace) -> int:
    scene = _scene(args)
    from bearingwear.scene.checking.check import record
    from bearingwear.studies.cage.life import cage_found
    from bearingwear.studies.cage.plan import Ensemble
    from bearingwear.studies.sampling import usable_cores

    names = ("runs", "within", "seed", "least_turns", "most_turns")
    given = {name: getattr(args, name) for name in names if getattr(args, name) is not None}
    plan = record(Ensemble, given, "cage")
    _tell_of_new_folder(args.output)
    with ProgressLines(args.scene) as tell:
        workers = args.jobs or usable_cores()
        found = cage_found(scene, plan, args.life, workers, tell, args.output)
    if not args.quiet:
        _print_file(args.output, args)
    if (found["status"] == 0).any():
        return OK
    sys.stderr.write(one_line(f"{args.scene}: none of the cage runs succeeded"))
    return OK if args.record_failures else NOT_SOLVED


def calibrate(args: argparse.Namespace) -> int:
    from bearingwear.scene.read import load_scene
    from bearingwear.studies.sampling import usable_cores
    from bearingwear.studies.uncertainty.calibration import calibrated, files_of

    data = files_of(args.output)
    check_output(data, args.scene)
    with ProgressLines() as tell:
        found = calibrated(load_scene(args.scene, args.set), args.tests, usable_cores(), tell)
    _tell_of_new_folder(args.output)
    found.write(args.output)
    _print_file(data, args)
    _tell(f"{args.output}: calibrated scene; {data}: results, for `show` and `plot`")
    return OK


def recommend(args: argparse.Namespace) -> int:
    with ProgressLines(args.scene) as tell:
        from bearingwear.studies.solve import life_scene

        scene = life_scene(args.scene, args.set, films=True)
        from bearingwear.studies.design.document.sheets import preload_document
        from bearingwear.studies.design.recommend import best_method, recommended
        from bearingwear.studies.sampling import usable_cores

        limits = _limits(args, scene)
        found, lives = recommended(scene, limits, args.scene, usable_cores(), tell)
        sheet = preload_document(found, lives)
    if lives is not None and not (lives["status"] == OK).any():
        sys.stderr.write(one_line(f"{args.scene}: no life could be computed at any preload"))
        return NOT_SOLVED
    _print_sheet(sheet, args)
    if not limits.given or best_method(found) is not None:
        return OK
    sys.stderr.write(one_line(f"{args.scene}: no preload satisfies all requirements"))
    return INFEASIBLE


def launch(args: argparse.Namespace) -> int:
    from bearingwear.document.launch import launch_document
    from bearingwear.lives.margin import launched_by_wear
    from bearingwear.solvers.bearing.launch import check_launch

    given = {"axial": args.axial, "radial": args.radial}
    args.set += [f"launch.{way}_g={g:g}" for way, g in given.items() if g is not None]
    scene = _scene(args)
    check_launch(scene, args.scene)
    _print_sheet(launch_document(scene, launched_by_wear(scene)), args)
    return OK


def margin(args: argparse.Namespace) -> int:
    given = {"torque_Nm": args.drive, "standard": args.standard, "data": args.data}
    args.set += [f"drive.{key}={value}" for key, value in given.items() if value is not None]
    scene = _scene(args)
    if scene.drive is None:
        raise UsageError(f"{args.scene}: drive: got nothing, expected a drive block or --drive N_M")
    from bearingwear.document.margin import margin_document, worst_corner
    from bearingwear.lives.margin import torque_corners

    corners = torque_corners(scene)
    _print_sheet(margin_document(scene, corners), args)
    if worst_corner(corners).margin < 0.0:
        return INFEASIBLE
    return OK if all(corner.torque == corner.torque for corner in corners) else NOT_SOLVED


def warmup(args: argparse.Namespace) -> int:
    scene = _scene(args)
    from bearingwear.solvers.warmup.transient import course_of, ramp
    from bearingwear.studies.dataset import write_dataset
    from bearingwear.studies.warmup.result import warm_up_dataset

    check_output(args.output, args.scene)
    with ProgressLines(args.scene):
        seconds = scene.start_s if args.seconds is None else args.seconds
        if args.limit:
            from bearingwear.studies.warmup.shortest_ramp import shortest_ramp

            if (shortest := shortest_ramp(scene, dict(args.limit))) is None:
                sys.stderr.write(one_line(f"{args.scene}: no ramp to speed keeps these limits"))
                return NOT_SOLVED
            seconds = shortest
        course = course_of(scene, args.course) if args.course else ramp(seconds)
        found = warm_up_dataset(scene, course, args.duration)
    _tell_of_new_folder(args.output)
    write_dataset(found, args.output)
    if not args.quiet:
        _print_file(args.output, args)
    return OK if found["status"] == 0 else NOT_SOLVED


def export(args: argparse.Namespace) -> int:
    from bearingwear.atomic import write_text
    from bearingwear.studies.export import NotExported, StiffnessOverSpeed

    scene, path = _scene(args), Path(args.output)
    if path.suffix not in (".csv", ".toml"):
        raise UsageError(f"-o: got {args.output}, expected a name that ends in .csv or .toml")
    try:
        found = StiffnessOverSpeed.of(scene, args.speeds)
    except NotExported as error:
        sys.stderr.write(one_line(f"{args.scene}: {error}"))
        return NOT_SOLVED
    name = re.sub(r"[^A-Za-z0-9_-]", "_", path.stem)
    more = args.bearing, args.tilt, args.damping, args.node, args.ross
    _tell_of_new_folder(path)
    write_text(path, found.csv if path.suffix == ".csv" else found.toml(name, *more))
    print(f"{path}: written; dynamic stiffness at {len(args.speeds)} speeds")
    return OK


def show(args: argparse.Namespace) -> int:
    if args.second is not None:
        from bearingwear.document.comparison import comparison_sheet
        from bearingwear.studies import STUDY_SHEETS

        _print_sheet(comparison_sheet(args.file, args.second, STUDY_SHEETS, args.all), args)
    elif args.file.endswith(SCENE_SUFFIXES):
        from bearingwear.document.show import scene_sheet
        from bearingwear.scene.read import load_scene

        _print_sheet(scene_sheet(load_scene(args.file)), args)
    else:
        _print_file(args.file, args, args.all)
    return OK


def plot(args: argparse.Namespace) -> int:
    from bearingwear.plotting.plot import plot as draw
    from bearingwear.studies import STUDY_PLOTS

    for path in args.output:
        check_folder(path)
        _tell_of_new_folder(path)
    draw(args.file, args.output, STUDY_PLOTS, args.bearing)
    for path in args.output:
        print(f"{path}: written")
    return OK


def study(args: argparse.Namespace) -> int:
    from bearingwear.arguments import is_result
    from bearingwear.studies.launch import DRY_RUN, run_own_study, run_study
    from bearingwear.studies.sampling import usable_cores

    jobs = args.jobs or usable_cores()
    if not args.name.endswith(SCENE_SUFFIXES):
        again = ["--force"] if is_result(args.name) else []
        return run_study(args.name, jobs, [*args.more, *again, "--rerun-incomplete"])
    from bearingwear.scene.read import load_scene
    from bearingwear.studies.own_study import write_study

    file = Path(args.name)
    folder = args.output or Path(file.stem)
    check_folder(folder / file.name)
    with contextlib.ExitStack() as stack:
        if DRY_RUN & {*args.more} and not folder.exists():  # it makes no folder
            folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        with ProgressLines(args.name):
            write_study(file, folder, _limits(args, load_scene(file)))
        status, page = run_own_study(folder, jobs, args.more)
    if page:
        _print(f"page: {page}")
    return status


def step(args: argparse.Namespace) -> int:
    """Call a function for a rule of the workflow."""
    from bearingwear.studies.run_step import NotSolved, run_step

    try:
        run_step(args.function, args.words, args.output)
    except NotSolved as error:
        sys.stderr.write(f"{error}\n")
        return NOT_SOLVED
    return OK


def _tried(path: str) -> list[str]:
    """How the scene that was written solves: its status, and what is to be warned of."""
    from bearingwear.kernels.build.folder import compile_time, is_compiled
    from bearingwear.results.warnings import warning_lines
    from bearingwear.solvers.effects.choice import LARGEST_KERNEL

    if not is_compiled(LARGEST_KERNEL["steady"]):
        return [
            "not solved yet: the first solve must compile the solver, which takes up to "
            f"{compile_time()}"
        ]
    from bearingwear.scene.read import load_scene
    from bearingwear.solvers.solve import solve as solved

    scene = load_scene(path)
    result = solved(scene)
    if result.status != "ok":
        return [f"cannot be solved ({result.status}): {result.reason}"]
    pressure = 1e-9 * float(result.values["maximum_pressure"].max())
    lines = [f"{result.reason}: maximum pressure {pressure:.3g} GPa"]
    if scene.bearing.maker is not None:
        from bearingwear.solvers.bearing.at_rest import RestingPair

        pair = RestingPair.of(scene)
        axial, radial = (1e-6 * one for one in pair.rigidity)
        lines.append(
            f"stiffness of a rigid pair of these bearings at rest: {axial:.3g} N/um axial, "
            f"{radial:.3g} N/um radial; an axial force of {plain(pair.lift_off)} N unloads one "
            "bearing"
        )
    return lines + [f"  {line}" for line in warning_lines(result.attrs)]


def _limits(args: argparse.Namespace, scene: Scene) -> DesignLimits:
    """The limits that are given for a scene, by the options of the table of measures."""
    from bearingwear.arguments import AS_IN_DUTY
    from bearingwear.scene.checking.check import record
    from bearingwear.studies.design.plan import DesignLimits

    given = {name: getattr(args, name) for name in LIMITED}
    warmup_s = scene.start_s if args.warmup_s is AS_IN_DUTY else args.warmup_s
    given |= {"at_speed_only": args.at_speed_only, "warmup_s": warmup_s}
    return record(DesignLimits, {k: v for k, v in given.items() if v is not None}, "limits")


def _restart(scene: Scene, args: argparse.Namespace) -> dict[str, Any]:
    """The file of `--restart`; first checks that the scene is solved by the dynamic model."""
    from bearingwear.results.restart import restart_from
    from bearingwear.solvers.effects.choice import choice
    from bearingwear.solvers.solve import check_restart

    check_restart(scene, choice(scene, args.fidelity))
    return restart_from(args.restart, scene)


def _tell(text: str) -> None:
    """Write a line at once; a run goes on where nobody reads about its progress any more."""
    with contextlib.suppress(OSError, ValueError):
        sys.stderr.write(one_line(text))
        sys.stderr.flush()


def _scene(args: argparse.Namespace) -> Scene:
    from bearingwear.scene.read import load_scene

    scene = load_scene(args.scene, args.set)
    if (case := getattr(args, "case", None)) is not None:
        from bearingwear.scene.cases import in_case

        scene = in_case(scene, case, "--case")
    if getattr(args, "output", None) is not None:
        check_output(args.output, args.scene)
    return scene


def _tell_of_new_folder(path: Path) -> None:
    """Tell of folders that are made, since a name may be mistyped."""
    if not path.parent.exists():
        _tell(f"{path.parent}: new folder")


def _finish(result: Result, args: argparse.Namespace) -> int:
    """Write the file, print the sheet; say so if the solver failed."""

    if args.record_timing:
        result.attrs["wall_time_s"] = float(result.wall_time_s)
    if args.output is not None:
        from bearingwear.results.netcdf import write_result

        _tell_of_new_folder(args.output)
        write_result(result, args.output)
    if args.quiet or args.json or args.csv:  # the sheet as text has them
        _warn(result.attrs)
    if not args.quiet:
        from bearingwear.document.show import sheet, sheet_of_result

        _print_sheet(sheet(args.output) if args.output else sheet_of_result(result), args)
    if result.status == "ok":
        return OK
    where = f" (see {args.output})" if args.output else ""
    sys.stderr.write(one_line(f"{args.scene}: {result.status}: {result.reason}{where}"))
    return OK if args.record_failures else NOT_SOLVED


def _print_sheet(sheet: Document, args: argparse.Namespace) -> None:
    from bearingwear.document.data import as_csv, as_json
    from bearingwear.document.text import as_text

    if args.csv and isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(encoding="utf-8")  # whatever the locale, as files are
    render = as_json if args.json else as_csv if args.csv else as_text
    _print(render(sheet))


def _print_file(path: str | Path, args: argparse.Namespace, every: bool = False) -> None:
    """The sheet of a result file of any kind."""
    from bearingwear.document.show import sheet
    from bearingwear.studies import STUDY_SHEETS

    _print_sheet(sheet(path, STUDY_SHEETS, every), args)


def _warn(attributes: Mapping[str, Any]) -> None:
    from bearingwear.results.warnings import warning_lines

    for line in warning_lines(attributes):
        _tell(line)


def _print(text: str) -> None:
    """Mask control characters: names in a foreign file may hold some."""
    print("\n".join(map(printable, text.split("\n"))))
