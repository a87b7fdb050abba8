"""The study of accuracy: its plan, errors, figures, tables and docs, with numbers made up here.

Tests of a whole study are marked `long`: they take 40 s of a core.
"""

import json
import math
import re

import numpy as np
import pytest
import xarray as xr
import yaml
from numpy.testing import assert_allclose
from support import ROOT, numbers_in, scene_file
from support import step as run_step

from bearingwear.console import UsageError
from bearingwear.results.entries import common_attributes
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.results.units import Rough
from bearingwear.scene.read import load_scene
from bearingwear.studies.dataset import write_dataset
from workflow.studies.accuracy.cages import cages_part
from workflow.studies.accuracy.checked_table import Agreement, CheckedTable, table_cells
from workflow.studies.accuracy.docs import DOCS_PARTS, differences
from workflow.studies.accuracy.figures import integration_figure
from workflow.studies.accuracy.gather import gathered_sweeps
from workflow.studies.accuracy.plan import (
    ACCURACY_FILE,
    FIGURE_NAMES,
    PRESET_KEYS,
    read_accuracy,
    reference_name,
    scene_settings,
    sweep_jobs,
    sweep_points,
)
from workflow.studies.accuracy.tables import SECTIONS, row_section

PLAN_FILE = ROOT / ACCURACY_FILE
NOT_CONVERGED = 1  # status


def step(run, *outputs, settings=None, **inputs):
    """Runs a step of the study of accuracy, and returns its exit status; see `support.step`."""
    return run_step(f"studies.accuracy.{run}", *outputs, settings=settings, **inputs)


@pytest.fixture(scope="module")
def plan():
    """Returns the plan of the project: scenes, sweeps, references, tables and cages."""
    return read_accuracy(PLAN_FILE)


def invented_sweep(plan, scene, name, failed=()):
    """Returns a sweep or a reference of the plan on a scene, with made-up errors and times.

    The k-th point of a sweep has relative errors of 0.1^k. Those of the QV of the inner contact are
    -3 times as large, those of the total QV of bearing218 twice as large. The first point of a
    reference is exact, and its second one has errors of 1e-4. Points take 1, 2, 4, ... ms.

    name: of a sweep or a reference. The references `short` and `long` have no life.
    failed: labels of points that have a status and no numbers.
    """
    points = sweep_points(plan, name)
    n = len(points)
    sweep = plan["sweeps"].get(name)
    reference = reference_name(sweep) if sweep else name
    error = 0.1 ** np.arange(1.0, n + 1) if sweep else np.array([0.0, 1e-4])
    exact = {"total_qv": 0.6, "qv_outer": 0.05, "residual_preload": 7.0, "wear_rate": 1e-10,
             "life": 1.3, "cage_wear_rate": 1e-15, "end_qv": 0.7}  # fmt: skip
    numbers = {key: value * (1.0 + error) for key, value in exact.items()}
    numbers["qv_inner"] = 0.01 * (1.0 - 3.0 * error)
    if scene == "bearing218":  # so that the median over scenes is not the worst of them
        numbers["total_qv"] = 0.6 * (1.0 + 2.0 * error)
    if reference in ("short", "long"):
        numbers["life"] = np.full(n, np.nan)
    for key in ("total_qv", "residual_preload", "wear_rate", "life"):
        numbers[f"estimate_{key}"] = 2.0 * error
    time = 1e-3 * 2.0 ** np.arange(n)
    numbers |= {"wall_time": time, "processor_time": time}
    numbers |= {"life_wall_time": 10.0 * time, "life_processor_time": 10.0 * time}
    numbers["simulated_turns"] = np.full(n, 4.0)
    numbers["wear_over_gap"] = [float(p.end or "nan") for p in points]
    for key in ("coriolis_energy_share", "azimuth_energy_share"):
        numbers[key] = np.full(n, 1e-5)
    status = np.array([NOT_CONVERGED if p.label in failed else 0 for p in points], dtype=np.int8)
    values = {key: np.where(status == 0, column, np.nan) for key, column in numbers.items()}
    texts = {"label": [p.label for p in points], "settings": [" ".join(p.settings) for p in points]}
    return xr.Dataset(
        {key: ("point", np.array(column, dtype=object)) for key, column in texts.items()}
        | {"value": ("point", [p.value for p in points]), "status": ("point", status)}
        | {key: ("point", column, {"units": "1"}) for key, column in values.items()},
        attrs={
            "scene_name": scene,
            "sweep_name": name,
            "sweep_kind": sweep["kind"] if sweep else "reference",
            "against": reference,
            "sweep_title": sweep["title"] if sweep else name,
            "source": "bearingwear 1",
            "source_hash": "1",
        },
    )


@pytest.fixture(scope="module")
def files(plan, tmp_path_factory):
    """Returns the paths of all sweeps and references of the plan, one for each and its scene.

    The first point of the sweep `gauss` on the scene gyro_fresh has failed.
    """
    folder = tmp_path_factory.mktemp("points")
    paths = []
    for scene, name in sweep_jobs(plan):
        failed = ("gauss 4",) if scene == "gyro_fresh" else ()
        paths.append(folder / f"{scene}-{name}.nc")
        write_dataset(invented_sweep(plan, scene, name, failed), paths[-1])
    return paths


@pytest.fixture(scope="module")
def trade(files, tmp_path_factory):
    """Returns the path of the file that gathers the sweeps of `files`."""
    path = tmp_path_factory.mktemp("trade") / "accuracy.nc"
    assert step("gather.gathered_sweeps", path, paths=files) == 0
    return path


# the plan


def test_the_plan_reads_and_every_scene_of_it_is_valid(plan):
    """No scene raises an error with the settings of the first and the last point of its sweeps."""
    assert len(plan["scenes"]) >= 5
    for scene, sweep in sweep_jobs(plan):
        points = sweep_points(plan, sweep)
        for point in (points[0], points[-1]):
            file = scene_file(plan["scenes"][scene]["file"])
            load_scene(file, point.overrides(scene_settings(plan, scene)))


def test_sweeps_may_set_the_presets_of_the_documented_names():
    assert set(PRESET_KEYS) == {"draft", "standard", "reference"}


def test_a_scene_has_the_sweeps_of_its_references(plan):
    """bearing218 has the reference `steady` and not `long`; with turbine it is the other way round.

    `strips` is compared with `steady`, `turns` with `long`, and `hertz` with its own first point.
    """
    jobs = sweep_jobs(plan)
    assert ("bearing218", "strips") in jobs and ("bearing218", "turns") not in jobs
    assert ("turbine", "strips") not in jobs and ("turbine", "hertz") in jobs


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        (
            {"sweeps": {"a": {"title": "a", "from": "nowhere", "grid": {}}}},
            "got nowhere",
        ),
        ({"scenes": {"a": {"file": "gyro_s1", "references": ["x"]}}}, "references: got x"),
        ({"table": [{"sweep": "strips", "label": "x", "text": "y"}]}, "table, strips: got x"),
        ({"cages": {"ensembles": {"a": {"text": "a"}}, "file": "x"}}, "got the scene x, expected"),
        ({"cages": {"runs": 5}}, "cages.runs: 5 is less than the minimum of 20"),
        ({"sweeps": {"a": {"title": "a", "from": "scene", "grid": {"end": 3}}}}, "end: 3 is not"),
        ({"effects": [{"sweep": "gauss", "label": "gauss 4", "text": "y"}]}, "against: got steady"),
    ],
)
def test_a_broken_plan_is_refused_in_one_line(change, problem, tmp_path):
    """Each change replaces a block of the project's plan."""
    data = yaml.safe_load(PLAN_FILE.read_text(encoding="utf-8")) | change
    (tmp_path / "scenes").symlink_to(ROOT / "config/scenes")
    file = tmp_path / "accuracy.yaml"
    file.write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(UsageError) as error:
        read_accuracy(file)
    assert problem in str(error.value) and "\n" not in str(error.value)


# errors


@pytest.mark.long
def test_errors_are_against_the_reference_of_the_scene(trade, plan):
    """Relative errors, with their signs, are those by which `invented_sweep` spoils exact values.

    They are 0.1^k for the k-th point of `gauss`, and -3 times that at the inner contact;
    `error_contact_qv` is the larger magnitude of both contacts. The first point failed: it keeps
    its status and has no errors.
    """
    dataset = load(trade)
    assert dataset.sizes["point"] == sum(
        len(sweep_points(plan, name)) for _, name in sweep_jobs(plan)
    )
    is_gauss = (dataset["scene"].values == "gyro_fresh") & (dataset["sweep"].values == "gauss")
    gauss = dataset.isel(point=is_gauss)
    error = 0.1 ** np.arange(2.0, gauss.sizes["point"] + 1.0)  # of the points but the first
    assert_allclose(gauss["error_total_qv"][1:], error, rtol=1e-9)
    assert_allclose(gauss["error_qv_inner"][1:], -3.0 * error, rtol=1e-9)
    assert_allclose(gauss["error_contact_qv"][1:], 3.0 * error, rtol=1e-9)
    assert_allclose(gauss["error_life"][1:], error, rtol=1e-9)
    assert_allclose(gauss["reference_time"], 1e-3)  # s
    assert int(gauss["status"][0]) == NOT_CONVERGED
    assert np.isnan(gauss["error_total_qv"][0]) and np.isnan(gauss["error_contact_qv"][0])


@pytest.mark.long
def test_gathering_refuses_what_does_not_belong_together(files, tmp_path):
    """Refused are sweeps without their reference, files of different sources, and no file."""
    without = [path for path in files if path.name != "turbine-long.nc"]
    with pytest.raises(CaseFileError, match="turbine, .*: the reference long is missing"):
        gathered_sweeps(without)
    other = load(files[0]).assign_attrs(source_hash="2")
    write_dataset(other, tmp_path / "other.nc")
    with pytest.raises(CaseFileError, match="other.nc: source_hash differs"):
        gathered_sweeps([files[1], tmp_path / "other.nc"])
    with pytest.raises(CaseFileError, match="no sweeps"):
        gathered_sweeps([])


# figures, tables, docs


@pytest.mark.long
@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("which", FIGURE_NAMES)
def test_figures_are_drawn_without_a_warning(trade, which, tmp_path):
    """Warnings are errors here, and the file is not empty."""
    settings, output = {"which": which}, tmp_path / "a.svg"
    assert step("figures.figure", output, trade=trade, settings=settings) == 0
    assert output.stat().st_size > 0


@pytest.mark.long
def test_the_title_on_integrators_states_every_ratio_of_times(trade):
    """It has no dash, which would stand for a ratio that no scene has."""
    title = integration_figure(load(trade)).get_suptitle()
    assert "Runge-Kutta" in title
    assert "–" not in title


@pytest.mark.long
def test_a_figure_is_the_same_bytes_twice(trade, tmp_path):
    settings, outputs = {"which": FIGURE_NAMES[0]}, [tmp_path / "a.svg", tmp_path / "b.svg"]
    for output in outputs:
        assert step("figures.figure", output, trade=trade, settings=settings) == 0
    assert outputs[0].read_bytes() == outputs[1].read_bytes()


@pytest.fixture(scope="module")
def cages(plan, tmp_path_factory):
    """Returns the path of the gathered ensembles of the plan; each has 0.9 times the work before.

    In the first ensemble, the work of run k = 0, 1, ... is 1e-4 (1 + 0.1 k) J. Pockets have 0.8 of
    the work, the land 0.2. In ensemble k = 0, 1, ..., the first k runs have another motion (1) than
    the rest (0).
    """
    folder = tmp_path_factory.mktemp("cages")
    paths, first_work = [], 1e-4 * (1.0 + 0.1 * np.arange(plan["cages"]["runs"]))
    for k, (name, row) in enumerate(plan["cages"]["ensembles"].items()):
        work = 0.9**k * first_work
        parts = {"work": work, "pocket_work": 0.8 * work, "land_work": 0.2 * work}
        motion = (np.arange(work.size) < k).astype(np.int8)
        parts |= {"turns": np.full(work.size, float(row["least_turns"])), "motion": motion}
        data = {part: ("run", values) for part, values in parts.items()}
        paths.append(folder / f"{name}.nc")
        write_dataset(xr.Dataset(data, attrs=common_attributes()), paths[-1])
    file = folder / "cages.nc"
    assert step("cages.gathered_cages", file, paths=paths) == 0
    return file


def test_ensembles_are_relative_to_the_first(cages, plan):
    """A row has turns and the work of cage, pockets and land, as ratios to the first ensemble.

    Then follow the half-width of the 90 % interval of the work, and the share of runs in the same
    motion. There are six ensembles of 20 runs; the first has 450 turns, the second 30.
    """
    _, table = cages_part(load(cages), plan)
    first, second, *_, last = (row[1:] for row in table.rows)
    assert first == [1.0, 1.0, 1.0, 1.0, 0.0, 1.0]
    # the work of run k is 1 + 0.1 k, with a mean of 1.95; run by run the second ensemble differs by
    # a tenth of it. The 95 % point of Student's t with 19 degrees of freedom is 1.7291.
    interval = 0.1 * np.arange(20).std(ddof=1) / 1.95 * 1.7291 / math.sqrt(20)
    assert_allclose(second, [30 / 450, 0.9, 0.9, 0.9, 0.1 * interval, 0.95], rtol=1e-4)
    assert last[1] == pytest.approx(0.9**5)
    assert last[-1] == 0.75  # five of 20 runs move in another way


def test_the_table_of_ensembles_is_written_into_the_docs(cages, plan, tmp_path):
    """Between its marks, every line of the table is missing before; afterwards nothing differs."""
    _, table = cages_part(load(cages), plan)
    docs = tmp_path / "accuracy.md"
    docs.write_text("<!-- cages: begin -->\n<!-- cages: end -->\n", encoding="utf-8")
    missing = differences(cages, PLAN_FILE, docs, "cages")
    assert len(missing) == len(table.rows) + 2  # all rows, and two lines of the head
    inputs = {"plan": PLAN_FILE, "docs": docs, "trade": cages}
    assert step("docs.docs_with_part", docs, settings={"part": "cages"}, **inputs) == 0
    assert differences(cages, PLAN_FILE, docs, "cages") == []
    # the third ensemble: 30 of 450 turns, and 0.9^2 of the work
    assert "| 30 turns | 0.067 | 0.81 |" in docs.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def tables(trade, tmp_path_factory):
    """Returns the paths of the tables of `trade`, as CSV and as Markdown."""
    folder = tmp_path_factory.mktemp("tables")
    outputs = folder / "a.csv", folder / "a.md"
    assert step("docs.accuracy_tables", *outputs, trade=trade, plan=PLAN_FILE) == 0
    return outputs


@pytest.mark.long
def test_the_tables_have_the_errors_of_the_run(trade, tables):
    """The CSV has a line for each point and a head, the Markdown rows of the plan; neither NaN.

    50 strips are the fourth point, in five scenes. By `invented_sweep`, the median error of QV is
    0.1^4 or 0.01 % and the largest 0.02 %; contacts have 0.03 %, the preload 0.01 %.
    """
    csv_text, markdown = (path.read_text(encoding="utf-8") for path in tables)
    assert "| 50 equal strips | 5 | 0.01 | 0.02 | 0.03 | 0.01 |" in markdown
    assert "nan" not in markdown + csv_text
    assert len(csv_text.splitlines()) == 1 + load(trade).sizes["point"]


def write_parts(docs, trade, cages):
    """Writes all parts into docs, and returns the set of exit statuses of the steps."""
    inputs = {"trade": trade, "plan": PLAN_FILE, "docs": docs}
    inputs_of_parts = dict.fromkeys(DOCS_PARTS, inputs) | {"cages": inputs | {"trade": cages}}
    return {
        step("docs.docs_with_part", docs, settings={"part": part}, **part_inputs)
        for part, part_inputs in inputs_of_parts.items()
    }


def checked_status(docs, trade, cages):
    """Returns the exit status of the check: 0 as in the run, 2 without a part, 3 with differences.

    It writes `check.txt` beside the docs if all is well.
    """
    output = docs.with_name("check.txt")
    return step("docs.check_docs", output, trade=trade, cages=cages, plan=PLAN_FILE, docs=docs)


EMPTY_PARTS = [f"<!-- {name}: begin -->\n<!-- {name}: end -->\n" for name in ("effects", "grooves")]
EMPTY_DOCS = "\n".join(["# Accuracy\n", *EMPTY_PARTS, "## Later\n"])
"""Docs with the marks of two parts. Parts without marks are written at the end."""


@pytest.fixture(scope="module")
def docs_text(trade, cages, tmp_path_factory):
    """Returns the text of docs into which all parts of the run are written."""
    docs = tmp_path_factory.mktemp("docs") / "accuracy.md"
    docs.write_text(EMPTY_DOCS, encoding="utf-8")
    assert write_parts(docs, trade, cages) == {0}
    return docs.read_text(encoding="utf-8")


@pytest.mark.long
def test_docs_without_their_parts_do_not_pass_the_check(trade, cages, tmp_path):
    """The check ends with status 2, as EMPTY_DOCS lacks the marks of most parts."""
    docs = tmp_path / "accuracy.md"
    docs.write_text(EMPTY_DOCS, encoding="utf-8")
    assert checked_status(docs, trade, cages) == 2


@pytest.mark.long
def test_parts_are_written_into_the_docs(trade, cages, tables, docs_text, tmp_path):
    """The docs then have all cells of the tables, and pass the check; other text stays.

    Writing the parts again changes nothing. A part of an unknown name is refused.
    """
    docs = tmp_path / "accuracy.md"
    docs.write_text(docs_text, encoding="utf-8")
    assert docs_text.startswith("# Accuracy\n\n<!-- effects: begin -->\n")
    end_of_grooves = docs_text.index("<!-- grooves: end -->\n\n## Later\n")
    assert end_of_grooves < docs_text.index("| 50 equal strips |")
    cells = table_cells(docs_text)
    assert cells.items() >= table_cells(tables[1].read_text(encoding="utf-8")).items()
    assert checked_status(docs, trade, cages) == 0
    assert docs.with_name("check.txt").read_text().startswith(f"{docs}: ")
    assert write_parts(docs, trade, cages) == {0}
    assert docs.read_text(encoding="utf-8") == docs_text
    inputs = {"trade": trade, "plan": PLAN_FILE, "docs": docs}
    assert step("docs.docs_with_part", docs, settings={"part": "x"}, **inputs) == 2


@pytest.mark.long
@pytest.mark.parametrize(
    ("old", "new", "difference"),
    [
        (
            "| 50 equal strips | 5 | 0.01 ",
            "| 50 equal strips | 5 | 0.03 ",
            "50 equal strips: median QV: .* 0.03, .* 0.01",
        ),
        (  # 1.01/1.1: the second point has an error of 1 %, the first, its reference, of 10 %
            "| gyro_worn | 0.918 |",
            "| gyro_worn | 0.94 |",
            "fixed-position preload: growth at speed, gyro_worn: preload: .* 0.94",
        ),
        ("| yes |", "| no |", "gyro_fresh: worn profile: .* no,"),
        ("| 50 equal strips |", "| 51 equal strips |", "50 equal strips: missing"),
    ],
)
def test_a_number_of_the_docs_beyond_its_tolerance_is_named(
    trade, cages, docs_text, old, new, difference, tmp_path, capsys
):
    """A line has the number of the docs and that of the run; a second one counts one difference."""
    docs = tmp_path / "accuracy.md"
    assert old in docs_text
    docs.write_text(docs_text.replace(old, new, 1), encoding="utf-8")
    capsys.readouterr()
    assert checked_status(docs, trade, cages) == 3
    line, count = capsys.readouterr().err.splitlines()
    assert re.search(difference, line) and numbers_in(count) == [1.0]


@pytest.mark.long
def test_a_number_of_the_docs_within_its_tolerance_passes(
    trade, cages, docs_text, tmp_path, capsys
):
    """0.019 in place of 0.01: errors may differ by a factor of about two."""
    docs, old = tmp_path / "accuracy.md", "| 50 equal strips | 5 | 0.01 "
    assert old in docs_text
    docs.write_text(docs_text.replace(old, old.replace("0.01", "0.019"), 1), encoding="utf-8")
    capsys.readouterr()
    assert checked_status(docs, trade, cages) == 0
    assert capsys.readouterr().err == ""


# errors in percent agree within a factor of 2.1, or if both are at most 0.1 %
ERROR = Agreement(2.1, 0.1, "%")


@pytest.mark.parametrize(
    ("agreement", "old", "new", "is_met"),
    [
        (ERROR, "0.1", "0.2", True), (ERROR, "0.1", "0.22", False),
        (ERROR, "5", "10", True), (ERROR, "5", "11", False),
        (ERROR, "-5", "-10", True), (ERROR, "-5", "-11", False),
        (ERROR, "0.001", "0.09", True), (ERROR, "-0.05", "0.1", True),
        (ERROR, "-5", "5", False), (ERROR, "-5", "0", False),
        (ERROR, "< 0.001", "0.1", True), (ERROR, "< 0.001", "0.22", False),
        (ERROR, "-2", "< 0.5", False),
        (ERROR, "–", "–", True), (ERROR, "–", "1", False),
        (Agreement(2.1), "< 0.001", "0.002", True), (Agreement(2.1), "< 0.001", "0.0032", False),
        # equal
        (Agreement(1.0), "5", "5", True), (Agreement(1.0), "5", "6", False),
        (Agreement(1.0), "yes", "yes", True), (Agreement(1.0), "yes", "no", False),
    ],
)  # fmt: skip
def test_cells_agree_within_their_tolerance_either_way(agreement, old, new, is_met):
    """A number below the floor counts as the floor, and "< x" as x; words must be equal."""
    assert agreement.is_met(old, new) == agreement.is_met(new, old) == is_met


def test_the_docs_hold_every_row_of_the_plan(plan):
    """Its table names a row by its section and text; eight cells follow."""
    cells = table_cells((ROOT / "docs" / "accuracy.md").read_text(encoding="utf-8"))
    rows = {(SECTIONS[row_section(plan, row)], row["text"]) for row in plan["table"]}
    assert rows <= set(cells)
    assert all(len(cells[row]) == 8 for row in rows)


@pytest.mark.long
@pytest.mark.parametrize("part", DOCS_PARTS)
def test_the_docs_hold_every_row_of_a_run(trade, cages, part):
    """The invented numbers differ from those of the docs, but no row is missing there."""
    file = cages if part == "cages" else trade
    lines = differences(file, PLAN_FILE, ROOT / "docs" / "accuracy.md", part)
    assert lines and not [line for line in lines if line.endswith("missing")]


def test_table_cells_have_only_significant_digits():
    """Numbers have three digits, `Rough` ones two; 0.00012 % is "< 0.001", and NaN a dash.

    The first two items of the row name it and are no cells.
    """
    row = ["a", "b", 1.23456, 0.0, math.nan, Rough(1.2345), Rough(7.77), 0.00012, "yes"]
    units = ["", "", "", "", "", "%", ""]
    columns = {f"{k}": Agreement(unit=unit) for k, unit in enumerate(units)}
    table = CheckedTable(title="x", columns=columns, rows=[row])
    *_, cells = table_cells(table.text, axes=2).values()
    assert cells == ["1.23", "0", "–", "1.2", "7.8", "< 0.001", "yes"]
