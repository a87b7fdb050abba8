"""A small study of a scene whose description is not to be trusted, and its page."""

import contextlib
import os
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
    """Results of the study, as the workflow would make them below `folder`."""
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
        cases = [f"{FOLDER}/{case_id}.nc" for case_id in GRID.cases()]
        for case, path in zip(GRID.cases().values(), cases, strict=True):
            write_result(solve(variant(scene, case.changes)), Path(path))
        study, lives, choice = f"{FOLDER}/study.nc", f"{FOLDER}/wear_life.nc", f"{CHOICE}/design.nc"
        taken = f"{CHOICE}/recommendation.nc"
        both, alone = {"friction": [0.02, 0.08]}, {"friction": 0.02}
        design = {"design": choice, "recommendation": taken}
        tables = [f"{FOLDER}/tables/{name}" for name in ("cases.csv", "summary.md")]
        small_map = [choice, taken]
        settings = {"axes": AXES, "limits": LIMITS}
        draw, chosen = "studies.grid.figures.draw", "studies.design"
        figure = [drawn(name) for name in (*FIGURES, f"{CHOICE}/figures/design")]
        for status in (
            step("studies.grid.gather.gathered_study", study, paths=cases),
            step("studies.grid.life.study_life", lives, scene=scene, study=study),
            step("studies.grid.tables.study_tables", *tables, study=study, lives=lives),
            step(f"{draw}.draw_wear", *figure[0], studies=[study], settings=both),
            step(f"{draw}.draw_life", *figure[1], lives=lives, settings=both),
            step(f"{draw}.draw_overlay", *figure[2], studies=[study], settings=alone),
            step("studies.grid.answer.lives_answer", LIVES_ANSWER, lives=[lives]),
            step(f"{chosen}.recommend.small_map", *small_map, scene=scene, settings=settings),
            step(f"{chosen}.figures.draw.draw_design", *figure[3], **design),
            step(f"{chosen}.document.sheets.tables", *texts(), **design),
            step(f"{chosen}.document.sheets.design_answer", f"{CHOICE}/answer.json", **design),
            step(f"{chosen}.document.charts.design_charts", f"{CHOICE}/charts.json", **design),
        ):
            assert status == 0


def drawn(name: str) -> list[str]:
    return [f"{name}.{suffix}" for suffix in ("svg", "png")]


def texts() -> list[str]:
    return [f"{CHOICE}/tables/{name}" for name in ("map.csv", "design.md")]


def page_command(path, sections=SECTIONS, docs=DOCS, answers=ANSWERS, scenes=()) -> list[str]:
    """Arguments of `bearingwear` that write the page of files below the present folder."""
    inputs = [*sections, "--answers", *answers, "--docs", *docs, "--scenes", *scenes, "-o", path]
    return ["page", *map(str, inputs)]


def make_page(path, sections=SECTIONS, docs=DOCS, answers=ANSWERS) -> str:
    """The page of files below the present folder."""
    assert main(page_command(path, sections, docs, answers)) == 0
    with open(os.fspath(path), encoding="utf-8") as file:
        return file.read()
