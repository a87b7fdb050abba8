"""A small study of a scene whose description is not to be trusted, and its page."""

import contextlib
from pathlib import Path

import yaml
from support import scene_file, step

from bearingwear.cli import main
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.grid.grid import Grid

GRID = Grid.from_lists(PRELOAD_METHODS, [0.02, 0.08], [0.0, 0.7])
HOSTILE = (
    "</p><script>alert(1)</script> <img src=x onerror=alert(2)> {{ 7 * 7 }} | [a](javascript:b) "
    "![c](http://d.example/e.png) <http://f.example> \"'&amp;"
)
FOLDER = "results/mine"
FIGURES = (f"{FOLDER}/figures/fig10", f"{FOLDER}/figures/wear_life", "results/figures/spread")
SECTIONS = (
    f"{FOLDER}/study.nc",
    f"{FOLDER}/wear_life.nc",
    f"{FOLDER}/tables/summary.md",
    *(f"{figure}.{suffix}" for figure in FIGURES for suffix in ("svg", "png")),
)
LIVES_ANSWER = "results/answer.json"
CHOICE = f"{FOLDER}/preload"
ANSWERS = (
    LIVES_ANSWER,
    f"{CHOICE}/answer.json",
    f"{CHOICE}/charts.json",
    f"{CHOICE}/figures/design.svg",
    f"{CHOICE}/tables/design.md",
)
DOCS = ("docs/verification.md",)
AXES = {
    "preload_method": PRELOAD_METHODS,
    "friction": [0.08],
    "shaft_speed_rpm": [30000.0],
    "preload_N": [2.0, 4.0, 6.0, 8.0, 12.0],
}
LIMITS = {"system_axial_stiffness_N_um": 3.0, "gyroscopic_slip_share": 0.25}


def make_small_study(folder: Path) -> None:
    """Makes the results of the study below `folder`, as the workflow would."""
    from bearingwear.results.netcdf import write_result
    from bearingwear.scene.read import variant
    from bearingwear.solvers.solve import solve

    plain = yaml.safe_load(scene_file("gyro_s1").read_text(encoding="utf-8"))
    with contextlib.chdir(folder):
        scene = Path("mine.yaml")
        scene.write_text(yaml.safe_dump(plain | {"name": "mine", "description": HOSTILE}))
        Path(FOLDER).mkdir(parents=True)
        Path("docs").mkdir()
        Path(DOCS[0]).write_text("# Verification\n\nIt is.\n")
        paths = {case_id: f"{FOLDER}/{case_id}.nc" for case_id in GRID.cases()}
        for case_id, case in GRID.cases().items():
            write_result(solve(variant(scene, case.changes)), Path(paths[case_id]))
        make_lives_and_figures(scene, [*paths.values()])
        make_recommendation(scene)


def make_lives_and_figures(scene: Path, cases: list[str]) -> None:
    """Gathers cases, and makes their lives, tables, figures and answer in the present folder.

    cases: paths of the result files of the cases.
    """
    study, lives = f"{FOLDER}/study.nc", f"{FOLDER}/wear_life.nc"
    tables = [f"{FOLDER}/tables/{name}" for name in ("cases.csv", "summary.md")]
    wear_figure, life_figure, overlay_figure = map(figure_files, FIGURES)
    frictions, least_friction = {"friction": [0.02, 0.08]}, {"friction": 0.02}
    draw = "studies.grid.figures.draw"
    run_step("studies.grid.gather.gathered_study", study, paths=cases)
    run_step("studies.grid.life.study_life", lives, scene=scene, study=study)
    run_step("studies.grid.tables.study_tables", *tables, study=study, lives=lives)
    run_step(f"{draw}.draw_wear", *wear_figure, studies=[study], settings=frictions)
    run_step(f"{draw}.draw_life", *life_figure, lives=lives, settings=frictions)
    run_step(f"{draw}.draw_overlay", *overlay_figure, studies=[study], settings=least_friction)
    run_step("studies.grid.answer.lives_answer", LIVES_ANSWER, lives=[lives])


def make_recommendation(scene: Path) -> None:
    """Makes a map of preloads, and its figure, tables, answer and charts in the present folder."""
    design, recommendation = f"{CHOICE}/design.nc", f"{CHOICE}/recommendation.nc"
    inputs = {"design": design, "recommendation": recommendation}
    tables = [f"{CHOICE}/tables/{name}" for name in ("map.csv", "design.md")]
    settings = {"axes": AXES, "limits": LIMITS}
    folder = "studies.design"
    run_step(
        f"{folder}.recommend.small_map", design, recommendation, scene=scene, settings=settings
    )
    figure = figure_files(f"{CHOICE}/figures/design")
    run_step(f"{folder}.figures.draw.draw_design", *figure, **inputs)
    run_step(f"{folder}.document.sheets.tables", *tables, **inputs)
    run_step(f"{folder}.document.sheets.design_answer", f"{CHOICE}/answer.json", **inputs)
    run_step(f"{folder}.document.charts.design_charts", f"{CHOICE}/charts.json", **inputs)


def run_step(run: str, *outputs, **inputs) -> None:
    """Runs a step of a study, which must succeed. Arguments: `support.step_arguments`."""
    assert step(run, *outputs, **inputs) == 0


def figure_files(name: str) -> list[str]:
    """Returns the SVG and PNG files of a figure, by its path without a suffix."""
    return [f"{name}.{suffix}" for suffix in ("svg", "png")]


def page_command(path, sections=SECTIONS, docs=DOCS, answers=ANSWERS, scenes=()) -> list[str]:
    """Returns arguments of `bearingwear` that write the page of files below the present folder."""
    inputs = [*sections, "--answers", *answers, "--docs", *docs, "--scenes", *scenes, "-o", path]
    return ["page", *map(str, inputs)]


def make_page(path, sections=SECTIONS, docs=DOCS, answers=ANSWERS) -> str:
    """Writes the page of files below the present folder, and returns its text."""
    assert main(page_command(path, sections, docs, answers)) == 0
    return Path(path).read_text(encoding="utf-8")
