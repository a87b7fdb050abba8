"""Handlers of the commands. Exit statuses: `cli`.

A handler takes the parsed arguments and returns the exit status. It imports only what it needs, so
that `solve` does not wait for xarray, nor `show` for numba.
"""

from __future__ import annotations

import argparse
import contextlib
import re
import shlex
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bearingwear.atomic import check_folder, check_output
from bearingwear.console import (
    INFEASIBLE,
    NOT_SOLVED,
    SUCCESS,
    ProgressLines,
    UsageError,
    one_line,
)
from bearingwear.kernels.status import OK
from bearingwear.measures import LIMITED, plain
from bearingwear.options import given_scene, output_of
from bearingwear.printing import (
    print_file,
    print_sheet,
    print_text,
    print_warnings,
    tell_of_file,
    tell_of_new_folder,
)
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.records import SCENE_SUFFIXES
from bearingwear.scene.new.catalogue import MAKERS
from bearingwear.scene.new.letters import OTHER_MAKERS
from bearingwear.scene.new.scene_file import OPTIONS

if TYPE_CHECKING:
    from bearingwear.scene.new.scene_file import UsualLimits
    from bearingwear.scene.scene import Scene
    from bearingwear.solvers.result import Result
    from bearingwear.studies.design.plan import DesignLimits

NEXT = (
    ("check", ""),
    ("solve", ".nc"),
    ("life", "-life.nc"),
    ("uncertainty", "-uncertainty.nc"),
    ("recommend", ""),
    ("study", ""),
)
"""Commands that `new` suggests next, each with the end of the name of its output."""

TO_CHOOSE_BY = ("recommend", "study")
"""Commands of `NEXT` with requirements, which `new` estimates from the bearing at rest."""


def new(args: argparse.Namespace) -> int:
    """Writes a scene file, solves it once and suggests the next commands.

    It is not solved if that would first compile the solver. With `--list`, bearings are printed
    instead.
    """
    from bearingwear.scene.new.scene_file import usual_limits, write_scene
    from bearingwear.scene.read import load_scene

    if args.list is not None:
        return _print_bearings(args.list)
    path, designation = _file_and_designation(args.names)
    if designation is None and args.bore is None and args.outside is None:
        name = Path(path).stem
        example = f"`bearingwear new {path} {name if re.search('[0-9]{3}', name) else '7008C'}`"
        problem = f"got no designation, expected {example}, or --bore and --outside"
        raise SceneError("", problem, source="new")
    values = {key: getattr(args, key) for _, key, *_ in OPTIONS}
    check_folder(Path(path))
    tell_of_new_folder(Path(path))
    assumptions = write_scene(
        path,
        given={key: value for key, value in values.items() if value is not None},
        designation=designation,
        bore=args.bore,
        outside=args.outside,
        clearance=args.clearance,
        ball_material=args.ball_material,
        preload_method=args.preload_method,
        preload_class=args.preload_class,
        maker=args.maker,
        lubrication=args.lubrication,
        pair=args.pair,
    )
    print(f"{path}: written; values assumed or taken from a catalogue, as marked in the file:")
    for line in assumptions:
        print(f"  {line}")
    for line in _trial_lines(path):
        print(line)
    print("next:")
    for line in _next_commands(path, usual_limits(load_scene(path))):
        print(f"  {line}")
    return SUCCESS


def _next_commands(path: str, limits: UsualLimits) -> list[str]:
    """Returns the commands that a new scene file suggests, as lines for a shell.

    limits: requirements of stiffness [N/um] and pressure [GPa], options of `recommend` and `study`.
    """
    stem = str(Path(path).with_suffix(""))
    lines = []
    for command, output in NEXT:
        words = ["bearingwear", command, path]
        if output:
            words += ["-o", f"{stem}{output}"]
        if command in TO_CHOOSE_BY:
            words += ["--stiffness", f"{limits.stiffness:g}", "--pressure", f"{limits.pressure:g}"]
        lines.append(shlex.join(words))
    return lines


def _print_bearings(words: list[str]) -> int:
    """Prints the bearings in a maker's catalogue, and returns the exit status.

    words: values of `--list`: the maker and, optionally, the beginning of the designations.
    """
    from bearingwear.scene.checking.errors import shown
    from bearingwear.scene.new.catalogue import bearings_table

    maker, *series = words
    if maker.upper() not in MAKERS:
        problem = f"got {shown(maker)}, expected {', '.join(MAKERS)}"
        raise SceneError("", problem, source="--list")
    print_text("\n".join(bearings_table(maker.upper(), " ".join(series))))
    return SUCCESS


def _file_and_designation(names: list[str]) -> tuple[str, str | None]:
    """Returns the scene's file and the designation in the typed words of `new`.

    If no file is typed, it is named after the designation. If no designation is typed, it is None.

    names: words in the order of typing; the file may also come last, and the designation may have
        spaces.
    SceneError: no word, or a word without a suffix in place of the file.
    """
    if not names:
        problem = "got nothing, expected MYBEARING.yaml, a designation such as 7008C, or both"
        raise SceneError("", problem, source="new")
    are_scenes = [name.endswith(SCENE_SUFFIXES) for name in names]
    if are_scenes[-1] and not are_scenes[0]:
        names = [names[-1], *names[:-1]]  # 7008C mine.yaml
    file, *words = names
    designation = " ".join(names)
    if "." in file or ("/" in file and not _is_designation(designation)):
        return file, " ".join(words) or None
    is_maker = file.upper() in (*MAKERS, *OTHER_MAKERS)
    if words and re.search("[a-z]", file) and not is_maker:
        problem = f"got {file}, expected {file}.yaml as the scene file before the designation"
        raise SceneError("", problem, source="new")
    return re.sub(r"[^A-Za-z0-9_-]", "", designation) + ".yaml", designation


def check(args: argparse.Namespace) -> int:
    """Prints the model and the table of effects of a scene."""
    from bearingwear.document.effects import check_document
    from bearingwear.solvers.effects.choice import choice

    scene = given_scene(args)
    model = choice(scene, args.fidelity)
    if scene.duty is not None:
        from bearingwear.lives.duty.result import choices_of_phases

        choices_of_phases(scene, args.fidelity)  # refuses phases without a common steady model
    print_sheet(check_document(args.scene, scene, model), args)
    return SUCCESS


def solve(args: argparse.Namespace) -> int:
    """Solves a scene, or a case for each value of `--each`, and reports the results."""
    if args.each is not None:
        return _solve_each(args)
    args.output = _only_output(args.output)
    with ProgressLines(args.scene) as tell:
        scene = given_scene(args)
        from bearingwear.solvers.solve import solve as solved_result

        restart = _restart_state(scene, args) if args.restart is not None else None
        result = solved_result(scene, args.fidelity, restart, tell)
    return _finish(result, args)


def _only_output(paths: list[str] | None) -> str | None:
    """Returns the file that -o names, None if there is none. UsageError: several files."""
    if paths is None:
        return None
    if len(paths) > 1:
        raise UsageError(f"-o: got {len(paths)} files, expected one, or --each KEY=VALUE,VALUE...")
    return paths[0]


def _solve_each(args: argparse.Namespace) -> int:
    """Solves a case for each value of `--each`, and writes each to its own file.

    Returns `NOT_SOLVED` if any case has no solution, unless `--record-failures` is set.

    UsageError: `--each` is no KEY=VALUE,VALUE..., the values and files differ in number, or
    `--restart` is given as well.
    """
    key, _, values_text = args.each.partition("=")
    values, outputs = values_text.split(","), args.output or []
    if not (key and values_text) or len(outputs) != len(values):
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

    variants = [changes_of([*args.set, f"{key}={value}"]) for value in values]
    results = solved_variants(args.scene, variants, args.fidelity, args.case)
    status = SUCCESS
    for result, path in zip(results, outputs, strict=True):
        if args.record_timing:
            result.attrs["wall_time_s"] = float(result.wall_time_s)
        write_result(result, path)
        if result.status != "ok" and not args.record_failures:
            status = NOT_SOLVED
    return status


def sweep(args: argparse.Namespace) -> int:
    """Solves scenes at many values of their keys, and writes a dataset of the results.

    Returns `NOT_SOLVED` if no point is solved, unless `--record-failures` is set. A dry run only
    prints the number of points and the expected time.
    """
    args.scene = args.scenes[0]  # the file that messages name
    part, parts = args.part or (1, 1)
    args.output = output_of(args, f"-sweep-{part}of{parts}.nc" if args.part else "-sweep.nc")
    from bearingwear.scene.changes import changes_of
    from bearingwear.scene.read import variant
    from bearingwear.studies.sweep import Sweep
    from bearingwear.studies.typed_points import typed_points

    changes = changes_of(args.set)
    scenes = [variant(path, changes) for path in args.scenes]
    # one word may be `extremes` or `study`, which stand for variables
    keep = args.keep[0] if args.keep is not None and len(args.keep) == 1 else args.keep
    points = typed_points(args.axis, args.rows)
    planned = Sweep.of(scenes, points, args.what, args.fidelity, keep)
    if args.dry_run:
        from bearingwear.studies.sweep_cost import cost_lines

        print("\n".join(cost_lines(planned, args.jobs, parts)))
        return SUCCESS
    for path in args.scenes:
        check_output(args.output, path)
    tell_of_new_folder(args.output)
    with ProgressLines() as tell:
        results = planned.dataset(args.jobs, tell, args.part)
    from bearingwear.results.labels import coded
    from bearingwear.studies.dataset import write_dataset
    from bearingwear.studies.sweep_dataset import sweep_warnings

    write_dataset(coded(results), args.output)
    tell_of_file(args)
    for text in sweep_warnings(results):
        sys.stderr.write(one_line(f"{args.output}: {text}"))
    return SUCCESS if args.record_failures or (results["status"] == "ok").any() else NOT_SOLVED


def gather(args: argparse.Namespace) -> int:
    """Joins case files, or the parts of a sweep, into one file."""
    from bearingwear.results.netcdf import header
    from bearingwear.studies.dataset import write_dataset

    if "part" in header(args.files[0]):  # an attribute of the parts of a sweep alone
        from bearingwear.results.labels import coded
        from bearingwear.studies.sweep_dataset import gathered_parts

        write_dataset(coded(gathered_parts(args.files)), args.output)
        return SUCCESS
    from bearingwear.studies.grid.gather import gathered_study

    write_dataset(gathered_study(args.files), args.output)
    return SUCCESS


def page(args: argparse.Namespace) -> int:
    """Writes the report page of a study."""
    from bearingwear.atomic import write_text
    from bearingwear.page.page import page as page_html

    write_text(args.output, page_html(args.results, args.docs, args.answers, args.scenes))
    return SUCCESS


def compile(args: argparse.Namespace) -> int:
    """Compiles the kernels of the named models, or of all."""
    from bearingwear.arguments import MODELS
    from bearingwear.studies.compile_model import compile_model

    for model in args.models or MODELS:
        with ProgressLines(model):
            compile_model(model)
    return SUCCESS


def life(args: argparse.Namespace) -> int:
    """Computes the life of a scene, and reports the result."""
    with ProgressLines(args.scene) as tell:
        from bearingwear.scene.read import scene_for_life

        scene = scene_for_life(given_scene(args), args.scene)
        from bearingwear.lives.life import life as life_result

        result = life_result(scene, args.fidelity, tell)
    return _finish(result, args)


def uncertainty(args: argparse.Namespace) -> int:
    """Computes the spread in life, writes a file and prints its sheet.

    Returns `NOT_SOLVED` if no life could be computed, unless `--record-failures` is set.
    """
    args.output = output_of(args, "-uncertainty.nc")
    check_output(args.output, args.scene)
    with ProgressLines(args.scene) as tell:
        from bearingwear.studies.dataset import write_dataset
        from bearingwear.studies.sampling import SAMPLES, usable_cores
        from bearingwear.studies.uncertainty.quantiles import uncertain_lives

        spread = uncertain_lives(
            args.scene,
            frictions=args.friction,
            methods=args.method,
            samples=SAMPLES if args.samples is None else args.samples,
            seed=args.seed,
            workers=args.jobs or usable_cores(),
            tell=tell,
        )
    tell_of_new_folder(args.output)
    write_dataset(spread, args.output)
    tell_of_file(args)
    if not (spread["solved_share"] > 0.0).any():
        sys.stderr.write(one_line(f"{args.scene}: no life could be computed (see {args.output})"))
        return SUCCESS if args.record_failures else NOT_SOLVED
    if not args.quiet:
        print_file(args.output, args)
    return SUCCESS


def recommend(args: argparse.Namespace) -> int:
    """Prints the recommended preload of a scene; without requirements, lives over preload.

    Returns `INFEASIBLE` if no preload satisfies the requirements, and `NOT_SOLVED` if there are no
    requirements and no life could be computed.
    """
    with ProgressLines(args.scene) as tell:
        from bearingwear.studies.solve import life_scene

        scene = life_scene(args.scene, args.set, films=True)
        from bearingwear.studies.design.document.sheets import preload_document
        from bearingwear.studies.design.recommend import best_method, recommendation_and_map
        from bearingwear.studies.sampling import usable_cores

        limits = _design_limits(args, scene)
        recommendation, lives = recommendation_and_map(
            scene, limits, args.scene, usable_cores(), tell
        )
        sheet = preload_document(recommendation, lives)
    if lives is not None and not (lives["status"] == OK).any():
        sys.stderr.write(one_line(f"{args.scene}: no life could be computed at any preload"))
        return NOT_SOLVED
    print_sheet(sheet, args)
    if not limits.given or best_method(recommendation) is not None:
        return SUCCESS
    sys.stderr.write(one_line(f"{args.scene}: no preload satisfies all requirements"))
    return INFEASIBLE


def warmup(args: argparse.Namespace) -> int:
    """Computes a warm-up, writes a file and prints its sheet.

    With `--limit`, the ramp is the shortest that satisfies the limits. Returns `NOT_SOLVED` if
    there is none, without a file, or if the status of the warm-up is not ok.
    """
    args.output = output_of(args, "-warmup.nc")
    scene = given_scene(args)
    from bearingwear.scene.warmth import check_heat_capacities
    from bearingwear.solvers.warmup.transient import course_of, ramp
    from bearingwear.studies.dataset import write_dataset
    from bearingwear.studies.warmup.result import warm_up_dataset

    check_heat_capacities(scene.symmetric_half.sides, args.scene)
    check_output(args.output, args.scene)
    with ProgressLines(args.scene):
        seconds = scene.start_s if args.seconds is None else args.seconds
        if args.limit:
            seconds = _shortest_ramp_seconds(scene, args)
            if seconds is None:
                return NOT_SOLVED
        course = course_of(scene, args.course) if args.course else ramp(seconds)
        temperatures = warm_up_dataset(scene, course, args.duration)
    tell_of_new_folder(args.output)
    write_dataset(temperatures, args.output)
    tell_of_file(args)
    if not args.quiet:
        print_file(args.output, args)
    return SUCCESS if temperatures["status"] == OK else NOT_SOLVED


def _shortest_ramp_seconds(scene: Scene, args: argparse.Namespace) -> float | None:
    """Returns the time [s] of the shortest ramp to speed that satisfies `--limit`, or None.

    A line on standard error states that no ramp does, or names longer ramps that do not.
    """
    from bearingwear.studies.warmup.shortest_ramp import shortest_ramp

    shortest = shortest_ramp(scene, dict(args.limit))
    if shortest is None:
        sys.stderr.write(one_line(f"{args.scene}: no ramp to speed keeps these limits"))
        return None
    if shortest.broken_by:
        words = ", ".join(f"{longer:g} s" for longer in shortest.broken_by)
        text = f"a ramp of {shortest.seconds:g} s keeps these limits, but one of {words} does not"
        sys.stderr.write(one_line(f"{args.scene}: {text}"))
    return shortest.seconds


def show(args: argparse.Namespace) -> int:
    """Prints the sheet of a file or a scene, or those of two files side by side."""
    if args.second is not None:
        from bearingwear.document.comparison import comparison_sheet
        from bearingwear.studies import STUDY_SHEETS

        print_sheet(comparison_sheet(args.file, args.second, STUDY_SHEETS, args.all), args)
    elif args.file.endswith(SCENE_SUFFIXES):
        from bearingwear.document.show import scene_sheet
        from bearingwear.scene.read import load_scene

        print_sheet(scene_sheet(load_scene(args.file)), args)
    else:
        print_file(args.file, args, args.all)
    return SUCCESS


def plot(args: argparse.Namespace) -> int:
    """Draws a result file into figure files, and prints their names."""
    from bearingwear.plotting.plot import plot as draw_file
    from bearingwear.studies import STUDY_PLOTS

    for path in args.output:
        check_folder(path)
        tell_of_new_folder(path)
    draw_file(args.file, args.output, STUDY_PLOTS, args.bearing)
    for path in args.output:
        print(f"{path}: written")
    return SUCCESS


def study(args: argparse.Namespace) -> int:
    """Runs a study of the workflow, or the study of a scene, and returns the exit status.

    A result that is named as a file is recomputed.
    """
    from bearingwear.arguments import is_result
    from bearingwear.studies.launch import check_arguments, run_study
    from bearingwear.studies.sampling import usable_cores

    jobs = args.jobs or usable_cores()
    is_study_of_scene = args.name.endswith(SCENE_SUFFIXES)
    check_arguments(args.more, is_study_of_scene)
    if is_study_of_scene:
        return _study_of_scene(args, jobs)
    force_options = ["--force"] if is_result(args.name) else []
    return run_study(args.name, jobs, [*args.more, *force_options, "--rerun-incomplete"])


def _study_of_scene(args: argparse.Namespace, jobs: int) -> int:
    """Runs the study of one scene, prints its findings and page, and returns the exit status.

    The status is that of Snakemake, or `INFEASIBLE` if the study succeeds and no preload satisfies
    the requirements. A dry run makes no page, and leaves no new folder.
    """
    from bearingwear.scene.read import load_scene
    from bearingwear.studies.launch import DRY_RUN, own_headlines, run_own_study
    from bearingwear.studies.own_study import requirements_in_words, write_study

    file = Path(args.name)
    folder = args.output or Path(file.stem)
    check_folder(folder / file.name)
    with contextlib.ExitStack() as stack:
        if DRY_RUN & {*args.more} and not folder.exists():  # a dry run leaves no folder behind
            folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        with ProgressLines(args.name):
            limits = _design_limits(args, load_scene(file))
            before = write_study(file, folder, limits)
            now = requirements_in_words(folder, file.stem)
        if before not in ("", now):
            sys.stderr.write(one_line(f"{folder}: requirements now: {now}; before: {before}"))
        status, page = run_own_study(folder, jobs, args.more)
    if not page:
        return status
    if status == SUCCESS:
        for title in own_headlines(folder, file.stem):
            print_text(title)
    print_text(f"page: {page}")
    if status == SUCCESS and _is_infeasible(folder, file.stem):
        return INFEASIBLE
    return status


def _is_infeasible(folder: Path, scene_name: str) -> bool:
    """Whether the recommendation of a study states that no preload satisfies its requirements.

    folder: of the study, which has a folder `results`.
    """
    from bearingwear.results.netcdf import load
    from bearingwear.studies.design.choice import limits_of
    from bearingwear.studies.design.recommend import best_method

    recommendation = load(folder / "results" / scene_name / "preload" / "recommendation.nc")
    return bool(limits_of(recommendation).given) and best_method(recommendation) is None


def step(args: argparse.Namespace) -> int:
    """Calls a function for a rule of the workflow; returns `NOT_SOLVED` if it raises NotSolved.

    The function gets the words NAME=VALUE and the files to write.
    """
    from bearingwear.studies.run_step import NotSolved, run_step

    try:
        run_step(args.function, args.words, args.output)
    except NotSolved as error:
        sys.stderr.write(f"{error}\n")
        return NOT_SOLVED
    return SUCCESS


def _is_designation(text: str) -> bool:
    """Whether typed words are a designation alone, such as `SKF 7008 CD/P4A`."""
    from bearingwear.scene.new.assumed import size_of

    try:
        size_of(text, None, None)
    except SceneError:
        return False
    return True


def _trial_lines(path: str) -> list[str]:
    """Solves a scene file; returns lines on its status, pressure, stiffness and warnings.

    If that would first compile the solver, it is not solved, and the line says so.
    """
    from bearingwear.kernels.project import PROJECT
    from bearingwear.results.warnings import warning_lines
    from bearingwear.solvers.effects.choice import LARGEST_KERNEL

    if not PROJECT.is_compiled(LARGEST_KERNEL["steady"]):
        return [
            "not solved yet: the first solve must compile the solver, which takes up to "
            f"{PROJECT.compile_time}"
        ]
    from bearingwear.scene.read import load_scene
    from bearingwear.solvers.solve import solve as solved_result

    scene = load_scene(path)
    result = solved_result(scene)
    if result.status != "ok":
        return [f"cannot be solved ({result.status}): {result.reason}"]
    pressure = 1e-9 * float(result.values["maximum_pressure"].max())
    lines = [f"{result.reason}: maximum pressure {pressure:.3g} GPa"]
    if scene.bearing.maker is not None:
        lines.append(_resting_pair_line(scene))
    return lines + [f"  {line}" for line in warning_lines(result.attrs)]


def _resting_pair_line(scene: Scene) -> str:
    """Returns a line on the stiffness at rest of a rigid pair, as makers print it."""
    from bearingwear.solvers.bearing.at_rest import RestingPair

    pair = RestingPair.of(scene)
    axial, radial = (1e-6 * stiffness for stiffness in pair.rigidity)  # [N/um]
    return (
        f"stiffness of a rigid pair of these bearings at rest: {plain(axial)} N/um axial, "
        f"{plain(radial)} N/um radial; an axial force of {plain(pair.lift_off)} N unloads one "
        "bearing"
    )


def _design_limits(args: argparse.Namespace, scene: Scene) -> DesignLimits:
    """Returns the requirements in the options of a command.

    scene: its duty gives the time to full speed for `--warmup` without a value.
    """
    from bearingwear.arguments import AS_IN_DUTY
    from bearingwear.studies.design.plan import DesignLimits

    values = {name: getattr(args, name) for name in LIMITED}
    warmup_s = scene.start_s if args.warmup_s is AS_IN_DUTY else args.warmup_s
    values |= {"at_speed_only": args.at_speed_only, "warmup_s": warmup_s}
    return DesignLimits(**values)


def _restart_state(scene: Scene, args: argparse.Namespace) -> dict[str, Any]:
    """Returns the state in the file of `--restart`: `state` (m,) in SI units, `time` [s], `scene`.

    NotAvailable: the dynamic model does not solve the scene. CaseFileError: the scene cannot be
    continued from the file.
    """
    from bearingwear.results.restart import restart_from
    from bearingwear.solvers.effects.choice import choice
    from bearingwear.solvers.solve import check_restart

    check_restart(scene, choice(scene, args.fidelity))
    return restart_from(args.restart, scene)


def _finish(result: Result, args: argparse.Namespace) -> int:
    """Writes the result to the file of -o, prints its sheet, and returns the exit status.

    An unsolved result has a line on standard error. The status is then `NOT_SOLVED`, or `SUCCESS`
    with `--record-failures`.
    """
    if args.record_timing:
        result.attrs["wall_time_s"] = float(result.wall_time_s)
    if args.output is not None:
        from bearingwear.results.netcdf import write_result

        tell_of_new_folder(args.output)
        write_result(result, args.output)
    if args.quiet or args.json or args.csv:  # only the sheet as text contains the warnings
        print_warnings(result.attrs)
    if not args.quiet:
        from bearingwear.document.show import sheet, sheet_of_result

        print_sheet(sheet(args.output) if args.output else sheet_of_result(result), args)
    if result.status == "ok":
        return SUCCESS
    file_note = f" (see {args.output})" if args.output else ""
    sys.stderr.write(one_line(f"{args.scene}: {result.status}: {result.reason}{file_note}"))
    return SUCCESS if args.record_failures else NOT_SOLVED
