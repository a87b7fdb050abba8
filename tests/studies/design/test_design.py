"""The design study: its plan, the choice of a preload, and its steps on a map of a few lives."""

import math
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest
import xarray as xr
import yaml
from numpy.testing import assert_allclose
from support import ROOT, scene_file

from bearingwear.cli import main
from bearingwear.document.show import sheet
from bearingwear.document.text import as_text
from bearingwear.kernels.status import STATUS_NAMES
from bearingwear.measures import LIMITED
from bearingwear.results.netcdf import load
from bearingwear.results.quantiles import spread_at
from bearingwear.results.units import Rough
from bearingwear.results.words import in_words
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.checking.check import read_record
from bearingwear.scene.read import load_scene
from bearingwear.studies.dataset import write_dataset
from bearingwear.studies.design.choice import (
    ACTIVE,
    best_within,
    design_map,
    front,
    why_none,
)
from bearingwear.studies.design.dynamic_check import check_scene
from bearingwear.studies.design.map import HERTZIAN_GROOVE, life_point, map_part
from bearingwear.studies.design.plan import DesignLimits, DesignPlan, MapAxes
from bearingwear.studies.design.recommend import mapped, recommendation_of
from bearingwear.studies.design.study import DesignStudy
from bearingwear.studies.protocol import flat_files
from bearingwear.studies.uncertainty.quantiles import quantiles_and_indices
from bearingwear.studies.uncertainty.sample import sampled_lives

PLAN_FILE = ROOT / "config" / "design.yaml"
NOT_CONVERGED, BEYOND_GROOVE = (STATUS_NAMES.index(n) for n in ("not_converged", "beyond_groove"))
METHODS = ("constant_force", "fixed_position")
LIMITS = {
    "gyroscopic_slip_share": 0.25,
    "axial_stiffness_N_um": 3.0,
    "maximum_pressure_GPa": 1.5,
    "friction_power_W": 0.2,
}
SAMPLING = {"samples": 4, "chunks": 2, "seed": 3}
FILES = ("design", "recommendation", "uncertainty")


@pytest.fixture
def scene():
    return load_scene(scene_file("gyro_s1"))


# the plan


def test_plan_of_the_project():
    plan = read_record(DesignPlan, PLAN_FILE)
    plan.check_scenes(ROOT / "config" / "scenes")
    for name, of in plan.scenes.items():
        scene = load_scene(scene_file(name))
        assert of.map.lives >= 20_000
        assert scene.operation.preload_N in of.map.preload_N
        assert scene.friction.ball_race in of.map.friction
        assert scene.operation.shaft_speed_rpm in of.map.shaft_speed_rpm
        limits = {**LIMITS, "system_axial_stiffness_N_um": LIMITS["axial_stiffness_N_um"]}
        del limits["axial_stiffness_N_um"]  # of the arrangement, which means the same for both
        assert of.limits.given == limits


def test_small_map_of_the_project_is_around_its_scene():
    plan = read_record(DesignPlan, PLAN_FILE)
    assert plan.small_maps
    for name, axes in plan.small_maps.items():
        scene = load_scene(scene_file(name))
        assert axes.lives <= 40
        assert scene.friction.ball_race in axes.friction
        assert scene.operation.shaft_speed_rpm in axes.shaft_speed_rpm


# the choice


def made_up(lives, stiffness, status=None):
    """A line of a map of one method."""
    n = len(lives)
    status = np.zeros(n, dtype=np.int8) if status is None else np.array(status, dtype=np.int8)
    lives = np.where(status == 0, lives, np.nan)
    return xr.Dataset(
        {
            "status": ("preload", status),
            "life": (("preload", "loss_basis"), np.stack([10.0 * lives, lives], axis=-1)),
            "axial_stiffness": ("preload", 1e6 * np.asarray(stiffness)),
            "system_axial_stiffness": ("preload", 1e6 * np.asarray(stiffness)),
            "friction_power": ("preload", 0.1 * np.arange(1.0, n + 1)),
            "impractical": ("preload", np.zeros(n, dtype=np.int8)),
        },
        {"preload": np.arange(1.0, n + 1)},
    )


STIFF = DesignLimits(axial_stiffness_N_um=2.5)


@pytest.mark.parametrize(
    "line, limits, index, active",
    [
        (made_up([9, 8, 7, 6], [1, 2, 3, 4]), STIFF, 2, "axial_stiffness_N_um"),
        (
            made_up([9, 8, 7, 6], [1, 2, 3, 4]),
            DesignLimits(friction_power_W=1.0),
            0,
            "end_of_range",
        ),
        (made_up([5, 8, 7, 6], [1, 2, 3, 4]), DesignLimits(), 1, "none"),
        (
            made_up([1, 2, 3, 4], [1, 2, 3, 4]),
            DesignLimits(friction_power_W=0.25),
            1,
            "friction_power_W",
        ),
        (made_up([9, 8, 7, 6], [1, 2, 2, 2]), STIFF, -1, "no_preload_within_limits"),
        (made_up([9, 8, 7, 6], [3, 3, 3, 4], [0, 1, 0, 0]), DesignLimits(), 0, "not_solved"),
        (made_up([9, 8, 7, 6], [3, 3, 3, 4], [1, 1, 0, 0]), STIFF, 2, "not_solved"),
    ],
)
def test_choice_and_what_holds_it(line, limits, index, active):
    found, held = best_within(line, limits, basis=1)
    assert int(found) == index
    assert ACTIVE[int(held)] == active


def test_a_method_without_a_preload_within_the_limits_is_called_so(tmp_path, capsys):
    """Its status is -1, which must not be read as the last of the names."""
    scene, parts = scene_file("gyro_s1"), []
    for method in METHODS:
        parts.append(tmp_path / f"{method}.nc")
        part = map_part(scene, method, 0.08, [30000.0], [5.0, 7.0, 9.0], slip_limit=0.25)
        write_dataset(part, parts[-1])
    design, file = tmp_path / "design.nc", tmp_path / "recommendation.nc"
    write_dataset(design_map(parts, LIMITS | {"axial_stiffness_N_um": 4.6}), design)
    write_dataset(recommendation_of(scene, design), file)
    assert load(file)["status"].values.tolist() == [0, -1]
    assert main(["show", str(file)]) == 0
    text = capsys.readouterr().out
    assert re.search(
        r"limited by +dynamic axial stiffness of one bearing +no preload satisfies all limits", text
    )
    assert re.search(r"least stiffness, one bearing, dynamic +N/um +4\.6\d? +–\n", text)
    assert re.search(r"least stiffness, one bearing, quasi-static +N/um +4\.6\d? +–\n", text)
    # and so it is where a file is shown like any other
    several = as_text(sheet(file))
    assert "there was none to solve" in several and "jammed" not in several


def test_single_files_are_drawn(folder, tmp_path, capsys):
    """A map of one friction as lines, a recommendation, the spread of one scene's life."""
    spread = tmp_path / "spread.nc"
    scene = str(scene_file("gyro_s1"))
    assert main(["uncertainty", scene, "--samples", "16", "-o", str(spread)]) == 0
    files = {
        folder / "design.nc": "life, stiffness of one bearing and slip over preload",
        folder / "constant_force.nc": "life, stiffness of one bearing and slip over preload",
        folder / "recommendation.nc": "life at the recommended preload",
        folder / "uncertainty.nc": "90\N{NO-BREAK SPACE}% of bearings between",
        spread: "90\N{NO-BREAK SPACE}% of bearings between",
    }
    for path, said in files.items():
        figure = tmp_path / f"{path.stem}.svg"
        assert main(["plot", str(path), "-o", str(figure)]) == 0
        title = ET.parse(figure).getroot().findtext("{http://www.w3.org/2000/svg}title")
        assert said in title, title


@pytest.mark.parametrize(
    "limits, why",
    [
        (
            DesignLimits(axial_stiffness_N_um=5.0, friction_power_W=0.35),
            "axial stiffness of one bearing at least 5 N/µm, at best 4 at 4 N",
        ),
        (
            DesignLimits(axial_stiffness_N_um=3.5, friction_power_W=0.33),
            "each limit can be satisfied, but not all together: axial stiffness of one bearing at "
            "least 3.5 N/µm, "
            "but 3 at 3 N",
        ),
    ],
)
def test_limits_that_no_preload_keeps_to_are_named(limits, why):
    line = made_up([9, 8, 7, 6], [1, 2, 3, 4])
    assert int(best_within(line, limits, basis=1)[0]) == -1
    assert why_none(line, limits, basis=1) == why


def test_nothing_lives_or_nothing_was_solved():
    unsolved = made_up([9, 8], [1, 2], [NOT_CONVERGED, NOT_CONVERGED])
    assert why_none(unsolved, STIFF, basis=1) == "no life could be solved"
    assert why_none(made_up([0, 0], [1, 2]), STIFF, basis=1) == "every life ends when new"


def test_front_leaves_out_what_is_beaten_or_unsolved():
    line = made_up([9, 8, 7, 6, 5], [1, 3, 2, 4, 5], [0, 0, 0, NOT_CONVERGED, 0])
    assert front(line, 1).values.tolist() == [True, True, False, False, True]


# the steps, on a map of a few lives


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The whole design study."""
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
    samples = []
    for method in METHODS:
        for choice, chosen_by in (("own", None), ("recommended", recommendation)):
            for chunk in (0, 1):
                samples.append(folder / f"{method}-{choice}-{chunk}.nc")
                one = sampled_lives(scene, method, choice, chunk, SAMPLING, chosen_by)
                write_dataset(one, samples[-1])
    write_dataset(quantiles_and_indices(scene, samples, SAMPLING), folder / "uncertainty.nc")
    return folder


def step(name, output, settings="{}", **inputs):
    """Exit status of a step; lists of files are added one by one."""
    given = [
        f"{key}+={path}" if isinstance(files, list) else f"{key}={path}"
        for key, files in inputs.items()
        for path in (files if isinstance(files, list) else [files])
    ]
    outputs = [str(path) for path in (output if isinstance(output, list) else [output])]
    return main(["step", f"studies.{name}", *given, "--settings", settings, "-o", *outputs])


def files_in(folder):
    return {name: folder / f"{name}.nc" for name in FILES}


def test_recommended_preload_stands_on_its_limit(folder, scene):
    found = load(folder / "recommendation.nc")
    assert found["status"].values.tolist() == [0, 0]
    for k in range(2):
        one = found.isel(preload_method=k)
        assert ACTIVE[int(one["active_limit"])] == "axial_stiffness_N_um"
        # in few digits, of which the last but one cannot be lower
        preload = float(one["preload"])
        assert preload == float(f"{preload:.4g}")
        assert 3.0e6 <= float(LIMITED["axial_stiffness_N_um"].worst(one)) < 3.0e6 * 1.01
        unit = 10.0 ** (math.floor(math.log10(preload)) - 2)
        less = life_point(held_by(scene, METHODS[k], preload - unit), None)
        assert LIMITED["axial_stiffness_N_um"].worst(less) < 3.0e6
        assert float(one["gyroscopic_slip_share"]) <= 0.25
        assert 0.0 < float(one["life_error_estimate"][1]) < 0.1
    # no preload of the map within the limits lasts longer
    design = load(folder / "design.nc")
    assert np.all(found["life"].values >= design["recommended_life"].values[:, 0, 0])
    # with the Hertzian groove of this scene
    assert (found["groove"] == HERTZIAN_GROOVE).all()
    assert_allclose(found["hertzian_life"], found["life"], rtol=0.0)


def test_figures_and_tables_are_drawn(folder):
    files = files_in(folder)
    for name, given in (
        ("design", files),
        ("map", {"design": files["design"]}),
        ("uncertainty", files),
    ):
        out = folder / f"{name}.svg"
        assert step(f"design.figures.draw.draw_{name}", out, **given) == 0
        assert out.stat().st_size > 10_000
    tables = [folder / "map.csv", folder / "design.md"]
    assert step("design.document.sheets.tables", tables, **files) == 0
    text = (folder / "design.md").read_text()
    assert "violates a limit: axial stiffness" in text and "10 lives over preload" in text
    assert len((folder / "map.csv").read_text().splitlines()) == 11
    assert step("design.figures.draw.other", folder / "x.svg", **files) == 2
    wrong = dict(zip(FILES, reversed(files.values()), strict=True))
    assert step("design.document.sheets.tables", tables, **wrong) == 2
    assert step("design.figures.draw.draw_map", folder / "x.svg", design=files["uncertainty"]) == 2


def changed(path, target, **values):
    """A case file with other numbers."""
    case = load(path)
    for name, value in values.items():
        case[name] = case[name] * 0 + value if name == "status" else case[name] * value
    case.to_netcdf(target)
    return str(target)


def test_recommended_preload_in_time(folder, tmp_path, capsys):
    """Without a cage, a dynamic run stays in the steady state that the map is made of."""
    recommendation = folder / "recommendation.nc"
    found = load(recommendation)
    longest = int(np.argmax(found["life"].values[:, 1]))
    cases = []
    for times in ("0.80", "1.00", "1.25"):
        path = tmp_path / f"{times}.yaml"
        files = {"scene": scene_file("gyro_s1"), "recommendation": recommendation}
        settings = f'{{"times": {float(times)}}}'
        assert step("design.dynamic_check.check_scene_text", path, settings, **files) == 0
        plain = yaml.safe_load(path.read_text())
        preload = float(found["preload"][longest])
        assert plain["operation"]["preload_N"] == pytest.approx(float(times) * preload, rel=1e-12)
        assert plain["operation"]["preload_method"] == METHODS[longest]
        assert load_scene(path).cage is not None
        path.write_text(yaml.safe_dump({k: v for k, v in plain.items() if k != "cage"}))
        for fidelity in ("steady", "dynamic"):
            cases.append(str(tmp_path / f"{times}-{fidelity}.nc"))
            assert main(["solve", str(path), "--fidelity", fidelity, "-o", cases[-1]]) == 0
    out = tmp_path / "check.md"

    def table(*paths):
        given = {"recommendation": recommendation, "cases": list(paths)}
        assert step("design.document.check_table.check_table", out, **given) == 0
        return out.read_text()

    text = table(*cases)
    assert "The dynamic model agrees with the steady values of the map within" in text
    assert text.count("| no |") == 9 and "| yes |" not in text
    for steady, dynamic in zip(map(load, cases[::2]), map(load, cases[1::2]), strict=True):
        assert_allclose(dynamic["total_qv"], steady["total_qv"], rtol=1e-9)
    # and the table sees where it does not
    beyond = 1.0 + 2.0 * float(load(cases[0])["qv_error_estimate"]) + 0.01
    text = table(*cases[:-1], changed(cases[-1], tmp_path / "qv.nc", total_qv=beyond))
    assert "agrees with the steady values of the map in part" in text
    assert "Beyond them: QV of the bearing by +" in text and text.count("| yes |") == 1
    failed = changed(cases[-1], tmp_path / "failed.nc", status=NOT_CONVERGED)
    text = table(*cases[:-1], failed)
    assert "Not solved: dynamic at" in text and "not converged" in text
    capsys.readouterr()
    for wrong in ([*cases[:-1]], [recommendation], [*cases, folder / "design.nc"]):
        given = {"recommendation": recommendation, "cases": wrong}
        assert step("design.document.check_table.check_table", out, **given) == 2
    assert len(capsys.readouterr().err.splitlines()) == 3


def test_nothing_recommended_is_checked_at_the_scene_s_own_preload(scene, folder):
    none = load(folder / "recommendation.nc")
    none["life"] *= math.nan
    none["preload"] *= math.nan
    checked = check_scene(scene, none, 0.8)
    assert checked.operation.preload_N == pytest.approx(0.8 * scene.operation.preload_N)
    assert checked.operation.preload_method == scene.operation.preload_method


def test_every_status_is_counted(folder, tmp_path):
    """Lives that were not solved keep their status, in the map, the CSV and the table."""
    design = load(folder / "design.nc")
    assert int(design["solves"].min()) >= 5 and int(design["failed_solves"].min()) >= 0
    design["status"].values[0, 0, 0, :2] = NOT_CONVERGED, BEYOND_GROOVE
    design.to_netcdf(tmp_path / "design.nc")
    files = files_in(folder) | {"design": tmp_path / "design.nc"}
    out = [tmp_path / "map.csv", tmp_path / "design.md"]
    assert step("design.document.sheets.tables", out, **files) == 0
    text = (tmp_path / "design.md").read_text()
    for name, count in (("ok", 8), ("not_converged", 1), ("beyond_groove", 1)):
        assert f"| {in_words(name)} | {count} |" in text
        assert (tmp_path / "map.csv").read_text().count(f",{name},") == count
    solves = int(design["solves"].sum())
    assert f"10 lives over preload, method, friction and speed, from {solves} steady" in text


def test_answer_stands_first(folder):
    """Preload and method in the title; the life and its spread in the first sentences."""
    out = [folder / "map.csv", folder / "design.md"]
    assert step("design.document.sheets.tables", out, **files_in(folder)) == 0
    text = (folder / "design.md").read_text().replace("\N{NO-BREAK SPACE}", " ")
    found = load(folder / "recommendation.nc").isel(preload_method=0)
    spread = load(folder / "uncertainty.nc").isel(
        preload_method=0, preload_choice=1, uncertain_inputs=0, loss_basis=1
    )
    low, high = spread_at(spread).bearings.text.split(" to ")
    title = text.partition("\n")[0]
    assert f"use a spring preload of {float(found['preload']):.7g} N (constant force)" in title
    assert f"{Rough(found['life'][1]).text} h of life, counting balls and races" in text
    assert f"90 % of bearings between {low} and {high} h" in text
    assert "violates a limit: axial stiffness of one bearing at least" in text


def test_parts_of_other_plans_are_refused(folder, tmp_path, capsys):
    scene, out = scene_file("gyro_s1"), tmp_path / "out.nc"
    design = folder / "design.nc"
    gather, recommend = "design.choice.design_map", "design.recommend.recommendation_of"
    limits = '{"limits": {"gyroscopic_slip_share": 0.25}}'
    parts = [folder / f"{method}.nc" for method in METHODS]
    assert step(gather, out, limits, parts=[design, folder / "recommendation.nc"]) == 2
    assert step(gather, out, limits.replace("25", "5"), parts=parts) == 2
    assert step(gather, out, limits, parts=parts) == 0
    assert step(recommend, out, scene=scene_file("gyro_s2"), design=design) == 2
    given = {"scene": scene, "parts": [folder / "constant_force-own-0.nc"]}
    quantiles = "uncertainty.quantiles.quantiles_and_indices"
    sampling = '{"sampling": {"samples": 4, "chunks": 2, "seed": 3}}'
    assert step(quantiles, out, sampling, **given) == 2
    assert step(quantiles, out, sampling.replace("4", "1024"), **given) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 5 and "parts missing" in lines[3]


def test_a_limit_can_be_changed_without_another_map(folder):
    parts = [folder / f"{method}.nc" for method in METHODS]
    found = load(folder / "design.nc")
    stiffer = design_map(parts, LIMITS | {"axial_stiffness_N_um": 4.0})
    assert found["recommended_preload"].values.ravel().tolist() == [5.0, 11.0]
    assert_allclose(stiffer["recommended_preload"].values.ravel(), [7.0, math.nan])
    assert ACTIVE[int(stiffer["active_limit"].values.ravel()[1])] == "no_preload_within_limits"
    assert stiffer["life"].equals(found["life"])


# a small map, in one process


def axes(preloads, friction=0.08):
    return MapAxes(
        preload_method=METHODS, friction=(friction,), shaft_speed_rpm=(30000.0,), preload_N=preloads
    )


def test_a_small_map_recommends_what_the_parts_of_a_large_one_do(scene, folder):
    design, found = mapped(scene, axes((3.0, 5.0, 7.0, 9.0, 11.0)), DesignLimits(**LIMITS))
    for one, name in ((design, "design"), (found, "recommendation")):
        whole = load(folder / f"{name}.nc")
        xr.testing.assert_equal(one.drop_attrs(), whole.drop_attrs())
        assert one.attrs == whole.attrs


def test_the_limit_that_is_met_first_between_points_of_the_map_holds(scene):
    """At 3 N the slip share misses its limit by more than the stiffness, which is met sooner."""
    limits = DesignLimits(axial_stiffness_N_um=3.0, gyroscopic_slip_share=0.2)
    _, found = mapped(scene, axes((3.0, 8.0)), limits)
    one = found.isel(preload_method=0)
    assert 3.0e6 <= float(LIMITED["axial_stiffness_N_um"].worst(one)) < 3.0e6 * 1.01
    assert float(one["gyroscopic_slip_share"]) < 0.199
    assert ACTIVE[int(one["active_limit"])] == "axial_stiffness_N_um"


def test_figures_and_tables_without_an_uncertainty_study(scene, tmp_path):
    design, found = mapped(scene, axes((3.0, 7.0, 11.0)), DesignLimits(axial_stiffness_N_um=90.0))
    files = {"design": tmp_path / "design.nc", "recommendation": tmp_path / "recommendation.nc"}
    write_dataset(design, files["design"])
    write_dataset(found, files["recommendation"])
    out = tmp_path / "design.svg"
    assert step("design.figures.draw.draw_design", out, **files) == 0
    assert out.stat().st_size > 10_000
    tables = [tmp_path / "map.csv", tmp_path / "design.md"]
    assert step("design.document.sheets.tables", tables, **files) == 0
    text = tables[1].read_text()
    assert "Uncertainty" not in text and "L10" not in text
    why = "axial stiffness of one bearing at least 90"
    assert f"No fixed position preload satisfies all limits: {why}" in text
    assert "at best" in text and "nan" not in text


@pytest.mark.parametrize("life", [0.0, np.nan])
def test_figures_of_a_map_without_any_life(life, scene, tmp_path):
    """Each over a limit when new, or none solved: there is no axis of life to be logarithmic."""
    design, found = mapped(scene, axes((3.0, 7.0, 11.0)), DesignLimits())
    design["life"][:] = life
    found["life"][:], found["preload"][:] = life, np.nan
    files = {"design": tmp_path / "design.nc", "recommendation": tmp_path / "recommendation.nc"}
    write_dataset(design, files["design"])
    write_dataset(found, files["recommendation"])
    assert step("design.figures.draw.draw_design", tmp_path / "design.svg", **files) == 0
    assert step("design.figures.draw.draw_map", tmp_path / "map.svg", design=files["design"]) == 0


def test_scenes_without_an_uncertainty_study_ask_for_none():
    plan = read_record(DesignPlan, PLAN_FILE)
    for sampled, asked in (((), False), (("gyro_s1",), True)):
        given = [path for step in DesignStudy(plan, sampled).steps for path in asked_for(step)]
        assert any(path.endswith("uncertainty.nc") for path in given) == asked


def asked_for(step):
    return [path for job in step.jobs() for path in flat_files(step.files(job))]


def test_small_maps_are_those_of_scenes_in_the_main_study():
    plan = read_record(DesignPlan, PLAN_FILE)
    assert DesignStudy(plan, (), ("another",)).default_targets() == []
    made = DesignStudy(plan, (), ("gyro_s1",)).default_targets()
    assert "results/gyro_s1/preload/recommendation.nc" in made
    assert "results/gyro_s1/preload/tables/design.md" in made
