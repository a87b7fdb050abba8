"""The design study: the choice of a preload, and its steps on a map of a few lives."""

import math
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
import yaml
from numpy.testing import assert_allclose
from support import scene_file, step

from bearingwear.cli import main
from bearingwear.document.show import sheet
from bearingwear.document.text import as_text
from bearingwear.kernels.status import STATUS_NAMES
from bearingwear.measures import LIMITED
from bearingwear.results.netcdf import load
from bearingwear.scene.arrangement import with_method
from bearingwear.scene.read import load_scene
from bearingwear.studies.dataset import write_dataset
from bearingwear.studies.design.choice import (
    ACTIVE,
    best_within,
    design_map,
    pareto_front,
)
from bearingwear.studies.design.document.check_table import (
    SHARE_LABEL,
    CheckedPreload,
    ComparedNumber,
    agreement,
)
from bearingwear.studies.design.dynamic_check import check_scene
from bearingwear.studies.design.map import HERTZIAN_GROOVE, life_point, map_part
from bearingwear.studies.design.plan import DesignLimits, MapAxes
from bearingwear.studies.design.recommend import preload_map, recommendation, recommendation_of
from bearingwear.studies.uncertainty.quantiles import quantiles_and_indices

NOT_CONVERGED, BEYOND_GROOVE = (STATUS_NAMES.index(n) for n in ("not_converged", "beyond_groove"))
METHODS = ("constant_force", "fixed_position")
# requirements of the study in `folder`: a recommendation has 3 N/um
LIMITS = {
    "gyroscopic_slip_share": 0.25,
    "axial_stiffness_N_um": 3.0,
    "maximum_pressure_GPa": 1.5,
    "friction_power_W": 0.2,
}
SAMPLING = {"samples": 4, "seed": 3}
FILES = ("design", "recommendation", "uncertainty")


@pytest.fixture
def scene():
    """Returns gyro_s1, here in place of the fixture of tests/conftest.py."""
    return load_scene(scene_file("gyro_s1"))


# the choice


def invented_line(lives, stiffness, status=None):
    """Returns a line of a map of one method, at preloads of 1, 2, ... N and powers of 0.1 W per N.

    lives: in any unit, NaN where the status is not zero. stiffness [N/um], of one bearing and of
    the system. status: all zero if omitted.
    """
    n = len(lives)
    status = np.zeros(n, dtype=np.int8) if status is None else np.array(status, dtype=np.int8)
    lives = np.where(status == 0, lives, np.nan)
    return xr.Dataset(
        {
            "status": ("preload", status),
            "life": ("preload", lives),
            "axial_stiffness": ("preload", 1e6 * np.asarray(stiffness)),
            "system_axial_stiffness": ("preload", 1e6 * np.asarray(stiffness)),
            "friction_power": ("preload", 0.1 * np.arange(1.0, n + 1)),
            "impractical": ("preload", np.zeros(n, dtype=np.int8)),
        },
        {"preload": np.arange(1.0, n + 1)},
    )


STIFF = DesignLimits(axial_stiffness_N_um=2.5, at_speed_only=True)
POWER = DesignLimits(friction_power_W=0.25, at_speed_only=True)
UP, DOWN = [1, 2, 3, 4], [9, 8, 7, 6]  # lives or stiffnesses along a line


@pytest.mark.parametrize(
    "line, limits, index, active",
    [
        (invented_line(DOWN, UP), STIFF, 2, "axial_stiffness_N_um"),
        (
            invented_line(DOWN, UP),
            DesignLimits(friction_power_W=1.0, at_speed_only=True),
            0,
            "end_of_range",
        ),
        (invented_line([5, 8, 7, 6], UP), DesignLimits(at_speed_only=True), 1, "none"),
        (invented_line(UP, UP), POWER, 1, "friction_power_W"),
        (invented_line(DOWN, [1, 2, 2, 2]), STIFF, -1, "no_preload_within_limits"),
        (
            invented_line(DOWN, [3, 3, 3, 4], [0, 1, 0, 0]),
            DesignLimits(at_speed_only=True),
            0,
            "not_solved",
        ),
        (invented_line(DOWN, [3, 3, 3, 4], [1, 1, 0, 0]), STIFF, 2, "not_solved"),
    ],
)
def test_the_best_point_of_a_line_and_what_forbids_its_neighbour(line, limits, index, active):
    """index: of the best point, -1 where no preload is within the limits.

    active: name in `ACTIVE` of what its neighbour with a longer life violates. It is `none` if both
        neighbours are worse, and `end_of_range` if the neighbour is missing.
    """
    best, limit = best_within(line, limits)
    assert int(best) == index
    assert ACTIVE[int(limit)] == active


def test_the_pareto_front_omits_dominated_and_unsolved_points():
    """The third point is softer than the second and lives shorter; the fourth is not solved."""
    line = invented_line([9, 8, 7, 6, 5], [1, 3, 2, 4, 5], [0, 0, 0, NOT_CONVERGED, 0])
    assert pareto_front(line).values.tolist() == [True, True, False, False, True]


# the steps, on a map of a few lives


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Returns the folder of a design study of gyro_s1 at five preloads, at its full speed alone.

    Its files are a part of the map for each method, the map, the recommendation and the spread.
    """
    folder = tmp_path_factory.mktemp("design")
    scene = scene_file("gyro_s1")
    design, recommendation = folder / "design.nc", folder / "recommendation.nc"
    preloads = [3.0, 5.0, 7.0, 9.0, 11.0]
    parts = []
    for method in METHODS:
        parts.append(folder / f"{method}.nc")
        write_dataset(
            map_part(scene, method, 0.08, [30000.0], preloads, slip_limit=0.25), parts[-1]
        )
    write_dataset(design_map(parts, LIMITS), design)
    write_dataset(recommendation_of(scene, design), recommendation)
    sampled = quantiles_and_indices(scene, recommendation, METHODS, **SAMPLING)
    write_dataset(sampled, folder / "uncertainty.nc")
    return folder


def files_in(folder):
    """Returns the paths of map, recommendation and spread, by the arguments of steps."""
    return {name: folder / f"{name}.nc" for name in FILES}


def test_a_method_without_a_preload_has_no_status_of_a_solve(folder, tmp_path):
    """No preload has the required 40 N/um: the status is -1, and not the last of the names."""
    design, file = tmp_path / "design.nc", tmp_path / "recommendation.nc"
    parts = [folder / f"{method}.nc" for method in METHODS]
    write_dataset(design_map(parts, LIMITS | {"axial_stiffness_N_um": 40.0}), design)
    write_dataset(recommendation_of(scene_file("gyro_s1"), design), file)
    assert load(file)["status"].values.tolist() == [-1, -1]
    text = as_text(sheet(file))
    assert "nothing to solve" in text and STATUS_NAMES[-1] not in text


@pytest.mark.parametrize("name", ["constant_force", "recommendation", "uncertainty"])
def test_single_files_are_drawn(folder, name, tmp_path):
    """A part of a map (`constant_force`) is drawn as a map."""
    figure = tmp_path / f"{name}.svg"
    assert main(["plot", str(folder / f"{name}.nc"), "-o", str(figure)]) == 0
    assert "<path" in figure.read_text(encoding="utf-8")


@pytest.mark.parametrize("k", range(2))
def test_the_recommended_preload_just_meets_its_limit(folder, scene, k):
    """Stiffness is at most 1 % above its limit; with one less in the third digit it is below.

    The preload has at most four digits. The requirement on slip is satisfied as well.

    k: of the preload method.
    """
    point = load(folder / "recommendation.nc").isel(preload_method=k)
    assert int(point["status"]) == 0
    assert ACTIVE[int(point["active_limit"])] == "axial_stiffness_N_um"
    preload = float(point["preload"])
    assert preload == float(f"{preload:.4g}")
    assert 3.0e6 <= float(LIMITED["axial_stiffness_N_um"].worst(point)) < 3.0e6 * 1.01
    third_digit = 10.0 ** (math.floor(math.log10(preload)) - 2)
    less_preloaded = life_point(with_method(scene, METHODS[k], preload - third_digit), None)
    assert LIMITED["axial_stiffness_N_um"].worst(less_preloaded) < 3.0e6
    assert float(point["gyroscopic_slip_share"]) <= 0.25
    assert 0.0 < float(point["life_error_estimate"]) < 0.1


def test_no_preload_of_the_map_within_the_limits_lives_longer_than_the_recommended(folder):
    """The variable `recommended_life` of a map is the longest allowed life of its own preloads."""
    dataset, design = load(folder / "recommendation.nc"), load(folder / "design.nc")
    assert np.all(dataset["life"].values >= design["recommended_life"].values[:, 0, 0])


def test_a_recommendation_with_the_hertzian_groove_has_its_life(folder):
    dataset = load(folder / "recommendation.nc")
    assert (dataset["groove"] == HERTZIAN_GROOVE).all()
    assert (dataset["hertzian_life"] == dataset["life"]).all()


DRAW, TABLES = "studies.design.figures.draw", "studies.design.document.sheets.tables"


def test_figures_and_tables_are_drawn(folder, tmp_path):
    """The figure has curves, and the tables have a row for each point of the map."""
    files = files_in(folder)
    out = tmp_path / "design.svg"
    assert step(f"{DRAW}.draw_design", out, **files) == 0
    assert out.stat().st_size > 10_000  # bytes; empty axes have fewer
    tables = [tmp_path / "map.csv", tmp_path / "design.md"]
    assert step(TABLES, *tables, **files) == 0
    text = (tmp_path / "design.md").read_text()
    assert text.count("\n| ") > 20 and "nan" not in text  # rows of all its tables
    # a head, and five preloads by two methods
    assert len((tmp_path / "map.csv").read_text().splitlines()) == 1 + 5 * 2


def test_figures_and_tables_of_wrong_files_are_refused(folder, tmp_path):
    """The status is 2 for an unknown figure, files in the wrong order, and a spread as a map."""
    files = files_in(folder)
    tables = [tmp_path / "map.csv", tmp_path / "design.md"]
    assert step(f"{DRAW}.other", tmp_path / "x.svg", **files) == 2
    wrong = dict(zip(FILES, reversed(files.values()), strict=True))
    assert step(TABLES, *tables, **wrong) == 2
    assert step(f"{DRAW}.draw_map", tmp_path / "x.svg", design=files["uncertainty"]) == 2


def changed_case(path, target, status=None, qv_factor=1.0):
    """Writes a copy of a case file with another status or total QV; returns its path as text."""
    case = load(path)
    if status is not None:
        case["status"][...] = status
    case["total_qv"] *= qv_factor
    case.to_netcdf(target)
    return str(target)


TIMES = ("0.80", "1.25")
"""Factors on the recommended preload, at which it is checked by the dynamic model."""


def checking_scene_text(folder, path, times):
    """Writes the scene that checks a recommendation at a multiple of its preload; returns its data.

    times: the factor, as text.
    """
    files = {"scene": scene_file("gyro_s1"), "recommendation": folder / "recommendation.nc"}
    run = "studies.design.dynamic_check.check_scene_text"
    assert step(run, path, settings={"times": float(times)}, **files) == 0
    return yaml.safe_load(path.read_text())


@pytest.mark.parametrize("times", TIMES)
def test_the_scene_that_checks_a_recommendation_has_its_preload_and_method(folder, times, tmp_path):
    """It has the method with the longer life, and a cage, which the dynamic model solves."""
    dataset, path = load(folder / "recommendation.nc"), tmp_path / "check.yaml"
    longest = int(np.argmax(dataset["life"].values))
    operation = checking_scene_text(folder, path, times)["operation"]
    preload = float(times) * float(dataset["preload"][longest])
    assert operation["preload_N"] == pytest.approx(preload, rel=1e-12)
    assert operation["preload_method"] == METHODS[longest]
    assert load_scene(path).cage is not None


@pytest.fixture(scope="module")
def checking_cases(folder, tmp_path_factory):
    """Returns the paths of cases that check the recommendation, without a cage.

    They are the steady and the dynamic case at the first of TIMES, then both at the second.
    """
    cases, target = [], tmp_path_factory.mktemp("cases")
    for times in TIMES:
        path = target / f"{times}.yaml"
        data = checking_scene_text(folder, path, times)
        path.write_text(yaml.safe_dump({k: v for k, v in data.items() if k != "cage"}))
        for fidelity in ("steady", "dynamic"):
            cases.append(str(target / f"{times}-{fidelity}.nc"))
            assert main(["solve", str(path), "--fidelity", fidelity, "-o", cases[-1]]) == 0
    return cases


def check_table(folder, out, cases):
    """Writes the table that compares steady and dynamic cases; returns the status of the step."""
    inputs = {"recommendation": folder / "recommendation.nc", "cases": list(cases)}
    return step("studies.design.document.check_table.check_table", out, **inputs)


def test_dynamic_cases_without_a_cage_stay_in_the_steady_state(folder, checking_cases, tmp_path):
    """QV agrees to 1e-9; the table marks no difference in QV and wear rate at both preloads."""
    for steady, dynamic in zip(checking_cases[::2], checking_cases[1::2], strict=True):
        assert_allclose(load(dynamic)["total_qv"], load(steady)["total_qv"], rtol=1e-9)
    out = tmp_path / "check.md"
    assert check_table(folder, out, checking_cases) == 0
    assert out.read_text().count("| no |") == 2 * len(TIMES) and "| yes |" not in out.read_text()


def test_the_agreement_of_numbers_without_an_error_estimate_is_not_known():
    """It is neither claimed nor denied where estimates are NaN, however close the numbers are."""
    qv = ComparedNumber(preload=7.0, name="QV (W)", steady=1.0, dynamic=1.001)
    slip = replace(qv, name=SHARE_LABEL)
    point = CheckedPreload(preload=7.0, numbers=[qv, slip], settled="", status={})
    text = agreement([point])
    assert "not known" in text and "agrees" not in text and "does not agree" not in text


def test_a_dynamic_case_with_another_qv_is_marked(folder, checking_cases, tmp_path):
    """Its QV is raised by 1 % plus twice the error estimate of a steady case, beyond tolerance."""
    *others, last = checking_cases
    beyond = 1.0 + 2.0 * float(load(checking_cases[0])["qv_error_estimate"]) + 0.01
    changed, out = changed_case(last, tmp_path / "qv.nc", qv_factor=beyond), tmp_path / "check.md"
    assert check_table(folder, out, [*others, changed]) == 0
    (row,) = (line for line in out.read_text().splitlines() if "| yes |" in line)
    assert "QV" in row


def test_an_unsolved_dynamic_case_is_named_in_the_check(folder, checking_cases, tmp_path):
    """The step still succeeds; the table has the words of its status."""
    *others, last = checking_cases
    unsolved = changed_case(last, tmp_path / "unsolved.nc", status=NOT_CONVERGED)
    assert check_table(folder, tmp_path / "check.md", [*others, unsolved]) == 0
    assert "not converged" in (tmp_path / "check.md").read_text()


def test_cases_that_check_no_recommendation_are_refused_in_one_line(
    folder, checking_cases, tmp_path, capsys
):
    """Refused are three of four cases, a recommendation in place of cases, and a map among them."""
    recommendation, design = folder / "recommendation.nc", folder / "design.nc"
    capsys.readouterr()
    for wrong in (checking_cases[:-1], [recommendation], [*checking_cases, design]):
        assert check_table(folder, tmp_path / "check.md", wrong) == 2
        assert capsys.readouterr().err.count("\n") == 1


def test_nothing_recommended_is_checked_at_the_scene_s_own_preload(scene, folder):
    """Without a recommended preload, the scene of the check has 0.8 times that of the study."""
    none = load(folder / "recommendation.nc")
    none["life"] *= math.nan
    none["preload"] *= math.nan
    checked = check_scene(scene, none, 0.8)
    assert checked.operation.preload_N == pytest.approx(0.8 * scene.operation.preload_N)
    assert checked.operation.preload_method == scene.operation.preload_method


def test_a_map_counts_the_solves_of_each_life(folder):
    """A life takes five solves or more, for its states of wear; none of them fails here."""
    design = load(folder / "design.nc")
    assert int(design["solves"].min()) >= 5 and int(design["failed_solves"].max()) == 0


def test_every_status_is_in_the_table(folder, tmp_path):
    """Two of ten lives are marked as not solved; the CSV has their statuses by name."""
    design = load(folder / "design.nc")
    design["status"].values[0, 0, 0, :2] = NOT_CONVERGED, BEYOND_GROOVE
    design.to_netcdf(tmp_path / "design.nc")
    files = files_in(folder) | {"design": tmp_path / "design.nc"}
    out = [tmp_path / "map.csv", tmp_path / "design.md"]
    assert step("studies.design.document.sheets.tables", *out, **files) == 0
    for name, count in (("ok", 8), ("not_converged", 1), ("beyond_groove", 1)):
        assert (tmp_path / "map.csv").read_text().count(f",{name},") == count


@pytest.mark.parametrize(
    ("names", "slip_limit", "status"),
    [
        pytest.param(METHODS, 0.25, 0, id="right parts"),
        pytest.param(METHODS, 0.5, 2, id="another slip limit"),
        pytest.param(("design", "recommendation"), 0.25, 2, id="other files"),
    ],
)
def test_a_map_is_gathered_of_parts_with_its_slip_limit(
    folder, names, slip_limit, status, tmp_path, capsys
):
    """The parts have times to a slip share of 0.25. A fault gives one line and status 2."""
    settings = {"limits": {"gyroscopic_slip_share": slip_limit}}
    parts = [folder / f"{name}.nc" for name in names]
    gather = "studies.design.choice.design_map"
    assert step(gather, tmp_path / "out.nc", settings=settings, parts=parts) == status
    assert len(capsys.readouterr().err.splitlines()) == (status != 0)


def test_a_map_of_another_scene_is_not_recommended_from(folder, tmp_path, capsys):
    inputs = {"scene": scene_file("gyro_s2"), "design": folder / "design.nc"}
    recommend = "studies.design.recommend.recommendation_of"
    assert step(recommend, tmp_path / "out.nc", **inputs) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "another scene" in line


@pytest.mark.parametrize(
    ("name", "problem"),
    [("design", "recommendation file"), ("recommendation", "another scene")],
)
def test_a_spread_needs_a_recommendation_for_its_scene(folder, name, problem, tmp_path, capsys):
    """For a spread of gyro_s2, the map of gyro_s1 and its recommendation are refused."""
    inputs = {"scene": scene_file("gyro_s2"), "methods": "constant_force"}
    inputs["recommendation"] = folder / f"{name}.nc"
    quantiles = "studies.uncertainty.quantiles.quantiles_and_indices"
    assert step(quantiles, tmp_path / "out.nc", **inputs) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert problem in line


def test_a_limit_can_be_changed_without_another_map(folder):
    """With 3 N/um, the best of the five preloads are 5 and 11 N by the two methods.

    With 4 N/um they are 7 N and none. The lives of the map stay the same.
    """
    parts = [folder / f"{method}.nc" for method in METHODS]
    dataset = load(folder / "design.nc")
    stiffer = design_map(parts, LIMITS | {"axial_stiffness_N_um": 4.0})
    assert dataset["recommended_preload"].values.ravel().tolist() == [5.0, 11.0]
    assert_allclose(stiffer["recommended_preload"].values.ravel(), [7.0, math.nan])
    assert ACTIVE[int(stiffer["active_limit"].values.ravel()[1])] == "no_preload_within_limits"
    assert stiffer["life"].equals(dataset["life"])


# a small map, in one process


def axes(preloads, friction=0.08):
    """Returns the axes of a map of both methods at the speed of gyro_s1."""
    return MapAxes(
        preload_method=METHODS, friction=(friction,), shaft_speed_rpm=(30000.0,), preload_N=preloads
    )


def test_a_small_map_has_what_the_parts_of_a_large_one_have(scene, folder):
    """Values and the attributes of the dataset are equal; attributes of variables may differ."""
    limits = DesignLimits(**LIMITS, at_speed_only=True)
    design = preload_map(scene, axes((3.0, 5.0, 7.0, 9.0, 11.0)), limits)
    dataset = load(folder / "design.nc")
    xr.testing.assert_equal(design.drop_attrs(), dataset.drop_attrs())
    assert design.attrs == dataset.attrs


def test_the_limit_that_is_met_first_holds(scene):
    """With falling preload, the stiffness is the first to reach its limit, and so decides.

    There the slip share is below its limit of 0.2. At 3 N it violates that limit by more than the
    stiffness violates its own.
    """
    limits = DesignLimits(axial_stiffness_N_um=3.0, gyroscopic_slip_share=0.2, at_speed_only=True)
    point = recommendation(scene, limits).isel(preload_method=0)
    assert 3.0e6 <= float(LIMITED["axial_stiffness_N_um"].worst(point)) < 3.0e6 * 1.01
    assert float(point["gyroscopic_slip_share"]) < 0.199
    assert ACTIVE[int(point["active_limit"])] == "axial_stiffness_N_um"


@pytest.mark.parametrize(("life", "drawn"), [(0.0, "map"), (np.nan, "design")])
def test_figures_of_a_map_without_any_life(life, drawn, folder, tmp_path):
    """Lives are all zero or all unsolved (NaN), so that their axis cannot be logarithmic.

    drawn: `map` for the map alone, `design` for the map with its recommendation.
    """
    files = {name: tmp_path / f"{name}.nc" for name in ("design", "recommendation")}
    for name, file in files.items():
        dataset = load(folder / f"{name}.nc")
        dataset["life"][:] = life
        if name == "recommendation":
            dataset["preload"][:] = np.nan
        write_dataset(dataset, file)
    inputs = files if drawn == "design" else {"design": files["design"]}
    draw = f"studies.design.figures.draw.draw_{drawn}"
    assert step(draw, tmp_path / "a.svg", **inputs) == 0
