"""The study of accuracy: its plan, errors, front, table and docs, with numbers made up here.

What gathers and draws a whole study takes 40 s of a core: `make test-long`.
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
NOT_CONVERGED = 1


def step(run, *outputs, settings=None, **inputs):
    return run_step(f"studies.accuracy.{run}", *outputs, settings=settings, **inputs)


@pytest.fixture(scope="module")
def plan():
    return read_accuracy(PLAN_FILE)


def invented_sweep(plan, scene, name, failed=()):
    """A sweep of the plan, or a reference of it, whose k-th point has errors of 0.1^k.

    Inner QV errs three times as much; points whose labels are `failed` have no numbers.
    """
    points = sweep_points(plan, name)
    n = len(points)
    sweep = plan["sweeps"].get(name)
    reference = reference_name(sweep) if sweep else name
    if sweep is None:
        share = np.where(np.arange(n) == 0, 0.0, 1e-4)
    else:
        share = 0.1 ** np.arange(1.0, n + 1)
    status = np.array([NOT_CONVERGED if p.label in failed else 0 for p in points], dtype=np.int8)
    numbers = {"wall_time": 1e-3 * 2.0 ** np.arange(n), "simulated_turns": np.full(n, 4.0)}
    numbers["life_wall_time"] = 10.0 * numbers["wall_time"]
    numbers["processor_time"] = numbers["wall_time"]
    numbers["life_processor_time"] = numbers["life_wall_time"]
    sizes = {"total_qv": 0.6, "qv_inner": 0.01, "qv_outer": 0.05, "residual_preload": 7.0}
    sizes |= {"wear_rate": 1e-10, "life": 1.3, "cage_wear_rate": 1e-15}
    sizes |= {"end_qv": 0.7}
    numbers |= {key: size * (1.0 + share) for key, size in sizes.items()}
    if scene == "bearing218":  # so that median and worst differ
        numbers["total_qv"] = sizes["total_qv"] * (1.0 + 2.0 * share)
    numbers["qv_inner"] = 0.01 * (1.0 - 3.0 * share)
    if reference in ("short", "long"):
        numbers["life"] = np.full(n, np.nan)
    numbers["wear_over_gap"] = [float(p.end or "nan") for p in points]
    for key in ("coriolis_energy_share", "azimuth_energy_share"):
        numbers[key] = np.full(n, 1e-5)
    for key in ("total_qv", "residual_preload", "wear_rate", "life"):
        numbers[f"estimate_{key}"] = 2.0 * share
    values = {key: np.where(status == 0, column, np.nan) for key, column in numbers.items()}
    text = {"label": [p.label for p in points], "settings": [" ".join(p.settings) for p in points]}
    return xr.Dataset(
        {key: ("point", np.array(column, dtype=object)) for key, column in text.items()}
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
    """A file for each sweep of the plan; one point of gyro_fresh has failed."""
    folder = tmp_path_factory.mktemp("points")
    paths = []
    for scene, name in sweep_jobs(plan):
        failed = ("gauss 4",) if scene == "gyro_fresh" else ()
        paths.append(folder / f"{scene}-{name}.nc")
        write_dataset(invented_sweep(plan, scene, name, failed), paths[-1])
    return paths


@pytest.fixture(scope="module")
def trade(files, tmp_path_factory):
    """The file of all sweeps, gathered."""
    path = tmp_path_factory.mktemp("trade") / "accuracy.nc"
    assert step("gather.gathered_sweeps", path, paths=files) == 0
    return path


# the plan


def test_the_plan_reads_and_every_scene_of_it_is_valid(plan):
    for scene, sweep in sweep_jobs(plan):
        points = sweep_points(plan, sweep)
        for point in points[:: max(1, len(points) - 1)]:
            file = scene_file(plan["scenes"][scene]["file"])
            load_scene(file, point.overrides(scene_settings(plan, scene)))
    assert len(plan["scenes"]) >= 5 and set(PRESET_KEYS) == {"draft", "standard", "reference"}


def test_a_scene_has_the_sweeps_of_its_references(plan):
    """bearing218 has a steady reference and none of long runs; turbine has the other way round."""
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
    data = yaml.safe_load(PLAN_FILE.read_text(encoding="utf-8")) | change
    (tmp_path / "scenes").symlink_to(ROOT / "config/scenes")
    file = tmp_path / "accuracy.yaml"
    file.write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(UsageError) as error:
        read_accuracy(file)
    assert problem in str(error.value) and "\n" not in str(error.value)


# errors and front


@pytest.mark.long
def test_errors_are_against_the_reference_of_the_scene(trade, plan):
    dataset = load(trade)
    assert dataset.sizes["point"] == sum(
        len(sweep_points(plan, name)) for _, name in sweep_jobs(plan)
    )
    is_gauss = (dataset["scene"].values == "gyro_fresh") & (dataset["sweep"].values == "gauss")
    gauss = dataset.isel(point=is_gauss)
    error = 0.1 ** np.arange(2.0, 7.0)  # of the points but the first, which failed
    assert_allclose(gauss["error_total_qv"][1:], error, rtol=1e-9)
    assert_allclose(gauss["error_qv_inner"][1:], -3.0 * error, rtol=1e-9)
    assert_allclose(gauss["error_contact_qv"][1:], 3.0 * error, rtol=1e-9)
    assert_allclose(gauss["error_life"][1:], error, rtol=1e-9)
    assert_allclose(gauss["reference_time"], 1e-3)
    assert int(gauss["status"][0]) == NOT_CONVERGED
    assert np.isnan(gauss["error_total_qv"][0]) and np.isnan(gauss["error_contact_qv"][0])


@pytest.mark.long
def test_gathering_refuses_what_does_not_belong_together(files, tmp_path):
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
    settings, output = {"which": which}, tmp_path / "a.svg"
    assert step("figures.figure", output, trade=trade, settings=settings) == 0
    assert output.stat().st_size > 0


@pytest.mark.long
def test_the_title_on_integrators_states_every_ratio_of_times(trade):
    """A dash would stand for a ratio without any scene."""
    title = integration_figure(load(trade)).get_suptitle()
    assert "Runge-Kutta" in title
    assert "–" not in title


@pytest.mark.long
def test_a_figure_is_the_same_bytes_twice(trade, tmp_path):
    settings, outputs = {"which": FIGURE_NAMES[0]}, [tmp_path / "a.svg", tmp_path / "b.svg"]
    for output in outputs:
        assert step("figures.figure", output, trade=trade, settings=settings) == 0
    assert outputs[0].read_bytes() == outputs[1].read_bytes()


@pytest.fixture
def cages(plan, tmp_path):
    """A file of ensembles, each with 0.9 times the wear of that before it."""
    paths, work = [], 1e-4 * (1.0 + 0.1 * np.arange(plan["cages"]["runs"]))
    for k, (name, row) in enumerate(plan["cages"]["ensembles"].items()):
        file = 0.9**k * work
        parts = {"work": file, "pocket_work": 0.8 * file, "land_work": 0.2 * file}
        motion = (np.arange(file.size) < k).astype(np.int8)
        parts |= {"turns": np.full(file.size, float(row["least_turns"])), "motion": motion}
        data = {part: ("run", values) for part, values in parts.items()}
        paths.append(tmp_path / f"{name}.nc")
        write_dataset(xr.Dataset(data, attrs=common_attributes()), paths[-1])
    file = tmp_path / "cages.nc"
    assert step("cages.gathered_cages", file, paths=paths) == 0
    return file


def test_ensembles_are_relative_to_the_first(cages, plan):
    """Turns, work of cage, pockets and land, 90 % interval, and the share in another motion."""
    _, table = cages_part(load(cages), plan)
    first, second, *_, last = (row[1:] for row in table.rows)
    assert first == [1.0, 1.0, 1.0, 1.0, 0.0, 1.0]
    # 1 + 0.1 k over their mean of 1.95; Student's t of 19 degrees of freedom at 95 %
    interval = 0.1 * np.arange(20).std(ddof=1) / 1.95 * 1.7291 / math.sqrt(20)
    assert_allclose(second, [30 / 450, 0.9, 0.9, 0.9, 0.1 * interval, 0.95], rtol=1e-4)
    assert last[1] == pytest.approx(0.9**5) and last[-1] == 0.75


def test_the_table_of_ensembles_is_written_into_the_docs(cages, plan, tmp_path):
    _, table = cages_part(load(cages), plan)
    docs = tmp_path / "accuracy.md"
    docs.write_text("<!-- cages: begin -->\n<!-- cages: end -->\n", encoding="utf-8")
    missing = differences(cages, PLAN_FILE, docs, "cages")
    assert len(missing) == len(table.rows) + 2  # and the head
    inputs = {"plan": PLAN_FILE, "docs": docs, "trade": cages}
    assert step("docs.docs_with_part", docs, settings={"part": "cages"}, **inputs) == 0
    assert differences(cages, PLAN_FILE, docs, "cages") == []
    assert "| 30 turns | 0.067 | 0.81 |" in docs.read_text(encoding="utf-8")


@pytest.mark.long
def test_tables_docs_and_their_check(trade, plan, cages, tmp_path, capsys):
    docs = tmp_path / "accuracy.md"
    parts = [f"<!-- {name}: begin -->\n<!-- {name}: end -->\n" for name in ("effects", "grooves")]
    docs.write_text("\n".join(["# Accuracy\n", *parts, "## Later\n"]), encoding="utf-8")
    outputs = [tmp_path / "a.csv", tmp_path / "a.md"]
    inputs = {"trade": trade, "plan": PLAN_FILE}
    assert step("docs.accuracy_tables", *outputs, **inputs) == 0
    tables = outputs[1].read_text(encoding="utf-8")
    assert "| 50 equal strips | 5 | 0.01 | 0.02 | 0.03 | 0.01 |" in tables
    assert "nan" not in tables + outputs[0].read_text(encoding="utf-8")
    assert (
        len(outputs[0].read_text(encoding="utf-8").splitlines()) == 1 + load(trade).sizes["point"]
    )

    inputs |= {"docs": docs}

    def renew():
        others = dict.fromkeys(DOCS_PARTS, inputs) | {"cages": inputs | {"trade": cages}}
        return {
            step("docs.docs_with_part", docs, settings={"part": part}, **some)
            for part, some in others.items()
        }

    def check():
        return step("docs.check_docs", tmp_path / "check.txt", cages=cages, **inputs)

    assert check() == 2  # no such part yet
    assert renew() == {0} and check() == 0
    assert (tmp_path / "check.txt").read_text().startswith(f"{docs}: ")
    once = docs.read_text(encoding="utf-8")
    assert once.startswith("# Accuracy\n\n<!-- effects: begin -->\n")
    cells = table_cells(once)
    assert cells.items() >= table_cells(tables).items()
    assert once.index("<!-- grooves: end -->\n\n## Later\n") < once.index("| 50 equal strips |")
    assert renew() == {0} and docs.read_text(encoding="utf-8") == once  # not a second time
    assert step("docs.docs_with_part", docs, settings={"part": "x"}, **inputs) == 2

    # numbers of the docs that differ by more than the tolerance are named, one in a line
    for old, new, difference in [
        (
            "| 50 equal strips | 5 | 0.01 ",
            "| 50 equal strips | 5 | 0.03 ",
            "50 equal strips: median QV: .* 0.03, .* 0.01",
        ),
        ("| 50 equal strips | 5 | 0.01 ", "| 50 equal strips | 5 | 0.019 ", ""),
        (
            "| gyro_worn | 0.918 |",
            "| gyro_worn | 0.94 |",
            "fixed-position preload: growth at speed, gyro_worn: preload: .* 0.94",
        ),
        (
            "| yes |",
            "| no |",
            "gyro_fresh: worn profile: .* no,",
        ),
        ("| 50 equal strips |", "| 51 equal strips |", "50 equal strips: missing"),
    ]:
        assert old in once
        docs.write_text(once.replace(old, new, 1))
        capsys.readouterr()
        assert check() == (3 if difference else 0)
        lines = capsys.readouterr().err.splitlines()
        if difference:
            line, count = lines
            assert re.search(difference, line) and numbers_in(count) == [1.0]
        else:
            assert lines == []


@pytest.mark.parametrize(
    ("agreement", "old", "new", "is_met"),
    [
        # a factor of 2.1, or both below 0.1 %
        *((Agreement(2.1, 0.1, "%"), old, new, True) for old, new in (
            ("0.1", "0.2"), ("0.001", "0.09"), ("< 0.001", "0.1"), ("–", "–"), ("5", "10"),
            ("-5", "-10"), ("-0.05", "0.1"),
        )),
        *((Agreement(2.1, 0.1, "%"), old, new, False) for old, new in (
            ("0.1", "0.22"), ("–", "1"), ("5", "11"), ("< 0.001", "0.22"), ("-5", "-11"),
            ("-5", "5"), ("-5", "0"), ("-2", "< 0.5"),
        )),
        (Agreement(2.1), "< 0.001", "0.002", True),
        (Agreement(2.1), "< 0.001", "0.0032", False),
        # equal
        (Agreement(1.0), "5", "5", True),
        (Agreement(1.0), "5", "6", False),
        (Agreement(1.0), "yes", "yes", True),
        (Agreement(1.0), "yes", "no", False),
    ],
)  # fmt: skip
def test_cells_agree_within_their_tolerance_either_way(agreement, old, new, is_met):
    assert agreement.is_met(old, new) == agreement.is_met(new, old) == is_met


def test_the_docs_hold_every_row_of_the_plan(plan):
    cells = table_cells((ROOT / "docs" / "accuracy.md").read_text(encoding="utf-8"))
    rows = {(SECTIONS[row_section(plan, row)], row["text"]) for row in plan["table"]}
    assert rows <= set(cells)
    assert all(len(cells[row]) == 8 for row in rows)


@pytest.mark.long
@pytest.mark.parametrize("part", DOCS_PARTS)
def test_the_docs_hold_every_row_of_a_run(trade, cages, part):
    """Each row, on each scene, though the numbers invented here are not those of the docs."""
    file = cages if part == "cages" else trade
    lines = differences(file, PLAN_FILE, ROOT / "docs" / "accuracy.md", part)
    assert lines and not [line for line in lines if line.endswith("missing")]


def test_table_cells_have_only_significant_digits():
    row = ["a", "b", 1.23456, 0.0, math.nan, Rough(1.2345), Rough(7.77), 0.00012, "yes"]
    units = ["", "", "", "", "", "%", ""]
    columns = {f"{k}": Agreement(unit=unit) for k, unit in enumerate(units)}
    table = CheckedTable(title="x", columns=columns, rows=[row])
    *_, cells = table_cells(table.text, axes=2).values()
    assert cells == ["1.23", "0", "–", "1.2", "7.8", "< 0.001", "yes"]
