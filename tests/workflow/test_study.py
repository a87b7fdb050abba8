"""The study as its user runs it: what a run makes, and what a change makes anew.

Which sources and values a job reads is tested, without Snakemake, by tests/test_provenance.py,
tests/studies/test_configuration.py and test_rules.py. Here `make test` tests that Snakemake runs
such jobs again for a source, a scene and what is not read; `make test-long` tests the rest.
"""

import copy
import json
import os
import re
import shutil
import subprocess
import sys
import types

import jinja2
import netCDF4
import pytest
import yaml
from support import ROOT, scene_file

from bearingwear.arguments import STUDIES
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.scene.read import load_scene
from bearingwear.solvers.effects.choice import choice

# a case and, by folder, the figures of the small study that tests/workflow/conftest.py configures
WORN = "fixed_position-mu0.080-loss0.50"
FIGURES_OF_THE_SMALL_STUDY = {
    "gyro_s1/figures": {"fig07_fresh", "fig08_worn", "fig09_slip", "fig10_wear", "wear_life"},
    "gyro_s1_drag/figures": {"fig09_slip", "fig10_wear", "wear_life"},
    "figures": {"fig10_wear", "spread_drag"},
}

# rules that draw figures
DRAWN = {"figures", "friction_figures", "overlay", "wear_columns"}

# a study of one case
ONE_CASE = {
    "scenes": ["gyro_s1"],
    "preload_method": ["constant_force"],
    "friction": [0.02],
    "ball_diameter_loss_um": [0],
}


def number(path, name):
    """Returns the number that a variable of a case has."""
    with netCDF4.Dataset(path) as case:
        return float(case[name][...].item())


def has_dynamic_model(scene):
    """Returns whether this version has the dynamic model for a scene."""
    try:
        return choice(load_scene(scene_file(scene)), "dynamic").fidelity == "dynamic"
    except NotAvailable:
        return False


def test_every_study_is_planned(repository):
    """A dry run of the project's own studies plans all targets of the command `study`."""
    run = repository.run("-n", "--forceall", *STUDIES)
    assert run.status == 0, run.text
    assert set(STUDIES) - {"all"} <= run.jobs.keys()
    # by config/config.yaml: two preload methods, five scenes with four frictions, three with one
    assert run.jobs["solve"] == 2 * (5 * 4 + 3 * 1)
    assert run.jobs["wear_life"] == 5 + 3
    assert run.jobs["spread"] == 6  # one for each scene of its uncertain_lives
    # two methods, two frictions and three states of wear, and one case of a turbine
    assert run.jobs["solve_dynamic"] == 2 * 2 * 3 + 1


def test_the_linter_of_snakemake_asks_for_environments_alone(repository):
    """All its findings are that a rule has no environment of its own."""
    run = repository.run("--lint", jobs=None)
    findings = re.findall(r"^    \* (.*)$", run.text, re.M)
    # the study is one package in one environment: no rule needs one of its own
    allowed = "Specify a conda environment or container for each rule.:"
    assert findings and set(findings) == {allowed}, run.text


@pytest.mark.parametrize("option", ["--list", "--unlock", "--summary", "--rulegraph"])
def test_options_that_run_no_job_need_no_jobs(repository, option):
    """They succeed without the option -j, which Snakemake asks for to run jobs."""
    run = repository.run(option, jobs=None)
    assert run.status == 0, run.text


def test_a_run_makes_everything_and_then_nothing(first_run, solved_study):
    """It makes studies, lives, tables, figures, the page with its links, and the verdict.

    A copy of the project in another folder has nothing left to do.
    """
    project, run = first_run
    assert run.jobs["solve"] == 2 * 2 + 1  # two methods and two frictions, and a second scene
    results = project.results()
    for scene in ("gyro_s1", "gyro_s1_drag"):
        expected = {f"{scene}/{name}" for name in ("study.nc", "wear_life.nc")}
        expected |= {f"{scene}/tables/{name}" for name in ("cases.csv", "summary.md")}
        assert expected <= set(results)
    for folder, names in FIGURES_OF_THE_SMALL_STUDY.items():
        for suffix in ("svg", "png"):
            drawn = {path.name for path in (project.root / "results" / folder).glob(f"*.{suffix}")}
            assert drawn == {f"{name}.{suffix}" for name in names}
    page = results["report/index.html"].decode()
    figures = sum(map(len, FIGURES_OF_THE_SMALL_STUDY.values()))
    # and the map of preloads, which is a chart on the page
    assert len(list((project.root / "results").rglob("*.svg"))) == figures + 1
    assert page.count("<img ") == figures
    for path in ("docs/verification.md", "results/gyro_s1/figures/fig09_slip.svg"):
        assert f'<a href="../../{path}">' in page
    assert '<a href="../../results/gyro_s1/tables/cases.csv">' in page
    assert results["verdict.txt"] == b"all 15 solved and verified\n"  # 10 cases, 5 lives
    assert "page: results/report/index.html" in run.text.splitlines()
    again = solved_study.run()
    assert again.status == 0 and "Nothing to be done" in again.text


def test_the_notebook_runs_on_a_study_and_draws_the_figures(solved_study):
    """Every cell runs as plain Python; Snakemake has nothing to make there.

    Its variable `preload_left` has the share of the preload at a loss of 0.5 um, by method. It is
    one under a spring, and 0.2 to 0.6 in a fixed position; the paper has 0.40.
    """
    cells = json.loads((ROOT / "docs/paper.ipynb").read_text(encoding="utf-8"))["cells"]
    code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    code.append('figure.savefig("paper.svg"); spring, fixed = preload_left.values')
    code.append("assert abs(spring - 1) < 1e-9 and 0.2 < fixed < 0.6")
    completed = subprocess.run(
        [sys.executable, "-P", "-c", "\n".join(code)],
        cwd=solved_study.root,
        env=solved_study.environment | {"PYTHONPATH": str(solved_study.root)},
        capture_output=True, text=True, timeout=300,
    )  # fmt: skip
    assert completed.returncode == 0, completed.stderr
    assert "Nothing to be done" in completed.stdout + completed.stderr
    assert (solved_study.root / "paper.svg").stat().st_size > 10_000


@pytest.mark.long
def test_a_forced_run_writes_the_same_bytes(first_run, solved_study):
    """All five lines are solved again, and all files are made again."""
    run = solved_study.run("--forceall")
    assert run.status == 0 and run.jobs["solve"] == 5
    assert solved_study.results() == first_run[0].results()


@pytest.mark.long
def test_a_result_is_made_again_by_the_command_study(solved_study):
    """`bearingwear study FILE` makes a file that is there already: it has a later date."""
    case = solved_study.root / f"results/gyro_s1/cases/{WORN}.nc"
    old_date = case.stat().st_mtime_ns
    target = str(case.relative_to(solved_study.root))
    completed = subprocess.run(
        [sys.executable, "-m", "bearingwear", "study", target, "-j2"],
        cwd=solved_study.root,
        capture_output=True,
        text=True,
    )
    assert completed.returncode == 0, completed.stderr
    assert case.stat().st_mtime_ns > old_date


def test_the_report_of_snakemake_has_every_figure(solved_study):
    """It has our categories, captions and labels, and a first page that names the scenes."""
    run = solved_study.run("--report", "report.html", jobs=None)
    assert run.status == 0, run.text
    report = (solved_study.root / "report.html").read_text(encoding="utf-8")
    for category in ("across scenes", "gyro_s1_drag", "the report page"):
        assert category in report
    caption = (ROOT / "workflow/report/slip.rst").read_text(encoding="utf-8")
    assert " ".join(caption.split()[:8]) in report
    for label in ("slip across the contacts", "cases and lives, table, to download"):
        assert label in report
    assert {"against friction, new", "against friction, worn"} <= set(
        re.findall(r"against friction, \w+", report)
    )
    root = solved_study.root
    figures = {str(path.relative_to(root)) for path in root.glob("results/**/*.svg")}
    assert figures and figures == set(re.findall(r'"(results/[^"]*\.svg)": ?{', report))
    assert "gyro_s1_drag</strong>: " in report  # the first page


def test_captions_find_the_files_that_they_name():
    """Captions are templates, rendered here for a job whose inputs have no names.

    An unknown name is an error here, as it would be left out silently in a report. Only the caption
    of running averages names the reference values, which are in b.csv.
    """
    files = ["results/a.nc", "config/reference/b.csv", "config/reference/b.csv"]
    job = types.SimpleNamespace(input=files, config={"studies": []})
    environment = jinja2.Environment(undefined=jinja2.StrictUndefined)
    for path in (ROOT / "workflow/report").glob("*.rst"):
        text = environment.from_string(path.read_text(encoding="utf-8")).render(snakemake=job)
        assert text.count("b.csv is empty") == (path.stem == "running_average"), path


def test_the_page_shows_large_maps_if_the_configuration_says_so(solved_study):
    """The inputs of the page follow from the configuration, not from the maps that are there."""
    path = solved_study.root / "config/design.yaml"
    design = yaml.safe_load(path.read_text(encoding="utf-8"))
    axes = {"preload_method": ["constant_force"], "friction": [0.02, 0.08]}
    numbers = {"shaft_speed_rpm": [30000], "preload_N": [2.0, 4.0]}
    design["scenes"] = {"gyro_s1": {"map": axes | numbers}}
    path.write_text(yaml.safe_dump(design), encoding="utf-8")
    assert "map_part" not in solved_study.run("-n").jobs
    path.write_text(yaml.safe_dump(design | {"in_main_study": True}), encoding="utf-8")
    jobs = solved_study.run("-n").jobs
    assert jobs["map_part"] == 2  # one for each friction coefficient
    assert jobs["design_report"] == jobs["check_table"] == jobs["page"] == 1


def test_a_forced_case_is_solved_again(solved_study):
    """The one job solves its line, both cases with later dates and the other with the same bytes.

    Cases of another line are not written.
    """
    target = solved_study.case(WORN)
    same_line = solved_study.case("fixed_position-mu0.080-loss0.00")
    another_line = solved_study.case("fixed_position-mu0.020-loss0.00")
    old_dates = [path.stat().st_mtime_ns for path in (target, same_line)]
    contents, untouched = same_line.read_bytes(), another_line.stat()
    run = solved_study.run("-f", str(target.relative_to(solved_study.root)))
    assert run.status == 0 and run.jobs == {"solve": 1}
    dates = [path.stat().st_mtime_ns for path in (target, same_line)]
    assert all(new > old for new, old in zip(dates, old_dates, strict=True))
    assert same_line.read_bytes() == contents
    # not the whole stat: a run looks into every result, which dates its last access
    assert another_line.stat().st_mtime_ns == untouched.st_mtime_ns
    assert another_line.stat().st_ino == untouched.st_ino


@pytest.mark.long
def test_chunks_of_several_lines_give_the_bytes_of_single_lines(first_run, solved_study):
    """With four points to a job there are two jobs of two lines each, one for each method."""
    before = first_run[0].results()
    shutil.rmtree(solved_study.root / "results")
    config = solved_study.config
    config["points_per_job"] = 4
    del config["studies"][1:], config["figures"]["wear_columns"], config["figures"]["spreads"]
    solved_study.configure(config)
    run = solved_study.run("results/gyro_s1/wear_life.nc")
    assert run.status == 0, run.text
    assert run.jobs["solve_chunk"] == 2 and "solve" not in run.jobs
    after = solved_study.results()
    for name in ("study.nc", "wear_life.nc"):
        assert after[f"gyro_s1/{name}"] == before[f"gyro_s1/{name}"]


def test_edits_without_effect_run_no_job(solved_study):
    """They change dates, comments, help texts, order and digits of lists, and values none reads."""
    scene = "config/scenes/gyro_s1.yaml"
    with (solved_study.root / scene).open("a") as file:
        file.write("# a comment\n")
    # nothing reads the clearance of a cage that is not asked for
    solved_study.edit(scene, "pocket_clearance_mm: 0.15", "pocket_clearance_mm: 0.16")
    solved_study.edit("bearingwear/arguments.py", "a result file of any kind", "any result file")
    config = solved_study.config
    config["studies"][0].update(friction=[0.08, 0.020], ball_diameter_loss_um=[0.5, 0.0])
    solved_study.configure(config)
    for file in ("bearingwear/kernels/contact/slip.py", scene, "Snakefile"):
        os.utime(solved_study.root / file)
    run = solved_study.run()
    assert run.status == 0 and "Nothing to be done" in run.text, run.text


def test_an_edited_solver_source_solves_again(solved_study):
    """All five lines and both lives are planned; a case is made with twice the wear rate."""
    rate = number(solved_study.case(WORN), "ball_wear_rate")
    solved_study.edit(
        "bearingwear/solvers/bearing/outputs.py",
        '"ball_wear_rate": ball_rate.sum(axis=1)',
        '"ball_wear_rate": 2.0 * ball_rate.sum(axis=1)',
    )
    planned = solved_study.run("-n")
    assert planned.jobs["solve"] == 5 and planned.jobs["wear_life"] == 2
    run = solved_study.run(str(solved_study.case(WORN).relative_to(solved_study.root)))
    assert run.status == 0 and run.jobs == {"solve": 1}
    assert number(solved_study.case(WORN), "ball_wear_rate") == 2.0 * rate


@pytest.mark.long
def test_an_edited_figure_runs_the_jobs_of_its_study_alone(solved_study):
    """Its source has an old date and other contents: figures, page and verdict are made again."""
    solved_study.change_source("bearingwear/studies/grid/figures/quasistatic.py", date=0.0)
    planned = set(solved_study.run("-n").jobs)
    assert planned == {*DRAWN, "page", "verdict"}


def test_a_file_that_no_rule_makes_is_refused_by_name(solved_study):
    """The error names studies.nc, asked for in place of study.nc, without a traceback."""
    run = solved_study.run("-n", "results/gyro_s1/studies.nc")
    assert run.status == 1 and "results/gyro_s1/studies.nc" in run.text
    assert "Traceback" not in run.text


@pytest.mark.long
def test_an_edited_source_of_the_study_gathers_again_and_solves_nothing(solved_study):
    """A comment on a line of code is an edit: studies and lives of both scenes are made again."""
    solved_study.edit(
        "bearingwear/studies/dataset.py", "import numpy as np\n", "import numpy as np  # edited\n"
    )
    planned = solved_study.run("-n")
    assert planned.jobs["gather"] == planned.jobs["wear_life"] == 2
    assert "solve" not in planned.jobs


@pytest.mark.long
def test_an_edited_friction_solves_its_lines_alone(solved_study):
    """With 0.081 for 0.08, a line for each preload method and the study of one scene are made."""
    config = solved_study.config
    config["studies"][0]["friction"] = [0.02, 0.081]
    config["figures"].update(friction=[0.02, 0.081], wear_columns=[])
    solved_study.configure(config)
    planned = solved_study.run("-n")
    assert planned.jobs["solve"] == 2 and planned.jobs["gather"] == 1


def test_edits_that_no_case_reads_solve_none(solved_study):
    """Edited are the friction of the scene, which the study varies, its description, and the page.

    Only the page is made again, and the verdict, which always is.
    """
    solved_study.edit("config/scenes/gyro_s1.yaml", "ball_race: 0.08", "ball_race: 0.09")
    assert "solve" not in solved_study.run("-n").jobs
    solved_study.edit("config/scenes/gyro_s1.yaml", "ball_race: 0.09", "ball_race: 0.08")
    solved_study.edit("config/scenes/gyro_s1.yaml", "Instrument bearing", "Edited bearing")
    solved_study.edit("bearingwear/page/page.html", "The page has no date", "This page has no date")
    assert solved_study.run("-n").jobs == {"page": 1, "verdict": 1}


@pytest.mark.long
def test_uncertain_values_are_read_by_lives_and_no_case(solved_study):
    """The scene loses one of its distributions, which lives state; no case is solved again.

    Lives of both scenes and the map of preloads are made again, one scene being based on the other.
    """
    path = "config/scenes/gyro_s1.yaml"
    text = (solved_study.root / path).read_text(encoding="utf-8")
    spread = next(line for line in text.partition("\nuncertainty:")[2].splitlines() if ":" in line)
    solved_study.edit(path, f"{spread}\n", "")
    planned = solved_study.run("-n")
    assert planned.jobs["small_map"] == 1 and planned.jobs["wear_life"] == 2
    assert not planned.jobs.keys() & {"solve", "gather"}
    assert solved_study.run("results/gyro_s1/preload/answer.json").status == 0


def test_an_edited_scene_solves_its_cases_alone(solved_study):
    """Its file has other contents and a date of 1970: one line is planned, and its study."""
    path = "config/scenes/gyro_s1_drag.yaml"
    solved_study.edit(path, "drag_density_kg_m3: 250", "drag_density_kg_m3: 240")
    os.utime(solved_study.root / path, (0, 0))
    planned = solved_study.run("-n")
    assert planned.jobs["solve"] == 1 and planned.jobs["gather"] == 1
    assert planned.jobs["figures"] == 1 and "friction_figures" not in planned.jobs


def test_a_broken_configuration_is_refused_in_one_line(new_project):
    """Here a key is misspelt. tests/studies/test_configuration.py has other faults."""
    project = new_project()
    config = copy.deepcopy(project.config)
    config["studies"][0]["frictoin"] = [0.1]
    project.configure(config)
    run = project.run("-n")
    assert run.status == 1 and "Traceback" not in run.text
    (line,) = [line for line in run.text.splitlines() if line.startswith("config")]
    assert "studies[0]: Additional properties are not allowed" in line


def test_a_broken_scene_stops_with_one_line(new_project):
    """The friction is below zero: file, key and value are named once, and nothing is made."""
    project = new_project()
    project.edit("config/scenes/gyro_s1_drag.yaml", "ball_race: 0.02", "ball_race: -0.02")
    run = project.run()
    assert run.status != 0 and "Traceback" not in run.text
    lines = [line for line in run.text.splitlines() if "gyro_s1_drag.yaml" in line]
    assert len(lines) == 1 and "friction.ball_race" in lines[0] and "-0.02" in lines[0]
    assert not (project.root / "results").exists()


@pytest.mark.long
def test_a_given_configuration_replaces_that_of_the_folder(first_run):
    """Given by `--configfile`, it has one case; nothing of config/config.yaml is planned."""
    project, _ = first_run
    study = {**ONE_CASE, "friction": [0.03]}
    other = project.root.parent / "other.yaml"
    figures = {"worn_loss_um": 0.0, "friction": [0.03]}
    other.write_text(yaml.safe_dump({"studies": [study], "figures": figures}), encoding="utf-8")
    planned = project.run("-n", "--configfile", str(other)).jobs
    assert planned["solve"] == planned["gather"] == 1


@pytest.mark.long
@pytest.mark.skipif(not has_dynamic_model("gyro_s1"), reason="no dynamic model in this version")
def test_dynamic_cases_are_solved_and_drawn_with_the_study(new_project):
    """A case of four strips is solved for half a turn, beside its steady case.

    With another number of turns, only the dynamic case is planned again.
    """
    project = new_project()
    paper = "model: {contact: paper"
    project.edit("config/scenes/gyro_s1.yaml", paper, f"{paper}, strips: 4")
    figures = {"worn_loss_um": 0.5, "friction": [0.02], "running_averages": {"gyro_s1": {}}}
    dynamic = [{**ONE_CASE, "model": {"simulated_turns": 0.5}}]
    project.configure({"studies": [ONE_CASE], "dynamic": dynamic, "figures": figures})
    run = project.run()
    assert run.status == 0, run.text
    assert run.jobs["solve"] == run.jobs["solve_dynamic"] == 1
    case = "constant_force-mu0.020-loss0.00"
    folder = project.root / "results/gyro_s1"
    assert number(folder / f"dynamic/{case}.nc", "simulated_turns") == pytest.approx(0.5)
    for name in ("dynamic", f"fig06_running_average-{case}"):
        assert (folder / f"figures/{name}.svg").exists()
    assert (folder / "tables/dynamic.md").stat().st_size > 0
    # a case, a life, and the dynamic case
    assert project.results()["verdict.txt"] == b"all 3 solved and verified\n"
    dynamic[0]["model"] = {"simulated_turns": 1}
    project.configure({"studies": [ONE_CASE], "dynamic": dynamic, "figures": figures})
    planned = project.run("-n")
    assert planned.jobs["solve_dynamic"] == 1 and "solve" not in planned.jobs
